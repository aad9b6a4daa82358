/* particles_internal.h - the interface of a particle set for solvers, besides the public functions.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/context/guard.h"
#include "core/internal.h"

#include <mps/particles.h>

/* One component of a float64 field as a contiguous array, or NULL when the set has no such field
 * or component. Aligned to MPSI_ALIGNMENT, and readable at least MPSI_PARTICLES_PADDING values
 * past the end, where zeros stand: vector loops may load there, and store there only zeros.
 * Valid until particles are added. */
#define MPSI_PARTICLES_PADDING 8
double *mpsi_particles_column(mps_particles *particles, const char *name, int32_t component);

/* The same for a field of one int64, or NULL. */
int64_t *mpsi_particles_integers(mps_particles *particles, const char *name);

/* Whether `name` is a field of the library's own, a row of fields.h. */
bool mpsi_field_is_known(const char *name);

/* Writes the present name of a caller's field that a file of libmps 0.3 has as `former`, without
 * "user."; false: `former` is not such a name. */
bool mpsi_field_own_name(const char *former, char *out, size_t size);

/* mps_particles_add_field for a solver that has been given a law, and for what restores a state:
 * the name may be that of a law's history. */
mps_status mpsi_particles_add_field(mps_particles *particles, const char *function,
                                    const char *name, int32_t components);

/* Whether `ids` are particles of the set. The second takes NULL with a count of 0 for all of them,
 * as functions that assign materials do. */
mps_status mpsi_particles_check_ids(const mps_particles *particles, const char *function,
                                    int64_t count, const int64_t *ids);
mps_status mpsi_particles_check_ids_or_all(const mps_particles *particles, const char *function,
                                           int64_t count, const int64_t *ids);

/* Reorders all fields: new index k holds what index order[k] held. `order` is a permutation of
 * [0, count). Columns stay where they are; the epoch changes. Where more than one solver holds the
 * set this is MPS_ERROR_STATE. Errors (that one, or memory) are recorded for `function` on the
 * set's context, and nothing has changed. */
mps_status mpsi_particles_permute(mps_particles *particles, const char *function,
                                  const int64_t *order);
/* The same without allocating, on the context's threads: `scratch` are 1 to MPSI_PERMUTE_COLUMNS
 * places with memory for count items of 8 bytes each. More are faster on more threads. */
#define MPSI_PERMUTE_COLUMNS 3
mps_status mpsi_particles_permute_in(mps_particles *particles, const char *function,
                                     const int64_t *order, void *const *scratch, int32_t columns);

/* ---- holders: users of a set ------------------------------------------------------------------
 * A held set exists until the caller has destroyed it and the last holder has released it. A solver
 * holds the set first of all and releases it last:
 *
 *   s->holder = (mpsi_holder){.name = "an mps_s solver", .self = s, .kind = MPSI_USE_MOVE, ...};
 *   status = mpsi_particles_hold(particles, function, &s->holder);
 *
 * and begins every step with mpsi_particles_ready. */
typedef enum mpsi_use {
  MPSI_USE_LOOK, /* reads the present set: a recorder */
  MPSI_USE_FIX,  /* relies on order and positions, as other such holders may */
  MPSI_USE_MOVE  /* moves or sorts the particles: the only one besides readers */
} mpsi_use;

/* Partition of a set in parts: each rank gets an equal part of every addition, before there is a
 * solver. The callbacks are collective. */
typedef struct mpsi_deal {
  void *self; /* the domain */
  int32_t rank, size;
  /* The status of an addition on all ranks, which must have the same number of particles and the
   * same hash of their positions. */
  mps_status (*agree)(void *self, const char *function, mps_status status, int64_t count,
                      uint64_t hash);
  mps_status (*settle)(void *self, const char *function, mps_status status);
  void (*release)(void *self); /* when the set is destroyed */
  uint64_t constants;          /* hash of the names and values of mps_particles_set */
} mpsi_deal;

/* deal.c: an empty set becomes one whose particles are dealt; `deal` is copied. */
mps_status mpsi_particles_deal_out(mps_particles *particles, const char *function,
                                   const mpsi_deal *deal);
/* NULL: all particles of the set are here. */
const mpsi_deal *mpsi_particles_deal(const mps_particles *particles);
/* MPS_ERROR_STATE where the set's particles are dealt to the ranks of another domain than `domain`
 * (NULL: a solver that takes none, or has been given none). */
mps_status mpsi_particles_check_deal(const mps_particles *particles, const char *function,
                                     const void *domain);

/* Rows of a set that lie on several ranks, and their place in the whole. */
typedef struct mpsi_row_run {
  int32_t at[3], reserved; /* z counts first, then y, then x */
  int64_t rows;
} mpsi_row_run;

typedef struct mpsi_holder mpsi_holder;
struct mpsi_holder {
  const char *name; /* "a WLS-MPM solver (mps_mpm)" */
  void *self;
  mpsi_use kind;
  const mpsi_guard *guard; /* while a callback of the holder runs, the caller may only read the set;
                              NULL: it has none */
  /* The caller has edited `field`. Returns an error recorded for `function` (the edit then stays
   * open), or notes what to read or sort before the next step. NULL: not affected. `former`,
   * [component][particle], has the former values, of the fields that it compares; else NULL. */
  mps_status (*commit)(void *self, const char *function, const char *field, const double *former);
  bool (*compares)(const void *self, const char *field); /* NULL: none; of float64 fields */
  /* Particles [first, first + count) are added, with id and position, all else zero, and columns
   * may have moved: returns an error, or allocates memory for them and sets their initial values.
   * NULL: always an error (MPSI_USE_LOOK: never). */
  mps_status (*insert)(void *self, const char *function, int64_t first, int64_t count);
  /* These particles are to be removed (ids of the set, all different): returns an error, or
   * prepares. NULL: as above. */
  mps_status (*remove)(void *self, const char *function, int64_t count, const int64_t *ids);
  /* Particles with a mark, by present index, are about to be removed: after `remove`, or by a
   * solver itself. May be NULL. */
  void (*leaving)(void *self, const uint8_t *gone);
  /* After both, also on an error of another holder: columns, count and order may have changed. May
   * be NULL. Readers are notified too when the set is restored to a former state. */
  void (*renew)(void *self);
  /* Whether it needs the field. NULL: all but those of the caller's own. */
  bool (*uses)(const void *self, const char *field);
  /* Of a set that lies on several ranks: its rows in runs, with their place in the order of the
   * whole (`out` NULL: how many). NULL: rank after rank. */
  int64_t (*runs)(const void *self, mpsi_row_run *out);
  /* Of such a set (NULL: all of it is here): status on all ranks, with the same arguments, of
   * adding the particles from `first` on; and of removing the particles of a list, of which `known`
   * are here: *all is then the greatest count of a rank. Both are called before insert and remove.
   */
  mps_status (*agree)(void *self, const char *function, mps_status status, int64_t first);
  mps_status (*find)(void *self, const char *function, mps_status status, int64_t count,
                     const int64_t *ids, int64_t known, int64_t *all);
  mpsi_holder *next;
};

/* The runs of a holder, or one of all rows, at `rank` along z. `out` NULL: how many. */
int64_t mpsi_particles_runs(const mps_particles *particles, int32_t rank, mpsi_row_run *out);

/* MPS_ERROR_STATE where another holder is in the way, or a field is being edited; solvers also
 * mpsi_particles_check_deal. */
mps_status mpsi_particles_check_hold(const mps_particles *particles, const char *function,
                                     mpsi_use kind);
mps_status mpsi_particles_hold(mps_particles *particles, const char *function, mpsi_holder *holder);
void mpsi_particles_release(mps_particles *particles, mpsi_holder *holder); /* set may be NULL */
/* Notifies the holders of an edited field, with its former values (NULL: not known); one may return
 * an error. */
mps_status mpsi_particles_notify(mps_particles *particles, const char *function, const char *field,
                                 const double *former);
/* MPS_ERROR_STATE while the caller edits a field: for functions that read values of the set, which
 * may not be in range yet. */
mps_status mpsi_particles_committed(const mps_particles *particles, const char *function);
/* At the beginning of each step: the same, and after a fault of the caller's executor. */
mps_status mpsi_particles_ready(const mps_particles *particles, const char *function);

/* Before the caller changes values or number of the particles: MPS_ERROR_STATE in a callback of a
 * solver that holds the set; the second also while another field is edited. */
mps_status mpsi_particles_outside_callbacks(const mps_particles *particles, const char *function);
mps_status mpsi_particles_writable(const mps_particles *particles, const char *function);

/* ---- rollback -------------------------------------------------------------------------------- */

/* Backup of a set (fields, values, order, epoch), restored when the creation of a solver fails: no
 * particle may be added or removed in between. Needs the memory of the set once more. */
typedef struct mpsi_backup {
  void *memory; /* NULL: none taken */
  int32_t field_count;
  uint64_t epoch;
} mpsi_backup;
mps_status mpsi_particles_back_up(mps_particles *particles, const char *function,
                                  mpsi_backup *backup);
void mpsi_particles_go_back(mps_particles *particles, mpsi_backup *backup);
void mpsi_backup_drop(mps_particles *particles, mpsi_backup *backup);

/* A set keeps `count` of its particles, rows[0], rows[1], ... in this order, with memory for
 * `capacity`, and drops the rest, for a solver whose particles lie on several ranks. The whole is
 * in *former, to be restored or freed. */
typedef struct mpsi_storage mpsi_storage;
mps_status mpsi_particles_keep(mps_particles *particles, const char *function, int64_t count,
                               const int64_t *rows, int64_t capacity, mpsi_storage **former);
void mpsi_particles_take_back(mps_particles *particles, mpsi_storage **former);
void mpsi_storage_drop(mps_particles *particles, mpsi_storage **former);

/* Migration: memory for so many particles, which may move the columns; removal of marked ones; and,
 * once the caller has written all columns of the rows from the count on, addition of received ones.
 */
mps_status mpsi_particles_hold_room(mps_particles *particles, const char *function, int64_t count);
/* population.c: releases memory beyond a few more than the present particles. */
mps_status mpsi_particles_fit(mps_particles *particles, const char *function);
void mpsi_particles_make_way(mps_particles *particles, const uint8_t *gone);
void mpsi_particles_admit(mps_particles *particles, int64_t arriving);

/* Removes all fields but the first `keep`; no view of the others may exist yet. */
void mpsi_particles_drop_fields(mps_particles *particles, int32_t keep);

/* A solver removes the marked particles (by present index) of its own set, after a step. Other
 * holders are readers; all are notified. Nothing is allocated. */
void mpsi_particles_take_out(mps_particles *particles, const uint8_t *gone);

/* MPS_ERROR_STATE when particles cannot be added: a holder does not allow it, or a field is being
 * edited. */
mps_status mpsi_particles_check_free(const mps_particles *particles, const char *function);

/* crowding.c: MPS_ERROR_ARGUMENT where a particle from index `from` on shares its place with
 * another one; logs a warning where space is filled above 1.5 of its volume. `amount`: of a solver
 * that reads the field `volume`; NULL: each particle has the volume of the spacing. */
typedef struct mpsi_amount {
  double measure; /* thickness (m) or angle of the sector (rad) */
  bool axisymmetric;
} mpsi_amount;
mps_status mpsi_particles_check_crowding(mps_particles *particles, const char *function,
                                         int64_t from, const mpsi_amount *amount);

/* Number of particles that the set ever had: ids lie below it. */
int64_t mpsi_particles_made(const mps_particles *particles);

mps_context *mpsi_particles_context(const mps_particles *particles);

/* MPS_ERROR_ARGUMENT when a caller's set is NULL or made from another context than `context`. */
mps_status mpsi_particles_check_context(const mps_particles *particles, mps_context *context,
                                        const char *function);
