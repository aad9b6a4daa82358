/* test_mpm_settle.c - damping of WLS-MPM leaves reactions right and books what it takes; ground
 * settles under its weight to what theory and a slow loading say, in fewer steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/same.h"
#include "mpm_scene.h"
#include "test_fixture.h"

static double mean_of(mpm_scene *s, const char *field, int c) {
  mps_view v = mpm_scene_view(s, field);
  double sum = 0.0;
  for (int64_t k = 0; k < v.shape[0]; k++) sum += *mps_view_f64(&v, k, c);
  return sum / (double)v.shape[0];
}

static mps_mpm_energy_report losses(mpm_scene *s) {
  mps_mpm_energy_report l;
  OK(mps_mpm_get_energy_report(s->mpm, &l));
  return l;
}

/* ---- damping --------------------------------------------------------------------------------- */

/* Free fall: with local damping of 0.3 at 0.7 g; with viscous damping the velocity of the implicit
 * step, (v + g dt)/(1 + c dt), on its way to g/c. What damping takes is booked. */
TEST(damped_fall) {
  for (int viscous = 0; viscous <= 1; viscous++) {
    const double g = 10.0, rate = 40.0, dt = 1e-4;
    scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
    mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .dt = dt, .gravity[1] = -g, .budget = 1,
          .local_damping = viscous ? 0.0 : 0.3, .viscous_damping = viscous ? rate : 0.0);
    OK(mps_mpm_step(s.mpm, 500));
    double v = 0.0, taken = 0.0;
    for (int k = 0; k < 500; k++) {
      const double to = viscous ? (v + g * dt) / (1.0 + rate * dt) : v + 0.7 * g * dt;
      taken += 10.0 * (v + g * dt - to) * to;
      v = to;
    }
    NEAR(mean_of(&s, "velocity", 1), -v, 1e-12);
    const mps_mpm_energy_report l = losses(&s);
    NEAR(l.damping, taken, 1e-11);
    NEAR(l.residual, 0.0, 1e-12);
    if (viscous) assert_true(v > 0.8 * g / rate && v < g / rate);
  }
}

/* A block comes to rest on a fixed floor, between rollers or driven ahead by a box of nodes: the
 * floor bears the weight whatever the damping, and in each step the momentum changes by the forces
 * of boundaries, gravity and damping. */
TEST(floor_bears_the_weight) {
  for (int viscous = 0; viscous <= 1; viscous++) {
    scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
    mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.3);
    USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .gravity[1] = -10.0, .budget = 1,
          .lower[0] = given.lower[1] = 0.0, .upper[0] = 0.2, .local_damping = viscous ? 0.0 : 0.7,
          .viscous_damping = viscous ? 30.0 : 0.0);
    mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
    OK(mps_mpm_step(s.mpm, 4000));
    double force[3];
    mpm_scene_force(&s, MPS_SIDE_Y_LOWER, force);
    const mps_mpm_energy_report l = losses(&s);
    print_message("%s damping: floor bears %.9g of 600 N, damping took %.4g J\n",
                  viscous ? "viscous" : "local", force[1], l.damping);
    NEAR(fabs(force[1]), 600.0, viscous ? 1e-3 : 1e-6);
    assert_true(l.damping > 0.0 && fabs(l.residual) < 1e-12 * l.damping * 100.0);
  }
}

/* What a boundary drives is not damped: a box of nodes keeps its velocity, and so do the particles
 * well inside it. */
TEST(driven_nodes_are_not_damped) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.2);
  DEF(mpm, def, .cell = 0.02, .local_damping = 0.8, .viscous_damping = 100.0);
  mpm_scene_solve(&s, &def);
  const double t[] = {0.0, 1.0}, v[] = {0.3, 0.3}, low[] = {-1.0, -1.0}, high[] = {1.0, 1.0};
  MAKE(signal, go, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v);
  const mps_mpm_boundary_def all = mpm_scene_box_def(s.mpm, low, high, 0, go, 1.0);
  int32_t number;
  OK(mps_mpm_add_boundary(s.mpm, &all, &number));
  OK(mps_mpm_step(s.mpm, 20));
  mps_view velocity = mpm_scene_view(&s, "velocity");
  for (int64_t k = 0; k < velocity.shape[0]; k++) NEAR(*mps_view_f64(&velocity, k, 0), 0.3, 1e-14);
}

TEST(damping_is_checked) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  const double bad[][2] = {{1.0, 0.0}, {-0.1, 0.0}, {NAN, 0.0}, {0.0, -1.0}, {0.0, NAN}};
  for (int k = 0; k < 5; k++) {
    DEF(mpm, def, .cell = 0.02, .local_damping = bad[k][0], .viscous_damping = bad[k][1]);
    REFUSES(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm), "_damping is ");
  }
}

/* ---- settling -------------------------------------------------------------------------------- */

static mpm_scene column(double young, mps_material *law) {
  mpm_scene s = mpm_scene_begin(context, 0.025, 0.0, 0.0, young);
  if (law) {
    mps_material_destroy(&s.material);
    s.material = law;
  }
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 1.0);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.05, .gravity[1] = -10.0, .budget = 1,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = 0.2);
  return s;
}

/* A column between rollers: its middle sinks by rho g (H y - y^2/2)/M on average, the floor bears
 * the weight; the time stands still; the budget closes. */
TEST(column_settles) {
  const double young = 1e7, M = young * 0.7 / (1.3 * 0.4), g = 10.0, rho = 1000.0;
  scoped_mpm_scene s = column(young, NULL);
  const double before = mean_of(&s, "position", 1);
  DEF(mpm_settle, def, .tolerance = 1e-6);
  mps_mpm_settled out;
  OK(mps_mpm_settle(s.mpm, &def, &out));
  const double sunk = before - mean_of(&s, "position", 1), theory = rho * g / (3.0 * M);
  double force[3];
  mpm_scene_force(&s, MPS_SIDE_Y_LOWER, force);
  const mps_mpm_energy_report l = losses(&s);
  print_message(
      "column: sunk %.6g m, theory %.6g, in %d steps and %d peaks, unbalanced %.2g; floor "
      "bears %.8g of 2000 N\n",
      sunk, theory, (int)out.steps, (int)out.peaks, out.unbalanced, fabs(force[1]));
  NEAR(sunk, theory, 0.005 * theory);
  NEAR(fabs(force[1]), 2000.0, 1e-5 * 2000.0);
  assert_true(out.unbalanced <= 1e-6 && out.steps < 2000 && out.peaks > 1);
  assert_true(mps_mpm_time(s.mpm) == 0.0 && mps_mpm_steps(s.mpm) == out.steps);
  assert_true(mpm_scene_totals(&s).kinetic == 0.0);
  NEAR(l.residual, 0.0, 1e-12 * (l.damping + l.transfer));
  OK(mps_mpm_settle(s.mpm, &def, &out)); /* it is at rest */
  assert_int_equal(out.steps, 1);
  OK(mps_mpm_step(s.mpm, 100)); /* and stays there */
  assert_true(mpm_scene_totals(&s).kinetic < 1e-10 * l.damping);
}

/* Clay that cannot stand flows: no equilibrium, a clear status, the particles at rest, the result
 * written; arguments are checked. */
TEST(flow_does_not_settle) {
  DEF(material_von_mises, weak, .young = 1e7, .yield_stress = 500.0);
  MAKE_KEPT(material, law, create_von_mises, context, &weak);
  scoped_mpm_scene s = mpm_scene_begin(context, 0.025, 0.0, 0.0, 1e7);
  mps_material_destroy(&s.material);
  s.material = law;
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.5);
  DEF(mpm, def, .cell = 0.05, .gravity[1] = -10.0, .lower[0] = def.lower[1] = 0.0);
  mpm_scene_solve(&s, &def);
  DEF(mpm_settle, settle, .max_steps = 200);
  mps_mpm_settled out;
  FAILS(mps_mpm_settle(s.mpm, &settle, &out), MPS_ERROR_NUMERIC, "no equilibrium after 200 steps");
  assert_true(out.steps == 200 && out.unbalanced > 1e-3 && out.applied > 1000.0);
  assert_true(mpm_scene_totals(&s).kinetic == 0.0);
  OK(mps_mpm_step(s.mpm, 1)); /* it continues */
  settle.max_steps = 0;
  REFUSES(mps_mpm_settle(s.mpm, &settle, NULL), "max_steps is 0");
  settle = mps_mpm_settle_defaults();
  settle.tolerance = 0.0;
  REFUSES(mps_mpm_settle(s.mpm, &settle, NULL), "tolerance is 0");
  scoped_body *body = NULL;
  USING(body, mps_body_create_disc(context, &given, 0.1, &body), .motion = MPS_BODY_MOTION_FREE,
        .mass = given.inertia[2] = 1.0, .position[1] = 1.0);
  mpm_scene_contact(&s, body, 0.0);
  FAILS(mps_mpm_settle(s.mpm, NULL, NULL), MPS_ERROR_UNSUPPORTED, "body 0 moves freely");
}

/* ---- a slope --------------------------------------------------------------------------------- */

static mpm_scene slope(double gravity) {
  const double xy[] = {0.0, 0.0, 8.0, 0.0, 8.0, 2.0, 6.0, 2.0, 3.0, 4.0, 0.0, 4.0};
  mpm_scene s = mpm_scene_begin(context, 0.125, 0.0, 0.0, 1e7);
  mps_material_destroy(&s.material);
  USING(material_drucker_prager, mps_material_create_drucker_prager(context, &given, &s.material),
        .young = 2e7, .poisson = 0.3, .friction = 0.45, .cohesion = 6e3);
  OK(mps_particles_fill_polygon(s.particles, 6, xy, NULL));
  OK(mps_particles_add_field(s.particles, "body_acceleration", 0));
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.25, .gravity[1] = -gravity,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = 8.0);
  mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  return s;
}

/* Weight that grows over 5 s, eighty first periods of the slope's height, in 40 steps of it. */
static void load_slowly(mpm_scene *s, double g) {
  for (int k = 1; k <= 200; k++) {
    OK(mps_particles_set(s->particles, "body_acceleration", 1, -g * k / 200.0));
    OK(mps_mpm_run(s->mpm, 0.025 * k, 1, NULL, NULL));
  }
  OK(mps_mpm_run(s->mpm, 6.0, 1, NULL, NULL));
}

/* How far the top has sunk, and the mean of the size of the displacement. */
TEST(slope_settles) {
  scoped_mpm_scene slow = slope(0.0), fast = slope(10.0);
  mps_view x = mpm_scene_view(&slow, "position");
  const double start = mean_of(&slow, "position", 1), aside = mean_of(&slow, "position", 0);
  assert_true(x.shape[0] > 1000);
  load_slowly(&slow, 10.0);
  mps_mpm_settled out;
  OK(mps_mpm_settle(fast.mpm, NULL, &out));
  double sunk[2], moved[2];
  mpm_scene *both[] = {&slow, &fast};
  for (int k = 0; k < 2; k++) {
    sunk[k] = start - mean_of(both[k], "position", 1);
    moved[k] = mean_of(both[k], "position", 0) - aside;
  }
  print_message("slope: sunk %.6g and %.6g m, aside %.4g and %.4g, slowly in %d steps, settled in "
                "%d\n",
                sunk[0], sunk[1], moved[0], moved[1], (int)mps_mpm_steps(slow.mpm), (int)out.steps);
  NEAR(sunk[1], sunk[0], 0.01 * sunk[0]);
  assert_true(4 * out.steps < mps_mpm_steps(slow.mpm));
}

/* ---- between bodies -------------------------------------------------------------------------- */

static mps_body *half_plane(double along, double from, double normal) {
  const double angle = 17.0 * atan(1.0) / 45.0;
  const double n[] = {normal * cos(angle), normal * sin(angle)};
  DEF(body, def, .position[0] = along * cos(angle) + from * n[0],
      .position[1] = along * sin(angle) + from * n[1]);
  MAKE_KEPT(body, body, create_half_plane, context, &def, n);
  return body;
}

/* A block that nothing but two smooth half planes presses, turned by 17 degrees in the grid: it
 * settles, as their impulses are what is applied, to the force of plane stress sideways, E ln(1 -
 * u/w)/(1 - nu^2). */
TEST(block_between_bodies_settles) {
  const double width = 0.1, way = 1e-3, angle = 17.0 * atan(1.0) / 45.0;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e6);
  for (int k = 0; k < 100; k++) {
    const double u = (k % 10 + 0.5) * 0.01, v = (k / 10 + 0.5) * 0.01;
    const double x[] = {u * cos(angle) - v * sin(angle), u * sin(angle) + v * cos(angle)};
    OK(mps_particles_append(s.particles, 1, x));
  }
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .spline = 2);
  mps_body *body[] = {half_plane(0.0, 0.0, 1.0), half_plane(width, 0.0, -1.0)};
  mps_contact *contact[2];
  for (int b = 0; b < 2; b++) OK(mps_mpm_add_contact(s.mpm, body[b], NULL, &contact[b]));
  WITH_DEFAULTS(mps_body_motion, press, .velocity[0] = -0.02 * cos(angle),
                .velocity[1] = -0.02 * sin(angle));
  OK(mps_body_set_motion(body[1], &press));
  OK(mps_mpm_run(s.mpm, way / 0.02, 1, NULL, NULL));
  mps_mpm_settled out;
  OK(mps_mpm_settle(s.mpm, NULL, &out));
  double force[2];
  for (int b = 0; b < 2; b++) {
    mps_reaction r;
    OK(mps_contact_get_reaction(contact[b], -1, &r));
    force[b] = hypot(r.force[0], r.force[1]);
    mps_contact_destroy(&contact[b]);
    mps_body_destroy(&body[b]);
  }
  const double strain = -log(1.0 - way / width), nu = 0.3;
  const double exact = 1e6 / (1.0 - nu * nu) * strain * width * exp(nu / (1.0 - nu) * strain);
  print_message("block between bodies: %.6g and %.6g of %.6g N, applied %.6g N, in %d steps\n",
                force[0], force[1], exact, out.applied, (int)out.steps);
  for (int b = 0; b < 2; b++) NEAR(force[b], exact, 0.015 * exact);
  NEAR(out.applied, force[0] + force[1], 1e-9 * exact);
}

/* ---- a footing ------------------------------------------------------------------------------- */

typedef struct footing {
  mpm_scene s;
  mps_body *strip;
} footing;

static footing make_footing(void) {
  footing f = {.s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e9)};
  DEF(material_von_mises, law, .young = 1e9, .poisson = 0.3, .yield_stress = sqrt(3.0) * 1e4);
  mps_material_destroy(&f.s.material);
  OK(mps_material_create_von_mises(context, &law, &f.s.material));
  mpm_scene_box(&f.s, 0.0, 0.0, 2.0, 1.2);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.1, def.volumetric = MPS_MPM_VOLUMETRIC_POINT; /* the loading is compared */
  def.lower[0] = def.lower[1] = 0.0, def.upper[0] = 2.0;
  mpm_scene_solve(&f.s, &def);
  mpm_scene_side(&f.s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  USING(body, mps_body_create_box(context, &given, 1.0, 0.5, &f.strip), .position[1] = 1.45);
  OK(mps_mpm_add_contact(f.s.mpm, f.strip, NULL, NULL));
  return f;
}

static double pressure(footing *f) {
  mps_reaction r;
  OK(mps_body_get_reaction(f->strip, -1, &r));
  return r.force[1] / (0.5 * 1e4);
}

static void press(footing *f, double speed, double way) {
  WITH_DEFAULTS(mps_body_motion, down, .velocity[1] = -speed);
  OK(mps_body_set_motion(f->strip, &down));
  OK(mps_mpm_run(f->s.mpm, mps_mpm_time(f->s.mpm) + way / speed, 1, NULL, NULL));
}

/* q/c at 0.6 mm: at two speeds, which give the one without inertia (from 1 and 0.5 mm/s to 0.1 %; a
 * quick test has twice the speeds and half a percent); and by settling after each of six small
 * ways. A fast way makes the ground flow further than the footing requires, and leaves less than it
 * can bear. */
TEST(footing_bears) {
  const double slowest = test_quick() ? 1e-3 : 0.5e-3, within = test_quick() ? 0.0125 : 0.01;
  double q[2];
  int64_t steps = 0;
  for (int k = 0; k < 2; k++) {
    footing f = make_footing();
    const double speed = k == 0 ? 2.0 * slowest : slowest;
    press(&f, 0.25 * speed, 0.01e-3);
    press(&f, 0.5 * speed, 0.02e-3);
    press(&f, speed, 0.57e-3);
    q[k] = pressure(&f);
    steps = mps_mpm_steps(f.s.mpm);
    mps_body_destroy(&f.strip);
    mpm_scene_end(&f.s);
  }
  const double slow = 2.0 * q[1] - q[0];
  footing f = make_footing();
  DEF(mpm_settle, def, .tolerance = 2e-3);
  press(&f, 8e-3, 0.48e-3);
  OK(mps_mpm_settle(f.s.mpm, &def, NULL));
  const double rough = pressure(&f);
  for (int k = 0; k < 6; k++) {
    press(&f, 0.75e-3, 0.02e-3);
    OK(mps_mpm_settle(f.s.mpm, &def, NULL));
  }
  const double settled = pressure(&f);
  print_message("footing: q/c %.4f at %g mm/s, %.4f at half of it, so %.4f without inertia in %d "
                "steps; settled %.4f in %d (after one fast way %.4f)\n",
                q[0], 2e3 * slowest, q[1], slow, (int)steps, settled, (int)mps_mpm_steps(f.s.mpm),
                rough);
  NEAR(settled, slow, within * slow);
  assert_true(2 * mps_mpm_steps(f.s.mpm) < steps);
  mps_body_destroy(&f.strip);
  mpm_scene_end(&f.s);
}

/* Cancels at that call; never, if that is 0. */
typedef struct patience {
  int left;
} patience;
static int32_t loses_patience(void *user) {
  patience *p = user;
  return p->left > 0 && --p->left == 0;
}

static mpm_scene column_to_settle(mps_context *in) {
  mpm_scene s = mpm_scene_begin(in, 0.025, 0.0, 0.0, 1e7);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.5);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.05, .gravity[1] = -10.0, .lower[1] = 0.0);
  return s;
}

/* A settling that is cut, twice, and continued, also after a rollback to where it was cut, is the
 * one that was not, bit for bit; a step in between begins from rest. */
TEST(settling_goes_on_where_it_was_cut) {
  patience p = {0};
  mps_context_def def = test_context_defaults();
  def.cancel = loses_patience, def.cancel_user = &p;
  scoped_context *other = NULL;
  assert_int_equal(mps_context_create(&def, &other, NULL, 0), MPS_OK);
  scoped_mpm_scene s = column_to_settle(other), whole = column_to_settle(context);
  mps_mpm_settled out, uncut;
  scoped_snapshot *cut = NULL;
  OK(mps_mpm_settle(whole.mpm, NULL, &uncut));
  for (int k = 1; k <= 2; k++) {
    p.left = 8;
    FAILS_ON(other, mps_mpm_settle(s.mpm, NULL, &out), MPS_ERROR_CANCELLED, "cancel hook");
    assert_int_equal(out.steps, 8 * k);
  }
  const mps_totals totals = mpm_scene_totals(&s);
  assert_true(totals.kinetic > 0.0);
  OK(mps_mpm_snapshot(s.mpm, &cut));
  for (int again = 0; again < 2; again++) {
    OK(mps_mpm_settle(s.mpm, NULL, &out));
    assert_same_rows(s.particles, whole.particles, "");
    assert_memory_equal(&out, &uncut, sizeof out);
    OK(mps_mpm_rollback(s.mpm, cut));
  }
  OK(mps_mpm_step(s.mpm, 1)); /* from rest: not the swing's energy any more */
  assert_true(mpm_scene_totals(&s).kinetic < 0.2 * totals.kinetic);
}
