/* test_fluid_threads.c - a wave that breaks over a piston is the same bit for bit for every number
 * of threads. SPDX-License-Identifier: BSD-3-Clause */
#include "digest.h"
#include "fluid_tank.h"
#include "pthread_executor.h"

/* Positions, velocities, pressures and forces after 80 steps (20 if quick); 5000 particles, two
 * blocks of the preconditioner. */
static uint64_t run(const mps_context_def *def) {
  static const char *const names[] = {"id", "position", "velocity", "pressure", NULL};
  scoped_context *context = NULL;
  char text[256];
  if (mps_context_create(def, &context, text, sizeof text) != MPS_OK) fail_msg("%s", text);
  MAKE(signal, piston, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.3, 0.0);
  scoped_tank t = tank_make(context, 2.0, 1.0, 0.02, piston, 2e-3);
  OK(mps_fluid_step(t.fluid, test_quick() ? 20 : 80));
  uint64_t hash = digest_fields(t.water, names);
  mps_reaction r;
  OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &r));
  hash = digest_add(hash, &r.force[0]);
  hash = digest_add(hash, &r.moment[2]);
  return hash;
}

TEST(threads_change_nothing) {
  DEF(context, def, .executor = MPS_CONTEXT_EXECUTOR_SERIAL);
  const uint64_t expected = run(&def);
  for (int32_t threads = 2; threads <= 5; threads += 3) {
    def = pthread_executor_def(&threads);
    assert_true(run(&def) == expected);
  }
  def = mps_context_defaults();
  def.threads = 3;
  assert_true(run(&def) == expected);
}
