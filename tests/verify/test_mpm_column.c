/* test_mpm_column.c - the WLS-MPM solver against exact solutions: a column under its own weight,
 * the period of a bar, an axisymmetric cylinder and a column in space under their weight, and a
 * slab in space that does what plane strain does.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

/* A column between rollers, of height 1 m, starts with the stress of its weight and stays at rest:
 * sigma_yy = -rho g depth, sigma_xx = K0 sigma_yy, exact for linear stress. */
static void column_at_rest(int32_t geometry) {
  const int dim = geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2;
  const double rho = 1000.0, g = 10.0, K0 = 0.3 / 0.7;
  const double lo[] = {0.0, 0.0, 0.0}, hi[] = {dim == 3 ? 0.12 : 0.2, 1.0, 0.08};
  scoped_mpm_scene s = mpm_scene_begin_in(context, dim, 0.02, 0.0, 0.0, 1e7);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  mpm_scene_weigh(&s, rho * g, K0, 1.0);
  DEF(mpm, def, .geometry = geometry, .cell = 0.04);
  for (int c = 0; c < dim; c++) {
    def.lower[c] = 0.0;
    if (c != 1) def.upper[c] = hi[c];
  }
  def.gravity[1] = -g;
  mpm_scene_solve(&s, &def);
  OK(mps_mpm_run(s.mpm, 0.2, 1000000, NULL, NULL));
  const double worst = mpm_scene_weight_error(&s, rho * g, 1.0);
  print_message("geometry %d: stress within %.2g\n", geometry, worst);
  assert_true(worst < 0.03);
}

TEST(own_weight) {
  column_at_rest(MPS_MPM_GEOMETRY_PLANE_STRAIN);
  column_at_rest(MPS_MPM_GEOMETRY_AXISYMMETRIC);
  column_at_rest(MPS_MPM_GEOMETRY_SPACE);
}

/* A block that is thrown against the walls, in plane strain or as a slab of one cell in space. */
static mpm_scene thrown(int dim, int32_t volumetric) {
  const double lo[] = {0.1, 0.05, 0.0}, hi[] = {0.3, 0.15, 0.02};
  const double v0[] = {-2.0, -1.0, 0.0};
  const double plane[] = {1.0, -9.0, 7.0, -3.0};
  const double space[] = {1.0, -9.0, 0.0, 7.0, -3.0, 0.0, 0.0, 0.0, 0.0};
  mpm_scene s = mpm_scene_begin_in(context, dim, 0.01, 0.003, 0.0, 1e5);
  OK(mps_particles_fill_box(s.particles, lo, hi, NULL));
  mpm_scene_affine(&s, v0, dim == 3 ? space : plane);
  DEF(mpm, def, .geometry = dim == 3 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_PLANE_STRAIN,
      .volumetric = volumetric, .cell = 0.02);
  for (int c = 0; c < dim; c++) def.lower[c] = 0.0;
  def.upper[2] = 0.02;
  def.gravity[1] = -9.81;
  mpm_scene_solve(&s, &def);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  OK(mps_mpm_step(s.mpm, 300));
  return s;
}

static void compare_slab(int32_t volumetric) {
  scoped_mpm_scene plane = thrown(2, volumetric), slab = thrown(3, volumetric);
  mps_view x = mpm_scene_view(&plane, "position"), X = mpm_scene_view(&slab, "position");
  mps_view stress = mpm_scene_view(&plane, "stress"), S = mpm_scene_view(&slab, "stress");
  const int64_t count = x.shape[0];
  assert_int_equal(X.shape[0], 2 * count);
  double moved = 0.0, strained = 0.0;
  for (int64_t id = 0; id < 2 * count; id++) { /* the lattice is filled layer by layer */
    const int64_t k = mps_particles_index(plane.particles, id % count);
    const int64_t K = mps_particles_index(slab.particles, id);
    for (int c = 0; c < 2; c++)
      moved = fmax(moved, fabs(*mps_view_f64(&X, K, c) - *mps_view_f64(&x, k, c)));
    for (int c = 0; c < 4; c++)
      strained = fmax(strained, fabs(*mps_view_f64(&S, K, c) - *mps_view_f64(&stress, k, c)));
    NEAR(*mps_view_f64(&X, K, 2), id < count ? 0.005 : 0.015, 1e-14);
  }
  print_message("slab against plane strain: %.2g m, %.2g Pa\n", moved, strained);
  assert_true(moved < 1e-12);
  assert_true(strained < 1e-6);
}

TEST(slab_is_plane_strain) {
  compare_slab(MPS_MPM_VOLUMETRIC_POINT);
  compare_slab(MPS_MPM_VOLUMETRIC_CELL);
}

/* Axial vibration between rollers, fixed at the bottom, free at the top: period 4 L/c. */
TEST(bar_period) {
  const double E = 1e6, rho = 1000.0, length = 1.0;
  const double c = sqrt(E * 0.7 / (1.3 * 0.4) / rho), period = 4.0 * length / c;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, E);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, length);
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&v, k, 1) = 0.01 * sin(0.5 * PI * *mps_view_f64(&x, k, 1) / length);
  DEF(mpm, def, .cell = 0.02, .lower[0] = def.lower[1] = 0.0, .upper[0] = 0.1);
  mpm_scene_solve(&s, &def);
  /* zero crossings of the total momentum: at 1/4, 3/4, ... of a period */
  double crossing[3], before = mpm_scene_totals(&s).linear[1], t_before = 0.0;
  int found = 0;
  while (found < 3) {
    OK(mps_mpm_step(s.mpm, 1));
    const double now = mpm_scene_totals(&s).linear[1], t = mps_mpm_time(s.mpm);
    if (now * before < 0.0) crossing[found++] = t_before + (t - t_before) * before / (before - now);
    before = now;
    t_before = t;
    assert_true(t < 3.0 * period);
  }
  const double measured = crossing[2] - crossing[0];
  print_message("period %.6g s, exact %.6g s, %+.3f %%\n", measured, period,
                100.0 * (measured / period - 1.0));
  NEAR(measured, period, 0.01 * period);
}
