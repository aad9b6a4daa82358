/* calls_solver.h - the functions of all solvers (mps/solver.h), as calls of one of them:
 *
 *   API_SOLVER(mpm, API_MPM)    defines them
 *   API_SOLVER_CALLS(mpm, API_MPM)    their lines of the table
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_API_CALLS_SOLVER_H
#define TESTS_API_CALLS_SOLVER_H

#include "calls.h"

#include <mps/solver.h>

#include <stdio.h>

/* State after a failed step or run: earlier steps are kept. `steps`: taken before and after. A step
 * that diverged may have happened. */
void api_stepped(api *a, mps_status status, int64_t before, int64_t after);
/* A snapshot or checkpoint of WLS-MPM or explicit dynamics reads first what the caller has edited,
 * as a step does; one that is refused leaves the edits unread, but may have sorted the particles of
 * WLS-MPM. */
void api_reads_edits(api *a, api_kind kind, const api_object *o, mps_status status);
/* t_end of a run of a few steps. */
double api_t_end(api *a, double time, double dt);
/* Path of the file of this solver. */
void api_path(api *a, char path[300], const char *kind);
/* In an absurd mood: damages the file. */
void api_damage(api *a, const char *path);
/* Before and after steps: what open sides have taken out is what the mass lacks. Where they took
 * nothing, the sum of mps_totals stays, to 1e-8 of its largest term (but of a solver that holds
 * particles by ids, WLS-MPM: `loose`); and where there are only boundaries and gravity, the
 * momentum changes by their impulses, to 1e-9 of what has flowed (SOLVER_MOMENTUM: not of the
 * fluid, whose header states another bound). */
typedef struct api_account {
  mps_status status;
  int64_t count;
  double time, removed, impulse[3], gravity[3]; /* s, kg, N s, m/s2 */
  bool pushed;                                  /* forces or damping by fields of the set */
  bool radial;                                  /* x is a distance from an axis */
  mps_totals totals;
} api_account;
/* Whether forces or damping on the particles are fields of the set, and not all 0. */
bool api_field_acts(mps_particles *set);
void api_add_impulse(api_account *account, mps_status status, const mps_reaction *reaction);
void api_balance(api *a, const api_object *o, const api_account *before, const api_account *after,
                 bool momentum);

/* Ends the call: a linear solver, which does not solve, or the library's own again. */
void api_set_linear_solver(api *a, mps_solver *solver, int32_t equation);

/* Parts of a solver, then of its set. */
typedef struct api_state {
  int count[2];
  api_part parts[2][API_PARTS];
} api_state;
void api_read(api *a, api_kind kind, api_object *o, mps_particles *set, api_state *state);
/* Says what differs, but for what a rollback leaves as it is. */
void api_same(api *a, const api_state *x, const api_state *y, const char *but, const char *when);

#define API_SOLVER(S, KIND)                                                                        \
  API_DESTROY(S##_destroy, KIND)                                                                   \
  API_QUERY(S##_particles, KIND)                                                                   \
  API_QUERY(S##_context, KIND)                                                                     \
  API_QUERY(S##_time, KIND)                                                                        \
  API_QUERY(S##_steps, KIND)                                                                       \
  API_QUERY(S##_limit, KIND)                                                                       \
  static void S##_dt(api *a) {                                                                     \
    if (isnan(mps_##S##_dt(api_any(a, KIND)->handle))) api_broken(a, "is NaN");                    \
    api_end_changed(a);                                                                            \
  }                                                                                                \
  static void S##_get_totals_sized(api *a) {                                                       \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    API_SIZED(a, mps_totals, size, out);                                                           \
    const mps_status status =                                                                      \
        mps_solver_get_totals_sized(mps_##S##_solver(s), api_null(a, "out") ? NULL : out, size);   \
    API_SIZED_END(a, status, size, out, true);                                                     \
  }                                                                                                \
  static void S##_get_def_sized(api *a) {                                                          \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    API_SIZED(a, mps_##S##_def, size, out);                                                        \
    const mps_status status = mps_solver_get_def(mps_##S##_solver(s), SOLVER_DEF,                  \
                                                 api_null(a, "out") ? NULL : out, size);           \
    API_SIZED_END(a, status, size, out, true);                                                     \
  }                                                                                                \
  static void S##_get_reaction_sized(api *a) {                                                     \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    const int32_t number = (int32_t)api_least(a, "number", 0, 9);                                  \
    API_SIZED(a, mps_reaction, size, out);                                                         \
    const mps_status status =                                                                      \
        mps_solver_get_reaction_sized(mps_##S##_solver(s), number, out, size);                     \
    API_SIZED_END(a, status, size, out, true);                                                     \
  }                                                                                                \
  static void S##_get_boundary(api *a) {                                                           \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    const int32_t number = (int32_t)api_least(a, "number", 0, 8);                                  \
    API_SIZED(a, mps_##S##_boundary_def, size, out);                                               \
    const mps_status status = mps_solver_get(mps_##S##_solver(s), SOLVER_BOUNDARY, number,         \
                                             api_null(a, "out") ? NULL : out, size);               \
    API_SIZED_END(a, status, size, out, true);                                                     \
  }                                                                                                \
  static void S##_get_load(api *a) {                                                               \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    const int32_t number = (int32_t)api_least(a, "number", 0, 3);                                  \
    API_SIZED(a, mps_##S##_load_def, size, out);                                                   \
    const mps_status status = mps_solver_get(mps_##S##_solver(s), SOLVER_LOAD, number,             \
                                             api_null(a, "out") ? NULL : out, size);               \
    API_SIZED_END(a, status, size, out, true);                                                     \
  }                                                                                                \
  static void S##_get_numbers(api *a) {                                                            \
    int32_t numbers[4];                                                                            \
    int64_t count = -1, capacity = api_below(a, 5);                                                \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    if (a->mood == API_ABSURD && api_chance(a, 20)) capacity = -1, api_wrong(a, "capacity");       \
    const mps_status status = mps_solver_get_numbers(                                              \
        mps_##S##_solver(s), api_chance(a, 50) ? MPS_DEF_LOAD : SOLVER_BOUNDARY, capacity,         \
        api_null(a, "count") ? NULL : &count, numbers);                                            \
    if (status == MPS_OK && count < 0) api_broken(a, "counts %lld", (long long)count);             \
    a->reads = true;                                                                               \
    (void)api_end(a, status);                                                                      \
  }                                                                                                \
  static void S##_remove_boundary(api *a) {                                                        \
    api_object *o = api_any(a, KIND);                                                              \
    mps_##S *s = o->handle;                                                                        \
    o->drags = o->drags || KIND == API_ELASTIC;                                                    \
    (void)api_end(a, mps_##S##_remove_boundary(s, (int32_t)api_least(a, "number", 0, 8)));         \
  }                                                                                                \
  static void S##_remove_load(api *a) {                                                            \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    (void)api_end(a, mps_##S##_remove_load(s, (int32_t)api_least(a, "number", 0, 3)));             \
  }                                                                                                \
  static api_account S##_account(mps_##S *s) {                                                     \
    api_account account = {.count = mps_particles_count(mps_##S##_particles(s)),                   \
                           .time = mps_##S##_time(s),                                              \
                           .pushed = api_field_acts(mps_##S##_particles(s))};                      \
    for (int32_t k = 0; k < 16; k++) {                                                             \
      mps_reaction reaction;                                                                       \
      const mps_status given = mps_##S##_get_reaction(s, k, &reaction);                            \
      api_add_impulse(&account, given, &reaction);                                                 \
    }                                                                                              \
    SOLVER_GRAVITY(s, &account)                                                                    \
    account.status = mps_##S##_get_totals(s, &account.totals);                                     \
    return account;                                                                                \
  }                                                                                                \
  static bool step_by(api *a, api_object *o, int64_t count) {                                      \
    mps_##S *s = o->handle;                                                                        \
    api_account first = {.status = MPS_ERROR_STATE};                                               \
    if (SOLVER_COUNTS(s)) first = S##_account(s);                                                  \
    const int64_t before = mps_##S##_steps(s);                                                     \
    api_run_solver(a, KIND, o);                                                                    \
    const mps_status status = mps_##S##_step(s, count);                                            \
    api_stepped(a, status, before, mps_##S##_steps(s));                                            \
    if (status == MPS_OK && first.status == MPS_OK) {                                              \
      const api_account last = S##_account(s);                                                     \
      api_balance(a, o, &first, &last, SOLVER_MOMENTUM);                                           \
    }                                                                                              \
    if (status == MPS_OK) o->rewritten = false;                                                    \
    return api_end(a, status);                                                                     \
  }                                                                                                \
  static void S##_step(api *a) {                                                                   \
    api_object *o = api_any(a, KIND);                                                              \
    const int64_t count = api_least(a, "count", 0, 4);                                             \
    (void)step_by(a, o, count);                                                                    \
  }                                                                                                \
  static void S##_run(api *a) {                                                                    \
    api_object *o = api_any(a, KIND);                                                              \
    mps_##S *s = o->handle;                                                                        \
    const double t_end = api_t_end(a, mps_##S##_time(s), SOLVER_DT(s));                            \
    const int64_t every = api_least(a, "every", 1, 3), before = mps_##S##_steps(s);                \
    api_run_solver(a, KIND, o);                                                                    \
    const mps_status status =                                                                      \
        mps_##S##_run(s, t_end, every, api_chance(a, 80) ? api_in_run_##S : NULL, &a->plan);       \
    const bool published = KIND == API_ELASTIC && a->wrong == 0; /* fields, for the callback */    \
    if (status == MPS_OK && mps_##S##_time(s) != t_end) api_broken(a, "ends elsewhere");           \
    api_stepped(a, status, before, mps_##S##_steps(s));                                            \
    if (published) a->change = API_CHANGES_ALL;                                                    \
    (void)api_end(a, status);                                                                      \
  }                                                                                                \
  static void S##_set_dt(api *a) {                                                                 \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    double dt = mps_##S##_limit(s);                                                                \
    if (!(dt > 0.0 && dt < 1.0)) dt = 1e-3;                                                        \
    dt *= 0.2 + api_unit(a);                                                                       \
    if (a->mood == API_ABSURD && api_chance(a, 40)) {                                              \
      const double values[] = {0.0, -1.0, INFINITY, -INFINITY};                                    \
      dt = values[api_below(a, 4)];                                                                \
      api_wrong(a, "dt");                                                                          \
    }                                                                                              \
    api_say(a, "dt = %.17g, ", dt);                                                                \
    (void)api_end(a, mps_##S##_set_dt(s, dt));                                                     \
  }                                                                                                \
  /* Into a new snapshot, or one that may be of another solver. */                                 \
  static void S##_snapshot(api *a) {                                                               \
    api_object *o = api_any(a, KIND);                                                              \
    api_object *old =                                                                              \
        api_chance(a, 50) && api_alive(a, API_SNAPSHOT) ? api_any(a, API_SNAPSHOT) : NULL;         \
    if (old && !old->handle) old = NULL, a->wrong -= o->handle != NULL;                            \
    mps_snapshot *made = old ? old->handle : NULL;                                                 \
    if (old && o->handle && old->owner != o->serial) api_wrong(a, "snapshot");                     \
    const mps_status status = mps_##S##_snapshot(o->handle, &made);                                \
    if (old && made != old->handle) api_broken(a, "changes the handle");                           \
    if (!old) (void)api_adopt(a, API_SNAPSHOT, made, a->context, o);                               \
    a->reads = true;                                                                               \
    api_reads_edits(a, KIND, o, status);                                                           \
    (void)api_end(a, status);                                                                      \
  }                                                                                                \
  static void S##_rollback(api *a) {                                                               \
    api_object *o = api_any(a, KIND);                                                              \
    api_object *old = api_any(a, API_SNAPSHOT);                                                    \
    if (old->handle && o->handle && old->owner != o->serial) api_wrong(a, "snapshot");             \
    (void)api_end(a, mps_##S##_rollback(o->handle, old->handle));                                  \
  }                                                                                                \
  /* A rollback restores the state, and the same steps lead to the same state again. */            \
  static void S##_return(api *a) {                                                                 \
    static api_state begin, back, first, second;                                                   \
    api_object *o = api_any(a, KIND);                                                              \
    mps_##S *s = o->handle;                                                                        \
    mps_snapshot *snapshot = NULL;                                                                 \
    const mps_status status = mps_##S##_snapshot(s, &snapshot);                                    \
    (void)api_adopt(a, API_SNAPSHOT, snapshot, a->context, o);                                     \
    a->reads = true;                                                                               \
    api_reads_edits(a, KIND, o, status);                                                           \
    if (!api_end(a, status)) return;                                                               \
    a->latest = true;                                                                              \
    api_read(a, KIND, o, mps_##S##_particles(s), &begin);                                          \
    const int64_t count = 1 + (int64_t)api_below(a, 3);                                            \
    bool whole = false;                                                                            \
    /* edited moduli are read by the first step, which a rollback does not make undone */          \
    const char *but = KIND == API_ELASTIC && o->loose ? "energies" : NULL;                         \
    for (int pass = 0; pass < 3; pass++) { /* the first goes back at once */                       \
      if (pass > 0) {                                                                              \
        api_begin(a, "mps_" #S "_step");                                                           \
        api_say(a, "%s%d, %d", api_kind_names[KIND], (int)(o - a->objects[KIND]), (int)count);     \
        a->context = o->context;                                                                   \
        const bool stepped = step_by(a, o, count);                                                 \
        api_read(a, KIND, o, mps_##S##_particles(s), pass == 1 ? &first : &second);                \
        if (pass == 1) whole = stepped;                                                            \
        if (pass == 2 && stepped != whole) api_broken(a, "fails in one of two passes");            \
        if (pass == 2 && stepped)                                                                  \
          api_same(a, &first, &second, NULL, "after the same steps again");                        \
        if (pass == 2) break;                                                                      \
      }                                                                                            \
      api_begin(a, "mps_" #S "_rollback");                                                         \
      api_say(a, "%s%d", api_kind_names[KIND], (int)(o - a->objects[KIND]));                       \
      a->context = o->context;                                                                     \
      if (!api_end(a, mps_##S##_rollback(s, snapshot))) api_broken(a, "does not go back");         \
      api_read(a, KIND, o, mps_##S##_particles(s), &back);                                         \
      api_same(a, &begin, &back, but, "after a rollback");                                         \
      if (a->reason[0]) break;                                                                     \
    }                                                                                              \
    a->latest = false;                                                                             \
    api_settle(a);                                                                                 \
  }                                                                                                \
  static void S##_save(api *a) {                                                                   \
    char path[300];                                                                                \
    mps_checkpoint info = mps_checkpoint_defaults();                                               \
    api_object *o = api_any(a, KIND);                                                              \
    mps_##S *s = o->handle;                                                                        \
    api_path(a, path, #S);                                                                         \
    const bool given = api_chance(a, 50);                                                          \
    if (given) info.struct_size = api_struct_size(a, sizeof info);                                 \
    const mps_status status =                                                                      \
        mps_##S##_save(s, api_null(a, "path") ? NULL : path, given ? &info : NULL);                \
    a->reads = true;                                                                               \
    api_reads_edits(a, KIND, o, status);                                                           \
    (void)api_end(a, status);                                                                      \
  }                                                                                                \
  static void S##_restore(api *a) {                                                                \
    char path[300];                                                                                \
    mps_checkpoint info = mps_checkpoint_defaults();                                               \
    mps_##S *s = api_any(a, KIND)->handle;                                                         \
    api_path(a, path, api_chance(a, 90) ? #S : "fluid");                                           \
    api_damage(a, path);                                                                           \
    const bool given = api_chance(a, 50);                                                          \
    (void)api_end(a,                                                                               \
                  mps_##S##_restore(s, api_null(a, "path") ? NULL : path, given ? &info : NULL));  \
  }

#define API_SOLVER_CALLS(S, KIND)                                                                  \
  {"mps_" #S "_destroy", 1, KIND, destroy_##S##_destroy},                                          \
      {"mps_" #S "_particles", 1, KIND, query_##S##_particles},                                    \
      {"mps_" #S "_context", 1, KIND, query_##S##_context},                                        \
      {"mps_" #S "_time", 1, KIND, query_##S##_time},                                              \
      {"mps_" #S "_steps", 1, KIND, query_##S##_steps}, {"mps_" #S "_dt", 1, KIND, S##_dt},        \
      {"mps_" #S "_limit", 1, KIND, query_##S##_limit},                                            \
      {"mps_" #S "_get_totals_sized", 1, KIND, S##_get_totals_sized},                              \
      {"mps_" #S "_get_def_sized", 1, KIND, S##_get_def_sized},                                    \
      {"mps_" #S "_get_reaction_sized", 1, KIND, S##_get_reaction_sized},                          \
      {"mps_" #S "_get_boundary", 2, KIND, S##_get_boundary},                                      \
      {"mps_" #S "_get_load", 1, KIND, S##_get_load},                                              \
      {"mps_solver_get_numbers", 1, KIND, S##_get_numbers},                                        \
      {"mps_" #S "_remove_boundary", 2, KIND, S##_remove_boundary},                                \
      {"mps_" #S "_remove_load", 1, KIND, S##_remove_load},                                        \
      {"mps_" #S "_step", 14, KIND, S##_step}, {"mps_" #S "_run", 6, KIND, S##_run},               \
      {"mps_" #S "_set_dt", 3, KIND, S##_set_dt}, {"mps_" #S "_snapshot", 3, KIND, S##_snapshot},  \
      {"mps_" #S "_snapshot", 4, KIND, S##_return},                                                \
      {"mps_" #S "_rollback", 4, KIND, S##_rollback}, {"mps_" #S "_save", 2, KIND, S##_save}, {    \
    "mps_" #S "_restore", 3, KIND, S##_restore                                                     \
  }

#endif
