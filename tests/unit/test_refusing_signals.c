/* test_refusing_signals.c - a function of the caller that refuses a motion
 * (mps_signal_create_user): every call that evaluates it returns the caller's status with a record
 * that names the signal, whose it is and the time; nothing has changed, and the run continues as if
 * it had never refused. SPDX-License-Identifier: BSD-3-Clause */
#include "unchanged.h"
#include "test_fixture.h"

SEEN_SOLVER(mpm)
SEEN_SOLVER(dynamics)
SEEN_SOLVER(elastic)
SEEN_SOLVER(fluid)

typedef struct source {
  bool refuses;
  mps_status with;
  double gives; /* what else is added to the displacement */
} source;

static mps_status shake(void *user, double t, double motion[3]) {
  const source *s = user;
  const double w = 20.0, a = 1e-4;
  if (s->refuses) return s->with;
  motion[0] = a * (1.0 - cos(w * t)) + s->gives, motion[1] = a * w * sin(w * t);
  motion[2] = a * w * w * cos(w * t);
  return MPS_OK;
}

static source from;

static mps_signal *shaking_as(int32_t quantity) {
  from = (source){.with = MPS_ERROR_IO};
  MAKE_KEPT(signal, signal, create_user, context, quantity, shake, &from, NULL);
  return signal;
}

static mps_signal *shaking(void) { return shaking_as(MPS_SIGNAL_QUANTITY_DISPLACEMENT); }

/* ---- a solver whose boundary, load or body follows the signal -------------------------------- */

typedef struct scene {
  mps_particles *set;
  void *solver;
  mps_signal *signal, *factor; /* one function as a motion and as a number */
  mps_body *body;
  const char *object, *signal_name; /* as a record names them */
} scene;

static mps_particles *block(double spacing) {
  mps_particles *set = box_of(context, spacing, AT(0.0, 0.0), AT(0.8, 0.4));
  SET_FIELDS(set, {"density", 2000.0}, {"velocity", 0.0});
  return set;
}

static mps_material *stuff(void) {
  MAKE_KEPT(material, material, create_linear_elastic, context, 1e6, 0.25);
  return material;
}

static const int64_t some_ids[2] = {20, 21};

static mps_mpm *begin_mpm(scene *s) {
  scoped_material *material = stuff();
  s->set = block(0.1);
  DEF(mpm, def, .cell = 0.2);
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = 0.8;
  OK(mps_mpm_create(context, s->set, material, &def, (mps_mpm **)&s->solver));
  return s->solver;
}

static void mpm_boundary(scene *s) {
  DEF(mpm_boundary, side, .kind = MPS_BOUNDARY_DRIVEN, .signal[0] = s->signal);
  OK(mps_mpm_set_boundary(begin_mpm(s), MPS_SIDE_Y_LOWER, &side));
  s->object = "boundary 2", s->signal_name = "signal[0] of boundary 2";
}

static void mpm_load(scene *s) {
  DEF(mpm_load, def, .ids = some_ids, .id_count = 2, .traction[1] = 1e3, .signal[1] = s->factor);
  OK(mps_mpm_add_load(begin_mpm(s), &def, NULL));
  s->object = "load 0", s->signal_name = "signal[1] of load 0";
}

static void mpm_body(scene *s) {
  DEF(body, def, .position[0] = 0.4, .position[1] = 0.56);
  OK(mps_body_create_disc(context, &def, 0.15, &s->body));
  OK(mps_body_drive(s->body, 1, s->signal, -10.0));
  OK(mps_mpm_add_contact(begin_mpm(s), s->body, NULL, NULL));
  s->object = "body 0", s->signal_name = "signal[1] of body 0";
}

static void begin_dynamics(scene *s) {
  s->set = block(0.1);
  DEF(dynamics, def, .material = stuff());
  OK(mps_dynamics_create(context, s->set, &def, (mps_dynamics **)&s->solver));
  mps_material_destroy(&def.material);
}

static void dynamics_boundary(scene *s) {
  begin_dynamics(s);
  DEF(dynamics_boundary, base, .kind = MPS_BOUNDARY_DRIVEN, .lower[0] = base.lower[1] = -1.0,
      .upper[0] = 9.0, .upper[1] = 0.1, .dofs = MPS_DOF_Y, .signal[1] = s->signal);
  OK(mps_dynamics_add_boundary(s->solver, &base, NULL));
  s->object = "boundary 0", s->signal_name = "signal[1] of boundary 0";
}

static void dynamics_load(scene *s) {
  begin_dynamics(s);
  USING(dynamics_load, mps_dynamics_add_load(s->solver, &given, NULL), .ids = some_ids,
        .id_count = 2, .traction[0] = 1e3, .signal[0] = s->factor);
  s->object = "load 0", s->signal_name = "signal[0] of load 0";
}

static void begin_elastic(scene *s, mps_signal *base, mps_signal *load) {
  mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
  mps_elastic_load_def weight = mps_elastic_load_defaults();
  s->set = block(0.1);
  DEF(elastic, def, .material = stuff());
  OK(mps_elastic_create(context, s->set, &def, (mps_elastic **)&s->solver));
  foot.lower[0] = foot.lower[1] = -1.0, foot.upper[0] = 9.0, foot.upper[1] = 0.1;
  foot.kind = base ? MPS_BOUNDARY_DRIVEN : MPS_BOUNDARY_HELD;
  foot.signal[0] = base;
  OK(mps_elastic_add_boundary(s->solver, &foot, NULL));
  weight.kind = MPS_ELASTIC_LOAD_BODY, weight.all = 1;
  weight.force[1] = -9.81, weight.signal[1] = load;
  OK(mps_elastic_add_load(s->solver, &weight, NULL));
  USING(elastic_motion, mps_elastic_start(s->solver, &given), .dt = 4e-3);
  mps_material_destroy(&def.material);
}

static void elastic_boundary(scene *s) {
  begin_elastic(s, s->signal, NULL);
  s->object = "boundary 0", s->signal_name = "signal[0] of boundary 0";
}

static void elastic_load(scene *s) {
  begin_elastic(s, NULL, s->factor);
  s->object = "load 0", s->signal_name = "signal[1] of load 0";
}

static void begin_fluid(scene *s, mps_signal *piston) {
  const double wall[3][4] = {{0, 0, 0, 1}, {0, 0, 1, 0}, {0.8, 0, -1, 0}};
  s->set = block(0.05);
  OK(mps_fluid_create(context, s->set, NULL, (mps_fluid **)&s->solver));
  for (int k = 0; k < 3; k++) {
    mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
    def.kind = MPS_BOUNDARY_ROLLER; /* slip */
    for (int c = 0; c < 2; c++) def.point[c] = wall[k][c], def.normal[c] = wall[k][2 + c];
    if (k == 1) def.signal = piston;
    OK(mps_fluid_add_boundary(s->solver, &def, NULL));
  }
}

static void fluid_boundary(scene *s) {
  begin_fluid(s, s->signal);
  s->object = "boundary 1", s->signal_name = "signal of boundary 1";
}

static void fluid_load(scene *s) {
  begin_fluid(s, NULL);
  USING(fluid_load, mps_fluid_add_load(s->solver, &given, NULL), .kind = MPS_FLUID_LOAD_BODY,
        .all = 1, .acceleration[0] = 1.0, .signal[0] = s->factor);
  s->object = "load 0", s->signal_name = "signal[0] of load 0";
}

/* ---- steps ----------------------------------------------------------------------------------- */

#define VERBS(S)                                                                                   \
  static mps_status S##_step(void *s) { return mps_##S##_step(s, 1); }                             \
  static mps_status S##_run(void *s) {                                                             \
    return mps_##S##_run(s, mps_##S##_time(s) + 5e-3, 1, NULL, NULL);                              \
  }                                                                                                \
  static uint64_t S##_seen(void *s) { return seen_##S(s, false); }                                 \
  static void S##_destroy(void **s) { mps_##S##_destroy((mps_##S **)s); }
VERBS(mpm)
VERBS(dynamics)
VERBS(elastic)
VERBS(fluid)

typedef struct row {
  void (*make)(scene *s);
  mps_status (*step)(void *s), (*run)(void *s);
  uint64_t (*seen)(void *s);
  void (*destroy)(void **s);
  const char *step_name, *run_name;
} row;

#define ROW(make, S)                                                                               \
  { make, S##_step, S##_run, S##_seen, S##_destroy, "mps_" #S "_step", "mps_" #S "_run" }
static const row rows[] = {
    ROW(mpm_boundary, mpm),           ROW(mpm_load, mpm),           ROW(mpm_body, mpm),
    ROW(dynamics_boundary, dynamics), ROW(dynamics_load, dynamics), ROW(elastic_boundary, elastic),
    ROW(elastic_load, elastic),       ROW(fluid_boundary, fluid),   ROW(fluid_load, fluid)};

/* The record of a refusal with `status` by `function`. */
static void check_record(const scene *s, const char *function, mps_status status) {
  const mps_error *error = mps_context_error(context);
  assert_int_equal(error->status, status);
  assert_string_equal(error->function, function);
  assert_string_equal(error->object, s->object);
  if (!strstr(error->message, s->signal_name) || !strstr(error->message, "at t = "))
    fail_msg("\"%s\" does not name %s and a time", error->message, s->signal_name);
}

static uint64_t seen(const row *r, const scene *s) {
  const uint64_t hash = r->seen(s->solver);
  return s->body ? hash ^ seen_body(s->body) : hash;
}

/* The state is at the end of `steps` steps; the signal refuses on the way, or not. */
static uint64_t take_steps(const row *r, bool refuses) {
  scene s = {.signal = shaking(), .factor = shaking_as(MPS_SIGNAL_QUANTITY_VALUE)};
  r->make(&s);
  for (int k = 0; k < 4; k++) {
    (void)seen(r, &s); /* totals find pressures anew */
    const uint64_t before = seen(r, &s);
    from.refuses = refuses;
    if (refuses) {
      assert_int_equal(r->step(s.solver), MPS_ERROR_IO);
      check_record(&s, r->step_name, MPS_ERROR_IO);
      if (seen(r, &s) != before) fail_msg("%s, %s: changed", r->step_name, s.object);
      assert_int_equal(r->run(s.solver), MPS_ERROR_IO);
      check_record(&s, r->run_name, MPS_ERROR_IO);
      if (seen(r, &s) != before) fail_msg("%s, %s: changed", r->run_name, s.object);
    }
    from.refuses = false;
    OK(r->step(s.solver));
  }
  const uint64_t end = seen(r, &s);
  r->destroy(&s.solver);
  mps_body_destroy(&s.body);
  mps_signal_destroy(&s.signal);
  mps_signal_destroy(&s.factor);
  mps_particles_destroy(&s.set);
  return end;
}

TEST(refusals_come_back_and_change_nothing) {
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
    if (take_steps(&rows[k], true) != take_steps(&rows[k], false))
      fail_msg("row %zu, %s: the run differs after a refusal", k, rows[k].step_name);
}

/* A status that is none, and a motion that is no number. */
TEST(odd_answers_have_names) {
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    scene s = {.signal = shaking(), .factor = shaking_as(MPS_SIGNAL_QUANTITY_VALUE)};
    rows[k].make(&s);
    from.refuses = true, from.with = (mps_status)77;
    assert_int_equal(rows[k].step(s.solver), MPS_ERROR_ARGUMENT);
    check_record(&s, rows[k].step_name, MPS_ERROR_ARGUMENT);
    assert_non_null(strstr(mps_context_error(context)->message, "77"));
    from.refuses = false, from.gives = NAN;
    assert_int_equal(rows[k].step(s.solver), MPS_ERROR_NUMERIC);
    check_record(&s, rows[k].step_name, MPS_ERROR_NUMERIC);
    from.gives = 0.0;
    OK(rows[k].step(s.solver));
    rows[k].destroy(&s.solver);
    mps_body_destroy(&s.body);
    mps_signal_destroy(&s.signal);
    mps_signal_destroy(&s.factor);
    mps_particles_destroy(&s.set);
  }
}

/* ---- calls besides steps --------------------------------------------------------------------- */

#define REFUSED(s, call, function, hash)                                                           \
  do {                                                                                             \
    const uint64_t refused_before = (hash);                                                        \
    from.refuses = true;                                                                           \
    assert_int_equal((call), MPS_ERROR_IO);                                                        \
    from.refuses = false;                                                                          \
    check_record(s, function, MPS_ERROR_IO);                                                       \
    assert_true((hash) == refused_before);                                                         \
  } while (0)

TEST(bodies_stay_where_they_are) {
  scene s = {.signal = shaking(), .object = "body", .signal_name = "signal[1] of the body"};
  mps_body_motion motion = mps_body_motion_defaults();
  OK(mps_body_create_disc(context, NULL, 0.15, &s.body));
  REFUSED(&s, mps_body_drive(s.body, 1, s.signal, 1.0), "mps_body_drive", seen_body(s.body));
  OK(mps_body_advance(s.body, 0.01));
  mps_body_state at;
  OK(mps_body_get_state(s.body, &at));
  assert_true(at.position[1] == 0.0); /* the signal was not taken */
  OK(mps_body_drive(s.body, 1, s.signal, 1.0));
  REFUSED(&s, mps_body_advance(s.body, 0.01), "mps_body_advance", seen_body(s.body));
  REFUSED(&s, mps_body_drive(s.body, 0, NULL, 1.0), "mps_body_drive", seen_body(s.body));
  motion.velocity[0] = 1.0;
  OK(mps_body_set_motion(s.body, &motion));
  REFUSED(&s, mps_body_set_motion(s.body, NULL), "mps_body_set_motion", seen_body(s.body));
  from.refuses = true; /* a signal that is not used any more is not evaluated */
  OK(mps_body_drive(s.body, 1, NULL, 1.0));
  from.refuses = false;
  mps_body_destroy(&s.body);
  mps_signal_destroy(&s.signal);
  mps_signal_destroy(&s.factor);
}

TEST(boundaries_of_mpm_are_not_made) {
  scene s = {.signal = shaking(), .factor = shaking_as(MPS_SIGNAL_QUANTITY_VALUE)};
  scoped_mpm *mpm = begin_mpm(&s);
  DEF(mpm_boundary, def, .kind = MPS_BOUNDARY_DRIVEN, .signal[1] = s.signal, .ids = some_ids,
      .id_count = 2);
  int32_t number = -5;
  s.object = "boundary 6", s.signal_name = "signal[1] of boundary 6";
  REFUSED(&s, mps_mpm_add_boundary(mpm, &def, &number), "mps_mpm_add_boundary",
          seen_mpm(mpm, false));
  assert_int_equal(number, -5);
  OK(mps_mpm_add_boundary(mpm, &def, &number));
  REFUSED(&s, mps_mpm_set_boundary(mpm, number, &def), "mps_mpm_set_boundary",
          seen_mpm(mpm, false));
  mps_grid *grid = mps_mpm_grid(mpm);
  int64_t count = 0;
  REFUSED(&s, mps_grid_get_nodes(grid, 0, &count, NULL, NULL, NULL, NULL), "mps_grid_get_nodes",
          seen_mpm(mpm, false));
  mps_signal_destroy(&s.signal);
  mps_signal_destroy(&s.factor);
  mps_particles_destroy(&s.set);
}

TEST(steps_of_a_fluid_in_parts_go_on) {
  scene s = {.signal = shaking(), .factor = shaking_as(MPS_SIGNAL_QUANTITY_VALUE)};
  double end[2] = {0.0, 0.0};
  for (int refuses = 0; refuses < 2; refuses++) {
    from = (source){.with = MPS_ERROR_IO};
    fluid_boundary(&s);
    mps_fluid *fluid = s.solver;
    mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
    def.kind = MPS_BOUNDARY_ROLLER; /* slip */
    def.point[0] = -0.2, def.normal[0] = 1.0, def.signal = s.signal;
    s.object = "boundary 3", s.signal_name = "signal of boundary 3";
    if (refuses)
      REFUSED(&s, mps_fluid_add_boundary(fluid, &def, NULL), "mps_fluid_add_boundary",
              seen_fluid(fluid, false));
    s.object = "boundary 1", s.signal_name = "signal of boundary 1";
    if (refuses)
      REFUSED(&s, mps_fluid_set_boundary(fluid, 1, &def), "mps_fluid_set_boundary",
              seen_fluid(fluid, false));
    if (refuses)
      REFUSED(&s, mps_fluid_begin_step(fluid, 1e-3), "mps_fluid_begin_step",
              seen_fluid(fluid, false));
    OK(mps_fluid_begin_step(fluid, 1e-3));
    for (int k = 0; k < 2; k++) {
      from.refuses = refuses;
      if (refuses) assert_int_equal(mps_fluid_solve_pressure(fluid), MPS_ERROR_IO);
      if (refuses) check_record(&s, "mps_fluid_solve_pressure", MPS_ERROR_IO);
      from.refuses = false;
      OK(mps_fluid_solve_pressure(fluid));
    }
    from.refuses = true; /* the step's last part has what it needs, and so has the limit */
    OK(mps_fluid_end_step(fluid));
    assert_true(mps_fluid_limit(fluid) > 0.0);
    from.refuses = false;
    OK(mps_fluid_step(fluid, 2));
    const uint64_t hash = seen_fluid(fluid, false);
    memcpy(&end[refuses], &hash, sizeof hash);
    mps_fluid_destroy(&fluid);
    mps_particles_destroy(&s.set);
  }
  assert_memory_equal(&end[0], &end[1], sizeof end[0]);
  mps_signal_destroy(&s.signal);
  mps_signal_destroy(&s.factor);
}
