/* define.c - creation of the library's own laws: defaults, checks of every parameter, constants.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

static const mps_von_mises_def von_mises_defaults = {.poisson = 0.3};
static const mps_drucker_prager_def drucker_prager_defaults = {
    .cone = MPS_MATERIAL_CONE_PLANE_STRAIN, .poisson = 0.3, .friction = NAN, .tension = INFINITY};
static const mps_mohr_coulomb_def mohr_coulomb_defaults = {
    .poisson = 0.3, .friction = NAN, .tension = INFINITY};
static const mps_newtonian_def newtonian_defaults = {.state = MPS_MATERIAL_STATE_TAIT};

#define DEF_INIT(name)                                                                             \
  mps_status mps_##name##_def_init(mps_##name##_def *def, size_t size) {                           \
    return MPSI_DEF_INIT(mps_##name##_def, def, size, &name##_defaults);                           \
  }
DEF_INIT(von_mises)
DEF_INIT(drucker_prager)
DEF_INIT(mohr_coulomb)
DEF_INIT(newtonian)

/* A material of the library's own, with the first `history` of its columns, which are fields of the
 * table: one for all laws. */
static mps_status finish(mps_context *context, const char *function, mpsi_law_kind kind,
                         const char *name, const mpsi_law *law, int32_t history,
                         mps_material **out) {
  static const char *const columns[] = {"plastic_strain", "opening"};
  mps_material *material = mpsi_material_new(context, function, kind, name, history);
  if (!material) return MPS_ERROR_MEMORY;
  material->law = *law;
  material->wave_modulus = mpsi_law_wave_modulus(law);
  for (int32_t c = 0; c < history; c++) {
    strcpy(material->history_names[c], columns[c]);
    strcpy(material->history_fields[c], columns[c]);
  }
  *out = material;
  return MPS_OK;
}

static mps_status check_out(mps_context *context, const char *function, mps_material **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  return MPS_OK;
}

mps_status mps_material_linear_elastic(mps_context *context, double young, double poisson,
                                       mps_material **out) {
  mps_status status = check_out(context, __func__, out);
  if (status == MPS_OK) status = mpsi_check_elastic(context, __func__, young, poisson);
  if (status != MPS_OK) return status;
  const mpsi_law law = mpsi_law_elastic(young, poisson);
  return finish(context, __func__, MPSI_LAW_LINEAR_ELASTIC, "linear_elastic", &law, 0, out);
}

mps_status mps_material_neo_hookean(mps_context *context, double young, double poisson,
                                    mps_material **out) {
  mps_status status = check_out(context, __func__, out);
  if (status == MPS_OK) status = mpsi_check_elastic(context, __func__, young, poisson);
  if (status != MPS_OK) return status;
  mpsi_law law = mpsi_law_elastic(young, poisson);
  law.needs_deformation = true;
  return finish(context, __func__, MPSI_LAW_NEO_HOOKEAN, "neo_hookean", &law, 0, out);
}

mps_status mps_material_von_mises(mps_context *context, const mps_von_mises_def *user_def,
                                  mps_material **out) {
  mps_von_mises_def def = von_mises_defaults;
  mps_status status = check_out(context, __func__, out);
  if (status == MPS_OK)
    status = MPSI_DEF_READ(context, __func__, mps_von_mises_def, user_def, &def);
  if (status == MPS_OK) status = mpsi_check_elastic(context, __func__, def.young, def.poisson);
  if (status == MPS_OK)
    status =
        mpsi_check_range(context, __func__, "yield stress", def.yield_stress, MPSI_RANGE_STRESS);
  if (status == MPS_OK)
    status =
        mpsi_check_range_or_0(context, __func__, "hardening", def.hardening, MPSI_RANGE_STRESS);
  if (status != MPS_OK) return status;
  mpsi_law law = mpsi_law_elastic(def.young, def.poisson);
  law.yield = def.yield_stress;
  law.hardening = def.hardening;
  return finish(context, __func__, MPSI_LAW_VON_MISES, "von_mises", &law, 1, out);
}

static mps_status check_tension(mps_context *context, const char *function, double tension) {
  if (tension >= 0.0) return MPS_OK; /* infinity: up to the apex */
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "tension is %g Pa, must be >= 0 (or infinite: up to the apex)", tension);
}

static mps_status check_drucker_prager(mps_context *context, const char *function,
                                       const mps_drucker_prager_def *def) {
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

mps_status mps_material_drucker_prager(mps_context *context, const mps_drucker_prager_def *user_def,
                                       mps_material **out) {
  mps_drucker_prager_def def = drucker_prager_defaults;
  mps_status status = check_out(context, __func__, out);
  if (status == MPS_OK)
    status = MPSI_DEF_READ(context, __func__, mps_drucker_prager_def, user_def, &def);
  if (status == MPS_OK) status = check_drucker_prager(context, __func__, &def);
  if (status != MPS_OK) return status;
  mpsi_law law = mpsi_law_elastic(def.young, def.poisson);
  mpsi_law_add_cone(&law, (mps_cone)def.cone, def.friction, def.dilation, def.cohesion,
                    def.tension);
  return finish(context, __func__, MPSI_LAW_DRUCKER_PRAGER, "drucker_prager", &law, 2, out);
}

mps_status mps_material_mohr_coulomb(mps_context *context, const mps_mohr_coulomb_def *user_def,
                                     mps_material **out) {
  mps_mohr_coulomb_def def = mohr_coulomb_defaults;
  mps_status status = check_out(context, __func__, out);
  if (status == MPS_OK)
    status = MPSI_DEF_READ(context, __func__, mps_mohr_coulomb_def, user_def, &def);
  if (status == MPS_OK) status = mpsi_check_elastic(context, __func__, def.young, def.poisson);
  if (status == MPS_OK)
    status = mpsi_check_friction(context, __func__, def.friction, def.dilation, def.cohesion);
  if (status == MPS_OK) status = check_tension(context, __func__, def.tension);
  if (status != MPS_OK) return status;
  mpsi_law law = mpsi_law_elastic(def.young, def.poisson);
  mpsi_law_add_cone(&law, MPS_MATERIAL_CONE_INSCRIBED, def.friction, def.dilation, def.cohesion,
                    INFINITY);
  law.sin_phi = sin(def.friction);
  law.sin_psi = sin(def.dilation);
  law.c_cos_phi = def.cohesion * cos(def.friction);
  law.apex = def.friction > 0.0 ? law.c_cos_phi / law.sin_phi : INFINITY;
  law.cut = def.tension < law.apex ? def.tension : INFINITY;
  return finish(context, __func__, MPSI_LAW_MOHR_COULOMB, "mohr_coulomb", &law, 2, out);
}

static mps_status check_newtonian(mps_context *context, const char *function,
                                  const mps_newtonian_def *def) {
  if (def->state != MPS_MATERIAL_STATE_LINEAR && def->state != MPS_MATERIAL_STATE_TAIT)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "state is %d, must be 0 (linear) or 1 (Tait)", (int)def->state);
  if (def->no_tension != 0 && def->no_tension != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "no_tension is %d, must be 0 or 1",
                     (int)def->no_tension);
  const mps_status status =
      mpsi_check_range(context, function, "bulk modulus", def->bulk_modulus, MPSI_RANGE_MODULUS);
  if (status != MPS_OK) return status;
  return mpsi_check_range_or_0(context, function, "viscosity", def->viscosity,
                               MPSI_RANGE_VISCOSITY);
}

mps_status mps_material_newtonian(mps_context *context, const mps_newtonian_def *user_def,
                                  mps_material **out) {
  mps_newtonian_def def = newtonian_defaults;
  mps_status status = check_out(context, __func__, out);
  if (status == MPS_OK)
    status = MPSI_DEF_READ(context, __func__, mps_newtonian_def, user_def, &def);
  if (status == MPS_OK) status = check_newtonian(context, __func__, &def);
  if (status != MPS_OK) return status;
  const mpsi_law law = {.bulk = def.bulk_modulus,
                        .viscosity = def.viscosity,
                        .tait = def.state == MPS_MATERIAL_STATE_TAIT,
                        .no_tension = def.no_tension == 1};
  return finish(context, __func__, MPSI_LAW_NEWTONIAN, "newtonian", &law, 0, out);
}
