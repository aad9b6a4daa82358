/* record.c - recorded motions: from a file to a table. Recognise the format, parse, scale, taper,
 * correct the baseline, integrate. The parsers are record_at2.c, record_knet.c, record_smc.c,
 * record_cosmos.c and record_csv.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record_private.h"
#include "signal_private.h"

#include <string.h>

/* ---- formats --------------------------------------------------------------------------------- */

/* By mps_signal_record_format; CSV, the least particular, is tried last. */
static const struct {
  bool (*matches)(mpsi_text text);
  mps_status (*read)(mpsi_text *text, mpsi_samples *samples);
} formats[] = {
    [MPS_SIGNAL_RECORD_FORMAT_AT2] = {mpsi_at2_matches, mpsi_at2_read},
    [MPS_SIGNAL_RECORD_FORMAT_KNET] = {mpsi_knet_matches, mpsi_knet_read},
    [MPS_SIGNAL_RECORD_FORMAT_CSV] = {mpsi_csv_matches, mpsi_csv_read},
    [MPS_SIGNAL_RECORD_FORMAT_SMC] = {mpsi_smc_matches, mpsi_smc_read},
    [MPS_SIGNAL_RECORD_FORMAT_COSMOS] = {mpsi_cosmos_matches, mpsi_cosmos_read},
};

static mps_status recognise(const mpsi_text *text, int32_t *format) {
  static const int32_t order[] = {MPS_SIGNAL_RECORD_FORMAT_KNET, MPS_SIGNAL_RECORD_FORMAT_SMC,
                                  MPS_SIGNAL_RECORD_FORMAT_COSMOS, MPS_SIGNAL_RECORD_FORMAT_AT2,
                                  MPS_SIGNAL_RECORD_FORMAT_CSV};
  if (*format != MPS_SIGNAL_RECORD_FORMAT_AUTO) return MPS_OK;
  for (size_t i = 0; i < sizeof order / sizeof *order; i++)
    if (formats[order[i]].matches(*text)) {
      *format = order[i];
      return MPS_OK;
    }
  mpsi_text first = *text;
  first.line = 1;
  return mpsi_text_fail(&first, "not recognised as AT2 (NPTS and DT in its header), K-NET (begins "
                                "with \"Origin Time\"), SMC, COSMOS or CSV (time and value)");
}

/* ---- from samples to a signal ---------------------------------------------------------------- */

/* The unit of the values: the one asked for where the file has none. */
static mps_status settle_unit(const mpsi_text *text, mpsi_samples *samples, int32_t quantity) {
  const mps_signal_record_def *def = samples->def;
  const mpsi_unit *asked = NULL, *found = samples->unit;
  if (found && found->quantity != quantity)
    return mpsi_text_fail(text, "the unit of the values is %s, one of %s is expected", found->name,
                          quantity == MPS_SIGNAL_QUANTITY_ACCELERATION ? "acceleration"
                          : quantity == MPS_SIGNAL_QUANTITY_VELOCITY   ? "velocity"
                                                                       : "length");
  if (def->unit) asked = mpsi_unit_find((mpsi_slice){def->unit, def->unit + strlen(def->unit)});
  if (asked && found && asked->factor != found->factor)
    return mpsi_text_fail(text, "unit is %s, but the file says %s", asked->name, found->name);
  if (found && found->factor != 1.0 && !asked && def->scale == found->factor)
    return mpsi_text_fail(text,
                          "the file says %s, which is converted: scale %g would convert once more, "
                          "leave it 1",
                          found->name, def->scale);
  if (!found) samples->unit = asked;
  return MPS_OK;
}

static mps_status scale_samples(const mpsi_text *text, mpsi_samples *samples, double unit,
                                double scale) {
  for (int64_t i = 0; i < samples->count; i++) {
    samples->values[i] *= unit;
    samples->values[i] *= scale;
    if (!isfinite(samples->values[i]))
      return mpsi_fail(text->context, text->function, MPS_ERROR_NUMERIC,
                       "sample %lld overflows: t = %g s, value %g with scale %g", (long long)i + 1,
                       samples->times[i], samples->values[i], scale);
    if (!(fabs(samples->times[i]) <= MPSI_SIGNAL_LATEST))
      return mpsi_fail(text->context, text->function, MPS_ERROR_NUMERIC,
                       "sample %lld is at t = %g s, must be within 1e15 s", (long long)i + 1,
                       samples->times[i]);
  }
  return MPS_OK;
}

static mps_signal_record_report report_of(const mpsi_samples *samples, int32_t format,
                                          int32_t quantity) {
  mps_signal_record_report r = {.format = format, .quantity = quantity, .count = samples->count};
  r.factor = samples->unit ? samples->unit->factor : 1.0;
  r.unit = samples->unit ? samples->unit->name : "";
  r.length = samples->times[samples->count - 1];
  r.step = r.length / (double)(samples->count - 1);
  for (int64_t i = 0; i < samples->count; i++) {
    r.peak = fmax(r.peak, fabs(samples->values[i]) * r.factor);
    if (i > 0) r.gap = fmax(r.gap, samples->times[i] - samples->times[i - 1]);
  }
  return r;
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

static mps_status make_signal(mpsi_text *text, int32_t format, mpsi_samples *samples,
                              mps_signal **out) {
  const mps_signal_record_def *def = samples->def;
  mps_status status = formats[format].read(text, samples);
  if (status != MPS_OK) return status;
  if (samples->count < 2)
    return mpsi_text_fail(text, "the file has %s, at least 2 are needed",
                          samples->count == 1 ? "1 sample" : "no samples");
  const bool csv = format == MPS_SIGNAL_RECORD_FORMAT_CSV;
  const int32_t quantity = csv ? def->quantity : (int32_t)MPS_SIGNAL_QUANTITY_ACCELERATION;
  if ((status = settle_unit(text, samples, quantity)) != MPS_OK) return status;
  const mps_signal_record_report report = report_of(samples, format, quantity);
  if ((status = scale_samples(text, samples, report.factor, def->scale)) != MPS_OK) return status;
  if (quantity == MPS_SIGNAL_QUANTITY_ACCELERATION)
    status = condition(text, samples, def);
  else if (def->taper > 0.0)
    status = mpsi_fail(text->context, text->function, MPS_ERROR_ARGUMENT,
                       "taper is %g s, must be 0 for a record of %s", def->taper,
                       quantity == MPS_SIGNAL_QUANTITY_VELOCITY ? "velocities" : "displacements");
  if (status != MPS_OK) return status;
  status = mpsi_signal_from_table(text->context, text->function, quantity, samples->count,
                                  samples->times, samples->values, out);
  if (status == MPS_OK) (*out)->record = report;
  return status;
}

mps_status mpsi_record_signal(mpsi_text *text, const mps_signal_record_def *def, mps_signal **out) {
  int32_t format = def->format;
  MPSI_TRY(recognise(text, &format));
  mpsi_samples samples = {.def = def};
  mps_status status = make_signal(text, format, &samples, out);
  mpsi_samples_free(text->context, &samples);
  return status;
}

/* ---- the public function --------------------------------------------------------------------- */

static mps_status check_scale_and_unit(mps_context *context, const char *function,
                                       const mps_signal_record_def *def) {
  if (def->scale == 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "scale is 0, must be finite and not 0");
  if (!def->unit) return MPS_OK;
  const mpsi_slice name = {def->unit, def->unit + strlen(def->unit)};
  const mpsi_unit *unit = mpsi_unit_find(name);
  if (unit && unit->quantity == def->quantity) return MPS_OK;
  char known[120];
  mpsi_unit_list(def->quantity, known, sizeof known);
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "unit is \"%s\", allowed are %s",
                   mpsi_slice_quote(name).text, known);
}

mps_status mps_signal_create_record(mps_context *context, const char *path,
                                    const mps_signal_record_def *def, mps_signal **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!path) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "path is NULL");
  mps_signal_record_def known;
  MPSI_TRY(MPSI_DEF_READ_OR_DEFAULTS(context, __func__, mps_signal_record_def, def, &known));
  MPSI_TRY(check_scale_and_unit(context, __func__, &known));
  mpsi_text text;
  MPSI_TRY(mpsi_text_load(context, __func__, path, MPSI_RECORD_LIMIT, &text));
  mps_status status = mpsi_record_signal(&text, &known, out);
  mpsi_text_close(&text);
  return status;
}

mps_status mps_signal_get_record_sized(const mps_signal *signal, mps_signal_record_report *out,
                                       size_t size) {
  if (!signal) return mpsi_null(__func__, "signal");
  if (out && signal->record.count == 0)
    return mpsi_fail(signal->context, __func__, MPS_ERROR_STATE,
                     "the signal is not of mps_signal_create_record");
  return mpsi_out_write(signal->context, __func__, out, size, &signal->record,
                        sizeof signal->record);
}
