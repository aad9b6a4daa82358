/* test_elastic_cantilever.c - the paper's cantilever: tip errors of both methods at four sizes
 * against the reference values of an independent prototype, stress error, nearly incompressible
 * material. SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"

#include <lapacke.h>

static const int size_nx[4] = {17, 33, 65, 129}, size_ny[4] = {9, 17, 33, 65};

static double tip_error(const mps_elastic_def *def, double nu, int size, test_method method) {
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  cantilever c = {.nu = nu, .height = 2.0};
  scoped_test_body b = cantilever_make(context, &c, size_nx[size], size_ny[size], def, method);
  const double error = 100.0 * cantilever_solve(&b, &c, method);
  mps_elastic_report report;
  OK(mps_elastic_get_report(b.elastic, &report));
  print_message("nu %g method %d re %g N %d: tip error %+.3f %%, residual %.1e, nnz(K)/row %.1f, "
                "nnz(L) %.3g, assemble %.3f analyse %.3f factor %.3f s\n",
                nu, (int)method, def->radius_ratio, (int)b.n, error, report.residual,
                (2.0 * (double)report.matrix_nonzeros - (double)report.unknowns) /
                    (double)report.unknowns,
                (double)report.factor_nonzeros, report.seconds_assemble, report.seconds_analyse,
                report.seconds_factor);
  assert_true(report.residual < 1e-10);
  return error;
}

TEST(conservative_tip_errors_are_the_reference_values) {
  const double expected[4] = {0.79, 0.34, 0.11, 0.03};
  mps_elastic_def def = mps_elastic_defaults();
  for (int k = 0; k < 4; k++) NEAR(tip_error(&def, 0.3, k, TEST_CONSERVATIVE), expected[k], 0.05);
}

TEST(published_tip_errors_are_the_reference_values) {
  const double wide[4] = {3.6, 3.0, 1.9, 1.05}, narrow[4] = {-1.26, -0.09, 0.14, 0.13};
  mps_elastic_def def = mps_elastic_defaults();
  for (int k = 0; k < 4; k++) {
    def.radius_ratio = 3.0;
    NEAR(tip_error(&def, 0.3, k, TEST_PUBLISHED), wide[k], 0.05);
    def.radius_ratio = 2.1;
    NEAR(tip_error(&def, 0.3, k, TEST_PUBLISHED), narrow[k], 0.05);
  }
}

TEST(a_nearly_incompressible_cantilever_does_not_lock) {
  DEF(elastic, def, .state = MPS_ELASTIC_STATE_PLANE_STRAIN);
  assert_true(fabs(tip_error(&def, 0.4999, 0, TEST_CONSERVATIVE)) < 2.0);
}

/* ---- Chikazawa (5): four unknowns a particle, without elimination, by LU --------------------- */

/* Rows of particle i in the dense system a (order u, v, R, D), by brute force over all pairs. */
static void four_unknown_rows(const test_body *b, const cantilever *c, double ratio, int local,
                              double n0, int64_t i, double *a) {
  const int64_t size = 4 * b->n;
  const double l0 = mps_particles_spacing(b->particles), mu = 1 / (2 * (1 + c->nu));
  const double lambda = c->nu / (1 - c->nu * c->nu);
  double *row[4], density = 0;
  for (int k = 0; k < 4; k++) row[k] = a + (4 * i + k) * size;
  for (int pass = 0; pass < 2; pass++)
    for (int64_t j = 0; j < b->n; j++) {
      const double dx = test_value(b, "position", j, 0) - test_value(b, "position", i, 0);
      const double dy = test_value(b, "position", j, 1) - test_value(b, "position", i, 1);
      const double r = sqrt(dx * dx + dy * dy), w = ratio * l0 / r - 1;
      if (j == i || w < 1e-9) continue;
      if (pass == 0) density += w;
      if (pass == 0) continue;
      const double t[2] = {dx / r, dy / r}, s[2] = {-dy / r, dx / r};
      const double n = local ? density : n0, scale = l0 * l0 * 4 / n0 * w / r;
      for (int k = 0; k < 2; k++) {
        row[k][4 * j + k] += scale * 2 * mu / r;
        row[k][4 * i + k] -= scale * 2 * mu / r;
        for (int end = 0; end < 2; end++) {
          row[k][4 * (end ? j : i) + 2] -= scale * mu / 2 * s[k];
          row[k][4 * (end ? j : i) + 3] += scale * lambda / 2 * t[k];
        }
        row[2][4 * j + k] += 2 / n * s[k] * w / r;
        row[2][4 * i + k] -= 2 / n * s[k] * w / r;
        row[3][4 * j + k] += 2 / n * t[k] * w / r;
        row[3][4 * i + k] -= 2 / n * t[k] * w / r;
      }
    }
  row[2][4 * i + 2] = row[3][4 * i + 3] = -1.0;
}

static double four_unknown_difference(mps_context *context, double ratio, test_method method) {
  DEF(elastic, def, .radius_ratio = ratio);
  cantilever c = {.nu = 0.3, .height = 2.0};
  test_body b = cantilever_make(context, &c, 17, 9, &def, method);
  (void)cantilever_solve(&b, &c, method);
  double n0 = 0;
  for (int p = -4; p <= 4; p++)
    for (int q = -4; q <= 4; q++)
      if (p * p + q * q > 0) n0 += fmax(0, ratio / sqrt(p * p + q * q) - 1);
  const int64_t size = 4 * b.n;
  double *a = calloc((size_t)(size * size), sizeof *a), *f = calloc((size_t)size, sizeof *f);
  int32_t *pivot = malloc((size_t)size * sizeof *pivot);
  for (int64_t i = 0; i < b.n; i++) {
    four_unknown_rows(&b, &c, ratio, method == TEST_PUBLISHED, n0, i, a);
    const double x = test_value(&b, "position", i, 0), y = test_value(&b, "position", i, 1);
    const double h = c.height, l0 = h / 9;
    if (x < l0) { /* resultant of the parabolic shear on the facet */
      const double y1 = y + l0 / 2, y0 = y - l0 / 2;
      f[4 * i + 1] = 6 / h / h / h * (h * h / 4 * (y1 - y0) - (y1 * y1 * y1 - y0 * y0 * y0) / 3);
    }
    for (int k = 0; k < 2 && x > c.length - l0 / 2; k++) {
      memset(a + (4 * i + k) * size, 0, (size_t)size * sizeof *a);
      a[(4 * i + k) * size + 4 * i + k] = 1;
      f[4 * i + k] = k ? cantilever_v(&c, x, y) : cantilever_u(&c, x, y);
    }
  }
  assert_int_equal(LAPACKE_dgesv(LAPACK_ROW_MAJOR, (int)size, 1, a, (int)size, pivot, f, 1), 0);
  double worst = 0, largest = 0;
  for (int64_t i = 0; i < b.n; i++)
    for (int k = 0; k < 2; k++) {
      worst = fmax(worst, fabs(f[4 * i + k] - test_value(&b, "displacement", i, k)));
      largest = fmax(largest, fabs(f[4 * i + k]));
    }
  free(a);
  free(f);
  free(pivot);
  test_body_end(&b);
  return worst / largest;
}

TEST_SERIAL(the_condensed_form_is_the_papers_four_unknown_form) {
  for (int k = 0; k < 2; k++) {
    const double difference = four_unknown_difference(context, k ? 2.1 : 3.0, TEST_PUBLISHED);
    print_message("condensed and four-unknown form differ by %.1e\n", difference);
    NEAR(difference, 0.0, 1e-11);
  }
  NEAR(four_unknown_difference(context, 3.0, TEST_CONSTANT), 0.0, 1e-11);
}

/* ---- sections and stresses ------------------------------------------------------------------- */

TEST_SERIAL(sections_carry_shear_and_moment) {
  for (test_method method = TEST_CONSERVATIVE; method <= TEST_PUBLISHED; method++) {
    mps_elastic_def def = mps_elastic_defaults();
    cantilever c = {.nu = 0.3, .height = 2.0};
    scoped_test_body b = cantilever_make(context, &c, 33, 17, &def, method);
    (void)cantilever_solve(&b, &c, method);
    for (double x = 0.4; x < c.length; x += 0.5) {
      const double at[3] = {x, 0.0, 0.0};
      double force[3], moment[3];
      OK(mps_elastic_get_section(b.elastic, 0, x, at, force, moment));
      NEAR(force[0], 0.0, 1e-10);
      NEAR(force[1], 1.0, 1e-10); /* the far side carries the load P = 1 up */
      /* Nodal loads sit at the first particles where there is no first moment. */
      const double arm = x - (method ? 0.5 * c.height / 17 : 0.0);
      NEAR(moment[2], -arm, 1e-9);
    }
  }
}

/* L2 error of the stress over the body, in %: the wall's cells are half cells. */
static double stress_error(mps_context *context, int size) {
  mps_elastic_def def = mps_elastic_defaults();
  cantilever c = {.nu = 0.3, .height = 2.0};
  test_body b = cantilever_make(context, &c, size_nx[size], size_ny[size], &def, TEST_CONSERVATIVE);
  (void)cantilever_solve(&b, &c, TEST_CONSERVATIVE);
  OK(mps_elastic_update_stress(b.elastic));
  double wrong = 0, all = 0;
  for (int64_t i = 0; i < b.n; i++) {
    const double x = test_value(&b, "position", i, 0), y = test_value(&b, "position", i, 1);
    const double inertia = c.height * c.height * c.height / 12;
    const double exact[3] = {x * y / inertia, 0, (c.height * c.height / 4 - y * y) / 2 / inertia};
    static const int component[3] = {0, 1, 3};
    for (int k = 0; k < 3; k++) {
      const double weight = (k == 2 ? 2 : 1) * (x > c.length - 0.01 ? 0.5 : 1);
      wrong += weight * pow(test_value(&b, "stress", i, component[k]) - exact[k], 2);
      all += weight * exact[k] * exact[k];
    }
  }
  test_body_end(&b);
  return 100 * sqrt(wrong / all);
}

TEST_SERIAL(stress_errors_are_the_reference_values) {
  const double expected[4] = {4.3, 1.6, 0.59, 0.21};
  for (int k = 0; k < 4; k++) {
    const double error = stress_error(context, k);
    print_message("N %d: stress error %.2f %%\n", size_nx[k] * size_ny[k], error);
    NEAR(error, expected[k], 0.05);
  }
}

/* ---- three dimensions ------------------------------------------------------------------------ */

/* Tip deflection of a clamped bar of square section (1 m, cells x cells) and length about 6 m under
 * an end load along `direction`, over that of Timoshenko's beam. */
static double bar(mps_context *context, int cells, int direction) {
  const double nu = 0.3, spacing = 1.0 / cells, length = (6 * cells - 0.5) * spacing;
  test_body b = test_body_begin(context, 3, spacing);
  test_body_box(&b, 0, 0, 0, 6, 1, 1);
  test_body_finish(&b, 1.0, nu, NULL);
  int64_t count, *wall = test_select(&b, 0, length - 0.1 * spacing, INFINITY, &count);
  double traction[3] = {0, 0, 0};
  traction[direction] = 1.0;
  OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_UPPER, wall, count));
  for (int c = 0; c < 3; c++) OK(test_prescribe(b.elastic, c, count, wall, NULL));
  int64_t *facets = test_facets(&b, 0, -1, &count);
  OK(test_traction(b.elastic, count, facets, traction));
  OK(mps_elastic_solve(b.elastic));
  double force[3], moment[3];
  const double at[3] = {3.0, 0.5, 0.5};
  OK(mps_elastic_get_section(b.elastic, 0, 3.0 - 0.25 * spacing, at, force, moment));
  NEAR(force[direction], -1.0, 1e-9); /* the wall's side holds the load */
  NEAR(fabs(moment[direction == 1 ? 2 : 1]), 3.0, 1e-8);
  NEAR(moment[0], 0.0, 1e-9);
  double tip = 0.0, layer = 0.0;
  for (int64_t i = 0; i < b.n; i++)
    if (test_value(&b, "position", i, 0) < spacing) {
      tip += test_value(&b, "displacement", i, direction);
      layer += 1.0;
    }
  /* At the first layer; shear coefficient of a square (Cowper): 10 (1 + nu) / (12 + 11 nu). */
  const double x = 0.5 * spacing, l = length, kappa = 10 * (1 + nu) / (12 + 11 * nu);
  const double theory =
      12.0 / 6 * (2 * l * l * l - 3 * l * l * x + x * x * x) + 2 * (1 + nu) / kappa * (l - x);
  free(wall);
  free(facets);
  test_body_end(&b);
  return tip / layer / theory;
}

TEST_SERIAL(a_bar_bends_as_beam_theory_says) {
  const double coarse = bar(context, 4, 1), fine = bar(context, 8, 1), across = bar(context, 4, 2);
  print_message("3D bar, 4 and 8 cells across: deflection / theory %.4f, %.4f\n", coarse, fine);
  NEAR(across / coarse, 1.0, 1e-9);
  NEAR(fine, 1.0, 0.02);
}
