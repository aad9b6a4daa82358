/* state_equation.c - p = K (r - 1), or Tait's K/7 (r^7 - 1), r = V0/V, solved for V/V0: the inverse
 * of the fluid's law in laws.c. SPDX-License-Identifier: BSD-3-Clause */
#include "state_equation.h"

#include "material_private.h"

#include <math.h>

double mpsi_material_fluid_volume(const mps_material *material, double p) {
  const mpsi_law *law = &material->law;
  return law->tait ? pow(1.0 + 7.0 * p / law->bulk, -1.0 / 7.0) : law->bulk / (law->bulk + p);
}
