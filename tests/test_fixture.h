/* test_fixture.h - one serial context for all tests of a program: the group's setup and teardown.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_FIXTURE_H
#define MPS_TEST_FIXTURE_H

#include "test_common.h"

static mps_context *context;

static int make_context(void **state) {
  (void)state;
  context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  return 0;
}

static int drop_context(void **state) {
  (void)state;
  mps_context_destroy(&context);
  return 0;
}

#endif
