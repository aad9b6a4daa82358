/* near.c - before each step: which blocks are near which bodies, which nodes lie inside a body
 * or outside the domain, and which are corners of cells that hold particles. These decide which
 * nodes a particle near a body may use (Nakamura 5.1, with the same-side test), and which blocks
 * have particles with cut supports or need the velocity before the forces.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include <string.h>

/* Half the diagonal of a tile or block of `side` nodes an axis, in cells, and a little for
 * round-off: a body that has a node of it inside is no further than that from its centre. */
static double half_diagonal(const mps_mpm *mpm, int side) {
  return 0.5 * (side - 1) * sqrt((double)mpm->dim) * (1.0 + 1e-9);
}

/* Whether the body may have a node of the tile or block of `side` nodes an axis inside. */
static bool reaches(const mps_mpm *mpm, int32_t body, const int32_t *at, int side) {
  const double middle = 0.5 * (side - 1), local[3] = {middle, middle, middle};
  double x[3];
  mpsi_node_position(mpm, at, local, x);
  return mpsi_body_reaches(mpm->contact.body[body], x, half_diagonal(mpm, side) * mpm->def.cell);
}

/* ---- lists ------------------------------------------------------------------------------------
 */

/* Lists the pairs of blocks of cells and bodies; false where there is no room for them all, `count`
 * says how many there are.
 */
static bool list_cell_pairs(mps_mpm *mpm, int64_t *count) {
  *count = 0;
  for (int64_t g = 0; g < mpm->grid.node_count; g++) mpm->grid.nodes[g].bodies = 0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    mpsi_cell_block *cells = &mpm->grid.cells[b];
    cells->first_pair = (int32_t)*count;
    for (int32_t k = 0; k < mpm->contact.bodies; k++) {
      if (!reaches(mpm, k, cells->at, MPSI_TILE_SIDE)) continue;
      for (int q = 0; q < 1 << mpm->dim; q++)
        mpm->grid.nodes[cells->to[q]].bodies |= UINT32_C(1) << k;
      if (*count < mpm->contact.cell_pair_room.capacity) {
        mpsi_cell_pair *pair = (mpsi_cell_pair *)mpm->contact.cell_pair_room.item + *count;
        pair->cells = (int32_t)b;
        pair->body = k;
      }
      (*count)++;
    }
    cells->pairs = (int32_t)*count - cells->first_pair;
  }
  return *count <= mpm->contact.cell_pair_room.capacity;
}

/* The blocks of nodes that each body may touch. The same in two goes: see list_cell_pairs. */
static bool list_node_pairs(mps_mpm *mpm, int64_t *count, int64_t *near) {
  *count = *near = 0;
  for (int64_t g = 0; g < mpm->grid.node_count; g++) {
    mpsi_node_block *nodes = &mpm->grid.nodes[g];
    nodes->first_pair = (int32_t)*count;
    nodes->near = nodes->bodies ? (int32_t)(*near)++ : -1;
    for (int32_t k = 0; k < mpm->contact.bodies; k++) {
      if (!(nodes->bodies >> k & 1)) continue;
      if (*count < mpm->contact.node_pair_room.capacity)
        ((mpsi_node_pair *)mpm->contact.node_pair_room.item)[*count] =
            (mpsi_node_pair){(int32_t)g, k, 0.0};
      (*count)++;
    }
    nodes->pairs = (int32_t)*count - nodes->first_pair;
  }
  return *count <= mpm->contact.node_pair_room.capacity;
}

static mps_status make_lists(mps_mpm *mpm, const char *function) {
  mps_context *context = mpm->context;
  int64_t cell_pairs = 0, node_pairs = 0, near = 0;
  bool good = true;
  if (!list_cell_pairs(mpm, &cell_pairs)) {
    good = mpsi_room_ensure(context, &mpm->contact.cell_pair_room, cell_pairs,
                            sizeof *mpm->contact.cell_pair);
    if (good) list_cell_pairs(mpm, &cell_pairs);
  }
  if (good && !list_node_pairs(mpm, &node_pairs, &near)) {
    good = mpsi_room_ensure(context, &mpm->contact.node_pair_room, node_pairs,
                            sizeof *mpm->contact.node_pair);
    if (good) list_node_pairs(mpm, &node_pairs, &near);
  }
  const int64_t nodes = node_pairs * mpm->grid.block_nodes, masks = near * mpm->grid.block_nodes;
  good = good &&
         mpsi_room_ensure(context, &mpm->contact.node_room, nodes, sizeof *mpm->contact.node) &&
         mpsi_room_ensure(context, &mpm->contact.inside_room, masks, sizeof *mpm->contact.inside) &&
         mpsi_room_ensure(context, &mpm->contact.reached_room, masks, sizeof *mpm->contact.reached);
  if (!good)
    return mpsi_fail_memory(context, function,
                            (size_t)(cell_pairs + 1) * sizeof *mpm->contact.cell_pair +
                                (size_t)nodes * sizeof *mpm->contact.node);
  mpm->contact.cell_pair = mpm->contact.cell_pair_room.item;
  mpm->contact.node_pair = mpm->contact.node_pair_room.item;
  mpm->contact.node = mpm->contact.node_room.item;
  mpm->contact.inside = mpm->contact.inside_room.item;
  mpm->contact.reached = mpm->contact.reached_room.item;
  mpm->contact.cell_pair_count = cell_pairs;
  mpm->contact.node_pair_count = node_pairs;
  mpm->contact.mask_count = near;
  return MPS_OK;
}

/* ---- nodes in bodies --------------------------------------------------------------------------
 */

/* Normals at the nodes of a block that lie inside bodies. */
static void find_inside(mps_mpm *mpm, int64_t g, int32_t worker) {
  (void)worker;
  mpsi_node_block *nodes = &mpm->grid.nodes[g];
  nodes->inside = false;
  for (int c = 0; c < 3; c++) nodes->low[c] = MPSI_SIDE, nodes->high[c] = 0;
  if (nodes->near < 0) return;
  uint32_t *inside = mpm->contact.inside + mpsi_first_node(mpm, nodes->near);
  memset(inside, 0, (size_t)mpm->grid.block_nodes * sizeof *inside);
  memset(mpm->contact.reached + mpsi_first_node(mpm, nodes->near), 0,
         (size_t)mpm->grid.block_nodes);
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    mpsi_contact_node *node = mpm->contact.node + (int64_t)t * mpm->grid.block_nodes;
    const int32_t b = mpm->contact.node_pair[t].body;
    memset(node, 0, (size_t)mpm->grid.block_nodes * sizeof *node);
    if (!reaches(mpm, b, nodes->at, MPSI_SIDE)) continue;
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      int place[3];
      double x[3];
      mpsi_unravel(k, MPSI_SIDE, place);
      const double local[3] = {place[0], place[1], place[2]};
      mpsi_node_position(mpm, nodes->at, local, x);
      const mpsi_foot foot = mpsi_body_foot(mpm->contact.body[b], x);
      if (!(foot.distance < 0.0)) continue;
      for (int c = 0; c < mpm->dim; c++) node[k].normal[c] = foot.normal[c];
      inside[k] |= UINT32_C(1) << b;
      nodes->inside = true;
      for (int c = 0; c < 3; c++) {
        if (place[c] < nodes->low[c]) nodes->low[c] = place[c];
        if (place[c] >= nodes->high[c]) nodes->high[c] = place[c] + 1;
      }
    }
  }
}

/* Corners of the cells that hold particles. All blocks of a colour at once: they share no node. */
static void mark_reached(mps_mpm *mpm, int64_t b, int32_t worker) {
  (void)worker;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  if (!cells->inside || cells->pairs == 0) return;
  bool seen[MPSI_TILE_SIDE * MPSI_TILE_SIDE * MPSI_TILE_SIDE];
  memset(seen, 0, (size_t)mpm->grid.tile_nodes * sizeof *seen);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    int at[3] = {0};
    for (int c = 0; c < mpm->dim; c++) {
      /* counted from the block: not negative, so that truncation is floor */
      const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE, last = mpm->grid.high[c] - 1 - first;
      const double X = mpsi_grid_coordinate(mpm, c, mpm->p.x[c][k]) - (double)first;
      at[c] = X < (double)last ? (int)X : (int)last;
    }
    bool *here = &seen[mpsi_tile_index(at[0], at[1], at[2])];
    if (*here) continue;
    *here = true;
    for (int q = 0; q < 1 << mpm->dim; q++) {
      const int64_t node =
          mpsi_node_under(mpm, cells, at[0] + (q & 1), at[1] + (q >> 1 & 1), at[2] + (q >> 2));
      const mpsi_node_block *nodes = &mpm->grid.nodes[node / mpm->grid.block_nodes];
      mpm->contact.reached[mpsi_first_node(mpm, nodes->near) + node % mpm->grid.block_nodes] = 1;
    }
  }
}

/* ---- cut and split blocks ---------------------------------------------------------------------
 */

/* Nodes low to high - 1 of a tile. */
typedef struct box {
  int low[3], high[3];
} box;

static bool is_empty(const box *a) {
  return a->low[0] >= a->high[0] || a->low[1] >= a->high[1] || a->low[2] >= a->high[2];
}

static box common(const box *a, const box *b) {
  box out;
  for (int c = 0; c < 3; c++) {
    out.low[c] = a->low[c] > b->low[c] ? a->low[c] : b->low[c];
    out.high[c] = a->high[c] < b->high[c] ? a->high[c] : b->high[c];
  }
  return out;
}

/* Of the nodes that the block's stencils may use, those of the node block at corner q of the tile
 * from its `low` to its `high`. */
static box box_under(const mpsi_cell_block *cells, int q, const int32_t *low, const int32_t *high) {
  box used, out;
  for (int c = 0; c < 3; c++) {
    const int first = q >> c & 1 ? MPSI_SIDE : 0;
    used.low[c] = cells->low[c], used.high[c] = cells->high[c];
    out.low[c] = first + low[c], out.high[c] = first + high[c];
  }
  return common(&used, &out);
}

/* Where the stencils that have a node in a body may have nodes; empty where none has. */
static box near_bodies(const mps_mpm *mpm, const mpsi_cell_block *cells) {
  const int reach = mpm->def.spline;
  box out = {{MPSI_TILE_SIDE, MPSI_TILE_SIDE, MPSI_TILE_SIDE}, {0}};
  for (int q = 0; q < 1 << mpm->dim; q++) {
    const mpsi_node_block *nodes = &mpm->grid.nodes[cells->to[q]];
    const box in = box_under(cells, q, nodes->low, nodes->high);
    for (int c = 0; c < 3 && nodes->inside && !is_empty(&in); c++) {
      if (in.low[c] - reach < out.low[c]) out.low[c] = in.low[c] - reach;
      if (in.high[c] + reach > out.high[c]) out.high[c] = in.high[c] + reach;
    }
  }
  return out;
}

/* Slots of sides, and what is split, of the blocks of nodes under a cut block of cells. */
static void mark_cut(mps_mpm *mpm, const mpsi_cell_block *cells, const box *near, bool finds) {
  static const int32_t low[3] = {0}, high[3] = {MPSI_SIDE, MPSI_SIDE, MPSI_SIDE};
  const bool all =
      mpm->def.transfer == MPS_TRANSFER_WEIGHT || mpm->flip > 0.0 || (finds && cells->edge);
  bool rough = false;
  for (int32_t k = 0; cells->inside && k < cells->pairs; k++)
    rough =
        rough ||
        mpm->contact.body[mpm->contact.cell_pair[cells->first_pair + k].body]->def.friction > 0.0;
  for (int q = 0; q < 1 << mpm->dim; q++) {
    mpsi_node_block *nodes = &mpm->grid.nodes[cells->to[q]];
    box under = box_under(cells, q, low, high);
    under = common(&under, near);
    const bool touched = !is_empty(&under);
    if (!touched && !cells->edge && !mpm->standard) continue;
    if (nodes->side < 0) nodes->side = (int32_t)mpm->grid.side_count++;
    nodes->split = nodes->split || all || (touched && rough);
  }
}

/* Cut: some particle may have a cut support, or, with the standard scheme, one without a fit.
 * Split: friction needs the velocity before the forces; so does FLIP, and the transfer by weights,
 * which divides momentum and force by different masses. */
static mps_status find_cut(mps_mpm *mpm, const char *function) {
  bool finds = false; /* an absorbing wall asks for the forces of its first step */
  for (int32_t k = 0; k < MPSI_WALLS && !(mpm->def.settle > 0.0); k++)
    finds = finds || mpm->boundaries.hold[k].finds;
  for (int64_t g = 0; g < mpm->grid.node_count; g++)
    mpm->grid.nodes[g].side = -1, mpm->grid.nodes[g].split = false;
  mpm->grid.side_count = 0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    mpsi_cell_block *cells = &mpm->grid.cells[b];
    const box near = near_bodies(mpm, cells);
    cells->inside = !is_empty(&near);
    cells->cut = cells->edge || cells->inside || mpm->standard;
    if (cells->cut) mark_cut(mpm, cells, &near, finds);
  }
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    mpsi_cell_block *cells = &mpm->grid.cells[b];
    cells->split = false;
    for (int q = 0; q < 1 << mpm->dim; q++)
      cells->split = cells->split || mpm->grid.nodes[cells->to[q]].split;
    cells->apart = cells->split || cells->edge;
  }
  if (!mpsi_room_ensure(mpm->context, &mpm->grid.side_room,
                        mpm->grid.side_count * mpm->grid.block_nodes, sizeof *mpm->grid.side))
    return mpsi_fail_memory(mpm->context, function,
                            (size_t)(mpm->grid.side_count * mpm->grid.block_nodes) *
                                sizeof *mpm->grid.side);
  mpm->grid.side = mpm->grid.side_room.item;
  return MPS_OK;
}

mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function) {
  if (mpm->contact.bodies > 0) {
    const mps_status status = make_lists(mpm, function);
    if (status != MPS_OK) return status;
    mpsi_mpm_for_nodes(mpm, find_inside);
  }
  const mps_status status = find_cut(mpm, function);
  if (status == MPS_OK && mpm->contact.cell_pair_count > 0) mpsi_mpm_for_colours(mpm, mark_reached);
  return status;
}

/* ---- states under a tile ----------------------------------------------------------------------
 */

/* Nodes low to high - 1 of the tile along axis c are in the domain. */
static void domain_under(const mps_mpm *mpm, const mpsi_cell_block *cells, int c, int *low,
                         int *high) {
  const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
  *low = mpm->grid.low[c] > first ? (int)(mpm->grid.low[c] - first) : 0;
  *high = mpm->grid.high[c] < first + MPSI_TILE_SIDE ? (int)(mpm->grid.high[c] - first) + 1
                                                     : MPSI_TILE_SIDE;
}

static void mark_outside(const mps_mpm *mpm, const mpsi_cell_block *cells, uint8_t *state) {
  int low[3] = {0}, high[3] = {1, 1, 1};
  for (int c = 0; c < mpm->dim; c++) domain_under(mpm, cells, c, &low[c], &high[c]);
  memset(state, MPSI_OUTSIDE, (size_t)mpm->grid.tile_nodes);
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1] && low[0] < high[0]; j++)
      memset(state + mpsi_tile_index(low[0], j, k), mpm->standard ? MPSI_PLAIN : 0,
             (size_t)(high[0] - low[0]));
}

/* Of the nodes of a block under the corner q of the tile. */
static void mark_inside(const mps_mpm *mpm, const mpsi_node_block *nodes, int q,
                        mpsi_worker *worker) {
  int low[3] = {0}, size[3] = {1, 1, 1};
  for (int c = 0; c < mpm->dim; c++) {
    low[c] = q >> c & 1 ? MPSI_SIDE : 0;
    size[c] = low[c] ? MPSI_TILE_SIDE - MPSI_SIDE : MPSI_SIDE;
  }
  const int64_t first = mpsi_first_node(mpm, nodes->near);
  for (int k = 0; k < size[2]; k++)
    for (int j = 0; j < size[1]; j++)
      for (int i = 0; i < size[0]; i++) {
        const int64_t at = first + (k * MPSI_SIDE + j) * MPSI_SIDE + i;
        const int t = mpsi_tile_index(low[0] + i, low[1] + j, low[2] + k);
        if (!mpm->contact.inside[at]) continue;
        worker->inside[t] = mpm->contact.inside[at];
        worker->state[t] |= mpm->contact.reached[at] ? MPSI_INSIDE | MPSI_REACHED : MPSI_INSIDE;
      }
}

void mpsi_mpm_find_states(const mps_mpm *mpm, const mpsi_cell_block *cells, mpsi_worker *worker) {
  mark_outside(mpm, cells, worker->state);
  memset(worker->inside, 0, (size_t)mpm->grid.tile_nodes * sizeof *worker->inside);
  for (int q = 0; q < 1 << mpm->dim; q++) {
    const mpsi_node_block *nodes = &mpm->grid.nodes[cells->to[q]];
    if (nodes->inside) mark_inside(mpm, nodes, q, worker);
  }
}
