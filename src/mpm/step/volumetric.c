/* volumetric.c - means of the change of volume, by cell or by node.
 *
 * F-bar by cell: the laws take the mean change of volume of the cell in place of the particle's
 * own. A cell with many particles then has one condition of constant volume, as the nodes can
 * satisfy, instead of one for each particle.
 *
 * The particles of a cell are those with the same stencil at the beginning of the step, whichever
 * block they are sorted to. After G2P the values of the nodes are not needed any more: the lowest
 * node of each stencil then has {sum V, sum V tr(d)} of its cell. In plane strain a deviation
 * from the mean changes the out-of-plane strain too, by its third, as in 3D: else the deviatoric
 * part would change.
 *
 * By node, with the B-spline weights w at the beginning of the step: t_i = sum w V tr(d)/sum w V,
 * and the particle's is sum w t_i. A smooth rate does not remove differences of pressure that exist
 * already; so, after the laws, p_i = sum w V p/sum w V and p~ = sum w p_i, which replaces the mean
 * stress of a fluid (its state J does not change, so nothing is smoothed twice), and to which that
 * of other laws tends by beta c dt/h. Ghosts of mirrors are folded as mass is (mirror.h).
 *
 * At a wall or a surface all particles of a node lie on one side of it, and the mean of a pressure
 * that grows with depth is wrong by its gradient times their distance. So a fluid's pressure is
 * extrapolated to the node and back with its gradient at rest, p_i = sum w V (p + rho g.(x_i -
 * x))/sum w V and p~ = sum w (p_i - rho g.(x_i - x)): a fluid at rest does not change.
 *
 * By node and by law frictional laws, and by cell those with dilation, take each particle's own
 * tr(d) instead. With means of the rate and forces by own pressures, irregular pressures do net
 * work in a closed cycle, and dilation makes pressures irregular: a dilatant sand became unstable.
 * Its mean stress is filtered instead, by filter.c. SPDX-License-Identifier: BSD-3-Clause */
#include "means.h"

#include "mpm/water/water.h"

#include <string.h>

#define BETA 0.03 /* larger values spread pressure at free surfaces */

/* Whether the particle's law takes its own tr(d). */
static bool keeps_own(const mpsi_columns *p, int64_t k) {
  return p->laws.some_own && mpsi_law_of(p, k)->own_volume;
}

/* Columns of the velocity gradient's diagonal; that of zz is NULL in plane strain. */
static void find_diagonal(const mpsi_grid *grid, const mpsi_columns *p, const double **diagonal) {
  const bool space = grid->dim == 3;
  diagonal[0] = p->D[0];
  diagonal[1] = p->D[space ? 4 : 3];
  diagonal[2] = space ? p->D[8] : grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? p->L[4] : NULL;
}

/* Sums of the cells that a particle is in. One on a border between cells is in both by halves: the
 * same as in a mirror image, whatever round-off makes of its place. A side of the domain is no
 * border: a particle that a wall has stopped belongs to the cell inside. */
typedef struct cells_of {
  int count;
  double *sums[8];
} cells_of;

/* Whether cell `at` (tile node) along axis c is in the domain and in the part of the tile in use.
 */
static bool has_cell(const mpsi_grid *grid, const mpsi_cell_block *cells, int c, int at) {
  const int64_t base = (int64_t)cells->at[c] * MPSI_SIDE + at;
  if (at < cells->low[c] || at >= cells->high[c]) return false;
  return grid->spline != 3 || (base + 1 >= grid->low[c] && base + 1 < grid->high[c]);
}

/* A cell that a thin body divides counts as two. */
static cells_of find_sums(const mpsi_grid *grid, const mpsi_columns *p,
                          const mpsi_contacts *contacts, const mpsi_cell_block *cells,
                          const mpsi_worker *worker, int64_t particle) {
  cells_of out = {.count = 1};
  bool across = false;
  int at[8][3];
  const int32_t stencil = p->stencil[particle];
  mpsi_unravel(mpsi_stencil_node(stencil), MPSI_TILE_SIDE, at[0]);
  if (cells->thin) {
    double x[3];
    mpsi_former_place(grid, p, cells, at[0], particle, x);
    across = mpsi_mpm_find_parted(grid, contacts, cells, at[0], x).across & 1;
  }
  for (int c = 0; c < grid->dim; c++) {
    const int border = mpsi_stencil_border(stencil, c), own = at[0][c];
    if (border == 0 || !has_cell(grid, cells, c, own + border)) continue;
    const bool inside = has_cell(grid, cells, c, own);
    for (int k = 0, before = out.count; k < before; k++) {
      int *other = inside ? at[out.count++] : at[k];
      if (inside) memcpy(other, at[k], sizeof at[k]);
      other[c] = own + border;
    }
  }
  for (int k = 0; k < out.count; k++)
    out.sums[k] = mpsi_sums_at(grid, cells, worker, across, at[k][0], at[k][1], at[k][2]);
  return out;
}

/* Sums of the particle's cell where it is in that alone and no thin body is near, which is nearly
 * always so; NULL elsewhere. */
static inline double *find_only_sums(const mpsi_grid *grid, const mpsi_columns *p,
                                     const mpsi_cell_block *cells, const mpsi_worker *worker,
                                     int64_t particle) {
  const int32_t stencil = p->stencil[particle];
  int at[3];
  if (cells->thin || mpsi_stencil_on_border(stencil, grid->dim)) return NULL;
  mpsi_unravel(mpsi_stencil_node(stencil), MPSI_TILE_SIDE, at);
  return mpsi_sums_at(grid, cells, worker, false, at[0], at[1], at[2]);
}

static const double level[3] = {0.0, 0.0, 0.0}; /* zero gradient */

/* ---- by node --------------------------------------------------------------------------------- */

static bool by_nodes(const mps_mpm_def *def) { return def->volumetric == MPS_MPM_VOLUMETRIC_NODES; }

/* Whether the particle's mean stress is filtered, not smoothed (filter.c). */
static bool is_filtered(const mpsi_columns *p, int64_t k) {
  return p->laws.some_filtered && mpsi_law_of(p, k)->filtered;
}

/* Tile nodes of a particle's stencil along each axis, with images in place of ghosts of mirrors,
 * and weights. */
typedef struct support {
  int at[3][4];
  double w[3][4];
  double x[3];     /* position of the particle in the tile, in cells */
  uint64_t across; /* nodes of which the values across are used (thin_bodies.h) */
} support;

/* Stencil of a particle as G2P found it. */
static support support_of(const mpsi_grid *grid, const mpsi_columns *p,
                          const mpsi_contacts *contacts, const mpsi_cell_block *cells, int64_t k) {
  support out = {.w = {{1.0}, {1.0}, {1.0}}};
  int base[3];
  mpsi_unravel(mpsi_stencil_node(p->stencil[k]), MPSI_TILE_SIDE, base);
  if (cells->thin) {
    double x[3];
    mpsi_former_place(grid, p, cells, base, k, x);
    out.across = mpsi_mpm_find_parted(grid, contacts, cells, base, x).across;
  }
  for (int c = 0; c < grid->dim; c++) {
    const double t = p->t[c][k];
    out.x[c] = (double)base[c] + t;
    mpsi_weights(grid->spline, t, out.w[c]);
    for (int i = 0; i <= grid->spline; i++)
      out.at[c][i] = mpsi_mpm_mirror_partner(grid, cells, c, base[c] + i);
  }
  return out;
}

/* Difference between a node of the support and the particle of a linear function with the gradient
 * `slope` (3, per cell). */
static double linear_change(const support *s, const double *slope, int i, int j, int k) {
  return slope[0] * (s->at[0][i] - s->x[0]) + slope[1] * (s->at[1][j] - s->x[1]) +
         slope[2] * (s->at[2][k] - s->x[2]);
}

/* The sums of node (i, j, k) of a support. */
static double *node_of(const mpsi_grid *grid, const mpsi_cell_block *cells,
                       const mpsi_worker *worker, const support *s, int i, int j, int k) {
  const bool across = s->across >> (16 * k + 4 * j + i) & 1;
  return mpsi_sums_at(grid, cells, worker, across, s->at[0][i], s->at[1][j], s->at[2][k]);
}

/* Adds {V, V value} to the nodes by the weights, with the value extrapolated by `slope`. */
static void add_to_nodes(const mpsi_grid *grid, const mpsi_cell_block *cells,
                         const mpsi_worker *worker, const support *s, double V, double value,
                         const double *slope) {
  const int n = grid->spline, depth = grid->dim == 3 ? n : 0;
  for (int k = 0; k <= depth; k++)
    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n; i++) {
        const double w = s->w[0][i] * s->w[1][j] * s->w[2][k] * V;
        double *to = node_of(grid, cells, worker, s, i, j, k);
        to[MPSI_SUM_VOLUME] += w;
        to[MPSI_SUM_VALUE] += w * (value + linear_change(s, slope, i, j, k));
      }
}

/* Weighted mean of the nodes' means, extrapolated back to the particle by `slope`. */
static double mean_of_nodes(const mpsi_grid *grid, const mpsi_cell_block *cells, const support *s,
                            const double *slope) {
  const int n = grid->spline, depth = grid->dim == 3 ? n : 0;
  double sum = 0.0, weight = 0.0;
  for (int k = 0; k <= depth; k++)
    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n; i++) {
        const double w = s->w[0][i] * s->w[1][j] * s->w[2][k];
        const double *from = node_of(grid, cells, NULL, s, i, j, k);
        if (!(from[MPSI_SUM_VOLUME] > 0.0) || w == 0.0) continue;
        sum +=
            w * (from[MPSI_SUM_VALUE] / from[MPSI_SUM_VOLUME] - linear_change(s, slope, i, j, k));
        weight += w;
      }
  return sum / weight;
}

static double mean_stress(const mpsi_columns *p, int64_t k) {
  return (p->s[0][k] + p->s[1][k] + p->s[2][k]) / 3.0;
}

/* Gradient at rest, per cell, of the mean stress of a fluid; 0 for other laws. With it means over
 * the nodes do not change a fluid at rest, also at walls and surfaces, where the nodes lie on one
 * side. */
static void slope_at_rest(const mpsi_grid *grid, const mpsi_columns *p, const mps_mpm_def *def,
                          int64_t k, double *slope) {
  const bool fluid = mpsi_material_kept(mpsi_law_of(p, k)->material) == MPSI_KEPT_PRESSURE;
  const double weight = fluid ? p->m[k] / (p->V[k] * grid->inverse) : 0.0;
  for (int c = 0; c < 3; c++) slope[c] = c < grid->dim ? -weight * def->gravity[c] : 0.0;
}

static void sum_pressures(void *data, int64_t b, int32_t number) {
  mps_mpm *mpm = data;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  const mpsi_worker *worker = &mpm->grid.workers[number];
  mpsi_clear_sums(&mpm->grid, b, number);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    if (is_filtered(&mpm->p, k)) continue;
    const support s = support_of(&mpm->grid, &mpm->p, &mpm->contact, cells, k);
    double slope[3];
    slope_at_rest(&mpm->grid, &mpm->p, &mpm->def, k, slope);
    add_to_nodes(&mpm->grid, cells, worker, &s, mpm->p.V[k], mean_stress(&mpm->p, k), slope);
  }
}

static void smooth_pressures(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  const mpsi_columns *p = &mpm->p;
  for (int64_t k = cells->begin; k < cells->end; k++) {
    if (is_filtered(&mpm->p, k)) continue;
    const support s = support_of(&mpm->grid, &mpm->p, &mpm->contact, cells, k);
    double fraction = 1.0, wave, shear, slope[3];
    slope_at_rest(&mpm->grid, &mpm->p, &mpm->def, k, slope);
    if (mpsi_material_kept(mpsi_law_of(&mpm->p, k)->material) != MPSI_KEPT_PRESSURE) {
      mpsi_mpm_elastic(&mpm->p, k, &wave, &shear);
      fraction = fmin(1.0, BETA * sqrt(wave * p->V[k] / p->m[k]) * mpm->run.dt * mpm->grid.inverse);
    }
    const double change =
        fraction * (mean_of_nodes(&mpm->grid, cells, &s, slope) - mean_stress(&mpm->p, k));
    for (int c = 0; c < 3; c++) p->s[c][k] += change;
  }
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  mpm->kernels->speed(&work);
}

/* ---- by cell and by node --------------------------------------------------------------------- */

static void sum_rates(void *data, int64_t b, int32_t number) {
  mps_mpm *mpm = data;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  const mpsi_worker *worker = &mpm->grid.workers[number];
  const double *L[3], *V = mpm->p.V;
  mpsi_clear_sums(&mpm->grid, b, number);
  find_diagonal(&mpm->grid, &mpm->p, L);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    const double trace = L[0][k] + L[1][k] + (L[2] ? L[2][k] : 0.0);
    if (keeps_own(&mpm->p, k)) continue;
    if (by_nodes(&mpm->def)) {
      const support s = support_of(&mpm->grid, &mpm->p, &mpm->contact, cells, k);
      add_to_nodes(&mpm->grid, cells, worker, &s, V[k], trace, level);
      continue;
    }
    double *only = find_only_sums(&mpm->grid, &mpm->p, cells, worker, k);
    if (only) {
      only[MPSI_SUM_VOLUME] += V[k];
      only[MPSI_SUM_VALUE] += V[k] * trace;
      continue;
    }
    const cells_of of = find_sums(&mpm->grid, &mpm->p, &mpm->contact, cells, worker, k);
    const double part = of.count > 1 ? V[k] / of.count : V[k];
    for (int i = 0; i < of.count; i++) {
      of.sums[i][MPSI_SUM_VOLUME] += part;
      of.sums[i][MPSI_SUM_VALUE] += part * trace;
    }
  }
}

static void mean_diagonals(const mpsi_transfer *work, int64_t begin, int64_t end,
                           double (*diagonal)[MPSI_CHUNK]) {
  const mpsi_grid *grid = work->grid;
  const mpsi_columns *p = work->p;
  const mpsi_cell_block *cells = work->cells;
  const double *L[3];
  find_diagonal(grid, p, L);
  for (int64_t k = begin; k < end; k++) {
    const double own = L[0][k] + L[1][k] + (L[2] ? L[2][k] : 0.0);
    const double *only;
    double mean;
    if (keeps_own(p, k)) {
      mean = own;
    } else if (by_nodes(work->def)) {
      const support s = support_of(grid, p, work->contact, cells, k);
      mean = mean_of_nodes(grid, cells, &s, level);
    } else if ((only = find_only_sums(grid, p, cells, NULL, k))) {
      mean = only[MPSI_SUM_VALUE] / only[MPSI_SUM_VOLUME];
    } else {
      const cells_of of = find_sums(grid, p, work->contact, cells, NULL, k);
      mean = 0.0;
      for (int i = 0; i < of.count; i++)
        mean += of.sums[i][MPSI_SUM_VALUE] / of.sums[i][MPSI_SUM_VOLUME];
      if (of.count > 1) mean /= of.count;
    }
    const double change = (mean - own) / 3.0;
    for (int c = 0; c < 3; c++) diagonal[c][k - begin] = (L[c] ? L[c][k] : 0.0) + change;
  }
}

static void apply_laws(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  const mpsi_cell_block *cells = work.cells;
  mps_material_block seen;
  const mpsi_law_block laws = {work.grid, work.p, work.run, work.energy, cells, &seen};
  const bool responds = mpsi_pore_responds(mpm->water);
  mpsi_mpm_begin_block(&seen);
  if (responds) mpm->kernels->pore_begin_block(&work);
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int64_t end = k + MPSI_CHUNK < cells->end ? k + MPSI_CHUNK : cells->end;
    double *D[9], mean[3][MPSI_CHUNK], former[MPSI_CHUNK];
    for (int c = 0; c < mpm->grid.dim * mpm->grid.dim; c++) D[c] = mpm->p.D[c] + k;
    mean_diagonals(&work, k, end, mean);
    if (responds) memcpy(former, mpm->p.V + k, (size_t)(end - k) * sizeof *former);
    mpsi_mpm_apply_law(&laws, k, end, D, mean);
    if (!responds) continue;
    const double *const rate[3] = {mean[0], mean[1], mean[2]};
    mpsi_mpm_follow_motion(&mpm->p, mpm->run.dt, rate, k, (int)(end - k), former);
    mpm->kernels->pore_strain(&work, former, k, (int)(end - k));
  }
  if (responds) mpm->kernels->pore_respond(&work);
  if (!by_nodes(&mpm->def)) mpm->kernels->speed(&work);
}

static void add_rates(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_add_sums(mpm, b, worker, sum_rates);
}

static void add_pressures(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_add_sums(mpm, b, worker, sum_pressures);
}

void mpsi_mpm_apply_laws_by_cell(mps_mpm *mpm) {
  const bool means = !mpm->p.laws.at_once,
             filters = mpsi_mpm_filters(&mpm->p, mpm->water, &mpm->run);
  if (!(means || filters) || mpsi_any_failed(&mpm->grid, mpm->partition)) return;
  if (means) mpsi_run_sums(mpm, sum_rates, add_rates, apply_laws);
  if (!(by_nodes(&mpm->def) || filters) || mpsi_any_refused(&mpm->p, mpm->partition)) return;
  if (means && by_nodes(&mpm->def))
    mpsi_run_sums(mpm, sum_pressures, add_pressures, smooth_pressures);
  if (!filters) return;
  mpsi_pore_note_rest(mpm);
  mpsi_mpm_filter(mpm);
}
