/* selection.h - the particles that a boundary or load is on, for its numbered condition
 * (solver/conditions.h). SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

#include <stdbool.h>

/* Particles, and signals of x and y. Ids, signals and factors are those of the kept definition. */
typedef struct mpsi_dynamics_part {
  const int64_t *id; /* each once, also of removed particles */
  int64_t listed;
  int64_t count;
  int32_t *particle; /* present indices of the remaining particles, ascending */
  mps_signal *const *signal;
  const double *factor;
} mpsi_dynamics_part;

/* A member of mpsi_condition_kind. */
bool mpsi_dynamics_counts(const void *dynamics, int64_t id);

/* The particles of `ids`, which become those of this rank, each once. */
mps_status mpsi_dynamics_make_part(mps_dynamics *dynamics, const char *function, int64_t *ids,
                                   int64_t *id_count, mpsi_dynamics_part *out);
/* Particles that this rank counts: columns, which all ranks have, count on the leading one. */
int64_t mpsi_dynamics_counted(const mps_dynamics *dynamics, const mpsi_dynamics_part *part);
/* Finds its particles in the present set. */
void mpsi_dynamics_find_part(const mps_dynamics *dynamics, mpsi_dynamics_part *part);
