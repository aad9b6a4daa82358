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
  OK(mps_particles_set(b.particles, "density", 0, 1.0));
  int64_t count, *ids = test_select(&b, 0, -1, 0.3, &count);
  DEF(elastic_boundary, wall, .ids = ids, .id_count = count);
  OK(mps_elastic_add_boundary(b.elastic, &wall, NULL));
  free(ids);
  const double gravity[2] = {0.01, -0.05};
  OK(test_body_force(b.elastic, gravity));
  return b;
}

static void start(test_body *b, double dt) {
  USING(elastic_motion, mps_elastic_start(b->elastic, &given), .dt = dt, .stiffness_damping = 0.01);
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
  OK(mps_elastic_get_totals(b->elastic, &t));
  OK(mps_elastic_get_reaction(b->elastic, 0, &r));
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
TEST_SERIAL(a_step_that_fails_has_not_happened) {
  DEF(elastic, def, .solver = MPS_ELASTIC_SOLVER_CG, .iterations = 12, .tolerance = 1e-8);
  scoped_test_body b = clamped(context, &def), twin = clamped(context, &def);
  start(&b, 0.02);
  start(&twin, 0.02);
  OK(mps_elastic_step(b.elastic, 3));
  int64_t size;
  double *before = picture(&b, &size);
  OK(mps_elastic_set_dt(b.elastic, 1e4));
  for (int again = 0; again < 4; again++) {
    FAILS(mps_elastic_step(b.elastic, 1), MPS_ERROR_NUMERIC, "in 12 iterations");
    assert_int_equal(mps_context_error(context)->step, 3);
    assert_same(&b, before);
  }
  free(before);
  OK(mps_elastic_set_dt(b.elastic, 0.02));
  OK(mps_elastic_step(b.elastic, 2));
  OK(mps_elastic_step(twin.elastic, 5));
  before = picture(&twin, &size);
  assert_same(&b, before);
  free(before);
}

TEST(a_cancelled_step_leaves_whole_ones) {
  hook h = {.at = INT32_MAX};
  DEF(context, def, .executor = MPS_CONTEXT_EXECUTOR_SERIAL, .cancel = cancel, .cancel_user = &h);
  scoped_context *context = NULL;
  assert_int_equal(mps_context_create(&def, &context, NULL, 0), MPS_OK);
  scoped_test_body b = clamped(context, NULL), twin = clamped(context, NULL);
  start(&b, 0.1);
  start(&twin, 0.1);
  h = (hook){.at = 6};
  FAILS(mps_elastic_step(b.elastic, 50), MPS_ERROR_CANCELLED, "cancel hook at step 5");
  assert_int_equal(mps_elastic_steps(b.elastic), 5);
  h.at = INT32_MAX;
  OK(mps_elastic_step(twin.elastic, 5));
  int64_t size;
  double *expected = picture(&twin, &size);
  assert_same(&b, expected); /* the fields are those of the fifth step */
  h = (hook){.at = 1};
  FAILS(mps_elastic_run(b.elastic, 9.0, 1, NULL, NULL), MPS_ERROR_CANCELLED, "cancel hook");
  assert_same(&b, expected);
  free(expected);
}

/* ---- implicit coupling ----------------------------------------------------------------------- */

/* A step is tried with three loads, as a coupling iterates; the last try counts. */
TEST_SERIAL(a_step_can_be_repeated_with_other_loads) {
  scoped_test_body b = clamped(context, NULL), twin = clamped(context, NULL);
  scoped_snapshot *snapshot = NULL;
  DEF(elastic_load, load, .kind = MPS_ELASTIC_LOAD_PRESSURE);
  int64_t count, *facets = test_facets(&b, 1, 1, &count);
  int32_t number[2];
  load.ids = facets;
  load.id_count = count;
  OK(mps_elastic_add_load(b.elastic, &load, &number[0]));
  OK(mps_elastic_add_load(twin.elastic, &load, &number[1]));
  start(&b, 0.1);
  start(&twin, 0.1);
  for (int step = 0; step < 10; step++) {
    OK(mps_elastic_snapshot(b.elastic, &snapshot));
    for (int try = 0; try < 3; try++) {
      OK(mps_elastic_rollback(b.elastic, snapshot));
      load.force[0] = 0.02 * step + 0.1 * (2 - try);
      OK(mps_elastic_set_load(b.elastic, number[0], &load));
      OK(mps_elastic_step(b.elastic, 1));
    }
    OK(mps_elastic_set_load(twin.elastic, number[1], &load));
    OK(mps_elastic_step(twin.elastic, 1));
    int64_t size;
    double *expected = picture(&twin, &size);
    assert_same(&b, expected);
    free(expected);
  }
  free(facets);
}

/* A solver built in the same way continues from a file bit for bit. */
TEST(a_saved_motion_goes_on) {
  const char *path = "test_elastic_steps.h5";
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_test_body b = clamped(context, NULL), twin = clamped(context, NULL);
  start(&b, 0.1);
  OK(mps_elastic_step(b.elastic, 7));
  const mps_status status = mps_elastic_save(b.elastic, path, NULL);
  if (status != MPS_ERROR_UNSUPPORTED) { /* built without HDF5 */
    OK(status);
    FAILS(mps_elastic_restore(twin.elastic, path, NULL), MPS_ERROR_STATE, "mps_elastic_start");
    start(&twin, 0.1);
    OK(mps_elastic_restore(twin.elastic, path, NULL));
    OK(mps_elastic_step(b.elastic, 5));
    OK(mps_elastic_step(twin.elastic, 5));
    int64_t size;
    double *expected = picture(&b, &size);
    assert_same(&twin, expected);
    free(expected);
    remove(path);
  }
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
  FAILS(mps_elastic_step(e, 1), MPS_ERROR_STATE, "mps_elastic_run");
  FAILS(mps_elastic_set_dt(e, 1.0), MPS_ERROR_STATE, "mps_elastic_run");
  FAILS(mps_elastic_solve(e), MPS_ERROR_STATE, "mps_elastic_run");
  mps_elastic_destroy(&same);
  assert_ptr_equal(same, e);
  return ++c->calls == c->stop_at ? MPS_ERROR_IO : MPS_OK;
}

TEST_SERIAL(a_run_ends_where_it_was_told) {
  scoped_test_body b = clamped(context, NULL);
  caller c = {.body = &b};
  FAILS(mps_elastic_run(b.elastic, 1.0, 1, NULL, NULL), MPS_ERROR_STATE, "mps_elastic_start");
  start(&b, 0.1);
  OK(mps_elastic_run(b.elastic, 0.77, 3, look, &c));
  assert_true(mps_elastic_time(b.elastic) == 0.77 && mps_elastic_steps(b.elastic) == 8);
  assert_int_equal(c.calls, 4); /* 0, 3, 6 and the end */
  assert_true(c.last == 0.77 && mps_elastic_dt(b.elastic) == 0.1);
  assert_true(isinf(mps_elastic_limit(b.elastic)));
  REFUSES(mps_elastic_run(b.elastic, 0.5, 1, NULL, NULL), "t_end is 0.5 s");
  REFUSES(mps_elastic_run(b.elastic, NAN, 1, NULL, NULL), "t_end is nan");
  c = (caller){.body = &b, .stop_at = 2};
  FAILS(mps_elastic_run(b.elastic, 2.0, 1, look, &c), MPS_ERROR_IO,
        "the callback of mps_elastic_run returned status 5");
  assert_int_equal(mps_elastic_steps(b.elastic), 9);
}

/* ---- numbers and lists ----------------------------------------------------------------------- */

TEST_SERIAL(numbers_are_the_lowest_free_ones) {
  scoped_test_body b = clamped(context, NULL);
  const int64_t id = 20;
  int32_t number = -1;
  mps_reaction r;
  DEF(elastic_load, load, .kind = MPS_ELASTIC_LOAD_VOLUME, .all = 1);
  DEF(elastic_boundary, held, .ids = &id, .id_count = 1);
  for (int32_t k = 1; k < 12; k++) {
    OK(mps_elastic_add_boundary(b.elastic, &held, &number));
    assert_int_equal(number, k);
    OK(mps_elastic_add_load(b.elastic, &load, &number));
    assert_int_equal(number, k);
  }
  OK(mps_elastic_remove_boundary(b.elastic, 3));
  OK(mps_elastic_remove_load(b.elastic, 4));
  REFUSES(mps_elastic_get_reaction(b.elastic, 3, &r), "number is 3: there is no boundary");
  REFUSES(mps_elastic_set_load(b.elastic, 4, &load), "number is 4: there is no load");
  OK(mps_elastic_add_boundary(b.elastic, &held, &number));
  assert_int_equal(number, 3);
  held.id_count = 0;
  held.ids = NULL;
  REFUSES(mps_elastic_add_boundary(b.elastic, &held, &number),
          "nothing is selected: give ids and id_count, or a box");
}

/* The field `external_force` does what a load on particles does; the boundaries hold it. */
TEST_SERIAL(external_forces_act_as_loads) {
  scoped_test_body b = clamped(context, NULL), twin = clamped(context, NULL);
  const int64_t id = 50;
  const double force[2] = {0.3, -0.7};
  OK(mps_particles_add_field(b.particles, "external_force", 0));
  EDIT(f, b.particles, "external_force")
    for (int c = 0; c < 2; c++) *mps_edit_f64(&f, id, c) = force[c];
  OK(test_forces(twin.elastic, 1, &id, force));
  OK(mps_elastic_solve(b.elastic));
  OK(mps_elastic_solve(twin.elastic));
  for (int64_t i = 0; i < b.n; i++)
    for (int c = 0; c < 2; c++)
      assert_true(test_value(&b, "displacement", i, c) == test_value(&twin, "displacement", i, c));
  mps_reaction r;
  mps_totals t;
  double load[3];
  OK(mps_elastic_get_reaction(b.elastic, 0, &r));
  OK(mps_elastic_get_load_resultant(b.elastic, NULL, load, NULL));
  for (int c = 0; c < 2; c++) NEAR((r.force[c] + load[c]) / fabs(load[1]), 0.0, 1e-10);
  OK(mps_elastic_get_totals(b.elastic, &t));
  NEAR((t.strain - t.work_loads - t.work_boundaries) / t.strain, 0.0, 1e-10);
  mpsi_particles_column(b.particles, "external_force", 1)[id] = NAN;
  REFUSES(mps_elastic_solve(b.elastic), "external_force y of particle 50 is nan");
}

/* Sums and squares of what is larger are infinite: neither a start nor a step may hand them out. */
TEST_SERIAL(loads_and_motions_beyond_numbers_are_refused) {
  scoped_test_body b = clamped(context, NULL);
  DEF(elastic_motion, def, .dt = 0.02);
  int32_t number = -1;
  int64_t size;
  start(&b, def.dt);
  OK(mps_elastic_step(b.elastic, 2));
  DEF(elastic_load, load, .kind = MPS_ELASTIC_LOAD_BODY, .all = 1, .force[0] = 1.7e308);
  OK(mps_elastic_add_load(b.elastic, &load, &number));
  double *before = picture(&b, &size);
  FAILS(mps_elastic_step(b.elastic, 1), MPS_ERROR_NUMERIC, "N along x, allowed is up to 1e+150 N");
  FAILS(mps_elastic_start(b.elastic, &def), MPS_ERROR_NUMERIC,
        "N along x, allowed is up to 1e+150 N");
  assert_same(&b, before);
  OK(mps_elastic_remove_load(b.elastic, number));
  mpsi_particles_column(b.particles, "displacement", 1)[50] = 1e200;
  FAILS(mps_elastic_start(b.elastic, &def), MPS_ERROR_NUMERIC,
        "particle 50 is beyond double precision");
  mpsi_particles_column(b.particles, "displacement", 1)[50] = before[50 * 8 + 1];
  assert_same(&b, before);
  OK(mps_elastic_step(b.elastic, 1));
  free(before);
}

/* A bar in tension: facets move as the linear field says. */
TEST_SERIAL(facets_come_as_arrays) {
  scoped_test_body b = test_body_begin(context, 2, 0.5);
  test_body_box(&b, 0, 0, 0, 4, 2, 0);
  DEF(elastic, def, .measure = 3.0);
  test_body_finish(&b, 2.0, 0.0, &def);
  int64_t count, *ids = test_select(&b, 0, -1, 0.3, &count);
  OK(test_prescribe(b.elastic, 0, count, ids, NULL));
  OK(test_prescribe(b.elastic, 1, 1, ids, NULL));
  OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_LOWER, ids, count));
  free(ids);
  int64_t *right = test_facets(&b, 0, 1, &count);
  const double pull[2] = {0.1, 0.0};
  OK(test_traction(b.elastic, count, right, pull));
  OK(mps_elastic_solve(b.elastic));
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
  OK(mps_elastic_get_facets(b.elastic, NULL, all, &arrays));
  for (int64_t k = 0; k < all; k++) {
    total += area[k];
    NEAR(u[3 * k], 0.05 * (centre[3 * k] - 0.25), 1e-14);
    NEAR(fabs(normal[3 * k]) + fabs(normal[3 * k + 1]), 1.0, 0.0);
    const int across = normal[3 * k] != 0.0; /* the axis along the edge */
    NEAR(3.0 * extent[3 * k + across], area[k], 1e-14);
    NEAR(fabs(extent[3 * k + 1 - across]) + fabs(extent[3 * k + 2]), 0.0, 0.0);
    NEAR(u[3 * k + 2] + v[3 * k] + v[3 * k + 1], 0.0, 0.0);
  }
  NEAR(total, 3.0 * 11.5, 1e-12); /* half cells at the wall */
  OK(mps_elastic_get_facets(b.elastic, right, count, &arrays));
  for (int64_t k = 0; k < count; k++) {
    NEAR(centre[3 * k], 4.0, 0.0);
    NEAR(test_value(&b, "position", particle[k], 0), 3.75, 0.0);
  }
  const int64_t none = 24;
  REFUSES(mps_elastic_get_facets(b.elastic, &none, 1, &arrays), "facets[0] is 24");
  free(right);
}
