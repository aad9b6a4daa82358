/* user.c - a user's law: checks of its definition, and of its output.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

#include <float.h>
#include <stdio.h>

static bool is_name(const char *name) {
  const size_t length = mpsi_identifier(name, MPSI_MATERIAL_NAME);
  return length > 0 && name[length] == '\0';
}

static mps_status check_history(mps_context *context, const char *function,
                                const mps_material_user_def *def) {
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

static bool has_column(const mps_material_user_def *def, const char *name) {
  for (int32_t c = 0; c < def->history_count; c++)
    if (strcmp(def->history[c], name) == 0) return true;
  return false;
}

/* The filter of mean stresses reads and writes two columns, and calls the law without strain. */
static mps_status check_frictional(mps_context *context, const char *function,
                                   const mps_material_user_def *def) {
  if (def->frictional != 0 && def->frictional != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "frictional is %d, must be 0 or 1",
                     (int)def->frictional);
  if (def->frictional == 0) return MPS_OK;
  for (int k = 0; k < 2; k++)
    if (!has_column(def, mpsi_sand_columns[k]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "frictional is 1, then history must have a column \"%s\"",
                       mpsi_sand_columns[k]);
  if (isnan(def->bulk_modulus))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "frictional is 1, then bulk_modulus must be stated, it is NaN");
  if (def->needs_deformation == 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "frictional is 1, then needs_deformation must be 0, it is 1");
  return MPS_OK;
}

static mps_status check_user_law(mps_context *context, const char *function,
                                 const mps_material_user_def *def) {
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
  const mps_status status =
      mpsi_check_range_or_0(context, function, "viscosity", def->viscosity, MPSI_RANGE_VISCOSITY);
  if (status != MPS_OK) return status;
  const mps_status named = check_history(context, function, def);
  return named == MPS_OK ? check_frictional(context, function, def) : named;
}

/* K and G, where the definition states them, and K + 4G/3, which may then be left to the default.
 */
static mps_status check_moduli(mps_context *context, const char *function,
                               const mps_material_user_def *def) {
  const double least = def->bulk_modulus + 4.0 / 3.0 * def->shear_modulus;
  if (isnan(def->bulk_modulus) && isnan(def->shear_modulus))
    return mpsi_check_range(context, function, "wave_modulus: wave modulus", def->wave_modulus,
                            MPSI_RANGE_MODULUS);
  mps_status status = mpsi_check_range(context, function, "bulk_modulus: bulk modulus",
                                       def->bulk_modulus, MPSI_RANGE_MODULUS);
  if (status == MPS_OK)
    status = mpsi_check_range_or_0(context, function, "shear_modulus: shear modulus",
                                   def->shear_modulus, MPSI_RANGE_MODULUS);
  if (status != MPS_OK || isnan(def->wave_modulus)) return status;
  status = mpsi_check_range(context, function, "wave_modulus: wave modulus", def->wave_modulus,
                            MPSI_RANGE_MODULUS);
  if (status != MPS_OK || def->wave_modulus >= least * (1.0 - 1e-12)) return status;
  return mpsi_fail(
      context, function, MPS_ERROR_ARGUMENT,
      "wave_modulus: wave modulus is %g Pa, must be NaN or at least K + 4G/3 of its moduli, %g Pa",
      def->wave_modulus, least);
}

mps_status mpsi_define_user(mps_context *context, const char *function, const void *values,
                            mpsi_law *law) {
  const mps_material_user_def *def = values;
  mps_status status = check_user_law(context, function, def);
  if (status == MPS_OK) status = check_moduli(context, function, def);
  if (status != MPS_OK) return status;
  *law = (mpsi_law){.update = def->update,
                    .user = def->user,
                    .viscosity = def->viscosity,
                    .needs_deformation = def->needs_deformation == 1,
                    .turns_stress = def->turns_stress == 1,
                    .frictional = def->frictional == 1,
                    .moduli = def->moduli,
                    .history_count = def->history_count,
                    .has_moduli = def->shear_modulus > 0.0,
                    .shear = def->shear_modulus,
                    .bulk = def->bulk_modulus};
  if (def->bulk_modulus > 0.0) return MPS_OK;
  law->shear = def->wave_modulus / 3.0; /* nu = 1/4 */
  law->bulk = def->wave_modulus - 4.0 / 3.0 * law->shear;
  return MPS_OK;
}

/* ---- what it writes -------------------------------------------------------------------------- */

static bool all_finite(const double *column, int64_t count) {
  bool good = true;
  for (int64_t k = 0; k < count; k++) good &= fabs(column[k]) <= DBL_MAX; /* not of a NaN */
  return good;
}

static mps_status refuse(const mps_material_block *block, const char *what, int number,
                         const double *column, const char *allowed) {
  int64_t k = 0;
  while (isfinite(column[k]) && (number >= 0 || column[k] > 0.0)) k++;
  char name[40];
  (void)snprintf(name, sizeof name, number < 0 ? "%s" : "%s[%d]", what, number);
  if (block->message)
    (void)snprintf(block->message, (size_t)block->message_size, "%s is %g, must be %s", name,
                   column[k], allowed);
  if (block->refused) *block->refused = k;
  return MPS_ERROR_NUMERIC;
}

mps_status mpsi_check_results(const mps_material_block *block, int32_t history_count) {
  bool positive = all_finite(block->volume_ratio, block->count);
  for (int64_t k = 0; k < block->count; k++) positive &= block->volume_ratio[k] > 0.0;
  if (!positive) return refuse(block, "volume_ratio", -1, block->volume_ratio, "finite and > 0");
  for (int c = 0; c < 2 * block->dim; c++)
    if (!all_finite(block->stress[c], block->count))
      return refuse(block, "stress", c, block->stress[c], "finite");
  for (int32_t c = 0; c < history_count; c++)
    if (!all_finite(block->history[c], block->count))
      return refuse(block, "history", c, block->history[c], "finite");
  return MPS_OK;
}
