/* record_units.c - units that headers of records name, in the spellings that occur: "cm/s/s",
 * "CM/SEC**2", "m s-2", "m/s" with a superscript two, "Gal".
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#include <stdio.h>
#include <string.h>

#define FOOT 0.3048
#define INCH 0.0254
#define STANDARD_GRAVITY 9.80665 /* m/s2 */
#define SPELLING 24

enum {
  A = MPS_SIGNAL_QUANTITY_ACCELERATION,
  V = MPS_SIGNAL_QUANTITY_VELOCITY,
  D = MPS_SIGNAL_QUANTITY_DISPLACEMENT,
  T = MPSI_UNIT_TIME
};

/* The first of a quantity is that of SI. */
static const mpsi_unit units[] = {
    {"m/s2", A, 1.0},
    {"g", A, STANDARD_GRAVITY},
    {"gal", A, 1e-2},
    {"cm/s2", A, 1e-2},
    {"mm/s2", A, 1e-3},
    {"mg", A, 1e-3 * STANDARD_GRAVITY},
    {"%g", A, 1e-2 * STANDARD_GRAVITY},
    {"ft/s2", A, FOOT},
    {"in/s2", A, INCH},
    {"m/s", V, 1.0},
    {"cm/s", V, 1e-2},
    {"mm/s", V, 1e-3},
    {"kine", V, 1e-2},
    {"ft/s", V, FOOT},
    {"in/s", V, INCH},
    {"m", D, 1.0},
    {"cm", D, 1e-2},
    {"mm", D, 1e-3},
    {"um", D, 1e-6},
    {"ft", D, FOOT},
    {"in", D, INCH},
    {"s", T, 1.0},
    {"ms", T, 1e-3},
    {"us", T, 1e-6},
    {"min", T, 60.0},
    {"h", T, 3600.0},
};

enum { UNITS = (int)(sizeof units / sizeof *units) };

/* Other spellings, after `plain` has made them so. */
static const char *const others[][2] = {
    {"gals", "gal"},       {"m/s/s", "m/s2"},    {"cm/s/s", "cm/s2"},   {"mm/s/s", "mm/s2"},
    {"ft/s/s", "ft/s2"},   {"in/s/s", "in/s2"},  {"ms-2", "m/s2"},      {"cms-2", "cm/s2"},
    {"mms-2", "mm/s2"},    {"ms-1", "m/s"},      {"cms-1", "cm/s"},     {"mms-1", "mm/s"},
    {"g's", "g"},          {"gs", "g"},          {"g0", "g"},           {"meter", "m"},
    {"meters", "m"},       {"metre", "m"},       {"metres", "m"},       {"feet", "ft"},
    {"foot", "ft"},        {"inch", "in"},       {"inches", "in"},      {"seconds", "s"},
    {"second", "s"},       {"secs", "s"},        {"msec", "ms"},        {"minutes", "min"},
    {"percentg", "%g"},    {"%ofg", "%g"},       {"micrometer", "um"},  {"hours", "h"},
    {"kines", "kine"},     {"milli-g", "mg"},    {"\xc2\xb5m", "um"},   {"millimeter", "mm"},
    {"millimeters", "mm"}, {"millimetre", "mm"}, {"centimeters", "cm"},
};

static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/* Lower case, without blanks and powers' signs, "s" for "sec"; false where it is too long. */
static bool plain(mpsi_slice name, char out[SPELLING]) {
  size_t n = 0;
  for (const char *c = name.begin; c < name.end; c++) {
    const size_t left = (size_t)(name.end - c);
    char is = *c >= 'A' && *c <= 'Z' ? (char)(*c - 'A' + 'a') : *c;
    if (is == ' ' || is == '\t' || is == '^' || is == '*' || is == '"') continue;
    if (left >= 2 && memcmp(c, "\xc2\xb2", 2) == 0)
      c++, is = '2';
    else if (is == '\xb2')
      is = '2'; /* Latin-1 */
    if (left >= 3 && mpsi_slice_starts((mpsi_slice){c, name.end}, "sec", NULL) &&
        (left == 3 || !is_letter(c[3])) && (n == 0 || !is_letter(out[n - 1])))
      c += 2;
    if (n + 1 >= SPELLING) return false;
    out[n++] = is;
  }
  out[n] = '\0';
  return n > 0;
}

const mpsi_unit *mpsi_unit_find(mpsi_slice name) {
  char text[SPELLING];
  if (!plain(name, text)) return NULL;
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    if (strcmp(text, others[i][0]) == 0) {
      snprintf(text, sizeof text, "%s", others[i][1]);
      break;
    }
  for (int i = 0; i < UNITS; i++)
    if (strcmp(text, units[i].name) == 0) return &units[i];
  return NULL;
}

void mpsi_unit_list(int32_t quantity, char *out, size_t size) {
  size_t used = 0;
  out[0] = '\0';
  for (int i = 0; i < UNITS && used < size; i++)
    if (units[i].quantity == quantity)
      used += (size_t)snprintf(out + used, size - used, "%s%s", used ? ", " : "", units[i].name);
}
