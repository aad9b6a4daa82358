/* test_hdf5_fluid.c - a fluid that continues from a checkpoint in a new solver is, bit for bit, the
 * one that never stopped, on any number of threads; a tank built otherwise, or a damaged file, is
 * refused and changes nothing. SPDX-License-Identifier: BSD-3-Clause */
#include "digest.h"
#include "fluid_readings.h"

static const char path[] = TEST_TMP "/fluid.h5";
static const char *const fields[] = {"position", "velocity", "reduced_pressure", "pressure", NULL};

/* Water of 24 x 12 particles before a piston. */
static tank make(mps_context *c, double depth) {
  MAKE(signal, piston, create_sine, c, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.25, 0.005, 0.0);
  tank t = tank_make(c, 24 * 0.025, depth, 0.025, piston, 2e-3);
  return t;
}

static mps_reaction on_left(const tank *t) {
  mps_reaction r;
  OK(mps_fluid_get_reaction(t->fluid, TANK_LEFT, &r));
  return r;
}

static void same(const tank *x, const tank *y) {
  assert_true(digest_fields(x->water, fields) == digest_fields(y->water, fields));
  assert_true(mps_fluid_time(x->fluid) == mps_fluid_time(y->fluid));
  assert_int_equal(mps_fluid_steps(x->fluid), mps_fluid_steps(y->fluid));
  const mps_reaction p = on_left(x), q = on_left(y);
  assert_true(p.force[0] == q.force[0] && p.impulse[0] == q.impulse[0] && p.work == q.work);
  static readings before, again;
  read_all(x->fluid, 0.6, NULL, &before);
  read_all(y->fluid, 0.6, NULL, &again);
  same_readings(&before, &again);
}

TEST(goes_on_from_a_file) {
  scoped_context *a = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_tank whole = make(a, 0.3);
  for (int32_t threads = 1; threads <= 3; threads++) {
    OK(mps_fluid_step(whole.fluid, 20));
    OK(mps_fluid_save(whole.fluid, path, NULL));
    scoped_context *b = test_context(MPS_CONTEXT_EXECUTOR_THREADS, threads);
    scoped_tank next = make(b, 0.3);
    if (threads == 2) OK(mps_fluid_step(next.fluid, 3)); /* no matter where it is */
    mps_checkpoint info = mps_checkpoint_defaults();
    OK(mps_fluid_restore(next.fluid, path, &info));
    assert_int_equal(info.step, mps_fluid_steps(whole.fluid));
    assert_true(info.time == mps_fluid_time(whole.fluid));
    same(&whole, &next);
    OK(mps_fluid_step(whole.fluid, 20));
    OK(mps_fluid_step(next.fluid, 20));
    same(&whole, &next);
  }
}

/* A box that floats and heaves: its place is the file's too. */
static tank make_afloat(mps_context *c, mps_body **box) {
  const double load[3] = {1.0, -10.0, 0.0};
  tank t = make(c, 0.3);
  int64_t ids[4 * 4], count = 0;
  mps_view id = view_field(t.water, "id");
  mps_view x = view_field(t.water, "position");
  for (int64_t i = 0; i < id.shape[0]; i++)
    if (fabs(*mps_view_f64(&x, i, 0) - 0.3) < 0.05 && *mps_view_f64(&x, i, 1) > 0.2)
      ids[count++] = *mps_view_i64(&id, i, 0);
  assert_int_equal(count, 16);
  OK(mps_particles_remove(t.water, ids, count));
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE, .gravity[1] = -TANK_G, .position[0] = 0.3,
      .position[1] = 0.3, .mass = 10.0, .inertia[2] = 0.04);
  OK(mps_body_create_box(c, &def, 0.1, 0.2, box));
  OK(mps_body_set_load(*box, load, NULL));
  tank_float(t.fluid, *box);
  return t;
}

TEST(a_body_afloat_goes_on_from_a_file) {
  scoped_context *a = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_body *box = NULL, *other = NULL;
  mps_body_state p, q;
  scoped_tank whole = make_afloat(a, &box), next = make_afloat(a, &other);
  OK(mps_fluid_step(whole.fluid, 10));
  OK(mps_fluid_save(whole.fluid, path, NULL));
  OK(mps_fluid_restore(next.fluid, path, NULL));
  OK(mps_fluid_step(whole.fluid, 10));
  OK(mps_fluid_step(next.fluid, 10));
  same(&whole, &next);
  OK(mps_body_get_state(box, &p));
  OK(mps_body_get_state(other, &q));
  assert_true(p.position[1] < 0.3 && p.velocity[0] > 0.0);
  assert_memory_equal(&p, &q, sizeof p);
}

TEST(other_tanks_and_damaged_files_are_refused) {
  scoped_context *c = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_tank t = make(c, 0.3), lower = make(c, 0.275);
  OK(mps_fluid_step(t.fluid, 5));
  OK(mps_fluid_save(t.fluid, path, NULL));
  const uint64_t before = digest_fields(lower.water, fields);
  assert_int_not_equal(mps_fluid_restore(lower.fluid, path, NULL), MPS_OK);
  assert_true(strlen(mps_context_error(c)->message) > 0);
  assert_true(digest_fields(lower.water, fields) == before);

  /* A wall more. */
  tank_wall(t.fluid, 0.0, 1.0, 0.0, -1.0, NULL);
  assert_int_not_equal(mps_fluid_restore(t.fluid, path, NULL), MPS_OK);
  OK(mps_fluid_remove_boundary(t.fluid, 3));
  OK(mps_fluid_restore(t.fluid, path, NULL));

  /* One byte changed in the middle. */
  FILE *file = fopen(path, "r+b");
  assert_non_null(file);
  assert_int_equal(fseek(file, 0, SEEK_END), 0);
  const long middle = ftell(file) / 2;
  assert_int_equal(fseek(file, middle, SEEK_SET), 0);
  const int byte = fgetc(file);
  assert_int_equal(fseek(file, middle, SEEK_SET), 0);
  fputc(byte ^ 0x55, file);
  assert_int_equal(fclose(file), 0);
  const uint64_t now = digest_fields(t.water, fields);
  FAILS_ON(c, mps_fluid_restore(t.fluid, path, NULL), MPS_ERROR_FORMAT, "fluid.h5");
  assert_true(digest_fields(t.water, fields) == now);
  OK(mps_fluid_step(t.fluid, 2));
}
