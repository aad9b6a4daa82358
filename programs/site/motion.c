/* motion.c - the motion that shakes the ground: a record, a Ricker wavelet or cycles of a sine.
 *
 * The model moves with the input, and the particles feel the acceleration of that frame: -a(t). Of
 * a rigid base the input is the motion of the base, which rests in the frame. Of a compliant one it
 * is that of the outcrop of the half space, twice the incoming wave: the traction of the absorbing
 * base, rho c (v_outcrop - v) and that of rest, is -rho c times the velocity in the frame. So
 * particles move across cells by what the ground is strained, not by the way of the record.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include "common/record.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { LEAST_SAMPLES = 4 };

/* `cycles` of the sine between a cycle that grows and one that fades. */
static mps_status make_sine(mps_context *context, const settings *s, mps_signal **out) {
  enum { PER_CYCLE = 200, MOST = 200 * 1002 + 1 };
  static double t[MOST], a[MOST];
  const int64_t count = PER_CYCLE * (s->cycles + 2) + 1;
  for (int64_t k = 0; k < count; k++) {
    const double cycle = (double)k / PER_CYCLE;
    const double share = fmin(1.0, fmin(cycle, (double)s->cycles + 2.0 - cycle));
    t[k] = cycle / s->frequency;
    a[k] = s->amplitude * share * share * (3.0 - 2.0 * share) * sin(2.0 * PI * cycle);
  }
  return mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_ACCELERATION, count, t, a, out);
}

static mps_status make_record(app *a, const settings *s, mps_signal **out) {
  mps_context *context = a->context;
  if (strcmp(s->record, "ricker") == 0)
    return mps_signal_create_ricker(context, s->frequency, 1.5 / s->frequency, s->amplitude, out);
  if (strcmp(s->record, "sine") == 0) return make_sine(context, s, out);
  mps_signal_record_def def = mps_signal_record_defaults();
  def.baseline = s->baseline;
  def.scale = s->scale;
  def.unit = record_units[s->unit];
  def.step = s->step, def.column = s->column;
  return record_read(a, "record", s->record, &def, out);
}

double site_input(const simulation *sim, double t) {
  return t > 0.0 && t <= sim->record_end ? mps_signal_acceleration(sim->motion, t) : 0.0;
}

/* The frame's acceleration as a factor on loads, which is read at the beginning of a step:
 * nothing in the first one, from which dashpots take the traction at rest. */
static mps_status frame(void *user, double t, double motion[3]) {
  const simulation *sim = user;
  motion[0] = -site_input(sim, t - sim->start);
  return MPS_OK;
}

/* What a correction of the baseline has not taken away, and would move the ground for good. */
static void check_drift(app *a, const simulation *sim) {
  const double end = sim->record_end;
  double fastest = 0.0;
  enum { LOOKS = 2000 };
  for (int k = 0; k <= LOOKS; k++)
    fastest = fmax(fastest, fabs(mps_signal_velocity(sim->motion, end * k / LOOKS)));
  const double left = mps_signal_velocity(sim->motion, end);
  if (fabs(left) > 0.05 * fastest)
    app_warn(a,
             "%s ends with a velocity of %.3g m/s, the largest is %.3g m/s: displacements drift; "
             "--baseline corrects that",
             sim->s.record, left, fastest);
}

/* Largest |acceleration| (m/s2). It is linear between the samples of a record with one step, which
 * are among the instants looked at. */
static double find_peak(const simulation *sim) {
  mps_signal_record_report r;
  double peak = 0.0;
  int64_t looks = 20000;
  if (mps_signal_get_record(sim->motion, &r) == MPS_OK && r.count > 1) looks = 2 * (r.count - 1);
  for (int64_t k = 0; k <= looks; k++)
    peak = fmax(peak, fabs(mps_signal_acceleration(sim->motion,
                                                   sim->record_end * (double)k / (double)looks)));
  return peak;
}

mps_status site_make_motion(mps_context *context, simulation *sim) {
  const settings *s = &sim->s;
  const mps_status status = make_record(sim->m.a, s, &sim->motion);
  if (status != MPS_OK) return status;
  mps_signal_span(sim->motion, NULL, &sim->record_end);
  sim->record_peak = find_peak(sim);
  bool good = true;
  if (!(sim->record_peak > 0.0))
    good = site_refuse(&sim->m, "%s: the acceleration is 0 m/s2 throughout, must shake the ground",
                       s->record);
  else if (!(sim->record_end >= LEAST_SAMPLES * s->sample))
    good = site_refuse(&sim->m, "%s lasts %g s, must be at least %d times --sample, %g s",
                       s->record, sim->record_end, LEAST_SAMPLES, LEAST_SAMPLES * s->sample);
  if (!good) return MPS_ERROR_ARGUMENT;
  check_drift(sim->m.a, sim);
  return mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_VALUE, frame, sim, NULL, &sim->load);
}
