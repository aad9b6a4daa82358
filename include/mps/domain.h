/* mps/domain.h - several ranks (processes, or threads with a context each) that compute one model
 * together: on many machines, or on one.
 *
 * The library moves no bytes between ranks itself. A domain is made from a table of callbacks, the
 * transport; libmps-petsc (mps/petsc.h) makes one from an MPI communicator. A solver is given the
 * domain in its definition; each rank has a context, a particle set and a solver of its own.
 *
 * Collective functions are called by all ranks, with the same arguments and in the same order: the
 * functions of a solver with a domain, but those that only ask for what needs no other rank (the
 * solver's header says which), and the functions of this header that say so. They return the same
 * status on all ranks: an error on one rank is an error on all, with the same message, which names
 * the rank. Ranks that call different functions get MPS_ERROR_STATE, which names both, and so do
 * those that wait for a rank that has destroyed its domain (with `max_leave`); arguments that all
 * ranks must give alike are compared before anything is done. Results are the same bit for bit for
 * every number of ranks and threads, and without a domain, as long as all processors run the same
 * instruction level.
 *
 * Thread rule: a domain belongs to its context. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_DOMAIN_H
#define LIBMPS_DOMAIN_H

#include "particles.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_domain mps_domain;

/** Bytes for another rank. */
typedef struct mps_domain_message {
  int32_t rank;     /* to whom, at most one message each */
  int32_t reserved; /* 0 */
  int64_t bytes;    /* >= 0 */
  const void *data; /* the library's, unchanged until the call returns */
} mps_domain_message;

/** Gives memory for a message of `bytes` from `rank`, or NULL where there is none: the transport
 *  then drops the message and returns MPS_ERROR_MEMORY at the end. */
typedef void *(*mps_domain_room_fn)(void *room, int32_t rank, int64_t bytes);

/** The transport. Each callback is called on all ranks in the same order, but for star_destroy.
 *  It returns MPS_OK or the status of what went wrong; after that the domain is used no more, and
 *  every collective function that follows returns this status. A transport whose partners may die
 *  or whose messages may be lost ends its waits by a time limit of its own. */
typedef struct mps_domain_def {
  uint32_t struct_size;
  int32_t rank, size; /* 0 to size - 1; 1 to 1000000 */
  int32_t reserved;   /* 0 */
  void *user;
  /** Who talks to whom: sends `count` messages and receives those that others send to this rank, of
   *  which it does not know. */
  mps_status (*rendezvous)(void *user, int32_t count, const mps_domain_message *messages,
                           mps_domain_room_fn room, void *room_user);
  /** A star joins `own` items of this rank to their copies on others, and `guests` copies here to
   *  the items that they are of: guest k is item index[k] of rank[k]. The lists are the library's
   *  and go after the call. */
  mps_status (*star_create)(void *user, int64_t own, int64_t guests, const int32_t *rank,
                            const int64_t *index, void **star);
  /** Begins to copy all items, of item_bytes each, to their guests. The library touches neither
   *  array before star_end. One copy a star is under way at a time. */
  mps_status (*star_begin)(void *user, void *star, int32_t item_bytes, const void *own,
                           void *guests);
  mps_status (*star_end)(void *user, void *star);
  void (*star_destroy)(void *user, void *star);
  /** Each value becomes the greatest, or the sum (modulo 2^64), of those of all ranks. No value is
   *  NaN. */
  mps_status (*reduce_max)(void *user, int32_t count, double *values);
  mps_status (*reduce_sum)(void *user, int32_t count, int64_t *values);
  /** Called when the domain goes; NULL (default): nothing to do. */
  void (*destroy)(void *user);
  /** reduce_max in two parts, between which the library computes and copies by stars, so that no
   *  rank waits for one a little behind: `values` are the library's until max_end, which has
   *  written the greatest there. One is under way at a time, and no other reduction. Both NULL
   *  (default): reduce_max takes the place of max_end. */
  mps_status (*max_begin)(void *user, int32_t count, double *values);
  mps_status (*max_end)(void *user);
  /** This rank's part in one more reduction of the kind that max_begin begins (reduce_max where
   *  that is NULL), without its result and without waiting: `values` are copied. Called before
   *  `destroy` where the transport works, so that ranks that are in another call, or go into one,
   *  get an error instead of waiting. NULL (default): they wait. */
  mps_status (*max_leave)(void *user, int32_t count, const double *values);
} mps_domain_def;

MPS_API mps_status mps_domain_def_init(mps_domain_def *def, size_t size);
static inline mps_domain_def mps_domain_defaults(void) {
  mps_domain_def def;
  memset(&def, 0, sizeof def);
  if (mps_domain_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Makes a domain: collective, and each rank gives its own context. Callbacks have no default but
 *  where they say so. The transport is tried; MPS_ERROR_ARGUMENT where ranks do not agree upon
 *  version, instruction level or size. On an error `destroy` is not called. */
MPS_API MPS_NODISCARD mps_status mps_domain_create(mps_context *context, const mps_domain_def *def,
                                                   mps_domain **out);
/** Releases and nulls; accepts NULL. Not collective. Solvers keep the domain alive: its transport
 *  goes with the last of them. */
MPS_API void mps_domain_destroy(mps_domain **domain);

/** This rank, 0 to size - 1; -1 for NULL. */
MPS_API int32_t mps_domain_rank(const mps_domain *domain);
/** How many ranks compute the model; 0 for NULL. */
MPS_API int32_t mps_domain_size(const mps_domain *domain);

/** Makes the error of one rank that of all: a program calls it where ranks go different ways, such
 *  as after rank 0 has written a file. Collective: returns MPS_OK where every rank gives that, and
 *  else the highest status given, with the record of the lowest rank that gave it: the last error
 *  of its context. */
MPS_API MPS_NODISCARD mps_status mps_domain_agree(mps_domain *domain, mps_status status);

/** Each value becomes the greatest of all ranks (none may be NaN): whether one was asked to stop.
 *  Collective. */
MPS_API MPS_NODISCARD mps_status mps_domain_max(mps_domain *domain, int32_t count, double *values);

/** Creates an empty set whose particles lie in parts on the ranks from the first on, so that no
 * rank ever has memory for all of them. Fills and mps_particles_append are collective: all ranks
 * give the same, which is compared, and each keeps an equal part (a slab across the longest side of
 * a fill) with the ids of one process. Constants (mps_particles_set) are given alike on all ranks,
 *  other values by each rank for the particles that it has. Views, selections and removals are
 * those of a rank's own particles. A solver that is given this domain moves them to the ranks that
 * need them (mps_mpm and mps_dynamics do; docs/domain.md), also where its creation then fails;
 * others refuse the set with MPS_ERROR_STATE. On one rank as mps_particles_create, whose errors it
 * has. Collective. */
MPS_API MPS_NODISCARD mps_status mps_domain_create_particles(mps_domain *domain,
                                                             const mps_particles_def *def,
                                                             mps_particles **out);

/** Brings the particles of all ranks together on rank 0, for output: *whole becomes a set of rank
 *  0's context with all fields that `particles` has, each id once, in the order that explicit
 *  dynamics and WLS-MPM have without a domain (without a solver: rank after rank). Of an id on
 *  several ranks the highest one's copy counts. *whole NULL: made; else one that this function has
 *  filled before, to be filled again: with the same fields and particles, views of it stay good.
 *  On other ranks *whole stays NULL. Collective. All ranks have the same fields. */
MPS_API MPS_NODISCARD mps_status mps_domain_gather(mps_domain *domain, mps_particles *particles,
                                                   mps_particles **whole);

/** The same of `count` fields by name, with id and position: what a picture or a table needs, and
 *  less to send. MPS_ERROR_FIELD: the set has none of a name, or not all ranks name the same. */
MPS_API MPS_NODISCARD mps_status mps_domain_gather_fields(mps_domain *domain,
                                                          mps_particles *particles, int32_t count,
                                                          const char *const *names,
                                                          mps_particles **whole);

/** Values of the field `name` for `count` particles, on whatever rank they are, on all ranks:
 *  values[k * components + c] is that of particle ids[k], whole numbers as they are up to 2^53.
 *  All ranks give the same list. Collective. MPS_ERROR_ARGUMENT: no rank has an id of the list;
 *  MPS_ERROR_FIELD. On an error `values` are not to be used. */
MPS_API MPS_NODISCARD mps_status mps_domain_get_field(mps_domain *domain, mps_particles *particles,
                                                      const char *name, int64_t count,
                                                      const int64_t *ids, double *values);

MPS_EXTERN_C_END
#endif
