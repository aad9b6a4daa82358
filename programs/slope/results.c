/* results.c - tables and pictures of mps-slope. SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/area.h"
#include "common/plot.h"
#include "slope.h"

#include <math.h>
#include <stdio.h>

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
  if (!output_open(&f, a, s->out, "trials.csv")) return false;
  csv_header(&f, "trial,factor,phi_deg,cohesion_Pa,moved_over_height,t_s,failed,speed?");
  for (int k = 0; k < ended(sim); k++) {
    const trial *t = &sim->trial[k];
    const double degree = 180.0 / 3.14159265358979323846;
    const double row[] = {k + 1.0,
                          t->factor,
                          atan(tan(s->phi / degree) / t->factor) * degree,
                          s->cohesion / t->factor,
                          t->moved[t->rows - 1] / s->height,
                          t->t[t->rows - 1],
                          t->failed,
                          s->runout ? NAN : slope_speed(s, t, (int)fmin(6, t->rows - 1))};
    csv_row(&f, 8, row);
  }
  return output_close(&f);
}

static bool write_motion(app *a, const simulation *sim) {
  output f;
  if (!output_open(&f, a, sim->s.out, "motion.csv")) return false;
  csv_header(&f, "trial,factor,t_s,moved_over_height");
  for (int k = 0; k <= sim->now; k++) {
    const trial *t = &sim->trial[k];
    for (int i = 0; i < t->rows; i++) {
      const double row[] = {k + 1.0, t->factor, t->t[i], t->moved[i] / sim->s.height};
      csv_row(&f, 4, row);
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
  json_number(&f, "h", s->h);
  sand_write(&f, &s->voids, s->psi);
  json_number(&f, "c_over_gamma_H", s->cohesion / (s->density * s->gravity * s->height));
  json_integer(&f, "trials", ended(sim));
  json_number(&f, "factor_of_safety", factor);
  json_number_if(&f, stands > 0.0, "stands", stands);
  json_number(&f, "fails", fails);
  json_number(&f, "young", slope_young(s));
  json_number(&f, "flows", s->runout ? NAN : SLOPE_FLOWS);
  json_number(&f, "stability_number", stability_number(s, factor));
  json_number_if(&f, slope_pool(s) > 0.0, "pool", slope_pool(s));
  slope_circle circle, pole;
  const comparison spirals = compare_spirals(sim, &pole), circles = compare_circles(sim, &circle);
  const bool fails_so = compare_holds(&circles);
  json_comparison(&f, "log_spirals", &spirals);
  json_number(&f, "log_spirals_davis", davis_factor(s));
  json_comparison(&f, "slip_circles", &circles);
  json_number_if(&f, fails_so, "circle_x", circle.x + s->crest);
  json_number_if(&f, fails_so, "circle_y", circle.y + s->base);
  json_number_if(&f, fails_so, "circle_radius", circle.radius);
  json_number_if(&f, s->runout && ended(sim) > 0, "runout", sim->front);
  json_number_if(&f, s->runout && ended(sim) > 0, "lost_behind_crest", sim->lost);
  json_end(&f);
  return output_close(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static bool draw_motion(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  output f;
  if (!plot_open(&f, a, s->out, "motion", 1000, 640)) return false;
  output_text(&f,
              "set title \"%s of a slope, strength divided by F\\n{/*0.85 H = %g m, 1 : %g, "
              "{/Symbol f} = %g°, c/{/Symbol g}H = %.3g, h = %g m}\"\n"
              "set xlabel 'time (s)'\nset ylabel 'displacement over the height'\n"
              "set key outside right\nset yrange [0:*]\nplot ",
              s->runout ? "Run-out" : "Motion", s->height, s->slope, s->phi,
              s->cohesion / (s->density * s->gravity * s->height), s->h);
  for (int k = 0; k <= sim->now; k++)
    output_text(&f,
                "%s'motion.csv' every ::1 using ($1 == %d ? $3 : 1/0):4 with lines linewidth 2 "
                "linecolor rgb '%s' dashtype %d title 'F = %.3f'",
                k > 0 ? ", \\\n  " : "", k + 1, sim->trial[k].failed ? "#c0392b" : "#1f4e8c",
                1 + k % 5, sim->trial[k].factor);
  output_text(&f, "\n");
  return plot_close(&f, s->out, "motion");
}

static double greatest(const mpm_snapshot *shot, int column) {
  double most = 0.0;
  for (int64_t k = 0; k < shot->count; k++) most = fmax(most, shot->row[3 * k + column]);
  return most;
}

/* The water table, and the level of the pool before a drawdown. */
static void draw_water(output *f, const settings *s, double wide) {
  static const char arrow[] = "set arrow from %.9g,%.9g to %.9g,%.9g nohead linewidth 2 linecolor "
                              "rgb '#2e86c1'%s front\n";
  if (!isnan(s->drawdown))
    output_text(f, arrow, 0.0, s->drawdown + s->base, wide, s->drawdown + s->base,
                " dashtype '..'");
  if (s->points == 0 && isnan(s->table)) return;
  double from = 0.0;
  for (int64_t k = 0; k <= s->points; k++) {
    const double to = k < s->points ? s->line[2 * k] + s->crest : wide;
    if (!(to > from && to <= wide)) continue;
    output_text(f, arrow, from, slope_table(s, from - s->crest) + s->base, to,
                slope_table(s, to - s->crest) + s->base, "");
    from = to;
  }
}

static bool draw_slope(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  const double foot = s->crest + s->slope * s->height, top = s->base + s->height;
  const double wide = fmax(greatest(&sim->shot, 0) + s->h, foot + fmax(s->toe, 0.1 * s->height));
  const double high = 1.1 * top;
  const area_def def = {.spacing = s->h / sqrt((double)s->ppc),
                        .slit = AREA_SLIT_SHEARED,
                        .upper = {wide, high},
                        .walled = true,
                        .side = AREA_SIDE};
  area image;
  if (!mpm_snapshots_image(a, s->out, "slope.bin", 1, &sim->shot, &def, &image)) return false;
  output f;
  const int height = (int)fmin(900.0, fmax(380.0, 1000.0 * high / wide + 150.0));
  if (!plot_open(&f, a, s->out, "slope", 1100, height)) return false;
  output_text(&f,
              "set title 'Plastic strain (-) at t = %.2f s'\nset xlabel 'x (m)'\n"
              "set ylabel 'y (m)'\nset size ratio -1\nunset grid\n"
              "set palette defined (0 '#f3e3bd', 0.3 '#c98f4a', 1 '#5b2c12')\n"
              "set xrange [0:%.9g]\nset yrange [0:%.9g]\n",
              sim->shot.time, wide, high);
  output_text(&f, "set arrow from %.9g,%.9g to %.9g,%.9g nohead dashtype '--' front\n", s->crest,
              top, foot, s->base);
  draw_water(&f, s, wide);
  plot_colours(&f, 0.0, 0.5 * greatest(&sim->shot, 2), image.least, image.most);
  output_text(&f, "plot ");
  area_plot(&f, "slope.bin", &image, 1.0);
  output_text(&f, "\n");
  return plot_close(&f, s->out, "slope");
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
