/* keep.c - reduces a set to the particles of one rank, with a backup that restores the whole.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"

#include <string.h>

struct mpsi_storage {
  mpsi_field *field; /* the former ones, of the whole set */
  int32_t fields;
  int64_t count, capacity;
};

static void notify_holders(const mps_particles *p) {
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->renew && h->kind == MPSI_USE_LOOK) h->renew(h->self);
}

/* Builds the map from ids to rows again. */
static void index_ids(mps_particles *p) {
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  mpsi_ids_renew(&p->ids, p->next_id, p->count, id);
}

static void drop(mps_context *context, mpsi_storage *s) {
  for (int32_t f = 0; s && s->field && f < s->fields; f++) mpsi_free(context, s->field[f].block);
  if (s) mpsi_free(context, s->field);
  mpsi_free(context, s);
}

mps_status mpsi_particles_keep(mps_particles *p, const char *function, int64_t count,
                               const int64_t *rows, int64_t capacity, mpsi_storage **former) {
  mpsi_storage *s = *former = mpsi_alloc(p->context, 1, sizeof *s);
  if (s) s->field = mpsi_alloc(p->context, p->field_count, sizeof *s->field);
  bool good = s && s->field;
  for (int32_t f = 0; good && f < p->field_count; f++, s->fields++) {
    s->field[f] = *p->fields[f];
    s->field[f].block = mpsi_field_allocate(p->context, p->fields[f], capacity);
    good = s->field[f].block != NULL;
  }
  if (!good) {
    drop(p->context, s);
    *former = NULL;
    return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                     "could not allocate %d fields of %lld particles", p->field_count,
                     (long long)capacity);
  }
  for (int32_t f = 0; f < p->field_count; f++) {
    const mpsi_field before = *p->fields[f];
    mpsi_field_place(p->fields[f], s->field[f].block, capacity);
    for (int32_t c = 0; c < before.components; c++) {
      const char *from = mpsi_field_column(&before, c);
      char *to = mpsi_field_column(p->fields[f], c);
      for (int64_t k = 0; k < count; k++) memcpy(to + 8 * k, from + 8 * rows[k], 8);
    }
    s->field[f] = before;
  }
  s->count = p->count, s->capacity = p->capacity;
  p->count = count, p->capacity = capacity;
  index_ids(p);
  p->epoch++;
  notify_holders(p);
  return MPS_OK;
}

void mpsi_particles_take_back(mps_particles *p, mpsi_storage **former) {
  mpsi_storage *s = *former;
  *former = NULL;
  if (!s) return;
  mpsi_particles_drop_fields(p, s->fields);
  for (int32_t f = 0; f < s->fields; f++) {
    void *block = p->fields[f]->block;
    *p->fields[f] = s->field[f];
    s->field[f].block = block;
  }
  p->count = s->count, p->capacity = s->capacity;
  index_ids(p);
  notify_holders(p);
  drop(p->context, s);
}

void mpsi_storage_drop(mps_particles *p, mpsi_storage **former) {
  drop(p->context, *former);
  *former = NULL;
}
