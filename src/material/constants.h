/* constants.h - from the parameters of a definition to the constants of a law's loop.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/ranges.h"
#include "material_private.h"

/* The two constants of linear elasticity, which come as arguments. */
mps_status mpsi_check_elastic(mps_context *context, const char *function, double young,
                              double poisson);

mpsi_law mpsi_law_elastic(double young, double poisson);
/* Adds the end of dilation, where there is dilation. */
void mpsi_law_add_dilation_end(mpsi_law *law, double dilation, double void_ratio,
                               double max_void_ratio);
/* Adds the cones of yield and flow, and the limit of tension. */
void mpsi_law_add_cone(mpsi_law *law, mps_material_cone cone, double friction, double dilation,
                       double cohesion, double tension);
/* soften.c. MPS_ERROR_ARGUMENT: the strength would fall faster than the material unloads. */
mps_status mpsi_law_soften_mises(mps_context *context, const char *function, mpsi_law *law,
                                 const mps_material_von_mises_def *def);
mps_status mpsi_law_soften_mohr_coulomb(mps_context *context, const char *function, mpsi_law *law,
                                        const mps_material_mohr_coulomb_def *def);
double mpsi_law_wave_modulus(const mpsi_law *law);
