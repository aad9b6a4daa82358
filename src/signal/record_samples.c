/* record_samples.c - the samples of a recorded motion as its file is read.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"
#include "record_private.h"

#define FIRST_SAMPLES 4096

mps_status mpsi_samples_add(const mpsi_text *text, mpsi_samples *samples, double time,
                            double value) {
  if (samples->count == samples->capacity) {
    const int64_t wanted = samples->capacity > 0 ? 2 * samples->capacity : FIRST_SAMPLES;
    void *times = samples->times, *values = samples->values;
    bool grown = mpsi_grow(text->context, &times, samples->count, wanted, sizeof(double));
    samples->times = times;
    grown = grown && mpsi_grow(text->context, &values, samples->count, wanted, sizeof(double));
    samples->values = values;
    if (!grown)
      return mpsi_fail_memory(text->context, text->function, (size_t)wanted * sizeof(double));
    samples->capacity = wanted;
  }
  samples->times[samples->count] = time;
  samples->values[samples->count++] = value;
  return MPS_OK;
}

/* The next value: a word, or `width` characters; false at the end. */
static bool next_value(mpsi_text *text, mpsi_slice *line, int width, mpsi_slice *word) {
  if (width == 0) return mpsi_text_word(text, line, word);
  for (;;) {
    mpsi_slice field = {line->begin, line->end};
    if (mpsi_slice_size(field) > width) field.end = field.begin + width;
    line->begin = field.end;
    *word = mpsi_slice_word(&field, "");
    mpsi_slice_trim(&field);
    if (mpsi_slice_size(field) > 0) word->end = field.end; /* two numbers: refused as one */
    if (mpsi_slice_size(*word) > 0) return true;
    if (mpsi_slice_size(*line) == 0 && !mpsi_text_line(text, line)) return false;
  }
}

mps_status mpsi_samples_read(mpsi_text *text, mpsi_samples *samples, int64_t announced, double step,
                             int width, bool more) {
  mps_status status = MPS_OK;
  mpsi_slice line = {0}, word;
  while (status == MPS_OK && !(more && samples->count == announced) &&
         next_value(text, &line, width, &word)) {
    double value = 0.0;
    if (samples->count == announced)
      return mpsi_text_fail(text, "more values than the %lld that the header announces",
                            (long long)announced);
    status = mpsi_text_number(text, word, "the acceleration", &value);
    if (status == MPS_OK)
      status = mpsi_samples_add(text, samples, (double)samples->count * step, value);
  }
  if (status == MPS_OK && samples->count < announced)
    return mpsi_text_fail(text, "the file ends after %lld values, the header announces %lld",
                          (long long)samples->count, (long long)announced);
  return status;
}

void mpsi_samples_free(mps_context *context, mpsi_samples *samples) {
  MPSI_FREE(context, samples->times, samples->values);
  *samples = (mpsi_samples){0};
}
