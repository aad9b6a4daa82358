/* deal.c - sends the particles of a set in parts to the ranks of their blocks of cells, before the
 * solver adds its own fields: only the caller's fields are sent.
 *
 * Each rank finds the blocks of its part. All ranks receive the blocks of all with their numbers of
 * particles, from which each finds the same orientation of the curve; the curve is cut by the
 * numbers of each (owners.c). Beyond MOST_BLOCKS the list itself would be large: the curve is then
 * laid over the bounds of all blocks. Results do not depend on the owners.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/particles/mpm_particles.h"
#include "mpm/particles/rooms.h"
#include "mpm/ranks/partition.h"

#include <stdlib.h>
#include <string.h>

#define MOST_BLOCKS (INT64_C(1) << 20)

static mpsi_placed *list_own(mps_context *context, const mpsi_grid *grid) {
  const int64_t blocks = grid->cell_count;
  mpsi_placed *list = mpsi_alloc(context, blocks, sizeof *list);
  for (int64_t b = 0; list && b < blocks; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    list[b].particles = cells->end - cells->begin;
    memcpy(list[b].at, cells->at, sizeof list[b].at);
  }
  return list;
}

/* Joins the blocks of all ranks in one list, in order, each once. */
static mpsi_placed *join_lists(mps_context *context, const mpsi_mailbox *box, int64_t *blocks) {
  int64_t count = 0, kept = 0;
  for (int32_t m = 0; m < box->count; m++)
    count += box->mail[m].bytes / (int64_t)sizeof(mpsi_placed);
  mpsi_placed *list = mpsi_alloc(context, count, sizeof *list);
  if (!list) return NULL;
  char *to = (char *)list;
  for (int32_t m = 0; m < box->count; to += box->mail[m++].bytes)
    memcpy(to, box->mail[m].data, (size_t)box->mail[m].bytes);
  qsort(list, (size_t)count, sizeof *list, mpsi_compare_blocks);
  for (int64_t k = 0; k < count; k++)
    if (kept > 0 && mpsi_compare_blocks(&list[kept - 1], &list[k]) == 0)
      list[kept - 1].particles += list[k].particles;
    else
      list[kept++] = list[k];
  *blocks = kept;
  return list;
}

/* Orientation of the curve from the lists of all ranks. */
static mps_status place_by_list(mps_context *context, const mpsi_grid *grid,
                                mpsi_partition *partition, const char *function) {
  mps_domain *domain = partition->domain;
  const int32_t ranks = mps_domain_size(domain);
  mpsi_mailbox box = {.context = context};
  int64_t blocks = 0;
  mpsi_placed *own = list_own(context, grid), *all = NULL;
  mps_domain_message *message = mpsi_alloc(context, ranks, sizeof *message);
  mps_status status = MPS_OK;
  if (!own || !message)
    status = mpsi_fail_memory(context, function, (size_t)grid->cell_count * sizeof *own);
  for (int32_t r = 0; status == MPS_OK && r < ranks; r++)
    message[r] = (mps_domain_message){
        .rank = r, .bytes = grid->cell_count * (int64_t)sizeof *own, .data = own};
  status = mpsi_domain_agree(domain, function, status);
  if (status == MPS_OK) status = mpsi_domain_exchange(domain, function, ranks, message, &box);
  if (status == MPS_OK && (!(all = join_lists(context, &box, &blocks)) ||
                           !mpsi_mpm_choose_orientation(context, grid->dim, ranks, blocks, all,
                                                        &partition->orientation)))
    status = mpsi_fail_memory(context, function, (size_t)blocks * sizeof *all);
  mpsi_domain_free_mail(&box);
  MPSI_FREE(context, own, all, message);
  return mpsi_domain_agree(domain, function, status);
}

/* Orientation of the curve over the first and the last block along each axis. */
static mps_status place_by_bounds(mps_context *context, const mpsi_grid *grid,
                                  mpsi_partition *partition, const char *function) {
  double bound[6];
  for (int k = 0; k < 6; k++) bound[k] = -INFINITY;
  for (int64_t b = 0; b < grid->cell_count; b++)
    for (int c = 0; c < 3; c++) {
      const double at = grid->cells[b].at[c];
      bound[c] = fmax(bound[c], -at), bound[3 + c] = fmax(bound[3 + c], at);
    }
  mps_status status = mpsi_domain_max(partition->domain, function, 6, bound);
  if (status != MPS_OK) return status;
  mpsi_placed corner[2] = {{.particles = 1}, {.particles = 1}};
  for (int c = 0; c < 3; c++)
    corner[0].at[c] = (int32_t)-bound[c], corner[1].at[c] = (int32_t)bound[3 + c];
  if (!mpsi_mpm_choose_orientation(context, grid->dim, 1, 2, corner, &partition->orientation))
    status = mpsi_fail_memory(context, function, sizeof corner);
  return mpsi_domain_agree(partition->domain, function, status);
}

static mps_status find_blocks(const mpsi_rank_part *part, const char *function) {
  mpsi_mpm_bind(part->grid, part->p, part->water);
  part->p->laws.ids = mpsi_particles_integers(part->p->set, "id"); /* laws are added later */
  part->grid->worker_count = mps_context_threads(part->context);
  MPSI_TRY(mpsi_mpm_check_start(part->context, part->grid, part->p, part->def, function));
  if (!mpsi_mpm_make_room(part->context, part->grid, part->p, part->rooms, part->p->count))
    return mpsi_fail_memory(part->context, function,
                            (size_t)part->p->count * 2 * sizeof *part->grid->radix);
  return mpsi_mpm_sort_cells(part->context, part->grid, part->p, part->run, function);
}

/* Reduces the memory of fields and solver to what is needed. */
static mps_status fit(const mpsi_rank_part *part, const char *function) {
  const mps_status status = mpsi_particles_fit(part->p->set, function);
  mpsi_mpm_bind(part->grid, part->p, part->water);
  if (status != MPS_OK ||
      mpsi_mpm_shrink_room(part->context, part->grid, part->p, part->rooms, part->p->count))
    return status;
  return mpsi_fail_memory(part->context, function,
                          (size_t)part->p->count * 2 * sizeof *part->grid->radix);
}

mps_status mpsi_mpm_share_deal(const mpsi_rank_part *part, const char *function) {
  bool moved;
  int64_t blocks;
  MPSI_TRY(mpsi_domain_agree(part->partition->domain, function, find_blocks(part, function)));
  blocks = part->grid->cell_count;
  mps_status status = mpsi_domain_sum(part->partition->domain, function, 1, &blocks);
  if (status == MPS_OK)
    status = blocks <= MOST_BLOCKS
                 ? place_by_list(part->context, part->grid, part->partition, function)
                 : place_by_bounds(part->context, part->grid, part->partition, function);
  if (status == MPS_OK) status = mpsi_mpm_partition_migrate(part, function, status, &moved);
  return status == MPS_OK
             ? mpsi_domain_agree(part->partition->domain, function, fit(part, function))
             : status;
}
