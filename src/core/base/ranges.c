/* ranges.c - see ranges.h. SPDX-License-Identifier: BSD-3-Clause */
#include "ranges.h"
#include "core/definition/digits.h"

static const struct {
  const char *unit;
  double low, high;
} table[] = {
#define ROW(name, unit, ...) {unit, __VA_ARGS__},
    MPSI_RANGE_TABLE(ROW)
#undef ROW
};

bool mpsi_in_range(mpsi_range range, double value) {
  return value >= table[range].low && value <= table[range].high; /* not NaN */
}

mps_status mpsi_check_range(mps_context *context, const char *function, const char *name,
                            double value, mpsi_range range) {
  if (mpsi_in_range(range, value)) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %s%s, must be %g to %g", name,
                   mpsi_outside(value, table[range].low, table[range].high).text, table[range].unit,
                   table[range].low, table[range].high);
}

size_t mpsi_identifier(const char *name, size_t capacity) {
  size_t length = 0;
  for (;; length++) {
    const char c = name[length];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    if (!letter && !(length > 0 && c >= '0' && c <= '9')) return length;
    if (length + 1 >= capacity) return 0;
  }
}
