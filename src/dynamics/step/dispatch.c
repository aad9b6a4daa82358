/* dispatch.c - chooses the inner loops for the processor at run time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include "core/context/levels.h"

const mpsi_dynamics_kernels *mpsi_dynamics_kernels_select(int32_t level) {
#ifdef MPSI_X86_LEVELS
  if (level == 4) return &mpsi_dynamics_kernels_v4;
  if (level == 3) return &mpsi_dynamics_kernels_v3;
#endif
  return level == 1 ? &mpsi_dynamics_kernels_v1 : NULL;
}
