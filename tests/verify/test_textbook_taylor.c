/* test_textbook_taylor.c - Taylor's bar: a copper rod of 32.4 x 6.4 mm hits a smooth rigid wall
 * with 227 m/s, von Mises with linear hardening. No closed form: finite elements have a final
 * length of 21.3 to 21.5 mm and a foot of 7.0 to 7.2 mm radius. WLS-MPM in axisymmetry.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "test_fixture.h"
#include "textbook_table.h"

#define LENGTH 32.4e-3
#define RADIUS 3.2e-3
#define SPEED 227.0
#define END 80e-6 /* s */

static mps_material *copper(void) {
  DEF(material_von_mises, def, .young = 117e9, .poisson = 0.35, .yield_stress = 400e6,
      .hardening = 100e6);
  MAKE_KEPT(material, m, create_von_mises, context, &def);
  return m;
}

/* Length, and radius of the foot, of particles of the size that they have now. */
static void shape_of(mpm_scene *s, double spacing, double *length, double *radius) {
  const mps_view x = mpm_scene_view(s, "position"), strain = mpm_scene_view(s, "plastic_strain");
  FILE *f = textbook_table("taylor", "r_m,z_m,plastic_strain");
  double low = 1.0, high = 0.0;
  *radius = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double r = *mps_view_f64(&x, k, 0), z = *mps_view_f64(&x, k, 1);
    low = fmin(low, z), high = fmax(high, z);
    *radius = fmax(*radius, r);
    textbook_row(f, 3, (double[]){r, z, *mps_view_f64(&strain, k, 0)});
  }
  textbook_close(f);
  *length = high - low + spacing;
  *radius += 0.5 * spacing;
}

static void hit(int cells, double *length, double *radius) {
  const double h = RADIUS / cells, began = textbook_cost();
  scoped_mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 117e9);
  mps_material_destroy(&s.material);
  s.material = copper();
  mpm_scene_box(&s, 0.0, 0.0, RADIUS, LENGTH);
  OK(mps_particles_set(s.particles, "density", 0, 8930.0));
  const double down[2] = {0.0, -SPEED}, still[4] = {0.0};
  mpm_scene_affine(&s, down, still);
  DEF(mpm, def, .geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC, .cell = h, .lower[1] = 0.0);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.0);
  OK(mps_mpm_run(s.mpm, END, 1000000, NULL, NULL));
  shape_of(&s, 0.5 * h, length, radius);
  const mps_totals t = mpm_scene_totals(&s);
  print_message("radius of %d cells: length %.3f mm, foot %.3f mm, velocity %.2f m/s, %.1f s\n",
                cells, 1e3 * *length, 1e3 * *radius, t.linear[1] / t.mass, textbook_cost() - began);
}

TEST(is_as_short_as_measured) {
  double length, radius;
  for (int cells = 4; cells <= 16; cells *= 2) hit(cells, &length, &radius);
  NEAR(length, 21.4e-3, 0.03 * 21.4e-3);
  NEAR(radius, 7.1e-3, 0.05 * 7.1e-3);
}
