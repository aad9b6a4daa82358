/* given.h - arguments of a caller as a list of named numbers: ranks compare theirs, and a message
 * names the number that differs. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/definition/definition.h"
#include "hash.h"

#include <math.h>
#include <string.h>

#define MPSI_GIVEN_MOST 160 /* the following are compared as one number */

typedef struct mpsi_given {
  int32_t count;
  uint64_t rest; /* hash of the numbers beyond the capacity */
  const char *name[MPSI_GIVEN_MOST];
  const mpsi_def_member *member[MPSI_GIVEN_MOST]; /* of a definition, or NULL */
  double value[MPSI_GIVEN_MOST];                  /* NaN: unset */
} mpsi_given;

#define MPSI_GIVEN {.rest = MPSI_HASH} /* an empty list */

/* All NaN are the same. */
static inline uint64_t mpsi_hash_number(uint64_t hash, double number) {
  if (isnan(number)) number = NAN;
  return mpsi_hash(hash, &number, sizeof number);
}

/* `name` must outlive the list. */
static inline void mpsi_give(mpsi_given *list, const char *name, double value) {
  if (list->count == MPSI_GIVEN_MOST) {
    list->rest = mpsi_hash_number(list->rest, value);
    return;
  }
  list->name[list->count] = name;
  list->member[list->count] = NULL;
  list->value[list->count++] = value;
}

static inline void mpsi_give_vector(mpsi_given *list, const char *name, int32_t count,
                                    const double *values) {
  for (int32_t c = 0; c < count; c++) mpsi_give(list, name, values[c]);
}

/* A member of a definition by its own name. */
#define MPSI_GIVE(list, def, member) mpsi_give(list, #member, (double)(def)->member)

/* Component `c` of a member of a definition. */
static inline void mpsi_give_member(mpsi_given *list, const mpsi_def_member *member,
                                    const void *def, int32_t c) {
  mpsi_give(list, member->name, mpsi_member_value(member, def, c));
  if (list->count < MPSI_GIVEN_MOST) list->member[list->count - 1] = member;
}

/* What a definition's table says that ranks share. */
static inline void mpsi_give_def(mpsi_given *list, const mpsi_definition *definition,
                                 const void *def) {
  for (const mpsi_def_member *m = definition->member; m < definition->member + definition->count;
       m++)
    for (int32_t c = 0; m->same && c < m->count; c++) mpsi_give_member(list, m, def, c);
}
#define MPSI_GIVE_DEF(list, type, def)                                                             \
  mpsi_give_def(list, &mpsi_definition_of_##type, 1 ? (def) : (type *)0)

/* The bits of a hash that a double has exactly. */
static inline double mpsi_hash_short(uint64_t hash) { return (double)(hash >> 12); }

static inline void mpsi_give_bytes(mpsi_given *list, const char *name, const void *data,
                                   size_t bytes) {
  mpsi_give(list, name, mpsi_hash_short(mpsi_hash(MPSI_HASH, data, data ? bytes : 0)));
}

static inline void mpsi_give_text(mpsi_given *list, const char *name, const char *text) {
  mpsi_give_bytes(list, name, text, text ? strlen(text) : 0);
}

/* Of the whole list. */
static inline uint64_t mpsi_given_hash(const mpsi_given *list) {
  uint64_t hash = mpsi_hash(list->rest, &list->count, sizeof list->count);
  for (int32_t k = 0; k < list->count; k++) hash = mpsi_hash_number(hash, list->value[k]);
  return hash;
}
