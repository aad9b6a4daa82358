/* search.c - the factor of safety by strength reduction: trials with c and tan(phi) divided by a
 * factor, which close in on the one at which the slope fails. First a little less than that of
 * spirals, then a tenth more or less, and half as much again, until one stands and one fails, then
 * their geometric mean. Checkpoints hold the trials that have ended. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "slope.h"

#include <math.h>
#include <stdio.h>

#define FIRST 0.95 /* of the factor of spirals */
#define STEP 1.1   /* and 1.5 from the third trial on */
#define LEAST 0.05
#define MOST 20.0

void slope_bracket(const simulation *sim, int trials, double *stands, double *fails) {
  *stands = 0.0, *fails = INFINITY;
  for (int k = 0; k < trials; k++) {
    const trial *t = &sim->trial[k];
    if (t->failed)
      *fails = fmin(*fails, t->factor);
    else
      *stands = fmax(*stands, t->factor);
  }
}

bool slope_found(const simulation *sim, int trials) {
  double stands, fails;
  if (!isnan(sim->s.factor)) return trials > 0;
  slope_bracket(sim, trials, &stands, &fails);
  return stands > 0.0 && fails <= stands * (1.0 + sim->s.tolerance);
}

/* The next strength; NaN: beyond what is tried. */
static double next_factor(const simulation *sim) {
  double stands, fails;
  if (!isnan(sim->s.factor)) return sim->s.factor;
  slope_bracket(sim, sim->now, &stands, &fails);
  if (sim->now == 0) {
    slope_circle pole;
    const double first = FIRST * slope_spirals(&sim->s, false, &pole);
    return first >= LEAST && first <= MOST ? first : 1.0;
  }
  const double step = sim->now < 3 ? STEP : 1.5;
  const double next = isinf(fails)    ? stands * step
                      : stands == 0.0 ? fails / step
                                      : sqrt(stands * fails);
  return next >= LEAST && next <= MOST && sim->now < SLOPE_TRIALS ? next : NAN;
}

/* History of the run for a restart. */
/* The line of --water-level stands in a file, and must be that of the start. */
static bool pass_water(simulation *sim, resume_bytes *b) {
  const settings *s = &sim->s;
  if (s->points == 0) return true;
  const bool same = resume_same(b, &s->points, sizeof s->points) &&
                    resume_same(b, s->line, 2 * (size_t)s->points * sizeof *s->line);
  if (mpm_course_same(&sim->course, b, same, "the line of --water-level has")) return true;
  sim->now = 0;
  return false;
}

static void pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  int64_t samples = sim->m.samples;
  resume_pass(b, &sim->now, sizeof sim->now);
  resume_pass(b, &samples, sizeof samples);
  if (resume_wrong(b, sim->now < 0 || sim->now >= SLOPE_TRIALS || samples < 0)) {
    sim->now = 0;
    return;
  }
  if (!pass_water(sim, b)) return;
  sim->m.samples = samples;
  for (int k = 0; k <= sim->now; k++) {
    trial *t = &sim->trial[k];
    resume_pass(b, &t->factor, sizeof t->factor);
    resume_pass(b, &t->failed, sizeof t->failed);
    resume_pass(b, &t->ended, sizeof t->ended);
    resume_pass(b, &t->rows, sizeof t->rows);
    if (resume_wrong(b, t->rows < 0 || t->rows > SLOPE_SAMPLES + 1)) {
      t->rows = 0;
      return;
    }
    resume_pass(b, t->t, (size_t)t->rows * sizeof *t->t);
    resume_pass(b, t->moved, (size_t)t->rows * sizeof *t->moved);
  }
  double *const values[] = {&sim->front, &sim->lost, &sim->kinetic, &sim->peak};
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    resume_pass(b, values[k], sizeof *values[k]);
  resume_pass_snapshot(b, &sim->shot);
}

static void name_course(simulation *sim) {
  static char what[40];
  snprintf(what, sizeof what, "slope_%d", sim->now + 1);
  const bool lost = sim->course.saves.lost; /* warned once for all trials */
  sim->course = mpm_course_of(&sim->s.course, &sim->m, sim->s.out, "mps-slope 2", pass, sim);
  sim->course.what = what;
  sim->course.duration = slope_duration(&sim->s);
  sim->course.saves.lost = lost;
}

mps_status slope_build(mps_context *context, void *user) {
  simulation *sim = user;
  sim->context = context;
  sim->trial[0].factor = next_factor(sim);
  name_course(sim);
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK) status = mpm_course_load(&sim->course, context); /* which trial it is */
  name_course(sim);
  if (status == MPS_OK) status = slope_build_trial(sim);
  return status == MPS_OK ? mpm_course_begin(&sim->course, context, true) : status;
}

/* The picture is that of the weakest strength that has failed, so far; without any, of the last. */
static mps_status take_picture(simulation *sim) {
  const trial *now = &sim->trial[sim->now];
  double stands, fails;
  slope_bracket(sim, sim->now, &stands, &fails);
  if (!now->failed && !isinf(fails)) return MPS_OK;
  if (now->failed && now->factor > fails) return MPS_OK;
  return mpm_snapshot_take(&sim->m, mps_mpm_time(sim->m.mpm), "plastic_strain", &sim->shot);
}

static mps_status march_one(simulation *sim) {
  progress_part(&sim->m.a->bar, fmin(0.9, sim->now / 7.0), isnan(sim->s.factor) ? 0.15 : 1.0, 0.0,
                slope_duration(&sim->s));
  mps_status status = slope_march_trial(sim);
  const mps_status taken = sim->trial[sim->now].rows > 0 ? take_picture(sim) : MPS_OK;
  if (status == MPS_OK) status = taken;
  return mpm_course_end(&sim->course, status);
}

mps_status slope_march(void *user) {
  simulation *sim = user;
  for (;;) {
    mps_status status = march_one(sim);
    if (status != MPS_OK || slope_found(sim, sim->now + 1)) return status;
    sim->now++;
    const double factor = next_factor(sim);
    if (isnan(factor)) {
      sim->now--;
      sim->m.failed = true;
      if (sim->m.a->rank == 0)
        app_error(sim->m.a, "no factor of safety: the slope %s with the strength divided by %g",
                  sim->trial[sim->now].failed ? "fails" : "stands", sim->trial[sim->now].factor);
      return MPS_OK;
    }
    mpm_model_destroy(&sim->m);
    sim->trial[sim->now] = (trial){.factor = factor};
    sim->peak = 0.0;
    name_course(sim);
    status = slope_build_trial(sim);
    if (status == MPS_OK) status = mpm_course_begin(&sim->course, sim->context, false);
    if (status != MPS_OK) return status;
  }
}
