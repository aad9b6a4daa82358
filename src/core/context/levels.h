/* levels.h - which of the instruction sets that inner loops are compiled for (mps_add_levels in
 * src/CMakeLists.txt) this processor has, so that one binary package is as fast as a native build.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

/* All levels, ascending, as X(level, a, b). Another one is a row here and a case in
 * mpsi_processor_has, a number in MPS_LEVELS and its flags in src/CMakeLists.txt (without which
 * libmps does not link), and the list in mps/context.h. */
#define MPSI_ALL_LEVELS(X, a, b) X(1, a, b) X(3, a, b) X(4, a, b)
/* Those that this build has. */
#ifdef MPSI_X86_LEVELS
#define MPSI_LEVELS(X, a, b) MPSI_ALL_LEVELS(X, a, b)
#else
#define MPSI_LEVELS(X, a, b) X(1, a, b)
#endif
#define MPSI_LEVEL_VALUE(level, a, b) level, /* for an array of them */

static inline bool mpsi_processor_has(int32_t level) {
#ifdef MPSI_X86_LEVELS
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
                  __builtin_cpu_supports("avx512cd");
  if (level == 3) return v3;
  if (level == 4) return v4;
#endif
  return level == 1;
}

/* The x86-64 level to use for a requested one: 0 the best that processor and build have, 1 the
 * plain build. Returns 0 when the requested one is missing. */
static inline int32_t mpsi_level(int32_t wanted) {
  int32_t best = 0;
#define MPSI_LEVEL_IF(level, a, b)                                                                 \
  if ((wanted == 0 || wanted == (level)) && mpsi_processor_has(level)) best = level;
  MPSI_LEVELS(MPSI_LEVEL_IF, , )
#undef MPSI_LEVEL_IF
  return best;
}

/* Defines `const type *function(int32_t wanted)`: of the tables of loops `table`_v1 and so on, one
 * for each level that the build has, that of mpsi_level(wanted); NULL when what is asked for is
 * missing. */
#define MPSI_LEVEL_DECLARE(level, type, table) extern const type table##_v##level;
#define MPSI_LEVEL_CASE(level, type, table)                                                        \
  case level:                                                                                      \
    return &table##_v##level;
#define MPSI_DISPATCH(type, function, table)                                                       \
  MPSI_LEVELS(MPSI_LEVEL_DECLARE, type, table)                                                     \
  const type *function(int32_t wanted) {                                                           \
    switch (mpsi_level(wanted)) {                                                                  \
      MPSI_LEVELS(MPSI_LEVEL_CASE, type, table)                                                    \
    default:                                                                                       \
      return NULL;                                                                                 \
    }                                                                                              \
  }
