/* test_elastic_cantilever.c - the seed's cantilever: tip errors of both methods at four sizes
 * against the reference values of an independent prototype, stress error, nearly incompressible
 * material. SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"

static const int size_nx[4] = {17, 33, 65, 129}, size_ny[4] = {9, 17, 33, 65};

static double tip_error(const mps_elastic_def *def, double nu, int size) {
  mps_context *context = test_context(MPS_EXECUTOR_SERIAL, 1);
  cantilever c = {.nu = nu, .height = 2.0};
  test_body b = cantilever_make(context, &c, size_nx[size], size_ny[size], def);
  const double error = 100.0 * cantilever_solve(&b, &c, def);
  mps_elastic_report report;
  mps_assert_ok(context, mps_elastic_get_report(b.elastic, &report));
  print_message("nu %g method %d re %g N %d: tip error %+.3f %%, residual %.1e, nnz(K)/row %.1f, "
                "nnz(L) %.3g, assemble %.3f analyse %.3f factor %.3f s\n",
                nu, def->method, def->radius_ratio, (int)b.n, error, report.residual,
                (2.0 * (double)report.matrix_nonzeros - (double)report.unknowns) /
                    (double)report.unknowns,
                (double)report.factor_nonzeros, report.seconds_assemble, report.seconds_analyse,
                report.seconds_factor);
  assert_true(report.residual < 1e-10);
  test_body_end(&b);
  mps_context_destroy(&context);
  return error;
}

static void conservative_tip_errors_are_the_reference_values(void **state) {
  (void)state;
  const double expected[4] = {0.79, 0.34, 0.11, 0.03};
  mps_elastic_def def = mps_elastic_defaults();
  for (int k = 0; k < 4; k++) mps_assert_near(tip_error(&def, 0.3, k), expected[k], 0.05);
}

static void published_tip_errors_are_the_reference_values(void **state) {
  (void)state;
  const double wide[4] = {3.6, 3.0, 1.9, 1.05}, narrow[4] = {-1.26, -0.09, 0.14, 0.13};
  mps_elastic_def def = mps_elastic_defaults();
  def.method = MPS_ELASTIC_PUBLISHED;
  for (int k = 0; k < 4; k++) {
    def.radius_ratio = 3.0;
    mps_assert_near(tip_error(&def, 0.3, k), wide[k], 0.05);
    def.radius_ratio = 2.1;
    mps_assert_near(tip_error(&def, 0.3, k), narrow[k], 0.05);
  }
}

static void a_nearly_incompressible_cantilever_does_not_lock(void **state) {
  (void)state;
  mps_elastic_def def = mps_elastic_defaults();
  def.state = MPS_ELASTIC_PLANE_STRAIN;
  assert_true(fabs(tip_error(&def, 0.4999, 0)) < 2.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(conservative_tip_errors_are_the_reference_values),
      cmocka_unit_test(published_tip_errors_are_the_reference_values),
      cmocka_unit_test(a_nearly_incompressible_cantilever_does_not_lock),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
