/* record_header.c - free lines before the samples of a record: number of samples, step and unit by
 * the words that writers use, "NPTS=  4000, DT= .0050 SEC", "# dt = 0.01 s", "Sampling Freq(Hz)
 * 100Hz", "IN UNITS OF G", "unit: gal".
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#include <string.h>

#define SAME_STEP 1e-3 /* relative: headers round */

static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/* As mpsi_slice_find, for a whole word. */
static bool find_word(mpsi_slice line, const char *name, mpsi_slice *after) {
  for (mpsi_slice rest = line, end; mpsi_slice_find(rest, name, &end); rest = end) {
    const char *begin = end.begin - strlen(name);
    if ((begin == line.begin || !is_letter(begin[-1])) &&
        (end.begin == line.end || !is_letter(*end.begin))) {
      *after = end;
      return true;
    }
  }
  return false;
}

/* The number behind a name: "= 4000", "(Hz) 100Hz", ",0.005". *rest: what follows it. */
static bool number_behind(const mpsi_text *text, mpsi_slice *rest, double *out) {
  mpsi_slice_trim(rest);
  if (mpsi_slice_size(*rest) > 0 && strchr("([", *rest->begin)) {
    while (rest->begin < rest->end && !strchr(")]", *rest->begin)) rest->begin++;
    if (rest->begin < rest->end) rest->begin++;
  }
  while (rest->begin < rest->end && strchr(" \t=:,;", *rest->begin)) rest->begin++;
  const int64_t length = mpsi_text_scan(text, *rest, out);
  rest->begin += length;
  return length > 0;
}

static void find_step(const mpsi_text *text, mpsi_slice line, mpsi_header *h) {
  static const char *const steps[] = {"dt",
                                      "delta t",
                                      "delta",
                                      "time step",
                                      "timestep",
                                      "time interval",
                                      "sample interval",
                                      "sampling interval",
                                      "sampling period"};
  static const char *const rates[] = {"sampling freq", "sampling frequency",
                                      "sampling rate", "sample rate",
                                      "sps",           "samples per second"};
  mpsi_slice rest;
  double number;
  for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
    if (!find_word(line, steps[i], &rest)) continue;
    const mpsi_slice behind = rest;
    if (!number_behind(text, &rest, &number)) continue;
    mpsi_slice_trim(&rest);
    const mpsi_unit *unit = mpsi_unit_find(mpsi_slice_word(&rest, ",;)]"));
    mpsi_slice named = behind; /* "dt (ms) = 5" */
    mpsi_slice_trim(&named);
    if (!unit && mpsi_slice_size(named) > 0 && strchr("([", *named.begin)) {
      named.begin++;
      unit = mpsi_unit_find(mpsi_slice_word(&named, ")]"));
    }
    h->step = number * (unit && unit->quantity == MPSI_UNIT_TIME ? unit->factor : 1.0);
    return;
  }
  for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
    if (find_word(line, rates[i], &rest) && number_behind(text, &rest, &number)) {
      h->step = 1.0 / number;
      return;
    }
}

/* "4000 0.005 NPTS, DT" */
static void find_size(const mpsi_text *text, mpsi_slice line, mpsi_header *h) {
  static const char *const names[] = {"npts", "number of points", "number of samples", "npoints"};
  mpsi_slice rest;
  double number[2];
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    if (!find_word(line, names[i], &rest)) continue;
    if (number_behind(text, &rest, &number[0])) {
      h->count = number[0];
      return;
    }
    rest = line;
    if (i == 0 && number_behind(text, &rest, &number[0]) &&
        number_behind(text, &rest, &number[1]) && find_word(rest, "dt", &rest))
      h->count = number[0], h->step = number[1];
    return;
  }
}

static mps_status unknown(const mpsi_text *text, mpsi_slice unit) {
  return mpsi_text_fail(text,
                        "the unit \"%s\" is not known: accelerations are in m/s2, g, gal, cm/s2, "
                        "mm/s2, ft/s2, velocities in m/s, cm/s, lengths in m, cm, mm, ft",
                        mpsi_slice_quote(unit).text);
}

/* The units behind "units of", "unit:", "[sec, g]" of which one is of time. */
static mps_status read_units(const mpsi_text *text, mpsi_slice rest, mpsi_header *h) {
  const mpsi_slice all = rest;
  bool some = false;
  while (rest.begin < rest.end) {
    while (rest.begin < rest.end && strchr(" \t=:,;([\"", *rest.begin)) rest.begin++;
    mpsi_slice part = {rest.begin, rest.begin};
    while (part.end < rest.end && !strchr(",;.)]|\"", *part.end)) part.end++;
    rest.begin = part.end < rest.end ? part.end + 1 : part.end;
    const mpsi_unit *unit = mpsi_unit_find(part);
    if (!unit) {
      const mpsi_slice word = mpsi_slice_word(&part, ",;");
      unit = mpsi_unit_find(word);
    }
    if (!unit) break;
    some = true;
    if (unit->quantity == MPSI_UNIT_TIME) continue;
    h->unit = unit;
    return MPS_OK;
  }
  if (some) return MPS_OK;
  mpsi_slice first = all;
  while (first.begin < first.end && strchr(" \t=:,;([\"", *first.begin)) first.begin++;
  const mpsi_slice word = mpsi_slice_word(&first, ",;)]");
  return mpsi_slice_size(word) > 0 ? unknown(text, word) : MPS_OK;
}

/* A unit in brackets, of a line about a series: "Acceleration time history (g)". */
static void find_bracket(mpsi_slice line, mpsi_header *h) {
  static const char *const peaks[] = {"max", "peak", "pga", "pgv", "pgd"};
  for (size_t i = 0; i < sizeof peaks / sizeof *peaks; i++)
    if (mpsi_slice_find(line, peaks[i], NULL)) return;
  if (!mpsi_slice_find(line, "acc", NULL) && !mpsi_slice_find(line, "vel", NULL) &&
      !mpsi_slice_find(line, "disp", NULL))
    return;
  for (const char *c = line.begin; c < line.end; c++) {
    if (!strchr("([", *c)) continue;
    mpsi_slice part = {c + 1, c + 1};
    while (part.end < line.end && !strchr(")]", *part.end)) part.end++;
    const mpsi_unit *unit = mpsi_unit_find(part);
    if (unit && unit->quantity != MPSI_UNIT_TIME) h->unit = unit;
  }
}

mps_status mpsi_header_line(const mpsi_text *text, mpsi_slice line, mpsi_header *h) {
  mpsi_slice rest;
  find_size(text, line, h);
  find_step(text, line, h);
  const bool units = mpsi_slice_find(line, "units of", &rest);
  if (units || mpsi_slice_find(line, "time series", NULL) ||
      mpsi_slice_find(line, "time history", NULL)) {
    h->velocity = h->velocity || mpsi_slice_find(line, "velocity", NULL);
    h->displacement = h->displacement || mpsi_slice_find(line, "displacement", NULL);
  }
  if (units) return read_units(text, rest, h);
  if (find_word(line, "unit", &rest) || find_word(line, "units", &rest)) {
    mpsi_slice_trim(&rest);
    if (mpsi_slice_size(rest) > 0 && strchr("=:,;([", *rest.begin))
      return read_units(text, rest, h);
  }
  find_bracket(line, h);
  return MPS_OK;
}

mps_status mpsi_header_step(const mpsi_text *text, const mpsi_samples *samples, double *step) {
  const double asked = samples->def->step;
  if (!isnan(*step) && !(*step > 0.0 && isfinite(*step)))
    return mpsi_text_fail(text, "the step is %g s, must be finite and > 0", *step);
  if (!isnan(*step) && !isnan(asked) && !(fabs(*step - asked) <= SAME_STEP * asked))
    return mpsi_text_fail(text, "step is %g s, but the file has %g s", asked, *step);
  if (isnan(*step)) *step = asked;
  return MPS_OK;
}

mps_status mpsi_header_size(const mpsi_text *text, const char *name, double count, double step) {
  if (!(count >= 2.0 && count <= MPSI_RECORD_SAMPLES) || count != floor(count))
    return mpsi_text_fail(text, "%s is %g, must be a whole number in 2 to %g", name, count,
                          (double)MPSI_RECORD_SAMPLES);
  if (!isfinite(step) || step <= 0.0)
    return mpsi_text_fail(text, "DT is %g s, must be finite and > 0", step);
  return MPS_OK;
}
