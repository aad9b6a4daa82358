/* volumetric.c - F-bar by cell: the laws see the mean change of volume of the cell in place of the
 * particle's own. A cell with many particles then has one condition of constant volume, as the
 * nodes can satisfy, instead of one for each particle.
 *
 * The particles of a cell are those with the same stencil at the beginning of the step, whichever
 * block they are sorted to. When G2P has read the nodes, these have done their work: the lowest
 * node of each stencil then holds {sum V, sum V tr(d)} of its cell. In plane strain a deviation
 * from the mean changes the strain out of the plane too, by its third, as in space: else the part
 * without trace would change. SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

enum { SUM_VOLUME = 0, SUM_TRACE = 1 };

/* Columns of the velocity gradient's diagonal; that of zz is NULL in plane strain. */
static void find_diagonal(const mps_mpm *mpm, const double **diagonal) {
  const mpsi_columns *p = &mpm->p;
  const bool space = mpm->dim == 3;
  diagonal[0] = p->D[0];
  diagonal[1] = p->D[space ? 4 : 3];
  diagonal[2] = space ? p->D[8] : mpm->def.geometry == MPS_MPM_AXISYMMETRIC ? p->L[4] : NULL;
}

static double *sums_of(const mps_mpm *mpm, const mpsi_cell_block *cells, int64_t particle) {
  int at[3];
  mpsi_unravel(mpm->p.stencil[particle], MPSI_TILE_SIDE, at);
  return mpm->grid.node[mpsi_node_under(mpm, cells, at[0], at[1], at[2])];
}

/* Blocks of one colour have no node in common. */
static void add_cells(mps_mpm *mpm, int64_t b, int32_t worker) {
  (void)worker;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  const double *L[3], *V = mpm->p.V;
  find_diagonal(mpm, L);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    double *sums = sums_of(mpm, cells, k);
    sums[SUM_VOLUME] += V[k];
    sums[SUM_TRACE] += V[k] * (L[0][k] + L[1][k] + (L[2] ? L[2][k] : 0.0));
  }
}

void mpsi_mpm_mean_diagonals(const mps_mpm *mpm, const mpsi_cell_block *cells, int64_t begin,
                             int64_t end, double (*diagonal)[MPSI_CHUNK]) {
  const double *L[3];
  find_diagonal(mpm, L);
  for (int64_t k = begin; k < end; k++) {
    const double *sums = sums_of(mpm, cells, k);
    const double own = L[0][k] + L[1][k] + (L[2] ? L[2][k] : 0.0);
    const double change = (sums[SUM_TRACE] / sums[SUM_VOLUME] - own) / 3.0;
    for (int c = 0; c < 3; c++) diagonal[c][k - begin] = (L[c] ? L[c][k] : 0.0) + change;
  }
}

static void apply_laws(mps_mpm *mpm, int64_t b, int32_t worker) {
  mpsi_cell_block *cells = &mpm->grid.cells[b];
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    double *D[9];
    for (int c = 0; c < mpm->dim * mpm->dim; c++) D[c] = mpm->p.D[c] + k;
    mpsi_mpm_apply_law(mpm, cells, k, k + MPSI_CHUNK < cells->end ? k + MPSI_CHUNK : cells->end, D);
  }
  mpm->kernels->speed(mpm, b, worker);
}

void mpsi_mpm_apply_laws_by_cell(mps_mpm *mpm) {
  static const mpsi_pass pass = {
      .clear = mpsi_mpm_clear_nodes, .scatter = add_cells, .gather = apply_laws};
  for (int64_t b = 0; b < mpm->grid.cell_count; b++)
    if (mpm->grid.cells[b].bad >= 0 && !mpm->grid.cells[b].lost)
      return; /* the step has failed; its places may be no places */
  mpsi_mpm_run_pass(mpm, &pass);
}
