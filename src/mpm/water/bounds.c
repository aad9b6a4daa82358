/* bounds.c - what a step may make of saturated ground. After G2P and the laws each particle has
 *
 *   0 < n < 1         grains and water both fill a part of it
 *   |p| <= K_w        water whose density rho_w (1 + p/K_w) is neither negative nor doubled
 *   |v| dt <= h       within the Courant limit dt <= h/(c + v) no motion crosses a cell in a step:
 *                     a speed beyond it takes an acceleration by strains above 1 within the step
 *
 * or the step has diverged, and is undone (step/undo.h). A calm step, whose strains are below 1/10,
 * cannot come there from .1 <= n <= .9 and |p| <= K_w/4: others are saved. Steps with implicit pressures change
 * porosities after the motion (cell_loops.c): here those which they will have.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/kernels.h"
#include "water.h"

#include <stdio.h>

/* Porosity of particle k after the step. */
static double porosity_of(const mps_mpm *mpm, int64_t k) {
  const mpsi_columns *p = &mpm->p;
  if (mpsi_pore_responds(mpm->water)) return p->n[k];
  return 1.0 - (1.0 - p->n[k]) * (mpm->water->former[k] / p->V[k]);
}

static double speed_of(const mps_mpm *mpm, int64_t k) {
  double square = 0.0;
  for (int c = 0; c < mpm->grid.dim; c++) square += mpm->p.v[c][k] * mpm->p.v[c][k];
  return sqrt(square);
}

static bool is_possible(const mps_mpm *mpm, int64_t k) {
  const double n = porosity_of(mpm, k);
  return n > 0.0 && n < 1.0 && fabs(mpm->p.u[k]) <= mpm->water->def.bulk &&
         speed_of(mpm, k) * mpm->run.dt <= mpm->grid.cell;
}

/* Whether all particles [begin, end) are far inside the bounds of n and p, without branches. */
static bool are_far_inside(const mps_mpm *mpm, int64_t begin, int64_t end) {
  const mpsi_columns *p = &mpm->p;
  const bool done = mpsi_pore_responds(mpm->water);
  const double *n = p->n, *u = p->u, *former = mpm->water->former, *V = p->V;
  const double most = 0.25 * mpm->water->def.bulk;
  int good = 1;
  if (done)
    for (int64_t k = begin; k < end; k++)
      good &= (n[k] >= 0.1) & (n[k] <= 0.9) & (fabs(u[k]) <= most);
  else /* grains, of the volume before the step, in the volume after it */
    for (int64_t k = begin; k < end; k++) {
      const double grains = (1.0 - n[k]) * former[k];
      good &= (grains >= 0.1 * V[k]) & (grains <= 0.9 * V[k]) & (fabs(u[k]) <= most);
    }
  return good != 0;
}

static void find_impossible(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_cell_block *cells = &mpm->grid.cells[b];
  const bool slow = mpm->def.step_from == MPS_MPM_STEP_FROM_SPEED &&
                    cells->speed * mpm->run.dt <= mpm->grid.cell; /* c + |v| of all of them */
  cells->tight = !are_far_inside(mpm, cells->begin, cells->end);
  if ((cells->bad >= 0 && !cells->lost) || (slow && !cells->tight)) return;
  for (int64_t k = cells->begin; k < cells->end; k++)
    if (!is_possible(mpm, k)) {
      cells->bad = k;
      cells->lost = false;
      return;
    }
}

void mpsi_pore_check_step(mps_mpm *mpm) {
  if (mpm->water) mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, find_impossible, mpm);
}

bool mpsi_pore_describe(const mps_mpm *mpm, int64_t k, char *out, size_t size) {
  if (!mpm->water || !isfinite(mpm->p.V[k]) || !isfinite(speed_of(mpm, k))) return false;
  const double n = porosity_of(mpm, k), p = mpm->p.u[k], way = speed_of(mpm, k) * mpm->run.dt;
  if (!(n > 0.0 && n < 1.0))
    (void)snprintf(out, size, "has the porosity %.4g, must be in (0, 1)", n);
  else if (!(fabs(p) <= mpm->water->def.bulk))
    (void)snprintf(out, size, "has the pore pressure %.4g Pa, beyond K_w = %.4g Pa", p,
                   mpm->water->def.bulk);
  else if (way > mpm->grid.cell)
    (void)snprintf(out, size, "moves %.3g cells in the step, must be at most 1",
                   way * mpm->grid.inverse);
  else
    return false;
  return true;
}
