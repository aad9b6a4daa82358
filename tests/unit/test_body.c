/* test_body.c - rigid bodies: arguments, motion by signals and by forces, parts, ownership.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/body_internal.h"
#include "test_allocator.h"
#include "test_fixture.h"
#include "test_journal.h"

static const double square[] = {0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0};

TEST(refuses_bad_definitions) {
  mps_body *body = (mps_body *)1;
  mps_body_def def = mps_body_defaults();
  const double nowhere[] = {0.0, NAN}, zero[] = {0.0, 0.0};
  const double bow[] = {0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0};
  assert_int_equal(mps_body_create_disc(NULL, &def, 1.0, &body), MPS_ERROR_ARGUMENT);
  REFUSES(mps_body_create_disc(context, &def, 0.0, &body), "radius is 0 m");
  assert_null(body);
  REFUSES(mps_body_create_disc(context, &def, 1.0, NULL), "out is NULL");
  REFUSES(mps_body_create_box(context, &def, 1.0, -2.0, &body), "height is -2 m");
  REFUSES(mps_body_create_half_plane(context, &def, zero, &body), "normal is (0, 0)");
  REFUSES(mps_body_create_half_plane(context, &def, NULL, &body), "normal is NULL");
  REFUSES(mps_body_create_half_plane(context, &def, nowhere, &body), "must be finite");
  REFUSES(mps_body_create_polygon(context, &def, 4, NULL, &body), "xy is NULL");
  REFUSES(mps_body_create_polygon(context, &def, 2, square, &body), "vertices is 2");
  REFUSES(mps_body_create_polygon(context, &def, 4, bow, &body), "intersect");
  def.motion = 7;
  REFUSES(mps_body_create_box(context, &def, 1.0, 1.0, &body), "motion is 7");
  assert_null(body);
}

TEST(refuses_what_a_plane_has_not) {
  scoped_body *body = NULL;
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE, .mass = def.inertia[2] = 1.0);
  REFUSES(
      mps_body_create_sphere(context, &def, 1.0, &body),
      "inertia[0] is nan kg m2, must be in 1e-30 to 1e+30 where motion is MPS_BODY_MOTION_FREE");
  OK(mps_body_create_disc(context, &def, 1.0, &body));
  const double out[] = {0.0, 0.0, 1.0}, bad[] = {0.0, NAN, 0.0};
  REFUSES(mps_body_set_load(body, out, NULL), "must be 0 in 2D");
  REFUSES(mps_body_set_load(body, NULL, bad), "moment[1] is nan");
  OK(mps_body_set_load(body, NULL, out));
}

TEST(refuses_bad_solids) {
  mps_body *body = NULL;
  const double zero[3] = {0.0, 0.0, 0.0};
  const double crossing[] = {-0.1, 0.0, 1.0, 0.0, 1.0, 1.0};
  const double pinched[] = {0.0, 0.0, 1.0, -1.0, 1.0, 1.0};
  const double twice[] = {0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0, 1.0};
  REFUSES(mps_body_create_half_space(context, NULL, zero, &body), "normal is (0, 0, 0)");
  REFUSES(mps_body_create_cylinder(context, NULL, 1.0, NAN, &body), "length is nan m");
  REFUSES(mps_body_create_revolution(context, NULL, 3, NULL, &body), "rz is NULL");
  REFUSES(mps_body_create_revolution(context, NULL, 3, crossing, &body), "corner 0 has r = -0.1 m");
  REFUSES(mps_body_create_revolution(context, NULL, 3, pinched, &body),
          "corner 0 is on the axis with neither of its edges");
  REFUSES(mps_body_create_revolution(context, NULL, 4, twice, &body), "vertices: corners 1 and 2");
  assert_null(body);
}

TEST(refuses_bad_calls) {
  MAKE_KEPT(body, body, create_polygon, context, NULL, 4, square);
  mps_body_state s;
  mps_reaction r;
  const double force[] = {1.0, 2.0, 0.0}, bad[] = {0.0, INFINITY};
  double d;
  REFUSES(mps_body_advance(body, 0.0), "dt is 0 s");
  WITH_DEFAULTS(mps_body_motion, away, .velocity[0] = 1.0);
  OK(mps_body_set_motion(body, &away));
  FAILS(mps_body_advance(body, 1e300), MPS_ERROR_DIVERGED, "stays where it was");
  OK(mps_body_get_state(body, &s));
  NEAR(s.time, 0.0, 0.0);
  NEAR(s.position[0], 0.0, 0.0);
  OK(mps_body_set_motion(body, NULL));
  REFUSES(mps_body_drive(body, 2, NULL, 1.0), "component is 2");
  REFUSES(mps_body_drive(body, 0, NULL, NAN), "factor is nan");
  FAILS(mps_body_set_load(body, force, NULL), MPS_ERROR_STATE, "takes no load");
  REFUSES(mps_body_distance(body, 1, bad, &d, NULL, NULL, NULL), "point 0 has y = inf");
  REFUSES(mps_body_distance(body, -1, bad, &d, NULL, NULL, NULL), "count is -1");
  REFUSES(mps_body_get_reaction(body, 1, &r), "part is 1");
  REFUSES(mps_body_get_state(body, NULL), "out is NULL");
  REFUSES(mps_body_name_part(body, "no blanks", 0, 1, NULL), "no blanks");
  REFUSES(mps_body_name_part(body, "tip", 4, 1, NULL), "first is 4");
  assert_int_equal(mps_body_get_state(NULL, &s), MPS_ERROR_ARGUMENT);
  mps_body_destroy(&body);
  assert_null(body);
  mps_body_destroy(&body);
  mps_body_destroy(NULL);
}

TEST(names_parts) {
  MAKE(body, body, create_polygon, context, NULL, 4, square);
  int32_t tip, side;
  OK(mps_body_name_part(body, "tip", 0, 1, &tip));
  OK(mps_body_name_part(body, "side", 3, 2, &side)); /* 3 and 0 */
  assert_int_equal(mps_body_find_part(body, "rest"), 0);
  assert_int_equal(mps_body_find_part(body, "tip"), tip);
  assert_int_equal(mps_body_find_part(body, "side"), side);
  assert_int_equal(mps_body_find_part(body, "none"), -1);
  assert_int_equal(body->parts, 3);
  for (int k = 3; k < 200; k++) {
    char name[8];
    snprintf(name, sizeof name, "p%d", k);
    OK(mps_body_name_part(body, name, 0, 1, NULL));
  }
  assert_int_equal(body->parts, 200);
  assert_int_equal(mps_body_find_part(body, "p199"), 199);
  assert_int_equal(mps_body_find_part(body, "tip"), tip);
  OK(mps_body_name_part(body, "tip", 2, 1, NULL)); /* an old name still can */
}

/* A driven body is where its signals are, and its surface moves with it. */
TEST(follows_signals) {
  mps_signal *ramp = NULL, *sine = NULL;
  OK(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.0, 1.0, 2.0, &ramp));
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.25, 0.5, 0.0, &sine));
  DEF(body, def, .position[0] = 1.0, .rotation[2] = 0.3);
  MAKE(body, body, create_box, context, &def, 4.0, 2.0);
  OK(mps_body_drive(body, 1, ramp, -1.0));
  OK(mps_body_drive(body, 5, sine, 1.0));
  REFUSES(mps_body_drive(body, 5, sine, 1e300), "factor is 1e+300"); /* and nothing has changed */
  mps_signal_destroy(&ramp);
  mps_signal_destroy(&sine);
  for (int k = 0; k < 100; k++) OK(mps_body_advance(body, 0.01));
  mps_body_state s;
  OK(mps_body_get_state(body, &s));
  NEAR(s.time, 1.0, 1e-12);
  NEAR(s.position[0], 1.0, 0.0);
  NEAR(s.position[1], -2.0, 1e-12);
  NEAR(s.rotation[2], 0.8, 1e-12);
  NEAR(s.spin[2], 0.0, 1e-9);
  /* the middle of the right side, 0.5 outside */
  const double x[] = {1.0 + 2.5 * cos(0.8), -2.0 + 2.5 * sin(0.8)};
  double d, n[2], foot[2];
  int64_t edge;
  OK(mps_body_distance(body, 1, x, &d, n, foot, &edge));
  NEAR(d, 0.5, 1e-12);
  NEAR(n[0], cos(0.8), 1e-12);
  NEAR(foot[1], -2.0 + 2.0 * sin(0.8), 1e-12);
  assert_int_equal(edge, 1);
}

/* Signals in turn: what continues the motion is silent; what does not, as a signal that counts from
 * 0 again or a pose from elsewhere (a checkpoint), is warned of once. */
TEST(tells_of_jumps) {
  for (int n = 0; n < 12; n++) {
    journal j = {0};
    scoped_context *own = journal_context(&j, NULL);
    const int component = n % 2 ? 5 : 1, how = n / 2 % 4;
    const double size = pow(100.0, n % 3 - 1); /* m; rad */
    scoped_signal *fast = NULL, *slow = NULL;
    const double t[] = {0.0, 1.0, 2.0}, v[] = {size, size, size}, u[] = {0.0, size, 1.5 * size};
    OK(mps_signal_create_table(own, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v, &fast));
    OK(mps_signal_create_table(own, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 3, t, u, &slow));
    DEF(body, def, .position[1] = -3.0 * size);
    MAKE(body, body, create_box, own, &def, 4.0, 2.0);
    OK(mps_body_drive(body, component, fast, 1.0));
    for (int k = 0; k < 100; k++) OK(mps_body_advance(body, 0.01));
    OK(mps_body_drive(body, component, slow, 1.0));
    for (int k = 0; k < 50; k++) OK(mps_body_advance(body, 0.01));
    assert_int_equal(j.count, 0);
    if (how == 1) OK(mps_body_drive(body, component, fast, 1.0));
    if (how == 2) OK(mps_body_drive(body, component, NULL, 0.0));
    if (how == 3) body->pose.x[0] += 1e-3;
    for (int k = 0; k < 20; k++) OK(mps_body_advance(body, 0.01));
    assert_int_equal(j.count, how ? 1 : 0);
    char text[40];
    snprintf(text, sizeof text, "component %d jumps from", how == 3 ? 0 : component);
    if (how && !strstr(j.last, text)) fail_msg("%s", j.last);
  }
}

/* Free fall with a load: the discrete sums of symplectic Euler, exactly. */
TEST(falls_freely) {
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE, .mass = 2.0, .inertia[2] = 0.5, .velocity[0] = 3.0,
      .spin[2] = 1.0, .gravity[1] = -10.0);
  MAKE(body, body, create_disc, context, &def, 1.0);
  const double force[] = {4.0, 0.0, 0.0}, moment[] = {0.0, 0.0, 0.25};
  OK(mps_body_set_load(body, force, moment));
  FAILS(mps_body_drive(body, 0, NULL, 1.0), MPS_ERROR_STATE, "follows no");
  const int steps = 200;
  const double dt = 0.01, t = steps * dt, late = 0.5 * dt * dt * steps * (steps + 1);
  for (int k = 0; k < steps; k++) OK(mps_body_advance(body, dt));
  mps_body_state s;
  OK(mps_body_get_state(body, &s));
  NEAR(s.velocity[0], 3.0 + 2.0 * t, 1e-12);
  NEAR(s.position[0], 3.0 * t + 2.0 * late, 1e-11);
  NEAR(s.position[1], -10.0 * late, 1e-11);
  NEAR(s.spin[2], 1.0 + 0.5 * t, 1e-12);
  NEAR(s.rotation[2], t + 0.5 * late, 1e-11);
}

/* A servo: placed, then moved on by velocity and spin until it is set again. */
TEST(moves_from_outside) {
  mps_body_state s;
  MAKE_KEPT(signal, ramp, create_ramp, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.0, 1.0, 2.0);
  MAKE(body, body, create_box, context, NULL, 4.0, 2.0);
  OK(mps_body_drive(body, 0, ramp, 1.0));
  mps_signal_destroy(&ramp);
  WITH_DEFAULTS(mps_body_motion, motion, .position[0] = 3.0, .velocity[1] = -0.5, .spin[2] = 0.2);
  OK(mps_body_set_motion(body, &motion));
  for (int k = 0; k < 10; k++) OK(mps_body_advance(body, 0.05));
  OK(mps_body_get_state(body, &s));
  NEAR(s.position[0], 3.0, 0.0);
  NEAR(s.position[1], -0.25, 1e-15);
  NEAR(s.rotation[2], 0.1, 1e-15);
  NEAR(s.velocity[1], -0.5, 0.0);
  motion = mps_body_motion_defaults(); /* from where it is, with another velocity */
  motion.velocity[1] = 1.0;
  OK(mps_body_set_motion(body, &motion));
  for (int k = 0; k < 10; k++) OK(mps_body_advance(body, 0.05));
  OK(mps_body_get_state(body, &s));
  NEAR(s.position[1], 0.25, 1e-14);
  NEAR(s.rotation[2], 0.1, 1e-15);
  OK(mps_body_set_motion(body, NULL)); /* back to the ramp, which has ended */
  OK(mps_body_get_state(body, &s));
  NEAR(s.position[0], 2.0, 1e-12);
  NEAR(s.position[1], 0.0, 0.0);
  motion.velocity[2] = 1.0;
  REFUSES(mps_body_set_motion(body, &motion),
          "velocity[2] is 1 m/s, must be 0 where the model is plane");
  motion.velocity[2] = 0.0, motion.spin[2] = INFINITY;
  REFUSES(mps_body_set_motion(body, &motion), "spin[2] is inf rad/s");
}

/* In space a constant spin is a rotation about a fixed axis. */
TEST(turns_from_outside) {
  mps_body_state s;
  MAKE(body, body, create_sphere, context, NULL, 1.0);
  WITH_DEFAULTS(mps_body_motion, motion, .rotation[0] = 0.1);
  REFUSES(mps_body_set_motion(body, &motion), "all components are given, or none");
  motion.rotation[1] = motion.rotation[2] = 0.0;
  motion.spin[0] = 0.3;
  OK(mps_body_set_motion(body, &motion));
  for (int k = 0; k < 100; k++) OK(mps_body_advance(body, 0.01));
  OK(mps_body_get_state(body, &s));
  NEAR(s.rotation[0], 0.4, 1e-13);
  NEAR(s.orientation[4], cos(0.4), 1e-13);
}

static mps_body *free_body(int dim, const mps_body_def *more) {
  mps_body_def def = *more;
  mps_body *body = NULL;
  def.motion = MPS_BODY_MOTION_FREE;
  def.mass = 2.0;
  for (int c = dim == 2 ? 2 : 0; c < 3; c++) def.inertia[c] = 0.5 + 0.2 * c, def.spin[c] = 1.0 - c;
  def.velocity[0] = 3.0;
  if (dim == 2)
    OK(mps_body_create_disc(context, &def, 1.0, &body));
  else
    OK(mps_body_create_sphere(context, &def, 1.0, &body));
  return body;
}

/* The work of each force, added up step by step, is what the energy changes by. */
TEST(keeps_its_books) {
  for (int dim = 2; dim <= 3; dim++) {
    DEF(body, def, .gravity[1] = -10.0, .damping[0] = 0.5, .damping[1] = 0.3);
    scoped_body *body = free_body(dim, &def);
    const double force[] = {4.0, 0.0, 0.0}, moment[] = {0.0, 0.0, 0.25};
    const mpsi_load contact_force = {{-1.0, 6.0, 0.0}, {0.0, 0.0, -0.4}};
    OK(mps_body_set_load(body, force, moment));
    mps_body_totals start, t;
    mps_reaction r;
    OK(mps_body_get_totals(body, &start));
    NEAR(start.linear[0], 6.0, 0.0);
    mpsi_body_source source = {.moves = false};
    assert_true(mpsi_body_make_source(body, &source));
    mpsi_body_join(body, &source);
    source.part[0] = (mpsi_part_load){.force = contact_force, .count = 1};
    for (int k = 0; k < 200; k++) {
      mpsi_body_react(body, &source, 0.01);
      mpsi_body_advance(body, 0.01);
    }
    OK(mps_body_get_totals(body, &t));
    OK(mps_body_get_reaction(body, -1, &r));
    assert_true(t.dissipated > 1.0 && fabs(t.work_contacts) > 1.0 && fabs(t.work_loads) > 1.0);
    NEAR(t.kinetic + t.dissipated - t.work_contacts - t.work_loads, start.kinetic,
         1e-11 * (fabs(t.work_loads) + t.dissipated));
    /* gravity and the load at rest in time: impulse by hand, less what damping took */
    NEAR(r.impulse[1], 12.0, 1e-12);
    NEAR(-r.work, t.work_contacts, 0.02 * fabs(t.work_contacts)); /* at old velocities */
    mpsi_body_leave(body, &source);
    mpsi_body_free_source(body, &source);
  }
}

/* A velocity table that begins before t = 0: u(t) is the integral from 0. */
TEST(begins_where_it_is) {
  const double t[] = {-1.0, 2.0}, v[] = {0.01, 0.01}, a[] = {1.0, 1.0};
  for (int kind = 0; kind < 2; kind++) {
    scoped_signal *signal = NULL;
    mps_body_state s;
    OK(mps_signal_create_table(
        context, kind ? MPS_SIGNAL_QUANTITY_ACCELERATION : MPS_SIGNAL_QUANTITY_VELOCITY, 2, t,
        kind ? a : v, &signal));
    MAKE(body, body, create_disc, context, NULL, 1.0);
    OK(mps_body_drive(body, 1, signal, -1.0));
    OK(mps_body_get_state(body, &s));
    NEAR(s.position[1], 0.0, 1e-16);
    OK(mps_body_advance(body, 1.0));
    OK(mps_body_get_state(body, &s));
    NEAR(s.position[1], kind ? -1.5 : -0.01, 1e-15);
  }
}

TEST(refuses_insane_numbers) {
  scoped_body *body = NULL;
  mps_body_def def = mps_body_defaults();
  const double x[2] = {0.0, 0.0};
  double d;
  REFUSES(mps_body_create_disc(context, &def, 1e-320, &body),
          "radius is 9.99989e-321 m, must be in 1e-09 to 1e+09 m");
  REFUSES(mps_body_create_box(context, &def, 1.0, 1e300, &body), "height is 1e+300 m");
  OK(mps_body_create_disc(context, NULL, 1.0, &body));
  REFUSES(mps_body_distance(body, INT64_MAX, x, &d, NULL, NULL, NULL),
          "count is 9223372036854775807");
}

static mps_status make(mps_context *c, int what) {
  scoped_body *body = NULL;
  const double normal[] = {0.0, 1.0};
  const mps_status status = what == 0   ? mps_body_create_polygon(c, NULL, 4, square, &body)
                            : what == 1 ? mps_body_create_box(c, NULL, 1.0, 1.0, &body)
                            : what == 2 ? mps_body_create_disc(c, NULL, 1.0, &body)
                            : what == 3 ? mps_body_create_half_plane(c, NULL, normal, &body)
                                        : mps_body_create_cylinder(c, NULL, 1.0, 1.0, &body);
  if (status != MPS_OK) assert_null(body);
  return status;
}

TEST(survives_lack_of_memory) {
  for (int what = 0; what < 5; what++) test_allocator_sweep(make, what);
}
