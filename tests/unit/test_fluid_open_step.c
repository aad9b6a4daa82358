/* test_fluid_open_step.c - what may happen to a fluid while a step in parts is open.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include "fluid_tank.h"

/* A contact whose handle is destroyed while a step is open, as by an owner that runs out of scope:
 * the step is the body's last, whether it is ended or abandoned, and nothing is left. */
TEST(a_body_leaves_in_an_open_step) {
  for (int ended = 0; ended < 3; ended++) {
    test_allocator allocator = {0};
    mps_context *own = test_allocator_context(&allocator);
    tank t = tank_make(own, 0.6, 0.3, 0.03, NULL, 2e-3);
    DEF(body, at, .position[0] = 0.3, .position[1] = 0.42);
    MAKE_KEPT(body, box, create_box, own, &at, 0.2, 0.2);
    mps_contact *contact = tank_body(t.fluid, box, MPS_CONTACT_MOVER_OTHER);
    WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = -0.5, .position[1] = 0.419);
    OK(mps_body_set_motion(box, &motion));
    OK(mps_fluid_begin_step(t.fluid, NAN));
    mps_contact_destroy(&contact);
    assert_null(contact);
    OK(mps_fluid_solve_pressure(t.fluid));
    if (ended == 1) OK(mps_fluid_end_step(t.fluid));
    if (ended == 2) OK(mps_fluid_abandon_step(t.fluid));
    if (ended > 0) {
      contact =
          tank_body(t.fluid, box, MPS_CONTACT_MOVER_OTHER); /* it is not in the water any more */
      OK(mps_fluid_step(t.fluid, 2));
      mps_contact_destroy(&contact);
    }
    mps_body_destroy(&box);
    tank_free(&t);
    mps_context_destroy(&own);
    assert_int_equal(allocator.live, 0);
  }
}
