/* forces.c - forces G of the cells on their nodes per pressure, for implicit.c, and the masses of
 * these nodes. A cell's forces are the sums of V grad phi over its particles, added in the order of
 * the blocks of cells. On several ranks the particles of border blocks are sent to the ranks that
 * have these as ghosts, which add them at the ghosts' turn: the cells and nodes that a rank counts
 * have the bits of one process. SPDX-License-Identifier: BSD-3-Clause */
#include "forces.h"

#include "mpm/base/kernels.h"
#include "rim.h"

#include <string.h>

/* A particle in its cell: along each axis, of the four nodes from the one below the cell on, the
 * derivatives (1/m) and weights that the gather takes for its strain: `along` a wall and `value` at
 * it (wall_support.h). Nodes beyond a mirror are added to their images, where velocities across it
 * have the other sign. */
typedef struct shape {
  double slope[3][MPSI_PORE_SPAN], along[3][MPSI_PORE_SPAN], value[3][MPSI_PORE_SPAN];
  double odd[MPSI_PORE_SPAN]; /* value along x, of the velocity along x */
  int cut;                    /* axes along which sides of the domain cut the stencil */
} shape;

/* What a side makes of the weights w, of nodes that are s cells away, and their slopes. */
static void fit_to_side(const double *s, double *w, double *slope, double *value) {
  double M[3] = {0.0};
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) M[k] += w[i] * (k == 0 ? 1.0 : k == 1 ? s[i] : s[i] * s[i]);
  const double inverse = 1.0 / (M[0] * M[2] - M[1] * M[1]);
  for (int i = 0; i < 4; i++) {
    value[i] = w[i] * (M[2] - M[1] * s[i]) * inverse;
    slope[i] = w[i] * (M[0] * s[i] - M[1]) * inverse;
    w[i] /= M[0];
  }
}

static void find_along(const mpsi_grid *grid, int c, double X, int64_t cell, shape *out) {
  X = fmin(fmax(X, (double)cell), (double)cell + 1.0);
  const int64_t lowest = (int64_t)mpsi_base(grid->spline, X);
  const int64_t base = lowest < cell - 1 ? cell - 1 : lowest > cell ? cell : lowest;
  double w[4], slope[4], value[4], s[4];
  bool cut = false;
  mpsi_weights(grid->spline, X - (double)base, w);
  mpsi_slopes(grid->spline, X - (double)base, slope);
  for (int i = 0; i < 4; i++) {
    s[i] = (double)(base + i) - X;
    if (i > grid->spline || (base + i >= grid->use_low[c] && base + i <= grid->use_high[c])) continue;
    w[i] = slope[i] = 0.0;
    cut = true;
  }
  memcpy(value, w, sizeof value);
  if (cut && !grid->standard) fit_to_side(s, w, slope, value);
  out->cut += cut && !grid->standard;
  for (int i = 0; i <= grid->spline; i++) {
    const int64_t node = base + i;
    const bool below = node<grid->low[c], above = node> grid->high[c];
    const int64_t to = below ? 2 * grid->low[c] - node : above ? 2 * grid->high[c] - node : node;
    const int at = (int)(to - (cell - 1));
    const double sign = below || above ? -1.0 : 1.0;
    if (at < 0 || at >= MPSI_PORE_SPAN) continue;
    out->slope[c][at] += sign * slope[i] * grid->inverse;
    out->along[c][at] += w[i];
    out->value[c][at] += value[i];
    if (c == 0) out->odd[at] += sign * value[i];
  }
}

static shape find_shape(const mpsi_grid *grid, const double *x, const int64_t *cell) {
  shape out = {.cut = 0};
  if (grid->dim == 2) out.along[2][0] = out.value[2][0] = 1.0;
  for (int c = 0; c < grid->dim; c++)
    find_along(grid, c, mpsi_grid_at(grid, c, x[c]), cell[c], &out);
  return out;
}

/* Adds to the forces of the particle's cell, at axes [dim][nodes]. */
static void add_forces(const mpsi_grid *grid, const mpsi_pore_grain *particle, const shape *n,
                       double *force) {
  const int nodes = mpsi_pore_span_nodes(grid);
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  const bool fits = n->cut > 1 || particle->light || grid->by_weight;
  const double V = particle->V;
  for (int q = 0; q < nodes; q++) {
    int i[3];
    mpsi_unravel(q, MPSI_PORE_SPAN, i);
    double w[3];
    for (int c = 0; c < 3; c++) w[c] = fits ? n->value[c][i[c]] : n->along[c][i[c]];
    const double hoop = ring ? n->odd[i[0]] * n->value[1][i[1]] / particle->x[0] : 0.0;
    force[q] += V * (n->slope[0][i[0]] * w[1] * w[2] + hoop);
    force[nodes + q] += V * w[0] * n->slope[1][i[1]] * w[2];
    if (grid->dim == 3) force[2 * nodes + q] += V * w[0] * w[1] * n->slope[2][i[2]];
  }
}

/* The nodes of a stencil that are in use, as mpsi_kept_fit.active has them. */
static uint64_t nodes_in_use(const mpsi_grid *grid, const int64_t *base) {
  const int last = grid->spline, planes = grid->dim == 3 ? last : 0;
  uint64_t out = 0;
  for (int k = 0; k <= planes; k++)
    for (int j = 0; j <= last; j++)
      for (int i = 0; i <= last; i++) {
        const int64_t at[3] = {base[0] + i, base[1] + j, base[2] + k};
        bool in = true;
        for (int c = 0; c < grid->dim; c++)
          in = in && at[c] >= grid->use_low[c] && at[c] <= grid->use_high[c];
        if (in) out |= UINT64_C(1) << (16 * k + 4 * j + i);
      }
  return out;
}

/* The stencil of a particle as the transfers have it. */
typedef struct stencil {
  int64_t base[3];
  double w[3][4], s[3][4];
} stencil;

static stencil find_stencil(const mpsi_grid *grid, const double *x) {
  stencil out = {.w[2][0] = 1.0};
  for (int c = 0; c < grid->dim; c++) {
    const double X = mpsi_grid_at(grid, c, x[c]), base = mpsi_base(grid->spline, X);
    out.base[c] = (int64_t)base;
    mpsi_weights(grid->spline, X - base, out.w[c]);
    for (int i = 0; i < 4; i++) out.s[c][i] = (double)i - (X - base);
  }
  return out;
}

/* As add_forces, of a particle whose support a body cuts: by the fit of the step. */
static void add_fitted(const mpsi_grid *grid, const mpsi_pore_grain *particle, const stencil *at,
                       const int64_t *cell, double *force) {
  const int nodes = mpsi_pore_span_nodes(grid), dim = grid->dim;
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  double q[4][4];
  for (int r = 0, n = 0; r <= dim; r++)
    for (int c = r; c <= dim; c++, n++) q[r][c] = q[c][r] = particle->fit.q[n];
  for (uint64_t left = particle->fit.active; left; left &= left - 1) {
    const int n = __builtin_ctzll(left), i[3] = {n % 4, n / 4 % 4, n / 16};
    double w = 1.0, by[4] = {0.0};
    int place = 0;
    bool in = true;
    for (int c = 2; c >= 0; c--) {
      const int64_t to = c < dim ? at->base[c] + i[c] - (cell[c] - 1) : 0;
      in = in && to >= 0 && to < MPSI_PORE_SPAN;
      place = MPSI_PORE_SPAN * place + (int)to;
      w *= at->w[c][i[c]];
    }
    if (!in) continue;
    for (int r = 0; r <= dim; r++) {
      by[r] = q[r][0];
      for (int c = 0; c < dim; c++) by[r] += q[r][1 + c] * at->s[c][i[c]];
    }
    for (int c = 0; c < dim; c++)
      force[c * nodes + place] += particle->V * w * by[1 + c] * grid->inverse;
    if (ring) force[place] += particle->V * w * by[0] / particle->x[0];
  }
}

static void add_particle(mps_mpm *mpm, const mpsi_cell_block *cells,
                         const mpsi_pore_grain *particle) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_pore_system *s = mpm->water->system;
  int at[3];
  int64_t cell[3] = {0};
  mpsi_unravel((int)particle->place, MPSI_TILE_SIDE, at);
  for (int c = 0; c < grid->dim; c++) cell[c] = (int64_t)cells->at[c] * MPSI_SIDE + at[c];
  const int32_t g = mpsi_block_under(cells, at[0], at[1], at[2]);
  const int local = mpsi_local_under(at[0], at[1], at[2]);
  if (!mpsi_mpm_counts_node_block(grid, g)) return;
  double *force = mpsi_pore_row(grid, s, mpsi_first_node(grid, g) + local);
  if (particle->fitted) {
    const stencil own = find_stencil(grid, particle->x);
    if (particle->fit.active != nodes_in_use(grid, own.base)) {
      add_fitted(grid, particle, &own, cell, force);
      return;
    }
  }
  const shape n = find_shape(grid, particle->x, cell);
  add_forces(grid, particle, &n, force);
}

static void add_particles(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  (void)worker;
  for (int64_t k = cells->begin; k < cells->end; k++) {
    const mpsi_pore_grain particle = mpsi_pore_grain_of(mpm, cells, k);
    add_particle(mpm, cells, &particle);
  }
  if (!cells->ghost) return;
  int64_t count;
  const mpsi_pore_grain *particle = mpsi_pore_grains_of(mpm, b, &count);
  for (int64_t k = 0; k < count; k++) add_particle(mpm, cells, &particle[k]);
}

/* Masses and velocities of the nodes of a block without a correction, and which components are
 * prescribed. */
static void find_nodes(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_pore_system *s = mpm->water->system;
  const mpsi_grid *grid = &mpm->grid;
  const int64_t first = mpsi_first_node(grid, g);
  uint8_t *held = s->held + first;
  (void)worker;
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
                          .clear = find_nodes,
                          .scatter = add_particles,
                          .arrive = partition ? mpsi_pore_receive_grains : NULL};
  mps_status status = make_rows(mpm, function);
  if (partition) status = mpsi_domain_agree(partition->domain, function, status);
  if (status != MPS_OK) return status;
  if (partition) mpsi_pore_send_grains(mpm);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
  if (!partition) return MPS_OK;
  return partition->lost == MPS_OK ? mpsi_pore_send_forces(mpm, function) : partition->lost;
}
