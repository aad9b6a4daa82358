/* halo.c - see halo.h. SPDX-License-Identifier: BSD-3-Clause */
#include "halo.h"

#include "core/base/room_array.h"
#include "mpm/ranks/messages.h"
#include "mpm/ranks/notices.h"

#include <string.h>

/* ---- which layers ---------------------------------------------------------------------------- */

/* Search for layers. */
typedef struct search {
  const mps_mpm *mpm;
  const char *function;
  mpsi_notice *list;
  int64_t found; /* in the list */
  int32_t *rank; /* of each guest */
  int64_t *index;
} search;

mps_status mpsi_pore_find_notices(const mps_mpm *mpm, const char *function, mpsi_notice **list,
                                  int64_t *found) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_notice *own = mpsi_alloc(mpm->context, grid->node_count, sizeof *own);
  mpsi_block_range computed = {0};
  int64_t count = 0;
  mps_status status = MPS_OK;
  if (!own)
    status = mpsi_fail_memory(mpm->context, function, (size_t)grid->node_count * sizeof *own);
  for (int64_t g = 0; own && g < grid->node_count; g++) {
    if (grid->nodes[g].foreign) continue;
    mpsi_mpm_add_to_range(computed, grid->nodes[g].at);
    if (!mpsi_mpm_counts_node_block(grid, g)) continue;
    own[count] = (mpsi_notice){.number = (int32_t)g};
    memcpy(own[count++].at, grid->nodes[g].at, sizeof own->at);
  }
  status = mpsi_mpm_exchange_notices(mpm->context, mpm->domain, function, status, computed, count,
                                     own, list, found);
  mpsi_free(mpm->context, own);
  return status;
}

/* Whether the rank computes the cells on the other side of the block's face `direction`. */
static bool is_at_face(const mpsi_grid *grid, const int32_t *at, int direction) {
  int32_t beside[3] = {at[0], at[1], at[2]};
  beside[direction / 2] += direction & 1 ? 1 : -1;
  return mpsi_pore_own_block(grid, beside) >= 0;
}

static bool make_room(search *s, mpsi_pore_halo *halo) {
  mps_context *context = s->mpm->context;
  const int64_t most = s->found;
  s->rank = mpsi_alloc(context, 6 * most, sizeof *s->rank);
  s->index = mpsi_alloc(context, 6 * most, sizeof *s->index);
  const bool good = s->rank && s->index && MPSI_ENSURE(context, halo, block, 6 * most) &&
                    MPSI_ENSURE(context, halo, direction, 6 * most) &&
                    MPSI_ENSURE(context, halo, at, most);
  return good;
}

static mps_status choose(search *s, mpsi_pore_halo *halo) {
  const mpsi_grid *grid = &s->mpm->grid;
  if (!make_room(s, halo)) return mpsi_fail_memory(s->mpm->context, s->function, 24);
  for (const mpsi_notice *from = s->list; from < s->list + s->found; from++) {
    const int64_t before = halo->guests;
    if (mpsi_pore_own_block(grid, from->at) >= 0) continue;
    for (int d = 0; d < 2 * grid->dim; d++) {
      if (!is_at_face(grid, from->at, d)) continue;
      s->rank[halo->guests] = from->rank;
      s->index[halo->guests] = 6 * (int64_t)from->number + d;
      halo->block[halo->guests] = (int32_t)(grid->node_count + halo->blocks);
      halo->direction[halo->guests++] = (int8_t)d;
    }
    if (halo->guests > before) memcpy(halo->at[halo->blocks++], from->at, sizeof from->at);
  }
  return MPS_OK;
}

int32_t mpsi_pore_guest_block(const mpsi_grid *grid, const mpsi_water *water, const int32_t *at) {
  for (int64_t k = 0; k < water->halo->blocks; k++)
    if (memcmp(water->halo->at[k], at, sizeof water->halo->at[k]) == 0)
      return (int32_t)(grid->node_count + k);
  return -1;
}

/* ---- memory ------------------------------------------------------------------------------------
 */

/* Of a cell of a layer. */
typedef struct layer_cell {
  double p, k, now;
  mpsi_pore_faces faces;
  uint8_t free;
  bool filled, full, inside, thin;
} layer_cell;

static int layer_cells(const mpsi_grid *grid) { return grid->block_nodes / MPSI_SIDE; }

/* Cell i of the layer of a block at its face `direction`. */
static int cell_of_layer(int direction, int i) {
  const int plane = direction & 1 ? MPSI_SIDE - 1 : 0;
  if (direction < 2) return MPSI_SIDE * i + plane;
  if (direction > 3) return MPSI_SIDE * MPSI_SIDE * plane + i;
  return i / MPSI_SIDE * MPSI_SIDE * MPSI_SIDE + plane * MPSI_SIDE + i % MPSI_SIDE;
}

static int64_t doubles_of(const mpsi_grid *grid, mpsi_pore_stage stage) {
  _Static_assert(sizeof(layer_cell) % sizeof(double) == 0, "cells of a message");
  if (stage == MPSI_PORE_FILLED) return 1;
  return layer_cells(grid) *
         (stage == MPSI_PORE_NOW ? 1 : (int64_t)(sizeof(layer_cell) / sizeof(double)));
}

static mps_status reserve(const search *s, mpsi_pore_halo *halo) {
  const int64_t *item, layer = doubles_of(&s->mpm->grid, MPSI_PORE_EDGES);
  const int64_t out = mpsi_halo_items(halo->messages, &item) * layer, in = halo->guests * layer;
  if (!mpsi_room_ensure(s->mpm->context, &halo->out_room, out, sizeof(double)) ||
      !mpsi_room_ensure(s->mpm->context, &halo->in_room, in, sizeof(double)))
    return mpsi_fail_memory(s->mpm->context, s->function, (size_t)(out + in) * sizeof(double));
  return mpsi_mpm_reserve_messages(s->mpm->context, s->mpm->partition, s->function,
                                   mpsi_pore_sum_doubles(halo));
}

static double widest(const mps_mpm *mpm) {
  double most = 1.0;
  for (int64_t k = 0; k < mpm->partition->borders; k++) {
    int low[3], high[3];
    mpsi_pore_region(&mpm->grid, &mpm->grid.cells[mpm->partition->border[k]], low, high);
    double cells = 1.0;
    for (int c = 0; c < 3; c++) cells *= high[c] - low[c];
    most = fmax(most, cells);
  }
  return most;
}

static mps_status find(search *s, mpsi_pore_halo *halo) {
  mps_domain *domain = s->mpm->domain;
  double most = widest(s->mpm);
  mps_status status = mpsi_pore_find_notices(s->mpm, s->function, &s->list, &s->found);
  halo->guests = halo->blocks = 0;
  if (status == MPS_OK) status = choose(s, halo);
  MPSI_TRY(mpsi_domain_agree_max(domain, s->function, status, 1, &most));
  halo->most = (int64_t)most;
  const mpsi_halo_def def = {.guests = halo->guests, .rank = s->rank, .index = s->index};
  status = mpsi_halo_create(domain, s->function, &def, &halo->messages);
  return status == MPS_OK ? mpsi_domain_agree(domain, s->function, reserve(s, halo)) : status;
}

mps_status mpsi_pore_find_halo(mps_mpm *mpm, const char *function) {
  mpsi_pore_halo *halo = mpm->water->halo;
  search s = {.mpm = mpm, .function = function};
  mpsi_halo_destroy(mpm->context, &halo->messages);
  const mps_status status = find(&s, halo);
  if (status != MPS_OK) halo->guests = halo->blocks = 0;
  halo->searches = status == MPS_OK ? mpm->partition->searches : -1;
  MPSI_FREE(mpm->context, s.list, s.rank, s.index);
  return status;
}

void mpsi_pore_free_halo(mps_context *context, mpsi_pore_halo **pointer) {
  mpsi_pore_halo *halo = *pointer;
  *pointer = NULL;
  if (!halo) return;
  mpsi_halo_destroy(context, &halo->messages);
  MPSI_FREE(context, halo->block_room.item, halo->direction_room.item, halo->at_room.item,
            halo->out_room.item, halo->in_room.item, halo);
}

/* ---- layers ---------------------------------------------------------------------------------- */

static void pack_cell(mpsi_water *water, const mpsi_pore_block *block, const mpsi_pore_cell *cell,
                      int k, layer_cell *out) {
  memset(out, 0, sizeof *out);
  if (!mpsi_pore_marked(block->filled, k)) return;
  out->filled = true;
  out->full = mpsi_pore_marked(block->full, k);
  out->p = cell->p, out->k = cell->k;
  if (!water->flows) out->now = cell->now;
  out->free = cell->free, out->inside = cell->inside, out->thin = cell->thin;
  if (!cell->inside) out->faces = *mpsi_pore_faces_of(water, cell);
}

/* Exchange of the layers of a stage. */
typedef struct swap {
  mps_mpm *mpm;
  mpsi_pore_stage stage;
} swap;

static void pack_layer(void *data, int64_t item, double *out) {
  const mpsi_pore_stage stage = ((const swap *)data)->stage;
  const mpsi_grid *grid = &((const swap *)data)->mpm->grid;
  mpsi_water *water = ((const swap *)data)->mpm->water;
  const int64_t g = item / 6;
  const int direction = (int)(item % 6);
  const mpsi_pore_block *block = &water->block[g];
  uint64_t filled = 0;
  for (int i = 0; i < layer_cells(grid); i++) {
    const int k = cell_of_layer(direction, i);
    const mpsi_pore_cell *cell = water->cell + mpsi_first_node(grid, g) + k;
    const bool here = mpsi_pore_marked(block->filled, k);
    if (stage == MPSI_PORE_EDGES) pack_cell(water, block, cell, k, (layer_cell *)(void *)out + i);
    if (stage == MPSI_PORE_NOW) out[i] = here ? cell->now : 0.0;
    if (here) filled |= UINT64_C(1) << i;
  }
  if (stage == MPSI_PORE_FILLED) memcpy(out, &filled, sizeof filled);
}

static void unpack_cell(mpsi_water *water, mpsi_pore_block *block, mpsi_pore_cell *cell, int k,
                        const layer_cell *in) {
  if (!in->filled) return;
  if (in->full) mpsi_pore_mark(block->full, k);
  cell->p = in->p, cell->k = in->k, cell->now = in->now;
  cell->free = in->free, cell->inside = in->inside, cell->thin = in->thin;
  if (!in->inside) water->faces[cell - water->cell] = in->faces;
}

static void unpack_layer(void *data, int64_t guest, double *in) {
  const mpsi_pore_stage stage = ((const swap *)data)->stage;
  const mpsi_grid *grid = &((const swap *)data)->mpm->grid;
  mpsi_water *water = ((const swap *)data)->mpm->water;
  const int32_t g = water->halo->block[guest], direction = water->halo->direction[guest];
  mpsi_pore_block *block = &water->block[g];
  uint64_t filled = 0;
  if (stage == MPSI_PORE_FILLED) memcpy(&filled, in, sizeof filled);
  for (int i = 0; i < layer_cells(grid); i++) {
    const int k = cell_of_layer(direction, i);
    mpsi_pore_cell *cell = water->cell + mpsi_first_node(grid, g) + k;
    if (filled >> i & 1) mpsi_pore_mark(block->filled, k);
    if (stage == MPSI_PORE_EDGES)
      unpack_cell(water, block, cell, k, (const layer_cell *)(void *)in + i);
    if (stage == MPSI_PORE_NOW) cell->now = in[i];
  }
}

/* Before the marks of a step. */
static void clear_guests(const mpsi_grid *grid, mpsi_water *water) {
  for (int64_t k = 0; k < water->halo->blocks; k++) {
    mpsi_pore_block *block = &water->block[grid->node_count + k];
    memset(block->filled, 0, sizeof block->filled);
    memset(block->full, 0, sizeof block->full);
  }
}

void mpsi_pore_exchange(mps_mpm *mpm, mpsi_pore_stage stage) {
  if (!mpm->partition) return;
  const mpsi_pore_halo *halo = mpm->water->halo;
  double *const room[] = {halo->out_room.item, halo->in_room.item};
  swap s = {mpm, stage};
  if (stage == MPSI_PORE_FILLED) clear_guests(&mpm->grid, mpm->water);
  if (mpm->partition->lost == MPS_OK)
    mpm->partition->lost =
        mpsi_mpm_exchange_items(halo->messages, "mps_mpm_step", doubles_of(&mpm->grid, stage),
                                halo->guests, room, pack_layer, unpack_layer, &s);
}
