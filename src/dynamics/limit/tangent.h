/* tangent.h - the tangent at the reference state, as an operator.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_DYNAMICS_TANGENT_H
#define MPSI_DYNAMICS_TANGENT_H

#include <mps/dynamics.h>

/* y = S x, the symmetric tangent at the reference state: S = M^-1/2 K M^-1/2 over the 3 count
 * unknowns (x, y, rotation each in a row); held ones give 0. `weight` (NULL: 1) multiplies each
 * particle's pressure, its mean each pair's shear force. `work` has 4 (count + ghosts) doubles,
 * `weight` count + ghosts. Fails with a domain only. */
mps_status mpsi_dynamics_tangent_apply(mps_dynamics *dynamics, const char *function,
                                       const double *weight, const double *x, double *y,
                                       double *work);

#endif
