/* check.c - rules before and after each call, for all functions and arguments:
 *
 *   the status is one of the table;
 *   an argument that no function may take is refused;
 *   the record of an error has that status, the function's name and a message, which names an
 *   argument where that is refused;
 *   a call that failed has changed nothing, nor has one that only reads;
 *   after one that succeeded all is finite;
 *   a callback's status is returned, and calls that a callback may not make are refused.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "api.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void api_broken(api *a, const char *format, ...) {
  if (a->reason[0]) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(a->reason, sizeof a->reason, format, arguments);
  va_end(arguments);
}

/* Without stdio: it also runs when a signal has come. */
static void put(int descriptor, const char *text) {
  size_t length = strlen(text);
  while (length > 0) {
    const ssize_t written = write(descriptor, text, length);
    if (written <= 0) return;
    text += written;
    length -= (size_t)written;
  }
}

void api_print_log(const api *a, int descriptor) {
  const int64_t from = a->line_count > API_LINES ? a->line_count - API_LINES : 0;
  for (int64_t k = from; k < a->line_count; k++) {
    put(descriptor, "  ");
    put(descriptor, a->lines[k % API_LINES]);
    put(descriptor, "\n");
  }
  if (a->length > 0) {
    put(descriptor, "  ");
    put(descriptor, a->line);
    put(descriptor, "\n");
  }
}

/* ---- before ---------------------------------------------------------------------------------- */

/* One allocation of the call is refused, or all from one on. */
static void refuse_memory(api *a) {
  atomic_store(&a->memory.refuse_from, 0);
  atomic_store(&a->memory.refused, 0);
  if (a->steady || a->latest || !api_chance(a, 6)) return;
  const long long from =
      atomic_load(&a->memory.calls) + 1 + api_below(a, UINT32_C(1) << api_below(a, 7));
  atomic_store(&a->memory.refuse_to, api_chance(a, 50) ? from : INT64_MAX);
  atomic_store(&a->memory.refuse_from, from);
  api_say(a, "/* memory */ ");
}

static bool may_push(const char *name) {
  static const char *const parts[] = {"_add_load", "_set_load", "_add_contact",
                                      "_add_body", "_restore",  "_settle"};
  for (int k = 0; k < API_COUNT(parts); k++)
    if (strstr(name, parts[k])) return true;
  return false;
}

void api_begin(api *a, const char *name) {
  a->pushed = a->pushed || may_push(name);
  a->name = name;
  a->wrong = 0;
  a->wrong_name = "";
  a->picked = false;
  a->context = -1;
  a->own_record = false;
  a->change = API_CHANGES_NOTHING;
  a->reads = a->queries = false;
  memset(&a->plan, 0, sizeof a->plan);
  a->length = 0;
  for (int k = 0; k < API_SLOTS; k++) mps_context_clear_error(a->objects[API_CONTEXT][k].handle);
  api_say(a, "%s(", name);
  refuse_memory(a);
}

void api_make(api *a, const api_call *call) {
  api_begin(a, call->name);
  call->call(a);
}

/* ---- after ----------------------------------------------------------------------------------- */

static bool is_status(mps_status status) {
  return status >= MPS_OK && status <= MPS_ERROR_INTERNAL;
}

static void finish_line(api *a, mps_status status, const char *message) {
  if (a->length > 2 && strcmp(a->line + a->length - 2, ", ") == 0) a->length -= 2;
  api_say(a, ")");
  if (!a->queries) api_say(a, " = %d", (int)status);
  if (message && message[0]) api_say(a, ": %s", message);
  memcpy(a->lines[a->line_count % API_LINES], a->line, sizeof a->line);
  a->line_count++;
  if (a->verbose) {
    printf("%4" PRId64 "  %s\n", a->call, a->line);
    fflush(stdout);
  }
  a->length = 0;
}

/* The name, or without "_sized", which an inline function of the shorter name calls. */
static bool is_name(const char *recorded, const char *called) {
  size_t length = strlen(called);
  if (length > 6 && strcmp(called + length - 6, "_sized") == 0) length -= 6;
  return strcmp(recorded, called) == 0 ||
         (strncmp(recorded, called, length) == 0 && recorded[length] == '\0');
}

/* Of a solver that is NULL the kind is not known. */
static bool same_name(const char *recorded, const char *called) {
  char shared[80];
  api_shared_name(called, shared, sizeof shared);
  return is_name(recorded, called) || is_name(recorded, shared);
}

/* Whether a law refused, which is armed but not counted as `faulted`. */
static bool refused_by_law(const api *a, mps_status status) {
  return a->plan.fault == API_FAULT_STATUS && a->plan.status == status;
}

static void check_record(api *a, mps_status status, const mps_error *record) {
  if (record->status != status)
    api_broken(a, "returns %d, its record has %d", (int)status, (int)record->status);
  else if (!same_name(record->function, a->name))
    api_broken(a, "the record names %s", record->function);
  else if (strlen(record->message) < 8)
    api_broken(a, "the record's message is \"%s\"", record->message);
  else if (status == MPS_ERROR_ARGUMENT && !a->plan.faulted && !refused_by_law(a, status) &&
           !api_names_argument(a->name, record->message))
    api_broken(a, "the record names no argument: %.200s", record->message);
  else if (status == MPS_ERROR_ARGUMENT && api_prints_allowed(record->message))
    api_broken(a, "the record refuses a value and prints one that is allowed: %.200s",
               record->message);
}

static void check_status(api *a, mps_status status) {
  if (a->plan.broken) api_broken(a, "%s", a->plan.broken);
  if (!is_status(status)) api_broken(a, "returns %d, which is no status", (int)status);
  a->lost = a->lost || (a->plan.faulted && a->plan.status == MPS_ERROR_INTERNAL);
  if (status == MPS_ERROR_INTERNAL && a->plan.status != status && !a->lost)
    api_broken(a, "finds itself broken");
  if (status == MPS_OK && a->wrong > 0) api_broken(a, "takes an absurd %s", a->wrong_name);
  if (!a->plan.faulted) return;
  if (a->plan.fault == API_FAULT_STATUS && status != a->plan.status)
    api_broken(a, "returns %d where a callback returned %d", (int)status, (int)a->plan.status);
  else if ((a->plan.fault == API_FAULT_NO_STATUS || a->plan.fault == API_FAULT_VALUE) &&
           status == MPS_OK)
    api_broken(a, "succeeds where a callback %s",
               a->plan.fault == API_FAULT_VALUE ? "wrote NaN" : "returned no status");
}

/* May this part differ after a call that failed or reads? Sums over particles may where their order
 * may, in the last bits; and fields that have been written since are read first. */
static bool may_differ(const api *a, const char *part) {
  static const char *const by_order[] = {
      "order", "epoch", "mass", "volume", "momentum", "kinetic energy", "energies", "limit", "dt"};
  const int count = a->change == API_CHANGES_PLACES ? 2 : API_COUNT(by_order);
  if (a->change == API_CHANGES_NOTHING || a->change == API_CHANGES_ALL)
    return a->change == API_CHANGES_ALL;
  for (int k = 0; k < count; k++)
    if (strstr(part, by_order[k])) return strncmp(part, "set mass", 8) != 0;
  return false;
}

static void compare(api *a, const api_object *o, const api_part *parts, int count, api_kind kind,
                    int slot) {
  if (kind == API_DYNAMICS && count != o->part_count) return; /* dt is chosen where it is needed */
  if (count != o->part_count && a->change != API_CHANGES_ALL)
    api_broken(a, "changes the number of parts of %s%d from %d to %d", api_kind_names[kind], slot,
               o->part_count, count);
  for (int k = 0; k < count && k < o->part_count; k++)
    if (parts[k].hash != o->parts[k].hash && !may_differ(a, parts[k].name))
      api_broken(a, "changes %s%d's %s", api_kind_names[kind], slot, parts[k].name);
}

/* The part of that name before the call; the `k`th was most often there. NULL: there was none. */
static const api_part *former_part(const api_object *o, int k, const char *name) {
  if (k < o->part_count && strcmp(o->parts[k].name, name) == 0) return &o->parts[k];
  for (int n = 0; n < o->part_count; n++)
    if (strcmp(o->parts[n].name, name) == 0) return &o->parts[n];
  return NULL;
}

/* Values that were not finite before, after a step that diverged, are no fault; nor are values that
 * could not be read before. */
static void check_finite(api *a, const api_object *o, const api_part *parts, int count,
                         api_kind kind, int slot) {
  for (int k = 0; k < API_EDITS; k++)
    for (int set = 0; set < API_SLOTS; set++) /* totals of a field that is being written */
      if (a->objects[API_SET][set].edits[k].data) return;
  for (int k = 0; k < count; k++) {
    const api_part *former = parts[k].finite ? NULL : former_part(o, k, parts[k].name);
    if (former && former->finite)
      api_broken(a, "succeeds, and %s%d's %s is not finite", api_kind_names[kind], slot,
                 parts[k].name);
  }
}

static void look_after(api *a, mps_status status) {
  static api_part parts[API_PARTS];
  const bool changes = status == MPS_OK && !a->reads;
  /* Solvers first: totals of explicit dynamics bring the field `pressure` up to date. */
  for (int kind = API_KINDS - 1; kind >= 0; kind--)
    for (int slot = 0; slot < API_SLOTS; slot++) {
      api_object *o = &a->objects[kind][slot];
      if (!o->handle) continue;
      const int count = api_look(a, (api_kind)kind, o, parts);
      if (!changes) compare(a, o, parts, count, (api_kind)kind, slot);
      for (int k = 0; k < count; k++) {
        const api_part *former = parts[k].open ? former_part(o, k, parts[k].name) : NULL;
        if (former) parts[k].finite = former->finite; /* as before it was opened */
      }
      if (status == MPS_OK) check_finite(a, o, parts, count, (api_kind)kind, slot);
      for (int k = 0; k < count; k++) a->digest = api_mix(a->digest ^ parts[k].hash);
      memcpy(o->parts, parts, sizeof parts);
      o->part_count = count;
    }
}

void api_settle(api *a) {
  if (a->reason[0]) longjmp(a->failed, 1);
}

bool api_end(api *a, mps_status status) {
  atomic_store(&a->memory.refuse_from, 0);
  const mps_context *context = a->context >= 0 ? a->objects[API_CONTEXT][a->context].handle : NULL;
  const mps_error *record =
      status != MPS_OK && !a->own_record ? mps_context_error(context) : NULL;
  a->plan.solver = NULL;
  finish_line(a, status, record ? record->message : NULL);
  api_count(a->name, status);
  check_status(a, status);
  if (record) check_record(a, status, record);
  if (status == MPS_ERROR_MEMORY && atomic_load(&a->memory.refused) == 0 && !a->plan.faulted &&
      !refused_by_law(a, status) && a->mood == API_VALID && record &&
      !strstr(record->message, "memory_limit")) /* the caller's own limit */
    api_broken(a, "finds no memory where none was refused");
  a->digest = api_mix(a->digest ^ (uint64_t)status);
  look_after(a, status);
  api_settle(a);
  return status == MPS_OK;
}

bool api_end_made(api *a, mps_status status, api_kind kind, void *made, const api_object *owner) {
  if ((status == MPS_OK) != (made != NULL))
    api_broken(a, "returns %d %s an object", (int)status, made ? "with" : "without");
  (void)api_adopt(a, kind, made, a->context, owner);
  return api_end(a, status);
}

static void end_without(api *a, bool reads) {
  atomic_store(&a->memory.refuse_from, 0);
  a->queries = true;
  a->reads = reads;
  finish_line(a, MPS_OK, NULL);
  api_count(a->name, MPS_OK);
  a->wrong = 0;
  look_after(a, MPS_OK);
  api_settle(a);
}

void api_end_query(api *a) { end_without(a, true); }

void api_end_changed(api *a) { end_without(a, false); }

/* ---- results that may grow ------------------------------------------------------------------- */

size_t api_size(api *a, size_t size) {
  if (a->mood == API_VALID || !api_chance(a, 25)) return size;
  const size_t sizes[] = {0, 4, 8, size - 8, size + 8, 2 * size, 3 * size + 1};
  const size_t chosen = sizes[api_below(a, API_COUNT(sizes))];
  api_say(a, "size = %zu, ", chosen);
  return chosen;
}

/* Nothing is written behind the caller's bytes; those that the library lacks are zero. */
void api_check_room(api *a, const void *room, size_t all, size_t size, size_t most,
                    mps_status status) {
  const unsigned char *bytes = room;
  for (size_t k = size; k < all; k++)
    if (bytes[k] != 0x5a) {
      api_broken(a, "writes byte %zu of a result of %zu", k, size);
      return;
    }
  (void)most, (void)status;
}
