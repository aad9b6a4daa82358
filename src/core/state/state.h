/* state.h - the state of a solver, listed once. From the one list follow a snapshot in memory, its
 * rollback bit for bit (this header), and a checkpoint file (io/checkpoint.h).
 *
 * A solver writes one function that lists, in a fixed order, what its steps change, and what must
 * be the same when saving and restoring. The particle set is included by itself: number, ids, order
 * and all fields. A solver needs:
 *
 *   static void list_state(mpsi_state *s, void *solver) {
 *     mps_foo *foo = solver;
 *     mpsi_state_agree_integer(s, "scheme", foo->def.scheme); // compared, never written
 *     mpsi_state_f64(s, "time", &foo->time, 1);
 *     mpsi_state_i64(s, "steps", &foo->steps, 1);
 *     mpsi_state_f64(s, "residual", foo->residual, foo->freedoms);
 *     mpsi_state_enter(s, "boundary%d", k);                   // names: "boundary0/force"
 *     mpsi_state_f64(s, "force", foo->boundary[k].force, 3);
 *     mpsi_state_leave(s);
 *   }
 *   static mpsi_state_of state_of(void *foo) {
 *     return (mpsi_state_of){.solver = foo, .name = "foo", .context = foo->context,
 *                            .particles = foo->particles, .identity = &foo->identity,
 *                            .list = list_state, .bind = bind_fields,
 *                            .time = foo->time, .dt = foo->dt, .steps = foo->steps};
 *   }
 *
 * which is the `state` of its kind (solver/solver_base.h): snapshots, rollback and files follow.
 * Values whose number changes in steps, or that are kept in another form, are a mpsi_state_table.
 *
 * A rollback has two phases: first everything is compared and all memory is allocated; then values
 * are written, which cannot fail. So an error changes nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/exact.h"

#include <mps/particles.h>
#include <mps/solver.h>

#include <string.h>

#define MPSI_STATE_MOST (INT64_C(1) << 53) /* of a counter in a file */
#define MPSI_STATE_NAME 96                 /* bytes of an item's name, with the terminating zero */

typedef struct mpsi_state mpsi_state; /* a list */

/* ---- listing ------------------------------------------------------------------------------- */

/* Values of fixed number, `count` of them at an address that is valid until the list is used.
 * Copied out and in. In a file all are float64 or int64. Integers count something, and those of a
 * file must be within 2^53, so that none overflows in any run; `bits` may have all values, and the
 * limbs of exact sums those that additions leave. */
void mpsi_state_f64(mpsi_state *state, const char *name, double *values, int64_t count);
void mpsi_state_i64(mpsi_state *state, const char *name, int64_t *values, int64_t count);
void mpsi_state_bits(mpsi_state *state, const char *name, int64_t *values, int64_t count);
void mpsi_state_exact(mpsi_state *state, const char *name, mpsi_exact *sums, int64_t count);
void mpsi_state_bool(mpsi_state *state, const char *name, bool *value);

/* The members of a reaction. */
void mpsi_state_reaction(mpsi_state *state, mps_reaction *reaction);

/* Construction or setup of the solver: where it differs, a rollback is an error that names the item
 * and both values. */
void mpsi_state_agree_integer(mpsi_state *state, const char *name, int64_t value);
/* Of an enumeration: a message names the enumerators. */
void mpsi_state_agree_choice(mpsi_state *state, const char *name, const char *enumeration,
                             int32_t value);
void mpsi_state_agree_number(mpsi_state *state, const char *name, double value);
void mpsi_state_agree_text(mpsi_state *state, const char *name, const char *value);

/* Names listed until the matching leave begin with this one and "/". Not nested deeper than 3. */
void mpsi_state_enter(mpsi_state *state, const char *format, ...) MPSI_PRINTF(2, 3);
void mpsi_state_leave(mpsi_state *state);

typedef enum mpsi_state_type {
  MPSI_STATE_F64 = 0,
  MPSI_STATE_I64 = 1,
  MPSI_STATE_BYTES = 2
} mpsi_state_type;

/* A table whose number of rows the steps change, or that the solver keeps in another form. Tables
 * are written in the order of the list. */
typedef struct mpsi_state_table {
  mpsi_state_type type;
  int32_t columns;
  int64_t (*rows)(const void *solver);
  void (*get)(const void *solver, void *values); /* rows * columns, row by row */
  /* Allocates memory for `set`, keeping the present contents; false: memory refused. NULL: none is
   * needed. */
  bool (*reserve)(void *solver, int64_t rows, const void *values);
  void (*set)(void *solver, int64_t rows, const void *values); /* cannot fail */
} mpsi_state_table;
void mpsi_state_add_table(mpsi_state *state, const char *name, const mpsi_state_table *table);
/* A table of another object than the solver, which is passed to its functions instead. */
void mpsi_state_add_table_of(mpsi_state *state, const char *name, const mpsi_state_table *table,
                             void *owner);
/* The same, of a state that may have another list of such tables: a table that it lacks has no rows
 * then, one that only it has is left out. `fits`: whether rows of a state, one or more, can be its
 * own. On ranks all have the same rows. */
typedef bool (*mpsi_state_fits_fn)(const void *owner, int64_t rows, const void *values);
void mpsi_state_add_optional(mpsi_state *state, const char *name, const mpsi_state_table *table,
                             mpsi_state_fits_fn fits, void *owner);

/* ---- a solver's description ---------------------------------------------------------------- */

typedef struct mpsi_identity mpsi_identity; /* identifies a solver, also after its destruction */

typedef struct mpsi_state_of {
  void *solver;
  const char *name; /* of the kind of solver: "WLS-MPM" */
  mps_context *context;
  mps_particles *particles; /* NULL: none goes along */
  mpsi_identity **identity; /* a member of the solver, NULL at first */
  void (*list)(mpsi_state *state, void *solver);
  void (*list_also)(mpsi_state *state, void *solver); /* optional tables after these; may be NULL */
  /* Of a file only, may be NULL: do the values fit, such as indices into arrays? False: the file is
   * malformed, `*what` names the fault. It may correct a value in place. */
  bool (*fits)(void *solver, mps_snapshot *values, const char **what);
  /* Allocates the solver's arrays for so many particles, keeping their contents; false: refused.
   * May be NULL. Where neither this nor `prepare` is given, the solver cannot be restored to other
   * particles; where one is, the next id and the occupied lattice sites of the set belong to the
   * state too. */
  bool (*reserve)(void *solver, int64_t particles);
  /* The same for a solver that builds a new structure of the particles of `from`, whose ids have
   * been checked, which `bind` then installs. It returns an error of status `disagreement` that
   * names `source` where the state is not of this solver. It may be called again, or never followed
   * by `bind`. May be NULL. */
  mps_status (*prepare)(void *solver, const char *function, const mps_snapshot *from,
                        const char *source, mps_status disagreement);
  /* Of a file only, may be NULL: keeps the values of this rank's particles; `status` is that of
   * reading them here. */
  mps_status (*take_share)(void *solver, const char *function, mps_status status,
                           mps_snapshot *values);
  /* May be NULL: of a solver on several ranks. Agrees on a status once everything that can fail is
   * done; `status` is that of this rank. */
  mps_status (*settle)(void *solver, const char *function, mps_status status);
  /* May be NULL, for a snapshot or file with the caller's edits: reads them once all memory is
   * allocated; `status` is that of this rank so far, the result that of all. On an error nothing
   * has been read. */
  mps_status (*take_in)(void *solver, const char *function, mps_status status);
  /* May be NULL, cannot fail. `bind`: the set is restored, its columns may have moved and its
   * number of particles changed; the values of the list are still to be written. `after`: these are
   * written too. */
  void (*bind)(void *solver);
  void (*after)(void *solver);
  double time, dt; /* s, for the head of a file */
  int64_t steps;
} mpsi_state_of;

/* Fills *snapshot, made if it is NULL, and otherwise one that this solver has filled before
 * (MPS_ERROR_ARGUMENT): its memory is reused. On an error it is as before. */
mps_status mpsi_state_snapshot(const mpsi_state_of *of, const char *function,
                               mps_snapshot **snapshot);
/* Restores the solver and its set. MPS_ERROR_ARGUMENT: NULL, or of another solver; MPS_ERROR_STATE:
 * a value that must agree differs. On an error nothing has changed. */
mps_status mpsi_state_rollback(const mpsi_state_of *of, const char *function,
                               const mps_snapshot *snapshot);
/* The two phases of a rollback, for a solver that makes a trial step in between.
 * mpsi_state_prepare_restore: everything of mpsi_state_rollback that can fail; mpsi_state_restore
 * restores, once, and cannot fail. */
typedef struct mpsi_state_prepared {
  const mps_snapshot *from;
  struct mpsi_state_item *item; /* the list */
  int32_t count;
  void *scratch;
} mpsi_state_prepared;
mps_status mpsi_state_prepare_restore(const mpsi_state_of *of, const char *function,
                                      const mps_snapshot *snapshot, mpsi_state_prepared *out);
void mpsi_state_restore(const mpsi_state_of *of, mpsi_state_prepared *prepared);
/* Whether the solver can be restored to other particles than those of the set. */
static inline bool mpsi_state_any_particles(const mpsi_state_of *of) {
  return of->reserve || of->prepare;
}
/* To be called when a solver is destroyed. */
void mpsi_state_forget(mpsi_identity **identity);

/* ---- the values: for this folder and io ------------------------------------------------------ */

/* A value of the list: [row][column]; a field of the set: [component][particle]. */
typedef struct mpsi_value {
  char name[MPSI_STATE_NAME];
  mpsi_state_type type;
  bool agrees, table, text, optional; /* text: terminated bytes */
  int32_t columns;
  int64_t rows;
  void *data;
  int64_t capacity; /* bytes of data */
} mpsi_value;

typedef struct mpsi_values {
  mpsi_value *item;
  int32_t count, capacity; /* items from `count` on may have memory for later use */
} mpsi_values;

struct mps_snapshot {
  mps_context *context;
  mpsi_identity *identity; /* of the solver that filled it */
  int64_t particles;
  mpsi_values state, fields;
  struct mpsi_state_item *list; /* memory of the last list, for the next one */
  int32_t list_capacity;
};

static inline int64_t mpsi_state_size(mpsi_state_type type) {
  return type == MPSI_STATE_BYTES ? 1 : 8;
}
static inline bool mpsi_state_name_ends(const char *name, const char *end) {
  const size_t n = strlen(name), m = strlen(end);
  return n >= m && strcmp(name + n - m, end) == 0;
}
/* Room for `count` items, and in one of them for rows of a type; contents stay; false: refused. */
bool mpsi_values_reserve(mps_context *context, mpsi_values *values, int32_t count);
bool mpsi_value_reserve(mps_context *context, mpsi_value *value, mpsi_state_type type, int64_t rows,
                        int32_t columns);
const mpsi_value *mpsi_values_find(const mpsi_values *values, const char *name); /* or NULL */
void mpsi_values_free(mps_context *context, mpsi_values *values);

/* The state alone, without the set, into `out` (empty, or filled before). */
mps_status mpsi_state_get(const mpsi_state_of *of, const char *function, mps_snapshot *out);
/* Compares the values that must agree. `source` and `status` are those of the following. */
mps_status mpsi_state_agree(const mpsi_state_of *of, const char *function, const mps_snapshot *from,
                            const char *source, mps_status status);
/* The first phase, and both. `source` names the origin of the values ("'run.h5'", "the snapshot"),
 * `status` is that of a disagreement. Fields that the set lacks are added. */
mps_status mpsi_state_prepare(const mpsi_state_of *of, const char *function,
                              const mps_snapshot *from, const char *source, mps_status status,
                              mpsi_state_prepared *out);
mps_status mpsi_state_restore_values(const mpsi_state_of *of, const char *function,
                                     const mps_snapshot *from, const char *source,
                                     mps_status status);

/* ---- state_particles.c: the set's part ------------------------------------------------------- */

/* All fields of the set with their ids, in order: first the memory, then the values, which cannot
 * fail. */
mps_status mpsi_particles_reserve_state(mps_particles *particles, const char *function,
                                        mps_snapshot *out);
void mpsi_particles_get_state(const mps_particles *particles, mps_snapshot *out);
/* Lists the data of a set besides its fields. A state with them may be restored to a set of another
 * number of particles. */
void mpsi_particles_list_state(mpsi_state *state, mps_particles *particles);
/* Makes an item, with room for one integer, that of the next id in that list. */
void mpsi_particles_name_next_id(mpsi_value *item, int64_t next_id);
/* After such a state is restored without a solver's list. */
void mpsi_particles_take_next_id(mps_particles *particles, const mps_snapshot *from);
/* The two phases of a rollback. A field that `from` lacks keeps its values, each with its particle
 * (zero in a restored one); one that the set lacks is added. `scratch` passes data of the first
 * phase to the second, which frees it. */
mps_status mpsi_particles_prepare_state(mps_particles *particles, const char *function,
                                        const mps_snapshot *from, void **scratch);
void mpsi_particles_drop_prepared(mps_particles *particles, void *scratch);
void mpsi_particles_put_state(mps_particles *particles, const mps_snapshot *from, void *scratch);
