/* faces.c - what lies beyond the faces of the cells, and the part of each that is filled.
 *
 * A cell at a free surface is filled in part, f = sum V/h^dim, along each of the m axes on which it
 * has nothing beside it by f^(1/m); p is then the pressure at the centre of that part. At a drained
 * surface a cell less than half full would need short steps with explicit pressures: it stores
 * nothing and lies on the line between its neighbour inside and the surface. Most cells have others
 * on all their faces, which the marks of a block show for all its cells at once.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "halo.h"
#include "water.h"

#include <string.h>

/* ---- marks ----------------------------------------------------------------------------------- */

#define FIRST_ALONG_X UINT64_C(0x0101010101010101)
enum { LAST = MPSI_SIDE - 1 };

static const uint64_t *marks_of(const mpsi_water *water, int64_t g, bool full) {
  return full ? water->block[g].full : water->block[g].filled;
}

/* The word of a plane of the block beside g, or none. */
static uint64_t word_beside(const mpsi_water *water, int64_t g, bool full, int direction,
                            int plane) {
  const int32_t block = water->block[g].beside[direction];
  return block < 0 ? 0 : marks_of(water, block, full)[plane];
}

/* The marks of a plane moved by one cell, as seen from the cell on the other side of the face. */
static uint64_t seen(const mpsi_grid *grid, const mpsi_water *water, int64_t g, bool full,
                     int direction, int plane) {
  const uint64_t *own = marks_of(water, g, full);
  const int planes = grid->dim == 3 ? MPSI_SIDE : 1;
  const uint64_t beyond = direction < 4
                              ? word_beside(water, g, full, direction, plane)
                              : word_beside(water, g, full, direction, direction == 4 ? LAST : 0);
  switch (direction) {
  case 0:
    return (own[plane] << 1 & ~FIRST_ALONG_X) | (beyond >> LAST & FIRST_ALONG_X);
  case 1:
    return (own[plane] >> 1 & ~(FIRST_ALONG_X << LAST)) | (beyond & FIRST_ALONG_X) << LAST;
  case 2:
    return own[plane] << MPSI_SIDE | beyond >> (LAST * MPSI_SIDE);
  case 3:
    return own[plane] >> MPSI_SIDE | beyond << (LAST * MPSI_SIDE);
  case 4:
    return plane > 0 ? own[plane - 1] : beyond;
  default:
    return plane + 1 < planes ? own[plane + 1] : beyond;
  }
}

void mpsi_pore_surrounded(const mpsi_grid *grid, const mpsi_water *water, int64_t g, bool full,
                          uint64_t *out) {
  for (int plane = 0; plane < (grid->dim == 3 ? MPSI_SIDE : 1); plane++) {
    out[plane] = water->block[g].filled[plane];
    for (int d = 0; d < 2 * grid->dim && out[plane]; d++)
      out[plane] &= seen(grid, water, g, full, d, plane);
  }
}

/* Cells at a side of the domain have nothing beyond it, whatever has left through it. */
static void leave_sides(const mpsi_grid *grid, int64_t g, uint64_t *marks) {
  const int32_t *at = grid->nodes[g].at;
  for (int c = 0; c < grid->dim; c++) {
    const int64_t first = (int64_t)at[c] * MPSI_SIDE;
    for (int i = 0; i < MPSI_SIDE; i++) {
      if (first + i > grid->low[c] && first + i + 1 < grid->high[c]) continue;
      if (c == 2) marks[i] = 0;
      for (int plane = 0; c < 2 && plane < (grid->dim == 3 ? MPSI_SIDE : 1); plane++)
        marks[plane] &= ~(c == 0 ? FIRST_ALONG_X << i : UINT64_C(0xff) << (MPSI_SIDE * i));
    }
  }
}

/* ---- faces ----------------------------------------------------------------------------------- */

static bool in_body(const mpsi_contacts *contacts, const double *x) {
  for (int32_t b = 0; b < contacts->bodies; b++)
    if (mpsi_body_foot(contacts->body[b], x).distance < 0.0) return true;
  return false;
}

/* The last definition that holds the face's centre x and direction, or -1. */
static int find_face(const mpsi_grid *grid, mpsi_water *water, const double *x, int direction) {
  for (int64_t f = water->face_count - 1; f >= 0; f--) {
    const mps_pore_face_def *def = &water->face[f];
    bool in = def->sides == 0 || (def->sides >> direction & 1) != 0;
    for (int c = 0; c < grid->dim; c++) in = in && x[c] >= def->lower[c] && x[c] <= def->upper[c];
    if (in) return (int)f;
  }
  return -1;
}

/* What is beyond face `direction` of cell k of block g, whose box has its centre at x. */
static void find_beyond(const mpsi_grid *grid, const mpsi_contacts *contacts, mpsi_water *water,
                        int64_t g, int k, int direction, const double *x, mpsi_pore_cell *cell,
                        mpsi_pore_faces *faces) {
  const int axis = direction / 2, up = direction & 1;
  int place[3];
  mpsi_unravel(k, MPSI_SIDE, place);
  const int64_t at = (int64_t)grid->nodes[g].at[axis] * MPSI_SIDE + place[axis];
  const bool side = up ? at + 1 >= grid->high[axis] : at <= grid->low[axis];
  const double half = up ? 0.5 * grid->cell : -0.5 * grid->cell;
  double to[3] = {x[0], x[1], x[2]};
  faces->beyond[direction] = MPSI_PORE_CELL;
  faces->face[direction] = -1;
  if (!side && mpsi_pore_beside(grid, water, g, k, direction)) return;
  to[axis] += 2.0 * half;
  if (!side) cell->free |= (uint8_t)(1u << direction);
  const bool closed = side || in_body(contacts, to);
  to[axis] = x[axis] + half;
  const int face = find_face(grid, water, to, direction);
  faces->face[direction] = (int8_t)face;
  faces->beyond[direction] = closed ? MPSI_PORE_CLOSED : MPSI_PORE_DRAINED;
  if (face >= 0)
    faces->beyond[direction] =
        water->face[face].kind == MPS_PORE_FACE_DRAINED ? MPSI_PORE_DRAINED : MPSI_PORE_CLOSED;
}

/* The filled part of a cell whose box is at radius r. */
static void find_filled(const mpsi_grid *grid, mpsi_water *water, double r, mpsi_pore_cell *cell,
                        mpsi_pore_faces *faces) {
  const double h = grid->cell;
  const double box = (grid->dim == 3 ? h * h * h : h * h) * r;
  int axes = 0;
  for (int c = 0; c < grid->dim; c++) axes += (cell->free >> (2 * c) & 3) != 0;
  const double f = axes == 0 ? 1.0 : fmin(1.0, cell->volume / (grid->measure * box));
  const double part = axes <= 1 ? f : axes == 2 ? sqrt(f) : cbrt(f);
  faces->space = box * f;
  for (int c = 0; c < 3; c++) {
    const int sides = c < grid->dim ? cell->free >> (2 * c) & 3 : 0;
    faces->fill[c] = sides != 0 ? part : 1.0;
    faces->shift[c] = 0.5 * h * (1.0 - faces->fill[c]) *
                      (sides == 1   ? 1.0
                       : sides == 2 ? -1.0
                                    : 0.0);
    cell->p += c < grid->dim ? cell->g[c] * faces->shift[c] : 0.0;
  }
  const bool stores = !water->flows || !mpsi_pore_responds(water); /* whatever its filled part */
  for (int d = 0; d < 2 * grid->dim && !stores; d++)
    if (f < 0.5 && (cell->free >> d & 1) && faces->beyond[d] == MPSI_PORE_DRAINED)
      cell->thin = true;
}

/* Of a cell that is not inside. */
static void find_edge(const mpsi_grid *grid, const mpsi_contacts *contacts, mpsi_water *water,
                      int64_t g, int k, const int *place, mpsi_pore_cell *cell) {
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  const double local[3] = {place[0] + 0.5, place[1] + 0.5, place[2] + 0.5};
  mpsi_pore_faces *faces = water->faces + (cell - water->cell);
  double x[3];
  mpsi_node_position(grid, grid->nodes[g].at, local, x);
  for (int d = 0; d < 2 * grid->dim; d++)
    find_beyond(grid, contacts, water, g, k, d, x, cell, faces);
  find_filled(grid, water, ring ? x[0] : 1.0, cell, faces);
}

static void find_faces(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_water *water = mpm->water;
  mpsi_pore_cell *cell = water->cell + mpsi_first_node(&mpm->grid, g);
  mpsi_pore_block *block = &water->block[g];
  uint64_t inside[MPSI_PORE_WORDS] = {0};
  if (mpm->grid.geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC) {
    mpsi_pore_surrounded(&mpm->grid, water, g, false, inside);
    leave_sides(&mpm->grid, g, inside);
  }
  memcpy(block->full, inside, sizeof block->full);
  memcpy(block->inside, inside, sizeof block->inside);
  for (int w = 0; w < MPSI_PORE_WORDS; w++)
    for (uint64_t left = block->filled[w] & ~inside[w]; left; left &= left - 1) {
      const int k = 64 * w + mpsi_pore_lowest(left);
      int place[3];
      mpsi_unravel(k, MPSI_SIDE, place);
      cell[k].inside = false;
      find_edge(&mpm->grid, &mpm->contact, water, g, k, place, &cell[k]);
      if (cell[k].free == 0) mpsi_pore_mark(block->full, k);
      if (!water->flows && !water->expecting)
        cell[k].now = cell[k].p + mpsi_pore_squeeze(water, &cell[k]);
    }
}

void mpsi_pore_find_faces(mps_mpm *mpm) {
  const mpsi_pass faces = {.data = mpm, .finish = find_faces};
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &faces);
  mpsi_pore_exchange(mpm, MPSI_PORE_EDGES);
}
