/* test_kernel.c - weight functions: values, derivatives, moments.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

static const int32_t kinds[] = {MPS_KERNEL_MPS, MPS_KERNEL_SPLINE2, MPS_KERNEL_SPLINE3,
                                MPS_KERNEL_SMOOTH};

static mps_kernel *make(int32_t kind, double radius) {
  MAKE_KEPT(kernel, kernel, create, context, kind, radius);
  return kernel;
}

/* The derivative against central differences, and none where the weight ends. */
TEST(derivatives_are_those_of_the_weights) {
  for (int k = 0; k < 4; k++) {
    scoped_kernel *w = make(kinds[k], 3.0);
    assert_int_equal(mps_kernel_get_kind(w), kinds[k]);
    NEAR(mps_kernel_radius(w), 3.0, 0.0);
    for (double r = 0.13; r < 2.95; r += 0.0917) {
      const double e = 1e-5;
      const double slope = (mps_kernel_weight(w, r + e) - mps_kernel_weight(w, r - e)) / (2.0 * e);
      NEAR(mps_kernel_derivative(w, r), slope, 1e-6 * (1.0 + 3.0 / (r * r)));
    }
    NEAR(mps_kernel_weight(w, 3.0), 0.0, 0.0);
    NEAR(mps_kernel_weight(w, 3.0 - 1e-9), 0.0, 1e-9);
    NEAR(mps_kernel_derivative(w, 3.0), 0.0, 0.0);
    NEAR(mps_kernel_weight(w, -0.1), 0.0, 0.0);
  }
}

/* B-splines on nodes h apart are a partition of unity, and reproduce a linear function. */
TEST(splines_are_a_partition_of_unity) {
  const double h = 0.4;
  for (int k = 1; k < 3; k++) {
    scoped_kernel *w = make(kinds[k], (k == 1 ? 1.5 : 2.0) * h);
    for (double x = 0.0; x < h; x += 0.0137) {
      double sum = 0.0, first = 0.0;
      for (int i = -4; i <= 4; i++) {
        sum += mps_kernel_weight(w, fabs(x - i * h));
        first += mps_kernel_weight(w, fabs(x - i * h)) * i * h;
      }
      NEAR(sum, 1.0, 1e-14);
      NEAR(first, x, 1e-14);
    }
  }
}

/* Moment over the whole space by a midpoint rule. */
static double moment(const mps_kernel *w, int32_t dim, int32_t order) {
  const double pi = 3.14159265358979323846, sphere[3] = {2.0, 2.0 * pi, 4.0 * pi};
  const int n = 20000;
  const double step = mps_kernel_radius(w) / n;
  double sum = 0.0;
  for (int i = 0; i < n; i++) {
    const double r = (i + 0.5) * step;
    sum += mps_kernel_weight(w, r) * pow(r, dim + order - 1) * step;
  }
  return sphere[dim - 1] * sum;
}

/* A spline's integral over a line is h, its second moment h^3 (p + 1)/12 with the degree p; of
 * re/r - 1 the integral is pi re^2 in the plane, 2 pi re^3/3 in space. */
TEST(moments_are_those_of_theory) {
  const double h = 0.4, pi = 3.14159265358979323846;
  for (int k = 1; k < 3; k++) {
    scoped_kernel *w = make(kinds[k], (k == 1 ? 1.5 : 2.0) * h);
    NEAR(moment(w, 1, 0), h, 1e-9);
    NEAR(moment(w, 1, 2), h * h * h * (k + 2.0) / 12.0, 1e-9);
  }
  scoped_kernel *w = make(MPS_KERNEL_MPS, 3.0);
  NEAR(moment(w, 2, 0), 9.0 * pi, 1e-7);
  NEAR(moment(w, 3, 0), 18.0 * pi, 1e-7);
}

TEST(nonsense_is_refused) {
  scoped_kernel *w = NULL;
  REFUSES(mps_kernel_create(context, 4, 1.0, &w), "kind is 4");
  REFUSES(mps_kernel_create(context, -1, 1.0, &w), "kind");
  REFUSES(mps_kernel_create(context, 0, 1e-320, &w),
          "radius of influence is 9.99989e-321 m, must be 1e-12 to 1e+12");
  assert_null(w);
  assert_int_equal(mps_kernel_get_kind(NULL), -1);
  NEAR(mps_kernel_derivative(NULL, 1.0), 0.0, 0.0);
}
