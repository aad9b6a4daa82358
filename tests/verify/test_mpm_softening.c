/* test_mpm_softening.c - a column of softening clay is sheared until a band has slipped: with the
 * length of the law the work is that of the slip, whatever the grid; without, it follows the grid.
 * The nodes keep their level, so that the column is one-dimensional though its sides are free.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "test_fixture.h"

#define SU 10e3
#define RESIDUAL 0.3
#define SLIP 0.05
#define HEIGHT 1.0
#define SHEAR 1e6
#define DENSITY 2000.0
#define TRAVEL 0.1 /* m, of the top */
#define SPEED 0.1  /* m/s; a shear wave has 22 */
#define ROOT3 1.7320508075688772

/* The law; the seed, half a cell on either side of mid-height, is weaker by 2 %. */
static mps_material *clay(double share, double band) {
  DEF(material_von_mises, def, .young = 2.6 * SHEAR, .poisson = 0.3,
      .yield_stress = ROOT3 * SU * share, .residual = RESIDUAL, .slip = SLIP, .band = band);
  MAKE_KEPT(material, m, create_von_mises, context, &def);
  return m;
}

/* The stress falls to residual and the band slips by the rest of the travel; what the column keeps
 * in elastic strain, t^2/(2 G) a volume, is small. */
static double exact_work(void) {
  double slip = TRAVEL, stress = 0.0;
  for (int i = 0; i < 50; i++) {
    stress = SU * (RESIDUAL + (1.0 - RESIDUAL) * exp(-slip / SLIP));
    slip = TRAVEL - stress / SHEAR * HEIGHT;
  }
  return SU * (RESIDUAL * slip + (1.0 - RESIDUAL) * SLIP * (1.0 - exp(-slip / SLIP))) +
         0.5 * stress * stress / SHEAR * HEIGHT;
}

/* J/m2. `band` in cells of the grid, or in m where `fixed`. */
static double work_of(int cells, int32_t spline, double band, bool fixed) {
  const double h = HEIGHT / cells, width = 4.0 * h;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e6);
  mps_material_destroy(&s.material);
  const double length = fixed ? band : band * h;
  s.material = clay(1.0, length);
  scoped_material *seed = clay(0.98, length);
  mpm_scene_box(&s, 0.0, 0.0, width, HEIGHT);
  OK(mps_particles_set(s.particles, "density", 0, DENSITY));
  DEF(mpm, def, .cell = h, .spline = spline, .local_damping = 0.05, .lower[0] = -4.0 * h,
      .upper[0] = width + h * (4.0 + ceil(TRAVEL / h)), .lower[1] = 0.0, .upper[1] = HEIGHT);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  int64_t ids[64], count = 0;
  mps_view x = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (fabs(*mps_view_f64(&x, k, 1) - 0.5 * HEIGHT) < 0.5 * h)
      ids[count++] = *mps_view_i64(&id, k, 0);
  OK(mps_mpm_set_material(s.mpm, seed, ids, count));
  const double t[2] = {0.0, 10.0}, v[2] = {SPEED, SPEED};
  MAKE(signal, go, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  mpm_scene_drive(&s, MPS_SIDE_Y_UPPER, MPS_BOUNDARY_DRIVEN, 0.0, 0, go, 1.0);
  DEF(mpm_boundary, level, .dofs = MPS_DOF_Y, .lower[1] = 0.01 * h, .upper[1] = HEIGHT - 0.01 * h);
  OK(mps_mpm_add_boundary(s.mpm, &level, NULL));
  OK(mps_mpm_run(s.mpm, TRAVEL / SPEED, 10000000, NULL, NULL));
  mps_reaction r;
  OK(mps_mpm_get_reaction(s.mpm, MPS_SIDE_Y_UPPER, &r));
  const double work = r.work / width;
  print_message("H/h %d, spline %d, band %g %s: %.1f J/m2, exact %.1f (%+.1f %%)\n", cells,
                (int)spline, band, fixed ? "m" : "cells", work, exact_work(),
                100.0 * (work / exact_work() - 1.0));
  return work;
}

TEST(the_length_makes_the_work_that_of_the_slip) {
  static const double band[2] = {1.4, 1.5};
  for (int32_t spline = 2; spline <= 3; spline++) {
    double work[2];
    for (int k = 0; k < 2; k++) {
      work[k] = work_of(20 << k, spline, band[spline - 2], false);
      assert_true(fabs(work[k] / exact_work() - 1.0) < 0.05);
    }
    assert_true(fabs(work[1] / work[0] - 1.0) < 0.015);
  }
}

TEST(without_it_the_work_follows_the_grid) {
  const double coarse = work_of(20, 3, 0.12, true), fine = work_of(40, 3, 0.12, true);
  assert_true(fine < 0.93 * coarse);
}
