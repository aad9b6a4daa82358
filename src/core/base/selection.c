/* selection.c - the one rule by which definitions select, see selection.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "selection.h"

#include <stdio.h>

static bool listed(const mpsi_selection *s) { return s->ids || s->id_count != 0; }

static bool boxed(const mpsi_selection *s) {
  bool any = false;
  for (int c = 0; c < s->dim; c++) any = any || !isnan(s->lower[c]) || !isnan(s->upper[c]);
  return any;
}

bool mpsi_selection_given(const mpsi_selection *s) { return listed(s) || boxed(s) || s->all != 0; }

mps_status mpsi_selection_read(mps_context *context, const char *function, const mpsi_selection *s,
                               mpsi_selected *by, mpsi_selection_box *box) {
  const bool list = listed(s), bounds = boxed(s);
  *by = MPSI_SELECTED_NONE;
  if (s->all != 0 && s->all != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "all is %d, must be 0 or 1", s->all);
  if (list + bounds + s->all == 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "nothing is selected: give ids and id_count, or a box (lower, upper), or all "
                     "= 1");
  if (list + bounds + s->all > 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s are given: give ids and id_count, or a box (lower, upper), or all = 1",
                     !bounds ? "ids and all"
                     : !list ? "a box (lower, upper) and all"
                             : "both ids and a box (lower, upper)");
  if (list && (!s->ids || s->id_count < 1))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "id_count is %lld and ids is %s: at least one id is required",
                     (long long)s->id_count, s->ids ? "given" : "NULL");
  for (int c = 0; c < 3; c++) {
    const bool read = bounds && c < s->dim;
    box->lower[c] = read && !isnan(s->lower[c]) ? s->lower[c] : -INFINITY;
    box->upper[c] = read && !isnan(s->upper[c]) ? s->upper[c] : INFINITY;
    if (!(box->lower[c] <= box->upper[c]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "lower[%d] is %g m and upper[%d] %g m: the box is empty", c, box->lower[c],
                       c, box->upper[c]);
  }
  *by = list ? MPSI_SELECTED_IDS : bounds ? MPSI_SELECTED_BOX : MPSI_SELECTED_ALL;
  return MPS_OK;
}

bool mpsi_selection_contains(const mpsi_selection_box *box, int dim, const double *x) {
  bool inside = true;
  for (int c = 0; c < dim; c++) inside = inside && x[c] >= box->lower[c] && x[c] <= box->upper[c];
  return inside;
}

mps_status mpsi_selection_check_count(mps_context *context, const char *function,
                                      const mpsi_selection *s, const char *things, int64_t count) {
  char low[80] = "", high[80] = "";
  if (count > 0) return MPS_OK;
  if (s->all == 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "all: there is no %s", things);
  if (listed(s))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "ids: there is no %s of these ids",
                     things);
  for (int c = 0, a = 0, b = 0; c < s->dim; c++) {
    const char *comma = c > 0 ? ", " : "";
    a += snprintf(low + a, sizeof low - (size_t)a, "%s%g", comma, s->lower[c]);
    b += snprintf(high + b, sizeof high - (size_t)b, "%s%g", comma, s->upper[c]);
  }
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "lower and upper: no %s lies in the box from (%s) m to (%s) m", things, low,
                   high);
}
