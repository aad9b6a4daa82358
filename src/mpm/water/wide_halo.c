/* wide_halo.c - see wide_halo.h. SPDX-License-Identifier: BSD-3-Clause */
#include "wide_halo.h"

#include "core/base/order.h"
#include "core/base/room_array.h"
#include "halo.h"
#include "mpm/ranks/messages.h"

#include <stdlib.h>
#include <string.h>

enum { REACH = MPSI_PORE_SPAN - 1 }; /* cells: so far does the matrix join two of them */

/* ---- which cells ----------------------------------------------------------------------------- */

/* Search for a wide halo. */
typedef struct search {
  mps_mpm *mpm;
  const char *function;
  mpsi_notice *list;
  int64_t found;               /* in the list */
  int32_t *rank, *shared_rank; /* of each cell and each shared block */
  int64_t *index, *shared_index;
} search;

static bool is_counted(const mpsi_grid *grid, const int32_t *at) {
  const int32_t g = mpsi_pore_own_block(grid, at);
  return g >= 0 && mpsi_mpm_counts_node_block(grid, g);
}

/* Whether place i of a block is at most `below` places before one that lies `step` (-1, 0, 1)
 * blocks from it, or at most `above` behind it. */
static bool is_near(int i, int step, int below, int above) {
  return step == 0 || (step > 0 ? i >= MPSI_SIDE - below : i < above);
}

/* Marks the cells and nodes of a block that are in reach of the cells of one beside it. */
static void mark_near(const mpsi_grid *grid, const int32_t *step, uint8_t *cell, uint8_t *node) {
  for (int k = 0; k < grid->block_nodes; k++) {
    int at[3];
    bool in = true, reached = true;
    mpsi_unravel(k, MPSI_SIDE, at);
    for (int c = 0; c < grid->dim; c++) {
      in = in && is_near(at[c], step[c], REACH, REACH);
      reached = reached && is_near(at[c], step[c], 1, MPSI_PORE_SPAN - 2);
    }
    cell[k] |= in;
    node[k] |= reached;
  }
}

/* Whether the block at `at` of another rank has cells in the wide halo; marks these, unless `cell`
 * is NULL, and the nodes that are in reach. */
static bool is_in_rim(const mpsi_grid *grid, const int32_t *at, uint8_t *cell, uint8_t *node) {
  bool any = false;
  if (cell) memset(cell, 0, (size_t)grid->block_nodes);
  if (cell) memset(node, 0, (size_t)grid->block_nodes);
  for (int q = 0; q < MPSI_PORE_AROUND; q++) {
    int32_t step[3], beside[3];
    mpsi_unravel(q, 3, step);
    for (int c = 0; c < 3; c++) beside[c] = at[c] + --step[c];
    if ((grid->dim == 2 && step[2] != 0) || !is_counted(grid, beside)) continue;
    any = true;
    if (!cell) return true;
    mark_near(grid, step, cell, node);
  }
  return any;
}

static int64_t count_blocks(const search *s) {
  int64_t blocks = 0;
  for (int64_t k = 0; k < s->found; k++)
    blocks += is_in_rim(&s->mpm->grid, s->list[k].at, NULL, NULL);
  return blocks;
}

static bool make_lists(search *s, mpsi_pore_wide_halo *wide) {
  mps_context *context = s->mpm->context;
  const int64_t blocks = count_blocks(s), cells = blocks * s->mpm->grid.block_nodes;
  s->rank = mpsi_alloc(context, cells, sizeof *s->rank);
  s->index = mpsi_alloc(context, cells, sizeof *s->index);
  s->shared_rank = mpsi_alloc(context, blocks, sizeof *s->shared_rank);
  s->shared_index = mpsi_alloc(context, blocks, sizeof *s->shared_index);
  const bool good = s->rank && s->index && s->shared_rank && s->shared_index &&
                    MPSI_ENSURE(context, wide, block, blocks) &&
                    MPSI_ENSURE(context, wide, cell, cells) &&
                    MPSI_ENSURE(context, wide, reached, cells) &&
                    MPSI_ENSURE(context, wide, shared_block, blocks);
  return good;
}

/* Puts the block of a notice into the lists, where it has cells in the wide halo. */
static void take_notice(search *s, mpsi_pore_wide_halo *wide, const mpsi_notice *from) {
  enum { MOST = MPSI_SIDE * MPSI_SIDE * MPSI_SIDE };
  const mpsi_grid *grid = &s->mpm->grid;
  uint8_t cell[MOST], node[MOST];
  if (!is_in_rim(grid, from->at, cell, node)) return;
  const int32_t same = mpsi_pore_own_block(grid, from->at);
  mpsi_pore_wide_block *block = &wide->block[wide->blocks];
  memcpy(block->at, from->at, sizeof block->at);
  block->number = (int32_t)wide->blocks;
  for (int k = 0; k < grid->block_nodes; k++) {
    wide->cell[wide->blocks * grid->block_nodes + k] = cell[k] ? (int32_t)wide->cells : -1;
    if (!cell[k]) continue;
    s->rank[wide->cells] = from->rank;
    s->index[wide->cells] = mpsi_first_node(grid, from->number) + k;
    wide->reached[wide->cells++] = node[k];
  }
  wide->blocks++;
  if (same < 0) return;
  s->shared_rank[wide->shared_blocks] = from->rank;
  s->shared_index[wide->shared_blocks] = from->number;
  wide->shared_block[wide->shared_blocks++] = same;
}

static mps_status choose(search *s, mpsi_pore_wide_halo *wide) {
  if (!make_lists(s, wide)) return mpsi_fail_memory(s->mpm->context, s->function, 24);
  for (int64_t k = 0; k < s->found; k++) take_notice(s, wide, &s->list[k]);
  if (wide->blocks > 1)
    qsort(wide->block, (size_t)wide->blocks, sizeof *wide->block, mpsi_compare_blocks);
  return MPS_OK;
}

int32_t mpsi_pore_wide_block_at(const mpsi_pore_wide_halo *wide, const int32_t *at) {
  int64_t low;
  MPSI_BISECT(low, wide ? wide->blocks : 0, middle, mpsi_block_before(wide->block[middle].at, at));
  const bool found = wide && low < wide->blocks && !mpsi_block_before(at, wide->block[low].at);
  return found ? wide->block[low].number : -1;
}

/* ---- messages: memory --------------------------------------------------------------------------
 */

/* Of a shared block: of each cell change of its pressure, volume that it has gained;
 * correction of its node. */
enum { CHANGES = 2 + 3, NODE = 3 + 3 };

static int64_t greater(int64_t a, int64_t b) { return a > b ? a : b; }

/* The first of a message has the number of those that follow. */
static int64_t particle_doubles(const mpsi_pore_wide_halo *wide) {
  _Static_assert(sizeof(mpsi_pore_particle) % sizeof(double) == 0, "particles of a message");
  return (1 + wide->particles) * (int64_t)(sizeof(mpsi_pore_particle) / sizeof(double));
}

static mps_status reserve(const search *s, mpsi_pore_wide_halo *wide) {
  const mpsi_grid *grid = &s->mpm->grid;
  const int64_t cell = mpsi_pore_row_numbers(grid), block = CHANGES * grid->block_nodes;
  const int64_t *item;
  const int64_t out = greater(mpsi_halo_items(wide->halo, &item) * greater(cell, NODE),
                              mpsi_halo_items(wide->shared, &item) * block);
  const int64_t in = greater(wide->cells * greater(cell, NODE), wide->shared_blocks * block);
  if (!mpsi_room_ensure(s->mpm->context, &wide->out_room, out, sizeof(double)) ||
      !mpsi_room_ensure(s->mpm->context, &wide->in_room, in, sizeof(double)))
    return mpsi_fail_memory(s->mpm->context, s->function, (size_t)(out + in) * sizeof(double));
  return mpsi_mpm_reserve_messages(s->mpm->context, s->mpm->partition, s->function,
                                   particle_doubles(wide));
}

static double most_particles(const mps_mpm *mpm) {
  int64_t most = 0;
  for (int64_t k = 0; k < mpm->partition->borders; k++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[mpm->partition->border[k]];
    if (cells->end - cells->begin > most) most = cells->end - cells->begin;
  }
  return (double)most;
}

static mps_status find(search *s, mpsi_pore_wide_halo *wide) {
  const mpsi_grid *grid = &s->mpm->grid;
  mps_domain *domain = s->mpm->domain;
  double most = most_particles(s->mpm);
  mps_status status = mpsi_pore_find_notices(s->mpm, s->function, &s->list, &s->found);
  if (status == MPS_OK) status = choose(s, wide);
  MPSI_TRY(mpsi_domain_agree_max(domain, s->function, status, 1, &most));
  wide->particles = (int64_t)most;
  const mpsi_halo_def cells = {.guests = wide->cells,
                               .rank = s->rank,
                               .index = s->index,
                               .first = grid->node_count * grid->block_nodes,
                               .columns = 1};
  const mpsi_halo_def shared = {
      .guests = wide->shared_blocks, .rank = s->shared_rank, .index = s->shared_index};
  status = mpsi_halo_create(domain, s->function, &cells, &wide->halo);
  if (status == MPS_OK) status = mpsi_halo_create(domain, s->function, &shared, &wide->shared);
  return status == MPS_OK ? mpsi_domain_agree(domain, s->function, reserve(s, wide)) : status;
}

mps_status mpsi_pore_find_wide_halo(mps_mpm *mpm, const char *function) {
  mpsi_pore_system *system = mpm->water->system;
  search s = {.mpm = mpm, .function = function};
  mps_status status = MPS_OK;
  if (!system->wide_halo) {
    system->wide_halo = mpsi_alloc(mpm->context, 1, sizeof *system->wide_halo);
    if (system->wide_halo)
      *system->wide_halo = (mpsi_pore_wide_halo){.searches = -1};
    else
      status = mpsi_fail_memory(mpm->context, function, sizeof *system->wide_halo);
  }
  MPSI_TRY(mpsi_domain_agree(mpm->domain, function, status));
  mpsi_pore_wide_halo *wide = system->wide_halo;
  mpsi_halo_destroy(mpm->context, &wide->halo);
  mpsi_halo_destroy(mpm->context, &wide->shared);
  wide->blocks = wide->cells = wide->shared_blocks = 0;
  status = find(&s, wide);
  if (status != MPS_OK) wide->blocks = wide->cells = wide->shared_blocks = 0;
  wide->searches = status == MPS_OK ? mpm->partition->searches : -1;
  MPSI_FREE(mpm->context, s.list, s.rank, s.index, s.shared_rank, s.shared_index);
  return status;
}

void mpsi_pore_free_wide_halo(mps_context *context, mpsi_pore_wide_halo **pointer) {
  mpsi_pore_wide_halo *wide = *pointer;
  *pointer = NULL;
  if (!wide) return;
  mpsi_halo_destroy(context, &wide->halo);
  mpsi_halo_destroy(context, &wide->shared);
  MPSI_FREE(context, wide->block_room.item, wide->cell_room.item, wide->reached_room.item,
            wide->shared_block_room.item, wide->out_room.item, wide->in_room.item);
  mpsi_free(context, wide);
}

/* ---- particles ------------------------------------------------------------------------------- */

static void pack_particles(void *data, int64_t b, int32_t worker, double *message) {
  const mps_mpm *mpm = data;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  mpsi_pore_particle *out = (void *)message;
  *out = (mpsi_pore_particle){.place = (int32_t)(cells->end - cells->begin)};
  for (int64_t k = cells->begin; k < cells->end; k++) *++out = mpsi_pore_particle_of(mpm, cells, k);
}

void mpsi_pore_send_particles(mps_mpm *mpm) {
  mpsi_mpm_send_messages(mpm->context, mpm->partition, "mps_mpm_step",
                         particle_doubles(mpm->water->system->wide_halo), pack_particles, mpm);
}

const mpsi_pore_particle *mpsi_pore_particles_of(const mps_mpm *mpm, int64_t b, int64_t *count) {
  double *message;
  *count = 0;
  if (!mpsi_mpm_find_message(mpm->partition, &mpm->grid.cells[b], &message)) return NULL;
  const mpsi_pore_particle *in = (const void *)message;
  *count = in->place;
  return in + 1;
}

/* ---- cells ----------------------------------------------------------------------------------- */

/* Exchanges what the cells of the wide halo have, or shared blocks. */
static mps_status exchange(mps_mpm *mpm, const char *function, bool shared, int64_t doubles,
                           mpsi_item_fn pack, mpsi_item_fn unpack) {
  const mpsi_pore_wide_halo *wide = mpm->water->system->wide_halo;
  double *const room[] = {wide->out_room.item, wide->in_room.item};
  return mpsi_mpm_exchange_items(shared ? wide->shared : wide->halo, function, doubles,
                                 shared ? wide->shared_blocks : wide->cells, room, pack, unpack,
                                 mpm);
}

/* Place in the vectors of cell k of the wide halo. */
static int64_t at_rim(const mpsi_grid *grid, int64_t k) {
  return grid->node_count * grid->block_nodes + k;
}

static void pack_forces(void *data, int64_t cell, double *out) {
  const mps_mpm *mpm = data;
  const mpsi_pore_system *s = mpm->water->system;
  const size_t bytes = (size_t)mpsi_pore_row_numbers(&mpm->grid) * sizeof *out;
  if (s->row[cell] >= 0)
    memcpy(out, mpsi_pore_row(&mpm->grid, s, cell), bytes);
  else
    memset(out, 0, bytes);
}

static void unpack_forces(void *data, int64_t k, double *in) {
  const mps_mpm *mpm = data;
  memcpy(mpsi_pore_row(&mpm->grid, mpm->water->system, at_rim(&mpm->grid, k)), in,
         (size_t)mpsi_pore_row_numbers(&mpm->grid) * sizeof *in);
}

mps_status mpsi_pore_send_forces(mps_mpm *mpm, const char *function) {
  return exchange(mpm, function, false, mpsi_pore_row_numbers(&mpm->grid), pack_forces,
                  unpack_forces);
}

static void pack_node(void *data, int64_t node, double *out) {
  const mpsi_pore_system *s = ((const mps_mpm *)data)->water->system;
  memcpy(out, s->inertia[node], sizeof s->inertia[node]);
  memcpy(out + 3, s->velocity[node], sizeof s->velocity[node]);
}

/* Nodes out of reach have no inertia, and so no velocity: not all cells around them are here. */
static void unpack_node(void *data, int64_t k, double *in) {
  const mps_mpm *mpm = data;
  const mpsi_pore_system *s = mpm->water->system;
  const int64_t at = at_rim(&mpm->grid, k);
  for (int c = 0; c < 3; c++) {
    s->inertia[at][c] = s->wide_halo->reached[k] ? in[c] : 0.0;
    s->velocity[at][c] = in[3 + c];
  }
}

mps_status mpsi_pore_send_nodes(mps_mpm *mpm, const char *function) {
  return exchange(mpm, function, false, NODE, pack_node, unpack_node);
}

mps_status mpsi_pore_send_direction(mps_mpm *mpm, const char *function) {
  mpsi_halo *halo = mpm->water->system->wide_halo->halo;
  double *const column[] = {mpm->water->system->direction};
  MPSI_TRY(mpsi_halo_begin(halo, function, 1, column));
  return mpsi_halo_end(halo, function, column);
}

static void copy_changes(const mps_mpm *mpm, int64_t g, double *message, bool to) {
  const mpsi_pore_system *s = mpm->water->system;
  const int64_t first = mpsi_first_node(&mpm->grid, g), nodes = mpm->grid.block_nodes;
  double *const part[] = {s->change + first, s->squeeze + first, s->velocity[first]};
  for (int k = 0; k < 3; k++) {
    const int64_t numbers = k < 2 ? nodes : 3 * nodes;
    memcpy(to ? message : part[k], to ? part[k] : message, (size_t)numbers * sizeof *message);
    message += numbers;
  }
}

static void pack_changes(void *data, int64_t g, double *out) { copy_changes(data, g, out, true); }

static void unpack_changes(void *data, int64_t k, double *in) {
  const mps_mpm *mpm = data;
  copy_changes(mpm, mpm->water->system->wide_halo->shared_block[k], in, false);
}

mps_status mpsi_pore_send_changes(mps_mpm *mpm, const char *function) {
  return exchange(mpm, function, true, CHANGES * mpm->grid.block_nodes, pack_changes,
                  unpack_changes);
}
