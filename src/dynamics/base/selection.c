/* selection.c - the particles of a boundary or load of the explicit MPS solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "selection.h"
#include "core/particles/particles_internal.h"
#include "dynamics/base/dynamics_solver.h"

#include <stdlib.h>

bool mpsi_dynamics_counts(const void *solver, int64_t id) {
  const mps_dynamics *dynamics = solver;
  const int64_t i = mps_particles_index(dynamics->particles, id);
  return i >= 0 && (i < dynamics->body || dynamics->lead);
}

mps_status mpsi_dynamics_make_part(mps_dynamics *dynamics, const char *function, int64_t *ids,
                                   int64_t *id_count, mpsi_dynamics_part *out) {
  out->id = ids;
  out->listed = *id_count;
  out->particle = mpsi_alloc(dynamics->context, out->listed, sizeof *out->particle);
  if (!out->particle)
    return mpsi_fail_memory(dynamics->context, function,
                            (size_t)out->listed * sizeof *out->particle);
  mpsi_dynamics_find_part(dynamics, out);
  const int64_t *id = mpsi_particles_integers(dynamics->particles, "id");
  for (int64_t k = 0; k < out->count; k++) ids[k] = id[out->particle[k]];
  *id_count = out->listed = out->count;
  return MPS_OK;
}

int64_t mpsi_dynamics_counted(const mps_dynamics *dynamics, const mpsi_dynamics_part *part) {
  int64_t count = 0;
  for (int64_t k = 0; k < part->count; k++)
    count += part->particle[k] < dynamics->body || dynamics->lead;
  return count;
}

static int compare_indices(const void *left, const void *right) {
  const int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
  return a < b ? -1 : a > b;
}

void mpsi_dynamics_find_part(const mps_dynamics *dynamics, mpsi_dynamics_part *part) {
  int64_t found = 0;
  bool sorted = true;
  for (int64_t k = 0; k < part->listed; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, part->id[k]);
    if (i < 0) continue;
    sorted = sorted && (found == 0 || part->particle[found - 1] < i);
    part->particle[found++] = (int32_t)i;
  }
  if (!sorted) qsort(part->particle, (size_t)found, sizeof *part->particle, compare_indices);
  part->count = 0;
  for (int64_t k = 0; k < found; k++) /* each particle once */
    if (k == 0 || part->particle[k] != part->particle[part->count - 1])
      part->particle[part->count++] = part->particle[k];
}
