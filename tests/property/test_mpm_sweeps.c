/* test_mpm_sweeps.c - the sweeps over the contacts of a step end at their tolerance, or at their
 * number; the remainder is reported. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

/* A block on a rough plate that is dragged from under it, pressed by another. */
typedef struct press {
  mpm_scene s;
  mps_body *plate, *above;
} press;

static double sense = 1.0; /* of the dragging: -1 is the mirror image */
static int32_t sides = MPS_BOUNDARY_ROLLER;

static press make_press(int32_t sweeps, double tolerance) {
  press p = {.s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e6)};
  mpm_scene_box(&p.s, 0.0, 0.0, 0.2, 0.1);
  USING(mpm, mpm_scene_solve(&p.s, &given), .cell = 0.02, .origin[1] = 0.005, .lower[0] = 0.0,
        .upper[0] = 0.2, .lower[1] = -0.095, .upper[1] = 0.205);
  for (int32_t side = MPS_SIDE_X_LOWER; side <= MPS_SIDE_X_UPPER; side++)
    mpm_scene_side(&p.s, side, sides, 0.0);
  const double up[] = {0.0, 1.0}, down[] = {0.0, -1.0};
  mps_body_def at = mps_body_defaults();
  OK(mps_body_create_half_plane(context, &at, up, &p.plate));
  at.position[1] = 0.1;
  OK(mps_body_create_half_plane(context, &at, down, &p.above));
  DEF(contact, contact, .sweeps = sweeps, .tolerance = tolerance);
  OK(mps_mpm_add_contact(p.s.mpm, p.above, &contact, NULL));
  contact.friction = 0.22;
  OK(mps_mpm_add_contact(p.s.mpm, p.plate, &contact, NULL));
  mps_body_motion pressing = mps_body_motion_defaults(), dragging = mps_body_motion_defaults();
  pressing.velocity[1] = -0.02, dragging.velocity[0] = 0.05 * sense;
  OK(mps_body_set_motion(p.above, &pressing));
  OK(mps_body_set_motion(p.plate, &dragging));
  return p;
}

static void end_press(press *p) {
  mpm_scene_end(&p->s);
  mps_body_destroy(&p->plate);
  mps_body_destroy(&p->above);
}

/* In each step the sweeps continue until they change little enough, or as many are made as may be.
 */
TEST(sweeps_end_at_their_tolerance) {
  const struct {
    int32_t sweeps, most;
    double tolerance, least;
  } cases[] = {{0, 10, NAN, 0.0}, {0, 30, 1e-6, 1e-6}, {200, 200, 1e-6, 1e-6}, {7, 7, NAN, 0.0}};
  double mean[4] = {0.0};
  for (int k = 0; k < 4; k++) {
    SCOPED(end_press) press p = make_press(cases[k].sweeps, cases[k].tolerance);
    for (int n = 0; n < 60; n++) {
      mps_mpm_report usage;
      OK(mps_mpm_step(p.s.mpm, 1));
      OK(mps_mpm_get_report(p.s.mpm, &usage));
      assert_true(usage.left >= 0.0 && usage.left < 1.0);
      assert_true(usage.sweeps >= (k == 3 ? 7 : 10) && usage.sweeps <= cases[k].most);
      if (usage.sweeps < cases[k].most) assert_true(usage.left <= cases[k].least);
      mean[k] += (double)usage.sweeps / 60.0;
    }
  }
  print_message("mean sweeps: default %.1f, to 1e-6 %.1f, to that of 200 %.1f, of 7 %.1f\n",
                mean[0], mean[1], mean[2], mean[3]);
  assert_true(mean[0] < mean[1] && mean[1] < mean[2]);
  NEAR(mean[3], 7.0, 1e-12);
}

/* While it slides, friction is mu times the normal force. */
TEST(steady_sliding) {
  SCOPED(end_press) press p = make_press(0, NAN);
  mps_reaction before, after;
  OK(mps_mpm_run(p.s.mpm, 0.05, 100000, NULL, NULL));
  OK(mps_body_get_reaction(p.plate, -1, &before));
  OK(mps_mpm_run(p.s.mpm, 0.15, 100000, NULL, NULL));
  OK(mps_body_get_reaction(p.plate, -1, &after));
  const double x = after.impulse[0] - before.impulse[0], y = after.impulse[1] - before.impulse[1];
  print_message("friction over normal force %.6f\n", x / y);
  assert_true(y < 0.0);
  NEAR(fabs(x / y), 0.22, 2e-4);
}

/* A block under a smooth plate, pressed by 0.45 % on a rough one that is then dragged at 20 mm/s:
 * the friction over the normal force, and which part of that force contacts bear that do not slide.
 */
static double drag(double damping, double *sticks) {
  const double mu = 0.22, up[] = {0.0, 1.0}, down[] = {0.0, -1.0};
  mpm_scene s = mpm_scene_begin(context, 0.005, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.01, .origin[1] = 0.0025,
        .viscous_damping = damping, .lower[0] = 0.0, .upper[0] = 0.1);
  mps_body *body[2] = {NULL, NULL};
  mps_contact *contact[2] = {NULL, NULL};
  for (int b = 0; b < 2; b++) {
    mps_body_def at = mps_body_defaults();
    mps_contact_def how = mps_contact_defaults();
    at.position[1] = 0.1 * b, how.friction = b == 0 ? mu : 0.0;
    OK(mps_body_create_half_plane(context, &at, b == 0 ? up : down, &body[b]));
    OK(mps_mpm_add_contact(s.mpm, body[b], &how, &contact[b]));
  }
  mps_body_motion pressing = mps_body_motion_defaults(), dragging = pressing;
  pressing.velocity[1] = -0.0225, dragging.velocity[0] = 0.02;
  OK(mps_body_set_motion(body[1], &pressing));
  OK(mps_mpm_run(s.mpm, 0.02, 100000, NULL, NULL));
  pressing.velocity[1] = 0.0;
  OK(mps_body_set_motion(body[1], &pressing));
  OK(mps_body_set_motion(body[0], &dragging));
  OK(mps_mpm_run(s.mpm, 0.056, 100000, NULL, NULL));
  double all = 0.0, along = 0.0, stuck = 0.0;
  while (mps_mpm_time(s.mpm) < 0.08) {
    double force[3 * 80];
    int64_t count = 0;
    OK(mps_mpm_step(s.mpm, 1));
    OK(mps_contact_get_particles(contact[0], 80, &count, NULL, NULL, NULL, force, NULL));
    for (int64_t k = 0; k < count; k++) {
      const double P = force[3 * k + 1], T = force[3 * k];
      assert_true(fabs(T) <= mu * P * (1.0 + 1e-12));
      all += P, along += T, stuck += fabs(T) < 0.999 * mu * P ? P : 0.0;
    }
  }
  for (int b = 0; b < 2; b++) {
    mps_contact_destroy(&contact[b]);
    mps_body_destroy(&body[b]);
  }
  mpm_scene_end(&s);
  *sticks = stuck / all;
  return along / all;
}

/* A block at rest under the plate's drag has mu times the normal force. One that shakes as fast as
 * the plate moves overtakes it here and there: contacts stick for a while, and it has less. */
TEST(less_than_mu_is_what_sticks) {
  double sticks[2];
  const double damped = drag(300.0, &sticks[0]), shaking = drag(0.0, &sticks[1]);
  print_message("damped: %.6f, %.3f of the normal force sticks; shaking: %.6f, %.3f\n", damped,
                sticks[0], shaking, sticks[1]);
  NEAR(damped, 0.22, 1e-5);
  assert_true(sticks[0] == 0.0);
  assert_true(shaking > 0.22 * (1.0 - 2.0 * sticks[1]) && sticks[1] > 0.0);
}

/* Impulse (N s) on the plate after 15 steps between held sides, and the stresses of the particles.
 */
static void drag_to(double direction, int32_t sweeps, double tolerance, double *impulse,
                    double (*stress)[2]) {
  sense = direction, sides = MPS_BOUNDARY_HELD;
  SCOPED(end_press) press p = make_press(sweeps, tolerance);
  sense = 1.0, sides = MPS_BOUNDARY_ROLLER;
  for (int n = 0; n < 15; n++) {
    mps_mpm_report usage;
    OK(mps_mpm_step(p.s.mpm, 1));
    OK(mps_mpm_get_report(p.s.mpm, &usage));
    /* contacts that begin to slide may leave more, whatever the sweeps */
    if (tolerance > 0.0) assert_true(usage.left <= fmax(tolerance, 3e-8));
  }
  mps_reaction r;
  OK(mps_body_get_reaction(p.plate, -1, &r));
  impulse[0] = direction * r.impulse[0], impulse[1] = r.impulse[1];
  mps_view view = mpm_scene_view(&p.s, "stress");
  for (int64_t id = 0; id < 200; id++) { /* rows of 20 */
    const int64_t from = direction > 0.0 ? id : id / 20 * 20 + 19 - id % 20;
    const int64_t k = mps_particles_index(p.s.particles, from);
    for (int c = 0; c < 2; c++) stress[id][c] = *mps_view_f64(&view, k, c);
  }
}

/* Sweeps go through the list of contacts from one end to the other, so that what they leave is not
 * symmetric: a scene and its mirror image differ by that. With a tolerance that is reached they
 * differ by it in each step, over the part of what is left that a sweep takes, here a hundredth. */
TEST(mirror_images_agree_to_the_tolerance) {
  const struct {
    int32_t sweeps;
    double tolerance, bound;
  } cases[] = {{10, 0.0, 0.04}, {20000, 1e-6, 15e-4}, {20000, 1e-8, 15e-6}};
  for (int k = 0; k < 3; k++) {
    double a[2], b[2], stress[200][2], other[200][2], apart = 0.0, most = 0.0;
    drag_to(1.0, cases[k].sweeps, cases[k].tolerance, a, stress);
    drag_to(-1.0, cases[k].sweeps, cases[k].tolerance, b, other);
    for (int i = 0; i < 200; i++)
      for (int c = 0; c < 2; c++) {
        apart = fmax(apart, fabs(stress[i][c] - other[i][c]));
        most = fmax(most, fabs(stress[i][c]));
      }
    const double off = hypot(a[0] - b[0], a[1] - b[1]) / hypot(a[0], a[1]);
    print_message("%d sweeps, tolerance %g: impulses apart by %.2g, stresses by %.2g\n",
                  (int)cases[k].sweeps, cases[k].tolerance, off, apart / most);
    assert_true(off < cases[k].bound && apart < cases[k].bound * most);
  }
}

TEST(bad_tolerances_are_refused) {
  const double bad[] = {-1e-3, 1.0, INFINITY};
  SCOPED(end_press) press p = make_press(0, NAN);
  mps_body_def at = mps_body_defaults();
  at.position[0] = 10.0, at.position[1] = 0.05; /* between the two */
  MAKE(body, disc, create_disc, context, &at, 0.02);
  for (int k = 0; k < 3; k++) {
    DEF(contact, contact, .tolerance = bad[k]);
    REFUSES(mps_mpm_add_contact(p.s.mpm, disc, &contact, NULL), "must be >= 0 and below 1");
  }
}
