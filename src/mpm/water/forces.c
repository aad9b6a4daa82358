/* forces.c - forces G of the cells on their nodes per pressure, for implicit.c, and the masses of
 * these nodes. A cell's forces are the sums of V grad phi over its particles, added in the order of
 * the blocks of cells. On several ranks the particles of border blocks are sent to the ranks that
 * have these as ghosts, which add them at the ghosts' turn: the cells and nodes that a rank counts
 * have the bits of one process. SPDX-License-Identifier: BSD-3-Clause */
#include "forces.h"

#include "mpm/base/shape.h"
#include "rim.h"

#include <string.h>

static void clear_masses(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_pore_system *s = mpm->water->system;
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

static shape find_shape(const mpsi_grid *grid, const double *x, const int64_t *cell) {
  const double moment = mpsi_inverse_moment(grid->spline) * grid->inverse;
  shape out = {.w = {{0.0}}};
  if (grid->dim == 2) out.w[2][0] = 1.0;
  for (int c = 0; c < grid->dim; c++) {
    double X = mpsi_grid_at(grid, c, x[c]), w[4];
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

/* Adds to the forces of the particle's cell, at axes [dim][nodes]. */
static void add_forces(const mpsi_grid *grid, const mpsi_pore_grain *particle, const shape *n,
                       double *force) {
  const int nodes = mpsi_pore_span_nodes(grid);
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  const double V = particle->V;
  for (int q = 0; q < nodes; q++) {
    int i[3];
    mpsi_unravel(q, MPSI_PORE_SPAN, i);
    const double w[3] = {n->w[0][i[0]], n->w[1][i[1]], n->w[2][i[2]]};
    const double all = w[0] * w[1] * w[2];
    force[q] += V * n->slope[0][i[0]] * w[1] * w[2] + (ring ? V * all / particle->x[0] : 0.0);
    force[nodes + q] += V * w[0] * n->slope[1][i[1]] * w[2];
    if (grid->dim == 3) force[2 * nodes + q] += V * w[0] * w[1] * n->slope[2][i[2]];
  }
}

/* Adds to the masses of the particle's nodes that this rank counts; `at`: its cell in the tile of
 * its block, `near`: numbers of the nodes. A particle that has left its block in the step may reach
 * nodes below the tile: other blocks add to those at the same time, and they go without it. */
static void add_masses(const mpsi_grid *grid, mpsi_pore_system *s, const mpsi_pore_grain *particle,
                       const shape *n, const int *at, const int32_t *near) {
  const int64_t own = grid->node_count * grid->block_nodes;
  for (int q = 0; q < mpsi_pore_span_nodes(grid); q++) {
    int i[3];
    bool in = true;
    mpsi_unravel(q, MPSI_PORE_SPAN, i);
    for (int c = 0; c < grid->dim; c++) in = in && at[c] + i[c] >= 1;
    const double all = n->w[0][i[0]] * n->w[1][i[1]] * n->w[2][i[2]];
    if (!in || !(all > 0.0)) continue;
    const int64_t node = near[(i[2] * MPSI_PORE_BOX + i[1]) * MPSI_PORE_BOX + i[0]];
    if (node >= 0 && node < own) s->mass[node] += particle->m * all;
  }
}

static void add_particle(mps_mpm *mpm, int64_t b, const mpsi_pore_grain *particle) {
  const mpsi_grid *grid = &mpm->grid;
  const mpsi_cell_block *cells = &grid->cells[b];
  mpsi_pore_system *s = mpm->water->system;
  int at[3];
  int64_t cell[3] = {0};
  mpsi_unravel((int)particle->place, MPSI_TILE_SIDE, at);
  for (int c = 0; c < grid->dim; c++) cell[c] = (int64_t)cells->at[c] * MPSI_SIDE + at[c];
  const shape n = find_shape(grid, particle->x, cell);
  const int32_t g = mpsi_block_under(cells, at[0], at[1], at[2]);
  const int local = mpsi_local_under(at[0], at[1], at[2]);
  if (mpsi_mpm_counts_node_block(grid, g))
    add_forces(grid, particle, &n, mpsi_pore_row(grid, s, mpsi_first_node(grid, g) + local));
  add_masses(grid, s, particle, &n, at,
             s->tile + g * mpsi_pore_box_places(grid) + mpsi_pore_place(grid, local, 1));
}

static void add_particles(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  (void)worker;
  for (int64_t k = cells->begin; k < cells->end; k++) {
    const mpsi_pore_grain particle = mpsi_pore_grain_of(mpm, k);
    add_particle(mpm, b, &particle);
  }
  if (!cells->ghost) return;
  int64_t count;
  const mpsi_pore_grain *particle = mpsi_pore_grains_of(mpm, b, &count);
  for (int64_t k = 0; k < count; k++) add_particle(mpm, b, &particle[k]);
}

/* Which components of the nodes of a block are prescribed. */
static void find_held(mps_mpm *mpm, mpsi_pore_system *s, int64_t g, double factor) {
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

/* Rows of forces for the cells that this rank counts, then for those of the rim. */
static mps_status make_rows(mps_mpm *mpm, const char *function) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_pore_system *s = mpm->water->system;
  int32_t rows = 0;
  for (int64_t g = 0; g < grid->node_count; g++)
    for (int k = 0; k < grid->block_nodes && mpsi_mpm_counts_node_block(grid, g); k++)
      if (mpsi_pore_marked(mpm->water->block[g].filled, k))
        s->row[mpsi_first_node(grid, g) + k] = rows++;
  for (int64_t k = 0; s->rim && k < s->rim->cells; k++)
    s->row[grid->node_count * grid->block_nodes + k] = rows++;
  const int64_t numbers = rows * mpsi_pore_row_numbers(grid);
  if (!mpsi_room_ensure(mpm->context, &s->force_room, numbers, sizeof *s->force))
    return mpsi_fail_memory(mpm->context, function, (size_t)numbers * sizeof *s->force);
  s->force = s->force_room.item;
  if (numbers > 0) memset(s->force, 0, (size_t)numbers * sizeof *s->force);
  return MPS_OK;
}

mps_status mpsi_pore_find_forces(mps_mpm *mpm, const char *function) {
  const mpsi_partition *partition = mpm->partition;
  const mpsi_pass pass = {.data = mpm,
                          .clear = clear_masses,
                          .scatter = add_particles,
                          .arrive = partition ? mpsi_pore_receive_grains : NULL};
  mps_status status = make_rows(mpm, function);
  if (partition) status = mpsi_domain_agree(partition->domain, function, status);
  if (status != MPS_OK) return status;
  if (partition) mpsi_pore_send_grains(mpm);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, find_held, 0.0);
  if (!partition) return MPS_OK;
  return partition->lost == MPS_OK ? mpsi_pore_send_forces(mpm, function) : partition->lost;
}
