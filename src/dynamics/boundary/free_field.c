/* free_field.c - free-field columns: level ground beside the body, as particles of the same set.
 *
 * A column is one lattice column wide and repeats itself in x with period D, so it moves as
 * horizontally infinite ground. pairs.c computes the forces of the missing ground on the edge;
 * boundary.c adds dashpots between edge and column.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"
#include "core/particles/particles_internal.h"

#include <mps/dynamics.h>

#include <string.h>

typedef struct edge {
  double x; /* m, of the outermost particles */
  int64_t count;
  int64_t *index; /* their indices, bottom up after sorting by y is left to the solver */
} edge;

static mps_status find_edge(mps_context *context, mps_particles *particles, int32_t side,
                            edge *out) {
  const int64_t n = mps_particles_count(particles);
  const double *x = mpsi_particles_column(particles, "position", 0);
  const int64_t *mark = mpsi_particles_integers(particles, "free_field");
  const double D = mps_particles_spacing(particles);
  out->x = side == MPS_SIDE_X_LOWER ? INFINITY : -INFINITY;
  for (int64_t k = 0; k < n; k++) {
    if (mark && mark[k] == 1 + (int64_t)side)
      return mpsi_fail(context, "mps_dynamics_add_free_field", MPS_ERROR_STATE,
                       "the set already has a %s free-field column",
                       side == MPS_SIDE_X_LOWER ? "left" : "right");
    if (mark && mark[k]) continue;
    out->x = side == MPS_SIDE_X_LOWER ? fmin(out->x, x[k]) : fmax(out->x, x[k]);
  }
  out->index = mpsi_alloc(context, n, sizeof *out->index);
  if (!out->index) return mpsi_fail_memory(context, "mps_dynamics_add_free_field", (size_t)n * 8);
  for (int64_t k = 0; k < n; k++)
    if (!(mark && mark[k]) && fabs(x[k] - out->x) < 1e-6 * D) out->index[out->count++] = k;
  return MPS_OK;
}

/* Copies every field but id, position and the mark from the edge to the new particles. */
static mps_status copy_fields(mps_particles *particles, const edge *e, int64_t first, int32_t side,
                              double shift) {
  for (int32_t f = 0; f < mps_particles_field_count(particles); f++) {
    mps_particles_field_info info;
    MPSI_TRY(mps_particles_get_field_info(particles, f, &info));
    if (strcmp(info.name, "id") == 0 || strcmp(info.name, "position") == 0) continue;
    for (int32_t c = 0; c < info.components; c++) {
      double *value = mpsi_particles_column(particles, info.name, c);
      const double more = strcmp(info.name, "reference") == 0 && c == 0 ? shift : 0.0;
      for (int64_t k = 0; value && k < e->count; k++) value[first + k] = value[e->index[k]] + more;
    }
    int64_t *number = mpsi_particles_integers(particles, info.name);
    const bool mark = strcmp(info.name, "free_field") == 0;
    for (int64_t k = 0; number && k < e->count; k++)
      number[first + k] = mark ? 1 + side : number[e->index[k]];
  }
  return MPS_OK;
}

static mps_status append_column(mps_context *context, mps_particles *particles, int32_t side,
                                int32_t gap, const edge *e) {
  const double *x = mpsi_particles_column(particles, "position", 0);
  const double *y = mpsi_particles_column(particles, "position", 1);
  const double D = mps_particles_spacing(particles);
  const double shift = (side == MPS_SIDE_X_LOWER ? -D : D) * gap;
  double *at = mpsi_alloc(context, 2 * e->count, sizeof *at);
  if (!at) return mpsi_fail_memory(context, "mps_dynamics_add_free_field", (size_t)e->count * 16);
  for (int64_t k = 0; k < e->count; k++) {
    at[2 * k] = x[e->index[k]] + shift;
    at[2 * k + 1] = y[e->index[k]];
  }
  const int64_t first = mps_particles_count(particles);
  const int32_t fields = mps_particles_field_count(particles);
  mps_status status = mps_particles_add_field(particles, "free_field", 0);
  if (status == MPS_OK)
    status = mpsi_fail_of(context, mps_particles_append(particles, e->count, at), "gap");
  if (status == MPS_OK) status = copy_fields(particles, e, first, side, shift);
  if (status != MPS_OK) mpsi_particles_drop_fields(particles, fields);
  mpsi_free(context, at);
  return status;
}

mps_status mps_dynamics_add_free_field(mps_particles *particles, int32_t side, int32_t gap) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_context *context = mpsi_particles_context(particles);
  if (side != MPS_SIDE_X_LOWER && side != MPS_SIDE_X_UPPER)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "side is %s, allowed are MPS_SIDE_X_LOWER and MPS_SIDE_X_UPPER",
                     mpsi_name_of("mps_side", side).text);
  if (gap < 2 || gap > 1000000)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "gap is %d spacings, must be 2 to 1000000", gap);
  if (mps_particles_dim(particles) != 2 || mps_particles_count(particles) < 1)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "the set has dim %d and %lld particles: a 2D body is needed",
                     mps_particles_dim(particles), (long long)mps_particles_count(particles));
  edge e = {0};
  mps_status status = mpsi_particles_check_free(particles, __func__);
  if (status == MPS_OK) status = mpsi_particles_check_deal(particles, __func__, NULL);
  if (status == MPS_OK) status = find_edge(context, particles, side, &e);
  if (status == MPS_OK)
    status = mpsi_as(context, __func__, append_column(context, particles, side, gap, &e));
  mpsi_free(context, e.index);
  return status;
}
