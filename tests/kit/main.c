/* main.c - the program of tests that need no arguments.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/register.h"
#include "test_common.h"

int main(int count, char **text) {
  if (count > 1) cmocka_set_test_filter(text[1]);
  return test_run();
}
