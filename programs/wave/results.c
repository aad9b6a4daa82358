/* results.c - peaks, travel time and energy of a run, against theory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wave.h"

#include "common/record.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const integrators[] = {"verlet", "leapfrog", "euler"};

/* ---- travel time ----------------------------------------------------------------------------- */

/* sum_k x[k] y[k + lag] of two traces of n samples. */
static double correlation(int64_t n, const double *x, const double *y, int64_t lag) {
  double sum = 0.0;
  for (int64_t k = 0; k + lag < n; k++) sum += x[k] * y[k + lag];
  return sum;
}

/* The lag (s) of the surface trace y behind the input x with the highest correlation, refined by
 * a parabola through three samples. The search ends before the next wave of the same sign, which
 * has been up, down, up, down and up: at five times the first; that at three times is reversed. */
static double best_lag(int64_t n, const double *x, const double *y, double dt, double expected) {
  const int64_t from = (int64_t)(0.3 * expected / dt) + 1, to = (int64_t)(2.0 * expected / dt);
  int64_t best = -1;
  double most = 0.0;
  for (int64_t lag = from; lag <= to && lag + 1 < n; lag++) {
    const double value = correlation(n, x, y, lag);
    if (value > most) {
      most = value;
      best = lag;
    }
  }
  /* A maximum at the end of the records does not count. */
  if (best <= from || best >= to || best + 2 >= n) return NAN;
  const double before = correlation(n, x, y, best - 1), after = correlation(n, x, y, best + 1);
  const double bend = before - 2.0 * most + after;
  if (before > most || after > most || !(bend < 0.0)) return NAN;
  return ((double)best + 0.5 * (before - after) / bend) * dt;
}

static bool find_travel_time(app *a, const receivers *r, const mps_signal *signal, results *x) {
  const int64_t n = r->rows - 1; /* the last row may follow after a shorter interval */
  x->travel_time = NAN;
  if (n < 8) return true;
  double *input = malloc((size_t)n * sizeof *input), *surface = malloc((size_t)n * sizeof *surface);
  if (input && surface) {
    double input_end;
    mps_signal_span(signal, NULL, &input_end);
    for (int64_t k = 0; k < n; k++) {
      input[k] = mps_signal_acceleration(signal, receivers_time(r, k));
      surface[k] = receivers_value(r, k, 0);
    }
    const double dt = receivers_time(r, 1) - receivers_time(r, 0);
    /* The strongest part of the input must have had the time to arrive. */
    int64_t strongest = 0;
    for (int64_t k = 0; k < n; k++)
      if (fabs(input[k]) > fabs(input[strongest])) strongest = k;
    if (receivers_time(r, n) > receivers_time(r, strongest) + 1.1 * x->travel_exact)
      x->travel_time = best_lag(n, input, surface, dt, x->travel_exact);
  }
  const bool ok = input && surface;
  free(input);
  free(surface);
  return ok || app_no_memory(a);
}

/* The surface doubles an incoming pulse; that is the peak until the wave comes back from a base. */
static comparison compare_peak(const settings *s, const results *x) {
  const layer *l = &s->ground.layer[0];
  const double length = 1.5 / s->frequency; /* s, of a Ricker pulse */
  comparison c = compare_with("a doubled pulse", x->surface_peak, 2.0 * fabs(s->amplitude));
  compare_require(&c, s->ricker, "the input is a record");
  compare_require(&c, !s->sloped, "the ground is not level");
  compare_require(&c, s->ground.count == 1, "the ground has layers");
  compare_require(&c, l->damping == 0.0, "the ground is damped");
  compare_require(&c,
                  s->base == BASE_RIGID ||
                      (s->half_space.vs == l->vs && s->half_space.vp == l->vp &&
                       s->half_space.unit_weight == l->unit_weight),
                  "the half space is of other ground");
  compare_require(&c, s->base != BASE_RIGID || length <= 2.0 * x->travel_exact,
                  "the pulse lasts %.3g s, and its reflection from the base arrives after %.3g s",
                  length, 2.0 * x->travel_exact);
  return c;
}

/* The lag of the surface behind the base is the time of travel where one pulse has arrived before
 * the next. A record correlates with its own later waves too. */
static comparison compare_travel(const settings *s, const results *x) {
  comparison c =
      compare_with("the travel time through the layers", x->travel_time, x->travel_exact);
  compare_require(
      &c, s->ricker,
      "the input is a record, whose correlation with the surface need not be highest at "
      "the first arrival");
  compare_require(&c, !s->sloped, "the ground is not level");
  compare_require(&c, 1.0 / s->frequency <= 4.0 * x->travel_exact,
                  "the pulse of %.3g Hz is longer than two ways through the ground, %.3g s",
                  s->frequency, 4.0 * x->travel_exact);
  return c;
}

bool results_find(app *a, const settings *s, const column *c, const receivers *r,
                  const mps_signal *signal, results *x) {
  const receiver *base = &r->list[r->column - 1];
  /* The surface is the face of its particles; so is a viscous base, a rigid one the centre of its
   * row. */
  const double bottom = c->height - column_level(c, 0.5 * c->spacing);
  x->travel_exact = layers_travel_time(&s->ground, settings_wave(s), bottom, bottom - base->depth);
  x->surface_peak = x->surface_peak_edge = x->travel_time = x->energy_drift = NAN;
  bool ok = true;
  if (x->end != OUTCOME_DIVERGED && r->rows > 0) {
    x->surface_peak = receivers_peak(r, 0);
    x->surface_peak_edge = receivers_peak(r, r->column);
    x->energy_drift = receivers_energy_drift(r);
    ok = find_travel_time(a, r, signal, x);
  }
  x->peak = compare_peak(s, x);
  x->travel = compare_travel(s, x);
  return ok;
}

/* ---- files and lines ------------------------------------------------------------------------- */

bool results_write(app *a, const settings *s, const results *x, const mps_signal *signal) {
  static const char *const bases[] = {"rigid", "viscous"};
  static const char *const sides[] = {"roller", "periodic", "freefield"};
  const char wave[2] = {settings_wave(s), '\0'};
  output file;
  if (!summary_open(&file, a, s->out)) return false;
  json_text(&file, "wave", wave);
  json_text(&file, "integrator", integrators[s->integrator]);
  json_text(&file, "rotation", s->rotation == 0 ? "mean-matrix" : "mean-angle");
  json_text(&file, "torque", s->torque == 0 ? "conserving" : "printed");
  json_text(&file, "base", bases[s->base]);
  json_text(&file, "sides", sides[s->sides]);
  json_text(&file, "input", s->input);
  if (!s->ricker) record_json(&file, signal);
  json_number(&file, "spacing", s->spacing);
  json_integer(&file, "particles", x->particles);
  json_integer(&file, "steps", x->steps);
  JSON_NUMBERS(&file, {"dt", x->dt}, {"dt_limit_linear", x->dt_limit},
               {"surface_peak", x->surface_peak}, {"surface_peak_edge", x->surface_peak_edge});
  json_comparison(&file, "surface_peak_theory", &x->peak);
  json_number(&file, "travel_time", x->travel_time);
  json_comparison(&file, "travel_time_exact", &x->travel);
  json_number(&file, "energy_drift", x->energy_drift);
  json_end(&file);
  return output_close(&file);
}

void results_print(app *a, const settings *s, const results *x) {
  const bool diverged = x->end == OUTCOME_DIVERGED;
  app_tell_results(a, s->out);
  if (diverged) return;
  printf("surface peak %.3f m/s2", x->surface_peak);
  if (isnan(x->travel_time) && s->ricker) {
    printf(", the wave has not reached the surface (that takes %.3f s)\n", x->travel_exact);
    return;
  }
  if (compare_holds(&x->peak))
    printf(" (theory %.3f, %+.1f %%)", x->peak.reference, 100.0 * compare_error(&x->peak));
  if (compare_holds(&x->travel))
    printf(", travel time %.3f s (exact %.3f, %+.1f %%)", x->travel_time, x->travel.reference,
           100.0 * compare_error(&x->travel));
  printf("\n");
  compare_tell(&x->peak);
  compare_tell(&x->travel);
}
