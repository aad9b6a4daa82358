/* forces.c - forces G of the cells on their nodes per pressure, for implicit.c, and the masses of
 * these nodes. A cell's forces are the sums of V grad phi over its particles, added in the order of
 * the blocks of cells. On several ranks the particles of border blocks are sent to the ranks that
 * have these as ghosts, which add them at the ghosts' turn: the cells and nodes that a rank counts
 * have the bits of one process. SPDX-License-Identifier: BSD-3-Clause */
#include "forces.h"

#include "mpm/base/kernels.h"
#include "rim.h"

#include <string.h>

/* A particle in its cell: along each axis weights and slopes of the four nodes from the one below
 * the cell on, those beyond a side of the domain added to their mirror images, where velocities
 * across it have the other sign. */
typedef struct shape {
  double w[3][MPSI_PORE_SPAN], slope[3][MPSI_PORE_SPAN]; /* slope: 1/m */
  double odd[MPSI_PORE_SPAN]; /* weights along x for the velocity along x */
} shape;

static shape find_shape(const mpsi_grid *grid, const double *x, const int64_t *cell) {
  shape out = {.w = {{0.0}}};
  if (grid->dim == 2) out.w[2][0] = 1.0;
  for (int c = 0; c < grid->dim; c++) {
    double X = mpsi_grid_at(grid, c, x[c]), w[4], slope[4];
    X = fmin(fmax(X, (double)cell[c]), (double)cell[c] + 1.0);
    const int64_t lowest = (int64_t)mpsi_base(grid->spline, X);
    const int64_t base = lowest < cell[c] - 1 ? cell[c] - 1 : lowest > cell[c] ? cell[c] : lowest;
    const double t = X - (double)base;
    mpsi_weights(grid->spline, t, w);
    mpsi_slopes(grid->spline, t, slope);
    for (int i = 0; i <= grid->spline; i++) {
      const int64_t node = base + i;
      if (node > cell[c] + 2) continue;
      const bool below = node<grid->low[c], above = node> grid->high[c];
      const int64_t to = below ? 2 * grid->low[c] - node : above ? 2 * grid->high[c] - node : node;
      const int at = (int)(to - (cell[c] - 1));
      const double sign = below || above ? -1.0 : 1.0;
      if (at < 0 || at >= MPSI_PORE_SPAN) continue;
      out.w[c][at] += w[i];
      out.slope[c][at] += sign * slope[i] * grid->inverse;
      if (c == 0) out.odd[at] += sign * w[i];
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
    const double hoop = ring ? n->odd[i[0]] * w[1] / particle->x[0] : 0.0;
    force[q] += V * (n->slope[0][i[0]] * w[1] * w[2] + hoop);
    force[nodes + q] += V * w[0] * n->slope[1][i[1]] * w[2];
    if (grid->dim == 3) force[2 * nodes + q] += V * w[0] * w[1] * n->slope[2][i[2]];
  }
}

/* The same of a particle whose support a body cuts, by the fit of the step. */
static void add_fitted(const mps_mpm *mpm, const mpsi_transfer *work, int64_t k, double V,
                       const int *cell, double *force) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = mpsi_pore_span_nodes(grid);
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  mpsi_foot_weights here, there;
  const double none[3] = {0.0};
  mpm->kernels->foot(work, k, none, &here);
  for (int c = 0; c < grid->dim; c++) {
    double d[3] = {0.0};
    d[c] = grid->cell;
    mpm->kernels->foot(work, k, d, &there);
    for (uint64_t left = here.active; left; left &= left - 1) {
      const int n = __builtin_ctzll(left);
      const int i[3] = {here.at[0] + n % 4 - cell[0] + 1, here.at[1] + n / 4 % 4 - cell[1] + 1,
                        grid->dim == 3 ? here.at[2] + n / 16 - cell[2] + 1 : 0};
      bool in = true;
      for (int a = 0; a < 3; a++) in = in && i[a] >= 0 && i[a] < MPSI_PORE_SPAN;
      if (!in) continue;
      const int q = (i[2] * MPSI_PORE_SPAN + i[1]) * MPSI_PORE_SPAN + i[0];
      force[c * nodes + q] += V * (there.psi[n] - here.psi[n]) * grid->inverse;
      if (ring && c == 0) force[q] += V * here.psi[n] / mpm->p.x[0][k];
    }
  }
}

static void add_particle(mps_mpm *mpm, const mpsi_transfer *work, int64_t k,
                         const mpsi_pore_grain *particle) {
  const mpsi_grid *grid = &mpm->grid;
  const mpsi_cell_block *cells = work->cells;
  mpsi_pore_system *s = mpm->water->system;
  int at[3];
  int64_t cell[3] = {0};
  mpsi_unravel((int)particle->place, MPSI_TILE_SIDE, at);
  for (int c = 0; c < grid->dim; c++) cell[c] = (int64_t)cells->at[c] * MPSI_SIDE + at[c];
  const int32_t g = mpsi_block_under(cells, at[0], at[1], at[2]);
  const int local = mpsi_local_under(at[0], at[1], at[2]);
  if (!mpsi_mpm_counts_node_block(grid, g)) return;
  double *force = mpsi_pore_row(grid, s, mpsi_first_node(grid, g) + local);
  if (k >= 0 && cells->first_fit >= 0 &&
      grid->fitted[cells->first_fit + (k - cells->begin)] == MPSI_FITTED_CUT) {
    add_fitted(mpm, work, k, particle->V, at, force);
    return;
  }
  const shape n = find_shape(grid, particle->x, cell);
  add_forces(grid, particle, &n, force);
}

static void add_particles(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  const mpsi_cell_block *cells = work.cells;
  for (int64_t k = cells->begin; k < cells->end; k++) {
    const mpsi_pore_grain particle = mpsi_pore_grain_of(mpm, k);
    add_particle(mpm, &work, k, &particle);
  }
  if (!cells->ghost) return;
  int64_t count;
  const mpsi_pore_grain *particle = mpsi_pore_grains_of(mpm, b, &count);
  for (int64_t k = 0; k < count; k++) add_particle(mpm, &work, -1, &particle[k]);
}

static void clear_nothing(void *data, int64_t g, int32_t worker) {
  (void)data, (void)g, (void)worker;
}

/* Masses and velocities of the nodes of a block without a correction, and which components are
 * prescribed. */
static void find_held(mps_mpm *mpm, mpsi_pore_system *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  const int64_t first = mpsi_first_node(grid, g);
  uint8_t *held = s->held + first;
  (void)factor;
  memset(held, 0, (size_t)grid->block_nodes);
  for (int k = 0; k < grid->block_nodes; k++) {
    const double *node = grid->node[first + k];
    s->mass[first + k] = node[MPSI_MASS];
    for (int c = 0; c < 3; c++) s->velocity[first + k][c] = node[MPSI_VECTOR + c];
  }
  for (int32_t t = 0; t < grid->nodes[g].holds; t++) {
    const mpsi_held *at = &mpm->boundaries.held[grid->nodes[g].first_held + t];
    const mpsi_boundary *hold = &mpm->boundaries.hold[at->hold];
    mpsi_range in;
    if (hold->kind == MPS_BOUNDARY_OPEN || hold->kind == MPS_BOUNDARY_ABSORBING ||
        !mpsi_find_range(grid->dim, grid->nodes[g].at, hold, &in))
      continue;
    const bool whole = hold->kind == MPS_BOUNDARY_HELD || hold->kind == MPS_BOUNDARY_DRIVEN;
    const uint32_t dofs = at->hold < MPSI_SIDES && !whole ? 1u << hold->axis : hold->dofs;
    const bool moves = hold->kind == MPS_BOUNDARY_FREE_FIELD;
    for (int k = in.low[2]; k <= in.high[2]; k++)
      for (int j = in.low[1]; j <= in.high[1]; j++)
        for (int i = in.low[0]; i <= in.high[0]; i++) {
          const int local = mpsi_local_under(i, j, k);
          held[local] |= (uint8_t)dofs;
          for (int c = 0; c < grid->dim && !moves; c++)
            if (dofs >> c & 1) s->velocity[first + local][c] = hold->v[c];
        }
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
  memset(s->force, 0, (size_t)numbers * sizeof *s->force);
  return MPS_OK;
}

mps_status mpsi_pore_find_forces(mps_mpm *mpm, const char *function) {
  const mpsi_partition *partition = mpm->partition;
  const mpsi_pass pass = {.data = mpm,
                          .clear = clear_nothing,
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
