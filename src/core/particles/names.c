/* names.c - names of fields, and whose each is: one of the library's table, "user.NAME" the
 * caller's own, "<law>.<column>" the history of a law. No other name is one of a field, so that a
 * later version can add rows to the table without taking a name that a caller has.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"

#include "fields.h"

#include <stdio.h>
#include <string.h>

/* ---- the table ------------------------------------------------------------------------------- */

#define I64                                                                                        \
  { 0, 64, 1 }
#define F64                                                                                        \
  { 2, 64, 1 }
#define ROW(name, type, components, unit, meaning, writer, valid, since)                           \
  {#name, unit, meaning, type, components},
static const mpsi_field_row table[] = {MPSI_FIELD_TABLE(ROW)};
#undef ROW
#define ROWS (sizeof table / sizeof *table)

const mpsi_field_row *mpsi_field_row_of(const char *name) {
  for (size_t i = 0; i < ROWS; i++)
    if (strcmp(table[i].name, name) == 0) return &table[i];
  return NULL;
}

int32_t mpsi_field_row_components(const mpsi_field_row *row, int32_t dim) {
  return mpsi_field_components(row->components, dim);
}

bool mpsi_field_is_known(const char *name) { return mpsi_field_row_of(name) != NULL; }

/* ---- owners ---------------------------------------------------------------------------------- */

mpsi_field_owner mpsi_field_owner_of(const char *name) {
  if (mpsi_field_row_of(name)) return MPSI_FIELD_OF_TABLE;
  const size_t length = mpsi_identifier(name, MPSI_FIELD_NAME_PART);
  if (length == 0 || name[length] != '.') return MPSI_FIELD_UNKNOWN;
  const char *rest = name + length + 1;
  const size_t second = mpsi_identifier(rest, MPSI_FIELD_NAME_PART);
  if (second == 0 || rest[second] != '\0') return MPSI_FIELD_UNKNOWN;
  const size_t own = strlen(MPSI_FIELD_OWN);
  return strncmp(name, MPSI_FIELD_OWN, own) == 0 ? MPSI_FIELD_OF_CALLER : MPSI_FIELD_OF_LAW;
}

bool mpsi_field_own_name(const char *former, char *out, size_t size) {
  const size_t length = mpsi_identifier(former, MPSI_FIELD_NAME_PART);
  if (length == 0 || former[length] != '\0' || mpsi_field_row_of(former)) return false;
  return snprintf(out, size, MPSI_FIELD_OWN "%s", former) < (int)size;
}

/* ---- misspellings ---------------------------------------------------------------------------- */

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

static int least(int a, int b) { return a < b ? a : b; }

/* Letters to insert, remove or replace (Levenshtein), capitals as small ones; `most` + 1: more. */
static int distance(const char *a, const char *b, int most) {
  enum { ROOM = MPSI_FIELD_NAME_PART };
  int row[ROOM + 1];
  const int n = (int)strlen(a), m = (int)strlen(b);
  if (n >= ROOM || m >= ROOM) return most + 1;
  for (int j = 0; j <= m; j++) row[j] = j;
  for (int i = 1; i <= n; i++) {
    int diagonal = row[0];
    row[0] = i;
    for (int j = 1; j <= m; j++) {
      const int replaced = diagonal + (lower(a[i - 1]) != lower(b[j - 1]));
      diagonal = row[j];
      row[j] = least(replaced, least(row[j], row[j - 1]) + 1);
    }
  }
  return least(row[m], most + 1);
}

const char *mpsi_field_nearest(const char *name) {
  const int most = strlen(name) > 5 ? 2 : 1;
  int best = most + 1;
  const char *nearest = NULL;
  for (size_t i = 0; i < ROWS; i++) {
    const int d = distance(name, table[i].name, most);
    if (d < best) best = d, nearest = table[i].name;
  }
  return nearest;
}

mps_status mpsi_field_refuse_name(mps_context *context, const char *function, const char *name) {
  const size_t length = mpsi_identifier(name, MPSI_FIELD_NAME_PART);
  const char *near = mpsi_field_nearest(name);
  if (mpsi_field_owner_of(name) == MPSI_FIELD_OF_LAW)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "name is '%s', the history of a law, which the solver adds that the law is "
                     "given to; a field of your own is user.NAME: write user.%s",
                     name, name + length + 1);
  if (length > 0 && name[length] == '\0')
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "name is '%s', no field of the library's table: for a field of your own "
                     "write user.%s%s%s%s",
                     name, name, near ? "; the nearest of the table is '" : "", near ? near : "",
                     near ? "'" : "");
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "name is '%.60s', must be one of the library's table or user.NAME: letters, "
                   "digits and _, not a digit first, 1 to %d characters",
                   name, MPSI_FIELD_NAME_PART - 1);
}
