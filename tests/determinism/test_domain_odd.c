/* test_domain_odd.c - one rank of three that gives another value than the others: constants of
 * definitions, weight functions, the next motion of a body, states to roll back to. All ranks get
 * the same error, which names what differs, and none computes a third result. And a rank that sends
 * nothing more: all end.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "ranks_team.h"

static mps_status make_set(mps_context *own, double spacing, double width, double height,
                           mps_particles **set) {
  DEF(particles, def, .spacing = spacing);
  mps_status status = mps_particles_create(own, &def, set);
  TRY(mps_particles_fill_box(*set, AT(0.0, 0.0), AT(width, height), NULL));
  TRY(mps_particles_set(*set, "density", 0, 1000.0));
  return status;
}

/* ---- WLS-MPM --------------------------------------------------------------------------------- */

#define ODD_MPM(ROW)                                                                               \
  ROW(MPM_DEGREE, MPS_ERROR_ARGUMENT, "spline is ")                                                \
  ROW(MPM_LAW, MPS_ERROR_ARGUMENT, "another value on others")                                      \
  ROW(MPM_STATEV, MPS_ERROR_ARGUMENT, "histories is ")                                             \
  ROW(MPM_SWEEPS, MPS_ERROR_ARGUMENT, "sweeps is ")                                                \
  ROW(MPM_ADHESION, MPS_ERROR_ARGUMENT, "adhesion is ")                                            \
  ROW(MPM_STRENGTH, MPS_ERROR_ARGUMENT, "strength is ")                                            \
  ROW(MPM_CORNER, MPS_ERROR_ARGUMENT, "corner is ")                                                \
  ROW(MPM_TOLERANCE, MPS_ERROR_ARGUMENT, "tolerance is ")                                          \
  ROW(MPM_OFFSET, MPS_ERROR_ARGUMENT, "offset is ")                                                \
  ROW(MPM_INSIDE, MPS_ERROR_ARGUMENT, "inside is ")                                                \
  ROW(MPM_BODY_LOAD, MPS_ERROR_ARGUMENT, "the load on the body is ")                               \
  ROW(MPM_BODY_FACTOR, MPS_ERROR_ARGUMENT, "the body's ")                                          \
  ROW(MPM_BODY_MOTION, MPS_ERROR_ARGUMENT, "the body's ")                                          \
  ROW(MPM_SETTLE, MPS_ERROR_ARGUMENT, "max_steps is ")                                             \
  ROW(MPM_FLIP, MPS_ERROR_ARGUMENT, "flip is ")                                                    \
  ROW(MPM_POINTS, MPS_ERROR_ARGUMENT, "points")                                                    \
  ROW(MPM_COMPONENT, MPS_ERROR_ARGUMENT, "component")                                              \
  ROW(MPM_END, MPS_ERROR_ARGUMENT, "t_end")                                                        \
  ROW(MPM_SNAPSHOT, MPS_ERROR_ARGUMENT, "steps is ")                                               \
  ROW(MPM_NO_SNAPSHOT, MPS_ERROR_ARGUMENT, "rank 1: snapshot is NULL")                             \
  ROW(MPM_FILE, MPS_ERROR_ARGUMENT, "time is ")                                                    \
  ROW(MPM_SETTLING_SIDE, MPS_ERROR_ARGUMENT, "settle is ")
enum { ODD_MPM(CASE_NAME) MPM_CASES };

static const trouble_case of_mpm[MPM_CASES] = {ODD_MPM(CASE_ROW)};

static MPS_MATERIAL_UMAT(umat_that_does_nothing) { MPS_MATERIAL_UMAT_UNUSED; }

static mps_status make_law(mps_context *own, int what, bool odd, mps_material **law) {
  const double initial[1] = {odd && what == MPM_STATEV ? 2.0 : 1.0};
  if (what != MPM_LAW && what != MPM_STATEV)
    return mps_material_create_linear_elastic(own, 1e5, 0.3, law);
  DEF(material_umat, def, .umat = umat_that_does_nothing, .wave_modulus = 1e5, .statev_count = 1,
      .statev_initial = initial);
  if (odd && what == MPM_LAW) def.temperature = 300.0;
  return mps_material_create_umat(own, &def, law);
}

/* A body above the ground, and what is done to it. */
static mps_status with_body(mps_context *own, mps_mpm *mpm, int what, bool odd) {
  mps_contact_def contact = mps_contact_defaults();
  DEF(body, def, .position[0] = 0.6, .position[1] = 0.76);
  mps_body_motion motion = mps_body_motion_defaults();
  scoped_body *body = NULL;
  scoped_signal *signal = NULL;
  const double force[3] = {0.0, odd ? -2.0 : -1.0, 0.0}, moment[3] = {0.0, 0.0, 0.0};
  if (what == MPM_BODY_LOAD)
    def.motion = MPS_BODY_MOTION_FREE, def.mass = 10.0, def.inertia[2] = 1.0;
  if (odd && what == MPM_SWEEPS) contact.sweeps = 40;
  if (odd && what == MPM_ADHESION) contact.adhesion = 10.0;
  if (odd && what == MPM_STRENGTH) contact.strength = 10.0;
  if (odd && what == MPM_CORNER) contact.corner = 0.01;
  if (what == MPM_TOLERANCE) contact.sweeps = 60, contact.tolerance = odd ? 1e-6 : 1e-5;
  if (odd && what == MPM_OFFSET) contact.offset = 0.04;
  if (odd && what == MPM_INSIDE) contact.inside = MPS_CONTACT_INSIDE_REMOVE;
  motion.velocity[1] = odd ? -0.2 : -0.1;
  mps_status status =
      mps_signal_create_ramp(own, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.0, 0.1, -0.01, &signal);
  TRY(mps_body_create_box(own, &def, 0.4, 0.2, &body));
  TRY(mps_mpm_add_contact(mpm, body, &contact, NULL));
  if (what == MPM_BODY_LOAD) TRY(mps_body_set_load(body, force, moment));
  if (what == MPM_BODY_FACTOR) TRY(mps_body_drive(body, 1, signal, odd ? 2.0 : 1.0));
  if (what == MPM_BODY_MOTION) TRY(mps_body_set_motion(body, &motion));
  TRY(mps_mpm_step(mpm, 3));
  return status;
}

/* Two states, of which one rank goes back to the other one. */
static mps_status back(mps_mpm *mpm, int what, bool odd) {
  static const char *const file[2] = {TEST_TMP "/odd-1.h5", TEST_TMP "/odd-2.h5"};
  mps_snapshot *state[2] = {NULL, NULL};
  mps_status status = MPS_OK;
  for (int k = 0; k < 2; k++) {
    TRY(mps_mpm_step(mpm, 2));
    if (what != MPM_FILE) TRY(mps_mpm_snapshot(mpm, &state[k]));
    if (what == MPM_FILE) TRY(mps_mpm_save(mpm, file[k], NULL));
  }
  if (what == MPM_SNAPSHOT) TRY(mps_mpm_rollback(mpm, state[odd]));
  if (what == MPM_NO_SNAPSHOT) TRY(mps_mpm_rollback(mpm, odd ? NULL : state[0]));
  if (what == MPM_FILE) TRY(mps_mpm_restore(mpm, file[odd], NULL));
  TRY(mps_mpm_step(mpm, 2));
  for (int k = 0; k < 2; k++) mps_snapshot_destroy(&state[k]);
  return status;
}

static mps_status ask_grid(mps_mpm *mpm, int what, bool odd) {
  const double point[3] = {0.4, odd && what == MPM_POINTS ? 0.31 : 0.3, 0.0};
  double value[2];
  mps_status status = mps_mpm_step(mpm, 1);
  TRY(mps_grid_evaluate(mps_mpm_grid(mpm), "velocity", odd && what == MPM_COMPONENT ? 0 : -1, 1,
                        point, value, NULL));
  return status;
}

static mps_status run_mpm(mps_context *own, mps_domain *domain, int what, int32_t rank) {
  const bool odd = rank == 1;
  DEF(mpm, def, .domain = domain, .cell = 0.2, .gravity[1] = -9.81);
  mps_mpm_boundary_def side = mps_mpm_boundary_defaults();
  mps_mpm_settle_def settle = mps_mpm_settle_defaults();
  scoped_particles *set = NULL;
  scoped_material *law = NULL;
  scoped_mpm *mpm = NULL;
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = c ? 2.0 : 1.2;
  mps_status status = make_set(own, 0.1, 1.2, 0.6, &set);
  if (what == MPM_DEGREE)
    TRY(mps_kernel_create(own, odd ? MPS_KERNEL_SPLINE2 : MPS_KERNEL_SPLINE3, odd ? 0.3 : 0.4,
                          &def.kernel));
  TRY(make_law(own, what, odd, &law));
  TRY(mps_mpm_create(own, set, law, &def, &mpm));
  if (what == MPM_FLIP) TRY(mps_experimental_mpm_standard(mpm, odd ? 0.9 : 1.0));
  if (what == MPM_SETTLING_SIDE) {
    side.kind = MPS_BOUNDARY_ABSORBING;
    side.settle = odd ? 0.2 : 0.1;
    TRY(mps_mpm_set_boundary(mpm, MPS_SIDE_X_LOWER, &side));
  }
  settle.max_steps = odd ? 3 : 2, settle.tolerance = 0.99;
  if (what == MPM_SETTLE) TRY(mps_mpm_settle(mpm, &settle, NULL));
  if (what >= MPM_SWEEPS && what <= MPM_BODY_MOTION) TRY(with_body(own, mpm, what, odd));
  if (what == MPM_CASES) TRY(with_body(own, mpm, what, false));
  if (what == MPM_POINTS || what == MPM_COMPONENT) TRY(ask_grid(mpm, what, odd));
  if (what == MPM_END) TRY(mps_mpm_run(mpm, odd ? 0.01 : 0.02, 1, NULL, NULL));
  if (what >= MPM_SNAPSHOT && what <= MPM_FILE) TRY(back(mpm, what, odd));
  mps_kernel_destroy(&def.kernel);
  return status;
}

TEST(test_mpm) { meet_troubles(run_mpm, of_mpm, MPM_CASES); }

/* ---- the fluid ------------------------------------------------------------------------------- */

#define ODD_FLUID(ROW)                                                                             \
  ROW(FLUID_ITERATIONS, MPS_ERROR_ARGUMENT, "iterations is ")                                      \
  ROW(FLUID_LEVEL, MPS_ERROR_ARGUMENT, "level is ")                                                \
  ROW(FLUID_RADIUS, MPS_ERROR_ARGUMENT, "radius_ratio is ")                                        \
  ROW(FLUID_GAMMA, MPS_ERROR_ARGUMENT, "gamma is ")                                                \
  ROW(FLUID_KIND, MPS_ERROR_ARGUMENT, "kind is ")                                                  \
  ROW(FLUID_MOTION, MPS_ERROR_ARGUMENT, "wall's motion")                                           \
  ROW(FLUID_DT, MPS_ERROR_ARGUMENT, "dt is ")                                                      \
  ROW(FLUID_SNAPSHOT, MPS_ERROR_ARGUMENT, "steps is ")                                             \
  ROW(FLUID_NO_SNAPSHOT, MPS_ERROR_ARGUMENT, "rank 1: snapshot is NULL")
enum { ODD_FLUID(CASE_NAME) FLUID_CASES };

static const trouble_case of_fluid[FLUID_CASES] = {ODD_FLUID(CASE_ROW)};

static mps_status wall(mps_fluid *fluid, int32_t kind, double x, double nx, double ny) {
  DEF(fluid_boundary, def, .kind = kind, .point[0] = x, .normal[0] = nx, .normal[1] = ny);
  return mps_fluid_add_boundary(fluid, &def, NULL);
}

static mps_status step_fluid(mps_fluid *fluid, int what, bool odd) {
  mps_snapshot *state[2] = {NULL, NULL};
  const double velocity[1] = {odd ? 0.02 : 0.01};
  mps_status status = MPS_OK;
  if (what == FLUID_MOTION) TRY(mps_fluid_set_boundary_motion(fluid, 1, NULL, velocity));
  if (what == FLUID_DT) {
    TRY(mps_fluid_begin_step(fluid, odd ? 1e-3 : 2e-3));
    TRY(mps_fluid_solve_pressure(fluid));
    TRY(mps_fluid_end_step(fluid));
  }
  for (int k = 0; k < 2; k++) {
    TRY(mps_fluid_step(fluid, 1));
    if (what >= FLUID_SNAPSHOT) TRY(mps_fluid_snapshot(fluid, &state[k]));
  }
  if (what >= FLUID_SNAPSHOT)
    TRY(mps_fluid_rollback(
        fluid, odd && what == FLUID_NO_SNAPSHOT ? NULL : state[odd && what == FLUID_SNAPSHOT]));
  TRY(mps_fluid_step(fluid, 1));
  for (int k = 0; k < 2; k++) mps_snapshot_destroy(&state[k]);
  return status;
}

static mps_status run_fluid(mps_context *own, mps_domain *domain, int what, int32_t rank) {
  const bool odd = rank == 1;
  DEF(fluid, def, .domain = domain);
  scoped_particles *set = NULL;
  scoped_fluid *fluid = NULL;
  if (odd && what == FLUID_ITERATIONS) def.iterations = 1999;
  if (odd && what == FLUID_LEVEL) def.level = 0.5;
  mps_status status = make_set(own, 0.02, 0.6, 0.4, &set);
  if (what == FLUID_RADIUS)
    TRY(mps_kernel_create(own, MPS_KERNEL_SMOOTH, odd ? 0.06 : 0.062, &def.kernel));
  TRY(mps_fluid_create(own, set, &def, &fluid));
  if (what == FLUID_GAMMA) TRY(mps_experimental_fluid_classical(fluid, odd ? 0.1 : 0.2));
  TRY(wall(fluid, MPS_BOUNDARY_ROLLER, 0.0, 0.0, 1.0));
  TRY(wall(fluid, odd && what == FLUID_KIND ? MPS_BOUNDARY_HELD : MPS_BOUNDARY_ROLLER, 0.0, 1.0,
           0.0));
  TRY(wall(fluid, MPS_BOUNDARY_ROLLER, 0.6, -1.0, 0.0));
  TRY(step_fluid(fluid, what, odd));
  mps_kernel_destroy(&def.kernel);
  return status;
}

TEST(test_fluid) { meet_troubles(run_fluid, of_fluid, FLUID_CASES); }

/* ---- explicit dynamics ----------------------------------------------------------------------- */

#define ODD_DYNAMICS(ROW)                                                                          \
  ROW(DYNAMICS_KERNEL, MPS_ERROR_ARGUMENT, "the kind of the kernel is ")                           \
  ROW(DYNAMICS_WATCH, MPS_ERROR_ARGUMENT, "watch_damping is ")                                     \
  ROW(DYNAMICS_PERIOD, MPS_ERROR_ARGUMENT, "period_x is ")                                         \
  ROW(DYNAMICS_HALF_SPACE, MPS_ERROR_ARGUMENT, "shear_velocity is ")                               \
  ROW(DYNAMICS_AREA, MPS_ERROR_ARGUMENT, "area is ")                                               \
  ROW(DYNAMICS_START, MPS_ERROR_ARGUMENT, "time is ")                                              \
  ROW(DYNAMICS_END, MPS_ERROR_ARGUMENT, "t_end")                                                   \
  ROW(DYNAMICS_SNAPSHOT, MPS_ERROR_ARGUMENT, "steps is ")                                          \
  ROW(DYNAMICS_NO_SNAPSHOT, MPS_ERROR_ARGUMENT, "rank 1: snapshot is NULL")                        \
  ROW(DYNAMICS_FILE, MPS_ERROR_ARGUMENT, "steps is ")
enum { ODD_DYNAMICS(CASE_NAME) DYNAMICS_CASES };

static const trouble_case of_dynamics[DYNAMICS_CASES] = {ODD_DYNAMICS(CASE_ROW)};

static mps_status step_dynamics(mps_dynamics *dynamics, int what, bool odd) {
  static const char *const file[2] = {TEST_TMP "/odd-3.h5", TEST_TMP "/odd-4.h5"};
  mps_snapshot *state[2] = {NULL, NULL};
  mps_status status = MPS_OK;
  const bool memory = what == DYNAMICS_SNAPSHOT || what == DYNAMICS_NO_SNAPSHOT;
  for (int k = 0; k < 2; k++) {
    TRY(mps_dynamics_step(dynamics, 2));
    if (memory) TRY(mps_dynamics_snapshot(dynamics, &state[k]));
    if (what == DYNAMICS_FILE) TRY(mps_dynamics_save(dynamics, file[k], NULL));
  }
  if (memory)
    TRY(mps_dynamics_rollback(dynamics, odd && what == DYNAMICS_NO_SNAPSHOT ? NULL : state[odd]));
  if (what == DYNAMICS_FILE) TRY(mps_dynamics_restore(dynamics, file[odd], NULL));
  TRY(mps_dynamics_step(dynamics, 2));
  if (what == DYNAMICS_END) TRY(mps_dynamics_run(dynamics, odd ? 0.2 : 0.1, 1, NULL, NULL));
  for (int k = 0; k < 2; k++) mps_snapshot_destroy(&state[k]);
  return status;
}

static mps_status run_dynamics(mps_context *own, mps_domain *domain, int what, int32_t rank) {
  const bool odd = rank == 1;
  DEF(dynamics, def, .domain = domain);
  scoped_particles *set = NULL;
  scoped_dynamics *dynamics = NULL;
  if (odd && what == DYNAMICS_WATCH) def.watch_damping = 1;
  if (what == DYNAMICS_PERIOD) def.period_x = odd ? 44.0 : 40.0;
  DEF(dynamics_boundary, base, .kind = MPS_BOUNDARY_ABSORBING, .lower[0] = 0.0, .upper[0] = 40.0,
      .lower[1] = 0.0, .upper[1] = 1.0,
      .shear_velocity = odd && what == DYNAMICS_HALF_SPACE ? 300.0 : 200.0);
  DEF(dynamics_load, load, .lower[0] = 0.0, .upper[0] = 40.0, .lower[1] = 29.0, .upper[1] = 30.0,
      .traction[0] = 1.0, .area = odd && what == DYNAMICS_AREA ? 2.0 : 1.0);
  mps_status status = make_set(own, 1.0, 40.0, 30.0, &set);
  TRY(mps_particles_set(set, "shear_velocity", 0, 150.0));
  TRY(mps_particles_set(set, "pressure_velocity", 0, 300.0));
  if (what == DYNAMICS_KERNEL)
    TRY(mps_kernel_create(own, odd ? MPS_KERNEL_SPLINE3 : MPS_KERNEL_MPS, 1.5, &def.kernel));
  TRY(mps_dynamics_create(own, set, &def, &dynamics));
  TRY(mps_dynamics_add_boundary(dynamics, &base, NULL));
  TRY(mps_dynamics_add_load(dynamics, &load, NULL));
  if (what == DYNAMICS_START) TRY(mps_dynamics_restart(dynamics, odd ? 1.0 : 0.0));
  TRY(step_dynamics(dynamics, what, odd));
  mps_kernel_destroy(&def.kernel);
  return status;
}

TEST(test_dynamics) { meet_troubles(run_dynamics, of_dynamics, DYNAMICS_CASES); }

/* ---- a rank that falls silent ---------------------------------------------------------------- */

/* At one call of the transport after the other, until it makes no more: every rank ends, with an
 * error. `run` makes no other trouble. */
static void lose_partner(trouble_fn *run, int what) {
  int lost = 0;
  for (int64_t deaf = 2;; deaf += 5) {
    troubled s = {.run = run, .what = what};
    team t;
    team_begin(&t, 3);
    t.member[1].deaf_at = deaf;
    team_run(&t, run_troubled, &s);
    team_end(&t);
    if (s.status[0] == MPS_OK && s.status[1] == MPS_OK && s.status[2] == MPS_OK) break;
    for (int32_t r = 0; r < 3; r++)
      if (s.status[r] != MPS_ERROR_IO)
        fail_msg("call %d, rank %d: %d %s", (int)deaf, (int)r, (int)s.status[r], s.message[r]);
    lost++;
  }
  assert_true(lost > 5);
}

TEST(test_lost_partner) {
  lose_partner(run_mpm, MPM_CASES);
  lose_partner(run_fluid, FLUID_CASES);
  lose_partner(run_dynamics, DYNAMICS_CASES);
}
