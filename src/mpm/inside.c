/* inside.c - which nodes lie inside a body or outside the domain, and which are corners of cells
 * that hold particles. These decide which nodes a particle near a body may use (Nakamura 5.1, with
 * the same-side test of fitted.c). SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include <string.h>

/* ---- before a step --------------------------------------------------------------------------- */

/* The node `place` of the block is inside body b, with the surface's normal there. */
static void note_inside(mpsi_node_block *nodes, const int *place, uint32_t *inside, int32_t b) {
  *inside |= UINT32_C(1) << b;
  nodes->inside = true;
  for (int c = 0; c < 3; c++) {
    if (place[c] < nodes->low[c]) nodes->low[c] = place[c];
    if (place[c] >= nodes->high[c]) nodes->high[c] = place[c] + 1;
  }
}

/* Distances change no faster than places: where a node is `far` (m) from what would change its
 * state, the next nodes of its row have that state too, as many as this. */
static int same_behind(const mps_mpm *mpm, double far) {
  const double cells = far * mpm->grid.inverse * (1.0 - 1e-9);
  return cells < 0.0 ? 0 : cells < MPSI_SIDE ? (int)cells : MPSI_SIDE;
}

/* No stencil reaches a node so far (m) below the surface: a particle is no deeper than its contact
 * allows, and the nodes of its stencil no further from it than two cells along each axis. */
static double deep_below(const mps_mpm *mpm, int32_t b) {
  return mpm->contact.handle[b]->def.depth + 2.0 * mpm->def.cell * sqrt((double)mpm->dim);
}

/* Whether x lies before the tangent plane at the foot of a point outside: no convex body holds it.
 */
static bool lies_before(const mps_mpm *mpm, const mpsi_foot *foot, const double *x) {
  double before = 0.0;
  for (int c = 0; c < mpm->dim; c++) before += (x[c] - foot->at[c]) * foot->normal[c];
  return foot->distance > 0.0 && before > 1e-9 * mpm->def.cell;
}

/* Nodes of a block that lie inside body b, with normals where a stencil may have them. */
static void find_inside_body(mps_mpm *mpm, mpsi_node_block *nodes, int32_t b,
                             mpsi_contact_node *node, uint32_t *inside) {
  const double deep = deep_below(mpm, b);
  mpsi_foot foot = {.distance = 0.0};
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    int place[3];
    double x[3];
    mpsi_unravel(k, MPSI_SIDE, place);
    mpsi_node_place(mpm, nodes->at, k, x);
    if (mpm->contact.handle[b]->convex && lies_before(mpm, &foot, x)) continue;
    foot = mpsi_body_foot(mpm->contact.body[b], x);
    const int row = MPSI_SIDE - 1 - place[0]; /* nodes behind this one */
    int same = foot.distance < 0.0 ? same_behind(mpm, -foot.distance - deep)
                                   : same_behind(mpm, foot.distance);
    if (same > row) same = row;
    for (int i = 0; i <= same && foot.distance < 0.0; i++, place[0]++) {
      note_inside(nodes, place, &inside[k + i], b);
      for (int c = 0; c < 3; c++)
        node[k + i].normal[c] = c < mpm->dim && i == 0 ? foot.normal[c] : 0.0;
    }
    k += same;
  }
}

/* Normals at the nodes of a block that lie inside bodies. */
void mpsi_mpm_find_inside(mps_mpm *mpm, int64_t g, int32_t worker) {
  (void)worker;
  mpsi_node_block *nodes = &mpm->grid.nodes[g];
  nodes->inside = nodes->thin = false;
  for (int c = 0; c < 3; c++) nodes->low[c] = MPSI_SIDE, nodes->high[c] = 0;
  if (nodes->near < 0) return;
  mpsi_mpm_find_sight(mpm, g);
  uint32_t *inside = mpm->contact.inside + mpsi_first_node(mpm, nodes->near);
  memset(inside, 0, (size_t)mpm->grid.block_nodes * sizeof *inside);
  _Atomic uint8_t *reached = mpm->contact.reached + mpsi_first_node(mpm, nodes->near);
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    atomic_store_explicit(&reached[k], 0, memory_order_relaxed);
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    mpsi_contact_node *node = mpm->contact.node + (int64_t)t * mpm->grid.block_nodes;
    const int32_t b = mpm->contact.node_pair[t].body;
    if (mpm->contact.sums) memset(node, 0, (size_t)mpm->grid.block_nodes * sizeof *node);
    if (mpm->contact.thin >> b & 1) continue; /* cuts no support: across.h */
    if (mpsi_mpm_body_reaches(mpm, b, nodes->at, MPSI_SIDE))
      find_inside_body(mpm, nodes, b, node, inside);
  }
}

/* Cells low to high - 1 of the block along each axis with corners inside bodies; false where there
 * are none. */
static bool cells_near(const mps_mpm *mpm, const mpsi_cell_block *cells, int *low, int *high) {
  bool any = false;
  for (int c = 0; c < 3; c++) low[c] = MPSI_TILE_SIDE, high[c] = 0;
  for (int q = 0; q < 1 << mpm->dim; q++) {
    const mpsi_node_block *nodes = &mpm->grid.nodes[cells->to[q]];
    any = any || nodes->inside;
    for (int c = 0; c < 3 && nodes->inside; c++) {
      const int first = q >> c & 1 ? MPSI_SIDE : 0;
      if (first + nodes->low[c] - 1 < low[c]) low[c] = first + nodes->low[c] - 1;
      if (first + nodes->high[c] > high[c]) high[c] = first + nodes->high[c];
    }
  }
  return any;
}

typedef void (*corner_fn)(const mps_mpm *mpm, const mpsi_cell_block *cells, const int *at,
                          void *data);

/* Corners of the cells that hold particles, some of them more than once. */
static void for_corners(const mps_mpm *mpm, const mpsi_cell_block *cells, corner_fn work,
                        void *data) {
  int low[3], high[3];
  if (cells->pairs == 0 || !cells_near(mpm, cells, low, high)) return;
  bool seen[MPSI_TILE_SIDE * MPSI_TILE_SIDE * MPSI_TILE_SIDE];
  memset(seen, 0, (size_t)mpm->grid.tile_nodes * sizeof *seen);
  double first[3], last[3];
  const int dim = mpm->dim;
  int slim = 0; /* the axis along which most are not near */
  for (int c = 0; c < dim; c++) {
    if (high[c] - low[c] < high[slim] - low[slim]) slim = c;
    first[c] = (double)cells->at[c] * MPSI_SIDE;
    last[c] = (double)(mpm->grid.high[c] - 1) - first[c];
  }
  for (int64_t k = cells->begin; k < cells->end; k++) {
    int at[3] = {0};
    bool near = true;
    for (int n = 0; n < dim && near; n++) {
      const int c = slim + n < dim ? slim + n : slim + n - dim;
      /* counted from the block: not negative, so that truncation is floor */
      const double X = mpsi_grid_coordinate(mpm, c, mpm->p.x[c][k]) - first[c];
      at[c] = (int)(X < last[c] ? X : last[c]);
      near = at[c] >= low[c] && at[c] < high[c];
    }
    if (!near) continue;
    bool *here = &seen[mpsi_tile_index(at[0], at[1], at[2])];
    if (*here) continue;
    *here = true;
    for (int q = 0; q < 1 << mpm->dim; q++) {
      const int corner[3] = {at[0] + (q & 1), at[1] + (q >> 1 & 1), at[2] + (q >> 2)};
      work(mpm, cells, corner, data);
    }
  }
}

/* Several blocks may mark one node at once. */
static void mark_node(const mps_mpm *mpm, const mpsi_cell_block *cells, const int *at, void *data) {
  _Atomic uint8_t *reached = data;
  const int64_t node = mpsi_node_under(mpm, cells, at[0], at[1], at[2]);
  const mpsi_node_block *nodes = &mpm->grid.nodes[node / mpm->grid.block_nodes];
  const int64_t at_node = mpsi_first_node(mpm, nodes->near) + node % mpm->grid.block_nodes;
  atomic_store_explicit(&reached[at_node], 1, memory_order_relaxed);
}

void mpsi_mpm_mark_reached(mps_mpm *mpm, int64_t b, int32_t worker) {
  (void)worker;
  for_corners(mpm, &mpm->grid.cells[b], mark_node, mpm->contact.reached);
}

static void list_node(const mps_mpm *mpm, const mpsi_cell_block *cells, const int *at, void *data) {
  const int t = mpsi_tile_index(at[0], at[1], at[2]);
  (void)mpm, (void)cells;
  ((uint64_t *)data)[t / 64] |= UINT64_C(1) << t % 64;
}

void mpsi_mpm_list_reached(const mps_mpm *mpm, int64_t b, uint64_t *bits) {
  for_corners(mpm, &mpm->grid.cells[b], list_node, bits);
}

void mpsi_mpm_take_reached(mps_mpm *mpm, int64_t b, const uint64_t *bits) {
  for (int t = 0; t < mpm->grid.tile_nodes; t++) {
    int at[3];
    if (!(bits[t / 64] >> t % 64 & 1)) continue;
    mpsi_unravel(t, MPSI_TILE_SIDE, at);
    mark_node(mpm, &mpm->grid.cells[b], at, mpm->contact.reached);
  }
}

/* ---- states under a tile ----------------------------------------------------------------------
 */

/* Nodes low to high - 1 of the tile along axis c are in the domain, or beyond a mirror. */
static void domain_under(const mps_mpm *mpm, const mpsi_cell_block *cells, int c, int *low,
                         int *high) {
  const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
  *low = mpm->grid.use_low[c] > first ? (int)(mpm->grid.use_low[c] - first) : 0;
  *high = mpm->grid.use_high[c] < first + MPSI_TILE_SIDE ? (int)(mpm->grid.use_high[c] - first) + 1
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

/* Of the nodes of a block under the corner q of the tile, in bodies or beside thin ones. */
static void mark_near(const mps_mpm *mpm, const mpsi_node_block *nodes, int q,
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
        if (nodes->thin && mpm->contact.beside[at]) worker->state[t] |= MPSI_THIN;
        if (!mpm->contact.inside[at]) continue;
        worker->inside[t] = mpm->contact.inside[at];
        const bool reached =
            atomic_load_explicit(&mpm->contact.reached[at], memory_order_relaxed) != 0;
        worker->state[t] |= reached ? MPSI_INSIDE | MPSI_REACHED : MPSI_INSIDE;
      }
}

void mpsi_mpm_find_states(const mps_mpm *mpm, const mpsi_cell_block *cells, mpsi_worker *worker) {
  mark_outside(mpm, cells, worker->state);
  memset(worker->inside, 0, (size_t)mpm->grid.tile_nodes * sizeof *worker->inside);
  for (int q = 0; q < 1 << mpm->dim; q++) {
    const mpsi_node_block *nodes = &mpm->grid.nodes[cells->to[q]];
    if (nodes->inside || nodes->thin) mark_near(mpm, nodes, q, worker);
  }
  if (cells->mirrors) mpsi_mpm_mirror_states(mpm, cells, worker);
}
