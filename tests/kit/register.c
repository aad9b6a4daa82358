/* register.c - the tests of a program, as their constructors register them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/register.h"
#include "test_common.h"

enum { MOST = 128 };

static struct CMUnitTest tests[MOST];
static int lines[MOST];
static int count;
static test_setup_fn group[2];

/* Inserted by line: the order in which constructors run is the compiler's. */
void test_register(const char *name, test_fn test, test_setup_fn make, test_setup_fn drop,
                   int line) {
  if (count == MOST) abort();
  int at = count++;
  for (; at > 0 && lines[at - 1] > line; at--) {
    tests[at] = tests[at - 1];
    lines[at] = lines[at - 1];
  }
  tests[at] = (struct CMUnitTest){name, test, make, drop, NULL};
  lines[at] = line;
}

void test_register_group(test_setup_fn make, test_setup_fn drop) {
  group[0] = make, group[1] = drop;
}

int test_run(void) {
  return _cmocka_run_group_tests("tests", tests, (size_t)count, group[0], group[1]);
}
