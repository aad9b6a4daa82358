/* test_contact.c - contacts of the WLS-MPM solver with bodies: the handle, bodies that several
 * solvers share, and what must not pass without a word: thin walls, particles inside, bodies driven
 * through the ground.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/contact_internal.h"
#include "fluid_tank.h"
#include "mpm_scene.h"
#include "test_fixture.h"

/* A block 0.2 x 0.1 m in cells of 0.02 m, its lower side on y = 0. */
static mpm_scene block_at(double x) {
  mpm_scene s = mpm_scene_begin(context, 0.01, x, 0.0, 1e5);
  mpm_scene_box(&s, x, 0.0, x + 0.2, 0.1);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .origin[0] = x, .lower[1] = 0.0);
  return s;
}

static mps_body *box_at(double x, double y, double width, double height) {
  DEF(body, def, .position[0] = x, .position[1] = y);
  MAKE_KEPT(body, body, create_box, context, &def, width, height);
  return body;
}

/* Pressed by 1 mm: the particles in contact, each with its gap, normal and force by the penalty. */
TEST(tells_who_touches) {
  mpm_scene s = block_at(0.0);
  scoped_body *plate = box_at(0.1, 0.149, 0.4, 0.1);
  DEF(contact, def, .method = MPS_CONTACT_METHOD_PENALTY, .penalty = 5e4);
  scoped_contact *contact = NULL;
  OK(mps_mpm_add_contact(s.mpm, plate, &def, &contact));
  assert_ptr_equal(contact->body, plate);
  int64_t count = 0, ids[32];
  double gap[32], normal[96], force[96], foot[96], sum = 0.0;
  OK(mps_contact_get_particles(contact, 0, &count, NULL, NULL, NULL, NULL, NULL));
  assert_int_equal(count, 20); /* the upper row */
  OK(mps_contact_get_particles(contact, 32, &count, ids, gap, normal, force, foot));
  for (int64_t k = 0; k < count; k++) {
    NEAR(gap[k], -0.001, 1e-15);
    NEAR(normal[3 * k + 1], -1.0, 0.0);
    NEAR(force[3 * k + 1], -50.0, 1e-10);
    NEAR(foot[3 * k + 1], 0.099, 1e-15);
    assert_true(mps_particles_index(s.particles, ids[k]) >= 0);
    sum += force[3 * k + 1];
  }
  OK(mps_mpm_step(s.mpm, 1));
  mps_reaction r, body;
  OK(mps_contact_get_reaction(contact, -1, &r));
  NEAR(r.force[1], -sum, 1e-9);
  assert_int_equal(r.count, 20);
  OK(mps_body_get_reaction(plate, 0, &body));
  assert_memory_equal(&r, &body, sizeof r);
  REFUSES(mps_contact_get_reaction(contact, 1, &r), "part is 1");
  /* its end: no contact is left, and the body is the caller's */
  mps_contact_destroy(&contact);
  assert_null(contact);
  OK(mps_mpm_step(s.mpm, 5));
  OK(mps_body_get_reaction(plate, -1, &r));
  NEAR(r.impulse[1], body.impulse[1], 0.0);
  OK(mps_body_advance(plate, 0.1));
  /* the solver goes first: the handle still returns values */
  OK(mps_mpm_add_contact(s.mpm, plate, &def, &contact));
  mpm_scene_end(&s);
  OK(mps_contact_get_reaction(contact, -1, &r));
  FAILS(mps_contact_get_particles(contact, 0, &count, NULL, NULL, NULL, NULL, NULL),
        MPS_ERROR_STATE, "has ended");
}

/* A beam lies free on two blocks of two solvers: it feels both, and momentum is kept. */
TEST(bodies_are_shared) {
  mpm_scene s[2] = {block_at(0.0), block_at(0.5)};
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE, .mass = 40.0, .inertia[2] = 4.0,
      .position[0] = 0.35, .position[1] = 0.151, .velocity[1] = -0.5);
  mps_contact *contact[2];
  MAKE(body, beam, create_box, context, &def, 1.2, 0.1);
  DEF(contact, other, .mover = MPS_CONTACT_MOVER_OTHER);
  for (int k = 0; k < 2; k++) {
    OK(mps_mpm_remove_boundary(s[k].mpm, MPS_SIDE_Y_LOWER));
    OK(mps_mpm_add_contact(s[k].mpm, beam, k ? &other : NULL, &contact[k]));
  }
  const double dt = 0.4 * mps_mpm_limit(s[0].mpm);
  for (int step = 0; step < 100; step++)
    for (int k = 1; k >= 0; k--) OK(mps_mpm_run(s[k].mpm, (step + 1) * dt, 1, NULL, NULL));
  mps_reaction part[2], all;
  OK(mps_body_get_reaction(beam, -1, &all));
  for (int k = 0; k < 2; k++) {
    OK(mps_contact_get_reaction(contact[k], -1, &part[k]));
    assert_true(part[k].impulse[1] > 1.0);
  }
  NEAR(part[0].impulse[1] + part[1].impulse[1], all.impulse[1], 1e-12);
  NEAR(part[0].force[1] + part[1].force[1], all.force[1], 1e-9);
  /* equal but for the order in which the solvers stop the beam */
  NEAR(part[0].impulse[1], part[1].impulse[1], 2e-3 * part[0].impulse[1]);
  mps_body_totals beam_now;
  OK(mps_body_get_totals(beam, &beam_now));
  const double sum = mpm_scene_totals(&s[0]).linear[1] + mpm_scene_totals(&s[1]).linear[1];
  NEAR(sum + beam_now.linear[1], -0.5 * 40.0, 1e-10);
  NEAR(beam_now.kinetic - beam_now.work_contacts, 0.5 * 40.0 * 0.25, 1e-10);
  for (int k = 0; k < 2; k++) {
    mpm_scene_end(&s[k]);
    mps_contact_destroy(&contact[k]);
  }
}

/* A servo: the plate's speed is set by the force on it, until that is what was requested. */
TEST(servo_keeps_a_force) {
  scoped_mpm_scene s = block_at(0.0);
  scoped_body *plate = box_at(0.1, 0.15, 0.4, 0.1);
  mpm_scene_contact(&s, plate, 0.0);
  const double wanted = 100.0;
  double mean = 0.0;
  mps_reaction r;
  for (int step = 0; step < 6000; step++) {
    OK(mps_body_get_reaction(plate, -1, &r));
    mean += 0.01 * (r.force[1] - mean);
    WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = -1e-4 * (wanted - mean));
    OK(mps_body_set_motion(plate, &motion));
    OK(mps_mpm_step(s.mpm, 1));
  }
  print_message("servo: mean force %.4g N of %.4g\n", mean, wanted);
  NEAR(mean, wanted, 0.02 * wanted);
}

/* A wedge of 30 degrees has a tip and no thin wall: driven a cell and a half into the block it
 * splits the particles, evenly to both sides, and keeps them out. One of 15 degrees is an edge that
 * leaks by springs. */
TEST(wedges_are_no_walls) {
  scoped_mpm_scene s = block_at(0.0);
  scoped_body *wedge = NULL;
  const double t[] = {0.0, 0.04}, way[] = {0.0, -0.04}; /* s, m */
  DEF(body, def, .position[0] = 0.1, .position[1] = 0.11);
  for (int k = 0; k < 2; k++) {
    const double half = 0.2 * tan((k ? 15.0 : 7.5) * atan(1.0) / 45.0);
    const double xy[] = {0.0, 0.0, half, 0.2, -half, 0.2};
    mps_body_destroy(&wedge);
    OK(mps_body_create_polygon(context, &def, 3, xy, &wedge));
    DEF(contact, springs, .method = MPS_CONTACT_METHOD_PENALTY);
    if (!k)
      REFUSES(mps_mpm_add_contact(s.mpm, wedge, &springs, NULL), "meet at less than 20 degrees");
  }
  MAKE(signal, down, create_table, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 2, t, way);
  OK(mps_body_drive(wedge, 1, down, 1.0));
  OK(mps_mpm_add_contact(s.mpm, wedge, NULL, NULL));
  OK(mps_mpm_run(s.mpm, 0.04, 1, NULL, NULL));
  const mps_view x = mpm_scene_view(&s, "position");
  double sum = 0.0, across = 0.0;
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const double at[] = {*mps_view_f64(&x, i, 0), *mps_view_f64(&x, i, 1)};
    double distance;
    OK(mps_body_distance(wedge, 1, at, &distance, NULL, NULL, NULL));
    assert_true(distance > 0.0);
    sum += at[0] - 0.1;
    across += fabs(at[0] - 0.1);
  }
  assert_true(fabs(sum) < 0.01 * across);
}

/* Plates of 0.6 and 0.9 cells, between nodes or not: by springs all momentum would pass. */
TEST(thin_plates_are_refused) {
  scoped_mpm_scene s = block_at(0.0);
  const double cells[] = {0.6, 0.9};
  for (int k = 0; k < 2; k++) {
    scoped_body *plate = box_at(0.3, 0.05, cells[k] * 0.02, 0.5);
    DEF(contact, def, .method = MPS_CONTACT_METHOD_PENALTY);
    REFUSES(mps_mpm_add_contact(s.mpm, plate, &def, NULL), "below 2 cells momentum passes");
    def.thin = 1;
    OK(mps_mpm_add_contact(s.mpm, plate, &def, NULL));
    mps_mpm_destroy(&s.mpm);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02);
  }
}

TEST(covered_particles_are_refused) {
  scoped_mpm_scene s = block_at(0.0);
  scoped_body *box = box_at(0.1, 0.05, 0.06, 0.06);
  mps_contact *over = NULL; /* before the first step only that refuses: the state may be restored */
  OK(mps_mpm_add_contact(s.mpm, box, NULL, &over));
  REFUSES(mps_mpm_step(s.mpm, 1), "36 particles lie inside the body");
  assert_true(mps_context_error(context)->particle >= 0);
  mps_contact_destroy(&over);
  OK(mps_mpm_step(s.mpm, 1));
  REFUSES(mps_mpm_add_contact(s.mpm, box, NULL, NULL), "36 particles lie inside the body");
  assert_true(mps_context_error(context)->particle >= 0);
  USING(contact, mps_mpm_add_contact(s.mpm, box, &given, NULL), .inside = MPS_CONTACT_INSIDE_PUSH);
}

/* How deep a particle is below the surface of a body at most, m. */
static double deepest_in(mpm_scene *s, mps_body *body) {
  mps_view x = mpm_scene_view(s, "position");
  double deepest = 0.0;
  for (int64_t p = 0; p < x.shape[0]; p++) {
    const double at[2] = {*mps_view_f64(&x, p, 0), *mps_view_f64(&x, p, 1)};
    double distance;
    OK(mps_body_distance(body, 1, at, &distance, NULL, NULL, NULL));
    deepest = fmax(deepest, -distance);
  }
  return deepest;
}

/* A wedge through soil and floor at any speed: the step follows it, and the soil gives way to it;
 * where it cannot, the run stops. */
TEST(driven_too_deep_is_told) {
  const double speeds[] = {30.0, 1000.0, 1e5};
  const double wedge[] = {0.0, 0.0, 0.1, 0.2, -0.1, 0.2}, t[] = {0.0, 1.0};
  for (int k = 0; k < 3; k++) {
    scoped_mpm_scene s = block_at(0.0);
    const double v[] = {speeds[k], speeds[k]};
    scoped_body *body = NULL;
    DEF(body, def, .position[0] = 0.1, .position[1] = 0.105);
    MAKE(signal, down, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v);
    OK(mps_body_create_polygon(context, &def, 3, wedge, &body));
    OK(mps_body_drive(body, 1, down, -1.0));
    mpm_scene_contact(&s, body, 0.0);
    assert_true(mps_mpm_limit(s.mpm) <= 0.02 / speeds[k] * (1.0 + 1e-12));
    mps_status status = MPS_OK;
    for (int step = 0; step < 400 && status == MPS_OK; step++) {
      assert_true(deepest_in(&s, body) <= 0.02);
      status = mps_mpm_step(s.mpm, 1);
    }
    if (status == MPS_OK) { /* all are aside */
      NEAR(deepest_in(&s, body), 0.0, 0.0);
    } else if (strstr(mps_context_error(context)->message, "below the surface of body 0")) {
      assert_true(mps_context_error(context)->particle >= 0);
      FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_DIVERGED, "below"); /* as before */
    } else { /* or is pressed to nothing between the wedge and the floor, or through it */
      const char *why = mps_context_error(context)->message;
      assert_true(strstr(why, "has no volume") || strstr(why, "has left the domain"));
    }
  }
}

/* A disc of 1 kg over a block in axisymmetry: forces along r and moments cancel around the ring.
 */
TEST(free_bodies_stay_on_the_axis) {
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.1);
  DEF(mpm, def, .geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC, .cell = 0.02, .lower[1] = 0.0);
  mpm_scene_solve(&s, &def);
  const struct {
    double sideways, spin, gravity, load;
    const char *refusal; /* NULL: none */
  } list[] = {{0.1, 0.0, 0.0, 0.0, "velocity[0] is 0.1 m/s"},
              {0.0, 2.0, 0.0, 0.0, "spin[2] 2 rad/s"},
              {0.0, 0.0, -9.81, 0.0, "gravity[0] -9.81 m/s2"},
              {0.0, 0.0, 0.0, 5.0, "force[0] 5 N"},
              {0.0, 0.0, 0.0, 0.0, NULL}};
  scoped_body *body = NULL;
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    DEF(body, free_def, .motion = MPS_BODY_MOTION_FREE, .position[1] = 0.16, .mass = 1.0,
        .inertia[2] = 0.01);
    const double force[3] = {list[k].load, 0.0, 0.0};
    free_def.velocity[0] = list[k].sideways, free_def.velocity[1] = -1.0;
    free_def.spin[2] = list[k].spin;
    free_def.gravity[0] = list[k].gravity, free_def.gravity[1] = -9.81;
    mps_body_destroy(&body);
    OK(mps_body_create_disc(context, &free_def, 0.05, &body));
    OK(mps_body_set_load(body, force, NULL));
    const mps_contact_def contact = mps_contact_defaults();
    if (list[k].refusal)
      REFUSES(mps_mpm_add_contact(s.mpm, body, &contact, NULL), list[k].refusal);
    else
      OK(mps_mpm_add_contact(s.mpm, body, &contact, NULL));
  }
  const double sideways[3] = {1.0, 0.0, 0.0};
  WITH_DEFAULTS(mps_body_motion, motion, .spin[2] = 1.0);
  REFUSES(mps_body_set_load(body, sideways, NULL), "force[0] is 1 N");
  REFUSES(mps_body_set_motion(body, &motion), "spin[2] 1 rad/s");
  mpm_scene plane = block_at(0.0);
  const mps_contact_def contact = mps_contact_defaults();
  REFUSES(mps_mpm_add_contact(plane.mpm, body, &contact, NULL),
          "another solver, which is axisymmetric");
  tank t = tank_make(context, 0.6, 0.3, 0.03, NULL, 2e-3);
  scoped_body *lid = box_at(0.0, 0.3, 0.2, 0.1);
  OK(mps_mpm_add_contact(s.mpm, lid, &contact, NULL));
  REFUSES(mps_fluid_add_contact(t.fluid, lid, NULL, NULL), "another solver, which is axisymmetric");
  tank_free(&t);
  mps_body_state now;
  OK(mps_mpm_run(s.mpm, 0.05, 100000, NULL, NULL));
  OK(mps_body_get_state(body, &now));
  NEAR(now.position[0], 0.0, 0.0);
  NEAR(now.rotation[2], 0.0, 0.0);
  assert_true(now.velocity[1] > -0.5); /* falling freely it would have -1.5 m/s */
  mpm_scene_end(&plane);
  mpm_scene_end(&s);
  OK(mps_body_set_load(body, sideways, NULL)); /* on no axis any more */
}
