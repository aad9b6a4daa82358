/* rank_files.c - checkpoints of a body on several ranks. Rank 0 writes the file that the run
 * without a domain would write: particles and blocks in the order of one rank, sums over all ranks.
 * Each rank reads the whole file and keeps its own part, so that a run continues on any number of
 * ranks, or without a domain. SPDX-License-Identifier: BSD-3-Clause */
#include "rank_files.h"

#include <stdlib.h>
#include <string.h>

/* Relation of the values of a rank to those of the file. */
typedef enum merging {
  SAME,   /* equal on all ranks */
  EXACT,  /* limbs of exact sums, added over the ranks; rank 0 alone restores them */
  COUNT,  /* whole numbers, likewise */
  SIZES,  /* sizes of memory, which a rank finds by itself */
  BLOCKS, /* blocks of cells */
  DASHES  /* dashpots of blocks of nodes */
} merging;

static merging merging_of(const mpsi_value *value) {
  const char *name = value->name;
  if (value->agrees || value->optional) return SAME;
  if (strcmp(name, "sizes") == 0) return SIZES;
  if (strcmp(name, "blocks") == 0) return BLOCKS;
  if (strcmp(name, "dashpots") == 0) return DASHES;
  if (strcmp(name, "boundaries_work") == 0 || strcmp(name, "energies") == 0 ||
      strncmp(name, "water/", 6) == 0)
    return EXACT;
  if (strncmp(name, "boundary", 8) != 0) return SAME;
  if (mpsi_state_name_ends(name, "/step") || mpsi_state_name_ends(name, "/all")) return EXACT;
  return mpsi_state_name_ends(name, "/count") || mpsi_state_name_ends(name, "/removed") ? COUNT
                                                                                        : SAME;
}

/* ---- writing --------------------------------------------------------------------------------- */

static int by_place(const void *left, const void *right) {
  const int64_t *a = left, *b = right;
  for (int c = 2; c >= 0; c--)
    if (a[MPSI_BLOCK_AT + c] != b[MPSI_BLOCK_AT + c])
      return a[MPSI_BLOCK_AT + c] < b[MPSI_BLOCK_AT + c] ? -1 : 1;
  return 0;
}

/* Gathers the blocks of all ranks in order; during the exchange they have the number of particles
 * in place of the index of the first. */
static mps_status gather_blocks(const mpsi_columns *p, mpsi_partition *partition,
                                const char *function, mpsi_value *value) {
  mpsi_block *block = value->data;
  for (int64_t k = 0; k < value->rows; k++)
    block[k][0] = (k + 1 < value->rows ? block[k + 1][0] : p->count) - block[k][0];
  const mps_status status =
      mpsi_domain_gather_rows(partition->domain, function, value->rows, value);
  if (status != MPS_OK || mps_domain_rank(partition->domain) > 0) return status;
  block = value->data;
  qsort(block, (size_t)value->rows, sizeof *block, by_place);
  int64_t begin = 0;
  for (int64_t k = 0; k < value->rows; k++) {
    const int64_t count = block[k][0];
    block[k][0] = begin;
    begin += count;
  }
  return MPS_OK;
}

static mps_status merge(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                        const mpsi_boundaries *boundaries, mpsi_partition *partition,
                        const char *function, mpsi_values *state) {
  mps_domain *domain = partition->domain;
  mps_status status = MPS_OK;
  for (int32_t k = 0; k < state->count && status == MPS_OK; k++) {
    mpsi_value *value = &state->item[k];
    const int32_t numbers = (int32_t)(value->rows * value->columns);
    switch (merging_of(value)) {
    case SAME:
      break;
    case EXACT:
      status = mpsi_domain_sum_exact(domain, function, numbers / MPSI_EXACT_LIMBS, value->data);
      break;
    case COUNT:
    case SIZES:
      status = mpsi_domain_sum(domain, function, numbers, value->data);
      break;
    case BLOCKS:
      status = gather_blocks(p, partition, function, value);
      break;
    case DASHES:
      status = mpsi_mpm_gather_dashpots(context, grid, boundaries, partition, function, value);
      break;
    }
  }
  return status;
}

mps_status mpsi_mpm_save_on_ranks(mps_mpm *mpm, const mpsi_state_of *of, const char *function,
                                  const char *path, const mps_checkpoint *info) {
  mps_domain *domain = mpm->domain;
  mps_snapshot state = {.context = mpm->context};
  const mpsi_checkpoint_request request = {of, function, path, info, &state.state};
  mps_status status = MPS_OK;
  if (mpm->contact.bodies > 0)
    status =
        mpsi_mpm_share_warm_start(&mpm->contact.impulses, mpm->p.set, domain, function, status);
  if (mpm->prescribed.on)
    status = mpsi_mpm_share_warm_start(&mpm->prescribed.constraints.impulses, mpm->p.set, domain,
                                       function, status);
  mpsi_mpm_order_warm_start(&mpm->contact.impulses);
  mpsi_mpm_order_warm_start(&mpm->prescribed.constraints.impulses);
  if (status == MPS_OK)
    status = mpsi_domain_agree(domain, function, mpsi_state_get(of, function, &state));
  if (status == MPS_OK)
    status = merge(mpm->context, &mpm->grid, &mpm->p, &mpm->boundaries, mpm->partition, function,
                   &state.state);
  if (status == MPS_OK)
    status = mpsi_domain_write_rows(domain, function, mpm->p.set, mpsi_checkpoint_save_rows,
                                    (void *)&request);
  mpsi_values_free(mpm->context, &state.state);
  return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* Keeps the blocks of this rank and lists their rows of the file, in order; returns the number of
 * rows. */
static int64_t take_blocks(const mpsi_grid *grid, mpsi_partition *partition, mpsi_value *blocks,
                           int64_t particles, int64_t *rows) {
  mpsi_block *block = blocks->data;
  const int32_t rank = mps_domain_rank(partition->domain);
  int64_t target = 0, count = 0;
  for (int64_t b = 0; b < blocks->rows; b++) {
    const int64_t begin = block[b][0], end = b + 1 < blocks->rows ? block[b + 1][0] : particles;
    int32_t at[3];
    for (int c = 0; c < 3; c++) at[c] = (int32_t)block[b][MPSI_BLOCK_AT + c];
    if (mpsi_mpm_block_owner(grid, partition, at) != rank) continue;
    memmove(block[target], block[b], sizeof *block); /* target <= b */
    block[target++][0] = count;
    for (int64_t k = begin; k < end; k++) rows[count++] = k;
  }
  blocks->rows = target;
  return count;
}

/* Keeps the rows of this rank. rows[k] >= k: no row is overwritten before it is read, and no column
 * reaches the next. */
static void take_fields(mps_snapshot *values, const int64_t *rows, int64_t count) {
  const int64_t all = values->particles;
  for (int32_t f = 0; f < values->fields.count; f++) {
    mpsi_value *field = &values->fields.item[f];
    int64_t *data = field->data;
    for (int32_t c = 0; c < field->columns; c++)
      for (int64_t k = 0; k < count; k++) data[c * count + k] = data[c * all + rows[k]];
    field->rows = count;
  }
  values->particles = count;
}

static void take_values(mpsi_partition *partition, mpsi_values *state) {
  const bool first = mps_domain_rank(partition->domain) == 0;
  for (int32_t k = 0; k < state->count; k++) {
    mpsi_value *value = &state->item[k];
    const merging how = merging_of(value);
    const bool sums = how == EXACT || how == COUNT;
    if (how == SIZES || (sums && !first))
      memset(value->data, 0, (size_t)(value->rows * value->columns) * sizeof(int64_t));
  }
}

mps_status mpsi_mpm_restore_on_ranks(void *solver, const char *function, mps_status status,
                                     mps_snapshot *values) {
  mps_mpm *mpm = solver;
  if (!mpm->partition) return status;
  int64_t *rows = NULL;
  if (status == MPS_OK) {
    rows = mpsi_alloc(mpm->context, values->particles, sizeof *rows);
    if (!rows)
      status = mpsi_fail_memory(mpm->context, function, (size_t)values->particles * sizeof *rows);
  }
  if (status == MPS_OK)
    status = mpsi_mpm_take_dashpots(mpm->context, &mpm->grid, &mpm->boundaries, mpm->partition,
                                    function, mpsi_values_find(&values->state, "blocks"),
                                    (mpsi_value *)mpsi_values_find(&values->state, "dashpots"));
  status = mpsi_domain_agree(mpm->domain, function, status);
  if (status == MPS_OK) {
    mpsi_value *blocks = (mpsi_value *)mpsi_values_find(&values->state, "blocks");
    const int64_t count = take_blocks(&mpm->grid, mpm->partition, blocks, values->particles, rows);
    take_fields(values, rows, count);
    take_values(mpm->partition, &values->state);
    mpm->partition->heaviest = 0.0; /* the curve is cut again at the next sort */
  }
  mpsi_free(mpm->context, rows);
  return status;
}
