/* table.c - the file of rows of numbers. SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include "options.h"
#include "units.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { LINE = 1024, NAMES = 400, OTHER = -1 };
static char note[700];

typedef struct reader {
  const char *path;
  const table_def *def;
  double *values;
  int64_t *rows, line;
  bool named;               /* a header is read */
  bool ended;               /* a row without end is read */
  int columns;              /* of the file */
  char comment[LINE];       /* the last one before the rows, which may be a header */
  int place[TABLE_COLUMNS]; /* the column of the definition that each of the file is, or OTHER */
  double factor[TABLE_COLUMNS]; /* to SI units, by columns of the file */
  char *why;
  size_t size;
} reader;

const char *table_note(void) { return note; }

/* "path:line: reason", without the line where it is 0. Returns false. */
static bool fail(const reader *r, const char *format, ...) {
  va_list args;
  const int at = r->line > 0 ? snprintf(r->why, r->size, "%s:%lld: ", r->path, (long long)r->line)
                             : snprintf(r->why, r->size, "%s: ", r->path);
  va_start(args, format);
  if (at >= 0 && (size_t)at < r->size) vsnprintf(r->why + at, r->size - (size_t)at, format, args);
  va_end(args);
  return false;
}

/* ---- names ----------------------------------------------------------------------------------- */

/* "unit_weight_kN_m3" */
static void full_name(const table_column *c, char *out, size_t size) {
  const int used = snprintf(out, size, "%s%s%s", c->name, strcmp(c->unit, "1") == 0 ? "" : "_",
                            strcmp(c->unit, "1") == 0 ? "" : c->unit);
  for (int k = 0; k < used && (size_t)k < size; k++)
    if (out[k] == ' ' || out[k] == '/') out[k] = '_';
}

/* "thickness_m, vs_m_s": the names of the columns. */
static void list_names(const table_def *def, char *out, size_t size) {
  size_t used = 0;
  out[0] = '\0';
  for (int k = 0; k < def->count && used < size; k++) {
    char name[60];
    full_name(&def->column[k], name, sizeof name);
    used += (size_t)snprintf(out + used, size - used, "%s%s", k ? ", " : "", name);
  }
}

static char simple(char c) {
  if (c >= 'A' && c <= 'Z') return (char)(c | 0x20);
  return c == '_' || c == '-' ? ' ' : c;
}

/* What follows the name of the column in the cell, NULL: it is another. */
static const char *behind(const char *cell, const char *name) {
  while (*name && *cell && simple(*name) == simple(*cell)) name++, cell++;
  return *name ? NULL : cell;
}

/* A word "a" of "a|b" that begins the cell. */
static bool is_other(const char *cell, const char *others) {
  char name[40];
  while (others && *others) {
    const int length = (int)strcspn(others, "|");
    snprintf(name, sizeof name, "%.*s", length, others);
    const char *rest = behind(cell, name);
    if (rest && (!*rest || strchr(" _,-([", *rest))) return true;
    others += length + (others[length] == '|');
  }
  return false;
}

/* The unit that follows a name, "_kN_m3", " [kN/m3]", "": *factor to SI. */
static bool read_unit(const table_column *c, const char *rest, double *factor) {
  char unit[40];
  const char *bracket = strpbrk(rest, "([");
  if (bracket) rest = bracket;
  while (*rest && strchr(" _,-([", *rest)) rest++;
  size_t length = strlen(rest);
  while (length > 0 && strchr(" )]", rest[length - 1])) length--;
  if (length == 0) return units_factor(c->unit, c->quantity, factor);
  if (length >= sizeof unit) return false;
  memcpy(unit, rest, length);
  unit[length] = '\0';
  return units_factor(unit, c->quantity, factor);
}

/* ---- lines ----------------------------------------------------------------------------------- */

/* Splits `line` in place into trimmed cells: at commas or semicolons where there are some (empty
 * cells count), else at tabs where names have blanks, else at blanks. Returns the number of cells,
 * at most TABLE_COLUMNS + 1. */
static int split(char *line, bool header, char *cell[TABLE_COLUMNS + 1]) {
  int count = 0;
  const char *stops = strchr(line, ';') ? ";" : strchr(line, ',') ? "," : NULL;
  if (!stops && header && strchr(line, '\t')) stops = "\t";
  for (char *rest = line; rest && count <= TABLE_COLUMNS;) {
    rest += strspn(rest, stops && *stops == '\t' ? " " : " \t");
    if (!*rest) break; /* a separator at the end makes no cell */
    char *end = rest + strcspn(rest, stops ? stops : " \t");
    char *next = *end ? end + 1 : NULL;
    *end = '\0';
    for (size_t n = strlen(rest); n > 0 && strchr(" \t\"", rest[n - 1]);) rest[--n] = '\0';
    if (*rest == '"') rest++;
    /* a unit in brackets behind a blank belongs to the name before it */
    if (!stops && header && count > 0 && strchr("([", *rest) && *rest) {
      char *last = cell[count - 1];
      const size_t used = strlen(last);
      memmove(last + used, rest, strlen(rest) + 1);
    } else {
      cell[count++] = rest;
    }
    rest = next;
  }
  return count;
}

/* Makes the columns of a header; *unknown: the cell that is none, else it is wrong otherwise. */
static bool read_header(reader *r, char **cell, int count, const char **unknown) {
  const table_def *def = r->def;
  bool given[TABLE_COLUMNS] = {false};
  char names[NAMES], name[60];
  list_names(def, names, sizeof names);
  *unknown = NULL;
  for (int i = 0; i < count && i <= TABLE_COLUMNS; i++) {
    int found = -1;
    const char *rest = NULL;
    for (int k = 0; k < def->count && found < 0; k++) {
      rest = behind(cell[i], def->column[k].name);
      if (rest && (!*rest || strchr(" _,-([", *rest))) found = k;
    }
    if (found < 0 && i < TABLE_COLUMNS && is_other(cell[i], def->others)) {
      r->place[i] = OTHER;
      continue;
    }
    if (found < 0) {
      *unknown = cell[i];
      return fail(r, "\"%.60s\" is not a column of a %s: %s", cell[i], def->row, names);
    }
    const table_column *c = &def->column[found];
    full_name(c, name, sizeof name);
    if (i == TABLE_COLUMNS || given[found]) return fail(r, "a second column \"%.60s\"", cell[i]);
    given[found] = true;
    r->place[i] = found;
    if (c->words)
      r->factor[i] = 1.0;
    else if (!read_unit(c, rest, &r->factor[i]))
      return fail(r, "the unit of \"%.60s\" is none of %s, such as %s", cell[i], c->name, name);
  }
  r->columns = count;
  for (int k = 0; k < def->count; k++)
    if (!given[k] && !def->column[k].optional) {
      full_name(&def->column[k], name, sizeof name);
      return fail(r, "the header lacks %s: a %s has %s", name, def->row, names);
    }
  return true;
}

/* The columns of a file without a header, which a comment may name. */
static bool assume(reader *r) {
  const table_def *def = r->def;
  char *cell[TABLE_COLUMNS + 1], names[NAMES], why[64], *all = r->why;
  const size_t size = r->size;
  const char *unknown;
  r->named = true;
  r->why = why, r->size = sizeof why;
  const int count = split(r->comment, true, cell);
  const bool header = count > 0 && read_header(r, cell, count, &unknown);
  r->why = all, r->size = size;
  if (header) return true;
  list_names(def, names, sizeof names);
  if (def->others) return fail(r, "a header is missing: a %s has %s", def->row, names);
  r->columns = def->count;
  for (int k = 0; k < def->count; k++) {
    r->place[k] = k;
    if (!units_factor(def->column[k].unit, def->column[k].quantity, &r->factor[k]))
      return fail(r, "a unit is not known");
  }
  snprintf(note, sizeof note, "%.200s has no header: its columns are taken as %s", r->path, names);
  return true;
}

/* A number, with a decimal comma where the cell has one. */
static bool read_cell(char *cell, double *out) {
  char *comma = strchr(cell, ',');
  if (comma && !strchr(cell, '.')) *comma = '.';
  for (char *c = cell; *c; c++)
    if (*c == 'd' || *c == 'D') *c = 'e'; /* of Fortran */
  return options_number(cell, out);
}

static bool check_range(reader *r, int k, double value, double factor, const char *cell) {
  const table_column *c = &r->def->column[k];
  if (value <= c->upper && (c->open ? value > c->lower : value >= c->lower)) return true;
  const bool pure = strcmp(c->quantity, "1") == 0;
  const char *unit = pure ? "" : c->quantity;
  char name[60], is[60] = "";
  full_name(c, name, sizeof name);
  if (factor != 1.0) snprintf(is, sizeof is, ", %g%s%s", value, pure ? "" : " ", unit);
  return fail(r, "%s is %s%s, must be %s%g to %g%s%s", name, cell, is, c->open ? "above " : "",
              c->lower, c->upper, pure ? "" : " ", unit);
}

/* A cell of column k, which is not empty. */
static bool read_value(reader *r, int k, char *cell, double factor, double *out) {
  const table_column *c = &r->def->column[k];
  char text[40];
  snprintf(text, sizeof text, "%.32s", cell);
  const char *word = c->words;
  for (*out = 0.0; word && *word; ++*out, word += strspn(word, "|")) {
    const size_t length = strcspn(word, "|");
    if (strlen(cell) == length && strncmp(word, cell, length) == 0) return true;
    word += length;
  }
  if (c->words) return fail(r, "%s is %s, must be one of %s", c->name, text, c->words);
  if (c->endless && strcmp(cell, "inf") == 0) {
    *out = INFINITY;
    return r->ended = true;
  }
  if (!read_cell(cell, out)) return fail(r, "\"%s\" is not a finite number", text);
  *out *= factor;
  return check_range(r, k, *out, factor, text);
}

static bool read_row(reader *r, char **cell, int count) {
  const table_def *def = r->def;
  char names[NAMES];
  list_names(def, names, sizeof names);
  bool may_end = false; /* before the last column */
  for (int i = count; i < r->columns; i++)
    may_end = r->place[i] == OTHER || def->column[r->place[i]].optional;
  if (count > r->columns || (count < r->columns && !may_end))
    return fail(r, "%s values, a %s has %d: %s", count > r->columns ? "too many" : "too few",
                def->row, r->columns, names);
  if (r->ended) return fail(r, "a %s below one that is endless", def->row);
  if (*r->rows == def->most) return fail(r, "more than %lld %ss", (long long)def->most, def->row);
  double *row = r->values + *r->rows * def->count;
  for (int k = 0; k < def->count; k++) row[k] = NAN;
  for (int i = 0; i < r->columns; i++) {
    const int k = r->place[i];
    const bool empty = i >= count || !*cell[i];
    if (k == OTHER || (empty && def->column[k].optional)) continue;
    if (empty) return fail(r, "%s is missing", def->column[k].name);
    if (!read_value(r, k, cell[i], r->factor[i], &row[k])) return false;
  }
  const char *reason = def->fault ? def->fault(row) : NULL;
  if (reason) return fail(r, "%s", reason);
  ++*r->rows;
  return true;
}

static bool read_line(reader *r, char *line) {
  char *cell[TABLE_COLUMNS + 1], first[64];
  char *comment = strchr(line, '#');
  if (comment) *comment = '\0';
  for (size_t n = strlen(line); n > 0 && strchr(" \t\r\n", line[n - 1]);) line[--n] = '\0';
  if (r->line == 1 && strncmp(line, "sep=", 4) == 0) return true; /* of a spreadsheet */
  if (comment && !*line && !r->named) {
    snprintf(r->comment, sizeof r->comment, "%s", comment + 1);
    r->comment[strcspn(r->comment, "\r\n")] = '\0';
  }
  if (r->line == 1 && strncmp(line, "\xef\xbb\xbf", 3) == 0)
    memmove(line, line + 3, strlen(line + 3) + 1);
  double number;
  snprintf(first, sizeof first, "%.*s", (int)fmin((double)strcspn(line, ",; \t"), 60.0), line);
  const bool header = !r->named && *r->rows == 0 && *line && !options_number(first, &number) &&
                      strchr("+-.0123456789", *line) == NULL;
  const int count = split(line, header, cell);
  const char *unknown;
  if (count == 0) return true;
  if (header) {
    r->named = true; /* a first line that does not begin with a number */
    return read_header(r, cell, count, &unknown);
  }
  if (!r->named && !assume(r)) return false;
  return read_row(r, cell, count);
}

bool table_read(const char *path, const table_def *def, double *values, int64_t *rows, char *why,
                size_t size) {
  reader r = {.path = path, .def = def, .values = values, .rows = rows, .why = why, .size = size};
  *rows = 0;
  note[0] = '\0';
  FILE *file = fopen(path, "r");
  if (!file) {
    snprintf(why, size, "cannot read %s: %s", path, strerror(errno));
    return false;
  }
  char line[LINE];
  bool ok = true;
  for (r.line = 1; ok && fgets(line, sizeof line, file); r.line++) {
    if (!strchr(line, '\n') && !feof(file)) /* a device may give zeros without end */
      ok = fail(&r, "line longer than %d characters, or no text", LINE - 2);
    else
      ok = read_line(&r, line);
  }
  if (ok && ferror(file)) {
    snprintf(why, size, "cannot read %s: %s", path, strerror(errno));
    ok = false;
  }
  fclose(file);
  r.line = 0;
  return ok && *rows == 0 ? fail(&r, "no %s in the file", def->row) : ok;
}
