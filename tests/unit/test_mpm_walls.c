/* test_mpm_walls.c - walls, moving nodes and loads of the WLS-MPM solver: arguments, memory; what
 * it says of bodies and steps that do not suit it. SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
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

static mps_mpm_boundary_def side_def(int32_t kind) {
  DEF(mpm_boundary, def, .kind = kind);
  return def;
}

TEST(refuses_bad_sides) {
  scoped_mpm_scene s = small_scene(context, NULL);
  mps_mpm *m = s.mpm;
  const int64_t ids[] = {1};
  mps_reaction r;
  MAKE(signal, signal, create_ramp, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.0, 1.0, 1.0);
  REFUSES(mps_mpm_set_side(m, MPS_SIDE_Z_LOWER, 0, 0.0), "number is 4");
  REFUSES(mps_mpm_set_side(m, -1, 0, 0.0), "number is -1");
  REFUSES(mps_mpm_set_side(m, MPS_SIDE_X_UPPER, 0, 0.0), "number is 1");
  REFUSES(mps_mpm_set_side(m, MPS_SIDE_Y_LOWER, 5, 0.0), "kind is MPS_BOUNDARY_FREE_FIELD");
  REFUSES(mps_mpm_set_side(m, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, -0.1), "friction is -0.1");
  REFUSES(mps_mpm_set_side(m, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.1),
          "must be 0 where kind is MPS_BOUNDARY_HELD");
  REFUSES(mps_mpm_set_boundary(m, 0, NULL), "def is NULL");
  mps_mpm_boundary_def def = side_def(MPS_BOUNDARY_ROLLER);
  def.signal[0] = signal, def.factor[0] = NAN;
  REFUSES(mps_mpm_set_boundary(m, 0, &def), "factor[0] is nan");
  def.factor[0] = 1.0;
  REFUSES(mps_mpm_set_boundary(m, MPS_SIDE_Y_LOWER, &def), "signal[0] is given");
  def = side_def(MPS_BOUNDARY_HELD);
  def.ids = ids, def.id_count = 1;
  REFUSES(mps_mpm_set_boundary(m, 0, &def), "and a side of the domain is whole");
  def = side_def(MPS_BOUNDARY_ABSORBING);
  def.settle = -1.0;
  REFUSES(mps_mpm_set_boundary(m, 0, &def), "settle is -1 s");
  REFUSES(mps_mpm_get_reaction(m, MPS_SIDE_Y_UPPER, &r), "number is 3");
  REFUSES(mps_solver_get_reaction_sized(mps_mpm_solver(m), MPS_SIDE_Y_LOWER, NULL, sizeof r),
          "out is NULL");
  assert_int_equal(mps_mpm_set_side(NULL, 0, 0, 0.0), MPS_ERROR_ARGUMENT);
  mps_mpm_destroy(&s.mpm);
  DEF(mpm, solver, .cell = 0.02, .lower[1] = 0.0);
  OK(mps_mpm_create(context, s.particles, s.material, &solver, &s.mpm));
  OK(mps_experimental_mpm_standard(s.mpm, 1.0));
  REFUSES(mps_mpm_set_side(s.mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_ABSORBING, 0.0),
          "the standard method does not allow");
  mps_mpm_destroy(&s.mpm);
  solver.geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC;
  OK(mps_mpm_create(context, s.particles, s.material, &solver, &s.mpm));
  REFUSES(mps_mpm_set_side(s.mpm, 0, MPS_BOUNDARY_ABSORBING, 0.0), "on the axis r = 0");
  REFUSES(mps_mpm_remove_boundary(s.mpm, 0), "cannot be free");
  def = side_def(MPS_BOUNDARY_HELD);
  def.signal[0] = signal;
  REFUSES(mps_mpm_set_boundary(s.mpm, 0, &def), "must be NULL where kind is MPS_BOUNDARY_HELD");
}

static mps_status add_box(mpm_scene *s, const double *lower, const double *upper, int32_t component,
                          int32_t *number) {
  const mps_mpm_boundary_def def = mpm_scene_box_def(s->mpm, lower, upper, component, NULL, 1.0);
  return mps_mpm_add_boundary(s->mpm, &def, number);
}

TEST(refuses_bad_boxes) {
  scoped_mpm_scene s = small_scene(context, NULL);
  const double lower[] = {0.0, 0.0}, upper[] = {0.1, INFINITY}, low[] = {0.001, 0.001};
  const double high[] = {0.019, 0.019};
  const int64_t unknown[] = {3, 100};
  mps_reaction r;
  int32_t box = -1;
  DEF(mpm_boundary, def, .kind = MPS_BOUNDARY_ROLLER);
  REFUSES(mps_mpm_add_boundary(s.mpm, &def, &box), "kind is MPS_BOUNDARY_ROLLER, ");
  REFUSES(add_box(&s, lower, upper, 2, &box), "dofs is 4");
  REFUSES(add_box(&s, low, high, 0, &box), "must hold a node");
  REFUSES(add_box(&s, upper, lower, 0, &box), "the box is empty");
  def = mps_mpm_boundary_defaults();
  def.ids = unknown, def.id_count = 2;
  REFUSES(mps_mpm_add_boundary(s.mpm, &def, &box), "ids[1] is 100");
  def.id_count = 0;
  REFUSES(mps_mpm_add_boundary(s.mpm, &def, &box), "id_count is 0 and ids is given");
  for (int32_t k = 6; k < 100; k++) {
    OK(add_box(&s, lower, upper, 0, &box));
    assert_int_equal(box, k);
  }
  OK(mps_mpm_remove_boundary(s.mpm, 11));
  REFUSES(mps_mpm_remove_boundary(s.mpm, 11), "number is 11");
  REFUSES(mps_mpm_get_reaction(s.mpm, 11, &r), "number is 11");
  REFUSES(mps_mpm_get_reaction(s.mpm, 100, &r), "number is 100");
  OK(add_box(&s, lower, upper, 1, &box));
  assert_int_equal(box, 11);
  OK(mps_mpm_step(s.mpm, 3));
}

static mps_status add_load(mpm_scene *s, int64_t count, const int64_t *ids, const double *area,
                           const double *traction, int32_t *number) {
  const mps_mpm_load_def def = mpm_scene_load_def(count, ids, area, traction, 2, NULL);
  return mps_mpm_add_load(s->mpm, &def, number);
}

TEST(refuses_bad_loads) {
  scoped_mpm_scene s = small_scene(context, NULL);
  const int64_t ids[] = {4, 100}, good[] = {4, 5};
  const double pull[] = {1.0, 2.0}, bad[] = {1.0, NAN}, area[] = {1.0, INFINITY};
  int32_t load = -1;
  REFUSES(add_load(&s, 0, good, NULL, pull, &load), "id_count is 0 and ids is given");
  REFUSES(add_load(&s, 2, NULL, NULL, pull, &load), "ids is NULL");
  REFUSES(add_load(&s, 2, ids, NULL, pull, &load), "ids[1] is 100");
  REFUSES(add_load(&s, 2, good, area, pull, &load), "area[1] is inf");
  REFUSES(mps_mpm_add_load(s.mpm, NULL, &load), "def is NULL");
  REFUSES(add_load(&s, 2, good, NULL, bad, &load), "traction[1] is nan");
  REFUSES(mps_mpm_remove_load(s.mpm, 0), "number is 0");
  OK(add_load(&s, 2, good, NULL, pull, &load));
  const mps_mpm_load_def def = mpm_scene_load_def(2, good, NULL, bad, 2, NULL);
  REFUSES(mps_mpm_set_load(s.mpm, load, &def), "traction[1] is nan");
  OK(mps_mpm_remove_load(s.mpm, load));
  REFUSES(mps_mpm_set_load(s.mpm, load, &def), "number is 0");
  OK(mps_mpm_step(s.mpm, 1));
  NEAR(mpm_scene_totals(&s).linear[0], 0.0, 0.0); /* nothing pulls any more */
}

/* Particles driven at a constant velocity go where it says, and what they drag pulls back: the
 * boundary's impulse is what the momentum gains, its work what the particles' motion costs. */
TEST(drives_particles) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02);
  const double t[] = {0.0, 1.0}, v[] = {0.2, 0.2};
  MAKE(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v);
  const int64_t ids[] = {0, 17, 99};
  DEF(mpm_boundary, def, .ids = ids, .id_count = 3, .dofs = MPS_DOF_X, .signal[0] = signal);
  REFUSES(mps_mpm_add_boundary(s.mpm, &def, NULL), "make its kind MPS_BOUNDARY_DRIVEN");
  def.kind = MPS_BOUNDARY_DRIVEN;
  int32_t number = -1;
  OK(mps_mpm_add_boundary(s.mpm, &def, &number));
  mps_view x = mpm_scene_view(&s, "position");
  const double from = *mps_view_f64(&x, mps_particles_index(s.particles, 17), 0);
  OK(mps_mpm_run(s.mpm, 0.3, 1000, NULL, NULL));
  x = mpm_scene_view(&s, "position");
  NEAR(*mps_view_f64(&x, mps_particles_index(s.particles, 17), 0), from + 0.06, 1e-12);
  mps_reaction r;
  OK(mps_mpm_get_reaction(s.mpm, number, &r));
  const mps_totals total = mpm_scene_totals(&s);
  assert_int_equal(r.count, 3);
  NEAR(total.linear[0], 0.2 * total.mass, 0.1 * 0.2 * total.mass); /* it comes along */
  NEAR(r.impulse[0], total.linear[0], 1e-12 * total.mass);
  NEAR(r.work, 0.2 * r.impulse[0], 1e-14 * total.mass);
}

/* A field of forces that comes to the set between steps acts from the next one on. */
TEST(reads_external_forces) {
  scoped_mpm_scene s = small_scene(context, NULL);
  OK(mps_mpm_remove_boundary(s.mpm, MPS_SIDE_X_LOWER)); /* a free edge */
  OK(mps_mpm_step(s.mpm, 2));
  OK(mps_particles_set(s.particles, "external_force", 0, 0.25));
  double t = mps_mpm_time(s.mpm);
  OK(mps_mpm_step(s.mpm, 10));
  t = mps_mpm_time(s.mpm) - t;
  NEAR(mpm_scene_totals(&s).linear[0], 25.0 * t, 1e-12 * t);
  OK(mps_particles_set(s.particles, "external_force", 0, 0.0));
  OK(mps_mpm_step(s.mpm, 10));
  NEAR(mpm_scene_totals(&s).linear[0], 25.0 * t, 1e-12 * t);
}

/* ---- warnings of the log --------------------------------------------------------------------- */

typedef struct heard {
  int warnings;
  char last[512];
} heard;

static void listen(void *user, int32_t level, const char *message) {
  heard *h = user;
  if (level != MPS_CONTEXT_LOG_WARNING) return;
  h->warnings++;
  snprintf(h->last, sizeof h->last, "%s", message);
}

static mps_context *listening(heard *h) {
  mps_context_def def = test_context_defaults();
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
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

/* The shear of curved surfaces is short where the second row of particles is beyond a cell. */
TEST(tells_of_large_particles) {
  for (int k = 0; k < 4; k++) {
    heard h = {0};
    scoped_context *own = listening(&h);
    scoped_mpm_scene s = mpm_scene_begin(own, k % 2 ? 0.02 : 0.01, 0.0, 0.0, 1e6);
    mps_contact_def contact = mps_contact_defaults();
    scoped_body *body = NULL;
    mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02);
    USING(body, mps_body_create_disc(own, &given, 0.1, &body), .position[0] = 0.3);
    if (k > 1) contact.strength = 1e3;
    OK(mps_mpm_add_contact(s.mpm, body, &contact, NULL));
    if (k == 3)
      expect_warning(&h, 1, "spacing of 0.02 m is more than half a cell, 0.01 m");
    else
      assert_int_equal(h.warnings, 0);
  }
}

TEST(tells_of_bodies) {
  heard h = {0};
  scoped_context *own = listening(&h);
  scoped_mpm_scene s = small_scene(own, NULL);
  mps_body *bodies[4] = {NULL};
  DEF(body, def, .position[0] = 0.3);
  OK(mps_body_create_box(own, &def, 0.04, 0.3, &bodies[0]));
  def.position[0] = 0.325;
  OK(mps_body_create_box(own, &def, 0.03, 0.3, &bodies[1]));
  def.position[0] = 0.335;
  OK(mps_body_create_box(own, &def, 0.03, 0.3, &bodies[2]));
  mpm_scene_contact(&s, bodies[0], 0.0);
  assert_int_equal(h.warnings, 0); /* two cells are enough */
  mps_contact *over = NULL; /* before the first step only that looks at the places of bodies */
  OK(mps_mpm_add_contact(s.mpm, bodies[1], NULL, &over));
  FAILS_ON(own, mps_mpm_step(s.mpm, 1), MPS_ERROR_ARGUMENT,
           "overlaps body 0 of the solver by more than 0.002 m");
  mps_contact_destroy(&over);
  DEF(contact, contact, .method = MPS_CONTACT_METHOD_PENALTY);
  FAILS_ON(own, mps_mpm_add_contact(s.mpm, bodies[2], &contact, NULL), MPS_ERROR_ARGUMENT,
           "0.03 m thin, 1.5 cells");
  contact.thin = 1;
  OK(mps_mpm_add_contact(s.mpm, bodies[2], &contact, NULL)); /* they are in contact */
  expect_warning(&h, 1, "0.03 m thin, 1.5 cells");
  OK(mps_mpm_step(s.mpm, 2));
  assert_int_equal(h.warnings, 1);
  def.position[0] = -0.3;
  contact.penalty = 1e8;
  OK(mps_body_create_box(own, &def, 0.1, 0.1, &bodies[3]));
  OK(mps_mpm_add_contact(s.mpm, bodies[3], &contact, NULL));
  OK(mps_mpm_step(s.mpm, 2));
  expect_warning(&h, 2, "contact with body 2 will chatter: k dt^2/m = ");
  for (int b = 0; b < 4; b++) mps_body_destroy(&bodies[b]);
}

/* Two boxes, or a ball and a half plane, beside a block of particles: from a step at most 64 after
 * that in which they overlap by a tenth of a cell, and once; not those that pass beside each
 * other. */
TEST(tells_of_bodies_that_meet) {
  for (int k = 0; k < 9; k++) {
    heard h = {0};
    scoped_context *own = listening(&h);
    scoped_mpm_scene s = mpm_scene_begin(own, 0.01, 0.0, 0.0, pow(30.0, k % 3) * 1e5);
    scoped_body *a = NULL, *b = NULL;
    mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02);
    DEF(body, at, .position[0] = 0.5, .position[1] = (k < 6 ? 0.03 : -0.03) * (k % 3));
    const double normal[3] = {0.0, 1.0, 0.0};
    if (k < 6)
      OK(mps_body_create_box(own, &at, 0.1, 0.06, &a));
    else
      OK(mps_body_create_half_plane(own, &at, normal, &a));
    at.position[1] += k < 6 ? 0.1 : 0.05;
    at.position[0] += k >= 3 && k < 6 ? 0.11 : 0.0; /* beside it */
    if (k < 6)
      OK(mps_body_create_box(own, &at, 0.1, 0.06, &b));
    else
      OK(mps_body_create_disc(own, &at, 0.03, &b));
    WITH_DEFAULTS(mps_body_motion, down, .velocity[1] = -1.0);
    OK(mps_body_set_motion(b, &down));
    mpm_scene_contact(&s, a, 0.0);
    mpm_scene_contact(&s, b, 0.0);
    const double overlap_at =
        k >= 3 && k < 6 ? INFINITY : 0.022 + (k < 6 ? 0.02 : 0.0); /* s, at 1 m/s */
    while (mps_mpm_time(s.mpm) < 0.08) {
      const double before = mps_mpm_time(s.mpm);
      OK(mps_mpm_step(s.mpm, 1));
      if (before < overlap_at) assert_int_equal(h.warnings, 0);
      if (before > overlap_at + 64.0 * mps_mpm_dt(s.mpm))
        expect_warning(&h, 1, "bodies 0 and 1 overlap by more than 0.002 m (0.1 cells)");
    }
  }
}

/* A free box beside a block of particles that goes through each side of the domain, but not one
 * that is driven, nor one that stays before it. */
TEST(tells_of_bodies_that_leave) {
  for (int k = 0; k < 12; k++) {
    heard h = {0};
    scoped_context *own = listening(&h);
    const double cell = 0.02 / (1 + k % 3), way = k % 2 ? 1.0 : -1.0;
    const int c = k / 2 % 2;
    const bool driven = k >= 8, far = k < 4 || driven;
    scoped_mpm_scene s = mpm_scene_begin(own, 0.5 * cell, 0.0, 0.0, 1e6);
    mpm_scene_box(&s, 0.0, 0.0, 5 * cell, 5 * cell);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = cell, .lower[0] = -20 * cell,
          .lower[1] = -20 * cell, .upper[0] = 20 * cell, .upper[1] = 20 * cell);
    DEF(body, at, .motion = driven ? MPS_BODY_MOTION_DRIVEN : MPS_BODY_MOTION_FREE,
        .position[0] = -10 * cell, .position[1] = -10 * cell);
    if (!driven) at.mass = 1.0, at.inertia[2] = 1.0;
    at.position[c] = way * 15 * cell;
    MAKE(body, box, create_box, own, &at, 4 * cell, 4 * cell);
    WITH_DEFAULTS(mps_body_motion, off, .velocity[c] = way * 50 * cell);
    OK(mps_body_set_motion(box, &off));
    mpm_scene_contact(&s, box, 0.0);
    OK(mps_mpm_run(s.mpm, far ? 0.2 : 0.09, 1, NULL, NULL)); /* by 10 or 4.5 cells */
    assert_int_equal(h.warnings, far && !driven ? 1 : 0);
    if (far && !driven) expect_warning(&h, 1, "free body 0 goes through the side");
    if (far && !driven) expect_warning(&h, 1, c ? "side y = " : "side x = ");
  }
}

TEST(tells_of_steps) {
  heard h = {0};
  scoped_context *own = listening(&h);
  scoped_mpm_scene s = small_scene(own, NULL);
  const double limit = mps_mpm_limit(s.mpm);
  mps_mpm_destroy(&s.mpm);
  DEF(mpm, def, .cell = 0.02, .dt = 1.01 * limit);
  FAILS_ON(own, mps_mpm_create(own, s.particles, s.material, &def, &s.mpm), MPS_ERROR_ARGUMENT,
           "above the Courant limit");
  def.dt = 0.45 * limit;
  OK(mps_mpm_create(own, s.particles, s.material, &def, &s.mpm));
  OK(mps_mpm_step(s.mpm, 3));
  assert_int_equal(h.warnings, 0);
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < v.view.shape[0]; k++) *mps_edit_f64(&v, k, 0) = 3.0; /* c = 11.6 m/s */
  OK(mps_mpm_step(s.mpm, 3));
  expect_warning(&h, 1, "above the fraction courant = 0.5");
}

/* A NaN in a particle is found in the step that sees it, and all is left for a look. */
TEST(tells_of_nan) {
  scoped_mpm_scene s = small_scene(context, NULL);
  OK(mps_mpm_step(s.mpm, 2));
  mps_view id = mpm_scene_view(&s, "id");
  mps_view v = mpm_scene_view(&s, "velocity"), x = mpm_scene_view(&s, "position");
  double far = -1.0;
  mpsi_particles_column(s.particles, "velocity", 1)[17] = NAN;
  const double at = *mps_view_f64(&x, 17, 0);
  FAILS(mps_mpm_step(s.mpm, 5), MPS_ERROR_DIVERGED, "is not finite");
  assert_int_equal(mps_context_error(context)->step, 3);
  const int64_t who = mps_particles_index(s.particles, mps_context_error(context)->particle);
  assert_true(who >= 0 && fabs(*mps_view_f64(&x, 17, 0) - at) < 1e30);
  for (int64_t k = 0; k < v.shape[0]; k++) /* beyond its reach nothing has happened */
    if (!isnan(*mps_view_f64(&v, k, 1))) far = fmax(far, fabs(*mps_view_f64(&x, k, 0) - at));
  assert_true(far > 0.04);
  assert_int_equal(id.shape[0], 100);
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "left no state to go on from");
}

/* ---- memory ---------------------------------------------------------------------------------- */

static mps_status make(mps_context *c, int what) {
  DEF(particles, set, .spacing = 0.01);
  scoped_particles *particles = NULL;
  scoped_material *material = NULL;
  scoped_mpm *mpm = NULL;
  scoped_signal *signal = NULL, *factor = NULL;
  const double lo[] = {0.0, 0.0}, hi[] = {0.1, 0.1}, area[] = {1e-2, 1e-2};
  const int64_t ids[] = {3, 4};
  int32_t number;
  DEF(mpm, def, .cell = 0.02, .lower[1] = 0.0);
  mps_status status = mps_particles_create(c, &set, &particles);
  if (status == MPS_OK) status = mps_particles_fill_box(particles, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(particles, "density", 0, 1000.0);
  if (status == MPS_OK) status = mps_material_create_linear_elastic(c, 1e5, 0.3, &material);
  if (status == MPS_OK) status = mps_mpm_create(c, particles, material, &def, &mpm);
  if (status == MPS_OK)
    status = mps_signal_create_ramp(c, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.0, 1.0, 1.0, &signal);
  if (status == MPS_OK)
    status = mps_signal_create_ramp(c, MPS_SIGNAL_QUANTITY_VALUE, 0.0, 1.0, 1.0, &factor);
  mps_mpm_boundary_def base = side_def(MPS_BOUNDARY_ABSORBING), box, list = base;
  base.signal[0] = signal;
  list.kind = MPS_BOUNDARY_DRIVEN;
  list.ids = ids, list.id_count = 2;
  const mps_mpm_load_def load = mpm_scene_load_def(2, ids, area, lo, 2, factor);
  if (status == MPS_OK) box = mpm_scene_box_def(mpm, lo, hi, 0, signal, 1.0);
  if (status == MPS_OK) status = mps_mpm_add_boundary(mpm, &box, &number);
  if (status == MPS_OK) status = mps_mpm_add_boundary(mpm, &list, &number);
  if (status == MPS_OK) status = mps_mpm_set_boundary(mpm, MPS_SIDE_Y_LOWER, &base);
  if (status == MPS_OK) status = mps_mpm_add_load(mpm, &load, &number);
  if (status == MPS_OK) status = mps_mpm_step(mpm, 3);
  return status;
}

TEST(survives_lack_of_memory) { test_allocator_sweep(make, 0); }

/* Steps with walls, moving nodes and loads allocate nothing, also where they sort. */
TEST(steady_steps_allocate_nothing) {
  test_allocator allocator = {0};
  mps_context *own = test_allocator_context(&allocator);
  int32_t box = -1, loads[2];
  mpm_scene s = held_begin(own, MPS_MPM_GEOMETRY_PLANE_STRAIN, &box, loads);
  int64_t calls = 0;
  for (int round = 0; round < 5; round++) {
    OK(mps_mpm_set_side(s.mpm, MPS_SIDE_X_UPPER, MPS_BOUNDARY_ABSORBING, 0.0));
    calls = allocator.calls;
    OK(mps_mpm_step(s.mpm, 5));
    if (round >= 2) assert_int_equal(allocator.calls, calls);
  }
  mpm_scene_end(&s);
  mps_context_destroy(&own);
  assert_int_equal(allocator.live, 0);
}
