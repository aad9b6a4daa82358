/* files.c - checkpoints of a body that lies on several ranks. Rank 0 writes the file of a run
 * without a domain: particles and lists in the order of the whole body, sums over all ranks. Each
 * rank reads the whole file and keeps its part, so that a run continues on any number of ranks, or
 * without a domain. SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "files.h"
#include "dynamics/base/dynamics_solver.h"
#include "io/checkpoint.h"
#include "domain/moment.h"

#include <stdio.h>
#include <string.h>

/* Correspondence of the values of a rank and those of the file. */
typedef enum merging {
  SAME, /* on all ranks */
  SUM,  /* exact sums: of all ranks; read, they are rank 0's */
  COUNT,
  ROWS /* of lists in the order of particles; of columns the last rank's */
} merging;

static merging merging_of(const mpsi_value *value) {
  if (value->agrees || value->optional) return SAME;
  if (value->table) return mpsi_state_name_ends(value->name, "sites") ? SAME : ROWS;
  if (strncmp(value->name, "work_", 5) == 0 || mpsi_state_name_ends(value->name, "/pushed") ||
      mpsi_state_name_ends(value->name, "/impulse") || mpsi_state_name_ends(value->name, "/work"))
    return SUM;
  return mpsi_state_name_ends(value->name, "/particles") ? COUNT : SAME;
}

/* ---- numbers of list rows that belong to the body -------------------------------------------- */

static int64_t body_rows(const mps_dynamics *dynamics, const mpsi_value *value) {
  int64_t rows = 0;
  if (strcmp(value->name, "held_values") == 0)
    for (int64_t k = 0; k < dynamics->bounds; k++)
      rows += dynamics->bound[k].particle < dynamics->body;
  else
    for (int64_t k = 0; k < dynamics->dashpots; k++)
      rows += dynamics->dashpot[k].particle < dynamics->body;
  return rows;
}

static const mpsi_dynamics_part *part_of(const mps_dynamics *dynamics, const char *name) {
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++) {
    char own[MPSI_STATE_NAME];
    snprintf(own, sizeof own, "boundary%d/particles", (int)k);
    if (mpsi_dynamics_boundary_of(dynamics, k) && strcmp(own, name) == 0)
      return &mpsi_dynamics_boundary_of(dynamics, k)->part;
  }
  return NULL;
}

/* ---- writing --------------------------------------------------------------------------------- */

static mps_status merge(mps_dynamics *dynamics, const char *function, mpsi_values *state) {
  mps_status status = MPS_OK;
  for (int32_t k = 0; k < state->count && status == MPS_OK; k++) {
    mpsi_value *value = &state->item[k];
    const merging how = merging_of(value);
    if (how == SUM)
      status = mpsi_domain_sum_exact(dynamics->domain, function,
                                     (int32_t)(value->rows / MPSI_EXACT_LIMBS), value->data);
    if (how == ROWS)
      status =
          mpsi_domain_gather_rows(dynamics->domain, function,
                                  dynamics->lead ? value->rows : body_rows(dynamics, value), value);
    if (how != COUNT) continue;
    *(int64_t *)value->data = mpsi_dynamics_counted(dynamics, part_of(dynamics, value->name));
    status = mpsi_domain_sum(dynamics->domain, function, 1, value->data);
  }
  return status;
}

mps_status mpsi_dynamics_save_partitions(mps_dynamics *dynamics, const mpsi_state_of *of,
                                         const char *function, const char *path,
                                         const mps_checkpoint *info) {
  mps_snapshot state = {.context = dynamics->context};
  const mpsi_checkpoint_request request = {of, function, path, info, &state.state};
  mps_status status =
      mpsi_domain_agree(dynamics->domain, function, mpsi_state_get(of, function, &state));
  if (status == MPS_OK) status = merge(dynamics, function, &state.state);
  if (status == MPS_OK)
    status = mpsi_domain_write_rows(dynamics->domain, function, dynamics->particles,
                                    mpsi_checkpoint_save_rows, (void *)&request);
  mpsi_values_free(dynamics->context, &state.state);
  return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

static mps_status misfit(const mps_dynamics *dynamics, const char *function, const char *what) {
  return mpsi_fail(dynamics->context, function, MPS_ERROR_FORMAT,
                   "the file is of another body: %s is another", what);
}

/* Rows of this rank's particles, in their order. */
static mps_status take_fields(mps_dynamics *dynamics, const char *function, mps_snapshot *values) {
  mps_context *context = dynamics->context;
  const mpsi_value *id = mpsi_values_find(&values->fields, "id");
  const int64_t made = mpsi_particles_made(dynamics->particles), all = values->particles;
  const int64_t *own = mpsi_particles_integers(dynamics->particles, "id"), n = dynamics->count;
  if (all != dynamics->whole || !id || id->rows != all)
    return misfit(dynamics, function, "the number of particles");
  int64_t *at = mpsi_alloc(context, made, sizeof *at), *column = mpsi_alloc(context, n, 8);
  mps_status status = at && column ? MPS_OK : mpsi_fail_memory(context, function, (size_t)made * 8);
  for (int64_t k = 0; status == MPS_OK && k < made; k++) at[k] = -1;
  for (int64_t k = 0; status == MPS_OK && k < all; k++) {
    const int64_t i = ((const int64_t *)id->data)[k];
    if (i < 0 || i >= made) status = misfit(dynamics, function, "an id");
    if (status == MPS_OK) at[i] = k;
  }
  for (int64_t k = 0; status == MPS_OK && k < n; k++)
    if (at[own[k]] < 0) status = misfit(dynamics, function, "an id");
  for (int32_t f = 0; status == MPS_OK && f < values->fields.count; f++) {
    mpsi_value *field = &values->fields.item[f];
    for (int32_t c = 0; c < field->columns; c++) { /* n <= all: no column overtakes another */
      for (int64_t k = 0; k < n; k++)
        memcpy(&column[k], (const char *)field->data + 8 * (c * all + at[own[k]]), 8);
      memcpy((char *)field->data + 8 * c * n, column, (size_t)n * 8);
    }
    field->rows = n;
  }
  MPSI_FREE(context, at, column);
  if (status == MPS_OK) values->particles = n;
  return status;
}

/* `before`: rows of the body on lower ranks, and on all. */
static mps_status take_rows(const mps_dynamics *dynamics, const char *function, mpsi_value *value,
                            const int64_t before[2]) {
  const int64_t row = value->columns * mpsi_state_size(value->type);
  const int64_t body = body_rows(dynamics, value);
  const int64_t own =
      strcmp(value->name, "held_values") == 0 ? dynamics->bounds : dynamics->dashpots;
  char *data = value->data;
  if (value->rows != before[1] + own - body) return misfit(dynamics, function, value->name);
  memmove(data, data + before[0] * row, (size_t)(body * row));
  memmove(data + body * row, data + before[1] * row, (size_t)((own - body) * row));
  value->rows = own;
  return MPS_OK;
}

mps_status mpsi_dynamics_take_values(void *solver, const char *function, mps_status status,
                                     mps_snapshot *values) {
  mps_dynamics *dynamics = solver;
  mps_domain *domain = dynamics->domain;
  const int32_t rank = mps_domain_rank(domain);
  if (!mpsi_domain_many(domain)) return status;
  if (status == MPS_OK) status = take_fields(dynamics, function, values);
  status = mpsi_domain_agree_moment(domain, function, status, values);
  for (int32_t k = 0; status == MPS_OK && k < values->state.count; k++) {
    mpsi_value *value = &values->state.item[k];
    const merging how = merging_of(value);
    if (how == SUM && rank > 0) memset(value->data, 0, (size_t)(value->rows * value->columns) * 8);
    if (how == COUNT) {
      int64_t all = mpsi_dynamics_counted(dynamics, part_of(dynamics, value->name)),
              *kept = value->data;
      status = mpsi_domain_sum(domain, function, 1, &all);
      if (status == MPS_OK && all != *kept) status = misfit(dynamics, function, value->name);
      *kept = part_of(dynamics, value->name)->count;
    }
    if (how != ROWS) continue;
    int64_t before[2];
    status = mpsi_domain_count(domain, function, body_rows(dynamics, value), &before[0], &before[1]);
    if (status == MPS_OK) status = take_rows(dynamics, function, value, before);
    status = mpsi_domain_agree(domain, function, status);
  }
  return status;
}
