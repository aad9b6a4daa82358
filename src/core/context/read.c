/* read.c - reads the definition of a caller: errors, and warnings of members that have no effect.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

mps_status mpsi_def_read(mps_context *context, const char *function,
                         const mpsi_definition *definition, const void *def, bool needed,
                         uint32_t scene, void *known) {
  char why[MPSI_WHY];
  if (!def && needed) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "def is NULL");
  const mps_status status = mpsi_definition_take(definition, def, known, scene, why);
  if (status != MPS_OK) return mpsi_fail(context, function, status, "%s", why);
  const mpsi_def_rule *rule = definition->rule;
  for (int32_t k = 0; context && k < definition->rules; k++)
    if (rule[k].demand == MPSI_DEMAND_UNUSED &&
        !mpsi_rule_check(definition, &rule[k], known, scene, why))
      mpsi_log(context, MPS_CONTEXT_LOG_WARNING, "%s: %s", function, why);
  return MPS_OK;
}
