/* dispatch.c - chooses the fluid's inner loops for the processor at run time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "loops.h"

#include "core/context/levels.h"

MPSI_DISPATCH(mpsi_fluid_loops, mpsi_fluid_choose_loops, mpsi_fluid_loops)
