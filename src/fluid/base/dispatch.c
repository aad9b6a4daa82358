/* dispatch.c - chooses the fluid's inner loops for the processor at run time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "loops.h"

#include "core/context/levels.h"

extern const mpsi_fluid_loops mpsi_fluid_loops_v1;
#ifdef MPSI_X86_LEVELS
extern const mpsi_fluid_loops mpsi_fluid_loops_v3, mpsi_fluid_loops_v4;
#endif

const mpsi_fluid_loops *mpsi_fluid_choose_loops(int32_t wanted) {
#ifdef MPSI_X86_LEVELS
  const int32_t level = mpsi_level(wanted);
  if (level == 4) return &mpsi_fluid_loops_v4;
  if (level == 3) return &mpsi_fluid_loops_v3;
#else
  (void)wanted;
#endif
  return &mpsi_fluid_loops_v1;
}
