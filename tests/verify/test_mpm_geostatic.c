/* test_mpm_geostatic.c - ground that starts with its stress at rest stays at rest in the WLS-MPM
 * solver: two layers, plane strain and axisymmetric, quadratic and cubic, on a roller and a fixed
 * floor, which are mirrors or, for comparison, fitted.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define GRAVITY 10.0
#define HEIGHT 2.0

/* Parts of the column: by how much of the largest stress theirs moves. */
typedef struct part_changes {
  double floor, inside, surface;
} part_changes;

/* 0.8 m of 1500 kg/m3 over 2000 kg/m3; K0 is that of elastic ground. */
static part_changes rest(int32_t geometry, int32_t spline, int32_t walls, int32_t floor) {
  const double k0 = 0.3 / 0.7;
  const mps_geostatic_layer layers[] = {{0.8, k0, NAN}, {INFINITY, k0, NAN}};
  const double full = GRAVITY * (1500.0 * 0.8 + 2000.0 * 1.2);
  scoped_mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 2e7);
  mpm_scene_box(&s, 0.0, 0.0, 0.4, HEIGHT);
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(rho, s.particles, "density")
    for (int64_t k = 0; k < x.shape[0]; k++)
      if (*mps_view_f64(&x, k, 1) > HEIGHT - 0.8) *mps_edit_f64(&rho, k, 0) = 1500.0;
  DEF(geostatic, ground, .layers = layers, .layer_count = 2, .gravity = GRAVITY);
  OK(mps_particles_set_geostatic(s.particles, &ground));
  double before[320];
  mps_view stress = mpm_scene_view(&s, "stress"), id = mpm_scene_view(&s, "id");
  assert_int_equal(x.shape[0], 320);
  for (int64_t k = 0; k < 320; k++) before[*mps_view_i64(&id, k, 0)] = *mps_view_f64(&stress, k, 1);
  DEF(mpm, def, .geometry = geometry, .spline = spline, .cell = 0.1, .lower[0] = def.lower[1] = 0.0,
      .upper[0] = 0.4, .edge = walls, .gravity[1] = -GRAVITY);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, floor, 0.0);
  double fastest = 0.0;
  part_changes change = {0.0, 0.0, 0.0};
  for (int look = 1; look <= 20; look++) { /* more than a period, 4 H/c = 0.07 s */
    OK(mps_mpm_run(s.mpm, 0.005 * look, 1000000, NULL, NULL));
    mps_view v = mpm_scene_view(&s, "velocity");
    stress = mpm_scene_view(&s, "stress"), id = mpm_scene_view(&s, "id");
    x = mpm_scene_view(&s, "position");
    for (int64_t k = 0; k < 320; k++) {
      const double y = *mps_view_f64(&x, k, 1), old = before[*mps_view_i64(&id, k, 0)];
      double *largest = y < 0.4            ? &change.floor
                        : y < HEIGHT - 0.2 ? &change.inside
                                           : &change.surface;
      *largest = fmax(*largest, fabs(*mps_view_f64(&stress, k, 1) - old) / full);
      fastest = fmax(fastest, fabs(*mps_view_f64(&v, k, 1)));
    }
  }
  print_message(
      "geometry %d, spline %d, %s floor, %s: at most %.2g mm/s; stress moves by %.3g %% at "
      "the floor, %.3g %% at the surface, %.3g %% elsewhere\n",
      (int)geometry, (int)spline, floor == MPS_BOUNDARY_HELD ? "fixed" : "roller",
      walls == MPS_MPM_EDGE_FIT ? "fit" : "mirror", 1e3 * fastest, 100.0 * change.floor,
      100.0 * change.surface, 100.0 * change.inside);
  assert_true(fastest < 1e-3); /* free fall in this time: 1 m/s */
  return change;
}

/* Mirrors leave the error of the particles' quadrature; the surface has half-filled cells. */
TEST(layers_stay_at_rest) {
  static const int32_t floors[] = {MPS_BOUNDARY_ROLLER, MPS_BOUNDARY_HELD};
  for (int32_t geometry = MPS_MPM_GEOMETRY_PLANE_STRAIN; geometry <= MPS_MPM_GEOMETRY_AXISYMMETRIC;
       geometry++)
    for (int32_t spline = 2; spline <= 3; spline++)
      for (int k = 0; k < 2; k++) {
        const double most = geometry == MPS_MPM_GEOMETRY_PLANE_STRAIN ? 8e-4 : 3e-3;
        const part_changes c = rest(geometry, spline, MPS_MPM_EDGE_MIRROR, floors[k]);
        assert_true(c.floor < most);
        assert_true(c.inside < most);
        assert_true(c.surface < (spline == 2 ? 2.5e-3 : 1e-3));
      }
}

/* The kernels that a wall cuts do not integrate even a constant stress exactly. */
TEST(fit_moves_it_at_walls) {
  static const double most[2][2] = {{4e-3, 0.025}, {0.012, 0.045}};
  for (int32_t geometry = MPS_MPM_GEOMETRY_PLANE_STRAIN; geometry <= MPS_MPM_GEOMETRY_AXISYMMETRIC;
       geometry++)
    for (int32_t spline = 2; spline <= 3; spline++) {
      const part_changes c = rest(geometry, spline, MPS_MPM_EDGE_FIT, MPS_BOUNDARY_ROLLER);
      assert_true(c.floor < most[geometry][spline - 2]);
      assert_true(c.inside < 6e-3);
    }
}
