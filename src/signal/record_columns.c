/* record_columns.c - the names of the columns of a CSV: which one is the time, which the value, and
 * in which units, "Time [s]", "Acceleration [g]", "acc_cm_s2", "N-S(gal)", "WG1 (mm)".
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#include <stdio.h>
#include <string.h>

#define NAMES_SHOWN 140

enum { ROLE_OTHER = -1, ROLE_SPECTRUM = -2 }; /* else mps_signal_quantity, or MPSI_UNIT_TIME */

static bool is_blank(char c) { return c == ' ' || c == '\t'; }
static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

static mpsi_slice trim(mpsi_slice cell) {
  while (cell.begin < cell.end && (is_blank(*cell.begin) || *cell.begin == '"')) cell.begin++;
  while (cell.end > cell.begin && (is_blank(cell.end[-1]) || cell.end[-1] == '"')) cell.end--;
  return cell;
}

int mpsi_columns_split(mpsi_slice line, mpsi_layout layout, mpsi_slice cell[MPSI_RECORD_COLUMNS]) {
  int count = 0;
  const char *stops = layout.semicolon ? ";" : layout.comma ? "" : ",;";
  line = trim(line);
  while (line.begin < line.end || count == 0) {
    if (count == MPSI_RECORD_COLUMNS) return count + 1;
    mpsi_slice one = {line.begin, line.begin};
    bool quoted = false;
    while (one.end < line.end && (quoted || !((*one.end && strchr(stops, *one.end)) ||
                                              (layout.blanks && is_blank(*one.end))))) {
      quoted = quoted != (*one.end == '"');
      one.end++;
    }
    line.begin = one.end;
    while (line.begin < line.end && is_blank(*line.begin)) line.begin++;
    if (line.begin < line.end && *line.begin && strchr(stops, *line.begin)) {
      line.begin++;
      while (line.begin < line.end && is_blank(*line.begin)) line.begin++;
    }
    cell[count++] = trim(one);
  }
  return count;
}

static bool word_is(const char *word, const char *const *list, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (strcmp(word, list[i]) == 0) return true;
  return false;
}

/* What a column is, by the letters that its name begins with and by words in it. */
static int role_of(mpsi_slice cell) {
  static const char *const spectra[] = {"sa", "psa", "sv", "psv", "sd", "freq", "frequency", "f"};
  static const char *const times[] = {"t",    "time",    "times", "sec",
                                      "secs", "seconds", "zeit",  "temps"};
  static const char *const lengths[] = {"u", "d", "level", "eta", "elevation", "surface", "wg"};
#define IS(list) word_is(word, list, sizeof(list) / sizeof *(list))
  char word[16] = "";
  for (size_t n = 0; n + 1 < sizeof word && cell.begin + n < cell.end && is_letter(cell.begin[n]);
       n++)
    word[n] = (char)(cell.begin[n] | 0x20), word[n + 1] = '\0';
  if (mpsi_slice_find(cell, "spectr", NULL) || mpsi_slice_find(cell, "period", NULL) || IS(spectra))
    return ROLE_SPECTRUM;
  if (mpsi_slice_find(cell, "acc", NULL) || strcmp(word, "a") == 0 || strcmp(word, "ag") == 0)
    return MPS_SIGNAL_QUANTITY_ACCELERATION;
  if (mpsi_slice_find(cell, "vel", NULL) || strcmp(word, "v") == 0) {
    if (!mpsi_slice_starts(cell, "level", NULL)) return MPS_SIGNAL_QUANTITY_VELOCITY;
  }
  if (mpsi_slice_find(cell, "disp", NULL) || IS(lengths)) return MPS_SIGNAL_QUANTITY_DISPLACEMENT;
  if (IS(times) || mpsi_slice_find(cell, "time", NULL)) return MPSI_UNIT_TIME;
  return ROLE_OTHER;
#undef IS
}

/* Directions that stand in parentheses as units do. */
static bool is_direction(mpsi_slice part) {
  static const char *const words[] = {"ns", "ew",  "ud",  "n-s",      "e-w",     "u-d",
                                      "x",  "y",   "z",   "h1",       "h2",      "h",
                                      "v",  "rel", "abs", "relative", "absolute"};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    mpsi_slice after;
    if (mpsi_slice_starts(part, words[i], &after) && after.begin == after.end) return true;
  }
  return false;
}

/* "acc_m_s2": what is behind the first underscore; "acc, g", "acc g": the last word. */
static const mpsi_unit *unit_behind(mpsi_slice cell) {
  char text[24];
  for (const char *under = cell.begin; under < cell.end; under++) {
    if (*under != '_') continue;
    size_t n = 0;
    for (const char *c = under + 1; c < cell.end && n < sizeof text; c++)
      text[n++] = *c == '_' ? '/' : *c;
    const mpsi_unit *unit = mpsi_unit_find((mpsi_slice){text, text + n});
    if (unit) return unit;
  }
  const char *last = cell.end;
  while (last > cell.begin && !strchr(" \t,", last[-1])) last--;
  return last > cell.begin ? mpsi_unit_find((mpsi_slice){last, cell.end}) : NULL;
}

/* The unit of a column, NULL: none is named. */
static mps_status find_unit(const mpsi_text *text, mpsi_slice cell, const mpsi_unit **out) {
  *out = NULL;
  for (const char *c = cell.begin; c < cell.end; c++) {
    if (!strchr("([", *c)) continue;
    mpsi_slice part = {c + 1, c + 1};
    while (part.end < cell.end && !strchr(")]", *part.end)) part.end++;
    *out = mpsi_unit_find(part);
    if (*out) return MPS_OK;
    if (is_direction(trim(part))) continue;
    char known[120];
    const int role = role_of(cell);
    mpsi_unit_list(role < 0 ? MPS_SIGNAL_QUANTITY_ACCELERATION : role, known, sizeof known);
    const mpsi_quote name = mpsi_slice_quote(cell), unit = mpsi_slice_quote(part);
    return mpsi_text_fail(text, "the unit \"%s\" of the column \"%s\" is not known: %s", unit.text,
                          name.text, known);
  }
  *out = unit_behind(cell);
  return MPS_OK;
}

/* "a", "b", for messages. */
static void list_names(const mpsi_slice *cell, int count, int without, char out[NAMES_SHOWN]) {
  size_t used = 0;
  out[0] = '\0';
  for (int i = 0; i < count && used + 48 < NAMES_SHOWN; i++)
    if (i != without)
      used += (size_t)snprintf(out + used, NAMES_SHOWN - used, "%s\"%s\"", used ? ", " : "",
                               mpsi_slice_quote(cell[i]).text);
}

static bool same_name(mpsi_slice cell, const char *name) {
  mpsi_slice after;
  if (!mpsi_slice_starts(cell, name, &after)) return false;
  mpsi_slice_trim(&after);
  return after.begin == after.end || *after.begin == '(' || *after.begin == '[';
}

/* The column of the values: the one asked for, or the only one. */
static mps_status find_value(const mpsi_text *text, const mpsi_slice *cell, const mpsi_samples *s,
                             mpsi_columns *out) {
  char names[NAMES_SHOWN];
  const char *asked = s->def->column;
  int found = -1, all = 0, fitting = -1, fit = 0;
  for (int i = 0; i < out->count; i++) {
    if (i == out->time || (asked && !same_name(cell[i], asked))) continue;
    found = i, all++;
    if (role_of(cell[i]) == s->def->quantity) fitting = i, fit++;
  }
  out->value = all == 1 ? found : !asked && fit == 1 ? fitting : -1;
  list_names(cell, out->count, out->time, names);
  if (asked && all != 1)
    return mpsi_text_fail(text, "%s column is named \"%.40s\": the file has %s",
                          all ? "more than one" : "no", asked, names);
  if (out->value < 0) return mpsi_text_fail(text, "which column is wanted? The file has %s", names);
  return MPS_OK;
}

static mps_status check_value(const mpsi_text *text, mpsi_slice cell, const mpsi_samples *s,
                              const mpsi_unit *unit) {
  static const char *const names[] = {"accelerations", "velocities", "displacements", "times"};
  const int role = role_of(cell), is = unit ? unit->quantity : role;
  if (role == ROLE_SPECTRUM)
    return mpsi_text_fail(text, "\"%s\" is a response spectrum, a motion in time is expected",
                          mpsi_slice_quote(cell).text);
  if ((role >= 0 && role != s->def->quantity) || (is >= 0 && is != s->def->quantity))
    return mpsi_text_fail(text, "\"%s\" has %s, %s are expected", mpsi_slice_quote(cell).text,
                          names[role >= 0 && role != s->def->quantity ? role : is],
                          names[s->def->quantity]);
  return MPS_OK;
}

mps_status mpsi_columns_find(const mpsi_text *text, const mpsi_slice *cell, const mpsi_slice *units,
                             mpsi_samples *s, mpsi_columns *out) {
  const mpsi_unit *unit = NULL;
  out->time = -1, out->second = 1.0;
  for (int i = 0; i < out->count; i++)
    if (role_of(cell[i]) == ROLE_SPECTRUM)
      return mpsi_text_fail(text,
                            "\"%s\" is a column of a response spectrum, a motion in time is "
                            "expected",
                            mpsi_slice_quote(cell[i]).text);
  for (int i = 0; i < out->count && out->time < 0; i++)
    if (role_of(cell[i]) == MPSI_UNIT_TIME) out->time = i;
  if (out->time < 0 && isnan(out->step)) {
    char names[NAMES_SHOWN];
    list_names(cell, out->count, -1, names);
    return mpsi_text_fail(
        text,
        "no column is named time or t, and there is no step, such as dt=0.01: the "
        "file has %s",
        names);
  }
  mps_status status = find_value(text, cell, s, out);
  if (status != MPS_OK) return status;
  if (out->time >= 0) {
    const int t = out->time;
    status = find_unit(text, cell[t], &unit);
    if (status == MPS_OK && !unit && units) unit = mpsi_unit_find(units[t]);
    if (status != MPS_OK) return status;
    if (unit && unit->quantity != MPSI_UNIT_TIME)
      return mpsi_text_fail(text, "the unit \"%s\" of the column \"%s\" is none of time",
                            unit->name, mpsi_slice_quote(cell[t]).text);
    if (unit) out->second = unit->factor;
  }
  status = find_unit(text, cell[out->value], &unit);
  if (status == MPS_OK && !unit && units) unit = mpsi_unit_find(units[out->value]);
  if (status == MPS_OK) status = check_value(text, cell[out->value], s, unit);
  if (status == MPS_OK && unit) s->unit = unit;
  return status;
}
