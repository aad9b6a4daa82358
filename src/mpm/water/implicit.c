/* implicit.c - pressures of cells, implicit in time. With increments d of the pressures
 *
 *   [S + dt T + dt^2 G^T m^-1 G] d = dt (fluxes at p) - change of volume,   S = V n/K_w
 *
 * T are the fluxes per difference of pressure, and G the forces on the nodes per pressure of a
 * cell: a pressure that rises pushes the ground apart, which the last term sees in advance. So
 * neither waves in the water nor its flow limit the step, which is that of the dry ground. The
 * matrix is symmetric and positive definite, and conjugate gradients with its diagonal solve it.
 * The forces of the next step are those of the new pressures; velocities are not corrected.
 *
 * G is that of full supports, mirrored at sides of the domain, with the particles where they are at
 * the end of the step: what it lacks beside bodies delays pressures, and changes no steady state.
 * Vectors are by cells, loops by blocks; sums are added in the order of the blocks, so that no bit
 * depends on the number of threads. SPDX-License-Identifier: BSD-3-Clause */
#include "implicit.h"

#include "mpm/base/shape.h"

#include <string.h>

#define TOLERANCE 1e-9 /* of the residual, over the right-hand side */
enum { MOST_ITERATIONS = 5000 };
/* Below so many terms of G a loop is over before a second thread has begun it. */
enum { FEWEST_TERMS = 32 * MPSI_SIDE * MPSI_SIDE * MPSI_PORE_SPAN * MPSI_PORE_SPAN };

typedef struct mpsi_pore_system system_of;

/* ---- room ------------------------------------------------------------------------------------ */

static bool ensure(mps_mpm *mpm, mpsi_room *room, int64_t count, size_t size) {
  return mpsi_room_ensure(mpm->context, room, count, size);
}

enum { MOST_SPAN = MPSI_PORE_SPAN * MPSI_PORE_SPAN * MPSI_PORE_SPAN };

/* The box of nodes or cells in reach of a block's own: from TILE_BEFORE places before it on. */
enum { TILE_BEFORE = MPSI_PORE_SPAN - 2, TILE = MPSI_SIDE + 2 * TILE_BEFORE };

static int tile_places(const mpsi_grid *grid) {
  return grid->dim == 3 ? TILE * TILE * TILE : TILE * TILE;
}

static int span_nodes(const mpsi_grid *grid) {
  return grid->dim == 3 ? MOST_SPAN : MPSI_PORE_SPAN * MPSI_PORE_SPAN;
}

static void find_around(const mpsi_grid *grid, system_of *s) {
  for (int64_t g = 0; g < grid->node_count; g++)
    for (int k = 0; k < MPSI_PORE_AROUND; k++) {
      int32_t at[3], step[3];
      mpsi_unravel(k, 3, step);
      for (int c = 0; c < 3; c++) at[c] = grid->nodes[g].at[c] + step[c] - 1;
      s->around[g][k] = grid->dim == 2 && step[2] != 1 ? -1 : mpsi_pore_own_block(grid, at);
    }
}

mps_status mpsi_pore_make_system(mps_mpm *mpm, const char *function) {
  enum { VECTORS = 7 };
  const int64_t blocks = mpm->grid.node_count, nodes = blocks * mpm->grid.block_nodes;
  system_of *s = mpm->water->system;
  if (!s) {
    s = mpm->water->system = mpsi_alloc(mpm->context, 1, sizeof *s);
    if (!s) return mpsi_fail_memory(mpm->context, function, sizeof *s);
    memset(s, 0, sizeof *s);
  }
  const bool good = ensure(mpm, &s->around_room, blocks, sizeof *s->around) &&
                    ensure(mpm, &s->mass_room, nodes, sizeof *s->mass) &&
                    ensure(mpm, &s->velocity_room, nodes, sizeof *s->velocity) &&
                    ensure(mpm, &s->held_room, nodes, sizeof *s->held) &&
                    ensure(mpm, &s->row_room, nodes, sizeof *s->row) &&
                    ensure(mpm, &s->conductance_room, nodes, sizeof *s->conductance) &&
                    ensure(mpm, &s->vector_room, VECTORS * nodes, sizeof(double)) &&
                    ensure(mpm, &s->tile_room, blocks * tile_places(&mpm->grid), sizeof *s->tile) &&
                    ensure(mpm, &s->part_room, blocks, sizeof *s->part);
  if (!good)
    return mpsi_fail_memory(mpm->context, function, (size_t)(VECTORS * nodes) * sizeof(double));
  s->around = s->around_room.item;
  s->mass = s->mass_room.item;
  s->velocity = s->velocity_room.item;
  s->held = s->held_room.item;
  s->row = s->row_room.item;
  s->conductance = s->conductance_room.item;
  s->tile = s->tile_room.item;
  s->part = s->part_room.item;
  double **const vector[VECTORS] = {&s->diagonal,  &s->scale,   &s->change, &s->residual,
                                    &s->direction, &s->product, &s->inverse};
  for (int k = 0; k < VECTORS; k++) *vector[k] = (double *)s->vector_room.item + k * nodes;
  find_around(&mpm->grid, s);
  return MPS_OK;
}

void mpsi_pore_free_system(mps_context *context, mpsi_pore_system **pointer) {
  system_of *s = *pointer;
  *pointer = NULL;
  if (!s) return;
  const mpsi_room room[] = {s->around_room, s->mass_room,  s->velocity_room, s->held_room,
                            s->row_room,    s->force_room, s->vector_room,   s->conductance_room,
                            s->tile_room,   s->part_room};
  for (size_t k = 0; k < sizeof room / sizeof *room; k++) mpsi_free(context, room[k].item);
  mpsi_free(context, s);
}

/* ---- loops over blocks ----------------------------------------------------------------------- */

/* Whether the cell has an unknown of its own. */
static bool is_unknown(const mpsi_water *water, int64_t g, int k, const mpsi_pore_cell *cell) {
  return mpsi_pore_marked(water->block[g].filled, k) && !cell[k].thin;
}

/* The node or cell at `offset` from the first of block g, or -1. */
static int64_t find_at(const mpsi_grid *grid, const system_of *s, int64_t g, const int *offset) {
  int block = 0, local = 0;
  for (int c = 2; c >= 0; c--) {
    const int place = c < grid->dim ? offset[c] : 0;
    block = 3 * block + (place < 0 ? 0 : place < MPSI_SIDE ? 1 : 2);
    local = MPSI_SIDE * local + (place & (MPSI_SIDE - 1));
  }
  const int32_t to = s->around[g][block];
  return to < 0 ? -1 : mpsi_first_node(grid, to) + local;
}

/* Work on all blocks, each by itself; and the sum of what it has left in `part`. */
typedef struct block_loop {
  mps_mpm *mpm;
  void (*task)(mps_mpm *mpm, system_of *s, int64_t g, double factor);
  double factor;
} block_loop;

static void run_block(void *data, int64_t g, int32_t worker) {
  const block_loop *loop = data;
  (void)worker;
  loop->task(loop->mpm, loop->mpm->water->system, g, loop->factor);
}

static void for_blocks(mps_mpm *mpm, void (*task)(mps_mpm *, system_of *, int64_t, double),
                       double factor) {
  block_loop loop = {mpm, task, factor};
  const int64_t blocks = mpm->grid.node_count;
  if (blocks * mpm->grid.block_nodes * span_nodes(&mpm->grid) >= FEWEST_TERMS) {
    mpsi_parallel_for(mpm->context, blocks, run_block, &loop);
    return;
  }
  for (int64_t g = 0; g < blocks; g++) run_block(&loop, g, 0);
}

static double sum_blocks(mps_mpm *mpm, void (*task)(mps_mpm *, system_of *, int64_t, double),
                         double factor) {
  double sum = 0.0;
  for_blocks(mpm, task, factor);
  for (int64_t g = 0; g < mpm->grid.node_count; g++) sum += mpm->water->system->part[g];
  return sum;
}

/* The place in a tile of what is `before` places before place k of the block along each axis. */
static int tile_place(const mpsi_grid *grid, int k, int before) {
  int at[3];
  mpsi_unravel(k, MPSI_SIDE, at);
  for (int c = 0; c < grid->dim; c++) at[c] += TILE_BEFORE - before;
  return (at[2] * TILE + at[1]) * TILE + at[0];
}

/* How far places q of a span lie from the first in a tile. */
static void list_shifts(const mpsi_grid *grid, int *shift) {
  for (int q = 0; q < span_nodes(grid); q++) {
    int i[3];
    mpsi_unravel(q, MPSI_PORE_SPAN, i);
    shift[q] = (i[2] * TILE + i[1]) * TILE + i[0];
  }
}

/* What is in reach of each block, once a step: iterations look nothing up. */
static void find_tile(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  int32_t *tile = s->tile + g * tile_places(grid);
  (void)factor;
  for (int t = 0; t < tile_places(grid); t++) {
    int offset[3];
    mpsi_unravel(t, TILE, offset);
    for (int c = 0; c < 3; c++) offset[c] -= TILE_BEFORE;
    tile[t] = (int32_t)find_at(grid, s, g, offset);
  }
}

/* ---- forces on nodes ------------------------------------------------------------------------- */

static void clear_masses(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  system_of *s = mpm->water->system;
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  (void)worker;
  memset(s->mass + first, 0, (size_t)mpm->grid.block_nodes * sizeof *s->mass);
}

/* A particle in its cell: along each axis weights and slopes of the four nodes from the one below
 * the cell on, those beyond a side of the domain added to their mirror images, where velocities
 * across it have the other sign. */
typedef struct shape {
  double w[3][MPSI_PORE_SPAN], slope[3][MPSI_PORE_SPAN];
} shape;

static shape find_shape(const mpsi_grid *grid, const mpsi_columns *p, const int64_t *cell,
                        int64_t k) {
  const double moment = mpsi_inverse_moment(grid->spline) * grid->inverse;
  shape out = {.w = {{0.0}}};
  if (grid->dim == 2) out.w[2][0] = 1.0;
  for (int c = 0; c < grid->dim; c++) {
    double X = mpsi_grid_at(grid, c, p->x[c][k]), w[4];
    X = fmin(fmax(X, (double)cell[c]), (double)cell[c] + 1.0);
    const int64_t lowest = (int64_t)mpsi_base(grid->spline, X);
    const int64_t base = lowest < cell[c] - 1 ? cell[c] - 1 : lowest > cell[c] ? cell[c] : lowest;
    const double t = X - (double)base;
    mpsi_weights(grid->spline, t, w);
    for (int i = 0; i <= grid->spline; i++) {
      const int64_t node = base + i;
      if (node > cell[c] + 2) continue;
      const bool below = node<grid->low[c], above = node> grid->high[c];
      const int64_t to = below ? 2 * grid->low[c] - node : above ? 2 * grid->high[c] - node : node;
      const int at = (int)(to - (cell[c] - 1));
      const double sign = below || above ? -1.0 : 1.0, slope = w[i] * (i - t) * moment;
      if (at < 0 || at >= MPSI_PORE_SPAN) continue;
      out.w[c][at] += w[i];
      out.slope[c][at] += sign * slope;
    }
  }
  return out;
}

/* Adds to the forces of the particle's cell, and to the masses of its nodes. */
static void add_particle(mps_mpm *mpm, int64_t b, int64_t k) {
  const mpsi_grid *grid = &mpm->grid;
  const mpsi_cell_block *cells = &grid->cells[b];
  system_of *s = mpm->water->system;
  int at[3];
  int64_t cell[3] = {0};
  mpsi_unravel(mpm->water->place[k], MPSI_TILE_SIDE, at);
  for (int c = 0; c < grid->dim; c++) cell[c] = (int64_t)cells->at[c] * MPSI_SIDE + at[c];
  const shape n = find_shape(grid, &mpm->p, cell, k);
  const int32_t g = mpsi_block_under(cells, at[0], at[1], at[2]);
  const int local = mpsi_local_under(at[0], at[1], at[2]), nodes = span_nodes(grid);
  double *force = s->force + (int64_t)s->row[mpsi_first_node(grid, g) + local] * grid->dim * nodes;
  const int32_t *near = s->tile + g * tile_places(grid) + tile_place(grid, local, 1);
  const double V = mpm->p.V[k], m = mpm->p.m[k];
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  for (int q = 0; q < nodes; q++) {
    int i[3];
    mpsi_unravel(q, MPSI_PORE_SPAN, i);
    const double w[3] = {n.w[0][i[0]], n.w[1][i[1]], n.w[2][i[2]]};
    const double all = w[0] * w[1] * w[2];
    force[q] += V * n.slope[0][i[0]] * w[1] * w[2] + (ring ? V * all / mpm->p.x[0][k] : 0.0);
    force[nodes + q] += V * w[0] * n.slope[1][i[1]] * w[2];
    if (grid->dim == 3) force[2 * nodes + q] += V * w[0] * w[1] * n.slope[2][i[2]];
    const int64_t node = all > 0.0 ? near[(i[2] * TILE + i[1]) * TILE + i[0]] : -1;
    if (node >= 0) s->mass[node] += m * all;
  }
}

static void add_particles(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  (void)worker;
  for (int64_t k = mpm->grid.cells[b].begin; k < mpm->grid.cells[b].end; k++)
    add_particle(mpm, b, k);
}

/* Which components of the nodes of a block are prescribed. */
static void find_held(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  uint8_t *held = s->held + mpsi_first_node(grid, g);
  (void)factor;
  memset(held, 0, (size_t)grid->block_nodes);
  for (int32_t t = 0; t < grid->nodes[g].holds; t++) {
    const mpsi_held *at = &mpm->boundaries.held[grid->nodes[g].first_held + t];
    const mpsi_boundary *hold = &mpm->boundaries.hold[at->hold];
    mpsi_range in;
    if (hold->kind == MPS_BOUNDARY_OPEN || hold->kind == MPS_BOUNDARY_ABSORBING ||
        !mpsi_find_range(grid->dim, grid->nodes[g].at, hold, &in))
      continue;
    const bool whole = hold->kind == MPS_BOUNDARY_HELD || hold->kind == MPS_BOUNDARY_DRIVEN;
    const uint32_t dofs = at->hold < MPSI_SIDES && !whole ? 1u << hold->axis : hold->dofs;
    for (int k = in.low[2]; k <= in.high[2]; k++)
      for (int j = in.low[1]; j <= in.high[1]; j++)
        for (int i = in.low[0]; i <= in.high[0]; i++)
          held[mpsi_local_under(i, j, k)] |= (uint8_t)dofs;
  }
}

static mps_status assemble_forces(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  const mpsi_grid *grid = &mpm->grid;
  int32_t rows = 0;
  for (int64_t g = 0; g < grid->node_count; g++)
    for (int k = 0; k < grid->block_nodes; k++)
      if (mpsi_pore_marked(mpm->water->block[g].filled, k))
        s->row[mpsi_first_node(grid, g) + k] = rows++;
  const int64_t numbers = (int64_t)rows * grid->dim * span_nodes(grid);
  if (!ensure(mpm, &s->force_room, numbers, sizeof *s->force))
    return mpsi_fail_memory(mpm->context, function, (size_t)numbers * sizeof *s->force);
  s->force = s->force_room.item;
  memset(s->force, 0, (size_t)numbers * sizeof *s->force);
  for_blocks(mpm, find_tile, 0.0);
  const mpsi_pass pass = {.data = mpm, .clear = clear_masses, .scatter = add_particles};
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
  for_blocks(mpm, find_held, 0.0);
  return MPS_OK;
}

/* ---- the operator ---------------------------------------------------------------------------- */

static const double *forces_of(const mpsi_grid *grid, const system_of *s, int64_t cell) {
  return s->force + (int64_t)s->row[cell] * grid->dim * span_nodes(grid);
}

/* Velocities of nodes under the pressures `direction`, per dt. Node k is number q of the cell that
 * lies q places before the last of those in reach. */
static void find_velocities(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = span_nodes(grid);
  const int64_t first = mpsi_first_node(grid, g);
  const int32_t *tile = s->tile + g * tile_places(grid);
  int shift[MOST_SPAN];
  (void)factor;
  list_shifts(grid, shift);
  for (int k = 0; k < grid->block_nodes; k++) {
    double *v = s->velocity[first + k];
    v[0] = v[1] = v[2] = 0.0;
    if (!(s->mass[first + k] > 0.0)) continue;
    const int last = tile_place(grid, k, MPSI_PORE_SPAN - 2) + shift[nodes - 1];
    for (int q = 0; q < nodes; q++) {
      const int64_t cell = tile[last - shift[q]];
      if (cell < 0 || !(s->scale[cell] > 0.0)) continue;
      const double *force = forces_of(grid, s, cell), d = s->scale[cell] * s->direction[cell];
      for (int c = 0; c < grid->dim; c++) v[c] += force[c * nodes + q] * d;
    }
    for (int c = 0; c < grid->dim; c++)
      v[c] = s->held[first + k] >> c & 1 ? 0.0 : v[c] / s->mass[first + k];
  }
}

/* dt^2 G^T v of a cell, m3. */
static double squeeze_of(const mps_mpm *mpm, const system_of *s, int64_t g, int k, const int *shift,
                         bool diagonal) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = span_nodes(grid);
  const int64_t cell = mpsi_first_node(grid, g) + k;
  const double *force = forces_of(grid, s, cell), dt = mpm->run.dt;
  double sum = 0.0;
  const int32_t *near = s->tile + g * tile_places(grid) + tile_place(grid, k, 1);
  for (int q = 0; q < nodes; q++) {
    const int64_t node = near[shift[q]];
    if (node < 0 || !(s->mass[node] > 0.0)) continue;
    for (int c = 0; c < grid->dim; c++) {
      const double f = force[c * nodes + q];
      if (!diagonal)
        sum += f * s->velocity[node][c];
      else if (!(s->held[node] >> c & 1))
        sum += f * f * s->scale[cell] / s->mass[node];
    }
  }
  return dt * dt * s->scale[cell] * sum / grid->measure;
}

/* The matrix times `direction`; their product to the sums. */
static void multiply(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_water *water = mpm->water;
  const int64_t first = mpsi_first_node(grid, g);
  const mpsi_pore_cell *cell = water->cell + first;
  int shift[MOST_SPAN];
  (void)factor;
  list_shifts(grid, shift);
  s->part[g] = 0.0;
  for (int k = 0; k < grid->block_nodes; k++) {
    if (!is_unknown(water, g, k, cell)) continue;
    const double own = s->direction[first + k];
    double sum = s->diagonal[first + k] * own;
    for (int d = 0; d < 2 * grid->dim; d++) {
      if (s->conductance[first + k][d] == 0.0) continue;
      const mpsi_pore_cell *beside = mpsi_pore_beside(grid, water, g, k, d);
      sum +=
          mpm->run.dt * s->conductance[first + k][d] * (own - s->direction[beside - water->cell]);
    }
    sum += squeeze_of(mpm, s, g, k, shift, false);
    s->product[first + k] = sum;
    s->part[g] += own * sum;
  }
}

/* ---- conjugate gradients --------------------------------------------------------------------- */

/* d = 0, r = the right-hand side, z = r/diagonal; r.z to the sums. */
static void start(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  int shift[MOST_SPAN];
  (void)factor;
  list_shifts(&mpm->grid, shift);
  s->part[g] = 0.0;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!is_unknown(mpm->water, g, k, cell)) continue;
    double diagonal = s->diagonal[first + k] + squeeze_of(mpm, s, g, k, shift, true);
    for (int d = 0; d < 2 * mpm->grid.dim; d++)
      diagonal += mpm->run.dt * s->conductance[first + k][d];
    s->inverse[first + k] = 1.0 / diagonal;
    s->change[first + k] = 0.0;
    s->direction[first + k] = s->inverse[first + k] * s->residual[first + k];
    s->part[g] += s->residual[first + k] * s->direction[first + k];
  }
}

/* Along the direction; the new r.z to the sums. */
static void advance(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  s->part[g] = 0.0;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!is_unknown(mpm->water, g, k, cell)) continue;
    const int64_t at = first + k;
    s->change[at] += factor * s->direction[at];
    s->residual[at] -= factor * s->product[at];
    s->part[g] += s->residual[at] * s->residual[at] * s->inverse[at];
  }
}

static void turn(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (is_unknown(mpm->water, g, k, cell))
      s->direction[first + k] =
          s->inverse[first + k] * s->residual[first + k] + factor * s->direction[first + k];
}

static void take(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  mpsi_pore_cell *cell = mpm->water->cell + first;
  (void)factor;
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (is_unknown(mpm->water, g, k, cell)) cell[k].now = cell[k].p + s->change[first + k];
}

static mps_status iterate(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  double rest = sum_blocks(mpm, start, 0.0);
  const double least = TOLERANCE * TOLERANCE * rest;
  for (s->iterations = 0; rest > least || !isfinite(rest); s->iterations++) {
    if (s->iterations == MOST_ITERATIONS || !isfinite(rest))
      return mpsi_fail(mpm->context, function, MPS_ERROR_NUMERIC,
                       "step %lld: pressures of the pore water have a residual of %g after %lld "
                       "iterations, must come to %g: choose a smaller dt or K_w",
                       (long long)mpm->run.steps, sqrt(rest), (long long)s->iterations,
                       sqrt(least));
    for_blocks(mpm, find_velocities, 0.0);
    const double along = sum_blocks(mpm, multiply, 0.0), before = rest;
    rest = sum_blocks(mpm, advance, before / along);
    for_blocks(mpm, turn, rest / before);
  }
  for_blocks(mpm, take, 0.0);
  return MPS_OK;
}

mps_status mpsi_pore_solve(mps_mpm *mpm, const char *function) {
  const mps_status status = assemble_forces(mpm, function);
  return status == MPS_OK ? iterate(mpm, function) : status;
}
