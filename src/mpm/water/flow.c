/* flow.c - the flow of water between cells, explicit in time, and the slopes of the pressures.
 *
 *   dp/dt = K_w/n [sum of fluxes/space - tr d]
 *
 * The flux between two cells is that of the harmonic mean of their permeabilities over the distance
 * of the centres of their filled parts; to a drained face it goes over half the filled part, to one
 * behind a thin cell over half a cell and the filled part of that one. Between two cells it goes
 * through the smaller of their filled parts or, with implicit pressures, which have no thin cells,
 * the larger: a cell filled by a thousandth has the pressure of that inside. The driving slope is
 * that of p - rho_w b.x. A cell's own slope is interpolated to its centre from those on its side of
 * two opposite faces, so that it is exact for a parabola at a surface and for layers of different
 * permeability; at an impervious face it is that of water at rest.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cell_loops.h"
#include "implicit.h"
#include "halo.h"
#include "mpm/boundary/free_field.h"
#include "mpm/base/kernels.h"

#include <string.h>

#define LINK 0.01       /* see link_between; filled parts of cells that pass */
#define NEARLY_FULL 0.9 /* nothing to those beside them, */
#define IN_PART 0.6     /* and all of it */

/* Slope (Pa/m) of p along the axis of a face, on the cell's side of it, at a distance (m, from the
 * cell's centre); flux (m3/s) into the cell. */
typedef struct face_flow {
  double slope, distance, flux, conductance; /* the latter, m3/(s Pa): flux per difference */
  bool known;                                /* else there is no condition at the face */
} face_flow;

static double weight_of_water(mpsi_water *water) { return water->def.density * MPS_PORE_GRAVITY; }

/* Area (m2), at a radius (m; 1 but in axisymmetry), through which water flows between the filled
 * parts of a cell and of the one beside it. */
static double area_of(const mpsi_grid *grid, mpsi_water *water, const mpsi_pore_cell *cell,
                      const mpsi_pore_cell *beside, int direction, double radius) {
  const double *own = mpsi_pore_faces_of(water, cell)->fill;
  const double *other = beside ? mpsi_pore_faces_of(water, beside)->fill : own;
  double area = radius;
  for (int c = 0; c < grid->dim; c++)
    if (c != direction / 2)
      area *= grid->cell *
              (mpsi_pore_responds(water) ? fmin(own[c], other[c]) : fmax(own[c], other[c]));
  return area;
}

/* Of a face at grid coordinate X of its cell's box. */
static double radius_of(const mpsi_grid *grid, int direction, double X) {
  return mpsi_pore_radius(grid, direction == 1 ? X + 1.0 : direction == 0 ? X : X + 0.5);
}

/* Through which water flows from x over a distance (m) to a drained face: half way, as pressures
 * near a drain follow the logarithm of the radius. */
static double area_to_drained(const mpsi_grid *grid, mpsi_water *water, const mpsi_pore_cell *cell,
                              int direction, const double *x, double X, double distance) {
  double radius = radius_of(grid, direction, X);
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && direction < 2)
    radius = x[0] + (direction == 1 ? 0.5 : -0.5) * distance;
  return area_of(grid, water, cell, NULL, direction, radius);
}

/* Pressure (Pa) of a drained face at x[3]. */
static double given_pressure(const mpsi_grid *grid, mpsi_water *water,
                             const mps_mpm_def *definition, int face, const double *x) {
  if (face < 0) return 0.0;
  const mps_pore_face_def *def = &water->face[face];
  double p = def->pressure;
  for (int c = 0; c < grid->dim && def->at_rest; c++)
    p += water->def.density * definition->gravity[c] * x[c];
  return p;
}

/* Through `distance` (m) to a pressure that is given there, by face `number` of cell `at`. */
static face_flow to_drained(const mps_mpm *mpm, const mpsi_pore_cell *cell, int face, int direction,
                            const double *x, double distance, double p, double area) {
  const int axis = direction / 2, sign = direction & 1 ? 1 : -1;
  const double still = mpm->water->def.density * mpm->def.gravity[axis];
  double to[3] = {x[0], x[1], x[2]};
  to[axis] += sign * distance;
  const double slope =
      (given_pressure(&mpm->grid, mpm->water, &mpm->def, face, to) - p) / distance; /* outwards */
  return (face_flow){.slope = sign * slope,
                     .distance = 0.5 * distance,
                     .flux = area * cell->k / weight_of_water(mpm->water) * (slope - sign * still),
                     .conductance = area * cell->k / weight_of_water(mpm->water) / distance,
                     .known = true};
}

static face_flow to_cell(const mpsi_grid *grid, mpsi_water *water, const mps_mpm_def *def,
                         const mpsi_pore_cell *cell, const mpsi_pore_cell *beside, int direction,
                         double p, double p_beside, double area) {
  const int axis = direction / 2, sign = direction & 1 ? 1 : -1;
  const double still = water->def.density * def->gravity[axis];
  const double distance = grid->cell + sign * (mpsi_pore_faces_of(water, beside)->shift[axis] -
                                               mpsi_pore_faces_of(water, cell)->shift[axis]);
  const double drive = (p_beside - p) / distance - sign * still; /* outwards */
  const double sum = cell->k + beside->k, own = sum > 0.0 ? 2.0 * beside->k / sum : 1.0;
  return (face_flow){.slope = sign * drive * own + still,
                     .distance = 0.5 * distance,
                     .flux = area * own * cell->k / weight_of_water(water) * drive,
                     .conductance = area * own * cell->k / weight_of_water(water) / distance,
                     .known = true};
}

/* Pressures at the beginning or at the end of the step. */
static double pressure_of(const mpsi_pore_cell *cell, bool end) {
  return end ? cell->now : cell->p;
}

/* What is at face `direction` of cell k of block g; x: centre of its filled part. `*behind`
 * receives the cell whose drained face it is, and its number. */
static face_flow at_face(const mps_mpm *mpm, int64_t g, int k, int direction, bool end,
                         const mpsi_pore_cell *cell, const double *x, double X,
                         const mpsi_pore_cell **behind) {
  const int axis = direction / 2, sign = direction & 1 ? 1 : -1;
  const double h = mpm->grid.cell, p = pressure_of(cell, end);
  const face_flow none = {.known = false};
  *behind = NULL;
  if (!mpm->water->flows &&
      mpsi_pore_faces_of(mpm->water, cell)->beyond[direction] != MPSI_PORE_CELL)
    return none;
  if (mpsi_pore_faces_of(mpm->water, cell)->beyond[direction] == MPSI_PORE_CLOSED)
    return (face_flow){.slope = mpm->water->def.density * mpm->def.gravity[axis],
                       .distance = 0.5 * h * mpsi_pore_faces_of(mpm->water, cell)->fill[axis],
                       .known = true};
  if (mpsi_pore_faces_of(mpm->water, cell)->beyond[direction] == MPSI_PORE_DRAINED) {
    const double way = 0.5 * h * mpsi_pore_faces_of(mpm->water, cell)->fill[axis];
    *behind = cell;
    return to_drained(mpm, cell, mpsi_pore_faces_of(mpm->water, cell)->face[direction], direction,
                      x, way, p,
                      area_to_drained(&mpm->grid, mpm->water, cell, direction, x, X, way));
  }
  const mpsi_pore_cell *beside = mpsi_pore_beside(&mpm->grid, mpm->water, g, k, direction);
  const double area = mpm->water->flows ? area_of(&mpm->grid, mpm->water, cell, beside, direction,
                                                  radius_of(&mpm->grid, direction, X))
                                        : 0.0;
  if (!beside->thin)
    return to_cell(&mpm->grid, mpm->water, &mpm->def, cell, beside, direction, p,
                   pressure_of(beside, end), area);
  if (!(beside->free >> direction & 1) ||
      mpsi_pore_faces_of(mpm->water, beside)->beyond[direction] != MPSI_PORE_DRAINED)
    return none;
  *behind = beside;
  const double own = 0.5 * h + sign * -mpsi_pore_faces_of(mpm->water, cell)->shift[axis];
  const double way = own + h * mpsi_pore_faces_of(mpm->water, beside)->fill[axis];
  return to_drained(mpm, cell, mpsi_pore_faces_of(mpm->water, beside)->face[direction], direction,
                    x, way, p, area_to_drained(&mpm->grid, mpm->water, cell, direction, x, X, way));
}

/* Centre of the filled part of cell k of a block of nodes; the coordinate of its box along x. */
static double centre_of(const mpsi_grid *grid, mpsi_water *water, int64_t g, int k,
                        const mpsi_pore_cell *cell, double *x) {
  int place[3];
  mpsi_unravel(k, MPSI_SIDE, place);
  const double local[3] = {place[0] + 0.5, place[1] + 0.5, place[2] + 0.5};
  mpsi_node_position(grid, grid->nodes[g].at, local, x);
  for (int c = 0; c < grid->dim; c++) x[c] += mpsi_pore_faces_of(water, cell)->shift[c];
  return (double)grid->nodes[g].at[0] * MPSI_SIDE + place[0];
}

/* ---- cells among inner cells ----------------------------------------------------------------- */

/* Cells of a block that are inside, with cells on all faces that have no free face: inner_cells.c.
 * Returns whether there are any. */
static bool find_inner(const mpsi_grid *grid, const mpsi_water *water, int64_t g, uint64_t *inner) {
  uint64_t any = 0;
  memset(inner, 0, MPSI_PORE_WORDS * sizeof *inner);
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) return false;
  mpsi_pore_surrounded(grid, water, g, true, inner);
  for (int w = 0; w < MPSI_PORE_WORDS; w++) {
    inner[w] &= water->block[g].inside[w];
    any |= inner[w];
  }
  return any != 0;
}

/* ---- pressures at the end of the step -------------------------------------------------------- */

/* Through faces `face` of the cells of block g; m3/s, below 0 inwards. */
static void let_out(mpsi_water *water, int64_t g, int face, double rate) {
  water->outflow[g][face < 0 ? MPS_PORE_MAX_FACES : face] += rate;
  if (rate < 0.0) water->outflow[g][MPSI_PORE_FACES] -= rate;
}

/* By the pressures at the beginning or the end of the step. */
static double flux_into(mps_mpm *mpm, int64_t g, int k, bool end, const mpsi_pore_cell *cell) {
  const mpsi_pore_cell *behind;
  double x[3], flux = 0.0;
  const double X = centre_of(&mpm->grid, mpm->water, g, k, cell, x);
  for (int d = 0; d < 2 * mpm->grid.dim; d++) {
    const face_flow f = at_face(mpm, g, k, d, end, cell, x, X, &behind);
    if (f.known) flux += f.flux;
    if (f.known && behind)
      let_out(mpm->water, g, mpsi_pore_faces_of(mpm->water, behind)->face[d], -f.flux);
  }
  return flux;
}

/* m3 that stores water, of a cell that is not inside. One less than half full at an impervious
 * surface: else its steps would be short. */
static double space_of(const mpsi_pore_faces *faces) {
  const double filled = faces->fill[0] * faces->fill[1] * faces->fill[2];
  return fmax(faces->space, 0.5 * faces->space / fmax(1e-3, filled));
}

/* Of a cell that is not among inner ones (inner_cells.c). */
static void advance(mps_mpm *mpm, int64_t g, int k, mpsi_pore_cell *cell) {
  mpsi_water *water = mpm->water;
  const double h = mpm->grid.cell;
  double space = mpm->grid.dim == 3 ? h * h * h : h * h;
  cell->gain = flux_into(mpm, g, k, false, cell);
  if (!cell->inside) space = space_of(mpsi_pore_faces_of(water, cell));
  cell->now = cell->p + water->def.bulk / cell->n * (water->elapsed * cell->gain / space) +
              mpsi_pore_squeeze(mpm->water, cell);
}

static void find_pressures(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_transfer work = mpsi_transfer_begin(mpm);
  mpsi_pore_cell *cell = mpm->water->cell + mpsi_first_node(&mpm->grid, g);
  uint64_t inner[MPSI_PORE_WORDS];
  memset(mpm->water->outflow[g], 0, sizeof mpm->water->outflow[g]);
  if (find_inner(&mpm->grid, mpm->water, g, inner)) mpm->kernels->pore_advance(&work, g, inner);
  for (int w = 0; w < MPSI_PORE_WORDS; w++)
    for (uint64_t left = mpm->water->block[g].filled[w] & ~inner[w]; left; left &= left - 1) {
      const int k = 64 * w + mpsi_pore_lowest(left);
      if (!cell[k].thin) advance(mpm, g, k, &cell[k]); /* else find_slopes finds its gain */
    }
}

/* ---- slopes ---------------------------------------------------------------------------------- */

/* To the cell's centre between two faces. */
static double between(const face_flow *below, const face_flow *above) {
  if (below->known && above->known)
    return (below->slope * above->distance + above->slope * below->distance) /
           (below->distance + above->distance);
  return below->known ? below->slope : above->known ? above->slope : 0.0;
}

static void find_slope(const mps_mpm *mpm, int64_t g, int k, mpsi_pore_cell *cell) {
  const mpsi_pore_cell *behind;
  double x[3];
  const double X = centre_of(&mpm->grid, mpm->water, g, k, cell, x);
  for (int c = 0; c < mpm->grid.dim; c++) {
    const face_flow below = at_face(mpm, g, k, 2 * c, true, cell, x, X, &behind);
    const face_flow above = at_face(mpm, g, k, 2 * c + 1, true, cell, x, X, &behind);
    cell->g[c] += mpm->water->share * (between(&below, &above) - cell->g[c]);
  }
}

/* On the line from the neighbours inside to the surface, the mean over the axes that have one. */
static void interpolate(const mpsi_grid *grid, mpsi_water *water, const mps_mpm_def *def, int64_t g,
                        int k, mpsi_pore_cell *cell) {
  const double h = grid->cell;
  double x[3], sum = 0.0;
  int lines = 0;
  centre_of(grid, water, g, k, cell, x);
  for (int d = 0; d < 2 * grid->dim; d++) {
    const int axis = d / 2, sign = d & 1 ? 1 : -1;
    if (!(cell->free >> d & 1) || mpsi_pore_faces_of(water, cell)->beyond[d] != MPSI_PORE_DRAINED)
      continue;
    const mpsi_pore_cell *inside = mpsi_pore_beside(grid, water, g, k, d ^ 1);
    double at[3] = {x[0], x[1], x[2]};
    at[axis] += sign * 0.5 * h * mpsi_pore_faces_of(water, cell)->fill[axis];
    const double surface =
        given_pressure(grid, water, def, mpsi_pore_faces_of(water, cell)->face[d], at);
    cell->g[axis] = 0.0;
    if (!inside || inside->thin) continue;
    const double way = 0.5 * h - sign * mpsi_pore_faces_of(water, inside)->shift[axis] +
                       h * mpsi_pore_faces_of(water, cell)->fill[axis];
    const double slope = (surface - inside->now) / way; /* outwards */
    cell->g[axis] = sign * slope;
    sum += surface - slope * 0.5 * h * mpsi_pore_faces_of(water, cell)->fill[axis];
    lines++;
  }
  cell->now = lines > 0 ? sum / lines : 0.0;
}

static int drained_face(mpsi_water *water, const mpsi_pore_cell *cell) {
  int d = 0;
  while (
      !((cell->free >> d & 1) && mpsi_pore_faces_of(water, cell)->beyond[d] == MPSI_PORE_DRAINED))
    d++;
  return mpsi_pore_faces_of(water, cell)->face[d];
}

/* What the particles of a thin cell lose as their pressures go back to the line leaves through one
 * of its drained faces. */
static void expel(const mpsi_grid *grid, mpsi_water *water, int64_t g, mpsi_pore_cell *cell) {
  const double storage = cell->n * cell->volume / (water->def.bulk * grid->measure);
  cell->gain = storage * (cell->now - cell->p) / water->elapsed;
  let_out(water, g, drained_face(water, cell), -cell->gain);
}

static void find_slopes(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_water *water = mpm->water;
  const mpsi_transfer work = mpsi_transfer_begin(mpm);
  mpsi_pore_cell *cell = water->cell + mpsi_first_node(&mpm->grid, g);
  uint64_t inner[MPSI_PORE_WORDS];
  if (find_inner(&mpm->grid, water, g, inner)) mpm->kernels->pore_slopes(&work, g, inner);
  for (int w = 0; w < MPSI_PORE_WORDS; w++)
    for (uint64_t left = water->block[g].filled[w] & ~inner[w]; left; left &= left - 1) {
      const int k = 64 * w + mpsi_pore_lowest(left);
      if (!cell[k].thin) {
        find_slope(mpm, g, k, &cell[k]);
        continue;
      }
      interpolate(&mpm->grid, water, &mpm->def, g, k, &cell[k]);
      expel(&mpm->grid, water, g, &cell[k]);
    }
}

/* ---- particles ------------------------------------------------------------------------------- */

/* Permeability after a change of volume by the factor `ratio`: v = 1/(1 - n), before, follows it,
 * and e = v - 1. */
static double permeability_after(const mps_pore_water_def *def, double k, double n, double ratio) {
  if (def->exponent != 0.0) k *= pow(ratio, def->exponent);
  if (def->ratio_slope < INFINITY) k *= exp((ratio - 1.0) / ((1.0 - n) * def->ratio_slope));
  return k;
}

void mpsi_pore_change_permeability(const mpsi_columns *p, const mpsi_water *water,
                                   const double *former, int64_t begin, int64_t end) {
  const mps_pore_water_def *def = &water->def;
  if (def->exponent == 0.0 && !(def->ratio_slope < INFINITY)) return;
  for (int64_t k = begin; k < end; k++)
    p->k[k] = permeability_after(def, p->k[k], p->n[k], p->V[k] / former[k - begin]);
}

void mpsi_pore_follow(const mpsi_columns *p, const mpsi_water *water, int64_t k, double former) {
  const double V = p->V[k];
  if (water->flows) mpsi_pore_change_permeability(p, water, &former, k, k + 1);
  p->n[k] = 1.0 - (1.0 - p->n[k]) * (former / V);
  p->u[k] -= water->def.bulk / p->n[k] * ((V - former) / former);
}

void mpsi_pore_give_flow(const mpsi_transfer *work, int64_t begin, int64_t end) {
  const mpsi_columns *p = work->p;
  mpsi_water *water = work->water;
  const mps_pore_water_def *def = &water->def;
  const double weight = weight_of_water(water);
  for (int c = 0; c < work->grid->dim && water->seepage[0]; c++)
    for (int64_t k = begin; k < end; k++)
      water->seepage[c][k] =
          -p->k[k] / weight * (p->g[c][k] - def->density * work->def->gravity[c]);
}

/* Part of its volume that the cell is expected to gain in the step: what its pressures know. */
static double expected_of(const mpsi_water *water, const mpsi_pore_cell *cell) {
  return water->system->squeeze[cell - water->cell];
}

static void load_row(const mpsi_transfer *work, const mpsi_pore_cell *cell, const uint64_t *filled,
                     int local, int cells, mpsi_node *tile, mpsi_node *gain) {
  mpsi_water *water = work->water;
  const double amount = water->def.density * water->elapsed * work->grid->measure;
  for (int i = 0; i < cells; i++) {
    if (!mpsi_pore_marked(filled, local + i)) continue;
    double centre = cell[i].now; /* of the filled part; then of the box */
    for (int c = 0; c < work->grid->dim && !cell[i].inside; c++)
      centre -= cell[i].g[c] * mpsi_pore_faces_of(water, cell + i)->shift[c];
    tile[i][0] = centre;
    for (int c = 0; c < 3; c++) tile[i][1 + c] = cell[i].g[c];
    if (water->flows) gain[i][0] = amount * cell[i].gain / cell[i].volume;
    if (water->expecting) gain[i][1] = expected_of(water, cell + i);
  }
}

/* For the particles of a block, to the worker's tiles: of each cell the pressure at the centre of
 * its box and its slopes; kg/m3 that its particles gain. */
static void load_tile(const mpsi_transfer *work) {
  const mpsi_grid *grid = work->grid;
  const mpsi_cell_block *cells = work->cells;
  int low[3], high[3];
  mpsi_pore_region(grid, cells, low, high);
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1]; j++)
      for (int i = low[0], end; i < high[0]; i = end) {
        const int32_t g = mpsi_block_under(cells, i, j, k);
        const int local = mpsi_local_under(i, j, k), at = mpsi_tile_index(i, j, k);
        end = i < MPSI_SIDE && high[0] > MPSI_SIDE ? MPSI_SIDE : high[0];
        load_row(work, work->water->cell + mpsi_first_node(grid, g) + local,
                 work->water->block[g].filled, local, end - i, work->worker->tile + at,
                 work->worker->force + at);
      }
}

static void give_to_particles(void *data, int64_t b, int32_t number) {
  mps_mpm *mpm = data;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, number);
  load_tile(&work);
  mpm->kernels->pore_give(&work);
}

/* ---- columns of free-field sides -------------------------------------------------------------
 * The column of a free-field side (boundary/free_field.h) has pressures of its own, which flow up
 * and down as the ground's do. For an exchange the cells at the side are lent to it: they hold the
 * column's pressures and slopes while fluxes, pressures and slopes are found along y by the
 * functions above, with the permeabilities, porosities and faces of the ground, and have the
 * ground's again afterwards. */

/* The cell that particle k of the column is in, and how far (m) it is above its centre; NULL: it
 * has left the column's nodes, which the next step refuses. */
static mpsi_pore_column_cell *find_column_cell(const mpsi_grid *grid, const mpsi_water *water,
                                               const mpsi_free_field *f, int64_t k, double *above) {
  const double Y = mpsi_grid_at(grid, 1, f->y[k]) - (double)f->first;
  if (!(Y >= 0.0 && Y < (double)f->nodes)) return NULL;
  const int64_t at = mpsi_own_cell(grid, 1, Y + (double)f->first);
  *above = f->y[k] - (grid->origin[1] + grid->cell * ((double)at + 0.5));
  return &water->column[at - f->first];
}

/* The cells at the side, with the pressures of the column instead of the ground's. */
static void enter_column(mps_mpm *mpm, int side, mpsi_free_field *f) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_water *water = mpm->water;
  const int64_t layer = side == MPS_SIDE_X_LOWER ? grid->low[0] : grid->high[0] - 1;
  double above;
  memset(water->column, 0, (size_t)f->nodes * sizeof *water->column);
  for (int64_t k = 0; k < f->count; k++) {
    mpsi_pore_column_cell *c = find_column_cell(grid, water, f, k, &above);
    if (!c) continue;
    c->volume += f->V[k];
    c->p += f->V[k] * (f->u[k] - f->g[k] * above);
    c->g += f->V[k] * f->g[k];
  }
  for (int64_t n = 0; n < f->nodes; n++) {
    mpsi_pore_column_cell *c = &water->column[n];
    const int64_t y = f->first + n;
    const int32_t at[3] = {(int32_t)mpsi_block_with(layer), (int32_t)mpsi_block_with(y), 0};
    c->block = mpsi_pore_own_block(grid, at);
    c->place =
        (int)(layer - (int64_t)at[0] * MPSI_SIDE + MPSI_SIDE * (y - (int64_t)at[1] * MPSI_SIDE));
    if (c->block < 0 || !mpsi_pore_marked(water->block[c->block].filled, c->place)) continue;
    c->cell = water->cell + mpsi_first_node(grid, c->block) + c->place;
    c->was = *c->cell;
    if (!(c->volume > 0.0)) continue;
    c->cell->p = c->p / c->volume;
    c->cell->g[1] = c->g / c->volume;
    c->cell->p += c->cell->g[1] * mpsi_pore_faces_of(water, c->cell)->shift[1];
    c->cell->now = c->cell->p;
  }
}

/* The pressure of a cell of the column at the end of the exchange, by the fluxes below and above.
 */
static void flow_in_column(mps_mpm *mpm, mpsi_pore_column_cell *c) {
  mpsi_water *water = mpm->water;
  const double h = mpm->grid.cell;
  const mpsi_pore_cell *behind;
  double x[3], flux = 0.0;
  if (c->cell->thin) return;
  const double X = centre_of(&mpm->grid, water, c->block, c->place, c->cell, x);
  for (int d = 2; d < 4; d++) {
    const face_flow f = at_face(mpm, c->block, c->place, d, false, c->cell, x, X, &behind);
    if (f.known) flux += f.flux;
  }
  const double space = c->cell->inside ? h * h : space_of(mpsi_pore_faces_of(water, c->cell));
  c->cell->now = c->cell->p + water->def.bulk / c->cell->n * (water->elapsed * flux / space);
}

/* Its slope along y, from the pressures at the end. */
static void slope_in_column(mps_mpm *mpm, mpsi_pore_column_cell *c) {
  const mpsi_pore_cell *behind;
  double x[3];
  if (c->cell->thin) {
    interpolate(&mpm->grid, mpm->water, &mpm->def, c->block, c->place, c->cell);
    return;
  }
  const double X = centre_of(&mpm->grid, mpm->water, c->block, c->place, c->cell, x);
  const face_flow below = at_face(mpm, c->block, c->place, 2, true, c->cell, x, X, &behind);
  const face_flow above = at_face(mpm, c->block, c->place, 3, true, c->cell, x, X, &behind);
  c->cell->g[1] += mpm->water->share * (between(&below, &above) - c->cell->g[1]);
}

/* Back to the column's particles; where the ground has no cell they keep theirs. */
static void leave_column(const mpsi_grid *grid, mpsi_water *water, mpsi_free_field *f) {
  double above;
  for (int64_t k = 0; k < f->count; k++) {
    const mpsi_pore_column_cell *c = find_column_cell(grid, water, f, k, &above);
    const mpsi_pore_cell *cell = c ? c->cell : NULL;
    if (!cell) continue;
    f->g[k] = cell->g[1];
    f->u[k] = cell->now + cell->g[1] * (above - mpsi_pore_faces_of(water, cell)->shift[1]);
  }
  for (int64_t n = 0; n < f->nodes; n++)
    if (water->column[n].cell) *water->column[n].cell = water->column[n].was;
}

static void exchange_in_column(mps_mpm *mpm, int side, mpsi_free_field *f) {
  mpsi_water *water = mpm->water;
  enter_column(mpm, side, f);
  for (int64_t n = 0; n < f->nodes && water->flows; n++)
    if (water->column[n].cell) flow_in_column(mpm, &water->column[n]);
  for (int64_t n = 0; n < f->nodes; n++)
    if (water->column[n].cell) slope_in_column(mpm, &water->column[n]);
  leave_column(&mpm->grid, water, f);
}

void mpsi_pore_update_columns(mps_mpm *mpm) {
  if (!mpsi_pore_responds(mpm->water)) return;
  for (int side = 0; side < 2; side++) {
    mpsi_free_field *f = mpm->boundaries.boundary[side].field;
    if (!f) continue;
    if (mpm->water->due) exchange_in_column(mpm, side, f);
    for (int64_t k = 0; k < f->count; k++) {
      const int64_t from = mps_particles_index(mpm->p.set, f->id[k]);
      if (from >= 0) f->seen[k] = mpm->p.u[from];
    }
  }
}

/* ---- implicit pressures ---------------------------------------------------------------------- */

static double filled_part(const mpsi_grid *grid, mpsi_water *water, const mpsi_pore_cell *cell) {
  double part = 1.0;
  for (int c = 0; c < grid->dim; c++) part *= mpsi_pore_faces_of(water, cell)->fill[c];
  return part;
}

/* What a cell that is filled in part, and one beside it, pass to one another in dt for a difference
 * of their changes of pressure, m3/Pa. The few particles of such a cell beside a body move with
 * nodes that contacts hold: their pressure moves nothing, only the water's storage bounds it, and
 * at the rim of a cone it rose to twice that around, for some hundred steps. Ground of the modulus
 * rho c^2 as large as the cells would take LINK of that volume. What stays as it is passes nothing.
 * Of their filled parts, which other ranks know too; radius (m): of the face, 1 but in axisymmetry.
 */
static double link_between(const mps_mpm *mpm, const mpsi_pore_cell *cell,
                           const mpsi_pore_cell *beside, double radius) {
  mpsi_water *water = mpm->water;
  if (!beside || cell->thin || beside->thin) return 0.0;
  const double filled =
      fmin(filled_part(&mpm->grid, water, cell), filled_part(&mpm->grid, water, beside));
  const double share = fmin(1.0, (NEARLY_FULL - filled) / (NEARLY_FULL - IN_PART));
  if (!(share > 0.0)) return 0.0;
  const double modulus = water->def.density * mpm->run.speed * mpm->run.speed;
  const double volume = filled * pow(mpm->grid.cell, mpm->grid.dim) * radius;
  return share * LINK * volume / modulus;
}

/* Storage and fluxes of a cell, and the right-hand side, for implicit.c. */
static void find_equation(mps_mpm *mpm, int64_t g, int k, const mpsi_pore_cell *cell) {
  mpsi_water *water = mpm->water;
  mpsi_pore_system *s = water->system;
  const int64_t at = cell - water->cell;
  const double dt = mpm->run.dt, V = cell->volume / mpm->grid.measure;
  const mpsi_pore_cell *behind;
  double x[3], flux = 0.0;
  const double X = centre_of(&mpm->grid, water, g, k, cell, x);
  s->space[at] = V;
  s->diagonal[at] = V * cell->n / water->def.bulk;
  for (int d = 0; d < 2 * mpm->grid.dim; d++) {
    s->conductance[at][d] = link_between(mpm, cell, mpsi_pore_beside(&mpm->grid, water, g, k, d),
                                         radius_of(&mpm->grid, d, X)) /
                            dt;
    if (!water->flows) continue;
    const face_flow f = at_face(mpm, g, k, d, false, cell, x, X, &behind);
    if (!f.known) continue;
    flux += f.flux;
    if (behind)
      s->diagonal[at] += dt * f.conductance;
    else
      s->conductance[at][d] += f.conductance;
  }
  s->residual[at] = dt * flux;
}

static void find_equations(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_water *water = mpm->water;
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = water->cell + first;
  memset(water->outflow[g], 0, sizeof water->outflow[g]);
  if (!mpsi_mpm_counts_node_block(&mpm->grid, g)) return; /* another rank has its equations */
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    water->system->direction[first + k] = water->system->change[first + k] = 0.0;
    if (mpsi_pore_marked(water->block[g].filled, k)) find_equation(mpm, g, k, &cell[k]);
  }
}

/* What flows under the pressures at the end of the step, so that no water is lost. */
static void find_gains(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_water *water = mpm->water;
  mpsi_pore_cell *cell = water->cell + mpsi_first_node(&mpm->grid, g);
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (mpsi_pore_marked(water->block[g].filled, k))
      cell[k].gain = flux_into(mpm, g, k, true, &cell[k]);
  }
}

static mps_status find_implicit(mps_mpm *mpm, const char *function) {
  const mpsi_pass equations = {.data = mpm, .finish = find_equations};
  const mpsi_pass gains = {.data = mpm, .finish = find_gains};
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &equations);
  const mps_status status = mpsi_pore_solve(mpm, function);
  if (status == MPS_OK && mpm->water->flows)
    mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &gains);
  return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

static void give(mps_mpm *mpm) {
  const mpsi_pass particles = {.data = mpm, .finish = find_slopes, .gather = give_to_particles};
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &particles);
}

mps_status mpsi_pore_press(mps_mpm *mpm, const char *function) {
  if (!mpsi_pore_predicts(mpm)) return MPS_OK;
  mpsi_pore_find_ahead(mpm);
  mpm->water->expecting = true;
  mpsi_pore_find_cells(mpm);
  mpsi_pore_find_faces(mpm);
  mpm->water->expecting = false;
  return mpsi_pore_press_nodes(mpm, function);
}

mps_status mpsi_pore_predict(mps_mpm *mpm, const char *function) {
  mpsi_water *water = mpm->water;
  MPSI_TRY(find_implicit(mpm, function));
  mpsi_pore_follow_means(mpm);
  water->expecting = true;
  water->share = 1.0;
  water->elapsed = mpm->run.dt;
  give(mpm);
  water->elapsed = 0.0;
  water->expecting = false;
  return MPS_OK;
}

/* Pressures after the motion: by what it has taken of the volumes besides what was expected. */
static void find_rest(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_water *water = mpm->water;
  mpsi_pore_cell *cell = water->cell + mpsi_first_node(&mpm->grid, g);
  for (int w = 0; w < MPSI_PORE_WORDS; w++)
    for (uint64_t left = water->block[g].filled[w]; left; left &= left - 1) {
      const int k = 64 * w + mpsi_pore_lowest(left);
      cell[k].gain = 0.0;
      cell[k].now = cell[k].p + mpsi_pore_squeeze(water, &cell[k]);
    }
}

void mpsi_pore_flow(mps_mpm *mpm) {
  const bool implicit = !mpsi_pore_responds(mpm->water);
  const mpsi_pass pressures = {.data = mpm, .finish = implicit ? find_rest : find_pressures};
  if (mpm->water->flows) {
    mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pressures);
    mpsi_pore_exchange(mpm, MPSI_PORE_NOW);
  }
  give(mpm);
}
