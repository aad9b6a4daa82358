/* test_elastic_steps.c - steps of implicit elasticity among callers: whole or not at all, repeated
 * after a rollback, runs and their callbacks, numbers of boundaries and loads, arrays of facets.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "elastic_common.h"

typedef struct hook {
  int calls, at;
} hook;

static int32_t cancel(void *user) {
  hook *h = user;
  return ++h->calls >= h->at;
}

static test_body clamped(mps_context *context, const mps_elastic_def *def) {
  test_body b = test_body_begin(context, 2, 0.5);
  test_body_box(&b, 0, 0, 0, 8, 2, 0);
  test_body_finish(&b, 2.0, 0.3, def);
  mps_assert_ok(context, mps_particles_set(b.particles, "density", 0, 1.0));
  int64_t count, *ids = test_select(&b, 0, -1, 0.3, &count);
  mps_elastic_boundary_def wall = mps_elastic_boundary_defaults();
  wall.ids = ids;
  wall.id_count = count;
  mps_assert_ok(context, mps_elastic_add_boundary(b.elastic, &wall, NULL));
  free(ids);
  const double gravity[2] = {0.01, -0.05};
  mps_assert_ok(context, test_body_force(b.elastic, gravity));
  return b;
}

static void start(test_body *b, double dt) {
  mps_elastic_motion_def def = mps_elastic_motion_defaults();
  def.dt = dt;
  def.stiffness_damping = 0.01;
  mps_assert_ok(b->context, mps_elastic_start(b->elastic, &def));
}

/* Everything that a caller sees, as bytes to compare. */
static double *picture(test_body *b, int64_t *size) {
  static const char *const fields[] = {"displacement", "velocity", "acceleration", "reaction"};
  mps_totals t;
  mps_reaction r;
  *size = b->n * 8 + 20 + 14;
  double *out = calloc((size_t)*size, sizeof *out);
  for (int64_t i = 0; i < b->n; i++)
    for (int k = 0; k < 8; k++) out[i * 8 + k] = test_value(b, fields[k / 2], i, k % 2);
  mps_assert_ok(b->context, mps_elastic_get_totals(b->elastic, &t));
  mps_assert_ok(b->context, mps_elastic_get_reaction(b->elastic, 0, &r));
  memcpy(out + b->n * 8, &t, sizeof t);
  memcpy(out + b->n * 8 + 16, r.force, sizeof r.force);
  memcpy(out + b->n * 8 + 19, r.impulse, sizeof r.impulse);
  out[b->n * 8 + 22] = r.work;
  out[b->n * 8 + 23] = mps_elastic_time(b->elastic);
  out[b->n * 8 + 24] = (double)mps_elastic_steps(b->elastic);
  return out;
}

static void assert_same(test_body *b, double *before) {
  int64_t size;
  double *now = picture(b, &size);
  assert_memory_equal(now, before, (size_t)size * sizeof *now);
  free(now);
}

/* ---- whole or not at all --------------------------------------------------------------------- */

/* Each retry of a step whose CG does not converge added energy. */
static void a_step_that_fails_has_not_happened(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_elastic_def def = mps_elastic_defaults();
  def.solver = MPS_ELASTIC_SOLVER_CG;
  def.iterations = 12;
  def.tolerance = 1e-8;
  test_body b = clamped(context, &def), twin = clamped(context, &def);
  start(&b, 0.02);
  start(&twin, 0.02);
  mps_assert_ok(context, mps_elastic_step(b.elastic, 3));
  int64_t size;
  double *before = picture(&b, &size);
  mps_assert_ok(context, mps_elastic_set_dt(b.elastic, 1e4));
  for (int again = 0; again < 4; again++) {
    mps_assert_fails(context, mps_elastic_step(b.elastic, 1), MPS_ERROR_NUMERIC,
                     "in 12 iterations");
    assert_int_equal(mps_context_error(context)->step, 3);
    assert_same(&b, before);
  }
  free(before);
  mps_assert_ok(context, mps_elastic_set_dt(b.elastic, 0.02));
  mps_assert_ok(context, mps_elastic_step(b.elastic, 2));
  mps_assert_ok(context, mps_elastic_step(twin.elastic, 5));
  before = picture(&twin, &size);
  assert_same(&b, before);
  free(before);
  test_body_end(&b);
  test_body_end(&twin);
  mps_context_destroy(&context);
}

static void a_cancelled_step_leaves_whole_ones(void **state) {
  (void)state;
  hook h = {.at = INT32_MAX};
  mps_context_def def = mps_context_defaults();
  mps_context *context = NULL;
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  def.cancel = cancel;
  def.cancel_user = &h;
  assert_int_equal(mps_context_create(&def, &context, NULL, 0), MPS_OK);
  test_body b = clamped(context, NULL), twin = clamped(context, NULL);
  start(&b, 0.1);
  start(&twin, 0.1);
  h = (hook){.at = 6};
  mps_assert_fails(context, mps_elastic_step(b.elastic, 50), MPS_ERROR_CANCELLED, "cancelled");
  assert_int_equal(mps_elastic_steps(b.elastic), 5);
  h.at = INT32_MAX;
  mps_assert_ok(context, mps_elastic_step(twin.elastic, 5));
  int64_t size;
  double *expected = picture(&twin, &size);
  assert_same(&b, expected); /* the fields are those of the fifth step */
  h = (hook){.at = 1};
  mps_assert_fails(context, mps_elastic_run(b.elastic, 9.0, 1, NULL, NULL), MPS_ERROR_CANCELLED,
                   "cancelled");
  assert_same(&b, expected);
  free(expected);
  test_body_end(&b);
  test_body_end(&twin);
  mps_context_destroy(&context);
}

/* ---- implicit coupling ----------------------------------------------------------------------- */

/* A step is tried with three loads, as a coupling iterates; the last try counts. */
static void a_step_can_be_repeated_with_other_loads(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  test_body b = clamped(context, NULL), twin = clamped(context, NULL);
  mps_snapshot *snapshot = NULL;
  mps_elastic_load_def load = mps_elastic_load_defaults();
  int64_t count, *facets = test_facets(&b, 1, 1, &count);
  int32_t number[2];
  load.kind = MPS_ELASTIC_LOAD_PRESSURE;
  load.ids = facets;
  load.id_count = count;
  mps_assert_ok(context, mps_elastic_add_load(b.elastic, &load, &number[0]));
  mps_assert_ok(context, mps_elastic_add_load(twin.elastic, &load, &number[1]));
  start(&b, 0.1);
  start(&twin, 0.1);
  for (int step = 0; step < 10; step++) {
    mps_assert_ok(context, mps_elastic_snapshot(b.elastic, &snapshot));
    for (int try = 0; try < 3; try++) {
      mps_assert_ok(context, mps_elastic_rollback(b.elastic, snapshot));
      load.force[0] = 0.02 * step + 0.1 * (2 - try);
      mps_assert_ok(context, mps_elastic_set_load(b.elastic, number[0], &load));
      mps_assert_ok(context, mps_elastic_step(b.elastic, 1));
    }
    mps_assert_ok(context, mps_elastic_set_load(twin.elastic, number[1], &load));
    mps_assert_ok(context, mps_elastic_step(twin.elastic, 1));
    int64_t size;
    double *expected = picture(&twin, &size);
    assert_same(&b, expected);
    free(expected);
  }
  free(facets);
  mps_snapshot_destroy(&snapshot);
  test_body_end(&b);
  test_body_end(&twin);
  mps_context_destroy(&context);
}

/* A solver built in the same way continues from a file bit for bit. */
static void a_saved_motion_goes_on(void **state) {
  (void)state;
  const char *path = "test_elastic_steps.h5";
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  test_body b = clamped(context, NULL), twin = clamped(context, NULL);
  start(&b, 0.1);
  mps_assert_ok(context, mps_elastic_step(b.elastic, 7));
  const mps_status status = mps_elastic_save(b.elastic, path, NULL);
  if (status != MPS_ERROR_UNSUPPORTED) { /* built without HDF5 */
    mps_assert_ok(context, status);
    mps_assert_fails(context, mps_elastic_restore(twin.elastic, path, NULL), MPS_ERROR_STATE,
                     "mps_elastic_start");
    start(&twin, 0.1);
    mps_assert_ok(context, mps_elastic_restore(twin.elastic, path, NULL));
    mps_assert_ok(context, mps_elastic_step(b.elastic, 5));
    mps_assert_ok(context, mps_elastic_step(twin.elastic, 5));
    int64_t size;
    double *expected = picture(&b, &size);
    assert_same(&twin, expected);
    free(expected);
    remove(path);
  }
  test_body_end(&b);
  test_body_end(&twin);
  mps_context_destroy(&context);
}

/* ---- runs ------------------------------------------------------------------------------------ */

typedef struct caller {
  test_body *body;
  int calls, stop_at;
  double last;
} caller;

static mps_status look(void *user, mps_elastic *e) {
  caller *c = user;
  mps_totals t;
  mps_context *context = c->body->context;
  const double now = mps_elastic_time(e);
  assert_true(c->calls == 0 || now > c->last);
  c->last = now;
  if (mps_elastic_get_totals(e, &t) != MPS_OK) return MPS_ERROR_INTERNAL;
  /* Reading is allowed, the rest is not; destroying does nothing. */
  mps_elastic *same = e;
  mps_assert_fails(context, mps_elastic_step(e, 1), MPS_ERROR_STATE, "mps_elastic_run");
  mps_assert_fails(context, mps_elastic_set_dt(e, 1.0), MPS_ERROR_STATE, "mps_elastic_run");
  mps_assert_fails(context, mps_elastic_solve(e), MPS_ERROR_STATE, "mps_elastic_run");
  mps_elastic_destroy(&same);
  assert_ptr_equal(same, e);
  return ++c->calls == c->stop_at ? MPS_ERROR_IO : MPS_OK;
}

static void a_run_ends_where_it_was_told(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  test_body b = clamped(context, NULL);
  caller c = {.body = &b};
  mps_assert_fails(context, mps_elastic_run(b.elastic, 1.0, 1, NULL, NULL), MPS_ERROR_STATE,
                   "mps_elastic_start");
  start(&b, 0.1);
  mps_assert_ok(context, mps_elastic_run(b.elastic, 0.77, 3, look, &c));
  assert_true(mps_elastic_time(b.elastic) == 0.77 && mps_elastic_steps(b.elastic) == 8);
  assert_int_equal(c.calls, 4); /* 0, 3, 6 and the end */
  assert_true(c.last == 0.77 && mps_elastic_dt(b.elastic) == 0.1);
  assert_true(isinf(mps_elastic_limit(b.elastic)));
  mps_assert_fails(context, mps_elastic_run(b.elastic, 0.5, 1, NULL, NULL), MPS_ERROR_ARGUMENT,
                   "t_end is 0.5 s");
  mps_assert_fails(context, mps_elastic_run(b.elastic, NAN, 1, NULL, NULL), MPS_ERROR_ARGUMENT,
                   "t_end is nan");
  c = (caller){.body = &b, .stop_at = 2};
  mps_assert_fails(context, mps_elastic_run(b.elastic, 2.0, 1, look, &c), MPS_ERROR_IO,
                   "the callback of mps_elastic_run returned status 5");
  assert_int_equal(mps_elastic_steps(b.elastic), 9);
  test_body_end(&b);
  mps_context_destroy(&context);
}

/* ---- numbers and lists ----------------------------------------------------------------------- */

static void numbers_are_the_lowest_free_ones(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  test_body b = clamped(context, NULL);
  const int64_t id = 20;
  int32_t number = -1;
  mps_reaction r;
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults();
  mps_elastic_load_def load = mps_elastic_load_defaults();
  held.ids = &id;
  held.id_count = 1;
  for (int32_t k = 1; k < 12; k++) {
    mps_assert_ok(context, mps_elastic_add_boundary(b.elastic, &held, &number));
    assert_int_equal(number, k);
    mps_assert_ok(context, mps_elastic_add_load(b.elastic, &load, &number));
    assert_int_equal(number, k);
  }
  mps_assert_ok(context, mps_elastic_remove_boundary(b.elastic, 3));
  mps_assert_ok(context, mps_elastic_remove_load(b.elastic, 4));
  mps_assert_fails(context, mps_elastic_get_reaction(b.elastic, 3, &r), MPS_ERROR_ARGUMENT,
                   "no boundary 3");
  mps_assert_fails(context, mps_elastic_set_load(b.elastic, 4, &load), MPS_ERROR_ARGUMENT,
                   "no load 4");
  mps_assert_ok(context, mps_elastic_add_boundary(b.elastic, &held, &number));
  assert_int_equal(number, 3);
  held.id_count = 0;
  held.ids = NULL;
  mps_assert_fails(context, mps_elastic_add_boundary(b.elastic, &held, &number), MPS_ERROR_ARGUMENT,
                   "neither ids nor a box");
  test_body_end(&b);
  mps_context_destroy(&context);
}

/* The field `external_force` does what a load on particles does; the boundaries hold it. */
static void external_forces_act_as_loads(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  test_body b = clamped(context, NULL), twin = clamped(context, NULL);
  const int64_t id = 50;
  const double force[2] = {0.3, -0.7};
  mps_assert_ok(context, mps_particles_add_field(b.particles, "external_force", 0));
  mps_edit f;
  mps_assert_ok(context, mps_particles_edit(b.particles, "external_force", &f));
  for (int c = 0; c < 2; c++) *mps_edit_f64(&f, id, c) = force[c];
  mps_assert_ok(context, mps_particles_commit(b.particles, &f));
  mps_assert_ok(context, test_forces(twin.elastic, 1, &id, force));
  mps_assert_ok(context, mps_elastic_solve(b.elastic));
  mps_assert_ok(context, mps_elastic_solve(twin.elastic));
  for (int64_t i = 0; i < b.n; i++)
    for (int c = 0; c < 2; c++)
      assert_true(test_value(&b, "displacement", i, c) == test_value(&twin, "displacement", i, c));
  mps_reaction r;
  mps_totals t;
  double load[3];
  mps_assert_ok(context, mps_elastic_get_reaction(b.elastic, 0, &r));
  mps_assert_ok(context, mps_elastic_get_load_resultant(b.elastic, NULL, load, NULL));
  for (int c = 0; c < 2; c++) mps_assert_near((r.force[c] + load[c]) / fabs(load[1]), 0.0, 1e-10);
  mps_assert_ok(context, mps_elastic_get_totals(b.elastic, &t));
  mps_assert_near((t.strain - t.work_loads - t.work_boundaries) / t.strain, 0.0, 1e-10);
  mpsi_particles_column(b.particles, "external_force", 1)[id] = NAN;
  mps_assert_fails(context, mps_elastic_solve(b.elastic), MPS_ERROR_ARGUMENT,
                   "external_force y of particle 50 is nan");
  test_body_end(&b);
  test_body_end(&twin);
  mps_context_destroy(&context);
}

/* Sums and squares of what is larger are infinite: neither a start nor a step may hand them out. */
static void loads_and_motions_beyond_numbers_are_refused(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  test_body b = clamped(context, NULL);
  mps_elastic_motion_def def = mps_elastic_motion_defaults();
  mps_elastic_load_def load = mps_elastic_load_defaults();
  int32_t number = -1;
  int64_t size;
  def.dt = 0.02;
  start(&b, def.dt);
  mps_assert_ok(context, mps_elastic_step(b.elastic, 2));
  load.kind = MPS_ELASTIC_LOAD_GRAVITY;
  load.force[0] = 1.7e308;
  mps_assert_ok(context, mps_elastic_add_load(b.elastic, &load, &number));
  double *before = picture(&b, &size);
  mps_assert_fails(context, mps_elastic_step(b.elastic, 1), MPS_ERROR_NUMERIC,
                   "N along x, allowed is up to 1e+150 N");
  mps_assert_fails(context, mps_elastic_start(b.elastic, &def), MPS_ERROR_NUMERIC,
                   "N along x, allowed is up to 1e+150 N");
  assert_same(&b, before);
  mps_assert_ok(context, mps_elastic_remove_load(b.elastic, number));
  mpsi_particles_column(b.particles, "displacement", 1)[50] = 1e200;
  mps_assert_fails(context, mps_elastic_start(b.elastic, &def), MPS_ERROR_NUMERIC,
                   "particle 50 is beyond double precision");
  mpsi_particles_column(b.particles, "displacement", 1)[50] = before[50 * 8 + 1];
  assert_same(&b, before);
  mps_assert_ok(context, mps_elastic_step(b.elastic, 1));
  free(before);
  test_body_end(&b);
  mps_context_destroy(&context);
}

/* A bar in tension: facets move as the linear field says. */
static void facets_come_as_arrays(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  test_body b = test_body_begin(context, 2, 0.5);
  test_body_box(&b, 0, 0, 0, 4, 2, 0);
  mps_elastic_def def = mps_elastic_defaults();
  def.measure = 3.0;
  test_body_finish(&b, 2.0, 0.0, &def);
  int64_t count, *ids = test_select(&b, 0, -1, 0.3, &count);
  mps_assert_ok(context, test_prescribe(b.elastic, 0, count, ids, NULL));
  mps_assert_ok(context, test_prescribe(b.elastic, 1, 1, ids, NULL));
  mps_assert_ok(context, mps_elastic_cut(b.elastic, 0, -1, count, ids));
  free(ids);
  int64_t *right = test_facets(&b, 0, 1, &count);
  const double pull[2] = {0.1, 0.0};
  mps_assert_ok(context, test_traction(b.elastic, count, right, pull));
  mps_assert_ok(context, mps_elastic_solve(b.elastic));
  const int64_t all = mps_elastic_facet_count(b.elastic);
  assert_int_equal(all, 2 * (8 + 4));
  int64_t particle[24];
  double centre[72], normal[72], extent[72], area[24], u[72], v[72], total = 0.0;
  const mps_elastic_facet_arrays arrays = {.particle = particle,
                                           .centre = centre,
                                           .normal = normal,
                                           .extent = extent,
                                           .area = area,
                                           .displacement = u,
                                           .velocity = v};
  mps_assert_ok(context, mps_elastic_get_facets(b.elastic, all, NULL, &arrays));
  for (int64_t k = 0; k < all; k++) {
    total += area[k];
    mps_assert_near(u[3 * k], 0.05 * (centre[3 * k] - 0.25), 1e-14);
    mps_assert_near(fabs(normal[3 * k]) + fabs(normal[3 * k + 1]), 1.0, 0.0);
    const int across = normal[3 * k] != 0.0; /* the axis along the edge */
    mps_assert_near(3.0 * extent[3 * k + across], area[k], 1e-14);
    mps_assert_near(fabs(extent[3 * k + 1 - across]) + fabs(extent[3 * k + 2]), 0.0, 0.0);
    mps_assert_near(u[3 * k + 2] + v[3 * k] + v[3 * k + 1], 0.0, 0.0);
  }
  mps_assert_near(total, 3.0 * 11.5, 1e-12); /* half cells at the wall */
  mps_assert_ok(context, mps_elastic_get_facets(b.elastic, count, right, &arrays));
  for (int64_t k = 0; k < count; k++) {
    mps_assert_near(centre[3 * k], 4.0, 0.0);
    mps_assert_near(test_value(&b, "position", particle[k], 0), 3.75, 0.0);
  }
  const int64_t none = 24;
  mps_assert_fails(context, mps_elastic_get_facets(b.elastic, 1, &none, &arrays),
                   MPS_ERROR_ARGUMENT, "facets[0] is 24");
  free(right);
  test_body_end(&b);
  mps_context_destroy(&context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_step_that_fails_has_not_happened),
      cmocka_unit_test(a_cancelled_step_leaves_whole_ones),
      cmocka_unit_test(a_step_can_be_repeated_with_other_loads),
      cmocka_unit_test(a_saved_motion_goes_on),
      cmocka_unit_test(a_run_ends_where_it_was_told),
      cmocka_unit_test(numbers_are_the_lowest_free_ones),
      cmocka_unit_test(external_forces_act_as_loads),
      cmocka_unit_test(loads_and_motions_beyond_numbers_are_refused),
      cmocka_unit_test(facets_come_as_arrays),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
