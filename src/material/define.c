/* define.c - creation of materials: the defaults of their definitions, and their history.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"
#include "core/particles/particles_internal.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>

#include <stdio.h>

/* A material of the library's own. A column of its history that is a field of the library is that
 * field, one for all laws; others lie under the law's name. */
static mps_status create(mps_context *context, const char *function, mpsi_law_kind kind,
                         const void *def, mps_material **out) {
  const mpsi_law_type *type = &mpsi_law_types[kind];
  mpsi_law law = {.has_moduli = false};
  int32_t count = 0;
  while (type->columns[count]) count++;
  MPSI_TRY(type->define(context, function, def, &law));
  mps_material *material = mpsi_material_new(context, function, type, type->name, count);
  if (!material) return MPS_ERROR_MEMORY;
  material->law = law;
  material->wave_modulus = mpsi_law_wave_modulus(&law);
  for (int32_t c = 0; c < count; c++) {
    strcpy(material->history_names[c], type->columns[c]);
    const bool own = !mpsi_field_is_known(type->columns[c]);
    (void)snprintf(material->history_fields[c], sizeof material->history_fields[c], "%s%s%s",
                   own ? type->name : "", own ? "." : "", type->columns[c]);
  }
  if (kind == MPSI_LAW_CAM_CLAY) {
    material->history_initial[MPSI_CLAY_PC] = law.first_pc;
    material->history_initial[MPSI_CLAY_VOID] = law.first_void;
  }
  *out = material;
  return MPS_OK;
}

static mps_status check_out(mps_context *context, const char *function, mps_material **out) {
  if (!context) return mpsi_null(function, "context");
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  return MPS_OK;
}

mps_status mps_material_create_linear_elastic(mps_context *context, double young, double poisson,
                                              mps_material **out) {
  const mpsi_elastic_def def = {.young = young, .poisson = poisson};
  MPSI_TRY(check_out(context, __func__, out));
  return create(context, __func__, MPSI_LAW_LINEAR_ELASTIC, &def, out);
}

mps_status mps_material_create_neo_hookean(mps_context *context, double young, double poisson,
                                           mps_material **out) {
  const mpsi_elastic_def def = {.young = young, .poisson = poisson};
  MPSI_TRY(check_out(context, __func__, out));
  return create(context, __func__, MPSI_LAW_NEO_HOOKEAN, &def, out);
}

#define CREATE(name, KIND)                                                                         \
  mps_status mps_material_create_##name(                                                           \
      mps_context *context, const mps_material_##name##_def *user_def, mps_material **out) {       \
    mps_material_##name##_def def = mps_material_##name##_defaults();                              \
    mps_status status = check_out(context, __func__, out);                                         \
    if (status == MPS_OK)                                                                          \
      status = MPSI_DEF_READ(context, __func__, mps_material_##name##_def, user_def, &def);        \
    return status == MPS_OK ? create(context, __func__, KIND, &def, out) : status;                 \
  }
CREATE(von_mises, MPSI_LAW_VON_MISES)
CREATE(drucker_prager, MPSI_LAW_DRUCKER_PRAGER)
CREATE(mohr_coulomb, MPSI_LAW_MOHR_COULOMB)
CREATE(newtonian, MPSI_LAW_NEWTONIAN)
CREATE(cam_clay, MPSI_LAW_CAM_CLAY)
CREATE(small_strain, MPSI_LAW_SMALL_STRAIN)
CREATE(cyclic_sand, MPSI_LAW_CYCLIC_SAND)

/* ---- factors of each particle ------------------------------------------------------------------
 */

mps_status mps_material_create_by_field(mps_context *context, const mps_material *law,
                                        mps_material **out) {
  static const char *const names[MPSI_FACTORS] = {"stiffness_factor", "strength_factor"};
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!law) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "law is NULL");
  if (law->context != context)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "law was made from another context");
  if (law->by_field || !(law->type->traits & MPSI_LAW_BY_FIELD))
    return mpsi_fail(context, __func__, MPS_ERROR_UNSUPPORTED,
                     "law: it is %s%s, must be linear_elastic, von_mises, drucker_prager, "
                     "mohr_coulomb, small_strain or cyclic_sand",
                     law->name, law->by_field ? " by field already" : "");
  const int32_t columns = law->history_count;
  mps_material *m =
      mpsi_material_new(context, __func__, law->type, law->name, columns + MPSI_FACTORS);
  if (!m) return MPS_ERROR_MEMORY;
  m->law = law->law;
  m->wave_modulus = law->wave_modulus;
  m->by_field = true;
  for (int32_t c = 0; c < columns + MPSI_FACTORS; c++) {
    const char *name = c < columns ? law->history_names[c] : names[c - columns];
    strcpy(m->history_names[c], name);
    strcpy(m->history_fields[c], c < columns ? law->history_fields[c] : name);
    m->history_initial[c] = c < columns ? law->history_initial[c] : 1.0;
  }
  *out = m;
  return MPS_OK;
}

/* ---- a user's law ---------------------------------------------------------------------------- */

mps_status mpsi_material_make_user(mps_context *context, const char *function,
                                   const mps_material_user_def *def, mps_material **out) {
  const mpsi_law_type *type = &mpsi_law_types[MPSI_LAW_USER];
  mpsi_law law = {.has_moduli = false};
  MPSI_TRY(type->define(context, function, def, &law));
  mps_material *material =
      mpsi_material_new(context, function, type, def->name, def->history_count);
  if (!material) return MPS_ERROR_MEMORY;
  material->law = law;
  material->release = def->release;
  material->release_user = def->user;
  material->wave_modulus =
      isnan(def->wave_modulus) ? mpsi_law_wave_modulus(&law) : def->wave_modulus;
  for (int32_t c = 0; c < def->history_count; c++) {
    strcpy(material->history_names[c], def->history[c]);
    (void)snprintf(material->history_fields[c], sizeof material->history_fields[c], "%s.%s",
                   def->name, def->history[c]);
    if (def->history_initial) material->history_initial[c] = def->history_initial[c];
  }
  *out = material;
  return MPS_OK;
}

mps_status mps_material_create_user(mps_context *context, const mps_material_user_def *user_def,
                                    mps_material **out) {
  mps_material_user_def def = mps_material_user_defaults();
  mps_status status = check_out(context, __func__, out);
  if (status == MPS_OK)
    status = MPSI_DEF_READ(context, __func__, mps_material_user_def, user_def, &def);
  return status == MPS_OK ? mpsi_material_make_user(context, __func__, &def, out) : status;
}
