/* outflow.c - particles that leave the set at the end of a step: those that have passed an open
 * side of the domain (what bodies take away before a step: contact/removal.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/particles/particles.h"

#include <string.h>

mps_status mpsi_mpm_prepare_outflow(mps_mpm *mpm, const char *function) {
  mpsi_boundaries *b = &mpm->boundaries;
  b->open = 0;
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (b->hold[k].kind == MPS_BOUNDARY_OPEN) b->open |= 1u << k;
  const bool any = b->open != 0 || mpsi_mpm_some_take_away(&mpm->contact);
  if (!any || mpsi_room_ensure(mpm->context, &mpm->rooms.gone, mpm->p.count, 1)) return MPS_OK;
  return mpsi_fail_memory(mpm->context, function, (size_t)mpm->p.count);
}

/* The open side that the particle has passed, or -1. */
static int32_t passed(const mps_mpm *mpm, int64_t k) {
  for (int c = 0; c < mpm->grid.dim; c++) {
    const double X = mpsi_grid_at(&mpm->grid, c, mpm->p.x[c][k]);
    if (mpm->boundaries.open >> (2 * c) & 1 && X < (double)mpm->grid.low[c]) return 2 * c;
    if (mpm->boundaries.open >> (2 * c + 1) & 1 && X > (double)mpm->grid.high[c]) return 2 * c + 1;
  }
  return -1;
}

/* The momentum of a removed particle is subtracted from the total, as by an impulse. */
static void carry_out(mps_mpm *mpm, int64_t k, mpsi_boundary *hold) {
  const mpsi_columns *p = &mpm->p;
  const double m = p->m[k], h = mpm->grid.cell;
  const double second = mpm->grid.standard ? 0.0 : h * h / (mpm->grid.spline == 3 ? 3.0 : 4.0);
  double x[3] = {0.0}, v[3] = {0.0}, L[3][3] = {{0.0}}, kinetic = 0.0;
  double impulse[3], moment[3];
  for (int c = 0; c < mpm->grid.dim; c++) {
    x[c] = p->x[c][k], v[c] = p->v[c][k];
    for (int d = 0; d < mpm->grid.dim; d++) L[c][d] = p->L[mpm->grid.dim * c + d][k];
  }
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    const double spin = m * (x[a] * v[b] - x[b] * v[a] + second * (L[b][a] - L[a][b]));
    impulse[c] = -m * v[c];
    moment[c] = -spin;
    kinetic += 0.5 * m * v[c] * v[c];
  }
  mpsi_mpm_boundary_add_impulse(hold, impulse, moment, -kinetic, 1);
  mpsi_mpm_energy_add_at_once(mpm, MPSI_ENERGY_BOUNDARIES, -kinetic);
  mpsi_mpm_energy_add_at_once(mpm, MPSI_ENERGY_KINETIC, -kinetic);
}

static int64_t through_sides(mps_mpm *mpm, uint8_t *gone) {
  int64_t count = 0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[b];
    for (int64_t k = cells->begin; k < cells->end && cells->gone; k++) {
      const int32_t side = passed(mpm, k);
      if (side < 0) continue;
      mpsi_boundary *hold = &mpm->boundaries.hold[side];
      carry_out(mpm, k, hold);
      hold->removed++;
      mpsi_exact_add(&hold->sums->all[MPSI_BOUNDARY_MASS], mpm->p.m[k]);
      gone[k] = 1;
      count++;
    }
  }
  return count;
}

void mpsi_mpm_remove_leaving(mps_mpm *mpm) {
  bool any = false;
  for (int64_t b = 0; b < mpm->grid.cell_count && mpm->boundaries.open && !any; b++)
    any = mpm->grid.cells[b].gone;
  if (!any) return;
  if (mpm->p.count > 0) memset(mpm->rooms.gone.item, 0, (size_t)mpm->p.count);
  if (through_sides(mpm, mpm->rooms.gone.item) > 0)
    mpsi_particles_take_out(mpm->p.set, mpm->rooms.gone.item);
}
