/* order.h - searches in lists that are in order, and the order of numbers.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stdint.h>

/* Bisection: to `first`, an int64_t, the least number `at` from 0 on for which `before` does not
 * hold, or `count`. `before` is an expression of `at` that holds up to some number and from there
 * on does not. */
#define MPSI_BISECT(first, count, at, before)                                                      \
  do {                                                                                             \
    int64_t mpsi_end = (count);                                                                    \
    (first) = 0;                                                                                   \
    while ((first) < mpsi_end) {                                                                   \
      const int64_t at = (first) + (mpsi_end - (first)) / 2;                                       \
      if (before)                                                                                  \
        (first) = at + 1;                                                                          \
      else                                                                                         \
        mpsi_end = at;                                                                             \
    }                                                                                              \
  } while (0)

/* For qsort: from the least on, items that are or begin with an int64_t. */
static inline int mpsi_ascending(const void *left, const void *right) {
  const int64_t a = *(const int64_t *)left, b = *(const int64_t *)right;
  return a < b ? -1 : a > b;
}
