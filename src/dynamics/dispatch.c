/* dispatch.c - chooses the inner loops for the processor at run time, so that one binary package
 * is as fast as a native build.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

const mpsi_kernels *mpsi_kernels_select(int32_t isa) {
#ifdef MPSI_X86_LEVELS
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
                  __builtin_cpu_supports("avx512cd");
  if (isa == 4 || (isa == 0 && v4)) return v4 ? &mpsi_kernels_v4 : NULL;
  if (isa == 3 || (isa == 0 && v3)) return v3 ? &mpsi_kernels_v3 : NULL;
#endif
  return isa == 0 || isa == 1 ? &mpsi_kernels_v1 : NULL;
}
