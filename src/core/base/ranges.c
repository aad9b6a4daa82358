/* ranges.c - see ranges.h. SPDX-License-Identifier: BSD-3-Clause */
#include "ranges.h"

#include <stdio.h>
#include <stdlib.h>

static const struct {
  const char *unit;
  double low, high;
} table[] = {
#define ROW(name, unit, low, high) {unit, low, high},
    MPSI_RANGE_TABLE(ROW)
#undef ROW
};

bool mpsi_in_range(mpsi_range range, double value) {
  return value >= table[range].low && value <= table[range].high; /* not NaN */
}

static mps_status check(mps_context *context, const char *function, const char *name, double value,
                        mpsi_range range, const char *zero) {
  if (mpsi_in_range(range, value) || (zero[0] && value == 0.0)) return MPS_OK;
  char text[32];
  snprintf(text, sizeof text, "%.6g", value);
  if (mpsi_in_range(range,
                    strtod(text, NULL))) /* rounded, it would read as the bound that it exceeds */
    snprintf(text, sizeof text, "%.17g", value);
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %s%s, must be %s%g to %g", name,
                   text, table[range].unit, zero, table[range].low, table[range].high);
}

mps_status mpsi_check_range(mps_context *context, const char *function, const char *name,
                            double value, mpsi_range range) {
  return check(context, function, name, value, range, "");
}

mps_status mpsi_check_range_or_0(mps_context *context, const char *function, const char *name,
                                 double value, mpsi_range range) {
  return check(context, function, name, value, range, "0 or ");
}

size_t mpsi_identifier(const char *name, size_t room) {
  size_t length = 0;
  for (;; length++) {
    const char c = name[length];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    if (!letter && !(length > 0 && c >= '0' && c <= '9')) return length;
    if (length + 1 >= room) return 0;
  }
}
