/* parameters.c - the definitions of the library's own laws: checks of every value, and the
 * constants of their loops. SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

mps_status mpsi_define_elastic(mps_context *context, const char *function, const void *values,
                               mpsi_law *law) {
  const mpsi_elastic_def *def = values;
  const mps_status status = mpsi_check_elastic(context, function, def->young, def->poisson);
  if (status != MPS_OK) return status;
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
  mps_status status = mpsi_check_elastic(context, function, def->young, def->poisson);
  if (status == MPS_OK)
    status = mpsi_check_range(context, function, "yield_stress: yield stress", def->yield_stress,
                              MPSI_RANGE_STRESS);
  if (status == MPS_OK)
    status =
        mpsi_check_range_or_0(context, function, "hardening", def->hardening, MPSI_RANGE_STRESS);
  if (status == MPS_OK) status = mpsi_check_mises_softening(context, function, def);
  if (status != MPS_OK) return status;
  *law = mpsi_law_elastic(def->young, def->poisson);
  law->yield = def->yield_stress;
  law->hardening = def->hardening;
  mpsi_law_soften_mises(law, def);
  return MPS_OK;
}

static mps_status check_tension(mps_context *context, const char *function, double tension) {
  if (tension >= 0.0) return MPS_OK; /* infinity: up to the apex */
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "tension is %g Pa, must be >= 0 (or infinite: up to the apex)", tension);
}

static mps_status check_drucker_prager(mps_context *context, const char *function,
                                       const mps_material_drucker_prager_def *def) {
  if (def->cone < MPS_MATERIAL_CONE_PLANE_STRAIN || def->cone > MPS_MATERIAL_CONE_EXTENSION)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "cone is %d, must be 0 (plane strain), 1 (circumscribed), 2 (inscribed) or 3 "
                     "(extension)",
                     (int)def->cone);
  mps_status status = mpsi_check_elastic(context, function, def->young, def->poisson);
  if (status == MPS_OK)
    status = mpsi_check_friction(context, function, def->friction, def->dilation, def->cohesion);
  return status == MPS_OK ? check_tension(context, function, def->tension) : status;
}

mps_status mpsi_define_drucker_prager(mps_context *context, const char *function,
                                      const void *values, mpsi_law *law) {
  const mps_material_drucker_prager_def *def = values;
  const mps_status status = check_drucker_prager(context, function, def);
  if (status != MPS_OK) return status;
  *law = mpsi_law_elastic(def->young, def->poisson);
  mpsi_law_add_cone(law, (mps_material_cone)def->cone, def->friction, def->dilation, def->cohesion,
                    def->tension);
  return MPS_OK;
}

mps_status mpsi_define_mohr_coulomb(mps_context *context, const char *function, const void *values,
                                    mpsi_law *law) {
  const mps_material_mohr_coulomb_def *def = values;
  mps_status status = mpsi_check_elastic(context, function, def->young, def->poisson);
  if (status == MPS_OK)
    status = mpsi_check_friction(context, function, def->friction, def->dilation, def->cohesion);
  if (status == MPS_OK) status = check_tension(context, function, def->tension);
  if (status == MPS_OK) status = mpsi_check_mohr_coulomb_softening(context, function, def);
  if (status != MPS_OK) return status;
  *law = mpsi_law_elastic(def->young, def->poisson);
  mpsi_law_add_cone(law, MPS_MATERIAL_CONE_INSCRIBED, def->friction, def->dilation, def->cohesion,
                    INFINITY);
  law->sin_phi = sin(def->friction);
  law->sin_psi = sin(def->dilation);
  law->c_cos_phi = def->cohesion * cos(def->friction);
  law->apex = def->friction > 0.0 ? law->c_cos_phi / law->sin_phi : INFINITY;
  law->cut = def->tension < law->apex ? def->tension : INFINITY;
  mpsi_law_soften_mohr_coulomb(law, def);
  return MPS_OK;
}

static mps_status check_newtonian(mps_context *context, const char *function,
                                  const mps_material_newtonian_def *def) {
  if (def->state != MPS_MATERIAL_STATE_LINEAR && def->state != MPS_MATERIAL_STATE_TAIT)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "state is %d, must be 0 (Tait) or 1 (linear)", (int)def->state);
  if (def->no_tension != 0 && def->no_tension != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "no_tension is %d, must be 0 or 1",
                     (int)def->no_tension);
  const mps_status status = mpsi_check_range(context, function, "bulk_modulus: bulk modulus",
                                             def->bulk_modulus, MPSI_RANGE_MODULUS);
  if (status != MPS_OK) return status;
  return mpsi_check_range_or_0(context, function, "viscosity", def->viscosity,
                               MPSI_RANGE_VISCOSITY);
}

mps_status mpsi_define_newtonian(mps_context *context, const char *function, const void *values,
                                 mpsi_law *law) {
  const mps_material_newtonian_def *def = values;
  const mps_status status = check_newtonian(context, function, def);
  if (status != MPS_OK) return status;
  *law = (mpsi_law){.bulk = def->bulk_modulus,
                    .viscosity = def->viscosity,
                    .tait = def->state == MPS_MATERIAL_STATE_TAIT,
                    .no_tension = def->no_tension == 1};
  return MPS_OK;
}
