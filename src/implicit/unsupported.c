/* unsupported.c - the functions of mps/elastic.h in a build without CHOLMOD: no solver can be
 * created. SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

#include <mps/elastic_solver.h>
#include <mps/experimental.h>

static mps_status refuse(mps_context *context, const char *function, mps_elastic **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (out) *out = NULL;
  return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                   "this libmps was built without CHOLMOD (MPS_IMPLICIT)");
}

mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                              const mps_elastic_def *def, mps_elastic **out) {
  (void)particles;
  (void)def;
  return refuse(context, __func__, out);
}

mps_status mps_experimental_elastic_published(mps_context *context, mps_particles *particles,
                                              const mps_elastic_def *def, int32_t constant,
                                              mps_elastic **out) {
  (void)particles;
  (void)def;
  (void)constant;
  return refuse(context, __func__, out);
}

void mps_elastic_destroy(mps_elastic **elastic) { (void)elastic; }

mps_status mps_elastic_get_def_sized(const mps_elastic *elastic, mps_elastic_def *out,
                                     size_t size) {
  (void)elastic;
  (void)out;
  (void)size;
  return MPS_ERROR_UNSUPPORTED;
}

mps_particles *mps_elastic_particles(const mps_elastic *elastic) {
  (void)elastic;
  return NULL;
}

mps_context *mps_elastic_context(const mps_elastic *elastic) {
  (void)elastic;
  return NULL;
}

mps_status mps_elastic_update_material(mps_elastic *elastic) {
  (void)elastic;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_set_material(mps_elastic *elastic, const mps_material *material,
                                    int64_t count, const int64_t *ids) {
  (void)elastic;
  (void)material;
  (void)count;
  (void)ids;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_cut(mps_elastic *elastic, int32_t axis, int32_t side, int64_t count,
                           const int64_t *ids) {
  (void)elastic;
  (void)axis;
  (void)side;
  (void)count;
  (void)ids;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_add_boundary(mps_elastic *elastic, const mps_elastic_boundary_def *def,
                                    int32_t *number) {
  (void)elastic;
  (void)def;
  (void)number;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_set_boundary(mps_elastic *elastic, int32_t number,
                                    const mps_elastic_boundary_def *def) {
  (void)elastic;
  (void)number;
  (void)def;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_remove_boundary(mps_elastic *elastic, int32_t number) {
  (void)elastic;
  (void)number;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_reaction_sized(const mps_elastic *elastic, int32_t number,
                                          mps_reaction *out, size_t size) {
  (void)elastic;
  (void)number;
  (void)out;
  (void)size;
  return MPS_ERROR_UNSUPPORTED;
}

int64_t mps_elastic_facet_count(const mps_elastic *elastic) {
  (void)elastic;
  return 0;
}

mps_status mps_elastic_select_facets(const mps_elastic *elastic, int32_t axis, int32_t side,
                                     const double *lo, const double *hi, int64_t capacity,
                                     int64_t *count, int64_t *facets) {
  (void)elastic;
  (void)axis;
  (void)side;
  (void)lo;
  (void)hi;
  (void)capacity;
  (void)facets;
  (void)count;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_facets_sized(const mps_elastic *elastic, int64_t count,
                                        const int64_t *facets,
                                        const mps_elastic_facet_arrays *arrays, size_t size) {
  (void)elastic;
  (void)count;
  (void)facets;
  (void)arrays;
  (void)size;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_add_load(mps_elastic *elastic, const mps_elastic_load_def *def,
                                int32_t *number) {
  (void)elastic;
  (void)def;
  (void)number;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_set_load(mps_elastic *elastic, int32_t number,
                                const mps_elastic_load_def *def) {
  (void)elastic;
  (void)number;
  (void)def;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_remove_load(mps_elastic *elastic, int32_t number) {
  (void)elastic;
  (void)number;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_load_resultant(const mps_elastic *elastic, const double *about,
                                          double *force, double *moment) {
  (void)elastic;
  (void)about;
  (void)force;
  (void)moment;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_analyse_sized(mps_elastic *elastic, mps_elastic_estimate *out, size_t size) {
  (void)elastic;
  (void)out;
  (void)size;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_solve(mps_elastic *elastic) {
  (void)elastic;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_solve_cases(mps_elastic *elastic, int64_t count, const double *loads,
                                   double *displacements) {
  (void)elastic;
  (void)count;
  (void)loads;
  (void)displacements;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_report_sized(const mps_elastic *elastic, mps_elastic_report *out,
                                        size_t size) {
  (void)elastic;
  (void)out;
  (void)size;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_update_stress(mps_elastic *elastic) {
  (void)elastic;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_section(const mps_elastic *elastic, int32_t axis, double position,
                                   const double *about, double *force, double *moment) {
  (void)elastic;
  (void)axis;
  (void)position;
  (void)about;
  (void)force;
  (void)moment;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_energy(const mps_elastic *elastic, double *strain, double *stabilising) {
  (void)elastic;
  (void)strain;
  (void)stabilising;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_totals_sized(const mps_elastic *elastic, mps_totals *out, size_t size) {
  (void)elastic;
  (void)out;
  (void)size;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_start(mps_elastic *elastic, const mps_elastic_motion_def *def) {
  (void)elastic;
  (void)def;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_step(mps_elastic *elastic, int64_t count) {
  (void)elastic;
  (void)count;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_run(mps_elastic *elastic, double t_end, int64_t every,
                           mps_elastic_fn callback, void *user) {
  (void)elastic;
  (void)t_end;
  (void)every;
  (void)callback;
  (void)user;
  return MPS_ERROR_UNSUPPORTED;
}

double mps_elastic_time(const mps_elastic *elastic) {
  (void)elastic;
  return 0.0;
}

int64_t mps_elastic_steps(const mps_elastic *elastic) {
  (void)elastic;
  return 0;
}

double mps_elastic_dt(const mps_elastic *elastic) {
  (void)elastic;
  return 0.0;
}

double mps_elastic_limit(const mps_elastic *elastic) {
  (void)elastic;
  return 0.0;
}

mps_status mps_elastic_set_dt(mps_elastic *elastic, double dt) {
  (void)elastic;
  (void)dt;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_modes(mps_elastic *elastic, int32_t count, double *omega, double *shapes) {
  (void)elastic;
  (void)count;
  (void)omega;
  (void)shapes;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_snapshot(mps_elastic *elastic, mps_snapshot **snapshot) {
  (void)elastic;
  (void)snapshot;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_rollback(mps_elastic *elastic, const mps_snapshot *snapshot) {
  (void)elastic;
  (void)snapshot;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_save(mps_elastic *elastic, const char *path, const mps_checkpoint *info) {
  (void)elastic;
  (void)path;
  (void)info;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_restore(mps_elastic *elastic, const char *path, mps_checkpoint *info) {
  (void)elastic;
  (void)path;
  (void)info;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_set_solver(mps_elastic *elastic, const mps_elastic_solver_def *def) {
  (void)elastic;
  (void)def;
  return MPS_ERROR_UNSUPPORTED;
}
