/* study.c - runs the paper's parameter study in parallel and fits its regression.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "study.h"

#include <mps/experimental/dynamics_predict.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

const double study_radius[STUDY_RADII] = {0.25, 0.5, 1.0, 1.6};
const double study_velocity[STUDY_VELOCITIES] = {100.0, 200.0, 400.0, 800.0};
const double study_damping[STUDY_DAMPINGS] = {0.001, 0.0022, 0.0048, 0.01, 0.022,
                                              0.048, 0.1,    0.22,   0.48, 1.0};
static const double FIT_LIMIT = 0.2201; /* the paper fits h up to 0.22 */

/* ---- the cases ------------------------------------------------------------------------------- */

static void list_cases(study *s) {
  stability_case *x = s->cases;
  for (int wave = 0; wave < 2; wave++)
    for (int r = 0; r < STUDY_RADII; r++)
      for (int v = 0; v < STUDY_VELOCITIES; v++)
        for (int h = 0; h < STUDY_DAMPINGS; h++)
          *x++ = (stability_case){.wave = wave == 0 ? 'S' : 'P',
                                  .integrator = MPS_DYNAMICS_INTEGRATOR_VERLET,
                                  .radius = study_radius[r],
                                  .velocity = study_velocity[v],
                                  .damping = study_damping[h]};
  static const int others[3] = {MPS_DYNAMICS_INTEGRATOR_EULER, MPS_DYNAMICS_INTEGRATOR_LEAPFROG,
                                MPS_DYNAMICS_INTEGRATOR_VERLET};
  for (int other = 0; other < 3; other++)
    for (int r = 1; r < STUDY_RADII; r += 2) /* 0.5 and 1.6 m */
      for (int h = 0; h < STUDY_DAMPINGS; h++)
        *x++ = (stability_case){.wave = 'S',
                                .integrator = others[other],
                                .radius = study_radius[r],
                                .velocity = study_velocity[0],
                                .damping = study_damping[h]};
}

/* ---- running --------------------------------------------------------------------------------- */

typedef struct work {
  app *a;
  study *s;
  int64_t order[STUDY_CASES]; /* largest first, so that no worker ends long after the others */
  int64_t cost[STUDY_CASES];  /* particle steps */
  int64_t count;              /* of this rank */
  int64_t total;
  atomic_int_fast64_t done;
  atomic_int cases_done;
  atomic_flag drawing;
  atomic_bool failed;
} work;

static int64_t estimate_cost(mps_context *context, const method *m, const stability_case *x) {
  mps_dynamics_predict_def def = mps_dynamics_predict_defaults();
  mps_dynamics_prediction guess;
  def.spacing = 2.0 * x->radius;
  def.shear_velocity = x->wave == 'S' ? x->velocity : 0.5 * x->velocity;
  def.pressure_velocity = 2.0 * def.shear_velocity;
  def.damping = x->damping;
  def.f1 = m->f1;
  def.f2 = m->f2;
  double dt = 1e-3;
  if (mps_dynamics_predict(context, &def, &guess) == MPS_OK) dt = guess.dt;
  if (x->integrator == MPS_DYNAMICS_INTEGRATOR_EULER) dt *= 0.2;
  const double particles = (double)case_particles(x->radius);
  if (m->kind == METHOD_LINEAR) return (int64_t)(particles * sqrt(particles));
  return (int64_t)(particles * method_duration(m, x->velocity) / dt) + 1;
}

static void sort_by_cost(work *w) {
  for (int64_t i = 0; i < STUDY_CASES; i++) { /* insertion: 380 items */
    int64_t k = i;
    for (; k > 0 && w->cost[w->order[k - 1]] < w->cost[i]; k--) w->order[k] = w->order[k - 1];
    w->order[k] = i;
  }
}

/* Of several ranks each takes whole cases: the largest remaining one goes to the rank with the
 * least work. Keeps those of this rank in `order`; `owner` has the rank of each case. */
static bool deal(work *w, int32_t *owner) {
  const int32_t ranks = w->a->domain ? mps_domain_size(w->a->domain) : 1;
  int64_t *load = calloc((size_t)ranks, sizeof *load);
  if (!load) return app_no_memory(w->a);
  for (int64_t k = 0; k < STUDY_CASES; k++) {
    const int64_t i = w->order[k];
    int32_t least = 0;
    for (int32_t rank = 1; rank < ranks; rank++)
      if (load[rank] < load[least]) least = rank;
    load[least] += w->cost[i];
    owner[i] = least;
    if (least == w->a->rank) w->order[w->count++] = i;
  }
  w->total = load[w->a->rank];
  free(load);
  return true;
}

/* Sends the results of each rank to all. */
static bool share_cases(app *a, study *s, const int32_t *owner) {
  bool ok = true;
  for (int64_t i = 0; i < STUDY_CASES && ok; i++) {
    stability_case *x = &s->cases[i];
    double values[] = {x->linear,        x->stepping, x->unstable, x->table2, (double)x->particles,
                       (double)x->steps, x->status};
    ok = app_check(a, app_share(a, owner[i] == a->rank, sizeof values / sizeof *values, values));
    x->linear = values[0], x->stepping = values[1], x->unstable = values[2], x->table2 = values[3];
    x->particles = (int64_t)values[4], x->steps = (int64_t)values[5];
    x->status = (mps_status)values[6];
  }
  return ok;
}

static void run_one(void *data, int64_t index, int32_t worker) {
  work *w = data;
  (void)worker;
  if (atomic_load(&w->failed) || progress_interrupted()) return;
  const int64_t i = w->order[index];
  method m = w->s->m;
  if (i >= STUDY_GRID) m.criterion = STUDY_INTEGRATOR_CRITERION;
  case_find(&m, &w->s->cases[i]);
  if (w->s->cases[i].status != MPS_OK) atomic_store(&w->failed, true);
  const int64_t done = atomic_fetch_add(&w->done, w->cost[i]) + w->cost[i];
  const int count = atomic_fetch_add(&w->cases_done, 1) + 1;
  if (atomic_flag_test_and_set(&w->drawing)) return;
  char text[64];
  snprintf(text, sizeof text, "%d of %d cases", count, (int)w->count);
  progress_draw(&w->a->bar, (double)done / (double)w->total, text);
  atomic_flag_clear(&w->drawing);
}

bool study_run(app *a, const method *m, study *s) {
  work *w = calloc(1, sizeof *w);
  if (!w) return app_no_memory(a);
  *s = (study){.m = *m};
  list_cases(s);
  for (int64_t i = 0; i < STUDY_CASES; i++) { /* until they have been run */
    stability_case *x = &s->cases[i];
    x->linear = x->stepping = x->unstable = x->table2 = NAN;
    x->status = MPS_ERROR_CANCELLED;
  }
  w->a = a;
  w->s = s;
  atomic_flag_clear(&w->drawing);
  for (int64_t i = 0; i < STUDY_CASES; i++) w->cost[i] = estimate_cost(a->context, m, &s->cases[i]);
  sort_by_cost(w);
  int32_t owner[STUDY_CASES];
  bool ok =
      deal(w, owner) && app_check(a, mps_context_parallel_for(a->context, w->count, run_one, w));
  progress_clear(&a->bar);
  for (int64_t i = 0; ok && i < STUDY_CASES; i++)
    if (s->cases[i].status != MPS_OK && s->cases[i].status != MPS_ERROR_CANCELLED)
      ok = app_error(a, "%s", s->cases[i].why);
  ok = app_agree(a, ok) && share_cases(a, s, owner);
  s->done = 0;
  for (int64_t i = 0; i < STUDY_CASES; i++) s->done += s->cases[i].status == MPS_OK;
  free(w);
  return ok;
}

/* ---- regression ------------------------------------------------------------------------------ */

static bool fit_wave(app *a, study *s, int wave, bool stepping) {
  double R[STUDY_WAVE], V[STUDY_WAVE], h[STUDY_WAVE], dt[STUDY_WAVE];
  regression *r = stepping ? &s->stepping[wave] : &s->linear[wave];
  const limit_fit *printed = &s->printed[wave];
  double sum = 0.0, sum_fits = 0.0;
  int64_t count = 0;
  for (int64_t i = 0; i < STUDY_WAVE; i++) {
    const stability_case *x = &s->cases[wave * STUDY_WAVE + i];
    R[i] = x->radius;
    V[i] = x->velocity;
    h[i] = x->damping;
    dt[i] = stepping ? x->stepping : x->linear;
  }
  char why[160];
  if (!limit_fit_make(STUDY_WAVE, R, V, h, dt, FIT_LIMIT, &r->fit, why))
    return app_error(a, "%s", why);
  for (int64_t i = 0; i < STUDY_WAVE; i++) {
    if (h[i] > FIT_LIMIT) continue;
    const double table2 = limit_fit_dt(printed, R[i], V[i], h[i]);
    const double fitted = limit_fit_dt(&r->fit, R[i], V[i], h[i]);
    sum += pow(dt[i] / table2 - 1.0, 2.0);
    sum_fits += pow(fitted / table2 - 1.0, 2.0);
    count++;
  }
  r->rms_table2 = sqrt(sum / (double)count);
  r->rms_fits = sqrt(sum_fits / (double)count);
  r->known = true;
  return true;
}

bool study_fit(app *a, study *s) {
  for (int wave = 0; wave < 2; wave++) {
    s->printed[wave] = limit_fit_printed(wave == 0 ? 'S' : 'P');
    if (s->m.kind != METHOD_STEPPING && !fit_wave(a, s, wave, false)) return false;
    if (s->m.kind != METHOD_LINEAR && !fit_wave(a, s, wave, true)) return false;
  }
  return true;
}
