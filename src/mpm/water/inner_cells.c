/* inner_cells.c - fluxes and slopes of cells that are filled as a whole, as are those on all their
 * faces (flow.c has the equations, and those of other cells). All cells of a plane of a block are
 * computed, face by face, and what is not asked for is left out. Compiled once for each instruction
 * set. SPDX-License-Identifier: BSD-3-Clause */
#include "cell_loops.h"

#include "mpm/base/loops.h"

#include <float.h>
#include <stddef.h>

enum { SIDE = MPSI_SIDE, PLANE = SIDE * SIDE, WIDE = SIDE + 1 };

/* A quantity of the cells of a plane and of those on its faces. */
typedef struct plane {
  double of[SIDE + 2][SIDE + 2];
} plane;

/* The cells of a block of nodes, and which of them have no free face. */
typedef struct block {
  const mpsi_pore_cell *cell; /* NULL where there is no block */
  const uint64_t *full;
} block;

static block block_of(const mpsi_grid *grid, const mpsi_water *water, int32_t g) {
  if (g < 0) return (block){NULL, NULL};
  return (block){water->cell + mpsi_first_node(grid, g), water->block[g].full};
}

/* The quantity at `offset` of cell c, 0 where it has a free face: no cell among inner ones asks for
 * it, and another thread may be writing the pressure of one at a drained surface. */
MPSI_INLINE double read(const block *from, int c, size_t offset) {
  double out;
  if (!from->cell || !mpsi_pore_marked(from->full, c)) return 0.0;
  memcpy(&out, (const char *)(from->cell + c) + offset, sizeof out);
  return out;
}

/* Plane `z` of block g, with the cells on its sides; 0 where there is no block. */
static void load_plane(const mpsi_grid *grid, const mpsi_water *water, int64_t g, int z,
                       size_t offset, plane *out) {
  const block own = block_of(grid, water, (int32_t)g);
  const int from = z * PLANE;
  block at[4];
  for (int d = 0; d < 4; d++) at[d] = block_of(grid, water, water->block[g].beside[d]);
  for (int j = 0; j < SIDE; j++)
    for (int i = 0; i < SIDE; i++) out->of[j + 1][i + 1] = read(&own, from + j * SIDE + i, offset);
  for (int i = 0; i < SIDE; i++) {
    out->of[i + 1][0] = read(&at[0], from + i * SIDE + SIDE - 1, offset);
    out->of[i + 1][SIDE + 1] = read(&at[1], from + i * SIDE, offset);
    out->of[0][i + 1] = read(&at[2], from + (SIDE - 1) * SIDE + i, offset);
    out->of[SIDE + 1][i + 1] = read(&at[3], from + i, offset);
  }
}

/* The cells of block g in plane z, which may be one beyond it; 0 where there is no block. */
static void load_layer(const mpsi_grid *grid, const mpsi_water *water, int64_t g, int z,
                       size_t offset, double *out) {
  const int32_t to = z < 0 ? water->block[g].beside[4] : water->block[g].beside[5];
  const block of = block_of(grid, water, z < 0 || z == SIDE ? to : (int32_t)g);
  const int from = (z & (SIDE - 1)) * PLANE;
  for (int k = 0; k < PLANE; k++) out[k] = read(&of, from + k, offset);
}

/* k times the drive through the faces of a plane, towards the cell before them: between two cells k
 * is the harmonic mean of theirs. Without flow the drive alone. */
typedef struct faces {
  double x[SIDE][WIDE], y[WIDE][SIDE], below[PLANE], above[PLANE];
} faces;

/* Through one face, of the pressures and permeabilities before and behind it. DBL_MIN: no cell,
 * whose k is 0, divides by zero, which a host may trap; other cells' bits are the same. */
MPSI_INLINE double through(double p0, double p1, double k0, double k1, double inverse, double still,
                           bool flows) {
  const double drive = (p1 - p0) * inverse - still;
  return flows ? 2.0 * k0 * k1 / (k0 + k1 + DBL_MIN) * drive : drive;
}

MPSI_INLINE void find_faces_of(const plane *p, const plane *k, double inverse, const double *still,
                               bool flows, faces *out) {
  for (int j = 0; j < SIDE; j++)
    MPSI_SIMD for (int i = 0; i < WIDE; i++) out->x[j][i] =
        through(p->of[j + 1][i], p->of[j + 1][i + 1], k->of[j + 1][i], k->of[j + 1][i + 1], inverse,
                still[0], flows);
  for (int j = 0; j < WIDE; j++)
    MPSI_SIMD for (int i = 0; i < SIDE; i++) out->y[j][i] =
        through(p->of[j][i + 1], p->of[j + 1][i + 1], k->of[j][i + 1], k->of[j + 1][i + 1], inverse,
                still[1], flows);
}

/* The faces between two planes of cells. */
MPSI_INLINE void find_faces_between(const double *p0, const double *p1, const double *k0,
                                    const double *k1, double inverse, double still, bool flows,
                                    double *out) {
  MPSI_SIMD for (int i = 0; i < PLANE; i++) out[i] =
      through(p0[i], p1[i], k0[i], k1[i], inverse, still, flows);
}

/* What a loop over the planes of a block reads: pressures at `offset`. */
typedef struct reading {
  const mpsi_transfer *work;
  int64_t g;
  size_t offset;
  double still[3]; /* Pa/m, slopes of water at rest */
} reading;

static reading reading_of(const mpsi_transfer *work, int64_t g, size_t offset) {
  reading of = {work, g, offset, {0.0}};
  for (int c = 0; c < 3; c++) of.still[c] = work->water->def.density * work->def->gravity[c];
  return of;
}

/* The faces of plane z, and the permeabilities of its cells. In space `out` has those of the plane
 * below, if that is not the first. */
MPSI_INLINE void find_faces(const reading *of, int z, int dim, bool flows, plane *k, faces *out) {
  const mpsi_grid *grid = of->work->grid;
  const mpsi_water *water = of->work->water;
  const size_t fast = offsetof(mpsi_pore_cell, k);
  double p0[PLANE], p1[PLANE], k0[PLANE] = {0.0}, k1[PLANE] = {0.0};
  plane p;
  load_plane(grid, water, of->g, z, of->offset, &p);
  if (flows) load_plane(grid, water, of->g, z, fast, k);
  find_faces_of(&p, k, grid->inverse, of->still, flows, out);
  if (dim == 2) return;
  if (z > 0) memcpy(out->below, out->above, sizeof out->below);
  for (int up = z > 0 ? 1 : 0; up < 2; up++) {
    load_layer(grid, water, of->g, z - 1 + up, of->offset, p0);
    load_layer(grid, water, of->g, z + up, of->offset, p1);
    if (flows) load_layer(grid, water, of->g, z - 1 + up, fast, k0);
    if (flows) load_layer(grid, water, of->g, z + up, fast, k1);
    find_faces_between(p0, p1, k0, k1, grid->inverse, of->still[2], flows,
                       up ? out->above : out->below);
  }
}

/* ---- pressures ------------------------------------------------------------------------------- */

MPSI_INLINE void advance_block(const mpsi_transfer *work, int64_t g, const uint64_t *inner,
                               int dim) {
  mpsi_water *water = work->water;
  const reading of = reading_of(work, g, offsetof(mpsi_pore_cell, p));
  mpsi_pore_cell *first = water->cell + mpsi_first_node(work->grid, g);
  const double h = work->grid->cell, dt = water->elapsed, bulk = water->def.bulk;
  const double to_flux = (dim == 3 ? h * h : h) / (water->def.density * MPS_PORE_GRAVITY);
  const double to_change = dt / (dim == 3 ? h * h * h : h * h);
  plane k;
  faces at;
  for (int z = 0; z < (dim == 3 ? SIDE : 1); z++) {
    double sum[PLANE];
    find_faces(&of, z, dim, true, &k, &at);
    for (int j = 0; j < SIDE; j++) MPSI_SIMD for (int i = 0; i < SIDE; i++) {
        double all = (at.x[j][i + 1] - at.x[j][i]) + (at.y[j + 1][i] - at.y[j][i]);
        if (dim == 3) all += at.above[j * SIDE + i] - at.below[j * SIDE + i];
        sum[j * SIDE + i] = all * to_flux;
      }
    for (uint64_t left = inner[z]; left; left &= left - 1) {
      const int c = mpsi_pore_lowest(left);
      mpsi_pore_cell *cell = first + z * PLANE + c;
      cell->gain = sum[c];
      cell->now = cell->p + bulk / cell->n *
                                (to_change * sum[c] - cell->change / (cell->volume - cell->change));
    }
  }
}

void MPSI_LEVELLED(mpsi_pore_advance)(const mpsi_transfer *work, int64_t g, const uint64_t *inner) {
  if (work->grid->dim == 2)
    advance_block(work, g, inner, 2);
  else
    advance_block(work, g, inner, 3);
}

/* ---- slopes ---------------------------------------------------------------------------------- */

/* Along an axis, from the drives through a cell's faces times k. */
MPSI_INLINE double slope_of(double before, double behind, double k, double still, bool flows) {
  const double mean = 0.5 * (before + behind);
  return still + (flows ? mean / (k + DBL_MIN) : mean);
}

MPSI_INLINE void slope_block(const mpsi_transfer *work, int64_t g, const uint64_t *inner, int dim,
                             bool flows) {
  mpsi_water *water = work->water;
  const reading of = reading_of(work, g, offsetof(mpsi_pore_cell, now));
  mpsi_pore_cell *first = water->cell + mpsi_first_node(work->grid, g);
  plane k = {{{0.0}}};
  faces at;
  for (int z = 0; z < (dim == 3 ? SIDE : 1); z++) {
    double slope[3][PLANE];
    find_faces(&of, z, dim, flows, &k, &at);
    for (int j = 0; j < SIDE; j++) MPSI_SIMD for (int i = 0; i < SIDE; i++) {
        const double own = k.of[j + 1][i + 1];
        const int c = j * SIDE + i;
        slope[0][c] = slope_of(at.x[j][i], at.x[j][i + 1], own, of.still[0], flows);
        slope[1][c] = slope_of(at.y[j][i], at.y[j + 1][i], own, of.still[1], flows);
        if (dim == 3) slope[2][c] = slope_of(at.below[c], at.above[c], own, of.still[2], flows);
      }
    for (uint64_t left = inner[z]; left; left &= left - 1) {
      const int c = mpsi_pore_lowest(left);
      double *to = first[z * PLANE + c].g;
      for (int a = 0; a < dim; a++) to[a] += water->share * (slope[a][c] - to[a]);
    }
  }
}

void MPSI_LEVELLED(mpsi_pore_slopes)(const mpsi_transfer *work, int64_t g, const uint64_t *inner) {
  const bool flows = work->water->flows;
  if (work->grid->dim == 2 && !flows)
    slope_block(work, g, inner, 2, false);
  else if (work->grid->dim == 2)
    slope_block(work, g, inner, 2, true);
  else if (!flows)
    slope_block(work, g, inner, 3, false);
  else
    slope_block(work, g, inner, 3, true);
}
