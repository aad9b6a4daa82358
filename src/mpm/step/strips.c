/* strips.c - particles in the strips beyond inset edges (contact/edge.h), which the body does not
 * bear. The ground there flows on between the face and free ground, and would enter the body by
 * some 1e-4 cells a step. Its places are corrected, not its velocities: a particle nearer to the
 * body than its half size e is moved along the normal to that distance, no farther than e in a
 * step. So no force acts, and no work is done; momentum does not change, and moment of momentum,
 * which a moved particle has less of, goes to the spin of its velocity gradient, from which the
 * next transfer gives it to the nodes (transfer/spin.h). SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/grid/pass.h"

/* Whether x lies in the domain; `left`: its stencil leaves the tile of the block (g2p.c). */
static bool is_in_domain(const mpsi_grid *grid, const mpsi_cell_block *cells, const double *x,
                         bool *left) {
  const double first = grid->spline == 3 ? 1.0 : 0.5;
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && !(x[0] > 0.0)) return false;
  for (int c = 0; c < grid->dim; c++) {
    const double X = mpsi_grid_at(grid, c, x[c]), own = X - (double)cells->at[c] * MPSI_SIDE;
    if (!(X >= (double)grid->low[c]) || !(X <= (double)grid->high[c])) return false;
    if (!(own >= first + cells->low[c]) || !(own < first + (cells->high[c] - mpsi_reach(grid, c))))
      *left = true;
  }
  return true;
}

static void move_off(const mpsi_grid *grid, const mpsi_columns *p, const mps_contact *contact,
                     mpsi_cell_block *cells, int64_t k) {
  double x[3] = {0.0}, to[3], v[2];
  for (int c = 0; c < grid->dim; c++) x[c] = p->x[c][k];
  const mpsi_bearing bearing = mpsi_mpm_bearing(grid, p, contact, k, x);
  const double by = fmin(bearing.half, bearing.half - bearing.foot.distance);
  if (!(by > 0.0)) return;
  for (int c = 0; c < 3; c++) to[c] = x[c] + by * bearing.foot.normal[c];
  if (!is_in_domain(grid, cells, to, &cells->left)) return;
  for (int c = 0; c < grid->dim; c++) p->x[c][k] = to[c], v[c] = p->v[c][k];
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) return; /* rings */
  const double moment = (to[0] - x[0]) * v[1] - (to[1] - x[1]) * v[0];
  const double spin = mpsi_inverse_moment(grid->spline) * moment * grid->inverse * grid->inverse;
  p->L[2][k] -= 0.5 * spin, p->L[1][k] += 0.5 * spin;
}

static void clear_block(void *solver, int64_t b, int32_t worker) {
  mps_mpm *mpm = solver;
  mpsi_cell_block *cells = &mpm->grid.cells[b];
  for (int32_t q = 0; q < cells->pairs; q++) {
    const mpsi_cell_pair *pair = &mpm->contact.cell_pair[cells->first_pair + q];
    const int32_t *strip = mpm->contact.impulses.candidate + pair->first_candidate;
    for (int64_t i = 0; i < pair->strips; i++)
      move_off(&mpm->grid, &mpm->p, mpm->contact.handle[pair->body], cells,
               cells->begin + strip[i]);
  }
}

void mpsi_mpm_clear_strips(mps_mpm *mpm) {
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, clear_block, mpm);
}
