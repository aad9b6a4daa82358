/* test_common.h - what every test program shares: the public headers, cmocka, assertions on
 * doubles and statuses, a context.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_COMMON_H
#define MPS_TEST_COMMON_H

/* Callbacks need not read all that they get. */
#pragma GCC diagnostic ignored "-Wunused-parameter"

#ifndef MPS_EXPERIMENTAL
#define MPS_EXPERIMENTAL
#endif
#include <mps/experimental.h>
#include <mps/mps.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "kit/register.h"

#define PI 3.14159265358979323846

/* cmocka's float assertion casts to float; this one compares doubles and prints them. */
#define NEAR(actual, expected, tolerance)                                                          \
  do {                                                                                             \
    const double near_a = (actual), near_e = (expected), near_t = (tolerance);                     \
    if (!(fabs(near_a - near_e) <= near_t))                                                        \
      fail_msg("%s = %.17g, expected %.17g +- %g", #actual, near_a, near_e, near_t);               \
  } while (0)

/* Succeeds, or fails the test with the library's own message. */
#define OK(call)                                                                                   \
  do {                                                                                             \
    const mps_status ok_status = (call);                                                           \
    if (ok_status != MPS_OK)                                                                       \
      fail_msg("%s: status %d: %s", #call, (int)ok_status, mps_last_error()->message);             \
  } while (0)

/* Fails with `status`, and the record of context `on` has a message that contains `text`. */
#define FAILS_ON(on, call, expected_status, text)                                                  \
  do {                                                                                             \
    const mps_status fail_status = (call);                                                         \
    if (fail_status != (expected_status))                                                          \
      fail_msg("%s: status %d, expected %d", #call, (int)fail_status, (int)(expected_status));     \
    if (!strstr(mps_context_error(on)->message, (text)))                                           \
      fail_msg("%s: message \"%s\" does not contain \"%s\"", #call,                                \
               mps_context_error(on)->message, (text));                                            \
  } while (0)

/* The same on the context of that name where the call stands; REFUSES: as an argument. */
#define FAILS(call, status, text) FAILS_ON(context, call, status, text)
#define REFUSES(call, text) FAILS(call, MPS_ERROR_ARGUMENT, text)

#include "kit/objects.h"

/* The defaults, with the instruction level that ctest wants the loops of this run to have
 * (tests/CMakeLists.txt); a machine without it skips the program. */
static inline mps_context_def test_context_defaults(void) {
  mps_context_def def = mps_context_defaults();
  const char *level = getenv("MPS_TEST_LEVEL");
  if (level) {
    scoped_context *probe = NULL;
    char text[256];
    def.instruction_level = atoi(level);
    if (mps_context_create(&def, &probe, text, sizeof text) == MPS_ERROR_UNSUPPORTED) {
      printf("skipped: %s\n", text);
      exit(77);
    }
    mps_context_destroy(&probe);
    mps_context_def higher = def;
    bool highest = true;
    for (higher.instruction_level++; highest && higher.instruction_level <= 4;
         higher.instruction_level++)
      highest = mps_context_create(&higher, &probe, text, sizeof text) != MPS_OK;
    mps_context_destroy(&probe);
    if (highest) {
      printf(
          "skipped: the highest level of this machine, at which the test without a level runs\n");
      exit(77);
    }
  }
  return def;
}

/* Sanitizers, counters and the emulator run some ten times slower, and see in a few steps what they
 * would see in many: there the tests that compare results take fewer steps, and fewer numbers of
 * threads. */
static inline bool test_quick(void) { return getenv("MPS_TEST_QUICK") != NULL; }

/* The thread sanitizer looks for races alone: what a refused allocation leaves behind, and how much
 * memory a run takes, the other configurations see. There one in seven allocations is refused. */
static inline bool test_races(void) { return getenv("MPS_TEST_RACES") != NULL; }
static inline int64_t test_refusals_apart(void) { return test_races() ? 7 : 1; }

/* Of so many steps a quarter where it is to be quick. */
static inline int64_t test_steps(int64_t steps) { return test_quick() ? (steps + 3) / 4 : steps; }

static inline mps_context *test_context(int32_t executor, int32_t threads) {
  mps_context_def def = test_context_defaults();
  mps_context *context = NULL;
  char text[256];
  def.executor = executor;
  def.threads = threads;
  if (mps_context_create(&def, &context, text, sizeof text) != MPS_OK) fail_msg("%s", text);
  return context;
}

/* A test with a serial context of its own, named context. */
#define TEST_SERIAL(name)                                                                          \
  static void in_context_##name(mps_context *context);                                             \
  TEST(name) {                                                                                     \
    scoped_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);                            \
    in_context_##name(own);                                                                        \
  }                                                                                                \
  static void in_context_##name(mps_context *context)

#endif
