/* test_hdf5_restart.c - a run that stops at a checkpoint and continues in a new solver is, bit for
 * bit, the run that never stopped: every integrator, with and without damping, driven, with a
 * viscous base and free-field columns.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/same.h"
#include "dynamics/base/dynamics_solver.h"
#include "soil_column.h"
#include "test_fixture.h"

#define STEPS_BEFORE 37
#define STEPS_AFTER 53

static const char path[] = TEST_TMP "/restart.h5", before[] = TEST_TMP "/restart_before.h5";
typedef struct run {
  int integrator, rotation;
  double damping;
  bool driven;  /* else a viscous base with an incoming wave, and free-field columns */
  double start; /* s: time of the first step */
} run;

typedef struct body {
  mps_particles *set;
  mps_dynamics *solver;
} body;

static void set_field(mps_particles *set, const char *name, double value) {
  OK(mps_particles_set(set, name, 0, value));
}

/* A block of 8 x 6 particles in slow motion, on its base. The time step is no dyadic number, so
 * that times are rounded. `dt` NaN: the library's own choice. */
static body build(const run *r, double dt) {
  body b = {NULL, NULL};
  USING(particles, mps_particles_create(context, &given, &b.set), .spacing = 1.0);
  OK(mps_particles_fill_box(b.set, AT(0.0, 0.0), AT(8.0, 6.0), NULL));
  set_field(b.set, "density", 1500.0);
  set_field(b.set, "shear_velocity", 100.0);
  set_field(b.set, "pressure_velocity", 200.0);
  set_field(b.set, "damping", r->damping);
  set_field(b.set, "velocity", 0.0);
  mps_view x = view_field(b.set, "position");
  EDIT(v, b.set, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&v, k, 0) = 0.01 * sin(*mps_view_f64(&x, k, 1)) * cos(*mps_view_f64(&x, k, 0));
  if (!r->driven) OK(mps_dynamics_add_free_field(b.set, MPS_SIDE_X_LOWER, 3));
  DEF(dynamics, def, .integrator = r->integrator, .rotation = r->rotation, .dt = dt);
  OK(mps_dynamics_create(context, b.set, &def, &b.solver));
  const double base_lo[2] = {-20.0, 0.0}, base_hi[2] = {20.0, 1.0};
  int64_t ids[64], count;
  OK(mps_particles_select_box(b.set, base_lo, base_hi, 64, &count, ids));
  MAKE(signal, wave, create_ricker, context, 9.0, 0.05, 0.01);
  if (r->driven) {
    OK(soil_add_held(b.solver, MPS_DOF_Y, count, ids));
    OK(soil_add_driven(b.solver, 0, wave, 1.0, count, ids));
  } else {
    USING(dynamics_boundary, soil_add_viscous(b.solver, &given, count, ids), .signal[0] = wave);
  }
  if (r->start != 0.0) OK(mps_dynamics_restart(b.solver, r->start));
  return b;
}

static void drop(body *b) {
  mps_dynamics_destroy(&b->solver);
  mps_particles_destroy(&b->set);
}

static void same_bits(const body *a, const body *b, const char *what) {
  assert_same_rows(a->set, b->set, what);
  assert_int_equal(mps_dynamics_steps(a->solver), mps_dynamics_steps(b->solver));
  const double time[2] = {mps_dynamics_time(a->solver), mps_dynamics_time(b->solver)};
  if (time[0] != time[1]) fail_msg("%s: time %.17g and %.17g s", what, time[0], time[1]);
}

static void checkpoint(const body *b) { OK(mps_dynamics_save(b->solver, path, NULL)); }

/* The program that continues: with a time step of its own, which the file's replaces. */
static body resume(const run *r) {
  body b = build(r, 1e-4);
  OK(mps_dynamics_restore(b.solver, path, NULL));
  return b;
}

static void stop_and_go_on(const run *r, double dt, int64_t steps) {
  char what[128];
  snprintf(what, sizeof what, "integrator %d rotation %d damping %g driven %d start %g",
           r->integrator, r->rotation, r->damping, r->driven, r->start);
  SCOPED(drop) body whole = build(r, dt);
  OK(mps_dynamics_step(whole.solver, steps));
  checkpoint(&whole);
  SCOPED(drop) body other = resume(r);
  same_bits(&whole, &other, what);
  for (int k = 0; k < 2; k++) {
    OK(mps_dynamics_step(whole.solver, STEPS_AFTER));
    OK(mps_dynamics_step(other.solver, STEPS_AFTER));
    same_bits(&whole, &other, what);
    /* a checkpoint of the resumed run serves as well */
    drop(&other);
    checkpoint(&whole);
    other = resume(r);
  }
  mps_totals energy;
  OK(mps_dynamics_get_totals(whole.solver, &energy));
  assert_true(energy.strain > 0.0); /* something moved */
}

TEST(every_integrator_goes_on_bit_for_bit) {
  static const double start[] = {0.0, 0.3};
  for (int integrator = 0; integrator < 3; integrator++)
    for (int damped = 0; damped < 2; damped++)
      for (int driven = 0; driven < 2; driven++)
        for (int k = 0; k < 2; k++) {
          const run r = {integrator,
                         driven ? MPS_DYNAMICS_ROTATION_MEAN_MATRIX
                                : MPS_DYNAMICS_ROTATION_MEAN_ANGLE,
                         0.05 * damped, driven == 1, start[k]};
          stop_and_go_on(&r, 7e-4, STEPS_BEFORE);
        }
}

TEST(so_does_a_run_with_the_librarys_time_step) {
  const run r = {MPS_DYNAMICS_INTEGRATOR_VERLET, MPS_DYNAMICS_ROTATION_MEAN_MATRIX, 0.02, true,
                 0.0};
  stop_and_go_on(&r, NAN, STEPS_BEFORE);
}

TEST(so_does_one_that_has_not_begun) {
  for (int integrator = 0; integrator < 3; integrator++) {
    const run r = {integrator, MPS_DYNAMICS_ROTATION_MEAN_MATRIX, 0.02, true, 0.0};
    stop_and_go_on(&r, 7e-4, 0);
  }
}

/* A run that is dug into, and stops after that, continues in a new solver on all particles; and a
 * run goes back to a file from before in a solver that has been dug into. */
TEST(so_does_one_that_was_dug_into) {
  for (int driven = 0; driven < 2; driven++) {
    const run r = {0, MPS_DYNAMICS_ROTATION_MEAN_MATRIX, 0.02, driven == 1, 0.0};
    const double lo[2] = {2.1, -1.0}, hi[2] = {4.9, 99.0}; /* down to the base */
    int64_t ids[32], count;
    SCOPED(drop) body whole = build(&r, 7e-4);
    OK(mps_dynamics_step(whole.solver, STEPS_BEFORE));
    OK(mps_dynamics_save(whole.solver, before, NULL));
    OK(mps_particles_select_box(whole.set, lo, hi, 32, &count, ids));
    OK(mps_particles_remove(whole.set, ids, count));
    OK(mps_dynamics_step(whole.solver, 5));
    checkpoint(&whole);
    SCOPED(drop) body other = resume(&r);
    assert_int_equal(mps_particles_count(whole.set), mps_particles_count(other.set));
    assert_int_equal(whole.solver->pairs, other.solver->pairs);
    for (int part = 0; part < 2; part++) {
      same_bits(&whole, &other, "dug");
      OK(mps_dynamics_step(whole.solver, STEPS_AFTER));
      OK(mps_dynamics_step(other.solver, STEPS_AFTER));
    }
    SCOPED(drop) body fresh = build(&r, 7e-4);
    OK(mps_dynamics_restore(fresh.solver, before, NULL));
    OK(mps_dynamics_restore(other.solver, before, NULL));
    for (int part = 0; part < 2; part++) {
      same_bits(&fresh, &other, "filled");
      OK(mps_dynamics_step(fresh.solver, STEPS_AFTER));
      OK(mps_dynamics_step(other.solver, STEPS_AFTER));
    }
  }
}
