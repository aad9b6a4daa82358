/* fields.c - fields of a particle set: the storage of a field, and views of it.
 *
 * Storage: a loop over particles reads many columns side by side. Columns that start at the same
 * offset in a 4 KiB page would compete for the same few lines of the first-level cache, and a load
 * would wait for the store to another column at the same offset. Large blocks are page aligned, so
 * each column starts STAGGER lines later in its page than the previous one.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"

#include <stdio.h>
#include <string.h>

#define LINE_ITEMS (MPSI_ALIGNMENT / 8) /* items of 8 bytes in a cache line */
#define PAGE_LINES 64
#define PAGE_ITEMS (PAGE_LINES * LINE_ITEMS)
#define STAGGER 5 /* lines; odd, so that all 64 places of a page are used before one repeats */
#define MAX_COMPONENTS 16

/* The layout of a view is frozen: bindings repeat it. */
_Static_assert(sizeof(mps_dtype) == 4, "mps_dtype is DLPack's DLDataType");
_Static_assert(offsetof(mps_view, data) == 0 && offsetof(mps_view, shape) == 8 &&
                   offsetof(mps_view, stride) == 32 && offsetof(mps_view, dtype) == 56 &&
                   offsetof(mps_view, flags) == 60 && offsetof(mps_view, epoch) == 64 &&
                   offsetof(mps_view, device_type) == 72 && offsetof(mps_view, device_id) == 76 &&
                   sizeof(mps_view) == 80,
               "mps_view has a frozen layout");
_Static_assert(offsetof(mps_edit, data) == 0 && offsetof(mps_edit, view) == 8 &&
                   sizeof(mps_edit) == 88,
               "mps_edit has a frozen layout");

static bool is_f64(mps_dtype dtype) { return dtype.code == 2; }

/* ---- storage --------------------------------------------------------------------------------- */

static int64_t column_stride(int64_t capacity) {
  const int64_t least = capacity + MPSI_PARTICLES_PADDING, offset = STAGGER * LINE_ITEMS;
  return (least - offset + PAGE_ITEMS - 1) / PAGE_ITEMS * PAGE_ITEMS + offset;
}

void *mpsi_field_allocate(mps_context *context, const mpsi_field *field, int64_t capacity) {
  return mpsi_alloc(context, field->components * column_stride(capacity) + PAGE_ITEMS, 8);
}

void mpsi_field_place(mpsi_field *field, void *block, int64_t capacity) {
  const uint64_t have = (uintptr_t)block / MPSI_ALIGNMENT;
  const uint64_t want = (uint64_t)field->first_column * STAGGER;
  field->block = block;
  field->data = (char *)block + (want - have) % PAGE_LINES * MPSI_ALIGNMENT;
  field->stride = column_stride(capacity);
}

/* Moves a field of `count` particles into a block of mpsi_field_allocate. */
static void move_field(mps_context *context, mpsi_field *field, void *block, int64_t count,
                       int64_t capacity) {
  mpsi_field moved = *field;
  mpsi_field_place(&moved, block, capacity);
  for (int32_t c = 0; c < field->components && count > 0; c++)
    memcpy(mpsi_field_column(&moved, c), mpsi_field_column(field, c), (size_t)count * 8);
  mpsi_free(context, field->block);
  *field = moved;
}

mpsi_field *mpsi_field_find(const mps_particles *particles, const char *name) {
  for (int32_t f = 0; f < particles->field_count; f++)
    if (strcmp(particles->fields[f]->name, name) == 0) return particles->fields[f];
  return NULL;
}

double *mpsi_particles_column(mps_particles *particles, const char *name, int32_t component) {
  const mpsi_field *field = mpsi_field_find(particles, name);
  if (!field || !is_f64(field->dtype) || component < 0 || component >= field->components)
    return NULL;
  return mpsi_field_column(field, component);
}

int64_t *mpsi_particles_integers(mps_particles *particles, const char *name) {
  const mpsi_field *field = mpsi_field_find(particles, name);
  return field && field->dtype.code == 0 ? mpsi_field_column(field, 0) : NULL;
}

/* ---- ready ----------------------------------------------------------------------------------- */

mps_status mpsi_particles_committed(const mps_particles *p, const char *function) {
  for (int32_t f = 0; p->open_edits > 0 && f < p->field_count; f++) {
    if (!p->fields[f]->open) continue;
    (void)mpsi_fail(p->context, function, MPS_ERROR_STATE,
                    "field '%s' is being edited: mps_particles_commit ends that",
                    p->fields[f]->name);
    mpsi_fail_object(p->context, "field '%s'", p->fields[f]->name);
    return MPS_ERROR_STATE;
  }
  return MPS_OK;
}

mps_status mpsi_particles_ready(const mps_particles *p, const char *function) {
  MPSI_TRY(mpsi_particles_committed(p, function));
  return mpsi_executor_check(p->context, function);
}

/* ---- adding ---------------------------------------------------------------------------------- */

static mps_status insert_field(mps_particles *p, const char *function, const mpsi_field *like) {
  mpsi_field *field = mpsi_alloc(p->context, 1, sizeof *field);
  if (!field) return mpsi_fail_memory(p->context, function, sizeof *field);
  *field = *like;
  field->first_column = p->columns;
  void *block = mpsi_field_allocate(p->context, field, p->capacity);
  void *list = p->fields;
  if (!block ||
      !mpsi_grow(p->context, &list, p->field_count, p->field_count + 1, sizeof *p->fields)) {
    MPSI_FREE(p->context, block, field);
    return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                     "could not allocate field '%s' of %lld particles", like->name,
                     (long long)p->capacity);
  }
  move_field(p->context, field, block, 0, p->capacity);
  p->fields = list;
  p->fields[p->field_count++] = field;
  p->columns += field->components;
  return MPS_OK;
}

static mps_status describe_other_field(const mps_particles *p, const char *function,
                                       const char *name, int32_t components, bool of_law,
                                       mpsi_field *out) {
  if (components < 1 || components > MAX_COMPONENTS)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "components of field '%s' is %d, allowed are 1 to %d", name, components,
                     MAX_COMPONENTS);
  *out = (mpsi_field){.unit = "",
                      .meaning = of_law ? "history of a law" : "field of the caller",
                      .dtype = {2, 64, 1},
                      .components = components};
  return MPS_OK;
}

/* Description of a field of this name and number of components (0: the table's). `histories`: that
 * of a law is one, too. */
static mps_status describe_field(const mps_particles *p, const char *function, const char *name,
                                 int32_t components, bool histories, mpsi_field *out) {
  const mpsi_field_row *row = mpsi_field_row_of(name);
  const mpsi_field_owner owner = mpsi_field_owner_of(name);
  if (owner == MPSI_FIELD_UNKNOWN || (owner == MPSI_FIELD_OF_LAW && !histories))
    return mpsi_field_refuse_name(p->context, function, name);
  if (row) {
    const int32_t expected = mpsi_field_row_components(row, p->def.dim);
    if (components != 0 && components != expected)
      return mpsi_fail(
          p->context, function, MPS_ERROR_FIELD,
          "components of field '%s' is %d, allowed in %dD are 0 (as documented) and %d", name,
          components, p->def.dim, expected);
    *out = (mpsi_field){
        .unit = row->unit, .meaning = row->meaning, .dtype = row->dtype, .components = expected};
    if (strcmp(name, "id") == 0 || strcmp(name, "material") == 0) out->flags = MPS_VIEW_READONLY;
  } else {
    MPSI_TRY(describe_other_field(p, function, name, components, owner == MPSI_FIELD_OF_LAW, out));
  }
  snprintf(out->name, sizeof out->name, "%s", name);
  return MPS_OK;
}

static mps_status add_field(mps_particles *p, const char *function, const char *name,
                            int32_t components, bool histories) {
  mpsi_field field = {0};
  const mpsi_field *present = mpsi_field_find(p, name);
  MPSI_TRY(describe_field(p, function, name, components, histories || present, &field));
  if (!present) return insert_field(p, function, &field);
  if (present->components != field.components)
    return mpsi_fail(p->context, function, MPS_ERROR_FIELD,
                     "components is %d, but field '%s' exists with %d", components, name,
                     present->components);
  return MPS_OK;
}

mps_status mps_particles_add_field(mps_particles *particles, const char *name, int32_t components) {
  if (!particles) return mpsi_null(__func__, "particles");
  if (!name) return mpsi_fail(particles->context, __func__, MPS_ERROR_ARGUMENT, "name is NULL");
  return add_field(particles, __func__, name, components, false);
}

mps_status mpsi_particles_add_field(mps_particles *particles, const char *function,
                                    const char *name, int32_t components) {
  return add_field(particles, function, name, components, true);
}

/* ---- removing -------------------------------------------------------------------------------- */

void mpsi_field_drop(mps_particles *p, mpsi_field *field) {
  int32_t kept = 0;
  for (int32_t f = 0; f < p->field_count; f++)
    if (p->fields[f] != field) p->fields[kept++] = p->fields[f];
  p->field_count = kept;
  p->columns -= field->components;
  mpsi_free(p->context, field->block);
  mpsi_free(p->context, field->former);
  mpsi_free(p->context, field);
}

void mpsi_particles_drop_fields(mps_particles *particles, int32_t keep) {
  while (particles->field_count > keep)
    mpsi_field_drop(particles, particles->fields[particles->field_count - 1]);
}

/* ---- looking --------------------------------------------------------------------------------- */

mps_status mpsi_field_fail_unknown(const mps_particles *p, const char *function, const char *name) {
  char names[260] = "", own[MPSI_FIELD_NAME], advice[120] = "";
  size_t used = 0;
  for (int32_t f = 0; f < p->field_count && used < sizeof names; f++)
    used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", f ? ", " : "",
                             p->fields[f]->name);
  const char *near = mpsi_field_nearest(name);
  (void)snprintf(own, sizeof own, MPSI_FIELD_OWN "%.60s", name);
  if (mpsi_field_find(p, own))
    (void)snprintf(advice, sizeof advice, " (write %s)", own);
  else if (mpsi_field_owner_of(name) == MPSI_FIELD_OF_CALLER)
    (void)snprintf(advice, sizeof advice, " (mps_particles_add_field adds it)");
  else if (near && strcmp(near, name) == 0)
    (void)snprintf(advice, sizeof advice, " here, as no solver of the set has made it");
  else if (near)
    (void)snprintf(advice, sizeof advice, " (is '%s' meant?)", near);
  return mpsi_fail(p->context, function, MPS_ERROR_FIELD, "no field '%.60s'%s; the set has: %s",
                   name, advice, names);
}

int32_t mps_particles_has_field(const mps_particles *particles, const char *name) {
  return particles && name && mpsi_field_find(particles, name) != NULL;
}

mps_status mps_particles_view(mps_particles *particles, const char *name, mps_view *out) {
  if (!particles) return mpsi_null(__func__, "particles");
  if (!name || !out)
    return mpsi_fail(particles->context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     name ? "out" : "name");
  memset(out, 0, sizeof *out);
  const mpsi_field *field = mpsi_field_find(particles, name);
  if (!field) return mpsi_field_fail_unknown(particles, __func__, name);
  *out = (mps_view){.data = field->data,
                    .shape = {particles->count, field->components, 1},
                    .stride = {1, field->stride, 1},
                    .dtype = field->dtype,
                    .flags = field->flags | MPS_VIEW_READONLY,
                    .epoch = particles->epoch};
  return MPS_OK;
}

mps_status mpsi_field_look_up(const mps_particles *p, const char *function, const char *name,
                              mpsi_field *out) {
  const mpsi_field *field = mpsi_field_find(p, name);
  if (!field && !mpsi_field_row_of(name)) return mpsi_field_fail_unknown(p, function, name);
  if (!field) return describe_field(p, function, name, 0, false, out);
  *out = *field;
  return MPS_OK;
}

int32_t mps_particles_field_count(const mps_particles *particles) {
  return particles ? particles->field_count : 0;
}

mps_status mps_particles_get_field_info_sized(const mps_particles *particles, int32_t index,
                                              mps_particles_field_info *out, size_t size) {
  static const char function[] = "mps_particles_get_field_info";
  if (!particles) return mpsi_null(__func__, "particles");
  if (index < 0 || index >= particles->field_count)
    return mpsi_fail(particles->context, function, MPS_ERROR_ARGUMENT,
                     "index is %d, allowed are 0 to %d", index, particles->field_count - 1);
  const mpsi_field *field = particles->fields[index];
  const mps_particles_field_info info = {.name = field->name,
                                         .unit = field->unit,
                                         .meaning = field->meaning,
                                         .dtype = field->dtype,
                                         .components = field->components,
                                         .flags = field->flags};
  return mpsi_out_write(particles->context, function, out, size, &info, sizeof info);
}
