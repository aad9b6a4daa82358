/* waves.c - see waves.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "waves.h"

#include "ranks.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

/* ---- tank ------------------------------------------------------------------------------------ */

mps_status waves_move_piston(void *user, double t, double motion[3]) {
  const waves_piston *p = user;
  const double w = 2.0 * WAVES_PI / p->period, ramp = p->ramp;
  const double s = t <= 0.0 ? 0.0 : ramp > 0.0 && t < ramp ? t / ramp : 1.0;
  const bool rising = t > 0.0 && s < 1.0;
  const double rise = s * s * (3.0 - 2.0 * s), rate = rising ? 6.0 * s * (1.0 - s) / ramp : 0.0;
  const double bend = rising ? (6.0 - 12.0 * s) / (ramp * ramp) : 0.0;
  motion[0] = p->amplitude * rise * sin(w * t);
  motion[1] = p->amplitude * (rate * sin(w * t) + rise * w * cos(w * t));
  motion[2] =
      p->amplitude * (bend * sin(w * t) + 2.0 * rate * w * cos(w * t) - rise * w * w * sin(w * t));
  return MPS_OK;
}

mps_status waves_fill(mps_context *context, double length, double depth, double spacing,
                      mps_particles **out) {
  mps_particles_def def = mps_particles_defaults();
  const double lo[] = {0.0, 0.0}, hi[] = {length, depth};
  def.spacing = spacing;
  const mps_status status = mps_particles_create(context, &def, out);
  return status == MPS_OK ? mps_particles_fill_box(*out, lo, hi, NULL) : status;
}

double waves_noise(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

mps_status waves_disturb(mps_particles *water, double by, uint64_t seed) {
  uint64_t state = seed;
  mps_edit x;
  mps_status status = mps_particles_edit(water, "position", &x);
  if (status != MPS_OK) return status;
  for (int64_t i = 0; i < x.view.shape[0]; i++)
    for (int c = 0; c < 2; c++) *mps_edit_f64(&x, i, c) += by * waves_noise(&state);
  return mps_particles_commit(water, &x);
}

mps_status waves_add_wall(mps_fluid *fluid, const double *point, double nx, double ny,
                          mps_signal *signal, int32_t *number) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[0] = point[0], def.point[1] = point[1];
  def.normal[0] = nx, def.normal[1] = ny;
  def.signal = signal;
  return mps_fluid_add_boundary(fluid, &def, number);
}

/* ---- theory ---------------------------------------------------------------------------------- */

double waves_number(double period, double depth) {
  const double w2 = 4.0 * WAVES_PI * WAVES_PI / (period * period);
  double k = w2 / WAVES_G / sqrt(tanh(w2 * depth / WAVES_G)); /* close for all depths */
  for (int n = 0; n < 50; n++) {
    const double t = tanh(k * depth);
    k -= (WAVES_G * k * t - w2) / (WAVES_G * (t + k * depth * (1.0 - t * t)));
  }
  return k;
}

double waves_havelock(double k, double depth) {
  const double a = 2.0 * k * depth;
  return 2.0 * (cosh(a) - 1.0) / (sinh(a) + a);
}

bool waves_check(app *a, double period, double depth, double amplitude, double spacing,
                 double length) {
  const double k = waves_number(period, depth), most = 0.142 * 2.0 * WAVES_PI / k * tanh(k * depth);
  const double height = 2.0 * fabs(amplitude) * waves_havelock(k, depth);
  if (amplitude != 0.0 && 2.0 * WAVES_PI / k < 2.0 * spacing)
    return app_error(
        a, "--period is %g s: its waves, %.2g m long, are shorter than 2 spacings of %g m", period,
        2.0 * WAVES_PI / k, spacing);
  if (height > 0.0 && height < 2.0 * spacing)
    app_warn(a,
             "the piston's waves, %.2g m high, are lower than 2 spacings of %g m: they will lose "
             "height",
             height, spacing);
  if (!(fabs(amplitude) < length))
    return app_error(a, "--amplitude is %g m, must be below the length of the tank, %g m",
                     amplitude, length);
  if (height > most)
    return app_error(
        a,
        "--amplitude %g m: waves of %.3g m would be above the breaking height %.3g m of "
        "a period of %g s in a depth of %g m",
        amplitude, height, most, period, depth);
  if (height > 0.8 * most)
    app_warn(a, "the piston's waves, %.2g m high, are more than .8 of those that break, %.2g m",
             height, most);
  return true;
}

void waves_warn_of_step(app *a, double omega, double dt) {
  if (omega * dt > 0.3)
    app_warn(a,
             "a step of %.3g s is too long for a structure that swings with %.4g rad/s in the "
             "water: %.2g s, .3/omega, or less follow it",
             dt, omega, 0.3 / omega);
}

double waves_sainflou_rise(double k, double depth, double H) { /* pi H^2 coth(kd)/L */
  return 0.5 * k * H * H / tanh(k * depth);
}

double waves_sainflou_bed(double k, double depth, double H) {
  return WAVES_DENSITY * WAVES_G * H / cosh(k * depth);
}

double waves_sainflou(double k, double depth, double H, int sign) {
  const double top = depth + sign * H + waves_sainflou_rise(k, depth, H);
  return 0.5 * top * (WAVES_DENSITY * WAVES_G * depth + sign * waves_sainflou_bed(k, depth, H));
}

/* H + rise(H) = level: the positive root. */
double waves_sainflou_height(double k, double depth, double level) {
  const double a = 0.5 * k / tanh(k * depth);
  return 2.0 * level / (1.0 + sqrt(1.0 + 4.0 * a * level));
}

double waves_sloshing_period(double length, double depth) {
  const double k = WAVES_PI / length;
  return 2.0 * WAVES_PI / sqrt(WAVES_G * k * tanh(k * depth));
}

/* ---- the pressure ---------------------------------------------------------------------------- */

bool waves_choose_solver(app *a, int choice, mps_fluid *fluid, char *why, size_t size) {
  /* choices after the first are those of mps_petsc_method */
  return choice == 0 || ranks_solve(mps_fluid_solver(fluid), MPS_LINEAR_EQUATION_PRESSURE,
                                    choice - 1, &a->equations, why, size);
}
