/* test_fixture.h - one serial context for all tests of a program.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_FIXTURE_H
#define MPS_TEST_FIXTURE_H

#include "test_common.h"

extern mps_context *context;

int make_context(void **state);
int drop_context(void **state);

/* Before a program's own TEST_GROUP, which takes its place. */
__attribute__((constructor(101))) static void register_fixture(void) {
  test_register_group(make_context, drop_context);
}

#endif
