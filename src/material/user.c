/* user.c - creation of a law of the caller's own: its callback, history columns and wave modulus.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

#include <stdio.h>

static const mps_user_law_def user_law_defaults = {.name = "user", .turns_stress = 1};

mps_status mps_user_law_def_init(mps_user_law_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_user_law_def, def, size, &user_law_defaults);
}

static bool is_name(const char *name) {
  const size_t length = mpsi_identifier(name, MPSI_MATERIAL_NAME);
  return length > 0 && name[length] == '\0';
}

static mps_status check_history(mps_context *context, const char *function,
                                const mps_user_law_def *def) {
  if (def->history_count < 0 || def->history_count > MPSI_MATERIAL_COLUMNS)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "history_count is %d, must be 0..%d",
                     (int)def->history_count, MPSI_MATERIAL_COLUMNS);
  if (def->history_count > 0 && !def->history)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "history is NULL, must name %d columns",
                     (int)def->history_count);
  for (int32_t c = 0; c < def->history_count; c++) {
    const char *name = def->history[c];
    if (!name || !is_name(name))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "history[%d] is \"%.60s\", must be a name [A-Za-z_][A-Za-z0-9_]* of at most "
                       "47 characters",
                       (int)c, name ? name : "(NULL)");
    for (int32_t d = 0; d < c; d++)
      if (strcmp(name, def->history[d]) == 0)
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "history[%d] and history[%d] are both \"%s\"", (int)d, (int)c, name);
    if (def->history_initial && !isfinite(def->history_initial[c]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "history_initial[%d] is %g, must be finite", (int)c,
                       def->history_initial[c]);
  }
  return MPS_OK;
}

static mps_status check_user_law(mps_context *context, const char *function,
                                 const mps_user_law_def *def) {
  if (!def->update) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "update is NULL");
  if (!def->name || !is_name(def->name))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "name is \"%.60s\", must be [A-Za-z_][A-Za-z0-9_]* of at most 47 characters",
                     def->name ? def->name : "(NULL)");
  if (def->needs_deformation != 0 && def->needs_deformation != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "needs_deformation is %d, must be 0 or 1", (int)def->needs_deformation);
  if (def->turns_stress != 0 && def->turns_stress != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "turns_stress is %d, must be 0 or 1",
                     (int)def->turns_stress);
  mps_status status =
      mpsi_check_range(context, function, "wave modulus", def->wave_modulus, MPSI_RANGE_MODULUS);
  if (status == MPS_OK)
    status =
        mpsi_check_range_or_0(context, function, "viscosity", def->viscosity, MPSI_RANGE_VISCOSITY);
  return status == MPS_OK ? check_history(context, function, def) : status;
}

mps_status mpsi_material_make_user(mps_context *context, const char *function,
                                   const mps_user_law_def *def, mps_material **out) {
  const mps_status status = check_user_law(context, function, def);
  if (status != MPS_OK) return status;
  mps_material *material =
      mpsi_material_new(context, function, MPSI_LAW_USER, def->name, def->history_count);
  if (!material) return MPS_ERROR_MEMORY;
  material->law = (mpsi_law){.update = def->update,
                             .user = def->user,
                             .viscosity = def->viscosity,
                             .needs_deformation = def->needs_deformation == 1,
                             .turns_stress = def->turns_stress == 1};
  material->wave_modulus = def->wave_modulus;
  for (int32_t c = 0; c < def->history_count; c++) {
    strcpy(material->history_names[c], def->history[c]);
    (void)snprintf(material->history_fields[c], sizeof material->history_fields[c], "%s.%s",
                   def->name, def->history[c]);
    if (def->history_initial) material->history_initial[c] = def->history_initial[c];
  }
  *out = material;
  return MPS_OK;
}

mps_status mps_material_user(mps_context *context, const mps_user_law_def *user_def,
                             mps_material **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_user_law_def def = user_law_defaults;
  const mps_status status = MPSI_DEF_READ(context, __func__, mps_user_law_def, user_def, &def);
  return status == MPS_OK ? mpsi_material_make_user(context, __func__, &def, out) : status;
}
