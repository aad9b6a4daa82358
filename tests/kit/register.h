/* register.h - a test is a function that registers itself:
 *   TEST(weights_sum_to_one) { ... }
 * A program runs its tests in the order of their lines. Programs without a main of their own have
 * that of the kit, which takes the name of a test (or a pattern, "walls_*") as its argument.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_KIT_REGISTER_H
#define MPS_TEST_KIT_REGISTER_H

/* As cmocka's: a test, and what makes or drops what tests share (0: done). */
typedef void (*test_fn)(void **state);
typedef int (*test_setup_fn)(void **state);

void test_register(const char *name, test_fn test, test_setup_fn make, test_setup_fn drop,
                   int line);
void test_register_group(test_setup_fn make, test_setup_fn drop);

/* Runs all that are registered; the number of tests that failed. */
int test_run(void);

#define TEST(name) TEST_EACH(name, NULL, NULL)

/* A test before which `make` is called, and after which `drop`. */
#define TEST_EACH(name, make, drop)                                                                \
  static void name(void **test_state);                                                             \
  __attribute__((constructor)) static void register_##name(void) {                                 \
    test_register(#name, name, make, drop, __LINE__);                                              \
  }                                                                                                \
  static void name(__attribute__((unused)) void **test_state)

/* What is made before the first test of the program and dropped after the last. */
#define TEST_GROUP(make, drop)                                                                     \
  __attribute__((constructor)) static void register_group_##make(void) {                           \
    test_register_group(make, drop);                                                               \
  }

#endif
