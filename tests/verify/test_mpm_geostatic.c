/* test_mpm_geostatic.c - ground that starts with its stress at rest stays at rest in the WLS-MPM
 * solver: two layers, plane strain and axisymmetric, quadratic and cubic.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include <mps/geostatic.h>

#define GRAVITY 10.0
#define HEIGHT 2.0

/* 0.8 m of 1500 kg/m3 over 2000 kg/m3; K0 is that of elastic ground. The kernels that a wall cuts
 * do not integrate even a constant stress exactly, so that the stress within their reach moves by
 * `near_wall` of the largest; `inside` is that of the rest. */
static void stay_at_rest(int32_t geometry, int32_t spline, double inside, double near_wall) {
  const double k0 = 0.3 / 0.7;
  const mps_soil_layer layers[] = {{0.8, k0, 0.0}, {INFINITY, k0, 0.0}};
  const double full = GRAVITY * (1500.0 * 0.8 + 2000.0 * 1.2);
  mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 2e7);
  mpm_scene_box(&s, 0.0, 0.0, 0.4, HEIGHT);
  mps_assert_ok(context, mps_particles_set(s.particles, "density", 0, 2000.0));
  mps_view x = mpm_scene_view(&s, "position"), rho = mpm_scene_view(&s, "density");
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 1) > HEIGHT - 0.8) *mps_view_f64(&rho, k, 0) = 1500.0;
  mps_geostatic_def ground = mps_geostatic_defaults();
  ground.layers = layers;
  ground.layer_count = 2;
  ground.gravity = GRAVITY;
  mps_assert_ok(context, mps_particles_set_geostatic(s.particles, &ground));
  double before[320];
  mps_view stress = mpm_scene_view(&s, "stress"), id = mpm_scene_view(&s, "id");
  assert_int_equal(x.shape[0], 320);
  for (int64_t k = 0; k < 320; k++) before[*mps_view_i64(&id, k, 0)] = *mps_view_f64(&stress, k, 1);
  mps_mpm_def def = mps_mpm_defaults();
  def.geometry = geometry;
  def.spline = spline;
  def.cell = 0.1;
  def.lower[0] = def.lower[1] = 0.0;
  def.upper[0] = 0.4;
  def.gravity[1] = -GRAVITY;
  mps_assert_ok(context, mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  double fastest = 0.0, change[2] = {0.0};
  for (int look = 1; look <= 20; look++) { /* more than a period, 4 H/c = 0.07 s */
    mps_assert_ok(context, mps_mpm_run(s.mpm, 0.005 * look, 1000000, NULL, NULL));
    mps_view v = mpm_scene_view(&s, "velocity");
    stress = mpm_scene_view(&s, "stress"), id = mpm_scene_view(&s, "id");
    x = mpm_scene_view(&s, "position");
    for (int64_t k = 0; k < 320; k++) {
      const double y = *mps_view_f64(&x, k, 1), old = before[*mps_view_i64(&id, k, 0)];
      double *largest = &change[y > 0.4 && y < HEIGHT - 0.2];
      *largest = fmax(*largest, fabs(*mps_view_f64(&stress, k, 1) - old) / full);
      fastest = fmax(fastest, fabs(*mps_view_f64(&v, k, 1)));
    }
  }
  print_message("geometry %d, spline %d: at most %.2g mm/s; stress moves by %.2g of the largest, "
                "%.2g at the ends\n",
                (int)geometry, (int)spline, 1e3 * fastest, change[1], change[0]);
  assert_true(fastest < 1e-3); /* free fall in this time: 1 m/s */
  assert_true(change[1] < inside);
  assert_true(change[0] < near_wall);
  mpm_scene_end(&s);
}

static void layers_stay_at_rest(void **state) {
  (void)state;
  stay_at_rest(MPS_MPM_PLANE_STRAIN, 2, 1e-3, 4e-3);
  stay_at_rest(MPS_MPM_AXISYMMETRIC, 2, 4e-3, 0.012);
  stay_at_rest(MPS_MPM_PLANE_STRAIN, 3, 4e-3, 0.025);
  stay_at_rest(MPS_MPM_AXISYMMETRIC, 3, 6e-3, 0.045);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(layers_stay_at_rest)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
