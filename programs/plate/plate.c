/* plate.c - building, solving and judging the two plates.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "plate.h"

#include <math.h>
#include <stdlib.h>

/* ---- exact solutions ------------------------------------------------------------------------- */

void plate_exact_stress(const plate_def *def, const double *x, double *stress) {
  stress[0] = def->tension;
  stress[1] = stress[2] = 0.0;
  if (!def->hole) return;
  /* Kirsch (1898), in Cartesian components. */
  const double r2 = x[0] * x[0] + x[1] * x[1], t = atan2(x[1], x[0]);
  const double q = def->radius * def->radius / r2;
  stress[0] *= 1 - q * (1.5 * cos(2 * t) + cos(4 * t)) + 1.5 * q * q * cos(4 * t);
  stress[1] = def->tension * (-q * (0.5 * cos(2 * t) - cos(4 * t)) - 1.5 * q * q * cos(4 * t));
  stress[2] = def->tension * (-q * (0.5 * sin(2 * t) + sin(4 * t)) + 1.5 * q * q * sin(4 * t));
}

void plate_exact_displacement(const plate *p, const double *x, double *u) {
  const plate_def *d = p->def;
  const double nu = d->poisson, strain = d->tension / d->young;
  u[0] = strain * (d->plane_strain ? 1.0 - nu * nu : 1.0) * (x[0] - p->wall);
  u[1] = -nu * strain * (d->plane_strain ? 1.0 + nu : 1.0) * x[1];
}

/* ---- particles ------------------------------------------------------------------------------- */

static mps_status solid(void *user, const double *x, int32_t *inside) {
  const plate_def *d = user;
  *inside = !d->hole || x[0] * x[0] + x[1] * x[1] > d->radius * d->radius;
  return MPS_OK;
}

/* The plate in tension: x from 0 to side, y from -side/2. The quarter: particles on both planes of
 * symmetry, x = 0 and y = 0. */
static bool make_particles(plate *p) {
  const plate_def *d = p->def;
  mps_particles_def set = mps_particles_defaults();
  plate_def copy = *d;
  set.spacing = p->spacing = d->spacing;
  if (d->hole)
    set.origin[0] = set.origin[1] = -0.5 * p->spacing;
  else
    set.origin[1] = -0.5 * d->side;
  const double lo[2] = {set.origin[0], set.origin[1]};
  const double hi[2] = {lo[0] + d->side, lo[1] + d->side};
  p->wall = d->hole ? 0.0 : 0.5 * p->spacing;
  return app_check(p->a, mps_particles_create(p->a->context, &set, &p->particles)) &&
         app_check(p->a, mps_particles_fill_where(p->particles, lo, hi, solid, &copy, NULL)) &&
         app_check(p->a, mps_particles_set(p->particles, "young", 0, d->young)) &&
         app_check(p->a, mps_particles_set(p->particles, "poisson", 0, d->poisson));
}

/* ---- supports and loads ---------------------------------------------------------------------- */

/* The layer at `at` along `axis` slides in its own plane; conservative: its cells end there. */
static bool slide(plate *p, const elastic_method *method, int32_t axis, double at, int64_t *ids,
                  int64_t room) {
  double lo[2] = {-INFINITY, -INFINITY}, hi[2] = {INFINITY, INFINITY};
  int64_t count;
  hi[axis] = at + 0.25 * p->spacing;
  return app_check(p->a, mps_particles_select_box(p->particles, lo, hi, room, &count, ids)) &&
         elastic_hold(p->a, p->elastic, axis, count, ids, NULL) &&
         (method->published ||
          app_check(p->a, mps_elastic_cut(p->elastic, mps_side_of(axis, 0), ids, count)));
}

static mps_status outer_traction(void *user, const double *x, const double *normal,
                                 double *traction) {
  double stress[3];
  plate_exact_stress(user, x, stress);
  traction[0] = stress[0] * normal[0] + stress[2] * normal[1];
  traction[1] = stress[2] * normal[0] + stress[1] * normal[1];
  return MPS_OK;
}

/* The outer edge on side +1 of `axis` carries the exact traction. */
static bool pull(plate *p, int32_t axis, int64_t *facets, int64_t room) {
  double lo[2] = {-INFINITY, -INFINITY}, hi[2] = {INFINITY, INFINITY};
  plate_def copy = *p->def;
  int64_t count;
  lo[axis] = (p->def->hole || axis == 0 ? p->def->side : 0.5 * p->def->side) - 1.5 * p->spacing;
  return app_check(p->a, mps_elastic_select_facets(p->elastic, mps_side_of(axis, 1), lo, hi, room,
                                                   &count, facets)) &&
         elastic_pull(p->a, p->elastic, count, facets, outer_traction, &copy);
}

static bool support_and_load(plate *p, const elastic_method *method) {
  const int64_t n = mps_particles_count(p->particles);
  const int64_t room =
      n > mps_elastic_facet_count(p->elastic) ? n : mps_elastic_facet_count(p->elastic);
  int64_t *list = malloc((size_t)room * sizeof *list);
  if (!app_agree(p->a, list || app_no_memory(p->a))) {
    free(list);
    return false;
  }
  bool done = slide(p, method, 0, p->wall, list, room) && pull(p, 0, list, room);
  if (p->def->hole) {
    done = done && slide(p, method, 1, 0.0, list, room) && pull(p, 1, list, room);
  } else { /* against sliding as a whole */
    const double middle[2] = {p->wall, 0.0};
    list[0] = mps_particles_nearest(p->particles, middle);
    mps_view x;
    done = done && app_check(p->a, mps_particles_view(p->particles, "position", &x));
    double at[2] = {p->wall, 0.0}, u[2];
    if (done) at[1] = *mps_view_f64(&x, mps_particles_index(p->particles, list[0]), 1);
    plate_exact_displacement(p, at, u);
    done = done && elastic_hold(p->a, p->elastic, 1, 1, list, &u[1]);
  }
  free(list);
  return done;
}

/* ---- results --------------------------------------------------------------------------------- */

bool plate_get(const plate *p, int64_t k, elastic_point *out) {
  return elastic_point_get(p->a, p->particles, k, out);
}

bool plate_on_ligament(const plate *p, const elastic_point *at) {
  return p->def->hole && fabs(at->x[0]) < 0.25 * p->spacing;
}

/* Solves the 3 x 3 normal equations by Cramer's rule. */
static double determinant(const double a[3][3]) {
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
         a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
         a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/* The lattice makes a staircase of the hole, which disturbs a few layers. The stress at its edge is
 * that of c0 + c1 (a/r)^2 + c2 (a/r)^4, the form of the exact solution, fitted over the ligament
 * from four layers outside the edge to three radii. */
static bool find_concentration(plate *p) {
  double a[3][3] = {{0}}, b[3] = {0}, edge = 0.0;
  for (int64_t k = 0; k < mps_particles_count(p->particles); k++) {
    elastic_point at;
    if (!plate_get(p, k, &at)) return false;
    if (!plate_on_ligament(p, &at) || at.x[1] < p->def->radius + 4.0 * p->spacing ||
        at.x[1] > 3.0 * p->def->radius)
      continue;
    const double q = pow(p->def->radius / at.x[1], 2), f[3] = {1.0, q, q * q};
    for (int i = 0; i < 3; i++) {
      b[i] += f[i] * at.stress[0] / p->def->tension;
      for (int j = 0; j < 3; j++) a[i][j] += f[i] * f[j];
    }
  }
  const double whole = determinant((const double(*)[3])a);
  for (int c = 0; c < 3; c++) {
    double m[3][3];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) m[i][j] = j == c ? b[i] : a[i][j];
    edge += determinant((const double(*)[3])m) / whole;
  }
  p->concentration = edge;
  return true;
}

static bool find_errors(plate *p) {
  double wrong = 0.0, all = 0.0, largest = 0.0;
  mps_view principal;
  if (!app_check(p->a, mps_particles_view(p->particles, "principal", &principal))) return false;
  for (int64_t k = 0; k < mps_particles_count(p->particles); k++) {
    elastic_point at;
    double exact[3], u[2];
    if (!plate_get(p, k, &at)) return false;
    plate_exact_stress(p->def, at.x, exact);
    plate_exact_displacement(p, at.x, u);
    for (int c = 0; c < 3; c++) {
      const double weight = c == 2 ? 2.0 : 1.0;
      wrong += weight * (at.stress[c] - exact[c]) * (at.stress[c] - exact[c]);
      all += weight * exact[c] * exact[c];
    }
    for (int c = 0; c < 2; c++) largest = fmax(largest, fabs(at.u[c] - u[c]));
    p->largest = fmax(p->largest, *mps_view_f64(&principal, k, 0) / p->def->tension);
  }
  p->stress_error = sqrt(wrong / all);
  if (p->def->hole) return find_concentration(p);
  const double end[2] = {p->def->side, 0.0};
  elastic_point at;
  double u[2];
  const int64_t id = mps_particles_nearest(p->particles, end);
  if (!plate_get(p, mps_particles_index(p->particles, id), &at)) return false;
  plate_exact_displacement(p, at.x, u);
  p->end = at.u[0];
  p->end_exact = u[0];
  p->displacement_error = largest / fabs(u[0]);
  return true;
}

bool plate_solve(app *a, const plate_def *def, const elastic_method *method, plate *out) {
  *out = (plate){.a = a, .def = def};
  return app_agree(a, make_particles(out)) &&
         elastic_make(a, out->particles, method, &out->elastic) && support_and_load(out, method) &&
         app_check(a, mps_elastic_solve(out->elastic)) &&
         app_check(a, mps_elastic_update_stress(out->elastic)) &&
         app_check(a, mps_elastic_get_report(out->elastic, &out->report)) && find_errors(out);
}

void plate_free(plate *p) {
  mps_elastic_destroy(&p->elastic);
  mps_particles_destroy(&p->particles);
}
