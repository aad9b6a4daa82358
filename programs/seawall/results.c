/* results.c - tables and summary of mps-seawall, and Sainflou's wave beside them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include "common/closed_tank.h"
#include "common/series.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Heights (m) of the Sainflou wave of the look. */
typedef struct sainflou {
  double harmonic; /* twice the incident amplitude: the level's first harmonic at the wall, in the
                      period before */
  double level;    /* of a wave whose crest is where the level is: a breaking wave's jet counts */
} sainflou;

static sainflou find_heights(const seawall *w) {
  const double k = waves_number(w->s.period, w->s.depth), to = w->look.at.t;
  sainflou h = {NAN, NAN};
  if (w->samples == 0) return h;
  const series level = {w->samples, sizeof *w->sample, &w->sample->t, &w->sample->level};
  const double least = 0.02 * w->s.spacing;
  h.harmonic = series_harmonic(&level, w->s.period, to - w->s.period, to, NULL);
  if (!(h.harmonic > least)) h.harmonic = NAN;
  if (w->look.at.level > least) h.level = waves_sainflou_height(k, w->s.depth, w->look.at.level);
  return h;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static bool write_force(app *a, const seawall *w) {
  output f;
  if (!csv_open(
          &f, a, w->s.out, "force.csv",
          "t_s,force_N,force_10_Hz_N,moment_N_m,level_m?,deflection_m,piston_m,linear_force_N"))
    return false;
  for (int64_t k = 0; k < w->samples; k++) {
    const seawall_sample *p = &w->sample[k];
    const double slow = seawall_smooth(w, llround(p->t / w->s.dt) - 1);
    CSV_LINE(&f, p->t, p->force, slow, p->moment, p->level, p->deflection, p->piston, w->linear[k]);
  }
  return output_close(&f);
}

static bool write_pressure(app *a, const seawall *w, double H) {
  const seawall_settings *s = &w->s;
  const double k = waves_number(s->period, s->depth);
  const double top = s->depth + H + waves_sainflou_rise(k, s->depth, H);
  const double bed = WAVES_DENSITY * WAVES_G * s->depth + waves_sainflou_bed(k, s->depth, H);
  output f;
  if (!csv_open(&f, a, s->out, "pressure.csv", "y_m,pressure_Pa,sainflou_Pa?")) return false;
  for (int64_t i = 0; i < w->look.points; i++) {
    const double y = w->look.y[i];
    CSV_LINE(&f, y, w->look.pressure[i], isnan(H) ? NAN : fmax(bed * (1.0 - y / top), 0.0));
  }
  return output_close(&f);
}

static bool write_wall(app *a, const seawall *w) {
  mps_view x;
  output f;
  if (!app_check(a, mps_particles_view(w->wall.set, "position", &x)) ||
      !output_open(&f, a, w->s.out, "wall.csv"))
    return false;
  csv_header(&f, "x_m,y_m,u_m,v_m");
  for (int64_t i = 0; i < x.shape[0]; i++) {
    CSV_LINE(&f, *mps_view_f64(&x, i, 0), *mps_view_f64(&x, i, 1), w->look.displacement[2 * i],
             w->look.displacement[2 * i + 1]);
  }
  return output_close(&f);
}

/* ---- summary --------------------------------------------------------------------------------- */

/* The largest force from one time (s) to another, less all that is faster than 10 Hz, and when; of
 * short steps one every hundredth of the window, within which the smoothed force hardly changes. */
static double find_peak(const seawall *w, double from, double to, double *at) {
  const int64_t end = to < (double)w->forces * w->s.dt ? (int64_t)(to / w->s.dt) : w->forces;
  const int64_t stride = (int64_t)fmax(1.0, 0.01 * SEAWALL_WINDOW / w->s.dt);
  double most = NAN;
  *at = NAN;
  for (int64_t k = (int64_t)(fmax(from, 0.0) / w->s.dt); k < end; k += stride) {
    const double force = seawall_smooth(w, k);
    if (!(force <= most)) most = force, *at = (double)(k + 1) * w->s.dt;
  }
  return most;
}

static double crest_force(const seawall *w, double H) {
  const double k = waves_number(w->s.period, w->s.depth);
  return isnan(H) ? NAN : waves_sainflou(k, w->s.depth, H, 1);
}

/* The force in time against linear potential flow: standard deviations after the piston's jerk. */
static void compare_linear(output *f, const seawall *w) {
  double sum[2] = {0.0, 0.0}, square[2] = {0.0, 0.0}, deviation[2];
  int64_t count = 0;
  for (int64_t k = 0; k < w->samples; k++) {
    if (w->sample[k].t <= SEAWALL_IMPULSE) continue;
    const double value[2] = {w->sample[k].force - w->linear[0], w->linear[k] - w->linear[0]};
    for (int i = 0; i < 2; i++) sum[i] += value[i], square[i] += value[i] * value[i];
    count++;
  }
  for (int i = 0; i < 2; i++)
    deviation[i] = sqrt(fmax(square[i] - sum[i] * sum[i] / (double)count, 0.0) / (double)count);
  JSON_NUMBERS(f, {"force_deviation", deviation[0]}, {"force_deviation_linear", deviation[1]});
  if (deviation[1] > 0.0)
    printf("force of the waves in time, standard deviation %.2f N; linear potential flow in this "
           "tank %.2f N (%+.1f %%)\n",
           deviation[0], deviation[1], 100.0 * (deviation[0] / deviation[1] - 1.0));
}

static void summarise(output *f, const seawall *w, const sainflou *h) {
  const seawall_settings *s = &w->s;
  const seawall_sample *at = &w->look.at;
  const bool crest = at->t >= SEAWALL_LOOK - 0.5 * s->sample;
  JSON_NUMBERS(f, {"force_at_516", crest ? at->force : NAN},
               {"moment_at_516", crest ? at->moment : NAN},
               {"deflection_at_516", crest ? at->deflection : NAN},
               {"level_at_516", crest ? at->level : NAN});
  double peak_at, crest_at;
  const double peak = find_peak(w, SEAWALL_IMPULSE, INFINITY, &peak_at); /* after the jerk */
  const double most =
      find_peak(w, SEAWALL_LOOK - 0.25 * s->period, SEAWALL_LOOK + 0.25 * s->period, &crest_at);
  JSON_NUMBERS(f,
               {"force_10_hz_at_516", crest ? seawall_smooth(w, llround(at->t / s->dt) - 1) : NAN},
               {"force_crest", crest ? most : NAN}, {"force_crest_time", crest ? crest_at : NAN},
               {"force_peak", peak}, {"force_peak_time", peak_at}, {"sainflou_height", h->harmonic},
               {"sainflou_force", crest_force(w, h->harmonic)}, {"sainflou_height_level", h->level},
               {"sainflou_force_level", crest_force(w, h->level)},
               {"force_still", 0.5 * WAVES_DENSITY * WAVES_G * s->depth * s->depth});
  const seawall_sample *last = &w->sample[w->samples - 1];
  JSON_NUMBERS(f, {"force_end", last->force}, {"moment_end", last->moment},
               {"deflection_end", last->deflection});
  if (crest)
    printf("t = %.2f s: force %.1f N, moment %.1f N m about the bed, wall moves by %.4g m\n", at->t,
           at->force, at->moment, at->deflection);
  if (!isnan(h->harmonic))
    printf("Sainflou for the first harmonic of the level at the wall, the period before t = %.2f s "
           "(H = %.3f m): %.1f N\n",
           at->t, h->harmonic, crest_force(w, h->harmonic));
  if (!isnan(h->level))
    printf(
        "Sainflou for the level itself, the jet of a breaking wave included (H = %.3f m): %.1f N\n",
        h->level, crest_force(w, h->level));
  compare_linear(f, w);
  if (!isnan(peak)) printf("largest force below 10 Hz %.1f N at %.3f s\n", peak, peak_at);
}

static bool write_summary(app *a, const seawall *w, const sainflou *h) {
  output f;
  mps_fluid_report report;
  mps_elastic_report factor;
  if (!app_check(a, mps_fluid_get_report(w->fluid, &report)) ||
      !app_check(a, mps_elastic_get_report(w->wall.solver, &factor)) ||
      !summary_open(&f, a, w->s.out))
    return false;
  json_integer(&f, "particles", seawall_paper_particles(&w->s));
  json_integer(&f, "particles_water", mps_particles_count(w->water));
  json_integer(&f, "particles_structure", mps_particles_count(w->wall.set));
  json_integer(&f, "steps", mps_fluid_steps(w->fluid));
  json_number(&f, "time", mps_fluid_time(w->fluid));
  summarise(&f, w, h);
  json_integer(&f, "collisions", report.collisions);
  json_integer(&f, "limited", report.limited);
  json_integer(&f, "pushed", report.pushed);
  mps_coupling_report both;
  if (w->s.coupled && mps_coupling_get_report(w->both.coupling, &both) == MPS_OK)
    json_number(&f, "solutions_a_step", (double)both.all_repeats / fmax((double)both.steps, 1.0));
  json_end(&f);
  return output_close(&f);
}

static bool close_series(app *a, seawall *w) {
  return (!w->series || app_check(a, mps_recorder_close(&w->series))) &&
         (!w->wall_series || app_check(a, mps_recorder_close(&w->wall_series)));
}

#define SMALL                                                                                      \
  0.05 /* of the wall's height: displacements for which its theory is one of small ones */

/* Violations of the model's assumptions. */
static void warn_of_limits(app *a, const seawall *w) {
  const double height = w->s.wall_height;
  const seawall_sample *bent = w->sample, *high = w->sample;
  for (int64_t k = 1; k < w->samples; k++) {
    const seawall_sample *p = &w->sample[k];
    if (fabs(p->deflection) > fabs(bent->deflection)) bent = p;
    if (isnan(high->level) || p->level > high->level) high = p;
  }
  if (fabs(bent->deflection) > SMALL * height)
    app_warn(
        a,
        "the wall's crest moves by %.3g m at t = %.3f s, more than %g of its height of %g m: its "
        "displacements are computed as small ones",
        bent->deflection, bent->t, SMALL, height);
  if (w->s.depth + high->level > height)
    app_warn(
        a,
        "the water at the wall is %.3f m high at t = %.3f s, the wall %g m: it would go over its "
        "crest, which the computed one does not have",
        w->s.depth + high->level, high->t, height);
}

static bool find_linear(app *a, seawall *w) {
  const double still = 0.5 * WAVES_DENSITY * WAVES_G * w->s.depth * w->s.depth;
  closed_tank c = {.length = w->s.length, .depth = w->s.depth, .mass = NAN, .piston = w->motion};
  closed_tank_begin(&c);
  w->linear = calloc((size_t)w->samples, sizeof *w->linear);
  if (!w->linear) return app_no_memory(a);
  for (int64_t k = 0; k < w->samples; k++) {
    if (!app_check(a, closed_tank_advance(&c, w->sample[k].t))) return false;
    w->linear[k] = still + closed_tank_force(&c);
  }
  return true;
}

bool seawall_write(app *a, seawall *w) {
  const sainflou h = find_heights(w);
  warn_of_limits(a, w);
  if (!find_linear(a, w)) return false;
  if (!write_force(a, w) || !write_pressure(a, w, h.harmonic) || !write_wall(a, w) ||
      !close_series(a, w) || !write_summary(a, w, &h) || !seawall_draw(a, w, h.harmonic))
    return false;
  app_tell_results(a, w->s.out);
  return true;
}
