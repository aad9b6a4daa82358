/* state.c - see state.h: copies of a solver's state, snapshots, and rollback.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "state_private.h"

#include "core/particles/particles_internal.h"

#include <string.h>

/* Into the memory that `out` has. */
static mps_status list(const mpsi_state_of *of, const char *function, mpsi_state *out) {
  *out = (mpsi_state){
      .context = of->context, .solver = of->solver, .item = out->item, .capacity = out->capacity};
  of->list(out, of->solver);
  if (of->list_also) of->list_also(out, of->solver);
  if (of->particles && mpsi_state_any_particles(of)) mpsi_particles_list_state(out, of->particles);
  if (!out->refused) return MPS_OK;
  return mpsi_fail_memory(of->context, function, (size_t)out->capacity * 2 * sizeof *out->item);
}

static mps_status reserve_values(const mpsi_state_of *of, const char *function, const mpsi_state *s,
                                 mps_snapshot *out) {
  bool good = mpsi_values_reserve(of->context, &out->state, s->count);
  for (int32_t k = 0; good && k < s->count; k++)
    good = mpsi_value_reserve(of->context, &out->state.item[k], s->item[k].type, s->item[k].rows,
                              s->item[k].columns);
  return good ? MPS_OK
              : mpsi_fail(of->context, function, MPS_ERROR_MEMORY,
                          "could not allocate the state of the solver: %d items", s->count);
}

static void read_values(const mpsi_state *s, mps_snapshot *out) {
  for (int32_t k = 0; k < s->count; k++) {
    const mpsi_state_item *from = &s->item[k];
    mpsi_value *to = &out->state.item[k];
    memcpy(to->name, from->name, sizeof to->name);
    to->type = from->type;
    to->agrees = from->agrees, to->table = from->table != NULL, to->text = from->text;
    to->optional = from->optional;
    to->columns = from->columns, to->rows = from->rows;
    mpsi_state_read_item(from, to->data);
  }
  out->state.count = s->count;
}

/* `status` is that of the call so far: the ranks of a solver that reads edits agree on it. A
 * snapshot that is filled again and again keeps the list's memory. */
static mps_status get(const mpsi_state_of *of, const char *function, mps_status status,
                      mps_snapshot *out, bool keeps) {
  mpsi_state s = {.item = NULL};
  if (keeps && out) s.item = out->list, s.capacity = out->list_capacity;
  if (status == MPS_OK && of->particles) status = mpsi_particles_ready(of->particles, function);
  if (status == MPS_OK) status = list(of, function, &s);
  if (status == MPS_OK) status = reserve_values(of, function, &s, out);
  if (of->take_in) status = of->take_in(of->solver, function, status);
  if (status == MPS_OK) read_values(&s, out);
  if (keeps && out)
    out->list = s.item, out->list_capacity = s.capacity;
  else
    mpsi_free(of->context, s.item);
  return status;
}

mps_status mpsi_state_get(const mpsi_state_of *of, const char *function, mps_snapshot *out) {
  return get(of, function, MPS_OK, out, false);
}

/* ---- snapshots ----------------------------------------------------------------------------- */

struct mpsi_identity {
  mps_context *context;
  int32_t shares; /* one thread at a time: no atomics */
};

void mpsi_state_forget(mpsi_identity **identity) {
  if (!*identity) return;
  mps_context *context = (*identity)->context;
  if (--(*identity)->shares == 0) {
    mpsi_free(context, *identity);
    mpsi_context_release(context);
  }
  *identity = NULL;
}

static mpsi_identity *identify(const mpsi_state_of *of) {
  if (!*of->identity) {
    mpsi_identity *made = mpsi_alloc(of->context, 1, sizeof *made);
    if (!made) return NULL;
    *made = (mpsi_identity){mpsi_context_retain(of->context), 1};
    *of->identity = made;
  }
  return *of->identity;
}

static mps_snapshot *new_snapshot(const mpsi_state_of *of) {
  mpsi_identity *identity = identify(of);
  mps_snapshot *made = identity ? mpsi_alloc(of->context, 1, sizeof *made) : NULL;
  if (!made) return NULL;
  made->context = mpsi_context_retain(of->context);
  made->identity = identity;
  identity->shares++;
  return made;
}

void mps_snapshot_destroy(mps_snapshot **snapshot) {
  if (!snapshot || !*snapshot) return;
  mps_snapshot *old = *snapshot;
  mps_context *context = old->context;
  *snapshot = NULL;
  mpsi_values_free(context, &old->state);
  mpsi_values_free(context, &old->fields);
  mpsi_state_forget(&old->identity);
  MPSI_FREE(context, old->list, old);
  mpsi_context_release(context);
}

static mps_status check_owner(const mpsi_state_of *of, const char *function,
                              const mps_snapshot *snapshot) {
  if (*of->identity && snapshot->identity == *of->identity) return MPS_OK;
  return mpsi_fail(of->context, function, MPS_ERROR_ARGUMENT,
                   "the snapshot is of another solver than this %s: each solver needs its own",
                   of->name);
}

/* Allocation comes first, so that a snapshot that is filled again is unchanged when memory is
 * refused: values of the state are written after the fields' memory is allocated. */
mps_status mpsi_state_snapshot(const mpsi_state_of *of, const char *function,
                               mps_snapshot **snapshot) {
  mps_snapshot *made = snapshot ? *snapshot : NULL;
  mps_status status = made ? check_owner(of, function, made) : MPS_OK;
  if (!snapshot)
    status = mpsi_fail(of->context, function, MPS_ERROR_ARGUMENT,
                       "snapshot is NULL, must be the "
                       "address of a pointer, which may be NULL at first");
  else if (!made && !(made = new_snapshot(of)))
    status = mpsi_fail_memory(of->context, function, sizeof *made);
  if (status == MPS_OK && of->particles)
    status = mpsi_particles_reserve_state(of->particles, function, made);
  status = get(of, function, status, made, true);
  if (status == MPS_OK && of->particles) mpsi_particles_get_state(of->particles, made);
  if (status != MPS_OK && snapshot && !*snapshot) mps_snapshot_destroy(&made);
  if (status == MPS_OK) *snapshot = made;
  return status;
}

mps_status mpsi_state_rollback(const mpsi_state_of *of, const char *function,
                               const mps_snapshot *snapshot) {
  mps_status status = MPS_OK;
  if (!snapshot)
    status = mpsi_fail(of->context, function, MPS_ERROR_ARGUMENT, "snapshot is NULL");
  else
    status = check_owner(of, function, snapshot);
  if (status == MPS_OK)
    return mpsi_state_restore_values(of, function, snapshot, "the snapshot", MPS_ERROR_STATE);
  return of->settle ? of->settle(of->solver, function, status)
                    : status; /* other ranks wait there */
}

mps_status mpsi_state_prepare_restore(const mpsi_state_of *of, const char *function,
                                      const mps_snapshot *snapshot, mpsi_state_prepared *out) {
  return mpsi_state_prepare(of, function, snapshot, "the snapshot", MPS_ERROR_STATE, out);
}

/* ---- rollback -------------------------------------------------------------------------------- */

/* One call. */
typedef struct restoring {
  const mpsi_state_of *of;
  const char *function, *source;
  mps_status status; /* of a disagreement */
} restoring;

static mps_status compare(const restoring *w, const mpsi_state_item *now, const mpsi_value *then) {
  mps_context *context = w->of->context;
  if (now->text) {
    if (strcmp(now->own.text, then->data) == 0) return MPS_OK;
    return mpsi_fail(context, w->function, w->status, "in %s %s is '%.60s', in this solver '%.60s'",
                     w->source, now->name, (const char *)then->data, now->own.text);
  }
  if (now->type == MPSI_STATE_I64) {
    const int64_t value = *(const int64_t *)then->data;
    if (value == now->own.integer) return MPS_OK;
    if (now->enumeration)
      return mpsi_fail(context, w->function, w->status, "in %s %s is %s, in this solver %s",
                       w->source, now->name, mpsi_name_of(now->enumeration, (int32_t)value).text,
                       mpsi_name_of(now->enumeration, (int32_t)now->own.integer).text);
    return mpsi_fail(context, w->function, w->status, "in %s %s is %lld, in this solver %lld",
                     w->source, now->name, (long long)value, (long long)now->own.integer);
  }
  const double value = *(const double *)then->data;
  if (value == now->own.number) return MPS_OK;
  return mpsi_fail(context, w->function, w->status, "in %s %s is %.17g, in this solver %.17g",
                   w->source, now->name, value, now->own.number);
}

/* The value that belongs to item k: nearly always number k. */
static const mpsi_value *value_of(const mps_snapshot *from, const mpsi_state *s, int32_t k) {
  if (k < from->state.count && strcmp(from->state.item[k].name, s->item[k].name) == 0)
    return &from->state.item[k];
  return mpsi_values_find(&from->state, s->item[k].name);
}

/* Of a table that both have. */
static mps_status match_optional(const restoring *w, const mpsi_state_item *now,
                                 const mpsi_value *then) {
  const bool text = now->type == MPSI_STATE_BYTES;
  if (then->rows == 0 || now->fits(now->owner, then->rows, then->data)) return MPS_OK;
  return mpsi_fail(w->of->context, w->function, text ? w->status : MPS_ERROR_FORMAT,
                   "in %s %s is %.*s, not that of this solver", w->source, now->name,
                   (int)(text ? then->rows : 9), text ? (const char *)then->data : "malformed");
}

static mps_status match(const restoring *w, const mpsi_state *s, const mps_snapshot *from) {
  int32_t needed = 0, there = 0;
  for (int32_t k = 0; k < from->state.count; k++) there += !from->state.item[k].optional;
  for (int32_t k = 0; k < s->count; k++) {
    const mpsi_state_item *now = &s->item[k];
    const mpsi_value *then = value_of(from, s, k);
    if (now->optional) {
      MPSI_TRY(then ? match_optional(w, now, then) : MPS_OK);
      continue;
    }
    needed++;
    const bool same = then && then->type == now->type && then->columns == now->columns &&
                      (now->table || then->rows == now->rows);
    if (!same)
      return mpsi_fail(w->of->context, w->function, w->status,
                       "%s has %s '%s', which this solver has", w->source,
                       then ? "another number of" : "no", now->name);
    MPSI_TRY(now->agrees ? compare(w, now, then) : MPS_OK);
    if (!mpsi_state_bounded(now, then))
      return mpsi_fail(w->of->context, w->function, MPS_ERROR_FORMAT,
                       "%s is malformed: its '%s' is beyond what a run can count", w->source,
                       now->name);
  }
  if (there == needed) return MPS_OK;
  return mpsi_fail(w->of->context, w->function, w->status, "%s has %d items, this solver %d",
                   w->source, there, needed);
}

mps_status mpsi_state_agree(const mpsi_state_of *of, const char *function, const mps_snapshot *from,
                            const char *source, mps_status disagreement) {
  const restoring w = {of, function, source, disagreement};
  mpsi_state s = {.item = NULL};
  mps_status status = list(of, function, &s);
  if (status == MPS_OK) status = match(&w, &s, from);
  mpsi_free(of->context, s.item);
  return status;
}

static bool reserve(const mpsi_state *s, const mps_snapshot *from) {
  for (int32_t k = 0; k < s->count; k++) {
    const mpsi_state_table *table = s->item[k].table;
    const mpsi_value *then = value_of(from, s, k);
    if (table && table->reserve && then &&
        !table->reserve(s->item[k].owner, then->rows, then->data))
      return false;
  }
  return true;
}

mps_status mpsi_state_prepare(const mpsi_state_of *of, const char *function,
                              const mps_snapshot *from, const char *source, mps_status disagreement,
                              mpsi_state_prepared *out) {
  const restoring w = {of, function, source, disagreement};
  mpsi_state s = {.item = NULL};
  *out = (mpsi_state_prepared){.from = from};
  mps_status status = list(of, function, &s);
  if (status == MPS_OK) status = match(&w, &s, from);
  const bool good = status == MPS_OK && reserve(&s, from) &&
                    (!of->particles || !of->reserve || of->reserve(of->solver, from->particles));
  if (status == MPS_OK && !good)
    status = mpsi_fail(of->context, function, MPS_ERROR_MEMORY,
                       "could not allocate the memory to restore %s", source);
  const int32_t fields = of->particles ? mps_particles_field_count(of->particles) : 0;
  if (status == MPS_OK && of->particles)
    status = mpsi_particles_prepare_state(of->particles, function, from, &out->scratch);
  const bool prepared = status == MPS_OK;
  if (status == MPS_OK && of->prepare)
    status = of->prepare(of->solver, function, from, source, disagreement);
  if (of->settle) status = of->settle(of->solver, function, status);
  if (prepared && status != MPS_OK && of->particles) {
    mpsi_particles_drop_prepared(of->particles, out->scratch);
    mpsi_particles_drop_fields(of->particles, fields);
  }
  if (status != MPS_OK) mpsi_free(of->context, s.item);
  if (status != MPS_OK) return status;
  out->item = s.item;
  out->count = s.count;
  return MPS_OK;
}

void mpsi_state_restore(const mpsi_state_of *of, mpsi_state_prepared *prepared) {
  const mps_snapshot *from = prepared->from;
  const mpsi_state s = {.item = prepared->item, .count = prepared->count};
  if (of->particles) mpsi_particles_put_state(of->particles, from, prepared->scratch);
  if (of->bind) of->bind(of->solver);
  for (int32_t k = 0; k < s.count; k++) mpsi_state_write_item(&s.item[k], value_of(from, &s, k));
  if (of->after) of->after(of->solver);
  mpsi_free(of->context, prepared->item);
  *prepared = (mpsi_state_prepared){.item = NULL};
}

mps_status mpsi_state_restore_values(const mpsi_state_of *of, const char *function,
                                     const mps_snapshot *from, const char *source,
                                     mps_status disagreement) {
  mpsi_state_prepared prepared;
  const mps_status status = mpsi_state_prepare(of, function, from, source, disagreement, &prepared);
  if (status == MPS_OK) mpsi_state_restore(of, &prepared);
  return status;
}
