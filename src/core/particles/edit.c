/* edit.c - access control of a set: editing of fields by the caller, and the solvers and recorders
 * that hold the set.
 *
 *   caller                      set                                holders
 *   mps_particles_edit ------>  field open: steps are refused
 *   writes through the view
 *   mps_particles_commit ---->  finite? in range? ------------->   commit(field): may refuse, else
 *                               field closed                       reads it before the next step
 *   mps_particles_abandon --->  former values, field closed
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"

#include "fields.h"
#include "core/base/hash.h"
#include "core/definition/digits.h"

#include <stdio.h>
#include <string.h>

/* ---- holders --------------------------------------------------------------------------------- */

static const mpsi_holder *holder_in_the_way(const mps_particles *p, mpsi_use kind) {
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (kind != MPSI_USE_LOOK && h->kind != MPSI_USE_LOOK &&
        (kind == MPSI_USE_MOVE || h->kind == MPSI_USE_MOVE))
      return h;
  return NULL;
}

mps_status mpsi_particles_check_hold(const mps_particles *p, const char *function, mpsi_use kind) {
  MPSI_TRY(mpsi_particles_ready(p, function));
  const mpsi_holder *other = holder_in_the_way(p, kind);
  if (!other) return MPS_OK;
  return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                   "the particle set is held by %s: destroy that first, or use a set of its own",
                   other->name);
}

mps_status mpsi_particles_hold(mps_particles *p, const char *function, mpsi_holder *holder) {
  MPSI_TRY(mpsi_particles_check_hold(p, function, holder->kind));
  holder->next = p->holders;
  p->holders = holder;
  return MPS_OK;
}

int64_t mpsi_particles_runs(const mps_particles *p, int32_t rank, mpsi_row_run *out) {
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->runs) return h->runs(h->self, out);
  if (out) *out = (mpsi_row_run){.at = {0, 0, rank}, .rows = p->count};
  return 1;
}

mps_status mpsi_particles_outside_callbacks(const mps_particles *p, const char *function) {
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->guard && h->guard->callback)
      return mpsi_fail(
          p->context, function, MPS_ERROR_STATE,
          "the particle set is held by %s, which is in %s: a callback may only read it", h->name,
          h->guard->callback);
  return MPS_OK;
}

mps_status mpsi_particles_writable(const mps_particles *p, const char *function) {
  MPSI_TRY(mpsi_particles_outside_callbacks(p, function));
  return mpsi_particles_ready(p, function);
}

void mpsi_particles_release(mps_particles *p, mpsi_holder *holder) {
  if (!p) return;
  mpsi_holder **link = &p->holders;
  while (*link && *link != holder) link = &(*link)->next;
  if (!*link) return; /* it never held the set */
  *link = holder->next;
  mpsi_particles_free_if_unused(p);
}

/* ---- checks of values ------------------------------------------------------------------------ */

typedef struct range {
  const char *name;
  double lower, upper;
} range;

static range range_of(const char *name) {
#define ROW(name, lower, upper) {#name, lower, upper},
  static const range ranges[] = {MPSI_FIELD_RANGES(ROW)};
#undef ROW
  for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++)
    if (strcmp(ranges[k].name, name) == 0) return ranges[k];
  return (range){name, -MPSI_LARGEST, MPSI_LARGEST};
}

/* `what`: the argument; `particle`: -1 of all of them. */
static mps_status check_value(const mps_particles *p, const char *function, const char *what,
                              const mpsi_field *field, range r, double value, int64_t particle) {
  if (value >= r.lower && value <= r.upper) return MPS_OK;
  char whose[48] = "";
  if (particle >= 0) snprintf(whose, sizeof whose, " of particle %lld", (long long)particle);
  (void)mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                  "%s of field '%s'%s is %s%s%s, allowed are %g to %g", what, field->name, whose,
                  mpsi_outside(value, r.lower, r.upper).text, *field->unit ? " " : "",
                  strcmp(field->unit, "-") == 0 ? "" : field->unit, r.lower, r.upper);
  mpsi_fail_where(p->context, -1, particle);
  mpsi_fail_object(p->context, "field '%s'", field->name);
  return MPS_ERROR_ARGUMENT;
}

/* MPS_ERROR_ARGUMENT unless `value` is one that the caller may give the field. */
static mps_status check_field_value(const mps_particles *p, const char *function,
                                    const mpsi_field *field, double value) {
  return check_value(p, function, "value", field, range_of(field->name), value, -1);
}

static mps_status check_field(const mps_particles *p, const char *function,
                              const mpsi_field *field) {
  if (field->dtype.code != 2) return MPS_OK;
  const range r = range_of(field->name);
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int32_t c = 0; c < field->components; c++) {
    const double *value = mpsi_field_column(field, c);
    for (int64_t k = 0; k < p->count; k++) {
      MPSI_TRY(check_value(p, function, "edit", field, r, value[k], id[k]));
    }
  }
  return MPS_OK;
}

mps_status mpsi_particles_notify(mps_particles *p, const char *function, const char *field,
                                 const double *former) {
  for (mpsi_holder *h = p->holders; h; h = h->next)
    if (h->commit)
      MPSI_TRY(mpsi_fail_of(p->context,
                            h->commit(h->self, function, field,
                                      h->compares && h->compares(h->self, field) ? former : NULL),
                            "particles"));
  return MPS_OK;
}

/* ---- editing --------------------------------------------------------------------------------- */

/* Copies a field to its backup, or back. */
static void copy_former(const mps_particles *p, mpsi_field *field, bool back) {
  for (int32_t c = 0; c < field->components; c++) {
    char *column = mpsi_field_column(field, c), *kept = (char *)(field->former + c * p->count);
    memcpy(back ? column : kept, back ? kept : column, (size_t)p->count * 8);
  }
}

/* Keeps a backup of a field before an edit; its memory is reused. */
static mps_status keep_former(mps_particles *p, const char *function, mpsi_field *field) {
  const int64_t items = field->components * p->count;
  if (items > field->former_capacity || !field->former) {
    double *former = mpsi_alloc(p->context, items, sizeof *former);
    if (!former) return mpsi_fail_memory(p->context, function, (size_t)items * 8);
    mpsi_free(p->context, field->former);
    field->former = former;
    field->former_capacity = items;
  }
  copy_former(p, field, false);
  return MPS_OK;
}

mps_status mps_particles_edit(mps_particles *particles, const char *name, mps_edit *out) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_context *context = particles->context;
  if (out) out->data = NULL;
  MPSI_TRY(mpsi_as(particles->context, __func__,
                   mps_particles_view(particles, name, out ? &out->view : NULL)));
  mpsi_field *field = mpsi_field_find(particles, name);
  const char *reason = NULL;
  if (field->flags & MPS_VIEW_READONLY) reason = "is written by the library only";
  if (field->open) reason = "is being edited already: mps_particles_commit ends that";
  if (reason) {
    memset(out, 0, sizeof *out);
    (void)mpsi_fail(context, __func__, field->open ? MPS_ERROR_STATE : MPS_ERROR_FIELD,
                    "field '%s' %s", name, reason);
    mpsi_fail_object(context, "field '%s'", name);
    return field->open ? MPS_ERROR_STATE : MPS_ERROR_FIELD;
  }
  mps_status status = mpsi_particles_outside_callbacks(particles, __func__);
  if (status == MPS_OK) status = keep_former(particles, __func__, field);
  if (status != MPS_OK) {
    memset(out, 0, sizeof *out);
    return status;
  }
  field->open = true;
  particles->open_edits++;
  out->data = field->data;
  out->view.flags &= ~MPS_VIEW_READONLY;
  return MPS_OK;
}

/* The open field of `edit`; NULL with an error recorded. */
static mpsi_field *find_open(const mps_particles *p, const char *function, const mps_edit *edit) {
  if (!edit) {
    (void)mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT, "edit is NULL");
    return NULL;
  }
  for (int32_t f = 0; f < p->field_count; f++)
    if (p->fields[f]->open && p->fields[f]->data == edit->data) return p->fields[f];
  (void)mpsi_fail(p->context, function, MPS_ERROR_STATE,
                  "edit is not of a field that is being edited: mps_particles_edit gives it");
  return NULL;
}

static void close_field(mps_particles *p, mpsi_field *field, mps_edit *edit) {
  field->open = false;
  p->open_edits--;
  edit->data = NULL;
  edit->view.flags |= MPS_VIEW_READONLY;
}

mps_status mps_particles_commit(mps_particles *particles, mps_edit *edit) {
  if (!particles) return mpsi_null(__func__, "particles");
  mpsi_field *field = find_open(particles, __func__, edit);
  if (!field) return mps_context_error(particles->context)->status;
  mps_status status = check_field(particles, __func__, field);
  if (status == MPS_OK)
    status = mpsi_particles_notify(particles, __func__, field->name, field->former);
  if (status == MPS_OK) close_field(particles, field, edit);
  return status;
}

mps_status mps_particles_abandon(mps_particles *particles, mps_edit *edit) {
  if (!particles) return mpsi_null(__func__, "particles");
  mpsi_field *field = find_open(particles, __func__, edit);
  if (!field) return mps_context_error(particles->context)->status;
  copy_former(particles, field, true);
  close_field(particles, field, edit);
  return MPS_OK;
}

/* ---- removing a field ------------------------------------------------------------------------ */

/* Solvers look up fields of the table and histories when they please. */
static const mpsi_holder *holder_that_uses(const mps_particles *p, const char *name) {
  const bool own = mpsi_field_owner_of(name) == MPSI_FIELD_OF_CALLER;
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->uses ? h->uses(h->self, name) : !own) return h;
  return NULL;
}

mps_status mps_particles_remove_field(mps_particles *particles, const char *name) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_context *context = particles->context;
  if (!name) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "name is NULL");
  mps_status status = mpsi_particles_writable(particles, __func__);
  if (status != MPS_OK) return status;
  mpsi_field *field = mpsi_field_find(particles, name);
  if (!field) return mpsi_field_fail_unknown(particles, __func__, name);
  const mpsi_holder *user = holder_that_uses(particles, name);
  if (strcmp(name, "id") == 0 || strcmp(name, "position") == 0)
    status = mpsi_fail(context, __func__, MPS_ERROR_STATE, "every set has the field '%s'", name);
  else if (user)
    status = mpsi_fail(context, __func__, MPS_ERROR_STATE,
                       "field '%s' is used by %s, which holds the set: destroy that first", name,
                       user->name);
  if (status != MPS_OK) {
    mpsi_fail_object(context, "field '%s'", name);
    return status;
  }
  mpsi_field_drop(particles, field);
  particles->epoch++;
  return MPS_OK;
}

/* ---- values without an edit ------------------------------------------------------------------ */

/* Writes `columns` columns from `first` on, of values[i * step] and the following ones; on a
 * holder's error they are as before. */
static mps_status write_columns(mps_particles *p, const char *function, mpsi_field *field,
                                int32_t first, int32_t columns, const double *values,
                                int64_t step) {
  mps_status status = p->holders ? keep_former(p, function, field) : MPS_OK;
  if (status != MPS_OK) return status;
  for (int32_t c = 0; c < columns; c++) {
    void *column = mpsi_field_column(field, first + c);
    for (int64_t i = 0; i < p->count; i++) {
      const double value = values[i * step + c];
      if (field->dtype.code == 2)
        ((double *)column)[i] = value;
      else
        ((int64_t *)column)[i] = (int64_t)value;
    }
  }
  if (!p->holders) return MPS_OK;
  status = mpsi_particles_notify(p, function, field->name, field->former);
  if (status != MPS_OK) copy_former(p, field, true);
  return status;
}

/* Constants of a set in parts must be the same on all ranks: solvers compare the hash. */
static uint64_t note_constant(uint64_t hash, const char *name, int32_t component, double value) {
  hash = mpsi_hash(hash, name, strlen(name) + 1);
  hash = mpsi_hash(hash, &component, sizeof component);
  return mpsi_hash(hash, &value, sizeof value);
}

mps_status mps_particles_set(mps_particles *particles, const char *name, int32_t component,
                             double value) {
  if (!particles) return mpsi_null(__func__, "particles");
  if (!name) return mpsi_fail(particles->context, __func__, MPS_ERROR_ARGUMENT, "name is NULL");
  mpsi_field shape;
  MPSI_TRY(mpsi_particles_outside_callbacks(particles, __func__));
  MPSI_TRY(mpsi_field_look_up(particles, __func__, name, &shape));
  if (shape.dtype.code != 2)
    return mpsi_fail(
        particles->context, __func__, MPS_ERROR_FIELD,
        "field '%s' is of int64, only float64 fields can be set: use mps_particles_edit", name);
  if (component != 0 && shape.components == 1)
    return mpsi_fail(particles->context, __func__, MPS_ERROR_ARGUMENT,
                     "component of field '%s' is %d, and the field has one alone: 0", name,
                     component);
  if (component < 0 || component >= shape.components)
    return mpsi_fail(particles->context, __func__, MPS_ERROR_ARGUMENT,
                     "component of field '%s' is %d, allowed are 0 to %d", name, component,
                     shape.components - 1);
  const bool present = mpsi_field_find(particles, name) != NULL;
  if (present && shape.open) return mpsi_particles_ready(particles, __func__);
  const int32_t fields = particles->field_count;
  mps_status status = check_field_value(particles, __func__, &shape, value);
  if (status == MPS_OK && !present)
    status = mpsi_as(particles->context, __func__, mps_particles_add_field(particles, name, 0));
  if (status == MPS_OK)
    status = write_columns(particles, __func__, mpsi_field_find(particles, name), component, 1,
                           &value, 0);
  if (status == MPS_OK && particles->deal)
    particles->deal->constants = note_constant(particles->deal->constants, name, component, value);
  if (status != MPS_OK) mpsi_particles_drop_fields(particles, fields);
  return status;
}

/* Finite, in the field's range, and whole where the field is of whole numbers. */
static mps_status check_values(const mps_particles *p, const char *function,
                               const mpsi_field *field, int32_t columns, const double *values) {
  static const range whole = {"", -0x1p53, 0x1p53};
  const bool integers = field->dtype.code == 0;
  const range r = integers ? whole : range_of(field->name);
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int64_t k = 0; k < p->count * columns; k++) {
    const int64_t particle = id[k / columns];
    const mps_status status = check_value(p, function, "values", field, r, values[k], particle);
    if (status != MPS_OK) return status;
    if (!integers || values[k] == nearbyint(values[k])) continue;
    (void)mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                    "values of field '%s' of particle %lld is %g, must be a whole number",
                    field->name, (long long)particle, values[k]);
    mpsi_fail_where(p->context, -1, particle);
    return MPS_ERROR_ARGUMENT;
  }
  return MPS_OK;
}

mps_status mpsi_field_write(mps_particles *p, const char *function, const char *name,
                            const mpsi_field *shape, int32_t component, const double *values) {
  const int32_t fields = p->field_count, first = component < 0 ? 0 : component;
  const int32_t columns = component < 0 ? shape->components : 1;
  if (shape->open) return mpsi_particles_committed(p, function);
  if (shape->flags & MPS_VIEW_READONLY)
    return mpsi_fail(p->context, function, MPS_ERROR_FIELD,
                     "field '%s' is written by the library only", name);
  mps_status status = check_values(p, function, shape, columns, values);
  if (status == MPS_OK) status = mpsi_particles_add_field(p, function, name, shape->components);
  if (status == MPS_OK)
    status = write_columns(p, function, mpsi_field_find(p, name), first, columns, values, columns);
  if (status != MPS_OK) mpsi_particles_drop_fields(p, fields);
  return status;
}

mps_status mps_particles_set_array(mps_particles *particles, const char *name, int32_t component,
                                   const double *values, int64_t count) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_context *context = particles->context;
  if (!name) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "name is NULL");
  mpsi_field shape;
  mps_status status = mpsi_particles_outside_callbacks(particles, __func__);
  if (status == MPS_OK) status = mpsi_field_look_up(particles, __func__, name, &shape);
  if (status != MPS_OK) return status;
  if (component < -1 || component >= shape.components)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "component of field '%s' is %d, allowed are -1 (all) to %d", name, component,
                     shape.components - 1);
  if (count != particles->count)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "count is %lld, must be the number of particles, %lld", (long long)count,
                     (long long)particles->count);
  if (count > 0 && !values)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "values is NULL");
  status = check_values(particles, __func__, &shape, component < 0 ? shape.components : 1, values);
  return status == MPS_OK ? mpsi_field_write(particles, __func__, name, &shape, component, values)
                          : status;
}
