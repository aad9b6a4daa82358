/* test_mpm_snapshot.c - mps_mpm_snapshot and mps_mpm_rollback: the steps after a rollback are the
 * same as after the snapshot, bit for bit, on any number of threads; whose snapshot it is; refused
 * memory changes nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "mpm_twins.h"
#include "test_allocator.h"

/* All that a program can see of a run, as a new scene would have it: `x` continues as `twin` does.
 */
static void follows(scene *x, scene *twin, int64_t steps) {
  same(x, twin);
  OK(mps_mpm_step(x->s.mpm, steps));
  OK(mps_mpm_step(twin->s.mpm, steps));
  same(x, twin);
}

static mps_status roll(scene *x, mps_snapshot *s) { return mps_mpm_rollback(x->s.mpm, s); }

/* A twin never goes back. */
static void goes_back(int32_t geometry, int32_t threads, int64_t steps) {
  scoped_context *context = on_threads(&threads);
  SCOPED(drop) scene x = build(context, geometry, &none), twin = build(context, geometry, &none);
  mps_snapshot *snapshot = NULL;
  for (int k = 0; k < 4; k++) {
    OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
    OK(mps_mpm_step(x.s.mpm, steps));
    OK(roll(&x, snapshot));
    OK(mps_mpm_step(x.s.mpm, 3)); /* twice from the same snapshot */
    OK(roll(&x, snapshot));
    follows(&x, &twin, steps);
  }
  for (int b = 0; b < BODIES; b++) { /* all this has been of contact */
    mps_reaction r;
    OK(mps_body_get_reaction(x.body[b], -1, &r));
    assert_true(r.impulse[1] != 0.0);
  }
  mps_snapshot_destroy(&snapshot);
  assert_null(snapshot);
}

TEST(goes_back_bit_for_bit_on_any_threads) {
  for (int32_t threads = test_quick() ? 3 : 1; threads <= 3; threads++)
    goes_back(MPS_MPM_GEOMETRY_PLANE_STRAIN, threads, 50);
  goes_back(MPS_MPM_GEOMETRY_AXISYMMETRIC, 2, 80);
  goes_back(MPS_MPM_GEOMETRY_SPACE, 2, 25);
}

/* Walls that look for their forces at rest, boxes of nodes, loads, two materials. */
TEST_SERIAL(goes_back_with_walls_and_loads) {
  SCOPED(drop)
  scene x = build_held(context, MPS_MPM_GEOMETRY_PLANE_STRAIN),
        twin = build_held(context, MPS_MPM_GEOMETRY_PLANE_STRAIN);
  scoped_snapshot *snapshot = NULL;
  for (int k = 0; k < 4; k++) {
    OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
    OK(mps_mpm_step(x.s.mpm, 50));
    OK(roll(&x, snapshot));
    same_fields(&x, &twin);
    same_forces(&x, &twin);
    OK(mps_mpm_step(x.s.mpm, 20));
    OK(mps_mpm_step(twin.s.mpm, 20));
    same_fields(&x, &twin);
    same_forces(&x, &twin);
  }
}

/* A step that fails half way is forgotten. */
TEST_SERIAL(mends_a_failed_step) {
  SCOPED(drop)
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        twin = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  scoped_snapshot *snapshot = NULL;
  OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
  mpsi_particles_column(x.s.particles, "velocity", 0)[7] = NAN;
  FAILS(mps_mpm_step(x.s.mpm, 1), MPS_ERROR_DIVERGED, "not finite");
  assert_int_equal(mps_mpm_steps(x.s.mpm), 0); /* undone */
  OK(roll(&x, snapshot));
  follows(&x, &twin, 20);
}

TEST(belongs_to_its_solver) {
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        y = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  scoped_snapshot *snapshot = NULL;
  REFUSES(mps_mpm_rollback(x.s.mpm, NULL), "snapshot is NULL");
  REFUSES(mps_mpm_snapshot(x.s.mpm, NULL), "snapshot is NULL");
  assert_int_equal(mps_mpm_snapshot(NULL, &snapshot), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_rollback(NULL, snapshot), MPS_ERROR_ARGUMENT);
  mps_snapshot_destroy(&snapshot); /* nothing */
  mps_snapshot_destroy(NULL);
  OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
  REFUSES(mps_mpm_rollback(y.s.mpm, snapshot), "of another solver");
  REFUSES(mps_mpm_snapshot(y.s.mpm, &snapshot), "of another solver");
  assert_non_null(snapshot);
  drop(&x); /* it survives, also where the next solver gets the memory of this one */
  x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  REFUSES(mps_mpm_rollback(x.s.mpm, snapshot), "of another solver");
  drop(&x);
  drop(&y);
  mps_context_destroy(&context); /* and its context's last share */
}

/* The caller's own field may go while the solver holds the set, and comes back with the state. */
TEST(a_removed_field_comes_back) {
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  SCOPED(drop)
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        twin = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  scoped_snapshot *snapshot = NULL;
  mps_particles *set = x.s.particles;
  OK(mps_particles_add_field(set, "user.own", 1));
  OK(mps_particles_add_field(set, "user.rest", 1));
  OK(mps_particles_set(set, "user.own", 0, 7.0));
  OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
  FAILS(mps_particles_remove_field(set, "stress"), MPS_ERROR_STATE, "used by a WLS-MPM solver");
  OK(mps_particles_remove_field(set, "user.own"));
  OK(mps_mpm_step(x.s.mpm, 120)); /* sorts */
  OK(roll(&x, snapshot));
  mps_view own;
  OK(mps_particles_view(set, "user.own", &own));
  for (int64_t k = 0; k < own.shape[0]; k++) assert_true(*mps_view_f64(&own, k, 0) == 7.0);
  OK(mps_particles_remove_field(set, "user.own"));
  OK(mps_particles_remove_field(set, "user.rest"));
  follows(&x, &twin, 20);
}

/* What the caller has built since is not undone: it is named. */
TEST_SERIAL(another_build_is_refused) {
  change c = none;
  c.bodies = 1;
  SCOPED(drop)
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &c),
        twin = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &c);
  scoped_snapshot *snapshot = NULL;
  OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
  OK(mps_mpm_step(x.s.mpm, 5));
  OK(mps_mpm_step(twin.s.mpm, 5));
  mpm_scene_contact(&x.s, x.body[1], 0.4);
  mpm_scene_contact(&twin.s, twin.body[1], 0.4);
  FAILS(roll(&x, snapshot), MPS_ERROR_STATE, "in the snapshot bodies is 1, in this solver 2");
  follows(&x, &twin, 5);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static mps_status snapshot_once(mps_context *own, int what) {
  scene x;
  scoped_snapshot *snapshot = NULL;
  mps_status status = try_build(own, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none, &x);
  if (status == MPS_OK) status = mps_mpm_snapshot(x.s.mpm, &snapshot);
  if (status == MPS_OK) status = mps_mpm_rollback(x.s.mpm, snapshot);
  drop(&x);
  return status;
}

TEST(refused_allocations_leave_nothing_behind) { test_allocator_sweep(snapshot_once, 0); }

/* Each allocation of a rollback, and of a snapshot filled again, is refused in turn: the run is
 * where it was, and the snapshot what it was. The particles have been sorted in between. */
TEST(refused_allocations_change_nothing) {
  test_allocator allocator = {0};
  mps_context *context = test_allocator_context(&allocator);
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        twin = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        first = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  mps_snapshot *snapshot = NULL;
  OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
  const uint64_t epoch = mps_particles_epoch(x.s.particles);
  OK(mps_mpm_step(x.s.mpm, 120));
  OK(mps_mpm_step(twin.s.mpm, 120));
  assert_true(mps_particles_epoch(x.s.particles) != epoch);
  OK(mps_particles_add_field(x.s.particles, "user.own", 2)); /* larger than it was */
  OK(mps_particles_add_field(twin.s.particles, "user.own", 2));
  for (int what = 0; what < 2; what++) {
    mps_status status = MPS_ERROR_MEMORY;
    for (int64_t k = 1; status != MPS_OK; k++) {
      const int64_t live = allocator.live;
      allocator.calls = 0;
      allocator.refuse_at = k;
      status = what ? mps_mpm_rollback(x.s.mpm, snapshot) : mps_mpm_snapshot(x.s.mpm, &snapshot);
      allocator.refuse_at = 0;
      if (status == MPS_OK) break;
      assert_int_equal(status, MPS_ERROR_MEMORY);
      if (what) assert_int_equal(allocator.live, live);
      follows(&x, &twin, 1);
      if (!what) { /* still the first state */
        scoped_snapshot *second = NULL;
        OK(mps_mpm_snapshot(x.s.mpm, &second));
        OK(roll(&x, snapshot));
        assert_int_equal(mps_mpm_steps(x.s.mpm), 0);
        same_bodies(&x, &first);
        OK(roll(&x, second));
      }
    }
    if (what == 0) { /* the snapshot is now of here, and rollback has to undo a sort */
      OK(mps_mpm_step(x.s.mpm, 120));
      OK(roll(&x, snapshot));
      follows(&x, &twin, 120);
    }
  }
  mps_snapshot_destroy(&snapshot);
  drop(&x);
  drop(&twin);
  drop(&first);
  mps_context_destroy(&context);
  assert_int_equal(allocator.live, 0);
}

/* Filled again with the same sizes, a snapshot allocates no more than its list. */
TEST(memory_is_reused) {
  test_allocator allocator = {0};
  mps_context *context = test_allocator_context(&allocator);
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  mps_snapshot *snapshot = NULL;
  OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
  const int64_t live = allocator.live, before = allocator.calls;
  OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
  assert_int_equal(allocator.live, live);
  const int64_t again = allocator.calls - before;
  assert_true(again <= 4); /* the list of items, which grows */
  mps_snapshot_destroy(&snapshot);
  drop(&x);
  mps_context_destroy(&context);
  assert_int_equal(allocator.live, 0);
}
