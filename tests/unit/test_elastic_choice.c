/* test_elastic_choice.c - MPS_ELASTIC_SOLVER_AUTO in space: a compact body is solved by conjugate
 * gradients, a slender one, many load cases and motions by a factor, and one whose iterations do
 * not end by a factor too. The results are those of the factor, and do not depend on what was
 * solved before. SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"

/* A block of m x m x n cells, its lowest layer held, pulled by gravity. */
static test_body block(mps_context *context, int m, int n, int32_t solver, int64_t iterations) {
  DEF(elastic, def, .solver = solver, .blas_threads = 1, .iterations = iterations);
  test_body b = test_body_begin(context, 3, 0.5);
  const double gravity[3] = {0.2, -0.5, -1.0};
  int64_t count, *ids;
  test_body_box(&b, 0, 0, 0, 0.5 * m, 0.5 * m, 0.5 * n);
  test_body_finish(&b, 2e6, 0.3, &def);
  ids = test_select(&b, 2, -1, 0.3, &count);
  for (int c = 0; c < 3; c++) OK(test_prescribe(b.elastic, c, count, ids, NULL));
  OK(test_body_force(b.elastic, gravity));
  free(ids);
  return b;
}

/* The displacements, at rest, and by what they were found. */
static double *solve(test_body *b, mps_elastic_report *report) {
  double *u = malloc((size_t)(3 * b->n) * sizeof *u);
  OK(mps_elastic_solve(b->elastic));
  OK(mps_elastic_get_report(b->elastic, report));
  for (int64_t k = 0; k < 3 * b->n; k++) u[k] = test_value(b, "displacement", k / 3, (int)(k % 3));
  return u;
}

static double largest_difference(const double *a, const double *b, int64_t n) {
  double most = 0.0, size = 0.0;
  for (int64_t k = 0; k < n; k++)
    most = fmax(most, fabs(a[k] - b[k])), size = fmax(size, fabs(b[k]));
  return most / size;
}

static void compare(mps_context *context, int m, int n, int64_t iterations, int64_t least,
                    int64_t factors, double bound) {
  mps_elastic_report report, direct;
  scoped_test_body a = block(context, m, n, MPS_ELASTIC_SOLVER_AUTO, iterations);
  scoped_test_body b = block(context, m, n, MPS_ELASTIC_SOLVER_LLT, 0);
  double *u = solve(&a, &report), *v = solve(&b, &direct);
  const double off = largest_difference(u, v, 3 * a.n);
  print_message("%d x %d x %d, at most %lld: %lld iterations, %lld factors, off by %.2g\n", m, m, n,
                (long long)iterations, (long long)report.iterations,
                (long long)report.factorisations, off);
  assert_true(report.iterations >= least && report.factorisations == factors && off < bound);
  free(u), free(v);
}

TEST_SERIAL(the_choice_in_space) {
  compare(context, 12, 12, 0, 61, 0, 1e-8);  /* compact: iterations */
  compare(context, 3, 120, 0, 0, 1, 1e-9);   /* slender: the factor */
  compare(context, 12, 12, 60, 60, 1, 1e-9); /* iterations do not end: the factor */
}

TEST_SERIAL(many_cases_and_motions_take_a_factor_and_later_solutions_do_not_notice) {
  enum { CASES = 8 };
  mps_elastic_report report;
  scoped_test_body b = block(context, 12, 12, MPS_ELASTIC_SOLVER_AUTO, 0);
  double *first = solve(&b, &report);
  double *loads = calloc((size_t)(3 * b.n * CASES), sizeof *loads);
  double *made = calloc((size_t)(3 * b.n * CASES), sizeof *made);
  for (int k = 0; k < CASES; k++) loads[3 * b.n * k + 3 * (b.n - 1)] = 1.0;
  OK(mps_elastic_solve_cases(b.elastic, CASES - 1, loads, made));
  OK(mps_elastic_get_report(b.elastic, &report));
  assert_int_equal(report.factorisations, 0);
  const double few = made[3 * (b.n - 1)];
  OK(mps_elastic_solve_cases(b.elastic, CASES, loads, made));
  OK(mps_elastic_get_report(b.elastic, &report));
  assert_int_equal(report.factorisations, 1);
  NEAR(made[3 * (b.n - 1)] / few, 1.0, 1e-8);
  OK(mps_particles_set(b.particles, "density", 0, 1000.0));
  USING(elastic_motion, mps_elastic_start(b.elastic, &given), .dt = 1e-3);
  OK(mps_elastic_step(b.elastic, 2));
  double *again = solve(&b, &report);
  assert_memory_equal(again, first, (size_t)(3 * b.n) * sizeof *first);
  free(first), free(again), free(loads), free(made);
}
