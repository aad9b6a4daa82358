/* enumerators.c - the names of all public enumerators. enumerators.h, their rows, is written from
 * the headers when the build is configured (src/CMakeLists.txt); enumerations of X macros are here.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

#include <stdio.h>
#include <string.h>

static const struct {
  const char *enumeration, *name;
  int32_t value;
} rows[] = {
#define STATUS(own, number, text) {"mps_status", "MPS_" #own, number},
#define FEATURE(own, number, text) {"mps_feature", "MPS_FEATURE_" #own, number},
#define DEFINITION(own, number, type) {"mps_def_kind", "MPS_DEF_" #own, number},
    MPS_STATUS_TABLE(STATUS) MPS_FEATURE_TABLE(FEATURE) MPS_DEFINITION_TABLE(DEFINITION)
#include "enumerators.h"
};

const char *mps_enumerator_name(const char *enumeration, int32_t value) {
  for (size_t k = 0; enumeration && k < sizeof rows / sizeof *rows; k++)
    if (rows[k].value == value && strcmp(rows[k].enumeration, enumeration) == 0)
      return rows[k].name;
  return NULL;
}

mpsi_name mpsi_name_of(const char *enumeration, int32_t value) {
  const char *name = mps_enumerator_name(enumeration, value);
  mpsi_name out;
  if (name)
    snprintf(out.text, sizeof out.text, "%s", name);
  else
    snprintf(out.text, sizeof out.text, "%d", (int)value);
  return out;
}

const char *mpsi_enumeration_of(const char *name) {
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
    if (strcmp(rows[k].name, name) == 0) return rows[k].enumeration;
  return NULL;
}
