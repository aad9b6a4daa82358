/* test_elastic.c - implicit elasticity on the ranks that mpirun starts: each rank solves alone by
 * CHOLMOD, then all of them together by PETSc, and compares.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"
#include "world.h"
#include "petsc_solves.h"

static mps_petsc_solver *solvers[2]; /* by method */

static bool stiff(double x, double y) {
  (void)x;
  return y < 0.5;
}

/* A stepped block of two materials, held below, sliding along an inclined plane on one side. */
static test_body block(int dim, mps_petsc_solver *solver) {
  test_body b = test_body_begin(own, dim, 0.25);
  test_body_box(&b, 0, 0, 0, 3, 1, 1);
  test_body_box(&b, 0, 1, 0, 1.5, 2, 1);
  DEF(elastic, def, .tolerance = 1e-11);
  if (solver) def.domain = domain;
  test_body_finish(&b, 1.0, 0.3, &def);
  test_inclined(&b, stiff, 1e-3, true);
  if (solver)
    OK(petsc_solves(solver, mps_elastic_solver(b.elastic), MPS_LINEAR_EQUATION_STIFFNESS, 0));
  return b;
}

static void static_solutions_are_cholmods(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; dim++)
    for (int method = 0; method < 2; method++) {
      mps_elastic_report report;
      scoped_test_body alone = block(dim, NULL), together = block(dim, solvers[method]);
      OK(mps_elastic_solve(alone.elastic));
      OK(mps_elastic_solve(together.elastic));
      test_compare(&alone, &together, "displacement", 1e-9);
      test_compare(&alone, &together, "reaction", 1e-9);
      OK(mps_elastic_get_report(together.elastic, &report));
      assert_int_equal(report.solver, MPS_ELASTIC_SOLVER_FOREIGN);
      assert_true(report.residual < 1e-10);
      assert_true(report.iterations <= (method == MPS_PETSC_METHOD_DIRECT ? 2 : 60));
      /* Another load, the same matrix. */
      const double force[3] = {-0.2, 0.1, 0.3};
      OK(test_body_force(alone.elastic, force));
      OK(test_body_force(together.elastic, force));
      OK(mps_elastic_solve(alone.elastic));
      OK(mps_elastic_solve(together.elastic));
      test_compare(&alone, &together, "displacement", 1e-9);
    }
}

static void motions_are_cholmods(void **state) {
  (void)state;
  DEF(elastic_motion, motion, .dt = 0.2);
  test_body both[2] = {block(2, NULL), block(2, solvers[MPS_PETSC_METHOD_MULTIGRID])};
  for (int k = 0; k < 2; k++) {
    OK(mps_particles_set(both[k].particles, "density", 0, 2.0));
    OK(mps_elastic_start(both[k].elastic, &motion));
    OK(mps_elastic_step(both[k].elastic, 8));
    OK(mps_elastic_set_dt(both[k].elastic, 0.1)); /* another matrix */
    OK(mps_elastic_step(both[k].elastic, 8));
  }
  test_compare(&both[0], &both[1], "displacement", 1e-8);
  test_compare(&both[0], &both[1], "velocity", 1e-8);
  test_body_end(&both[0]);
  test_body_end(&both[1]);
}

/* A bar 50 times as long as wide: the last places of its displacements alone are forces above the
 * tolerance, which no solver can reach. */
static void a_slender_bar_is_solved(void **state) {
  (void)state;
  test_body both[2];
  const double force[3] = {0.0, -1e-3, 0.0};
  for (int k = 0; k < 2; k++) {
    int64_t count;
    mps_elastic_def def = mps_elastic_defaults();
    both[k] = test_body_begin(own, 2, 0.25);
    test_body_box(&both[k], 0, 0, 0, 50, 1, 0);
    def.tolerance = 1e-11;
    if (k) def.domain = domain;
    test_body_finish(&both[k], 1.0, 0.3, &def);
    int64_t *ids = test_select(&both[k], 0, -1, 0.3, &count);
    for (int c = 0; c < 2; c++) OK(test_prescribe(both[k].elastic, c, count, ids, NULL));
    free(ids);
    OK(test_body_force(both[k].elastic, force));
    if (k)
      OK(petsc_solves(solvers[0], mps_elastic_solver(both[k].elastic),
                      MPS_LINEAR_EQUATION_STIFFNESS, 0));
    OK(mps_elastic_solve(both[k].elastic));
  }
  test_compare(&both[0], &both[1], "displacement", 1e-7);
  test_body_end(&both[0]);
  test_body_end(&both[1]);
}

/* What was solved by all ranks is solved by each alone when the solver is taken out. */
static void a_solver_is_taken_out_again(void **state) {
  (void)state;
  scoped_test_body b = block(2, solvers[MPS_PETSC_METHOD_MULTIGRID]), alone = block(2, NULL);
  mps_elastic_report report;
  OK(mps_elastic_solve(b.elastic));
  OK(mps_solver_set_linear_solver(mps_elastic_solver(b.elastic), MPS_LINEAR_EQUATION_STIFFNESS,
                                  NULL));
  OK(mps_elastic_solve(b.elastic));
  OK(mps_elastic_solve(alone.elastic));
  OK(mps_elastic_get_report(b.elastic, &report));
  assert_int_equal(report.solver, MPS_ELASTIC_SOLVER_LLT);
  test_compare(&alone, &b, "displacement", 1e-13);
  mps_linear_solver_def def;
  assert_int_equal(mps_petsc_linear_solver(NULL, &def), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_petsc_linear_solver(solvers[0], NULL), MPS_ERROR_ARGUMENT);
}

int main(void) {
  if (!begin_world()) return 1;
  for (int32_t k = 0; k < 2; k++)
    if (mps_petsc_solver_create_world(own, k, &solvers[k]) != MPS_OK) return 1;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(static_solutions_are_cholmods),
      cmocka_unit_test(motions_are_cholmods),
      cmocka_unit_test(a_slender_bar_is_solved),
      cmocka_unit_test(a_solver_is_taken_out_again),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  for (int k = 0; k < 2; k++) mps_petsc_solver_destroy(&solvers[k]);
  return end_world(failed);
}
