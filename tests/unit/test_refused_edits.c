/* test_refused_edits.c - what a refused call has not taken in: a snapshot or file of explicit
 * dynamics for which there is no memory or place, a material that a solver refuses, a state from
 * which no motion can begin; and ids to come of a set that was brought together.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain_threads.h"
#include "test_allocator.h"
#include "unchanged.h"

SEEN_SOLVER(dynamics)

static mps_particles *block(mps_context *own, double velocity) {
  mps_particles *set = box_of(own, 0.1, AT(0.0, 0.0), AT(0.4, 0.4));
  SET_FIELDS(set, {"density", 1000.0}, {"velocity", velocity}, {"shear_velocity", 20.0},
             {"pressure_velocity", 40.0});
  return set;
}

/* Its lowest row is held at a place that a signal gives. */
static mps_dynamics *held_block(mps_context *own, mps_particles *set, bool watch) {
  DEF(dynamics, def, .watch_damping = watch);
  if (watch) OK(mps_particles_set(set, "damping", 0, 0.0)); /* there, and of no effect so far */
  MAKE_KEPT(dynamics, made, create, own, set, &def);
  USING(dynamics_boundary, mps_dynamics_add_boundary(made, &given, NULL),
        .lower[0] = given.lower[1] = 0.0, .upper[0] = 0.4, .upper[1] = 0.1,
        .dofs = MPS_DOF_X | MPS_DOF_Y);
  OK(mps_dynamics_set_dt(made, 1e-4));
  return made;
}

static mps_context *on(test_allocator *allocator) {
  mps_context *own = test_allocator_context(allocator);
  assert_non_null(own);
  return own;
}

/* ---- edits ----------------------------------------------------------------------------------- */

TEST(a_refused_snapshot_takes_no_edit_in) {
  test_allocator memory = {0};
  mps_context *own = on(&memory);
  mps_particles *set = block(own, 0.0);
  mps_dynamics *dynamics = held_block(own, set, false);
  mps_snapshot *snapshot = NULL;
  OK(mps_particles_set(set, "displacement", 0, 0.19));
  const uint64_t before = seen_dynamics(dynamics, false);
  mps_status status = MPS_ERROR_MEMORY;
  int refusals = 0;
  for (; status == MPS_ERROR_MEMORY; refusals++) {
    memory.refuse_at = memory.calls + 1 + refusals;
    status = mps_dynamics_snapshot(dynamics, &snapshot);
    memory.refuse_at = 0;
    if (status != MPS_OK) assert_true(seen_dynamics(dynamics, false) == before);
  }
  OK(status);
  assert_true(refusals > 5);
  assert_true(seen_dynamics(dynamics, false) != before); /* held particles are at their places */
  mps_snapshot_destroy(&snapshot);
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
  mps_context_destroy(&own);
  assert_int_equal(memory.live, 0);
}

TEST(a_refused_file_takes_no_edit_in) {
  test_allocator memory = {0};
  scoped_context *own = on(&memory);
  scoped_particles *set = block(own, 0.0);
  scoped_dynamics *dynamics = held_block(own, set, false);
  mps_checkpoint info = mps_checkpoint_defaults();
  OK(mps_particles_set(set, "displacement", 0, 0.19));
  const uint64_t before = seen_dynamics(dynamics, false);
  assert_int_not_equal(mps_dynamics_save(dynamics, TEST_TMP "/no/such/folder.h5", NULL), MPS_OK);
  assert_true(seen_dynamics(dynamics, false) == before);
  info.user_bytes = -1;
  assert_int_not_equal(mps_dynamics_save(dynamics, TEST_TMP "/refused.h5", &info), MPS_OK);
  assert_true(seen_dynamics(dynamics, false) == before);
  assert_int_not_equal(mps_dynamics_save(dynamics, NULL, NULL), MPS_OK);
  assert_true(seen_dynamics(dynamics, false) == before);
}

/* ---- materials ------------------------------------------------------------------------------- */

static mps_status to_stiff(mps_dynamics *dynamics, const mps_material *stiff) {
  return mps_dynamics_set_material(dynamics, stiff, NULL, 0);
}

/* Its field "damping" is zero: only now does the solver need memory to watch what damping takes. */
static mps_status to_damped(mps_dynamics *dynamics, const mps_material *stiff) {
  return mps_particles_set(mps_dynamics_particles(dynamics), "damping", 0, 0.05);
}

/* One allocation after the other is refused within `change`: none leaves other coefficients. */
static void refuse_memory_within(mps_status (*change)(mps_dynamics *, const mps_material *)) {
  mps_status status = MPS_ERROR_MEMORY;
  for (int refusals = 0; status == MPS_ERROR_MEMORY; refusals++) {
    test_allocator memory = {0};
    mps_context *own = on(&memory);
    mps_particles *set = block(own, 0.1);
    mps_dynamics *dynamics = held_block(own, set, true);
    mps_totals totals;
    MAKE_KEPT(material, stiff, create_linear_elastic, own, 4e6, 0.3);
    OK(mps_dynamics_step(dynamics, 3));
    OK(mps_dynamics_get_totals(dynamics, &totals));
    const uint64_t before = seen_dynamics(dynamics, false);
    memory.refuse_at = memory.calls + 1 + refusals;
    status = change(dynamics, stiff);
    memory.refuse_at = 0;
    if (status != MPS_OK) assert_true(seen_dynamics(dynamics, false) == before);
    mps_material_destroy(&stiff);
    mps_dynamics_destroy(&dynamics);
    mps_particles_destroy(&set);
    mps_context_destroy(&own);
    assert_int_equal(memory.live, 0);
  }
  assert_int_equal(status, MPS_OK);
}

TEST(a_material_is_refused_as_a_whole) { refuse_memory_within(to_stiff); }

TEST(damping_is_refused_as_a_whole) { refuse_memory_within(to_damped); }

/* WLS-MPM refuses the density where a volume is not positive: no field has another value then. */
TEST(fields_of_a_material_that_is_refused_stay) {
  scoped_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_particles *set = block(own, 0.0);
  DEF(mpm, def, .cell = 0.2);
  scoped_material *law = NULL, *other = NULL;
  OK(mps_material_create_linear_elastic(own, 1e6, 0.3, &law));
  OK(mps_material_create_linear_elastic(own, 2e6, 0.2, &other));
  MAKE(mpm, mpm, create, own, set, law, &def);
  mps_view view = view_field(set, "volume");
  *(double *)(uintptr_t)mps_view_f64(&view, 2, 0) = -1.0; /* as a run leaves it that has diverged */
  const uint64_t before = seen_values(set);
  FAILS_ON(own, mps_particles_set_material(set, other, 1500.0, NULL, 0), MPS_ERROR_ARGUMENT,
           "volume");
  OK(mps_particles_view(set, "density", &view));
  for (int64_t i = 0; i < view.shape[0]; i++) assert_true(*mps_view_f64(&view, i, 0) == 1000.0);
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info info;
    OK(mps_particles_get_field_info(set, f, &info));
    assert_string_not_equal(info.name, "young"); /* nor is there a new field */
  }
  assert_true(seen_values(set) == before);
}

/* ---- states that have diverged --------------------------------------------------------------- */

TEST(no_motion_begins_at_a_speed_without_an_energy) {
  scoped_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_particles *set = block(own, 0.0);
  scoped_dynamics *dynamics = held_block(own, set, false);
  mps_view view = view_field(set, "velocity");
  *(double *)(uintptr_t)mps_view_f64(&view, 12, 0) = 1.1e100; /* as a run leaves it */
  FAILS_ON(own, mps_dynamics_restart(dynamics, 0.0), MPS_ERROR_ARGUMENT, "beyond 1e+100 m/s");
  OK(mps_particles_set(set, "velocity", 0, 1.0));
  OK(mps_dynamics_restart(dynamics, 0.0));
  OK(mps_dynamics_step(dynamics, 1));
}

/* A displacement of which the restoring force is no number, as one that has diverged. */
TEST(accelerations_that_are_not_finite_are_not_shown) {
  scoped_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_particles *set = block(own, 0.0);
  scoped_dynamics *dynamics = held_block(own, set, false);
  OK(mps_dynamics_refresh(dynamics));
  mps_view view = view_field(set, "displacement");
  for (int64_t i = 0; i < view.shape[0]; i++) /* as a run leaves it */
    *(double *)(uintptr_t)mps_view_f64(&view, i, 0) = i % 2 ? 1e308 : -1e308;
  OK(mps_dynamics_restart(dynamics, 0.0));
  const uint64_t before = seen_dynamics(dynamics, false);
  FAILS_ON(own, mps_dynamics_refresh(dynamics), MPS_ERROR_DIVERGED, "must be finite");
  assert_true(seen_dynamics(dynamics, false) == before);
}

/* ---- ids to come ----------------------------------------------------------------------------- */

/* Ids 5 to 9 are removed: the set that was brought together knows that they were there. */
TEST(ids_to_come_follow_those_that_are_gone) {
  static const int64_t ids[10] = {5, 6, 7, 8, 9, 0, 1, 2, 3, 4};
  static const char *const names[] = {"id"};
  scoped_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  team t;
  team_begin(&t, 1);
  const mps_domain_def def = team_domain_def(&t, 0);
  MAKE(domain, domain, create, own, &def);
  for (int again = 0; again < 2; again++) {
    const double places[20] = {0};
    scoped_particles *set = NULL, *whole = NULL;
    USING(particles, mps_particles_create(own, &given, &set), .spacing = 0.1);
    for (int part = 0; part < 2; part++) {
      OK(mps_particles_append(set, 5, places));
      /* `again`: it has the same particles already when more were added and removed */
      if (part == 0 && again) OK(mps_domain_gather_fields(domain, set, 1, names, &whole));
    }
    OK(mps_particles_remove(set, ids, again ? 5 : 10));
    OK(mps_domain_gather_fields(domain, set, 1, names, &whole));
    const int64_t left = again ? 5 : 0;
    assert_int_equal(mps_particles_count(whole), left);
    for (int64_t id = 0; id < 12; id++)
      assert_int_equal(mps_particles_index(whole, id), id < left ? id : -1);
    OK(mps_particles_append(whole, 3, places));
    for (int64_t id = 0; id < 13; id++)
      assert_int_equal(mps_particles_index(whole, id), id < left ? id
                                                       : id < 10 ? -1
                                                                 : left + id - 10);
  }
  team_end(&t);
}
