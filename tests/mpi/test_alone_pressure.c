/* test_alone_pressure.c - a fluid's pressure solved by PETSc, in a process that no mpirun started:
 * the same motion as by the library's own solver, in iterations that do not grow with the fluid.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"
#include "petsc_solves.h"

#include <mps/experimental/petsc.h>

/* A tank of `rows` rows whose left wall moves, and a particle above it that falls alone. */
static tank waves(int rows, double tolerance) {
  const double l0 = 0.25 / rows, drop[] = {0.3, 0.6};
  scoped_signal *piston = NULL;
  tank t = {NULL, NULL};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  set.spacing = l0, def.dt = 0.04 * sqrt(l0 / TANK_G), def.level = 0.25, def.tolerance = tolerance;
  OK(mps_particles_create(context, &set, &t.water));
  tank_fill(t.water, 0.5, 0.25, NULL, NULL);
  OK(mps_particles_append(t.water, 1, drop));
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0, &piston));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, piston);
  tank_wall(t.fluid, 0.5, 0.0, -1.0, 0.0, NULL);
  return t;
}

static double force_on_the_wall(tank *t) {
  mps_reaction r;
  OK(mps_fluid_get_reaction(t->fluid, TANK_RIGHT, &r));
  return r.force[0];
}

static void moves_the_water_as_the_library_does(void **state) {
  (void)state;
  for (int32_t method = MPS_PETSC_METHOD_MULTIGRID; method <= MPS_PETSC_METHOD_DIRECT; method++) {
    mps_petsc_solver *solver = NULL;
    scoped_tank own = waves(20, 1e-12), other = waves(20, 1e-10);
    assert_int_equal(mps_petsc_solver_create(context, method, &solver), MPS_OK);
    OK(petsc_solves(solver, mps_fluid_solver(other.fluid), MPS_LINEAR_EQUATION_PRESSURE, 0));
    for (int k = 0; k < 20; k++) {
      OK(mps_fluid_step(own.fluid, 1));
      OK(mps_fluid_step(other.fluid, 1));
      const double force = force_on_the_wall(&own);
      NEAR(force_on_the_wall(&other), force, 1e-6 * fabs(force));
    }
    mps_totals a, b;
    OK(mps_fluid_get_totals(own.fluid, &a));
    OK(mps_fluid_get_totals(other.fluid, &b));
    assert_true(a.kinetic > 1e-5);
    NEAR(b.kinetic, a.kinetic, 1e-7 * a.kinetic);
    mps_petsc_solver_destroy(&solver);
  }
}

/* Iterations of the first step, whose preconditioner is new, and of three steps. */
static void iterations(int rows, mps_petsc_solver *solver, int64_t *first, int64_t *all) {
  scoped_tank t = waves(rows, 1e-8);
  mps_fluid_report report;
  if (solver)
    OK(petsc_solves(solver, mps_fluid_solver(t.fluid), MPS_LINEAR_EQUATION_PRESSURE, 100));
  OK(mps_fluid_step(t.fluid, 1));
  OK(mps_fluid_get_report(t.fluid, &report));
  *first = report.iterations;
  OK(mps_fluid_step(t.fluid, 2));
  OK(mps_fluid_get_report(t.fluid, &report));
  *all = report.all_iterations;
}

static void a_larger_fluid_takes_hardly_more_iterations(void **state) {
  (void)state;
  mps_petsc_solver *solver = NULL;
  int64_t small[2], large[2], own[2];
  assert_int_equal(mps_petsc_solver_create(context, MPS_PETSC_METHOD_MULTIGRID, &solver), MPS_OK);
  iterations(20, solver, &small[0], &small[1]);
  iterations(80, solver, &large[0], &large[1]);
  iterations(80, NULL, &own[0], &own[1]);
  print_message("801 particles: %lld iterations, %lld in 3 steps; 12801: %lld, %lld; by the "
                "library: %lld, %lld\n",
                (long long)small[0], (long long)small[1], (long long)large[0], (long long)large[1],
                (long long)own[0], (long long)own[1]);
  assert_true(large[0] <= 2 * small[0] + 2);
  assert_true(5 * large[0] < 2 * own[0]); /* 12 and 33 */
  mps_petsc_solver_destroy(&solver);
}

/* The preconditioner of former steps is no part of the state, so a snapshot ends its life. */
static void going_back_is_exact(void **state) {
  (void)state;
  mps_petsc_solver *solver = NULL, *fresh = NULL;
  scoped_snapshot *start = NULL;
  scoped_tank t = waves(20, 1e-8);
  assert_int_equal(mps_petsc_solver_create(context, MPS_PETSC_METHOD_MULTIGRID, &solver), MPS_OK);
  assert_int_equal(mps_petsc_solver_create(context, MPS_PETSC_METHOD_MULTIGRID, &fresh), MPS_OK);
  OK(petsc_solves(solver, mps_fluid_solver(t.fluid), MPS_LINEAR_EQUATION_PRESSURE, 0));
  OK(mps_fluid_step(t.fluid, 5));
  OK(mps_fluid_snapshot(t.fluid, &start));
  OK(mps_fluid_step(t.fluid, 5));
  const double force = force_on_the_wall(&t);
  OK(mps_fluid_rollback(t.fluid, start));
  OK(mps_fluid_step(t.fluid, 5));
  assert_true(force_on_the_wall(&t) == force);
  OK(mps_fluid_rollback(t.fluid, start));
  OK(petsc_solves(fresh, mps_fluid_solver(t.fluid), MPS_LINEAR_EQUATION_PRESSURE,
                  0)); /* as after a restart */
  OK(mps_fluid_step(t.fluid, 5));
  assert_true(force_on_the_wall(&t) == force);
  mps_petsc_solver_destroy(&solver);
  mps_petsc_solver_destroy(&fresh);
}

static void bad_calls_are_refused(void **state) {
  (void)state;
  mps_petsc_solver *solver = NULL;
  tank t = waves(8, 1e-8);
  REFUSES(mps_petsc_solver_create(context, 2, &solver), "method is 2, allowed are MPS_PETSC_METHOD_MULTIGRID");
  assert_int_equal(mps_petsc_solver_create(NULL, MPS_PETSC_METHOD_MULTIGRID, &solver),
                   MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_petsc_solver_create(context, -1, &solver), MPS_ERROR_ARGUMENT);
  assert_null(solver);
  assert_int_equal(mps_petsc_solver_create(context, MPS_PETSC_METHOD_MULTIGRID, NULL),
                   MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_petsc_solver_create(context, MPS_PETSC_METHOD_MULTIGRID, &solver), MPS_OK);
  REFUSES(petsc_solves(solver, mps_fluid_solver(t.fluid), MPS_LINEAR_EQUATION_PRESSURE, -1),
          "least");
  /* Below `least` the library's own solver is at work: no iteration of the other. */
  OK(petsc_solves(solver, mps_fluid_solver(t.fluid), MPS_LINEAR_EQUATION_PRESSURE, 1000));
  OK(mps_fluid_step(t.fluid, 1));
  tank_free(&t);
  mps_petsc_solver_destroy(&solver);
  mps_petsc_solver_destroy(&solver);
  mps_petsc_solver_destroy(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(moves_the_water_as_the_library_does),
      cmocka_unit_test(a_larger_fluid_takes_hardly_more_iterations),
      cmocka_unit_test(going_back_is_exact),
      cmocka_unit_test(bad_calls_are_refused),
  };
  scoped_context *of_all = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_petsc_solver *first = NULL; /* MPI can be started once in a process: it lives as long */
  if (mps_petsc_solver_create(of_all, MPS_PETSC_METHOD_MULTIGRID, &first) != MPS_OK) return 1;
  const int failed = cmocka_run_group_tests(tests, make_context, drop_context);
  mps_petsc_solver_destroy(&first);
  mps_petsc_solver *late = NULL;
  if (mps_petsc_solver_create(of_all, MPS_PETSC_METHOD_MULTIGRID, &late) != MPS_ERROR_STATE)
    return 1;
  if (!strstr(mps_context_error(of_all)->message, "cannot be started")) return 1;
  return failed;
}
