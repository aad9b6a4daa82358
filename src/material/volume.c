/* volume.c - the volumetric strain that suits each law. A law that flows at constant volume, or is
 * nearly incompressible, asks each particle for its own condition of constant volume, more than the
 * nodes can satisfy: it locks, and takes a mean. Under friction a mean would do harm: the strength
 * follows the pressure that the mean has made, and bearing capacities fall. There each particle
 * keeps its own strain, and what is rough in its mean stress is filtered. So it is with a fluid.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_private.h"

#define NEARLY_INCOMPRESSIBLE 0.45 /* Poisson's ratio */

static bool is_frictional(const mpsi_law *law) {
  return law->alpha > 0.0 || law->sin_phi > 0.0 || law->frictional;
}

static bool is_nearly_incompressible(const mpsi_law *law) {
  const double poisson =
      (3.0 * law->bulk - 2.0 * law->shear) / (2.0 * (3.0 * law->bulk + law->shear));
  return law->has_moduli && poisson >= NEARLY_INCOMPRESSIBLE - 1e-9;
}

mpsi_volume mpsi_material_volume(const mps_material *material) {
  const mpsi_law *law = &material->law;
  if (material->type->kept == MPSI_KEPT_PRESSURE) return MPSI_VOLUME_FILTERED;
  if (mpsi_material_opens(material)) {
    if (is_frictional(law)) return MPSI_VOLUME_FILTERED;
    return mpsi_material_dilates(material) ? MPSI_VOLUME_OWN : MPSI_VOLUME_MEAN;
  }
  if (material->type->traits & MPSI_LAW_ISOCHORIC) return MPSI_VOLUME_MEAN;
  return is_nearly_incompressible(law) ? MPSI_VOLUME_MEAN : MPSI_VOLUME_OWN;
}
