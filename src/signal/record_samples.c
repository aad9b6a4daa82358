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

void mpsi_samples_free(mps_context *context, mpsi_samples *samples) {
  mpsi_free(context, samples->times);
  mpsi_free(context, samples->values);
  *samples = (mpsi_samples){0};
}
