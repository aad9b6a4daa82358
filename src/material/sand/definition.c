/* definition.c - the definition of cyclic sand: Mohr-Coulomb, and the constants of the volume
 * strain of cyclic shear. Byrne (1991): C1 = 7600 Dr^-2.5 with the relative density Dr in percent,
 * or 8.7 (N1)60^-1.25, and C2 = 0.4/C1. Martin, Finn and Seed (1975): four constants.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material/constants.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>

mps_status mpsi_define_cyclic_sand(mps_context *context, const char *function, const void *values,
                                   mpsi_law *law) {
  const mps_material_cyclic_sand_def *d = values;
  mps_material_mohr_coulomb_def strength = mps_material_mohr_coulomb_defaults();
  strength.young = d->young, strength.poisson = d->poisson;
  strength.friction = d->friction, strength.dilation = d->dilation;
  strength.cohesion = d->cohesion;
  strength.void_ratio = d->void_ratio, strength.max_void_ratio = d->max_void_ratio;
  MPSI_TRY(mpsi_define_mohr_coulomb(context, function, &strength, law));
  double c1 = d->c1;
  if (!isnan(d->relative_density)) c1 = 7600.0 * pow(100.0 * d->relative_density, -2.5);
  if (!isnan(d->blow_count)) c1 = 8.7 * pow(d->blow_count, -1.25);
  law->contract[0] = c1;
  law->contract[1] = isnan(d->c2) ? 0.4 / c1 : d->c2;
  law->contract[2] = isnan(d->c3) ? 0.0 : d->c3;
  law->contract[3] = isnan(d->c4) ? 0.0 : d->c4;
  law->threshold = d->threshold;
  law->strain_limit = d->strain_limit;
  return MPS_OK;
}
