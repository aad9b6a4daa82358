/* test_guarded.c - the guard of the particle store: editing and its checks, holders, particles that
 * come and go.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "core/particles/particles_internal.h"

static mps_particles *make_set(mps_context *own, double width) {
  mps_particles *set = box_of(own, 0.5, AT(0.0, 0.0), AT(width, 2.0));
  OK(mps_particles_set(set, "density", 0, 2000.0));
  return set;
}

static mps_mpm *make_mpm(mps_particles *set) {
  mps_mpm *mpm = NULL;
  DEF(mpm, def, .cell = 1.0);
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = 8.0;
  MAKE(material, material, create_linear_elastic, context, 1e6, 0.3);
  OK(mps_mpm_create(context, set, material, &def, &mpm));
  return mpm;
}

/* Writes one value and commits; what was there before is written back after a refusal. */
static mps_status write_one(mps_particles *set, const char *field, int64_t id, double value) {
  mps_edit v;
  OK(mps_particles_edit(set, field, &v));
  double *at = mps_edit_f64(&v, mps_particles_index(set, id), 0);
  const double former = *at;
  *at = value;
  const mps_status status = mps_particles_commit(set, &v);
  if (status == MPS_OK) return status;
  *at = former;
  mps_edit again = v; /* the field has stayed open */
  const mps_error keep = *mps_context_error(context);
  OK(mps_particles_commit(set, &again));
  (void)mpsi_fail(context, keep.function, keep.status, "%s", keep.message);
  mpsi_fail_where(context, -1, keep.particle);
  mpsi_fail_object(context, "%s", keep.object);
  return status;
}

/* What a view gives cannot be written through. */
_Static_assert(_Generic(mps_view_f64(NULL, 0, 0), const double * : 1, default : 0) &&
                   _Generic(mps_view_i64(NULL, 0, 0), const int64_t * : 1, default : 0) &&
                   _Generic(((mps_view *)0)->data, const void * : 1, default : 0),
               "views are for reading");

/* ---- editing --------------------------------------------------------------------------------- */

TEST(views_are_for_reading_and_edits_for_writing) {
  scoped_particles *set = make_set(context, 2.0);
  mps_edit e, other;
  mps_view v = view_field(set, "density");
  assert_true(v.flags & MPS_VIEW_READONLY);
  assert_int_equal(v.device_type, 0);
  OK(mps_particles_edit(set, "density", &e));
  assert_false(e.view.flags & MPS_VIEW_READONLY);
  assert_ptr_equal(e.data, v.data);
  FAILS(mps_particles_edit(set, "density", &other), MPS_ERROR_STATE, "is being edited already");
  assert_null(other.data);
  FAILS(mps_particles_set(set, "density", 0, 1.0), MPS_ERROR_STATE, "'density' is being edited");
  const double x[2] = {9.0, 9.0};
  const int64_t ids[1] = {0};
  FAILS(mps_particles_append(set, 1, x), MPS_ERROR_STATE, "'density'");
  FAILS(mps_particles_remove(set, ids, 1), MPS_ERROR_STATE, "'density'");
  assert_string_equal(mps_context_error(context)->object, "field 'density'");
  REFUSES(mps_particles_commit(set, NULL), "NULL");
  OK(mps_particles_commit(set, &e));
  assert_null(e.data);
  assert_ptr_equal(e.view.data, v.data);
  assert_true(e.view.flags & MPS_VIEW_READONLY);
  FAILS(mps_particles_commit(set, &e), MPS_ERROR_STATE, "not of a field");
  FAILS(mps_particles_edit(set, "id", &e), MPS_ERROR_FIELD, "library only");
  FAILS(mps_particles_edit(set, "nothing", &e), MPS_ERROR_FIELD, "no field");
}

TEST(commit_checks_values_and_names_the_particle) {
  scoped_particles *set = make_set(context, 2.0);
  OK(mps_particles_add_field(set, "poisson", 0));
  OK(mps_particles_add_field(set, "user.mine", 1));
  const struct {
    const char *field;
    double bad[3];
    double good;
  } rows[] = {{"density", {-1.0, NAN, 1e13}, 1e12},
              {"poisson", {-1.1, 0.51, INFINITY}, 0.5},
              {"position", {2e15, NAN, -INFINITY}, -1e15},
              {"user.mine", {NAN, 1e101, -INFINITY}, -1e99}};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    for (int b = 0; b < 3; b++) {
      assert_int_equal(write_one(set, rows[k].field, 5, rows[k].bad[b]), MPS_ERROR_ARGUMENT);
      const mps_error *error = mps_context_error(context);
      assert_int_equal(error->particle, 5);
      assert_non_null(strstr(error->object, rows[k].field));
      assert_non_null(strstr(error->message, "of particle 5"));
    }
    assert_int_equal(write_one(set, rows[k].field, 5, rows[k].good), MPS_OK);
  }
  REFUSES(mps_particles_set(set, "density", 0, -3.0),
          "'density' is -3 kg/m3, allowed are 0 to 1e+12");
}

/* ---- solvers --------------------------------------------------------------------------------- */

TEST(a_step_waits_for_the_commit) {
  scoped_particles *set = make_set(context, 2.0);
  scoped_mpm *mpm = make_mpm(set);
  EDIT(v, set, "velocity") {
    FAILS(mps_mpm_step(mpm, 1), MPS_ERROR_STATE, "'velocity' is being edited");
    FAILS(mps_mpm_run(mpm, 1e-3, 1, NULL, NULL), MPS_ERROR_STATE, "'velocity'");
  }
  OK(mps_mpm_step(mpm, 1));
}

/* Each of these was a heap overflow, a crash or silently wrong before. */
/* What is half written is neither kept nor begun with: it may be put back, or refused. */
TEST(states_wait_for_the_commit) {
  scoped_particles *set = make_set(context, 4.0);
  mps_dynamics_def def = mps_dynamics_defaults();
  scoped_snapshot *snapshot = NULL;
  mps_edit v;
  SET_FIELDS(set, {"shear_velocity", 100.0}, {"pressure_velocity", 200.0});
  MAKE(dynamics, dynamics, create, context, set, &def);
  OK(mps_particles_edit(set, "velocity", &v));
  *mps_edit_f64(&v, 0, 0) = NAN;
  const char *text = "field 'velocity' is being edited";
  FAILS(mps_dynamics_snapshot(dynamics, &snapshot), MPS_ERROR_STATE, text);
  assert_null(snapshot);
  FAILS(mps_dynamics_restart(dynamics, 0.0), MPS_ERROR_STATE, text);
  const mps_status saved = mps_dynamics_save(dynamics, TEST_TMP "/half_written.h5", NULL);
  assert_true(saved == MPS_ERROR_STATE || saved == MPS_ERROR_UNSUPPORTED);
  OK(mps_particles_abandon(set, &v));
  OK(mps_dynamics_snapshot(dynamics, &snapshot));
  OK(mps_dynamics_step(dynamics, 1));
  OK(mps_dynamics_rollback(dynamics, snapshot));
}

TEST(a_solver_never_meets_a_position_outside_its_domain) {
  scoped_particles *set = make_set(context, 2.0);
  scoped_mpm *mpm = make_mpm(set);
  const double bad[] = {1e3, NAN, 1e9, -5.0, INFINITY};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    assert_int_equal(write_one(set, "position", 3, bad[k]), MPS_ERROR_ARGUMENT);
    OK(mps_mpm_step(mpm, 2));
  }
  REFUSES(write_one(set, "position", 3, 1e3), "outside the domain");
}

/* Two blocks without contact: one carried over by 5 m moves there as it would have here, since the
 * nodes lie at whole metres. */
TEST(a_move_between_steps_is_a_translation) {
  double moved[2][2];
  for (int far = 0; far < 2; far++) {
    scoped_particles *set = make_set(context, 2.0);
    scoped_mpm *mpm = make_mpm(set);
    mps_edit x, v;
    OK(mps_particles_edit(set, "position", &x));
    OK(mps_particles_edit(set, "velocity", &v));
    for (int64_t k = 0; k < x.view.shape[0]; k++) {
      *mps_edit_f64(&x, k, 0) += far ? 4.0 : 2.0;
      *mps_edit_f64(&x, k, 1) += far ? 4.0 : 3.0;
      *mps_edit_f64(&v, k, 0) = *mps_view_f64(&x.view, k, 1) - (far ? 4.0 : 3.0);
    }
    OK(mps_particles_commit(set, &x));
    OK(mps_particles_commit(set, &v));
    OK(mps_mpm_run(mpm, 0.05, 1, NULL, NULL));
    OK(mps_particles_view(set, "position", &x.view));
    for (int c = 0; c < 2; c++) {
      const double start = c == 0 ? (far ? 4.25 : 2.25) : (far ? 4.25 : 3.25);
      moved[far][c] = *mps_view_f64(&x.view, mps_particles_index(set, 0), c) - start;
    }
  }
  assert_true(fabs(moved[0][0]) > 1e-3);
  for (int c = 0; c < 2; c++) NEAR(moved[1][c], moved[0][c], 1e-12);
}

/* The Courant limit h/(c + |v|) follows a velocity that the caller writes. */
TEST(the_limit_follows_the_callers_velocity) {
  scoped_particles *set = make_set(context, 2.0);
  scoped_mpm *mpm = make_mpm(set);
  const double c = sqrt(1e6 * 0.7 / (1.3 * 0.4) / 2000.0);
  NEAR(mps_mpm_limit(mpm), 1.0 / c, 1e-9);
  assert_int_equal(write_one(set, "velocity", 7, 100.0), MPS_OK);
  OK(mps_mpm_step(mpm, 0)); /* reads what was written */
  NEAR(mps_mpm_limit(mpm), 1.0 / (c + 100.0), 1e-9);
}

/* Two metres of soil far from the walls, in flight: particles enter other cells, but stay near
 * enough to the blocks that they were sorted to. */
static mps_particles *free_set(void) {
  mps_particles *set = box_of(context, 0.25, AT(2.1, 3.1), AT(4.1, 5.1));
  SET_FIELDS(set, {"density", 2000.0}, {"velocity", 2.0});
  OK(mps_particles_add_field(set, "external_force", 0));
  return set;
}

/* What each step reads anew moves no particle in memory, and no other field but positions does. */
TEST(only_positions_make_a_solver_sort) {
  static const char *const fields[] = {"external_force", "velocity", "stress", "density",
                                       "position"};
  scoped_particles *set = free_set();
  scoped_mpm *mpm = make_mpm(set);
  const uint64_t first = mps_particles_epoch(set);
  OK(mps_mpm_run(mpm, 0.3, 1, NULL, NULL)); /* 0.6 m */
  assert_int_equal(mps_particles_epoch(set), first);
  for (int f = 0; f < 5; f++) {
    mps_edit view;
    OK(mps_particles_edit(set, fields[f], &view));
    OK(mps_particles_commit(set, &view));
    OK(mps_mpm_step(mpm, 1));
    assert_int_equal(mps_particles_epoch(set) != first, f == 4);
  }
}

/* A force that is edited is that of the next step: a body in flight has its acceleration. */
TEST(an_edited_force_acts_at_once) {
  scoped_particles *set = free_set();
  mps_view v;
  mps_edit f;
  scoped_mpm *mpm = make_mpm(set);
  double speed = 2.0;
  for (int step = 1; step <= 3; step++) {
    mps_view m = view_field(set, "mass");
    OK(mps_particles_edit(set, "external_force", &f));
    for (int64_t k = 0; k < f.view.shape[0]; k++)
      *mps_edit_f64(&f, k, 0) = 3.0 * step * *mps_view_f64(&m, k, 0);
    OK(mps_particles_commit(set, &f));
    const double before = mps_mpm_time(mpm);
    OK(mps_mpm_step(mpm, 1));
    speed += 3.0 * step * (mps_mpm_time(mpm) - before);
    OK(mps_particles_view(set, "velocity", &v));
    for (int64_t k = 0; k < v.shape[0]; k++) NEAR(*mps_view_f64(&v, k, 0), speed, 1e-12);
  }
}

/* The values are those from before, also where the solver had refused them, and no holder reads
 * again. */
TEST(an_abandoned_edit_was_none) {
  scoped_particles *set = make_set(context, 2.0);
  scoped_mpm *mpm = make_mpm(set);
  mps_edit x;
  OK(mps_mpm_step(mpm, 1));
  const double limit = mps_mpm_limit(mpm);
  for (int f = 0; f < 2; f++) {
    const char *name = f == 0 ? "position" : "velocity";
    OK(mps_particles_edit(set, name, &x));
    const double kept[2] = {*mps_view_f64(&x.view, 3, 0), *mps_view_f64(&x.view, 3, 1)};
    for (int c = 0; c < 2; c++) *mps_edit_f64(&x, 3, c) = f == 0 ? 1e9 : 1e3;
    if (f == 0) REFUSES(mps_particles_commit(set, &x), "outside");
    OK(mps_particles_abandon(set, &x));
    assert_true(x.view.flags & MPS_VIEW_READONLY);
    for (int c = 0; c < 2; c++) assert_true(*mps_view_f64(&x.view, 3, c) == kept[c]);
    FAILS(mps_particles_abandon(set, &x), MPS_ERROR_STATE, "being edited");
    OK(mps_mpm_step(mpm, 0));
    assert_true(mps_mpm_limit(mpm) == limit);
  }
  REFUSES(mps_particles_abandon(set, NULL), "edit is NULL");
  assert_int_equal(mps_particles_abandon(NULL, &x), MPS_ERROR_ARGUMENT);
  (void)view_field(set, "position");
}

/* One material for all solvers, given to a set that a solver holds: its masses follow. */
TEST(a_sets_material_renews_its_masses) {
  scoped_particles *set = make_set(context, 2.0);
  scoped_mpm *mpm = make_mpm(set);
  mps_totals before, after;
  MAKE(material, rock, create_linear_elastic, context, 1e7, 0.2);
  OK(mps_mpm_get_totals(mpm, &before));
  OK(mps_particles_set_material(set, rock, 3000.0, NULL, 0));
  OK(mps_mpm_get_totals(mpm, &after));
  NEAR(after.mass, 1.5 * before.mass, 1e-9 * before.mass);
}

TEST(one_solver_moves_a_set) {
  scoped_particles *set = make_set(context, 2.0);
  mps_mpm *mpm = make_mpm(set), *second = NULL;
  DEF(mpm, def, .cell = 1.0);
  MAKE(material, material, create_linear_elastic, context, 1e6, 0.3);
  const uint64_t epoch = mps_particles_epoch(set);
  const int32_t fields = mps_particles_field_count(set);
  FAILS(mps_mpm_create(context, set, material, &def, &second), MPS_ERROR_STATE,
        "held by a WLS-MPM solver");
  assert_null(second);
  mps_dynamics *dynamics = NULL;
  SET_FIELDS(set, {"shear_velocity", 100.0}, {"pressure_velocity", 200.0});
  FAILS(mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_STATE, "held by");
  assert_int_equal(mps_particles_epoch(set), epoch);
  assert_int_equal(mps_particles_field_count(set), fields + 2);
  mps_mpm_destroy(&mpm);
  OK(mps_mpm_create(context, set, material, &def, &mpm));
  mps_material_destroy(&material);
  mps_particles *kept = set;
  mps_particles_destroy(&set);
  assert_int_equal(mps_particles_count(kept), 16);
  mps_mpm_destroy(&mpm);
}

/* ---- coming and going ------------------------------------------------------------------------ */

TEST(particles_are_removed_and_keep_their_ids) {
  scoped_particles *set = make_set(context, 2.0);
  OK(mps_particles_add_field(set, "user.mine", 2));
  mps_edit mine;
  OK(mps_particles_edit(set, "user.mine", &mine));
  for (int64_t k = 0; k < 16; k++)
    for (int c = 0; c < 2; c++) *mps_edit_f64(&mine, k, c) = 10.0 * (double)k + c;
  OK(mps_particles_commit(set, &mine));
  const int64_t ids[] = {15, 0, 7}, twice[] = {3, 3}, unknown[] = {3, 16};
  const uint64_t epoch = mps_particles_epoch(set);
  REFUSES(mps_particles_remove(set, twice, 2), "ids[1] is 3, which stands in the list before");
  REFUSES(mps_particles_remove(set, unknown, 2), "ids[1] is 16: the set has no such particle");
  REFUSES(mps_particles_remove(set, ids, 17), "count is 17");
  REFUSES(mps_particles_remove(set, NULL, 1), "NULL");
  assert_int_equal(mps_particles_count(set), 16);
  assert_int_equal(mps_particles_epoch(set), epoch);
  OK(mps_particles_remove(set, ids, 3));
  assert_int_equal(mps_particles_count(set), 13);
  assert_true(mps_particles_epoch(set) != epoch);
  for (int k = 0; k < 3; k++) assert_int_equal(mps_particles_index(set, ids[k]), -1);
  OK(mps_particles_view(set, "user.mine", &mine.view));
  for (int64_t id = 0; id < 16; id++) {
    const int64_t at = mps_particles_index(set, id);
    if (at < 0) continue;
    for (int c = 0; c < 2; c++) NEAR(*mps_view_f64(&mine.view, at, c), 10.0 * (double)id + c, 0.0);
  }
  /* Vector loops read zeros behind the last particle. */
  const double *column = mpsi_particles_column(set, "user.mine", 1);
  for (int k = 0; k < MPSI_PARTICLES_PADDING; k++) NEAR(column[13 + k], 0.0, 0.0);
  REFUSES(mps_particles_remove(set, ids, 1), "no such");

  /* A new particle gets an id that none had; it is found by its place. */
  const double there[2] = {5.0, 5.0};
  OK(mps_particles_append(set, 1, there));
  assert_int_equal(mps_particles_nearest(set, there), 16);
  assert_int_equal(mps_particles_index(set, 16), 13);
  int64_t found[16], count;
  const double lo[2] = {0.0, 0.0}, hi[2] = {9.0, 9.0};
  OK(mps_particles_select_box(set, lo, hi, 16, &count, found));
  assert_int_equal(count, 14);
  assert_int_equal(found[0], 1);
  assert_int_equal(found[13], 16);
  (void)view_field(set, "position");
  int64_t all[14];
  memcpy(all, found, sizeof all);
  OK(mps_particles_remove(set, all, 14));
  assert_int_equal(mps_particles_count(set), 0);
  assert_int_equal(mps_particles_nearest(set, there), -1);
}

/* What a solver that lets particles come and go would note. */
typedef struct visitor {
  mps_particles *set;
  mps_status answer;
  int inserts, removes, renewals, commits;
  int64_t first, count, seen;
  double former;
} visitor;

static bool visit_compares(const void *self, const char *field) {
  return strcmp(field, "density") == 0;
}

static mps_status visit_commit(void *self, const char *function, const char *field,
                               const double *former) {
  visitor *v = self;
  (void)function;
  assert_true((former != NULL) == (strcmp(field, "density") == 0));
  if (former) v->former = former[5];
  v->commits++;
  return v->answer;
}
static mps_status visit_insert(void *self, const char *function, int64_t first, int64_t count) {
  visitor *v = self;
  v->inserts++;
  v->first = first;
  v->count = count;
  if (v->answer == MPS_OK) return MPS_OK;
  return mpsi_fail(context, function, v->answer, "outside the domain");
}
static mps_status visit_remove(void *self, const char *function, int64_t count,
                               const int64_t *ids) {
  visitor *v = self;
  (void)ids;
  v->removes++;
  v->count = count;
  if (v->answer == MPS_OK) return MPS_OK;
  return mpsi_fail(context, function, v->answer, "not now");
}
static void visit_renew(void *self) {
  visitor *v = self;
  v->renewals++;
  v->seen = mps_particles_count(v->set);
}

TEST(holders_decide_who_comes_and_goes) {
  scoped_particles *set = make_set(context, 2.0);
  visitor v = {.set = set};
  mpsi_holder recorder = {.name = "a recorder", .kind = MPSI_USE_LOOK};
  mpsi_holder solver = {.name = "a solver of the test",
                        .self = &v,
                        .kind = MPSI_USE_MOVE,
                        .commit = visit_commit,
                        .compares = visit_compares,
                        .insert = visit_insert,
                        .remove = visit_remove,
                        .renew = visit_renew};
  mpsi_holder deaf = {.name = "a deaf solver", .kind = MPSI_USE_MOVE};
  const double lo[2] = {0.0, 0.0}, hi[2] = {2.0, 3.0}, x[4] = {5.0, 5.0, 6.0, 6.0};
  const int64_t ids[2] = {4, 2};
  int64_t added = -1;
  OK(mpsi_particles_hold(set, "test", &recorder));
  OK(mpsi_particles_hold(set, "test", &solver));
  FAILS(mpsi_particles_hold(set, "test", &deaf), MPS_ERROR_STATE, "held by a solver of the test");
  OK(mps_particles_append(set, 2, x));
  assert_int_equal(v.first, 16);
  assert_int_equal(v.count, 2);
  assert_int_equal(v.seen, 18);
  OK(mps_particles_remove(set, ids, 2));
  assert_int_equal(v.seen, 16);
  v.answer = MPS_ERROR_ARGUMENT;
  REFUSES(mps_particles_append(set, 2, x), "the domain");
  REFUSES(mps_particles_fill_box(set, lo, hi, &added), "the domain");
  REFUSES(mps_particles_remove(set, ids + 1, 1), "no such");
  const int64_t there[1] = {5};
  REFUSES(mps_particles_remove(set, there, 1), "not now");
  assert_int_equal(mps_particles_count(set), 16);
  assert_int_equal(v.seen, 16);
  assert_int_equal(mps_particles_index(set, 18), -1);
  REFUSES(mps_particles_set(set, "density", 0, 1.0), "");
  NEAR(*mpsi_particles_column(set, "density", 0), 2000.0, 0.0);
  v.answer = MPS_OK;
  OK(mps_particles_fill_box(set, lo, hi, &added)); /* the sites are free yet */
  assert_int_equal(added, 8);
  assert_int_equal(mps_particles_index(set, 18), 16);
  mpsi_particles_release(set, &solver);
  OK(mpsi_particles_hold(set, "test", &deaf));
  FAILS(mps_particles_append(set, 2, x), MPS_ERROR_STATE, "a deaf solver");
  FAILS(mps_particles_remove(set, there, 1), MPS_ERROR_STATE, "a deaf solver");
  mpsi_particles_release(set, &deaf);
  mpsi_particles_release(set, &deaf); /* does nothing */
  mps_particles *kept = set;
  mps_particles_destroy(&set);
  assert_int_equal(mps_particles_count(kept), 24);
  mpsi_particles_release(kept, &recorder);
}

/* ---- going back, and memory ------------------------------------------------------------------ */

TEST(a_set_goes_back_to_what_it_was) {
  scoped_particles *set = make_set(context, 2.0);
  const uint64_t epoch = mps_particles_epoch(set);
  const int32_t fields = mps_particles_field_count(set);
  mpsi_backup backup;
  OK(mpsi_particles_back_up(set, "test", &backup));
  int64_t order[16];
  for (int64_t k = 0; k < 16; k++) order[k] = 15 - k;
  SET_FIELDS(set, {"volume", 3.0}, {"density", 7.0});
  OK(mpsi_particles_permute(set, "test", order));
  mpsi_particles_go_back(set, &backup);
  assert_int_equal(mps_particles_epoch(set), epoch);
  assert_int_equal(mps_particles_field_count(set), fields);
  const double *density = mpsi_particles_column(set, "density", 0);
  for (int64_t k = 0; k < 16; k++) {
    assert_int_equal(mps_particles_index(set, k), k);
    assert_int_equal(mpsi_particles_integers(set, "id")[k], k);
    NEAR(density[k], 2000.0, 0.0);
  }
  mpsi_backup_drop(set, &backup);
}
