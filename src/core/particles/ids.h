/* ids.h - the map from ids to indices of a particle set: an array over all ids, or, of a set that
 * has few of the ids because the rest lies on other ranks, a hash table over its own ones, so that
 * its memory follows the particles here and not all of them.
 *
 * The table has open addresses with linear probing; it is at most three quarters full, and a
 * removed id is closed by moving later ones back, so that no marks of removed ids remain.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#define MPSI_IDS_MOST INT32_MAX /* particles of a set with a table */

typedef struct mpsi_ids {
  bool sparse;      /* a table: chosen while the map is empty */
  int64_t capacity; /* ids of the array, or slots of the table, below 2^32 */
  int64_t count;    /* ids in the table */
  int64_t *index;   /* of the array: -1 of an id that is not here */
  int64_t *id;      /* of the table: -1 of a free slot */
  int32_t *places;  /* of the table: the index of each */
} mpsi_ids;

/* Room for ids below `made`, of which `count` are here at once; false: refused, and nothing has
 * changed. The array keeps what it has below `former`. */
bool mpsi_ids_reserve(mps_context *context, mpsi_ids *ids, int64_t former, int64_t made,
                      int64_t count);
/* Releases slots of a table for more than `count` ids; false as above. */
bool mpsi_ids_fit(mps_context *context, mpsi_ids *ids, int64_t count);
void mpsi_ids_free(mps_context *context, mpsi_ids *ids);

/* -1: it is not here. `id` lies below those reserved. */
int64_t mpsi_ids_find(const mpsi_ids *ids, int64_t id);
/* Ids that are in the table already may be put from several threads at once, each by one. */
void mpsi_ids_put(mpsi_ids *ids, int64_t id, int64_t index);
void mpsi_ids_drop(mpsi_ids *ids, int64_t id);
/* Sets exactly `count` ids, id[k] at index k, of `made` that were ever given. */
void mpsi_ids_renew(mpsi_ids *ids, int64_t made, int64_t count, const int64_t *id);
