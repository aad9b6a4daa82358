/* test_kernel.c - weight functions: values, derivatives, moments.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include <mps/kernel.h>

static const int32_t kinds[] = {MPS_KERNEL_MPS, MPS_KERNEL_SPLINE2, MPS_KERNEL_SPLINE3,
                                MPS_KERNEL_SMOOTH};

static mps_kernel *make(int32_t kind, double radius) {
  mps_kernel *kernel = NULL;
  mps_assert_ok(context, mps_kernel_create(context, kind, radius, &kernel));
  return kernel;
}

/* The derivative against central differences, and none where the weight ends. */
static void derivatives_are_those_of_the_weights(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    mps_kernel *w = make(kinds[k], 3.0);
    assert_int_equal(mps_kernel_get_kind(w), kinds[k]);
    mps_assert_near(mps_kernel_radius(w), 3.0, 0.0);
    for (double r = 0.13; r < 2.95; r += 0.0917) {
      const double e = 1e-5;
      const double slope = (mps_kernel_weight(w, r + e) - mps_kernel_weight(w, r - e)) / (2.0 * e);
      mps_assert_near(mps_kernel_derivative(w, r), slope, 1e-6 * (1.0 + 3.0 / (r * r)));
    }
    mps_assert_near(mps_kernel_weight(w, 3.0), 0.0, 0.0);
    mps_assert_near(mps_kernel_weight(w, 3.0 - 1e-9), 0.0, 1e-9);
    mps_assert_near(mps_kernel_derivative(w, 3.0), 0.0, 0.0);
    mps_assert_near(mps_kernel_weight(w, -0.1), 0.0, 0.0);
    mps_kernel_destroy(&w);
  }
}

/* B-splines on nodes h apart are a partition of unity, and reproduce a linear function. */
static void splines_are_a_partition_of_unity(void **state) {
  (void)state;
  const double h = 0.4;
  for (int k = 1; k < 3; k++) {
    mps_kernel *w = make(kinds[k], (k == 1 ? 1.5 : 2.0) * h);
    for (double x = 0.0; x < h; x += 0.0137) {
      double sum = 0.0, first = 0.0;
      for (int i = -4; i <= 4; i++) {
        sum += mps_kernel_weight(w, fabs(x - i * h));
        first += mps_kernel_weight(w, fabs(x - i * h)) * i * h;
      }
      mps_assert_near(sum, 1.0, 1e-14);
      mps_assert_near(first, x, 1e-14);
    }
    mps_kernel_destroy(&w);
  }
}

/* Closed forms: a spline's integral is h, its second moment h^3 (p + 1)/12 with the degree p; of
 * re/r - 1 in the plane pi re^2, in space 2 pi re^3/3. Others by a fine midpoint rule. */
static void moments_are_integrals(void **state) {
  (void)state;
  const double h = 0.4, pi = 3.14159265358979323846, sphere[3] = {2.0, 2.0 * pi, 4.0 * pi};
  double m;
  for (int k = 1; k < 3; k++) {
    mps_kernel *w = make(kinds[k], (k == 1 ? 1.5 : 2.0) * h);
    mps_assert_ok(context, mps_kernel_moment(context, w, 1, 0, &m));
    mps_assert_near(m, h, 1e-15);
    mps_assert_ok(context, mps_kernel_moment(context, w, 1, 2, &m));
    mps_assert_near(m, h * h * h * (k + 2.0) / 12.0, 1e-16);
    mps_kernel_destroy(&w);
  }
  mps_kernel *w = make(MPS_KERNEL_MPS, 3.0);
  mps_assert_ok(context, mps_kernel_moment(context, w, 2, 0, &m));
  mps_assert_near(m, 9.0 * pi, 1e-13);
  mps_assert_ok(context, mps_kernel_moment(context, w, 3, 0, &m));
  mps_assert_near(m, 18.0 * pi, 1e-13);
  mps_kernel_destroy(&w);
  for (int k = 0; k < 4; k++)
    for (int32_t dim = 1; dim <= 3; dim++)
      for (int32_t order = 0; order <= 4; order++) {
        if (k == 0 && dim + order < 3) continue; /* not smooth enough for the rule */
        const int n = 20000;
        const double radius = 1.7, step = radius / n;
        w = make(kinds[k], radius);
        double sum = 0.0;
        for (int i = 0; i < n; i++) {
          const double r = (i + 0.5) * step;
          sum += mps_kernel_weight(w, r) * pow(r, dim + order - 1) * step;
        }
        mps_assert_ok(context, mps_kernel_moment(context, w, dim, order, &m));
        mps_assert_near(m, sphere[dim - 1] * sum, 2e-7 * fabs(m));
        mps_kernel_destroy(&w);
      }
}

static void nonsense_is_refused(void **state) {
  (void)state;
  mps_kernel *w = NULL;
  double m;
  mps_assert_fails(context, mps_kernel_create(context, 4, 1.0, &w), MPS_ERROR_ARGUMENT,
                   "kind is 4");
  mps_assert_fails(context, mps_kernel_create(context, -1, 1.0, &w), MPS_ERROR_ARGUMENT, "kind");
  mps_assert_fails(context, mps_kernel_create(context, 0, 1e-320, &w), MPS_ERROR_ARGUMENT,
                   "radius of influence is 9.99989e-321 m, must be 1e-12 to 1e+12");
  assert_null(w);
  w = make(MPS_KERNEL_MPS, 1.0);
  mps_assert_fails(context, mps_kernel_moment(context, w, 1, 0, &m), MPS_ERROR_ARGUMENT,
                   "diverges");
  mps_assert_fails(context, mps_kernel_moment(context, w, 4, 0, &m), MPS_ERROR_ARGUMENT,
                   "dim is 4");
  mps_assert_fails(context, mps_kernel_moment(context, w, 2, 5, &m), MPS_ERROR_ARGUMENT, "order 5");
  mps_assert_fails(context, mps_kernel_moment(context, NULL, 2, 0, &m), MPS_ERROR_ARGUMENT, "NULL");
  assert_int_equal(mps_kernel_get_kind(NULL), -1);
  mps_assert_near(mps_kernel_derivative(NULL, 1.0), 0.0, 0.0);
  mps_kernel_destroy(&w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(derivatives_are_those_of_the_weights),
      cmocka_unit_test(splines_are_a_partition_of_unity),
      cmocka_unit_test(moments_are_integrals),
      cmocka_unit_test(nonsense_is_refused),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
