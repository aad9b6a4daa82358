/* mps/experimental/domain.h - several ranks (processes, or threads with a context each) that
 * compute one model together: on many machines, or on one.
 *
 * The library moves no bytes between ranks itself. A domain is made from a table of callbacks, the
 * transport; libmps-petsc (mps/experimental/petsc.h) makes one from an MPI communicator. A solver
 * is given the domain in its definition; each rank has a context, a particle set and a solver of
 * its own.
 *
 * Collective functions are called by all ranks, with the same arguments, in the same order: the
 * functions of a solver with a domain, except queries that need no other rank (listed in the
 * solver's header), and the functions of this header whose comments say so. They return the same
 * status on all ranks: an error on one rank is an error on all, with the same message, which names
 * the rank. Ranks that call different functions get MPS_ERROR_STATE, which names both, and so do
 * ranks that wait for one that has destroyed its domain (with `max_leave`); arguments that must be
 * the same on all ranks are compared first. Results are the same bit for bit for every number of
 * ranks and threads, and without a domain, as long as all processors run the same instruction
 * level.
 *
 * Thread rule: a domain belongs to its context. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_DOMAIN_H
#define LIBMPS_EXPERIMENTAL_DOMAIN_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../particles.h"
#include "../solver.h"

MPS_EXTERN_C_BEGIN

/** Bytes for another rank. */
typedef struct mps_domain_message {
  int32_t rank;     /* the receiver; at most one message for each */
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
  /** Sparse exchange, in which a receiver does not know its senders: sends `count` messages and
   *  receives all that other ranks send to this one. */
  mps_status (*rendezvous)(void *user, int32_t count, const mps_domain_message *messages,
                           mps_domain_room_fn room, void *room_user);
  /** A star joins the `own` items of this rank to their copies on other ranks, and the `guests`
   *  copies on this rank to their originals: guest k copies item index[k] of rank[k]. The lists
   *  belong to the library and are valid during the call. */
  mps_status (*star_create)(void *user, int64_t own, int64_t guests, const int32_t *rank,
                            const int64_t *index, void **star);
  /** Begins to copy all items, of item_bytes each, to their guests. The library neither reads nor
   *  writes these arrays before star_end. A star has at most one copy in progress. */
  mps_status (*star_begin)(void *user, void *star, int32_t item_bytes, const void *own,
                           void *guests);
  mps_status (*star_end)(void *user, void *star);
  void (*star_destroy)(void *user, void *star);
  /** Each value becomes the greatest, or the sum (modulo 2^64), of those of all ranks. No value is
   *  NaN. */
  mps_status (*reduce_max)(void *user, int32_t count, double *values);
  mps_status (*reduce_sum)(void *user, int32_t count, int64_t *values);
  mps_release_fn release; /* of `user`: ends the transport; NULL (default): nothing to do */
  /** reduce_max in two parts, between which the library computes and copies by stars, so that no
   *  rank waits for one a little behind: `values` are the library's until max_end, which has
   *  written the greatest there. One is under way at a time, and no other reduction. Both NULL
   *  (default): reduce_max takes the place of max_end. */
  mps_status (*max_begin)(void *user, int32_t count, double *values);
  mps_status (*max_end)(void *user);
  /** This rank's part in one more reduction of the kind that max_begin begins (reduce_max where
   *  that is NULL), without its result and without waiting: `values` are copied. Called before
   *  `release` where the transport works, so that ranks that are in another call, or go into one,
   *  get an error instead of waiting. NULL (default): they wait. */
  mps_status (*max_leave)(void *user, int32_t count, const double *values);
} mps_domain_def;

static inline mps_domain_def mps_domain_defaults(void) {
  mps_domain_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_DOMAIN, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Makes a domain: collective, and each rank gives its own context. Callbacks have no default
 *  unless stated. The transport is tested; MPS_ERROR_ARGUMENT where ranks do not agree upon
 *  version, instruction level or size. On an error `release` is not called. */
MPS_API MPS_NODISCARD mps_status mps_domain_create(mps_context *context, const mps_domain_def *def,
                                                   mps_domain **out);
/** Releases and nulls; accepts NULL. Not collective. Solvers keep the domain alive: its transport
 *  is destroyed with the last of them. */
MPS_API void mps_domain_destroy(mps_domain **domain);

/** This rank, 0 to size - 1; -1 for NULL. */
MPS_API int32_t mps_domain_rank(const mps_domain *domain);
/** Number of ranks; 0 for NULL. */
MPS_API int32_t mps_domain_size(const mps_domain *domain);

/** Agrees on a status: a program calls it after work that differs between ranks, such as writing a
 *  file on rank 0. Collective: returns MPS_OK where every rank passes that, and else the highest
 *  status passed, with the record (last error of its context) of the lowest rank that passed it.
 *  MPS_ERROR_ARGUMENT: NULL. */
MPS_API MPS_NODISCARD mps_status mps_domain_agree(mps_domain *domain, mps_status status);

/** Each value becomes the greatest of all ranks, such as a flag that requests a stop. Collective.
 *  MPS_ERROR_ARGUMENT: a NaN, or a `count` below 0 or not the same on all ranks. */
MPS_API MPS_NODISCARD mps_status mps_domain_max(mps_domain *domain, int32_t count, double *values);

/** Creates an empty set whose particles lie in parts on the ranks from the first on, so that no
 *  rank ever has memory for all of them. Fills and mps_particles_append are collective: all ranks
 *  pass the same arguments, which are compared, and each keeps an equal part (a slab across the
 *  longest side of a fill) with the ids of one process. Constants (mps_particles_set) are the same
 *  on all ranks; other values are set by each rank for its own particles. Views, selections and
 *  removals are those of a rank's own particles. A solver that is given this domain moves them to
 *  the ranks that need them (mps_mpm and mps_dynamics do; docs/domain.md), also where its creation
 *  then fails; others refuse the set with MPS_ERROR_STATE. On one rank as mps_particles_create,
 *  whose errors it has. Collective. */
MPS_API MPS_NODISCARD mps_status mps_domain_create_particles(mps_domain *domain,
                                                             const mps_particles_def *def,
                                                             mps_particles **out);

/** Brings the particles of all ranks together on rank 0, for output: *whole becomes a set of rank
 *  0's context with id, position and the `count` fields of `names` (NULL with count 0: all that
 *  `particles` has), each id once, in the order that explicit
 *  dynamics and WLS-MPM have without a domain (without a solver: rank after rank). Of an id on
 *  several ranks the highest one's copy counts. *whole NULL: created; else a set that this function
 *  has filled before, to be filled again: with the same fields and particles its views stay valid.
 *  On other ranks *whole stays NULL. Collective. All ranks have the same fields.
 *  MPS_ERROR_ARGUMENT: a set of another context, or *whole is `particles`;
 *  MPS_ERROR_FIELD: a field that the set lacks, or fields that differ between ranks;
 *  MPS_ERROR_STATE: a field is being edited; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_domain_gather_fields(mps_domain *domain,
                                                          mps_particles *particles, int64_t count,
                                                          const char *const *names,
                                                          mps_particles **whole);

/** Values of the field `name` for `count` particles, of any rank, on all ranks: values[k *
 *  components + c] is that of particle ids[k], whole numbers as they are up to 2^53. All ranks pass
 *  the same list. Collective. MPS_ERROR_ARGUMENT: an id of the list is on no rank; MPS_ERROR_FIELD:
 *  no such field. On an error `values` are not to be used. */
MPS_API MPS_NODISCARD mps_status mps_domain_get_field(mps_domain *domain, mps_particles *particles,
                                                      const char *name, const int64_t *ids,
                                                      int64_t count, double *values);

MPS_EXTERN_C_END
#endif
