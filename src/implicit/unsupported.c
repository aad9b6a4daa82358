/* unsupported.c - the functions of mps/elastic.h in a build without CHOLMOD: no solver can be
 * created, so the others have nothing to work on. SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

#include <mps/elastic.h>

mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                              const mps_elastic_def *def, mps_elastic **out) {
  (void)particles;
  (void)def;
  if (!context) return MPS_ERROR_ARGUMENT;
  if (out) *out = NULL;
  return mpsi_fail(context, __func__, MPS_ERROR_UNSUPPORTED,
                   "this libmps was built without CHOLMOD (MPS_IMPLICIT)");
}

void mps_elastic_destroy(mps_elastic **elastic) { (void)elastic; }

mps_status mps_elastic_update_material(mps_elastic *elastic) {
  (void)elastic;
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

mps_status mps_elastic_prescribe(mps_elastic *elastic, int32_t component, int64_t count,
                                 const int64_t *ids, const double *values) {
  (void)elastic;
  (void)component;
  (void)count;
  (void)ids;
  (void)values;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_roller(mps_elastic *elastic, const double *normal, int64_t count,
                              const int64_t *ids, const double *values) {
  (void)elastic;
  (void)normal;
  (void)count;
  (void)ids;
  (void)values;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_clear_supports(mps_elastic *elastic) {
  (void)elastic;
  return MPS_ERROR_UNSUPPORTED;
}

int64_t mps_elastic_facet_count(const mps_elastic *elastic) {
  (void)elastic;
  return 0;
}

mps_status mps_elastic_get_facet(const mps_elastic *elastic, int64_t facet,
                                 mps_elastic_facet *out) {
  (void)elastic;
  (void)facet;
  (void)out;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_select_facets(const mps_elastic *elastic, int32_t axis, int32_t side,
                                     const double *lo, const double *hi, int64_t capacity,
                                     int64_t *facets, int64_t *count) {
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

mps_status mps_elastic_clear_loads(mps_elastic *elastic) {
  (void)elastic;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_add_forces(mps_elastic *elastic, int64_t count, const int64_t *ids,
                                  const double *forces) {
  (void)elastic;
  (void)count;
  (void)ids;
  (void)forces;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_add_body_force(mps_elastic *elastic, const double *force) {
  (void)elastic;
  (void)force;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_add_traction(mps_elastic *elastic, int64_t count, const int64_t *facets,
                                    const double *traction) {
  (void)elastic;
  (void)count;
  (void)facets;
  (void)traction;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_add_pressure(mps_elastic *elastic, int64_t count, const int64_t *facets,
                                    const double *pressures) {
  (void)elastic;
  (void)count;
  (void)facets;
  (void)pressures;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_add_traction_fn(mps_elastic *elastic, int64_t count, const int64_t *facets,
                                       mps_traction_fn traction, void *user) {
  (void)elastic;
  (void)count;
  (void)facets;
  (void)traction;
  (void)user;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_load_resultant(const mps_elastic *elastic, const double *about,
                                      double *force, double *moment) {
  (void)elastic;
  (void)about;
  (void)force;
  (void)moment;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_analyse(mps_elastic *elastic, mps_elastic_estimate *out) {
  (void)elastic;
  (void)out;
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

mps_status mps_elastic_get_report(const mps_elastic *elastic, mps_elastic_report *out) {
  (void)elastic;
  (void)out;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_reaction_resultant(const mps_elastic *elastic, const double *about,
                                          double *force, double *moment) {
  (void)elastic;
  (void)about;
  (void)force;
  (void)moment;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_stress(mps_elastic *elastic) {
  (void)elastic;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_section(mps_elastic *elastic, int32_t axis, double position,
                               const double *about, double *force, double *moment) {
  (void)elastic;
  (void)axis;
  (void)position;
  (void)about;
  (void)force;
  (void)moment;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_energy(mps_elastic *elastic, double *strain, double *stabilising) {
  (void)elastic;
  (void)strain;
  (void)stabilising;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_start(mps_elastic *elastic, const mps_newmark_def *def) {
  (void)elastic;
  (void)def;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_step(mps_elastic *elastic, int64_t count) {
  (void)elastic;
  (void)count;
  return MPS_ERROR_UNSUPPORTED;
}

double mps_elastic_time(const mps_elastic *elastic) {
  (void)elastic;
  return 0.0;
}

mps_status mps_elastic_kinetic_energy(const mps_elastic *elastic, double *out) {
  (void)elastic;
  (void)out;
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_modes(mps_elastic *elastic, int32_t count, double *omega, double *shapes) {
  (void)elastic;
  (void)count;
  (void)omega;
  (void)shapes;
  return MPS_ERROR_UNSUPPORTED;
}
