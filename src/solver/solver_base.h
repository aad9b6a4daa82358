/* solver_base.h - what all solvers are (mps/solver.h): a context and a set of particles that they
 * hold, ranks, a guard, steps to a time with the caller's hooks between them, and a state to save
 * and to return to. A solver is this base and what only it has:
 *
 *   struct mps_foo { MPSI_SOLVER_BASE; double viscosity; ... };
 *
 * `foo->base` is the base, and its members are those of `foo`. What a solver does in its own way is
 * in a table of functions, its mpsi_solver_kind; these get the solver as `void *`, which is the
 * pointer to its base and to itself. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/context/guard.h"
#include "core/internal.h"
#include "core/particles/particles_internal.h"
#include "core/state/state.h"
#include "solver/conditions.h"

#include <mps/history.h>
#include <mps/solver.h>

#include <math.h>

/* Names of the functions, for records of errors. */
typedef struct mpsi_solver_names {
  const char *step, *run, *callback, *dt, *set_dt, *get_totals, *get_reaction, *get_def, *snapshot,
      *rollback, *save, *restore, *destroy;
} mpsi_solver_names;

#define MPSI_SOLVER_NAMES(S)                                                                       \
  {                                                                                                \
    "mps_" S "_step", "mps_" S "_run", "the callback of mps_" S "_run", "mps_" S "_dt",            \
        "mps_" S "_set_dt", "mps_" S "_get_totals", "mps_" S "_get_reaction", "mps_" S "_get_def", \
        "mps_" S "_snapshot", "mps_" S "_rollback", "mps_" S "_save", "mps_" S "_restore",         \
        "mps_" S "_destroy"                                                                        \
  }

/* A call of step or run under way. */
typedef struct mpsi_march {
  double start, t_end; /* s; t_end NaN: a call of step */
  int64_t total;       /* steps to take; -1: until t_end, by steps that `advance` chooses */
  int64_t done;        /* of these */
  int64_t before;      /* steps that the solver had taken */
  int64_t every;       /* steps between calls of the callback */
  int64_t prompt;      /* at most so many steps between questions to the cancel hook */
  double length;       /* s, of equal steps, where the solver chooses such */
  bool last;           /* the steps being taken are the last */
  bool called;         /* the callback has run since the last step */
  bool calls;          /* it will run after the steps being taken */
  mps_solver_fn callback;
  void *user;
} mpsi_march;

static inline bool mpsi_march_is_run(const mpsi_march *march) { return !isnan(march->t_end); }

/* MPS_ERROR_ARGUMENT where a run by steps of `dt` would hardly end; for `begin`, once that is
 * known.
 */
mps_status mpsi_march_check(const mpsi_march *march, mps_context *context, const char *function,
                            double dt);

/* What a solver does in its own way. `function`: for records. Collective on ranks, but for time,
 * steps, dt, limit. Functions marked (*) may be NULL. */
typedef struct mpsi_solver_kind {
  mpsi_solver_names name;
  const char *task; /* of the progress hook */
  const mpsi_condition_kind *boundary, *load;
  int32_t def_kind; /* MPS_DEF_... of its own definition */
  void (*get_def)(const void *solver, void *def);
  double (*time)(const void *solver);
  int64_t (*steps)(const void *solver);
  double (*dt)(void *solver, const char *function); /* 0 where it cannot be chosen */
  double (*limit)(const void *solver);
  /* (*) MPS_ERROR_STATE where the solver cannot step or change now, other than in a callback; the
   * same on all ranks. */
  mps_status (*ready)(void *solver, const char *function);
  /* (*) The caller is about to change the solver: its step, conditions or state. */
  void (*changing)(void *solver);
  /* The worst status of all ranks, for statuses of this one. */
  mps_status (*agree)(void *solver, const char *function, mps_status status);
  mps_status (*check_dt)(void *solver, const char *function, double dt); /* this rank's */
  mps_status (*use_dt)(void *solver, const char *function, double dt);   /* after this check */
  mps_status (*get_totals)(void *solver, const char *function, mps_totals *out);
  /* `status`: whether the boundary is there, on this rank. */
  mps_status (*get_reaction)(void *solver, const char *function, mps_status status, int32_t number,
                             mps_reaction *out);

  /* Before the first step: reads what the caller has edited, and may change `total`, `prompt` and
   * `length` of the march (total is -1 in a run). */
  mps_status (*begin)(void *solver, const char *function, mpsi_march *march);
  /* (*) How many of the next `most` steps to take at once; NULL: one. */
  int64_t (*batch)(const void *solver, const mpsi_march *march, int64_t most);
  /* Takes `count` steps. Where `total` is -1 it sets `last`. On an error the solver is as after the
   * last complete step. */
  mps_status (*advance)(void *solver, const char *function, mpsi_march *march, int64_t count);
  /* (*) After the last step or an error: `status` is returned, or one of publishing the results. */
  mps_status (*end)(void *solver, const char *function, const mpsi_march *march, mps_status status);
  int32_t equation; /* mps_linear_equation that the caller's linear solver may solve, or 0 */
  /* (*) Whether one can be set now. This rank's status. */
  mps_status (*linear_ready)(void *solver, const char *function);
  void (*linear_changed)(void *solver); /* (*) after another one, or the library's own, is set */
  /* (*) On several ranks, where the step exchanges the cancel hook's answer: whether a rank asked
   * to stop. NULL: ranks agree after each question. */
  bool (*stopped)(const void *solver);

  /* ---- the state between two steps ---- */
  mpsi_state_of (*state)(void *solver);
  /* (*) Before a state is kept: reads the caller's edits; MPS_ERROR_STATE where there is none. This
   * rank's status. */
  mps_status (*settle)(void *solver, const char *function);
  /* (*) After a settle and what followed it, whose status is given: an error undoes what it can. */
  void (*settled)(void *solver, mps_status status);
  /* (*) Before a former state returns. This rank's status. */
  mps_status (*leave)(void *solver, const char *function);
  /* (*) After: quantities that follow from it and need other ranks. */
  mps_status (*returned)(void *solver, const char *function);
  /* (*) Writes the file, of a body that may lie on several ranks; NULL: all ranks have the same,
   * and rank 0 writes. */
  mps_status (*save)(void *solver, const mpsi_state_of *of, const char *function, const char *path,
                     const mps_checkpoint *info);
  /* Frees what only this solver has. */
  void (*destroy)(void *solver);
} mpsi_solver_kind;

typedef struct mpsi_linear mpsi_linear; /* linear.h */

#define MPSI_SOLVER_MEMBERS                                                                        \
  const mpsi_solver_kind *kind;                                                                    \
  mps_context *context;                                                                            \
  mps_particles *particles;                                                                        \
  mpsi_holder holder; /* of the particles */                                                       \
  mps_domain *domain; /* ranks, shared; NULL: none */                                              \
  mpsi_guard guard;                                                                                \
  mpsi_linear *linear; /* the caller's linear solver, NULL: none */                                \
  mpsi_conditions conditions[MPSI_CONDITION_LISTS];                                                \
  mpsi_identity *identity; /* of its snapshots */                                                  \
  mps_history *histories   /* the first of a list; histories.h */

struct mps_solver {
  MPSI_SOLVER_MEMBERS;
};

/* The first member of a solver: the base, whose members are also the solver's own. */
#define MPSI_SOLVER_BASE                                                                           \
  union {                                                                                          \
    mps_solver base;                                                                               \
    struct {                                                                                       \
      MPSI_SOLVER_MEMBERS;                                                                         \
    };                                                                                             \
  }

/* Starts a base of zeros, with shares in the context and the domain (or NULL), and holds the set,
 * which may be held: `holder` as this solver does. */
void mpsi_solver_start(mps_solver *solver, const char *function, const mpsi_solver_kind *kind,
                       mps_context *context, mps_particles *particles, mps_domain *domain,
                       const mpsi_holder *holder);
/* Ends it, also after a failed creation. The caller's pointer is NULL then. */
void mpsi_solver_end(mps_solver *solver);

/* Asks the cancel hook between steps: MPS_ERROR_CANCELLED on all ranks where one says so. */
mps_status mpsi_solver_check_cancel(mps_solver *solver, const char *function);
/* MPS_ERROR_STATE in a callback, and where the solver is not ready; the second for what changes it.
 */
mps_status mpsi_solver_enter(mps_solver *solver, const char *function);
mps_status mpsi_solver_enter_to_change(mps_solver *solver, const char *function);
