/* water.c - water in the pores of a slope, at pressures that do not change: x from the edge of the
 * crest to the toe, y from the level of the toe.
 *
 * Below a water table the pressure is that of water at rest, gamma_w times the depth below the
 * table, or of water that flows along it, cos^2 of its inclination times that. Water that stands
 * above the ground is a pool, whose pressure bears on the surface. After a drawdown all pressures
 * are those before it less what the surface above has lost of its load (Bishop 1954, B = 1). With
 * r_u they are r_u times the weight of the ground above (Bishop and Morgenstern 1960).
 *
 * The ground is computed by effective stresses: its weight and the force -grad p of the water are
 * the load of a particle, and where the pool's pressure bears on the surface the effective stress
 * there is 0. SPDX-License-Identifier: BSD-3-Clause */
#include "slope.h"

#include "common/table.h"

#include <mps/soil.h>

#include <math.h>

#define DRY (-INFINITY)

/* ---- the surface and the table --------------------------------------------------------------- */

double slope_surface(const settings *s, double x) {
  const double run = s->slope * s->height;
  if (x <= 0.0) return s->height;
  return x < run ? s->height * (1.0 - x / run) : 0.0;
}

/* Level of the table at x, and its inclination's cos^2. */
static double table_at(const settings *s, double x, double *flat) {
  const double *p = s->line;
  *flat = 1.0;
  if (s->points == 0) return isnan(s->table) ? DRY : s->table;
  if (x <= p[0]) return p[1];
  for (int64_t k = 1; k < s->points; k++, p += 2)
    if (x <= p[2]) {
      const double run = p[2] - p[0], fall = p[3] - p[1];
      if (s->flow == FLOW_ALONG) *flat = run * run / (run * run + fall * fall);
      return p[1] + fall * (x - p[0]) / run;
    }
  return p[1];
}

double slope_table(const settings *s, double x) {
  double flat;
  return table_at(s, x, &flat);
}

double slope_pool(const settings *s) {
  const double level = slope_table(s, INFINITY);
  return level > 0.0 ? level : DRY;
}

bool slope_is_wet(const settings *s) { return s->ru > 0.0 || s->points > 0 || !isnan(s->table); }

/* ---- weights and pressures ------------------------------------------------------------------- */

/* Weight of the water above the surface at x, Pa, for a pool at `level`. */
static double pool_load(const settings *s, double level, double x) {
  return WATER * s->gravity * fmax(0.0, level - slope_surface(s, x));
}

/* Level below which the ground is saturated. */
static double saturated_to(const settings *s, double x) {
  const double level = slope_table(s, x);
  return isnan(s->drawdown) ? level : fmax(level, s->drawdown);
}

double slope_density(const settings *s, double x, double y) {
  return y < saturated_to(s, x) ? s->density : s->moist;
}

/* Weight of ground and pool above a point, Pa. */
double slope_overburden(const settings *s, double x, double y) {
  const double top = slope_surface(s, x), wet = fmin(fmax(saturated_to(s, x), y), top);
  const double pool = slope_pool(s);
  return s->gravity * (s->moist * (top - wet) + s->density * (wet - y)) + pool_load(s, pool, x);
}

double slope_pressure(const settings *s, double x, double y) {
  double flat;
  const double unit = WATER * s->gravity, level = table_at(s, x, &flat);
  if (s->ru > 0.0) return s->ru * slope_overburden(s, x, y);
  if (isnan(s->drawdown)) return unit * flat * fmax(0.0, level - y);
  const double lost = pool_load(s, s->drawdown, x) - pool_load(s, slope_pool(s), x);
  return fmax(0.0, unit * fmax(0.0, s->drawdown - y) - lost);
}

/* ---- particles ------------------------------------------------------------------------------- */

/* The effective stress at rest. */
static mps_status rest(void *user, const double *place, double *stress) {
  const settings *s = user;
  const double x = place[0] - s->crest, y = place[1] - s->base;
  const double up = fmax(0.0, slope_overburden(s, x, y) - slope_pressure(s, x, y));
  stress[1] = -up;
  stress[0] = stress[2] = -up * s->poisson / (1.0 - s->poisson);
  return MPS_OK;
}

/* Densities, and -grad p over them. */
static mps_status load(settings *s, mps_particles *set) {
  const double step = 1e-6 * s->height;
  mps_view x;
  mps_edit density, force;
  mps_status status = mps_particles_add_field(set, "body_acceleration", 0);
  if (status == MPS_OK) status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(set, "density", &density);
  if (status == MPS_OK) status = mps_particles_edit(set, "body_acceleration", &force);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double px = *mps_view_f64(&x, k, 0) - s->crest, py = *mps_view_f64(&x, k, 1) - s->base;
    const double rho = slope_density(s, px, py);
    const double along = slope_pressure(s, px + step, py) - slope_pressure(s, px - step, py);
    const double up = slope_pressure(s, px, py + step) - slope_pressure(s, px, py - step);
    *mps_edit_f64(&density, k, 0) = rho;
    *mps_edit_f64(&force, k, 0) = -along / (2.0 * step * rho);
    *mps_edit_f64(&force, k, 1) = -up / (2.0 * step * rho);
  }
  status = mps_particles_commit(set, &density);
  return status == MPS_OK ? mps_particles_commit(set, &force) : status;
}

mps_status slope_wet(settings *s, mps_particles *set) {
  const mps_status status = load(s, set);
  return status == MPS_OK ? mps_particles_set_stress(set, rest, s) : status;
}

/* ---- options --------------------------------------------------------------------------------- */

/* From a to b, not level, is above the ground somewhere: at an end, or above the toe, where alone
 * the surface is concave. */
static bool hangs(const settings *s, const double *a, const double *b) {
  const double run = s->slope * s->height, least = 1e-9 * s->height;
  if (a[1] == b[1]) return false;
  if (a[0] <= run && run < b[0] && a[1] + (b[1] - a[1]) * (run - a[0]) / (b[0] - a[0]) > least)
    return true;
  return a[1] > slope_surface(s, a[0]) + least || b[1] > slope_surface(s, b[0]) + least;
}

/* The line of a file: x ascending, and where it is above the ground it is level, as a pool is. */
static const char *read_line(settings *s) {
  static const table_def def = {.row = "point",
                                .column = {{"x", "m", "m", -1e6, 1e6, .open = false},
                                           {"level", "m", "m", -1e6, 1e6, .open = false}},
                                .count = 2,
                                .most = SLOPE_POINTS};
  static char why[600];
  if (!table_read(s->table_text, &def, s->line, &s->points, why, sizeof why)) return why;
  if (s->points < 2) return "--water-level: a line has at least two points";
  for (int64_t k = 1; k < s->points; k++) {
    const double *a = s->line + 2 * (k - 1), *b = a + 2;
    if (!(b[0] > a[0])) return "--water-level: the x of its points must ascend";
    if (hangs(s, a, b))
      return "--water-level: above the ground it must be level, the water of a pool";
  }
  return NULL;
}

const char *slope_settle_water(settings *s, const option *table) {
  if (isnan(s->moist)) s->moist = s->density;
  if (s->table_text && !options_number(s->table_text, &s->table)) {
    const units_status read = units_read(s->table_text, "m", &s->table);
    if (read != UNITS_GOOD) {
      s->table = NAN;
      const char *why = read_line(s);
      if (why) return why;
    }
  }
  if (fabs(s->table) > 1e6) return "--water-level must be in [-1e6, 1e6] m";
  if (s->ru > 0.0 && s->table_text) return "--ru and --water-level exclude each other";
  if (s->points == 0 && options_given(table, "seepage"))
    return "--seepage is for a --water-level that is a line";
  if (!isnan(s->drawdown) && (s->points > 0 || !s->table_text))
    return "--drawdown is to a --water-level that is a level";
  if (!isnan(s->drawdown) && !(s->drawdown > s->table))
    return "--drawdown must be above --water-level, to which the pool has fallen";
  if (!s->table_text && options_given(table, "moist-density"))
    return "--moist-density is for ground above a --water-level";
  if (s->runout && slope_is_wet(s))
    return "--runout excludes water: its pressures are those of a slope in place";
  if (s->table_text && !(s->density > WATER))
    return "--density must be above 1000 kg/m3, that of water, with --water-level";
  return s->moist > s->density ? "--moist-density must be at most --density" : NULL;
}
