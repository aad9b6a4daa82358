/* test_elastic.c - implicit elasticity: what is refused and why, solvers and orderings agree, the
 * symbolic factor is kept, memory limits, failures inside CHOLMOD.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/operator/moduli.h"
#include "elastic_common.h"
#include "core/particles/particles_internal.h"
#include "test_allocator.h"

#include "implicit/base/implicit_solver.h"
#include "implicit/body/window.h"

#include <SuiteSparse_config.h>

static test_body square(mps_context *context, int cells, const mps_elastic_def *def) {
  test_body b = test_body_begin(context, 2, 0.5);
  test_body_box(&b, 0, 0, 0, 0.5 * cells, 0.5 * cells, 0);
  test_body_finish(&b, 2.0, 0.3, def);
  return b;
}

/* Clamped below, pulled down by gravity. */
static void clamp(test_body *b) {
  int64_t count, *ids = test_select(b, b->dim - 1, -1, 0.3, &count);
  const double gravity[3] = {0.2, -1.0, -0.5};
  for (int c = 0; c < b->dim; c++) OK(test_prescribe(b->elastic, c, count, ids, NULL));
  OK(test_body_force(b->elastic, gravity));
  free(ids);
}

/* ---- refused at creation --------------------------------------------------------------------- */

static void refuse_points(mps_context *context, int64_t count, const double *x, const char *why) {
  scoped_test_body b = test_body_begin(context, 2, 0.5);
  OK(mps_particles_append(b.particles, count, x));
  SET_FIELDS(b.particles, {"young", 1.0}, {"poisson", 0.3});
  REFUSES(mps_elastic_create(context, b.particles, NULL, &b.elastic), why);
  assert_null(b.elastic);
}

TEST_SERIAL(bodies_that_cannot_be_solved_are_refused) {
  const double off[] = {0, 0, 0.5, 0, 0, 0.5, 0.5, 0.51};
  refuse_points(context, 4, off, "particle 3 is off the lattice");
  const double twice[] = {0, 0, 0.5, 0, 0, 0.5, 0.5, 0.5, 0.5, 0};
  refuse_points(context, 5, twice, "particles 1 and 4 lie at the same point");
  const double lonely[] = {0, 0, 0.5, 0, 0, 0.5, 0.5, 0.5, 5, 5};
  refuse_points(context, 5, lonely, "particle 4 is isolated");
  const double thin[] = {0, 0, 0.5, 0, 1, 0};
  refuse_points(context, 3, thin, "one particle thick along y at particle 0");
  const double far_away[] = {0, 0, 0.5, 0, 0, 0.5, 0.5, 0.5, 1e9, 0};
  scoped_test_body b = test_body_begin(context, 2, 0.5);
  OK(mps_particles_append(b.particles, 5, far_away));
  FAILS(mps_elastic_create(context, b.particles, NULL, &b.elastic), MPS_ERROR_UNSUPPORTED,
        "spacings from particle 0");
  test_body_end(&b);
  b = test_body_begin(context, 2, 0.5);
  REFUSES(mps_elastic_create(context, b.particles, NULL, &b.elastic), "empty");
  test_body_box(&b, 0, 0, 0, 1, 1, 0);
  FAILS(mps_elastic_create(context, b.particles, NULL, &b.elastic), MPS_ERROR_FIELD,
        "no field 'young'");
}

TEST_SERIAL(impossible_materials_are_refused) {
  scoped_test_body b = square(context, 3, NULL);
  double *young = mpsi_particles_column(b.particles, "young", 0); /* past the set's own check */
  double *poisson = mpsi_particles_column(b.particles, "poisson", 0);
  const struct {
    double *field;
    double value;
    const char *why;
  } bad[] = {{young, 0.0, "young of particle 4 is 0"},
             {young, -2.0, "young of particle 4 is -2"},
             {young, NAN, "young of particle 4 is nan"},
             {young, INFINITY, "young of particle 4 is inf"},
             {poisson, 0.5, "poisson of particle 4 is 0.5"},
             {poisson, -1.0, "poisson of particle 4 is -1"},
             {poisson, NAN, "poisson of particle 4 is nan"}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    const double good = bad[k].field[4];
    bad[k].field[4] = bad[k].value;
    mps_elastic *other = NULL;
    REFUSES(mps_elastic_create(context, b.particles, NULL, &other), bad[k].why);
    assert_null(other);
    REFUSES(mpsi_elastic_renew_material(b.elastic, __func__), bad[k].why);
    assert_int_equal(mps_context_error(context)->particle, 4);
    bad[k].field[4] = good;
  }
  /* The refused values have changed nothing. */
  clamp(&b);
  OK(mps_elastic_solve(b.elastic));
}

TEST_SERIAL(bad_definitions_are_refused) {
  scoped_test_body b = square(context, 3, NULL);
  mps_elastic *e = NULL;
  assert_int_equal(mps_elastic_create(NULL, b.particles, NULL, &e), MPS_ERROR_ARGUMENT);
  REFUSES(mps_elastic_create(context, NULL, NULL, &e), "particles is NULL");
  REFUSES(mps_elastic_create(context, b.particles, NULL, NULL), "out is NULL");
  mps_elastic_destroy(NULL);
  mps_elastic_destroy(&e);
  test_body_end(&b);
  b = test_body_begin(context, 3, 0.5);
  test_body_box(&b, 0, 0, 0, 1, 1, 1);
  mps_elastic_def def = mps_elastic_defaults();
  FAILS(test_create(context, b.particles, &def, TEST_PUBLISHED, &e), MPS_ERROR_UNSUPPORTED,
        "two-dimensional");
}

/* ---- refused calls --------------------------------------------------------------------------- */

TEST_SERIAL(bad_supports_and_loads_are_refused) {
  scoped_test_body b = square(context, 3, NULL);
  mps_elastic *e = b.elastic;
  const int64_t good[2] = {0, 1}, bad[2] = {0, 9}, facet_bad[1] = {12};
  const double nan_values[2] = {0.0, NAN}, zero[2] = {0, 0}, one[4] = {1, 1, 1, 1};
#define REFUSE(call, why) REFUSES(call, why)
  REFUSE(test_prescribe(e, 2, 2, good, NULL), "dofs is 4");
  REFUSE(test_prescribe(e, 0, 2, bad, NULL), "ids[1] is 9");
  REFUSE(test_prescribe(e, 0, -2, good, NULL), "id_count is -2");
  REFUSE(test_prescribe(e, 0, 2, NULL, NULL), "id_count is 2 and ids is NULL");
  REFUSE(test_prescribe(e, 0, 2, good, nan_values), "values[3] is nan");
  REFUSE(test_roller(e, zero, 2, good, NULL), "normal has the length 0");
  REFUSE(test_roller(e, nan_values, 2, good, NULL), "normal has the length nan");
  REFUSE(mps_elastic_cut(e, MPS_SIDE_Z_UPPER, good, 2),
         "side is MPS_SIDE_Z_UPPER, allowed are MPS_SIDE_X_LOWER to MPS_SIDE_Y_UPPER");
  REFUSE(mps_elastic_cut(e, MPS_SIDE_ANY, good, 2), "side is MPS_SIDE_ANY");
  REFUSE(mps_elastic_cut(e, MPS_SIDE_X_LOWER, bad, 2), "ids[1] is 9");
  FAILS(mps_elastic_cut(e, MPS_SIDE_X_UPPER, good, 2), MPS_ERROR_STATE,
        "particle 0 has a neighbour");
  REFUSE(test_forces(e, 2, bad, one), "ids[1] is 9");
  REFUSE(test_forces(e, 1, good, nan_values), "values[1] is nan");
  REFUSE(test_body_force(e, nan_values), "force[1] is nan");
  REFUSE(test_traction(e, 1, facet_bad, one), "ids[0] is 12");
  REFUSE(test_traction(e, 1, good, nan_values), "force[1] is nan");
  REFUSE(test_pressure(e, 2, good, nan_values), "values[1] is nan");
  REFUSE(test_traction_fn(e, 2, good, NULL, NULL), "function is NULL");
  REFUSE(mps_elastic_solve_cases(e, 1, NULL, NULL), "loads is NULL");
  REFUSE(mps_elastic_get_section(e, 0, NAN, NULL, NULL, NULL), "position is nan");
  assert_int_equal(mps_elastic_solve(NULL), MPS_ERROR_ARGUMENT);
  /* x + y and x - y fix a particle: a third direction is one too many. */
  const double up[2] = {1, 1}, down[2] = {1, -1};
  OK(test_roller(e, up, 1, good, NULL));
  OK(test_roller(e, down, 1, good, NULL));
  FAILS(test_prescribe(e, 0, 1, good, NULL), MPS_ERROR_STATE, "already fixed");
  double force[3];
  OK(mps_elastic_get_load_resultant(e, NULL, force, NULL));
  assert_true(force[0] == 0.0 && force[1] == 0.0); /* nothing of the refused loads is left */
#undef REFUSE
}

TEST_SERIAL(free_rigid_motions_are_named) {
  scoped_test_body b = square(context, 4, NULL);
  mps_elastic *e = b.elastic;
#define REFUSE(why) FAILS(mps_elastic_solve(e), MPS_ERROR_STATE, why)
  REFUSE("leave 3 of the 3 rigid motions");
  const int64_t corner = 0, other = 15;
  int64_t count, *ids = test_select(&b, 1, -1, 0.3, &count);
  OK(test_prescribe(e, 1, count, ids, NULL));
  REFUSE("leave 1 of the 3");
  REFUSE("translation along x");
  free(ids);
  OK(test_clear_boundaries(e));
  for (int c = 0; c < 2; c++) OK(test_prescribe(e, c, 1, &corner, NULL));
  REFUSE("rotation about (0.25, 0.25)");
  /* A roller whose line passes through the pin does not hold the rotation either. */
  const double line[2] = {1, 1}, square_to_it[2] = {1, -1};
  OK(test_roller(e, line, 1, &other, NULL));
  REFUSE("rotation about (0.25, 0.25)");
  OK(test_clear_boundaries(e));
  for (int c = 0; c < 2; c++) OK(test_prescribe(e, c, 1, &corner, NULL));
  OK(test_roller(e, square_to_it, 1, &other, NULL));
  OK(mps_elastic_solve(e));
  test_body_end(&b);
  /* Two bodies, one of them unsupported: its part is named. Contact at a corner is no support. */
  b = test_body_begin(context, 2, 0.5);
  test_body_box(&b, 0, 0, 0, 1, 1, 0);
  test_body_box(&b, 1, 1, 0, 2, 2, 0);
  test_body_finish(&b, 1.0, 0.3, NULL);
  e = b.elastic;
  clamp(&b);
  REFUSE("part of 4 particles with particle 4");
  test_body_end(&b);
  b = test_body_begin(context, 3, 0.5);
  test_body_box(&b, 0, 0, 0, 1, 1, 1);
  test_body_finish(&b, 1.0, 0.3, NULL);
  e = b.elastic;
  REFUSE("leave 6 of the 6");
  ids = test_select(&b, 2, -1, 0.3, &count);
  for (int c = 0; c < 3; c++) OK(test_prescribe(e, c, c == 2 ? count : 1, ids, NULL));
  REFUSE("rotation about the direction (0, 0, 1)");
  free(ids);
#undef REFUSE
}

/* ---- solvers --------------------------------------------------------------------------------- */

TEST_SERIAL(solvers_and_orderings_agree) {
  const struct {
    int32_t solver, ordering;
    double limit;
  } ways[] = {{MPS_ELASTIC_SOLVER_AUTO, MPS_ELASTIC_ORDERING_BEST, NAN},
              {MPS_ELASTIC_SOLVER_LLT, MPS_ELASTIC_ORDERING_AMD, INFINITY},
              {MPS_ELASTIC_SOLVER_LLT, MPS_ELASTIC_ORDERING_METIS, NAN},
              {MPS_ELASTIC_SOLVER_LDLT, MPS_ELASTIC_ORDERING_AMD, INFINITY},
              {MPS_ELASTIC_SOLVER_CG, MPS_ELASTIC_ORDERING_AMD, INFINITY},
              {MPS_ELASTIC_SOLVER_AUTO, MPS_ELASTIC_ORDERING_AMD, 1000.0}};
  double reference = 0.0;
  for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
    DEF(elastic, def, .solver = ways[k].solver, .ordering = ways[k].ordering,
        .memory_limit = ways[k].limit, .tolerance = 1e-12);
    scoped_test_body b = square(context, 20, &def);
    clamp(&b);
    OK(mps_elastic_solve(b.elastic));
    const double u = test_value(&b, "displacement", b.n - 1, 0);
    if (k == 0) reference = u;
    NEAR(u / reference, 1.0, 1e-9);
    mps_elastic_report report;
    OK(mps_elastic_get_report(b.elastic, &report));
    const int cg = k >= 4;
    assert_int_equal(report.solver, cg       ? MPS_ELASTIC_SOLVER_CG
                                    : k == 3 ? MPS_ELASTIC_SOLVER_LDLT
                                             : MPS_ELASTIC_SOLVER_LLT);
    assert_true(cg ? report.iterations > 10 : report.condition > 10.0);
    assert_true(report.residual < 1e-11);
  }
  DEF(elastic, def, .solver = MPS_ELASTIC_SOLVER_LLT, .memory_limit = 1000.0);
  scoped_test_body b = square(context, 20, &def);
  clamp(&b);
  FAILS(mps_elastic_solve(b.elastic), MPS_ERROR_MEMORY, "memory_limit is 1000");
  test_body_end(&b);
  def = mps_elastic_defaults();
  def.solver = MPS_ELASTIC_SOLVER_CG;
  def.iterations = 3;
  b = square(context, 20, &def);
  clamp(&b);
  FAILS(mps_elastic_solve(b.elastic), MPS_ERROR_NUMERIC, "in 3 iterations");
}

/* Negative shear moduli, which no field can give: set inside the solver. */
TEST_SERIAL(a_matrix_that_is_not_positive_definite_is_diagnosed) {
  scoped_test_body b = square(context, 8, NULL);
  for (int64_t i = 40; i < b.n; i++) b.elastic->mu[i] = -1.0;
  mpsi_elastic_measure(b.elastic);
  clamp(&b);
  for (int again = 0; again < 2; again++) {
    FAILS(mps_elastic_solve(b.elastic), MPS_ERROR_NUMERIC, "not positive definite at direction");
    assert_in_range(mps_context_error(context)->particle, 8, b.n - 1);
  }
  OK(mpsi_elastic_renew_material(b.elastic, __func__)); /* as the fields say */
  OK(mps_elastic_solve(b.elastic));
}

TEST_SERIAL(what_can_be_kept_is_kept) {
  scoped_test_body b = square(context, 12, NULL);
  mps_elastic_report report;
  mps_elastic_estimate estimate;
  clamp(&b);
  OK(mps_elastic_analyse(b.elastic, &estimate));
  assert_int_equal(estimate.unknowns, 2 * 12 * 11);
  assert_true(estimate.factor_nonzeros > estimate.matrix_nonzeros && estimate.factor_flops > 1e4);
  OK(mps_elastic_solve(b.elastic));
  const double u = test_value(&b, "displacement", 20, 1);
  const double load[2] = {0.2, -1.0};
  OK(test_body_force(b.elastic, load)); /* twice the load */
  OK(mps_elastic_solve(b.elastic));
  NEAR(test_value(&b, "displacement", 20, 1) / u, 2.0, 1e-12);
  OK(mps_elastic_get_report(b.elastic, &report));
  assert_int_equal(report.factorisations, 1);
  /* Half the stiffness: a new factor on the old analysis. */
  OK(mps_particles_set(b.particles, "young", 0, 1.0));
  OK(mps_elastic_solve(b.elastic));
  NEAR(test_value(&b, "displacement", 20, 1) / u, 4.0, 1e-12);
  OK(mps_elastic_get_report(b.elastic, &report));
  assert_int_equal(report.factorisations, 2);
  assert_int_equal(report.analyses, 1);
  assert_int_equal(report.factor_nonzeros, estimate.factor_nonzeros);
  /* A prescribed value that changes needs nothing new; a new support does. */
  const int64_t id = 0;
  const double lift = 0.1;
  OK(test_prescribe(b.elastic, 1, 1, &id, &lift));
  OK(mps_elastic_solve(b.elastic));
  NEAR(test_value(&b, "displacement", 0, 1), 0.1, 0.0);
  OK(mps_elastic_get_report(b.elastic, &report));
  assert_int_equal(report.factorisations, 2);
  OK(test_prescribe(b.elastic, 0, 1, &(int64_t){100}, NULL));
  OK(mps_elastic_solve(b.elastic));
  OK(mps_elastic_get_report(b.elastic, &report));
  assert_int_equal(report.analyses, 2);
}

TEST_SERIAL(many_load_cases_superpose) {
  scoped_test_body b = square(context, 6, NULL);
  clamp(&b);
  const int64_t cases = 37, all = b.n * 3;
  double *loads = calloc((size_t)(cases * all), sizeof *loads);
  double *u = calloc((size_t)(cases * all), sizeof *u);
  for (int64_t k = 0; k < cases; k++) {
    loads[k * all + 90 + k % 2] = 1.0 + (double)k;
    loads[k * all + 106] = 0.5;
  }
  OK(mps_elastic_solve_cases(b.elastic, cases, loads, u));
  for (int64_t k = 0; k < cases; k += 6) {
    int64_t ids[36];
    for (int64_t i = 0; i < b.n; i++) ids[i] = i;
    USING(elastic_load, mps_elastic_set_load(b.elastic, 0, &given), .kind = MPS_ELASTIC_LOAD_FORCE,
          .ids = ids, .id_count = b.n, .values = loads + k * all);
    OK(mps_elastic_solve(b.elastic));
    for (int64_t i = 0; i < all; i++)
      NEAR(u[k * all + i],
           i % 3 == 2 ? 0.0 : test_value(&b, "displacement", i / 3, (int32_t)(i % 3)), 1e-10);
  }
  free(loads);
  free(u);
}

TEST_SERIAL(a_body_that_is_held_everywhere_has_no_unknowns) {
  scoped_test_body b = square(context, 2, NULL);
  const int64_t ids[4] = {0, 1, 2, 3};
  const double load[2] = {1.0, -2.0};
  for (int c = 0; c < 2; c++) OK(test_prescribe(b.elastic, c, 4, ids, NULL));
  OK(test_body_force(b.elastic, load));
  OK(mps_elastic_solve(b.elastic));
  double force[3];
  OK(test_reactions(b.elastic, NULL, force, NULL));
  NEAR(force[0], -1.0, 1e-14);
  NEAR(force[1], 2.0, 1e-14);
}

/* Lists in disorder that name particles twice: held ones stay, driven ones are where they are
 * driven to, and their reactions balance one another and the load; one particle alone is a list
 * too. */
TEST_SERIAL(lists_hold_and_drive_exactly) {
  scoped_test_body b = square(context, 4, NULL);
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults(), driven = held;
  const int64_t below[6] = {3, 0, 1, 3, 2, 0}, above[1] = {14};
  const double load[2] = {0.3, -2.0}, to[3] = {0.01, 0.02, 0.0}; /* load: of 1 m2 */
  int32_t number[2];
  mps_reaction r[2];
  held.ids = below, held.id_count = 6;
  driven.kind = MPS_BOUNDARY_DRIVEN, driven.ids = above, driven.id_count = 1, driven.values = to;
  OK(mps_elastic_add_boundary(b.elastic, &held, &number[0]));
  OK(mps_elastic_add_boundary(b.elastic, &driven, &number[1]));
  OK(test_body_force(b.elastic, load));
  OK(mps_elastic_solve(b.elastic));
  for (int k = 0; k < 2; k++) OK(mps_elastic_get_reaction(b.elastic, number[k], &r[k]));
  assert_int_equal(r[1].count, 1);
  for (int c = 0; c < 2; c++) {
    for (int k = 0; k < 6; k++) NEAR(test_value(&b, "displacement", below[k], c), 0, 0);
    NEAR(test_value(&b, "displacement", 14, c), to[c], 0.0);
    NEAR(r[0].force[c] + r[1].force[c] + 4.0 * load[c], 0.0, 1e-11);
    assert_true(fabs(r[1].force[c]) > 1e-3);
  }
}

/* ---- memory ---------------------------------------------------------------------------------- */

/* Everything once: create, support, solve, stresses, cases, a motion, modes. */
static mps_status use(mps_context *context, mps_particles *particles, int32_t solver,
                      mps_elastic **out) {
  DEF(elastic, def, .solver = solver);
  DEF(elastic_motion, motion, .dt = 0.1);
  const int64_t ids[4] = {0, 1, 2, 3};
  const double gravity[2] = {0.0, -1.0};
  double loads[48] = {0.0}, u[48], omega[2];
  mps_status status = mps_elastic_create(context, particles, &def, out);
  for (int c = 0; c < 2 && status == MPS_OK; c++) status = test_prescribe(*out, c, 4, ids, NULL);
  if (status == MPS_OK) status = test_body_force(*out, gravity);
  if (status == MPS_OK) status = mps_elastic_solve(*out);
  if (status == MPS_OK) status = mps_elastic_update_stress(*out);
  if (status == MPS_OK) status = mps_elastic_solve_cases(*out, 1, loads, u);
  if (status == MPS_OK) status = mps_elastic_start(*out, &motion);
  if (status == MPS_OK) status = mps_elastic_step(*out, 2);
  if (status == MPS_OK) status = mps_elastic_modes(*out, 2, omega, NULL);
  return status == MPS_ERROR_UNSUPPORTED ? MPS_OK : status; /* built without ARPACK */
}

static mps_status make(mps_context *context, int solver) {
  DEF(particles, def, .spacing = 1.0);
  scoped_particles *particles = NULL;
  scoped_elastic *elastic = NULL;
  mps_status status = mps_particles_create(context, &def, &particles);
  if (status == MPS_OK) status = mps_particles_fill_box(particles, AT(0, 0), AT(4, 4), NULL);
  if (status == MPS_OK) status = mps_particles_set(particles, "young", 0, 1.0);
  if (status == MPS_OK) status = mps_particles_set(particles, "poisson", 0, 0.3);
  if (status == MPS_OK) status = mps_particles_set(particles, "density", 0, 1.0);
  if (status == MPS_OK) status = use(context, particles, solver, &elastic);
  return status;
}

TEST(every_refused_allocation_is_reported_and_leaks_nothing) {
  test_allocator_sweep(make, MPS_ELASTIC_SOLVER_AUTO);
  test_allocator_sweep(make, MPS_ELASTIC_SOLVER_CG);
}

TEST(a_step_of_a_motion_allocates_nothing) {
  test_allocator allocator = {0};
  mps_context *context = test_allocator_context(&allocator);
  test_body b = square(context, 8, NULL);
  OK(mps_particles_set(b.particles, "density", 0, 1.0));
  clamp(&b);
  USING(elastic_motion, mps_elastic_start(b.elastic, &given), .dt = 0.1);
  OK(mps_elastic_step(b.elastic, 1));
  const int64_t before = allocator.calls;
  OK(mps_elastic_step(b.elastic, 10));
  assert_int_equal(allocator.calls, before);
  /* A static solution ends the motion. */
  OK(mps_elastic_solve(b.elastic));
  FAILS(mps_elastic_step(b.elastic, 1), MPS_ERROR_STATE, "mps_elastic_start");
  test_body_end(&b);
  mps_context_destroy(&context);
  assert_int_equal(allocator.live, 0);
}

/* SuiteSparse's process-wide hooks belong to the host program: here, that is this test. */
static int64_t suite_calls, suite_refuse, suite_live;
static size_t suite_most; /* bytes at once; 0: any number */

static void *suite_malloc(size_t size) {
  if (++suite_calls == suite_refuse || (suite_most && size > suite_most)) return NULL;
  suite_live++;
  return malloc(size);
}
static void *suite_calloc(size_t count, size_t size) {
  if (++suite_calls == suite_refuse) return NULL;
  suite_live++;
  return calloc(count, size);
}
static void *suite_realloc(void *old, size_t size) {
  if (++suite_calls == suite_refuse) return NULL;
  if (!old) suite_live++;
  return realloc(old, size);
}
static void suite_free(void *memory) {
  if (memory) suite_live--;
  free(memory);
}

/* What refusing call after call inside CHOLMOD does; METIS has a memory of its own, so AMD. */
static void use_suite_hooks(void) {
  SuiteSparse_config.malloc_func = suite_malloc;
  SuiteSparse_config.calloc_func = suite_calloc;
  SuiteSparse_config.realloc_func = suite_realloc;
  SuiteSparse_config.free_func = suite_free;
}

static void drop_suite_hooks(void) {
  SuiteSparse_config.malloc_func = malloc;
  SuiteSparse_config.calloc_func = calloc;
  SuiteSparse_config.realloc_func = realloc;
  SuiteSparse_config.free_func = free;
}

TEST(failures_inside_cholmod_are_reported_and_leak_nothing) {
  use_suite_hooks();
  int64_t failed = 0;
  for (int32_t solver = MPS_ELASTIC_SOLVER_LLT; solver <= MPS_ELASTIC_SOLVER_LDLT; solver++) {
    mps_status status = MPS_ERROR_MEMORY;
    for (suite_refuse = 1; suite_refuse < 2000; suite_refuse++) {
      mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
      DEF(elastic, def, .solver = solver, .ordering = MPS_ELASTIC_ORDERING_AMD);
      suite_calls = 0;
      test_body b = square(context, 5, &def);
      clamp(&b);
      status = mps_elastic_solve(b.elastic);
      if (status != MPS_OK) {
        assert_int_equal(status, MPS_ERROR_MEMORY);
        assert_non_null(strstr(mps_context_error(context)->message, "CHOLMOD"));
        failed++;
        /* The solver is as usable as before. */
        suite_calls = suite_refuse;
        OK(mps_elastic_solve(b.elastic));
      }
      test_body_end(&b);
      mps_context_destroy(&context);
      assert_int_equal(suite_live, 0);
      if (status == MPS_OK && suite_calls < suite_refuse) break; /* nothing left to refuse */
    }
    assert_int_equal(status, MPS_OK);
  }
  print_message("%d calls refused inside CHOLMOD were reported\n", (int)failed);
  assert_true(failed > 10);
  suite_refuse = 0;
  drop_suite_hooks();
}

/* METIS, which would print and take memory from elsewhere, is not called where the memory that it
 * may need is not available: 0.3 MB for this graph, more than anything else here takes at once. */
TEST_SERIAL(without_memory_for_metis_the_ordering_is_amd) {
  int32_t chosen[2];
  use_suite_hooks();
  for (int k = 0; k < 2; k++) {
    DEF(elastic, def, .solver = MPS_ELASTIC_SOLVER_LLT, .ordering = MPS_ELASTIC_ORDERING_METIS);
    mps_elastic_report report;
    scoped_test_body b = square(context, 12, &def);
    suite_most = k ? 250000 : 0;
    clamp(&b);
    OK(mps_elastic_solve(b.elastic));
    OK(mps_elastic_get_report(b.elastic, &report));
    chosen[k] = report.ordering;
  }
  suite_most = 0;
  drop_suite_hooks();
  assert_int_equal(chosen[0], MPS_ELASTIC_ORDERING_METIS);
  assert_int_equal(chosen[1], MPS_ELASTIC_ORDERING_AMD);
}

TEST_SERIAL(the_particles_outlive_their_owner_and_may_be_used_by_two_solvers) {
  test_body b = square(context, 4, NULL);
  scoped_elastic *second = NULL;
  mps_elastic_def def = mps_elastic_defaults();
  OK(test_create(context, b.particles, &def, TEST_PUBLISHED, &second));
  mps_particles_destroy(&b.particles);
  mps_elastic_destroy(&b.elastic);
}
