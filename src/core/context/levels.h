/* levels.h - which of the instruction sets that inner loops are compiled for (mps_add_levels in
 * src/CMakeLists.txt) this processor has, so that one binary package is as fast as a native build.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_LEVELS_H
#define MPSI_LEVELS_H

#include "core/internal.h"

/* The x86-64 level to use for a requested one: 0 the best that processor and build have, 1 the
 * plain build. Returns 1, 3 or 4, or 0 when the requested one is missing. */
static inline int32_t mpsi_level(int32_t wanted) {
#ifdef MPSI_X86_LEVELS
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
                  __builtin_cpu_supports("avx512cd");
  if (wanted == 4 || (wanted == 0 && v4)) return v4 ? 4 : 0;
  if (wanted == 3 || (wanted == 0 && v3)) return v3 ? 3 : 0;
#endif
  return wanted == 0 || wanted == 1 ? 1 : 0;
}

/* Defines `const type *function(int32_t wanted)`: of the tables of loops `table`_v1, _v3 and _v4,
 * one for each level that the build has, that of mpsi_level(wanted); NULL when what is asked for is
 * missing. */
#ifdef MPSI_X86_LEVELS
#define MPSI_DISPATCH(type, function, table)                                                       \
  extern const type table##_v1, table##_v3, table##_v4;                                            \
  const type *function(int32_t wanted) {                                                           \
    const int32_t level = mpsi_level(wanted);                                                      \
    return level == 4 ? &table##_v4 : level == 3 ? &table##_v3 : level == 1 ? &table##_v1 : NULL;  \
  }
#else
#define MPSI_DISPATCH(type, function, table)                                                       \
  extern const type table##_v1;                                                                    \
  const type *function(int32_t wanted) { return mpsi_level(wanted) == 1 ? &table##_v1 : NULL; }
#endif

#endif
