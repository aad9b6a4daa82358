/* test_mpm_walls.c - walls, moving nodes and loads of the WLS-MPM solver: arguments, memory; what
 * it says of bodies and steps that do not suit it. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_held.h"
#include "test_allocator.h"
#include "test_fixture.h"

static mpm_scene small_scene(mps_context *c, const mps_mpm_def *changed) {
  mpm_scene s = mpm_scene_begin(c, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  mps_mpm_def def = changed ? *changed : mps_mpm_defaults();
  def.cell = 0.02;
  def.lower[0] = def.lower[1] = 0.0;
  mpm_scene_solve(&s, &def);
  return s;
}

#define REFUSES(text, call) mps_assert_fails(context, call, MPS_ERROR_ARGUMENT, text)

static void refuses_bad_walls(void **state) {
  (void)state;
  mpm_scene s = small_scene(context, NULL);
  mps_mpm *m = s.mpm, *other = NULL;
  double force[3];
  mps_signal *signal = NULL;
  mps_assert_ok(context, mps_signal_ramp(context, 0.0, 1.0, 1.0, &signal));
  REFUSES("axis is 2", mps_mpm_set_wall(m, 2, 0, 0, 0.0));
  REFUSES("upper 2", mps_mpm_set_wall(m, 0, 2, 0, 0.0));
  REFUSES("no upper wall across x", mps_mpm_set_wall(m, 0, 1, 0, 0.0));
  REFUSES("wall_lower[1] is 4", mps_mpm_set_wall(m, 1, 0, 4, 0.0));
  REFUSES("wall_friction_lower[1] is -0.1", mps_mpm_set_wall(m, 1, 0, 2, -0.1));
  REFUSES("of kind 1", mps_mpm_set_wall(m, 1, 0, MPS_WALL_FIXED, 0.1));
  REFUSES("component is 2", mps_mpm_drive_wall(m, 0, 0, 2, signal, 1.0));
  REFUSES("factor is nan", mps_mpm_drive_wall(m, 0, 0, 0, signal, NAN));
  REFUSES("only 0 is held", mps_mpm_drive_wall(m, 0, 0, 1, signal, 1.0));
  REFUSES("no upper wall", mps_mpm_get_wall_force(m, 1, 1, force));
  REFUSES("force is NULL", mps_mpm_get_wall_force(m, 1, 0, NULL));
  assert_int_equal(mps_mpm_set_wall(NULL, 0, 0, 0, 0.0), MPS_ERROR_ARGUMENT);
  mps_mpm_destroy(&s.mpm);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.02;
  def.settle = -1.0;
  REFUSES("settle is -1 s", mps_mpm_create(context, s.particles, s.material, &def, &other));
  def.settle = 0.0;
  def.wall_friction_upper[1] = 0.3;
  REFUSES("wall_friction_upper[1] is 0.3",
          mps_mpm_create(context, s.particles, s.material, &def, &other));
  def.wall_friction_upper[1] = 0.0;
  def.wall_lower[0] = MPS_WALL_ABSORBING;
  def.scheme = MPS_SCHEME_STANDARD;
  REFUSES("allowed with 0 (WLS)", mps_mpm_create(context, s.particles, s.material, &def, &other));
  def.scheme = MPS_SCHEME_WLS;
  def.geometry = MPS_AXISYMMETRIC;
  REFUSES("on the axis r = 0", mps_mpm_create(context, s.particles, s.material, &def, &other));
  def.wall_lower[0] = MPS_WALL_ROLLER;
  mps_assert_ok(context, mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  REFUSES("on the axis r = 0", mps_mpm_drive_wall(s.mpm, 0, 0, 0, signal, 1.0));
  mps_signal_destroy(&signal);
  mpm_scene_end(&s);
}

static void refuses_bad_boxes(void **state) {
  (void)state;
  mpm_scene s = small_scene(context, NULL);
  const double lower[] = {0.0, 0.0}, upper[] = {0.1, INFINITY}, low[] = {0.001, 0.001};
  const double high[] = {0.019, 0.019};
  double force[3];
  int32_t box = -1;
  REFUSES("lower is NULL", mps_mpm_drive_nodes(s.mpm, NULL, upper, 0, NULL, 1.0, &box));
  REFUSES("box is NULL", mps_mpm_drive_nodes(s.mpm, lower, upper, 0, NULL, 1.0, NULL));
  REFUSES("component is -1", mps_mpm_drive_nodes(s.mpm, lower, upper, -1, NULL, 1.0, &box));
  REFUSES("must hold a node", mps_mpm_drive_nodes(s.mpm, low, high, 0, NULL, 1.0, &box));
  REFUSES("must hold a node", mps_mpm_drive_nodes(s.mpm, upper, lower, 0, NULL, 1.0, &box));
  for (int32_t k = 0; k < MPS_MPM_MAX_BOXES; k++) {
    mps_assert_ok(context, mps_mpm_drive_nodes(s.mpm, lower, upper, 0, NULL, 1.0, &box));
    assert_int_equal(box, k);
  }
  REFUSES("has 32 boxes", mps_mpm_drive_nodes(s.mpm, lower, upper, 0, NULL, 1.0, &box));
  mps_assert_ok(context, mps_mpm_free_nodes(s.mpm, 5));
  REFUSES("box is 5", mps_mpm_free_nodes(s.mpm, 5));
  REFUSES("box is 5", mps_mpm_get_nodes_force(s.mpm, 5, force));
  REFUSES("box is 32", mps_mpm_get_nodes_force(s.mpm, 32, force));
  mps_assert_ok(context, mps_mpm_drive_nodes(s.mpm, lower, upper, 1, NULL, 1.0, &box));
  assert_int_equal(box, 5);
  mps_assert_ok(context, mps_mpm_step(s.mpm, 3));
  mpm_scene_end(&s);
}

static void refuses_bad_loads(void **state) {
  (void)state;
  mpm_scene s = small_scene(context, NULL);
  const int64_t ids[] = {4, 100}, good[] = {4, 5};
  const double pull[] = {1.0, 2.0}, bad[] = {1.0, NAN}, area[] = {1.0, INFINITY};
  int32_t load = -1;
  REFUSES("count is 0", mps_mpm_add_load(s.mpm, 0, good, NULL, pull, NULL, &load));
  REFUSES("ids NULL", mps_mpm_add_load(s.mpm, 2, NULL, NULL, pull, NULL, &load));
  REFUSES("ids[1] is 100", mps_mpm_add_load(s.mpm, 2, ids, NULL, pull, NULL, &load));
  REFUSES("area[1] is inf", mps_mpm_add_load(s.mpm, 2, good, area, pull, NULL, &load));
  REFUSES("traction is NULL", mps_mpm_add_load(s.mpm, 2, good, NULL, NULL, NULL, &load));
  REFUSES("traction[1] is nan", mps_mpm_add_load(s.mpm, 2, good, NULL, bad, NULL, &load));
  REFUSES("load is NULL", mps_mpm_add_load(s.mpm, 2, good, NULL, pull, NULL, NULL));
  REFUSES("load is 0", mps_mpm_remove_load(s.mpm, 0));
  mps_assert_ok(context, mps_mpm_add_load(s.mpm, 2, good, NULL, pull, NULL, &load));
  REFUSES("traction[1] is nan", mps_mpm_set_load(s.mpm, load, bad, NULL));
  mps_assert_ok(context, mps_mpm_remove_load(s.mpm, load));
  REFUSES("load is 0", mps_mpm_set_load(s.mpm, load, pull, NULL));
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  mps_assert_near(mpm_scene_totals(&s).linear[0], 0.0, 0.0); /* nothing pulls any more */
  mpm_scene_end(&s);
}

/* ---- what the log is told -------------------------------------------------------------------- */

typedef struct heard {
  int warnings;
  char last[512];
} heard;

static void listen(void *user, mps_log_level level, const char *message) {
  heard *h = user;
  if (level != MPS_LOG_WARNING) return;
  h->warnings++;
  snprintf(h->last, sizeof h->last, "%s", message);
}

static mps_context *listening(heard *h) {
  mps_context_def def = test_context_defaults();
  def.executor = MPS_EXECUTOR_SERIAL;
  def.log = listen;
  def.log_user = h;
  mps_context *own = NULL;
  assert_int_equal(mps_context_create(&def, &own, NULL, 0), MPS_OK);
  return own;
}

static void expect_warning(heard *h, int count, const char *text) {
  assert_int_equal(h->warnings, count);
  if (!strstr(h->last, text)) fail_msg("\"%s\" does not contain \"%s\"", h->last, text);
}

static void tells_of_bodies(void **state) {
  (void)state;
  heard h = {0};
  mps_context *own = listening(&h);
  mpm_scene s = small_scene(own, NULL);
  mps_body *bodies[4] = {NULL};
  mps_body_def def = mps_body_defaults();
  def.position[0] = 0.3;
  mps_assert_ok(own, mps_body_create_box(own, &def, 0.04, 0.3, &bodies[0]));
  def.position[0] = 0.325;
  mps_assert_ok(own, mps_body_create_box(own, &def, 0.03, 0.3, &bodies[1]));
  def.position[0] = 0.335;
  mps_assert_ok(own, mps_body_create_box(own, &def, 0.03, 0.3, &bodies[2]));
  mps_assert_ok(own, mps_mpm_add_body(s.mpm, bodies[0]));
  assert_int_equal(h.warnings, 0); /* two cells are enough */
  mps_assert_fails(own, mps_mpm_add_body(s.mpm, bodies[1]), MPS_ERROR_ARGUMENT,
                   "overlaps body 0 of the solver by more than 0.002 m");
  mps_assert_ok(own, mps_mpm_add_body(s.mpm, bodies[2])); /* they touch */
  expect_warning(&h, 1, "0.03 m thin, 1.5 cells");
  mps_assert_ok(own, mps_mpm_step(s.mpm, 2));
  assert_int_equal(h.warnings, 1);
  def.position[0] = -0.3;
  def.penalty = 1e8;
  mps_assert_ok(own, mps_body_create_box(own, &def, 0.1, 0.1, &bodies[3]));
  mps_assert_ok(own, mps_mpm_add_body(s.mpm, bodies[3]));
  mps_assert_ok(own, mps_mpm_step(s.mpm, 2));
  expect_warning(&h, 2, "contact with body 2 will chatter: k dt^2/m = ");
  for (int b = 0; b < 4; b++) mps_body_destroy(&bodies[b]);
  mpm_scene_end(&s);
  mps_context_destroy(&own);
}

static void tells_of_steps(void **state) {
  (void)state;
  heard h = {0};
  mps_context *own = listening(&h);
  mpm_scene s = small_scene(own, NULL);
  const double limit = mps_mpm_limit(s.mpm);
  mps_mpm_destroy(&s.mpm);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.02;
  def.dt = 1.01 * limit;
  mps_assert_fails(own, mps_mpm_create(own, s.particles, s.material, &def, &s.mpm),
                   MPS_ERROR_ARGUMENT, "above the Courant limit");
  def.dt = 0.45 * limit;
  mps_assert_ok(own, mps_mpm_create(own, s.particles, s.material, &def, &s.mpm));
  mps_assert_ok(own, mps_mpm_step(s.mpm, 3));
  assert_int_equal(h.warnings, 0);
  mps_view v = mpm_scene_view(&s, "velocity");
  for (int64_t k = 0; k < v.shape[0]; k++) *mps_view_f64(&v, k, 0) = 3.0; /* c = 11.6 m/s */
  mps_assert_ok(own, mps_mpm_step(s.mpm, 3));
  expect_warning(&h, 1, "above the fraction courant = 0.5");
  mpm_scene_end(&s);
  mps_context_destroy(&own);
}

/* A NaN in a particle is found in the step that sees it, and all is left for a look. */
static void tells_of_nan(void **state) {
  (void)state;
  mpm_scene s = small_scene(context, NULL);
  mps_assert_ok(context, mps_mpm_step(s.mpm, 2));
  mps_view v = mpm_scene_view(&s, "velocity"), id = mpm_scene_view(&s, "id");
  mps_view x = mpm_scene_view(&s, "position");
  double far = -1.0;
  *mps_view_f64(&v, 17, 1) = NAN;
  const double at = *mps_view_f64(&x, 17, 0);
  mps_assert_fails(context, mps_mpm_step(s.mpm, 5), MPS_ERROR_DIVERGED, "is not finite");
  assert_int_equal(mps_context_error(context)->step, 3);
  const int64_t who = mps_particles_index(s.particles, mps_context_error(context)->particle);
  assert_true(who >= 0 && fabs(*mps_view_f64(&x, 17, 0) - at) < 1e30);
  for (int64_t k = 0; k < v.shape[0]; k++) /* beyond its reach nothing has happened */
    if (!isnan(*mps_view_f64(&v, k, 1))) far = fmax(far, fabs(*mps_view_f64(&x, k, 0) - at));
  assert_true(far > 0.04);
  assert_int_equal(id.shape[0], 100);
  mps_assert_fails(context, mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "state is kept");
  mpm_scene_end(&s);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static mps_status make(mps_context *c, int what) {
  (void)what;
  mps_particles_def set = mps_particles_defaults();
  set.spacing = 0.01;
  mps_particles *particles = NULL;
  mps_material *material = NULL;
  mps_mpm *mpm = NULL;
  mps_signal *signal = NULL;
  const double lo[] = {0.0, 0.0}, hi[] = {0.1, 0.1}, area[] = {1e-2, 1e-2};
  const int64_t ids[] = {3, 4};
  int32_t number;
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.02;
  def.lower[1] = 0.0;
  def.wall_lower[1] = MPS_WALL_ABSORBING;
  mps_status status = mps_particles_create(c, &set, &particles);
  if (status == MPS_OK) status = mps_particles_fill_box(particles, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(particles, "density", 0, 1000.0);
  if (status == MPS_OK) status = mps_material_linear_elastic(c, 1e5, 0.3, &material);
  if (status == MPS_OK) status = mps_mpm_create(c, particles, material, &def, &mpm);
  if (status == MPS_OK) status = mps_signal_ramp(c, 0.0, 1.0, 1.0, &signal);
  if (status == MPS_OK) status = mps_mpm_drive_nodes(mpm, lo, hi, 0, signal, 1.0, &number);
  if (status == MPS_OK) status = mps_mpm_drive_wall(mpm, 1, 0, 0, signal, 1.0);
  if (status == MPS_OK) status = mps_mpm_add_load(mpm, 2, ids, area, lo, signal, &number);
  if (status == MPS_OK) status = mps_mpm_step(mpm, 3);
  mps_signal_destroy(&signal);
  mps_mpm_destroy(&mpm);
  mps_particles_destroy(&particles);
  mps_material_destroy(&material);
  return status;
}

static void survives_lack_of_memory(void **state) {
  (void)state;
  test_allocator_sweep(make, 0);
}

/* Steps with walls, moving nodes and loads allocate nothing, also where they sort. */
static void steady_steps_allocate_nothing(void **state) {
  (void)state;
  test_allocator allocator = {0};
  mps_context *own = test_allocator_context(&allocator);
  int32_t box = -1, loads[2];
  mpm_scene s = held_begin(own, MPS_PLANE_STRAIN, &box, loads);
  int64_t calls = 0;
  for (int round = 0; round < 5; round++) {
    if (round == 2) calls = allocator.calls;
    mps_assert_ok(own, mps_mpm_set_wall(s.mpm, 0, 1, MPS_WALL_ABSORBING, 0.0));
    mps_assert_ok(own, mps_mpm_step(s.mpm, 5));
  }
  assert_int_equal(allocator.calls, calls);
  mpm_scene_end(&s);
  mps_context_destroy(&own);
  assert_int_equal(allocator.live, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(refuses_bad_walls),       cmocka_unit_test(refuses_bad_boxes),
      cmocka_unit_test(refuses_bad_loads),       cmocka_unit_test(tells_of_bodies),
      cmocka_unit_test(tells_of_steps),          cmocka_unit_test(tells_of_nan),
      cmocka_unit_test(survives_lack_of_memory), cmocka_unit_test(steady_steps_allocate_nothing)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
