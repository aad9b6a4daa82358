/* model.c - see model.h. The wall passes through its layer of particles (half cells); the loaded
 * and the free surfaces lie half a spacing outside the particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cantilever.h"

#include <math.h>
#include <stdlib.h>

double model_length(double height, int64_t nx, int64_t ny) {
  return ((double)nx - 0.5) * height / (double)ny;
}

static bool make_particles(model *m) {
  mps_particles_def def = mps_particles_defaults();
  def.spacing = m->spacing;
  def.origin[1] = -0.5 * m->problem->height;
  const double lo[2] = {0.0, -0.5 * m->problem->height};
  const double hi[2] = {(double)m->nx * m->spacing, 0.5 * m->problem->height};
  int64_t added;
  if (!app_check(m->a, mps_particles_create(m->a->context, &def, &m->particles)) ||
      !app_check(m->a, mps_particles_fill_box(m->particles, lo, hi, &added)) ||
      !app_check(m->a, mps_particles_set(m->particles, "young", 0, m->problem->young)) ||
      !app_check(m->a, mps_particles_set(m->particles, "poisson", 0, m->problem->poisson)))
    return false;
  return added == m->nx * m->ny || app_error(m->a, "%lld particles instead of %lld x %lld",
                                             (long long)added, (long long)m->nx, (long long)m->ny);
}

/* ---- supports and loads ---------------------------------------------------------------------- */

static bool support_wall(model *m, const elastic_method *method, int64_t *ids, double *values) {
  const double lo[2] = {m->problem->length - 0.25 * m->spacing, -INFINITY};
  const double hi[2] = {INFINITY, INFINITY};
  int64_t count;
  mps_view x;
  if (!app_check(m->a, mps_particles_select_box(m->particles, lo, hi, m->ny, &count, ids)) ||
      !app_check(m->a, mps_particles_view(m->particles, "position", &x)))
    return false;
  for (int32_t c = 0; c < 2; c++) {
    for (int64_t k = 0; k < count; k++) {
      double u[2];
      beam_wall(m->problem, *mps_view_f64(&x, mps_particles_index(m->particles, ids[k]), 1), u);
      values[k] = u[c];
    }
    if (!elastic_hold(m->a, m->elastic, c, count, ids, values)) return false;
  }
  /* The published method has whole cells everywhere. */
  return method->published ||
         app_check(m->a, mps_elastic_cut(m->elastic, MPS_SIDE_X_UPPER, ids, count));
}

static mps_status end_traction(void *user, const double *x, const double *normal,
                               double *traction) {
  (void)normal;
  beam_traction(user, x[1], traction);
  return MPS_OK;
}

static bool support_and_load(model *m, const elastic_method *method) {
  int64_t *list = malloc((size_t)m->ny * sizeof *list), count;
  double *values = malloc((size_t)m->ny * sizeof *values);
  beam problem = *m->problem;
  bool done = app_agree(m->a, (list && values) || app_no_memory(m->a)) &&
              support_wall(m, method, list, values);
  done = done && app_check(m->a, mps_elastic_select_facets(m->elastic, MPS_SIDE_X_LOWER, NULL, NULL,
                                                           m->ny, &count, list));
  done = done && elastic_pull(m->a, m->elastic, count, list, end_traction, &problem);
  free(list);
  free(values);
  return done;
}

/* ---- results --------------------------------------------------------------------------------- */

bool model_get(const model *m, int64_t i, int64_t j, elastic_point *out) {
  const double at[2] = {((double)i + 0.5) * m->spacing,
                        ((double)j + 0.5) * m->spacing - 0.5 * m->problem->height};
  /* The box was filled row by row along x. */
  const int64_t row = mps_particles_index(m->particles, j * m->nx + i);
  if (!elastic_point_get(m->a, m->particles, row, out)) return false;
  if (fabs(out->x[0] - at[0]) + fabs(out->x[1] - at[1]) < 0.1 * m->spacing) return true;
  const int64_t id = mps_particles_nearest(m->particles, at);
  return elastic_point_get(m->a, m->particles, mps_particles_index(m->particles, id), out);
}

void model_reference(const model *m, const double *x, double *u) {
  if (m->reference)
    q4_at(m->reference, x[0], x[1], u);
  else
    beam_displacement(m->problem, x[0], x[1], u);
}

static bool find_errors(model *m) {
  double wrong = 0.0, all = 0.0, u[2], exact[3];
  elastic_point p;
  for (int64_t i = 0; i < m->nx; i++)
    for (int64_t j = 0; j < m->ny; j++) {
      if (!model_get(m, i, j, &p)) return false;
      const double cell = i == m->nx - 1 ? 0.5 : 1.0;
      beam_stress(m->problem, p.x[0], p.x[1], exact);
      for (int c = 0; c < 3; c++) {
        const double weight = cell * (c == 2 ? 2.0 : 1.0);
        wrong += weight * (p.stress[c] - exact[c]) * (p.stress[c] - exact[c]);
        all += weight * exact[c] * exact[c];
      }
    }
  if (!model_get(m, 0, m->ny / 2, &p)) return false;
  model_reference(m, p.x, u);
  m->tip = p.u[1];
  m->tip_exact = u[1];
  m->tip_error = m->tip / m->tip_exact - 1.0;
  m->stress_error = sqrt(wrong / all);
  double load[3];
  mps_reaction reaction[2]; /* of the two components of the wall */
  mps_totals totals;
  if (!app_check(m->a, mps_elastic_get_load_resultant(m->elastic, NULL, load, NULL)) ||
      !app_check(m->a, mps_elastic_get_reaction(m->elastic, 0, &reaction[0])) ||
      !app_check(m->a, mps_elastic_get_reaction(m->elastic, 1, &reaction[1])) ||
      !app_check(m->a, mps_elastic_get_totals(m->elastic, &totals)))
    return false;
  m->energy = totals.strain;
  m->equilibrium = hypot(load[0] + reaction[0].force[0], load[1] + reaction[1].force[1]) /
                   hypot(load[0], load[1]);
  return true;
}

bool model_solve(app *a, const beam *problem, const q4 *reference, int64_t nx, int64_t ny,
                 const elastic_method *method, model *out) {
  *out = (model){.a = a,
                 .problem = problem,
                 .reference = reference,
                 .nx = nx,
                 .ny = ny,
                 .spacing = problem->height / (double)ny};
  return app_agree(a, make_particles(out)) &&
         elastic_make(a, out->particles, method, &out->elastic) && support_and_load(out, method) &&
         app_check(a, mps_elastic_solve(out->elastic)) &&
         app_check(a, mps_elastic_update_stress(out->elastic)) &&
         app_check(a, mps_elastic_get_report(out->elastic, &out->report)) && find_errors(out);
}

void model_free(model *m) {
  mps_elastic_destroy(&m->elastic);
  mps_particles_destroy(&m->particles);
}
