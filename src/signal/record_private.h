/* record_private.h - parsers of recorded motions. For the files record*.c (and their tests) only.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_RECORD_PRIVATE_H
#define MPSI_RECORD_PRIVATE_H

#include "core/base/text.h"

#include <mps/signal.h>

#define MPSI_RECORD_LIMIT (256 << 20) /* bytes of the largest file that is read */

/* Samples as they come. */
typedef struct mpsi_samples {
  int64_t count, capacity;
  double *times, *values; /* s from the first sample; SI units */
} mpsi_samples;
mps_status mpsi_samples_add(const mpsi_text *text, mpsi_samples *samples, double time,
                            double value);
void mpsi_samples_free(mps_context *context, mpsi_samples *samples);

/* One parser for each format: does the text look like it, and read it (m/s2, for a CSV as it
 * is). What was read before an error is left to the caller to free. */
bool mpsi_at2_matches(mpsi_text text);
mps_status mpsi_at2_read(mpsi_text *text, mpsi_samples *samples);
bool mpsi_knet_matches(mpsi_text text);
mps_status mpsi_knet_read(mpsi_text *text, mpsi_samples *samples);
bool mpsi_csv_matches(mpsi_text text);
mps_status mpsi_csv_read(mpsi_text *text, mpsi_samples *samples);

/* The signal of a text: mps_signal_create_record without the file. `def` is checked; NULL *out
 * before. */
mps_status mpsi_record_signal(mpsi_text *text, const mps_signal_record_def *def, mps_signal **out);

#endif
