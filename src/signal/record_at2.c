/* record_at2.c - PEER strong motion files (.AT2). Four header lines; the fourth holds the number
 * of samples and the step, in one of the spellings
 *   NPTS=  4000, DT= .0050 SEC        4000 0.005 NPTS, DT
 * and then come NPTS accelerations in g, any number of them on a line.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#define STANDARD_GRAVITY 9.80665 /* m/s2 */
#define HEADER_LINES 4
#define SAMPLES_MAX 1e9

bool mpsi_at2_matches(mpsi_text text) {
  mpsi_slice line;
  for (int i = 0; i < HEADER_LINES; i++)
    if (!mpsi_text_line(&text, &line)) return false;
  return mpsi_slice_find(line, "NPTS", NULL) && mpsi_slice_find(line, "DT", NULL);
}

/* The files of velocities (.VT2) and displacements (.DT2) look the same but for this line. */
static mps_status check_units(const mpsi_text *text, mpsi_slice line) {
  mpsi_slice unit;
  const mpsi_quote quote = mpsi_slice_quote(line);
  if (mpsi_slice_find(line, "VELOCITY", NULL) || mpsi_slice_find(line, "DISPLACEMENT", NULL))
    return mpsi_text_fail(text, "\"%s\": an AT2 file of accelerations is expected", quote.text);
  if (!mpsi_slice_find(line, "UNITS OF", &unit)) return MPS_OK;
  unit = mpsi_slice_word(&unit, ",;.");
  if (mpsi_slice_size(unit) == 1 && mpsi_slice_starts(unit, "G", NULL)) return MPS_OK;
  return mpsi_text_fail(text, "the unit is \"%s\", only g is expected in an AT2 file",
                        mpsi_slice_quote(unit).text);
}

/* NAME= number, anywhere in the line. */
static bool named_number(const mpsi_text *text, mpsi_slice line, const char *name, double *out) {
  mpsi_slice after;
  if (!mpsi_slice_find(line, name, &after)) return false;
  mpsi_slice_trim(&after);
  if (!mpsi_slice_starts(after, "=", &after)) return false;
  mpsi_slice_trim(&after);
  return mpsi_text_scan(text, after, out) > 0;
}

/* The next word, if it is a number. */
static bool word_number(const mpsi_text *text, mpsi_slice *rest, double *out) {
  const mpsi_slice word = mpsi_slice_word(rest, ",");
  return mpsi_slice_size(word) > 0 && mpsi_text_scan(text, word, out) == mpsi_slice_size(word);
}

static mps_status read_size(const mpsi_text *text, mpsi_slice line, int64_t *count, double *step) {
  double npts = 0.0;
  mpsi_slice rest = line;
  const bool found =
      (named_number(text, line, "NPTS", &npts) && named_number(text, line, "DT", step)) ||
      (word_number(text, &rest, &npts) && word_number(text, &rest, step));
  if (!found)
    return mpsi_text_fail(text, "\"%s\": NPTS= and DT= with their numbers are expected here",
                          mpsi_slice_quote(line).text);
  if (!(npts >= 2.0 && npts <= SAMPLES_MAX) || npts != floor(npts))
    return mpsi_text_fail(text, "NPTS is %g, must be a whole number in 2..%g", npts, SAMPLES_MAX);
  if (!isfinite(*step) || *step <= 0.0)
    return mpsi_text_fail(text, "DT is %g s, must be finite and > 0", *step);
  *count = (int64_t)npts;
  return MPS_OK;
}

static mps_status read_header(mpsi_text *text, int64_t *count, double *step) {
  mpsi_slice line = {0};
  mps_status status = MPS_OK;
  for (int i = 1; i <= HEADER_LINES && status == MPS_OK; i++) {
    if (!mpsi_text_line(text, &line))
      return mpsi_text_fail(text, "the file ends within the %d header lines of an AT2 file",
                            HEADER_LINES);
    if (i == 3) status = check_units(text, line);
  }
  return status == MPS_OK ? read_size(text, line, count, step) : status;
}

mps_status mpsi_at2_read(mpsi_text *text, mpsi_samples *samples) {
  int64_t announced = 0;
  double step = 0.0;
  mps_status status = read_header(text, &announced, &step);
  mpsi_slice line = {0}, word;
  while (status == MPS_OK && mpsi_text_word(text, &line, &word)) {
    double value = 0.0;
    if (samples->count == announced)
      return mpsi_text_fail(text, "more values than the %lld that NPTS announces",
                            (long long)announced);
    status = mpsi_text_number(text, word, "the acceleration", &value);
    if (status == MPS_OK)
      status =
          mpsi_samples_add(text, samples, (double)samples->count * step, value * STANDARD_GRAVITY);
  }
  if (status == MPS_OK && samples->count < announced)
    return mpsi_text_fail(text, "the file ends after %lld values, NPTS announces %lld",
                          (long long)samples->count, (long long)announced);
  return status;
}
