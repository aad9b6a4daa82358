/* partition.c - blocks of cells of a rank, and its ghosts: see partition.h.
 *
 * All ranks begin with the same set, sort it in the same way and keep their own blocks of it.
 * Ghosts are found from the blocks that exist: each rank sends the list of its blocks to the ranks
 * whose blocks may be beside them. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/particles/mpm_particles.h"
#include "core/base/order.h"
#include "core/base/room_array.h"
#include "messages.h"
#include "notices.h"
#include "mpm/contact/pairs.h"
#include "mpm/particles/rooms.h"

#include <stdlib.h>
#include <string.h>

/* ---- ghosts ---------------------------------------------------------------------------------- */

/* Search for ghosts. */
typedef struct search {
  const mpsi_rank_part *part;
  const char *function;
  mpsi_cell_block *own; /* own blocks in order */
  mpsi_notice *announced;
  int64_t count;
  mpsi_block_range range; /* of these */
  mpsi_notice *ghost;     /* in the order of their owners, then of blocks: `number` is then their
                             place in the former */
  int32_t *rank;
  int64_t *index;
  int64_t ghosts;
} search;

static bool is_own(const search *s, const int32_t *at) {
  int64_t low;
  MPSI_BISECT(low, s->count, middle, mpsi_block_before(s->own[middle].at, at));
  return low < s->count && memcmp(s->own[low].at, at, sizeof s->own[low].at) == 0;
}

static bool beside_own(const search *s, const int32_t *at) {
  const int depth = s->part->grid->dim == 3;
  for (int k = -depth; k <= depth; k++)
    for (int j = -1; j <= 1; j++)
      for (int i = -1; i <= 1; i++) {
        const int32_t beside[3] = {at[0] + i, at[1] + j, at[2] + k};
        if (is_own(s, beside)) return true;
      }
  return false;
}

/* Copies the own blocks, without the ghosts in the list. */
static mps_status copy_own(search *s) {
  const mpsi_grid *grid = s->part->grid;
  mps_context *context = s->part->context;
  s->own = mpsi_alloc(context, grid->cell_count, sizeof *s->own);
  s->announced = mpsi_alloc(context, grid->cell_count, sizeof *s->announced);
  if (!s->own || !s->announced)
    return mpsi_fail_memory(context, s->function, (size_t)grid->cell_count * sizeof *s->own);
  for (int64_t b = 0; b < grid->cell_count; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    mpsi_notice *notice = &s->announced[s->count];
    if (cells->ghost) continue;
    mpsi_mpm_add_to_range(s->range, cells->at);
    notice->number = (int32_t)s->count;
    memcpy(notice->at, cells->at, sizeof notice->at);
    memcpy(notice->low, cells->low, sizeof notice->low);
    memcpy(notice->high, cells->high, sizeof notice->high);
    s->own[s->count++] = *cells;
  }
  return MPS_OK;
}

/* Of the blocks announced, those beside own ones. */
static mps_status choose_ghosts(search *s, int64_t announced) {
  mps_context *context = s->part->context;
  s->rank = mpsi_alloc(context, announced, sizeof *s->rank);
  s->index = mpsi_alloc(context, announced, sizeof *s->index);
  if (!s->rank || !s->index)
    return mpsi_fail_memory(context, s->function, (size_t)announced * sizeof *s->index);
  for (int64_t k = 0; k < announced; k++) {
    if (!beside_own(s, s->ghost[k].at)) continue;
    s->ghost[s->ghosts] = s->ghost[k];
    s->rank[s->ghosts] = s->ghost[k].rank;
    s->index[s->ghosts++] = s->ghost[k].number;
  }
  return MPS_OK;
}

/* ---- lists ----------------------------------------------------------------------------------- */

static int compare_ghosts(const void *left, const void *right) {
  const mpsi_notice *a = left, *b = right;
  return mpsi_block_before(a->at, b->at) ? -1 : mpsi_block_before(b->at, a->at) ? 1 : 0;
}

static void sort_ghosts(const search *s) {
  for (int64_t k = 0; k < s->ghosts; k++) s->ghost[k].number = (int32_t)k;
  if (s->ghosts > 1) qsort(s->ghost, (size_t)s->ghosts, sizeof *s->ghost, compare_ghosts);
}

/* Merges own blocks and ghosts in one list; `place`: index of each own block in it. */
static void merge(const search *s, int32_t *place) {
  mpsi_cell_block *cells = s->part->grid->cells;
  int64_t own = 0, ghost = 0;
  for (int64_t b = 0; b < s->count + s->ghosts; b++) {
    const mpsi_notice *next = ghost < s->ghosts ? &s->ghost[ghost] : NULL;
    if (own < s->count && (!next || mpsi_block_before(s->own[own].at, next->at))) {
      cells[b] = s->own[own];
      cells[b].parcel = -1;
      cells[b].waits = cells[b].first = 0;
      place[own++] = (int32_t)b;
      continue;
    }
    const int64_t begin = own < s->count ? s->own[own].begin : s->part->p->count;
    cells[b] = (mpsi_cell_block){
        .begin = begin, .end = begin, .bad = -1, .ghost = true, .parcel = s->ghost[ghost++].number};
    memcpy(cells[b].at, next->at, sizeof next->at);
    memcpy(cells[b].low, next->low, sizeof next->low);
    memcpy(cells[b].high, next->high, sizeof next->high);
  }
}

static bool put_lists(search *s) {
  const mpsi_rank_part *part = s->part;
  mpsi_partition *partition = part->partition;
  const int64_t all = s->count + s->ghosts;
  int32_t *place = mpsi_alloc(part->context, s->count, sizeof *place);
  bool good = place && mpsi_mpm_ensure_cells(part->context, part->grid, all) &&
              MPSI_ENSURE(part->context, partition, border, s->count) &&
              mpsi_room_ensure(part->context, &partition->rank_room, s->ghosts, sizeof *s->rank);
  if (good) {
    partition->ghost_rank = partition->rank_room.item;
    if (s->ghosts > 0) memcpy(partition->ghost_rank, s->rank, (size_t)s->ghosts * sizeof *s->rank);
    sort_ghosts(s);
    merge(s, place);
    for (int64_t k = 0; k < s->count; k++) partition->border[k] = place[k];
    partition->ghosts = s->ghosts;
    good = mpsi_mpm_build_nodes(part->context, part->grid, all);
  }
  mpsi_free(part->context, place);
  return good;
}

/* Marks blocks of cells that add after a ghost, directly or not, and nodes to which such blocks
 * add: these wait for messages. */
static void mark_blocks(const mpsi_grid *grid) {
  for (int64_t b = 0; b < grid->cell_count; b++) grid->cells[b].late = grid->cells[b].ghost;
  for (int64_t k = 0; k < grid->cell_count; k++) {
    const mpsi_cell_block *cells = &grid->cells[grid->coloured[k]];
    for (int q = 0; cells->late && q < 1 << grid->dim; q++) {
      grid->nodes[cells->to[q]].late = true;
      if (cells->next[q] >= 0) grid->cells[cells->next[q]].late = true;
    }
  }
  for (int64_t g = 0; g < grid->node_count; g++)
    grid->nodes[g].foreign = !mpsi_mpm_node_block_complete(grid, g);
}

/* Own blocks requested by other ranks; memory for messages. */
static mps_status find_border(const mpsi_rank_part *part, const char *function) {
  mpsi_partition *partition = part->partition;
  const int64_t *item;
  partition->borders = mpsi_halo_items(partition->halo, &item);
  for (int64_t k = 0; k < partition->borders;
       k++) { /* item[k] >= k: no entry is overwritten before it is read */
    partition->border[k] = partition->border[item[k]];
    part->grid->cells[partition->border[k]].parcel = k;
  }
  return mpsi_mpm_reserve_messages(part->context, partition, function,
                                   mpsi_mpm_most_doubles(partition, part->contact));
}

static double widest(const search *s) {
  double most = 0.0;
  for (int64_t b = 0; b < s->count; b++) {
    double nodes = 1.0;
    for (int c = 0; c < 3; c++) nodes *= s->own[b].high[c] - s->own[b].low[c];
    most = fmax(most, nodes);
  }
  return most;
}

static mps_status join(search *s, mps_status status, int64_t announced) {
  const mpsi_rank_part *part = s->part;
  mpsi_partition *partition = part->partition;
  double most = status == MPS_OK ? widest(s) : 0.0;
  if (status == MPS_OK) status = choose_ghosts(s, announced);
  if (status == MPS_OK && !put_lists(s))
    status = mpsi_fail_memory(part->context, s->function,
                              (size_t)(s->count + s->ghosts) * sizeof *part->grid->cells);
  MPSI_TRY(mpsi_domain_agree_max(partition->domain, s->function, status, 1, &most));
  partition->most = (int32_t)most;
  mark_blocks(part->grid);
  mpsi_halo_destroy(part->context, &partition->halo);
  const mpsi_halo_def def = {.guests = s->ghosts, .rank = s->rank, .index = s->index};
  MPSI_TRY(mpsi_halo_create(partition->domain, s->function, &def, &partition->halo));
  return mpsi_domain_agree(partition->domain, s->function, find_border(part, s->function));
}

mps_status mpsi_mpm_partition_find_ghosts(const mpsi_rank_part *part, const char *function) {
  mpsi_partition *partition = part->partition;
  if (!partition->outdated) return MPS_OK;
  search s = {.part = part, .function = function};
  int64_t announced;
  mps_status status = copy_own(&s);
  status = mpsi_mpm_exchange_notices(part->context, partition->domain, function, status, s.range,
                                     s.count, s.announced, &s.ghost, &announced);
  status = join(&s, status, announced);
  MPSI_FREE(part->context, s.own, s.announced, s.ghost, s.rank, s.index);
  partition->outdated = status != MPS_OK;
  partition->searches++;
  if (partition->outdated) part->run->stale = true; /* the lists may have been freed */
  return status;
}

mps_status mpsi_mpm_partition_sort(const mpsi_rank_part *part, const char *function) {
  bool moved = false;
  part->partition->outdated = true;
  mps_status status = mpsi_mpm_sort_cells(part->context, part->grid, part->p, part->run, function);
  status = mpsi_mpm_partition_migrate(part, function, status, &moved);
  if (status != MPS_OK) {
    part->run->stale = true;
    return status;
  }
  if (moved) status = mpsi_mpm_sort_cells(part->context, part->grid, part->p, part->run, function);
  status = mpsi_domain_agree(part->partition->domain, function, status);
  if (status != MPS_OK) part->run->stale = true;
  return status == MPS_OK ? mpsi_mpm_partition_find_ghosts(part, function) : status;
}

/* ---- the first cut --------------------------------------------------------------------------- */

/* Lists the rows of own blocks, which are moved together. */
static int64_t take_blocks(mpsi_grid *grid, mpsi_partition *partition, int64_t *rows) {
  mpsi_cell_block *cells = grid->cells;
  const int32_t rank = mps_domain_rank(partition->domain);
  int64_t blocks = 0, count = 0;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    if (mpsi_mpm_block_owner(grid, partition, cells[b].at) != rank) continue;
    const int64_t begin = count;
    for (int64_t k = cells[b].begin; k < cells[b].end; k++) rows[count++] = k;
    cells[blocks] = cells[b];
    cells[blocks].begin = begin;
    cells[blocks++].end = count;
  }
  grid->cell_count = blocks;
  return count;
}

static mps_status keep_own(const mpsi_rank_part *part, const char *function,
                           mpsi_storage **former) {
  int64_t *rows = mpsi_alloc(part->context, part->p->count, sizeof *rows);
  if (!rows)
    return mpsi_fail_memory(part->context, function, (size_t)part->p->count * sizeof *rows);
  const int64_t count = take_blocks(part->grid, part->partition, rows);
  const mps_status status = mpsi_particles_keep(part->p->set, function, count, rows, count, former);
  mpsi_free(part->context, rows);
  if (status != MPS_OK) return status;
  mpsi_mpm_bind(part->grid, part->p, part->water);
  if (mpsi_mpm_shrink_room(part->context, part->grid, part->p, part->rooms, count)) return MPS_OK;
  return mpsi_fail_memory(part->context, function, (size_t)count * 2 * sizeof *part->grid->radix);
}

/* Checks that all ranks are given the same definition. */
static mps_status compare_ranks(const mpsi_columns *p, const mps_mpm_def *d, const char *function,
                                mps_status status) {
  mpsi_given given = MPSI_GIVEN;
  MPSI_GIVE_DEF(&given, mps_mpm_def, d);
  mpsi_give(&given, "having a kernel", d->kernel != NULL);
  if (status == MPS_OK) mpsi_material_give(&given, p->laws.law[0].material);
  status = mpsi_domain_agree_given(d->domain, function, status, &given);
  if (status != MPS_OK || mpsi_particles_deal(p->set)) return status;
  return mpsi_domain_agree_particles(d->domain, function, status, p->set);
}

mps_status mpsi_mpm_share_begin(mps_context *context, const mpsi_columns *p, mps_domain *domain,
                                const char *function, mps_status status, mpsi_partition **out) {
  mpsi_partition *partition = NULL;
  if (status == MPS_OK && !(partition = mpsi_alloc(context, 1, sizeof *partition)))
    status = mpsi_fail_memory(context, function, sizeof *partition);
  status = mpsi_domain_agree_parts(domain, function, status, p->set);
  if (status != MPS_OK) {
    mpsi_free(context, partition);
    return status;
  }
  *partition = (mpsi_partition){.domain = mpsi_domain_retain(domain), .outdated = true};
  *out = partition;
  return MPS_OK;
}

mps_status mpsi_mpm_partition_create(const mpsi_rank_part *part, const char *function,
                                     mpsi_storage **former) {
  mps_domain *domain = part->def->domain;
  mps_status status = compare_ranks(part->p, part->def, function, MPS_OK);
  if (status == MPS_OK)
    status = mpsi_mpm_partition_cut(part->context, part->grid, part->partition, function, true);
  if (status == MPS_OK)
    status = mpsi_domain_agree(domain, function, keep_own(part, function, former));
  return status == MPS_OK ? mpsi_mpm_partition_find_ghosts(part, function) : status;
}

mps_status mpsi_mpm_share_take_part(const mpsi_rank_part *part, const char *function,
                                    mps_status status) {
  status = compare_ranks(part->p, part->def, function, status);
  return status == MPS_OK ? mpsi_mpm_partition_find_ghosts(part, function) : status;
}

void mpsi_mpm_partition_free(mps_context *context, mpsi_partition **pointer) {
  mpsi_partition *partition = *pointer;
  if (!partition) return;
  *pointer = NULL;
  mpsi_halo_destroy(context, &partition->halo);
  MPSI_FREE(context, partition->first, partition->border_room.item, partition->rank_room.item,
            partition->out_room.item, partition->in_room.item);
  mps_domain_destroy(&partition->domain);
  mpsi_free(context, partition);
}
