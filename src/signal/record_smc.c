/* record_smc.c - SMC files of the U.S. Geological Survey. Eleven lines of text, the first of which
 * is "2 CORRECTED ACCELEROGRAM" or of another kind; 48 integers of 10 characters, of which number
 * 16 counts the comment lines and 17 the samples; 50 reals of 15 characters, of which number 2 is
 * the sampling rate; the comments, each behind a "|"; then accelerations in cm/s2, 10 characters
 * each.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#define TEXT_LINES 11
#define INTEGER_LINES 6
#define REAL_LINES 10
#define INTEGER_WIDTH 10
#define REAL_WIDTH 15
#define VALUE_WIDTH 10
#define IN_LINE 8 /* integers; 5 reals */
#define COMMENTS_MAX 10000

/* "2 CORRECTED ACCELEROGRAM", some writers have a "*" or blanks before it; the kind behind the
 * digit. */
static bool kind_of(mpsi_slice line, mpsi_slice *kind) {
  while (line.begin < line.end && (*line.begin == '*' || *line.begin == ' ')) line.begin++;
  if (mpsi_slice_size(line) < 3 || *line.begin < '0' || *line.begin > '9' || line.begin[1] != ' ')
    return false;
  line.begin++;
  mpsi_slice_trim(&line);
  *kind = line;
  return mpsi_slice_find(line, "ACCELEROGRAM", NULL) || mpsi_slice_starts(line, "VELOCITY", NULL) ||
         mpsi_slice_starts(line, "DISPLACEMENT", NULL) ||
         mpsi_slice_starts(line, "RESPONSE SPECTR", NULL);
}

bool mpsi_smc_matches(mpsi_text text) {
  mpsi_slice line, kind;
  return mpsi_text_line(&text, &line) && kind_of(line, &kind);
}

/* Number `k` from 0 of `lines` lines of numbers of `width` characters, `each` on a line. */
static mps_status pick(mpsi_text *text, int lines, int width, int each, int count, const int *k,
                       double *out) {
  for (int n = 0; n < lines; n++) {
    mpsi_slice line;
    if (!mpsi_text_line(text, &line))
      return mpsi_text_fail(text, "the file ends within the header of an SMC file");
    for (int i = 0; i < count; i++) {
      if (k[i] / each != n) continue;
      mpsi_slice field = {line.begin + (int64_t)(k[i] % each) * width, line.end};
      if (field.begin > line.end) field.begin = line.end;
      if (mpsi_slice_size(field) > width) field.end = field.begin + width;
      MPSI_TRY(mpsi_text_number(text, mpsi_slice_word(&field, ""), "the header's number", &out[i]));
    }
  }
  return MPS_OK;
}

mps_status mpsi_smc_read(mpsi_text *text, mpsi_samples *samples) {
  static const char unit[] = "cm/s2";
  static const int wanted[] = {15, 16}, rate_at = 1;
  mpsi_slice line = {0}, kind;
  if (!mpsi_text_line(text, &line) || !kind_of(line, &kind))
    return mpsi_text_fail(text, "an SMC file begins with a line such as \"2 CORRECTED "
                                "ACCELEROGRAM\"");
  if (!mpsi_slice_find(kind, "ACCELEROGRAM", NULL))
    return mpsi_text_fail(text, "\"%s\": an SMC file of accelerations is expected",
                          mpsi_slice_quote(kind).text);
  for (int i = 1; i < TEXT_LINES; i++)
    if (!mpsi_text_line(text, &line))
      return mpsi_text_fail(text, "the file ends within the header of an SMC file");
  double number[2] = {0.0}, rate = 0.0;
  MPSI_TRY(pick(text, INTEGER_LINES, INTEGER_WIDTH, IN_LINE, 2, wanted, number));
  MPSI_TRY(pick(text, REAL_LINES, REAL_WIDTH, 5, 1, &rate_at, &rate));
  if (!(number[0] >= 0.0 && number[0] <= COMMENTS_MAX))
    return mpsi_text_fail(text, "the header has %g lines of comments", number[0]);
  if (!(rate > 0.0 && rate < 1e9))
    return mpsi_text_fail(text, "the sampling rate of the header is %g, a number > 0 is expected",
                          rate);
  double step = 1.0 / rate;
  mps_status status =
      mpsi_header_size(text, "the number of samples in the header", number[1], step);
  if (status == MPS_OK) status = mpsi_header_step(text, samples, &step);
  for (int i = 0; status == MPS_OK && i < (int)number[0]; i++)
    if (!mpsi_text_line(text, &line) || mpsi_slice_size(line) == 0 || *line.begin != '|')
      return mpsi_text_fail(text, "a comment behind a \"|\" is expected, %g of them are announced",
                            number[0]);
  if (status != MPS_OK) return status;
  samples->unit = mpsi_unit_find((mpsi_slice){unit, unit + sizeof unit - 1});
  return mpsi_samples_read(text, samples, (int64_t)number[1], step, VALUE_WIDTH, false);
}
