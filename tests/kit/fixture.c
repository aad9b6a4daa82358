/* fixture.c - one serial context for all tests of a program.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

mps_context *context;

int make_context(void **state) {
  (void)state;
  context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  return 0;
}

int drop_context(void **state) {
  (void)state;
  mps_context_destroy(&context);
  return 0;
}
