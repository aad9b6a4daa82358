/* table.c - the file of rows of numbers. SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include "options.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { LINE = 1024 };
static const char SEPARATORS[] = " \t,;\r\n";

typedef struct reader {
  const char *path;
  const table_def *def;
  double *values;
  int64_t *rows, line;
  bool header;
  char *why;
  size_t size;
} reader;

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

/* Splits `line` in place. Returns the number of words, at most TABLE_COLUMNS + 1. */
static int split(char *line, char *words[TABLE_COLUMNS + 1]) {
  int count = 0;
  line[strcspn(line, "#")] = '\0';
  for (char *rest = line + strspn(line, SEPARATORS); *rest && count <= TABLE_COLUMNS;) {
    words[count++] = rest;
    rest += strcspn(rest, SEPARATORS);
    if (*rest) *rest++ = '\0';
    rest += strspn(rest, SEPARATORS);
  }
  return count;
}

static bool read_line(reader *r, char *line) {
  const table_def *def = r->def;
  char *words[TABLE_COLUMNS + 1];
  double *row = r->values + *r->rows * def->count, number;
  const int count = split(line, words);
  if (count == 0) return true;
  if (!r->header && *r->rows == 0 && !options_number(words[0], &number)) {
    r->header = true; /* a first line that does not begin with a number */
    return true;
  }
  if (count != def->count)
    return fail(r, "%s values, a %s has %d: %s", count > def->count ? "too many" : "too few",
                def->row, def->count, def->columns);
  if (*r->rows == def->most) return fail(r, "more than %lld %ss", (long long)def->most, def->row);
  for (int i = 0; i < count; i++)
    if (!options_number(words[i], &row[i]))
      return fail(r, "\"%s\" is not a finite number", words[i]);
  const char *reason = def->fault ? def->fault(row) : NULL;
  if (reason) return fail(r, "%s", reason);
  ++*r->rows;
  return true;
}

bool table_read(const char *path, const table_def *def, double *values, int64_t *rows, char *why,
                size_t size) {
  reader r = {path, def, values, rows, 0, false, why, size};
  *rows = 0;
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
