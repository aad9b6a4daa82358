/* test_elastic_long.c - a million unknowns of implicit elasticity on the ranks that mpirun starts:
 * a plate in tension, whose exact solution the method has. SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"
#include "world.h"
#include "petsc_solves.h"

#define COLUMNS 1000
#define ROWS 500

static mps_petsc_solver *solver;

static void a_plate_of_a_million_unknowns(void **state) {
  (void)state;
  const double stress = 2.0, young = 8.0, nu = 0.3;
  scoped_test_body b = test_body_begin(own, 2, 1.0);
  mps_elastic_report report;
  test_body_box(&b, 0, 0, 0, COLUMNS, ROWS, 0);
  DEF(elastic, def, .domain = domain);
  test_body_finish(&b, young, nu, &def);
  int64_t count, corner, *ids = test_select(&b, 0, -1, 0.6, &count);
  corner = ids[0];
  OK(test_prescribe(b.elastic, 0, count, ids, NULL));
  OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_LOWER, ids, count));
  OK(test_prescribe(b.elastic, 1, 1, &corner, NULL)); /* it carries nothing */
  free(ids);
  int64_t *facets = test_facets(&b, 0, 1, &count);
  double *traction = calloc((size_t)count * 3, sizeof *traction);
  for (int64_t k = 0; k < count; k++) traction[3 * k] = stress;
  OK(test_traction(b.elastic, count, facets, traction));
  free(traction);
  free(facets);
  OK(petsc_solves(solver, mps_elastic_solver(b.elastic), MPS_LINEAR_EQUATION_STIFFNESS, 0));
  OK(mps_elastic_solve(b.elastic));
  OK(mps_elastic_get_report(b.elastic, &report));
  double away = 0.0;
  mps_view x, u;
  OK(mps_particles_view(b.particles, "position", &x));
  OK(mps_particles_view(b.particles, "displacement", &u));
  const double bottom = *mps_view_f64(&x, mps_particles_index(b.particles, corner), 1);
  for (int64_t i = 0; i < b.n; i++) {
    away = fmax(away,
                fabs(*mps_view_f64(&u, i, 0) - stress / young * (*mps_view_f64(&x, i, 0) - 0.5)));
    away = fmax(away, fabs(*mps_view_f64(&u, i, 1) +
                           nu * stress / young * (*mps_view_f64(&x, i, 1) - bottom)));
  }
  away /= stress / young * COLUMNS;
  print_message("%lld unknowns: %lld iterations, residual %.1e, error %.1e, %.1f s\n",
                (long long)report.unknowns, (long long)report.iterations, report.residual, away,
                report.seconds_solve);
  assert_true(report.unknowns > 990000);
  assert_true(report.iterations < 100);
  assert_true(report.residual < 1.1e-10);
  NEAR(away, 0.0, 1e-8);
}

int main(void) {
  if (!begin_world()) return 1;
  if (mps_petsc_solver_create_world(own, MPS_PETSC_METHOD_MULTIGRID, &solver) != MPS_OK) return 1;
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_plate_of_a_million_unknowns)};
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  mps_petsc_solver_destroy(&solver);
  return end_world(failed);
}
