/* record_csv.c - columns of text: time and value by the names of a header line, or time (s) and
 * value in two columns without names; values a step apart, of which the header, or the reader,
 * says the step: "dt=0.01", or a line of the number of values and the step before them (eqsig;
 * DEEPSOIL, with times). Separated by blanks, commas or semicolons; behind semicolons, and between
 * blanks where all words are such, a comma is a decimal sign. '#' begins a comment.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#include <string.h>

#define SAME_STEP 1e-3 /* relative */
#define UNEVEN 2.0     /* longest over shortest interval */
#define LONG 8         /* samples from which a series that never changes sign is looked at */

typedef struct csv {
  mpsi_text *text;
  mpsi_samples *samples;
  mpsi_header header;
  mpsi_layout layout;
  mpsi_columns columns;
  /* lines that may have names: the last plain one, the one before it, the last comment */
  mpsi_slice plain[2], comment;
  int64_t plain_line[2], comment_line;
  double start, before; /* times, as in the file */
} csv;

/* The next line that is not empty after its comment is cut off; begins with its first word. A
 * comment before the samples goes to *comment. */
static mps_status next_line(mpsi_text *text, mpsi_slice *line, mpsi_slice *comment, bool *found) {
  *found = false;
  while (mpsi_text_line(text, line)) {
    mpsi_slice_trim(line);
    if (mpsi_slice_size(*line) == 0) continue;
    const bool whole = strchr("#%!|", *line->begin) && *line->begin != '\0';
    const char *at = whole ? line->begin : memchr(line->begin, '#', (size_t)mpsi_slice_size(*line));
    *comment = (mpsi_slice){line->end, line->end};
    if (at) *comment = (mpsi_slice){at + 1, line->end}, line->end = at;
    if (memchr(line->begin, '\r', (size_t)mpsi_slice_size(*line)))
      return mpsi_text_fail(text, "lines end with CR alone, must end with LF or CRLF");
    *found = true;
    return MPS_OK;
  }
  return MPS_OK;
}

static bool is_number_start(mpsi_slice word) {
  return mpsi_slice_size(word) > 0 &&
         ((*word.begin && strchr("+-.0123456789", *word.begin)) ||
          mpsi_slice_starts(word, "nan", NULL) || mpsi_slice_starts(word, "inf", NULL));
}

/* A row of numbers, perhaps malformed ones: a broken first sample must not be skipped in silence. A
 * title may begin with a year. */
static bool is_row(mpsi_slice line) {
  mpsi_slice rest = line;
  if (!is_number_start(mpsi_slice_word(&rest, ",;"))) return false;
  int letters = 0;
  while (rest.begin < rest.end) {
    while (rest.begin < rest.end && strchr(",; \t", *rest.begin)) rest.begin++;
    const mpsi_slice word = mpsi_slice_word(&rest, ",;");
    letters += mpsi_slice_size(word) > 0 && !is_number_start(word);
    if (mpsi_slice_size(word) == 0) break;
  }
  return letters < 2;
}

/* ---- layout ---------------------------------------------------------------------------------- */

/* "12,5": digits on both sides of one comma, and no point. */
static bool has_decimal_comma(mpsi_slice word) {
  const char *comma = memchr(word.begin, ',', (size_t)mpsi_slice_size(word));
  if (!comma || comma == word.begin || comma + 1 == word.end) return false;
  const char before = comma[-1], after = comma[1];
  return before >= '0' && before <= '9' && after >= '0' && after <= '9' &&
         !memchr(word.begin, '.', (size_t)mpsi_slice_size(word)) &&
         !memchr(comma + 1, ',', (size_t)(word.end - comma - 1));
}

static mpsi_layout layout_of(mpsi_slice row) {
  mpsi_layout layout = {.blanks = true};
  if (memchr(row.begin, ';', (size_t)mpsi_slice_size(row))) {
    layout.semicolon = layout.comma = true;
    return layout;
  }
  int words = 0, commas = 0;
  for (mpsi_slice rest = row;; words++) {
    const mpsi_slice word = mpsi_slice_word(&rest, "");
    if (mpsi_slice_size(word) == 0) break;
    commas += has_decimal_comma(word);
  }
  layout.comma = words > 1 && commas == words;
  return layout;
}

/* Names and not numbers, which may have blanks: split where the numbers are. */
static int split_names(const csv *c, mpsi_slice line, mpsi_slice *cell) {
  mpsi_layout layout = c->layout;
  const char comma = layout.semicolon ? ';' : ',';
  if (memchr(line.begin, comma, (size_t)mpsi_slice_size(line))) layout.blanks = false;
  if (!layout.blanks) layout.comma = layout.semicolon;
  if (layout.blanks && memchr(line.begin, '\t', (size_t)mpsi_slice_size(line))) {
    int count = 0; /* tabs alone */
    for (mpsi_slice rest = line; count < MPSI_RECORD_COLUMNS; count++) {
      const char *tab = memchr(rest.begin, '\t', (size_t)mpsi_slice_size(rest));
      mpsi_slice one = {rest.begin, tab ? tab : rest.end};
      (void)mpsi_columns_split(one, (mpsi_layout){.comma = true}, &cell[count]);
      if (!tab) return count + 1;
      rest.begin = tab + 1;
    }
    return count + 1;
  }
  int count = mpsi_columns_split(line, layout, cell);
  if (!layout.blanks || count > MPSI_RECORD_COLUMNS) return count;
  int kept = 0; /* a unit in brackets belongs to the name before it */
  for (int i = 0; i < count; i++) {
    if (kept > 0 && cell[i].begin < cell[i].end && strchr("([", *cell[i].begin))
      cell[kept - 1].end = cell[i].end;
    else
      cell[kept++] = cell[i];
  }
  return kept;
}

/* ---- numbers --------------------------------------------------------------------------------- */

static mps_status read_number(const csv *c, mpsi_slice cell, const char *what, double *out) {
  char plain[64];
  const char *comma = memchr(cell.begin, ',', (size_t)mpsi_slice_size(cell));
  if (!comma || !c->layout.comma || !has_decimal_comma(cell) ||
      mpsi_slice_size(cell) >= (int64_t)sizeof plain)
    return mpsi_text_number(c->text, cell, what, out);
  memcpy(plain, cell.begin, (size_t)mpsi_slice_size(cell));
  plain[comma - cell.begin] = '.';
  return mpsi_text_number(c->text, (mpsi_slice){plain, plain + mpsi_slice_size(cell)}, what, out);
}

static mps_status add_timed(csv *c, double time, double value) {
  mpsi_samples *s = c->samples;
  if (s->count == 0) c->start = time;
  /* compared from the first time on, as the samples will be: nothing gets lost in rounding */
  const double now = (time - c->start) * c->columns.second;
  if (s->count > 0 && !(now > s->times[s->count - 1]))
    return mpsi_text_fail(c->text, "time %.17g does not come after %.17g", time, c->before);
  c->before = time;
  if (!isfinite(now))
    return mpsi_text_fail(c->text, "time %g is too far from the first, %g", time, c->start);
  return mpsi_samples_add(c->text, s, now, value);
}

static mps_status read_row(csv *c, mpsi_slice line) {
  mpsi_slice cell[MPSI_RECORD_COLUMNS];
  const mpsi_columns *k = &c->columns;
  const mpsi_slice none = {line.end, line.end};
  const int count = mpsi_columns_split(line, c->layout, cell);
  double time = 0.0, value = 0.0;
  mps_status status = MPS_OK;
  if (k->time >= 0)
    status = read_number(c, k->time < count ? cell[k->time] : none, "the time", &time);
  if (status == MPS_OK)
    status = read_number(c, k->value < count ? cell[k->value] : none, "the value", &value);
  if (status == MPS_OK && count > k->count)
    return mpsi_text_fail(c->text, "%d columns are expected, \"%s\" is left over", k->count,
                          count > MPSI_RECORD_COLUMNS ? "..."
                                                      : mpsi_slice_quote(cell[k->count]).text);
  if (status == MPS_OK && count < k->count)
    return mpsi_text_fail(c->text, "%d columns are expected, the line has %d", k->count, count);
  if (status != MPS_OK) return status;
  return k->time >= 0 ? add_timed(c, time, value)
                      : mpsi_samples_add(c->text, c->samples,
                                         (double)c->samples->count * c->columns.step, value);
}

/* All numbers of the line are values one after another. */
static mps_status read_series(csv *c, mpsi_slice line) {
  mpsi_slice cell[MPSI_RECORD_COLUMNS];
  const int count = mpsi_columns_split(line, c->layout, cell);
  if (count > MPSI_RECORD_COLUMNS)
    return mpsi_text_fail(c->text, "more than %d values on a line", MPSI_RECORD_COLUMNS);
  mps_status status = MPS_OK;
  for (int i = 0; i < count && status == MPS_OK; i++) {
    double value = 0.0;
    status = read_number(c, cell[i], "the value", &value);
    if (status == MPS_OK)
      status =
          mpsi_samples_add(c->text, c->samples, (double)c->samples->count * c->columns.step, value);
  }
  return status;
}

/* ---- header ---------------------------------------------------------------------------------- */

/* Reads up to the first row of numbers, which is *row. */
static mps_status read_header(csv *c, mpsi_slice *row, bool *found) {
  mpsi_slice comment;
  for (;;) {
    mps_status status = next_line(c->text, row, &comment, found);
    if (status != MPS_OK || !*found) return status;
    if (mpsi_slice_size(*row) > 0 && is_row(*row)) return MPS_OK;
    if (c->text->line > MPSI_RECORD_HEADER)
      return mpsi_text_fail(c->text, "no row of numbers in the first %d lines", MPSI_RECORD_HEADER);
    const bool remark = mpsi_slice_size(*row) == 0;
    const mpsi_slice all = remark ? comment : *row;
    if ((status = mpsi_header_line(c->text, all, &c->header)) != MPS_OK) return status;
    if (mpsi_slice_find(all, ":", NULL) || mpsi_slice_find(all, "=", NULL))
      continue; /* "unit: g" is no name of columns */
    if (remark) {
      c->comment = comment, c->comment_line = c->text->line;
    } else {
      c->plain[1] = c->plain[0], c->plain_line[1] = c->plain_line[0];
      c->plain[0] = *row, c->plain_line[0] = c->text->line;
    }
  }
}

/* All of the cells are units: the line below the names. */
static bool are_units(const mpsi_slice *cell, int count) {
  for (int i = 0; i < count; i++) {
    mpsi_slice unit = cell[i];
    if (unit.begin < unit.end && strchr("([", *unit.begin)) unit.begin++, unit.end--;
    if (unit.begin < unit.end && !mpsi_unit_find(unit)) return false;
  }
  return true;
}

/* Whether a line has the columns' names: it has as many cells as the rows. */
static mps_status use_names(csv *c, bool *named) {
  mpsi_slice cell[2][MPSI_RECORD_COLUMNS];
  mpsi_text at = *c->text; /* messages name the line of the names */
  const int count = c->columns.count;
  *named = false;
  bool units = false;
  for (int i = 0; i < 2 && c->plain_line[i] > 0; i++) {
    if (split_names(c, c->plain[i], cell[i]) != count) break;
    if (i == 0 && count > 1 && are_units(cell[0], count) && c->plain_line[1] > 0 &&
        split_names(c, c->plain[1], cell[1]) == count) {
      for (int k = 0; k < count; k++)
        if (cell[0][k].begin < cell[0][k].end && strchr("([", *cell[0][k].begin))
          cell[0][k].begin++, cell[0][k].end--;
      units = true;
      continue;
    }
    if (count == 1 && isnan(c->columns.step)) break; /* a title */
    at.line = c->plain_line[i];
    *named = true;
    return mpsi_columns_find(&at, cell[i], units ? cell[0] : NULL, c->samples, &c->columns);
  }
  if (c->plain_line[0] > 0 || c->comment_line == 0 || count < 2) return MPS_OK;
  if (split_names(c, c->comment, cell[0]) != count) return MPS_OK;
  mpsi_slice rest;
  bool time = false; /* of comments only such as numpy.savetxt writes */
  for (int k = 0; k < count; k++)
    time = time || mpsi_slice_starts(cell[0][k], "time", &rest) ||
           (mpsi_slice_starts(cell[0][k], "t", &rest) &&
            (rest.begin == rest.end || strchr(" ([_", *rest.begin))) ||
           mpsi_slice_find(cell[0][k], "period", NULL);
  if (!time) return MPS_OK;
  at.line = c->comment_line;
  *named = true;
  return mpsi_columns_find(&at, cell[0], NULL, c->samples, &c->columns);
}

/* ---- number of values and step in a line before them ----------------------------------------- */

static bool read_all(const csv *c, mpsi_slice line, int most, double *out, int *count) {
  mpsi_slice cell[MPSI_RECORD_COLUMNS];
  *count = mpsi_columns_split(line, c->layout, cell);
  for (int i = 0; i < *count && i < most; i++)
    if (mpsi_text_scan(c->text, cell[i], &out[i]) != mpsi_slice_size(cell[i]) ||
        mpsi_slice_size(cell[i]) == 0)
      return false;
  return true;
}

/* The row is such a line; *row becomes the next one. */
static bool is_size(csv *c, mpsi_slice *row) {
  double size[2], first[2];
  int count, columns;
  mpsi_slice next, comment;
  bool found;
  if (!read_all(c, *row, 2, size, &count) || count != 2) return false;
  if (!(size[0] >= 2.0 && size[0] == floor(size[0]) && size[0] <= MPSI_RECORD_SAMPLES) ||
      !(size[1] > 0.0 && size[1] <= 10.0))
    return false;
  mpsi_text at = *c->text;
  do {
    if (!mpsi_text_line(&at, &next)) return false;
    mpsi_slice_trim(&next);
  } while (mpsi_slice_size(next) == 0);
  if (!read_all(c, next, 2, first, &columns)) return false;
  if (columns == 2 && !(first[0] < size[0] && first[0] <= size[1] * (1.0 + SAME_STEP)))
    return false;
  c->header.count = size[0], c->header.step = size[1];
  return next_line(c->text, row, &comment, &found) == MPS_OK && found;
}

/* ---- the file -------------------------------------------------------------------------------- */

bool mpsi_csv_matches(mpsi_text text) {
  mpsi_slice line;
  while (text.line <= MPSI_RECORD_HEADER && mpsi_text_line(&text, &line)) {
    mpsi_slice_trim(&line);
    const char *comment = memchr(line.begin, '#', (size_t)mpsi_slice_size(line));
    if (comment) line.end = comment;
    if (mpsi_slice_size(line) > 0 && is_row(line)) return true;
  }
  return false;
}

/* Two columns without names: the first is time if it rises by the step that is given. */
static bool first_is_time(const csv *c, mpsi_slice row) {
  double a[2], b[2];
  int count;
  mpsi_text at = *c->text;
  mpsi_slice next;
  if (isnan(c->columns.step)) return true;
  if (!read_all(c, row, 2, a, &count)) return true;
  do {
    if (!mpsi_text_line(&at, &next)) return false;
    mpsi_slice_trim(&next);
  } while (mpsi_slice_size(next) == 0);
  return read_all(c, next, 2, b, &count) && count == 2 &&
         fabs(b[0] - a[0] - c->columns.step) <= SAME_STEP * c->columns.step;
}

/* What the columns are. *series: all numbers are values. */
static mps_status find_columns(csv *c, mpsi_slice row, bool sized, bool *series) {
  mpsi_columns *k = &c->columns;
  mpsi_slice cell[MPSI_RECORD_COLUMNS];
  bool named = false;
  k->count = mpsi_columns_split(row, c->layout, cell);
  k->time = -1, k->value = 0, k->second = 1.0;
  mps_status status = use_names(c, &named);
  *series = false;
  if (status != MPS_OK || named) return status;
  if (c->samples->def->column)
    return mpsi_text_fail(c->text, "column is \"%.40s\", but no line names the columns",
                          c->samples->def->column);
  if (k->count == 2 && first_is_time(c, row)) {
    k->time = 0, k->value = 1;
    if (sized && !c->samples->def->unit)
      return mpsi_text_fail(c->text,
                            "a file of this form names no unit (g of DEEPSOIL): give unit");
    return MPS_OK;
  }
  *series = !isnan(k->step);
  if (*series) return MPS_OK;
  if (k->count == 1)
    return mpsi_text_fail(c->text, "one column, and no step between its values: a line such as "
                                   "dt=0.01 before them, or step, says it");
  return mpsi_text_fail(c->text,
                        "without names two columns are expected, time and value: \"%s\" is left "
                        "over",
                        k->count > MPSI_RECORD_COLUMNS ? "..." : mpsi_slice_quote(cell[2]).text);
}

static mps_status check_read(const csv *c) {
  const mpsi_samples *s = c->samples;
  if (!isnan(c->header.count) && c->header.count != (double)s->count)
    return mpsi_text_fail(c->text, "the file has %lld values, its header announces %g",
                          (long long)s->count, c->header.count);
  if (s->count < 2 || c->columns.time < 0) return MPS_OK;
  double shortest = INFINITY, longest = 0.0, least = INFINITY, most = -INFINITY;
  for (int64_t i = 0; i < s->count; i++) {
    least = fmin(least, s->values[i]), most = fmax(most, s->values[i]);
    if (i == 0) continue;
    shortest = fmin(shortest, s->times[i] - s->times[i - 1]);
    longest = fmax(longest, s->times[i] - s->times[i - 1]);
  }
  const double mean = s->times[s->count - 1] / (double)(s->count - 1), step = c->columns.step;
  if (!isnan(step) && !(fabs(mean - step) <= SAME_STEP * step))
    return mpsi_text_fail(c->text, "the times are %g s apart in the mean, but step is %g s", mean,
                          step);
  if (s->def->quantity == MPS_SIGNAL_QUANTITY_ACCELERATION && s->count >= LONG && least >= 0.0 &&
      most > 0.0 && longest > UNEVEN * shortest)
    return mpsi_text_fail(c->text,
                          "values of one sign at uneven intervals: is this a response spectrum?");
  return MPS_OK;
}

static mps_status read_file(csv *c) {
  mpsi_slice row, comment;
  bool found, series, sized;
  mps_status status = read_header(c, &row, &found);
  if (status != MPS_OK || !found) return status;
  c->samples->unit = c->header.unit;
  c->layout = layout_of(row);
  sized = is_size(c, &row);
  c->columns.step = c->header.step;
  status = mpsi_header_step(c->text, c->samples, &c->columns.step);
  if (status == MPS_OK) status = find_columns(c, row, sized, &series);
  while (status == MPS_OK && found) {
    if (mpsi_slice_size(row) > 0) status = series ? read_series(c, row) : read_row(c, row);
    if (status == MPS_OK) status = next_line(c->text, &row, &comment, &found);
  }
  return status == MPS_OK ? check_read(c) : status;
}

mps_status mpsi_csv_read(mpsi_text *text, mpsi_samples *samples) {
  csv c = {.text = text, .samples = samples, .header = {.count = NAN, .step = NAN}};
  return read_file(&c);
}
