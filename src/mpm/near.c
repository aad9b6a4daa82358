/* near.c - before each step: which blocks meet which bodies, which of their nodes lie inside a body
 * or outside the domain, and which are corners of cells that hold particles. These decide which
 * nodes a particle near a body may use (seed B 5.1, with the same-side test), and which blocks have
 * particles with cut supports or need the velocity before the forces.
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
  return mpsi_body_reaches(mpm->body[body], x, half_diagonal(mpm, side) * mpm->def.cell);
}

/* ---- lists ------------------------------------------------------------------------------------
 */

/* Numbers the meetings; false where there is no room for them all, `count` says how many there are.
 */
static bool list_meetings(mps_mpm *mpm, int64_t *count) {
  *count = 0;
  for (int64_t g = 0; g < mpm->node_count; g++) mpm->nodes[g].bodies = 0;
  for (int64_t b = 0; b < mpm->cell_count; b++) {
    mpsi_cells *cells = &mpm->cells[b];
    cells->first_meeting = (int32_t)*count;
    for (int32_t k = 0; k < mpm->bodies; k++) {
      if (!reaches(mpm, k, cells->at, MPSI_TILE_SIDE)) continue;
      for (int q = 0; q < 1 << mpm->dim; q++) mpm->nodes[cells->to[q]].bodies |= UINT32_C(1) << k;
      if (*count < mpm->meeting_room.capacity) {
        mpsi_meeting *meeting = (mpsi_meeting *)mpm->meeting_room.item + *count;
        meeting->cells = (int32_t)b;
        meeting->body = k;
      }
      (*count)++;
    }
    cells->meetings = (int32_t)*count - cells->first_meeting;
  }
  return *count <= mpm->meeting_room.capacity;
}

/* The blocks of nodes that each body may touch. The same in two goes: see list_meetings. */
static bool list_touches(mps_mpm *mpm, int64_t *count, int64_t *near) {
  *count = *near = 0;
  for (int64_t g = 0; g < mpm->node_count; g++) {
    mpsi_nodes *nodes = &mpm->nodes[g];
    nodes->first_touch = (int32_t)*count;
    nodes->near = nodes->bodies ? (int32_t)(*near)++ : -1;
    for (int32_t k = 0; k < mpm->bodies; k++) {
      if (!(nodes->bodies >> k & 1)) continue;
      if (*count < mpm->touch_room.capacity)
        ((mpsi_touch *)mpm->touch_room.item)[*count] = (mpsi_touch){(int32_t)g, k, 0.0};
      (*count)++;
    }
    nodes->touches = (int32_t)*count - nodes->first_touch;
  }
  return *count <= mpm->touch_room.capacity;
}

static mps_status make_lists(mps_mpm *mpm, const char *function) {
  mps_context *context = mpm->context;
  int64_t meetings = 0, touches = 0, near = 0;
  bool good = true;
  if (!list_meetings(mpm, &meetings)) {
    good = mpsi_room_ensure(context, &mpm->meeting_room, meetings, sizeof *mpm->meeting);
    if (good) list_meetings(mpm, &meetings);
  }
  if (good && !list_touches(mpm, &touches, &near)) {
    good = mpsi_room_ensure(context, &mpm->touch_room, touches, sizeof *mpm->touch);
    if (good) list_touches(mpm, &touches, &near);
  }
  const int64_t nodes = touches * mpm->own, masks = near * mpm->own;
  good = good && mpsi_room_ensure(context, &mpm->touch_node_room, nodes, sizeof *mpm->touch_node) &&
         mpsi_room_ensure(context, &mpm->inside_room, masks, sizeof *mpm->inside) &&
         mpsi_room_ensure(context, &mpm->reached_room, masks, sizeof *mpm->reached);
  if (!good)
    return mpsi_fail_memory(context, function,
                            (size_t)(meetings + 1) * sizeof *mpm->meeting +
                                (size_t)nodes * sizeof *mpm->touch_node);
  mpm->meeting = mpm->meeting_room.item;
  mpm->touch = mpm->touch_room.item;
  mpm->touch_node = mpm->touch_node_room.item;
  mpm->inside = mpm->inside_room.item;
  mpm->reached = mpm->reached_room.item;
  mpm->meeting_count = meetings;
  mpm->touch_count = touches;
  mpm->near_count = near;
  return MPS_OK;
}

/* ---- nodes in bodies --------------------------------------------------------------------------
 */

/* Normals at the nodes of a block that lie inside bodies. */
static void find_inside(mps_mpm *mpm, int64_t g, int32_t worker) {
  (void)worker;
  mpsi_nodes *nodes = &mpm->nodes[g];
  nodes->inside = false;
  if (nodes->near < 0) return;
  uint32_t *inside = mpm->inside + mpsi_first_node(mpm, nodes->near);
  memset(inside, 0, (size_t)mpm->own * sizeof *inside);
  memset(mpm->reached + mpsi_first_node(mpm, nodes->near), 0, (size_t)mpm->own);
  for (int32_t t = nodes->first_touch; t < nodes->first_touch + nodes->touches; t++) {
    mpsi_touch_node *touch = mpm->touch_node + (int64_t)t * mpm->own;
    const int32_t b = mpm->touch[t].body;
    memset(touch, 0, (size_t)mpm->own * sizeof *touch);
    if (!reaches(mpm, b, nodes->at, MPSI_SIDE)) continue;
    for (int k = 0; k < mpm->own; k++) {
      int place[3];
      double x[3];
      mpsi_unravel(k, MPSI_SIDE, place);
      const double local[3] = {place[0], place[1], place[2]};
      mpsi_node_position(mpm, nodes->at, local, x);
      const mpsi_foot foot = mpsi_body_foot(mpm->body[b], x);
      if (!(foot.distance < 0.0)) continue;
      for (int c = 0; c < mpm->dim; c++) touch[k].normal[c] = foot.normal[c];
      inside[k] |= UINT32_C(1) << b;
      nodes->inside = true;
    }
  }
}

/* Corners of the cells that hold particles. All blocks of a colour at once: they share no node. */
static void mark_reached(mps_mpm *mpm, int64_t b, int32_t worker) {
  (void)worker;
  const mpsi_cells *cells = &mpm->cells[b];
  if (!cells->cut || cells->meetings == 0) return;
  int last[3] = {-1, -1, -1};
  for (int64_t k = cells->begin; k < cells->end; k++) {
    int at[3] = {0};
    for (int c = 0; c < mpm->dim; c++)
      at[c] = (int)(mpsi_own_cell(mpm, c, mpsi_grid_coordinate(mpm, c, mpm->p.x[c][k])) -
                    (int64_t)cells->at[c] * MPSI_SIDE);
    if (memcmp(at, last, sizeof at) == 0) continue;
    memcpy(last, at, sizeof at);
    for (int q = 0; q < 1 << mpm->dim; q++) {
      const int64_t node =
          mpsi_node_under(mpm, cells, at[0] + (q & 1), at[1] + (q >> 1 & 1), at[2] + (q >> 2));
      const mpsi_nodes *nodes = &mpm->nodes[node / mpm->own];
      mpm->reached[mpsi_first_node(mpm, nodes->near) + node % mpm->own] = 1;
    }
  }
}

/* ---- cut and split blocks ---------------------------------------------------------------------
 */

/* Cut: some particle may have a cut support, or, with the standard scheme, one without a fit.
 * Split: friction needs the velocity before the forces; so does FLIP, and the transfer by weights,
 * which divides momentum and force by different masses. */
static mps_status find_cut(mps_mpm *mpm, const char *function) {
  const bool by_weight = mpm->def.transfer == MPS_TRANSFER_WEIGHT;
  bool finds = false; /* an absorbing wall asks for the forces of its first step */
  for (int32_t k = 0; k < MPSI_WALLS && !(mpm->def.settle > 0.0); k++)
    finds = finds || mpm->hold[k].finds;
  const int corners = 1 << mpm->dim;
  for (int64_t g = 0; g < mpm->node_count; g++)
    mpm->nodes[g].side = -1, mpm->nodes[g].split = false;
  mpm->side_count = 0;
  for (int64_t b = 0; b < mpm->cell_count; b++) {
    mpsi_cells *cells = &mpm->cells[b];
    bool inside = false;
    for (int q = 0; q < corners; q++) inside = inside || mpm->nodes[cells->to[q]].inside;
    bool rough = by_weight || mpm->flip > 0.0 || (finds && cells->edge);
    for (int32_t k = 0; inside && k < cells->meetings; k++)
      rough = rough || mpm->body[mpm->meeting[cells->first_meeting + k].body]->def.friction > 0.0;
    cells->cut = cells->edge || inside || mpm->standard;
    for (int q = 0; q < corners && cells->cut; q++) {
      mpsi_nodes *nodes = &mpm->nodes[cells->to[q]];
      if (nodes->side < 0) nodes->side = (int32_t)mpm->side_count++;
      nodes->split = nodes->split || rough;
    }
  }
  for (int64_t b = 0; b < mpm->cell_count; b++) {
    mpm->cells[b].split = false;
    for (int q = 0; q < corners; q++)
      mpm->cells[b].split = mpm->cells[b].split || mpm->nodes[mpm->cells[b].to[q]].split;
  }
  if (!mpsi_room_ensure(mpm->context, &mpm->side_room, mpm->side_count * mpm->own,
                        sizeof *mpm->side))
    return mpsi_fail_memory(mpm->context, function,
                            (size_t)(mpm->side_count * mpm->own) * sizeof *mpm->side);
  mpm->side = mpm->side_room.item;
  return MPS_OK;
}

mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function) {
  if (mpm->bodies > 0) {
    const mps_status status = make_lists(mpm, function);
    if (status != MPS_OK) return status;
    mpsi_mpm_for_nodes(mpm, find_inside);
  }
  const mps_status status = find_cut(mpm, function);
  if (status == MPS_OK && mpm->meeting_count > 0) mpsi_mpm_for_colours(mpm, mark_reached);
  return status;
}

/* ---- states under a tile ----------------------------------------------------------------------
 */

void mpsi_mpm_find_states(const mps_mpm *mpm, const mpsi_cells *cells, mpsi_worker *worker) {
  for (int t = 0; t < mpm->tile; t++) {
    int place[3];
    bool outside = false;
    mpsi_unravel(t, MPSI_TILE_SIDE, place);
    for (int c = 0; c < mpm->dim; c++) {
      const int64_t n = (int64_t)cells->at[c] * MPSI_SIDE + place[c];
      outside = outside || n < mpm->low[c] || n > mpm->high[c];
    }
    worker->inside[t] = 0;
    worker->state[t] = outside ? MPSI_OUTSIDE : mpm->standard ? MPSI_PLAIN : 0;
    const int64_t node = mpsi_node_under(mpm, cells, place[0], place[1], place[2]);
    const mpsi_nodes *nodes = &mpm->nodes[node / mpm->own];
    if (!nodes->inside) continue;
    const int64_t at = mpsi_first_node(mpm, nodes->near) + node % mpm->own;
    worker->inside[t] = mpm->inside[at];
    if (mpm->inside[at])
      worker->state[t] |= mpm->reached[at] ? MPSI_INSIDE | MPSI_REACHED : MPSI_INSIDE;
  }
}
