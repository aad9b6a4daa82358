/* conditions.h - the numbered conditions of a solver, its boundaries and its loads: their
 * definitions, the lists and signals that these have, and what the solver makes of each.
 *
 * A definition is kept as the caller gave it, with copies of its lists and shares in its signals.
 * Where it selects particles by a box, or all of them, and the solver lists them, the kept one has
 * their ids instead. What a solver does in its own way is in a table of functions; these get the
 * solver as `void *`, as those of mpsi_solver_kind do, and the kept definition, whose lists live as
 * long as the condition. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/selection.h"
#include "core/definition/definition.h"
#include "signal/signal_internal.h"

#include <mps/solver.h>

enum { MPSI_BOUNDARIES, MPSI_LOADS, MPSI_CONDITION_LISTS };

/* A list in a definition, of 8-byte values: the names of the members that point to it and count its
 * items, and the values of an item. */
typedef struct mpsi_condition_list {
  const char *member, *count;
  int32_t each;
} mpsi_condition_list;

enum { MPSI_CONDITION_MOST_LISTS = 2 };

/* The members `kind` to `remove` of the conditions WHAT (BOUNDARY) of a solver. */
#define MPSI_CONDITION_OF(SOLVER, solver, WHAT, what_)                                             \
  .kind = MPS_DEF_##SOLVER##_##WHAT,                                                               \
  .definition = &mpsi_definition_of_mps_##solver##_##what_##_def, .what = #what_,                  \
  .add = "mps_" #solver "_add_" #what_, .set = "mps_" #solver "_set_" #what_,                      \
  .get = "mps_" #solver "_get_" #what_, .remove = "mps_" #solver "_remove_" #what_

/* `own`: what the solver makes of a definition, `size` zeroed bytes. Functions marked (*) may be
 * NULL. Those with a status return this rank's, but for `apply`. */
typedef struct mpsi_condition_kind {
  int32_t kind; /* MPS_DEF_... of the definitions */
  const mpsi_definition *definition;
  const char *what;                     /* "boundary" */
  const char *add, *set, *get, *remove; /* names of functions, for records */
  mpsi_signal_role role;                /* of the member `signal` */
  mpsi_condition_list list[MPSI_CONDITION_MOST_LISTS];
  int32_t first, most; /* numbers that can be added: first to most - 1 */
  size_t size;
  /* (*) A number below `first`, which exists without being added: whether it does, and its
   * definition as long as the caller has set none. */
  bool (*has)(const void *solver, int32_t number);
  void (*describe)(const void *solver, int32_t number, void *def);
  /* (*) Values of an item, where a choice decides. */
  int32_t (*each)(const void *def, int32_t list);
  /* (*) Rules that the table of the definition does not have. */
  mps_status (*check)(void *solver, const char *function, int32_t number, const void *def);

  /* ---- selection; (*) all functions ---- */
  bool selects; /* by ids, a box or `all`; numbers from `first` on */
  /* Whether the solver keeps a selection by a box, or of all, as it is. */
  bool (*keeps)(const void *def, mpsi_selected by);
  /* Place (m) and id of item k of those that can be selected; false: there is none. NULL: the
   * particles of the set. */
  bool (*item)(const void *solver, const void *def, int64_t k, double x[3], int64_t *id);
  const char *(*items)(const void *def); /* "particle" where NULL */
  /* Errors in the listed ids that one rank alone can find. NULL: all must be of particles of the
   * set, unless `some`. */
  mps_status (*check_ids)(void *solver, const char *function, const void *def, int64_t count,
                          const int64_t *ids);
  /* Whether this rank counts the item: ranks add up what they select. */
  bool (*counts)(const void *solver, int64_t id);
  bool some; /* a list may name items that are not there, as long as one is */

  mps_status (*make)(void *solver, const char *function, int32_t number, void *def, void *own);
  /* (*) Puts `own` with its `def` (NULL: none) in the place of `former` (NULL: none). Collective:
   * the same status on all ranks. On an error nothing has changed. */
  mps_status (*apply)(void *solver, const char *function, int32_t number, void *def, void *own,
                      void *former);
  void (*drop)(void *solver, void *own); /* (*) frees what it points to */
} mpsi_condition_kind;

/* By number: the definition, NULL where the number is free, and what the solver has made of it. */
typedef struct mpsi_conditions {
  const mpsi_condition_kind *kind;
  void **def, **own;
  int32_t capacity;
} mpsi_conditions;

/* Functions of a solver for one of its lists: PREFIX_count, above the numbers of its conditions,
 * and PREFIX_of, what it made of that of a number below, NULL where it is free. */
#define MPSI_CONDITION_ACCESS(prefix, solver_type, list, type)                                     \
  static inline int32_t prefix##_count(const solver_type *solver) {                                \
    return solver->conditions[list].capacity;                                                          \
  }                                                                                                \
  static inline type *prefix##_of(const solver_type *solver, int32_t number) {                     \
    return solver->conditions[list].own[number];                                                   \
  }

/* Frees all, which the solver needs no more. */
void mpsi_conditions_drop(mps_solver *solver);
