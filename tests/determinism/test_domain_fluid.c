/* test_domain_fluid.c - the fluid on several ranks: every particle, force and number has the bits
 * of the run without a domain, on whatever number of ranks and threads; and an error of one rank is
 * an error of all. SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_ranks.h"
#include "ranks_team.h"

static int64_t steps(int64_t full) { return test_quick() ? full / 6 : full; }

TEST(test_collapse) { compare_teams(compute, COLLAPSE, steps(18), true); }
TEST(test_afloat) { compare_teams(compute, AFLOAT, steps(6), true); }
TEST(test_spill) { compare_teams(compute, SPILL, steps(24), true); }
TEST(test_classical) { compare_teams(compute, CLASSICAL, steps(12), false); }
TEST(test_breakwater) { compare_teams(compute, BREAKWATER, steps(12), true); }
TEST(test_puddle) { compare_teams(compute, PUDDLE, 20, true); }

/* ---- cut in two ------------------------------------------------------------------------------ */

#define CHECKPOINT "test_domain_fluid.h5"

static mps_status begin(mps_context *own, mps_domain *domain, int what, int64_t count, result *r) {
  return compute_half(own, domain, what, count, NULL, CHECKPOINT, r);
}

static mps_status go_on(mps_context *own, mps_domain *domain, int what, int64_t count, result *r) {
  return compute_half(own, domain, what, count, CHECKPOINT, NULL, r);
}

/* Written by 3 ranks, it continues with 2, and without a domain, as a run without one does; and
 * before it does, it reports what it reported before. */
TEST(test_checkpoint) {
  if (!mps_library_has(MPS_FEATURE_HDF5)) skip();
  const int64_t count = steps(12);
  result half = {0}, whole = {0}, on = {0};
  mps_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  OK(begin(own, NULL, COLLAPSE, count, &half));
  OK(go_on(own, NULL, COLLAPSE, count, &whole));
  remove(CHECKPOINT);
  compare_part(begin, 3, COLLAPSE, count, &half, true);
  compare_part(go_on, 2, COLLAPSE, 0, &half, true);
  compare_part(go_on, 2, COLLAPSE, count, &whole, true);
  OK(go_on(own, NULL, COLLAPSE, count, &on));
  int64_t *seen = calloc((size_t)whole.count + 1, sizeof *seen);
  compare(&whole, &on, seen);
  free(seen);
  drop(&half), drop(&whole), drop(&on);
  mps_context_destroy(&own);
  remove(CHECKPOINT);
}

/* ---- what goes wrong on one rank ------------------------------------------------------------- */

TEST(test_refused_memory) { refuse_memory(compute, POND, 2, 9); }

/* One after the other, what ranks do not agree upon, what fails on one of them, what is refused. */
#define FLUID_TROUBLES(ROW)                                                                        \
  ROW(OTHER_SET, MPS_ERROR_ARGUMENT, "a hash of the set's particles")                              \
  ROW(OTHER_DENSITY, MPS_ERROR_ARGUMENT, "density is ")                                            \
  ROW(OTHER_WALL, MPS_ERROR_ARGUMENT, "another value on others")                                   \
  ROW(OTHER_COUNT, MPS_ERROR_ARGUMENT, "count is ")                                                \
  ROW(NO_COUNT, MPS_ERROR_ARGUMENT, "count is -1")                                                 \
  ROW(OTHER_END, MPS_ERROR_ARGUMENT, "every is 0")                                                 \
  ROW(OTHER_ADDED, MPS_ERROR_ARGUMENT, "the number of particles is ")                              \
  ROW(CANCELLED, MPS_ERROR_CANCELLED, "stopped by the cancel hook at step 0")                      \
  ROW(CALLBACK_FAILS, MPS_ERROR_IO, "rank 2: ")                                                    \
  ROW(SOLVER, MPS_ERROR_ARGUMENT, "the linear solver is rank 0 of 1 processes")                    \
  ROW(OTHER_LOAD, MPS_ERROR_ARGUMENT, "another value on others")                                   \
  ROW(OTHER_SIGNAL, MPS_ERROR_ARGUMENT, "another value on others")                                 \
  ROW(OTHER_BODY, MPS_ERROR_ARGUMENT, "another value on others")                                   \
  ROW(OTHER_REMOVED, MPS_ERROR_ARGUMENT, "number is ")                                             \
  ROW(NO_SUCH_LOAD, MPS_ERROR_ARGUMENT, "number is 5: there is no load")
enum { FLUID_TROUBLES(CASE_NAME) TROUBLES };
static const trouble_case trouble[TROUBLES] = {FLUID_TROUBLES(CASE_ROW)};

static mps_status refuse_callback(void *user, mps_fluid *fluid) {
  return *(const int32_t *)user == 2 && mps_fluid_steps(fluid) > 0 ? MPS_ERROR_IO : MPS_OK;
}

static int32_t cancel(void *user) { return *(const int32_t *)user == 1; }

static mps_status no_matrix(void *user, const mps_linear_matrix *matrix) { return MPS_OK; }

static mps_status no_solve(void *user, const double *b, double tolerance, double *x,
                           mps_linear_result *out) {
  return MPS_OK;
}

/* Loads, walls and bodies that are not the same on all ranks. */
static mps_status define_otherwise(mps_context *own, scene *s, int what, int32_t rank) {
  scoped_signal *signal = NULL;
  scoped_body *body = NULL;
  const double right = what == OTHER_BODY && rank == 2 ? 0.41 : 0.4;
  const double corner[8] = {0.2, 0.6, right, 0.6, right, 0.7, 0.2, 0.7};
  const mps_body_def def = mps_body_defaults();
  mps_status status =
      mps_signal_create_sine(own, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0,
                             what == OTHER_SIGNAL ? 0.01 + 0.001 * rank : 0.01, 0.0, &signal);
  TRY(wall(s, MPS_BOUNDARY_ROLLER, 0.6, 0.0, -1.0, 0.0, signal));
  TRY(mps_body_create_polygon(own, &def, 4, corner, &body));
  TRY(mps_fluid_add_contact(s->fluid, body, NULL, NULL));
  DEF(fluid_load, load, .all = 1, .acceleration[0] = what == OTHER_LOAD ? 0.1 * rank : 0.1);
  TRY(mps_fluid_add_load(s->fluid, &load, NULL));
  TRY(mps_fluid_add_load(s->fluid, &load, NULL));
  if (what == NO_SUCH_LOAD) TRY(mps_fluid_set_load(s->fluid, rank == 1 ? 5 : 0, &load));
  TRY(mps_fluid_remove_load(s->fluid, rank == 1 ? 1 : 0));
  return status;
}

static mps_status run_trouble(mps_context *own, mps_domain *domain, int what, int32_t rank) {
  SCOPED(drop_scene) scene s = {.set = NULL};
  DEF(particles, set, .spacing = 0.02);
  DEF(fluid, def, .domain = domain);
  const double lower[2] = {0.0, 0.0}, upper[2] = {0.6, 0.4}, extra[2] = {0.3, 0.7};
  if (what == OTHER_DENSITY) def.density = 1000.0 + rank;
  mps_status status = mps_particles_create(own, &set, &s.set);
  TRY(mps_particles_fill_box(s.set, lower, upper, NULL));
  if (what == OTHER_SET && rank == 1) TRY(mps_particles_append(s.set, 1, extra));
  TRY(mps_fluid_create(own, s.set, &def, &s.fluid));
  TRY(wall(&s, MPS_BOUNDARY_ROLLER, 0.0, 0.0, 0.0, 1.0, NULL));
  TRY(wall(&s, MPS_BOUNDARY_ROLLER, what == OTHER_WALL ? -0.1 * rank : 0.0, 0.0, 1.0, 0.0, NULL));
  mps_linear_solver_def solver = mps_linear_solver_defaults(); /* of one process */
  solver.matrix = no_matrix, solver.solve = no_solve;
  if (what == SOLVER)
    TRY(mps_solver_set_linear_solver(mps_fluid_solver(s.fluid), MPS_LINEAR_EQUATION_PRESSURE,
                                     &solver));
  if (what >= OTHER_LOAD) TRY(define_otherwise(own, &s, what, rank));
  if (what == OTHER_ADDED && rank == 1) TRY(mps_particles_append(s.set, 1, extra));
  if (what == CALLBACK_FAILS) TRY(mps_fluid_run(s.fluid, 0.1, 1, refuse_callback, &rank));
  if (what == CANCELLED) mps_context_set_cancel(own, cancel, &rank, NULL);
  if (what == OTHER_END) TRY(mps_fluid_run(s.fluid, 0.1, rank == 1 ? 0 : 1, NULL, NULL));
  TRY(mps_fluid_step(s.fluid, what == OTHER_COUNT             ? 1 + rank
                              : what == NO_COUNT && rank == 1 ? -1
                                                              : 2));
  return status;
}

TEST(test_troubles) { meet_troubles(run_trouble, trouble, TROUBLES); }
