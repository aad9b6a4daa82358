/* rim.c - see rim.h. SPDX-License-Identifier: BSD-3-Clause */
#include "rim.h"

#include "notices.h"

#include <stdlib.h>
#include <string.h>

enum { REACH = MPSI_PORE_SPAN - 1 }; /* cells: so far does the matrix join two of them */

/* ---- which cells ----------------------------------------------------------------------------- */

/* Search for a rim. */
typedef struct search {
  mps_mpm *mpm;
  const char *function;
  mpsi_pore_notices notices;
  int32_t *rank, *whole_rank; /* of each cell and each whole block */
  int64_t *index, *whole_index;
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

/* Whether the block at `at` of another rank has cells in the rim; marks these, unless `cell` is
 * NULL, and the nodes that are in reach. */
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
  const mpsi_mailbox *box = &s->notices.box;
  int64_t blocks = 0;
  for (int32_t m = 0; m < box->count; m++) {
    const mpsi_pore_notice *from = box->mail[m].data;
    for (int64_t k = 0; k < box->mail[m].bytes / (int64_t)sizeof *from; k++)
      blocks += is_in_rim(&s->mpm->grid, from[k].at, NULL, NULL);
  }
  return blocks;
}

static bool make_lists(search *s, mpsi_pore_rim *rim) {
  mps_context *context = s->mpm->context;
  const int64_t blocks = count_blocks(s), cells = blocks * s->mpm->grid.block_nodes;
  s->rank = mpsi_alloc(context, cells, sizeof *s->rank);
  s->index = mpsi_alloc(context, cells, sizeof *s->index);
  s->whole_rank = mpsi_alloc(context, blocks, sizeof *s->whole_rank);
  s->whole_index = mpsi_alloc(context, blocks, sizeof *s->whole_index);
  const bool good = s->rank && s->index && s->whole_rank && s->whole_index &&
                    mpsi_room_ensure(context, &rim->block_room, blocks, sizeof *rim->block) &&
                    mpsi_room_ensure(context, &rim->cell_room, cells, sizeof *rim->cell) &&
                    mpsi_room_ensure(context, &rim->reached_room, cells, sizeof *rim->reached) &&
                    mpsi_room_ensure(context, &rim->whole_room, blocks, sizeof *rim->whole_block);
  rim->block = rim->block_room.item;
  rim->cell = rim->cell_room.item;
  rim->reached = rim->reached_room.item;
  rim->whole_block = rim->whole_room.item;
  return good;
}

/* Puts the block of a notice into the lists, where it has cells in the rim. */
static void take_notice(search *s, mpsi_pore_rim *rim, int32_t rank, const mpsi_pore_notice *from) {
  enum { MOST = MPSI_SIDE * MPSI_SIDE * MPSI_SIDE };
  const mpsi_grid *grid = &s->mpm->grid;
  uint8_t cell[MOST], node[MOST];
  if (!is_in_rim(grid, from->at, cell, node)) return;
  const int32_t same = mpsi_pore_own_block(grid, from->at);
  mpsi_pore_rim_block *block = &rim->block[rim->blocks];
  memcpy(block->at, from->at, sizeof block->at);
  block->number = (int32_t)rim->blocks;
  for (int k = 0; k < grid->block_nodes; k++) {
    rim->cell[rim->blocks * grid->block_nodes + k] = cell[k] ? (int32_t)rim->cells : -1;
    if (!cell[k]) continue;
    s->rank[rim->cells] = rank;
    s->index[rim->cells] = mpsi_first_node(grid, from->number) + k;
    rim->reached[rim->cells++] = node[k];
  }
  rim->blocks++;
  if (same < 0) return;
  s->whole_rank[rim->wholes] = rank;
  s->whole_index[rim->wholes] = from->number;
  rim->whole_block[rim->wholes++] = same;
}

static int compare_blocks(const void *left, const void *right) {
  const mpsi_pore_rim_block *a = left, *b = right;
  return mpsi_block_before(a->at, b->at) ? -1 : mpsi_block_before(b->at, a->at) ? 1 : 0;
}

static mps_status choose(search *s, mpsi_pore_rim *rim) {
  const mpsi_mailbox *box = &s->notices.box;
  if (!make_lists(s, rim)) return mpsi_fail_memory(s->mpm->context, s->function, 24);
  for (int32_t m = 0; m < box->count; m++) {
    const mpsi_pore_notice *from = box->mail[m].data;
    for (int64_t k = 0; k < box->mail[m].bytes / (int64_t)sizeof *from; k++)
      take_notice(s, rim, box->mail[m].rank, &from[k]);
  }
  if (rim->blocks > 1) qsort(rim->block, (size_t)rim->blocks, sizeof *rim->block, compare_blocks);
  return MPS_OK;
}

int32_t mpsi_pore_rim_block_at(const mpsi_pore_rim *rim, const int32_t *at) {
  int64_t low = 0, high = rim ? rim->blocks : 0;
  while (low < high) {
    const int64_t middle = (low + high) / 2;
    if (mpsi_block_before(rim->block[middle].at, at))
      low = middle + 1;
    else
      high = middle;
  }
  const bool found = rim && low < rim->blocks && !mpsi_block_before(at, rim->block[low].at);
  return found ? rim->block[low].number : -1;
}

/* ---- messages: room -------------------------------------------------------------------------- */

/* Of a cell in a message: mass, held components and velocity of its node, its scale, its forces. */
enum { MASS, HELD, SCALE, VELOCITY, HEAD = VELOCITY + 3 };

static int64_t force_bytes(const mpsi_grid *grid) {
  return (HEAD + mpsi_pore_row_numbers(grid)) * (int64_t)sizeof(double);
}

/* Of a cell: change of its pressure, volume that it has gained; correction of its node. */
enum { CHANGES = 2 + 3 };

static int64_t change_bytes(const mpsi_grid *grid) {
  return CHANGES * grid->block_nodes * (int64_t)sizeof(double);
}

/* The first of a parcel has the number of those that follow. */
static int64_t grain_bytes(const mpsi_pore_rim *rim) {
  return (1 + rim->particles) * (int64_t)sizeof(mpsi_pore_grain);
}

static int64_t greatest(int64_t a, int64_t b, int64_t c) {
  const int64_t most = a > b ? a : b;
  return most > c ? most : c;
}

static mps_status reserve(const search *s, mpsi_pore_rim *rim) {
  const mpsi_grid *grid = &s->mpm->grid;
  const mpsi_partition *partition = s->mpm->partition;
  const int64_t *item;
  const int64_t out = greatest(mpsi_halo_items(rim->halo, &item) * force_bytes(grid),
                               mpsi_halo_items(rim->whole, &item) * change_bytes(grid),
                               partition->borders * grain_bytes(rim));
  const int64_t in = greatest(rim->cells * force_bytes(grid), rim->wholes * change_bytes(grid),
                              partition->ghosts * grain_bytes(rim));
  if (mpsi_room_ensure(s->mpm->context, &rim->out_room, out, 1) &&
      mpsi_room_ensure(s->mpm->context, &rim->in_room, in, 1))
    return MPS_OK;
  return mpsi_fail_memory(s->mpm->context, s->function, (size_t)(out + in));
}

static double most_particles(const mps_mpm *mpm) {
  int64_t most = 0;
  for (int64_t k = 0; k < mpm->partition->borders; k++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[mpm->partition->border[k]];
    if (cells->end - cells->begin > most) most = cells->end - cells->begin;
  }
  return (double)most;
}

static mps_status find(search *s, mpsi_pore_rim *rim) {
  const mpsi_grid *grid = &s->mpm->grid;
  mps_domain *domain = s->mpm->partition->domain;
  double most = most_particles(s->mpm);
  mps_status status = mpsi_pore_find_notices(s->mpm, s->function, &s->notices);
  if (status != MPS_OK) return status;
  status = mpsi_domain_agree_max(domain, s->function, choose(s, rim), 1, &most);
  if (status != MPS_OK) return status;
  rim->particles = (int64_t)most;
  const mpsi_halo_def cells = {.guests = rim->cells,
                               .rank = s->rank,
                               .index = s->index,
                               .first = grid->node_count * grid->block_nodes,
                               .columns = 1};
  const mpsi_halo_def whole = {
      .guests = rim->wholes, .rank = s->whole_rank, .index = s->whole_index};
  status = mpsi_halo_create(domain, s->function, &cells, &rim->halo);
  if (status == MPS_OK) status = mpsi_halo_create(domain, s->function, &whole, &rim->whole);
  return status == MPS_OK ? mpsi_domain_agree(domain, s->function, reserve(s, rim)) : status;
}

mps_status mpsi_pore_find_rim(mps_mpm *mpm, const char *function) {
  mpsi_pore_system *system = mpm->water->system;
  search s = {.mpm = mpm, .function = function};
  mps_status status = MPS_OK;
  if (!system->rim) {
    system->rim = mpsi_alloc(mpm->context, 1, sizeof *system->rim);
    if (system->rim)
      *system->rim = (mpsi_pore_rim){.searches = -1};
    else
      status = mpsi_fail_memory(mpm->context, function, sizeof *system->rim);
  }
  status = mpsi_domain_agree(mpm->partition->domain, function, status);
  if (status != MPS_OK) return status;
  mpsi_pore_rim *rim = system->rim;
  mpsi_halo_destroy(mpm->context, &rim->halo);
  mpsi_halo_destroy(mpm->context, &rim->whole);
  rim->blocks = rim->cells = rim->wholes = 0;
  status = find(&s, rim);
  if (status != MPS_OK) rim->blocks = rim->cells = rim->wholes = 0;
  rim->searches = status == MPS_OK ? mpm->partition->searches : -1;
  mpsi_pore_free_notices(mpm->context, &s.notices);
  void *parts[] = {s.rank, s.index, s.whole_rank, s.whole_index};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(mpm->context, parts[k]);
  return status;
}

void mpsi_pore_free_rim(mps_context *context, mpsi_pore_rim **pointer) {
  mpsi_pore_rim *rim = *pointer;
  *pointer = NULL;
  if (!rim) return;
  mpsi_halo_destroy(context, &rim->halo);
  mpsi_halo_destroy(context, &rim->whole);
  const mpsi_room room[] = {rim->block_room, rim->cell_room, rim->reached_room,
                            rim->whole_room, rim->out_room,  rim->in_room};
  for (size_t k = 0; k < sizeof room / sizeof *room; k++) mpsi_free(context, room[k].item);
  mpsi_free(context, rim);
}

/* ---- particles ------------------------------------------------------------------------------- */

static void pack_grains(void *data, int64_t k, int32_t number) {
  mps_mpm *mpm = data;
  const mpsi_pore_rim *rim = mpm->water->system->rim;
  const mpsi_cell_block *cells = &mpm->grid.cells[mpm->partition->border[k]];
  mpsi_pore_grain *out = (void *)((char *)rim->out_room.item + k * grain_bytes(rim));
  (void)number;
  *out = (mpsi_pore_grain){.place = (int32_t)(cells->end - cells->begin)};
  for (int64_t i = cells->begin; i < cells->end; i++) *++out = mpsi_pore_grain_of(mpm, cells, i);
}

void mpsi_pore_send_grains(mps_mpm *mpm) {
  mpsi_partition *partition = mpm->partition;
  const mpsi_pore_rim *rim = mpm->water->system->rim;
  mpsi_parallel_for(mpm->context, partition->borders, pack_grains, mpm);
  if (partition->lost == MPS_OK)
    partition->lost =
        mpsi_halo_begin_bytes(partition->halo, "mps_mpm_step", (int32_t)grain_bytes(rim),
                              rim->out_room.item, rim->in_room.item);
}

void mpsi_pore_receive_grains(void *solver) {
  mpsi_partition *partition = ((mps_mpm *)solver)->partition;
  if (partition->lost == MPS_OK)
    partition->lost = mpsi_halo_end_bytes(partition->halo, "mps_mpm_step");
}

const mpsi_pore_grain *mpsi_pore_grains_of(const mps_mpm *mpm, int64_t b, int64_t *count) {
  const mpsi_pore_rim *rim = mpm->water->system->rim;
  const mpsi_pore_grain *in = (const void *)((const char *)rim->in_room.item +
                                             mpm->grid.cells[b].parcel * grain_bytes(rim));
  *count = mpm->partition->lost == MPS_OK ? in->place : 0; /* else the step has failed */
  return in + 1;
}

/* ---- cells ----------------------------------------------------------------------------------- */

static void pack_cell(const mps_mpm *mpm, int64_t cell, double *out) {
  const mpsi_grid *grid = &mpm->grid;
  const mpsi_pore_system *s = mpm->water->system;
  const size_t bytes = (size_t)mpsi_pore_row_numbers(grid) * sizeof *out;
  const mpsi_pore_block *block = &mpm->water->block[cell / grid->block_nodes];
  out[MASS] = s->mass[cell];
  out[HELD] = s->held[cell];
  out[SCALE] = s->scale[cell];
  memcpy(out + VELOCITY, s->velocity[cell], sizeof s->velocity[cell]);
  if (mpsi_pore_marked(block->filled, (int)(cell % grid->block_nodes)))
    memcpy(out + HEAD, mpsi_pore_row(grid, s, cell), bytes);
  else
    memset(out + HEAD, 0, bytes);
}

/* Nodes out of reach have no mass, and so no velocity: not all cells around them are here. */
static void unpack_cell(const mps_mpm *mpm, int64_t number, const double *in) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_pore_system *s = mpm->water->system;
  const int64_t cell = grid->node_count * grid->block_nodes + number;
  s->mass[cell] = s->rim->reached[number] ? in[MASS] : 0.0;
  s->held[cell] = (uint8_t)in[HELD];
  s->scale[cell] = in[SCALE];
  memcpy(s->velocity[cell], in + VELOCITY, sizeof s->velocity[cell]);
  memcpy(mpsi_pore_row(grid, s, cell), in + HEAD, (size_t)mpsi_pore_row_numbers(grid) * sizeof *in);
}

mps_status mpsi_pore_send_forces(mps_mpm *mpm, const char *function) {
  const mpsi_pore_rim *rim = mpm->water->system->rim;
  const int64_t *item, items = mpsi_halo_items(rim->halo, &item), bytes = force_bytes(&mpm->grid);
  const int64_t numbers = bytes / (int64_t)sizeof(double);
  double *out = rim->out_room.item, *in = rim->in_room.item;
  for (int64_t k = 0; k < items; k++) pack_cell(mpm, item[k], out + k * numbers);
  mps_status status = mpsi_halo_begin_bytes(rim->halo, function, (int32_t)bytes, out, in);
  if (status == MPS_OK) status = mpsi_halo_end_bytes(rim->halo, function);
  for (int64_t k = 0; status == MPS_OK && k < rim->cells; k++)
    unpack_cell(mpm, k, in + k * numbers);
  return status;
}

mps_status mpsi_pore_send_direction(mps_mpm *mpm, const char *function) {
  mpsi_halo *halo = mpm->water->system->rim->halo;
  double *const column[] = {mpm->water->system->direction};
  const mps_status status = mpsi_halo_begin(halo, function, 1, column);
  return status == MPS_OK ? mpsi_halo_end(halo, function, column) : status;
}

/* The parts of a block's message: where they are in the system, and how long. */
static int64_t list_changes(const mpsi_grid *grid, const mpsi_pore_system *s, int64_t g,
                            double **part, int64_t *numbers) {
  const int64_t first = mpsi_first_node(grid, g);
  part[0] = s->change + first, numbers[0] = grid->block_nodes;
  part[1] = s->squeeze + first, numbers[1] = grid->block_nodes;
  part[2] = s->velocity[first], numbers[2] = 3 * grid->block_nodes;
  return 3;
}

static void copy_changes(const mpsi_grid *grid, const mpsi_pore_system *s, int64_t g, double *box,
                         bool back) {
  double *part[3];
  int64_t numbers[3];
  const int64_t parts = list_changes(grid, s, g, part, numbers);
  for (int64_t k = 0; k < parts; box += numbers[k++])
    memcpy(back ? part[k] : box, back ? box : part[k], (size_t)numbers[k] * sizeof *box);
}

mps_status mpsi_pore_send_changes(mps_mpm *mpm, const char *function) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_pore_system *s = mpm->water->system;
  const int64_t *item, items = mpsi_halo_items(s->rim->whole, &item);
  const int64_t bytes = change_bytes(grid), numbers = bytes / (int64_t)sizeof(double);
  double *out = s->rim->out_room.item, *in = s->rim->in_room.item;
  for (int64_t k = 0; k < items; k++) copy_changes(grid, s, item[k], out + k * numbers, false);
  mps_status status = mpsi_halo_begin_bytes(s->rim->whole, function, (int32_t)bytes, out, in);
  if (status == MPS_OK) status = mpsi_halo_end_bytes(s->rim->whole, function);
  for (int64_t k = 0; status == MPS_OK && k < s->rim->wholes; k++)
    copy_changes(grid, s, s->rim->whole_block[k], in + k * numbers, true);
  return status;
}
