/* test_callbacks.c - one rule for every callback of every solver: it may read the solver and its
 * set, and nothing else. Each solver is called from the callback of a run, from a signal of the
 * caller's and from the cancel hook to step, to change, to go back and to die, and its set to be
 * edited, filled and emptied: MPS_ERROR_STATE, and the run continues as if it had not been called.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "digest.h"
#include "test_fixture.h"

/* ---- four solvers, called alike -------------------------------------------------------------- */

typedef struct verbs {
  const char *name;
  mps_status (*step)(void *s);
  mps_status (*run)(void *s, double t_end, void *user); /* user NULL: no callback */
  mps_status (*set_dt)(void *s);
  mps_status (*snapshot)(void *s, mps_snapshot **to);
  mps_status (*rollback)(void *s, const mps_snapshot *to);
  mps_status (*save)(void *s, const char *path);
  void (*destroy)(void **s);
  int64_t (*steps)(const void *s);
} verbs;

static mps_status from_run(void *user, void *solver);

#define VERBS(S)                                                                                   \
  static mps_status S##_seen(void *user, mps_##S *s) { return from_run(user, s); }                 \
  static mps_status S##_step(void *s) { return mps_##S##_step(s, 1); }                             \
  static mps_status S##_run(void *s, double t, void *user) {                                       \
    return mps_##S##_run(s, t, 2, user ? S##_seen : NULL, user);                                   \
  }                                                                                                \
  static mps_status S##_set_dt(void *s) { return mps_##S##_set_dt(s, 1e-4); }                      \
  static mps_status S##_snapshot(void *s, mps_snapshot **to) { return mps_##S##_snapshot(s, to); } \
  static mps_status S##_rollback(void *s, const mps_snapshot *to) {                                \
    return mps_##S##_rollback(s, to);                                                              \
  }                                                                                                \
  static mps_status S##_save(void *s, const char *path) { return mps_##S##_save(s, path, NULL); }  \
  static void S##_destroy(void **s) { mps_##S##_destroy((mps_##S **)s); }                          \
  static int64_t S##_steps(const void *s) { return mps_##S##_steps(s); }                           \
  static const verbs of_##S = {#S,           S##_step, S##_run,     S##_set_dt, S##_snapshot,      \
                               S##_rollback, S##_save, S##_destroy, S##_steps};

VERBS(mpm)
VERBS(dynamics)
VERBS(elastic)
VERBS(fluid)

typedef struct scene {
  const verbs *verb;
  void *solver;
  mps_particles *set;
  mps_signal *signal;
  mps_snapshot *before, *now;
  double end;   /* s, of the run */
  bool asks;    /* whether callbacks call at all */
  bool within;  /* the solver is at work */
  int asked[3]; /* from the run, a signal, the cancel hook */
} scene;

enum { FROM_RUN, FROM_SIGNAL, FROM_HOOK };

#define REFUSED(call) FAILS(call, MPS_ERROR_STATE, "")

static void ask_for_everything(scene *s, int from) {
  const verbs *v = s->verb;
  const double place[2] = {0.31, 0.33};
  const int64_t id = 3;
  mps_edit edit;
  void *same = s->solver;
  if (!s->asks || !s->within) return;
  s->asked[from]++;
  REFUSED(v->step(s->solver));
  REFUSED(v->run(s->solver, 9.0, NULL));
  REFUSED(v->set_dt(s->solver));
  REFUSED(v->rollback(s->solver, s->before));
  v->destroy(&same);
  assert_ptr_equal(same, s->solver);
  REFUSED(mps_particles_edit(s->set, "velocity", &edit));
  assert_null(edit.data);
  assert_non_null(strstr(mps_context_error(context)->message, "may only read"));
  REFUSED(mps_particles_set(s->set, "external_force", 0, 1.0));
  REFUSED(mps_particles_set_array(s->set, "external_force", -1, NULL, 0));
  REFUSED(mps_particles_remove_field(s->set, "user.own"));
  REFUSED(mps_particles_append(s->set, 1, place));
  REFUSED(mps_particles_remove(s->set, &id, 1));
  (void)view_field(s->set, "position");
  scoped_particles *copy = NULL;
  OK(mps_particles_copy(s->set, &copy));
  if (from == FROM_RUN) { /* between two steps: what only reads the state is allowed */
    OK(v->snapshot(s->solver, &s->now));
  } else {
    REFUSED(v->snapshot(s->solver, &s->now));
    REFUSED(v->save(s->solver, "test_callbacks.h5"));
  }
}

static mps_status from_run(void *user, void *solver) {
  scene *s = user;
  assert_ptr_equal(solver, s->solver);
  ask_for_everything(s, FROM_RUN);
  return MPS_OK;
}

static mps_status from_signal(void *user, double t, double motion[3]) {
  const double w = 20.0, a = 1e-4;
  ask_for_everything(user, FROM_SIGNAL);
  motion[0] = a * (1.0 - cos(w * t)), motion[1] = a * w * sin(w * t);
  motion[2] = a * w * w * cos(w * t);
  return MPS_OK;
}

static int32_t from_hook(void *user) {
  ask_for_everything(user, FROM_HOOK);
  return 0;
}

/* ---- the scenes ------------------------------------------------------------------------------ */

static void make_set(scene *s, double spacing) {
  USING(particles, mps_particles_create(context, &given, &s->set), .spacing = spacing);
  OK(mps_particles_fill_box(s->set, AT(0.0, 0.0), AT(0.8, 0.4), NULL));
  SET_FIELDS(s->set, {"density", 2000.0}, {"velocity", 0.0});
  OK(mps_particles_set(s->set, "external_force", 1, -1.0));
  OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, from_signal, s, NULL,
                            &s->signal));
}

static mps_material *stuff(void) {
  MAKE_KEPT(material, material, create_linear_elastic, context, 1e6, 0.25);
  return material;
}

static void make_mpm(scene *s) {
  scoped_material *material = stuff();
  make_set(s, 0.1);
  DEF(mpm, def, .cell = 0.2);
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = 0.8;
  OK(mps_mpm_create(context, s->set, material, &def, (mps_mpm **)&s->solver));
  DEF(mpm_boundary, side, .kind = MPS_BOUNDARY_DRIVEN, .signal[0] = s->signal);
  OK(mps_mpm_set_boundary(s->solver, MPS_SIDE_Y_LOWER, &side));
  s->end = 0.02;
}

static void make_dynamics(scene *s) {
  make_set(s, 0.1);
  DEF(dynamics, def, .material = stuff());
  OK(mps_dynamics_create(context, s->set, &def, (mps_dynamics **)&s->solver));
  DEF(dynamics_boundary, base, .kind = MPS_BOUNDARY_DRIVEN, .lower[0] = base.lower[1] = -1.0,
      .upper[0] = 9.0, .upper[1] = 0.1, .dofs = MPS_DOF_Y, .signal[0] = s->signal);
  OK(mps_dynamics_add_boundary(s->solver, &base, NULL));
  mps_material_destroy(&def.material);
  s->end = 0.02;
}

static void make_elastic(scene *s) {
  mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
  make_set(s, 0.1);
  DEF(elastic, def, .material = stuff());
  OK(mps_elastic_create(context, s->set, &def, (mps_elastic **)&s->solver));
  foot.lower[0] = foot.lower[1] = -1.0, foot.upper[0] = 9.0, foot.upper[1] = 0.1;
  foot.kind = MPS_BOUNDARY_DRIVEN, foot.signal[0] = s->signal;
  OK(mps_elastic_add_boundary(s->solver, &foot, NULL));
  USING(elastic_motion, mps_elastic_start(s->solver, &given), .dt = 4e-3);
  mps_material_destroy(&def.material);
  s->end = 0.02;
}

static void make_fluid(scene *s) {
  const double wall[3][4] = {{0, 0, 0, 1}, {0, 0, 1, 0}, {0.8, 0, -1, 0}};
  make_set(s, 0.05);
  OK(mps_fluid_create(context, s->set, NULL, (mps_fluid **)&s->solver));
  for (int k = 0; k < 3; k++) {
    mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
    def.kind = MPS_BOUNDARY_ROLLER; /* slip */
    for (int c = 0; c < 2; c++) def.point[c] = wall[k][c], def.normal[c] = wall[k][2 + c];
    if (k == 1) def.signal = s->signal;
    OK(mps_fluid_add_boundary(s->solver, &def, NULL));
  }
  s->end = 0.06;
}

static uint64_t run_scene(void (*make)(scene *s), const verbs *verb, bool asks) {
  static const char *const fields[] = {"id", "position", "velocity", NULL};
  scene s = {.verb = verb};
  make(&s);
  OK(verb->snapshot(s.solver, &s.before));
  mps_context_set_cancel(context, from_hook, &s, NULL);
  s.asks = asks, s.within = true;
  OK(verb->run(s.solver, s.end, &s));
  OK(verb->step(s.solver));
  s.within = false;
  mps_context_set_cancel(context, NULL, NULL, NULL);
  for (int from = 0; from < 3; from++) {
    if (asks && s.asked[from] == 0) fail_msg("%s: nothing asked from place %d", verb->name, from);
  }
  assert_true(verb->steps(s.solver) > 2);
  OK(verb->rollback(s.solver, s.before)); /* allowed again */
  OK(verb->run(s.solver, s.end, NULL));
  const uint64_t hash = digest_fields(s.set, fields);
  mps_snapshot_destroy(&s.before);
  mps_snapshot_destroy(&s.now);
  verb->destroy(&s.solver);
  assert_null(s.solver);
  mps_signal_destroy(&s.signal);
  mps_particles_destroy(&s.set);
  return hash;
}

/* The cancel hook and signals are called within a step, or between two where that makes no
 * difference. */
TEST(callbacks_only_read) {
  const struct {
    void (*make)(scene *s);
    const verbs *verb;
  } rows[] = {{make_mpm, &of_mpm},
              {make_dynamics, &of_dynamics},
              {make_elastic, &of_elastic},
              {make_fluid, &of_fluid}};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    const uint64_t calm = run_scene(rows[k].make, rows[k].verb, false);
    assert_true(run_scene(rows[k].make, rows[k].verb, true) == calm);
  }
}
