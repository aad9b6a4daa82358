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

#endif
