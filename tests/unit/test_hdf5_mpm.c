/* test_hdf5_mpm.c - a WLS-MPM run that continues from a checkpoint in a new solver is, bit for bit,
 * the run that never stopped, on any number of threads; a solver built otherwise is refused by
 * name. SPDX-License-Identifier: BSD-3-Clause */
#include "io/checkpoint.h"
#include "core/particles/particles_internal.h"
#include "mpm_twins.h"
#include "test_allocator.h"
#include "test_hdf5.h"

#include <core/internal.h>
#include <io/replace.h>

#include <fcntl.h>
#include <unistd.h>

static const char path[] = TEST_TMP "/mpm.h5", part[] = TEST_TMP "/mpm.h5.part";

/* ---- the same bits --------------------------------------------------------------------------- */

/* One run continues all the while; at each stop it is saved, and another solver, on other threads,
 * takes over and follows it to the next stop. */
static void stop_and_go_on(int32_t geometry, int64_t steps, int stops) {
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  SCOPED(drop) scene whole = build(context, geometry, &none);
  const uint64_t epoch = mps_particles_epoch(whole.s.particles);
  for (int k = 0; k < stops; k++) {
    int32_t threads = 1 + k % 3;
    scoped_context *other = on_threads(&threads);
    OK(mps_mpm_save(whole.s.mpm, path, NULL));
    SCOPED(drop) scene next = build(other, geometry, &none);
    if (k % 2) OK(mps_mpm_step(next.s.mpm, 5)); /* where it is does not matter */
    mps_checkpoint info = mps_checkpoint_defaults();
    OK(mps_mpm_restore(next.s.mpm, path, &info));
    assert_int_equal(info.step, mps_mpm_steps(whole.s.mpm));
    assert_true(info.time == mps_mpm_time(whole.s.mpm) && info.dt == mps_mpm_dt(whole.s.mpm));
    same(&whole, &next);
    OK(mps_mpm_step(whole.s.mpm, steps));
    OK(mps_mpm_step(next.s.mpm, steps));
    same(&whole, &next);
  }
  for (int b = 0; b < BODIES; b++) { /* all this has been of contact, and of sorting */
    mps_reaction r;
    OK(mps_body_get_reaction(whole.body[b], -1, &r));
    assert_true(r.impulse[1] != 0.0);
  }
  assert_true(mps_particles_epoch(whole.s.particles) > epoch);
}

TEST(goes_on_in_plane_strain) { stop_and_go_on(MPS_MPM_GEOMETRY_PLANE_STRAIN, 61, 8); }

TEST(goes_on_in_axisymmetry) { stop_and_go_on(MPS_MPM_GEOMETRY_AXISYMMETRIC, 83, 4); }

TEST(goes_on_in_space) { stop_and_go_on(MPS_MPM_GEOMETRY_SPACE, 29, 4); }

/* Stops at every step, some of which leave the particles to be sorted by the next. */
TEST_SERIAL(goes_on_from_every_step) {
  SCOPED(drop)
  scene whole = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        next = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  OK(mps_mpm_step(whole.s.mpm, 100));
  uint64_t epoch = mps_particles_epoch(whole.s.particles);
  int sorted = 0;
  for (int k = 0; k < (test_quick() ? 40 : 100); k++) {
    OK(mps_mpm_save(whole.s.mpm, path, NULL));
    OK(mps_mpm_restore(next.s.mpm, path, NULL));
    OK(mps_mpm_step(whole.s.mpm, 1));
    OK(mps_mpm_step(next.s.mpm, 1));
    same(&whole, &next);
    sorted += mps_particles_epoch(whole.s.particles) != epoch;
    epoch = mps_particles_epoch(whole.s.particles);
  }
  assert_true(sorted > 0);
}

/* ---- walls, moving nodes, loads, several materials ------------------------------------------- */

/* A block under a plate that reaches 1 mm into it; `late`: its contact begins after three steps. */
static scene overlapped(mps_context *on, bool late) {
  scene x = {.s = mpm_scene_begin(on, 0.01, 0.0, 0.0, 1e6)};
  mpm_scene_box(&x.s, 0.0, 0.0, 0.2, 0.1);
  USING(mpm, mpm_scene_solve(&x.s, &given), .cell = 0.02, .lower[1] = 0.0, .gravity[1] = -9.81);
  if (late) OK(mps_mpm_step(x.s.mpm, 3));
  DEF(body, at, .position[0] = 0.1, .position[1] = 0.149);
  WITH_DEFAULTS(mps_body_motion, down, .velocity[1] = -0.1);
  OK(mps_body_create_box(on, &at, 0.5, 0.1, &x.body[DRIVEN]));
  OK(mps_body_set_motion(x.body[DRIVEN], &down));
  OK(mps_mpm_add_contact(x.s.mpm, x.body[DRIVEN], NULL, NULL));
  return x;
}

/* Saved before the first step of a contact, and after. */
TEST_SERIAL(overlaps_go_on) {
  SCOPED(drop) scene whole = overlapped(context, true);
  for (int k = 0; k < 2; k++) {
    OK(mps_mpm_save(whole.s.mpm, path, NULL));
    SCOPED(drop) scene next = overlapped(context, false);
    OK(mps_mpm_restore(next.s.mpm, path, NULL));
    OK(mps_mpm_step(whole.s.mpm, 50));
    OK(mps_mpm_step(next.s.mpm, 50));
    same_fields(&whole, &next);
  }
}

TEST(with_walls_loads_and_materials) {
  for (int32_t geometry = 0; geometry <= MPS_MPM_GEOMETRY_SPACE; geometry++) {
    scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
    SCOPED(drop) scene whole = build_held(context, geometry);
    for (int k = 0; k < (test_quick() ? 3 : 4);
         k++) { /* at first before the walls have found their forces at rest */
      int32_t threads = 3;
      scoped_context *other = on_threads(&threads);
      OK(mps_mpm_save(whole.s.mpm, path, NULL));
      scene next = build_held(other, geometry);
      if (k == 2) OK(mps_mpm_step(next.s.mpm, 30));
      OK(mps_mpm_restore(next.s.mpm, path, NULL));
      same_fields(&whole, &next);
      same_forces(&whole, &next);
      OK(mps_mpm_step(whole.s.mpm, 20));
      OK(mps_mpm_step(next.s.mpm, 20));
      same_fields(&whole, &next);
      same_forces(&whole, &next);
      drop(&next);
    }
  }
}

TEST_SERIAL(other_walls_loads_and_materials_are_refused) {
  scene saved = build_held(context, MPS_MPM_GEOMETRY_PLANE_STRAIN);
  OK(mps_mpm_save(saved.s.mpm, path, NULL));
  drop(&saved);
  for (int k = 0; k < 4; k++) {
    int32_t box, loads[2];
    SCOPED(drop) scene x = {.s = held_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &box, loads)};
    if (k == 0) OK(mps_mpm_set_side(x.s.mpm, 1, MPS_BOUNDARY_HELD, 0.0));
    if (k == 1) OK(mps_mpm_remove_load(x.s.mpm, loads[1]));
    if (k == 2) OK(mps_mpm_remove_boundary(x.s.mpm, box));
    static const char *const text[] = {
        "boundary1/kind is MPS_BOUNDARY_ABSORBING, in this solver MPS_BOUNDARY_HELD",
        "loads is 2, in this solver 1", "boundary6/kind is MPS_BOUNDARY_DRIVEN, in this solver -1",
        "materials is 2, in this solver 1"};
    REFUSES(mps_mpm_restore(x.s.mpm, path, NULL), text[k]);
  }
}

/* ---- errors ---------------------------------------------------------------------------------- */

TEST_SERIAL(another_solver_is_refused) {
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  OK(mps_mpm_step(x.s.mpm, 20));
  OK(mps_mpm_save(x.s.mpm, path, NULL));
  drop(&x);
  const struct {
    int32_t geometry;
    change c;
    const char *text;
  } list[] = {
      {MPS_MPM_GEOMETRY_AXISYMMETRIC, none,
       "geometry is MPS_MPM_GEOMETRY_PLANE_STRAIN, in this solver "
       "MPS_MPM_GEOMETRY_AXISYMMETRIC"},
      {MPS_MPM_GEOMETRY_SPACE, none, "particles in 2D, the set has"},
      {0, {.spacing = 0.02, .cell = 0.02, .bodies = 2}, "spacing 0.01 m, the set has 0.02"},
      {0, {.spacing = 0.01, .cell = 0.04, .bodies = 2}, "in this solver 0.0400"},
      {0,
       {.spacing = 0.01, .cell = 0.02, .bodies = 2, .origin = -0.1},
       "axis0/origin is 0, in this solver -0.1"},
      {0,
       {.spacing = 0.01, .cell = 0.02, .bodies = 2, .wall = 0.2},
       "axis0/highest_node is 50, in this solver 60"},
      {0,
       {.spacing = 0.01, .cell = 0.02, .bodies = 2, .elastic = true},
       "material0/name is 'drucker_prager', in"},
      {0, {.spacing = 0.01, .cell = 0.02, .bodies = 1}, "bodies is 2, in this solver 1"},
      {0,
       {.spacing = 0.01, .cell = 0.02, .bodies = 2, .half_plane = true},
       "body1/shape is 2, in this solver 1"},
  };
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    SCOPED(drop) scene a = build(context, list[k].geometry, &list[k].c);
    SCOPED(drop) scene b = build(context, list[k].geometry, &list[k].c);
    REFUSES(mps_mpm_restore(a.s.mpm, path, NULL), list[k].text);
    same(&a, &b); /* nothing has changed, and it runs */
    OK(mps_mpm_step(a.s.mpm, 3));
    OK(mps_mpm_step(b.s.mpm, 3));
    same(&a, &b);
  }
}

/* The set takes the particles of the file: more, fewer, or others than it has. */
TEST_SERIAL(another_number_of_particles_is_taken) {
  change more = none;
  more.particles = 1;
  SCOPED(drop)
  scene few = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        many = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &more);
  OK(mps_mpm_step(few.s.mpm, 60));
  OK(mps_mpm_save(few.s.mpm, path, NULL));
  OK(mps_mpm_restore(many.s.mpm, path, NULL));
  assert_int_equal(mps_particles_count(many.s.particles), 800);
  same(&few, &many);
  OK(mps_mpm_step(few.s.mpm, 60));
  OK(mps_mpm_step(many.s.mpm, 60));
  same(&few, &many);
  const int64_t gone[3] = {0, 401, 799};
  OK(mps_particles_remove(few.s.particles, gone, 3));
  OK(mps_mpm_step(few.s.mpm, 20));
  OK(mps_mpm_restore(few.s.mpm, path, NULL));
  OK(mps_mpm_step(few.s.mpm, 60));
  same(&few, &many);
}

TEST_SERIAL(other_files_and_bad_arguments) {
  SCOPED(drop) scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  mps_checkpoint info = mps_checkpoint_defaults();
  assert_int_equal(mps_mpm_save(NULL, path, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_restore(NULL, path, NULL), MPS_ERROR_ARGUMENT);
  REFUSES(mps_mpm_save(x.s.mpm, "", NULL), "path is empty");
  REFUSES(mps_mpm_restore(x.s.mpm, NULL, NULL), "path is NULL");
  FAILS(mps_mpm_restore(x.s.mpm, TEST_TMP "/no.h5", NULL), MPS_ERROR_IO, "no.h5");
  info.user_bytes = -1;
  REFUSES(mps_mpm_save(x.s.mpm, path, &info), "user_bytes is -1");
  info.user_bytes = 3;
  REFUSES(mps_mpm_save(x.s.mpm, path, &info), "user_data is NULL");
  info.user_bytes = 0;
  OK(mpsi_checkpoint_write(x.s.particles, path, &info));
  FAILS(mps_mpm_restore(x.s.mpm, path, NULL), MPS_ERROR_FORMAT, "no solver");
  OK(mps_mpm_save(x.s.mpm, path, NULL));
  assert_int_equal(truncate(path, 5000), 0);
  FAILS(mps_mpm_restore(x.s.mpm, path, NULL), MPS_ERROR_FORMAT, "mpm.h5");
  OK(mps_mpm_save(x.s.mpm, path, NULL));
  OK(mps_mpm_step(x.s.mpm, 1));
  test_disk_limit(20000);
  const mps_status status = mps_mpm_save(x.s.mpm, path, NULL);
  test_disk_limit(0);
  assert_int_equal(status, MPS_ERROR_IO);
  assert_int_equal(access(part, F_OK), -1);
  OK(mps_mpm_restore(x.s.mpm, path, NULL)); /* the former one */
  assert_int_equal(mps_mpm_steps(x.s.mpm), 0);
}

/* A step that diverges is undone, and an earlier checkpoint brings back what was before. */
TEST_SERIAL(a_broken_run_goes_back) {
  SCOPED(drop)
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        y = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  OK(mps_mpm_save(x.s.mpm, path, NULL));
  OK(mps_mpm_step(x.s.mpm, 3));
  mpsi_particles_column(x.s.particles, "velocity", 0)[7] = NAN;
  FAILS(mps_mpm_step(x.s.mpm, 1), MPS_ERROR_DIVERGED, "not finite");
  assert_int_equal(mps_mpm_steps(x.s.mpm), 3);
  OK(mps_mpm_restore(x.s.mpm, path, NULL));
  OK(mps_mpm_step(x.s.mpm, 10));
  OK(mps_mpm_step(y.s.mpm, 10));
  same(&x, &y);
}

/* What the caller gives along comes back, from both kinds of checkpoint. */
TEST_SERIAL(the_callers_bytes_come_back) {
  SCOPED(drop) scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  char text[] = "rows so far", room[64];
  for (int k = 0; k < 2; k++) {
    mps_checkpoint info = mps_checkpoint_defaults(), back = mps_checkpoint_defaults();
    info.user_data = text, info.user_bytes = sizeof text;
    strcpy(info.user_key, "a run");
    OK(k ? mps_mpm_save(x.s.mpm, path, &info) : mpsi_checkpoint_write(x.s.particles, path, &info));
    OK(mps_checkpoint_info(context, path, &back));
    assert_int_equal(back.user_bytes, sizeof text);
    assert_string_equal(back.user_key, "a run");
    memset(room, 'x', sizeof room);
    back.user_data = room;
    back.user_bytes = sizeof text - 1;
    REFUSES(mps_checkpoint_info(context, path, &back), "user_bytes is 11, '");
    assert_int_equal(room[0], 'x');
    back.user_bytes = sizeof room;
    OK(k ? mps_mpm_restore(x.s.mpm, path, &back) : mps_checkpoint_info(context, path, &back));
    assert_int_equal(back.user_bytes, sizeof text);
    assert_string_equal(room, text);
    strcpy(back.user_key, "another");
    if (k) REFUSES(mps_mpm_restore(x.s.mpm, path, &back), "wanted is 'another'");
  }
}

/* Fields that a solver has not read would be a wrong state without a word. */
TEST_SERIAL(a_set_that_a_solver_holds_is_not_read_into) {
  SCOPED(drop)
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        twin = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  mps_checkpoint info = mps_checkpoint_defaults();
  OK(mpsi_checkpoint_write(x.s.particles, path, &info));
  OK(mps_mpm_step(x.s.mpm, 5));
  OK(mps_mpm_step(twin.s.mpm, 5));
  FAILS(mps_checkpoint_read(x.s.particles, path, &info), MPS_ERROR_STATE, "held by");
  same(&x, &twin);
}

/* A sealed file with contents that no run writes: a block elsewhere, or with a tile that its
 * particles' stencils would leave. */
TEST_SERIAL(blocks_elsewhere_are_refused) {
  SCOPED(drop) scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  enum { ROW = 10 };
  static const int64_t bad[][2] = {{0, 1},  {1, 1000}, {1, INT64_MAX}, {3, 1},
                                   {4, -1}, {4, 12},   {8, 99},        {9, 2}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    OK(mps_mpm_save(x.s.mpm, path, NULL));
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t dataset = H5Dopen2(file, "solver/blocks", H5P_DEFAULT);
    int64_t block[ROW * 64];
    assert_true(H5Dget_storage_size(dataset) <= sizeof block);
    assert_true(H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, block) >= 0);
    block[ROW + bad[k][0]] = bad[k][1]; /* of the second block */
    assert_true(H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, block) >= 0);
    H5Dclose(dataset);
    H5Fclose(file);
    mpsi_replacement again;
    OK(mpsi_replace_begin(context, "test", path, true, &again));
    char data[1 << 20];
    const int fd = open(path, O_RDONLY);
    const ssize_t size = read(fd, data, sizeof data);
    assert_true(size > 0 && size < (ssize_t)sizeof data);
    assert_int_equal(write(again.fd, data, (size_t)size), size);
    close(fd);
    OK(mpsi_replace_commit(context, "test", &again));
    FAILS(mps_mpm_restore(x.s.mpm, path, NULL), MPS_ERROR_FORMAT, "blocks do not contain");
    OK(mps_mpm_step(x.s.mpm, 1));
  }
}

static mps_status restore_once(mps_context *own, int what) {
  scene x;
  mps_status status = try_build(own, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none, &x);
  if (status == MPS_OK) status = mps_mpm_save(x.s.mpm, path, NULL);
  if (status == MPS_OK) status = mps_mpm_restore(x.s.mpm, path, NULL);
  drop(&x);
  return status;
}

TEST(refused_allocations_leave_nothing_behind) {
  const int64_t handles = test_hdf5_handles();
  test_allocator_sweep(restore_once, 0);
  assert_int_equal(test_hdf5_handles(), handles);
  assert_int_equal(access(part, F_OK), -1);
}
