/* record_knet.c - K-NET and KiK-net ASCII files. Seventeen header lines, each a name and a value,
 * end with the one named "Memo."; of them these count, found by their names:
 *   Sampling Freq(Hz) 100Hz
 *   Duration Time(s)  60
 *   Scale Factor      3920(gal)/6182761
 * Then come whole numbers, acceleration = number * 3920/6182761 gal, 1 gal = 0.01 m/s2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"

#define HEADER_LINES_MAX 64  /* some writers add lines */
#define COUNT_MAX 2147483648 /* of an instrument of at most 32 bits */

typedef struct header {
  double frequency, duration, scale; /* Hz; s, 0 where not given; gal for each count */
} header;

bool mpsi_knet_matches(mpsi_text text) {
  mpsi_slice line, after;
  return mpsi_text_line(&text, &line) && mpsi_slice_starts(line, "Origin Time", &after) &&
         !mpsi_slice_starts(after, ",", NULL); /* of a table with such lines before it */
}

/* The value of a header line that begins with `name` and perhaps a unit, as in "Duration Time(s)".
 */
static bool field(mpsi_slice line, const char *name, mpsi_slice *value) {
  if (!mpsi_slice_starts(line, name, value)) return false;
  if (mpsi_slice_starts(*value, "(", NULL) && !mpsi_slice_find(*value, ")", value)) return false;
  mpsi_slice_trim(value);
  return true;
}

/* A finite number > 0 at the start of *value, which is taken away. */
static mps_status positive(const mpsi_text *text, const char *name, mpsi_slice *value,
                           double *out) {
  mpsi_slice_trim(value);
  const int64_t length = mpsi_text_scan(text, *value, out);
  if (length == 0 || !isfinite(*out) || *out <= 0.0)
    return mpsi_text_fail(text, "%s is \"%s\", a number > 0 is expected", name,
                          mpsi_slice_quote(*value).text);
  value->begin += length;
  return MPS_OK;
}

static mps_status read_scale(const mpsi_text *text, mpsi_slice value, double *scale) {
  double gal = 0.0, counts = 0.0;
  mps_status status = positive(text, "Scale Factor", &value, &gal);
  if (status != MPS_OK) return status;
  const mpsi_slice unit = mpsi_slice_word(&value, "/");
  mpsi_slice_trim(&value);
  if (mpsi_slice_size(unit) != 5 || !mpsi_slice_starts(unit, "(gal)", NULL) ||
      !mpsi_slice_starts(value, "/", &value))
    return mpsi_text_fail(text, "the unit of Scale Factor is \"%s\", (gal)/counts is expected",
                          mpsi_slice_quote(unit).text);
  if ((status = positive(text, "the divisor of Scale Factor", &value, &counts)) != MPS_OK)
    return status;
  *scale = gal / counts;
  if (!isfinite(*scale) || *scale <= 0.0)
    return mpsi_text_fail(text, "Scale Factor is %g/%g, outside the range of a double", gal,
                          counts);
  return MPS_OK;
}

static mps_status read_header(mpsi_text *text, header *out) {
  mpsi_slice line, value;
  mps_status status = MPS_OK;
  for (;;) {
    if (text->line == HEADER_LINES_MAX || !mpsi_text_line(text, &line))
      return mpsi_text_fail(text, "no \"Memo.\" line ends the header of a K-NET file");
    if (field(line, "Memo", &value)) break;
    if (field(line, "Sampling Freq", &value))
      status = positive(text, "Sampling Freq", &value, &out->frequency);
    else if (field(line, "Duration Time", &value))
      status = positive(text, "Duration Time", &value, &out->duration);
    else if (field(line, "Scale Factor", &value))
      status = read_scale(text, value, &out->scale);
    if (status != MPS_OK) return status;
  }
  if (out->frequency == 0.0 || out->scale == 0.0)
    return mpsi_text_fail(text, "the header ends without \"%s\"",
                          out->frequency == 0.0 ? "Sampling Freq" : "Scale Factor");
  if (!isfinite(1.0 / out->frequency))
    return mpsi_text_fail(text, "Sampling Freq is %g Hz, too small", out->frequency);
  return MPS_OK;
}

/* The duration is given in whole seconds: up to one more second of samples may follow. */
static mps_status check_duration(const mpsi_text *text, const header *h, int64_t count) {
  const double announced = h->duration * h->frequency;
  if (h->duration == 0.0 ||
      ((double)count > announced - 0.5 && (double)count < announced + fmax(h->frequency, 0.5)))
    return MPS_OK;
  return mpsi_text_fail(text, "the file has %lld values, %g s at %g Hz announce %g",
                        (long long)count, h->duration, h->frequency, announced);
}

mps_status mpsi_knet_read(mpsi_text *text, mpsi_samples *samples) {
  static const char gal[] = "gal";
  header h = {0};
  mps_status status = read_header(text, &h);
  double step = 1.0 / h.frequency;
  if (status == MPS_OK) status = mpsi_header_step(text, samples, &step);
  samples->unit = mpsi_unit_find((mpsi_slice){gal, gal + 3});
  mpsi_slice line = {0}, word;
  while (status == MPS_OK && mpsi_text_word(text, &line, &word)) {
    double counts = 0.0;
    status = mpsi_text_number(text, word, "the count", &counts);
    if (status == MPS_OK && (counts != floor(counts) || fabs(counts) > COUNT_MAX))
      return mpsi_text_fail(text,
                            "the count is \"%s\", a whole number of at most 32 bits is expected",
                            mpsi_slice_quote(word).text);
    if (status == MPS_OK)
      status =
          mpsi_samples_add(text, samples, (double)samples->count / h.frequency, counts * h.scale);
  }
  return status == MPS_OK ? check_duration(text, &h, samples->count) : status;
}
