/* parts.c - see parts.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "parts.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

mps_status parts_create(mps_context *context, mps_domain *domain, const mps_particles_def *def,
                        mps_particles **out) {
  return domain ? mps_domain_create_particles(domain, def, out)
                : mps_particles_create(context, def, out);
}

mps_status parts_sum(mps_domain *domain, int64_t *value) {
  if (!domain) return MPS_OK;
  const int32_t ranks = mps_domain_size(domain);
  double *each = calloc((size_t)ranks, sizeof *each);
  mps_status status = mps_domain_agree(domain, each ? MPS_OK : MPS_ERROR_MEMORY);
  if (status == MPS_OK) {
    each[mps_domain_rank(domain)] = (double)*value;
    status = mps_domain_max(domain, ranks, each);
  }
  *value = 0;
  for (int32_t k = 0; status == MPS_OK && k < ranks; k++) *value += (int64_t)each[k];
  free(each);
  return status;
}

/* ---- the nearest ----------------------------------------------------------------------------- */

/* This rank's nearest particle to each place: id, where it lies, and -(distance)^2, in the order of
 * terms in which mps_particles_nearest adds them. */
static mps_status find_own(mps_particles *particles, int32_t count, const double *places,
                           int64_t *ids, double *position, double *closeness) {
  mps_view x;
  const mps_status status = mps_particles_view(particles, "position", &x);
  const int32_t dim = mps_particles_dim(particles);
  for (int32_t k = 0; k < count; k++) {
    ids[k] = mps_particles_nearest(particles, places + k * dim);
    closeness[k] = -INFINITY;
    const int64_t row = mps_particles_index(particles, ids[k]);
    if (status != MPS_OK || row < 0) continue;
    double square = 0.0;
    for (int32_t c = 0; c < dim; c++) {
      position[k * dim + c] = *mps_view_f64(&x, row, c);
      const double distance = position[k * dim + c] - places[k * dim + c];
      square += distance * distance;
    }
    closeness[k] = -square;
  }
  return status;
}

/* `best` is for work: the closeness of each rank's own, then of all; ids; positions. */
static mps_status join(mps_domain *domain, int32_t dim, int32_t count, int64_t *ids,
                       double *position, double *best) {
  double *own = best + count, *lowest = own + count;
  for (int32_t k = 0; k < count; k++) best[k] = own[k];
  mps_status status = mps_domain_max(domain, count, best);
  for (int32_t k = 0; k < count; k++)
    lowest[k] = ids[k] >= 0 && own[k] == best[k] ? -(double)ids[k] : -INFINITY;
  if (status == MPS_OK) status = mps_domain_max(domain, count, lowest);
  for (int32_t k = 0; status == MPS_OK && k < count; k++) {
    const bool here = ids[k] >= 0 && lowest[k] == -(double)ids[k];
    for (int32_t c = 0; c < dim && !here; c++) position[k * dim + c] = -INFINITY;
    ids[k] = isfinite(lowest[k]) ? -(int64_t)lowest[k] : -1;
  }
  return status == MPS_OK ? mps_domain_max(domain, count * dim, position) : status;
}

mps_status parts_nearest(mps_domain *domain, mps_particles *particles, int32_t count,
                         const double *places, int64_t *ids, double *position) {
  double *work = malloc(3 * (size_t)count * sizeof *work + 1);
  mps_status status = work ? MPS_OK : MPS_ERROR_MEMORY;
  if (work) status = find_own(particles, count, places, ids, position, work + count);
  if (domain) {
    status = mps_domain_agree(domain, status);
    if (status == MPS_OK)
      status = join(domain, mps_particles_dim(particles), count, ids, position, work);
  }
  free(work);
  return status;
}
