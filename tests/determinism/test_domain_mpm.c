/* test_domain_mpm.c - WLS-MPM on several ranks: every particle has the bits of the run without a
 * domain, on whatever number of ranks and threads; and an error of one rank is an error of all.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_ranks.h"
#include "ranks_team.h"

TEST(test_slide) { compare_teams(compute, SLIDE, 120, false); }
TEST(test_spread) { compare_teams(compute, SPREAD, 120, false); }
TEST(test_ring) { compare_teams(compute, RING, 60, false); }
/* So many particles that the threads of a rank take blocks as they become ready. */
TEST(test_wide) { compare_teams(compute, WIDE, 12, true); }
TEST(test_room) { compare_teams(compute, ROOM, 60, false); }

TEST(test_press) { compare_teams(compute, PRESS, 90, false); }
TEST(test_cone) { compare_teams(compute, CONE, 80, true); }
TEST(test_plates) { compare_teams(compute, PLATES, 80, true); }
TEST(test_piles) { compare_teams(compute, PILES, 80, false); }
TEST(test_balls) { compare_teams(compute, BALLS, 40, true); }

/* In and out by the caller, between steps. */
TEST(test_changes) {
  compare_teams(compute_changes, SPREAD, 48, true);
  compare_teams(compute_changes, PRESS, 32, true);
  compare_teams(compute_changes, ROOM, 16, true);
}

/* Loaded particles go out through a side while the others settle: what is applied to them is that
 * of the step. */
static mps_status compute_leaving(mps_context *own, mps_domain *domain, int what, int64_t steps,
                                  result *r) {
  enum { LOADED = 40 };
  int64_t ids[LOADED];
  double area[LOADED];
  SCOPED(end_scene) scene s = {.set = NULL};
  for (int64_t k = 0; k < LOADED; k++) ids[k] = 60 * k + 59, area[k] = 1e-4 * (double)(k + 1);
  DEF(mpm_load, load, .ids = ids, .id_count = LOADED, .area = area, .traction[0] = 4e6);
  mps_status status = make_scene(own, domain, what, &s);
  TRY(mps_mpm_add_load(s.mpm, &load, NULL));
  TRY(mps_mpm_step(s.mpm, steps));
  for (int64_t n = 1; status == MPS_OK && n <= 12; n++) {
    DEF(mpm_settle, def, .max_steps = n);
    mps_mpm_settled now = {0};
    status = mps_mpm_settle(s.mpm, &def, &now);
    if (status == MPS_ERROR_NUMERIC) status = MPS_OK; /* not yet */
    r->other[n] = now.applied;
  }
  TRY(keep_scene(domain, what, &s, r));
  if (r->reaction[MPS_SIDE_X_UPPER].removed == 0) status = MPS_ERROR_INTERNAL;
  return status;
}

TEST(test_leaving) { compare_teams(compute_leaving, SPREAD, 12, true); }

/* ---- cut in two ------------------------------------------------------------------------------ */

#define CHECKPOINT "test_domain_mpm.h5"

static mps_status begin(mps_context *own, mps_domain *domain, int what, int64_t steps, result *r) {
  return compute_half(own, domain, what, steps, NULL, CHECKPOINT, r);
}

static mps_status go_on(mps_context *own, mps_domain *domain, int what, int64_t steps, result *r) {
  return compute_half(own, domain, what, steps, CHECKPOINT, NULL, r);
}

/* Written on 4 ranks, a run continues with the bits of one that was not cut: on 3, and on one
 * without a domain; written without a domain, on 3. */
static void compare_cut(int what, int64_t steps) {
  if (!mps_library_has(MPS_FEATURE_HDF5)) skip();
  result half = {0}, whole = {0}, on = {0};
  mps_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  OK(compute_half(own, NULL, what, steps, NULL, CHECKPOINT, &half));
  OK(go_on(own, NULL, what, steps, &whole));
  compare_part(go_on, 3, what, steps, &whole, false);
  remove(CHECKPOINT);
  compare_part(begin, 4, what, steps, &half, false);
  compare_part(go_on, 3, what, steps, &whole, false);
  OK(go_on(own, NULL, what, steps, &on));
  int64_t *seen = calloc((size_t)whole.count + 1, sizeof *seen);
  compare(&whole, &on, seen);
  assert_memory_equal(on.id, whole.id, (size_t)whole.count * sizeof *whole.id);
  free(seen);
  drop(&half), drop(&whole), drop(&on);
  mps_context_destroy(&own);
  remove(CHECKPOINT);
}

TEST(test_cut_press) { compare_cut(PRESS, 45); }
TEST(test_cut_spread) { compare_cut(SPREAD, 50); }

/* ---- what goes wrong on one rank ------------------------------------------------------------- */

TEST(test_refused_memory) { refuse_memory(compute, SPREAD, 30, 7); }

TEST(test_refused_contact) { refuse_memory(compute, PRESS, 24, 11); }

/* Nodes and values of the grid, at the end of what has been well. */
static mps_status probe(mps_context *own, mps_domain *domain, int what, int64_t steps, result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_status status = make_scene(own, domain, what, &s);
  TRY(mps_mpm_step(s.mpm, steps));
  TRY(keep_grid(domain, &s, r->other));
  return status;
}

TEST(test_refused_probes) { refuse_memory(probe, SLIDE, 1, 1); }

TEST(test_refused_changes) { refuse_memory(compute_changes, SPREAD, 12, 13); }

/* ---- steps that leave no state to restart from ----------------------------------------------- */

/* The body flies towards a free side until a particle is lost, on one of the ranks. */
static mps_status lose_particle(mps_context *own, mps_domain *domain, scene *s) {
  mps_mpm_def def = scene_def(domain, SLIDE);
  def.upper[0] = 1.24, def.dt = NAN; /* as far as it may: a tenth of a cell past the wall */
  mps_status status = make_set(own, NULL, SLIDE, &s->set);
  TRY(mps_material_create_linear_elastic(own, 1e6, 0.3, &s->material[0]));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_mpm_create(own, s->set, s->material[0], &def, &s->mpm));
  TRY(mps_mpm_set_side(s->mpm, MPS_SIDE_X_UPPER, MPS_BOUNDARY_FREE, 0.0));
  if (status == MPS_OK) status = mps_mpm_step(s->mpm, 1000);
  if (status != MPS_ERROR_DIVERGED || mps_context_error(own)->particle < 0)
    return MPS_ERROR_INTERNAL;
  return MPS_OK;
}

/* A step that is refused because a particle is lost changes nothing on any rank: queries of the
 * state afterwards have the bits of one process. Without that particle the run continues. */
static mps_status compute_lost(mps_context *own, mps_domain *domain, int what, int64_t steps,
                               result *r) {
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_totals totals[2];
  (void)what;
  mps_status status = lose_particle(own, domain, &s);
  const int64_t gone[1] = {mps_context_error(own)->particle};
  TRY(mps_mpm_get_totals(s.mpm, &totals[0]));
  if (status == MPS_OK && mps_mpm_step(s.mpm, 1) != MPS_ERROR_STATE) status = MPS_ERROR_INTERNAL;
  TRY(mps_mpm_get_totals(s.mpm, &totals[1]));
  if (status == MPS_OK && memcmp(&totals[0], &totals[1], sizeof totals[0]) != 0)
    status = MPS_ERROR_INTERNAL;
  memcpy(r->other + 20, totals, sizeof totals);
  TRY(mps_particles_remove(s.set, gone, 1));
  for (int64_t k = 0; status == MPS_OK && k < steps; k++) {
    status = mps_mpm_step(s.mpm, 1);
    r->other[k] = status;
    if (status == MPS_ERROR_DIVERGED || status == MPS_ERROR_STATE) status = MPS_OK; /* others */
  }
  TRY(keep(s.set, r));
  return status;
}

TEST(test_lost) { compare_teams(compute_lost, SLIDE, 5, true); }

/* After a step that gives no finite numbers the set may not be changed, but nothing may be removed
 * from it: the same results on one rank and on several. */
static mps_status compute_broken(mps_context *own, mps_domain *domain, int what, int64_t steps,
                                 result *r) {
  enum { ANSWERS = 3 }; /* a step that is undone fails again */
  static const mps_status expected[ANSWERS] = {MPS_ERROR_DIVERGED, MPS_OK, MPS_ERROR_DIVERGED};
  SCOPED(end_scene) scene s = {.set = NULL};
  scoped_snapshot *then = NULL;
  mps_edit stress;
  const int64_t ids[2] = {59, 300};
  mps_status status = make_scene(own, domain, what, &s);
  TRY(mps_mpm_step(s.mpm, steps));
  TRY(mps_mpm_snapshot(s.mpm, &then));
  TRY(mps_particles_edit(s.set, "stress", &stress));
  const int64_t at = status == MPS_OK ? mps_particles_index(s.set, ids[0]) : -1;
  if (at >= 0) *mps_edit_f64(&stress, at, 0) = 1e99;
  TRY(mps_particles_commit(s.set, &stress));
  if (domain) status = mps_domain_agree(domain, status);
  if (status == MPS_OK) {
    const mps_status answer[ANSWERS] = {
        mps_mpm_step(s.mpm, 3), mps_particles_remove(s.set, NULL, 0), mps_mpm_step(s.mpm, 1)};
    if (memcmp(answer, expected, sizeof answer) != 0) status = MPS_ERROR_INTERNAL;
  }
  TRY(mps_mpm_rollback(s.mpm, then));
  TRY(mps_particles_remove(s.set, ids, 2));
  TRY(mps_mpm_step(s.mpm, steps));
  TRY(keep(s.set, r));
  return status;
}

TEST(test_broken) {
  compare_teams(compute_broken, SLIDE, 5, true);
  compare_teams(compute_broken, SPREAD, 5, true); /* with an absorbing side */
}

/* One after the other, what ranks do not agree upon, what fails on one of them, what is refused. */
#define MPM_TROUBLES(ROW)                                                                          \
  ROW(OTHER_SET, MPS_ERROR_ARGUMENT, "a hash of the set's particles")                              \
  ROW(OTHER_DT, MPS_ERROR_ARGUMENT, "dt is ")                                                      \
  ROW(OTHER_COUNT, MPS_ERROR_ARGUMENT, "count is ")                                                \
  ROW(CANCELLED, MPS_ERROR_CANCELLED, "stopped by the cancel hook at step 0")                      \
  ROW(CALLBACK_FAILS, MPS_ERROR_IO, "rank 2: ")                                                    \
  ROW(UNKNOWN_ID, MPS_ERROR_ARGUMENT, "of 2 ids 1 are of particles of the set on any rank")        \
  ROW(OTHER_CONTACT, MPS_ERROR_ARGUMENT, "another value on others")                                \
  ROW(DEPTH, MPS_ERROR_DIVERGED, "m below the surface of body 0, at most 1e-09 m")                 \
  ROW(OTHER_BOUNDARY, MPS_ERROR_ARGUMENT, "another value on others")                               \
  ROW(BAD_BOUNDARY, MPS_ERROR_ARGUMENT, "rank 1: number is -1")                                    \
  ROW(OTHER_REMOVED, MPS_ERROR_ARGUMENT, "number is 1 on rank 0")                                  \
  ROW(OTHER_TRACTION, MPS_ERROR_ARGUMENT, "another value on others")                               \
  ROW(OTHER_AREA, MPS_ERROR_ARGUMENT, "another value on others")                                   \
  ROW(OTHER_FACTOR, MPS_ERROR_ARGUMENT, "another value on others")                                 \
  ROW(BAD_LOAD, MPS_ERROR_ARGUMENT, "rank 1: number is 5")                                         \
  ROW(OTHER_LOAD_REMOVED, MPS_ERROR_ARGUMENT, "number is 0 on rank 0")                             \
  ROW(MANY_IDS, MPS_ERROR_ARGUMENT, "id_count is 4000, allowed are 1 to ")
enum { MPM_TROUBLES(CASE_NAME) TROUBLES };
static const trouble_case trouble[TROUBLES] = {MPM_TROUBLES(CASE_ROW)};

static mps_status refuse_callback(void *user, mps_mpm *mpm) {
  return *(const int32_t *)user == 2 && mps_mpm_steps(mpm) > 0 ? MPS_ERROR_IO : MPS_OK;
}

static int32_t cancel(void *user) { return *(const int32_t *)user == 1; }

/* More particles than there are, each of them there. */
static mps_status list_many(mps_mpm *mpm) {
  const int64_t ids[4000] = {17};
  DEF(mpm_load, def, .ids = ids, .id_count = 4000);
  return mps_mpm_add_load(mpm, &def, NULL);
}

/* Two loads, which ranks make, change or remove in their own ways. */
static mps_status load_badly(mps_mpm *mpm, int what, int32_t rank) {
  const int64_t ids[2] = {17, 44};
  const double area[2] = {1e-2, what == OTHER_AREA && rank == 2 ? 1e-3 : 2e-2};
  DEF(mpm_load, def, .ids = ids, .id_count = 2, .area = area,
      .traction[0] = what == OTHER_TRACTION ? 10.0 * rank : 10.0);
  mps_status status = mps_mpm_add_load(mpm, &def, NULL);
  TRY(mps_mpm_add_load(mpm, &def, NULL));
  if (what == OTHER_FACTOR) def.factor[1] = rank;
  TRY(mps_mpm_set_load(mpm, what == BAD_LOAD && rank == 1 ? 5 : 1, &def));
  TRY(mps_mpm_remove_load(mpm, what == OTHER_LOAD_REMOVED && rank == 2 ? 1 : 0));
  return status;
}

static mps_status run_trouble(mps_context *own, mps_domain *domain, int what, int32_t rank) {
  SCOPED(end_scene) scene s = {.set = NULL};
  scoped_body *body = NULL;
  mps_mpm_def def = scene_def(domain, SLIDE);
  if (what == OTHER_DT) def.dt = 1e-5 * (1.0 + rank);
  mps_status status = make_set(own, NULL, SLIDE, &s.set);
  if (what == OTHER_SET && rank == 1) TRY(mps_particles_set(s.set, "density", 0, 2000.0));
  TRY(mps_material_create_linear_elastic(own, 1e6, 0.3, &s.material[0]));
  mps_contact_def contact = mps_contact_defaults();
  mps_body_def box = mps_body_defaults(); /* the soil runs into it */
  box.position[0] = 1.32, box.position[1] = 0.6;
  TRY(mps_body_create_box(own, &box, 0.2, 0.4, &body));
  status = mps_domain_agree(domain, status);
  const int64_t before = mps_particles_count(s.set);
  TRY(mps_mpm_create(own, s.set, s.material[0], &def, &s.mpm));
  if (status != MPS_OK && mps_particles_count(s.set) != before) status = MPS_ERROR_INTERNAL;
  if (what == OTHER_COUNT) TRY(mps_mpm_step(s.mpm, 1 + rank));
  if (what == CANCELLED) {
    mps_context_set_cancel(own, cancel, &rank, NULL);
    TRY(mps_mpm_step(s.mpm, 10));
  }
  if (what == CALLBACK_FAILS) TRY(mps_mpm_run(s.mpm, 1.0, 5, refuse_callback, &rank));
  if (what == OTHER_BOUNDARY)
    TRY(mps_mpm_set_side(s.mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, 0.1 * rank));
  if (what == BAD_BOUNDARY)
    TRY(mps_mpm_set_side(s.mpm, rank == 1 ? -1 : MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0));
  if (what == OTHER_REMOVED)
    TRY(mps_mpm_remove_boundary(s.mpm, rank == 1 ? MPS_SIDE_Y_LOWER : MPS_SIDE_X_UPPER));
  if (what == MANY_IDS)
    TRY(list_many(s.mpm));
  else if (what >= OTHER_TRACTION)
    TRY(load_badly(s.mpm, what, rank));
  if (what == UNKNOWN_ID) {
    const int64_t ids[2] = {17, 123456};
    int32_t number;
    DEF(mpm_boundary, boundary, .ids = ids, .id_count = 2);
    TRY(mps_mpm_add_boundary(s.mpm, &boundary, &number));
  }
  if (what == OTHER_CONTACT) contact.friction = 0.1 * rank;
  if (what == DEPTH) contact.depth = 1e-9, contact.offset = 0.0;
  if (what == OTHER_CONTACT || what == DEPTH) TRY(mps_mpm_add_contact(s.mpm, body, &contact, NULL));
  if (what == DEPTH) TRY(mps_mpm_step(s.mpm, 1000));
  return status;
}

TEST(test_troubles) { meet_troubles(run_trouble, trouble, TROUBLES); }

/* ---- what goes wrong while the caller puts particles in or takes them out -------------------- */

#define CHANGES_OF_RANKS(ROW)                                                                      \
  ROW(OTHER_ADDED, MPS_ERROR_ARGUMENT, "a hash of the particles to add")                           \
  ROW(OUTSIDE, MPS_ERROR_ARGUMENT, "outside the domain")                                           \
  ROW(FEWER_THAN_NONE, MPS_ERROR_ARGUMENT, "rank 1: count is -3")                                  \
  ROW(PREDICATE_FAILS, MPS_ERROR_IO, "rank 2: ")                                                   \
  ROW(EDITING, MPS_ERROR_STATE, "rank 1: ")                                                        \
  ROW(NO_DENSITY, MPS_ERROR_STATE, "has come since the last step and has density 0")               \
  ROW(NOT_THERE, MPS_ERROR_ARGUMENT, "of 2 ids 1 are of particles of the set on any rank")         \
  ROW(OTHER_LISTS, MPS_ERROR_ARGUMENT, "give all ranks the same list")                             \
  ROW(TWICE, MPS_ERROR_ARGUMENT, "which stands in the list before")
enum { CHANGES_OF_RANKS(CASE_NAME) CHANGES };
static const trouble_case change[CHANGES] = {CHANGES_OF_RANKS(CASE_ROW)};

static mps_status refuse_place(void *user, const double *x, int32_t *inside) {
  *inside = x[1] > 1.02;
  return *(const int32_t *)user == 2 && x[0] > 0.9 ? MPS_ERROR_IO : MPS_OK;
}

static mps_status put_badly(mps_particles *set, int what, int32_t rank) {
  const double place[4] = {0.5, 1.2, what == OTHER_ADDED ? 0.6 + 0.1 * rank : 0.7,
                           what == OUTSIDE ? -0.3 : 1.3};
  const double lo[2] = {0.2, 1.0}, hi[2] = {1.0, 1.1};
  if (what == PREDICATE_FAILS)
    return mps_particles_fill_where(set, lo, hi, refuse_place, &rank, NULL);
  return mps_particles_append(set, what == FEWER_THAN_NONE && rank == 1 ? -3 : 2, place);
}

static mps_status run_change(mps_context *own, mps_domain *domain, int what, int32_t rank) {
  SCOPED(end_scene) scene s = {.set = NULL};
  mps_edit edit;
  const int64_t other[3] = {1 + rank, 700 + rank, 2 * rank}, twice[3] = {17, 44, 17},
                wrong[2] = {17, 123456};
  mps_status status = make_scene(own, domain, SLIDE, &s);
  TRY(mps_mpm_step(s.mpm, 2));
  const int64_t count = mps_particles_count(s.set);
  if (what == EDITING && rank == 1) TRY(mps_particles_edit(s.set, "density", &edit));
  if (what == NOT_THERE)
    TRY(mps_particles_remove(s.set, wrong, 2));
  else if (what == OTHER_LISTS || what == TWICE)
    TRY(mps_particles_remove(s.set, what == TWICE ? twice : other, 3));
  else
    TRY(put_badly(s.set, what, rank));
  if (what != NO_DENSITY && mps_particles_count(s.set) != count) status = MPS_ERROR_INTERNAL;
  if (what == EDITING && rank == 1 && mps_particles_abandon(s.set, &edit) != MPS_OK)
    status = MPS_ERROR_INTERNAL;
  TRY(mps_mpm_step(s.mpm, 1));
  if (what != NO_DENSITY && mps_mpm_step(s.mpm, 1) != MPS_OK) status = MPS_ERROR_INTERNAL;
  return status;
}

TEST(test_bad_changes) { meet_troubles(run_change, change, CHANGES); }
