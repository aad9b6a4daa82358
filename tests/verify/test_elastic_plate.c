/* test_elastic_plate.c - the paper's square plate in tension, and Kirsch's plate with a hole.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"

#include <lapacke.h>

/* ---- tension --------------------------------------------------------------------------------- */

/* 17 x 17 cells; the left layer is the wall, free to contract. Largest relative error. */
static double tension_error(mps_context *context, int32_t state) {
  const double nu = 0.3, load = 0.01;
  DEF(elastic, def, .state = state);
  scoped_test_body b = test_body_begin(context, 2, 1.0 / 17);
  test_body_box(&b, 0, 0, 0, 1, 1, 0);
  assert_int_equal(mps_particles_count(b.particles), 289);
  test_body_finish(&b, 1.0, nu, &def);
  int64_t count, facet_count;
  int64_t *wall = test_select(&b, 0, -1, 0.5 / 17 + 1e-9, &count);
  int64_t *facets = test_facets(&b, 0, 1, &facet_count);
  const double traction[2] = {load, 0.0};
  OK(test_prescribe(b.elastic, 0, count, wall, NULL));
  OK(test_prescribe(b.elastic, 1, 1, wall + count / 2, NULL));
  OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_LOWER, wall, count));
  OK(test_traction(b.elastic, facet_count, facets, traction));
  OK(mps_elastic_solve(b.elastic));
  OK(mps_elastic_update_stress(b.elastic));
  const double x0 = 0.5 / 17, y0 = test_value(&b, "position", wall[count / 2], 1);
  const int strain = state == MPS_ELASTIC_STATE_PLANE_STRAIN;
  const double ex = load * (strain ? 1 - nu * nu : 1), ey = -nu * load * (strain ? 1 + nu : 1);
  double worst = 0.0;
  for (int64_t i = 0; i < b.n; i++) {
    const double x = test_value(&b, "position", i, 0) - x0;
    const double y = test_value(&b, "position", i, 1) - y0;
    worst = fmax(worst, fabs(test_value(&b, "displacement", i, 0) - ex * x) / load);
    worst = fmax(worst, fabs(test_value(&b, "displacement", i, 1) - ey * y) / load);
    worst = fmax(worst, fabs(test_value(&b, "stress", i, 0) / load - 1.0));
    worst = fmax(worst, fabs(test_value(&b, "principal", i, 0) / load - 1.0));
    worst = fmax(worst, fabs(test_value(&b, "stress", i, 2) / load - (strain ? nu : 0.0)));
    const double mises = strain ? sqrt(1 - nu + nu * nu) : 1.0;
    worst = fmax(worst, fabs(test_value(&b, "von_mises", i, 0) / load - mises));
  }
  /* The force through any section is the load, without a moment about the middle. */
  const double middle[3] = {0.0, 0.5, 0.0};
  double force[3], moment[3];
  OK(mps_elastic_get_section(b.elastic, 0, 0.4, middle, force, moment));
  NEAR(force[0] / load, 1.0, 1e-10);
  NEAR(force[1] / load, 0.0, 1e-10);
  NEAR(moment[2] / load, 0.0, 1e-10);
  free(wall);
  free(facets);
  return worst;
}

TEST_SERIAL(a_plate_in_tension_is_exact) {
  for (int32_t s = 0; s < 2; s++) {
    const double error = tension_error(context, s);
    print_message("plate in tension, 289 particles, state %d: largest error %.1e\n", s, error);
    NEAR(error, 0.0, 1e-10);
  }
}

/* The published method with the paper's particles on the boundary: nodal forces at the end. */
TEST_SERIAL(the_published_plate_is_the_reference_value) {
  const double l0 = 1.0 / 16;
  scoped_test_body b = test_body_begin(context, 2, l0);
  test_body_box(&b, 0, 0, 0, 17 * l0, 17 * l0, 0);
  test_body_finish_by(&b, 1.0, 0.3, NULL, TEST_PUBLISHED);
  int64_t count, ends;
  int64_t *wall = test_select(&b, 0, -1, 0.6 * l0, &count);
  int64_t *end = test_select(&b, 0, 16.4 * l0, 99, &ends);
  OK(test_prescribe(b.elastic, 0, count, wall, NULL));
  OK(test_prescribe(b.elastic, 1, 1, wall + count / 2, NULL));
  for (int64_t k = 0; k < ends; k++) {
    const double y = test_value(&b, "position", end[k], 1);
    const double force[2] = {y < l0 || y > 16 * l0 ? 0.5 * l0 : l0, 0.0};
    OK(test_forces(b.elastic, 1, end + k, force));
  }
  OK(mps_elastic_solve(b.elastic));
  double mean = 0.0;
  for (int64_t k = 0; k < ends; k++)
    mean += test_value(&b, "displacement", end[k], 0) / (double)ends;
  const double middle = test_value(&b, "displacement", end[ends / 2], 0);
  print_message("published plate: end displacement %+.2f %% (mean), %+.2f %% (middle)\n",
                100 * (mean - 1), 100 * (middle - 1));
  NEAR(100 * (middle - 1), 0.7, 0.05);
  free(wall);
  free(end);
}

/* ---- Kirsch ---------------------------------------------------------------------------------- */

/* Stresses of the infinite plate with a hole of radius a under unit tension in x. */
static void kirsch(double a, double x, double y, double *sxx, double *syy, double *sxy) {
  const double r = sqrt(x * x + y * y), t = atan2(y, x), q = a * a / r / r;
  *sxx = 1 - q * (1.5 * cos(2 * t) + cos(4 * t)) + 1.5 * q * q * cos(4 * t);
  *syy = -q * (0.5 * cos(2 * t) - cos(4 * t)) - 1.5 * q * q * cos(4 * t);
  *sxy = -q * (0.5 * sin(2 * t) + sin(4 * t)) + 1.5 * q * q * sin(4 * t);
}

static mps_status kirsch_traction(void *user, const double *x, const double *normal,
                                  double *traction) {
  double sxx, syy, sxy;
  kirsch(*(double *)user, x[0], x[1], &sxx, &syy, &sxy);
  traction[0] = sxx * normal[0] + sxy * normal[1];
  traction[1] = sxy * normal[0] + syy * normal[1];
  return MPS_OK;
}

static mps_status outside(void *user, const double *x, int32_t *inside) {
  const double a = *(double *)user;
  *inside = x[0] * x[0] + x[1] * x[1] > a * a;
  return MPS_OK;
}

/* A lattice makes a staircase of the hole, which disturbs a few layers: the concentration at its
 * edge (r = 1) is that of c0 + c1 / r^2 + c2 / r^4, the form of the exact solution, fitted to the
 * stress over the ligament from `from` to `to`. */
static double fit_at_edge(const test_body *b, const int64_t *ids, int64_t count, double from,
                          double to) {
  double A[9] = {0}, c[3] = {0};
  int32_t pivot[3];
  for (int64_t k = 0; k < count; k++) {
    const double y = test_value(b, "position", ids[k], 1), q = 1 / y / y;
    if (y < from || y > to) continue;
    const double f[3] = {1, q, q * q};
    for (int p = 0; p < 3; p++) {
      c[p] += f[p] * test_value(b, "stress", ids[k], 0);
      for (int r = 0; r < 3; r++) A[3 * p + r] += f[p] * f[r];
    }
  }
  assert_int_equal(LAPACKE_dgesv(LAPACK_ROW_MAJOR, 3, 1, A, 3, pivot, c, 1), 0);
  return c[0] + c[1] + c[2];
}

/* A quarter of the plate; the traction of the infinite plate on its outer edges. */
static double kirsch_concentration(mps_context *context, int m) {
  double a = 1.0;
  const double l0 = a / (m + 0.5), side = 4.0;
  const int cells = (int)(side / l0);
  DEF(particles, set, .spacing = l0);
  set.origin[0] = set.origin[1] = -0.5 * l0; /* particles on both planes of symmetry */
  scoped_test_body b = {.context = context, .dim = 2};
  OK(mps_particles_create(context, &set, &b.particles));
  const double lo[2] = {-0.5 * l0, -0.5 * l0}, hi[2] = {cells * l0, cells * l0};
  OK(mps_particles_fill_where(b.particles, lo, hi, outside, &a, NULL));
  test_body_finish(&b, 1.0, 0.3, NULL);
  for (int axis = 0; axis < 2; axis++) {
    int64_t count, *plane = test_select(&b, axis, -1, 0.1 * l0, &count);
    OK(test_prescribe(b.elastic, axis, count, plane, NULL));
    OK(mps_elastic_cut(b.elastic, mps_side_of(axis, 0), plane, count));
    free(plane);
    int64_t all = mps_elastic_facet_count(b.elastic), *facets = malloc((size_t)all * 8);
    double from[2] = {-INFINITY, -INFINITY};
    from[axis] = (cells - 1) * l0;
    OK(mps_elastic_select_facets(b.elastic, mps_side_of(axis, 1), from, NULL, all, &count, facets));
    OK(test_traction_fn(b.elastic, count, facets, kirsch_traction, &a));
    free(facets);
  }
  OK(mps_elastic_solve(b.elastic));
  OK(mps_elastic_update_stress(b.elastic));
  int64_t count, *axis = test_select(&b, 0, -1, 0.1 * l0, &count);
  const double concentration = fit_at_edge(&b, axis, count, a + 4 * l0, 3 * a);
  print_message("hole of radius %.1f spacings, %d particles: concentration %.3f\n", m + 0.5,
                (int)b.n, concentration);
  free(axis);
  return concentration;
}

TEST_SERIAL(the_hole_concentrates_stress_three_times) {
  const double coarse = kirsch_concentration(context, 10);
  const double middle = kirsch_concentration(context, 20);
  const double fine = kirsch_concentration(context, 40);
  NEAR(fine / 3.0, 1.0, 0.03);
  assert_true(fabs(fine - 3.0) < fabs(middle - 3.0) && fabs(middle - 3.0) < fabs(coarse - 3.0));
}
