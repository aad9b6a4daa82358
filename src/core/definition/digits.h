/* digits.h - numbers in messages. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

/* A number as a message shows it. */
typedef struct mpsi_digits {
  char text[32];
} mpsi_digits;

/* `value`, refused by a check that allows `low` to `high`, in 6 digits; in 17 where 6 would read as
 * one that is allowed, as just above 1 reads "1". The text lives as long as the expression. */
mpsi_digits mpsi_outside(double value, double low, double high);
