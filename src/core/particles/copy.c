/* copy.c - a second set with the particles of another one.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"

#include <string.h>

static bool copy_field(const mps_particles *from, const mpsi_field *field, mps_particles *to) {
  mpsi_field *copy = mpsi_alloc(to->context, 1, sizeof *copy);
  void *block = copy ? mpsi_field_allocate(to->context, field, to->capacity) : NULL;
  if (!block) {
    mpsi_free(to->context, copy);
    return false;
  }
  *copy = *field;
  copy->former = NULL, copy->former_capacity = 0;
  copy->first_column = to->columns;
  mpsi_field_place(copy, block, to->capacity);
  for (int32_t c = 0; c < field->components && from->count > 0; c++)
    memcpy(mpsi_field_column(copy, c), mpsi_field_column(field, c), (size_t)from->count * 8);
  to->fields[to->field_count++] = copy;
  to->columns += copy->components;
  return true;
}

static bool copy_sites(const mpsi_site_runs *from, mps_particles *to) {
  if (from->count == 0) return true;
  to->sites.item = mpsi_alloc(to->context, from->count, sizeof *from->item);
  if (!to->sites.item) return false;
  memcpy(to->sites.item, from->item, (size_t)from->count * sizeof *from->item);
  to->sites.count = to->sites.capacity = from->count;
  return true;
}

/* All but the members that need memory. */
static mps_particles beginning_of(const mps_particles *from) {
  return (mps_particles){.context = from->context,
                         .def = from->def,
                         .count = from->count,
                         .capacity = from->count,
                         .epoch = 1,
                         .owned = true,
                         .next_id = from->next_id,
                         .ids = {.sparse = from->ids.sparse}};
}

mps_status mps_particles_copy(const mps_particles *particles, mps_particles **out) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_context *context = particles->context;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  const mps_status status = mpsi_particles_committed(particles, __func__);
  if (status != MPS_OK) return status;
  mps_particles *p = mpsi_alloc(context, 1, sizeof *p);
  if (!p) return mpsi_fail_memory(context, __func__, sizeof *p);
  *p = beginning_of(particles);
  (void)mpsi_context_retain(context);
  p->fields = mpsi_alloc(context, particles->field_count, sizeof *p->fields);
  bool good = p->fields && copy_sites(&particles->sites, p) &&
              mpsi_ids_reserve(context, &p->ids, 0, p->next_id, p->count);
  for (int32_t f = 0; good && f < particles->field_count; f++)
    good = copy_field(particles, particles->fields[f], p);
  if (!good) {
    mps_particles_destroy(&p);
    return mpsi_fail(context, __func__, MPS_ERROR_MEMORY,
                     "could not allocate %d fields of %lld particles", particles->field_count,
                     (long long)particles->count);
  }
  mpsi_ids_renew(&p->ids, p->next_id, p->count, p->fields[MPSI_FIELD_ID]->data);
  *out = p;
  return MPS_OK;
}
