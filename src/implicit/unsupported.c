/* unsupported.c - the functions of mps/elastic.h in a build without CHOLMOD: no solver can be
 * created. SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

#include <mps/elastic.h>
#include <mps/experimental/papers.h>

static mps_status refuse(mps_context *context, const char *function, mps_elastic **out) {
  if (!context) return mpsi_null(function, "context");
  if (out) *out = NULL;
  return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                   "this libmps was built without CHOLMOD (MPS_IMPLICIT)");
}

mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                              const mps_elastic_def *def, mps_elastic **out) {
  return refuse(context, __func__, out);
}

mps_status mps_experimental_elastic_published(mps_context *context, mps_particles *particles,
                                              const mps_elastic_def *def, int32_t constant,
                                              mps_elastic **out) {
  return refuse(context, __func__, out);
}

mps_status mps_elastic_set_material(mps_elastic *elastic, const mps_material *material,
                                    const int64_t *ids, int64_t count) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_cut(mps_elastic *elastic, int32_t side, const int64_t *ids, int64_t count) {
  return MPS_ERROR_UNSUPPORTED;
}

int64_t mps_elastic_facet_count(const mps_elastic *elastic) { return 0; }

mps_status mps_elastic_select_facets(const mps_elastic *elastic, int32_t side, const double *lo,
                                     const double *hi, int64_t capacity, int64_t *count,
                                     int64_t *facets) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_facets_sized(const mps_elastic *elastic, const int64_t *facets,
                                        int64_t count, const mps_elastic_facet_arrays *arrays,
                                        size_t size) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_load_resultant(const mps_elastic *elastic, const double *about,
                                          double *force, double *moment) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_analyse_sized(mps_elastic *elastic, mps_elastic_estimate *out, size_t size) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_solve(mps_elastic *elastic) { return MPS_ERROR_UNSUPPORTED; }

mps_status mps_elastic_solve_cases(mps_elastic *elastic, int64_t count, const double *loads,
                                   double *displacements) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_get_report_sized(const mps_elastic *elastic, mps_elastic_report *out,
                                        size_t size) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_update_stress(mps_elastic *elastic) { return MPS_ERROR_UNSUPPORTED; }

mps_status mps_elastic_get_section(const mps_elastic *elastic, int32_t axis, double position,
                                   const double *about, double *force, double *moment) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_start(mps_elastic *elastic, const mps_elastic_motion_def *def) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_status mps_elastic_modes(mps_elastic *elastic, int64_t count, double *omega, double *shapes) {
  return MPS_ERROR_UNSUPPORTED;
}

mps_solver *mps_elastic_solver(const mps_elastic *elastic) { return NULL; }
