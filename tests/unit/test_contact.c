/* test_contact.c - contacts of the WLS-MPM solver with bodies: the handle, bodies that several
 * solvers share, and what must not pass without a word: thin walls, particles inside, bodies driven
 * through the ground.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_tank.h"
#include "mpm_scene.h"
#include "test_fixture.h"

#define REFUSES(text, call) mps_assert_fails(context, call, MPS_ERROR_ARGUMENT, text)

/* A block 0.2 x 0.1 m in cells of 0.02 m, its lower side on y = 0. */
static mpm_scene block_at(double x) {
  mpm_scene s = mpm_scene_begin(context, 0.01, x, 0.0, 1e5);
  mpm_scene_box(&s, x, 0.0, x + 0.2, 0.1);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.02;
  def.origin[0] = x;
  def.lower[1] = 0.0;
  mpm_scene_solve(&s, &def);
  return s;
}

static mps_body *box_at(double x, double y, double width, double height) {
  mps_body_def def = mps_body_defaults();
  mps_body *body = NULL;
  def.position[0] = x, def.position[1] = y;
  mps_assert_ok(context, mps_body_create_box(context, &def, width, height, &body));
  return body;
}

static void bad_definitions(void **state) {
  (void)state;
  mpm_scene s = block_at(0.0);
  mps_body *body = box_at(0.1, 0.2, 0.1, 0.1);
  mps_contact *contact = (mps_contact *)1;
#define CASE(member, value, text)                                                                  \
  do {                                                                                             \
    mps_contact_def def = mps_contact_defaults();                                                  \
    def.member = value;                                                                            \
    REFUSES(text, mps_mpm_add_contact(s.mpm, body, &def, &contact));                               \
    assert_null(contact);                                                                          \
  } while (0)
  CASE(friction, -0.1, "friction is -0.1");
  CASE(method, 2, "method is 2, allowed are 0 (impulse) and 1 (penalty)");
  CASE(sweeps, -1, "sweeps is -1, must be in 0 to 1000");
  CASE(penalty, 1e6, "penalty is given, and method is 0 (impulse)");
  CASE(xi, 0.5, "xi is given, and method is 0 (impulse)");
  CASE(penalty, 0.0, "penalty is 0 N/m");
  CASE(xi, 1.0, "xi is 1, must be in (0, 1)");
  CASE(offset, -1.0, "offset is -1 m");
  CASE(depth, 0.0, "depth is 0 m");
  CASE(mover, 2, "mover is 2");
  CASE(thin, -1, "thin is -1");
  CASE(inside, 3, "inside is 3");
  CASE(corner, -0.01, "corner is -0.01 m, must be in 0 to 1e+09");
#undef CASE
  mps_contact_def both = mps_contact_defaults();
  both.method = MPS_CONTACT_METHOD_PENALTY;
  both.xi = 0.6, both.penalty = 1e6;
  REFUSES("xi is 0.6 and penalty 1e+06 N/m", mps_mpm_add_contact(s.mpm, body, &both, NULL));
  both.xi = NAN, both.corner = 0.01;
  REFUSES("corner is 0.01 m, and method is 1", mps_mpm_add_contact(s.mpm, body, &both, NULL));
  mps_body_destroy(&body);
  mpm_scene_end(&s);
}

/* Pressed by 1 mm: the particles in contact, each with its gap, normal and force by the penalty. */
static void tells_who_touches(void **state) {
  (void)state;
  mpm_scene s = block_at(0.0);
  mps_body *plate = box_at(0.1, 0.149, 0.4, 0.1);
  mps_contact_def def = mps_contact_defaults();
  mps_contact *contact = NULL;
  def.method = MPS_CONTACT_METHOD_PENALTY, def.penalty = 5e4;
  mps_assert_ok(context, mps_mpm_add_contact(s.mpm, plate, &def, &contact));
  assert_ptr_equal(mps_contact_body(contact), plate);
  int64_t count = 0, ids[32];
  double gap[32], normal[96], force[96], foot[96], sum = 0.0;
  mps_assert_ok(context,
                mps_contact_get_particles(contact, 0, &count, NULL, NULL, NULL, NULL, NULL));
  assert_int_equal(count, 20); /* the upper row */
  mps_assert_ok(context,
                mps_contact_get_particles(contact, 32, &count, ids, gap, normal, force, foot));
  for (int64_t k = 0; k < count; k++) {
    mps_assert_near(gap[k], -0.001, 1e-15);
    mps_assert_near(normal[3 * k + 1], -1.0, 0.0);
    mps_assert_near(force[3 * k + 1], -50.0, 1e-10);
    mps_assert_near(foot[3 * k + 1], 0.099, 1e-15);
    assert_true(mps_particles_index(s.particles, ids[k]) >= 0);
    sum += force[3 * k + 1];
  }
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  mps_reaction r, body;
  mps_assert_ok(context, mps_contact_get_reaction(contact, -1, &r));
  mps_assert_near(r.force[1], -sum, 1e-9);
  assert_int_equal(r.count, 20);
  mps_assert_ok(context, mps_body_get_reaction(plate, 0, &body));
  assert_memory_equal(&r, &body, sizeof r);
  mps_assert_fails(context, mps_contact_get_reaction(contact, 1, &r), MPS_ERROR_ARGUMENT,
                   "part is 1");
  /* its end: no contact is left, and the body is the caller's */
  mps_contact_destroy(&contact);
  assert_null(contact);
  mps_assert_ok(context, mps_mpm_step(s.mpm, 5));
  mps_assert_ok(context, mps_body_get_reaction(plate, -1, &r));
  mps_assert_near(r.impulse[1], body.impulse[1], 0.0);
  mps_assert_ok(context, mps_body_advance(plate, 0.1));
  /* the solver goes first: the handle still returns values */
  mps_assert_ok(context, mps_mpm_add_contact(s.mpm, plate, &def, &contact));
  mpm_scene_end(&s);
  mps_assert_ok(context, mps_contact_get_reaction(contact, -1, &r));
  mps_assert_fails(context,
                   mps_contact_get_particles(contact, 0, &count, NULL, NULL, NULL, NULL, NULL),
                   MPS_ERROR_STATE, "has ended");
  mps_contact_destroy(&contact);
  mps_body_destroy(&plate);
}

/* A beam lies free on two blocks of two solvers: it feels both, and momentum is kept. */
static void bodies_are_shared(void **state) {
  (void)state;
  mpm_scene s[2] = {block_at(0.0), block_at(0.5)};
  mps_body_def def = mps_body_defaults();
  def.motion = MPS_BODY_MOTION_FREE;
  def.mass = 40.0, def.inertia[2] = 4.0;
  def.position[0] = 0.35, def.position[1] = 0.151, def.velocity[1] = -0.5;
  mps_body *beam = NULL;
  mps_contact *contact[2];
  mps_assert_ok(context, mps_body_create_box(context, &def, 1.2, 0.1, &beam));
  mps_contact_def other = mps_contact_defaults();
  other.mover = MPS_CONTACT_MOVER_OTHER;
  for (int k = 0; k < 2; k++) {
    mps_assert_ok(context, mps_mpm_remove_boundary(s[k].mpm, MPS_MPM_SIDE_Y_LOWER));
    mps_assert_ok(context, mps_mpm_add_contact(s[k].mpm, beam, k ? &other : NULL, &contact[k]));
  }
  const double dt = 0.4 * mps_mpm_limit(s[0].mpm);
  for (int step = 0; step < 100; step++)
    for (int k = 1; k >= 0; k--)
      mps_assert_ok(context, mps_mpm_run(s[k].mpm, (step + 1) * dt, 1, NULL, NULL));
  mps_reaction part[2], all;
  mps_assert_ok(context, mps_body_get_reaction(beam, -1, &all));
  for (int k = 0; k < 2; k++) {
    mps_assert_ok(context, mps_contact_get_reaction(contact[k], -1, &part[k]));
    assert_true(part[k].impulse[1] > 1.0);
  }
  mps_assert_near(part[0].impulse[1] + part[1].impulse[1], all.impulse[1], 1e-12);
  mps_assert_near(part[0].force[1] + part[1].force[1], all.force[1], 1e-9);
  /* equal but for the order in which the solvers stop the beam */
  mps_assert_near(part[0].impulse[1], part[1].impulse[1], 2e-3 * part[0].impulse[1]);
  mps_body_totals beam_now;
  mps_assert_ok(context, mps_body_get_totals(beam, &beam_now));
  const double sum = mpm_scene_totals(&s[0]).linear[1] + mpm_scene_totals(&s[1]).linear[1];
  mps_assert_near(sum + beam_now.linear[1], -0.5 * 40.0, 1e-10);
  mps_assert_near(beam_now.kinetic - beam_now.work_contacts, 0.5 * 40.0 * 0.25, 1e-10);
  for (int k = 0; k < 2; k++) {
    mpm_scene_end(&s[k]);
    mps_contact_destroy(&contact[k]);
  }
  mps_body_destroy(&beam);
}

/* A servo: the plate's speed is set by the force on it, until that is what was requested. */
static void servo_keeps_a_force(void **state) {
  (void)state;
  mpm_scene s = block_at(0.0);
  mps_body *plate = box_at(0.1, 0.15, 0.4, 0.1);
  mpm_scene_contact(&s, plate, 0.0);
  const double wanted = 100.0;
  double mean = 0.0;
  mps_reaction r;
  for (int step = 0; step < 6000; step++) {
    mps_assert_ok(context, mps_body_get_reaction(plate, -1, &r));
    mean += 0.01 * (r.force[1] - mean);
    mps_body_motion motion = mps_body_motion_defaults();
    motion.velocity[1] = -1e-4 * (wanted - mean);
    mps_assert_ok(context, mps_body_set_motion(plate, &motion));
    mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  }
  print_message("servo: mean force %.4g N of %.4g\n", mean, wanted);
  mps_assert_near(mean, wanted, 0.02 * wanted);
  mps_body_destroy(&plate);
  mpm_scene_end(&s);
}

/* A wedge of 30 degrees has a tip and no thin wall: driven a cell and a half into the block it
 * splits the particles, evenly to both sides, and keeps them out. One of 15 degrees is an edge that
 * leaks by springs. */
static void wedges_are_no_walls(void **state) {
  (void)state;
  mpm_scene s = block_at(0.0);
  mps_body_def def = mps_body_defaults();
  mps_body *wedge = NULL;
  const double t[] = {0.0, 0.04}, way[] = {0.0, -0.04}; /* s, m */
  mps_signal *down = NULL;
  def.position[0] = 0.1, def.position[1] = 0.11;
  for (int k = 0; k < 2; k++) {
    const double half = 0.2 * tan((k ? 15.0 : 7.5) * atan(1.0) / 45.0);
    const double xy[] = {0.0, 0.0, half, 0.2, -half, 0.2};
    mps_body_destroy(&wedge);
    mps_assert_ok(context, mps_body_create_polygon(context, &def, 3, xy, &wedge));
    mps_contact_def springs = mps_contact_defaults();
    springs.method = MPS_CONTACT_METHOD_PENALTY;
    if (!k)
      REFUSES("meet at less than 20 degrees", mps_mpm_add_contact(s.mpm, wedge, &springs, NULL));
  }
  mps_assert_ok(context, mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 2, t,
                                                 way, &down));
  mps_assert_ok(context, mps_body_drive(wedge, 1, down, 1.0));
  mps_assert_ok(context, mps_mpm_add_contact(s.mpm, wedge, NULL, NULL));
  mps_assert_ok(context, mps_mpm_run(s.mpm, 0.04, 1, NULL, NULL));
  const mps_view x = mpm_scene_view(&s, "position");
  double sum = 0.0, across = 0.0;
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const double at[] = {*mps_view_f64(&x, i, 0), *mps_view_f64(&x, i, 1)};
    double distance;
    mps_assert_ok(context, mps_body_distance(wedge, 1, at, &distance, NULL, NULL, NULL));
    assert_true(distance > 0.0);
    sum += at[0] - 0.1;
    across += fabs(at[0] - 0.1);
  }
  assert_true(fabs(sum) < 0.01 * across);
  mps_signal_destroy(&down);
  mps_body_destroy(&wedge);
  mpm_scene_end(&s);
}

/* Plates of 0.6 and 0.9 cells, between nodes or not: by springs all momentum would pass. */
static void thin_plates_are_refused(void **state) {
  (void)state;
  mpm_scene s = block_at(0.0);
  const double cells[] = {0.6, 0.9};
  for (int k = 0; k < 2; k++) {
    mps_body *plate = box_at(0.3, 0.05, cells[k] * 0.02, 0.5);
    mps_contact_def def = mps_contact_defaults();
    def.method = MPS_CONTACT_METHOD_PENALTY;
    REFUSES("below 2 cells momentum passes", mps_mpm_add_contact(s.mpm, plate, &def, NULL));
    def.thin = 1;
    mps_assert_ok(context, mps_mpm_add_contact(s.mpm, plate, &def, NULL));
    mps_body_destroy(&plate);
    mps_mpm_destroy(&s.mpm);
    mps_mpm_def solver = mps_mpm_defaults();
    solver.cell = 0.02;
    mpm_scene_solve(&s, &solver);
  }
  mpm_scene_end(&s);
}

static void covered_particles_are_refused(void **state) {
  (void)state;
  mpm_scene s = block_at(0.0);
  mps_body *box = box_at(0.1, 0.05, 0.06, 0.06);
  REFUSES("36 particles lie inside the body", mps_mpm_add_contact(s.mpm, box, NULL, NULL));
  assert_true(mps_context_error(context)->particle >= 0);
  mps_contact_def def = mps_contact_defaults();
  def.inside = MPS_CONTACT_INSIDE_PUSH;
  mps_assert_ok(context, mps_mpm_add_contact(s.mpm, box, &def, NULL));
  mps_body_destroy(&box);
  mpm_scene_end(&s);
}

/* How deep a particle is below the surface of a body at most, m. */
static double deepest_in(mpm_scene *s, mps_body *body) {
  mps_view x = mpm_scene_view(s, "position");
  double deepest = 0.0;
  for (int64_t p = 0; p < x.shape[0]; p++) {
    const double at[2] = {*mps_view_f64(&x, p, 0), *mps_view_f64(&x, p, 1)};
    double distance;
    mps_assert_ok(context, mps_body_distance(body, 1, at, &distance, NULL, NULL, NULL));
    deepest = fmax(deepest, -distance);
  }
  return deepest;
}

/* A wedge through soil and floor at any speed: the step follows it, and the soil gives way to it;
 * where it cannot, the run stops. */
static void driven_too_deep_is_told(void **state) {
  (void)state;
  const double speeds[] = {30.0, 1000.0, 1e5};
  const double wedge[] = {0.0, 0.0, 0.1, 0.2, -0.1, 0.2}, t[] = {0.0, 1.0};
  for (int k = 0; k < 3; k++) {
    mpm_scene s = block_at(0.0);
    const double v[] = {speeds[k], speeds[k]};
    mps_signal *down = NULL;
    mps_body *body = NULL;
    mps_body_def def = mps_body_defaults();
    def.position[0] = 0.1, def.position[1] = 0.105;
    mps_assert_ok(context,
                  mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v, &down));
    mps_assert_ok(context, mps_body_create_polygon(context, &def, 3, wedge, &body));
    mps_assert_ok(context, mps_body_drive(body, 1, down, -1.0));
    mpm_scene_contact(&s, body, 0.0);
    assert_true(mps_mpm_limit(s.mpm) <= 0.02 / speeds[k] * (1.0 + 1e-12));
    mps_status status = MPS_OK;
    for (int step = 0; step < 400 && status == MPS_OK; step++) {
      assert_true(deepest_in(&s, body) <= 0.02);
      status = mps_mpm_step(s.mpm, 1);
    }
    if (status == MPS_OK) { /* all are aside */
      mps_assert_near(deepest_in(&s, body), 0.0, 0.0);
    } else if (strstr(mps_context_error(context)->message, "below the surface of body 0")) {
      assert_true(mps_context_error(context)->particle >= 0);
      mps_assert_fails(context, mps_mpm_step(s.mpm, 1), MPS_ERROR_DIVERGED,
                       "below"); /* as before */
    } else { /* or is pressed to nothing between the wedge and the floor, or through it */
      const char *why = mps_context_error(context)->message;
      assert_true(strstr(why, "has no volume") || strstr(why, "has left the domain"));
    }
    mps_signal_destroy(&down);
    mps_body_destroy(&body);
    mpm_scene_end(&s);
  }
}

/* A disc of 1 kg over a block in axisymmetry: forces along r and moments cancel around the ring.
 */
static void free_bodies_stay_on_the_axis(void **state) {
  (void)state;
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.1);
  mps_mpm_def def = mps_mpm_defaults();
  def.geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC;
  def.cell = 0.02;
  def.lower[1] = 0.0;
  mpm_scene_solve(&s, &def);
  const struct {
    double sideways, spin, gravity, load;
    const char *refusal; /* NULL: none */
  } list[] = {{0.1, 0.0, 0.0, 0.0, "velocity[0] is 0.1 m/s"},
              {0.0, 2.0, 0.0, 0.0, "spin[2] 2 rad/s"},
              {0.0, 0.0, -9.81, 0.0, "gravity[0] -9.81 m/s2"},
              {0.0, 0.0, 0.0, 5.0, "force[0] 5 N"},
              {0.0, 0.0, 0.0, 0.0, NULL}};
  mps_body *body = NULL;
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    mps_body_def free_def = mps_body_defaults();
    const double force[3] = {list[k].load, 0.0, 0.0};
    free_def.motion = MPS_BODY_MOTION_FREE;
    free_def.position[1] = 0.16;
    free_def.mass = 1.0, free_def.inertia[2] = 0.01;
    free_def.velocity[0] = list[k].sideways, free_def.velocity[1] = -1.0;
    free_def.spin[2] = list[k].spin;
    free_def.gravity[0] = list[k].gravity, free_def.gravity[1] = -9.81;
    mps_body_destroy(&body);
    mps_assert_ok(context, mps_body_create_disc(context, &free_def, 0.05, &body));
    mps_assert_ok(context, mps_body_set_load(body, force, NULL));
    const mps_contact_def contact = mps_contact_defaults();
    if (list[k].refusal)
      REFUSES(list[k].refusal, mps_mpm_add_contact(s.mpm, body, &contact, NULL));
    else
      mps_assert_ok(context, mps_mpm_add_contact(s.mpm, body, &contact, NULL));
  }
  const double sideways[3] = {1.0, 0.0, 0.0};
  mps_body_motion motion = mps_body_motion_defaults();
  motion.spin[2] = 1.0;
  REFUSES("force[0] is 1 N", mps_body_set_load(body, sideways, NULL));
  REFUSES("spin[2] 1 rad/s", mps_body_set_motion(body, &motion));
  mpm_scene plane = block_at(0.0);
  const mps_contact_def contact = mps_contact_defaults();
  REFUSES("another solver, which is axisymmetric",
          mps_mpm_add_contact(plane.mpm, body, &contact, NULL));
  tank t = tank_make(context, 0.6, 0.3, 0.03, NULL, 2e-3);
  mps_body *lid = box_at(0.0, 0.3, 0.2, 0.1);
  mps_assert_ok(context, mps_mpm_add_contact(s.mpm, lid, &contact, NULL));
  REFUSES("another solver, which is axisymmetric", mps_fluid_add_contact(t.fluid, lid, NULL, NULL));
  mps_body_destroy(&lid);
  tank_free(&t);
  mps_body_state now;
  mps_assert_ok(context, mps_mpm_run(s.mpm, 0.05, 100000, NULL, NULL));
  mps_assert_ok(context, mps_body_get_state(body, &now));
  mps_assert_near(now.position[0], 0.0, 0.0);
  mps_assert_near(now.rotation[2], 0.0, 0.0);
  assert_true(now.velocity[1] > -0.5); /* falling freely it would have -1.5 m/s */
  mpm_scene_end(&plane);
  mpm_scene_end(&s);
  mps_assert_ok(context, mps_body_set_load(body, sideways, NULL)); /* on no axis any more */
  mps_body_destroy(&body);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bad_definitions),
                                     cmocka_unit_test(tells_who_touches),
                                     cmocka_unit_test(bodies_are_shared),
                                     cmocka_unit_test(servo_keeps_a_force),
                                     cmocka_unit_test(thin_plates_are_refused),
                                     cmocka_unit_test(wedges_are_no_walls),
                                     cmocka_unit_test(covered_particles_are_refused),
                                     cmocka_unit_test(driven_too_deep_is_told),
                                     cmocka_unit_test(free_bodies_stay_on_the_axis)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
