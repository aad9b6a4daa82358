/* test_fluid_open_step.c - what may happen to a fluid while a step in parts is open.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include "fluid_tank.h"

/* A contact whose handle is destroyed while a step is open, as by an owner that runs out of scope:
 * the step is the body's last, whether it is ended or abandoned, and nothing is left. */
static void a_body_leaves_in_an_open_step(void **state) {
  (void)state;
  for (int ended = 0; ended < 3; ended++) {
    test_allocator allocator = {0};
    mps_context *own = test_allocator_context(&allocator);
    tank t = tank_make(own, 0.6, 0.3, 0.03, NULL, 2e-3);
    mps_body_def at = mps_body_defaults();
    mps_body *box = NULL;
    at.position[0] = 0.3, at.position[1] = 0.42;
    mps_assert_ok(own, mps_body_create_box(own, &at, 0.2, 0.2, &box));
    mps_contact *contact = tank_body(own, t.fluid, box, 0);
    mps_body_motion motion = mps_body_motion_defaults();
    motion.velocity[1] = -0.5, motion.position[1] = 0.419;
    mps_assert_ok(own, mps_body_set_motion(box, &motion));
    mps_assert_ok(own, mps_fluid_begin_step(t.fluid, NAN));
    mps_contact_destroy(&contact);
    assert_null(contact);
    mps_assert_ok(own, mps_fluid_solve_pressure(t.fluid));
    if (ended == 1) mps_assert_ok(own, mps_fluid_end_step(t.fluid));
    if (ended == 2) mps_assert_ok(own, mps_fluid_abandon_step(t.fluid));
    if (ended > 0) {
      contact = tank_body(own, t.fluid, box, 0); /* it is not in the water any more */
      mps_assert_ok(own, mps_fluid_step(t.fluid, 2));
      mps_contact_destroy(&contact);
    }
    mps_body_destroy(&box);
    tank_free(&t);
    mps_context_destroy(&own);
    assert_int_equal(allocator.live, 0);
  }
}

/* A solution that finds no memory, at any allocation: forces are those before it, and one that
 * finds memory follows. */
static void a_refused_solution_leaves_the_forces(void **state) {
  (void)state;
  test_allocator allocator = {0};
  mps_context *own = test_allocator_context(&allocator);
  tank t = tank_make(own, 0.25, 2.0, 0.05, NULL, 2e-3); /* bed, then longer walls */
  mps_reaction before[3], after;
  mps_status status = MPS_ERROR_MEMORY;
  int refused = 0;
  for (int32_t b = 0; b < 3; b++)
    mps_assert_ok(own, mps_fluid_get_reaction(t.fluid, b, &before[b]));
  mps_assert_ok(own, mps_fluid_begin_step(t.fluid, NAN));
  for (int at = 1; status != MPS_OK; at++) {
    allocator.refuse_at = allocator.calls + at;
    status = mps_fluid_solve_pressure(t.fluid);
    allocator.refuse_at = 0;
    if (status == MPS_OK) break;
    refused++;
    assert_int_equal(status, MPS_ERROR_MEMORY);
    for (int32_t b = 0; b < 3; b++) {
      mps_assert_ok(own, mps_fluid_get_reaction(t.fluid, b, &after));
      assert_memory_equal(&after, &before[b], sizeof after);
    }
    assert_true(at < 1000);
  }
  print_message("%d allocations refused\n", refused);
  assert_true(refused >= 2);
  mps_assert_ok(own, mps_fluid_end_step(t.fluid));
  mps_assert_ok(own, mps_fluid_get_reaction(t.fluid, TANK_BED, &after));
  mps_assert_near(after.force[1], 1000.0 * TANK_G * 0.25 * 2.0, 5.0);
  tank_free(&t);
  mps_context_destroy(&own);
  assert_int_equal(allocator.live, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_body_leaves_in_an_open_step),
      cmocka_unit_test(a_refused_solution_leaves_the_forces),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
