/* row_heads.h - a rank's description of its particles as a message (gather.c, rows.c): head, runs
 * of rows, then the head of each field.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/particles/particles_internal.h"
#include "core/state/state.h"

#include <stdio.h>

typedef struct mpsi_rows_head {
  int64_t particles, fields, dim, runs, made; /* made: ids lie below it */
  double spacing;
} mpsi_rows_head;

typedef struct mpsi_field_head {
  char name[MPSI_STATE_NAME];
  int64_t columns, integer;
} mpsi_field_head;

/* Of all fields of the set. */
static inline mpsi_rows_head mpsi_rows_head_of(const mps_particles *set, int32_t rank) {
  return (mpsi_rows_head){.particles = mps_particles_count(set),
                          .fields = mps_particles_field_count(set),
                          .dim = mps_particles_dim(set),
                          .runs = mpsi_particles_runs(set, rank, NULL),
                          .made = mpsi_particles_made(set),
                          .spacing = mps_particles_spacing(set)};
}

static inline mpsi_field_head mpsi_field_head_of(const mps_particles_field_info *info) {
  mpsi_field_head head = {.columns = info->components, .integer = info->dtype.code == 0};
  snprintf(head.name, sizeof head.name, "%s", info->name);
  return head;
}

/* Order of two runs of rows in the whole set: < 0, > 0, or 0 where they begin at one place. */
static inline int mpsi_row_run_order(const mpsi_row_run *a, const mpsi_row_run *b) {
  for (int c = 2; c >= 0; c--)
    if (a->at[c] != b->at[c]) return a->at[c] < b->at[c] ? -1 : 1;
  return 0;
}
