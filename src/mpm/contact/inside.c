/* inside.c - nodes inside bodies or outside the domain, nodes that are corners of cells with
 * particles, and the surface normals at those that are both. By these a particle near a body finds
 * its active nodes (Nakamura 5.1, with the side test of support.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/kernels.h"
#include "mpm/ranks/messages.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/pairs.h"

#include <string.h>

/* ---- before a step --------------------------------------------------------------------------- */

/* Adds the node `place` to the range of the block's nodes inside bodies. */
static void add_to_range(mpsi_node_block *nodes, const int *place) {
  nodes->inside = true;
  for (int c = 0; c < 3; c++) {
    if (place[c] < nodes->low[c]) nodes->low[c] = place[c];
    if (place[c] >= nodes->high[c]) nodes->high[c] = place[c] + 1;
  }
}

/* Number of nodes after the present one in its row that lie on the same side of the surface: the
 * distance from the surface, here `far` (m), changes at most by the distance between nodes. */
static int count_same_side(const mpsi_grid *grid, double far) {
  const double cells = far * grid->inverse * (1.0 - 1e-9);
  return cells < MPSI_SIDE ? (int)cells : MPSI_SIDE;
}

/* Number of nodes of the block, from the one at `place` (position x) on, that lie outside a convex
 * body because they are before the tangent plane at the foot of an outer point: the node alone, its
 * row, its plane or all the rest; 0: not known. */
static int count_before(const mpsi_grid *grid, const mpsi_foot *foot, const int *place,
                        const double *x) {
  const double least = 1e-9 * grid->cell;
  double before = 0.0;
  int count = 1;
  for (int c = 0; c < grid->dim; c++) before += (x[c] - foot->at[c]) * foot->normal[c];
  if (!(foot->distance > 0.0) || !(before > least)) return 0;
  for (int c = 0; c < grid->dim && place[c] == 0; c++, count *= MPSI_SIDE) {
    before += fmin(0.0, (MPSI_SIDE - 1) * grid->cell * foot->normal[c]);
    if (!(before > least)) break;
  }
  return count;
}

/* Marks the nodes of a block that lie inside the body of its pair t. */
static void find_inside_body(const mpsi_grid *grid, const mpsi_contacts *contacts,
                             mpsi_node_block *nodes, int32_t t, uint8_t *inside) {
  const int32_t b = contacts->node_pair[t].body;
  const bool convex = contacts->handle[b]->convex;
  const unsigned state =
      MPSI_INSIDE | (mpsi_by_impulses(contacts->handle[b]) ? MPSI_IMPULSE : MPSI_PENALTY);
  uint8_t *held = contacts->held + (int64_t)t * grid->block_nodes;
  mpsi_foot foot = {.distance = 0.0};
  for (int k = 0, done; k < grid->block_nodes; k += done) {
    int place[3];
    double x[3];
    mpsi_unravel(k, MPSI_SIDE, place);
    mpsi_node_place(grid, nodes->at, k, x);
    if (convex && (done = count_before(grid, &foot, place, x)) > 0) continue;
    foot = mpsi_body_foot(contacts->body[b], x);
    done = 1 + count_same_side(grid, fabs(foot.distance));
    if (done > MPSI_SIDE - place[0]) done = MPSI_SIDE - place[0];
    for (int i = 0; i < done && foot.distance < 0.0; i++, place[0]++) {
      held[k + i] = 1;
      inside[k + i] |= (uint8_t)state;
      add_to_range(nodes, place);
    }
  }
}

void mpsi_mpm_find_inside(void *search, int64_t g, int32_t worker) {
  const mpsi_inside_search *of = search;
  const size_t count = (size_t)of->grid->block_nodes;
  mpsi_node_block *nodes = &of->grid->nodes[g];
  nodes->inside = nodes->thin = false;
  for (int c = 0; c < 3; c++) nodes->low[c] = MPSI_SIDE, nodes->high[c] = 0;
  if (nodes->near < 0) return;
  mpsi_mpm_find_sight(of->grid, of->contact, g);
  uint8_t *inside = of->contact->inside + mpsi_first_node(of->grid, nodes->near);
  memset(inside, 0, count);
  memset((void *)(of->contact->reached + mpsi_first_node(of->grid, nodes->near)), 0, count);
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    const int32_t b = of->contact->node_pair[t].body;
    memset(of->contact->held + (int64_t)t * of->grid->block_nodes, 0, count);
    if (of->contact->penalty_bodies > 0)
      memset(of->contact->node + (int64_t)t * of->grid->block_nodes, 0,
             count * sizeof *of->contact->node);
    if (of->contact->state[b].parts) continue; /* such a body cuts no support: thin_bodies.h */
    if (mpsi_mpm_body_reaches(of->grid, of->contact, b, nodes->at, MPSI_SIDE))
      find_inside_body(of->grid, of->contact, nodes, t, inside);
  }
}

/* Range, low to high - 1 along each axis, of the block's cells with corners inside bodies; false:
 * there are none. */
static bool cells_near(const mpsi_grid *grid, const mpsi_cell_block *cells, int *low, int *high) {
  bool any = false;
  for (int c = 0; c < 3; c++) low[c] = MPSI_TILE_SIDE, high[c] = 0;
  for (int q = 0; q < 1 << grid->dim; q++) {
    const mpsi_node_block *nodes = &grid->nodes[cells->to[q]];
    any = any || nodes->inside;
    for (int c = 0; c < 3 && nodes->inside; c++) {
      const int first = q >> c & 1 ? MPSI_SIDE : 0;
      if (first + nodes->low[c] - 1 < low[c]) low[c] = first + nodes->low[c] - 1;
      if (first + nodes->high[c] > high[c]) high[c] = first + nodes->high[c];
    }
  }
  return any;
}

typedef void (*corner_fn)(const mpsi_inside_search *of, const mpsi_cell_block *cells, const int *at,
                          void *data);

/* Corners of a particle's own cell, tile nodes from[] to to[]: those of both cells where it is on
 * their border. Returns whether it is on none. */
static bool find_own_corners(const mpsi_grid *grid, const mpsi_columns *p,
                             const mpsi_cell_block *cells, int64_t k, int *from, int *to) {
  bool within = true;
  for (int c = 0; c < grid->dim; c++) {
    /* counted from the block: not negative, so that truncation is floor */
    const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
    const double low = (double)(grid->low[c] - first), last = (double)(grid->high[c] - 1 - first);
    const double X = mpsi_grid_at(grid, c, p->x[c][k]) - (double)first;
    const double own = X < low ? low : X < last ? (double)(int)X : last;
    const bool below = X - own < MPSI_ON_BORDER && own > low;
    const bool above = own + 1.0 - X < MPSI_ON_BORDER && own < last;
    from[c] = (int)own + above;
    to[c] = (int)own + !below;
    within = within && !below && !above;
  }
  return within;
}

/* Calls `work` for the corners of all cells with particles that may have corners inside bodies,
 * for some corners more than once. */
static void for_corners(const mpsi_inside_search *of, const mpsi_cell_block *cells, corner_fn work,
                        void *data) {
  int low[3], high[3];
  if (cells->pairs == 0 || !cells_near(of->grid, cells, low, high)) return;
  bool seen[MPSI_TILE_SIDE * MPSI_TILE_SIDE * MPSI_TILE_SIDE];
  memset(seen, 0, (size_t)of->grid->tile_nodes * sizeof *seen);
  for (int64_t k = cells->begin;
       (k = of->kernels->next_in(of->grid, of->p, cells, low, high, k)) < cells->end; k++) {
    int from[3] = {0}, to[3] = {0}, at[3];
    const bool within = find_own_corners(of->grid, of->p, cells, k, from, to);
    bool *here = &seen[mpsi_tile_index(from[0], from[1], from[2])], near = !within || !*here;
    for (int c = 0; c < of->grid->dim; c++) near = near && to[c] > low[c] && from[c] < high[c];
    if (!near) continue;
    if (within) *here = true;
    for (at[2] = from[2]; at[2] <= to[2]; at[2]++)
      for (at[1] = from[1]; at[1] <= to[1]; at[1]++)
        for (at[0] = from[0]; at[0] <= to[0]; at[0]++) work(of, cells, at, data);
  }
}

/* Surface normals of the bodies that contain node `local` of a block. */
static void find_normals(const mpsi_grid *grid, const mpsi_contacts *contacts,
                         const mpsi_node_block *nodes, int local) {
  double x[3];
  mpsi_node_place(grid, nodes->at, local, x);
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    const int64_t at = (int64_t)t * grid->block_nodes + local;
    if (!contacts->held[at]) continue;
    const mps_body *body = contacts->body[contacts->node_pair[t].body];
    const mpsi_foot foot = mpsi_body_foot(body, x);
    for (int c = 0; c < 3; c++) contacts->normal[at][c] = c < grid->dim ? foot.normal[c] : 0.0;
  }
}

/* Marks a node as reached. Threads on several blocks may mark the same node at once: the first
 * finds the normals there. */
static void mark_node(const mpsi_inside_search *of, const mpsi_cell_block *cells, const int *at,
                      void *data) {
  _Atomic uint8_t *reached = data;
  const int64_t node = mpsi_node_under(of->grid, cells, at[0], at[1], at[2]);
  const mpsi_node_block *nodes = &of->grid->nodes[node / of->grid->block_nodes];
  const int local = (int)(node % of->grid->block_nodes);
  reached += mpsi_first_node(of->grid, nodes->near) + local;
  if (atomic_load_explicit(reached, memory_order_relaxed) ||
      atomic_exchange_explicit(reached, 1, memory_order_relaxed))
    return;
  if (nodes->inside) find_normals(of->grid, of->contact, nodes, local);
}

void mpsi_mpm_mark_reached(void *search, int64_t b, int32_t worker) {
  const mpsi_inside_search *of = search;
  for_corners(of, &of->grid->cells[b], mark_node, of->contact->reached);
}

static void set_corner_bit(const mpsi_inside_search *of, const mpsi_cell_block *cells,
                           const int *at, void *data) {
  const int t = mpsi_tile_index(at[0], at[1], at[2]);
  ((uint64_t *)data)[t / 64] |= UINT64_C(1) << t % 64;
}

static void mark_ghost_corners(const mpsi_inside_search *of, int64_t b, const uint64_t *bits) {
  for (int t = 0; t < of->grid->tile_nodes; t++) {
    int at[3];
    if (!(bits[t / 64] >> t % 64 & 1)) continue;
    mpsi_unravel(t, MPSI_TILE_SIDE, at);
    mark_node(of, &of->grid->cells[b], at, of->contact->reached);
  }
}

/* Words of one bit for each node of a tile; the last one: whether the block is two-sided. */
static int64_t corner_words(const mpsi_grid *grid) { return (grid->tile_nodes + 63) / 64 + 1; }

static void pack_corners(void *search, int64_t b, int32_t worker, double *message) {
  const mpsi_inside_search *of = search;
  uint64_t *bits = (uint64_t *)message;
  memset(bits, 0, (size_t)corner_words(of->grid) * sizeof *bits);
  if (of->failed) return;
  for_corners(of, &of->grid->cells[b], set_corner_bit, bits);
  bits[corner_words(of->grid) - 1] = of->grid->cells[b].thin;
}

/* On several ranks: exchanges the corners of cells with particles, and whether thin bodies
 * make nodes of the block two-sided. */
mps_status mpsi_mpm_exchange_corners(mpsi_inside_search *of, mpsi_partition *partition,
                                     const char *function) {
  const int64_t words = corner_words(of->grid); /* fewer than a tile has */
  const mps_status status =
      mpsi_mpm_exchange_messages(of->context, partition, function, words, pack_corners, of);
  for (int64_t b = 0; !of->failed && status == MPS_OK && b < of->grid->cell_count; b++) {
    mpsi_cell_block *cells = &of->grid->cells[b];
    double *message;
    if (!cells->ghost) continue;
    (void)mpsi_mpm_find_message(partition, cells, &message);
    mark_ghost_corners(of, b, (const uint64_t *)message);
    cells->thin = ((const uint64_t *)message)[words - 1] != 0;
  }
  return status;
}

/* ---- states of the nodes under a tile -------------------------------------------------------- */

/* Range, low to high - 1, of the tile's nodes along axis c that are in the domain or beyond a
 * mirror. */
static void domain_under(const mpsi_grid *grid, const mpsi_cell_block *cells, int c, int *low,
                         int *high) {
  const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
  *low = grid->use_low[c] > first ? (int)(grid->use_low[c] - first) : 0;
  *high = grid->use_high[c] < first + MPSI_TILE_SIDE ? (int)(grid->use_high[c] - first) + 1
                                                     : MPSI_TILE_SIDE;
}

static void mark_outside(const mpsi_grid *grid, const mpsi_cell_block *cells, uint8_t *state) {
  int low[3] = {0}, high[3] = {1, 1, 1};
  for (int c = 0; c < grid->dim; c++) domain_under(grid, cells, c, &low[c], &high[c]);
  memset(state, MPSI_OUTSIDE, (size_t)grid->tile_nodes);
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1] && low[0] < high[0]; j++)
      memset(state + mpsi_tile_index(low[0], j, k), grid->standard ? MPSI_PLAIN : 0,
             (size_t)(high[0] - low[0]));
}

/* States of the nodes in bodies or beside thin ones, of the block under corner q of the tile. */
static void mark_near(const mpsi_grid *grid, const mpsi_contacts *contacts,
                      const mpsi_node_block *nodes, int q, mpsi_worker *worker) {
  int from[3] = {0}, to[3] = {1, 1, 1}, shift[3] = {0};
  for (int c = 0; c < grid->dim; c++) {
    const int size = q >> c & 1 ? MPSI_TILE_SIDE - MPSI_SIDE : MPSI_SIDE;
    shift[c] = q >> c & 1 ? MPSI_SIDE : 0;
    from[c] = nodes->thin ? 0 : nodes->low[c];
    to[c] = nodes->thin || nodes->high[c] > size ? size : nodes->high[c];
  }
  const int64_t first = mpsi_first_node(grid, nodes->near);
  for (int k = from[2]; k < to[2]; k++)
    for (int j = from[1]; j < to[1]; j++)
      for (int i = from[0]; i < to[0]; i++) {
        const int64_t at = first + (k * MPSI_SIDE + j) * MPSI_SIDE + i;
        const int t = mpsi_tile_index(shift[0] + i, shift[1] + j, shift[2] + k);
        if (nodes->thin && contacts->beside[at]) worker->state[t] |= MPSI_THIN;
        if (!contacts->inside[at]) continue;
        const bool reached =
            atomic_load_explicit(&contacts->reached[at], memory_order_relaxed) != 0;
        worker->state[t] |= (uint8_t)(contacts->inside[at] | (reached ? MPSI_REACHED : 0));
      }
}

void mpsi_mpm_find_states(const mpsi_transfer *work) {
  const mpsi_grid *grid = work->grid;
  mark_outside(grid, work->cells, work->worker->state);
  for (int q = 0; q < 1 << grid->dim; q++) {
    const mpsi_node_block *nodes = &grid->nodes[work->cells->to[q]];
    if (nodes->inside || nodes->thin) mark_near(grid, work->contact, nodes, q, work->worker);
  }
  if (work->cells->mirrors) mpsi_mpm_mirror_states(work);
}
