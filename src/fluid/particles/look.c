/* look.c - the particles at the start of a step: copies of their fields, their order in memory,
 * neighbours, and the sums over these. SPDX-License-Identifier: BSD-3-Clause */
#include "look.h"
#include "fluid/base/access.h"
#include "fluid/boundary/sight.h"
#include "fluid/boundary/walls.h"
#include "fluid/particles/pores.h"
#include "fluid/ranks/partition.h"

#include <string.h>

static double *column(const mps_fluid *f, const char *name, int32_t component) {
  return mpsi_particles_column(f->particles, name, component);
}

static void load_part(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const size_t bytes = (size_t)(end - begin) * sizeof(double);
  for (int c = 0; c < 2; c++) {
    memcpy(f->x[c] + begin, column(f, "position", c) + begin, bytes);
    memcpy(f->u[c] + begin, column(f, "velocity", c) + begin, bytes);
  }
  memcpy(f->q + begin, column(f, "reduced_pressure", 0) + begin, bytes);
}

/* Copies of positions, velocities and the last reduced pressure. */
void mpsi_fluid_load_cloud(mps_fluid *f) {
  mpsi_fluid_for_all(f, f->count, MPSI_FLUID_COPIED, load_part);
  f->driven = false;
  mpsi_fluid_deal(f);
}

mps_status mpsi_fluid_look_around(mps_fluid *f, const char *function, mps_status status) {
  if (status == MPS_OK) status = mpsi_fluid_make_ghosts(f, function);
  if (status == MPS_OK) mpsi_fluid_move_ghosts(f);
  status = mpsi_fluid_agree_same(f, function, status);
  if (status == MPS_OK) status = mpsi_fluid_find_neighbours(f, function);
  if (status == MPS_OK) status = mpsi_fluid_find_halo(f, function);
  if (status == MPS_OK) mpsi_fluid_find_moments(f);
  if (status == MPS_OK) status = mpsi_fluid_lost(f, function);
  f->stale = status != MPS_OK;
  return status;
}

mps_status mpsi_fluid_look(mps_fluid *f, const char *function) {
  mpsi_fluid_load_cloud(f);
  mps_status status = mpsi_fluid_find_loads(f, function, f->load_time);
  if (status == MPS_OK) status = mpsi_fluid_find_pores(f, function, 0.0);
  return mpsi_fluid_look_around(f, function, status);
}

/* After a step the fields of the surface are written; otherwise they are computed now. In an open
 * step the cloud has the fields' particles and neighbours. */
static mps_status find_surface(mps_fluid *f, const char *function) {
  if (!f->unknown) return MPS_OK;
  f->report_before_look = f->report;
  mps_status status = mpsi_fluid_agree(f, function, MPS_OK);
  if (status == MPS_OK && f->stage == MPSI_FLUID_BETWEEN) status = mpsi_fluid_look(f, function);
  if (status == MPS_OK) mpsi_fluid_send_local(f);
  if (status == MPS_OK) status = mpsi_fluid_lost(f, function);
  return status;
}

mps_status mpsi_fluid_show_surface(mps_fluid *f, mps_status status) {
  if (!f->unknown) return status;
  if (status != MPS_OK) { /* computed again by the next query */
    f->report = f->report_before_look;
    return status;
  }
  int64_t *surface = mpsi_particles_integers(f->particles, "free_surface");
  double *rise = column(f, "surface_rise", 0);
  for (int64_t i = 0; i < f->count; i++) surface[i] = f->state[i], rise[i] = mpsi_fluid_rise(f, i);
  f->unknown = 0;
  return status;
}

mps_status mpsi_fluid_ensure_surface(mps_fluid *f, const char *function) {
  return f->unknown ? mpsi_fluid_show_surface(f, find_surface(f, function)) : MPS_OK;
}

/* Loads are evaluated at the last step's time, for the particles' present positions. */
mps_status mpsi_fluid_refresh(mps_fluid *f, const char *function) {
  const mps_status status = find_surface(f, function);
  if (status != MPS_OK || f->stage != MPSI_FLUID_BETWEEN) return status;
  if (f->stale) { /* the surface is known */
    const int64_t *surface = mpsi_particles_integers(f->particles, "free_surface");
    mpsi_fluid_load_cloud(f);
    for (int64_t i = 0; i < f->count; i++) f->state[i] = (uint8_t)surface[i];
    f->ghosts = 0, f->travel = INFINITY; /* images are not read */
    f->stale = false;
  }
  mpsi_fluid_find_limits(f);
  return mpsi_fluid_find_loads(f, function, f->load_time);
}

/* Sorts the set by columns of cells half of re wide, so that neighbours lie near each other in
 * memory. It only serves speed: where the fluid is scattered or memory is short the order stays. */
mps_status mpsi_fluid_sort(mps_fluid *f, const char *function) {
  const double *x = column(f, "position", 0), *y = column(f, "position", 1);
  const int64_t n = f->count;
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int64_t i = 0; i < n; i++) {
    low[0] = fmin(low[0], x[i]), high[0] = fmax(high[0], x[i]);
    low[1] = fmin(low[1], y[i]), high[1] = fmax(high[1], y[i]);
  }
  const double inverse = 2.0 * f->weight.inverse, rows = floor((high[1] - low[1]) * inverse) + 1.0;
  const double cells = (floor((high[0] - low[0]) * inverse) + 1.0) * rows;
  if (!(cells < 4.0 * (double)n + 4096.0)) return MPS_OK;
  const int64_t number = (int64_t)cells;
  double none =
      !mpsi_room_fit(f->context, &f->lower_col_room, 2 * (number + 1 + n), sizeof(uint16_t));
  const mps_status lost = mpsi_fluid_agree_max(f, function, MPS_OK, 1, &none); /* all or none */
  if (lost != MPS_OK || none > 0.0) return lost;
  int32_t *first = f->lower_col_room.item, *cell = first + number + 1;
  int64_t *order = (int64_t *)f->system.r; /* free between steps, as z is */
  memset(first, 0, (size_t)(number + 1) * sizeof *first);
  for (int64_t i = 0; i < n; i++) {
    cell[i] = (int32_t)((int64_t)((x[i] - low[0]) * inverse) * (int64_t)rows +
                        (int64_t)((y[i] - low[1]) * inverse));
    first[cell[i] + 1]++;
  }
  for (int64_t k = 0; k < number; k++) first[k + 1] += first[k];
  bool sorted = true;
  for (int64_t i = 0; i < n; i++) {
    sorted = sorted && first[cell[i]] == i;
    order[first[cell[i]]++] = i;
  }
  void *const scratch = f->system.z;
  if (sorted) return MPS_OK;
  return mpsi_fluid_agree(f, function,
                          mpsi_particles_permute_in(f->particles, function, order, &scratch, 1));
}
