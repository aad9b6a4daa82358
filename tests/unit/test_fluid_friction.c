/* test_fluid_friction.c - friction of faces in still water, at bodies, in snapshots; definitions
 * that are refused. SPDX-License-Identifier: BSD-3-Clause */
#include "digest.h"
#include "fluid_tank.h"
#include "test_fixture.h"

#define L0 0.05
#define LENGTH 2.0 /* m, 40 L0 */

static mps_particles *water;
static mps_fluid *fluid;

/* A tank of still water, 40 x 10 particles, but for a hole where a body is. */
static void fill(const double *hole) {
  USING(particles, mps_particles_create(context, &given, &water), .spacing = L0);
  for (int i = 0; i < 40; i++)
    for (int j = 0; j < 10; j++) {
      const double x[2] = {(i + 0.5) * L0, (j + 0.5) * L0};
      if (hole && x[0] > hole[0] && x[0] < hole[2] && x[1] > hole[1] && x[1] < hole[3]) continue;
      OK(mps_particles_append(water, 1, x));
    }
  USING(fluid, mps_fluid_create(context, water, &given, &fluid), .dt = 2e-3, .level = 10.0 * L0);
}

static void add_walls(double friction) {
  const double wall[3][3] = {{0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}, {LENGTH, -1.0, 0.0}};
  for (int k = 0; k < 3; k++)
    USING(fluid_boundary, mps_fluid_add_boundary(fluid, &given, NULL), .kind = MPS_BOUNDARY_ROLLER,
          .point[0] = wall[k][0], .normal[0] = wall[k][1], .normal[1] = wall[k][2],
          .friction_factor = friction);
}

static int drop(void **state) {
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
  return 0;
}

static uint64_t digest(void) {
  static const char *const names[] = {"id", "position", "velocity", "pressure", NULL};
  return digest_fields(water, names);
}

static double fastest(void) {
  const mps_view u = view_field(water, "velocity");
  double most = 0.0;
  for (int64_t i = 0; i < u.shape[0]; i++)
    most = fmax(most, hypot(*mps_view_f64(&u, i, 0), *mps_view_f64(&u, i, 1)));
  return most;
}

TEST_EACH(still_water_stays_still, NULL, drop) {
  const double factor[3] = {0.0, 0.01, 1e6};
  for (int k = 0; k < 3; k++) {
    fill(NULL);
    add_walls(factor[k]);
    OK(mps_fluid_step(fluid, 100));
    printf("f %g: %.2g m/s after 100 steps\n", factor[k], fastest());
    NEAR(fastest(), 0.0, 1e-9);
    drop(NULL);
  }
}

static void push(double speed) { OK(mps_particles_set(water, "velocity", 0, speed)); }

TEST_EACH(a_run_that_is_rolled_back_is_the_same, NULL, drop) {
  mps_reaction first, again;
  scoped_snapshot *kept = NULL;
  fill(NULL);
  add_walls(0.1);
  push(0.5);
  OK(mps_fluid_step(fluid, 10));
  OK(mps_fluid_snapshot(fluid, &kept));
  OK(mps_fluid_step(fluid, 20));
  const uint64_t hash = digest();
  OK(mps_fluid_get_reaction(fluid, 0, &first));
  OK(mps_fluid_rollback(fluid, kept));
  OK(mps_fluid_step(fluid, 20));
  OK(mps_fluid_get_reaction(fluid, 0, &again));
  assert_true(hash == digest());
  assert_memory_equal(&first, &again, sizeof first);
  assert_true(first.force[0] < 0.0); /* against the water */
}

/* The bed's segment of a tank of one polyline has the friction that a plane bed has. */
TEST_EACH(segments_have_their_friction, NULL, drop) {
  const double corner[4][3] = {{0.0, 2.0, 0.0}, {0.0}, {LENGTH, 0.0, 0.0}, {LENGTH, 2.0, 0.0}};
  double force[9], moment[3];
  int64_t count = 0;
  mps_reaction plane, line;
  fill(NULL);
  add_walls(0.1);
  push(0.5);
  OK(mps_fluid_step(fluid, 1));
  OK(mps_fluid_get_reaction(fluid, 0, &plane));
  drop(NULL);
  fill(NULL);
  USING(fluid_boundary, mps_fluid_add_boundary(fluid, &given, NULL), .kind = MPS_BOUNDARY_ROLLER,
        .corners = corner[0], .corner_count = 4, .friction_factor = 0.1);
  push(0.5);
  OK(mps_fluid_step(fluid, 1));
  OK(mps_fluid_get_reaction(fluid, 0, &line));
  OK(mps_fluid_get_segments(fluid, 0, 3, &count, force, moment));
  assert_true(plane.force[0] < 0.0);
  NEAR(force[3] / plane.force[0], 1.0, 0.01);
  for (int c = 0; c < 2; c++)
    NEAR((force[c] + force[3 + c] + force[6 + c]) / line.force[c], 1.0, 1e-9);
  NEAR((moment[0] + moment[1] + moment[2]) / line.moment[2], 1.0, 1e-9);
}

/* ---- bodies ---------------------------------------------------------------------------------- */

/* What is missing in the budget of momentum along x, of a box and the boundaries up to `walls`. */
static double missing(const mps_contact *box, int32_t walls, double before) {
  mps_totals totals;
  mps_reaction r;
  OK(mps_fluid_get_totals(fluid, &totals));
  OK(mps_contact_get_reaction(box, -1, &r));
  double rest =
      totals.linear[0] - before - totals.impulse_loads[0] - totals.impulse_scheme[0] + r.impulse[0];
  for (int32_t k = 0; k < walls; k++) {
    OK(mps_fluid_get_reaction(fluid, k, &r));
    rest -= r.impulse[0];
  }
  return rest;
}

static void displace(double by) {
  uint64_t state = 7;
  EDIT(x, water, "position")
    for (int64_t i = 0; i < x.view.shape[0]; i++)
      for (int c = 0; c < 2; c++) {
        state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        *mps_edit_f64(&x, i, c) += by * ((double)(state >> 11) * 0x1p-52 - 1.0);
      }
}

/* A bed that is the top of a body between two walls moves along itself with V: the body feels
 * 1/2 rho f V^2 for each metre between them, and the water the opposite, whatever its lattice. */
static void drag(double V, double by) {
  const double xy[8] = {-2.0, -0.5, 2.0, -0.5, 2.0, 0.5, -2.0, 0.5}, f = 0.1, dt = 1e-5;
  const double wall[2][2] = {{0.0, 1.0}, {LENGTH, -1.0}};
  mps_reaction box;
  mps_totals totals;
  scoped_body *body = NULL;
  scoped_contact *contact = NULL;
  fill(NULL);
  OK(mps_fluid_set_dt(fluid, dt));
  for (int k = 0; k < 2; k++) tank_wall(fluid, wall[k][0], 0.0, wall[k][1], 0.0, NULL);
  USING(body, mps_body_create_polygon(context, &given, 4, xy, &body), .position[0] = 1.0,
        .position[1] = -0.5);
  USING(fluid_contact, mps_fluid_add_contact(fluid, body, &given, &contact),
        .kind = MPS_BOUNDARY_ROLLER, .friction_factor = f, .mover = MPS_CONTACT_MOVER_OTHER);
  if (by > 0.0) displace(by);
  WITH_DEFAULTS(mps_body_motion, motion, .velocity[0] = V);
  OK(mps_body_set_motion(body, &motion));
  OK(mps_fluid_step(fluid, 1));
  OK(mps_contact_get_reaction(contact, -1, &box));
  OK(mps_fluid_get_totals(fluid, &totals));
  const double drag = -500.0 * f * V * fabs(V) * LENGTH;
  printf("V %+g, displaced %g: force %.4f of %.4f N\n", V, by, box.force[0], drag);
  NEAR(box.force[0] / drag, 1.0, 1e-3);
  if (by == 0.0) NEAR(box.moment[2] / (-0.5 * drag), 1.0, 1e-3);
  NEAR(missing(contact, 2, 0.0) / (drag * dt), 0.0, 1e-9);
  NEAR(totals.work_bodies + totals.work_boundaries, -drag * V * dt, 1e-3 * fabs(drag * V * dt));
  mps_contact_destroy(&contact);
  drop(NULL);
}

TEST(a_bed_that_moves_drags_the_water) {
  for (int way = -1; way <= 1; way += 2) {
    drag(0.5 * way, 0.0);
    drag(2.0 * way, 0.0);
    drag(2.0 * way, 0.2 * L0);
  }
}

/* A box afloat, .5 m long, that is given a speed: with friction of any size it slows, more than
 * without and never to turn, though it weighs less than the layer of particles around it. */
static void slow(double mass, double draught, double *without) {
  const double hole[4] = {0.75, 0.5 - draught, 1.25, 1.0}, factor[4] = {0.0, 1.0, 100.0, 1e6};
  const double xy[8] = {-0.25, 0.0, 0.25, 0.0, 0.25, 0.4, -0.25, 0.4};
  for (int k = 0; k < 4; k++) {
    scoped_body *body = NULL;
    scoped_contact *contact = NULL;
    mps_body_state now = {.velocity = {0.5}};
    fill(hole);
    add_walls(0.0);
    USING(body, mps_body_create_polygon(context, &given, 4, xy, &body),
          .motion = MPS_BODY_MOTION_FREE, .position[0] = 1.0, .position[1] = 0.5 - draught,
          .mass = mass, .inertia[2] = 0.08 * mass, .gravity[1] = -9.81, .velocity[0] = 0.5);
    USING(fluid_contact, mps_fluid_add_contact(fluid, body, &given, &contact),
          .kind = MPS_BOUNDARY_ROLLER, .friction_factor = factor[k]);
    for (int n = 0; n < 5; n++) {
      const double before = now.velocity[0];
      OK(mps_fluid_step(fluid, 10));
      OK(mps_body_get_state(body, &now));
      assert_true(now.velocity[0] < before && now.velocity[0] > 0.0);
      if (k == 0) without[n] = now.velocity[0];
      if (k > 0) assert_true(now.velocity[0] < without[n]);
    }
    printf("box of %g kg, f %g: %.4f m/s\n", mass, factor[k], now.velocity[0]);
    NEAR(missing(contact, 3, 0.0), 0.0, 1e-9 * mass);
    mps_contact_destroy(&contact);
    drop(NULL);
  }
}

TEST_EACH(a_box_afloat_slows_by_friction, NULL, drop) {
  double without[5];
  slow(100.0, 0.2, without);
  slow(20.0, 0.05, without);
}

/* ---- definitions ----------------------------------------------------------------------------- */

TEST_EACH(wrong_factors_are_refused, NULL, drop) {
  const double wrong[4] = {-0.01, NAN, INFINITY, 1e7};
  scoped_body *body = NULL;
  fill(NULL);
  DEF(fluid_boundary, wall, .kind = MPS_BOUNDARY_ROLLER, .normal[1] = 1.0);
  USING(body, mps_body_create_box(context, &given, 0.5, 0.2, &body), .position[1] = 3.0);
  for (int k = 0; k < 4; k++) {
    wall.friction_factor = wrong[k];
    REFUSES(mps_fluid_add_boundary(fluid, &wall, NULL), "friction_factor is ");
    DEF(fluid_contact, def, .friction_factor = wrong[k]);
    REFUSES(mps_fluid_add_contact(fluid, body, &def, NULL), "friction_factor is ");
  }
  wall.friction_factor = 0.01, wall.kind = MPS_BOUNDARY_OPEN;
  REFUSES(mps_fluid_add_boundary(fluid, &wall, NULL), "friction_factor");
}
