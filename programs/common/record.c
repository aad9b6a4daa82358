/* record.c - see record.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "record.h"

#include "options.h"

#include <stdio.h>
#include <string.h>

#define UNEVEN 1.5 /* longest over mean interval, above which a gap is likely */

const char *const record_units[] = {NULL, "m/s2", "g", "gal"};

static const char *format_of(const mps_signal_record_report *r) {
  static const char *const formats[] = {"", "AT2", "K-NET", "CSV", "SMC", "COSMOS"};
  return r->format > 0 && r->format <= MPS_SIGNAL_RECORD_FORMAT_COSMOS ? formats[r->format] : "";
}

static const char *si_of(const mps_signal_record_report *r) {
  static const char *const units[] = {"m/s2", "m/s", "m"};
  return units[r->quantity];
}

static void print(const char *path, const mps_signal_record_report *r) {
  printf("%s: %s, %lld values, step %.4g s, length %.6g s, peak %.4g %s", path, format_of(r),
         (long long)r->count, r->step, r->length, r->peak, si_of(r));
  if (r->unit[0] && r->factor != 1.0) printf(" (%.4g %s)", r->peak / r->factor, r->unit);
  printf("\n");
  fflush(stdout);
}

/* What the library asks for in its message, and the option that gives it, where there is one. */
static void hint(app *a, const char *name) {
  static const char *const words[][2] = {
      {"give unit", "unit"}, {"or step, says it", "step"}, {"which column", "column"}};
  const char *message = mps_context_error(a->context)->message;
  for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
    char option_name[40];
    snprintf(option_name, sizeof option_name, "%s-%s", name, words[k][1]);
    for (const option *o = options_read(); o && (o->name || o->help); o++)
      if (o->name && strcmp(o->name, option_name) == 0 && strstr(message, words[k][0]))
        app_warn(a, "--%s says it", option_name);
  }
}

mps_status record_read(app *a, const char *name, const char *path, const mps_signal_record_def *def,
                       mps_signal **out) {
  mps_signal_record_report r;
  mps_status status = mps_signal_create_record(a->context, path, def, out);
  if (status == MPS_ERROR_FORMAT) hint(a, name);
  if (status == MPS_OK) status = mps_signal_get_record(*out, &r);
  if (status != MPS_OK) return status;
  if (a->rank == 0) print(path, &r);
  if (!r.unit[0]) app_warn(a, "%s names no unit: its values are taken as %s", path, si_of(&r));
  if (r.gap > UNEVEN * r.step)
    app_warn(a, "%s has intervals of up to %.3g s, %.3g s in the mean: are samples missing?", path,
             r.gap, r.step);
  return MPS_OK;
}

void record_json(output *file, const mps_signal *signal) {
  mps_signal_record_report r;
  if (mps_signal_get_record(signal, &r) != MPS_OK) return;
  json_text(file, "record_format", format_of(&r));
  json_integer(file, "record_values", r.count);
  json_number(file, "record_step", r.step);
  json_number(file, "record_length", r.length);
  json_number(file, "record_peak", r.peak);
  json_text(file, "record_unit", r.unit[0] ? r.unit : si_of(&r));
}
