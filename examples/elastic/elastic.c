/* elastic.c - see elastic.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic.h"

#include <math.h>

elastic_settings elastic_settings_defaults(void) {
  return (elastic_settings){.young = 1.0, .poisson = 0.3, .radius_ratio = NAN, .alpha = 1.0};
}

mps_elastic_def elastic_settings_def(const elastic_settings *s) {
  mps_elastic_def def = mps_elastic_defaults();
  def.method = s->method == 1 ? MPS_ELASTIC_PUBLISHED : MPS_ELASTIC_CONSERVATIVE;
  def.divisor = s->divisor == 1 ? MPS_ELASTIC_CONSTANT : MPS_ELASTIC_LOCAL;
  def.state = s->state == 1 ? MPS_ELASTIC_PLANE_STRAIN : MPS_ELASTIC_PLANE_STRESS;
  def.alpha = s->alpha;
  if (!isnan(s->radius_ratio)) def.radius_ratio = s->radius_ratio;
  return def;
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
