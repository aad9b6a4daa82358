/* test_mpm_friction_in_time.c - a block rests on an incline whose friction falls: it starts to
 * slide when mu = tan(slope), and then moves by g cos(slope) (-dmu/dt) (t - t0)^3/6. By both
 * methods of contact, on three grids, over a restart; and what a factor on friction may be.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define G 9.81
#define DEGREE 0.017453292519943295
#define SLOPE (20.0 * DEGREE)
#define HOLD 0.2                 /* s: the block comes to rest under its weight */
#define FIRST tan(40.0 * DEGREE) /* mu at HOLD and a second later */
#define LAST tan(10.0 * DEGREE)
#define RATE (FIRST - LAST)                        /* 1/s */
#define START (HOLD + (FIRST - tan(SLOPE)) / RATE) /* s */
#define END (START + 0.25)                        /* s, of the run */

typedef struct block {
  mpm_scene s;
  mps_body *base;
  mps_contact *contact;
} block;

static mps_signal *fall(void) {
  const double t[2] = {HOLD, HOLD + 1.0}, v[2] = {1.0, LAST / FIRST};
  MAKE_KEPT(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_VALUE, 2, t, v);
  return signal;
}

/* The axes are along and across the incline. */
static block make_block(double cell, int32_t method, mps_signal *factor) {
  const double up[2] = {0.0, 1.0};
  block b = {.s = mpm_scene_begin(context, 0.5 * cell, 0.0, 0.0, 4e5)};
  mps_body_def base = mps_body_defaults();
  DEF(mpm, def, .cell = cell, .flip_time = 0.002, .gravity[0] = G * sin(SLOPE),
      .gravity[1] = -G * cos(SLOPE));
  mpm_scene_box(&b.s, 0.0, 0.0, 0.2, 0.1);
  mpm_scene_solve(&b.s, &def);
  OK(mps_body_create_half_plane(context, &base, up, &b.base));
  DEF(contact, contact, .method = method, .friction = FIRST, .friction_factor = factor);
  OK(mps_mpm_add_contact(b.s.mpm, b.base, &contact, &b.contact));
  return b;
}

static void end_block(block *b) {
  mps_contact_destroy(&b->contact);
  mpm_scene_end(&b->s);
  mps_body_destroy(&b->base);
}

/* Mean position and velocity along the incline. */
static void look(block *b, double *x, double *v) {
  const mps_view at = mpm_scene_view(&b->s, "position"), speed = mpm_scene_view(&b->s, "velocity");
  *x = *v = 0.0;
  for (int64_t k = 0; k < at.shape[0]; k++) {
    *x += *mps_view_f64(&at, k, 0) / (double)at.shape[0];
    *v += *mps_view_f64(&speed, k, 0) / (double)at.shape[0];
  }
}

static void slides_on_time(int32_t method, double cell, double tolerance) {
  mps_signal *factor = fall();
  block b = make_block(cell, method, factor);
  double x0, v0, x, v;
  mps_signal_destroy(&factor); /* the contact keeps it */
  OK(mps_mpm_run(b.s.mpm, HOLD, INT64_MAX, NULL, NULL));
  look(&b, &x0, &v0);
  OK(mps_mpm_run(b.s.mpm, START - 0.05, INT64_MAX, NULL, NULL));
  look(&b, &x, &v);
  const double crept = x - x0;
  OK(mps_mpm_run(b.s.mpm, END, INT64_MAX, NULL, NULL));
  look(&b, &x, &v);
  const double k = G * cos(SLOPE) * RATE;
  const double by_speed = END - sqrt(2.0 * v / k);
  const double by_place = END - cbrt(6.0 * (x - x0 - crept) / k);
  if (getenv("MPS_TEST_SHOW"))
    printf("method %d cell %g: start %.5f s by speed, %.5f by place, exact %.5f, crept %.2e m\n",
           method, cell, by_speed, by_place, START, crept);
  NEAR(crept, 0.0, 2e-4); /* m */
  NEAR(by_speed, START, tolerance);
  NEAR(by_place, START, tolerance);
  end_block(&b);
}

TEST(by_impulses_a_block_starts_to_slide_when_it_should) {
  for (int n = 2; n <= 4; n++) slides_on_time(MPS_CONTACT_METHOD_IMPULSE, 0.1 / n, 0.003);
}

TEST(by_penalty_a_block_starts_to_slide_when_it_should) {
  for (int n = 2; n <= 4; n++) slides_on_time(MPS_CONTACT_METHOD_PENALTY, 0.1 / n, 0.003);
}

TEST(a_restart_goes_on_with_the_friction_of_its_time) {
  const char path[] = TEST_TMP "/friction_in_time.h5";
  for (int32_t method = 0; method < 2; method++) {
    scoped_signal *factor = fall();
    block one = make_block(0.05, method, factor), two = make_block(0.05, method, factor);
    double x[2], v[2];
    OK(mps_mpm_run(one.s.mpm, 1.1 * START, INT64_MAX, NULL, NULL));
    const mps_status saved = mps_mpm_save(one.s.mpm, path, NULL);
    if (saved != MPS_ERROR_UNSUPPORTED) {
      OK(saved);
      OK(mps_mpm_restore(two.s.mpm, path, NULL));
      OK(mps_mpm_step(one.s.mpm, 50));
      OK(mps_mpm_step(two.s.mpm, 50));
      look(&one, &x[0], &v[0]);
      look(&two, &x[1], &v[1]);
      assert_true(x[0] == x[1] && v[0] == v[1]);
    }
    end_block(&one), end_block(&two);
  }
}

TEST(a_factor_is_a_number_that_is_not_negative) {
  const double t[2] = {0.0, 1.0}, v[2] = {1.0, 2.0}, sinks[2] = {0.02, -2.0};
  mps_signal *motion = NULL, *negative = NULL;
  block b = make_block(0.05, MPS_CONTACT_METHOD_IMPULSE, NULL);
  mps_contact_destroy(&b.contact);
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v, &motion));
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VALUE, 2, t, sinks, &negative));
  DEF(contact, def, .friction = 0.5, .friction_factor = motion);
  FAILS(mps_mpm_add_contact(b.s.mpm, b.base, &def, &b.contact), MPS_ERROR_ARGUMENT,
        "friction_factor");
  def.friction_factor = negative;
  OK(mps_mpm_add_contact(b.s.mpm, b.base, &def, &b.contact));
  FAILS(mps_mpm_run(b.s.mpm, 0.1, INT64_MAX, NULL, NULL), MPS_ERROR_ARGUMENT, "must be >= 0");
  const int64_t steps = mps_mpm_steps(b.s.mpm);
  assert_true(steps > 0 && mps_mpm_time(b.s.mpm) < 0.02);
  FAILS(mps_mpm_step(b.s.mpm, 1), MPS_ERROR_ARGUMENT, "contact 0");
  assert_int_equal(mps_mpm_steps(b.s.mpm), steps); /* which is as after its last step */
  mps_signal_destroy(&motion);
  mps_signal_destroy(&negative);
  end_block(&b);
}
