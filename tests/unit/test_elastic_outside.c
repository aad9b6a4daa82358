/* test_elastic_outside.c - equations of implicit elasticity solved from outside, with inclined
 * supports and two materials: displacements, reactions and motions, and the matrix.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"
#include "linear_plug.h"

static mps_context *own;

static bool stiff(double x, double y) { return x > 1.0; }

/* An L of two materials, held below, with a roller at an angle. */
static test_body ell(int dim) {
  test_body b = test_body_begin(own, dim, 0.25);
  DEF(elastic, def, .tolerance = 1e-11);
  test_body_box(&b, 0, 0, 0, 2, 1, 0.5);
  test_body_box(&b, 0, 1, 0, 1, 2, 0.5);
  test_body_finish(&b, 1.0, 0.3, &def);
  test_inclined(&b, stiff, 1e-2, false);
  return b;
}

static void put_in(test_body *b, linear_plug *p) {
  const mps_linear_solver_def def = linear_plug_def(p);
  OK(mps_solver_set_linear_solver(mps_elastic_solver(b->elastic), MPS_LINEAR_EQUATION_STIFFNESS,
                                  &def));
}

TEST(another_solver_gives_the_same_displacements) {
  for (int dim = 2; dim <= 3; dim++) {
    SCOPED(linear_plug_drop) linear_plug p = {.fault = LINEAR_FINE};
    scoped_test_body alone = ell(dim), other = ell(dim);
    mps_elastic_report report;
    put_in(&other, &p);
    OK(mps_elastic_solve(alone.elastic));
    OK(mps_elastic_solve(other.elastic));
    OK(mps_elastic_solve(other.elastic));
    test_compare(&alone, &other, "displacement", 1e-9);
    test_compare(&alone, &other, "reaction", 1e-9);
    assert_int_equal(p.matrices, 1); /* the second solution has the same */
    assert_int_equal(p.solutions, 2);
    assert_int_equal(p.rows, alone.n * dim);
    assert_int_equal(p.block, dim);
    OK(mps_elastic_get_report(other.elastic, &report));
    assert_int_equal(report.solver, MPS_ELASTIC_SOLVER_FOREIGN);
    assert_int_equal(report.matrix_nonzeros, p.start[p.rows]);
    assert_true(report.iterations > 10 && report.residual < 1e-10);
    /* Motions: two steps, two matrices. Then the library's own again. */
    test_body *both[2] = {&alone, &other};
    const double pull[3] = {0.5, 0.2, -0.3}; /* beside the first */
    DEF(elastic_motion, motion, .dt = 0.2);
    for (int k = 0; k < 2; k++) {
      OK(test_body_force(both[k]->elastic, pull));
      OK(mps_particles_set(both[k]->particles, "density", 0, 2.0));
      OK(mps_elastic_start(both[k]->elastic, &motion));
      OK(mps_elastic_step(both[k]->elastic, 4));
      OK(mps_elastic_set_dt(both[k]->elastic, 0.1));
      OK(mps_elastic_step(both[k]->elastic, 4));
    }
    test_compare(&alone, &other, "velocity", 1e-8);
    OK(mps_solver_set_linear_solver(mps_elastic_solver(other.elastic),
                                    MPS_LINEAR_EQUATION_STIFFNESS, NULL));
    OK(mps_elastic_solve(alone.elastic));
    OK(mps_elastic_solve(other.elastic));
    test_compare(&alone, &other, "displacement", 1e-13);
  }
}

/* It is symmetric; a rigid motion strains nothing where no support is near. */
TEST(the_matrix_has_rigid_motions) {
  for (int dim = 2; dim <= 3; dim++) {
    SCOPED(linear_plug_drop) linear_plug p = {.fault = LINEAR_FINE};
    scoped_test_body b = ell(dim);
    put_in(&b, &p);
    OK(mps_elastic_solve(b.elastic));
    double *f = calloc((size_t)p.rows, sizeof *f), largest = 0.0;
    for (int64_t k = 0; k < p.start[p.rows]; k++) largest = fmax(largest, fabs(p.value[k]));
    assert_true(linear_asymmetry(&p) < 1e-14 * largest);
    assert_int_equal(p.modes, dim == 2 ? 3 : 6);
    for (int32_t m = 0; m < p.modes; m++) {
      linear_multiply(&p, p.mode + m * p.rows, f);
      for (int64_t i = 0; i < p.rows; i++)
        if (fabs(test_value(&b, "position", i / dim, 1) - 1.125) < 0.1 &&
            test_value(&b, "position", i / dim, 0) < 0.3)
          NEAR(f[i] / largest, 0.0, 1e-13);
    }
    free(f);
  }
}

static int make_own(void **state) {
  own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  return 0;
}

static int drop_own(void **state) {
  mps_context_destroy(&own);
  return 0;
}

TEST_GROUP(make_own, drop_own)
