/* test_hdf5_fluid.c - a fluid that continues from a checkpoint in a new solver is, bit for bit, the
 * one that never stopped, on any number of threads; a tank built otherwise, or a damaged file, is
 * refused and changes nothing. SPDX-License-Identifier: BSD-3-Clause */
#include "digest.h"
#include "fluid_readings.h"
#include <mps/io.h>

static const char path[] = TEST_TMP "/fluid.h5";
static const char *const fields[] = {"position", "velocity", "reduced_pressure", "pressure", NULL};

/* Water of 24 x 12 particles before a piston. */
static tank make(mps_context *c, double depth) {
  mps_signal *piston = NULL;
  mps_assert_ok(c, mps_signal_create_sine(c, 1.25, 0.005, 0.0, &piston));
  tank t = tank_make(c, 24 * 0.025, depth, 0.025, piston, 2e-3);
  mps_signal_destroy(&piston);
  return t;
}

static mps_reaction on_left(mps_context *c, const tank *t) {
  mps_reaction r;
  mps_assert_ok(c, mps_fluid_get_reaction(t->fluid, TANK_LEFT, &r));
  return r;
}

static void same(mps_context *a, const tank *x, mps_context *b, const tank *y) {
  assert_true(digest_fields(a, x->water, fields) == digest_fields(b, y->water, fields));
  assert_true(mps_fluid_time(x->fluid) == mps_fluid_time(y->fluid));
  assert_int_equal(mps_fluid_steps(x->fluid), mps_fluid_steps(y->fluid));
  const mps_reaction p = on_left(a, x), q = on_left(b, y);
  assert_true(p.force[0] == q.force[0] && p.impulse[0] == q.impulse[0] && p.work == q.work);
  static readings before, again;
  read_all(a, x->fluid, 0.6, NULL, &before);
  read_all(b, y->fluid, 0.6, NULL, &again);
  same_readings(&before, &again);
}

static void goes_on_from_a_file(void **state) {
  (void)state;
  mps_context *a = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  tank whole = make(a, 0.3);
  for (int32_t threads = 1; threads <= 3; threads++) {
    mps_assert_ok(a, mps_fluid_step(whole.fluid, 20));
    mps_assert_ok(a, mps_fluid_save(whole.fluid, path, NULL));
    mps_context *b = test_context(MPS_CONTEXT_EXECUTOR_THREADS, threads);
    tank next = make(b, 0.3);
    if (threads == 2) mps_assert_ok(b, mps_fluid_step(next.fluid, 3)); /* no matter where it is */
    mps_checkpoint info = mps_checkpoint_defaults();
    mps_assert_ok(b, mps_fluid_restore(next.fluid, path, &info));
    assert_int_equal(info.step, mps_fluid_steps(whole.fluid));
    assert_true(info.time == mps_fluid_time(whole.fluid));
    same(a, &whole, b, &next);
    mps_assert_ok(a, mps_fluid_step(whole.fluid, 20));
    mps_assert_ok(b, mps_fluid_step(next.fluid, 20));
    same(a, &whole, b, &next);
    tank_free(&next);
    mps_context_destroy(&b);
  }
  tank_free(&whole);
  mps_context_destroy(&a);
}

/* A box that floats and heaves: its place is the file's too. */
static tank make_afloat(mps_context *c, mps_body **box) {
  mps_body_def def = mps_body_defaults();
  const double load[3] = {1.0, -10.0, 0.0};
  tank t = make(c, 0.3);
  int64_t ids[4 * 4], count = 0;
  mps_view id, x;
  mps_assert_ok(c, mps_particles_view(t.water, "id", &id));
  mps_assert_ok(c, mps_particles_view(t.water, "position", &x));
  for (int64_t i = 0; i < id.shape[0]; i++)
    if (fabs(*mps_view_f64(&x, i, 0) - 0.3) < 0.05 && *mps_view_f64(&x, i, 1) > 0.2)
      ids[count++] = *mps_view_i64(&id, i, 0);
  assert_int_equal(count, 16);
  mps_assert_ok(c, mps_particles_remove(t.water, count, ids));
  def.motion = MPS_BODY_MOTION_FREE, def.gravity[1] = -TANK_G;
  def.position[0] = 0.3, def.position[1] = 0.3;
  def.mass = 10.0, def.inertia[2] = 0.04;
  mps_assert_ok(c, mps_body_create_box(c, &def, 0.1, 0.2, box));
  mps_assert_ok(c, mps_body_set_load(*box, load, NULL));
  tank_float(c, t.fluid, *box);
  return t;
}

static void a_body_afloat_goes_on_from_a_file(void **state) {
  (void)state;
  mps_context *a = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_body *box = NULL, *other = NULL;
  mps_body_state p, q;
  tank whole = make_afloat(a, &box), next = make_afloat(a, &other);
  mps_assert_ok(a, mps_fluid_step(whole.fluid, 10));
  mps_assert_ok(a, mps_fluid_save(whole.fluid, path, NULL));
  mps_assert_ok(a, mps_fluid_restore(next.fluid, path, NULL));
  mps_assert_ok(a, mps_fluid_step(whole.fluid, 10));
  mps_assert_ok(a, mps_fluid_step(next.fluid, 10));
  same(a, &whole, a, &next);
  mps_assert_ok(a, mps_body_get_state(box, &p));
  mps_assert_ok(a, mps_body_get_state(other, &q));
  assert_true(p.position[1] < 0.3 && p.velocity[0] > 0.0);
  assert_memory_equal(&p, &q, sizeof p);
  mps_body_destroy(&box);
  mps_body_destroy(&other);
  tank_free(&whole);
  tank_free(&next);
  mps_context_destroy(&a);
}

static void other_tanks_and_damaged_files_are_refused(void **state) {
  (void)state;
  mps_context *c = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  tank t = make(c, 0.3), lower = make(c, 0.275);
  mps_assert_ok(c, mps_fluid_step(t.fluid, 5));
  mps_assert_ok(c, mps_fluid_save(t.fluid, path, NULL));
  const uint64_t before = digest_fields(c, lower.water, fields);
  assert_int_not_equal(mps_fluid_restore(lower.fluid, path, NULL), MPS_OK);
  assert_true(strlen(mps_context_error(c)->message) > 0);
  assert_true(digest_fields(c, lower.water, fields) == before);

  /* A wall more. */
  tank_wall(c, t.fluid, 0.0, 1.0, 0.0, -1.0, NULL);
  assert_int_not_equal(mps_fluid_restore(t.fluid, path, NULL), MPS_OK);
  mps_assert_ok(c, mps_fluid_remove_boundary(t.fluid, 3));
  mps_assert_ok(c, mps_fluid_restore(t.fluid, path, NULL));

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
  const uint64_t now = digest_fields(c, t.water, fields);
  mps_assert_fails(c, mps_fluid_restore(t.fluid, path, NULL), MPS_ERROR_FORMAT, "fluid.h5");
  assert_true(digest_fields(c, t.water, fields) == now);
  mps_assert_ok(c, mps_fluid_step(t.fluid, 2));
  tank_free(&lower);
  tank_free(&t);
  mps_context_destroy(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(goes_on_from_a_file),
      cmocka_unit_test(a_body_afloat_goes_on_from_a_file),
      cmocka_unit_test(other_tanks_and_damaged_files_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
