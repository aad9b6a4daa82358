/* parameters.c - the definitions of the library's own laws, and the constants of their
 * loops. SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

mps_status mpsi_define_elastic(mps_context *context, const char *function, const void *values,
                               mpsi_law *law) {
  const mpsi_elastic_def *def = values;
  MPSI_TRY(mpsi_check_elastic(context, function, def->young, def->poisson));
  *law = mpsi_law_elastic(def->young, def->poisson);
  return MPS_OK;
}

mps_status mpsi_define_neo_hookean(mps_context *context, const char *function, const void *values,
                                   mpsi_law *law) {
  const mps_status status = mpsi_define_elastic(context, function, values, law);
  law->needs_deformation = status == MPS_OK;
  return status;
}

mps_status mpsi_define_von_mises(mps_context *context, const char *function, const void *values,
                                 mpsi_law *law) {
  const mps_material_von_mises_def *def = values;
  *law = mpsi_law_elastic(def->young, def->poisson);
  law->yield = def->yield_stress;
  law->hardening = def->hardening;
  return mpsi_law_soften_mises(context, function, law, def);
}

mps_status mpsi_define_drucker_prager(mps_context *context, const char *function,
                                      const void *values, mpsi_law *law) {
  const mps_material_drucker_prager_def *def = values;
  *law = mpsi_law_elastic(def->young, def->poisson);
  mpsi_law_add_cone(law, (mps_material_cone)def->cone, def->friction, def->dilation, def->cohesion,
                    def->tension);
  mpsi_law_add_dilation_end(law, def->dilation, def->void_ratio, def->max_void_ratio);
  return MPS_OK;
}

mps_status mpsi_define_mohr_coulomb(mps_context *context, const char *function, const void *values,
                                    mpsi_law *law) {
  const mps_material_mohr_coulomb_def *def = values;
  *law = mpsi_law_elastic(def->young, def->poisson);
  mpsi_law_add_cone(law, MPS_MATERIAL_CONE_INSCRIBED, def->friction, def->dilation, def->cohesion,
                    INFINITY);
  law->sin_phi = sin(def->friction);
  law->sin_psi = sin(def->dilation);
  law->c_cos_phi = def->cohesion * cos(def->friction);
  law->apex = def->friction > 0.0 ? law->c_cos_phi / law->sin_phi : INFINITY;
  law->cut = def->tension < law->apex ? def->tension : INFINITY;
  mpsi_law_add_dilation_end(law, def->dilation, def->void_ratio, def->max_void_ratio);
  return mpsi_law_soften_mohr_coulomb(context, function, law, def);
}

mps_status mpsi_define_newtonian(mps_context *context, const char *function, const void *values,
                                 mpsi_law *law) {
  const mps_material_newtonian_def *def = values;
  *law = (mpsi_law){.bulk = def->bulk_modulus,
                    .viscosity = def->viscosity,
                    .tait = def->state == MPS_MATERIAL_STATE_EQUATION_TAIT,
                    .no_tension = def->no_tension == 1};
  return MPS_OK;
}
