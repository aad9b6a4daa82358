/* results.c - capacity, tables and pictures of mps-footing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/area.h"
#include "common/compare.h"
#include "common/plot.h"
#include "footing.h"

#include <math.h>
#include <stdio.h>

#define PI 3.14159265358979323846
#define GROWTH 0.1   /* of the pressure, over the second half of the path: more is no capacity */
#define SUNK 0.15    /* of a circle's radius: deeper, pressures depend on the cell by a tenth */
#define STEEP 41.0   /* degrees, of friction: above, weight bears less than it should */
#define FASTEST 0.08 /* of the capacity: v (rho G)^1/2, at which inertia adds some 5 % */
#define DEEPEST 0.05 /* of the half width: limit analysis knows the ground's first shape only */

/* Pa, of the run of ground in its first shape; NaN: it has not ended. */
typedef struct capacity {
  double last;              /* mean over the last fifth of the path */
  double undeformed, slope; /* of the line through the path's second half: at no settlement, and per
                               mm */
  double growth;            /* of the pressure, over the second half of the path */
  double most;              /* largest pressure of the path */
  double deformed;          /* `last` of the ground as it is, where that is another run */
  double associated;        /* of associated flow, beside `limits.davis` */
  footing_limits limits;    /* NaN where they are not of this run */
  comparison limit;         /* of `last` with the exact one */
} capacity;

static bool is_whole(const simulation *sim) { return footing_rows(sim) == FOOTING_SAMPLES; }

/* Rows of the first run, and their number. */
static const footing_row *first_rows(const simulation *sim, int *count) {
  const bool kept = sim->now == FOOTING_DEFORMED;
  *count = kept ? sim->undeformed_rows : footing_rows(sim);
  return kept ? sim->undeformed : sim->course.rows.row;
}

static double mean_of_last(const footing_row *row, int count) {
  const int fifth = count < 5 ? 1 : count / 5;
  double sum = 0.0;
  for (int k = count - fifth; k < count; k++) sum += row[k].q / fifth;
  return sum;
}

static void fit_path(const footing_row *row, int count, capacity *c) {
  const int first = count / 2, n = count - first;
  double x = 0.0, q = 0.0, xx = 0.0, xq = 0.0;
  for (int k = first; k < count; k++) x += row[k].path * 1e3 / n, q += row[k].q / n;
  for (int k = first; k < count; k++) {
    const double dx = row[k].path * 1e3 - x;
    xx += dx * dx;
    xq += dx * (row[k].q - q);
  }
  c->last = mean_of_last(row, count), c->most = 0.0;
  for (int k = 0; k < count; k++) c->most = fmax(c->most, row[k].q);
  c->slope = xq / xx;
  c->undeformed = q - c->slope * x;
  c->growth = c->slope * (row[count - 1].path - row[first].path) * 1e3 / c->last;
}

static bool has_fallen(const capacity *c) { return c->last < (1.0 - GROWTH) * c->most; }

/* Of a rigid, perfectly plastic ground, slowly, before its shape changes. */
static comparison compare_limit(const simulation *sim, const capacity *c) {
  const settings *s = &sim->s;
  const footing_pace *p = &s->pace[FOOTING_UNDEFORMED];
  const footing_limits *l = &c->limits;
  const double inertia = p->rate * sqrt(s->density * p->young / (2.0 + 2.0 * s->poisson));
  const double width = footing_is_whole(s) ? 1.0 - s->eccentricity / s->half_width : 1.0;
  const double most = (isnan(l->exact) ? fmax(l->smooth, l->rough) : l->exact) / width;
  comparison out = compare_with(l->source, c->last, l->exact);
  compare_require(&out, s->top == 0.0,
                  "ground of two layers is known by bounds alone, not by an exact capacity");
  compare_require(&out, isnan(l->davis),
                  "--psi is below --phi: the exact capacity is of associated flow");
  compare_require(&out, p->settlement <= DEEPEST * s->half_width,
                  "the footing is pressed by %.2g of its half width, and the capacity is of ground "
                  "in its first shape",
                  p->settlement / s->half_width);
  compare_require(&out, !(c->growth > GROWTH),
                  "the pressure grows by %.0f %% over the second half of the path: the ground has "
                  "not reached its bearing capacity",
                  100.0 * c->growth);
  compare_require(&out, !(inertia > FASTEST * most),
                  "the footing moves at %g mm/s: the inertia of the ground, v (rho G)^1/2, is %.2g "
                  "of the capacity",
                  1e3 * p->rate, inertia / most);
  compare_require(&out, !has_fallen(c),
                  "the pressure falls by %.0f %% from its largest, %.4g kPa: the ground has failed "
                  "before the end of the path, over whose last fifth the capacity is taken",
                  100.0 * (1.0 - c->last / c->most), 1e-3 * c->most);
  return out;
}

static capacity measure(const simulation *sim) {
  const settings *s = &sim->s;
  capacity c = {NAN, NAN, NAN, NAN, NAN, NAN, footing_scale(s), footing_find_limits(s), {0}};
  int count;
  const footing_row *row = first_rows(sim, &count);
  if (count == FOOTING_SAMPLES) fit_path(row, count, &c);
  if (sim->now == FOOTING_DEFORMED && is_whole(sim))
    c.deformed = mean_of_last(footing_row_of(sim, 0), FOOTING_SAMPLES);
  c.limit = compare_limit(sim, &c);
  if (c.limit.reason[0]) c.limits.smooth = c.limits.rough = c.limits.exact = NAN;
  compare_require(&c.limit, !isnan(c.limits.exact),
                  "it is of a smooth or a rough base, between which the friction of this one, %g, "
                  "lies",
                  s->mu);
  return c;
}

/* The coefficients of a capacity q, NaN where nothing of the kind bears: over the cohesion, that of
 * the upper layer where there are two, the surcharge, and rho g B/2. */
typedef struct coefficients {
  double c, q, gamma;
} coefficients;

static coefficients divide(const settings *s, double q) {
  const double cohesion = s->top > 0.0 ? s->top_cohesion : s->cohesion;
  const double weight = s->density * s->gravity * s->half_width;
  return (coefficients){cohesion > 0.0 ? q / cohesion : NAN,
                        s->surcharge > 0.0 ? q / s->surcharge : NAN,
                        weight > 0.0 ? q / weight : NAN};
}

/* ---- tables ---------------------------------------------------------------------------------- */

static bool write_rows(app *a, const settings *s, const char *name, const footing_row *row,
                       int count) {
  output f;
  if (!csv_open(&f, a, s->out, name, "settlement_mm,q_kPa,q_over_c?")) return false;
  for (int k = 0; k < count; k++) {
    CSV_LINE(&f, row[k].path * 1e3, row[k].q * 1e-3, divide(s, row[k].q).c);
  }
  return output_close(&f);
}

static bool write_pressure(app *a, const simulation *sim) {
  int count;
  const footing_row *row = first_rows(sim, &count);
  return write_rows(a, &sim->s, "pressure.csv", row, count) &&
         (sim->now != FOOTING_DEFORMED ||
          write_rows(a, &sim->s, "pressure_deformed.csv", sim->course.rows.row, footing_rows(sim)));
}

static bool write_particles(app *a, const settings *s, const mpm_snapshot *shot) {
  output f;
  if (!csv_open(&f, a, s->out, "particles.csv", "x_m,y_m,plastic_strain")) return false;
  for (int64_t k = 0; k < shot->count; k++) csv_row(&f, 3, shot->row + 3 * k);
  return output_close(&f);
}

static bool write_summary(app *a, const simulation *sim, const capacity *c) {
  const settings *s = &sim->s;
  output f;
  if (!mpm_model_summary(a, &sim->m, s->out, &f)) return false;
  json_text(&f, "model", s->model == VON_MISES ? "vonmises" : "druckerprager");
  json_text(&f, "shape", s->shape == CIRCLE ? "circle" : "strip");
  JSON_NUMBERS(&f, {"cell", s->h}, {"flip_time", s->flip_time});
  sand_write(&f, &s->voids, s->model == DRUCKER_PRAGER ? s->psi : 0.0);
  json_number(&f, "friction", s->mu);
  if (s->contact == MPS_CONTACT_METHOD_IMPULSE) json_number(&f, "corner", s->corner);
  if (s->inset > 0.0) json_number(&f, "inset", s->inset);
  json_number(&f, "rate", s->rate);
  if (footing_is_whole(s)) {
    mps_body_state body;
    json_number(&f, "eccentricity", s->eccentricity);
    if (mps_body_get_state(sim->m.body[0], &body) == MPS_OK)
      json_number(&f, "turned", body.rotation[2] * 180.0 / PI); /* degrees, anticlockwise */
  }
  const coefficients n = divide(s, c->last);
  json_number(&f, "q", c->last);
  json_comparison(&f, "q_exact", &c->limit);
  JSON_NUMBERS(&f, {"q_exact_smooth", c->limits.smooth}, {"q_exact_rough", c->limits.rough},
               {"q_davis", c->limits.davis}, {"q_deformed", c->deformed},
               {"young_undeformed", s->pace[FOOTING_UNDEFORMED].young},
               {"rate_undeformed", s->pace[FOOTING_UNDEFORMED].rate}, {"q_over_c", n.c},
               {"q_over_c_undeformed", divide(s, c->undeformed).c},
               {"q_over_c_per_mm", divide(s, c->slope).c}, {"q_over_surcharge", n.q},
               {"q_over_weight", n.gamma});
  json_end(&f);
  return output_close(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static bool draw_pressure(app *a, const simulation *sim, const capacity *c) {
  const settings *s = &sim->s;
  const bool two = sim->now == FOOTING_DEFORMED, circle = s->shape == CIRCLE;
  const footing_limits *l = &c->limits;
  const bool one = l->smooth == l->rough; /* the base does not matter */
  return plot_draw(
      a, s->out, "pressure", "footing/pressure",
      "first = '%s footing on %s ground'\nsecond = 'h = %g m, %s %g m, %g mm/s, friction of the "
      "base "
      "%g'\nfile = '%s'; undeformed = %.9g; exact = %.9g; source = '%s'\nsmooth = %.9g; rough = "
      "%.9g; smooth_source = 'smooth base, %s'; rough_source = 'rough base, %s'",
      circle ? "Circular" : "Strip", s->model == VON_MISES ? "cohesive" : "frictional", s->h,
      circle ? "radius" : "half width", s->half_width, 1e3 * s->rate, s->mu,
      two ? "pressure_deformed.csv" : "pressure.csv", two ? 1e-3 * c->last : NAN,
      one ? 1e-3 * l->exact : NAN, l->source, one || l->exact == l->rough ? NAN : 1e-3 * l->smooth,
      one || l->exact == l->smooth ? NAN : 1e-3 * l->rough, circle ? "Shield" : "exact",
      circle ? "Eason, Shield" : "exact");
}

/* `user`: the corner of the footing, m. */
static bool in_footing(const void *user, double x, double y) {
  const double *corner = user;
  return fabs(x) < corner[0] && y > corner[1];
}

/* The mechanism reaches farther in frictional ground. */
static bool draw_bands(app *a, const simulation *sim, const mpm_snapshot *shot) {
  const settings *s = &sim->s;
  const double wide = s->model == VON_MISES ? 5.0 : 9.0, top = s->depth + 0.3 * s->half_width;
  const double right = fmin(s->width, wide * s->half_width);
  const double base[2] = {s->half_width,
                          s->depth - footing_row_of(sim, footing_rows(sim) - 1)->path};
  const area_def def = {
      .spacing = mps_particles_spacing(sim->m.particles),
      .slit = AREA_SLIT_SHEARED,
      .lower = {footing_is_whole(s) ? -right : 0.0, fmax(0.0, s->depth - 3.0 * s->half_width)},
      .upper = {right, top},
      .walled = true,
      .side = AREA_SIDE,
      .solid = in_footing,
      .user = base};
  area image;
  output f;
  if (!mpm_snapshots_image(a, s->out, "shear_bands.bin", 1, shot, &def, &image) ||
      !plot_begin(&f, a, s->out, "shear_bands"))
    return false;
  area_set(&f, "shear_bands.bin", &def, 1, &image, 1.0);
  output_text(&f,
              "titles[1] = 'Plastic strain (-)'; x_name = 'x (m)'; y_name = 'y (m)'; cb_name = ''; "
              "palette = 'blues'\n"
              "cb_least = 0; cb_most = %.9g\ncover(k) = 'set object 1 rectangle from %.9g,%.9g to "
              "%.9g,%.9g fillcolor rgb \"#888888\" fillstyle solid front'\n",
              0.25 * mpm_snapshot_most(shot, 2), fmax(def.lower[0], -s->half_width), base[1],
              s->half_width, top);
  return plot_end(&f, s->out, "shear_bands", "maps");
}

/* ---- the end --------------------------------------------------------------------------------- */

/* N_c, N_q or N_gamma where nothing else bears. */
static void print_coefficients(const settings *s, double q) {
  const coefficients n = divide(s, q);
  const int kinds = !isnan(n.c) + !isnan(n.q) + !isnan(n.gamma);
  const char *const name[] = {kinds == 1 && s->gradient == 0.0 ? "N_c" : "q/c",
                              kinds == 1 ? "N_q" : "q/surcharge",
                              kinds == 1 ? "N_gamma" : "q/(rho g B/2)"};
  const double value[] = {n.c, n.q, n.gamma};
  for (int k = 0; k < 3; k++)
    if (!isnan(value[k])) printf(", %s %.4g", name[k], value[k]);
}

static void print(const simulation *sim, const capacity *c) {
  const settings *s = &sim->s;
  const footing_limits *l = &c->limits;
  if (isnan(c->last)) {
    printf("no bearing capacity: the footing has not settled as far as --settlement\n");
    return;
  }
  printf("bearing capacity of the undeformed ground %.4g kPa", 1e-3 * c->last);
  print_coefficients(s, c->last);
  if (compare_holds(&c->limit))
    printf(" (%s %.4g kPa, %+.1f %%)", c->limit.source, 1e-3 * l->exact,
           100.0 * compare_error(&c->limit));
  else if (!isnan(l->smooth) || !isnan(l->rough))
    printf(" (%s: smooth base %.4g kPa, rough %.4g)", l->source, 1e-3 * l->smooth, 1e-3 * l->rough);
  if (!isnan(l->davis))
    printf(" (%.4g kPa with the strength of Davis for --psi, %.4g kPa of associated flow)",
           1e-3 * l->davis, 1e-3 * c->associated);
  printf("\n");
  if (!isnan(c->deformed)) {
    const bool far = s->settlement >= 1.0;
    printf("as the ground deforms: %.4g kPa after %.3g %s", 1e-3 * c->deformed,
           far ? s->settlement : 1e3 * s->settlement, far ? "m" : "mm");
    print_coefficients(s, c->deformed);
    printf("\n");
  }
  compare_tell(&c->limit);
  if (s->model == DRUCKER_PRAGER) sand_print(&s->voids, s->psi);
}

/* Ground whose pressure still grows has not reached its bearing capacity, one whose pressure falls
 * has lost it, and the line through either means nothing. */
static void warn_of_growth(app *a, const capacity *c) {
  if (c->growth > GROWTH)
    app_warn(a,
             "the pressure grows by %.0f %% over the second half of the path: the ground has not "
             "reached its bearing capacity, take a longer --settlement",
             100.0 * c->growth);
  if (has_fallen(c))
    app_warn(a,
             "the pressure falls by %.0f %% from its largest, %.4g kPa: the ground has failed "
             "before the end of the path, over whose last fifth the capacity is taken; take a "
             "shorter --settlement or a slower --rate",
             100.0 * (1.0 - c->last / c->most), 1e-3 * c->most);
}

/* Ground beside a circle that has sunk shares nodes with it: it is lifted off late. */
static void warn_of_cells(app *a, const settings *s, const capacity *c) {
  if (isnan(c->deformed) || s->shape != CIRCLE || s->settlement <= SUNK * s->half_width) return;
  app_warn(
      a,
      "the footing has sunk by %.2g radii: what deformed ground bears under a circle depends on "
      "the cell, five and ten cells a radius give up to 33 and 15 %% more than twenty",
      s->settlement / s->half_width);
}

/* N_gamma of 45 degrees falls as the particles a cell get more, and not with the cell. */
static void warn_of_angle(app *a, const settings *s) {
  const double degrees = footing_find_strength(s).phi * 180.0 / PI;
  if (!(degrees > STEEP) || !footing_weight_bears(s)) return;
  app_warn(
      a,
      "sand of %g degrees that its weight alone keeps: above %g degrees its capacity comes out "
      "up to a tenth too low, by the place of its edge on the grid",
      degrees, STEEP);
}

bool footing_finish(app *a, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  const capacity c = measure(sim);
  mpm_snapshot shot = {0};
  if (!isnan(c.last)) warn_of_growth(a, &c); /* before the summary, which lists it */
  warn_of_cells(a, s, &c);
  warn_of_angle(a, s);
  const bool good = app_check(a, mpm_snapshot_last(&sim->m, 0.0, "plastic_strain", &shot)) &&
                    write_pressure(a, sim) && write_particles(a, s, &shot) &&
                    write_summary(a, sim, &c) && draw_pressure(a, sim, &c) &&
                    draw_bands(a, sim, &shot) && footing_write_section(a, sim);
  mpm_snapshot_free(&shot);
  if (!good) return false;
  app_tell_results(a, s->out);
  print(sim, &c);
  return true;
}
