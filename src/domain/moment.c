/* moment.c - see moment.h. SPDX-License-Identifier: BSD-3-Clause */
#include "moment.h"

static void give(mpsi_given *list, const mps_snapshot *to, const char *name) {
  const mpsi_value *value = mpsi_values_find(&to->state, name);
  if (!value || value->rows * value->columns < 1) return;
  mpsi_give(list, name,
            value->type == MPSI_STATE_I64 ? (double)*(const int64_t *)value->data
                                          : *(const double *)value->data);
}

mps_status mpsi_domain_agree_moment(mps_domain *domain, const char *function, mps_status status,
                                    const mps_snapshot *to) {
  static const char *const names[] = {"steps", "time", "base_step", "base_time"};
  mpsi_given list = MPSI_GIVEN;
  if (!mpsi_domain_many(domain)) return status;
  if (status == MPS_OK && !to)
    status =
        mpsi_fail(mpsi_domain_context(domain), function, MPS_ERROR_ARGUMENT, "snapshot is NULL");
  for (size_t k = 0; status == MPS_OK && k < sizeof names / sizeof *names; k++)
    give(&list, to, names[k]);
  return mpsi_domain_agree_given(domain, function, status, &list);
}
