/* test_bounds_long.c - test_bounds.c with more draws. SPDX-License-Identifier: BSD-3-Clause */
#define BOUNDS_DRAWS 100
#include "test_bounds.c"
