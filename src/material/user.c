/* user.c - a user's law: checks of its definition, and of its output.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

#include <float.h>
#include <stdio.h>

static bool is_name(const char *name) {
  const size_t length = mpsi_identifier(name, MPSI_MATERIAL_NAME);
  return length > 0 && name[length] == '\0';
}

#define NAME "must be letters, digits and _, not begin with a digit, and have 1 to 47 characters"

static mps_status check_history(mps_context *context, const char *function,
                                const mps_material_user_def *def) {
  for (int32_t c = 0; c < def->history_count; c++) {
    const char *name = def->history[c];
    if (!name)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "history[%d] is NULL, must be the name of a column", (int)c);
    if (!is_name(name))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "history[%d] is '%.60s', " NAME,
                       (int)c, name);
    for (int32_t d = 0; d < c; d++)
      if (strcmp(name, def->history[d]) == 0)
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "history[%d] and history[%d] are both '%s'", (int)d, (int)c, name);
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
  if (def->frictional == 0) return MPS_OK;
  for (int k = 0; k < 2; k++)
    if (!has_column(def, mpsi_sand_columns[k]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "frictional is 1, and history has no column '%s', which it then needs",
                       mpsi_sand_columns[k]);
  return MPS_OK;
}

/* "user" begins the names of the caller's fields. */
static bool is_law_name(const char *name) { return is_name(name) && strcmp(name, "user") != 0; }

static mps_status check_user_law(mps_context *context, const char *function,
                                 const mps_material_user_def *def) {
  if (!is_law_name(def->name))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "name is '%.60s', " NAME ", and not user, of the caller's own fields",
                     def->name);
  MPSI_TRY(check_history(context, function, def));
  return check_frictional(context, function, def);
}

/* K + 4G/3, where the definition states K and G. */
static mps_status check_moduli(mps_context *context, const char *function,
                               const mps_material_user_def *def) {
  const double least = def->bulk_modulus + 4.0 / 3.0 * def->shear_modulus;
  if (isnan(least) || isnan(def->wave_modulus) || def->wave_modulus >= least * (1.0 - 1e-12))
    return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "wave_modulus is %g Pa, must be NaN or at least K + 4G/3 of its moduli, %g Pa",
                   def->wave_modulus, least);
}

mps_status mpsi_define_user(mps_context *context, const char *function, const void *values,
                            mpsi_law *law) {
  const mps_material_user_def *def = values;
  MPSI_TRY(check_user_law(context, function, def));
  MPSI_TRY(check_moduli(context, function, def));
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
