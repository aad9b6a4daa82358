/* test_fluid_guard.c - no particle of the fluid moves more than half a spacing in a step without a
 * word: the classical scheme with the whole source, from disturbed particles, and a step given far
 * above the limit are refused, with the state as before; what holds continues.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define L0 0.015

/* Moves every particle by up to .15 l0, the same on every machine. */
static void disturb(void *user, double *x, double *u) {
  uint64_t *seed = user;
  (void)u;
  for (int c = 0; c < 2; c++) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    x[c] += 0.3 * L0 * ((double)(*seed >> 11) * 0x1p-53 - 0.5);
  }
}

static tank make(bool disturbed, double dt) {
  uint64_t seed = 3;
  return tank_of(context, 0.6, 0.3, L0, dt, NULL, disturbed ? disturb : NULL, &seed);
}

static double *positions(const tank *t) {
  const int64_t n = mps_particles_count(t->water);
  double *x = malloc((size_t)n * 2 * sizeof *x);
  mps_view v = view_field(t->water, "position");
  for (int64_t i = 0; i < n; i++) /* by id: the fluid sorts */
    for (int c = 0; c < 2; c++)
      x[2 * i + c] = *mps_view_f64(&v, mps_particles_index(t->water, i), c);
  return x;
}

static double farthest(const double *a, const double *b, int64_t n) {
  double most = 0.0;
  for (int64_t i = 0; i < n; i++)
    most = fmax(most, hypot(a[2 * i] - b[2 * i], a[2 * i + 1] - b[2 * i + 1]));
  return most;
}

/* At most `steps` steps: the status of the last; no step that is made moves a particle far. */
static mps_status run(tank *t, int steps) {
  const int64_t n = mps_particles_count(t->water);
  mps_status status = MPS_OK;
  for (int k = 0; k < steps && status == MPS_OK; k++) {
    double *before = positions(t);
    const int64_t made = mps_fluid_steps(t->fluid);
    status = mps_fluid_step(t->fluid, 1);
    double *after = positions(t);
    const double way = farthest(before, after, n);
    if (status == MPS_OK && way > 0.5 * L0) fail_msg("step %d moves %g l0", k, way / L0);
    if (status != MPS_OK) {
      assert_true(way == 0.0);
      assert_int_equal(mps_fluid_steps(t->fluid), made);
    }
    free(before), free(after);
  }
  return status;
}

TEST(the_whole_source_of_disturbed_particles_diverges) {
  scoped_tank t = make(true, 1e-3);
  OK(mps_experimental_fluid_classical(t.fluid, 1.0));
  const mps_status status = run(&t, 40);
  print_message("%s\n", mps_context_error(context)->message);
  assert_int_equal(status, MPS_ERROR_DIVERGED);
  assert_non_null(strstr(mps_context_error(context)->message, "allowed is half a spacing"));
  assert_true(mps_context_error(context)->particle >= 0);
}

TEST(a_lattice_and_a_fifth_of_the_source_hold) {
  for (int way = 0; way < 3; way++) {
    scoped_tank t = make(way == 1, 1e-3);
    if (way < 2) OK(mps_experimental_fluid_classical(t.fluid, way == 1 ? 0.2 : 1.0));
    OK(run(&t, 60));
  }
}

/* A step of the caller that carries the water more than half a spacing is refused, and with the
 * step that the fluid recommends the same state continues. */
TEST(a_step_far_above_the_limit_is_refused) {
  scoped_tank t = make(false, NAN);
  EDIT(edit, t.water, "velocity")
    for (int64_t i = 0; i < mps_particles_count(t.water); i++) *mps_edit_f64(&edit, i, 1) = 2.0;
  OK(mps_fluid_set_dt(t.fluid, 0.4 * L0 / 2.0));
  OK(run(&t, 1));
  OK(mps_fluid_set_dt(t.fluid, 1.2 * L0 / 2.0));
  FAILS(run(&t, 1), MPS_ERROR_DIVERGED, "allowed is half a spacing");
  OK(mps_fluid_set_dt(t.fluid, NAN));
  OK(run(&t, 5));
}

/* Without gravity the step follows the acceleration of loads and of the caller's forces: of water
 * at rest under it, which nothing else limits, and of a drop where it turns. */
TEST(without_gravity_loads_limit_the_step) {
  const double l0[] = {0.03, 0.02, 0.015}, g = 9.81;
  for (int k = 0; k < 6; k++) {
    const double d = l0[k / 2], step = 0.1 * sqrt(d / g);
    scoped_tank t = {NULL, NULL};
    USING(particles, mps_particles_create(context, &given, &t.water), .spacing = d);
    tank_fill(t.water, 0.6, 0.3, NULL, NULL);
    USING(fluid, mps_fluid_create(context, t.water, &given, &t.fluid), .gravity[1] = 0.0);
    tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
    const int32_t left = tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
    tank_wall(t.fluid, 0.6, 0.0, -1.0, 0.0, NULL);
    FAILS(mps_fluid_step(t.fluid, 1), MPS_ERROR_STATE, "nothing limits the step");
    if (k % 2 == 0)
      USING(fluid_load, mps_fluid_add_load(t.fluid, &given, NULL), .acceleration[1] = -g, .all = 1);
    else {
      OK(mps_particles_add_field(t.water, "external_force", 0));
      EDIT(edit, t.water, "external_force")
        for (int64_t i = 0; i < mps_particles_count(t.water); i++)
          *mps_edit_f64(&edit, i, 1) = -g * 1000.0 * d * d;
    }
    NEAR(mps_fluid_limit(t.fluid), step, 1e-12);
    OK(mps_fluid_run(t.fluid, 0.2, 1000, NULL, NULL));
    mps_reaction r;
    OK(mps_fluid_get_reaction(t.fluid, left, &r));
    NEAR(r.force[0], 500.0 * g * 0.09, 0.01 * 500.0 * g * 0.09);
    NEAR(mps_fluid_dt(t.fluid), step, 1e-12);
  }
}
