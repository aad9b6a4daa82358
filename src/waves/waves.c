/* waves.c - the sea as an object: its definition, what is refused before it is made, its limits,
 * the signal of its piston. SPDX-License-Identifier: BSD-3-Clause */
#include "dispersion.h"
#include "signal/signal_internal.h"
#include "waves_private.h"

#include <string.h>

#define SCAN                                                                                       \
  32 /* instants a period of the shortest component at which the piston's motion is examined */
#define MOST_SCAN 400000 /* of them */
#define BREAKING 0.142   /* height over L tanh(k depth), Miche (1944) */

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_record(mps_context *context, const mps_waves_def *d) {
  if (d->kind != MPS_WAVES_RECORD) return MPS_OK;
  const double step = (d->times[d->samples - 1] - d->times[0]) / (double)(d->samples - 1);
  for (int64_t k = 0; k < d->samples; k++) {
    const double even = d->times[0] + step * (double)k;
    if (!(step > 0.0 && step <= 1e12 && fabs(d->times[k] - even) <= 1e-3 * step))
      return mpsi_fail(context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                       "times[%lld] is %g s, must be %g: a record has even intervals", (long long)k,
                       d->times[k], even);
  }
  return MPS_OK;
}

/* Higher waves than any depth carries: crest and trough of a record, Hm0 of a sea. `levels`: of the
 * record. */
static mps_status check_sea(const mps_waves *w, const double *levels) {
  const mps_waves_def *d = &w->def;
  const mps_waves_report *r = &w->report;
  const double most =
      BREAKING * 2.0 * MPSI_WAVES_PI / r->wave_number * tanh(r->wave_number * d->depth);
  const double deepest = BREAKING * 2.0 * MPSI_WAVES_PI * d->depth; /* of long waves */
  double low = 0.0, high = 0.0;
  for (int64_t k = 0; d->kind == MPS_WAVES_RECORD && k < d->samples; k++)
    low = fmin(low, levels[k]), high = fmax(high, levels[k]);
  if (low <= -d->depth || high - low > deepest)
    return mpsi_fail(
        w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
        "levels are from %g to %g m, must be above the bed at -%g m and less than %g m "
        "from trough to crest, the breaking height of long waves: are they in m?",
        low, high, d->depth, deepest);
  if (d->phases == MPS_WAVES_PHASES_FOCUSED && 2.0 * d->crest > deepest)
    return mpsi_fail(
        w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
        "crest is %g m, must be at most %g m, half the breaking height of long waves in "
        "a depth of %g m",
        d->crest, 0.5 * deepest, d->depth);
  if (d->phases != MPS_WAVES_PHASES_FOCUSED && r->height > most)
    return mpsi_fail(
        w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
        "height Hm0 %g m of the sea is above the breaking height %g m of a period of %g "
        "s in a depth of %g m",
        r->height, most, r->period, d->depth);
  return MPS_OK;
}

/* Breaking, and crests of the second order's own. */
static mps_status check_height(const mps_waves *w) {
  const mps_waves_def *d = &w->def;
  if (d->theory == MPS_WAVES_THEORY_STREAM && d->kind != MPS_WAVES_REGULAR)
    return mpsi_fail(w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                     "theory MPS_WAVES_THEORY_STREAM is for MPS_WAVES_REGULAR");
  if (d->kind != MPS_WAVES_REGULAR) return MPS_OK;
  const double k = w->wave[0].k, L = 2.0 * MPSI_WAVES_PI / k,
               most = BREAKING * L * tanh(k * d->depth);
  const double ratio = d->height * L * L / (d->depth * d->depth * d->depth);
  if (d->height > most)
    return mpsi_fail(
        w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
        "height %g m of the waves is above the breaking height %g m of a period of %g s "
        "in a depth of %g m",
        d->height, most, d->period, d->depth);
  if (d->theory == MPS_WAVES_THEORY_SECOND && ratio >= 8.0 / 3.0 * MPSI_WAVES_PI * MPSI_WAVES_PI)
    return mpsi_fail(w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                     "height %g m of the waves: height L^2/depth^3 is %g, must be below 26.3 with "
                     "MPS_WAVES_THEORY_SECOND: longer waves are of MPS_WAVES_THEORY_STREAM",
                     d->height, ratio);
  return MPS_OK;
}

/* ---- the piston's range ---------------------------------------------------------------------- */

static mps_status check_motion(const mps_waves *w, double t, const double m[3]) {
  if (fabs(m[0]) > w->def.stroke)
    return mpsi_fail(w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                     "stroke is %g m, but these waves need a piston that is %g m from its mean "
                     "position at t = %g s",
                     w->def.stroke, fabs(m[0]), t);
  /* the tip of water that a wall leaves behind runs at 2 c (Ritter) */
  const double fastest = 2.0 * sqrt(w->def.gravity * w->def.depth);
  if (fabs(m[1]) > fastest)
    return mpsi_fail(
        w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
        "these waves need a piston that has %g m/s at t = %g s, must be at most %g m/s, "
        "2 (gravity depth)^1/2: water does not follow a faster one",
        fabs(m[1]), t, fastest);
  if (fabs(m[1]) > w->def.speed)
    return mpsi_fail(w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                     "speed is %g m/s, but these waves need a piston that has %g m/s at t = %g s",
                     w->def.speed, fabs(m[1]), t);
  return MPS_OK;
}

static mps_status examine(mps_waves *w) {
  mps_waves_report *r = &w->report;
  const double shortest = w->count > 0 ? w->repeat / (double)w->wave[w->count - 1].bin : w->period;
  const double span = w->ramp + w->repeat, step = fmax(shortest / SCAN, span / MOST_SCAN);
  double motion[MPSI_WAVES_BLOCK][3];
  for (double t = 0.0; t <= span; t += step * MPSI_WAVES_BLOCK) {
    mpsi_waves_move_evenly(w, t, step, MPSI_WAVES_BLOCK, motion);
    for (int64_t k = 0; k < MPSI_WAVES_BLOCK; k++) {
      const double *m = motion[k];
      r->stroke[0] = fmin(r->stroke[0], m[0]), r->stroke[1] = fmax(r->stroke[1], m[0]);
      r->speed = fmax(r->speed, fabs(m[1]));
      r->acceleration = fmax(r->acceleration, fabs(m[2]));
      MPSI_TRY(check_motion(w, t + step * (double)k, m));
    }
  }
  return MPS_OK;
}

static void summarise(mps_waves *w) {
  mps_waves_report *r = &w->report;
  const bool regular = w->def.kind == MPS_WAVES_REGULAR;
  double sum = 0.0;
  for (int64_t n = 0; n < w->count; n++) sum += 0.5 * pow(cabs(w->wave[n].a), 2.0);
  r->components = w->count;
  r->period = w->period;
  const double omega = 2.0 * MPSI_WAVES_PI / w->period;
  r->wave_number = mpsi_waves_depths(omega * omega * w->def.depth / w->def.gravity) / w->def.depth;
  r->height = regular ? w->def.height : 4.0 * sqrt(sum);
  r->repeat = w->repeat;
}

/* ---- life ------------------------------------------------------------------------------------ */

static void release(mps_waves *w) {
  MPSI_FREE(w->context, w->wave, w->push, w->bound, w->shape, w);
}

static mps_status make_second_order(mps_waves *w) {
  if (w->def.theory == MPS_WAVES_THEORY_LINEAR) return MPS_OK;
  const bool stream = w->def.theory == MPS_WAVES_THEORY_STREAM;
  const int64_t bins = stream ? MPSI_WAVES_HARMONICS : 2 * w->wave[w->count - 1].bin;
  const size_t bytes = (size_t)(bins + 1) * sizeof *w->push;
  w->push = mpsi_alloc(w->context, bins + 1, sizeof *w->push);
  if (!w->push) return mpsi_fail_memory(w->context, "mps_waves_create", bytes);
  w->bound = mpsi_alloc(w->context, bins + 1, sizeof *w->bound);
  if (!w->bound) return mpsi_fail_memory(w->context, "mps_waves_create", bytes);
  if (stream) w->shape = mpsi_alloc(w->context, bins + 1, sizeof *w->shape);
  if (stream && !w->shape) return mpsi_fail_memory(w->context, "mps_waves_create", bytes);
  w->bins = bins;
  MPSI_TRY(mpsi_waves_find_push(w));
  if (stream) MPSI_TRY(mpsi_waves_make_stream(w));
  if (stream) w->report.wave_number = w->wave[0].k;
  mpsi_waves_add_bound(w, 0.0, w->bound);
  return MPS_OK;
}

static mps_status make_sea(mps_waves *w, const mps_waves_def *def) {
  MPSI_TRY(mpsi_waves_make_components(w, def));
  MPSI_TRY(check_height(w));
  w->ramp = isnan(def->ramp) ? 2.0 * w->period : def->ramp;
  summarise(w);
  MPSI_TRY(check_sea(w, def->levels));
  return make_second_order(w);
}

mps_status mps_waves_create(mps_context *context, const mps_waves_def *user_def, mps_waves **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!user_def || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL", user_def ? "out" : "def");
  *out = NULL;
  mps_waves_def def;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_waves_def, user_def, &def));
  MPSI_TRY(check_record(context, &def));
  mps_waves *w = mpsi_alloc(context, 1, sizeof *w);
  if (!w) return mpsi_fail_memory(context, __func__, sizeof *w);
  w->context = context;
  w->def = def;
  w->def.frequency = w->def.density = w->def.times = w->def.levels = NULL;
  atomic_init(&w->references, 1);
  mps_status status =
      def.kind == MPS_WAVES_SOLITARY ? mpsi_waves_make_solitary(w) : make_sea(w, &def);
  if (status == MPS_OK) status = examine(w);
  if (status != MPS_OK) {
    release(w);
    return status;
  }
  mpsi_context_retain(context);
  *out = w;
  return MPS_OK;
}

mps_waves *mpsi_waves_retain(mps_waves *w) {
  atomic_fetch_add(&w->references, 1);
  return w;
}

void mps_waves_destroy(mps_waves **waves) {
  if (!waves || !*waves) return;
  mps_waves *w = *waves;
  *waves = NULL;
  if (atomic_fetch_sub(&w->references, 1) != 1) return;
  mps_context *context = w->context;
  release(w);
  mpsi_context_release(context);
}

mps_status mps_waves_get_report_sized(const mps_waves *w, mps_waves_report *out, size_t size) {
  if (!w) return mpsi_null(__func__, "waves");
  return mpsi_out_write(w->context, __func__, out, size, &w->report, sizeof w->report);
}

/* ---- the signal ------------------------------------------------------------------------------ */

static mps_status signal_motion(void *user, double t, double motion[3]) {
  double all[4];
  mpsi_waves_move(user, t, NULL, all);
  for (int c = 0; c < 3; c++) motion[c] = all[c];
  return MPS_OK;
}

static void drop_waves(void *user) {
  mps_waves *w = user;
  mps_waves_destroy(&w);
}

mps_status mps_signal_create_waves(mps_context *context, mps_waves *waves, mps_signal **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!waves || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL", waves ? "out" : "waves");
  *out = NULL;
  const mps_status status =
      mpsi_signal_create_owned(context, __func__, signal_motion, drop_waves, waves, out);
  if (status == MPS_OK) (void)mpsi_waves_retain(waves);
  return status;
}
