/* wave.c - an earthquake wave rises through a layer of soil and is reflected at its surface, by
 * explicit MPS (Yoshida). The column repeats itself in x, and its base lets waves in and out, so
 * that d'Alembert's solution holds: the surface has twice the velocity of the incoming wave, later
 * by the travel time H/Vs, and in the end all is at rest.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/dynamics.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double width = 4.0, height = 20.0, spacing = 0.2; /* m */
static const double density = 1800.0, vs = 100.0, vp = 200.0;  /* kg/m3, m/s */
static const double frequency = 4.0, begin = 0.25;             /* Hz, s: peak of the wavelet */

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

/* One line of the results; 1 where `got` is farther from the right value than `bound`. */
static int compare(const char *what, double got, double right, double bound) {
  printf("%-44s %11.5g   right: %11.5g +- %.2g\n", what, got, right, bound);
  return !(fabs(got - right) <= bound);
}

typedef struct record {
  mps_particles *soil;
  mps_signal *quake;
  int64_t surface;                    /* id of a particle at the top */
  double peak, time, difference, sum; /* m/s, s; sums of squares */
} record;

/* After each step. A velocity is that of the middle of the step. */
static mps_status look(void *user, mps_dynamics *dynamics) {
  record *r = user;
  const double t = mps_dynamics_time(dynamics) - 0.5 * mps_dynamics_dt(dynamics);
  const double right = 2.0 * mps_signal_velocity(r->quake, t - height / vs);
  mps_view velocity;
  ok(mps_particles_view(r->soil, "velocity", &velocity));
  const double v = *mps_view_f64(&velocity, mps_particles_index(r->soil, r->surface), 0);
  if (v > r->peak) r->peak = v, r->time = t;
  r->difference += (v - right) * (v - right), r->sum += right * right;
  return MPS_OK;
}

int main(void) {
  mps_context *context = NULL;
  mps_dynamics *dynamics = NULL;
  record r = {0};
  ok(mps_context_create(NULL, &context, NULL, 0));

  const double lo[2] = {0.0, 0.0}, hi[2] = {width, height}, top[2] = {0.0, height};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = spacing;
  ok(mps_particles_create(context, &set, &r.soil));
  ok(mps_particles_fill_box(r.soil, lo, hi, NULL));
  ok(mps_particles_set(r.soil, "density", 0, density));
  ok(mps_particles_set(r.soil, "shear_velocity", 0, vs));
  ok(mps_particles_set(r.soil, "pressure_velocity", 0, vp));
  r.surface = mps_particles_nearest(r.soil, top);

  mps_dynamics_def def = mps_dynamics_defaults();
  def.period_x = width; /* level ground without end */
  ok(mps_dynamics_create(context, r.soil, &def, &dynamics));

  /* Ricker's wavelet, Yoshida (9), of 1 m/s2, comes in through dashpots at the base */
  mps_dynamics_boundary_def base = mps_dynamics_boundary_defaults();
  ok(mps_signal_create_ricker(context, frequency, begin, 1.0, &r.quake));
  base.kind = MPS_BOUNDARY_ABSORBING;
  base.upper[1] = spacing; /* the lowest row */
  base.signal[0] = r.quake;
  ok(mps_dynamics_add_boundary(dynamics, &base, NULL));

  mps_totals in, left;
  ok(mps_dynamics_run(dynamics, begin, 1, look, &r));
  ok(mps_dynamics_get_totals(dynamics, &in)); /* half of the wavelet has come in */
  ok(mps_dynamics_run(dynamics, 1.0, 1, look, &r));
  ok(mps_dynamics_get_totals(dynamics, &left));

  /* (t - tp) exp(-c (t - tp)^2) is largest at tp + 1/sqrt(2 c) or, with another sign, before tp */
  const double c = pow(acos(-1.0) * frequency, 2.0), later = 1.0 / sqrt(2.0 * c);
  const double peak = 2.0 * later * exp(-0.5);
  int wrong = compare("velocity at the surface, m/s", r.peak, peak, 0.005 * peak);
  wrong += compare("its time, s", r.time, begin - later + height / vs, 0.005);
  wrong += compare("rms difference of the motion, relative", sqrt(r.difference / r.sum), 0.0, 0.03);
  wrong += compare("kinetic energy that stays, relative", left.kinetic / in.kinetic, 0.0, 1e-3);

  /* 2/omega with the highest frequency of an infinite lattice, sqrt(24) Vs/D, where Vp < 3.6 Vs */
  const double limit = 2.0 * spacing / (sqrt(24.0) * vs);
  wrong += compare("largest stable step, s", mps_dynamics_limit(dynamics), limit, 0.01 * limit);

  mps_dynamics_destroy(&dynamics);
  mps_signal_destroy(&r.quake);
  mps_particles_destroy(&r.soil);
  mps_context_destroy(&context);
  return wrong > 0;
}
