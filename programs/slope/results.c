/* results.c - tables and pictures of mps-slope. SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/area.h"
#include "common/plot.h"
#include "slope.h"

#include <math.h>
#include <stdio.h>

#define BELOW 0.95 /* of the factor with Davis' strength: less is not credible */

/* Trials that have ended: the last one where the run has. */
static int ended(const simulation *sim) { return sim->now + sim->trial[sim->now].ended; }

/* c/(rho g H) over the factor's own: N = F gamma H/c. */
static double stability_number(const settings *s, double factor) {
  return factor * s->density * s->gravity * s->height / s->cohesion;
}

static double found_factor(const simulation *sim) {
  double stands, fails;
  const int trials = ended(sim);
  if (!isnan(sim->s.factor) || !slope_found(sim, trials)) return NAN;
  slope_bracket(sim, trials, &stands, &fails);
  return sqrt(stands * fails);
}

/* Of slip lines, along which the ground has its strength everywhere at once. */
static comparison compare_slips(const simulation *sim, const char *source, double factor) {
  comparison c = compare_with(source, found_factor(sim), factor);
  compare_require(&c, !sim->s.runout, "in a run-out the strength softens");
  compare_require(&c, isfinite(factor), "none fails in this ground");
  compare_require(&c, factor > 0.0, "no strength holds a vertical face without cohesion");
  return c;
}

static comparison compare_spirals(const simulation *sim, slope_circle *pole) {
  return compare_slips(sim, "logarithmic spirals",
                       sim->s.runout ? NAN : slope_spirals(&sim->s, false, pole));
}

/* NaN where the flow is associated, or there is none. */
static double davis_factor(const settings *s) {
  slope_circle pole;
  const double factor = s->runout || s->psi == s->phi ? NAN : slope_spirals(s, true, &pole);
  return isfinite(factor) ? factor : NAN;
}

static comparison compare_circles(const simulation *sim, slope_circle *circle) {
  return compare_slips(sim, "slip circles", sim->s.runout ? NAN : slope_circles(&sim->s, circle));
}

/* ---- tables ---------------------------------------------------------------------------------- */

static bool write_trials(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  output f;
  if (!csv_open(&f, a, s->out, "trials.csv",
                "trial,factor,phi_deg,cohesion_Pa,moved_over_height,t_s,failed,speed?"))
    return false;
  for (int k = 0; k < ended(sim); k++) {
    const trial *t = &sim->trial[k];
    const double degree = 180.0 / 3.14159265358979323846;
    CSV_LINE(&f, k + 1.0, t->factor, atan(tan(s->phi / degree) / t->factor) * degree,
             s->cohesion / t->factor, t->moved[t->rows - 1] / s->height, t->t[t->rows - 1],
             t->failed, s->runout ? NAN : slope_speed(s, t, (int)fmin(6, t->rows - 1)));
  }
  return output_close(&f);
}

static bool write_motion(app *a, const simulation *sim) {
  output f;
  if (!csv_open(&f, a, sim->s.out, "motion.csv", "trial,factor,t_s,moved_over_height"))
    return false;
  for (int k = 0; k <= sim->now; k++) {
    const trial *t = &sim->trial[k];
    for (int i = 0; i < t->rows; i++) {
      CSV_LINE(&f, k + 1.0, t->factor, t->t[i], t->moved[i] / sim->s.height);
    }
  }
  return output_close(&f);
}

static bool write_summary(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  const double factor = found_factor(sim);
  double stands, fails;
  output f;
  if (!mpm_model_summary(a, &sim->m, s->out, &f)) return false;
  slope_bracket(sim, ended(sim), &stands, &fails);
  json_number(&f, "cell", s->h);
  sand_write(&f, &s->voids, s->psi);
  json_number(&f, "c_over_gamma_H", s->cohesion / (s->density * s->gravity * s->height));
  json_integer(&f, "trials", ended(sim));
  JSON_NUMBERS(&f, {"factor_of_safety", factor}, {"stands", stands > 0.0 ? stands : NAN},
               {"fails", fails}, {"young", slope_young(s)},
               {"flows", s->runout ? NAN : SLOPE_FLOWS},
               {"stability_number", stability_number(s, factor)},
               {"pool", slope_pool(s) > 0.0 ? slope_pool(s) : NAN});
  slope_circle circle, pole;
  const comparison spirals = compare_spirals(sim, &pole), circles = compare_circles(sim, &circle);
  const bool fails_so = compare_holds(&circles);
  json_comparison(&f, "log_spirals", &spirals);
  json_number(&f, "log_spirals_davis", davis_factor(s));
  json_comparison(&f, "slip_circles", &circles);
  JSON_NUMBERS(&f, {"circle_x", fails_so ? circle.x + s->crest : NAN},
               {"circle_y", fails_so ? circle.y + s->base : NAN},
               {"circle_radius", fails_so ? circle.radius : NAN},
               {"runout", s->runout && ended(sim) > 0 ? sim->front : NAN},
               {"lost_behind_crest", s->runout && ended(sim) > 0 ? sim->lost : NAN});
  json_end(&f);
  return output_close(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static bool draw_motion(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  output f;
  if (!plot_begin(&f, a, s->out, "motion")) return false;
  output_text(
      &f,
      "first = '%s of a slope, strength divided by F'\nsecond = 'H = %g m, 1 : %g, {/Symbol "
      "f} = %g°, c/{/Symbol g}H = %.3g, h = %g m'\n"
      "trials = %d\narray factor[trials]; array failed[trials]\n",
      s->runout ? "Run-out" : "Motion", s->height, s->slope, s->phi,
      s->cohesion / (s->density * s->gravity * s->height), s->h, sim->now + 1);
  for (int k = 0; k <= sim->now; k++)
    output_text(&f, "factor[%d] = %.9g; failed[%d] = %d\n", k + 1, sim->trial[k].factor, k + 1,
                sim->trial[k].failed);
  return plot_end(&f, s->out, "motion", "slope/motion");
}

static void draw_line(output *f, double x0, double y0, double x1, double y1, const char *look) {
  output_text(f, "set arrow from %.9g,%.9g to %.9g,%.9g nohead front %s; ", x0, y0, x1, y1, look);
}

/* The water table, and the level of the pool before a drawdown. */
static void draw_water(output *f, const settings *s, double wide) {
  static const char look[] = "linewidth 2 linecolor rgb \"#2e86c1\"";
  const double pool = s->drawdown + s->base;
  if (!isnan(pool))
    draw_line(f, 0.0, pool, wide, pool, "linewidth 2 linecolor rgb \"#2e86c1\" dashtype \"..\"");
  if (s->points == 0 && isnan(s->table)) return;
  double from = 0.0;
  for (int64_t k = 0; k <= s->points; k++) {
    const double to = k < s->points ? s->line[2 * k] + s->crest : wide;
    if (!(to > from && to <= wide)) continue;
    draw_line(f, from, slope_table(s, from - s->crest) + s->base, to,
              slope_table(s, to - s->crest) + s->base, look);
    from = to;
  }
}

static bool draw_slope(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  const double foot = s->crest + s->slope * s->height, top = s->base + s->height;
  const double wide =
      fmax(mpm_snapshot_most(&sim->shot, 0) + s->h, foot + fmax(s->toe, 0.1 * s->height));
  const area_def def = {.spacing = s->h / sqrt((double)s->ppc),
                        .slit = AREA_SLIT_SHEARED,
                        .upper = {wide, 1.1 * top},
                        .walled = true,
                        .side = AREA_SIDE};
  area image;
  output f;
  if (!mpm_snapshots_image(a, s->out, "slope.bin", 1, &sim->shot, &def, &image) ||
      !plot_begin(&f, a, s->out, "slope"))
    return false;
  area_set(&f, "slope.bin", &def, 1, &image, 1.0);
  output_text(&f,
              "titles[1] = 'Plastic strain (-) at t = %.2f s'; x_name = 'x (m)'; y_name = 'y (m)'\n"
              "cb_name = ''; palette = 'sand'; cb_least = 0; cb_most = %.9g\n"
              "cover(k) = '",
              sim->shot.time, 0.5 * mpm_snapshot_most(&sim->shot, 2));
  draw_line(&f, s->crest, top, foot, s->base, "dashtype \"--\"");
  draw_water(&f, s, wide);
  output_text(&f, "'\n");
  return plot_end(&f, s->out, "slope", "maps");
}

/* ---- the end --------------------------------------------------------------------------------- */

static void print(const simulation *sim) {
  const settings *s = &sim->s;
  const int trials = ended(sim);
  const trial *last = &sim->trial[sim->now];
  double stands, fails;
  slope_bracket(sim, trials, &stands, &fails);
  if (trials == 0)
    printf("no trial has ended\n");
  else if (s->runout)
    printf("%s: front %.3g m beyond the toe, %.3g m lost behind the crest\n",
           sim->kinetic <= 1e-3 * sim->peak ? "at rest" : "still moving", sim->front, sim->lost);
  else if (!isnan(s->factor))
    printf("strength divided by %g: the slope %s\n", s->factor, last->failed ? "fails" : "stands");
  else if (isnan(found_factor(sim)))
    printf("no factor of safety yet: above %.4g, below %.4g\n", stands, fails);
  else
    printf("factor of safety %.3f: stands with the strength divided by %.4g, fails with %.4g\n",
           found_factor(sim), stands, fails);
  if (slope_pool(s) > 0.0) printf("a pool stands %.4g m above the toe\n", slope_pool(s));
  if (trials > 0 && !s->runout)
    printf(
        "by loss of equilibrium: 1 %% of the ground does not come to rest, faster than %g g H/c\n",
        SLOPE_FLOWS);
  slope_circle circle;
  const comparison spirals = compare_spirals(sim, &circle), circles = compare_circles(sim, &circle);
  if (compare_holds(&spirals)) {
    printf("logarithmic spirals: %.3f", spirals.reference);
    if (!isnan(spirals.value)) printf(" (%+.1f %%)", 100.0 * compare_error(&spirals));
    if (!isnan(davis_factor(s)))
      printf(", at least %.3f as --psi is below --phi (Davis)", davis_factor(s));
  }
  if (compare_holds(&circles))
    printf("%sslip circles (Bishop's simplified method): %.3f", compare_holds(&spirals) ? ", " : "",
           circles.reference);
  if (compare_holds(&spirals) || compare_holds(&circles)) printf("\n");
  compare_tell(&spirals);
  sand_print(&s->voids, s->psi);
}

/* Spirals bound what stands, whatever the ground dilates. */
static void warn_of_bound(app *a, const simulation *sim) {
  slope_circle pole;
  const comparison spirals = compare_spirals(sim, &pole);
  const trial *last = &sim->trial[sim->now];
  const bool stands = !isnan(sim->s.factor) && ended(sim) > 0 && !last->failed;
  if (compare_holds(&spirals))
    compare_bound(a, "the factor of safety", stands ? last->factor : spirals.value, spirals.source,
                  spirals.reference);
  const double davis = davis_factor(&sim->s);
  if (spirals.value < BELOW * davis)
    app_warn(a,
             "the factor of safety is %.0f %% below that of spirals with the strength of Davis, "
             "%.3f, of which ground does not fall short: look at motion.png, take another --cell",
             100.0 * (1.0 - spirals.value / davis), davis);
}

bool slope_finish(app *a, void *user) {
  simulation *sim = user;
  warn_of_bound(a, sim); /* before the summary, which lists it */
  if (sim->s.runout && sim->lost > sim->s.crest - sim->s.h)
    app_warn(a, "the slope has moved up to the end of its ground: take a longer --crest");
  if (!write_trials(a, sim) || !write_motion(a, sim)) return false;
  if (!mpm_snapshots_write(a, sim->s.out, "particles.csv", "plastic_strain", 1, &sim->shot))
    return false;
  if (!write_summary(a, sim) || !draw_motion(a, sim) || !draw_slope(a, sim)) return false;
  app_tell_results(a, sim->s.out);
  print(sim);
  return true;
}
