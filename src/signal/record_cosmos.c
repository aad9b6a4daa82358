/* record_cosmos.c - COSMOS files, volumes 1 and 2. The first line names the motion,
 *   Corrected acceleration   (Format v01.20 with 13 text lines) ...
 * and then come text, "100 Integer-header values follow on 10 lines, Format= (10I8)", "100
 * Real-header values follow on 17 lines, Format= (6F13.6)" of which number 34 is the step (s),
 * "2 Comment line(s) follow, each starting with a "|":", and
 *   4000 acceleration pts, approx 20 secs, units=cm/sec2 (04), Format=(8f10.5)
 * A file may contain velocities and displacements behind the accelerations, which alone are read.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#include <string.h>

#define STEP_AT 33 /* of the reals, from 0 */
#define LINES_MAX 400

bool mpsi_cosmos_matches(mpsi_text text) {
  mpsi_slice line;
  return mpsi_text_line(&text, &line) && mpsi_slice_find(line, "(Format v", NULL);
}

/* Characters of a number in a format such as (8f10.5), (8(1PE10.4E1)); 0: there is none. */
static int width_of(mpsi_slice line) {
  mpsi_slice rest;
  if (!mpsi_slice_find(line, "Format", &rest)) return 0;
  for (const char *c = rest.begin; c + 1 < rest.end; c++) {
    if (!strchr("fFeEgGiI", *c) || c[1] < '1' || c[1] > '9') continue;
    int width = 0;
    for (c++; c < rest.end && *c >= '0' && *c <= '9' && width < 1000; c++)
      width = 10 * width + (*c - '0');
    return width;
  }
  return 0;
}

/* The number before `what` in the line, "100 Real-header values". */
static bool count_before(const mpsi_text *text, mpsi_slice line, const char *what, double *out) {
  if (!mpsi_slice_find(line, what, NULL)) return false;
  mpsi_slice_trim(&line);
  return mpsi_text_scan(text, line, out) > 0;
}

/* Reads `count` numbers of `width` characters; *out: that of the place `at`. */
static mps_status read_numbers(mpsi_text *text, double count, int width, int at, double *out) {
  if (!(count >= 1.0 && count <= 10000.0) || width < 2)
    return mpsi_text_fail(text, "a number of values and their format are expected here");
  mpsi_slice line = {0};
  for (int k = 0; k < (int)count; k++) {
    if (mpsi_slice_size(line) == 0 && !mpsi_text_line(text, &line))
      return mpsi_text_fail(text, "the file ends within the header of a COSMOS file");
    mpsi_slice field = line;
    if (mpsi_slice_size(field) > width) field.end = field.begin + width;
    line.begin = field.end;
    if (k != at) continue;
    MPSI_TRY(mpsi_text_number(text, mpsi_slice_word(&field, ""), "the step of the header", out));
  }
  return MPS_OK;
}

static mps_status read_unit(const mpsi_text *text, mpsi_slice line, const mpsi_unit **out) {
  mpsi_slice unit;
  if (!mpsi_slice_find(line, "units=", &unit))
    return mpsi_text_fail(text, "units= is expected here");
  mpsi_slice_trim(&unit);
  mpsi_slice word = mpsi_slice_word(&unit, ",(");
  *out = mpsi_unit_find(word);
  if (*out && (*out)->quantity == MPS_SIGNAL_QUANTITY_ACCELERATION) return MPS_OK;
  return mpsi_text_fail(text, "the unit is \"%s\", one of acceleration is expected",
                        mpsi_slice_quote(word).text);
}

mps_status mpsi_cosmos_read(mpsi_text *text, mpsi_samples *samples) {
  mpsi_slice line = {0};
  double count = NAN, step = NAN;
  if (!mpsi_text_line(text, &line) || !mpsi_slice_find(line, "acceleration", NULL))
    return mpsi_text_fail(text, "\"%s\": a COSMOS file of accelerations is expected",
                          mpsi_slice_quote(line).text);
  for (;;) {
    if (text->line >= LINES_MAX || !mpsi_text_line(text, &line))
      return mpsi_text_fail(text, "no line with the number of points ends the header of a COSMOS "
                                  "file");
    const int width = width_of(line);
    mps_status status = MPS_OK;
    if (count_before(text, line, "Integer-header values", &count))
      status = read_numbers(text, count, width, -1, NULL);
    else if (count_before(text, line, "Real-header values", &count))
      status = read_numbers(text, count, width, STEP_AT, &step);
    else if (count_before(text, line, " pts,", &count))
      break;
    if (status != MPS_OK) return status;
  }
  if (isnan(step)) return mpsi_text_fail(text, "the header ends without its real values");
  MPSI_TRY(mpsi_header_size(text, "the number of points", count, step));
  MPSI_TRY(mpsi_header_step(text, samples, &step));
  MPSI_TRY(read_unit(text, line, &samples->unit));
  return mpsi_samples_read(text, samples, (int64_t)count, step, width_of(line), true);
}
