/* outflow.c - particles that leave the set at the end of a step: those that have passed an open
 * side of the domain (removal by bodies, before a step: contact/removal.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "mpm/base/energy.h"
#include "mpm/particles/rooms.h"
#include "kinds.h"

#include <string.h>

mps_status mpsi_mpm_prepare_outflow(mps_context *context, const mpsi_columns *p, mpsi_boundaries *b,
                                    mpsi_rooms *rooms, bool bodies, const char *function) {
  b->open = 0;
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (mpsi_kind_of(&b->boundary[k])->open) b->open |= 1u << k;
  const bool any = b->open != 0 || bodies;
  if (!any || mpsi_room_ensure(context, &rooms->gone, p->count, 1)) return MPS_OK;
  return mpsi_fail_memory(context, function, (size_t)p->count);
}

/* The open side that the particle has passed, or -1. */
static int32_t passed(const mpsi_grid *grid, const mpsi_columns *p,
                      const mpsi_boundaries *boundaries, int64_t k) {
  for (int c = 0; c < grid->dim; c++) {
    const double X = mpsi_grid_at(grid, c, p->x[c][k]);
    if (mpsi_mpm_passes(grid, boundaries, c, X)) return 2 * c + (X > (double)grid->high[c]);
  }
  return -1;
}

/* Subtracts the momentum of a removed particle from the total, as an impulse of the side. */
static void subtract_particle(const mpsi_grid *grid, const mpsi_columns *p, mpsi_energy *energy,
                              int64_t k, mpsi_boundary *boundary) {
  const double m = p->m[k], h = grid->cell;
  const double second = grid->standard ? 0.0 : h * h / (grid->spline == 3 ? 3.0 : 4.0);
  double x[3] = {0.0}, v[3] = {0.0}, L[3][3] = {{0.0}}, kinetic = 0.0;
  double impulse[3], moment[3];
  for (int c = 0; c < grid->dim; c++) {
    x[c] = p->x[c][k], v[c] = p->v[c][k];
    for (int d = 0; d < grid->dim; d++) L[c][d] = p->L[grid->dim * c + d][k];
  }
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    const double spin = m * (x[a] * v[b] - x[b] * v[a] + second * (L[b][a] - L[a][b]));
    impulse[c] = -m * v[c];
    moment[c] = -spin;
    kinetic += 0.5 * m * v[c] * v[c];
  }
  mpsi_mpm_boundary_add_impulse(boundary, impulse, moment, -kinetic, 1);
  mpsi_mpm_energy_add_at_once(energy, MPSI_ENERGY_BOUNDARIES, -kinetic);
  mpsi_mpm_energy_add_at_once(energy, MPSI_ENERGY_KINETIC, -kinetic);
}

static int64_t through_sides(const mpsi_grid *grid, const mpsi_columns *p,
                             const mpsi_boundaries *boundaries, mpsi_energy *energy,
                             uint8_t *gone) {
  int64_t count = 0;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    for (int64_t k = cells->begin; k < cells->end && cells->gone; k++) {
      const int32_t side = passed(grid, p, boundaries, k);
      if (side < 0) continue;
      mpsi_boundary *boundary = &boundaries->boundary[side];
      subtract_particle(grid, p, energy, k, boundary);
      boundary->removed++;
      mpsi_exact_add(&boundary->sums->all[MPSI_BOUNDARY_MASS], p->m[k]);
      gone[k] = 1;
      count++;
    }
  }
  return count;
}

void mpsi_mpm_remove_leaving(const mpsi_grid *grid, const mpsi_columns *p,
                             const mpsi_boundaries *boundaries, mpsi_energy *energy,
                             const mpsi_rooms *rooms) {
  bool any = false;
  for (int64_t b = 0; b < grid->cell_count && boundaries->open && !any; b++)
    any = grid->cells[b].gone;
  if (!any) return;
  if (p->count > 0) memset(rooms->gone.item, 0, (size_t)p->count);
  if (through_sides(grid, p, boundaries, energy, rooms->gone.item) > 0)
    mpsi_particles_take_out(p->set, rooms->gone.item);
}
