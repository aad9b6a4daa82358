/* bound.c - see bound.h. With the potential energy P, the works W of walls and loads that the
 * budget counts, and G what the caller's edits have put in,
 *
 *   T <= F (T0 + P0 - P + W + G) + m g H/2 + tiny
 *
 * where H is the height of the water. Without errors of the scheme the bracket is T and what has
 * been dissipated. F = 4: shifted particles and collisions gain some energy in breakers. m g H/2:
 * water at rest has no other energy, and its particles rise by parts of a spacing; a mean speed of
 * sqrt(g H) is that of a long wave. tiny: 1e-20 m (l0/dt)^2, round-off.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "bound.h"

#include "core/particles/particles_internal.h"
#include "fluid/base/access.h"
#include "fluid/particles/loads.h"

#define FACTOR 4.0
#define TINY 1e-20

void mpsi_fluid_begin_bound(mps_fluid *f) {
  double kinetic;
  if (!f->renewed) return;
  f->renewed = false;
  f->given_energy =
      fmax(mpsi_fluid_energy(f, &kinetic) - f->energy - f->work_boundaries - f->work_loads, 0.0);
}

static double work_of_walls(const mps_fluid *f) {
  double work = 0.0;
  for (int b = 0; b < f->walls; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    if (w->used || w->line) work += w->load.power * f->dt + w->struck.work;
  }
  return work;
}

static mps_status report(mps_fluid *f, const char *function, int64_t i, double kinetic,
                         double most) {
  const long long id = (long long)mpsi_particles_integers(f->particles, "id")[i];
  const mps_status status = mpsi_fail(
      f->context, function, MPS_ERROR_DIVERGED,
      "step %lld, t = %g s: the kinetic energy is %.4g J, beyond %.4g J, %g times what gravity, "
      "walls and loads have given; particle %lld at (%g, %g) m is the fastest with (%g, %g) m/s; "
      "dt was %g s; the step was not made",
      (long long)f->steps, f->time, kinetic, most, FACTOR, id, f->x[0][i], f->x[1][i], f->u[0][i],
      f->u[1][i], f->dt);
  mpsi_fail_where(f->context, f->steps, id);
  return status;
}

mps_status mpsi_fluid_check_bound(mps_fluid *f, const char *function) {
  const double volume = f->l0 * f->l0 * f->def.measure, mass = f->def.density * volume;
  double square = 0.0, head = 0.0, low = INFINITY, high = -INFINITY, fastest = -1.0;
  int64_t at = 0;
  for (int64_t i = 0; i < f->count; i++) {
    const double u2 = f->u[0][i] * f->u[0][i] + f->u[1][i] * f->u[1][i];
    const double h = mpsi_fluid_head(f, f->x[0][i], f->x[1][i]);
    square += u2;
    head += h;
    low = h < low ? h : low;
    high = h > high ? h : high;
    if (u2 > fastest) fastest = u2, at = i;
  }
  const double kinetic = 0.5 * mass * square, potential = volume * head;
  const double had = f->energy + f->given_energy + f->work_boundaries + f->work_loads;
  const double rate = f->l0 / f->dt;
  double most = FACTOR * fmax(had + work_of_walls(f) - potential, 0.0) + TINY * mass * rate * rate;
  if (f->count > 0) most += 0.5 * volume * (double)f->count * (high - low);
  if (!(kinetic > most)) return MPS_OK;
  most += FACTOR * fmax(mpsi_fluid_work_of_loads(f), 0.0);
  return kinetic > most ? report(f, function, at, kinetic, most) : MPS_OK;
}
