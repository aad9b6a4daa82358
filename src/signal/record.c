/* record.c - recorded motions: from a file to a table. Recognise the format, parse, scale, taper,
 * correct the baseline, integrate. The parsers are record_at2.c, record_knet.c and record_csv.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"
#include "signal_private.h"

static const mps_signal_record_def record_defaults = {
    .struct_size = sizeof(mps_signal_record_def),
    .format = MPS_SIGNAL_RECORD_AUTO,
    .quantity = MPS_SIGNAL_QUANTITY_ACCELERATION,
    .baseline = MPS_SIGNAL_BASELINE_LINEAR,
    .scale = 1.0,
};

mps_status mps_signal_record_def_init(mps_signal_record_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_signal_record_def, def, size, &record_defaults);
}

/* ---- formats --------------------------------------------------------------------------------- */

/* In the order of mps_signal_record_format; CSV, the least particular, is tried last. */
static const struct {
  bool (*matches)(mpsi_text text);
  mps_status (*read)(mpsi_text *text, mpsi_samples *samples);
} formats[] = {
    [MPS_SIGNAL_RECORD_AT2] = {mpsi_at2_matches, mpsi_at2_read},
    [MPS_SIGNAL_RECORD_KNET] = {mpsi_knet_matches, mpsi_knet_read},
    [MPS_SIGNAL_RECORD_CSV] = {mpsi_csv_matches, mpsi_csv_read},
};

static mps_status recognise(const mpsi_text *text, int32_t *format) {
  if (*format != MPS_SIGNAL_RECORD_AUTO) return MPS_OK;
  for (int32_t i = MPS_SIGNAL_RECORD_AT2; i <= MPS_SIGNAL_RECORD_CSV; i++)
    if (formats[i].matches(*text)) {
      *format = i;
      return MPS_OK;
    }
  mpsi_text first = *text;
  first.line = 1;
  return mpsi_text_fail(&first, "not recognised as AT2 (NPTS and DT on line 4), K-NET (begins with "
                                "\"Origin Time\") or CSV (time and value)");
}

/* ---- from samples to a signal ---------------------------------------------------------------- */

static mps_status scale_samples(const mpsi_text *text, mpsi_samples *samples, double scale) {
  for (int64_t i = 0; i < samples->count; i++) {
    samples->values[i] *= scale;
    if (!isfinite(samples->values[i]) || !isfinite(samples->times[i]))
      return mpsi_fail(text->context, text->function, MPS_ERROR_NUMERIC,
                       "sample %lld overflows: t = %g s, value %g with scale %g", (long long)i + 1,
                       samples->times[i], samples->values[i], scale);
  }
  return MPS_OK;
}

static mps_status condition(const mpsi_text *text, mpsi_samples *samples,
                            const mps_signal_record_def *def) {
  const double length = samples->times[samples->count - 1];
  if (def->taper > 0.5 * length)
    return mpsi_fail(text->context, text->function, MPS_ERROR_ARGUMENT,
                     "taper is %g s, must be at most half the record (%g s)", def->taper,
                     0.5 * length);
  mpsi_taper(samples->count, samples->times, samples->values, def->taper);
  return mpsi_baseline_correct(text->context, text->function, def->baseline, samples->count,
                               samples->times, samples->values);
}

static mps_status make_signal(mpsi_text *text, const mps_signal_record_def *def, int32_t format,
                              mpsi_samples *samples, mps_signal **out) {
  mps_status status = formats[format].read(text, samples);
  if (status != MPS_OK) return status;
  if (samples->count < 2)
    return mpsi_text_fail(text, "the file has %s, at least 2 are needed",
                          samples->count == 1 ? "1 sample" : "no samples");
  if ((status = scale_samples(text, samples, def->scale)) != MPS_OK) return status;
  const bool csv = format == MPS_SIGNAL_RECORD_CSV;
  const int32_t quantity = csv ? def->quantity : (int32_t)MPS_SIGNAL_QUANTITY_ACCELERATION;
  if (quantity == MPS_SIGNAL_QUANTITY_ACCELERATION)
    status = condition(text, samples, def);
  else if (def->taper > 0.0)
    status = mpsi_fail(text->context, text->function, MPS_ERROR_ARGUMENT,
                       "taper is %g s, must be 0 for a record of %s", def->taper,
                       quantity == MPS_SIGNAL_QUANTITY_VELOCITY ? "velocities" : "displacements");
  if (status != MPS_OK) return status;
  return mpsi_signal_from_table(text->context, text->function, quantity, samples->count,
                                samples->times, samples->values, out);
}

mps_status mpsi_record_signal(mpsi_text *text, const mps_signal_record_def *def, mps_signal **out) {
  int32_t format = def->format;
  mps_status status = recognise(text, &format);
  if (status != MPS_OK) return status;
  mpsi_samples samples = {0};
  status = make_signal(text, def, format, &samples, out);
  mpsi_samples_free(text->context, &samples);
  return status;
}

/* ---- the public function --------------------------------------------------------------------- */

static mps_status check_def(mps_context *context, const char *function,
                            const mps_signal_record_def *def) {
  if (def->format < MPS_SIGNAL_RECORD_AUTO || def->format > MPS_SIGNAL_RECORD_CSV)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "format is %d, allowed are 0 (recognised), 1 (AT2), 2 (K-NET), 3 (CSV)",
                     def->format);
  if (def->quantity < MPS_SIGNAL_QUANTITY_ACCELERATION ||
      def->quantity > MPS_SIGNAL_QUANTITY_DISPLACEMENT)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "quantity is %d, allowed are 0 (acceleration), 1 (velocity), 2 (displacement)",
                     def->quantity);
  if (def->baseline < MPS_SIGNAL_BASELINE_LINEAR || def->baseline > MPS_SIGNAL_BASELINE_CUBIC)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "baseline is %d, allowed are 0 (linear), 1 (none), 2 (mean), 3 (quadratic), "
                     "4 (cubic)",
                     def->baseline);
  if (!isfinite(def->scale) || def->scale == 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "scale is %g, must be finite and not 0",
                     def->scale);
  if (!isfinite(def->taper) || def->taper < 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "taper is %g s, must be finite and >= 0", def->taper);
  return MPS_OK;
}

mps_status mps_signal_create_record(mps_context *context, const char *path,
                                    const mps_signal_record_def *def, mps_signal **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!path) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "path is NULL");
  mps_signal_record_def known = record_defaults;
  mps_status status = MPS_OK;
  if (def) status = MPSI_DEF_READ(context, __func__, mps_signal_record_def, def, &known);
  if (status == MPS_OK) status = check_def(context, __func__, &known);
  if (status != MPS_OK) return status;
  mpsi_text text;
  status = mpsi_text_load(context, __func__, path, MPSI_RECORD_LIMIT, &text);
  if (status != MPS_OK) return status;
  status = mpsi_record_signal(&text, &known, out);
  mpsi_text_close(&text);
  return status;
}
