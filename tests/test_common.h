/* test_common.h - what every test program shares: the public headers, cmocka, assertions on
 * doubles and statuses, a context.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_COMMON_H
#define MPS_TEST_COMMON_H

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

/* Objects that are destroyed where their block ends; they must have a value where they are
 * declared: scoped_body *body = NULL; */
#define SCOPED(destroy) __attribute__((cleanup(destroy), unused))
#define scoped_body SCOPED(mps_body_destroy) mps_body
#define scoped_contact SCOPED(mps_contact_destroy) mps_contact
#define scoped_context SCOPED(mps_context_destroy) mps_context
#define scoped_domain SCOPED(mps_domain_destroy) mps_domain
#define scoped_dynamics SCOPED(mps_dynamics_destroy) mps_dynamics
#define scoped_elastic SCOPED(mps_elastic_destroy) mps_elastic
#define scoped_fluid SCOPED(mps_fluid_destroy) mps_fluid
#define scoped_kernel SCOPED(mps_kernel_destroy) mps_kernel
#define scoped_material SCOPED(mps_material_destroy) mps_material
#define scoped_mpm SCOPED(mps_mpm_destroy) mps_mpm
#define scoped_particles SCOPED(mps_particles_destroy) mps_particles
#define scoped_recorder SCOPED(mps_recorder_destroy) mps_recorder
#define scoped_signal SCOPED(mps_signal_destroy) mps_signal
#define scoped_snapshot SCOPED(mps_snapshot_destroy) mps_snapshot

/* A definition with the defaults but for these members, at most 12:
 *   DEF(mpm, def, .cell = 0.02, .gravity[1] = -9.81);
 * WITH_DEFAULTS has the whole name of the type. */
#define DEF(noun, name, ...)                                                                       \
  mps_##noun##_def name = mps_##noun##_defaults();                                                 \
  SET_MEMBERS(name, __VA_ARGS__)
#define WITH_DEFAULTS(type, name, ...)                                                             \
  type name = type##_defaults();                                                                   \
  SET_MEMBERS(name, __VA_ARGS__)
#define SET_MEMBERS(v, ...)                                                                        \
  SET_COUNT(__VA_ARGS__, SET_12, SET_11, SET_10, SET_9, SET_8, SET_7, SET_6, SET_5, SET_4, SET_3,  \
            SET_2, SET_1, )                                                                        \
  (v, __VA_ARGS__)
#define SET_COUNT(a, b, c, d, e, f, g, h, i, j, k, l, which, ...) which
#define SET_1(v, a) v a
#define SET_2(v, a, ...) v a, SET_1(v, __VA_ARGS__)
#define SET_3(v, a, ...) v a, SET_2(v, __VA_ARGS__)
#define SET_4(v, a, ...) v a, SET_3(v, __VA_ARGS__)
#define SET_5(v, a, ...) v a, SET_4(v, __VA_ARGS__)
#define SET_6(v, a, ...) v a, SET_5(v, __VA_ARGS__)
#define SET_7(v, a, ...) v a, SET_6(v, __VA_ARGS__)
#define SET_8(v, a, ...) v a, SET_7(v, __VA_ARGS__)
#define SET_9(v, a, ...) v a, SET_8(v, __VA_ARGS__)
#define SET_10(v, a, ...) v a, SET_9(v, __VA_ARGS__)
#define SET_11(v, a, ...) v a, SET_10(v, __VA_ARGS__)
#define SET_12(v, a, ...) v a, SET_11(v, __VA_ARGS__)

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

#endif
