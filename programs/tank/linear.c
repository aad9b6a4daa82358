/* linear.c - linear potential flow for the waves of a piston before a fixed wall, or one that
 * oscillates on a spring: in an infinite flume, where the wall's own waves radiate its energy, and
 * in the closed tank of the run, from the start. Displacements of both walls are into the water.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include "common/closed_tank.h"

#include <math.h>

/* ---- an infinite flume ----------------------------------------------------------------------- */

/* A wall that oscillates as a whole with V e^{iwt} sends out phi = sum A cosh(k y) e^{-i k s} + sum
 * A_n cos(k_n y) e^{-k_n s},  w^2 = g k tanh(k d) = -g k_n tan(k_n d), which press upon it with
 * -(m_a dV/dt + B V): m_a = rho sum I_n^2/(k_n N_n), B = rho w I^2/(k N), where I is the integral
 * of the shape over the depth and N that of its square. */
void tank_flume(const tank_settings *s, tank_response *r) {
  const double w = 2.0 * WAVES_PI / s->period, d = s->depth, k = waves_number(s->period, d);
  const double I = sinh(k * d) / k, N = 0.5 * (d + sinh(2.0 * k * d) / (2.0 * k));
  r->added_mass = tank_added_mass(w, INFINITY, d);
  r->damping = WAVES_DENSITY * w * I * I / (k * N);
  const double incident = s->amplitude * waves_havelock(k, d);
  const double force = 2.0 * WAVES_DENSITY * WAVES_G * incident * tanh(k * d) / k;
  const double spring = s->stiffness - (s->mass + r->added_mass) * w * w;
  r->amplitude = force / hypot(spring, r->damping * w);
  r->lag = atan2(r->damping * w, spring);
  r->ratio = w / sqrt(s->stiffness / (s->mass + r->added_mass));
}

double tank_resonant_stiffness(const tank_settings *s, double ratio) {
  const double w = 2.0 * WAVES_PI / s->period;
  return (s->mass + tank_added_mass(w, INFINITY, s->depth)) * w * w / (ratio * ratio);
}

/* ---- the closed tank ------------------------------------------------------------------------- */

mps_status tank_linear(const tank_settings *s, int64_t count, const tank_sample *sample,
                       tank_sample *out) {
  closed_tank c = {.length = s->length,
                   .depth = s->depth,
                   .mass = s->kind == TANK_RESONANCE ? s->mass : NAN,
                   .stiffness = s->stiffness,
                   .piston = {s->amplitude, s->period, s->ramp}};
  closed_tank_begin(&c);
  for (int64_t k = 0; k < count; k++) {
    const mps_status status = closed_tank_advance(&c, sample[k].t);
    if (status != MPS_OK) return status;
    out[k] = (tank_sample){.t = sample[k].t, .deflection = c.wall, .right = closed_tank_force(&c)};
    for (int g = 0; g <= TANK_GAUGES; g++)
      out[k].level[g] = closed_tank_level(&c, g == TANK_GAUGES ? s->length : s->gauge[g]);
  }
  return MPS_OK;
}
