/* elastic.c - see elastic.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic.h"

#include "common/ranks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

int elastic_prefer(const options_program *program, const elastic_settings *s,
                   const option_preset *paper) {
  static const option_preset method[] = {{"method", "published"}, {0}};
  if (!s->paper) return -1;
  const int code = options_prefer(program, method);
  return code >= 0 ? code : options_prefer(program, paper);
}

elastic_method elastic_settings_method(const elastic_settings *s) {
  mps_elastic_def def = mps_elastic_defaults();
  def.state = s->state == 1 ? MPS_ELASTIC_STATE_PLANE_STRAIN : MPS_ELASTIC_STATE_PLANE_STRESS;
  def.alpha = s->alpha;
  def.radius_ratio = s->radius_ratio;
  return (elastic_method){.def = def, .published = s->method == 1, .constant = s->divisor == 1};
}

bool elastic_make(app *a, mps_particles *particles, const elastic_method *method,
                  mps_elastic **out) {
  mps_elastic_def def = method->def;
  char why[300];
  def.domain = a->domain;
  const bool made = method->published
                        ? app_check(a, mps_experimental_elastic_published(
                                           a->context, particles, &def, method->constant, out))
                        : app_check(a, mps_elastic_create(a->context, particles, &def, out));
  if (!made || !a->domain || method->published) return made; /* that, each rank solves alone */
  return ranks_solve(mps_elastic_solver(*out), MPS_LINEAR_EQUATION_STIFFNESS, 0, &a->equations, why,
                     sizeof why) ||
         app_error(a, "%s", why);
}

double elastic_seconds(double particles) { return 1e-4 * particles * pow(1e-5 * particles, 0.17); }

void elastic_bar(app *a, double done, double share, double seconds) {
  const double threads = (double)mps_context_threads(a->context);
  progress_part(&a->bar, done, share, 0.0, 0.0);
  progress_by_clock(&a->bar, seconds / (0.4 + 0.6 * threads), "solving");
}

#define SMALL 0.05 /* of a length: displacements for which the theory of small ones is one */

void elastic_warn(app *a, const option *table, const char *of, double displacement, double length) {
  const bool as_printed = options_given(table, "paper"); /* E of 1 Pa and a load of 1 N/m */
  if (as_printed && !options_given(table, "young") && !options_given(table, of)) return;
  if (fabs(displacement) > SMALL * length)
    app_warn(a,
             "the displacement of %.3g m is more than %g of the length of %g m: displacements are "
             "computed as small ones",
             displacement, SMALL, length);
}

void elastic_tell(const app *a, const mps_elastic_report *report) {
  if (a->domain)
    printf("%lld iterations of %d ranks, %.3f s\n", (long long)report->iterations,
           (int)mps_domain_size(a->domain), report->seconds_solve);
  else
    printf("%lld entries in the factor, factorised in %.3f s\n", (long long)report->factor_nonzeros,
           report->seconds_factor);
}

bool elastic_hold(app *a, mps_elastic *elastic, int32_t component, int64_t count,
                  const int64_t *ids, const double *values) {
  mps_elastic_boundary_def def = mps_elastic_boundary_defaults();
  double *all = calloc((size_t)(3 * count + 1), sizeof *all);
  if (!all) return app_no_memory(a);
  for (int64_t k = 0; values && k < count; k++) all[3 * k + component] = values[k];
  def.ids = ids;
  def.id_count = count;
  def.dofs = 1u << component;
  def.kind = MPS_BOUNDARY_DRIVEN;
  def.values = all;
  const bool done = app_check(a, mps_elastic_add_boundary(elastic, &def, NULL));
  free(all);
  return done;
}

bool elastic_pull(app *a, mps_elastic *elastic, int64_t count, const int64_t *facets,
                  mps_elastic_traction_fn traction, void *user) {
  mps_elastic_load_def def = mps_elastic_load_defaults();
  def.kind = MPS_ELASTIC_LOAD_FUNCTION;
  def.ids = facets;
  def.id_count = count;
  def.function = traction;
  def.user = user;
  return app_check(a, mps_elastic_add_load(elastic, &def, NULL));
}

const char *elastic_method_name(const elastic_settings *s) {
  return s->method == 1 ? "published" : "conservative";
}

bool elastic_point_get(app *a, mps_particles *particles, int64_t index, elastic_point *out) {
  static const int32_t component[3] = {0, 1, 3};
  mps_view x, u, stress, mises;
  if (!app_check(a, mps_particles_view(particles, "position", &x)) ||
      !app_check(a, mps_particles_view(particles, "displacement", &u)) ||
      !app_check(a, mps_particles_view(particles, "stress", &stress)) ||
      !app_check(a, mps_particles_view(particles, "von_mises", &mises)))
    return false;
  for (int32_t c = 0; c < 2; c++) {
    out->x[c] = *mps_view_f64(&x, index, c);
    out->u[c] = *mps_view_f64(&u, index, c);
  }
  for (int c = 0; c < 3; c++) out->stress[c] = *mps_view_f64(&stress, index, component[c]);
  out->mises = *mps_view_f64(&mises, index, 0);
  return true;
}
