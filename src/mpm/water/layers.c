/* layers.c - see layers.h. SPDX-License-Identifier: BSD-3-Clause */
#include "layers.h"

#include "notices.h"

#include <string.h>

static const char step[] = "mps_mpm_step";

/* ---- which layers ---------------------------------------------------------------------------- */

/* Search for layers. */
typedef struct search {
  const mps_mpm *mpm;
  const char *function;
  mpsi_pore_notices notices;
  int32_t *rank; /* of each guest */
  int64_t *index;
} search;

/* Whether the rank computes the cells on the other side of the block's face `direction`. */
static bool is_at_face(const mpsi_grid *grid, const int32_t *at, int direction) {
  int32_t beside[3] = {at[0], at[1], at[2]};
  beside[direction / 2] += direction & 1 ? 1 : -1;
  return mpsi_pore_own_block(grid, beside) >= 0;
}

static bool make_room(search *s, mpsi_pore_layers *layers) {
  mps_context *context = s->mpm->context;
  const int64_t most = mpsi_pore_count_notices(&s->notices);
  s->rank = mpsi_alloc(context, 6 * most, sizeof *s->rank);
  s->index = mpsi_alloc(context, 6 * most, sizeof *s->index);
  const bool good =
      s->rank && s->index &&
      mpsi_room_ensure(context, &layers->block_room, 6 * most, sizeof *layers->block) &&
      mpsi_room_ensure(context, &layers->direction_room, 6 * most, sizeof *layers->direction) &&
      mpsi_room_ensure(context, &layers->at_room, most, sizeof *layers->at);
  layers->block = layers->block_room.item;
  layers->direction = layers->direction_room.item;
  layers->at = layers->at_room.item;
  return good;
}

static mps_status choose(search *s, mpsi_pore_layers *layers) {
  const mpsi_grid *grid = &s->mpm->grid;
  if (!make_room(s, layers)) return mpsi_fail_memory(s->mpm->context, s->function, 24);
  const mpsi_mailbox *box = &s->notices.box;
  for (int32_t m = 0; m < box->count; m++) {
    const mpsi_pore_notice *from = box->mail[m].data;
    for (int64_t k = 0; k < box->mail[m].bytes / (int64_t)sizeof *from; k++) {
      const int64_t before = layers->guests;
      if (mpsi_pore_own_block(grid, from[k].at) >= 0) continue;
      for (int d = 0; d < 2 * grid->dim; d++) {
        if (!is_at_face(grid, from[k].at, d)) continue;
        s->rank[layers->guests] = box->mail[m].rank;
        s->index[layers->guests] = 6 * (int64_t)from[k].number + d;
        layers->block[layers->guests] = (int32_t)(grid->node_count + layers->blocks);
        layers->direction[layers->guests++] = (int8_t)d;
      }
      if (layers->guests > before)
        memcpy(layers->at[layers->blocks++], from[k].at, sizeof from[k].at);
    }
  }
  return MPS_OK;
}

int32_t mpsi_pore_guest_block(const mpsi_grid *grid, const mpsi_water *water, const int32_t *at) {
  for (int64_t k = 0; k < water->layers->blocks; k++)
    if (memcmp(water->layers->at[k], at, sizeof water->layers->at[k]) == 0)
      return (int32_t)(grid->node_count + k);
  return -1;
}

/* ---- room ------------------------------------------------------------------------------------ */

/* Of a cell of a layer. */
typedef struct layer_cell {
  double p, k, now;
  mpsi_pore_edge edge;
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

static int64_t bytes_of(const mpsi_grid *grid, mpsi_pore_stage stage) {
  if (stage == MPSI_PORE_FILLED) return sizeof(uint64_t);
  return layer_cells(grid) *
         (int64_t)(stage == MPSI_PORE_NOW ? sizeof(double) : sizeof(layer_cell));
}

static int64_t parcel_bytes(const mpsi_pore_layers *layers) {
  return layers->most * 2 * (int64_t)sizeof(mpsi_node);
}

static mps_status reserve(const search *s, mpsi_pore_layers *layers) {
  const mpsi_partition *partition = s->mpm->partition;
  const int64_t *item, layer = bytes_of(&s->mpm->grid, MPSI_PORE_EDGES);
  const int64_t parcel = parcel_bytes(layers);
  const int64_t out = mpsi_halo_items(layers->halo, &item) * layer, in = layers->guests * layer;
  const int64_t outgoing = partition->borders * parcel, incoming = partition->ghosts * parcel;
  if (mpsi_room_ensure(s->mpm->context, &layers->out_room, out > outgoing ? out : outgoing, 1) &&
      mpsi_room_ensure(s->mpm->context, &layers->in_room, in > incoming ? in : incoming, 1))
    return MPS_OK;
  return mpsi_fail_memory(s->mpm->context, s->function, (size_t)(out + in));
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

static mps_status find(search *s, mpsi_pore_layers *layers) {
  mps_domain *domain = s->mpm->partition->domain;
  double most = widest(s->mpm);
  mps_status status = mpsi_pore_find_notices(s->mpm, s->function, &s->notices);
  if (status != MPS_OK) return status;
  layers->guests = layers->blocks = 0;
  status = mpsi_domain_agree_max(domain, s->function, choose(s, layers), 1, &most);
  if (status != MPS_OK) return status;
  layers->most = (int64_t)most;
  const mpsi_halo_def def = {.guests = layers->guests, .rank = s->rank, .index = s->index};
  status = mpsi_halo_create(domain, s->function, &def, &layers->halo);
  return status == MPS_OK ? mpsi_domain_agree(domain, s->function, reserve(s, layers)) : status;
}

mps_status mpsi_pore_find_layers(mps_mpm *mpm, const char *function) {
  mpsi_pore_layers *layers = mpm->water->layers;
  search s = {.mpm = mpm, .function = function};
  mpsi_halo_destroy(mpm->context, &layers->halo);
  const mps_status status = find(&s, layers);
  if (status != MPS_OK) layers->guests = layers->blocks = 0;
  layers->searches = status == MPS_OK ? mpm->partition->searches : -1;
  mpsi_pore_free_notices(mpm->context, &s.notices);
  mpsi_free(mpm->context, s.rank);
  mpsi_free(mpm->context, s.index);
  return status;
}

void mpsi_pore_free_layers(mps_context *context, mpsi_pore_layers **pointer) {
  mpsi_pore_layers *layers = *pointer;
  *pointer = NULL;
  if (!layers) return;
  mpsi_halo_destroy(context, &layers->halo);
  mpsi_free(context, layers->block_room.item);
  mpsi_free(context, layers->direction_room.item);
  mpsi_free(context, layers->at_room.item);
  mpsi_free(context, layers->out_room.item);
  mpsi_free(context, layers->in_room.item);
  mpsi_free(context, layers);
}

/* ---- parcels --------------------------------------------------------------------------------- */

/* The region of both tiles, to or from a parcel. */
static void copy_region(const mpsi_grid *grid, const mpsi_cell_block *cells,
                        const mpsi_worker *worker, char *parcel, bool pack) {
  int low[3], high[3];
  mpsi_pore_region(grid, cells, low, high);
  const size_t bytes = (size_t)(high[0] - low[0]) * sizeof(mpsi_node);
  for (int which = 0; which < 2; which++)
    for (int k = low[2]; k < high[2]; k++)
      for (int j = low[1]; j < high[1]; j++) {
        mpsi_node *tile = which == 0 ? worker->tile : worker->force;
        double *row = tile[mpsi_tile_index(low[0], j, k)];
        memcpy(pack ? (void *)parcel : (void *)row, pack ? (void *)row : (void *)parcel, bytes);
        parcel += bytes;
      }
}

/* Sums of border blocks. */
typedef struct sums {
  mps_mpm *mpm;
  mpsi_mpm_task sum;
} sums;

static void pack_parcel(void *data, int64_t k, int32_t number) {
  const sums *s = data;
  mps_mpm *mpm = s->mpm;
  const mpsi_pore_layers *layers = mpm->water->layers;
  const int32_t b = mpm->partition->border[k];
  s->sum(mpm, b, number);
  copy_region(&mpm->grid, &mpm->grid.cells[b], &mpm->grid.workers[number],
              (char *)layers->out_room.item + k * parcel_bytes(layers), true);
}

void mpsi_pore_send_parcels(mps_mpm *mpm, mpsi_mpm_task sum) {
  sums s = {mpm, sum};
  mpsi_partition *partition = mpm->partition;
  mpsi_pore_layers *layers = mpm->water->layers;
  mpsi_parallel_for(mpm->context, partition->borders, pack_parcel, &s);
  if (partition->lost == MPS_OK)
    partition->lost = mpsi_halo_begin_bytes(partition->halo, step, (int32_t)parcel_bytes(layers),
                                            layers->out_room.item, layers->in_room.item);
}

void mpsi_pore_receive_parcels(void *solver) {
  mpsi_partition *partition = ((mps_mpm *)solver)->partition;
  if (partition->lost == MPS_OK) partition->lost = mpsi_halo_end_bytes(partition->halo, step);
}

bool mpsi_pore_take_parcel(mps_mpm *mpm, int64_t b, int32_t number) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  const mpsi_pore_layers *layers = mpm->water->layers;
  if (cells->ghost && mpm->partition->lost != MPS_OK) return false; /* the step has failed */
  char *parcels = cells->ghost ? layers->in_room.item : layers->out_room.item;
  copy_region(&mpm->grid, cells, &mpm->grid.workers[number],
              parcels + cells->parcel * parcel_bytes(layers), false);
  return true;
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
  if (!cell->inside) out->edge = *mpsi_pore_edge_of(water, cell);
}

static void pack_layer(const mpsi_grid *grid, mpsi_water *water, int64_t g, int direction,
                       mpsi_pore_stage stage, void *out) {
  const mpsi_pore_block *block = &water->block[g];
  uint64_t filled = 0;
  for (int i = 0; i < layer_cells(grid); i++) {
    const int k = cell_of_layer(direction, i);
    const mpsi_pore_cell *cell = water->cell + mpsi_first_node(grid, g) + k;
    const bool here = mpsi_pore_marked(block->filled, k);
    if (stage == MPSI_PORE_EDGES) pack_cell(water, block, cell, k, (layer_cell *)out + i);
    if (stage == MPSI_PORE_NOW) ((double *)out)[i] = here ? cell->now : 0.0;
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
  if (!in->inside) water->edge[cell - water->cell] = in->edge;
}

static void unpack_layer(const mpsi_grid *grid, mpsi_water *water, int32_t g, int direction,
                         mpsi_pore_stage stage, const void *in) {
  mpsi_pore_block *block = &water->block[g];
  uint64_t filled = 0;
  if (stage == MPSI_PORE_FILLED) memcpy(&filled, in, sizeof filled);
  for (int i = 0; i < layer_cells(grid); i++) {
    const int k = cell_of_layer(direction, i);
    mpsi_pore_cell *cell = water->cell + mpsi_first_node(grid, g) + k;
    if (filled >> i & 1) mpsi_pore_mark(block->filled, k);
    if (stage == MPSI_PORE_EDGES) unpack_cell(water, block, cell, k, (const layer_cell *)in + i);
    if (stage == MPSI_PORE_NOW) cell->now = ((const double *)in)[i];
  }
}

/* Before the marks of a step. */
static void clear_guests(const mpsi_grid *grid, mpsi_water *water) {
  for (int64_t k = 0; k < water->layers->blocks; k++) {
    mpsi_pore_block *block = &water->block[grid->node_count + k];
    memset(block->filled, 0, sizeof block->filled);
    memset(block->full, 0, sizeof block->full);
  }
}

void mpsi_pore_exchange(mps_mpm *mpm, mpsi_pore_stage stage) {
  if (!mpm->partition) return;
  mpsi_partition *partition = mpm->partition;
  mpsi_pore_layers *layers = mpm->water->layers;
  const int64_t *item, bytes = bytes_of(&mpm->grid, stage);
  const int64_t items = mpsi_halo_items(layers->halo, &item);
  char *out = layers->out_room.item, *in = layers->in_room.item;
  if (stage == MPSI_PORE_FILLED) clear_guests(&mpm->grid, mpm->water);
  if (partition->lost != MPS_OK) return;
  for (int64_t k = 0; k < items; k++)
    pack_layer(&mpm->grid, mpm->water, item[k] / 6, (int)(item[k] % 6), stage, out + k * bytes);
  partition->lost = mpsi_halo_begin_bytes(layers->halo, step, (int32_t)bytes, out, in);
  if (partition->lost == MPS_OK) partition->lost = mpsi_halo_end_bytes(layers->halo, step);
  for (int64_t q = 0; partition->lost == MPS_OK && q < layers->guests; q++)
    unpack_layer(&mpm->grid, mpm->water, layers->block[q], layers->direction[q], stage,
                 in + q * bytes);
}
