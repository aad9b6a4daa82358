/* state_particles.c - the particle set's part of a state: number, ids, order and all fields.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"
#include "state.h"

#include <stdio.h>
#include <string.h>

_Static_assert(MPSI_STATE_NAME >= MPSI_FIELD_NAME, "a field's name fits");

static mpsi_state_type type_of(const mpsi_field *field) {
  return field->dtype.code == 0 ? MPSI_STATE_I64 : MPSI_STATE_F64;
}

/* ---- taking -------------------------------------------------------------------------------- */

mps_status mpsi_particles_reserve_state(mps_particles *p, const char *function, mps_snapshot *out) {
  bool good = mpsi_values_reserve(p->context, &out->fields, p->field_count);
  for (int32_t f = 0; good && f < p->field_count; f++)
    good = mpsi_value_reserve(p->context, &out->fields.item[f], type_of(p->fields[f]), p->count,
                              p->fields[f]->components);
  return good ? MPS_OK
              : mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                          "could not allocate %d fields of %lld particles", p->field_count,
                          (long long)p->count);
}

void mpsi_particles_get_state(const mps_particles *p, mps_snapshot *out) {
  out->particles = p->count;
  out->fields.count = p->field_count;
  for (int32_t f = 0; f < p->field_count; f++) {
    const mpsi_field *field = p->fields[f];
    mpsi_value *to = &out->fields.item[f];
    snprintf(to->name, sizeof to->name, "%s", field->name);
    to->type = type_of(field);
    to->columns = field->components;
    to->rows = p->count;
    for (int32_t c = 0; c < field->components; c++)
      memcpy((char *)to->data + 8 * c * p->count, mpsi_field_column(field, c),
             (size_t)p->count * 8);
  }
}

/* ---- going back ---------------------------------------------------------------------------- */

/* What the first phase hands to the second, where the order changes. */
typedef struct move {
  int64_t *from; /* present index of the particle that goes to each new index */
  double *column;
} move;

static bool same_order(const mps_particles *p, const int64_t *id) {
  return memcmp(id, p->fields[MPSI_FIELD_ID]->data, (size_t)p->count * 8) == 0;
}

static mps_status check_ids(const mps_particles *p, const char *function, const mps_snapshot *from,
                            const int64_t *id) {
  if (from->particles != p->count)
    return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                     "the state is of %lld particles, the set has %lld", (long long)from->particles,
                     (long long)p->count);
  for (int64_t k = 0; k < p->count; k++)
    if (mps_particles_index(p, id[k]) < 0)
      return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                       "the state has a particle of id %lld, the set has none", (long long)id[k]);
  if (p->pins > 1 && !same_order(p, id))
    return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                     "the set cannot be sorted: it is held by %d solvers", p->pins);
  return MPS_OK;
}

static mps_status check_fields(const mps_particles *p, const char *function,
                               const mps_snapshot *from) {
  for (int32_t f = 0; f < from->fields.count; f++) {
    const mpsi_value *then = &from->fields.item[f];
    const mpsi_field *now = mpsi_field_find(p, then->name);
    if (now && (now->components != then->columns || type_of(now) != then->type))
      return mpsi_fail(p->context, function, MPS_ERROR_FIELD,
                       "field '%s' has %d components, in the state to go back to %d", then->name,
                       now->components, then->columns);
  }
  return MPS_OK;
}

static mps_status add_missing(mps_particles *p, const char *function, const mps_snapshot *from) {
  const int32_t before = p->field_count;
  for (int32_t f = 0; f < from->fields.count; f++) {
    const mpsi_value *then = &from->fields.item[f];
    if (mpsi_field_find(p, then->name) ||
        mps_particles_add_field(p, then->name, then->columns) == MPS_OK)
      continue;
    mpsi_particles_drop_fields(p, before);
    return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                     "could not allocate field '%s' of %lld particles", then->name,
                     (long long)p->count);
  }
  return MPS_OK;
}

static void free_move(mps_context *context, move *m) {
  if (!m) return;
  mpsi_free(context, m->from);
  mpsi_free(context, m->column);
  mpsi_free(context, m);
}

static move *new_move(const mps_particles *p, const int64_t *id) {
  move *m = mpsi_alloc(p->context, 1, sizeof *m);
  if (!m) return NULL;
  m->from = mpsi_alloc(p->context, p->count, sizeof *m->from);
  m->column = mpsi_alloc(p->context, p->count, sizeof *m->column);
  if (!m->from || !m->column) {
    free_move(p->context, m);
    return NULL;
  }
  for (int64_t k = 0; k < p->count; k++) m->from[k] = mps_particles_index(p, id[k]);
  return m;
}

mps_status mpsi_particles_prepare_state(mps_particles *p, const char *function,
                                        const mps_snapshot *from, void **scratch) {
  const mpsi_value *id = mpsi_values_find(&from->fields, "id");
  *scratch = NULL;
  if (!id || id->type != MPSI_STATE_I64 || id->columns != 1)
    return mpsi_fail(p->context, function, MPS_ERROR_FORMAT, "the state has no ids of particles");
  mps_status status = check_ids(p, function, from, id->data);
  if (status == MPS_OK) status = check_fields(p, function, from);
  if (status != MPS_OK) return status;
  move *m = NULL;
  if (!same_order(p, id->data)) {
    m = new_move(p, id->data);
    if (!m) return mpsi_fail_memory(p->context, function, (size_t)p->count * 16);
  }
  status = add_missing(p, function, from);
  if (status == MPS_OK)
    *scratch = m;
  else
    free_move(p->context, m);
  return status;
}

/* A field that goes with its particles. */
static void carry(const mps_particles *p, const mpsi_field *field, const move *m) {
  for (int32_t c = 0; c < field->components; c++) {
    char *column = mpsi_field_column(field, c), *sorted = (char *)m->column;
    for (int64_t k = 0; k < p->count; k++) memcpy(sorted + 8 * k, column + 8 * m->from[k], 8);
    memcpy(column, sorted, (size_t)p->count * 8);
  }
}

void mpsi_particles_put_state(mps_particles *p, const mps_snapshot *from, void *scratch) {
  move *m = scratch;
  for (int32_t f = 0; f < p->field_count; f++) {
    const mpsi_field *field = p->fields[f];
    const mpsi_value *then = mpsi_values_find(&from->fields, field->name);
    if (!then && m) carry(p, field, m);
    for (int32_t c = 0; then && c < field->components; c++)
      memcpy(mpsi_field_column(field, c), (const char *)then->data + 8 * c * p->count,
             (size_t)p->count * 8);
  }
  if (!m) return; /* the order is the same, and views stay good */
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int64_t k = 0; k < p->count; k++) p->index_of[id[k]] = k;
  p->epoch++;
  free_move(p->context, m);
}
