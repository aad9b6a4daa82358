/* dispatch.c - chooses the inner loops for the processor at run time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include "core/context/levels.h"

MPSI_DISPATCH(mpsi_dynamics_kernels, mpsi_dynamics_kernels_select, mpsi_dynamics_kernels)
