/* absorber.c - a piston that absorbs: u = u_asked + s (eta_asked - eta), after Schaeffer and
 * Klopman (2000), with the level at its face.
 *
 * SHALLOW: s = (g/d)^1/2. TUNED: s = omega/c0 at one period, and eta less C X, the level of the
 * evanescent modes of the correction X. C X alone is positive feedback of slow motions, dX/dt = s C
 * X where the level stays, as between two pistons that move together: X goes through a high-pass of
 * the rate f, X_h' = X' - f X_h, which is stable for f > s C, and what that turns at omega is
 * turned back,
 *
 *   X -> (1 + f^2/omega^2) X_h - f/omega^2 X'.
 *
 * The correction's displacement leaks at the rate `leak`: the mean level at the face would else
 * move the piston off. By linear theory the piston reflects, of waves of w,
 *
 *   R = |i w + leak - i s c0 + s C'|/|i w + leak + i s c0 + s C'|,
 *   C' = C(w) - C ((1 + f^2/omega^2) i w/(i w + f) - f/omega^2 i w),
 *
 * C(w) and c0(w) the transfers of a piston (dispersion.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/definition/digits.h"
#include "dispersion.h"
#include "waves_private.h"

struct mps_absorber {
  mps_context *context;
  mps_absorber_def def;          /* with its defaults computed */
  double gain, omega;            /* s, 1/s; of the period, rad/s */
  double near;                   /* C that is subtracted */
  double displacement, velocity; /* m, m/s */
  double correction, pass;       /* m: of the displacement; high-passed */
  int64_t limited;
};

static mps_status check_def(mps_context *context, const mps_absorber_def *d) {
  static const char function[] = "mps_absorber_create";
  const mps_waves *w = d->waves;
  if (!w) return MPS_OK;
  if (d->depth != w->def.depth || d->gravity != w->def.gravity)
    return mpsi_fail(
        context, function, MPS_ERROR_ARGUMENT, "%s is %g %s, must be that of waves, %g",
        d->depth != w->def.depth ? "depth" : "gravity",
        d->depth != w->def.depth ? d->depth : d->gravity, d->depth != w->def.depth ? "m" : "m/s2",
        d->depth != w->def.depth ? w->def.depth : w->def.gravity);
  return MPS_OK;
}

/* The rates that are not given, and the gain. */
static mps_status complete(mps_absorber *a) {
  mps_absorber_def *d = &a->def;
  const double omega = 2.0 * MPSI_WAVES_PI / d->period;
  if (isnan(d->leak)) d->leak = 0.02 / d->period;
  if (isnan(d->stroke)) d->stroke = d->depth;
  if (isnan(d->acceleration)) d->acceleration = 2.0 * d->gravity;
  a->omega = omega;
  a->gain = sqrt(d->gravity / d->depth);
  a->near = 0.0;
  if (d->form == MPS_ABSORBER_FORM_SHALLOW) return MPS_OK;
  const double y = omega * omega * d->depth / d->gravity;
  a->gain = omega / mpsi_waves_far(mpsi_waves_depths(y));
  a->near = mpsi_waves_near(y);
  const double least = a->gain * a->near;
  if (isnan(d->high_pass)) d->high_pass = fmax(0.15 * omega, 2.0 * least);
  if (d->high_pass > least) return MPS_OK;
  return mpsi_fail(a->context, "mps_absorber_create", MPS_ERROR_ARGUMENT,
                   "high_pass is %s rad/s, must be above %g: the piston would run away",
                   mpsi_outside(d->high_pass, least, INFINITY).text, least);
}

mps_status mps_absorber_create(mps_context *context, const mps_absorber_def *user_def,
                               mps_absorber **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!user_def || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL", user_def ? "out" : "def");
  *out = NULL;
  mps_absorber_def def;
  mps_status status = MPSI_DEF_READ(context, __func__, mps_absorber_def, user_def, &def);
  if (status == MPS_OK) status = check_def(context, &def);
  if (status == MPS_OK && isnan(def.period)) def.period = def.waves->period;
  if (status == MPS_OK)
    status = mpsi_waves_check_range(context, __func__, def.period, def.depth, def.gravity);
  if (status != MPS_OK) return status;
  mps_absorber *a = mpsi_alloc(context, 1, sizeof *a);
  if (!a) return mpsi_fail_memory(context, __func__, sizeof *a);
  a->context = mpsi_context_retain(context);
  a->def = def;
  if (def.waves) a->def.waves = mpsi_waves_retain(def.waves);
  status = complete(a);
  *out = a;
  if (status != MPS_OK) mps_absorber_destroy(out);
  return status;
}

void mps_absorber_destroy(mps_absorber **absorber) {
  if (!absorber || !*absorber) return;
  mps_absorber *a = *absorber;
  *absorber = NULL;
  mps_context *context = a->context;
  mps_waves_destroy(&a->def.waves);
  mpsi_free(context, a);
  mpsi_context_release(context);
}

/* ---- a step ---------------------------------------------------------------------------------- */

static double within(double value, double low, double high) {
  return value < low ? low : value > high ? high : value;
}

/* The velocity of the correction at the end of the step; the part of X' on the right is taken
 * there. */
static double correct(mps_absorber *a, double asked, double level, double moved, double dt) {
  const double drift = a->def.leak * a->correction;
  if (a->near == 0.0) return a->gain * (asked - level) - drift;
  const double f = a->def.high_pass, w2 = a->omega * a->omega;
  a->pass = (a->pass + moved) / (1.0 + dt * f);
  const double near = a->near * (1.0 + f * f / w2) * a->pass;
  return (a->gain * (asked - level + near) - drift) / (1.0 + a->gain * a->near * f / w2);
}

mps_status mps_absorber_advance(mps_absorber *a, double t, double dt, double level,
                                double *displacement, double *velocity) {
  if (!a) return mpsi_null(__func__, "absorber");
  if (!displacement || !velocity)
    return mpsi_fail(a->context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     displacement ? "velocity" : "displacement");
  if (!(fabs(t) <= 1e12))
    return mpsi_fail(a->context, __func__, MPS_ERROR_ARGUMENT, "t is %s s, must be within 1e12",
                     mpsi_outside(t, -1e12, 1e12).text);
  if (!mpsi_waves_positive(dt))
    return mpsi_fail(a->context, __func__, MPS_ERROR_ARGUMENT,
                     "dt is %s s, must be in 1e-12 to 1e12", mpsi_outside(dt, 1e-12, 1e12).text);
  if (!isnan(level) && !(fabs(level) <= 1e12))
    return mpsi_fail(a->context, __func__, MPS_ERROR_ARGUMENT,
                     "level is %s m, must be within 1e12, or NaN where there is none",
                     mpsi_outside(level, -1e12, 1e12).text);
  const mps_absorber_def *d = &a->def;
  double now[4] = {0.0}, next[4] = {0.0};
  if (d->waves) mpsi_waves_move(d->waves, t, d->waves->bound, now);
  if (d->waves) mpsi_waves_move(d->waves, t + dt, NULL, next);
  const double correction = a->displacement - now[0], moved = correction - a->correction;
  a->correction = correction;
  if (isnan(level)) level = now[3];
  const double wanted = next[1] + correct(a, now[3], level, moved, dt);
  /* the reserve of stroke is used up in no less than 1/omega, and the correction has a limit */
  const double omega = a->omega, change = d->acceleration * dt;
  const double asked = a->velocity + next[1] - now[1];
  double u = within(wanted, asked - change, asked + change);
  u = within(u, -(d->stroke + a->displacement) * omega, (d->stroke - a->displacement) * omega);
  const double end = a->displacement + 0.5 * dt * (a->velocity + u);
  if (fabs(end) > d->stroke) u = 0.0;
  a->limited += u != wanted;
  *displacement = a->displacement =
      within(a->displacement + 0.5 * dt * (a->velocity + u), -d->stroke, d->stroke);
  *velocity = a->velocity = u;
  return MPS_OK;
}

/* ---- queries --------------------------------------------------------------------------------- */

mps_status mps_absorber_get_reflection(const mps_absorber *a, double period, double *reflection) {
  if (!a) return mpsi_null(__func__, "absorber");
  if (!reflection) return mpsi_fail(a->context, __func__, MPS_ERROR_ARGUMENT, "reflection is NULL");
  const double depth = a->def.depth, g = a->def.gravity;
  MPSI_TRY(mpsi_waves_check_range(a->context, __func__, period, depth, g));
  const double omega = 2.0 * MPSI_WAVES_PI / period, y = omega * omega * depth / g;
  const double far = mpsi_waves_far(mpsi_waves_depths(y));
  const double complex rate = I * omega;
  const double f = a->def.high_pass, w2 = a->omega * a->omega;
  const double complex known =
      a->near == 0.0 ? 0.0 : (1.0 + f * f / w2) * rate / (rate + f) - f / w2 * rate;
  const double complex near = mpsi_waves_near(y) - a->near * known;
  const double complex base = rate + a->def.leak + a->gain * near, wave = I * a->gain * far;
  *reflection = cabs(base - wave) / cabs(base + wave);
  return MPS_OK;
}

mps_status mps_absorber_get_report_sized(const mps_absorber *a, mps_absorber_report *out,
                                         size_t size) {
  if (!a) return mpsi_null(__func__, "absorber");
  const mps_absorber_report report = {a->displacement, a->velocity, a->correction, a->limited};
  return mpsi_out_write(a->context, __func__, out, size, &report, sizeof report);
}

mps_status mps_absorber_get_memory(const mps_absorber *a, double *values) {
  if (!a) return mpsi_null(__func__, "absorber");
  if (!values) return mpsi_fail(a->context, __func__, MPS_ERROR_ARGUMENT, "values is NULL");
  const double all[MPS_ABSORBER_MEMORY] = {a->displacement, a->velocity, a->correction, a->pass,
                                           (double)a->limited};
  for (int k = 0; k < MPS_ABSORBER_MEMORY; k++) values[k] = all[k];
  return MPS_OK;
}

mps_status mps_absorber_set_memory(mps_absorber *a, const double *values) {
  if (!a) return mpsi_null(__func__, "absorber");
  if (!values) return mpsi_fail(a->context, __func__, MPS_ERROR_ARGUMENT, "values is NULL");
  for (int k = 0; k < MPS_ABSORBER_MEMORY; k++)
    if (!(fabs(values[k]) <= 1e15))
      return mpsi_fail(a->context, __func__, MPS_ERROR_FORMAT,
                       "values[%d] is %g: no state of an absorber", k, values[k]);
  if (fabs(values[0]) > a->def.stroke || values[4] < 0.0 || values[4] != floor(values[4]))
    return mpsi_fail(a->context, __func__, MPS_ERROR_FORMAT,
                     "values are of another absorber: displacement %g m with a stroke of %g m, %g "
                     "limited steps",
                     values[0], a->def.stroke, values[4]);
  a->displacement = values[0], a->velocity = values[1], a->correction = values[2];
  a->pass = values[3];
  a->limited = (int64_t)values[4];
  return MPS_OK;
}
