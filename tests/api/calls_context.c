/* calls_context.c - contexts and what belongs to no other object: versions, features, neighbours,
 * kernels.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "calls.h"

#include "core/definition/definition.h"

#include <mps/mps.h>
#include <mps/experimental/neighbours.h>

#include <stdlib.h>
#include <string.h>

/* ---- contexts -------------------------------------------------------------------------------- */

/* Definitions of all kinds, and of one that there is not. */
static void def_init(api *a) {
  union {
    uint32_t size;
    char room[4096];
  } u;
  const int32_t kind = (int32_t)api_below(a, a->mood == API_ABSURD ? 100 : 55);
  const mpsi_definition *definition = mpsi_definition_of(kind);
  if (!definition) api_wrong(a, "kind");
  const size_t size = api_size_of(a, definition ? definition->size : 64);
  const mps_status status = mps_def_init(kind, api_null(a, "def") ? NULL : &u, size);
  if (status == MPS_OK && u.size != size) api_broken(a, "sets no size");
  (void)api_end(a, status);
}

static void context_create(api *a) {
  mps_context *made = NULL;
  char text[64];
  mps_context_def def = mps_context_defaults();
  api_hooks(a, &def);
  def.threads = a->threads;
  def.executor = a->threads > 1 ? MPS_CONTEXT_EXECUTOR_THREADS : MPS_CONTEXT_EXECUTOR_SERIAL;
  def.struct_size = api_struct_size(a, sizeof def);
  if (a->mood == API_ABSURD) {
    def.executor = api_chance(a, 70) ? def.executor : api_choice(a, "executor", 4);
    if (def.executor == MPS_CONTEXT_EXECUTOR_CALLER) api_wrong(a, "parallel_for");
    if (def.executor == MPS_CONTEXT_EXECUTOR_OPENMP) def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
    if (api_chance(a, 20)) def.threads = -1, api_wrong(a, "threads");
    if (api_chance(a, 10)) def.instruction_level = 2, api_wrong(a, "instruction_level");
    if (api_chance(a, 10)) def.free = NULL, api_wrong(a, "free");
  }
  const mps_status status =
      mps_context_create(&def, api_null(a, "out") ? NULL : &made, api_chance(a, 80) ? text : NULL,
                         api_chance(a, 80) ? sizeof text : 0);
  api_object *o = api_adopt(a, API_CONTEXT, made, 0, NULL);
  for (int k = 0; o && k < API_SLOTS; k++)
    if (o == &a->objects[API_CONTEXT][k]) o->context = k;
  (void)api_end(a, status);
}

API_DESTROY(context_destroy, API_CONTEXT)
API_QUERY(context_error, API_CONTEXT)
API_QUERY(context_threads, API_CONTEXT)

/* Allowed without a context too: the record of the thread. */
static void context_get_error(api *a) {
  mps_error record;
  if (mps_context_get_error_sized(api_context(a), &record, sizeof record) != MPS_OK ||
      !memchr(record.message, '\0', sizeof record.message))
    api_broken(a, "no record of an error");
  api_end_query(a);
}

static void context_get_warning_sized(api *a) {
  mps_context *context = api_context(a);
  const int64_t count = mps_context_warning_count(context);
  const int64_t index = api_whole(a, "index", 0, count - 1);
  API_SIZED(a, mps_context_warning, size, out);
  const mps_status status = mps_context_get_warning_sized(context, index, out, size);
  API_SIZED_END(a, status, size, out, count > 0);
}

static void context_clear_warnings(api *a) {
  mps_context *context = api_context(a);
  mps_context_clear_warnings(context);
  if (mps_context_warning_count(context) != 0) api_broken(a, "leaves warnings");
  api_end_query(a);
}

API_QUERY(context_warning_count, API_CONTEXT)

static void context_clear_error(api *a) {
  mps_context *context = api_context(a);
  mps_context_clear_error(context);
  if (context && mps_context_error(context)->status != MPS_OK) api_broken(a, "leaves a record");
  api_end_query(a);
}

static void context_set_error(api *a) {
  mps_context *context = api_context(a);
  const bool good = api_chance(a, 70);
  const mps_status status =
      mps_context_set_error(context, good ? MPS_ERROR_IO : MPS_OK, "mps_context_set_error",
                            good || api_chance(a, 50) ? "what the caller says" : NULL);
  if (context && status != (good ? MPS_ERROR_IO : MPS_ERROR_ARGUMENT))
    api_broken(a, "returns another status");
  a->reads = true;
  (void)api_end(a, status);
}

/* Hooks are put in as they were, or taken out. */
static void context_set_hook(api *a, int which) {
  mps_context *context = api_context(a);
  mps_context_def def = mps_context_defaults();
  if (!api_chance(a, 30)) api_hooks(a, &def);
  api_say(a, def.log ? "hook, " : "NULL, ");
  if (which == 0) mps_context_set_log(context, def.log, &a->plan, NULL);
  if (which == 1) mps_context_set_progress(context, def.progress, &a->plan, NULL);
  if (which == 2) mps_context_set_cancel(context, def.cancel, &a->plan, NULL);
  api_end_query(a);
  if (which != 2 || def.cancel) return;
  mps_context_def hooks = mps_context_defaults(); /* it ends runs that would take for ever */
  api_hooks(a, &hooks);
  mps_context_set_cancel(context, hooks.cancel, &a->plan, NULL);
}

static void context_set_log(api *a) { context_set_hook(a, 0); }
static void context_set_progress(api *a) { context_set_hook(a, 1); }
static void context_set_cancel(api *a) { context_set_hook(a, 2); }

static void context_parallel_for(api *a) {
  atomic_llong sum = 0;
  mps_context *context = api_context(a);
  int64_t count = api_chance(a, 10) ? 0 : (int64_t)api_below(a, 50);
  if (a->mood == API_ABSURD && api_chance(a, 30)) count = -1, api_wrong(a, "count");
  api_say(a, "%d, ", (int)count);
  const mps_context_task_fn task = api_null(a, "task") ? NULL : api_count_unit;
  if (count == 0) a->wrong = a->wrong && !context;
  const mps_status status = mps_context_parallel_for(context, count, task, &sum);
  if (status == MPS_OK && count > 0 && atomic_load(&sum) != count * (count + 1) / 2)
    api_broken(a, "runs other units than %d", (int)count);
  a->reads = true;
  (void)api_end(a, status);
}

/* ---- the library ----------------------------------------------------------------------------- */

static void library(api *a) {
  static const int32_t numbers[] = {-1, 0, 1, 2, 3, 4, 6, 7, 1000, INT32_MIN, INT32_MAX};
  const int32_t number = numbers[api_below(a, API_COUNT(numbers))];
  const int32_t has = mps_library_has(number);
  if (has != 0 && has != 1) api_broken(a, "%d of feature %d", has, number);
  api_end_query(a);
  api_begin(a, "mps_enumerator_name");
  const char *name = mps_enumerator_name("mps_boundary_kind", number);
  if ((name != NULL) != (number >= 0 && number <= MPS_BOUNDARY_OPEN)) api_broken(a, "%d", number);
  api_end_query(a);
  api_begin(a, "mps_status_text");
  if (!mps_status_text((mps_status)number)) api_broken(a, "no text");
  api_end_query(a);
  api_begin(a, "mps_version");
  if (strlen(mps_version()) < 5) api_broken(a, "%s", mps_version());
  api_end_query(a);
  api_begin(a, "mps_version_number");
  if (mps_version_number() != MPS_VERSION_NUMBER) api_broken(a, "another");
  api_end_query(a);
}

/* ---- kernels --------------------------------------------------------------------------------- */

static void kernel_create(api *a) {
  mps_kernel *made = NULL;
  mps_context *context = api_context(a);
  const int32_t kind = api_choice(a, "kind", 4);
  const double radii[] = {0.15, 0.3, 0.31, 0.4};
  const double radius = api_real(a, "radius", 1e-12, 1e12, radii[api_below(a, 4)]);
  const mps_status status =
      mps_kernel_create(context, kind, radius, api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_KERNEL, made, NULL);
}

API_DESTROY(kernel_destroy, API_KERNEL)
API_QUERY(kernel_get_kind, API_KERNEL)
API_QUERY(kernel_radius, API_KERNEL)

static void kernel_weight(api *a) {
  const mps_kernel *kernel = api_any(a, API_KERNEL)->handle;
  const double r = api_real(a, "r", 0.0, INFINITY, 0.1);
  const double weight = mps_kernel_weight(kernel, r);
  if (isfinite(r) && !isfinite(weight) && r > 1e-200) api_broken(a, "w(%g) = %g", r, weight);
  api_end_query(a);
  api_begin(a, "mps_kernel_derivative");
  const double slope = mps_kernel_derivative(kernel, r);
  if (isfinite(r) && !isfinite(slope) && r > 1e-100) api_broken(a, "dw/dr(%g) = %g", r, slope);
  api_end_query(a);
}

/* ---- neighbours ------------------------------------------------------------------------------ */

static void neighbours_create(api *a) {
  mps_neighbours *made = NULL;
  mps_context *context = api_context(a);
  mps_neighbours_def def = mps_neighbours_defaults();
  def.struct_size = api_struct_size(a, sizeof def);
  def.dim = api_chance(a, 90) ? a->dim : (int32_t)api_whole(a, "dim", 2, 3);
  def.radius = api_real(a, "radius", 1e-150, 1e150, 0.2);
  def.half = api_choice(a, "half", 2);
  if (def.half != 0 && def.half != 1) a->wrong = 0; /* any other may be taken for 1 */
  const mps_status status = mps_neighbours_create(context, api_null(a, "def") ? NULL : &def,
                                                  api_null(a, "out") ? NULL : &made);
  (void)api_end_made(a, status, API_NEIGHBOURS, made, NULL);
}

API_DESTROY(neighbours_destroy, API_NEIGHBOURS)

static void neighbours_build(api *a) {
  mps_neighbours *neighbours = api_any(a, API_NEIGHBOURS)->handle;
  mps_particles *set = api_any(a, API_SET)->handle;
  mps_view view;
  memset(&view, 0, sizeof view);
  const bool position = !(a->mood == API_ABSURD && api_chance(a, 20));
  const char *name = position ? "position" : "id";
  if (!position) api_say(a, "\"id\", "), api_wrong(a, "dtype");
  if (!set || mps_particles_view(set, name, &view) != MPS_OK) memset(&view, 0, sizeof view);
  (void)api_end(a, mps_neighbours_build(neighbours, api_null(a, "view") ? NULL : &view));
}

static void neighbours_lists(api *a) {
  int64_t count = -1;
  const int64_t *offsets, *indices;
  const mps_neighbours *neighbours = api_any(a, API_NEIGHBOURS)->handle;
  const mps_status status = mps_neighbours_lists(neighbours, api_chance(a, 80) ? &count : NULL,
                                                 api_chance(a, 80) ? &offsets : NULL,
                                                 api_chance(a, 80) ? &indices : NULL);
  a->reads = true;
  (void)api_end(a, status);
}

static const api_call calls[] = {
    {"mps_def_init", 8, API_NOTHING, def_init},
    {"mps_context_create", 1, API_NOTHING, context_create},
    {"mps_context_destroy", 1, API_CONTEXT, destroy_context_destroy},
    {"mps_context_error", 1, API_CONTEXT, query_context_error},
    {"mps_context_get_error_sized", 1, API_CONTEXT, context_get_error},
    {"mps_context_warning_count", 1, API_CONTEXT, query_context_warning_count},
    {"mps_context_get_warning_sized", 1, API_CONTEXT, context_get_warning_sized},
    {"mps_context_clear_warnings", 1, API_CONTEXT, context_clear_warnings},
    {"mps_context_clear_error", 1, API_CONTEXT, context_clear_error},
    {"mps_context_set_error", 1, API_CONTEXT, context_set_error},
    {"mps_context_set_log", 1, API_CONTEXT, context_set_log},
    {"mps_context_set_progress", 1, API_CONTEXT, context_set_progress},
    {"mps_context_set_cancel", 1, API_CONTEXT, context_set_cancel},
    {"mps_context_threads", 1, API_CONTEXT, query_context_threads},
    {"mps_context_parallel_for", 2, API_CONTEXT, context_parallel_for},
    {"mps_library_has", 1, API_NOTHING, library},
    {"mps_enumerator_name", 0, API_NOTHING, library},
    {"mps_status_text", 0, API_NOTHING, library},
    {"mps_version", 0, API_NOTHING, library},
    {"mps_version_number", 0, API_NOTHING, library},
    {"mps_kernel_create", 4, API_CONTEXT, kernel_create},
    {"mps_kernel_destroy", 1, API_KERNEL, destroy_kernel_destroy},
    {"mps_kernel_get_kind", 1, API_KERNEL, query_kernel_get_kind},
    {"mps_kernel_radius", 1, API_KERNEL, query_kernel_radius},
    {"mps_kernel_weight", 2, API_KERNEL, kernel_weight},
    {"mps_kernel_derivative", 0, API_KERNEL, kernel_weight},
    {"mps_neighbours_create", 3, API_CONTEXT, neighbours_create},
    {"mps_neighbours_destroy", 1, API_NEIGHBOURS, destroy_neighbours_destroy},
    {"mps_neighbours_build", 5, API_NEIGHBOURS, neighbours_build},
    {"mps_neighbours_lists", 2, API_NEIGHBOURS, neighbours_lists},
};
const api_table api_context_calls = API_TABLE(calls);
