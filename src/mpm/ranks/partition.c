/* partition.c - blocks of cells of a rank, and its ghosts: see partition.h.
 *
 * All ranks begin with the same set, sort it in the same way and keep their own blocks of it.
 * Ghosts are found from the blocks that exist: each rank sends the list of its blocks to the ranks
 * whose blocks may be beside them. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/particles/mpm_particles.h"
#include "block_range.h"
#include "parcels.h"

#include <string.h>

/* ---- ghosts ---------------------------------------------------------------------------------- */

/* A block as it is sent to another rank. */
typedef struct notice {
  int32_t number; /* index among its owner's blocks */
  int32_t at[3], low[3], high[3];
} notice;

/* Search for ghosts. */
typedef struct search {
  const mpsi_rank_part *part;
  const char *function;
  mpsi_cell_block *own; /* own blocks in order */
  int64_t count;
  int64_t *range; /* of the blocks of each rank (block_range.h) */
  notice *sent;   /* blocks sent, rank by rank */
  mps_domain_message *message;
  mpsi_mailbox box;
  notice *ghost; /* ghosts in the order of their owners */
  int32_t *rank;
  int64_t *index;
  int64_t ghosts;
} search;

static bool is_own(const search *s, const int32_t *at) {
  int64_t low = 0, high = s->count;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (mpsi_block_before(s->own[middle].at, at))
      low = middle + 1;
    else
      high = middle;
  }
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
  const int64_t ranks = mps_domain_size(s->part->partition->domain);
  s->own = mpsi_alloc(context, grid->cell_count, sizeof *s->own);
  s->range = mpsi_alloc(context, MPSI_BLOCK_RANGE * ranks, sizeof *s->range);
  if (!s->own || !s->range)
    return mpsi_fail_memory(context, s->function, (size_t)grid->cell_count * sizeof *s->own);
  for (int64_t b = 0; b < grid->cell_count; b++)
    if (!grid->cells[b].ghost) s->own[s->count++] = grid->cells[b];
  int64_t *mine = s->range + MPSI_BLOCK_RANGE * mps_domain_rank(s->part->partition->domain);
  memset(s->range, 0, (size_t)(MPSI_BLOCK_RANGE * ranks) * sizeof *s->range);
  for (int64_t b = 0; b < s->count; b++) mpsi_block_range_add(mine, s->own[b].at);
  return MPS_OK;
}

static bool is_sent(const search *s, int32_t rank, int64_t b) {
  return rank != mps_domain_rank(s->part->partition->domain) &&
         mpsi_block_range_near(s->range + MPSI_BLOCK_RANGE * rank, s->own[b].at);
}

static mps_status exchange_search(search *s) {
  mps_context *context = s->part->context;
  mps_domain *domain = s->part->partition->domain;
  const int32_t ranks = mps_domain_size(domain);
  int64_t notices = 0;
  int32_t messages = 0;
  for (int32_t r = 0; r < ranks; r++)
    for (int64_t b = 0; b < s->count; b++) notices += is_sent(s, r, b);
  s->sent = mpsi_alloc(context, notices, sizeof *s->sent);
  s->message = mpsi_alloc(context, ranks, sizeof *s->message);
  mps_status status = MPS_OK;
  if (!s->sent || !s->message)
    status = mpsi_fail_memory(context, s->function, (size_t)notices * sizeof *s->sent);
  notices = 0;
  for (int32_t r = 0; status == MPS_OK && r < ranks; r++) {
    const int64_t first = notices;
    for (int64_t b = 0; b < s->count; b++) {
      if (!is_sent(s, r, b)) continue;
      notice *n = &s->sent[notices++];
      n->number = (int32_t)b;
      memcpy(n->at, s->own[b].at, sizeof n->at);
      memcpy(n->low, s->own[b].low, sizeof n->low);
      memcpy(n->high, s->own[b].high, sizeof n->high);
    }
    if (notices > first)
      s->message[messages++] =
          (mps_domain_message){.rank = r,
                               .bytes = (notices - first) * (int64_t)sizeof *s->sent,
                               .data = s->sent + first};
  }
  status = mpsi_domain_agree(domain, s->function, status);
  if (status != MPS_OK) return status;
  return mpsi_domain_exchange(domain, s->function, messages, s->message, &s->box);
}

static mps_status choose_ghosts(search *s) {
  mps_context *context = s->part->context;
  int64_t most = 0;
  for (int32_t m = 0; m < s->box.count; m++)
    most += s->box.mail[m].bytes / (int64_t)sizeof *s->ghost;
  s->ghost = mpsi_alloc(context, most, sizeof *s->ghost);
  s->rank = mpsi_alloc(context, most, sizeof *s->rank);
  s->index = mpsi_alloc(context, most, sizeof *s->index);
  if (!s->ghost || !s->rank || !s->index)
    return mpsi_fail_memory(context, s->function, (size_t)most * sizeof *s->ghost);
  for (int32_t m = 0; m < s->box.count; m++) {
    const notice *from = s->box.mail[m].data;
    for (int64_t k = 0; k < s->box.mail[m].bytes / (int64_t)sizeof *from; k++) {
      if (!beside_own(s, from[k].at)) continue;
      s->ghost[s->ghosts] = from[k];
      s->rank[s->ghosts] = s->box.mail[m].rank;
      s->index[s->ghosts++] = from[k].number;
    }
  }
  return MPS_OK;
}

/* ---- lists ----------------------------------------------------------------------------------- */

/* Sorts the ghosts in the order of blocks. */
static void sort_ghosts(const search *s, int64_t *order, int64_t *other) {
  for (int64_t k = 0; k < s->ghosts; k++) order[k] = k;
  for (int64_t width = 1; width < s->ghosts; width *= 2) {
    for (int64_t begin = 0; begin < s->ghosts; begin += 2 * width) {
      const int64_t middle = begin + width < s->ghosts ? begin + width : s->ghosts;
      const int64_t end = middle + width < s->ghosts ? middle + width : s->ghosts;
      int64_t a = begin, b = middle;
      for (int64_t k = begin; k < end; k++)
        other[k] = b >= end || (a < middle &&
                                !mpsi_block_before(s->ghost[order[b]].at, s->ghost[order[a]].at))
                       ? order[a++]
                       : order[b++];
    }
    memcpy(order, other, (size_t)s->ghosts * sizeof *order);
  }
}

/* Merges own blocks and ghosts in one list; `place`: index of each own block in it. */
static void merge(const search *s, const int64_t *order, int32_t *place) {
  mpsi_cell_block *cells = s->part->grid->cells;
  int64_t own = 0, ghost = 0;
  for (int64_t b = 0; b < s->count + s->ghosts; b++) {
    const notice *next = ghost < s->ghosts ? &s->ghost[order[ghost]] : NULL;
    if (own < s->count && (!next || mpsi_block_before(s->own[own].at, next->at))) {
      cells[b] = s->own[own];
      cells[b].parcel = -1;
      cells[b].waits = cells[b].first = 0;
      place[own++] = (int32_t)b;
      continue;
    }
    const int64_t begin = own < s->count ? s->own[own].begin : s->part->p->count;
    cells[b] = (mpsi_cell_block){
        .begin = begin, .end = begin, .bad = -1, .ghost = true, .parcel = order[ghost++]};
    memcpy(cells[b].at, next->at, sizeof next->at);
    memcpy(cells[b].low, next->low, sizeof next->low);
    memcpy(cells[b].high, next->high, sizeof next->high);
  }
}

static bool put_lists(search *s) {
  const mpsi_rank_part *part = s->part;
  mpsi_partition *partition = part->partition;
  const int64_t all = s->count + s->ghosts;
  int64_t *order = mpsi_alloc(part->context, 2 * s->ghosts, sizeof *order);
  int32_t *place = mpsi_alloc(part->context, s->count, sizeof *place);
  bool good = order && place && mpsi_mpm_ensure_cells(part->context, part->grid, all) &&
              mpsi_room_ensure(part->context, &partition->border_room, s->count,
                               sizeof *partition->border) &&
              mpsi_room_ensure(part->context, &partition->rank_room, s->ghosts, sizeof *s->rank);
  if (good) {
    partition->border = partition->border_room.item;
    partition->ghost_rank = partition->rank_room.item;
    if (s->ghosts > 0) memcpy(partition->ghost_rank, s->rank, (size_t)s->ghosts * sizeof *s->rank);
    sort_ghosts(s, order, order + s->ghosts);
    merge(s, order, place);
    for (int64_t k = 0; k < s->count; k++) partition->border[k] = place[k];
    partition->ghosts = s->ghosts;
    good = mpsi_mpm_build_nodes(part->context, part->grid, all);
  }
  mpsi_free(part->context, order);
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

/* Own blocks requested by other ranks; memory for parcels. */
static mps_status find_border(const mpsi_rank_part *part, const char *function) {
  mpsi_partition *partition = part->partition;
  const int64_t *item;
  partition->borders = mpsi_halo_items(partition->halo, &item);
  for (int64_t k = 0; k < partition->borders;
       k++) { /* item[k] >= k: no entry is overwritten before it is read */
    partition->border[k] = partition->border[item[k]];
    part->grid->cells[partition->border[k]].parcel = k;
  }
  return mpsi_mpm_reserve_parcels(part->context, part->contact, part->partition, function);
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

static mps_status join(search *s) {
  const mpsi_rank_part *part = s->part;
  mpsi_partition *partition = part->partition;
  double most = widest(s);
  mps_status status = choose_ghosts(s);
  if (status == MPS_OK && !put_lists(s))
    status = mpsi_fail_memory(part->context, s->function,
                              (size_t)(s->count + s->ghosts) * sizeof *part->grid->cells);
  status = mpsi_domain_agree_max(partition->domain, s->function, status, 1, &most);
  if (status != MPS_OK) return status;
  partition->most = (int32_t)most;
  mark_blocks(part->grid);
  mpsi_halo_destroy(part->context, &partition->halo);
  const mpsi_halo_def def = {.guests = s->ghosts, .rank = s->rank, .index = s->index};
  status = mpsi_halo_create(partition->domain, s->function, &def, &partition->halo);
  if (status != MPS_OK) return status;
  return mpsi_domain_agree(partition->domain, s->function, find_border(part, s->function));
}

mps_status mpsi_mpm_partition_find_ghosts(const mpsi_rank_part *part, const char *function) {
  mpsi_partition *partition = part->partition;
  if (!partition->outdated) return MPS_OK;
  search s = {.part = part, .function = function, .box.context = part->context};
  mps_status status = mpsi_domain_agree(partition->domain, function, copy_own(&s));
  if (status == MPS_OK)
    status = mpsi_domain_sum(partition->domain, function,
                             MPSI_BLOCK_RANGE * mps_domain_size(partition->domain), s.range);
  if (status == MPS_OK) status = exchange_search(&s);
  if (status == MPS_OK) status = join(&s);
  mpsi_domain_free_mail(&s.box);
  void *parts[] = {s.own, s.range, s.sent, s.message, s.ghost, s.rank, s.index};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(part->context, parts[k]);
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
static mps_status compare_ranks(const mpsi_grid *grid, const mpsi_columns *p, const mps_mpm_def *d,
                                const char *function, mps_status status) {
  mpsi_given given;
  mpsi_given_begin(&given);
  MPSI_GIVE(&given, d, geometry);
  MPSI_GIVE(&given, d, spline);
  MPSI_GIVE(&given, d, volumetric);
  MPSI_GIVE(&given, d, step_from);
  MPSI_GIVE(&given, d, budget);
  MPSI_GIVE(&given, d, walls);
  MPSI_GIVE(&given, d, measure);
  MPSI_GIVE(&given, d, local_damping);
  MPSI_GIVE(&given, d, viscous_damping);
  MPSI_GIVE(&given, d, flip_time);
  MPSI_GIVE(&given, d, cell);
  MPSI_GIVE(&given, d, dt);
  MPSI_GIVE(&given, d, courant);
  mpsi_give(&given, "having a kernel", d->kernel != NULL);
  MPSI_GIVE_VECTOR(&given, d, origin, grid->dim);
  MPSI_GIVE_VECTOR(&given, d, gravity, grid->dim);
  MPSI_GIVE_VECTOR(&given, d, lower, grid->dim);
  MPSI_GIVE_VECTOR(&given, d, upper, grid->dim);
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
  mps_status status = compare_ranks(part->grid, part->p, part->def, function, MPS_OK);
  if (status == MPS_OK)
    status = mpsi_mpm_partition_cut(part->context, part->grid, part->partition, function, true);
  if (status == MPS_OK)
    status = mpsi_domain_agree(domain, function, keep_own(part, function, former));
  return status == MPS_OK ? mpsi_mpm_partition_find_ghosts(part, function) : status;
}

mps_status mpsi_mpm_share_take_part(const mpsi_rank_part *part, const char *function,
                                    mps_status status) {
  status = compare_ranks(part->grid, part->p, part->def, function, status);
  return status == MPS_OK ? mpsi_mpm_partition_find_ghosts(part, function) : status;
}

void mpsi_mpm_partition_free(mps_context *context, mpsi_partition **pointer) {
  mpsi_partition *partition = *pointer;
  if (!partition) return;
  *pointer = NULL;
  mpsi_halo_destroy(context, &partition->halo);
  mpsi_free(context, partition->first);
  mpsi_free(context, partition->border_room.item);
  mpsi_free(context, partition->rank_room.item);
  mpsi_free(context, partition->out_room.item);
  mpsi_free(context, partition->in_room.item);
  mps_domain_destroy(&partition->domain);
  mpsi_free(context, partition);
}
