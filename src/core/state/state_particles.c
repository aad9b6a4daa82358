/* state_particles.c - the particle set's part of a state: number, ids, order and all fields.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_private.h"
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

/* ---- what a set has besides its fields ------------------------------------------------------- */

enum { SITES = 4 };
_Static_assert(sizeof(mpsi_site_run) == SITES * sizeof(int64_t), "kept as numbers");

static int64_t count_sites(const void *set) { return ((const mps_particles *)set)->sites.count; }

static void get_sites(const void *set, void *values) {
  const mpsi_site_runs *sites = &((const mps_particles *)set)->sites;
  memcpy(values, sites->item, (size_t)sites->count * sizeof *sites->item);
}

static bool reserve_sites(void *set, int64_t rows, const void *values) {
  mps_particles *p = set;
  void *item = p->sites.item;
  if (rows <= p->sites.capacity) return true;
  if (!mpsi_grow(p->context, &item, p->sites.count, rows, sizeof *p->sites.item)) return false;
  p->sites.item = item;
  p->sites.capacity = rows;
  return true;
}

static void set_sites(void *set, int64_t rows, const void *values) {
  mpsi_site_runs *sites = &((mps_particles *)set)->sites;
  if (rows > 0) memcpy(sites->item, values, (size_t)rows * sizeof *sites->item);
  sites->count = rows;
}

static const mpsi_state_table sites_table = {MPSI_STATE_I64, SITES,         count_sites,
                                             get_sites,      reserve_sites, set_sites};

#define NEXT_ID "particles/next_id"
#define OCCUPIED "particles/sites"

void mpsi_particles_list_state(mpsi_state *state, mps_particles *p) {
  mpsi_state_i64(state, NEXT_ID, &p->next_id, 1);
  mpsi_state_add_table_of(state, OCCUPIED, &sites_table, p);
}

void mpsi_particles_name_next_id(mpsi_value *item, int64_t next_id) {
  snprintf(item->name, sizeof item->name, NEXT_ID);
  item->type = MPSI_STATE_I64;
  item->rows = item->columns = 1;
  memcpy(item->data, &next_id, sizeof next_id);
}

void mpsi_particles_take_next_id(mps_particles *p, const mps_snapshot *from) {
  memcpy(&p->next_id, mpsi_values_find(&from->state, NEXT_ID)->data, sizeof p->next_id);
}

/* ---- rollback -------------------------------------------------------------------------------- */

/* Data of the first phase for the second, where order or number change. */
typedef struct move {
  int64_t *from; /* present index of the particle at each new index, -1: restored */
  double *column;
  void **block; /* of each field, larger memory; NULL: its own is large enough */
  int32_t blocks;
  int64_t capacity;
  int64_t ids; /* that the map has to contain */
} move;

static bool same_order(const mps_particles *p, const mps_snapshot *from, const int64_t *id) {
  return from->particles == p->count &&
         memcmp(id, p->fields[MPSI_FIELD_ID]->data, (size_t)p->count * 8) == 0;
}

static mps_status malformed(const mps_particles *p, const char *function, const char *what) {
  return mpsi_fail(p->context, function, MPS_ERROR_FORMAT, "the state is malformed: %s", what);
}

/* The same particles in another order. */
static mps_status check_same(const mps_particles *p, const char *function, const mps_snapshot *from,
                             const int64_t *id) {
  if (from->particles != p->count)
    return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                     "the state is of %lld particles, the set has %lld", (long long)from->particles,
                     (long long)p->count);
  for (int64_t k = 0; k < p->count; k++)
    if (mps_particles_index(p, id[k]) < 0)
      return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                       "the state has a particle of id %lld, the set has none", (long long)id[k]);
  return MPS_OK;
}

/* Other particles, as in a file: ids are below the next one, and unique. */
static mps_status check_ids(const mps_particles *p, const char *function, const mps_snapshot *from,
                            const int64_t *id, int64_t next) {
  bool good = next >= from->particles && next <= MPSI_MAX_PARTICLES;
  uint8_t *seen = good ? mpsi_alloc(p->context, next, 1) : NULL;
  if (good && !seen) return mpsi_fail_memory(p->context, function, (size_t)next);
  for (int64_t k = 0; good && k < from->particles; k++) {
    good = id[k] >= 0 && id[k] < next && !seen[id[k]];
    if (good) seen[id[k]] = 1;
  }
  mpsi_free(p->context, seen);
  return good ? MPS_OK : malformed(p, function, "an id is there twice, or above the next one");
}

static bool follows(const mpsi_site_run *a, const mpsi_site_run *b) {
  if (a->k != b->k) return a->k < b->k;
  return a->j != b->j ? a->j < b->j : a->end < b->begin;
}

/* Twice the distance of a fill from the origin, in spacings. */
static bool near(int64_t site) { return site >= -(INT64_C(1) << 41) && site <= INT64_C(1) << 41; }

static mps_status check_sites(const mps_particles *p, const char *function,
                              const mps_snapshot *from) {
  const mpsi_value *value = mpsi_values_find(&from->state, OCCUPIED);
  const mpsi_site_run *run = value ? value->data : NULL;
  for (int64_t k = 0; value && k < value->rows; k++)
    if (run[k].begin >= run[k].end || !near(run[k].begin) || !near(run[k].end) || !near(run[k].j) ||
        !near(run[k].k) || (k > 0 && !follows(&run[k - 1], &run[k])))
      return malformed(p, function, "its lattice sites");
  return MPS_OK;
}

static mps_status check_particles(const mps_particles *p, const char *function,
                                  const mps_snapshot *from, const int64_t *id) {
  const mpsi_value *next = mpsi_values_find(&from->state, NEXT_ID);
  mps_status status = next ? check_ids(p, function, from, id, *(const int64_t *)next->data)
                           : check_same(p, function, from, id);
  if (status == MPS_OK && next) status = check_sites(p, function, from);
  if (status == MPS_OK && mpsi_particles_solvers(p) > 1 && !same_order(p, from, id))
    status =
        mpsi_fail(p->context, function, MPS_ERROR_STATE,
                  "the set cannot be sorted: it is held by %d solvers", mpsi_particles_solvers(p));
  return status;
}

static mps_status check_fields(const mps_particles *p, const char *function,
                               const mps_snapshot *from) {
  for (int32_t f = 0; f < from->fields.count; f++) {
    const mpsi_value *then = &from->fields.item[f];
    const mpsi_field *now = mpsi_field_find(p, then->name);
    if (now && (now->components != then->columns || type_of(now) != then->type))
      return mpsi_fail(p->context, function, MPS_ERROR_FIELD,
                       "field '%s' has %d components, in the state to restore %d", then->name,
                       now->components, then->columns);
  }
  return MPS_OK;
}

static mps_status add_missing(mps_particles *p, const char *function, const mps_snapshot *from) {
  const int32_t before = p->field_count;
  for (int32_t f = 0; f < from->fields.count; f++) {
    const mpsi_value *then = &from->fields.item[f];
    if (mpsi_field_find(p, then->name) ||
        mpsi_particles_add_field(p, function, then->name, then->columns) == MPS_OK)
      continue;
    mpsi_particles_drop_fields(p, before);
    return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                     "could not allocate field '%s' of %lld particles", then->name,
                     (long long)p->count);
  }
  return MPS_OK;
}

void mpsi_particles_drop_prepared(mps_particles *p, void *scratch) {
  move *m = scratch;
  if (!m) return;
  for (int32_t f = 0; m->block && f < m->blocks; f++) mpsi_free(p->context, m->block[f]);
  MPSI_FREE(p->context, m->block, m->from, m->column, m);
}

/* Larger memory for all fields. */
static bool add_blocks(const mps_particles *p, move *m, int64_t count) {
  m->capacity = p->capacity;
  if (count <= p->capacity) return true;
  m->capacity = count;
  m->block = mpsi_alloc(p->context, p->field_count, sizeof *m->block);
  for (; m->block && m->blocks < p->field_count; m->blocks++)
    if (!(m->block[m->blocks] = mpsi_field_allocate(p->context, p->fields[m->blocks], count)))
      return false;
  return m->block != NULL;
}

static bool reserve_ids(mps_particles *p, move *m, const mps_snapshot *from) {
  const mpsi_value *next = mpsi_values_find(&from->state, NEXT_ID);
  m->ids =
      next && *(const int64_t *)next->data > p->next_id ? *(const int64_t *)next->data : p->next_id;
  return mpsi_ids_reserve(p->context, &p->ids, p->next_id, m->ids, from->particles);
}

/* With the same order, the next id may differ, where particles added later were removed: the map
 * has them all, without a particle. Entries beyond the set's own ids are not read. */
static bool reserve_ids_to_come(mps_particles *p, const mps_snapshot *from) {
  const mpsi_value *value = mpsi_values_find(&from->state, NEXT_ID);
  const int64_t next = value ? *(const int64_t *)value->data : 0;
  if (p->ids.sparse || next <= p->next_id) return true;
  if (!mpsi_ids_reserve(p->context, &p->ids, p->next_id, next, from->particles)) return false;
  for (int64_t id = p->next_id; id < next; id++) mpsi_ids_drop(&p->ids, id);
  return true;
}

static move *new_move(mps_particles *p, const mps_snapshot *from, const int64_t *id) {
  const int64_t count = from->particles;
  move *m = mpsi_alloc(p->context, 1, sizeof *m);
  if (!m) return NULL;
  m->from = mpsi_alloc(p->context, count, sizeof *m->from);
  if (m->from) m->column = mpsi_alloc(p->context, count, sizeof *m->column);
  if (!m->column || !add_blocks(p, m, count) || !reserve_ids(p, m, from)) {
    mpsi_particles_drop_prepared(p, m);
    return NULL;
  }
  for (int64_t k = 0; k < count; k++) m->from[k] = mps_particles_index(p, id[k]);
  return m;
}

mps_status mpsi_particles_prepare_state(mps_particles *p, const char *function,
                                        const mps_snapshot *from, void **scratch) {
  const mpsi_value *id = mpsi_values_find(&from->fields, "id");
  const int32_t fields = p->field_count;
  *scratch = NULL;
  if (!id || id->type != MPSI_STATE_I64 || id->columns != 1)
    return mpsi_fail(p->context, function, MPS_ERROR_FORMAT, "the state has no ids of particles");
  MPSI_TRY(mpsi_particles_ready(p, function));
  MPSI_TRY(check_particles(p, function, from, id->data));
  MPSI_TRY(check_fields(p, function, from));
  MPSI_TRY(add_missing(p, function, from));
  const bool same = same_order(p, from, id->data);
  if (!same) *scratch = new_move(p, from, id->data);
  if (same ? reserve_ids_to_come(p, from) : *scratch != NULL) return MPS_OK;
  mpsi_particles_drop_fields(p, fields);
  return mpsi_fail(p->context, function, MPS_ERROR_MEMORY,
                   "could not allocate %d fields of %lld particles", p->field_count,
                   (long long)from->particles);
}

/* Column `c` of a field, permuted with its particles. */
static void carry(const mpsi_field *before, double *to, int32_t c, const move *m, int64_t count) {
  const double *column = mpsi_field_column(before, c);
  for (int64_t k = 0; k < count; k++)
    if (m->from[k] >= 0)
      memcpy(&m->column[k], column + m->from[k], 8);
    else
      m->column[k] = 0.0;
  memcpy(to, m->column, (size_t)count * 8);
}

static void put_field(const mps_particles *p, mpsi_field *field, const mpsi_value *then,
                      const move *m, void *block, int64_t count) {
  const mpsi_field before = *field;
  if (block) mpsi_field_place(field, block, m->capacity);
  for (int32_t c = 0; c < field->components; c++) {
    char *to = mpsi_field_column(field, c);
    if (then)
      memcpy(to, (const char *)then->data + 8 * c * count, (size_t)count * 8);
    else if (m)
      carry(&before, (double *)to, c, m, count);
    if (!block && p->count > count) memset(to + 8 * count, 0, (size_t)(p->count - count) * 8);
  }
  if (block) mpsi_free(p->context, before.block);
}

void mpsi_particles_put_state(mps_particles *p, const mps_snapshot *from, void *scratch) {
  move *m = scratch;
  for (int32_t f = 0; f < p->field_count; f++) {
    void *block = m && m->block ? m->block[f] : NULL;
    put_field(p, p->fields[f], mpsi_values_find(&from->fields, p->fields[f]->name), m, block,
              from->particles);
    if (block) m->block[f] = NULL;
  }
  if (!m) return; /* the order is the same, and views stay valid */
  p->count = from->particles;
  p->capacity = m->capacity;
  const int64_t *id = p->fields[MPSI_FIELD_ID]->data;
  mpsi_ids_renew(&p->ids, m->ids, p->count, id);
  p->epoch++;
  mpsi_particles_drop_prepared(p, m);
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->renew && h->kind == MPSI_USE_LOOK) h->renew(h->self);
}
