/* test_mpm_corners.c - sides of WLS-MPM that join act without regard to the order of their numbers,
 * and particles on borders of cells as in a mirror image: the same scene turned by 90 degrees and
 * mirrored agrees to round-off. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include "mpm/boundary/corners.h"

/* ---- two sides of one kind, one of them with a signal ---------------------------------------- */

/* Ground of 6 x 6 cells in the corner of the lower sides, both of `kind`; `turned`: x and y
 * exchanged. The floor moves along both axes. */
static mpm_scene corner_of(int32_t kind, int32_t walls, double settle, bool turned) {
  mpm_scene s = mpm_scene_begin(context, 0.125, 0.0, 0.0, 1e6);
  const int x = turned ? 1 : 0, y = 1 - x;
  mpm_scene_box(&s, 0.0, 0.0, 1.5, 1.5);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.25, .lower[0] = given.lower[1] = 0.0,
        .edge = walls, .gravity[x] = -2.0, .gravity[y] = -9.75);
  MAKE(signal, signal, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 20.0, 1e-3, 0.3);
  DEF(mpm_boundary, side, .kind = kind, .settle = settle);
  OK(mps_mpm_set_boundary(s.mpm, 2 * x, &side));
  side.signal[x] = side.signal[y] = signal, side.factor[x] = 0.7;
  side.settle *= 2.0;
  OK(mps_mpm_set_boundary(s.mpm, 2 * y, &side));
  return s;
}

static void compare_corner(int32_t kind, int32_t walls, double settle) {
  scoped_mpm_scene a = corner_of(kind, walls, settle, false),
                   b = corner_of(kind, walls, settle, true);
  OK(mps_mpm_step(a.mpm, 60));
  OK(mps_mpm_step(b.mpm, 60));
  mps_view v = mpm_scene_view(&a, "velocity"), w = mpm_scene_view(&b, "velocity");
  mps_view stress = mpm_scene_view(&a, "stress"), other = mpm_scene_view(&b, "stress");
  double apart = 0.0, largest = 0.0, off = 0.0, most = 0.0, reaction = 0.0;
  for (int64_t id = 0; id < v.shape[0]; id++) { /* rows of 12 */
    const int64_t k = mps_particles_index(a.particles, id);
    const int64_t K = mps_particles_index(b.particles, id % 12 * 12 + id / 12);
    for (int c = 0; c < 2; c++) {
      apart = fmax(apart, fabs(*mps_view_f64(&v, k, c) - *mps_view_f64(&w, K, 1 - c)));
      largest = fmax(largest, fabs(*mps_view_f64(&v, k, c)));
      off = fmax(off, fabs(*mps_view_f64(&stress, k, c) - *mps_view_f64(&other, K, 1 - c)));
      most = fmax(most, fabs(*mps_view_f64(&stress, k, c)));
    }
  }
  for (int32_t number = 0; number <= 2; number += 2) {
    mps_reaction r, R;
    OK(mps_mpm_get_reaction(a.mpm, number, &r));
    OK(mps_mpm_get_reaction(b.mpm, 2 - number, &R));
    for (int c = 0; c < 2; c++)
      reaction = fmax(reaction, fabs(r.impulse[c] - R.impulse[1 - c]) /
                                    (fabs(r.impulse[0]) + fabs(r.impulse[1])));
  }
  print_message("kind %d, walls %d, settle %g: velocities %.2g, stresses %.2g, impulses %.2g\n",
                (int)kind, (int)walls, settle, apart / largest, off / most, reaction);
  assert_true(apart < 1e-11 * largest);
  assert_true(off < 1e-11 * most);
  assert_true(reaction < 1e-11);
}

TEST(corners_turn) {
  compare_corner(MPS_BOUNDARY_ABSORBING, MPS_MPM_EDGE_MIRROR, 0.0);
  compare_corner(MPS_BOUNDARY_ABSORBING, MPS_MPM_EDGE_FIT, 0.02);
  compare_corner(MPS_BOUNDARY_DRIVEN, MPS_MPM_EDGE_MIRROR, 0.0);
  compare_corner(MPS_BOUNDARY_DRIVEN, MPS_MPM_EDGE_FIT, 0.0);
}

/* ---- friction along an edge ------------------------------------------------------------------ */

static double slide(int32_t count, double v, const double *velocity, const double *most,
                    double *impulse) {
  const double after = mpsi_mpm_edge_friction(count, 2.0, v, velocity, most, impulse);
  double sum = 0.0;
  for (int32_t s = 0; s < count; s++) {
    sum += impulse[s];
    assert_true(fabs(impulse[s]) <= most[s] * (1.0 + 1e-14));
    /* against the slip along its side, and as large as it may be where there is some */
    if (fabs(after - velocity[s]) > 1e-14)
      NEAR(impulse[s], after > velocity[s] ? -most[s] : most[s], 1e-14);
  }
  NEAR(after, v + sum / 2.0, 1e-14);
  return after;
}

TEST(friction_along_an_edge) {
  const double rest[2] = {0.0, 0.0}, moves[2] = {0.0, 1.0}, most[2] = {0.5, 1.0};
  double impulse[2];
  NEAR(slide(2, 3.0, rest, most, impulse), 3.0 - 0.75, 1e-15); /* slides along both */
  NEAR(slide(2, 0.3, rest, most, impulse), 0.0, 0.0);          /* sticks to both: */
  NEAR(impulse[0], -0.2, 1e-15);                               /* parts as the limits */
  NEAR(impulse[1], -0.4, 1e-15);
  NEAR(slide(2, 0.2, moves, most, impulse), 0.45, 1e-15); /* between the two */
  NEAR(slide(2, 1.4, moves, most, impulse), 1.0, 0.0);    /* sticks to the second */
  for (int k = 0; k < 60; k++) {                          /* the order does not matter */
    const double v = -3.0 + 0.1 * k, V[2] = {moves[1], moves[0]}, L[2] = {most[1], most[0]};
    double other[2];
    const double after = slide(2, v, moves, most, impulse);
    NEAR(slide(2, v, V, L, other), after, 1e-15);
    NEAR(other[0], impulse[1], 1e-15);
  }
}

/* ---- particles on borders of cells ----------------------------------------------------------- */

/* A block of von Mises, with means by cell, that falls apart between free sides; its particles lie
 * on borders of cells where `first` says so, and the sides stop some. */
static void falls_alike(double first, int32_t spline) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.125, 0.0, 0.0, 1e6);
  enum { SIDE = 20 };
  double x[SIDE * SIDE][2];
  const int n = first == 0.0 ? SIDE + 1 : SIDE;
  int count = 0;
  for (int j = 0; j < 12; j++)
    for (int i = 0; i < n; i++, count++) {
      x[count][0] = 0.125 * (first + i) - 1.25;
      x[count][1] = 0.125 * (0.5 + j);
    }
  OK(mps_particles_append(s.particles, count, x[0]));
  DEF(material_von_mises, law, .young = 2e6, .yield_stress = 4e3);
  mps_material_destroy(&s.material);
  OK(mps_material_create_von_mises(context, &law, &s.material));
  DEF(mpm, def, .cell = 0.25, .spline = spline, .gravity[1] = -9.81,
      .volumetric = MPS_MPM_VOLUMETRIC_CELL, .lower[0] = -1.25, .upper[0] = 1.25, .lower[1] = 0.0);
  mpm_scene_solve(&s, &def);
  for (int32_t side = 0; side < 2; side++) mpm_scene_side(&s, side, MPS_BOUNDARY_FREE, 0.0);
  OK(mps_mpm_step(s.mpm, 60));
  mps_view stress = mpm_scene_view(&s, "stress");
  double apart = 0.0, most = 0.0;
  for (int64_t id = 0; id < count; id++) {
    const int64_t k = mps_particles_index(s.particles, id);
    const int64_t K = mps_particles_index(s.particles, id / n * n + n - 1 - id % n);
    for (int c = 0; c < 3; c++) {
      apart = fmax(apart, fabs(*mps_view_f64(&stress, k, c) - *mps_view_f64(&stress, K, c)));
      most = fmax(most, fabs(*mps_view_f64(&stress, k, c)));
    }
  }
  print_message("first at %g, spline %d: left against right %.2g of the stress\n", first,
                (int)spline, apart / most);
  assert_true(apart < 1e-11 * most);
}

TEST(borders_of_cells_are_symmetric) {
  for (int32_t spline = 2; spline <= 3; spline++) {
    falls_alike(0.5, spline); /* within cells, until sides stop them */
    falls_alike(0.0, spline); /* on borders of cells, and on the sides */
  }
}
