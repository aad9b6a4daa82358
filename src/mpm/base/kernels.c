/* kernels.c - chooses the solver's inner loops for the processor at run time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include "core/context/levels.h"

MPSI_DISPATCH(mpsi_kernels, mpsi_mpm_kernels, mpsi_mpm_kernels)
