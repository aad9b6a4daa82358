/* results.c - coefficients of earth pressure, tables and pictures of mps-wall.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/area.h"
#include "common/compare.h"
#include "common/plot.h"
#include "wall.h"

#include <math.h>
#include <stdio.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define GROWTH 0.1 /* of the force, over the last half of the path: more is no limit state */
#define FASTEST                                                                                    \
  0.05 /* of (g H)^1/2: the speed of a wall beside whose pressure inertia is little                \
        */

/* Forces over rho g H^2/2. */
typedef struct pressure {
  double across, along, height; /* height: of the force across over H above the toe */
  comparison theory;            /* Rankine, of a smooth wall; Coulomb, active and rough */
  double cracked;               /* Rankine below a tension crack: active, smooth, cohesive; NaN */
  double reduced;               /* Rankine with Davis' strength: smooth, psi < phi; NaN */
} pressure;

/* Of the layers, degrees. */
static double largest_dilation(const settings *s) {
  double most = 0.0;
  for (int k = 0; k < s->layers; k++) most = fmax(most, s->layer[k].psi);
  return most;
}

/* Rankine's coefficient without cohesion. */
static double rankine(const settings *s, const wall_layer *l) {
  const double side = s->pressure == ACTIVE ? -1.0 : 1.0;
  return pow(tan((45.0 + side * 0.5 * l->phi) * DEGREE), 2.0);
}

/* Coulomb's, across the wall. */
static double coulomb(const settings *s, const wall_layer *l) {
  const double phi = l->phi * DEGREE, delta = fmin(atan(s->friction), phi);
  const double root = sqrt(sin(phi + delta) * sin(phi) / cos(delta));
  return pow(cos(phi), 2.0) / pow(1.0 + root, 2.0);
}

/* Of the ground on a plane up to its surface, within its length, that a wall lifts along it: the
 * least, with all of the wall's friction (at most that of the ground). */
static double wedge(const settings *s, const wall_layer *l) {
  enum { PLANES = 1000 };
  const double phi = l->phi * DEGREE, friction = fmin(s->friction, tan(phi));
  const double flat = atan(s->height / s->length), steep = 90.0 * DEGREE - phi;
  double least = INFINITY;
  for (int k = 0; k < PLANES; k++) {
    const double plane = flat + (steep - flat) * k / PLANES, lifts = tan(plane + phi);
    if (friction * lifts < 1.0) least = fmin(least, lifts / (1.0 - friction * lifts) / tan(plane));
  }
  return least;
}

/* Rankine's of the strength that Davis takes. */
static double davis(const settings *s, const wall_layer *l) {
  const double phi = l->phi * DEGREE, psi = l->psi * DEGREE;
  const double less = atan(cos(psi) * sin(phi) / (1.0 - sin(psi) * sin(phi)));
  const double side = s->pressure == ACTIVE ? -1.0 : 1.0;
  return pow(tan(45.0 * DEGREE + side * 0.5 * less), 2.0);
}

static double most_cohesion(const settings *s) {
  double most = 0.0;
  for (int k = 0; k < s->layers; k++) most = fmax(most, s->layer[k].cohesion);
  return most;
}

static bool is_associated(const settings *s) {
  for (int k = 0; k < s->layers; k++)
    if (s->layer[k].psi < s->layer[k].phi) return false;
  return true;
}

/* Of the wedge that fails, along the surface, m. */
static double reach(const settings *s) {
  const double side = s->pressure == ACTIVE ? -1.0 : 1.0;
  double most = 0.0;
  for (int k = 0; k < s->layers; k++)
    most = fmax(most, tan((45.0 + side * 0.5 * s->layer[k].phi) * DEGREE));
  return most * s->height;
}

/* How much the force changes over the last half of the path, of its mean over the last fifth. */
static double late_change(const simulation *sim, double across) {
  const double half = wall_row_of(sim, wall_rows(sim) / 2)->across,
               last = wall_row_of(sim, wall_rows(sim) - 1)->across;
  return fabs(last - half) / (fabs(across) * wall_unit(&sim->s));
}

/* Rankine: K (rho g H^2/2 + q H) -+ 2 c sqrt(K) H, layer by layer. Coulomb's wedge on a vertical
 * wall whose friction is at most that of the ground: within some percent of the exact one in the
 * active case, not in the passive one, nor on a smooth bed, on which the ground at the toe slides
 * along with the wall. Both are of a wall that has moved far enough for the ground to yield. */
static comparison find_theory(const simulation *sim, double across) {
  const settings *s = &sim->s;
  const bool smooth = s->friction == 0.0;
  const double force = wall_theory(s, smooth ? rankine : coulomb, false);
  comparison c = compare_with(smooth ? "Rankine" : "Coulomb", across, force / wall_unit(s));
  compare_require(
      &c, smooth || s->base > 0.0,
      "on the smooth bed of --below-toe 0 the ground at the toe slides along with the wall%s",
      s->pressure == PASSIVE ? ", and resists less than ground that continues below it" : "");
  compare_require(
      &c, smooth || s->pressure == ACTIVE,
      "Coulomb's plane wedge is far above the force of a rough wall in the passive case");
  compare_require(&c, smooth || most_cohesion(s) == 0.0,
                  "the coefficient is that of ground without cohesion");
  compare_require(&c, s->motion != TURNS_ABOUT_TOP,
                  "the wall turns about its top, where the ground arches: the theory is of ground "
                  "that yields everywhere");
  compare_require(&c, force > 0.0, "the ground stands without the wall");
  compare_require(&c, (smooth && s->base == 0.0) || is_associated(s),
                  "with psi below phi the ground mobilises less than its strength");
  compare_require(&c, s->length >= reach(s),
                  "the ground is %.3g m long, its wedge would reach %.3g m", s->length, reach(s));
  compare_require(&c, s->rate <= FASTEST * sqrt(s->gravity * s->height),
                  "the wall moves at %.3g m/s, %.2g times (g H)^1/2: inertia counts", s->rate,
                  s->rate / sqrt(s->gravity * s->height));
  compare_require(&c, isnan(across) || !(late_change(sim, across) > GROWTH),
                  "the force still changes by %.0f %% over the last half of the path",
                  100.0 * late_change(sim, across));
  return c;
}

/* A wall cannot pull: Rankine's stress where it is a pressure, below 2 c/(rho g sqrt(K)). It is in
 * equilibrium and within the strength, so that the wall needs no more; with Rankine's tension it
 * would need less than the ground does. */
static double find_cracked(const settings *s) {
  if (s->pressure == PASSIVE || s->friction > 0.0 || most_cohesion(s) == 0.0) return NAN;
  const double all = wall_theory(s, rankine, false), pressed = wall_theory(s, rankine, true);
  return pressed > all * (1.0 + 1e-9) ? pressed / wall_unit(s) : NAN;
}

/* Sand that dilates by less than its friction slides along planes on which less than its strength
 * is mobilised, tan(phi*) = cos(psi) sin(phi)/(1 - sin(psi) sin(phi)) (Davis 1968): the force is
 * between Rankine's of phi and of phi*. On a smooth bed the ground is free to take planes of phi.
 */
static double find_reduced(const settings *s) {
  if (s->friction > 0.0 || most_cohesion(s) > 0.0 || s->motion == TURNS_ABOUT_TOP ||
      is_associated(s))
    return NAN;
  return wall_theory(s, davis, false) / wall_unit(s);
}

/* What no ground that a wall is pushed into bears: a wedge that slides on a plane is a mechanism,
 * and its force an upper bound, also where psi < phi. With cohesion, on a smooth wall, Rankine's.
 */
static double find_bound(const settings *s) {
  const bool cohesive = most_cohesion(s) > 0.0;
  if (s->pressure == ACTIVE || s->motion != TRANSLATES || s->layers > 1 ||
      (cohesive && (s->friction > 0.0 || s->length < reach(s))))
    return NAN;
  return wall_theory(s, cohesive ? rankine : wedge, false) / wall_unit(s);
}

/* Mean over the last fifth of the path; NaN where it has not ended. */
static pressure measure(const simulation *sim) {
  const settings *s = &sim->s;
  pressure p = {.across = NAN,
                .along = NAN,
                .height = NAN,
                .cracked = find_cracked(s),
                .reduced = find_reduced(s)};
  p.theory = find_theory(sim, NAN);
  if (wall_rows(sim) < WALL_SAMPLES) return p;
  const int n = WALL_SAMPLES / 5;
  double moment = 0.0;
  p.across = p.along = 0.0;
  for (int k = wall_rows(sim) - n; k < wall_rows(sim); k++) {
    p.across += wall_row_of(sim, k)->across / n / wall_unit(s);
    p.along += wall_row_of(sim, k)->along / n / wall_unit(s);
    moment += wall_row_of(sim, k)->moment / n;
  }
  p.height = moment / (p.across * wall_unit(s) * s->height);
  if (s->motion == TURNS_ABOUT_TOP) p.height += 1.0;
  p.theory = find_theory(sim, p.across);
  return p;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static bool write_pressure(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  output f;
  if (!csv_open(&f, a, s->out, "pressure.csv", "path_over_height,force_kN_m,K,K_along"))
    return false;
  for (int k = 0; k < wall_rows(sim); k++) {
    CSV_LINE(&f, wall_row_of(sim, k)->path / s->height, 1e-3 * wall_row_of(sim, k)->across,
             wall_row_of(sim, k)->across / wall_unit(s), wall_row_of(sim, k)->along / wall_unit(s));
  }
  return output_close(&f);
}

static bool write_summary(app *a, const simulation *sim, const pressure *p) {
  const settings *s = &sim->s;
  output f;
  if (!mpm_model_summary(a, &sim->m, s->out, &f)) return false;
  json_number(&f, "cell", s->h);
  sand_write(&f, &s->voids, largest_dilation(s));
  JSON_NUMBERS(&f, {"flip_time", s->flip_time}, {"K", p->across}, {"K_along", p->along},
               {"K_resultant", hypot(p->across, p->along)}, {"force_height", p->height});
  json_comparison(&f, "K_theory", &p->theory);
  JSON_NUMBERS(&f, {"K_cracked", p->cracked}, {"K_reduced", p->reduced},
               {"force", p->across * wall_unit(s)});
  json_number_if(&f, !isnan(s->water), "water_force", wall_water(s));
  json_end(&f);
  return output_close(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static const char *name_of(const settings *s) {
  static const char *const names[] = {"translates", "turns about its toe", "turns about its top"};
  return names[s->motion];
}

static const char *ground_of(const settings *s) {
  static char text[80];
  if (s->layers > 1)
    snprintf(text, sizeof text, "%d layers", s->layers);
  else
    snprintf(text, sizeof text, "{/Symbol f} = %g°, {/Symbol y} = %g°", s->layer[0].phi,
             s->layer[0].psi);
  return text;
}

static bool draw_pressure(app *a, const simulation *sim, const pressure *p) {
  const settings *s = &sim->s;
  return plot_draw(
      a, s->out, "pressure", "wall/pressure",
      "first = '%s pressure on a wall that %s'\nsecond = '%s, friction of the wall %g, "
      "h = H/%.3g'\nplain = %d; theory = %.9g; source = '%s'; cracked = %.9g",
      s->pressure == ACTIVE ? "Active" : "Passive", name_of(s), ground_of(s), s->friction,
      s->height / s->h, wall_is_plain(s), compare_reference(&p->theory), p->theory.source,
      p->cracked);
}

static bool draw_ground(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  const double left = s->base > 0.0 ? s->front : 0.4 * s->height;
  const double wide = fmin(s->length, (s->pressure == ACTIVE ? 2.0 : 5.0) * s->height);
  const double high = s->base + 1.3 * s->height;
  const area_def def = {.spacing = s->h / sqrt((double)s->ppc),
                        .slit = AREA_SLIT_SHEARED,
                        .lower = {-fmin(left, s->height), 0.0},
                        .upper = {wide, high},
                        .walled = true,
                        .side = AREA_SIDE};
  area image;
  output f;
  if (!area_image(a, s->out, "ground.bin", &def, sim->shot.count, sim->shot.row, &image) ||
      !plot_begin(&f, a, s->out, "ground"))
    return false;
  const double path =
      (s->pressure == ACTIVE ? -1.0 : 1.0) * wall_row_of(sim, wall_rows(sim) - 1)->path;
  const double foot = s->motion == TURNS_ABOUT_TOE ? 0.0 : path;
  const double toe = s->base - s->sheet; /* m; where ground lies before it, as thick as it is */
  const double thick = s->sheet > 0.0 ? wall_thickness(s) : 0.1 * s->height;
  const double head = s->motion == TURNS_ABOUT_TOP ? 0.0 : path;
  area_set(&f, "ground.bin", &def, 1, &image, 1.0);
  output_text(&f,
              "titles[1] = ''; x_name = 'x (m)'; y_name = 'y (m)'; cb_name = 'plastic strain (-)'\n"
              "palette = 'sand'; cb_least = 0; cb_most = %.9g\n"
              "cover(k) = 'set object 1 polygon from %.9g,%.9g to %.9g,%.9g to %.9g,%.9g to "
              "%.9g,%.9g to %.9g,%.9g fillcolor rgb \"#888888\" fillstyle solid front'\n",
              0.5 * mpm_snapshot_most(&sim->shot, 2), foot, toe, head, s->base + s->height,
              head - thick, s->base + s->height, foot - thick, toe, foot, toe);
  return plot_end(&f, s->out, "ground", "maps");
}

/* ---- the end --------------------------------------------------------------------------------- */

static void print(const settings *s, const pressure *p) {
  if (isnan(p->across)) {
    printf("no earth pressure: the wall has not moved as far as --travel, %g m\n", s->path);
    return;
  }
  if (isnan(p->height)) {
    printf("no earth pressure: after %g m the ground does not bear on the wall\n", s->path);
    return;
  }
  printf("%s earth pressure K %.4f across the wall, %.4f in all, at %.3f H",
         s->pressure == ACTIVE ? "active" : "passive", p->across, hypot(p->across, p->along),
         p->height);
  if (compare_holds(&p->theory) && !isnan(p->cracked))
    printf(" (Rankine %.4f, with a tension crack %.4f)", p->theory.reference, p->cracked);
  else if (compare_holds(&p->theory))
    printf(" (%s %.4f, %+.1f %%)", p->theory.source, p->theory.reference,
           100.0 * compare_error(&p->theory));
  if (!isnan(p->reduced))
    printf(", %.4f with the strength that Davis takes for psi < phi", p->reduced);
  if (!wall_is_plain(s)) printf(", %.4g kN/m", 1e-3 * p->across * wall_unit(s));
  if (!isnan(s->water))
    printf(", besides %.4g kN/m of water at %.3f H", 1e-3 * wall_water(s),
           (s->height - s->water) / (3.0 * s->height));
  printf("\n");
  compare_tell(&p->theory);
  sand_print(&s->voids, largest_dilation(s));
}

bool wall_finish(app *a, void *user) {
  const simulation *sim = user;
  const pressure p = measure(sim);
  compare_bound(a, "the passive pressure", p.across, "a sliding wedge", find_bound(&sim->s));
  if (!write_pressure(a, sim) ||
      !mpm_snapshots_write(a, sim->s.out, "particles.csv", "plastic_strain", 1, &sim->shot) ||
      !write_summary(a, sim, &p) || !draw_pressure(a, sim, &p) || !draw_ground(a, sim))
    return false;
  app_tell_results(a, sim->s.out);
  print(&sim->s, &p);
  return true;
}
