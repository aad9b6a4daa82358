/* near.c - before each step: which blocks meet which bodies, which of their nodes lie inside a body
 * or outside the domain, and which are corners of cells that hold particles. These decide which
 * nodes a particle near a body may use (seed B 5.1, with the same-side test).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include <string.h>

/* Half the diagonal of a tile, in cells, and a little for round-off: a body that has a node of the
 * tile inside is no further than that from its centre. */
#define TILE_REACH (0.5 * (MPSI_TILE_SIDE - 1) * 1.4143)

static void node_position(const mps_mpm *mpm, const int32_t *at, double i, double j, double *x) {
  x[0] = mpm->def.origin[0] + mpm->def.cell * ((double)at[0] * MPSI_SIDE + i);
  x[1] = mpm->def.origin[1] + mpm->def.cell * ((double)at[1] * MPSI_SIDE + j);
}

/* Numbers the meetings; false where there is no room for them all, `count` and `near` say how many
 * there are. */
static bool list_meetings(mps_mpm *mpm, int64_t *count, int64_t *near) {
  const double middle = 0.5 * (MPSI_TILE_SIDE - 1), reach = TILE_REACH * mpm->def.cell;
  *count = *near = 0;
  for (int64_t b = 0; b < mpm->cell_count; b++) {
    mpsi_cells *cells = &mpm->cells[b];
    double x[2];
    node_position(mpm, cells->at, middle, middle, x);
    cells->first_meeting = (int32_t)*count;
    for (int32_t k = 0; k < mpm->bodies; k++) {
      int32_t *slot = &mpm->meeting_of[b * mpm->bodies + k];
      *slot = -1;
      if (mpsi_body_foot(mpm->body[k], x).distance > reach) continue;
      *slot = (int32_t)(*count)++;
      if (*count > mpm->meeting_room.capacity) continue;
      mpsi_meeting *meeting = (mpsi_meeting *)mpm->meeting_room.item + *slot;
      meeting->cells = (int32_t)b;
      meeting->body = k;
    }
    cells->meetings = (int32_t)*count - cells->first_meeting;
    cells->near = cells->meetings > 0 ? (int32_t)(*near)++ : -1;
  }
  return *count <= mpm->meeting_room.capacity && *near <= mpm->near_room.capacity;
}

/* The blocks of nodes that each body touches. The same in two goes: see list_meetings. */
static bool list_touches(mps_mpm *mpm, int64_t *count) {
  *count = 0;
  for (int64_t g = 0; g < mpm->node_count; g++) {
    mpm->touch_first[g] = (int32_t)*count;
    for (int32_t k = 0; k < mpm->bodies; k++) {
      mpsi_touch touch = {.nodes = (int32_t)g, .body = k};
      bool any = false;
      for (int q = 0; q < 4; q++) {
        const int32_t b = mpm->nodes[g].from[q];
        touch.from[q] = b < 0 ? -1 : mpm->meeting_of[(int64_t)b * mpm->bodies + k];
        any = any || touch.from[q] >= 0;
      }
      if (!any) continue;
      if (*count < mpm->touch_room.capacity) {
        mpsi_touch *to = (mpsi_touch *)mpm->touch_room.item + *count;
        to->nodes = touch.nodes, to->body = touch.body, to->mass = 0.0;
        memcpy(to->from, touch.from, sizeof to->from);
      }
      (*count)++;
    }
  }
  mpm->touch_first[mpm->node_count] = (int32_t)*count;
  return *count <= mpm->touch_room.capacity;
}

static void mark_reached(mps_mpm *mpm, int64_t b) {
  const mpsi_cells *cells = &mpm->cells[b];
  if (cells->near < 0) return;
  uint8_t *reached = mpm->near[cells->near].reached;
  memset(reached, 0, MPSI_TILE);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    int64_t at[2];
    for (int c = 0; c < 2; c++)
      at[c] = mpsi_own_cell(mpm, c, mpsi_grid_coordinate(mpm, c, mpm->p.x[c][k])) -
              (int64_t)cells->at[c] * MPSI_SIDE;
    uint8_t *corner = reached + at[1] * MPSI_TILE_SIDE + at[0];
    corner[0] = corner[1] = corner[MPSI_TILE_SIDE] = corner[MPSI_TILE_SIDE + 1] = 1;
  }
}

/* Normals at the nodes inside a body. */
static void find_inside(const mps_mpm *mpm, const mpsi_cells *cells, mpsi_meeting *meeting,
                        uint8_t *state) {
  for (int j = 0; j < MPSI_TILE_SIDE; j++)
    for (int i = 0; i < MPSI_TILE_SIDE; i++) {
      const int t = j * MPSI_TILE_SIDE + i;
      double x[2];
      node_position(mpm, cells->at, i, j, x);
      const mpsi_foot foot = mpsi_body_foot(mpm->body[meeting->body], x);
      const bool inside = foot.distance < 0.0;
      for (int c = 0; c < 2; c++) meeting->normal[c][t] = inside ? foot.normal[c] : 0.0;
      if (inside) state[t] |= MPSI_INSIDE;
    }
}

/* Corners that this block's particles, or those of a block whose tile shares the node, have. A node
 * inside a body makes every block that has it in its tile a near one, so none is missed. */
static void gather_reached(const mps_mpm *mpm, const mpsi_cells *cells, uint8_t *state) {
  for (int q = 0; q < 4; q++) {
    const mpsi_nodes *nodes = &mpm->nodes[cells->to[q]];
    const int i0 = MPSI_SIDE * (q & 1), j0 = MPSI_SIDE * (q >> 1);
    for (int f = 0; f < 4; f++) {
      if (nodes->from[f] < 0) continue;
      const int32_t near = mpm->cells[nodes->from[f]].near;
      if (near < 0) continue;
      const int fi = MPSI_SIDE * (f & 1), fj = MPSI_SIDE * (f >> 1);
      for (int j = 0; j + j0 < MPSI_TILE_SIDE && j + fj < MPSI_TILE_SIDE && j < MPSI_SIDE; j++)
        for (int i = 0; i + i0 < MPSI_TILE_SIDE && i + fi < MPSI_TILE_SIDE && i < MPSI_SIDE; i++)
          if (mpm->near[near].reached[(j + fj) * MPSI_TILE_SIDE + i + fi])
            state[(j + j0) * MPSI_TILE_SIDE + i + i0] |= MPSI_REACHED;
    }
  }
}

static void find_states(mps_mpm *mpm, int64_t b) {
  const mpsi_cells *cells = &mpm->cells[b];
  if (cells->near < 0) return;
  uint8_t *state = mpm->near[cells->near].state;
  for (int j = 0; j < MPSI_TILE_SIDE; j++)
    for (int i = 0; i < MPSI_TILE_SIDE; i++) {
      const int64_t x = (int64_t)cells->at[0] * MPSI_SIDE + i;
      const int64_t y = (int64_t)cells->at[1] * MPSI_SIDE + j;
      const bool there =
          x >= mpm->low[0] && x <= mpm->high[0] && y >= mpm->low[1] && y <= mpm->high[1];
      state[j * MPSI_TILE_SIDE + i] = there ? 0 : MPSI_OUTSIDE;
    }
  for (int32_t k = 0; k < cells->meetings; k++)
    find_inside(mpm, cells, &mpm->meeting[cells->first_meeting + k], state);
  gather_reached(mpm, cells, state);
}

mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function) {
  mps_context *context = mpm->context;
  int64_t meetings = 0, near = 0, touches = 0;
  bool good = mpsi_room_ensure(context, &mpm->meeting_of_room, mpm->cell_count * mpm->bodies,
                               sizeof *mpm->meeting_of) &&
              mpsi_room_ensure(context, &mpm->touch_first_room, mpm->node_count + 1,
                               sizeof *mpm->touch_first);
  mpm->meeting_of = mpm->meeting_of_room.item;
  mpm->touch_first = mpm->touch_first_room.item;
  if (good && !list_meetings(mpm, &meetings, &near)) {
    good = mpsi_room_ensure(context, &mpm->meeting_room, meetings, sizeof *mpm->meeting) &&
           mpsi_room_ensure(context, &mpm->near_room, near, sizeof *mpm->near);
    if (good) list_meetings(mpm, &meetings, &near);
  }
  if (good && !list_touches(mpm, &touches)) {
    good = mpsi_room_ensure(context, &mpm->touch_room, touches, sizeof *mpm->touch);
    if (good) list_touches(mpm, &touches);
  }
  if (!good)
    return mpsi_fail_memory(context, function,
                            (size_t)(meetings + 1) * sizeof *mpm->meeting +
                                (size_t)touches * sizeof *mpm->touch);
  mpm->meeting = mpm->meeting_room.item;
  mpm->near = mpm->near_room.item;
  mpm->touch = mpm->touch_room.item;
  mpm->meeting_count = meetings;
  mpm->touch_count = touches;
  if (meetings == 0) return MPS_OK;
  mpsi_mpm_for(mpm, mpm->cell_count, mark_reached);
  mpsi_mpm_for(mpm, mpm->cell_count, find_states);
  return MPS_OK;
}
