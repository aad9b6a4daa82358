/* test_load_factors.c - numbers in time: tables that are linear between samples, or change in
 * steps; the factor on a load that each solver takes from one, to rounding; and that a load takes
 * no motion, a boundary or body no number. SPDX-License-Identifier: BSD-3-Clause */
#include "kit/block.h"

#define VALUE MPS_SIGNAL_QUANTITY_VALUE

/* A load that comes within a hundredth of the time before: a spline through it goes to -19. */
enum { SAMPLES = 6 };
static const double jump_at[SAMPLES] = {0.0, 1.0, 1.01, 2.0, 3.0, 4.0};
static const double jump_to[SAMPLES] = {0.0, 0.0, 1.0, 1.0, 1.0, 1.0};

static mps_signal *jump(int32_t quantity, double scale) {
  double t[SAMPLES];
  for (int k = 0; k < SAMPLES; k++) t[k] = scale * jump_at[k];
  MAKE_KEPT(signal, signal, create_table, context, quantity, SAMPLES, t, jump_to);
  return signal;
}

static double jump_value(double t) { return t <= 1.0 ? 0.0 : t >= 1.01 ? 1.0 : (t - 1.0) / 0.01; }

/* ---- signals --------------------------------------------------------------------------------- */

TEST(a_table_is_linear_between_its_samples) {
  const double t[5] = {-1.0, 0.0, 0.1, 3.0, 3.5}, v[5] = {2.0, -1.0, 4.0, 4.0, -8.0};
  mps_signal *line = NULL, *steps = NULL;
  OK(mps_signal_create_table(context, VALUE, 5, t, v, &line));
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VALUE_STEPS, 5, t, v, &steps));
  for (int k = 0; k < 5; k++) {
    assert_true(mps_signal_value(line, t[k]) == v[k]);
    assert_true(mps_signal_value(steps, t[k]) == v[k]);
    for (int j = 1; k < 4 && j < 10; j++) {
      const double x = 0.1 * j, at = t[k] + x * (t[k + 1] - t[k]);
      NEAR(mps_signal_value(line, at), v[k] + x * (v[k + 1] - v[k]), 1e-14);
      assert_true(mps_signal_value(steps, at) == v[k]);
    }
  }
  for (double far = 4.0; far < 1e9; far *= 10.0) {
    assert_true(mps_signal_value(line, -far) == v[0] && mps_signal_value(steps, -far) == v[0]);
    assert_true(mps_signal_value(line, far) == v[4] && mps_signal_value(steps, far) == v[4]);
  }
  assert_true(isnan(mps_signal_value(line, NAN)));
  mps_signal_destroy(&line);
  mps_signal_destroy(&steps);
  scoped_signal *late = jump(VALUE, 1.0);
  for (double at = -1.0; at < 5.0; at += 0.0037)
    NEAR(mps_signal_value(late, at), jump_value(at), 1e-13);
  assert_true(mps_signal_value(late, 0.6) == 0.0);
}

static mps_status line_of_time(void *user, double t, double motion[3]) {
  motion[0] = *(const double *)user * t;
  return MPS_OK; /* nothing else is read of a number */
}

/* A formula or function is one course, read as a motion or as a number, and never as both. */
TEST(a_number_is_no_motion) {
  double slope = 3.0;
  for (int kind = 0; kind < 3; kind++) {
    mps_signal *both[2] = {NULL, NULL};
    for (int k = 0; k < 2; k++) {
      const int32_t quantity = k == 0 ? MPS_SIGNAL_QUANTITY_DISPLACEMENT : VALUE;
      if (kind == 0)
        OK(mps_signal_create_sine(context, quantity, 2.0, 3.0, 0.4, &both[k]));
      else if (kind == 1)
        OK(mps_signal_create_ramp(context, quantity, 0.1, 0.5, -2.0, &both[k]));
      else if (k == 1)
        OK(mps_signal_create_user(context, quantity, line_of_time, &slope, NULL, &both[k]));
    }
    for (double t = -0.2; t < 1.0; t += 0.13) {
      const double value = mps_signal_value(both[1], t);
      assert_true(value == (kind == 2 ? slope * t : mps_signal_displacement(both[0], t)));
      assert_true(isnan(mps_signal_displacement(both[1], t)));
      assert_true(isnan(mps_signal_velocity(both[1], t)));
      assert_true(isnan(mps_signal_acceleration(both[1], t)));
      if (kind < 2) assert_true(isnan(mps_signal_value(both[0], t)));
    }
    mps_signal_destroy(&both[0]);
    mps_signal_destroy(&both[1]);
  }
  scoped_signal *none = NULL;
  assert_true(mps_signal_value(NULL, 1.0) == 0.0);
  REFUSES(mps_signal_create_sine(context, 0, 1.0, 1.0, 0.0, &none),
          "quantity is MPS_SIGNAL_QUANTITY_ACCELERATION, allowed are");
  REFUSES(mps_signal_create_ramp(context, 4, 0.0, 1.0, 0.0, &none),
          "quantity is MPS_SIGNAL_QUANTITY_VALUE_STEPS, allowed are");
  REFUSES(mps_signal_create_user(context, 1, line_of_time, &slope, NULL, &none),
          "quantity is MPS_SIGNAL_QUANTITY_VELOCITY, allowed are");
  REFUSES(mps_signal_create_table(context, 5, SAMPLES, jump_at, jump_to, &none),
          "quantity is 5, allowed are");
  /* of a number only its size is bounded */
  OK(mps_signal_create_ramp(context, VALUE, 0.0, 1e-90, 1e200, &none));
  assert_true(mps_signal_value(none, 1.0) == 1e200);
}

/* ---- solvers --------------------------------------------------------------------------------- */

/* A block that no boundary holds is pushed along x by the same force on each particle, which the
 * factor multiplies: what one step adds to its momentum is m b factor dt, with the factor at the
 * time that the step begins. */
#define FOLLOWS(S, add_load, factor_of)                                                            \
  static void S##_takes_the_factor(mps_##S *solver) {                                              \
    mps_signal *signal = jump(VALUE, 0.005);                                                       \
    add_load;                                                                                      \
    mps_signal_destroy(&signal);                                                                   \
    double before = 0.0, largest = 0.0;                                                            \
    while (mps_##S##_time(solver) < 0.0075) {                                                      \
      const double t = mps_##S##_time(solver);                                                     \
      mps_totals sum;                                                                              \
      OK(mps_##S##_step(solver, 1));                                                               \
      OK(mps_##S##_get_totals(solver, &sum));                                                      \
      const double dt = mps_##S##_time(solver) - t, gain = (factor_of);                            \
      NEAR((gain - before) / dt, jump_value(t / 0.005), 1e-9);                                     \
      largest = fmax(largest, (gain - before) / dt);                                               \
      before = gain;                                                                               \
    }                                                                                              \
    NEAR(largest, 1.0, 1e-9);                                                                      \
  }

static void push_mpm(mps_mpm *mpm, mps_signal *signal) {
  int64_t ids[32];
  for (int k = 0; k < 32; k++) ids[k] = k;
  DEF(mpm_load, def, .ids = ids, .id_count = 32);
  def.traction[0] = 100.0, def.signal[0] = signal; /* 10 N on 10 kg */
  OK(mps_mpm_add_load(mpm, &def, NULL));
}

static void push_dynamics(mps_dynamics *dynamics, mps_signal *signal) {
  USING(dynamics_load, mps_dynamics_add_load(dynamics, &given, NULL),
        .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1, .acceleration[0] = 1.0, .signal[0] = signal);
}

static void push_fluid(mps_fluid *fluid, mps_signal *signal) {
  DEF(fluid_load, def, .all = 1, .acceleration[0] = 1.0, .signal[0] = signal);
  OK(mps_fluid_add_load(fluid, &def, NULL));
}

FOLLOWS(mpm, push_mpm(solver, signal), sum.linear[0] / sum.mass)
FOLLOWS(dynamics, push_dynamics(solver, signal), sum.linear[0] / sum.mass)
FOLLOWS(fluid, push_fluid(solver, signal), sum.impulse_loads[0] / sum.mass)

TEST(explicit_solvers_take_the_factor_of_a_table) {
  scoped_particles *set = block();
  scoped_material *material = rubber();
  DEF(mpm, mpm_def, .cell = 0.2, .dt = 1e-4);
  scoped_dynamics *dynamics = NULL;
  MAKE(mpm, mpm, create, context, set, material, &mpm_def);
  mpm_takes_the_factor(mpm);
  mps_particles_destroy(&set);
  set = block();
  DEF(dynamics, dynamics_def, .material = material, .dt = 1e-4);
  dynamics_def.integrator = MPS_DYNAMICS_INTEGRATOR_EULER; /* of one force a step */
  OK(mps_dynamics_create(context, set, &dynamics_def, &dynamics));
  dynamics_takes_the_factor(dynamics);
  mps_particles_destroy(&set);
  set = block();
  DEF(fluid, fluid_def, .gravity[1] = 0.0, .dt = 1e-4);
  MAKE(fluid, fluid, create, context, set, &fluid_def);
  fluid_takes_the_factor(fluid);
}

/* 1 kPa on the right face of a bar 0.4 m high: at the time of each solution or step. */
TEST(implicit_elasticity_takes_the_factor_of_a_table) {
  scoped_particles *set = block();
  DEF(elastic, def, .material = rubber());
  mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
  int64_t facets[8], count;
  MAKE(elastic, elastic, create, context, set, &def);
  for (int c = 0; c < 2; c++) foot.lower[c] = -9.0, foot.upper[c] = 9.0;
  foot.upper[0] = 0.1;
  OK(mps_elastic_add_boundary(elastic, &foot, NULL));
  OK(mps_elastic_select_facets(elastic, MPS_SIDE_X_UPPER, NULL, NULL, 8, &count, facets));
  DEF(elastic_load, load, .kind = MPS_ELASTIC_LOAD_TRACTION, .ids = facets, .id_count = count,
      .force[0] = 1e3, .signal[0] = jump(VALUE, 1.0));
  OK(mps_elastic_add_load(elastic, &load, NULL));
  USING(elastic_motion, mps_elastic_start(elastic, &given), .dt = 0.067);
  for (int k = 0; k < 64; k++) {
    double force[3];
    OK(mps_elastic_step(elastic, 1));
    OK(mps_elastic_get_load_resultant(elastic, NULL, force, NULL));
    NEAR(force[0], 400.0 * jump_value(mps_elastic_time(elastic)), 1e-9);
  }
  mps_signal_destroy(&load.signal[0]);
  mps_material_destroy(&def.material);
}

/* ---- refusals -------------------------------------------------------------------------------- */

#define NO_MOTION(call)                                                                            \
  REFUSES(call, "is a motion, and a factor in time is a number: create it with "                   \
                "MPS_SIGNAL_QUANTITY_VALUE")
#define NO_NUMBER(call) REFUSES(call, "needs a motion: create it with")

TEST(each_takes_its_own_kind_alone) {
  mps_particles *set[4] = {block(), block(), block(), block()};
  scoped_material *material = rubber();
  mps_mpm_def mpm_def = mps_mpm_defaults();
  mps_dynamics_def dynamics_def = mps_dynamics_defaults();
  scoped_elastic *elastic = NULL;
  mpm_def.cell = 0.2, mpm_def.lower[1] = 0.0, dynamics_def.material = material;
  MAKE(mpm, mpm, create, context, set[0], material, &mpm_def);
  MAKE(dynamics, dynamics, create, context, set[1], &dynamics_def);
  USING(elastic, mps_elastic_create(context, set[2], &given, &elastic), .material = material);
  MAKE(fluid, fluid, create, context, set[3], NULL);
  MAKE(body, body, create_disc, context, NULL, 0.1);
  scoped_signal *number = jump(VALUE, 1.0), *motion = jump(MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0);
  const int64_t id = 3;
  DEF(mpm_load, ml, .ids = &id, .id_count = 1, .signal[1] = motion);
  NO_MOTION(mps_mpm_add_load(mpm, &ml, NULL));
  DEF(dynamics_load, dl, .ids = &id, .id_count = 1, .signal[1] = motion);
  NO_MOTION(mps_dynamics_add_load(dynamics, &dl, NULL));
  DEF(elastic_load, el, .signal[0] = motion);
  NO_MOTION(mps_elastic_add_load(elastic, &el, NULL));
  DEF(fluid_load, fl, .signal[0] = motion);
  NO_MOTION(mps_fluid_add_load(fluid, &fl, NULL));
  DEF(mpm_boundary, mb, .kind = MPS_BOUNDARY_DRIVEN, .signal[0] = number);
  NO_NUMBER(mps_mpm_set_boundary(mpm, MPS_SIDE_Y_LOWER, &mb));
  mb.ids = &id, mb.id_count = 1;
  NO_NUMBER(mps_mpm_add_boundary(mpm, &mb, NULL));
  DEF(dynamics_boundary, db, .ids = &id, .id_count = 1, .kind = MPS_BOUNDARY_DRIVEN,
      .signal[1] = number);
  NO_NUMBER(mps_dynamics_add_boundary(dynamics, &db, NULL));
  DEF(elastic_boundary, eb, .ids = &id, .id_count = 1, .kind = MPS_BOUNDARY_DRIVEN,
      .signal[0] = number);
  NO_NUMBER(mps_elastic_add_boundary(elastic, &eb, NULL));
  DEF(fluid_boundary, fb, .kind = MPS_BOUNDARY_DRIVEN, .signal = number, .normal[1] = 1.0);
  NO_NUMBER(mps_fluid_add_boundary(fluid, &fb, NULL));
  NO_NUMBER(mps_body_drive(body, 0, number, 1.0));
  mps_signal_destroy(&motion);
  for (int k = 0; k < 4; k++) mps_particles_destroy(&set[k]);
}
