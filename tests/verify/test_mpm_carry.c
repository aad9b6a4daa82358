/* test_mpm_carry.c - a free beam, bent by loads that balance, is carried through the grid of the
 * WLS-MPM solver: its deflection stays that of the beam at rest. With strains by the slope of the
 * fit it grows with the way, whatever the time step.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define LENGTH 1.0
#define DEPTH 0.1
#define YOUNG 1e6 /* Pa */
#define POISSON 0.3
#define DENSITY 1000.0
#define CELL 0.05
#define SPACING 0.025
#define CURVATURE 0.1 /* 1/m, the largest of the beam is twice that, in the middle */
#define ANGLE (PI / 6.0)
#define TIME (20.0 * CELL / 0.3) /* s: 20 cells along x, 27 along y */

static const double speed[2] = {-0.3, 0.4}; /* m/s */

/* Per unit thickness in plane strain; 1/s, the first mode of a free beam. */
static const double bending = YOUNG / (1.0 - POISSON * POISSON) * DEPTH * DEPTH * DEPTH / 12.0;
static double frequency(void) { return 22.37 * sqrt(bending / (DENSITY * DEPTH)); }

/* The beam's curvature is C (1 - cos(2 pi x)), for the load b cos(2 pi x) on its mass; by how much
 * the ends lie above the middle, the shear with it. */
static const double peak = CURVATURE * bending * 4.0 * PI * PI / (DENSITY * DEPTH); /* m/s2 */
static double deflection(void) {
  const double shear = 5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * DEPTH;
  return CURVATURE * (0.125 + 2.0 / (4.0 * PI * PI)) +
         peak * DENSITY * DEPTH / (4.0 * PI * PI) * 2.0 / shear;
}

/* Turns the lattice, loads each particle across the beam, and gives it the speed times `moves`.
 * `along` receives the place of each on the beam. */
static void lay_out(mpm_scene *s, double moves, double *along) {
  static const char *const name[3] = {"position", "velocity", "body_acceleration"};
  mps_edit field[3];
  for (int f = 1; f < 3; f++) OK(mps_particles_add_field(s->particles, name[f], 0));
  for (int f = 0; f < 3; f++) OK(mps_particles_edit(s->particles, name[f], &field[f]));
  for (int64_t k = 0; k < field[0].view.shape[0]; k++) {
    const double r = *mps_view_f64(&field[0].view, k, 0) - 0.5,
                 y = *mps_view_f64(&field[0].view, k, 1);
    const double b = peak * cos(2.0 * PI * (r + 0.5));
    along[k] = r + 0.5;
    *mps_edit_f64(&field[0], k, 0) = 0.5 + cos(ANGLE) * r - sin(ANGLE) * y;
    *mps_edit_f64(&field[0], k, 1) = sin(ANGLE) * r + cos(ANGLE) * y;
    for (int c = 0; c < 2; c++) *mps_edit_f64(&field[1], k, c) = moves * speed[c];
    *mps_edit_f64(&field[2], k, 0) = -sin(ANGLE) * b;
    *mps_edit_f64(&field[2], k, 1) = cos(ANGLE) * b;
  }
  for (int f = 0; f < 3; f++) OK(mps_particles_commit(s->particles, &field[f]));
}

/* Takes a share of all velocities away but that of the whole. */
static void damp(mpm_scene *s, double share, double moves) {
  EDIT(v, s->particles, "velocity")
    EDIT(L, s->particles, "velocity_gradient")
      for (int64_t k = 0; k < v.view.shape[0]; k++) {
        for (int c = 0; c < 2; c++)
          *mps_edit_f64(&v, k, c) -= share * (*mps_view_f64(&v.view, k, c) - moves * speed[c]);
        for (int c = 0; c < 4; c++) *mps_edit_f64(&L, k, c) *= 1.0 - share;
      }
}

/* By how much the ends lie above the middle, across the beam. */
static double sag(mpm_scene *s, const int64_t *ids, const double *along) {
  mps_view x = mpm_scene_view(s, "position");
  double ends = 0.0, middle = 0.0;
  int end_count = 0, middle_count = 0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const int64_t at = mps_particles_index(s->particles, ids[k]);
    const double y = cos(ANGLE) * *mps_view_f64(&x, at, 1) - sin(ANGLE) * *mps_view_f64(&x, at, 0);
    if (along[k] < SPACING || along[k] > LENGTH - SPACING) ends += y, end_count++;
    if (fabs(along[k] - 0.5) < SPACING) middle += y, middle_count++;
  }
  return ends / end_count - middle / middle_count;
}

/* Deflection over the beam's after the way at the speed times `moves`. */
static double carry(int32_t spline, int32_t strain, double moves) {
  enum { COUNT = 160 };
  double along[COUNT];
  int64_t ids[COUNT];
  scoped_mpm_scene s = mpm_scene_begin(context, SPACING, 0.0, -0.5 * DEPTH, YOUNG);
  mps_material_destroy(&s.material);
  OK(mps_material_create_neo_hookean(context, YOUNG, POISSON, &s.material));
  mpm_scene_box(&s, 0.0, -0.5 * DEPTH, LENGTH, 0.5 * DEPTH);
  assert_int_equal(mps_particles_count(s.particles), COUNT);
  mps_view id = mpm_scene_view(&s, "id");
  for (int k = 0; k < COUNT; k++) ids[k] = *mps_view_i64(&id, k, 0);
  lay_out(&s, moves, along);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = CELL, .spline = spline);
  OK(mps_experimental_mpm_strain(s.mpm, strain));
  while (mps_mpm_time(s.mpm) < TIME) {
    OK(mps_mpm_step(s.mpm, 1));
    damp(&s, 2.0 * frequency() * mps_mpm_dt(s.mpm), moves);
  }
  double way = 0.0;
  mps_view place = mpm_scene_view(&s, "position");
  for (int64_t k = 0; k < COUNT; k++) way += (*mps_view_f64(&place, k, 0) - 0.5) / COUNT;
  NEAR(way, moves * speed[0] * TIME, 0.5 * CELL);
  return sag(&s, ids, along) / deflection();
}

TEST(a_bent_beam_keeps_its_deflection) {
  static const double most[] = {0.15, 0.05}; /* growth; spline 2, 3 */
  for (int32_t spline = 2; spline <= 3; spline++) {
    double growth[2];
    for (int32_t strain = 0; strain < 2; strain++) {
      const double rest = carry(spline, strain, 0.0), moved = carry(spline, strain, 1.0);
      print_message(
          "spline %d, strain by the %s: deflection/beam %.3f at rest, %.3f after 20 cells\n",
          (int)spline, strain ? "fit" : "derivative", rest, moved);
      growth[strain] = moved / rest - 1.0;
    }
    assert_true(fabs(growth[0]) < most[spline - 2]);
    assert_true(growth[1] > 3.0 * fabs(growth[0])); /* the test can distinguish */
  }
}
