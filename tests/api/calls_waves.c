/* calls_waves.c - seas, absorbing pistons, separation of waves, loads of waves on walls.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls.h"

#include <mps/experimental/wave_loads.h>
#include <mps/experimental/waves.h>

#include <float.h>
#include <stdlib.h>

/* ---- linear theory --------------------------------------------------------------------------- */

/* ---- seas ------------------------------------------------------------------------------------ */

static void waves_create(api *a) {
  static const double f[3] = {0.4, 0.6, 1.1}, S[3] = {0.0, 1e-3, 0.0};
  double t[24], eta[24];
  mps_waves *made = NULL;
  mps_context *context = api_context(a);
  mps_waves_def def = mps_waves_defaults();
  def.repeat = 9.0;
  def.crest = 0.03, def.time = 2.0;
  def.count = 3, def.frequency = f, def.density = S;
  for (int k = 0; k < 24; k++) t[k] = 0.25 * k, eta[k] = api_near(a, "", 0.0, 0.01);
  a->wrong = 0; /* of a record alone: its table looks at them */
  def.samples = 24, def.times = t, def.levels = eta;
  api_define(a, MPS_DEF_WAVES, &def, 0,
             "kind, phases?, theory, depth 0.5, height 0.03, period 1.5, ramp? 1, stroke? 2");
  const bool none = api_null(a, "def");
  const mps_status status =
      mps_waves_create(context, none ? NULL : &def, api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_WAVES, made, NULL);
}

API_DESTROY(waves_destroy, API_WAVES)
API_GETTER(waves_report, mps_waves_get_report_sized, API_WAVES, const mps_waves, mps_waves_report)

static void waves_components(api *a) {
  double f[8] = {0.0}, amplitude[8] = {0.0};
  int64_t count = 0;
  const mps_waves *waves = api_any(a, API_WAVES)->handle;
  const int64_t capacity = api_least(a, "capacity", 0, 8);
  const mps_status status = mps_waves_get_components(
      waves, capacity > 8 ? 8 : capacity, api_null(a, "count") ? NULL : &count, f, amplitude, NULL);
  a->reads = true;
  (void)api_end(a, status);
}

static void waves_levels(api *a) {
  double linear[2] = {0.0}, level[2] = {0.0};
  const mps_waves *waves = api_any(a, API_WAVES)->handle;
  const double station = api_real(a, "station", 0.0, 1e12, 2.0);
  const double t[2] = {api_near(a, "t", 2.0, 2.0), 3.0};
  const bool none = api_null(a, "t");
  const mps_status status = mps_waves_get_levels(waves, station, 2, none ? NULL : t, linear, level);
  if (status == MPS_OK && !(isfinite(level[0]) && isfinite(level[1]))) api_broken(a, "level");
  a->reads = true;
  (void)api_end(a, status);
}

static void waves_piston(api *a) {
  double s = 0.0, u = 0.0;
  const mps_waves *waves = api_any(a, API_WAVES)->handle;
  const double t = api_near(a, "t", 2.0, 2.0);
  const mps_status status =
      mps_waves_get_piston(waves, 1, api_null(a, "t") ? NULL : &t, &s, &u, NULL, NULL);
  if (status == MPS_OK && !(isfinite(s) && isfinite(u))) api_broken(a, "%g, %g", s, u);
  a->reads = true;
  (void)api_end(a, status);
}

static void signal_waves(api *a) {
  mps_signal *made = NULL;
  mps_context *context = api_context(a);
  mps_waves *waves = api_any(a, API_WAVES)->handle;
  const mps_status status =
      mps_signal_create_waves(context, waves, api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_SIGNAL, made, NULL);
}

/* ---- absorbing pistons ----------------------------------------------------------------------- */

static void absorber_create(api *a) {
  mps_absorber *made = NULL;
  mps_context *context = api_context(a);
  mps_absorber_def def = mps_absorber_defaults();
  def.waves = api_maybe(a, API_WAVES, "waves");
  api_define(a, MPS_DEF_ABSORBER, &def, 0,
             "form, depth 0.5, period 1.5, leak? 0.01, high_pass? 5, stroke? 0.5");
  const bool none = api_null(a, "def");
  const mps_status status =
      mps_absorber_create(context, none ? NULL : &def, api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_ABSORBER, made, NULL);
}

API_DESTROY(absorber_destroy, API_ABSORBER)
API_GETTER(absorber_report, mps_absorber_get_report_sized, API_ABSORBER, const mps_absorber,
           mps_absorber_report)

static void absorber_advance(api *a) {
  double s = 0.0, u = 0.0;
  mps_absorber *absorber = api_any(a, API_ABSORBER)->handle;
  const double t = api_near(a, "t", 2.0, 2.0), dt = api_real(a, "dt", 1e-12, 1e12, 0.01);
  const double level = api_optional(a, "level", -1e12, 1e12, 0.01);
  const mps_status status =
      mps_absorber_advance(absorber, t, dt, level, api_null(a, "displacement") ? NULL : &s, &u);
  if (status == MPS_OK && !(isfinite(s) && isfinite(u))) api_broken(a, "%g, %g", s, u);
  (void)api_end(a, status);
}

static void absorber_reflection(api *a) {
  double r = 0.0;
  const mps_absorber *absorber = api_any(a, API_ABSORBER)->handle;
  const double period = api_real(a, "period", 1e-12, 1e12, 1.5);
  const mps_status status =
      mps_absorber_get_reflection(absorber, period, api_null(a, "reflection") ? NULL : &r);
  if (status == MPS_OK && !(r >= 0.0 && isfinite(r))) api_broken(a, "%g", r);
  a->reads = true;
  (void)api_end(a, status);
}

/* The memory of one in another, perhaps damaged. */
static void absorber_memory(api *a) {
  double values[MPS_ABSORBER_MEMORY] = {0.0};
  const mps_absorber *absorber = api_any(a, API_ABSORBER)->handle;
  const mps_status status =
      mps_absorber_get_memory(absorber, api_null(a, "values") ? NULL : values);
  a->reads = true;
  if (!api_end(a, status)) return;
  api_begin(a, "mps_absorber_set_memory");
  mps_absorber *other = api_any(a, API_ABSORBER)->handle;
  if (a->mood == API_ABSURD)
    values[api_below(a, MPS_ABSORBER_MEMORY)] = NAN, api_wrong(a, "values");
  (void)api_end(a, mps_absorber_set_memory(other, values));
}

/* ---- closed formulas ------------------------------------------------------------------------- */

static void separation_find(api *a) {
  enum { N = 64 };
  double t[N], levels[3 * N], f[4] = {0.0}, in[4] = {0.0};
  static const double x[3] = {1.0, 1.3, 1.9};
  int64_t count = 0;
  mps_context *context = api_context(a);
  mps_separation_def def = mps_separation_defaults();
  for (int k = 0; k < N; k++) {
    t[k] = 0.1 * k;
    for (int p = 0; p < 3; p++) levels[3 * k + p] = 0.01 * cos(4.0 * t[k] - 2.0 * x[p]);
  }
  levels[3] = api_near(a, "levels", 0.0, 0.01);
  def.gauges = 3, def.position = x, def.samples = N, def.times = t, def.levels = levels;
  api_define(a, MPS_DEF_SEPARATION, &def, 0, "depth 0.5, lower 0.3, upper 1.6");
  API_SIZED(a, mps_separation, size, out);
  const bool none = api_null(a, "def");
  const mps_status status = mps_separation_find_sized(
      context, none ? NULL : &def, api_least(a, "capacity", 0, 4) > 4 ? 4 : 2, &count, f, in, NULL,
      api_null(a, "out") ? NULL : out, size);
  a->wrong = 0; /* a capacity that is not taken as it is */
  API_SIZED_END(a, status, size, out, true);
}

static void sainflou_evaluate(api *a) {
  mps_context *context = api_context(a);
  mps_sainflou_def def = mps_sainflou_defaults();
  api_define(a, MPS_DEF_SAINFLOU, &def, 0, "height 0.1, period 2, depth 0.6, density 1000");
  API_SIZED(a, mps_sainflou, size, out);
  const bool none = api_null(a, "def");
  const mps_status status = mps_sainflou_evaluate_sized(context, none ? NULL : &def,
                                                        api_null(a, "out") ? NULL : out, size);
  API_SIZED_END(a, status, size, out, true);
}

static void goda_evaluate(api *a) {
  mps_context *context = api_context(a);
  mps_goda_def def = mps_goda_defaults();
  api_define(a, MPS_DEF_GODA, &def, 0,
             "impulsive, height 5, period 8, depth 10, seaward? 20, berm_depth? 8, base? 9, crest 4, "
             "width 12, berm_width? 5, angle 0.3, weight? 1e6, arm? 6, friction? 0.6");
  API_SIZED(a, mps_goda, size, out);
  const bool none = api_null(a, "def");
  const mps_status status =
      mps_goda_evaluate_sized(context, none ? NULL : &def, api_null(a, "out") ? NULL : out, size);
  API_SIZED_END(a, status, size, out, true);
}

static void eurotop_evaluate(api *a) {
  mps_context *context = api_context(a);
  mps_eurotop_def def = mps_eurotop_defaults();
  api_define(a, MPS_DEF_EUROTOP, &def, 0,
             "wall, foreshore, design, height 1, period 5, depth 5, crest 1, cotangent 3");
  API_SIZED(a, mps_eurotop, size, out);
  const bool none = api_null(a, "def");
  const mps_status status = mps_eurotop_evaluate_sized(context, none ? NULL : &def,
                                                       api_null(a, "out") ? NULL : out, size);
  API_SIZED_END(a, status, size, out, true);
}

static void run_up_find(api *a) {
  mps_context *context = api_context(a);
  mps_eurotop_def def = mps_eurotop_defaults();
  def.wall = MPS_EUROTOP_WALL_SLOPE;
  api_define(a, MPS_DEF_EUROTOP, &def, 0,
             "design, height 1, period 5, depth 5, cotangent 3, berm? 0.8, roughness 0.7");
  API_SIZED(a, mps_eurotop_run_up, size, out);
  const bool none = api_null(a, "def");
  const mps_status status = mps_eurotop_find_run_up_sized(context, none ? NULL : &def,
                                                          api_null(a, "out") ? NULL : out, size);
  API_SIZED_END(a, status, size, out, true);
}

static void overtopping_find(api *a) {
  enum { N = 24 };
  double t[N], heads[N], volumes[N], thin[N];
  mps_context *context = api_context(a);
  mps_overtopping_def def = mps_overtopping_defaults();
  for (int k = 0; k < N; k++) t[k] = 0.1 * k, heads[k] = 0.02 * cos(t[k]), volumes[k] = 1e-4 * k;
  volumes[3] = api_near(a, "volumes", 0.0, 0.01);
  def.samples = N, def.times = t, def.heads = heads, def.volumes = volumes;
  api_define(a, MPS_DEF_OVERTOPPING, &def, 0, "resolved 0.025, pause 0.3, depth? 0.5");
  API_SIZED(a, mps_overtopping, size, out);
  const bool none = api_null(a, "def");
  const mps_status status = mps_overtopping_find_sized(context, none ? NULL : &def, N, thin,
                                                       api_null(a, "out") ? NULL : out, size);
  API_SIZED_END(a, status, size, out, true);
}

static const api_call calls[] = {
    {"mps_waves_create", 3, API_CONTEXT, waves_create},
    {"mps_waves_destroy", 1, API_WAVES, destroy_waves_destroy},
    {"mps_waves_get_report_sized", 1, API_WAVES, waves_report},
    {"mps_waves_get_components", 1, API_WAVES, waves_components},
    {"mps_waves_get_levels", 1, API_WAVES, waves_levels},
    {"mps_waves_get_piston", 1, API_WAVES, waves_piston},
    {"mps_signal_create_waves", 2, API_WAVES, signal_waves},
    {"mps_absorber_create", 2, API_CONTEXT, absorber_create},
    {"mps_absorber_destroy", 1, API_ABSORBER, destroy_absorber_destroy},
    {"mps_absorber_advance", 4, API_ABSORBER, absorber_advance},
    {"mps_absorber_get_reflection", 1, API_ABSORBER, absorber_reflection},
    {"mps_absorber_get_report_sized", 1, API_ABSORBER, absorber_report},
    {"mps_absorber_get_memory", 2, API_ABSORBER, absorber_memory},
    {"mps_absorber_set_memory", 0, API_ABSORBER, absorber_memory},
    {"mps_separation_find_sized", 2, API_CONTEXT, separation_find},
    {"mps_sainflou_evaluate_sized", 1, API_CONTEXT, sainflou_evaluate},
    {"mps_goda_evaluate_sized", 1, API_CONTEXT, goda_evaluate},
    {"mps_eurotop_evaluate_sized", 1, API_CONTEXT, eurotop_evaluate},
    {"mps_eurotop_find_run_up_sized", 1, API_CONTEXT, run_up_find},
    {"mps_overtopping_find_sized", 1, API_CONTEXT, overtopping_find},
};
const api_table api_waves_calls = API_TABLE(calls);
