/* pcg.h - conjugate gradients, preconditioned, with a coarse space.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

/* Solves for system.x, starting from its values; the number of iterations, or -1. */
mps_status mpsi_fluid_factor(mps_fluid *fluid, const char *function);
int64_t mpsi_fluid_pcg(mps_fluid *fluid);
