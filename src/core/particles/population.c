/* population.c - addition and removal of particles, also while solvers hold the set, and the backup
 * for a failed creation of a solver. SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"

#include "core/base/hash.h"

#include <string.h>

/* Also after an error: a holder that had agreed uses the columns' new memory. */
static void renew_holders(const mps_particles *p) {
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->renew) h->renew(h->self);
}

/* Vector loops read zeros behind the last particle. */
static void clear_tail(mps_particles *p, int64_t count) {
  for (int32_t f = 0; f < p->field_count; f++)
    for (int32_t c = 0; c < p->fields[f]->components; c++)
      memset((char *)mpsi_field_column(p->fields[f], c) + 8 * p->count, 0, (size_t)count * 8);
}

/* ---- coming ---------------------------------------------------------------------------------- */

mps_status mpsi_particles_check_free(const mps_particles *p, const char *function) {
  MPSI_TRY(mpsi_particles_writable(p, function));
  const char *holder = NULL;
  for (const mpsi_holder *h = p->holders; h && !holder; h = h->next)
    if (!h->insert && h->kind != MPSI_USE_LOOK) holder = h->name;
  if (!holder) return MPS_OK;
  return mpsi_fail(
      p->context, function, MPS_ERROR_STATE,
      "the particle set is held by %s, which takes no more particles: destroy it first", holder);
}

/* Gets memory for so many particles; false: no memory, and nothing has changed. The columns have
 * then moved, and their former memory is kept until finish_columns, which frees it or moves the
 * columns back: then the caller's views are valid again. */
static bool reserve(mps_particles *p, int64_t capacity) {
  mps_context *context = p->context;
  mpsi_column_place *places = mpsi_alloc(context, p->field_count, sizeof *places);
  bool good = places != NULL;
  for (int32_t f = 0; good && f < p->field_count; f++)
    good = (places[f].block = mpsi_field_allocate(context, p->fields[f], capacity)) != NULL;
  for (int32_t f = 0; places && !good && f < p->field_count; f++)
    mpsi_free(context, places[f].block);
  if (!good) {
    mpsi_free(context, places);
    return false;
  }
  for (int32_t f = 0; f < p->field_count; f++) {
    const mpsi_field before = *p->fields[f];
    mpsi_field_place(p->fields[f], places[f].block, capacity);
    for (int32_t c = 0; c < before.components && p->count > 0; c++)
      memcpy(mpsi_field_column(p->fields[f], c), mpsi_field_column(&before, c),
             (size_t)p->count * 8);
    places[f] = (mpsi_column_place){before.block, before.data, before.stride};
  }
  p->former = places, p->former_capacity = p->capacity;
  p->capacity = capacity;
  return true;
}

static void finish_columns(mps_particles *p, bool moved) {
  if (!p->former) return;
  for (int32_t f = 0; f < p->field_count; f++) {
    mpsi_field *field = p->fields[f];
    const mpsi_column_place former = p->former[f];
    mpsi_free(p->context, moved ? former.block : field->block);
    if (moved) continue;
    field->block = former.block, field->data = former.data, field->stride = former.stride;
  }
  if (!moved) p->capacity = p->former_capacity;
  mpsi_free(p->context, p->former);
  p->former = NULL;
}

mps_status mpsi_particles_extend_part(mps_particles *p, const char *function, int64_t count,
                                      int64_t here) {
  p->came = 0;
  if (count > MPSI_MAX_PARTICLES - p->count || count > MPSI_MAX_PARTICLES - p->next_id)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "%lld particles to add to %lld, a set holds at most 2^40", (long long)count,
                     (long long)p->count);
  const int64_t needed = p->count + here;
  if (p->ids.sparse && needed > MPSI_IDS_MOST)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "%lld particles of a set in parts would lie on one rank, at most %d may",
                     (long long)needed, MPSI_IDS_MOST);
  if (!mpsi_ids_reserve(p->context, &p->ids, p->next_id, p->next_id + count, needed))
    /* before the columns, which have views, move */
    return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                     "could not allocate the numbers of %lld particles", (long long)count);
  if (needed > p->capacity) {
    /* The first fill gets exactly its size; later growth is by half at least. */
    const int64_t half_more = p->capacity + p->capacity / 2;
    if (!reserve(p, needed > half_more ? needed : half_more))
      return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                       "could not allocate %d fields of %lld particles", p->field_count,
                       (long long)needed);
  }
  p->next_id += p->came = count;
  if (count == 0) return MPS_OK;
  p->count = needed;
  p->epoch++;
  return MPS_OK;
}

/* Adds `count` particles with their ids; all else is zero. Nothing has changed on an error. */
static mps_status extend(mps_particles *p, const char *function, int64_t count) {
  const int64_t first = p->count, next = p->next_id;
  MPSI_TRY(mpsi_particles_extend_part(p, function, count, count));
  int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int64_t i = first; i < p->count; i++) id[i] = next + i - first;
  mpsi_particles_number(p, first);
  return MPS_OK;
}

void mpsi_particles_number(mps_particles *p, int64_t first) {
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int64_t i = first; i < p->count; i++) mpsi_ids_put(&p->ids, id[i], i);
}

mps_status mpsi_particles_arrive(mps_particles *p, const char *function, const char *places,
                                 mps_status status, int64_t first) {
  const int64_t count = p->count - first;
  if (mpsi_particles_deals(p)) status = p->deal->settle(p->deal->self, function, status);
  for (mpsi_holder *h = p->holders; h; h = h->next)
    if (h->agree) status = h->agree(h->self, function, status, first);
  if (count == 0) {
    if (status != MPS_OK) p->next_id -= p->came, p->epoch -= p->came > 0;
    p->came = 0;
    return status;
  }
  for (mpsi_holder *h = p->holders; h && status == MPS_OK; h = h->next)
    if (h->insert)
      status = mpsi_fail_of(p->context, h->insert(h->self, function, first, count), places);
  if (status != MPS_OK) {
    const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
    for (int64_t k = first; p->ids.sparse && k < p->count; k++) mpsi_ids_drop(&p->ids, id[k]);
    p->count = first;
    p->next_id -= p->came;
    p->epoch--; /* views still have the former memory */
    if (!p->former) clear_tail(p, count);
  }
  p->came = 0;
  finish_columns(p, status == MPS_OK);
  renew_holders(p);
  return status;
}

static mps_status check_positions(const mps_particles *p, const char *function, int64_t count,
                                  const double *positions) {
  const int32_t dim = p->def.dim;
  if (count < 0 || count > MPSI_MAX_PARTICLES)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld, allowed are 0 to 2^40", (long long)count);
  if (count > 0 && !positions)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT, "positions is NULL");
  for (int64_t i = 0; i < count; i++)
    for (int32_t c = 0; c < dim; c++)
      if (!(fabs(positions[i * dim + c]) <= MPSI_FARTHEST))
        return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                         "positions: position %lld has %c = %g m, allowed are %g to %g m",
                         (long long)i, "xyz"[c], positions[i * dim + c], -MPSI_FARTHEST,
                         MPSI_FARTHEST);
  return MPS_OK;
}

/* This rank's part of a list, an equal one as in every addition. */
static mps_status append_part(mps_particles *p, const char *function, mps_status status,
                              int64_t count, const double *positions) {
  const int32_t dim = p->def.dim;
  const int64_t first = p->count, next = p->next_id;
  const bool good = status == MPS_OK;
  const int64_t begin = good ? mpsi_deal_first(p->deal, p->deal->rank, count) : 0;
  const int64_t end = good ? mpsi_deal_first(p->deal, p->deal->rank + 1, count) : 0;
  const size_t bytes = good ? (size_t)(count * dim) * sizeof *positions : 0;
  status = mpsi_deal_agree(p, function, status, count, mpsi_hash(MPSI_HASH, positions, bytes));
  if (status != MPS_OK) return status;
  status = mpsi_particles_extend_part(p, function, count, end - begin);
  int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int64_t k = first; status == MPS_OK && k < p->count; k++) id[k] = next + begin + k - first;
  for (int32_t c = 0; status == MPS_OK && c < dim; c++) {
    double *x = mpsi_field_column(p->fields[MPSI_FIELD_POSITION], c);
    for (int64_t i = begin; i < end; i++) x[first + i - begin] = positions[i * dim + c];
  }
  if (status == MPS_OK) mpsi_particles_number(p, first);
  return mpsi_particles_arrive(p, function, "positions", status, first);
}

mps_status mps_particles_append(mps_particles *particles, int64_t count, const double *positions) {
  if (!particles) return mpsi_null(__func__, "particles");
  const int32_t dim = particles->def.dim;
  const int64_t first = particles->count;
  MPSI_TRY(mpsi_particles_outside_callbacks(particles, __func__));
  mps_status status = mpsi_particles_check_free(particles, __func__);
  if (status == MPS_OK) status = check_positions(particles, __func__, count, positions);
  if (mpsi_particles_deals(particles))
    return append_part(particles, __func__, status, count, positions);
  if (status == MPS_OK) status = extend(particles, __func__, count);
  for (int32_t c = 0; status == MPS_OK && c < dim; c++) {
    double *x = mpsi_field_column(particles->fields[MPSI_FIELD_POSITION], c);
    for (int64_t i = 0; i < count; i++) x[first + i] = positions[i * dim + c];
  }
  return mpsi_particles_arrive(particles, __func__, "positions", status, first);
}

/* ---- removal --------------------------------------------------------------------------------- */

/* The holder of a set that lies on several ranks, or NULL. */
static const mpsi_holder *sharer(const mps_particles *p) {
  const mpsi_holder *h = p->holders;
  while (h && !h->find) h = h->next;
  return h;
}

/* Marks removed particles, by present index. `known`: where some may be on other ranks, the number
 * here. */
static mps_status mark(const mps_particles *p, const char *function, int64_t count,
                       const int64_t *ids, uint8_t *gone, int64_t *known) {
  for (int64_t k = 0; k < count; k++) {
    const int64_t at = mps_particles_index(p, ids[k]);
    if (at < 0 && known) continue;
    if (at >= 0 && !gone[at]) {
      gone[at] = 1;
      if (known) ++*known;
      continue;
    }
    (void)mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                    at < 0 ? "ids[%lld] is %lld: the set has no such particle"
                           : "ids[%lld] is %lld, which stands in the list before",
                    (long long)k, (long long)ids[k]);
    mpsi_fail_where(p->context, -1, ids[k]);
    return MPS_ERROR_ARGUMENT;
  }
  return MPS_OK;
}

static void close_gaps(mps_particles *p, const uint8_t *gone) {
  int64_t kept = 0;
  for (int32_t f = 0; f < p->field_count; f++)
    for (int32_t c = 0; c < p->fields[f]->components; c++) {
      char *column = mpsi_field_column(p->fields[f], c);
      kept = 0;
      for (int64_t k = 0; k < p->count; k++)
        if (!gone[k]) memmove(column + 8 * kept++, column + 8 * k, 8);
    }
  const int64_t removed = p->count - kept, *id = p->fields[MPSI_FIELD_ID]->data;
  p->count = kept;
  clear_tail(p, removed);
  for (int64_t k = 0; k < kept; k++) mpsi_ids_put(&p->ids, id[k], k);
  p->epoch++;
}

void mpsi_particles_take_out(mps_particles *p, const uint8_t *gone) {
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->leaving) h->leaving(h->self, gone);
  mpsi_particles_make_way(p, gone);
  renew_holders(p);
}

mps_status mpsi_particles_hold_room(mps_particles *p, const char *function, int64_t count) {
  const bool ids = mpsi_ids_reserve(p->context, &p->ids, p->next_id, p->next_id, count);
  if (ids && count <= p->capacity) return MPS_OK;
  if (ids && reserve(p, count + count / 8)) {
    finish_columns(p, true);
    return MPS_OK;
  }
  return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                   "could not allocate %d fields of %lld particles", p->field_count,
                   (long long)count);
}

void mpsi_particles_make_way(mps_particles *p, const uint8_t *gone) {
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int64_t k = 0; k < p->count; k++)
    if (gone[k]) mpsi_ids_drop(&p->ids, id[k]);
  close_gaps(p, gone);
}

void mpsi_particles_admit(mps_particles *p, int64_t arriving) {
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int64_t k = p->count; k < p->count + arriving; k++) mpsi_ids_put(&p->ids, id[k], k);
  p->count += arriving;
  p->epoch++;
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->renew && h->kind == MPSI_USE_LOOK) h->renew(h->self);
}

static mps_status check_holders(const mps_particles *p, const char *function, int64_t count,
                                const int64_t *ids) {
  const char *holder = NULL;
  for (const mpsi_holder *h = p->holders; h && !holder; h = h->next)
    if (!h->remove && h->kind != MPSI_USE_LOOK) holder = h->name;
  if (holder)
    return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                     "the particle set is held by %s, which allows no removal: destroy it first",
                     holder);
  mps_status status = MPS_OK;
  for (mpsi_holder *h = p->holders; h && status == MPS_OK; h = h->next)
    if (h->remove)
      status = mpsi_fail_of(p->context, h->remove(h->self, function, count, ids), "ids");
  if (status != MPS_OK) renew_holders(p);
  return status;
}

static mps_status check_removal(const mps_particles *p, const char *function, int64_t count,
                                const int64_t *ids, bool shared) {
  MPSI_TRY(mpsi_particles_writable(p, function));
  if (count < 0 || (!shared && count > p->count))
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld, allowed are 0 to the set's %lld particles", (long long)count,
                     (long long)p->count);
  if (count > 0 && !ids) return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT, "ids is NULL");
  return MPS_OK;
}

mps_status mps_particles_remove(mps_particles *particles, const int64_t *ids, int64_t count) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_context *context = particles->context;
  const mpsi_holder *shared = sharer(particles);
  int64_t known = 0, all = count;
  uint8_t *gone = NULL;
  MPSI_TRY(mpsi_particles_outside_callbacks(particles, __func__));
  mps_status status = check_removal(particles, __func__, count, ids, shared != NULL);
  if (status == MPS_OK && count == 0 && !shared) return MPS_OK;
  if (status == MPS_OK && !(gone = mpsi_alloc(context, particles->count, 1)))
    status = mpsi_fail_memory(context, __func__, (size_t)particles->count);
  if (status == MPS_OK)
    status = mark(particles, __func__, count, ids, gone, shared ? &known : NULL);
  if (shared) status = shared->find(shared->self, __func__, status, count, ids, known, &all);
  if (status == MPS_OK && all > 0) status = check_holders(particles, __func__, count, ids);
  if (status == MPS_OK && (known > 0 || !shared)) mpsi_particles_take_out(particles, gone);
  mpsi_free(context, gone);
  return status;
}

/* ---- rollback -------------------------------------------------------------------------------- */

/* Copies all columns to the backup, or back. */
static void copy_columns(const mps_particles *p, char *memory, bool back) {
  const size_t bytes = (size_t)p->count * 8;
  for (int32_t f = 0; f < p->field_count; f++)
    for (int32_t c = 0; c < p->fields[f]->components; c++, memory += bytes) {
      char *column = mpsi_field_column(p->fields[f], c);
      memcpy(back ? column : memory, back ? memory : column, bytes);
    }
}

mps_status mpsi_particles_back_up(mps_particles *p, const char *function, mpsi_backup *backup) {
  *backup = (mpsi_backup){.field_count = p->field_count, .epoch = p->epoch};
  backup->memory = mpsi_alloc(p->context, p->columns * p->count, 8);
  if (!backup->memory)
    return mpsi_fail_memory(p->context, function, (size_t)(p->columns * p->count) * 8);
  copy_columns(p, backup->memory, false);
  return MPS_OK;
}

void mpsi_particles_go_back(mps_particles *p, mpsi_backup *backup) {
  if (!backup->memory) return;
  mpsi_particles_drop_fields(p, backup->field_count);
  copy_columns(p, backup->memory, true);
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  for (int64_t k = 0; k < p->count; k++) mpsi_ids_put(&p->ids, id[k], k);
  p->epoch = backup->epoch;
  mpsi_backup_drop(p, backup);
}

void mpsi_backup_drop(mps_particles *p, mpsi_backup *backup) {
  mpsi_free(p->context, backup->memory);
  backup->memory = NULL;
}

mps_status mpsi_particles_fit(mps_particles *p, const char *function) {
  const int64_t wanted = p->count + p->count / 64 + 8;
  if (!mpsi_ids_fit(p->context, &p->ids, wanted))
    return mpsi_fail_memory(p->context, function, (size_t)wanted * 16);
  if (p->capacity <= wanted) return MPS_OK;
  if (reserve(p, wanted)) {
    finish_columns(p, true);
    return MPS_OK;
  }
  return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                   "could not allocate %d fields of %lld particles", p->field_count,
                   (long long)wanted);
}
