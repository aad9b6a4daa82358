/* record_csv.c - two columns of text: time (s) and value, separated by blanks, a comma or a
 * semicolon. '#' begins a comment, empty lines are skipped, and one line of column names may come
 * before the first sample.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#include <string.h>

#define SEPARATORS ",;"

/* The next line that is not empty after its comment is cut off; begins with its first word. */
static bool next_line(mpsi_text *text, mpsi_slice *line) {
  while (mpsi_text_line(text, line)) {
    const char *comment = memchr(line->begin, '#', (size_t)mpsi_slice_size(*line));
    if (comment) line->end = comment;
    mpsi_slice_trim(line);
    if (mpsi_slice_size(*line) > 0) return true;
  }
  return false;
}

/* Names, not a malformed number: a broken first sample must not be skipped in silence. */
static bool is_names(mpsi_slice line) {
  const mpsi_slice word = mpsi_slice_word(&line, SEPARATORS);
  return mpsi_slice_size(word) > 0 && !strchr("+-.0123456789", *word.begin) &&
         !mpsi_slice_starts(word, "nan", NULL) && !mpsi_slice_starts(word, "inf", NULL);
}

static bool begins_with_number(const mpsi_text *text, mpsi_slice line) {
  double ignored;
  return mpsi_text_scan(text, line, &ignored) > 0;
}

bool mpsi_csv_matches(mpsi_text text) {
  mpsi_slice line;
  if (!next_line(&text, &line)) return false;
  if (is_names(line) && !next_line(&text, &line)) return false;
  return begins_with_number(&text, line);
}

static mps_status read_pair(const mpsi_text *text, mpsi_slice line, double *time, double *value) {
  mps_status status = mpsi_text_number(text, mpsi_slice_word(&line, SEPARATORS), "the time", time);
  if (status != MPS_OK) return status;
  mpsi_slice_trim(&line);
  if (mpsi_slice_size(line) > 0 && strchr(SEPARATORS, *line.begin)) line.begin++;
  status = mpsi_text_number(text, mpsi_slice_word(&line, SEPARATORS), "the value", value);
  if (status != MPS_OK) return status;
  mpsi_slice_trim(&line);
  if (mpsi_slice_size(line) == 0) return MPS_OK;
  return mpsi_text_fail(text, "two columns are expected (and a decimal point), \"%s\" is left over",
                        mpsi_slice_quote(line).text);
}

mps_status mpsi_csv_read(mpsi_text *text, mpsi_samples *samples) {
  mpsi_slice line;
  bool first = true;
  double start = 0.0, before = 0.0;
  while (next_line(text, &line)) {
    const bool names = first && is_names(line);
    first = false;
    if (names) continue;
    double time = 0.0, value = 0.0;
    mps_status status = read_pair(text, line, &time, &value);
    if (status != MPS_OK) return status;
    if (samples->count == 0) start = time;
    /* compared from the first time on, as the samples will be: nothing gets lost in rounding */
    if (samples->count > 0 && !(time - start > samples->times[samples->count - 1]))
      return mpsi_text_fail(text, "time %.17g s does not come after %.17g s", time, before);
    before = time;
    if (!isfinite(time - start))
      return mpsi_text_fail(text, "time %g s is too far from the first, %g s", time, start);
    if ((status = mpsi_samples_add(text, samples, time - start, value)) != MPS_OK) return status;
  }
  return MPS_OK;
}
