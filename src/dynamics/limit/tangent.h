/* tangent.h - the tangent at the reference state, as an operator.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

/* y = S x, the symmetric tangent at the reference state: S = M^-1/2 K M^-1/2 over the 3 count
 * unknowns (x, y, rotation each in a row); held ones give 0. `weight` (count + ghosts values; NULL:
 * 1) multiplies the pressure of each particle, and its mean over a pair the shear force of the
 * pair. `work` is scratch of 4 (count + ghosts) doubles. Not MPS_OK only where the exchange between
 * ranks fails. */
mps_status mpsi_dynamics_tangent_apply(mps_dynamics *dynamics, const char *function,
                                       const double *weight, const double *x, double *y,
                                       double *work);
