/* cells.c - pressures of cells: sums over the particles of a cell, and what lies beyond its faces.
 *
 * A cell's pressure is the mean over its particles of p + g.(x_c - x), each particle carrying its
 * own p and g = grad p; means are weighted by volumes. A cell at a free surface is filled in part,
 * f = sum V/h^dim, along each of the m axes on which it has nothing beside it by f^(1/m); p is then
 * the pressure at the centre of that part. At a drained surface a cell less than half full would
 * need short steps: it stores nothing and lies on the line between its neighbour inside and the
 * surface. SPDX-License-Identifier: BSD-3-Clause */
#include "water.h"

/* ---- sums ------------------------------------------------------------------------------------ */

/* Empty: what its first particles give takes the place of the rest. */
static void clear(mps_mpm *mpm, int64_t g, int32_t worker) {
  mpsi_pore_cell *cell = mpm->water->cell + mpsi_first_node(&mpm->grid, g);
  (void)worker;
  for (int k = 0; k < mpm->grid.block_nodes; k++) cell[k].volume = 0.0;
}

/* The first node of a block of cells, and the last cells of its tile, or of the domain. */
typedef struct tile {
  double first[3];
  int last[3];
} tile;

static tile tile_of(const mpsi_grid *grid, const mpsi_cell_block *cells) {
  tile out = {{0.0}, {0}};
  for (int c = 0; c < grid->dim; c++) {
    const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE, most = grid->high[c] - 1 - first;
    out.first[c] = (double)first;
    out.last[c] = most < MPSI_TILE_SIDE - 1 ? (int)most : MPSI_TILE_SIDE - 1;
  }
  return out;
}

/* See mpsi_pore_cell_at. A particle that has left the domain is in the nearest cell. */
MPSI_INLINE int find_place(const mpsi_grid *grid, const mpsi_columns *p, const tile *in, int dim,
                           int64_t particle) {
  int corner = 0, local = 0;
  for (int c = 0; c < dim; c++) {
    const double X = mpsi_grid_at(grid, c, p->x[c][particle]) - in->first[c];
    int cell = X > 0.0 ? (int)X : 0; /* without a call of floor */
    cell = cell < in->last[c] ? cell : in->last[c];
    corner |= (cell >= MPSI_SIDE) << c;
    local |= (cell & (MPSI_SIDE - 1)) << (MPSI_PORE_BITS * c);
  }
  return corner * MPSI_PORE_BLOCK + local;
}

/* What some particles of a cell give to it. */
typedef struct cell_sums {
  double volume, change, p, g[3], n, k;
} cell_sums;

MPSI_INLINE void add_to_cell(int dim, mpsi_pore_cell *cell, const cell_sums *sum) {
  const bool empty = !(cell->volume > 0.0);
  cell->volume = (empty ? 0.0 : cell->volume) + sum->volume;
  cell->change = (empty ? 0.0 : cell->change) + sum->change;
  cell->p = (empty ? 0.0 : cell->p) + sum->p;
  cell->n = (empty ? 0.0 : cell->n) + sum->n;
  cell->k = (empty ? 0.0 : cell->k) + sum->k;
  for (int c = 0; c < 3; c++) cell->g[c] = (empty ? 0.0 : cell->g[c]) + (c < dim ? sum->g[c] : 0.0);
}

/* Particles of a stencil are neighbours: those in a row that are in the same cell are summed before
 * they are added to it. */
MPSI_INLINE void sum_body(const mpsi_grid *grid, const mpsi_columns *p, mpsi_water *water,
                          int64_t b, int dim) {
  const mpsi_cell_block *cells = &grid->cells[b];
  const double *former = water->former;
  uint16_t *place = water->place;
  const tile in = tile_of(grid, cells);
  for (int64_t k = cells->begin; k < cells->end; k++)
    place[k] = (uint16_t)find_place(grid, p, &in, dim, k);
  for (int64_t k = cells->begin; k < cells->end;) {
    const int at = place[k];
    double centre[3];
    mpsi_pore_cell *cell = mpsi_pore_cell_at(grid, water, cells, at, centre);
    cell_sums sum = {.volume = 0.0};
    for (; k < cells->end && place[k] == at; k++) {
      const double V = p->V[k];
      double there = p->u[k];
      for (int c = 0; c < dim; c++) {
        there += p->g[c][k] * (centre[c] - p->x[c][k]);
        sum.g[c] += V * p->g[c][k];
      }
      sum.volume += V;
      sum.change += V - former[k];
      sum.p += V * there;
      sum.n += V * p->n[k];
      if (p->k) sum.k += V * p->k[k];
    }
    add_to_cell(dim, cell, &sum);
  }
}

static void sum_particles(mps_mpm *mpm, int64_t b, int32_t worker) {
  (void)worker;
  if (mpm->grid.dim == 2)
    sum_body(&mpm->grid, &mpm->p, mpm->water, b, 2);
  else
    sum_body(&mpm->grid, &mpm->p, mpm->water, b, 3);
}

static void find_means(mps_mpm *mpm, int64_t g, int32_t worker) {
  mpsi_pore_cell *cell = mpm->water->cell + mpsi_first_node(&mpm->grid, g);
  (void)worker;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (mpsi_pore_empty(&cell[k])) continue;
    const double inverse = 1.0 / cell[k].volume;
    cell[k].p *= inverse;
    cell[k].n *= inverse;
    cell[k].k *= inverse;
    for (int c = 0; c < mpm->grid.dim; c++) cell[k].g[c] *= inverse;
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
  for (int64_t f = water->faces - 1; f >= 0; f--) {
    const mps_pore_face_def *def = &water->face[f];
    bool in = def->sides == 0 || (def->sides >> direction & 1) != 0;
    for (int c = 0; c < grid->dim; c++) in = in && x[c] >= def->lower[c] && x[c] <= def->upper[c];
    if (in) return (int)f;
  }
  return -1;
}

/* Whether cell k of block g has others on all its faces: most have. */
static bool is_inside(const mpsi_grid *grid, mpsi_water *water, int64_t g, int k,
                      const int *place) {
  for (int c = 0; c < grid->dim; c++) {
    const int64_t at = (int64_t)grid->nodes[g].at[c] * MPSI_SIDE + place[c];
    if (at + 1 >= grid->high[c] || at <= grid->low[c]) return false;
    if (mpsi_pore_empty(mpsi_pore_beside(grid, water, g, k, 2 * c))) return false;
    if (mpsi_pore_empty(mpsi_pore_beside(grid, water, g, k, 2 * c + 1))) return false;
  }
  return true;
}

/* What is beyond face `direction` of cell k of block g, whose box has its centre at x. */
static void find_beyond(const mpsi_grid *grid, const mpsi_contacts *contacts, mpsi_water *water,
                        int64_t g, int k, int direction, const double *x, mpsi_pore_cell *cell,
                        mpsi_pore_edge *edge) {
  const int axis = direction / 2, up = direction & 1;
  int place[3];
  mpsi_unravel(k, MPSI_SIDE, place);
  const int64_t at = (int64_t)grid->nodes[g].at[axis] * MPSI_SIDE + place[axis];
  const bool side = up ? at + 1 >= grid->high[axis] : at <= grid->low[axis];
  const double half = up ? 0.5 * grid->cell : -0.5 * grid->cell;
  double to[3] = {x[0], x[1], x[2]};
  edge->beyond[direction] = MPSI_PORE_CELL;
  edge->face[direction] = -1;
  if (!side && !mpsi_pore_empty(mpsi_pore_beside(grid, water, g, k, direction))) return;
  to[axis] += 2.0 * half;
  if (!side) cell->free |= (uint8_t)(1u << direction);
  const bool closed = side || in_body(contacts, to);
  to[axis] = x[axis] + half;
  const int face = find_face(grid, water, to, direction);
  edge->face[direction] = (int8_t)face;
  edge->beyond[direction] = closed ? MPSI_PORE_CLOSED : MPSI_PORE_DRAINED;
  if (face >= 0)
    edge->beyond[direction] =
        water->face[face].kind == MPS_PORE_FACE_DRAINED ? MPSI_PORE_DRAINED : MPSI_PORE_CLOSED;
}

/* The filled part of a cell whose box is at radius r. */
static void find_filled(const mpsi_grid *grid, mpsi_water *water, double r, mpsi_pore_cell *cell,
                        mpsi_pore_edge *edge) {
  const double h = grid->cell;
  const double box = (grid->dim == 3 ? h * h * h : h * h) * r;
  int axes = 0;
  for (int c = 0; c < grid->dim; c++) axes += (cell->free >> (2 * c) & 3) != 0;
  const double f = axes == 0 ? 1.0 : fmin(1.0, cell->volume / (grid->measure * box));
  const double part = axes <= 1 ? f : axes == 2 ? sqrt(f) : cbrt(f);
  edge->space = box * f;
  for (int c = 0; c < 3; c++) {
    const int sides = c < grid->dim ? cell->free >> (2 * c) & 3 : 0;
    edge->fill[c] = sides != 0 ? part : 1.0;
    edge->shift[c] = 0.5 * h * (1.0 - edge->fill[c]) * (sides == 1 ? 1.0 : sides == 2 ? -1.0 : 0.0);
    cell->p += c < grid->dim ? cell->g[c] * edge->shift[c] : 0.0;
  }
  for (int d = 0; d < 2 * grid->dim && water->flows; d++)
    if (f < 0.5 && (cell->free >> d & 1) && edge->beyond[d] == MPSI_PORE_DRAINED) cell->thin = true;
}

/* Of a cell that is not inside. */
static void find_edge(const mpsi_grid *grid, const mpsi_contacts *contacts, mpsi_water *water,
                      int64_t g, int k, const int *place, mpsi_pore_cell *cell) {
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  const double local[3] = {place[0] + 0.5, place[1] + 0.5, place[2] + 0.5};
  mpsi_pore_edge *edge = water->edge + (cell - water->cell);
  double x[3];
  mpsi_node_position(grid, grid->nodes[g].at, local, x);
  for (int d = 0; d < 2 * grid->dim; d++)
    find_beyond(grid, contacts, water, g, k, d, x, cell, edge);
  find_filled(grid, water, ring ? x[0] : 1.0, cell, edge);
}

static void find_faces(mps_mpm *mpm, int64_t g, int32_t worker) {
  mpsi_pore_cell *cell = mpm->water->cell + mpsi_first_node(&mpm->grid, g);
  const bool ring = mpm->grid.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  (void)worker;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (mpsi_pore_empty(&cell[k])) continue;
    int place[3];
    mpsi_unravel(k, MPSI_SIDE, place);
    cell[k].inside = !ring && is_inside(&mpm->grid, mpm->water, g, k, place);
    cell[k].free = 0;
    cell[k].thin = false;
    if (!cell[k].inside) find_edge(&mpm->grid, &mpm->contact, mpm->water, g, k, place, &cell[k]);
    if (!mpm->water->flows) cell[k].now = cell[k].p + mpsi_pore_squeeze(mpm->water, &cell[k]);
  }
}

void mpsi_pore_find_cells(mps_mpm *mpm) {
  const mpsi_pass sums = {.clear = clear, .scatter = sum_particles, .update = find_means};
  const mpsi_pass faces = {.finish = find_faces};
  mpsi_mpm_run_pass(mpm, &sums);
  mpsi_mpm_run_pass(mpm, &faces);
}
