/* units.c - see units.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_UNITS = 12 };

#define GRAVITY 9.80665  /* m/s2 */
#define FOOT 0.3048      /* m */
#define INCH 0.0254      /* m */
#define POUND 0.45359237 /* kg */

/* The first unit is that of SI, which options have. Those before `shown` are used where numbers are
 * printed, in ascending order but for the first. */
typedef struct quantity {
  const char *name;
  int shown;
  struct {
    const char *name;
    double factor;
  } unit[MOST_UNITS];
} quantity;

static const quantity quantities[] = {
    {"a length",
     2,
     {{"m", 1.0},
      {"mm", 1e-3},
      {"cm", 1e-2},
      {"km", 1e3},
      {"um", 1e-6},
      {"ft", FOOT},
      {"in", INCH}}},
    {"a time", 2, {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60.0}, {"h", 3600.0}}},
    {"a speed",
     2,
     {{"m/s", 1.0},
      {"mm/s", 1e-3},
      {"cm/s", 1e-2},
      {"km/s", 1e3},
      {"km/h", 1.0 / 3.6},
      {"mm/min", 1e-3 / 60.0},
      {"m/d", 1.0 / 86400.0},
      {"ft/s", FOOT}}},
    {"an acceleration",
     1,
     {{"m/s2", 1.0}, {"mm/s2", 1e-3}, {"cm/s2", 1e-2}, {"gal", 1e-2}, {"g", GRAVITY}}},
    {"a frequency", 1, {{"Hz", 1.0}, {"kHz", 1e3}}},
    {"a density",
     1,
     {{"kg/m3", 1.0}, {"t/m3", 1e3}, {"g/cm3", 1e3}, {"lb/ft3", POUND / (FOOT * FOOT * FOOT)}}},
    {"a unit weight",
     3,
     {{"N/m3", 1.0},
      {"kN/m3", 1e3},
      {"MN/m3", 1e6},
      {"lbf/ft3", POUND *GRAVITY / (FOOT * FOOT * FOOT)},
      {"pcf", POUND *GRAVITY / (FOOT * FOOT * FOOT)}}},
    {"a pressure",
     4,
     {{"Pa", 1.0},
      {"kPa", 1e3},
      {"MPa", 1e6},
      {"GPa", 1e9},
      {"N/m2", 1.0},
      {"kN/m2", 1e3},
      {"MN/m2", 1e6},
      {"N/mm2", 1e6},
      {"psi", POUND *GRAVITY / (INCH * INCH)},
      {"psf", POUND *GRAVITY / (FOOT * FOOT)},
      {"ksf", 1e3 * POUND *GRAVITY / (FOOT * FOOT)}}},
    {"a pressure over a length", 3, {{"Pa/m", 1.0}, {"kPa/m", 1e3}, {"MPa/m", 1e6}}},
    {"a force over a length", 4, {{"N/m", 1.0}, {"kN/m", 1e3}, {"MN/m", 1e6}, {"GN/m", 1e9}}},
    {"a viscosity", 1, {{"Pa s", 1.0}, {"mPa s", 1e-3}, {"Pas", 1.0}, {"mPas", 1e-3}}},
    {"a mass", 1, {{"kg", 1.0}, {"g", 1e-3}, {"t", 1e3}}},
    {"an angle", 1, {{"degrees", 1.0}, {"deg", 1.0}, {"rad", 57.29577951308232}}}};

/* A number without a dimension, in headers of tables alone. */
static const quantity ratio = {"a ratio",
                               1,
                               {{"1", 1.0},
                                {"-", 1.0},
                                {"ratio", 1.0},
                                {"decimal", 1.0},
                                {"%", 1e-2},
                                {"percent", 1e-2},
                                {"pct", 1e-2}}};

static const quantity *find(const char *unit) {
  const int count = (int)(sizeof quantities / sizeof *quantities);
  for (int k = 0; unit && k < count; k++)
    if (strcmp(quantities[k].unit[0].name, unit) == 0) return &quantities[k];
  return NULL;
}

/* Without blanks and signs of powers; "/" for "_", as in m_s2. */
static bool plain(const char *text, char *out, size_t size) {
  size_t n = 0;
  for (; *text; text++) {
    const unsigned char c = (unsigned char)*text;
    if (c == ' ' || c == '^' || c == '*' || c == 0xc2) continue;
    if (n + 1 >= size) return false;
    out[n++] = c == '_' ? '/' : c == 0xb2 ? '2' : c == 0xb3 ? '3' : c == 0xb0 ? 'd' : (char)c;
  }
  out[n] = '\0';
  return n > 0;
}

static bool same(const char *a, const char *b, bool exact) {
  for (; *a && *b; a++, b++) {
    const char x = !exact && *a >= 'A' && *a <= 'Z' ? (char)(*a | 0x20) : *a;
    const char y = !exact && *b >= 'A' && *b <= 'Z' ? (char)(*b | 0x20) : *b;
    if (x != y) return false;
  }
  return *a == *b;
}

bool units_factor(const char *text, const char *unit, double *factor) {
  static const char *const others[][2] = {
      {"feet", "ft"},    {"foot", "ft"},  {"inch", "in"},   {"inches", "in"},   {"sec", "s"},
      {"metres", "m"},   {"meters", "m"}, {"m/sec", "m/s"}, {"ft/sec", "ft/s"}, {"m/day", "m/d"},
      {"degree", "deg"}, {"d", "deg"},    {"fps", "ft/s"},  {"cm/sec", "cm/s"}};
  const quantity *q = strcmp(unit, "1") == 0 ? &ratio : find(unit);
  char name[32];
  if (!q || !plain(text, name, sizeof name)) return false;
  for (size_t k = 0; k < sizeof others / sizeof *others; k++)
    if (same(name, others[k][0], false)) {
      snprintf(name, sizeof name, "%s", others[k][1]);
      break;
    }
  for (int exact = 1; exact >= 0; exact--)
    for (int k = 0; k < MOST_UNITS && q->unit[k].name; k++)
      if (same(name, q->unit[k].name, exact)) {
        *factor = q->unit[k].factor;
        return true;
      }
  return false;
}

/* Length of the number that `text` begins with; 0: none. The programs never call setlocale, so
 * strtod reads the C locale's decimal point. */
static size_t number_at(const char *text, double *value) {
  char digits[64], *end;
  const size_t length = strspn(text, "0123456789+-.eE");
  if (length == 0 || length >= sizeof digits) return 0;
  memcpy(digits, text, length);
  digits[length] = '\0';
  *value = strtod(digits, &end);
  return isfinite(*value) ? (size_t)(end - digits) : 0;
}

static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

units_status units_read(const char *text, const char *unit, double *value) {
  double number = 0.0;
  const size_t length = number_at(text, &number);
  if (length == 0) return UNITS_NO_NUMBER;
  const char *rest = text + length;
  if (*rest == '\0') {
    *value = number;
    return UNITS_GOOD;
  }
  if (*rest == ' ') rest++;
  if (!is_letter(*rest)) return UNITS_NO_NUMBER;
  const quantity *q = find(unit);
  for (int k = 0; q && k < MOST_UNITS && q->unit[k].name; k++)
    if (strcmp(q->unit[k].name, rest) == 0) {
      *value = number * q->unit[k].factor;
      return isfinite(*value) ? UNITS_GOOD : UNITS_NO_NUMBER;
    }
  return UNITS_OTHER;
}

bool units_written(const char *text) {
  double number;
  const size_t length = number_at(text, &number);
  return length > 0 && is_letter(text[length + (text[length] == ' ')]);
}

void units_wanted(const char *unit, char *out, size_t size) {
  const quantity *q = find(unit);
  if (!q) {
    snprintf(out, size, "a number without a unit is wanted");
    return;
  }
  size_t used = (size_t)snprintf(out, size, "%s is wanted (", q->name);
  for (int k = 0; k < MOST_UNITS && q->unit[k].name && used < size; k++)
    used += (size_t)snprintf(out + used, size - used, "%s%s", k ? ", " : "", q->unit[k].name);
  if (used < size) snprintf(out + used, size - used, ")");
}

void units_show(double value, const char *unit, char *out, size_t size) {
  const quantity *q = find(unit);
  int best = 0;
  const bool large = fabs(value) >= 1e3, small = value != 0.0 && fabs(value) < 0.99e-2;
  for (int k = 1; q && k < q->shown; k++)
    if ((large && q->unit[k].factor > 1.0 && fabs(value) >= q->unit[k].factor) ||
        (small && q->unit[k].factor < 1.0))
      best = k;
  if (q)
    snprintf(out, size, "%.6g %s", value / q->unit[best].factor, q->unit[best].name);
  else
    snprintf(out, size, "%.6g", value);
}
