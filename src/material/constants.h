/* constants.h - from the parameters of a definition to the constants of a law's loop.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_CONSTANTS_H
#define MPSI_CONSTANTS_H

#include "core/base/ranges.h"
#include "material_private.h"

/* Checks one parameter: low <= value < high. Records the error with the value and the range. */
mps_status mpsi_check_elastic(mps_context *context, const char *function, double young,
                              double poisson);
/* Angles and cohesion of Drucker-Prager and Mohr-Coulomb. */
mps_status mpsi_check_friction(mps_context *context, const char *function, double friction,
                               double dilation, double cohesion);

mpsi_law mpsi_law_elastic(double young, double poisson);
/* Adds the cones of yield and flow, and the limit of tension. */
void mpsi_law_add_cone(mpsi_law *law, mps_material_cone cone, double friction, double dilation,
                       double cohesion, double tension);
/* soften.c: the checks, and the constants. */
mps_status mpsi_check_mises_softening(mps_context *context, const char *function,
                                      const mps_material_von_mises_def *def);
mps_status mpsi_check_mohr_coulomb_softening(mps_context *context, const char *function,
                                             const mps_material_mohr_coulomb_def *def);
void mpsi_law_soften_mises(mpsi_law *law, const mps_material_von_mises_def *def);
void mpsi_law_soften_mohr_coulomb(mpsi_law *law, const mps_material_mohr_coulomb_def *def);
double mpsi_law_wave_modulus(const mpsi_law *law);

#endif
