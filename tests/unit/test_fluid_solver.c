/* test_fluid_solver.c - the pressure equation solved from outside: CHOLMOD in place of the
 * library's own solver gives the same motion.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#include <cholmod.h>

typedef struct plug {
  cholmod_common common;
  cholmod_factor *factor;
  int64_t rows, entries;
  int matrices, solutions;
  double asymmetry, sum; /* largest |a_ij - a_ji|; smallest sum of a row */
} plug;

static double entry(const int64_t *start, const int32_t *column, const double *value, int64_t i,
                    int64_t j) {
  for (int64_t k = start[i]; k < start[i + 1]; k++)
    if (column[k] == j) return value[k];
  return 0.0;
}

/* Factors it; the lower half will do. */
static mps_status take_matrix(void *user, const mps_linear_matrix *m) {
  const int64_t rows = m->rows, *start = m->start;
  const int32_t *column = m->column;
  const double *value = m->value;
  plug *p = user;
  p->matrices++;
  p->rows = rows, p->entries = start[rows];
  cholmod_triplet *t = cholmod_allocate_triplet((size_t)rows, (size_t)rows, (size_t)start[rows], -1,
                                                CHOLMOD_REAL, &p->common);
  for (int64_t i = 0; i < rows; i++) {
    double sum = 0.0;
    for (int64_t k = start[i]; k < start[i + 1]; k++) {
      assert_true(k == start[i] || column[k] > column[k - 1]);
      sum += value[k];
      p->asymmetry = fmax(p->asymmetry, fabs(value[k] - entry(start, column, value, column[k], i)));
      if (column[k] > i) continue;
      ((int *)t->i)[t->nnz] = (int)i, ((int *)t->j)[t->nnz] = column[k];
      ((double *)t->x)[t->nnz++] = value[k];
    }
    p->sum = fmin(p->sum, sum);
  }
  cholmod_sparse *a = cholmod_triplet_to_sparse(t, 0, &p->common);
  cholmod_free_factor(&p->factor, &p->common);
  p->factor = cholmod_analyze(a, &p->common);
  cholmod_factorize(a, p->factor, &p->common);
  cholmod_free_triplet(&t, &p->common);
  cholmod_free_sparse(&a, &p->common);
  return MPS_OK;
}

static mps_status solve(void *user, const double *b, double tolerance, double *x,
                        mps_linear_result *result) {
  plug *p = user;
  p->solutions++;
  result->iterations = 1;
  assert_true(tolerance > 0.0);
  cholmod_dense *right =
      cholmod_allocate_dense((size_t)p->rows, 1, (size_t)p->rows, CHOLMOD_REAL, &p->common);
  memcpy(right->x, b, (size_t)p->rows * sizeof *b);
  cholmod_dense *out = cholmod_solve(CHOLMOD_A, p->factor, right, &p->common);
  for (int64_t i = 0; i < p->rows; i++) x[i] = ((double *)out->x)[i];
  cholmod_free_dense(&right, &p->common);
  cholmod_free_dense(&out, &p->common);
  return MPS_OK;
}

static plug plug_start(void) {
  plug p = {.sum = INFINITY};
  cholmod_start(&p.common);
  return p;
}

static void plug_end(plug *p) {
  cholmod_free_factor(&p->factor, &p->common);
  cholmod_finish(&p->common);
}

static void put_in(mps_fluid *fluid, plug *p) {
  DEF(linear_solver, def, .user = p, .matrix = take_matrix, .solve = solve);
  OK(mps_solver_set_linear_solver(mps_fluid_solver(fluid), MPS_LINEAR_EQUATION_PRESSURE, &def));
}

/* A tank whose left wall moves, and a particle above it that falls alone. */
static tank waves_of(double length, double tolerance) {
  tank t = {NULL, NULL};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  const double drop[] = {0.3, 0.6};
  set.spacing = 0.025, def.dt = 2e-3, def.level = 0.25, def.tolerance = tolerance;
  OK(mps_particles_create(context, &set, &t.water));
  tank_fill(t.water, length, 0.25, NULL, NULL);
  OK(mps_particles_append(t.water, 1, drop));
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  MAKE(signal, piston, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0);
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, piston);
  tank_wall(t.fluid, length, 0.0, -1.0, 0.0, NULL);
  return t;
}

static tank waves(double tolerance) { return waves_of(0.6, tolerance); }

/* To 1e-7 the same energy of moving water, and the same force on a wall. */
static void check_same_flow(const mps_fluid *own, const mps_fluid *other, int32_t wall) {
  mps_totals a, b;
  OK(mps_fluid_get_totals(own, &a));
  OK(mps_fluid_get_totals(other, &b));
  assert_true(a.kinetic > 1e-3);
  NEAR(a.kinetic, b.kinetic, 1e-7 * a.kinetic);
  mps_reaction of_own, of_other;
  OK(mps_fluid_get_reaction(own, wall, &of_own));
  OK(mps_fluid_get_reaction(other, wall, &of_other));
  NEAR(of_own.force[0], of_other.force[0], 1e-7 * fabs(of_own.force[0]));
}

TEST(cholmod_moves_the_water_as_the_library_does) {
  SCOPED(plug_end) plug p = plug_start();
  scoped_tank own = waves(1e-12), other = waves(1e-10);
  put_in(other.fluid, &p);
  OK(mps_fluid_step(own.fluid, 40));
  OK(mps_fluid_step(other.fluid, 40));
  assert_int_equal(p.matrices, 40);
  assert_int_equal(p.solutions, 40);
  assert_int_equal(p.rows, 241);
  assert_true(p.asymmetry <= 1e-12);
  assert_true(p.sum > -1e-9); /* dominant: walls without flow add nothing, the surface some */
  mps_fluid_report report;
  OK(mps_fluid_get_report(other.fluid, &report));
  assert_int_equal(report.all_iterations, 40);
  check_same_flow(own.fluid, other.fluid, TANK_RIGHT);
}

/* Enough particles for several blocks and a coarse space: the same water, but in more of a tank. */
TEST(so_it_does_with_a_coarse_space) {
  SCOPED(plug_end) plug p = plug_start();
  scoped_tank own = waves_of(15.0, 1e-12), other = waves_of(15.0, 1e-10);
  put_in(other.fluid, &p);
  OK(mps_fluid_step(own.fluid, 6));
  OK(mps_fluid_step(other.fluid, 6));
  assert_int_equal(p.rows, 6001);
  check_same_flow(own.fluid, other.fluid, TANK_LEFT);
}

/* At a bent wall two particles may be at other distances from the images of one another: their
 * weights are averaged, so that the matrix stays symmetric. */
TEST(beside_a_bent_wall_the_matrix_is_symmetric) {
  SCOPED(plug_end) plug p = plug_start();
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
  const double nodes[9] = {0.6, 0.0, 0.0, 0.6, 0.12, 0.0, 0.6, 0.25, 0.0};
  const double s[3] = {0.0, -0.004, 0.0}, still[3] = {0.0, 0.0, 0.0};
  scoped_tank t = {NULL, NULL};
  set.spacing = 0.025, def.dt = 2e-3, def.level = 0.25;
  OK(mps_particles_create(context, &set, &t.water));
  tank_fill(t.water, 0.6, 0.25, NULL, NULL);
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  wall.kind = MPS_BOUNDARY_ROLLER; /* slip */
  wall.point[0] = 0.6, wall.normal[0] = -1.0, wall.nodes = nodes, wall.node_count = 3;
  int32_t number = 0;
  OK(mps_fluid_add_boundary(t.fluid, &wall, &number));
  put_in(t.fluid, &p);
  for (int k = 0; k < 5; k++) {
    OK(mps_fluid_set_boundary_motion(t.fluid, number, s, still));
    OK(mps_fluid_step(t.fluid, 1));
  }
  assert_int_equal(p.matrices, 5);
  assert_true(p.asymmetry <= 1e-12);
}

TEST(a_step_in_parts_has_one_matrix) {
  SCOPED(plug_end) plug p = plug_start();
  scoped_tank t = waves(1e-5);
  put_in(t.fluid, &p);
  OK(mps_fluid_begin_step(t.fluid, 2e-3));
  OK(mps_fluid_solve_pressure(t.fluid));
  OK(mps_fluid_solve_pressure(t.fluid));
  OK(mps_fluid_end_step(t.fluid));
  assert_int_equal(mps_fluid_steps(t.fluid), 1);
  assert_true(p.matrices == 1 && p.solutions == 2);
}
