/* waves.c - the sea as an object: its definition, what is refused before it is made, its limits,
 * the signal of its piston. SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/digits.h"
#include "core/base/members.h"
#include "core/context/retain.h"
#include "dispersion.h"
#include "signal/signal_internal.h"
#include "waves_private.h"

#include <string.h>

#define SCAN                                                                                       \
  32 /* instants a period of the shortest component at which the piston's motion is examined */
#define MOST_SCAN 400000 /* of them */

static const mps_waves_def defaults = {
    .struct_size = sizeof(mps_waves_def),
    .depth = NAN,
    .gravity = 9.81,
    .height = NAN,
    .period = NAN,
    .gamma = 3.3,
    .repeat = NAN,
    .lower = 0.6,
    .upper = 2.5,
    .crest = NAN,
    .time = NAN,
    .ramp = NAN,
    .stroke = NAN,
    .speed = NAN,
    .seed = 1,
};

mps_status mps_waves_def_init(mps_waves_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_waves_def, def, size, &defaults);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_numbers(mps_context *context, const mps_waves_def *d) {
  const int32_t kind = d->kind;
  const bool regular = kind == MPS_WAVES_KIND_REGULAR, record = kind == MPS_WAVES_KIND_RECORD;
  const bool table = kind == MPS_WAVES_KIND_SPECTRUM, focus = d->phases == MPS_WAVES_PHASES_FOCUSED;
  const mpsi_member checks[] = {
      {"kind", "0 to 4", kind, kind >= 0 && kind <= MPS_WAVES_KIND_RECORD},
      {"phases", "0, 1 or 2", d->phases, d->phases >= 0 && d->phases <= 2},
      {"phases", "RANDOM (0) with a regular wave or a record", d->phases,
       !(regular || record) || d->phases == 0},
      {"theory", "0, 1 or 2", d->theory, d->theory >= 0 && d->theory <= 2},
      {"depth", "in (0, 1e12] m", d->depth, mpsi_waves_positive(d->depth)},
      {"gravity", "in (0, 1e12] m/s2", d->gravity, mpsi_waves_positive(d->gravity)},
      {"height", "in (0, 1e12] m", d->height,
       mpsi_waves_positive(d->height) || record || focus || (table && isnan(d->height))},
      {"period", "in (0, 1e12] s", d->period,
       mpsi_waves_positive(d->period) || ((table || record) && isnan(d->period))},
      {"gamma", "in 1 to 20", d->gamma, d->gamma >= 1.0 && d->gamma <= 20.0},
      {"repeat", "in (0, 1e12] s", d->repeat, mpsi_waves_positive_or_unset(d->repeat)},
      {"lower", "above 0 and below upper", d->lower, d->lower > 0.0 && d->lower < d->upper},
      {"upper", "at most 10", d->upper, d->upper <= 10.0},
      {"crest", "in (0, 1e12] m", d->crest, !focus || mpsi_waves_positive(d->crest)},
      {"position", "in 0 to 1e12 m", d->position, d->position >= 0.0 && d->position <= 1e12},
      {"time", "within 1e12 s", d->time, !focus || fabs(d->time) <= 1e12},
      {"ramp", "in 0 to 1e12 s", d->ramp, isnan(d->ramp) || (d->ramp >= 0.0 && d->ramp <= 1e12)},
      {"stroke", "in (0, 1e12] m", d->stroke, mpsi_waves_positive_or_unset(d->stroke)},
      {"speed", "in (0, 1e12] m/s", d->speed, mpsi_waves_positive_or_unset(d->speed)},
  };
  return MPSI_CHECK_MEMBERS(context, "mps_waves_create", "the waves", checks);
}

static mps_status check_repeat(mps_context *context, const mps_waves_def *d) {
  const bool read = d->kind != MPS_WAVES_KIND_REGULAR && d->kind != MPS_WAVES_KIND_RECORD;
  if (!read || isnan(d->repeat) || isnan(d->period) || d->repeat >= 2.0 * d->period) return MPS_OK;
  return mpsi_fail(context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                   "repeat of the waves is %s s, must be %g s or more, two periods",
                   mpsi_outside(d->repeat, 2.0 * d->period, INFINITY).text, 2.0 * d->period);
}

static mps_status check_table(mps_context *context, const mps_waves_def *d) {
  if (d->kind != MPS_WAVES_KIND_SPECTRUM) return MPS_OK;
  if (d->count < 2 || !d->frequency || !d->density)
    return mpsi_fail(context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                     "count is %lld with frequency %s and density %s, must be 2 or more rows",
                     (long long)d->count, d->frequency ? "given" : "NULL",
                     d->density ? "given" : "NULL");
  for (int64_t k = 0; k < d->count; k++) {
    const double f = d->frequency[k], last = k ? d->frequency[k - 1] : 0.0;
    if (!(f > last && f <= 1e12))
      return mpsi_fail(context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                       "frequency[%lld] is %g Hz, must be above %g and at most 1e12", (long long)k,
                       f, last);
    if (!(d->density[k] >= 0.0 && d->density[k] <= 1e100))
      return mpsi_fail(context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                       "density[%lld] is %g m2 s, must be in 0 to 1e100", (long long)k,
                       d->density[k]);
  }
  return MPS_OK;
}

static mps_status check_record(mps_context *context, const mps_waves_def *d) {
  if (d->kind != MPS_WAVES_KIND_RECORD) return MPS_OK;
  if (d->samples < 8 || !d->times || !d->levels)
    return mpsi_fail(context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                     "samples is %lld with times %s and levels %s, must be 8 or more samples",
                     (long long)d->samples, d->times ? "given" : "NULL",
                     d->levels ? "given" : "NULL");
  const double step = (d->times[d->samples - 1] - d->times[0]) / (double)(d->samples - 1);
  for (int64_t k = 0; k < d->samples; k++) {
    const double even = d->times[0] + step * (double)k;
    if (!(step > 0.0 && step <= 1e12 && fabs(d->times[k] - even) <= 1e-3 * step))
      return mpsi_fail(context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                       "times[%lld] is %g s, must be %g: a record has even intervals", (long long)k,
                       d->times[k], even);
    if (!(fabs(d->levels[k]) <= 1e12))
      return mpsi_fail(context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                       "levels[%lld] is %g m, must be within 1e12", (long long)k, d->levels[k]);
  }
  return MPS_OK;
}

/* Breaking, and crests of the second order's own. */
static mps_status check_height(const mps_waves *w) {
  const mps_waves_def *d = &w->def;
  if (d->kind != MPS_WAVES_KIND_REGULAR) return MPS_OK;
  const double k = w->wave[0].k, L = 2.0 * MPSI_WAVES_PI / k, most = 0.142 * L * tanh(k * d->depth);
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
                     "theory SECOND",
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
  if (fabs(m[1]) > w->def.speed)
    return mpsi_fail(w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                     "speed is %g m/s, but these waves need a piston that has %g m/s at t = %g s",
                     w->def.speed, fabs(m[1]), t);
  return MPS_OK;
}

static mps_status examine(mps_waves *w) {
  mps_waves_report *r = &w->report;
  const double shortest = w->repeat / (double)w->wave[w->count - 1].bin;
  const double span = w->ramp + w->repeat, step = fmax(shortest / SCAN, span / MOST_SCAN);
  double motion[MPSI_WAVES_BLOCK][3];
  for (double t = 0.0; t <= span; t += step * MPSI_WAVES_BLOCK) {
    mpsi_waves_move_evenly(w, t, step, MPSI_WAVES_BLOCK, motion);
    for (int64_t k = 0; k < MPSI_WAVES_BLOCK; k++) {
      const double *m = motion[k];
      r->stroke[0] = fmin(r->stroke[0], m[0]), r->stroke[1] = fmax(r->stroke[1], m[0]);
      r->speed = fmax(r->speed, fabs(m[1]));
      r->acceleration = fmax(r->acceleration, fabs(m[2]));
      const mps_status status = check_motion(w, t + step * (double)k, m);
      if (status != MPS_OK) return status;
    }
  }
  return MPS_OK;
}

static void summarise(mps_waves *w) {
  mps_waves_report *r = &w->report;
  const bool regular = w->def.kind == MPS_WAVES_KIND_REGULAR;
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
  mpsi_free(w->context, w->wave);
  mpsi_free(w->context, w->push);
  mpsi_free(w->context, w->bound);
  mpsi_free(w->context, w);
}

static mps_status make_second_order(mps_waves *w) {
  if (w->def.theory == MPS_WAVES_THEORY_LINEAR) return MPS_OK;
  const int64_t bins = 2 * w->wave[w->count - 1].bin;
  const size_t bytes = (size_t)(bins + 1) * sizeof *w->push;
  w->push = mpsi_alloc(w->context, bins + 1, sizeof *w->push);
  if (!w->push) return mpsi_fail_memory(w->context, "mps_waves_create", bytes);
  w->bound = mpsi_alloc(w->context, bins + 1, sizeof *w->bound);
  if (!w->bound) return mpsi_fail_memory(w->context, "mps_waves_create", bytes);
  w->bins = bins;
  mpsi_waves_add_bound(w, 0.0, w->bound);
  return mpsi_waves_find_push(w);
}

mps_status mps_waves_create(mps_context *context, const mps_waves_def *user_def, mps_waves **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!user_def || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL", user_def ? "out" : "def");
  *out = NULL;
  mps_waves_def def = defaults;
  mps_status status = MPSI_DEF_READ(context, __func__, mps_waves_def, user_def, &def);
  if (status == MPS_OK) status = check_numbers(context, &def);
  if (status == MPS_OK) status = check_repeat(context, &def);
  if (status == MPS_OK) status = check_table(context, &def);
  if (status == MPS_OK) status = check_record(context, &def);
  if (status != MPS_OK) return status;
  mps_waves *w = mpsi_alloc(context, 1, sizeof *w);
  if (!w) return mpsi_fail_memory(context, __func__, sizeof *w);
  w->context = context;
  w->def = def;
  w->def.frequency = w->def.density = w->def.times = w->def.levels = NULL;
  atomic_init(&w->references, 1);
  status = mpsi_waves_make_components(w, &def);
  if (status == MPS_OK) status = check_height(w);
  if (status == MPS_OK) w->ramp = isnan(def.ramp) ? 2.0 * w->period : def.ramp;
  if (status == MPS_OK) status = make_second_order(w);
  if (status == MPS_OK) summarise(w);
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
  if (!w) return MPS_ERROR_ARGUMENT;
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
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!waves || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL", waves ? "out" : "waves");
  *out = NULL;
  const mps_status status =
      mpsi_signal_create_owned(context, __func__, signal_motion, drop_waves, waves, out);
  if (status == MPS_OK) (void)mpsi_waves_retain(waves);
  return status;
}
