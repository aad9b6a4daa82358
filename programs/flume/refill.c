/* refill.c - water that has passed the crest returns to the flume, so that the mean level of a long
 * storm stays. A particle of it is laid on the surface near the maker, in the lowest of some
 * places, with the velocity of the water below it: within incompressible water there is no room for
 * one. The rate is what is missing before the rear edge of the crest over FLUME_REFILL_PERIODS
 * periods, slow against the waves; what is missing follows from the particles themselves, so that
 * the books close to the particle: water at the start + returned = in the flume + passed.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>

#define PLACES 8  /* that are compared */
#define CLEAR 4.0 /* spacings from the maker, and from gauges where the flume has room */
#define STEEP 1.5 /* spacings between a place and the level: more is spray or a breaker */
#define GOLDEN 0.6180339887498949 /* of the places: even in every part of their order */

/* Particles before the rear edge of the crest. */
int64_t flume_count_water(const flume *m) {
  mps_view x;
  int64_t count = 0;
  if (mps_particles_view(m->water, "position", &x) != MPS_OK) return 0;
  for (int64_t i = 0; i < x.shape[0]; i++) count += *mps_view_f64(&x, i, 0) <= m->heel[0];
  return count;
}

/* Where a disc of the diameter l0 that is lowered at x comes to rest on the particles; *below: the
 * one that bears it, -1: none. */
static double rest_height(const flume *m, const mps_view *position, double x, int64_t *below) {
  const double l0 = m->s.spacing;
  double highest = -INFINITY;
  *below = -1;
  for (int64_t i = 0; i < position->shape[0]; i++) {
    const double dx = *mps_view_f64(position, i, 0) - x;
    if (fabs(dx) >= l0) continue;
    const double y = *mps_view_f64(position, i, 1) + sqrt(l0 * l0 - dx * dx);
    if (y > highest) highest = y, *below = i;
  }
  return highest;
}

static bool near_gauge(const flume *m, double x) {
  for (int g = 0; g < m->gauges; g++)
    if (fabs(m->s.gauge[g] - x) < CLEAR * m->s.spacing) return true;
  return false;
}

/* The place that lies lowest against the level there, in half a wave length before the maker, or
 * half of the flume. False: the surface is too steep at all of them. */
static bool find_place(const flume *m, double *place, int64_t *below, mps_status *status) {
  const double l0 = m->s.spacing;
  const double low = flume_maker_place(m) + CLEAR * l0;
  const double high = low + 0.5 * fmin(m->wave_length, m->toe - low);
  double least = STEEP * l0;
  mps_view position;
  *below = -1;
  *status = mps_particles_view(m->water, "position", &position);
  for (int pass = 0; pass < 2 && *below < 0; pass++)
    for (int k = 0; k < PLACES && *status == MPS_OK; k++) {
      const double at = GOLDEN * (double)(m->returned * PLACES + k);
      const double x = low + (high - low) * (at - floor(at));
      double level;
      int64_t bears;
      if ((pass == 0) == near_gauge(m, x)) continue;
      *status = mps_fluid_get_levels(m->fluid, 1, &x, &level);
      const double y = rest_height(m, &position, x, &bears);
      const double above = y - level;
      if (*status != MPS_OK || bears < 0 || !(above > -STEEP * l0 && above < least)) continue;
      least = above;
      place[0] = x, place[1] = y, *below = bears;
    }
  return *below >= 0;
}

/* With the velocity of the particle that bears it. */
static mps_status add_particle(flume *m, const double *place, int64_t below) {
  mps_view velocity;
  mps_edit edit;
  double u[2];
  mps_status status = mps_particles_view(m->water, "velocity", &velocity);
  if (status != MPS_OK) return status;
  for (int c = 0; c < 2; c++) u[c] = *mps_view_f64(&velocity, below, c);
  status = mps_particles_append(m->water, 1, place);
  if (status == MPS_OK) status = mps_particles_edit(m->water, "velocity", &edit);
  if (status != MPS_OK) return status;
  const int64_t last = mps_particles_count(m->water) - 1;
  for (int c = 0; c < 2; c++) *mps_edit_f64(&edit, last, c) = u[c];
  return mps_particles_commit(m->water, &edit);
}

mps_status flume_refill(flume *m, double dt) {
  double place[2];
  int64_t below;
  mps_status status = MPS_OK;
  if (!flume_is_open(m) || m->s.leaves) return MPS_OK;
  const int64_t missing = m->filled - flume_count_water(m);
  m->due = missing > 0
               ? fmin(m->due + (double)missing * dt / (FLUME_REFILL_PERIODS * m->s.period), 1.0)
               : 0.0;
  if (m->due < 1.0 || !find_place(m, place, &below, &status)) return status;
  status = add_particle(m, place, below);
  if (status == MPS_OK) m->due = 0.0, m->returned++;
  return status;
}
