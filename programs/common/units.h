/* units.h - numbers with a unit, in usual notation: 10MPa, 5mm/s, 18kN/m3. Values are in SI units,
 * angles in degrees. An option's unit, such as "Pa", says which quantity it is.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef enum units_status {
  UNITS_GOOD,
  UNITS_NO_NUMBER, /* not a finite decimal number, with or without a unit */
  UNITS_OTHER      /* a number with a unit of another quantity, or with one that is not known */
} units_status;

/* Reads all of `text` into *value: a number in `unit`, or with a unit of the same quantity. Where
 * `unit` is none of a quantity ("1", "N", NULL) the number has no unit. */
units_status units_read(const char *text, const char *unit, double *value);
/* The value in `unit`'s SI quantity ("1": a ratio) of one of the unit that `text` is, in the
 * spellings of headers: "m_s", "kN/m^3", "feet", "%". False: it is none of that quantity. */
bool units_factor(const char *text, const char *unit, double *factor);
/* True where `text` ends with a unit. */
bool units_written(const char *text);
/* "a pressure is wanted (Pa, kPa, MPa, GPa)", for the error about UNITS_OTHER. */
void units_wanted(const char *unit, char *out, size_t size);
/* "10 MPa", "0.3": up to six digits, with a prefix where the number is easier to read. */
void units_show(double value, const char *unit, char *out, size_t size);
