/* particles.c - the particle set: life, growth, order, selection.
 *
 * Ids are given in order of insertion and never twice, so the map from id to index is one array:
 * the identity until the set is sorted or particles are removed. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "particles_private.h"

#include "core/base/order.h"
#include "core/base/ranges.h"

#include <stdlib.h>
#include <string.h>

/* ---- life ------------------------------------------------------------------------------------ */

static void free_set(mps_particles *p) {
  mps_context *context = p->context;
  for (int32_t f = 0; f < p->field_count; f++) {
    MPSI_FREE(context, p->fields[f]->former, p->fields[f]->block, p->fields[f]);
  }
  mpsi_free(context, p->fields);
  mpsi_ids_free(context, &p->ids);
  mpsi_free(context, p->sites.item);
  if (p->deal) p->deal->release(p->deal->self);
  MPSI_FREE(context, p->deal, p);
  mpsi_context_release(context);
}

mps_status mps_particles_create(mps_context *context, const mps_particles_def *def,
                                mps_particles **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_particles_def known;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_particles_def, def, &known));
  mps_particles *p = mpsi_alloc(context, 1, sizeof *p);
  if (!p) return mpsi_fail_memory(context, __func__, sizeof *p);
  p->context = mpsi_context_retain(context);
  p->def = known;
  p->epoch = 1;
  p->owned = true;
  mps_status status = mpsi_as(context, __func__, mps_particles_add_field(p, "id", 0));
  if (status == MPS_OK)
    status = mpsi_as(context, __func__, mps_particles_add_field(p, "position", 0));
  if (status != MPS_OK) {
    mpsi_fail_memory(context, __func__, sizeof *p); /* the only possible reason */
    free_set(p);
    return status;
  }
  *out = p;
  return MPS_OK;
}

void mpsi_particles_free_if_unused(mps_particles *p) {
  if (!p->owned && !p->holders) free_set(p);
}

void mps_particles_destroy(mps_particles **particles) {
  if (!particles || !*particles) return;
  mps_particles *p = *particles;
  *particles = NULL;
  p->owned = false;
  mpsi_particles_free_if_unused(p);
}

mps_context *mpsi_particles_context(const mps_particles *particles) { return particles->context; }

mps_status mpsi_particles_check_context(const mps_particles *particles, mps_context *context,
                                        const char *function) {
  if (!particles) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "particles is NULL");
  if (particles->context == context) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "the particle set was made from another context");
}

int64_t mps_particles_count(const mps_particles *particles) {
  return particles ? particles->count : 0;
}
int32_t mps_particles_dim(const mps_particles *particles) {
  return particles ? particles->def.dim : 0;
}
double mps_particles_spacing(const mps_particles *particles) {
  return particles ? particles->def.spacing : 0.0;
}
uint64_t mps_particles_epoch(const mps_particles *particles) {
  return particles ? particles->epoch : 0;
}

/* ---- order ----------------------------------------------------------------------------------- */

#define PERMUTE_CHUNK 8192 /* particles in a unit of work */

/* Some columns being permuted: first to `sorted`, then back. */
typedef struct permutation {
  const int64_t *order;
  int64_t count, chunks;
  char *column[MPSI_PERMUTE_COLUMNS], *sorted[MPSI_PERMUTE_COLUMNS];
  int32_t columns;
} permutation;

static int64_t chunk_end(const permutation *m, int64_t begin) {
  return begin + PERMUTE_CHUNK < m->count ? begin + PERMUTE_CHUNK : m->count;
}

static void permute_chunk(void *data, int64_t unit, int32_t worker) {
  const permutation *m = data;
  const int64_t begin = unit % m->chunks * PERMUTE_CHUNK, end = chunk_end(m, begin);
  const double *from = (const double *)m->column[unit / m->chunks];
  double *to = (double *)m->sorted[unit / m->chunks];
  for (int64_t k = begin; k < end; k++) memcpy(to + k, from + m->order[k], sizeof *to);
}

static void return_chunk(void *data, int64_t unit, int32_t worker) {
  const permutation *m = data;
  const int64_t begin = unit % m->chunks * PERMUTE_CHUNK, end = chunk_end(m, begin);
  memcpy(m->column[unit / m->chunks] + 8 * begin, m->sorted[unit / m->chunks] + 8 * begin,
         (size_t)(end - begin) * 8);
}

static void permute_columns(mps_particles *p, permutation *m) {
  if (m->chunks > 1) {
    mpsi_parallel_for(p->context, m->chunks * m->columns, permute_chunk, m);
    mpsi_parallel_for(p->context, m->chunks * m->columns, return_chunk, m);
  } else { /* too short for other threads */
    for (int32_t k = 0; k < m->columns; k++) permute_chunk(m, k, 0), return_chunk(m, k, 0);
  }
  m->columns = 0;
}

/* Ids are unique: no two chunks write the same index. */
typedef struct indexing {
  const int64_t *id;
  mpsi_ids *ids;
  int64_t count;
} indexing;

static void index_chunk(void *data, int64_t chunk, int32_t worker) {
  const indexing *i = data;
  const int64_t begin = chunk * PERMUTE_CHUNK;
  for (int64_t k = begin; k < i->count && k < begin + PERMUTE_CHUNK; k++)
    mpsi_ids_put(i->ids, i->id[k], k);
}

mps_status mpsi_particles_permute_in(mps_particles *p, const char *function, const int64_t *order,
                                     void *const *scratch, int32_t columns) {
  const int32_t solvers = mpsi_particles_solvers(p);
  if (solvers > 1)
    return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                     "the set cannot be sorted: it is held by %d solvers", solvers);
  permutation m = {.order = order, .count = p->count};
  m.chunks = (p->count + PERMUTE_CHUNK - 1) / PERMUTE_CHUNK;
  for (int32_t k = 0; k < columns; k++) m.sorted[k] = scratch[k];
  for (int32_t f = 0; f < p->field_count; f++)
    for (int32_t c = 0; c < p->fields[f]->components; c++) {
      m.column[m.columns++] = mpsi_field_column(p->fields[f], c);
      if (m.columns == columns) permute_columns(p, &m);
    }
  if (m.columns > 0) permute_columns(p, &m);
  indexing i = {p->fields[MPSI_FIELD_ID]->data, &p->ids, p->count};
  mpsi_parallel_for(p->context, m.chunks, index_chunk, &i);
  p->epoch++;
  return MPS_OK;
}

mps_status mpsi_particles_permute(mps_particles *p, const char *function, const int64_t *order) {
  void *scratch = mpsi_alloc(p->context, p->count, 8);
  if (!scratch) return mpsi_fail_memory(p->context, function, (size_t)p->count * 8);
  const mps_status status = mpsi_particles_permute_in(p, function, order, &scratch, 1);
  mpsi_free(p->context, scratch);
  return status;
}

int64_t mpsi_particles_made(const mps_particles *p) { return p->next_id; }

/* ---- selection ------------------------------------------------------------------------------- */

static mps_status check_select(const mps_particles *p, const char *function, const double *lo,
                               const double *hi, int64_t capacity, const int64_t *ids,
                               const int64_t *count) {
  MPSI_TRY(mpsi_particles_committed(p, function));
  if (!lo || !hi || !count)
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                     !lo   ? "lo"
                     : !hi ? "hi"
                           : "count");
  if (capacity < 0 || (capacity > 0 && !ids))
    return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                     "capacity is %lld with ids %s, must be >= 0, and 0 where ids is NULL",
                     (long long)capacity, ids ? "given" : "NULL");
  for (int32_t c = 0; c < p->def.dim; c++)
    if (!(lo[c] <= hi[c]))
      return mpsi_fail(p->context, function, MPS_ERROR_ARGUMENT,
                       "the box in %c is [%g, %g] m, must have lo <= hi", "xyz"[c], lo[c], hi[c]);
  return MPS_OK;
}

static bool in_box(const mps_particles *p, int64_t at, const double *lo, const double *hi) {
  for (int32_t c = 0; c < p->def.dim; c++) {
    const double *x = mpsi_field_column(p->fields[MPSI_FIELD_POSITION], c);
    if (!(x[at] >= lo[c] && x[at] <= hi[c])) return false;
  }
  return true;
}

/* Of a set that has few of the ids: goes through the particles. */
static mps_status select_few(const mps_particles *p, const char *function, const double *lo,
                             const double *hi, int64_t capacity, int64_t *ids, int64_t *count) {
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  int64_t found = 0;
  for (int64_t k = 0; k < p->count; k++) found += in_box(p, k, lo, hi);
  int64_t *list = capacity >= found ? ids : NULL;
  if (capacity > 0 && !list && !(list = mpsi_alloc(p->context, found, sizeof *list)))
    return mpsi_fail_memory(p->context, function, (size_t)found * sizeof *list);
  for (int64_t k = 0, at = 0; list && k < p->count; k++)
    if (in_box(p, k, lo, hi)) list[at++] = id[k];
  if (list && found > 0) qsort(list, (size_t)found, sizeof *list, mpsi_ascending);
  if (list && list != ids) {
    memcpy(ids, list, (size_t)capacity * sizeof *ids);
    mpsi_free(p->context, list);
  }
  *count = found;
  return MPS_OK;
}

mps_status mps_particles_select_box(const mps_particles *particles, const double *lo,
                                    const double *hi, int64_t capacity, int64_t *count,
                                    int64_t *ids) {
  if (!particles) return mpsi_null(__func__, "particles");
  MPSI_TRY(check_select(particles, __func__, lo, hi, capacity, ids, count));
  if (particles->ids.sparse) return select_few(particles, __func__, lo, hi, capacity, ids, count);
  int64_t found = 0;
  for (int64_t id = 0; id < particles->next_id; id++) {
    const int64_t at = mpsi_ids_find(&particles->ids, id);
    if (at < 0 || !in_box(particles, at, lo, hi)) continue;
    if (found < capacity) ids[found] = id;
    found++;
  }
  *count = found;
  return MPS_OK;
}

int64_t mps_particles_index(const mps_particles *particles, int64_t id) {
  return particles && id >= 0 && id < particles->next_id ? mpsi_ids_find(&particles->ids, id) : -1;
}

mps_status mpsi_particles_check_ids(const mps_particles *particles, const char *function,
                                    int64_t count, const int64_t *ids) {
  for (int64_t k = 0; k < count; k++)
    if (mps_particles_index(particles, ids[k]) < 0)
      return mpsi_fail(particles->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: the set has no such particle", (long long)k,
                       (long long)ids[k]);
  return MPS_OK;
}

mps_status mpsi_particles_check_ids_or_all(const mps_particles *particles, const char *function,
                                           int64_t count, const int64_t *ids) {
  if (count < 0 || (ids == NULL && count != 0))
    return mpsi_fail(particles->context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld with ids %s, must be >= 0, and 0 where ids is NULL (all)",
                     (long long)count, ids ? "given" : "NULL");
  return mpsi_particles_check_ids(particles, function, count, ids);
}

int64_t mps_particles_nearest(const mps_particles *particles, const double *x) {
  if (!particles || !x || mpsi_particles_committed(particles, __func__) != MPS_OK) return -1;
  const int64_t *id = particles->fields[MPSI_FIELD_ID]->data;
  int64_t best = -1;
  double best_square = INFINITY;
  for (int64_t k = 0; k < particles->count; k++) {
    double square = 0.0;
    for (int32_t c = 0; c < particles->def.dim; c++) {
      const double *column = mpsi_field_column(particles->fields[MPSI_FIELD_POSITION], c);
      const double distance = column[k] - x[c];
      square += distance * distance;
    }
    if (!(square < best_square || (square == best_square && id[k] < best))) continue;
    best_square = square;
    best = id[k];
  }
  return best;
}
