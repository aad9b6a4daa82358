/* particles_internal.h - what the solvers use of a particle set besides the public functions.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_PARTICLES_INTERNAL_H
#define MPSI_PARTICLES_INTERNAL_H

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

/* Whether `ids` are particles of the set. The second takes NULL with a count of 0 for all of them,
 * as functions do that say what particles are made of. */
mps_status mpsi_particles_check_ids(const mps_particles *particles, const char *function,
                                    int64_t count, const int64_t *ids);
mps_status mpsi_particles_check_ids_or_all(const mps_particles *particles, const char *function,
                                           int64_t count, const int64_t *ids);

/* Reorders all fields: new index k holds what index order[k] held. `order` is a permutation of
 * [0, count). Columns stay where they are; the epoch changes. A solver that sorts holds its own
 * pin; when another one holds a pin too, this is MPS_ERROR_STATE. Errors (that one, or memory)
 * are recorded for `function` on the set's context, and nothing has changed. */
mps_status mpsi_particles_permute(mps_particles *particles, const char *function,
                                  const int64_t *order);
/* The same without allocating, on the context's threads: `scratch` are 1 to MPSI_PERMUTE_COLUMNS
 * places with room for count items of 8 bytes each. More are faster on more threads. */
#define MPSI_PERMUTE_COLUMNS 3
mps_status mpsi_particles_permute_in(mps_particles *particles, const char *function,
                                     const int64_t *order, void *const *scratch, int32_t columns);

/* ---- holders: who uses a set ------------------------------------------------------------------
 * A held set lives on when the caller destroys it, and goes with the last release. A solver holds
 * the set first of all and releases it last:
 *
 *   s->holder = (mpsi_holder){.name = "an mps_s solver", .self = s, .kind = MPSI_USE_MOVE, ...};
 *   status = mpsi_particles_hold(particles, function, &s->holder);
 *
 * and begins every step with mpsi_particles_ready. */
typedef enum mpsi_use {
  MPSI_USE_LOOK, /* looks at whatever is there: a recorder */
  MPSI_USE_FIX,  /* relies on order and positions, as other such holders may */
  MPSI_USE_MOVE  /* moves or sorts the particles: the only one besides those that look */
} mpsi_use;

/* How the particles of a set are dealt to ranks as they come: each gets an equal part of every
 * addition, before there is a solver. The callbacks are collective. */
typedef struct mpsi_deal {
  void *self; /* the domain */
  int32_t rank, size;
  /* The status of an addition on all ranks, which must be given the same number of particles
   * and the same hash of their places. */
  mps_status (*agree)(void *self, const char *function, mps_status status, int64_t count,
                      uint64_t hash);
  mps_status (*settle)(void *self, const char *function, mps_status status);
  void (*release)(void *self); /* when the set goes */
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
  /* The caller has written `field`. Refuses with an error recorded for `function` (the edit then
   * stays open), or notes what it must read or sort before the next step. NULL: all the same to it.
   * `former`, [component][particle], is what it was, of the fields that it compares; else NULL. */
  mps_status (*commit)(void *self, const char *function, const char *field, const double *former);
  bool (*compares)(const void *self, const char *field); /* NULL: none; of float64 fields */
  /* Particles [first, first + count) have come, with id and position, all else zero, and columns
   * may lie elsewhere: refuses, or makes room for them, and gives them values to begin with. NULL:
   * always refuses (but MPSI_USE_LOOK never). */
  mps_status (*insert)(void *self, const char *function, int64_t first, int64_t count);
  /* These particles are to go (ids of the set, all different): refuses, or makes ready. NULL: as
   * above. */
  mps_status (*remove)(void *self, const char *function, int64_t count, const int64_t *ids);
  /* Particles with a mark, by present index, are about to go: after that, or of the holder's own
   * accord. May be NULL. */
  void (*leaving)(void *self, const uint8_t *gone);
  /* After both, also where another holder refused: columns, count and order may have changed.
   * May be NULL. A holder that only looks is told too when the set goes back in time. */
  void (*renew)(void *self);
  /* Of a set that lies on several ranks: its rows in runs, whose places tell the order of the whole
   * (`out` NULL: how many). NULL: rank after rank. */
  int64_t (*runs)(const void *self, mpsi_row_run *out);
  /* Of such a set (NULL: all of it is here): what has become of adding the particles from `first`
   * on, on all ranks, which must have been given the same; and of removing those of a list, of
   * which `known` are here: *all is then the greatest count that a rank has given. Both come before
   * insert and remove. */
  mps_status (*agree)(void *self, const char *function, mps_status status, int64_t first);
  mps_status (*find)(void *self, const char *function, mps_status status, int64_t count,
                     const int64_t *ids, int64_t known, int64_t *all);
  mpsi_holder *next;
};

/* The runs that a holder tells of, or one of all rows, at `rank` along z. `out` NULL: how many. */
int64_t mpsi_particles_runs(const mps_particles *particles, int32_t rank, mpsi_row_run *out);

/* MPS_ERROR_STATE where another holder is in the way, or a field is being edited; solvers also
 * mpsi_particles_check_deal. */
mps_status mpsi_particles_check_hold(const mps_particles *particles, const char *function,
                                     mpsi_use kind);
mps_status mpsi_particles_hold(mps_particles *particles, const char *function, mpsi_holder *holder);
void mpsi_particles_release(mps_particles *particles, mpsi_holder *holder); /* set may be NULL */
/* Tells the holders that the caller has written a field, which was `former` before that (NULL: not
 * known); one may refuse. */
mps_status mpsi_particles_tell(mps_particles *particles, const char *function, const char *field,
                               const double *former);
/* At the beginning of each step: MPS_ERROR_STATE while the caller edits a field. */
mps_status mpsi_particles_ready(const mps_particles *particles, const char *function);

/* Before the caller changes values or number of the particles: MPS_ERROR_STATE in a callback of a
 * solver that holds the set; the second also while another field is edited. */
mps_status mpsi_particles_outside_callbacks(const mps_particles *particles, const char *function);
mps_status mpsi_particles_writable(const mps_particles *particles, const char *function);

/* As MPSI_USE_FIX without a name: no particle can be added or removed. Each pin needs its unpin.
 */
mps_particles *mpsi_particles_pin(mps_particles *particles); /* returns `particles` */
void mpsi_particles_unpin(mps_particles *particles);         /* accepts NULL */

/* ---- going back ------------------------------------------------------------------------------ */

/* All of a set as it is (fields, values, order, epoch), to go back to when the creation of a solver
 * fails: no particle may come or go in between. Needs the memory of the set once more. */
typedef struct mpsi_backup {
  void *memory; /* NULL: none taken */
  int32_t field_count;
  uint64_t epoch;
} mpsi_backup;
mps_status mpsi_particles_back_up(mps_particles *particles, const char *function,
                                  mpsi_backup *backup);
void mpsi_particles_go_back(mps_particles *particles, mpsi_backup *backup);
void mpsi_backup_drop(mps_particles *particles, mpsi_backup *backup);

/* A set keeps `count` of its particles, rows[0], rows[1], ... in this order, with room for
 * `capacity`, and gives up the rest, on behalf of a solver whose particles lie on several ranks.
 * What it was is in *former, to be taken back or dropped. */
typedef struct mpsi_storage mpsi_storage;
mps_status mpsi_particles_keep(mps_particles *particles, const char *function, int64_t count,
                               const int64_t *rows, int64_t capacity, mpsi_storage **former);
void mpsi_particles_take_back(mps_particles *particles, mpsi_storage **former);
void mpsi_storage_drop(mps_particles *particles, mpsi_storage **former);

/* Particles go to other ranks and come from there: room for so many, which may move the columns;
 * those with a mark leave; and, once the caller has written all columns of the rows from the count
 * on, others are there. */
mps_status mpsi_particles_hold_room(mps_particles *particles, const char *function, int64_t count);
/* population.c: gives up room for more than a few particles beside those that there are. */
mps_status mpsi_particles_fit(mps_particles *particles, const char *function);
void mpsi_particles_make_way(mps_particles *particles, const uint8_t *gone);
void mpsi_particles_admit(mps_particles *particles, int64_t arriving);

/* Takes back the fields added since there were `keep` of them; nobody may have borrowed them yet.
 */
void mpsi_particles_drop_fields(mps_particles *particles, int32_t keep);

/* A solver removes particles of its own set, after a step: those with a mark, by present index. The
 * other holders only look; all are told. Nothing is allocated. */
void mpsi_particles_take_out(mps_particles *particles, const uint8_t *gone);

/* MPS_ERROR_STATE when particles cannot come now: a holder refuses that, or a field is edited. */
mps_status mpsi_particles_check_free(const mps_particles *particles, const char *function);

/* How many particles the set ever had: ids lie below it. */
int64_t mpsi_particles_made(const mps_particles *particles);

mps_context *mpsi_particles_context(const mps_particles *particles);

#endif
