/* results.c - peaks, travel time and energy of a run, against theory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "results.h"

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

bool results_find(app *a, const settings *s, const column *c, const receivers *r,
                  const mps_signal *signal, results *x) {
  const receiver *base = &r->list[r->column - 1];
  /* The surface is the face of its particles, the base the centre of its row. */
  x->travel_exact = layers_travel_time(&s->ground, settings_wave(s), c->height - 0.5 * c->spacing,
                                       c->height - 0.5 * c->spacing - base->depth);
  x->surface_theory = settings_doubles(s) ? 2.0 * fabs(s->amplitude) : NAN;
  x->surface_peak = x->surface_peak_edge = x->travel_time = x->energy_drift = NAN;
  if (x->end == OUTCOME_DIVERGED || r->rows == 0) return true;
  x->surface_peak = receivers_peak(r, 0);
  x->surface_peak_edge = receivers_peak(r, r->column);
  x->energy_drift = receivers_energy_drift(r);
  return find_travel_time(a, r, signal, x);
}

/* ---- files and lines ------------------------------------------------------------------------- */

bool results_write(app *a, const settings *s, const results *x) {
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
  json_number(&file, "radius", s->radius);
  json_integer(&file, "particles", x->particles);
  json_integer(&file, "steps", x->steps);
  json_number(&file, "dt", x->dt);
  json_number(&file, "dt_limit_linear", x->dt_limit);
  json_number(&file, "surface_peak", x->surface_peak);
  json_number(&file, "surface_peak_edge", x->surface_peak_edge);
  json_number(&file, "surface_peak_theory", x->surface_theory);
  json_number(&file, "travel_time", x->travel_time);
  json_number(&file, "travel_time_exact", x->travel_exact);
  json_number(&file, "energy_drift", x->energy_drift);
  json_end(&file);
  return output_close(&file);
}

void results_print(const app *a, const settings *s, const results *x) {
  const bool diverged = x->end == OUTCOME_DIVERGED;
  app_tell_results(a, s->out);
  if (diverged) return;
  printf("surface peak %.3f m/s2", x->surface_peak);
  if (isnan(x->travel_time)) {
    printf(", the wave has not reached the surface (that takes %.3f s)\n", x->travel_exact);
    return;
  }
  if (!isnan(x->surface_theory))
    printf(" (theory %.3f, %+.1f %%)", x->surface_theory,
           100.0 * (x->surface_peak / x->surface_theory - 1.0));
  printf(", travel time %.3f s (exact %.3f, %+.1f %%)\n", x->travel_time, x->travel_exact,
         100.0 * (x->travel_time / x->travel_exact - 1.0));
}
