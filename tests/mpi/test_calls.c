/* test_calls.c - ranks of mpirun that call different collective functions, each beside some of the
 * others: all get the same error, and none waits. SPDX-License-Identifier: BSD-3-Clause */
#include "collective_calls.h"

#include "world.h"

TEST(each_beside_some_others) {
  SCOPED(forget) subject s = {.own = own, .domain = domain};
  char why[512] = "";
  mps_status status = make_solvers(&s);
  OK(status);
  for (int a = 0; a < CALLS; a++)
    for (int step = 1; step < CALLS; step += 11) {
      const int b = (a + step) % CALLS;
      if (mps_domain_size(domain) == 1 || are_same(a, b)) continue;
      if (call_beside(&s, a, b, why) != MPS_OK) fail_msg("%s", why);
    }
}

int main(void) { return begin_world() ? end_world(test_run()) : 1; }
