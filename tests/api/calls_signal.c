/* calls_signal.c - signals, recorded motions in files that may be damaged, and couplings.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls.h"

#include <mps/experimental/coupling.h>
#include <mps/signal.h>

#include <float.h>
#include <stdio.h>
#include <stdlib.h>

/* A motion, or a number. */
static int32_t draw_quantity(api *a) {
  const int32_t quantity = api_choice(a, "quantity", 2);
  return quantity >= 0 && quantity < 2 ? quantity + MPS_SIGNAL_QUANTITY_DISPLACEMENT : -1;
}

#define DRAW_ricker (void)0
#define OF_ricker
#define DRAW_sine const int32_t quantity = draw_quantity(a)
#define OF_sine quantity,
#define DRAW_ramp const int32_t quantity = draw_quantity(a)
#define OF_ramp quantity,

/* A signal of three numbers, each drawn by `draw_...`. */
#define SIGNAL_OF_THREE(name, x, draw_x, y, draw_y, z, draw_z)                                     \
  static void signal_##name(api *a) {                                                              \
    mps_signal *made = NULL;                                                                       \
    mps_context *context = api_context(a);                                                         \
    DRAW_##name;                                                                                   \
    const double x = draw_x, y = draw_y, z = draw_z;                                               \
    mps_signal **out = api_null(a, "out") ? NULL : &made;                                          \
    const mps_status status = mps_signal_create_##name(context, OF_##name x, y, z, out);           \
    (void)api_end_made(a, status, API_SIGNAL, made, NULL);                                         \
  }
SIGNAL_OF_THREE(ricker, frequency, api_real(a, "frequency", 1e-9, 1e9, 20.0), peak,
                api_real(a, "peak_time", 0.0, DBL_MAX, 0.05), amplitude,
                api_near(a, "amplitude", 0.0, 1.0))
SIGNAL_OF_THREE(sine, frequency, api_real(a, "frequency", 1e-9, 1e9, 10.0), amplitude,
                api_near(a, "amplitude", 0.0, 0.01), phase, api_near(a, "phase", 0.0, 3.0))
SIGNAL_OF_THREE(ramp, start, api_near(a, "start", 0.0, 0.1), duration,
                api_real(a, "duration", 5e-324, DBL_MAX, 0.5), amplitude,
                api_near(a, "amplitude", 0.0, 0.01))

static void signal_table(api *a) {
  double times[6], values[6];
  mps_signal *made = NULL;
  mps_context *context = api_context(a);
  const int32_t quantity = api_choice(a, "quantity", 5);
  const int64_t count = api_least(a, "count", 2, 6);
  const double start = api_chance(a, 70) ? 0.0 : -0.1;
  for (int k = 0; k < 6; k++) {
    if (k >= count) a->mood = API_VALID;
    times[k] = api_near(a, "t", start + 0.05 * k, 0.02);
    values[k] = api_near(a, "", 0.0, 0.01);
  }
  const bool none = api_null(a, "times");
  const mps_status status = mps_signal_create_table(context, quantity, count, none ? NULL : times,
                                                    values, api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_SIGNAL, made, NULL);
}

static void signal_user(api *a) {
  mps_signal *made = NULL;
  mps_context *context = api_context(a);
  const int32_t quantity = draw_quantity(a);
  const mps_signal_fn some = quantity == MPS_SIGNAL_QUANTITY_VALUE ? api_number : api_motion;
  const mps_signal_fn fn = api_null(a, "fn") ? NULL : some;
  const mps_status status = mps_signal_create_user(context, quantity, fn, &a->plan, NULL,
                                                   api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_SIGNAL, made, NULL);
}

mps_signal *api_signal(api *a, bool number) {
  mps_signal *signal = api_maybe(a, API_SIGNAL, "signal");
  const bool fits = signal && isnan(mps_signal_value(signal, 0.0)) != number;
  return fits || a->mood == API_ABSURD ? signal : NULL;
}

/* A record of a usual form, with some damage. */
static void write_record(api *a, const char *path) {
  char text[600];
  size_t length = (size_t)snprintf(text, sizeof text, "time,acceleration\n");
  const int lines = 2 + (int)api_below(a, 12);
  for (int k = 0; k < lines; k++)
    length += (size_t)snprintf(text + length, sizeof text - length, "%g,%g\n", 0.01 * k,
                               api_unit(a) - 0.5);
  if (a->mood == API_ABSURD)
    for (int k = 0; k < 3; k++) text[api_below(a, (uint32_t)length)] = (char)api_below(a, 256);
  if (a->mood == API_ABSURD && api_chance(a, 50)) length = api_below(a, (uint32_t)length);
  FILE *file = fopen(path, "wb");
  if (!file) return;
  (void)!fwrite(text, 1, length, file);
  (void)fclose(file);
  api_record_file(path, text, length);
}

static void signal_record(api *a) {
  char path[300];
  mps_signal *made = NULL;
  mps_context *context = api_context(a);
  mps_signal_record_def def = mps_signal_record_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  if (api_chance(a, 50)) {
    def.format = api_choice(a, "format", 6);
    def.quantity = api_choice(a, "quantity", 3);
    def.baseline = api_choice(a, "baseline", 5);
    if (def.quantity != MPS_SIGNAL_QUANTITY_ACCELERATION && def.baseline < 0) a->wrong = 0;
    def.scale = api_near(a, "scale", 1.0, 0.5);
    def.taper = api_real(a, "taper", 0.0, 1e300, 0.01);
    a->wrong = 0; /* some are not read with others */
  }
  snprintf(path, sizeof path, "%s/record.csv", a->folder);
  write_record(a, path);
  if (a->mood == API_ABSURD && api_chance(a, 10)) {
    snprintf(path, sizeof path, "%s/no/such", a->folder);
    api_wrong(a, "path");
  }
  const bool none = api_null(a, "path");
  const mps_status status = mps_signal_create_record(context, none ? NULL : path, &def,
                                                     api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_SIGNAL, made, NULL);
}

/* Of a signal that is not of a file MPS_ERROR_STATE. */
static void signal_get_record_sized(api *a) {
  const mps_signal *signal = api_any(a, API_SIGNAL)->handle;
  API_SIZED(a, mps_signal_record_report, size, out);
  const mps_status status =
      mps_signal_get_record_sized(signal, api_null(a, "out") ? NULL : out, size);
  API_SIZED_END(a, status, size, out, true);
}

API_DESTROY(signal_destroy, API_SIGNAL)

static void signal_values(api *a) {
  const mps_signal *signal = api_any(a, API_SIGNAL)->handle;
  const double t = api_near(a, "t", 0.1, 0.5);
  const double u = mps_signal_displacement(signal, t);
  if (isinf(u)) api_broken(a, "u(%g) = %g", t, u);
  api_end_query(a);
  api_begin(a, "mps_signal_velocity");
  if (isinf(mps_signal_velocity(signal, t))) api_broken(a, "v(%g)", t);
  api_end_query(a);
  api_begin(a, "mps_signal_acceleration");
  if (isinf(mps_signal_acceleration(signal, t))) api_broken(a, "a(%g)", t);
  api_end_query(a);
  api_begin(a, "mps_signal_value");
  if (isinf(mps_signal_value(signal, t))) api_broken(a, "value(%g)", t);
  api_end_query(a);
}

static void signal_span(api *a) {
  double start = 0.0, end = 0.0;
  mps_signal_span(api_any(a, API_SIGNAL)->handle, api_chance(a, 80) ? &start : NULL, &end);
  if (isnan(start) || isnan(end)) api_broken(a, "%g to %g", start, end);
  api_end_query(a);
}

/* ---- couplings ------------------------------------------------------------------------------- */

static void coupling_create(api *a) {
  mps_coupling *made = NULL;
  mps_context *context = api_context(a);
  mps_coupling_def def = mps_coupling_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.method = api_choice(a, "method", 3);
  def.size = 2;
  if (a->mood == API_ABSURD && api_chance(a, 20)) def.size = 0, api_wrong(a, "size");
  def.relaxation = api_real(a, "relaxation", 5e-324, 1.0, 0.5);
  def.tolerance = api_real(a, "tolerance", 5e-324, nextafter(1.0, 0.0), 1e-4);
  def.floor = api_real(a, "floor", 0.0, DBL_MAX, 0.0);
  def.filter = api_real(a, "filter", 0.0, nextafter(1.0, 0.0), 1e-4);
  def.repeats = (int32_t)api_least(a, "repeats", 1, 20);
  def.reuse = (int32_t)api_least(a, "reuse", 0, 5);
  def.columns = (int32_t)api_least(a, "columns", 1, 10);
  def.order = (int32_t)api_whole(a, "order", 0, 2);
  const mps_status status = mps_coupling_create(context, api_null(a, "def") ? NULL : &def,
                                                api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_COUPLING, made, NULL);
}

API_DESTROY(coupling_destroy, API_COUPLING)

static void coupling_begin(api *a) {
  double start[3] = {0}, guess[3] = {0};
  mps_coupling *coupling = api_any(a, API_COUPLING)->handle;
  const bool given = api_chance(a, 40);
  if (given) api_vector(a, "start", 2, 0.0, 1.0, start);
  const mps_status status =
      mps_coupling_begin(coupling, given ? start : NULL, api_null(a, "guess") ? NULL : guess);
  if (status == MPS_OK && !(isfinite(guess[0]) && isfinite(guess[1])))
    api_broken(a, "guesses %g, %g", guess[0], guess[1]);
  (void)api_end(a, status);
}

static void coupling_next(api *a) {
  double answer[3], guess[3] = {0};
  int32_t done = -1;
  mps_coupling *coupling = api_any(a, API_COUPLING)->handle;
  api_vector(a, "answer", 2, 0.5, 1.0, answer);
  const mps_status status = mps_coupling_next(coupling, api_null(a, "answer") ? NULL : answer,
                                              guess, api_null(a, "done") ? NULL : &done);
  if (status == MPS_OK && !(isfinite(guess[0]) && isfinite(guess[1])))
    api_broken(a, "guesses %g, %g", guess[0], guess[1]);
  if (status == MPS_ERROR_NUMERIC) a->change = API_CHANGES_ALL; /* the answer has been counted */
  (void)api_end(a, status);
}

static void coupling_accept(api *a) {
  (void)api_end(a, mps_coupling_accept(api_any(a, API_COUPLING)->handle));
}

API_GETTER(coupling_get_report_sized, mps_coupling_get_report_sized, API_COUPLING,
           const mps_coupling, mps_coupling_report)

/* The memory of one coupling is set in another, perhaps damaged. */
static void coupling_memory(api *a) {
  double values[513];
  int64_t count = 0;
  int64_t capacity = (int64_t)api_below(a, 2) * 512;
  if (a->mood == API_ABSURD && api_chance(a, 20)) capacity = -1, api_wrong(a, "capacity");
  const mps_coupling *coupling = api_any(a, API_COUPLING)->handle;
  const mps_status status = mps_coupling_get_memory(coupling, capacity, &count, values);
  a->reads = true;
  if (!api_end(a, status) || count > capacity) return;
  api_begin(a, "mps_coupling_set_memory");
  mps_coupling *other = api_any(a, API_COUPLING)->handle;
  if (a->mood == API_ABSURD && count > 0) values[api_below(a, (uint32_t)count)] = NAN;
  if (a->mood == API_ABSURD && api_chance(a, 50))
    count = (int64_t)api_below(a, (uint32_t)count + 1);
  api_say(a, "%d, ", (int)count);
  (void)api_end(a, mps_coupling_set_memory(other, count, values));
}

static const api_call calls[] = {
    {"mps_signal_create_ricker", 2, API_CONTEXT, signal_ricker},
    {"mps_signal_create_sine", 3, API_CONTEXT, signal_sine},
    {"mps_signal_create_ramp", 2, API_CONTEXT, signal_ramp},
    {"mps_signal_create_table", 3, API_CONTEXT, signal_table},
    {"mps_signal_create_user", 4, API_CONTEXT, signal_user},
    {"mps_signal_create_record", 2, API_CONTEXT, signal_record},
    {"mps_signal_get_record_sized", 1, API_SIGNAL, signal_get_record_sized},
    {"mps_signal_destroy", 1, API_SIGNAL, destroy_signal_destroy},
    {"mps_signal_displacement", 2, API_SIGNAL, signal_values},
    {"mps_signal_velocity", 0, API_SIGNAL, signal_values},
    {"mps_signal_acceleration", 0, API_SIGNAL, signal_values},
    {"mps_signal_value", 0, API_SIGNAL, signal_values},
    {"mps_signal_span", 1, API_SIGNAL, signal_span},
    {"mps_coupling_create", 2, API_CONTEXT, coupling_create},
    {"mps_coupling_destroy", 1, API_COUPLING, destroy_coupling_destroy},
    {"mps_coupling_begin", 3, API_COUPLING, coupling_begin},
    {"mps_coupling_next", 6, API_COUPLING, coupling_next},
    {"mps_coupling_accept", 3, API_COUPLING, coupling_accept},
    {"mps_coupling_get_report_sized", 1, API_COUPLING, coupling_get_report_sized},
    {"mps_coupling_get_memory", 2, API_COUPLING, coupling_memory},
    {"mps_coupling_set_memory", 0, API_COUPLING, coupling_memory},
};
const api_table api_signal_calls = API_TABLE(calls);
