/* digits.c - see digits.h. SPDX-License-Identifier: BSD-3-Clause */
#include "digits.h"

#include <stdio.h>
#include <stdlib.h>

mpsi_digits mpsi_outside(double value, double low, double high) {
  mpsi_digits d;
  snprintf(d.text, sizeof d.text, "%.6g", value);
  const double read = strtod(d.text, NULL);
  if (read != value && read >= low && read <= high) snprintf(d.text, sizeof d.text, "%.17g", value);
  return d;
}
