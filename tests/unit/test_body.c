/* test_body.c - rigid bodies: arguments, motion by signals and by forces, parts, ownership.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/body_internal.h"
#include "test_allocator.h"
#include "test_fixture.h"

static const double square[] = {0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0};

static void refuses_bad_definitions(void **state) {
  (void)state;
  mps_body *body = (mps_body *)1;
  mps_body_def def = mps_body_defaults();
  const double nowhere[] = {0.0, NAN}, zero[] = {0.0, 0.0};
  const double bow[] = {0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0};
  assert_int_equal(mps_body_create_disc(NULL, &def, 1.0, &body), MPS_ERROR_ARGUMENT);
  mps_assert_fails(context, mps_body_create_disc(context, &def, 0.0, &body), MPS_ERROR_ARGUMENT,
                   "radius is 0 m");
  assert_null(body);
  mps_assert_fails(context, mps_body_create_disc(context, &def, 1.0, NULL), MPS_ERROR_ARGUMENT,
                   "out is NULL");
  mps_assert_fails(context, mps_body_create_box(context, &def, 1.0, -2.0, &body),
                   MPS_ERROR_ARGUMENT, "height is -2 m");
  mps_assert_fails(context, mps_body_create_half_plane(context, &def, zero, &body),
                   MPS_ERROR_ARGUMENT, "normal is (0, 0)");
  mps_assert_fails(context, mps_body_create_half_plane(context, &def, NULL, &body),
                   MPS_ERROR_ARGUMENT, "normal is NULL");
  mps_assert_fails(context, mps_body_create_half_plane(context, &def, nowhere, &body),
                   MPS_ERROR_ARGUMENT, "must be finite");
  mps_assert_fails(context, mps_body_create_polygon(context, &def, 4, NULL, &body),
                   MPS_ERROR_ARGUMENT, "xy is NULL");
  mps_assert_fails(context, mps_body_create_polygon(context, &def, 2, square, &body),
                   MPS_ERROR_ARGUMENT, "vertices is 2");
  mps_assert_fails(context, mps_body_create_polygon(context, &def, 4, bow, &body),
                   MPS_ERROR_ARGUMENT, "intersect");
  def = mps_body_defaults();
  def.mass = 1.0;
  mps_assert_fails(context, mps_body_create_box(context, &def, 1.0, 1.0, &body), MPS_ERROR_ARGUMENT,
                   "for free bodies");
  def.motion = MPS_BODY_MOTION_FREE;
  mps_assert_fails(context, mps_body_create_box(context, &def, 1.0, 1.0, &body), MPS_ERROR_ARGUMENT,
                   "inertia[2] is nan kg m2");
  def.motion = 7;
  mps_assert_fails(context, mps_body_create_box(context, &def, 1.0, 1.0, &body), MPS_ERROR_ARGUMENT,
                   "motion is 7");
  assert_null(body);
}

static void refuses_what_a_plane_has_not(void **state) {
  (void)state;
  mps_body *body = NULL;
  mps_body_def def = mps_body_defaults();
  def.position[2] = 0.5;
  mps_assert_fails(context, mps_body_create_disc(context, &def, 1.0, &body), MPS_ERROR_ARGUMENT,
                   "position[2] is 0.5 m, must be 0 for a 2D shape");
  def = mps_body_defaults();
  def.rotation[0] = 0.1;
  mps_assert_fails(context, mps_body_create_box(context, &def, 1.0, 1.0, &body), MPS_ERROR_ARGUMENT,
                   "rotation[0] is 0.1 rad");
  def = mps_body_defaults();
  def.motion = MPS_BODY_MOTION_FREE;
  def.mass = def.inertia[2] = 1.0;
  mps_assert_fails(context, mps_body_create_sphere(context, &def, 1.0, &body), MPS_ERROR_ARGUMENT,
                   "inertia[0] is nan kg m2");
  mps_assert_ok(context, mps_body_create_disc(context, &def, 1.0, &body));
  const double out[] = {0.0, 0.0, 1.0}, bad[] = {0.0, NAN, 0.0};
  mps_assert_fails(context, mps_body_set_load(body, out, NULL), MPS_ERROR_ARGUMENT,
                   "must be 0 in 2D");
  mps_assert_fails(context, mps_body_set_load(body, NULL, bad), MPS_ERROR_ARGUMENT,
                   "moment[1] nan N m");
  mps_assert_ok(context, mps_body_set_load(body, NULL, out));
  mps_body_destroy(&body);
}

static void refuses_bad_solids(void **state) {
  (void)state;
  mps_body *body = NULL;
  const double zero[3] = {0.0, 0.0, 0.0};
  const double crossing[] = {-0.1, 0.0, 1.0, 0.0, 1.0, 1.0};
  const double pinched[] = {0.0, 0.0, 1.0, -1.0, 1.0, 1.0};
  const double twice[] = {0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0, 1.0};
  mps_assert_fails(context, mps_body_create_half_space(context, NULL, zero, &body),
                   MPS_ERROR_ARGUMENT, "normal is (0, 0, 0)");
  mps_assert_fails(context, mps_body_create_cylinder(context, NULL, 1.0, NAN, &body),
                   MPS_ERROR_ARGUMENT, "length is nan m");
  mps_assert_fails(context, mps_body_create_revolution(context, NULL, 3, NULL, &body),
                   MPS_ERROR_ARGUMENT, "rz is NULL");
  mps_assert_fails(context, mps_body_create_revolution(context, NULL, 3, crossing, &body),
                   MPS_ERROR_ARGUMENT, "corner 0 has r = -0.1 m");
  mps_assert_fails(context, mps_body_create_revolution(context, NULL, 3, pinched, &body),
                   MPS_ERROR_ARGUMENT, "corner 0 is on the axis with neither of its edges");
  mps_assert_fails(context, mps_body_create_revolution(context, NULL, 4, twice, &body),
                   MPS_ERROR_ARGUMENT, "vertices: corners 1 and 2");
  assert_null(body);
}

static void refuses_bad_calls(void **state) {
  (void)state;
  mps_body *body = NULL;
  mps_assert_ok(context, mps_body_create_polygon(context, NULL, 4, square, &body));
  mps_body_state s;
  mps_reaction r;
  const double force[] = {1.0, 2.0, 0.0}, bad[] = {0.0, INFINITY};
  double d;
  mps_assert_fails(context, mps_body_advance(body, 0.0), MPS_ERROR_ARGUMENT, "dt is 0 s");
  mps_body_motion away = mps_body_motion_defaults();
  away.velocity[0] = 1.0;
  mps_assert_ok(context, mps_body_set_motion(body, &away));
  mps_assert_fails(context, mps_body_advance(body, 1e300), MPS_ERROR_DIVERGED,
                   "stays where it was");
  mps_assert_ok(context, mps_body_get_state(body, &s));
  mps_assert_near(s.time, 0.0, 0.0);
  mps_assert_near(s.position[0], 0.0, 0.0);
  mps_assert_ok(context, mps_body_set_motion(body, NULL));
  mps_assert_fails(context, mps_body_drive(body, 2, NULL, 1.0), MPS_ERROR_ARGUMENT,
                   "component is 2");
  mps_assert_fails(context, mps_body_drive(body, 0, NULL, NAN), MPS_ERROR_ARGUMENT,
                   "factor is nan");
  mps_assert_fails(context, mps_body_set_load(body, force, NULL), MPS_ERROR_STATE, "takes no load");
  mps_assert_fails(context, mps_body_distance(body, 1, bad, &d, NULL, NULL, NULL),
                   MPS_ERROR_ARGUMENT, "point 0 has y = inf");
  mps_assert_fails(context, mps_body_distance(body, -1, bad, &d, NULL, NULL, NULL),
                   MPS_ERROR_ARGUMENT, "count is -1");
  mps_assert_fails(context, mps_body_get_reaction(body, 1, &r), MPS_ERROR_ARGUMENT, "part is 1");
  mps_assert_fails(context, mps_body_get_state(body, NULL), MPS_ERROR_ARGUMENT, "out is NULL");
  mps_assert_fails(context, mps_body_name_part(body, "no blanks", 0, 1, NULL), MPS_ERROR_ARGUMENT,
                   "no blanks");
  mps_assert_fails(context, mps_body_name_part(body, "tip", 4, 1, NULL), MPS_ERROR_ARGUMENT,
                   "first is 4");
  assert_int_equal(mps_body_get_state(NULL, &s), MPS_ERROR_ARGUMENT);
  mps_body_destroy(&body);
  assert_null(body);
  mps_body_destroy(&body);
  mps_body_destroy(NULL);
}

static void names_parts(void **state) {
  (void)state;
  mps_body *body = NULL;
  mps_assert_ok(context, mps_body_create_polygon(context, NULL, 4, square, &body));
  int32_t tip, side;
  mps_assert_ok(context, mps_body_name_part(body, "tip", 0, 1, &tip));
  mps_assert_ok(context, mps_body_name_part(body, "side", 3, 2, &side)); /* 3 and 0 */
  assert_int_equal(mps_body_find_part(body, "rest"), 0);
  assert_int_equal(mps_body_find_part(body, "tip"), tip);
  assert_int_equal(mps_body_find_part(body, "side"), side);
  assert_int_equal(mps_body_find_part(body, "none"), -1);
  assert_int_equal(mps_body_part_count(body), 3);
  for (int k = 3; k < 200; k++) {
    char name[8];
    snprintf(name, sizeof name, "p%d", k);
    mps_assert_ok(context, mps_body_name_part(body, name, 0, 1, NULL));
  }
  assert_int_equal(mps_body_part_count(body), 200);
  assert_int_equal(mps_body_find_part(body, "p199"), 199);
  assert_int_equal(mps_body_find_part(body, "tip"), tip);
  mps_assert_ok(context, mps_body_name_part(body, "tip", 2, 1, NULL)); /* an old name still can */
  mps_body_destroy(&body);
}

/* A driven body is where its signals are, and its surface moves with it. */
static void follows_signals(void **state) {
  (void)state;
  mps_signal *ramp = NULL, *sine = NULL;
  mps_assert_ok(context, mps_signal_create_ramp(context, 0.0, 1.0, 2.0, &ramp));
  mps_assert_ok(context, mps_signal_create_sine(context, 0.25, 0.5, 0.0, &sine));
  mps_body_def def = mps_body_defaults();
  def.position[0] = 1.0;
  def.rotation[2] = 0.3;
  mps_body *body = NULL;
  mps_assert_ok(context, mps_body_create_box(context, &def, 4.0, 2.0, &body));
  mps_assert_ok(context, mps_body_drive(body, 1, ramp, -1.0));
  mps_assert_ok(context, mps_body_drive(body, 5, sine, 1.0));
  mps_signal_destroy(&ramp);
  mps_signal_destroy(&sine);
  for (int k = 0; k < 100; k++) mps_assert_ok(context, mps_body_advance(body, 0.01));
  mps_body_state s;
  mps_assert_ok(context, mps_body_get_state(body, &s));
  mps_assert_near(s.time, 1.0, 1e-12);
  mps_assert_near(s.position[0], 1.0, 0.0);
  mps_assert_near(s.position[1], -2.0, 1e-12);
  mps_assert_near(s.rotation[2], 0.8, 1e-12);
  mps_assert_near(s.spin[2], 0.0, 1e-9);
  /* the middle of the right side, 0.5 outside */
  const double x[] = {1.0 + 2.5 * cos(0.8), -2.0 + 2.5 * sin(0.8)};
  double d, n[2], foot[2];
  int64_t edge;
  mps_assert_ok(context, mps_body_distance(body, 1, x, &d, n, foot, &edge));
  mps_assert_near(d, 0.5, 1e-12);
  mps_assert_near(n[0], cos(0.8), 1e-12);
  mps_assert_near(foot[1], -2.0 + 2.0 * sin(0.8), 1e-12);
  assert_int_equal(edge, 1);
  mps_body_destroy(&body);
}

/* Free fall with a load: the discrete sums of symplectic Euler, exactly. */
static void falls_freely(void **state) {
  (void)state;
  mps_body_def def = mps_body_defaults();
  def.motion = MPS_BODY_MOTION_FREE;
  def.mass = 2.0;
  def.inertia[2] = 0.5;
  def.velocity[0] = 3.0;
  def.spin[2] = 1.0;
  def.gravity[1] = -10.0;
  mps_body *body = NULL;
  mps_assert_ok(context, mps_body_create_disc(context, &def, 1.0, &body));
  const double force[] = {4.0, 0.0, 0.0}, moment[] = {0.0, 0.0, 0.25};
  mps_assert_ok(context, mps_body_set_load(body, force, moment));
  mps_assert_fails(context, mps_body_drive(body, 0, NULL, 1.0), MPS_ERROR_STATE, "follows no");
  const int steps = 200;
  const double dt = 0.01, t = steps * dt, late = 0.5 * dt * dt * steps * (steps + 1);
  for (int k = 0; k < steps; k++) mps_assert_ok(context, mps_body_advance(body, dt));
  mps_body_state s;
  mps_assert_ok(context, mps_body_get_state(body, &s));
  mps_assert_near(s.velocity[0], 3.0 + 2.0 * t, 1e-12);
  mps_assert_near(s.position[0], 3.0 * t + 2.0 * late, 1e-11);
  mps_assert_near(s.position[1], -10.0 * late, 1e-11);
  mps_assert_near(s.spin[2], 1.0 + 0.5 * t, 1e-12);
  mps_assert_near(s.rotation[2], t + 0.5 * late, 1e-11);
  mps_body_destroy(&body);
}

/* A servo: placed, then moved on by velocity and spin until it is set again. */
static void moves_from_outside(void **state) {
  (void)state;
  mps_body *body = NULL;
  mps_body_state s;
  mps_signal *ramp = NULL;
  mps_assert_ok(context, mps_signal_create_ramp(context, 0.0, 1.0, 2.0, &ramp));
  mps_assert_ok(context, mps_body_create_box(context, NULL, 4.0, 2.0, &body));
  mps_assert_ok(context, mps_body_drive(body, 0, ramp, 1.0));
  mps_signal_destroy(&ramp);
  mps_body_motion motion = mps_body_motion_defaults();
  motion.position[0] = 3.0, motion.velocity[1] = -0.5, motion.spin[2] = 0.2;
  mps_assert_ok(context, mps_body_set_motion(body, &motion));
  for (int k = 0; k < 10; k++) mps_assert_ok(context, mps_body_advance(body, 0.05));
  mps_assert_ok(context, mps_body_get_state(body, &s));
  mps_assert_near(s.position[0], 3.0, 0.0);
  mps_assert_near(s.position[1], -0.25, 1e-15);
  mps_assert_near(s.rotation[2], 0.1, 1e-15);
  mps_assert_near(s.velocity[1], -0.5, 0.0);
  motion = mps_body_motion_defaults(); /* from where it is, with another velocity */
  motion.velocity[1] = 1.0;
  mps_assert_ok(context, mps_body_set_motion(body, &motion));
  for (int k = 0; k < 10; k++) mps_assert_ok(context, mps_body_advance(body, 0.05));
  mps_assert_ok(context, mps_body_get_state(body, &s));
  mps_assert_near(s.position[1], 0.25, 1e-14);
  mps_assert_near(s.rotation[2], 0.1, 1e-15);
  mps_assert_ok(context, mps_body_set_motion(body, NULL)); /* back to the ramp, which has ended */
  mps_assert_ok(context, mps_body_get_state(body, &s));
  mps_assert_near(s.position[0], 2.0, 1e-12);
  mps_assert_near(s.position[1], 0.0, 0.0);
  motion.velocity[2] = 1.0;
  mps_assert_fails(context, mps_body_set_motion(body, &motion), MPS_ERROR_ARGUMENT,
                   "velocity[2] is 1 m/s, must be 0 for a 2D shape");
  motion.velocity[2] = 0.0, motion.spin[2] = INFINITY;
  mps_assert_fails(context, mps_body_set_motion(body, &motion), MPS_ERROR_ARGUMENT,
                   "spin[2] is inf rad/s");
  mps_body_destroy(&body);
}

/* In space a constant spin is a rotation about a fixed axis. */
static void turns_from_outside(void **state) {
  (void)state;
  mps_body *body = NULL;
  mps_body_state s;
  mps_assert_ok(context, mps_body_create_sphere(context, NULL, 1.0, &body));
  mps_body_motion motion = mps_body_motion_defaults();
  motion.rotation[0] = 0.1;
  mps_assert_fails(context, mps_body_set_motion(body, &motion), MPS_ERROR_ARGUMENT, "or all NaN");
  motion.rotation[1] = motion.rotation[2] = 0.0;
  motion.spin[0] = 0.3;
  mps_assert_ok(context, mps_body_set_motion(body, &motion));
  for (int k = 0; k < 100; k++) mps_assert_ok(context, mps_body_advance(body, 0.01));
  mps_assert_ok(context, mps_body_get_state(body, &s));
  mps_assert_near(s.rotation[0], 0.4, 1e-13);
  mps_assert_near(s.orientation[4], cos(0.4), 1e-13);
  mps_body_destroy(&body);
}

static mps_body *free_body(int dim, const mps_body_def *more) {
  mps_body_def def = *more;
  mps_body *body = NULL;
  def.motion = MPS_BODY_MOTION_FREE;
  def.mass = 2.0;
  for (int c = dim == 2 ? 2 : 0; c < 3; c++) def.inertia[c] = 0.5 + 0.2 * c, def.spin[c] = 1.0 - c;
  def.velocity[0] = 3.0;
  if (dim == 2)
    mps_assert_ok(context, mps_body_create_disc(context, &def, 1.0, &body));
  else
    mps_assert_ok(context, mps_body_create_sphere(context, &def, 1.0, &body));
  return body;
}

/* The work of each force, added up step by step, is what the energy changes by. */
static void keeps_its_books(void **state) {
  (void)state;
  for (int dim = 2; dim <= 3; dim++) {
    mps_body_def def = mps_body_defaults();
    def.gravity[1] = -10.0, def.damping[0] = 0.5, def.damping[1] = 0.3;
    mps_body *body = free_body(dim, &def);
    const double force[] = {4.0, 0.0, 0.0}, moment[] = {0.0, 0.0, 0.25};
    const mpsi_load contact_force = {{-1.0, 6.0, 0.0}, {0.0, 0.0, -0.4}};
    mps_assert_ok(context, mps_body_set_load(body, force, moment));
    mps_body_totals start, t;
    mps_reaction r;
    mps_assert_ok(context, mps_body_get_totals(body, &start));
    mps_assert_near(start.linear[0], 6.0, 0.0);
    mpsi_body_source source = {.moves = false};
    assert_true(mpsi_body_make_source(body, &source));
    mpsi_body_join(body, &source);
    source.part[0] = (mpsi_part_load){.force = contact_force, .count = 1};
    for (int k = 0; k < 200; k++) {
      mpsi_body_react(body, &source, 0.01);
      mpsi_body_advance(body, 0.01);
    }
    mps_assert_ok(context, mps_body_get_totals(body, &t));
    mps_assert_ok(context, mps_body_get_reaction(body, -1, &r));
    assert_true(t.dissipated > 1.0 && fabs(t.work_contacts) > 1.0 && fabs(t.work_loads) > 1.0);
    mps_assert_near(t.kinetic + t.dissipated - t.work_contacts - t.work_loads, start.kinetic,
                    1e-11 * (fabs(t.work_loads) + t.dissipated));
    /* gravity and the load at rest in time: impulse by hand, less what damping took */
    mps_assert_near(r.impulse[1], 12.0, 1e-12);
    mps_assert_near(-r.work, t.work_contacts, 0.02 * fabs(t.work_contacts)); /* at old velocities */
    mpsi_body_leave(body, &source);
    mpsi_body_free_source(body, &source);
    mps_body_destroy(&body);
  }
}

/* A velocity table that begins before t = 0: u(t) is the integral from 0. */
static void begins_where_it_is(void **state) {
  (void)state;
  const double t[] = {-1.0, 2.0}, v[] = {0.01, 0.01}, a[] = {1.0, 1.0};
  for (int kind = 0; kind < 2; kind++) {
    mps_signal *signal = NULL;
    mps_body *body = NULL;
    mps_body_state s;
    mps_assert_ok(context, mps_signal_create_table(context,
                                                   kind ? MPS_SIGNAL_QUANTITY_ACCELERATION
                                                        : MPS_SIGNAL_QUANTITY_VELOCITY,
                                                   2, t, kind ? a : v, &signal));
    mps_assert_ok(context, mps_body_create_disc(context, NULL, 1.0, &body));
    mps_assert_ok(context, mps_body_drive(body, 1, signal, -1.0));
    mps_assert_ok(context, mps_body_get_state(body, &s));
    mps_assert_near(s.position[1], 0.0, 1e-16);
    mps_assert_ok(context, mps_body_advance(body, 1.0));
    mps_assert_ok(context, mps_body_get_state(body, &s));
    mps_assert_near(s.position[1], kind ? -1.5 : -0.01, 1e-15);
    mps_signal_destroy(&signal);
    mps_body_destroy(&body);
  }
}

static void refuses_insane_numbers(void **state) {
  (void)state;
  mps_body *body = NULL;
  mps_body_def def = mps_body_defaults();
  const double x[2] = {0.0, 0.0};
  double d;
  mps_assert_fails(context, mps_body_create_disc(context, &def, 1e-320, &body), MPS_ERROR_ARGUMENT,
                   "radius is 9.99989e-321 m, must be in 1e-09 to 1e+09 m");
  mps_assert_fails(context, mps_body_create_box(context, &def, 1.0, 1e300, &body),
                   MPS_ERROR_ARGUMENT, "height is 1e+300 m");
  def.position[1] = 1e308;
  mps_assert_fails(context, mps_body_create_disc(context, &def, 1.0, &body), MPS_ERROR_ARGUMENT,
                   "position[1] is 1e+308 m");
  def = mps_body_defaults();
  def.motion = MPS_BODY_MOTION_FREE;
  def.mass = 1e-308, def.inertia[2] = 1.0;
  mps_assert_fails(context, mps_body_create_disc(context, &def, 1.0, &body), MPS_ERROR_ARGUMENT,
                   "mass is 1e-308 kg");
  mps_assert_ok(context, mps_body_create_disc(context, NULL, 1.0, &body));
  mps_assert_fails(context, mps_body_distance(body, INT64_MAX, x, &d, NULL, NULL, NULL),
                   MPS_ERROR_ARGUMENT, "count is 9223372036854775807");
  mps_body_destroy(&body);
}

static mps_status make(mps_context *c, int what) {
  mps_body *body = NULL;
  const double normal[] = {0.0, 1.0};
  const mps_status status = what == 0   ? mps_body_create_polygon(c, NULL, 4, square, &body)
                            : what == 1 ? mps_body_create_box(c, NULL, 1.0, 1.0, &body)
                            : what == 2 ? mps_body_create_disc(c, NULL, 1.0, &body)
                            : what == 3 ? mps_body_create_half_plane(c, NULL, normal, &body)
                                        : mps_body_create_cylinder(c, NULL, 1.0, 1.0, &body);
  if (status != MPS_OK) assert_null(body);
  mps_body_destroy(&body);
  return status;
}

static void survives_lack_of_memory(void **state) {
  (void)state;
  for (int what = 0; what < 5; what++) test_allocator_sweep(make, what);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(refuses_bad_definitions),
                                     cmocka_unit_test(refuses_what_a_plane_has_not),
                                     cmocka_unit_test(refuses_bad_solids),
                                     cmocka_unit_test(refuses_bad_calls),
                                     cmocka_unit_test(names_parts),
                                     cmocka_unit_test(follows_signals),
                                     cmocka_unit_test(falls_freely),
                                     cmocka_unit_test(moves_from_outside),
                                     cmocka_unit_test(turns_from_outside),
                                     cmocka_unit_test(keeps_its_books),
                                     cmocka_unit_test(begins_where_it_is),
                                     cmocka_unit_test(refuses_insane_numbers),
                                     cmocka_unit_test(survives_lack_of_memory)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
