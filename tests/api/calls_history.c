/* calls_history.c - histories of all solvers: rows from the caller and from sources, files, and
 * what is left of them when their solver is gone. SPDX-License-Identifier: BSD-3-Clause */
#include "calls_solver.h"

#include <mps/mps.h>

static const char *const columns[] = {"a", "b"};

/* Of any kind. */
static api_object *any_solver(api *a, mps_solver **solver) {
  const uint32_t from = api_below(a, 4);
  api_kind kind = API_MPM;
  for (uint32_t k = 0; k < 4; k++) {
    kind = (api_kind)(API_MPM + (from + k) % 4);
    if (api_alive(a, kind) > 0) break;
  }
  api_object *o = api_any(a, kind);
  *solver = kind == API_MPM        ? mps_mpm_solver(o->handle)
            : kind == API_DYNAMICS ? mps_dynamics_solver(o->handle)
            : kind == API_ELASTIC  ? mps_elastic_solver(o->handle)
                                   : mps_fluid_solver(o->handle);
  return o;
}

static void create(api *a) {
  static const char *const names[] = {"first", "second", "third", "not a name", ""};
  static const char *const units[] = {"m", NULL};
  api_begin(a, "mps_history_create");
  mps_history *made = NULL;
  mps_solver *solver = NULL;
  api_object *o = any_solver(a, &solver);
  const uint32_t name = api_below(a, a->mood == API_ABSURD ? 5 : 3);
  api_say(a, "\"%s\", ", names[name]);
  if (name > 2) api_wrong(a, "name");
  const int32_t count = (int32_t)api_whole(a, "count", 1, 2);
  const bool none = count > 2 || api_null(a, "columns"); /* there are names of two */
  if (count > 2) api_wrong(a, "columns");
  const mps_status status = mps_history_create(
      solver, api_null(a, "name") ? NULL : names[name], none ? NULL : columns,
      api_chance(a, 30) ? units : NULL, count, api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_HISTORY, made, o);
}

API_DESTROY(history_destroy, API_HISTORY)
API_QUERY(history_count, API_HISTORY)

/* A column that the history may have; "t" too, where that is allowed. */
static const char *draw_column(api *a, bool time) {
  static const char *const names[] = {"a", "b", "t", "c"};
  const uint32_t name = api_below(a, a->mood == API_ABSURD ? 4 : time ? 3 : 2);
  api_say(a, "\"%s\", ", names[name]);
  if (name == 3 || (name == 2 && !time)) api_wrong(a, "column");
  return api_null(a, "column") ? NULL : names[name];
}

static void set_source(api *a) {
  api_begin(a, "mps_history_set_source");
  mps_history *history = api_any(a, API_HISTORY)->handle;
  const char *column = draw_column(a, false);
  mps_history_fn fn = api_chance(a, 60) ? api_column : NULL;
  api_say(a, fn ? "a source" : "no source");
  (void)api_end(a, mps_history_set_source(history, column, fn, &a->plan, NULL));
}

/* A row that has filled its block stays where the file cannot be written. */
static void record(api *a) {
  static const double row[] = {0.5, NAN};
  api_begin(a, "mps_history_record");
  mps_history *history = api_any(a, API_HISTORY)->handle;
  const int32_t count = (int32_t)api_below(a, 3);
  const double time = api_chance(a, 70) ? NAN : api_near(a, "time", 0.0, 1.0);
  const int64_t before = mps_history_count(history);
  api_say(a, "count = %d, ", (int)count);
  api_arm(a);
  const mps_status status = mps_history_record(history, time, row, count);
  const int64_t more = mps_history_count(history) - before;
  if (status == MPS_OK && more != 1) api_broken(a, "adds %d rows", (int)more);
  if (status == MPS_ERROR_IO) a->change = API_CHANGES_ALL;
  (void)api_end(a, status);
}

static void view(api *a) {
  api_begin(a, "mps_history_view");
  mps_view out;
  mps_history *history = api_any(a, API_HISTORY)->handle;
  const char *column = draw_column(a, true);
  const mps_status status = mps_history_view(history, column, api_null(a, "out") ? NULL : &out);
  if (status == MPS_OK && out.shape[0] != mps_history_count(history))
    api_broken(a, "shows %d rows", (int)out.shape[0]);
  a->reads = true;
  (void)api_end(a, status);
}

static void write_all(api *a) {
  api_begin(a, "mps_history_write");
  char path[300];
  mps_history *history = api_any(a, API_HISTORY)->handle;
  api_path(a, path, "rows");
  a->reads = true;
  (void)api_end(a, mps_history_write(history, api_null(a, "path") ? NULL : path));
}

static void open_file(api *a) {
  api_begin(a, "mps_history_open");
  char path[300];
  mps_history *history = api_any(a, API_HISTORY)->handle;
  const bool close = api_chance(a, 20);
  if (!close) api_path(a, path, "history");
  const int64_t every = api_least(a, "every", 1, 3);
  (void)api_end(a, mps_history_open(history, close ? NULL : path, every));
}

static void flush(api *a) {
  api_begin(a, "mps_history_flush");
  mps_history *history = api_any(a, API_HISTORY)->handle;
  a->reads = true;
  (void)api_end(a, mps_history_flush(history));
}

static const api_call calls[] = {
    {"mps_history_create", 3, API_CONTEXT, create},
    {"mps_history_destroy", 1, API_HISTORY, destroy_history_destroy},
    {"mps_history_count", 1, API_HISTORY, query_history_count},
    {"mps_history_set_source", 2, API_HISTORY, set_source},
    {"mps_history_record", 8, API_HISTORY, record},
    {"mps_history_view", 2, API_HISTORY, view},
    {"mps_history_write", 1, API_HISTORY, write_all},
    {"mps_history_open", 2, API_HISTORY, open_file},
    {"mps_history_flush", 1, API_HISTORY, flush},
};
const api_table api_history_calls = API_TABLE(calls);
