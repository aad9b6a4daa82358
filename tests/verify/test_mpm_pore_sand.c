/* test_mpm_pore_sand.c - a strip on sand without dilation, that flows out under it. Undrained,
 * shear leaves the mean effective stress as it is, so that sand under the stress p0 on all sides
 * has the strength c cos(phi) + p0 sin(phi), however far it has flowed. Dry, its columns come apart
 * as they pass the strip's edges, whose load goes from one to the next.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define HALF 0.4 /* m, half width of the strip */
#define WIDTH 1.6
#define DEPTH 0.8
#define REST 20e3 /* Pa, effective stress at rest on all sides, and surcharge */
#define COHESION 2e3
#define PHI 0.523598775598298873
#define POROSITY 0.4

enum { PARTS = 6, MANY = 30, MOST = 100 };

static double strength(void) { return COHESION * cos(PHI) + REST * sin(PHI); }

/* Half of the ground, without weight, and the surcharge on its highest particles. */
static mpm_scene make_ground(double h, double young, bool dry) {
  mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, young);
  const double high = h * round(DEPTH / h), wide = h * round(WIDTH / h);
  mpm_scene_box(&s, 0.0, 0.0, wide, high);
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  OK(mps_particles_add_field(s.particles, "stress", 0));
  for (int c = 0; c < 3; c++) OK(mps_particles_set(s.particles, "stress", c, -REST));
  DEF(material_mohr_coulomb, sand, .young = young, .poisson = 0.3, .friction = PHI,
      .cohesion = COHESION);
  mps_material_destroy(&s.material);
  OK(mps_material_create_mohr_coulomb(context, &sand, &s.material));
  USING(mpm, mps_mpm_create(context, s.particles, s.material, &given, &s.mpm), .cell = h,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = wide);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  const double modulus = young * 0.7 / (1.3 * 0.4);
  DEF(pore_water, water, .porosity = POROSITY, .bulk = 10.0 * POROSITY * modulus);
  if (!dry) OK(mps_mpm_add_pore_water(s.mpm, &water));
  const mps_view x = mpm_scene_view(&s, "position"), id = mpm_scene_view(&s, "id");
  int64_t ids[MOST], count = 0;
  for (int64_t k = 0; k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 1) > high - 0.5 * h) {
      assert_true(count < MOST);
      ids[count++] = *mps_view_i64(&id, k, 0);
    }
  USING(mpm_load, mps_mpm_add_load(s.mpm, &given, NULL), .ids = ids, .id_count = count,
        .traction[1] = -REST);
  return s;
}

/* Presses the strip by `far` q/E half widths, q the capacity of undrained sand; its load over q, of
 * each of the parts of the way. */
static void press(double cells, double young, double far, bool dry, int parts, double *out) {
  const double h = HALF / cells, exact = 5.14159265358979323846 * strength();
  const double way = far * exact / young * HALF, speed = 0.01 * sqrt(3e7 / young);
  scoped_mpm_scene s = make_ground(h, young, dry);
  scoped_contact *contact = NULL;
  DEF(body, body, .position[1] = h * round(DEPTH / h) + 2.0 * h);
  MAKE(body, strip, create_box, context, &body, 2.0 * HALF, 4.0 * h);
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = -speed);
  OK(mps_body_set_motion(strip, &motion));
  USING(contact, mps_mpm_add_contact(s.mpm, strip, &given, &contact), .inset = 0.75 * h);
  double before = 0.0;
  for (int k = 0; k < parts; k++) {
    mps_reaction r;
    OK(mps_mpm_run(s.mpm, way / speed * (k + 1) / parts, 1000000, NULL, NULL));
    OK(mps_contact_get_reaction(contact, -1, &r));
    out[k] = (r.impulse[1] - before) / (way / speed / parts) / HALF / exact;
    before = r.impulse[1];
  }
}

/* On three grids, an edge between lines of nodes, two stiffnesses. With a mean stress of its own
 * for each particle sand bore 1.42 to 1.69 times as much at the end, 1.19 to 1.39 times what it did
 * after a third of the way. */
TEST(keeps_its_undrained_strength) {
  static const double cells[] = {3.0, 3.5, 4.0}, young[] = {3e7, 3e7, 1.2e8};
  for (int k = 0; k < 3; k++) {
    double q[PARTS];
    press(cells[k], young[k], 30.0, false, PARTS, q);
    print_message("%g cells, E %g MPa: q over the exact one %.3f, %.3f, %.3f, %.3f\n", cells[k],
                  young[k] / 1e6, q[1], q[2], q[4], q[5]);
    NEAR(q[1], 1.0, 0.15);
    NEAR(q[5], q[1], 0.08 * q[1]);
  }
}

/* With columns stretched to 1.4 spacings no particle was near enough to an edge to bear there, and
 * the whole load fell by 14, 48 and 28 % from one part of the way to the next, up to .94 of it at
 * a tenth of the speed. */
TEST(hands_its_edges_on) {
  static const double cells[] = {2.5, 3.0, 3.0, 3.25}, young[] = {3e7, 3e7, 1e7, 3e7};
  static const double far[] = {180.0, 180.0, 90.0, 90.0};
  for (int k = 0; k < 4; k++) {
    double q[MANY], drop = 0.0;
    press(cells[k], young[k], far[k], true, MANY, q);
    for (int i = 5; i < MANY; i++) drop = fmax(drop, 1.0 - q[i] / q[i - 1]);
    print_message("dry, %g cells, E %g MPa: %.2f, at the end %.2f, falls by at most %.3f\n",
                  cells[k], young[k] / 1e6, q[8], q[MANY - 1], drop);
    assert_true(drop < 0.1);
  }
}
