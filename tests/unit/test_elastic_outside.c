/* test_elastic_outside.c - equations of implicit elasticity solved from outside: conjugate
 * gradients of this test in place of the library's solvers, the matrix in parts, invalid solutions.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "conjugate.h"
#include "elastic_common.h"

#include <mps/elastic_solver.h>

static mps_context *own;

/* A copy of the matrix; `part` of it. */
typedef struct plug {
  mps_elastic *inside; /* to be solved from within, where given */
  int64_t all, first, rows, *start;
  int32_t block, modes, *column;
  double *value, *mode;
  int matrices, solutions;
  double factor_of_answer;
  mps_status answer;
} plug;

static void drop(plug *p) {
  void *parts[] = {p->start, p->column, p->value, p->mode};
  for (int k = 0; k < 4; k++) free(parts[k]);
  p->start = NULL, p->column = NULL, p->value = NULL, p->mode = NULL;
}

static void *copy(const void *from, size_t count, size_t size) {
  void *to = malloc(count * size + 1);
  return memcpy(to, from, count * size);
}

static mps_status take(void *user, const mps_elastic_matrix *m, size_t size) {
  plug *p = user;
  assert_int_equal(size, sizeof *m);
  p->matrices++;
  if (p->answer != MPS_OK) return p->answer;
  const size_t rows = (size_t)m->rows, entries = (size_t)m->start[m->rows];
  drop(p);
  p->all = m->all, p->first = m->first, p->rows = m->rows;
  p->block = m->block, p->modes = m->modes;
  p->start = copy(m->start, rows + 1, sizeof *m->start);
  p->column = copy(m->column, entries, sizeof *m->column);
  p->value = copy(m->value, entries, sizeof *m->value);
  p->mode = copy(m->mode, rows * (size_t)m->modes, sizeof *m->mode);
  return MPS_OK;
}

static mps_status multiply(const void *matrix, const double *x, double *y) {
  const plug *p = matrix;
  for (int64_t i = 0; i < p->rows; i++) {
    y[i] = 0.0;
    for (int64_t k = p->start[i]; k < p->start[i + 1]; k++) y[i] += p->value[k] * x[p->column[k]];
  }
  return MPS_OK;
}

static mps_status solve(void *user, const double *b, double tolerance, double *x,
                        int64_t *iterations) {
  plug *p = user;
  const int64_t n = p->all;
  p->solutions++;
  if (p->inside) return mps_elastic_solve(p->inside);
  if (p->rows < p->all) return MPS_OK; /* a part alone solves nothing */
  const mps_status status = test_conjugate(n, multiply, p, b, tolerance, x, iterations);
  for (int64_t i = 0; i < n; i++) x[i] *= p->factor_of_answer;
  return status;
}

static bool stiff(double x, double y) {
  (void)y;
  return x > 1.0;
}

/* An L of two materials, held below, with a roller at an angle. */
static test_body ell(int dim) {
  test_body b = test_body_begin(own, dim, 0.25);
  mps_elastic_def def = mps_elastic_defaults();
  def.tolerance = 1e-11;
  test_body_box(&b, 0, 0, 0, 2, 1, 0.5);
  test_body_box(&b, 0, 1, 0, 1, 2, 0.5);
  test_body_finish(&b, 1.0, 0.3, &def);
  test_inclined(&b, stiff, 1e-2, false);
  return b;
}

static void put_in(test_body *b, plug *p, int32_t part, int32_t parts) {
  mps_elastic_solver_def def = mps_elastic_solver_defaults();
  def.user = p, def.matrix = take, def.solve = solve;
  def.part = part, def.parts = parts;
  mps_assert_ok(own, mps_elastic_set_solver(b->elastic, &def));
}

static void another_solver_gives_the_same_displacements(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; dim++) {
    plug p = {.factor_of_answer = 1.0};
    test_body alone = ell(dim), other = ell(dim);
    mps_elastic_report report;
    put_in(&other, &p, 0, 1);
    mps_assert_ok(own, mps_elastic_solve(alone.elastic));
    mps_assert_ok(own, mps_elastic_solve(other.elastic));
    mps_assert_ok(own, mps_elastic_solve(other.elastic));
    test_compare(&alone, &other, "displacement", 1e-9);
    test_compare(&alone, &other, "reaction", 1e-9);
    assert_int_equal(p.matrices, 1); /* the second solution has the same */
    assert_int_equal(p.solutions, 2);
    assert_int_equal(p.all, alone.n * dim);
    assert_int_equal(p.block, dim);
    mps_assert_ok(own, mps_elastic_get_report(other.elastic, &report));
    assert_int_equal(report.solver, MPS_ELASTIC_SOLVER_FOREIGN);
    assert_int_equal(report.matrix_nonzeros, p.start[p.rows]);
    assert_true(report.iterations > 10 && report.residual < 1e-10);
    /* Motions: two steps, two matrices. Then the library's own again. */
    mps_elastic_motion_def motion = mps_elastic_motion_defaults();
    test_body *both[2] = {&alone, &other};
    const double pull[3] = {0.5, 0.2, -0.3}; /* beside the first */
    motion.dt = 0.2;
    for (int k = 0; k < 2; k++) {
      mps_assert_ok(own, test_body_force(both[k]->elastic, pull));
      mps_assert_ok(own, mps_particles_set(both[k]->particles, "density", 0, 2.0));
      mps_assert_ok(own, mps_elastic_start(both[k]->elastic, &motion));
      mps_assert_ok(own, mps_elastic_step(both[k]->elastic, 4));
      mps_assert_ok(own, mps_elastic_set_dt(both[k]->elastic, 0.1));
      mps_assert_ok(own, mps_elastic_step(both[k]->elastic, 4));
    }
    test_compare(&alone, &other, "velocity", 1e-8);
    mps_assert_ok(own, mps_elastic_set_solver(other.elastic, NULL));
    mps_assert_ok(own, mps_elastic_solve(alone.elastic));
    mps_assert_ok(own, mps_elastic_solve(other.elastic));
    test_compare(&alone, &other, "displacement", 1e-13);
    test_body_end(&alone);
    test_body_end(&other);
    drop(&p);
  }
}

/* Parts of the rows are those of the whole, which is symmetric; a rigid motion strains nothing
 * where no support is near. */
static void the_matrix_comes_in_parts(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; dim++) {
    plug whole = {.factor_of_answer = 1.0}, part = {.factor_of_answer = 1.0};
    test_body b = ell(dim);
    put_in(&b, &whole, 0, 1);
    mps_assert_ok(own, mps_elastic_solve(b.elastic));
    double *u = calloc((size_t)(2 * whole.all), sizeof *u), *f = u + whole.all;
    double asymmetry = 0.0, largest = 0.0;
    for (int64_t i = 0; i < whole.all; i++)
      for (int64_t k = whole.start[i]; k < whole.start[i + 1]; k++) {
        const int64_t j = whole.column[k];
        double mirrored = 0.0;
        for (int64_t m = whole.start[j]; m < whole.start[j + 1]; m++)
          if (whole.column[m] == i) mirrored = whole.value[m];
        asymmetry = fmax(asymmetry, fabs(whole.value[k] - mirrored));
        largest = fmax(largest, fabs(mirrored));
      }
    assert_true(asymmetry < 1e-14 * largest);
    assert_int_equal(whole.modes, dim == 2 ? 3 : 6);
    for (int32_t m = 0; m < whole.modes; m++) {
      multiply(&whole, whole.mode + m * whole.all, f);
      for (int64_t i = 0; i < whole.all; i++)
        if (fabs(test_value(&b, "position", i / dim, 1) - 1.125) < 0.1 &&
            test_value(&b, "position", i / dim, 0) < 0.3)
          mps_assert_near(f[i] / largest, 0.0, 1e-13);
    }
    for (int32_t parts = 2; parts <= 5; parts += 3)
      for (int32_t k = 0, row = 0; k < parts; k++) {
        put_in(&b, &part, k, parts);
        mps_assert_fails(own, mps_elastic_solve(b.elastic), MPS_ERROR_NUMERIC, "residual");
        assert_int_equal(part.first, row);
        assert_int_equal(part.rows % dim, 0);
        for (int64_t i = 0; i < part.rows; i++, row++) {
          const int64_t count = part.start[i + 1] - part.start[i];
          assert_int_equal(count, whole.start[row + 1] - whole.start[row]);
          assert_memory_equal(part.column + part.start[i], whole.column + whole.start[row],
                              (size_t)count * sizeof *part.column);
          assert_memory_equal(part.value + part.start[i], whole.value + whole.start[row],
                              (size_t)count * sizeof *part.value);
        }
        if (k == parts - 1) assert_int_equal(row, whole.all);
      }
    free(u);
    drop(&whole);
    drop(&part);
    test_body_end(&b);
  }
}

static void answers_that_are_none_are_refused(void **state) {
  (void)state;
  plug p = {.factor_of_answer = 1.0001};
  test_body b = ell(2);
  mps_elastic_solver_def def = mps_elastic_solver_defaults();
  mps_assert_fails(own, mps_elastic_set_solver(b.elastic, &def), MPS_ERROR_ARGUMENT, "NULL");
  def.matrix = take, def.solve = solve;
  def.part = 2, def.parts = 2;
  mps_assert_fails(own, mps_elastic_set_solver(b.elastic, &def), MPS_ERROR_ARGUMENT,
                   "part is 2 of 2");
  def.part = -1;
  mps_assert_fails(own, mps_elastic_set_solver(b.elastic, &def), MPS_ERROR_ARGUMENT, "part");
  assert_int_equal(mps_elastic_set_solver(NULL, NULL), MPS_ERROR_ARGUMENT);
  put_in(&b, &p, 0, 1);
  mps_assert_fails(own, mps_elastic_solve(b.elastic), MPS_ERROR_NUMERIC, "residual");
  p.factor_of_answer = 1.0;
  p.inside = b.elastic;
  mps_assert_fails(own, mps_elastic_solve(b.elastic), MPS_ERROR_STATE, "callback solve");
  p.inside = NULL;
  put_in(&b, &p, 0, 1);
  p.answer = MPS_ERROR_IO;
  mps_assert_fails(own, mps_elastic_solve(b.elastic), MPS_ERROR_IO, "callback matrix");
  p.answer = MPS_OK;
  mps_assert_ok(own, mps_elastic_solve(b.elastic));
  test_body_end(&b);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(another_solver_gives_the_same_displacements),
      cmocka_unit_test(the_matrix_comes_in_parts),
      cmocka_unit_test(answers_that_are_none_are_refused),
  };
  own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  mps_context_destroy(&own);
  return failed;
}
