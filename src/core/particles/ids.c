/* ids.c - the map from ids to indices, see ids.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "ids.h"

/* ---- the table ------------------------------------------------------------------------------- */

/* Slots of a table for so many ids. */
static int64_t slots_for(int64_t count) { return count + count / 3 + 8; }

/* First slot of the search for an id. Ids of a fill are consecutive: every bit matters. */
static int64_t first_slot(const mpsi_ids *ids, int64_t id) {
  uint64_t mixed = (uint64_t)id * UINT64_C(0x9e3779b97f4a7c15);
  mixed ^= mixed >> 32;
  mixed *= UINT64_C(0xd6e8feb86659fd93);
  return (int64_t)((mixed >> 32) * (uint64_t)ids->capacity >> 32);
}

/* The slot of the id, or the free one for it. */
static int64_t slot_of(const mpsi_ids *ids, int64_t id) {
  int64_t at = first_slot(ids, id);
  while (ids->id[at] >= 0 && ids->id[at] != id) at = at + 1 < ids->capacity ? at + 1 : 0;
  return at;
}

/* Slots from `from` on to `to`, around the end of the table. */
static int64_t distance(const mpsi_ids *ids, int64_t from, int64_t to) {
  return to >= from ? to - from : to + ids->capacity - from;
}

static void close_up(mpsi_ids *ids, int64_t hole) {
  for (int64_t at = hole;;) {
    at = at + 1 < ids->capacity ? at + 1 : 0;
    if (ids->id[at] < 0) break;
    const int64_t first = first_slot(ids, ids->id[at]);
    if (distance(ids, first, at) < distance(ids, hole, at)) continue; /* begins behind the hole */
    ids->id[hole] = ids->id[at];
    ids->places[hole] = ids->places[at];
    hole = at;
  }
  ids->id[hole] = -1;
}

/* To a table of so many slots. False: no memory, and nothing has changed. */
static bool move_table(mps_context *context, mpsi_ids *ids, int64_t capacity) {
  mpsi_ids other = {.sparse = true, .capacity = capacity};
  other.id = mpsi_alloc(context, capacity, sizeof *other.id);
  other.places = mpsi_alloc(context, capacity, sizeof *other.places);
  if (!other.id || !other.places) {
    mpsi_ids_free(context, &other);
    return false;
  }
  for (int64_t at = 0; at < capacity; at++) other.id[at] = -1;
  for (int64_t at = 0; at < ids->capacity; at++)
    if (ids->id[at] >= 0) mpsi_ids_put(&other, ids->id[at], ids->places[at]);
  mpsi_ids_free(context, ids);
  *ids = other;
  return true;
}

static bool grow_table(mps_context *context, mpsi_ids *ids, int64_t count) {
  const int64_t half_more = ids->capacity / 4 * 3 + ids->capacity / 3;
  const bool by_half = ids->capacity > 0 && count < half_more && half_more < MPSI_IDS_MOST;
  return move_table(context, ids, slots_for(by_half ? half_more : count));
}

bool mpsi_ids_fit(mps_context *context, mpsi_ids *ids, int64_t count) {
  if (!ids->sparse || ids->count > count || ids->capacity <= slots_for(count)) return true;
  return move_table(context, ids, slots_for(count));
}

/* ---- both ------------------------------------------------------------------------------------ */

static bool fits(const mpsi_ids *ids, int64_t made, int64_t count) {
  return ids->sparse ? slots_for(count) <= ids->capacity : made <= ids->capacity;
}

bool mpsi_ids_reserve(mps_context *context, mpsi_ids *ids, int64_t former, int64_t made,
                      int64_t count) {
  if (fits(ids, made, count)) return true;
  if (ids->sparse) return grow_table(context, ids, count);
  const int64_t half_more = ids->capacity + ids->capacity / 2;
  const int64_t capacity = made > half_more ? made : half_more;
  void *index = ids->index;
  if (!mpsi_grow(context, &index, former, capacity, sizeof *ids->index)) return false;
  ids->index = index;
  ids->capacity = capacity;
  return true;
}

void mpsi_ids_free(mps_context *context, mpsi_ids *ids) {
  MPSI_FREE(context, ids->index, ids->id, ids->places);
  *ids = (mpsi_ids){.sparse = ids->sparse};
}

int64_t mpsi_ids_find(const mpsi_ids *ids, int64_t id) {
  if (!ids->sparse) return ids->index[id];
  if (ids->capacity == 0) return -1;
  const int64_t at = slot_of(ids, id);
  return ids->id[at] < 0 ? -1 : ids->places[at];
}

void mpsi_ids_put(mpsi_ids *ids, int64_t id, int64_t index) {
  if (!ids->sparse) {
    ids->index[id] = index;
    return;
  }
  const int64_t at = slot_of(ids, id);
  if (ids->id[at] < 0) {
    ids->id[at] = id;
    ids->count++;
  }
  ids->places[at] = (int32_t)index;
}

void mpsi_ids_drop(mpsi_ids *ids, int64_t id) {
  if (!ids->sparse) {
    ids->index[id] = -1;
    return;
  }
  const int64_t at = ids->capacity > 0 ? slot_of(ids, id) : -1;
  if (at < 0 || ids->id[at] < 0) return;
  close_up(ids, at);
  ids->count--;
}

void mpsi_ids_renew(mpsi_ids *ids, int64_t made, int64_t count, const int64_t *id) {
  if (ids->sparse) {
    for (int64_t at = 0; at < ids->capacity; at++) ids->id[at] = -1;
    ids->count = 0;
  } else {
    for (int64_t k = 0; k < made; k++) ids->index[k] = -1;
  }
  for (int64_t k = 0; k < count; k++) mpsi_ids_put(ids, id[k], k);
}
