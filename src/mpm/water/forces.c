/* forces.c - forces G of the cells on their nodes per pressure, for implicit.c. A cell's forces are
 * the sums of V grad phi over its particles, added in the order of the blocks of cells. On several
 * ranks the particles of border blocks are sent to the ranks that have these as ghosts, which add
 * them at the ghosts' turn: the cells and nodes that a rank counts have the bits of one process.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "forces.h"

#include "core/base/room_array.h"
#include "mpm/base/kernels.h"
#include "mpm/boundary/kinds.h"
#include "mpm/ranks/messages.h"
#include "wide_halo.h"

#include <string.h>

/* A particle's stencil along each axis: its nodes from `base` on, the derivatives (1/m) and the
 * weights that the gather takes for its strain, `along` a wall and `value` at it (wall_support.h).
 * Places are those of its cell: a particle on a face keeps to the cell that it is summed in. */
typedef struct stencil {
  int64_t base[3];
  double w[3][4], s[3][4]; /* weights, and distances of the nodes (cells) */
  double slope[3][4], along[3][4], value[3][4];
  int cut; /* axes along which sides of the domain cut it */
} stencil;

/* What a side makes of weights and derivatives along its axis. */
static void fit_to_side(const double *w, const double *s, double inverse, double *slope,
                        double *along, double *value) {
  double M[3] = {0.0};
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) M[k] += w[i] * (k == 0 ? 1.0 : k == 1 ? s[i] : s[i] * s[i]);
  const double by = 1.0 / (M[0] * M[2] - M[1] * M[1]);
  for (int i = 0; i < 4; i++) {
    value[i] = w[i] * (M[2] - M[1] * s[i]) * by;
    slope[i] = w[i] * (M[0] * s[i] - M[1]) * by * inverse;
    along[i] = w[i] / M[0];
  }
}

static void find_along(const mpsi_grid *grid, int c, double X, stencil *out) {
  double *w = out->w[c], *s = out->s[c], *slope = out->slope[c];
  const int64_t base = (int64_t)mpsi_base(grid->spline, X);
  bool cut = false;
  out->base[c] = base;
  mpsi_weights(grid->spline, X - (double)base, w);
  mpsi_slopes(grid->spline, X - (double)base, slope);
  for (int i = 0; i < 4; i++) {
    s[i] = (double)(base + i) - X;
    slope[i] *= grid->inverse;
    if (i > grid->spline || (base + i >= grid->use_low[c] && base + i <= grid->use_high[c]))
      continue;
    w[i] = slope[i] = 0.0;
    cut = true;
  }
  memcpy(out->along[c], w, sizeof out->along[c]);
  memcpy(out->value[c], w, sizeof out->value[c]);
  if (!cut || grid->standard) return;
  fit_to_side(w, s, grid->inverse, slope, out->along[c], out->value[c]);
  out->cut++;
}

static stencil find_stencil(const mpsi_grid *grid, const double *x) {
  stencil out = {.cut = 0};
  for (int c = 0; c < grid->dim; c++) find_along(grid, c, mpsi_grid_at(grid, c, x[c]), &out);
  for (int c = grid->dim; c < 3; c++) out.w[c][0] = out.along[c][0] = out.value[c][0] = 1.0;
  return out;
}

/* Number n = 16 k + 4 j + i of a stencil: its weights, its place, whether it is in use. */
static bool find_node(const mpsi_grid *grid, const stencil *at, int n, int *i, int64_t *node) {
  bool in = true;
  i[0] = n % 4, i[1] = n / 4 % 4, i[2] = n / 16;
  for (int c = 0; c < 3; c++) {
    node[c] = at->base[c] + i[c];
    in = in && i[c] <= (c < grid->dim ? grid->spline : 0);
    if (c < grid->dim) in = in && node[c] >= grid->use_low[c] && node[c] <= grid->use_high[c];
  }
  return in;
}

/* The row of a cell: forces at axes [dim][nodes], m3/s that moving sides bring in as mirrors, and
 * the force of these per pressure. */
typedef struct row {
  int64_t cell[3];
  double *force, *carried, *turned;
} row;

/* Adds V grad phi of a node, which beyond a mirror is its image there (boundary/mirror.c). */
static void add_node(const mps_mpm *mpm, const row *to, int64_t *node, double *gradient) {
  const mpsi_grid *grid = &mpm->grid;
  int place = 0;
  for (int c = 0; c < grid->dim; c++) {
    const bool above = node[c] > grid->high[c];
    if (!above && node[c] >= grid->low[c]) continue;
    const mpsi_boundary *side = &mpm->boundaries.boundary[2 * c + above];
    node[c] = 2 * (above ? grid->high[c] : grid->low[c]) - node[c];
    for (int a = 0; a < grid->dim; a++) {
      if (!mpsi_side_turns(side, c, a)) continue;
      *to->carried += 2.0 * gradient[a] * side->v[a];
      if (a == c) to->turned[2 * c + above] -= 2.0 * gradient[a];
      gradient[a] = -gradient[a];
    }
  }
  for (int c = grid->dim - 1; c >= 0; c--) {
    const int64_t at = node[c] - (to->cell[c] - 1);
    if (at < 0 || at >= MPSI_PORE_SPAN) return;
    place = MPSI_PORE_SPAN * place + (int)at;
  }
  for (int a = 0; a < grid->dim; a++)
    to->force[a * mpsi_pore_span_nodes(grid) + place] += gradient[a];
}

/* By full supports, and such as sides cut. */
static void add_forces(const mps_mpm *mpm, const mpsi_pore_particle *particle, const stencil *at,
                       const row *to) {
  const mpsi_grid *grid = &mpm->grid;
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  const bool fits = at->cut > 1 || particle->light || grid->by_weight;
  for (int n = 0; n < (grid->dim == 3 ? 64 : 16); n++) {
    int i[3];
    int64_t node[3];
    double w[3], gradient[3];
    if (!find_node(grid, at, n, i, node)) continue;
    for (int c = 0; c < 3; c++) w[c] = fits ? at->value[c][i[c]] : at->along[c][i[c]];
    for (int c = 0; c < grid->dim; c++)
      gradient[c] = particle->V * at->slope[c][i[c]] * w[(c + 1) % 3] * w[(c + 2) % 3];
    if (ring) gradient[0] += particle->V * at->value[0][i[0]] * at->value[1][i[1]] / particle->x[0];
    add_node(mpm, to, node, gradient);
  }
}

/* By the fit of the step, of a particle whose support a body cuts. */
static void add_fitted(const mps_mpm *mpm, const mpsi_pore_particle *particle, const stencil *at,
                       const row *to) {
  const mpsi_grid *grid = &mpm->grid;
  const int dim = grid->dim;
  const bool ring = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
  double q[4][4];
  for (int r = 0, n = 0; r <= dim; r++)
    for (int c = r; c <= dim; c++, n++) q[r][c] = q[c][r] = particle->fit.q[n];
  for (uint64_t left = particle->fit.active; left; left &= left - 1) {
    int i[3];
    int64_t node[3];
    double by[4], gradient[3];
    (void)find_node(grid, at, __builtin_ctzll(left), i, node);
    const double w = particle->V * at->w[0][i[0]] * at->w[1][i[1]] * at->w[2][i[2]];
    for (int r = 0; r <= dim; r++) {
      by[r] = q[r][0];
      for (int c = 0; c < dim; c++) by[r] += q[r][1 + c] * at->s[c][i[c]];
    }
    for (int c = 0; c < dim; c++) gradient[c] = w * by[1 + c] * grid->inverse;
    if (ring) gradient[0] += w * by[0] / particle->x[0];
    add_node(mpm, to, node, gradient);
  }
}

/* Whether the nodes of the particle's fit are all that its stencil has: no body cuts it. */
static bool uses_all(const mpsi_grid *grid, const mpsi_pore_particle *particle, const stencil *at) {
  uint64_t all = 0;
  for (int n = 0; n < (grid->dim == 3 ? 64 : 16); n++) {
    int i[3];
    int64_t node[3];
    if (find_node(grid, at, n, i, node)) all |= UINT64_C(1) << n;
  }
  return all == particle->fit.active;
}

static void add_particle(mps_mpm *mpm, const mpsi_cell_block *cells,
                         const mpsi_pore_particle *particle) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_pore_system *s = mpm->water->system;
  int at[3];
  row to = {{0}, NULL, NULL, NULL};
  mpsi_unravel(particle->place, MPSI_TILE_SIDE, at);
  for (int c = 0; c < grid->dim; c++) to.cell[c] = (int64_t)cells->at[c] * MPSI_SIDE + at[c];
  const int32_t g = mpsi_block_under(cells, at[0], at[1], at[2]);
  if (!mpsi_mpm_counts_node_block(grid, g)) return;
  const int64_t cell = mpsi_first_node(grid, g) + mpsi_local_under(at[0], at[1], at[2]);
  to.force = mpsi_pore_row(grid, s, cell);
  to.carried = &s->carried[cell];
  to.turned = s->turned[cell];
  const stencil nodes = find_stencil(grid, particle->x);
  if (particle->fitted && !uses_all(grid, particle, &nodes))
    add_fitted(mpm, particle, &nodes, &to);
  else
    add_forces(mpm, particle, &nodes, &to);
}

static void add_particles(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  for (int64_t k = cells->begin; k < cells->end; k++) {
    const mpsi_pore_particle particle = mpsi_pore_particle_of(mpm, cells, k);
    add_particle(mpm, cells, &particle);
  }
  if (!cells->ghost) return;
  int64_t count;
  const mpsi_pore_particle *particle = mpsi_pore_particles_of(mpm, b, &count);
  for (int64_t k = 0; k < count; k++) add_particle(mpm, cells, &particle[k]);
}

/* Masses of the nodes of a block: while the velocities that the pressures make are found, no
 * boundary has acted (foresee.c). */
static void find_masses(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_grid *grid = &mpm->grid;
  const int64_t first = mpsi_first_node(grid, g);
  for (int64_t k = first; k < first + grid->block_nodes; k++)
    for (int c = 0; c < 3; c++) mpm->water->system->inertia[k][c] = grid->node[k][MPSI_MASS];
}

/* Rows of forces for the cells that this rank counts, then for those of the wide halo. */
static mps_status make_rows(mps_mpm *mpm, const char *function) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_pore_system *s = mpm->water->system;
  int32_t rows = 0;
  for (int64_t g = 0; g < grid->node_count; g++) {
    const bool counts = mpsi_mpm_counts_node_block(grid, g);
    for (int k = 0; k < grid->block_nodes; k++) {
      const int64_t cell = mpsi_first_node(grid, g) + k;
      const bool filled = counts && mpsi_pore_is_unknown(mpm->water, g, k);
      s->row[cell] = filled ? rows++ : -1;
      if (!filled) continue;
      s->carried[cell] = 0.0;
      memset(s->turned[cell], 0, sizeof s->turned[cell]);
    }
  }
  for (int64_t k = 0; s->wide_halo && k < s->wide_halo->cells; k++)
    s->row[grid->node_count * grid->block_nodes + k] = rows++;
  const int64_t numbers = rows * mpsi_pore_row_numbers(grid);
  if (!MPSI_ENSURE(mpm->context, s, force, numbers))
    return mpsi_fail_memory(mpm->context, function, (size_t)numbers * sizeof *s->force);
  if (numbers > 0) memset(s->force, 0, (size_t)numbers * sizeof *s->force);
  return MPS_OK;
}

mps_status mpsi_pore_find_forces(mps_mpm *mpm, const char *function) {
  const mpsi_partition *partition = mpm->partition;
  const mpsi_pass pass = {.data = mpm,
                          .clear = find_masses,
                          .scatter = add_particles,
                          .ranks = mpm->partition,
                          .arrive = mpsi_mpm_receive_messages};
  mps_status status = make_rows(mpm, function);
  if (partition) status = mpsi_domain_agree(partition->domain, function, status);
  if (status != MPS_OK) return status;
  if (partition) mpsi_pore_send_particles(mpm);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
  if (!partition) return MPS_OK;
  return partition->lost == MPS_OK ? mpsi_pore_send_forces(mpm, function) : partition->lost;
}
