/* results.c - exact capacity, tables and pictures of mps-footing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/area.h"
#include "common/compare.h"
#include "common/plot.h"
#include "footing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

enum { LINES = 40 };

#define GROWTH 0.1   /* of the pressure, over the second half of the path: more is no capacity */
#define FASTEST 0.08 /* of the capacity: v (rho G)^1/2, at which inertia adds some 5 % */
#define DEEPEST 0.05 /* of the half width: limit analysis knows the ground's first shape only */

/* q/c of the run, and the reference values. */
typedef struct capacity {
  double unit;                 /* Pa: the cohesion, of the upper layer where there are two */
  double last;                 /* mean over the last fifth of the path; NaN: it has not ended */
  double undeformed, slope;    /* of the line through the path's second half: at no settlement, and
                                  per mm: limit analysis knows the ground's first shape only */
  double smooth, rough, exact; /* limits; NaN where the base is neither */
  double growth;               /* of the pressure, over the second half of the path */
  comparison limit;            /* of the capacity with `exact` */
} capacity;

static void fit_path(const simulation *sim, capacity *c) {
  const int first = footing_rows(sim) / 2, n = footing_rows(sim) - first;
  const double unit = c->unit;
  double x = 0.0, q = 0.0, xx = 0.0, xq = 0.0;
  c->last = 0.0;
  for (int k = first; k < footing_rows(sim); k++)
    x += footing_row_of(sim, k)->path * 1e3 / n, q += footing_row_of(sim, k)->q / unit / n;
  for (int k = first; k < footing_rows(sim); k++) {
    const double dx = footing_row_of(sim, k)->path * 1e3 - x;
    xx += dx * dx;
    xq += dx * (footing_row_of(sim, k)->q / unit - q);
  }
  c->slope = xq / xx;
  c->undeformed = q - c->slope * x;
  const int fifth = footing_rows(sim) < 5 ? 1 : footing_rows(sim) / 5;
  for (int k = footing_rows(sim) - fifth; k < footing_rows(sim); k++)
    c->last += footing_row_of(sim, k)->q / unit / fifth;
  const double path = (footing_row_of(sim, footing_rows(sim) - 1)->path -
                       footing_row_of(sim, footing_rows(sim) / 2)->path) *
                      1e3;
  c->growth = c->slope * path / c->last;
}

/* The limit by characteristics, which supposes associated flow; its error falls with the square of
 * the lines and is extrapolated. */
static double limit(const settings *s, bool rough) {
  const strip_footing f = {.half_width = s->half_width,
                           .friction = s->model == VON_MISES ? 0.0 : s->phi * PI / 180.0,
                           .cohesion = s->cohesion,
                           .weight = s->density * s->gravity,
                           .gradient = s->gradient,
                           .surcharge = s->surcharge,
                           .rough = rough};
  const double coarse = characteristics_capacity(&f, LINES / 2);
  const double fine = characteristics_capacity(&f, LINES);
  return (4.0 * fine - coarse) / 3.0 / f.cohesion;
}

/* Cohesive ground: Prandtl (52), whatever the weight and the base, where the cohesion does not grow
 * with depth. A circle: smooth, R. T. Shield,
 * J. Mech. Phys. Solids 4 (1955) 10-16; rough, G. Eason and R. T. Shield, Z. angew. Math. Phys. 11
 * (1960) 33-43. Coulomb's friction lets the base bear c, as a rough one does, where mu q > c. */
static void find_cohesive_limits(const settings *s, capacity *c) {
  if (s->top >
      0.0) { /* known by bounds alone: R. S. Merifield et al., Geotechnique 49 (1999) 471 */
    c->smooth = c->rough = c->exact = NAN;
    return;
  }
  if (s->gradient > 0.0) {
    c->smooth = limit(s, false), c->rough = limit(s, true);
    c->exact = s->mu == 0.0 ? c->smooth : s->mu >= 1.0 ? c->rough : NAN;
    return;
  }
  if (footing_is_thin(s)) { /* a rough strip: G. G. Meyerhof, T. K. Chaplin 1953 */
    c->rough = fmax(c->rough, PI + 1.0 + s->half_width / s->depth);
    c->smooth = NAN;
    c->exact = s->mu >= 1.0 ? c->rough : NAN;
  }
  if (footing_is_whole(s)) /* G. G. Meyerhof (1953): the width B - 2 e bears, without tension */
    c->smooth = c->rough = c->exact = (2.0 + PI) * (1.0 - s->eccentricity / s->half_width);
  if (s->shape == STRIP) return;
  c->smooth = 5.69, c->rough = 6.05;
  c->exact = s->mu == 0.0 ? c->smooth : s->mu * c->smooth >= 1.0 ? c->rough : NAN;
}

static const char *source_of(const settings *s) {
  return s->model == DRUCKER_PRAGER || s->gradient > 0.0 ? "characteristics"
         : footing_is_thin(s)                            ? "Meyerhof and Chaplin"
         : footing_is_whole(s)                           ? "Meyerhof, B - 2 e"
         : s->shape == STRIP                             ? "Prandtl"
                                                         : "Shield, Eason";
}

/* Of a rigid, perfectly plastic ground, slowly, before its shape changes. */
static comparison compare_limit(const simulation *sim, const capacity *c) {
  const settings *s = &sim->s;
  const bool cone = s->model == DRUCKER_PRAGER;
  const double shear = s->young / (2.0 + 2.0 * s->poisson);
  const double inertia = s->settled ? 0.0 : s->rate * sqrt(s->density * shear);
  const double width = footing_is_whole(s) ? 1.0 - s->eccentricity / s->half_width : 1.0;
  const double most = (isnan(c->exact) ? fmax(c->smooth, c->rough) : c->exact) / width;
  comparison out = compare_with(source_of(s), cone ? c->undeformed : c->last, c->exact);
  compare_require(&out, s->top == 0.0,
                  "ground of two layers is known by bounds alone, not by an exact capacity");
  compare_require(&out, !cone || s->psi == s->phi,
                  "--psi is below --phi: the exact capacity is of associated flow");
  compare_require(&out, s->settlement <= DEEPEST * s->half_width,
                  "the footing is pressed by %.2g of its half width, and the capacity is of ground "
                  "in its first shape",
                  s->settlement / s->half_width);
  compare_require(&out, !(c->growth > GROWTH),
                  "the pressure grows by %.0f %% over the second half of the path: the ground has "
                  "not reached its bearing capacity",
                  100.0 * c->growth);
  compare_require(&out, !(inertia > FASTEST * most * c->unit),
                  "the footing moves at %g mm/s: the inertia of the ground, v (rho G)^1/2, is %.2g "
                  "of the capacity",
                  1e3 * s->rate, inertia / (most * c->unit));
  return out;
}

static capacity measure(const simulation *sim) {
  const settings *s = &sim->s;
  capacity c = {.smooth = 2.0 + PI, .rough = 2.0 + PI, .exact = 2.0 + PI};
  c.unit = s->top > 0.0 ? s->top_cohesion : s->cohesion;
  /* the ground bears more until the end of the path */
  c.last = c.undeformed = c.slope = c.growth = NAN;
  if (footing_rows(sim) == sim->samples) fit_path(sim, &c);
  if (s->model == VON_MISES) {
    find_cohesive_limits(s, &c);
  } else {
    c.smooth = limit(s, false);
    c.rough = limit(s, true);
    c.exact = s->mu == 0.0 ? c.smooth : s->mu >= tan(s->phi * PI / 180.0) ? c.rough : NAN;
  }
  c.limit = compare_limit(sim, &c);
  if (c.limit.reason[0]) c.smooth = c.rough = c.exact = NAN;
  compare_require(&c.limit, !isnan(c.exact),
                  "it is of a smooth or a rough base, between which the friction of this one, %g, "
                  "lies",
                  s->mu);
  return c;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static bool write_pressure(app *a, const settings *s, const simulation *sim, const capacity *c) {
  output f;
  if (!output_open(&f, a, s->out, "pressure.csv")) return false;
  csv_header(&f, "settlement_mm,q_kPa,q_over_c");
  for (int k = 0; k < footing_rows(sim); k++) {
    const double row[] = {footing_row_of(sim, k)->path * 1e3, footing_row_of(sim, k)->q * 1e-3,
                          footing_row_of(sim, k)->q / c->unit};
    csv_row(&f, 3, row);
  }
  return output_close(&f);
}

static bool write_particles(app *a, const settings *s, simulation *sim) {
  mps_particles *set = sim->m.whole ? sim->m.whole : sim->m.particles;
  mps_view x, strain;
  output f;
  if (!app_check(a, mps_particles_view(set, "position", &x)) ||
      !app_check(a, mps_particles_view(set, "plastic_strain", &strain)))
    return false;
  int64_t *rows = mpm_rows_by_id(set);
  if (!rows) return app_no_memory(a);
  if (!output_open(&f, a, s->out, "particles.csv")) {
    free(rows);
    return false;
  }
  csv_header(&f, "x_m,y_m,plastic_strain");
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const int64_t k = rows[i];
    const double row[] = {*mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1),
                          *mps_view_f64(&strain, k, 0)};
    sim->strain = fmax(sim->strain, row[2]);
    csv_row(&f, 3, row);
  }
  free(rows);
  return output_close(&f);
}

static bool write_summary(app *a, const simulation *sim, const capacity *c) {
  const settings *s = &sim->s;
  output f;
  if (!mpm_model_summary(a, &sim->m, s->out, &f)) return false;
  json_text(&f, "model", s->model == VON_MISES ? "vonmises" : "druckerprager");
  json_text(&f, "shape", s->shape == CIRCLE ? "circle" : "strip");
  json_number(&f, "h", s->h);
  json_number(&f, "flip_time", s->flip_time);
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
  json_text(&f, "loading", s->settled ? "quasi-static" : "steady");
  json_number(&f, "q_over_c", c->last);
  json_number(&f, "q_over_c_undeformed", c->undeformed);
  json_number(&f, "q_over_c_per_mm", c->slope);
  json_comparison(&f, "q_exact", &c->limit);
  json_number(&f, "q_exact_smooth", c->smooth);
  json_number(&f, "q_exact_rough", c->rough);
  /* Over the last fifth of the path: N_q, N_gamma where there is nothing else that bears. */
  const double q = c->last * c->unit, weight = s->density * s->gravity * s->half_width;
  json_number(&f, "q_over_surcharge", s->surcharge > 0.0 ? q / s->surcharge : NAN);
  json_number(&f, "q_over_weight", weight > 0.0 ? q / weight : NAN);
  json_end(&f);
  return output_close(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

/* A level line; none where there is no solution. */
static void draw_limit(output *f, double value, const char *dash, const char *title) {
  if (!isnan(value))
    output_text(f, ", \\\n  %.9g dashtype '%s' linecolor rgb '#c0392b' title '%s'", value, dash,
                title);
}

static bool draw_pressure(app *a, const settings *s, const capacity *c) {
  output f;
  char loading[32] = "quasi-static";
  const footing_unit unit = footing_unit_of(s);
  if (!plot_open(&f, a, s->out, "pressure", 1000, 640)) return false;
  if (!s->settled) snprintf(loading, sizeof loading, "%g mm/s", 1e3 * s->rate);
  output_text(&f,
              "set title \"%s footing on %s ground\\n{/*0.85 h = %g m, %s %g m, "
              "%s, friction of the base %g}\"\nset xlabel 'settlement (mm)'\n"
              "set ylabel 'pressure over %s'\nset key right bottom opaque\n"
              "set yrange [0:*]\nplot 'pressure.csv' every ::1 using 1:($2*%.9g) with lines "
              "linecolor rgb '#1f4e8c' title 'WLS-MPM'",
              s->shape == CIRCLE ? "Circular" : "Strip",
              s->model == VON_MISES ? "cohesive" : "frictional", s->h,
              s->shape == CIRCLE ? "radius" : "half width", s->half_width, loading, s->mu,
              unit.name, 1e3 / unit.value);
  const double scale = c->unit / unit.value;
  const bool cone = s->model == DRUCKER_PRAGER;
  const bool circle = s->shape == CIRCLE;
  if (!cone && !circle)
    draw_limit(&f, scale * c->exact, "--",
               s->gradient > 0.0     ? "characteristics"
               : footing_is_whole(s) ? "Meyerhof, B - 2 e"
               : footing_is_thin(s)  ? "Meyerhof, Chaplin"
                                     : "Prandtl");
  if (circle && c->exact != c->rough)
    draw_limit(&f, scale * c->smooth, "--", "smooth base, Shield");
  if (circle && c->exact != c->smooth)
    draw_limit(&f, scale * c->rough, "-.", "rough base, Eason, Shield");
  if (cone && c->exact != c->rough)
    draw_limit(&f, scale * c->smooth, "--", "smooth base, characteristics");
  if (cone && c->exact != c->smooth)
    draw_limit(&f, scale * c->rough, "-.", "rough base, characteristics");
  output_text(&f, "\n");
  return plot_close(&f, s->out, "pressure");
}

/* `user`: the corner of the footing, m. */
static bool in_footing(const void *user, double x, double y) {
  const double *corner = user;
  return fabs(x) < corner[0] && y > corner[1];
}

/* shear_bands.bin: the plastic strain. */
static bool image_bands(app *a, const settings *s, const simulation *sim, const double *lower,
                        const double *upper, area *image) {
  mps_particles *set = sim->m.whole ? sim->m.whole : sim->m.particles;
  mps_view x, strain;
  output f;
  if (!app_check(a, mps_particles_view(set, "position", &x)) ||
      !app_check(a, mps_particles_view(set, "plastic_strain", &strain)))
    return false;
  double *row = malloc((size_t)(x.shape[0] + 1) * 3 * sizeof *row);
  if (!row) return app_no_memory(a);
  for (int64_t k = 0; k < x.shape[0]; k++) {
    row[3 * k] = *mps_view_f64(&x, k, 0);
    row[3 * k + 1] = *mps_view_f64(&x, k, 1);
    row[3 * k + 2] = *mps_view_f64(&strain, k, 0);
  }
  const double base[2] = {s->half_width,
                          s->depth - footing_row_of(sim, footing_rows(sim) - 1)->path};
  const area_def def = {.spacing = mps_particles_spacing(set),
                        .slit = AREA_SLIT_SHEARED,
                        .lower = {lower[0], lower[1]},
                        .upper = {upper[0], upper[1]},
                        .walled = true,
                        .side = AREA_SIDE,
                        .solid = in_footing,
                        .user = base};
  const bool good = output_open(&f, a, s->out, "shear_bands.bin");
  if (good) area_write(&f, &def, x.shape[0], row, image);
  free(row);
  return good && output_close(&f);
}

/* The mechanism reaches farther in frictional ground. */
static bool draw_bands(app *a, const settings *s, const simulation *sim) {
  const double wide = s->model == VON_MISES ? 5.0 : 9.0, top = s->depth + 0.3 * s->half_width;
  const double upper[2] = {fmin(s->width, wide * s->half_width), top};
  const double left = footing_is_whole(s) ? -upper[0] : 0.0;
  const double lower[2] = {left, fmax(0.0, s->depth - 3.0 * s->half_width)};
  area image;
  if (!image_bands(a, s, sim, lower, upper, &image)) return false;
  output f;
  if (!plot_open(&f, a, s->out, "shear_bands", 1100, s->model == VON_MISES ? 660 : 440))
    return false;
  output_text(&f,
              "set title 'Plastic strain (-)'\nset xlabel 'x (m)'\nset ylabel 'y (m)'\n"
              "set size ratio -1\nset palette defined (0 '#f7fbff', 0.3 '#6baed6', 1 '#08306b')\n"
              "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n"
              "set object 1 rectangle from %.9g,%.9g to %.9g,%.9g fillcolor rgb '#888888' front\n",
              left, upper[0], lower[1], top, fmax(left, -s->half_width),
              s->depth - footing_row_of(sim, footing_rows(sim) - 1)->path, s->half_width, top);
  plot_colours(&f, 0.0, 0.5 * sim->strain, image.least, image.most);
  output_text(&f, "plot ");
  area_plot(&f, "shear_bands.bin", &image, 1.0);
  output_text(&f, "\n");
  return plot_close(&f, s->out, "shear_bands");
}

/* ---- the end --------------------------------------------------------------------------------- */

static void print(const settings *s, const capacity *c) {
  if (isnan(c->last)) {
    printf("no bearing capacity: the footing has not settled as far as --settlement\n");
    return;
  }
  const bool cone = s->model == DRUCKER_PRAGER;
  printf("bearing capacity q/c %.*f", cone ? 2 : 3, c->last);
  if (s->top > 0.0) printf(", c that of the upper layer");
  if (cone) printf(", taken back to no settlement %.2f", c->undeformed);
  if (compare_holds(&c->limit) && cone)
    printf("; exact: %.2f (%s base), %+.1f %%", c->exact, s->mu > 0.0 ? "rough" : "smooth",
           100.0 * compare_error(&c->limit));
  else if (compare_holds(&c->limit))
    printf(" (%s %.3f, %+.1f %%)",
           footing_is_thin(s)                  ? "thin layer, rough base"
           : s->shape == CIRCLE && s->mu > 0.0 ? "rough base"
           : s->shape == CIRCLE                ? "smooth base"
                                               : c->limit.source,
           c->exact, 100.0 * compare_error(&c->limit));
  else if (!isnan(c->smooth) && !isnan(c->rough))
    printf(" (smooth base %.2f, rough %.2f)", c->smooth, c->rough);
  else if (!isnan(c->smooth))
    printf(" (smooth base %.3f; no characteristics found of a rough one)", c->smooth);
  else if (!isnan(c->rough))
    printf(" (rough base %.3f)", c->rough);
  printf("\n");
  compare_tell(&c->limit);
  if (cone) sand_print(&s->voids, s->psi);
}

/* Ground whose pressure still grows has not reached its bearing capacity, and the line through it
 * means nothing. */
static void warn_of_growth(app *a, const capacity *c) {
  if (c->growth > GROWTH)
    app_warn(a,
             "the pressure grows by %.0f %% over the second half of the path: the ground has not "
             "reached its bearing capacity, take a longer --settlement",
             100.0 * c->growth);
}

bool footing_finish(app *a, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  const capacity c = measure(sim);
  if (!isnan(c.last)) warn_of_growth(a, &c); /* before the summary, which lists it */
  if (!write_pressure(a, s, sim, &c) || !write_particles(a, s, sim) || !write_summary(a, sim, &c) ||
      !draw_pressure(a, s, &c) || !draw_bands(a, s, sim) || !footing_write_section(a, sim))
    return false;
  app_tell_results(a, s->out);
  print(s, &c);
  return true;
}
