/* test_conditions.c - boundaries and loads by number, of all solvers: lowest free numbers, wrong
 * callers, and definitions that are read back and given again. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "domain_threads.h"
#define FOUR_SOLVERS
#include "kit/block.h"

/* ---- a condition of each kind ---------------------------------------------------------------- */

static const int64_t lowest[3] = {2, 0, 1};

/* A box around the lowest row, or all, or a list. */
typedef enum way { LIST, BOX, ALL, WAYS } way;

#define SELECT(def, how)                                                                           \
  do {                                                                                             \
    if ((how) == LIST) (def).ids = lowest, (def).id_count = 3;                                     \
    if ((how) == BOX) (def).upper[1] = 0.11;                                                       \
    if ((how) == ALL) (def).all = 1;                                                               \
  } while (0)

typedef union any_def {
  uint32_t struct_size;
  mps_mpm_boundary_def mpm_boundary;
  mps_mpm_load_def mpm_load;
  mps_dynamics_boundary_def dynamics_boundary;
  mps_dynamics_load_def dynamics_load;
  mps_elastic_boundary_def elastic_boundary;
  mps_elastic_load_def elastic_load;
  mps_fluid_boundary_def fluid_boundary;
  mps_fluid_load_def fluid_load;
} any_def;

#define MAKER(S, what, KIND, setting)                                                              \
  static size_t S##_##what(way how, any_def *out) {                                                \
    mps_##S##_##what##_def def = mps_##S##_##what##_defaults();                                    \
    setting;                                                                                       \
    SELECT(def, how);                                                                              \
    memset(out, 0, sizeof *out);                                                                   \
    memcpy(out, &def, sizeof def);                                                                 \
    return sizeof def;                                                                             \
  }                                                                                                \
  static mps_solver *S##_##what##_solver(void) { return mps_##S##_solver(S); }
MAKER(mpm, boundary, MPM_BOUNDARY, (void)0)
MAKER(mpm, load, MPM_LOAD, def.traction[1] = -10.0)
MAKER(dynamics, boundary, DYNAMICS_BOUNDARY, def.dofs = MPS_DOF_Y)
MAKER(dynamics, load, DYNAMICS_LOAD, def.traction[0] = 3.0)
MAKER(elastic, boundary, ELASTIC_BOUNDARY, def.dofs = MPS_DOF_X)
MAKER(elastic, load, ELASTIC_LOAD, (def.kind = MPS_ELASTIC_LOAD_FORCE, def.force[0] = 2.0))
MAKER(fluid, load, FLUID_LOAD, def.acceleration[0] = 0.5)

static size_t fluid_boundary(way how, any_def *out) {
  DEF(fluid_boundary, def, .normal[1] = 1.0, .point[1] = -0.001 * how);
  memset(out, 0, sizeof *out);
  memcpy(out, &def, sizeof def);
  return sizeof def;
}
static mps_solver *fluid_boundary_solver(void) { return mps_fluid_solver(fluid); }

static const struct kind {
  int32_t kind, first;  /* first: of the numbers that are added */
  bool boundary, lists; /* lists: a box becomes a list of ids */
  size_t (*make)(way how, any_def *out);
  mps_solver *(*solver)(void);
  const char *set; /* name of the function that changes one */
} kinds[] = {
    {MPS_DEF_MPM_BOUNDARY, 6, true, false, mpm_boundary, mpm_boundary_solver,
     "mps_mpm_set_boundary"},
    {MPS_DEF_MPM_LOAD, 0, false, true, mpm_load, mpm_load_solver, "mps_mpm_set_load"},
    {MPS_DEF_DYNAMICS_BOUNDARY, 0, true, true, dynamics_boundary, dynamics_boundary_solver,
     "mps_dynamics_set_boundary"},
    {MPS_DEF_DYNAMICS_LOAD, 0, false, true, dynamics_load, dynamics_load_solver,
     "mps_dynamics_set_load"},
    {MPS_DEF_ELASTIC_BOUNDARY, 0, true, true, elastic_boundary, elastic_boundary_solver,
     "mps_elastic_set_boundary"},
    {MPS_DEF_ELASTIC_LOAD, 0, false, true, elastic_load, elastic_load_solver,
     "mps_elastic_set_load"},
    {MPS_DEF_FLUID_BOUNDARY, 0, true, false, fluid_boundary, fluid_boundary_solver,
     "mps_fluid_set_boundary"},
    {MPS_DEF_FLUID_LOAD, 0, false, false, fluid_load, fluid_load_solver, "mps_fluid_set_load"},
};
enum { KINDS = (int)(sizeof kinds / sizeof *kinds) };

static int64_t count_of(const struct kind *k) {
  int64_t count = -1;
  OK(mps_solver_get_numbers(k->solver(), k->kind, 0, &count, NULL));
  return count;
}

/* ---- numbers --------------------------------------------------------------------------------- */

TEST(the_lowest_free_number_is_given) {
  begin();
  for (const struct kind *k = kinds; k < kinds + KINDS; k++) {
    any_def def;
    int32_t number = -1, numbers[16];
    int64_t count = 0;
    (void)k->make(LIST, &def);
    const int64_t before = count_of(k); /* the sides of WLS-MPM */
    for (int32_t n = 0; n < 3 && k->kind != MPS_DEF_FLUID_BOUNDARY; n++) {
      OK(mps_solver_add(k->solver(), k->kind, &def, &number));
      assert_int_equal(number, k->first + n);
    }
    if (k->kind == MPS_DEF_FLUID_BOUNDARY) { /* planes, each elsewhere */
      for (int32_t n = 0; n < 3; n++) {
        def.fluid_boundary.normal[0] = n == 1, def.fluid_boundary.normal[1] = n != 1;
        def.fluid_boundary.point[1] = -1e-3 * n;
        OK(mps_solver_add(k->solver(), k->kind, &def, &number));
        assert_int_equal(number, n);
      }
    }
    OK(mps_solver_remove(k->solver(), k->kind, k->first + 1));
    assert_int_equal(count_of(k), before + 2);
    OK(mps_solver_get_numbers(k->solver(), k->kind, 16, &count, numbers));
    assert_int_equal(numbers[count - 2], k->first);
    assert_int_equal(numbers[count - 1], k->first + 2);
    OK(mps_solver_add(k->solver(), k->kind, &def, &number));
    assert_int_equal(number, k->first + 1);
    const int32_t own = k->boundary ? MPS_DEF_BOUNDARY : MPS_DEF_LOAD;
    for (int32_t n = 0; n < 3; n++) OK(mps_solver_remove(k->solver(), own, k->first + n));
    assert_int_equal(count_of(k), before);
  }
  end();
}

TEST(wrong_numbers_and_kinds_are_refused) {
  begin();
  for (const struct kind *k = kinds; k < kinds + KINDS; k++) {
    static const int32_t wrong[] = {-1, 9, 1000000, INT32_MAX, INT32_MIN};
    any_def def, out;
    int32_t number = -1;
    int64_t count = 7;
    const size_t size = k->make(LIST, &def);
    mps_solver *solver = k->solver();
    OK(mps_solver_add(solver, k->kind, &def, &number));
    for (int w = 0; w < 6; w++) {
      if (w == 5) OK(mps_solver_remove(solver, k->kind, number));
      const int32_t n = w == 5 ? number : wrong[w];
      assert_int_equal(mps_solver_set(solver, k->kind, n, &def), MPS_ERROR_ARGUMENT);
      assert_string_equal(mps_context_error(context)->function, k->set);
      assert_int_equal(mps_solver_remove(solver, k->kind, n), MPS_ERROR_ARGUMENT);
      assert_int_equal(mps_solver_get(solver, k->kind, n, &out, size), MPS_ERROR_ARGUMENT);
    }
    for (const struct kind *other = kinds; other < kinds + KINDS; other++) {
      if (other->solver() == solver) continue;
      assert_int_equal(mps_solver_add(solver, other->kind, &def, NULL), MPS_ERROR_ARGUMENT);
      assert_int_equal(mps_solver_set(solver, other->kind, 0, &def), MPS_ERROR_ARGUMENT);
      assert_int_equal(mps_solver_remove(solver, other->kind, 0), MPS_ERROR_ARGUMENT);
      assert_int_equal(mps_solver_get(solver, other->kind, 0, &out, size), MPS_ERROR_ARGUMENT);
    }
    assert_int_equal(mps_solver_add(solver, MPS_DEF_CONTEXT, &def, NULL), MPS_ERROR_ARGUMENT);
    assert_int_equal(mps_solver_add(solver, -3, &def, NULL), MPS_ERROR_ARGUMENT);
    assert_int_equal(mps_solver_add(solver, k->kind, NULL, NULL), MPS_ERROR_ARGUMENT);
    assert_int_equal(mps_solver_add(NULL, k->kind, &def, NULL), MPS_ERROR_ARGUMENT);
    assert_int_equal(mps_solver_get_numbers(solver, k->kind, -1, &count, NULL), MPS_ERROR_ARGUMENT);
    assert_int_equal(mps_solver_get_numbers(solver, k->kind, 0, NULL, NULL), MPS_ERROR_ARGUMENT);
    assert_int_equal(count, 7);
  }
  end();
}

/* ---- definitions read back ------------------------------------------------------------------- */

static const int64_t *ids_of(const struct kind *k, const any_def *def, int64_t *count) {
#define CASE(NAME, member)                                                                         \
  case MPS_DEF_##NAME:                                                                             \
    *count = def->member.id_count;                                                                 \
    return def->member.ids
  switch (k->kind) {
    CASE(MPM_BOUNDARY, mpm_boundary);
    CASE(MPM_LOAD, mpm_load);
    CASE(DYNAMICS_BOUNDARY, dynamics_boundary);
    CASE(DYNAMICS_LOAD, dynamics_load);
    CASE(ELASTIC_BOUNDARY, elastic_boundary);
    CASE(ELASTIC_LOAD, elastic_load);
    CASE(FLUID_LOAD, fluid_load);
  }
#undef CASE
  *count = 0;
  return NULL;
}

TEST(a_definition_read_back_says_what_it_selects) {
  begin();
  for (const struct kind *k = kinds; k < kinds + KINDS; k++)
    for (way how = LIST; how < WAYS; how++) {
      any_def def, out;
      int32_t number = -1;
      int64_t count = -1;
      const size_t size = k->make(how, &def);
      OK(mps_solver_add(k->solver(), k->kind, &def, &number));
      OK(mps_solver_get(k->solver(), k->kind, number, &out, size));
      assert_int_equal(out.struct_size, size);
      const int64_t *ids = ids_of(k, &out, &count);
      const int64_t expected = k->kind == MPS_DEF_FLUID_BOUNDARY ? 0
                               : how == LIST                     ? 3
                               : !k->lists                       ? 0
                               : how == BOX                      ? 8
                                                                 : 32;
      assert_int_equal(count, expected);
      if (count > 0) assert_ptr_not_equal(ids, lowest); /* the solver's copy */
      for (int64_t i = 0; i < count; i++)
        assert_true(ids[i] >= 0 && ids[i] < (how == ALL ? 32 : 8));
      /* Given again it is the same: read back a second time, nothing differs but the lists. */
      int32_t twin = -1;
      any_def again;
      if (k->kind != MPS_DEF_FLUID_BOUNDARY) {
        OK(mps_solver_add(k->solver(), k->kind, &out, &twin));
        OK(mps_solver_get(k->solver(), k->kind, twin, &again, size));
        int64_t same = -1;
        const int64_t *list = ids_of(k, &again, &same);
        assert_int_equal(same, count);
        if (count > 0) assert_memory_equal(list, ids, (size_t)count * sizeof *list);
        OK(mps_solver_remove(k->solver(), k->kind, twin));
      }
      OK(mps_solver_set(k->solver(), k->kind, number, &out));
      OK(mps_solver_remove(k->solver(), k->kind, number));
    }
  end();
}

/* The caller's lists and signals may go once the definition is given. */
TEST(lists_and_signals_belong_to_the_condition) {
  begin();
  int64_t ids[2] = {1, 0};
  double values[6] = {1e-3, 0.0, 0.0, 2e-3, 0.0, 0.0};
  int32_t number = -1;
  MAKE_KEPT(signal, signal, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.1, 0.0);
  mps_elastic_boundary_def def = mps_elastic_boundary_defaults(), out;
  def.kind = MPS_BOUNDARY_DRIVEN, def.ids = ids, def.id_count = 2, def.values = values;
  def.signal[0] = signal;
  OK(mps_elastic_add_boundary(elastic, &def, &number));
  mps_signal_destroy(&signal);
  ids[0] = ids[1] = 99, values[0] = values[3] = 0.0;
  OK(mps_elastic_get_boundary(elastic, number, &out));
  assert_int_equal(out.ids[0], 1);
  assert_int_equal(out.ids[1], 0);
  assert_true(out.values[0] == 1e-3 && out.values[3] == 2e-3);
  assert_non_null(out.signal[0]);
  assert_true(mps_signal_displacement(out.signal[0], 0.25) > 0.09);
  /* itself, whose lists are those that it replaces */
  OK(mps_elastic_set_boundary(elastic, number, &out));
  OK(mps_elastic_get_boundary(elastic, number, &out));
  assert_true(out.ids[1] == 0 && out.values[3] == 2e-3 && out.signal[0]);
  end();
}

TEST(sides_are_boundaries_of_their_number) {
  begin();
  mps_mpm_boundary_def def;
  OK(mps_mpm_get_boundary(mpm, MPS_SIDE_Y_LOWER, &def));
  assert_int_equal(def.kind, MPS_BOUNDARY_ROLLER);
  assert_int_equal(mps_mpm_get_boundary(mpm, MPS_SIDE_Y_UPPER, &def), MPS_ERROR_ARGUMENT);
  def = mps_mpm_boundary_defaults();
  def.kind = MPS_BOUNDARY_FRICTIONAL, def.friction = 0.3;
  OK(mps_mpm_set_boundary(mpm, MPS_SIDE_Y_LOWER, &def));
  OK(mps_mpm_get_boundary(mpm, MPS_SIDE_Y_LOWER, &def));
  assert_int_equal(def.kind, MPS_BOUNDARY_FRICTIONAL);
  assert_true(def.friction == 0.3);
  OK(mps_mpm_remove_boundary(mpm, MPS_SIDE_Y_LOWER));
  OK(mps_mpm_get_boundary(mpm, MPS_SIDE_Y_LOWER, &def));
  assert_int_equal(def.kind, MPS_BOUNDARY_FREE);
  end();
}

/* Definitions are not part of a state: they stay as they are. */
TEST(definitions_stay_when_a_state_returns) {
  begin();
  mps_solver *const solvers[3] = {mps_mpm_solver(mpm), mps_dynamics_solver(dynamics),
                                  mps_fluid_solver(fluid)};
  static const int which[3] = {1, 3, 7}; /* loads, of `kinds` */
  for (int s = 0; s < 3; s++) {
    const struct kind *k = &kinds[which[s]];
    any_def def, out;
    int32_t number = -1;
    int64_t count = 0;
    scoped_snapshot *snapshot = NULL;
    const size_t size = k->make(LIST, &def);
    OK(mps_solver_add(solvers[s], k->kind, &def, &number));
    OK(mps_solver_snapshot(solvers[s], &snapshot));
    (void)k->make(ALL, &def);
    OK(mps_solver_set(solvers[s], k->kind, number, &def));
    OK(mps_solver_step(solvers[s], 1));
    OK(mps_solver_rollback(solvers[s], snapshot));
    OK(mps_solver_get(solvers[s], k->kind, number, &out, size));
    (void)ids_of(k, &out, &count);
    assert_int_equal(count, k->lists ? 32 : 0);
  }
  end();
}

/* ---- definitions of solvers, contacts and bodies --------------------------------------------- */

TEST(definitions_of_objects_are_read_back) {
  begin();
  mps_mpm_def def;
  mps_dynamics_def other;
  OK(mps_mpm_get_def(mpm, &def));
  assert_true(def.cell == 0.2 && def.struct_size == sizeof def);
  assert_int_equal(mps_solver_get_def(mps_mpm_solver(mpm), MPS_DEF_DYNAMICS, &other, sizeof other),
                   MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(mps_context_error(context)->message, "MPS_DEF_MPM"));
  mps_body_def body_def = mps_body_defaults(), body_out;
  body_def.motion = MPS_BODY_MOTION_FREE, body_def.mass = 3.0, body_def.inertia[2] = 0.5;
  body_def.position[0] = 0.4, body_def.position[1] = 2.0;
  MAKE(body, body, create_disc, context, &body_def, 0.2);
  OK(mps_body_get_def(body, &body_out));
  assert_true(body_out.mass == 3.0 && body_out.position[1] == 2.0 && body_out.inertia[2] == 0.5);
  assert_int_equal(body_out.motion, MPS_BODY_MOTION_FREE);
  mps_contact_def contact_def = mps_contact_defaults(), contact_out;
  mps_fluid_contact_def fluid_out;
  scoped_contact *contact = NULL;
  contact_def.friction = 0.25;
  OK(mps_mpm_add_contact(mpm, body, &contact_def, &contact));
  OK(mps_contact_get_def(contact, MPS_DEF_CONTACT, &contact_out, sizeof contact_out));
  assert_true(contact_out.friction == 0.25 && contact_out.sweeps > 0);
  assert_int_equal(
      mps_contact_get_def(contact, MPS_DEF_FLUID_CONTACT, &fluid_out, sizeof fluid_out),
      MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_contact_get_def(NULL, MPS_DEF_CONTACT, &contact_out, sizeof contact_out),
                   MPS_ERROR_ARGUMENT);
  end();
}

/* ---- on ranks -------------------------------------------------------------------------------- */

enum { RANKS = 3, ROW = 40, MOST = 64 };

/* What the ranks have done: statuses of calls that succeed, of those that are refused, and the ids
 * of boundaries by a box and by a list. */
typedef struct work {
  mps_status good[RANKS][8], bad[RANKS][4];
  char message[RANKS][4][512];
  int64_t count[RANKS][2], ids[RANKS][2][MOST];
} work;

static void remember(work *w, int32_t rank, int which, const mps_dynamics_boundary_def *def) {
  w->count[rank][which] = def->id_count;
  for (int64_t k = 0; k < def->id_count && k < MOST; k++) w->ids[rank][which][k] = def->ids[k];
}

static void call_on_rank(void *user, team *t, int32_t rank) {
  work *w = user;
  scoped_domain *domain = NULL;
  scoped_context *own = team_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const mps_domain_def domain_def = team_domain_def(t, rank);
  scoped_particles *set = NULL;
  scoped_dynamics *solver = NULL;
  int64_t row[ROW];
  int32_t number[2] = {-1, -1};
  for (int64_t k = 0; k < ROW; k++) row[k] = ROW - 1 - k;
  DEF(particles, set_def, .spacing = 0.1);
  mps_status *good = w->good[rank], *bad = w->bad[rank];
  good[0] = mps_domain_create(own, &domain_def, &domain);
  good[1] = mps_particles_create(own, &set_def, &set);
  if (good[1] == MPS_OK)
    good[1] = mps_particles_fill_box(set, AT(0.0, 0.0), AT(0.1 * ROW, 2.0), NULL);
  if (good[1] == MPS_OK) good[1] = mps_particles_set(set, "density", 0, 1000.0);
  if (good[1] == MPS_OK) good[1] = mps_particles_set(set, "shear_velocity", 0, 10.0);
  if (good[1] == MPS_OK) good[1] = mps_particles_set(set, "pressure_velocity", 0, 20.0);
  DEF(dynamics, def, .domain = domain);
  good[2] = mps_dynamics_create(own, set, &def, &solver);
  mps_dynamics_boundary_def box = mps_dynamics_boundary_defaults(), list = box, out;
  box.upper[1] = 0.11;
  list.ids = row, list.id_count = ROW, list.dofs = MPS_DOF_Y;
  good[3] = mps_dynamics_add_boundary(solver, &box, &number[0]);
  good[4] = mps_dynamics_add_boundary(solver, &list, &number[1]);
  for (int k = 0; k < 2; k++) {
    good[5 + k] = mps_dynamics_get_boundary(solver, number[k], &out);
    if (good[5 + k] == MPS_OK) remember(w, rank, k, &out);
  }
  for (int k = 0; k < 4; k++) { /* rank 1, or all, call for what is refused on all */
    mps_dynamics_boundary_def wrong = list;
    if (k == 0 && rank == 1) wrong.dofs = MPS_DOF_X;
    if (k == 1) row[3] = 100000;
    if (k == 2) row[3] = rank;
    bad[k] = k < 3 ? mps_dynamics_set_boundary(solver, number[1], &wrong)
                   : mps_dynamics_remove_boundary(solver, rank == 1 ? 7 : number[0]);
    snprintf(w->message[rank][k], sizeof w->message[rank][k], "%s",
             mps_context_error(own)->message);
  }
  good[7] = mps_dynamics_remove_boundary(solver, number[0]);
}

TEST(ranks_have_their_parts_and_agree) {
  static const char *const text[4] = {"dofs", "ids", "ids", "number"};
  static work w;
  team_compute(RANKS, call_on_rank, &w);
  for (int k = 0; k < 8; k++)
    for (int r = 0; r < RANKS; r++)
      if (w.good[r][k] != MPS_OK) fail_msg("rank %d, call %d: %d", r, k, (int)w.good[r][k]);
  for (int which = 0; which < 2; which++) {
    int seen[ROW] = {0};
    for (int r = 0; r < RANKS; r++)
      for (int64_t k = 0; k < w.count[r][which]; k++) seen[w.ids[r][which][k]]++;
    for (int k = 0; k < ROW; k++) assert_int_equal(seen[k], 1); /* on one rank each */
  }
  for (int k = 0; k < 4; k++)
    for (int r = 0; r < RANKS; r++)
      if (w.bad[r][k] != MPS_ERROR_ARGUMENT || !strstr(w.message[r][k], text[k]))
        fail_msg("rank %d, refusal %d: %d %s", r, k, (int)w.bad[r][k], w.message[r][k]);
}
