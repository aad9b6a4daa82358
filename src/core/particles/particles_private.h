/* particles_private.h - the members of a particle set, for the files of this folder and
 * the state of a set (core/state) only. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "ids.h"
#include "particles_internal.h"

#define MPSI_MAX_PARTICLES (INT64_C(1) << 40)
#define MPSI_FIELD_NAME 96      /* bytes, with the terminating zero: <law>.<column>, user.NAME */
#define MPSI_FIELD_NAME_PART 48 /* of each of both parts */

/* A field: its columns lie one behind the other in one block, `stride` items apart. */
typedef struct mpsi_field {
  char name[MPSI_FIELD_NAME];
  const char *unit, *meaning;
  mps_dtype dtype;
  uint32_t flags;
  bool open;      /* the caller is editing it */
  double *former; /* former values: 8 bytes an item, [component][particle] */
  int64_t former_capacity;
  int32_t components;
  int64_t first_column; /* number of columns of the fields before it: staggers the addresses */
  void *block;          /* as allocated */
  void *data;           /* column 0 */
  int64_t stride;       /* items from one column to the next */
} mpsi_field;

/* Memory of the columns of a field. */
typedef struct mpsi_column_place {
  void *block, *data;
  int64_t stride;
} mpsi_column_place;

/* Occupied lattice sites begin <= i < end of the row (j, k). */
typedef struct mpsi_site_run {
  int64_t begin, end, j, k;
} mpsi_site_run;

/* Rows ascend in k, then j; runs of a row ascend, with a gap between any two. */
typedef struct mpsi_site_runs {
  mpsi_site_run *item;
  int64_t count, capacity;
} mpsi_site_runs;

struct mps_particles {
  mps_context *context;
  mps_particles_def def;
  int64_t count, capacity;
  uint64_t epoch;
  mpsi_column_place *former; /* of each field, while particles are being added and the columns have
                                moved: their former memory; else NULL */
  int64_t former_capacity;
  mpsi_holder *holders; /* in the order of addition, the last first */
  bool owned;           /* not yet destroyed by the caller */
  int32_t open_edits;   /* fields that the caller is editing */
  int32_t field_count;
  mpsi_field **fields; /* 0: id, 1: position */
  int64_t columns;
  int64_t next_id;      /* ids are given once: 0, 1, 2, ... */
  mpsi_ids ids;         /* id -> index */
  mpsi_deal *deal;      /* partition of a set in parts; NULL: all are here */
  int64_t came;         /* ids given with the last addition, on all ranks */
  mpsi_site_runs sites; /* sites occupied by lattice fills */
};

/* ---- names.c --------------------------------------------------------------------------------- */

#define MPSI_FIELD_OWN "user." /* begins the name of a caller's field */

/* A row of the library's table, fields.h. */
typedef struct mpsi_field_row {
  const char *name, *unit, *meaning;
  mps_dtype dtype;
  int32_t components; /* or a code */
} mpsi_field_row;

const mpsi_field_row *mpsi_field_row_of(const char *name); /* or NULL */
int32_t mpsi_field_row_components(const mpsi_field_row *row, int32_t dim);

typedef enum mpsi_field_owner {
  MPSI_FIELD_UNKNOWN, /* no name of a field */
  MPSI_FIELD_OF_TABLE,
  MPSI_FIELD_OF_CALLER,
  MPSI_FIELD_OF_LAW
} mpsi_field_owner;
mpsi_field_owner mpsi_field_owner_of(const char *name);
/* The field of the table that a misspelt name may stand for, or NULL. */
const char *mpsi_field_nearest(const char *name);
/* Records why a caller cannot add a field of this name, and what to write. */
mps_status mpsi_field_refuse_name(mps_context *context, const char *function, const char *name);

/* ---- fields.c -------------------------------------------------------------------------------- */

#define MPSI_FIELD_ID 0
#define MPSI_FIELD_POSITION 1

mpsi_field *mpsi_field_find(const mps_particles *particles, const char *name); /* or NULL */
/* The field of that name, or its description in the table of fields; MPS_ERROR_FIELD otherwise. */
mps_status mpsi_field_look_up(const mps_particles *particles, const char *function,
                              const char *name, mpsi_field *out);
/* Records that the set has no such field, what may be meant, and which it has. */
mps_status mpsi_field_fail_unknown(const mps_particles *particles, const char *function,
                                   const char *name);
/* The field is one of the set's. */
void mpsi_field_drop(mps_particles *particles, mpsi_field *field);
/* Address of a column of 8-byte items. */
static inline void *mpsi_field_column(const mpsi_field *field, int32_t component) {
  return (char *)field->data + (size_t)component * (size_t)field->stride * 8;
}
/* Memory for a field of `capacity` particles, or NULL. */
void *mpsi_field_allocate(mps_context *context, const mpsi_field *field, int64_t capacity);
/* The field lies in a block of mpsi_field_allocate from now on; nothing is copied or freed. */
void mpsi_field_place(mpsi_field *field, void *block, int64_t capacity);

/* ---- edit.c ---------------------------------------------------------------------------------- */

/* The values of all particles become those of a field, or of one component of it (-1: of all), once
 * they are checked; a field that is not there is added. A holder may refuse them: nothing has
 * changed on an error. `shape`: of mpsi_field_look_up. */
mps_status mpsi_field_write(mps_particles *particles, const char *function, const char *name,
                            const mpsi_field *shape, int32_t component, const double *values);

/* ---- population.c ---------------------------------------------------------------------------- */

/* Notifies the holders of the particles from index `first` on, added with their positions; on an
 * error of one they are removed again. `status`: that of adding them; `places`: the arguments of
 * the positions. */
mps_status mpsi_particles_arrive(mps_particles *particles, const char *function, const char *places,
                                 mps_status status, int64_t first);

/* ---- particles.c ----------------------------------------------------------------------------- */

/* Destroys the set when neither the caller nor a holder needs it. */
void mpsi_particles_free_if_unused(mps_particles *particles);
/* Adds `here` particles to a set in parts, whose ids the caller enters with mpsi_particles_number
 * once they are in the field, from index `first` on. */
mps_status mpsi_particles_extend_part(mps_particles *particles, const char *function, int64_t count,
                                      int64_t here);
void mpsi_particles_number(mps_particles *particles, int64_t first);

/* ---- deal.c ---------------------------------------------------------------------------------- */

/* Whether additions are divided here: a solver on several ranks that holds the set divides them
 * itself. */
bool mpsi_particles_deals(const mps_particles *particles);
/* The first of `count` that rank `rank` gets. */
static inline int64_t mpsi_deal_first(const mpsi_deal *deal, int32_t rank, int64_t count) {
  return count / deal->size * rank + count % deal->size * rank / deal->size;
}
/* Whether all ranks add the same; `status`: of the call so far on this rank, and the result for a
 * set that is not in parts. */
mps_status mpsi_deal_agree(const mps_particles *particles, const char *function, mps_status status,
                           int64_t count, uint64_t hash);
/* Of lattice sites in order of a fill the part of this rank: intervals along the axis of their
 * greatest extent, of equal numbers. False: memory refused. */
typedef struct mpsi_slab {
  int32_t axis;
  int64_t first[2],
      skip[2];       /* begins and ends within these columns, behind so many of their sites */
  int64_t passed[2]; /* sites of both columns that mpsi_slab_next has seen */
  int64_t count;     /* sites in it */
} mpsi_slab;
bool mpsi_slab_cut(const mps_particles *particles, const mpsi_site_runs *sites, mpsi_slab *out);
/* Of each run in turn: the sites *begin to *end - 1 are in it. */
void mpsi_slab_next(mpsi_slab *slab, const mpsi_site_run *run, int64_t *begin, int64_t *end);

/* Solvers that hold the set. */
static inline int32_t mpsi_particles_solvers(const mps_particles *p) {
  int32_t count = 0;
  for (const mpsi_holder *h = p->holders; h; h = h->next) count += h->kind != MPSI_USE_LOOK;
  return count;
}
