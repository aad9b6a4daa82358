/* step.c - the order of a step, its size, and its errors.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/base/access.h"
#include "fluid/boundary/walls.h"
#include "fluid/particles/look.h"
#include "fluid/particles/holder.h"
#include "fluid/reading/probe.h"
#include "fluid/step/afloat.h"
#include "fluid/step/bound.h"
#include "fluid/step/exchange.h"
#include "fluid/step/move.h"
#include "fluid/step/step.h"
#include "fluid/step/warn.h"
#include "fluid/particles/pores.h"
#include "fluid/particles/rock.h"
#include "fluid/ranks/partition.h"

#include <mps/experimental/fluid_parts.h>
#include <string.h>

#define SORT_EVERY 32   /* steps */
#define EVEN_STEPS 32   /* at the end of a run */
#define AT_REST 0.1     /* (l0/g)^1/2 */
#define HALVINGS 3      /* of a step in which a particle goes too far */
#define LEAST_STEP 1e-4 /* of the step at rest */

/* ---- fields and cloud ------------------------------------------------------------------------ */

static double *column(const mps_fluid *f, const char *name, int32_t component) {
  return mpsi_particles_column(f->particles, name, component);
}

static void store_part(mps_fluid *f, int64_t begin, int64_t end, int64_t part) {
  const size_t bytes = (size_t)(end - begin) * sizeof(double);
  double *q = column(f, "reduced_pressure", 0), most = 0.0;
  memcpy(column(f, "surface_rise", 0) + begin, mpsi_fluid_rises(f) + begin, bytes);
  int64_t *surface = mpsi_particles_integers(f->particles, "free_surface");
  for (int c = 0; c < 2; c++) {
    memcpy(column(f, "position", c) + begin, f->x[c] + begin, bytes);
    memcpy(column(f, "velocity", c) + begin, f->u[c] + begin, bytes);
  }
  memcpy(column(f, "reduced_pressure_old", 0) + begin, q + begin, bytes);
  memcpy(q + begin, f->q + begin, bytes);
  memcpy(column(f, "pressure", 0) + begin, f->pressure + begin, bytes);
  for (int64_t i = begin; i < end; i++) {
    surface[i] = f->state[i];
    most = mpsi_fluid_larger(f->u[0][i] * f->u[0][i] + f->u[1][i] * f->u[1][i], most);
  }
  f->system.sums[part] = most;
}

static void store_cloud(mps_fluid *f) {
  mpsi_fluid_for_all(f, f->count, MPSI_FLUID_COPIED, store_part);
  f->last_dt = f->dt;
  f->unknown = 0;
  double most = 0.0;
  for (int64_t k = 0; k * MPSI_FLUID_COPIED < f->count; k++)
    most = mpsi_fluid_larger(f->system.sums[k], most);
  f->speed = sqrt(most);
}

/* ---- one step -------------------------------------------------------------------------------- */

static mps_status went_wrong(mps_fluid *f, const char *function, int64_t i, double way) {
  const long long id = (long long)mpsi_particles_integers(f->particles, "id")[i];
  const mps_status status = mpsi_fail(
      f->context, function, MPS_ERROR_DIVERGED,
      "step %lld, t = %g s: particle %lld at (%g, %g) m moves %g m with (%g, %g) m/s, allowed is "
      "half a spacing, %g m; dt was %g s, %.3g of the recommended limit; the step was not made",
      (long long)f->steps, f->time, id, column(f, "position", 0)[i], column(f, "position", 1)[i],
      way, f->u[0][i], f->u[1][i], 0.5 * f->l0, f->dt, f->dt / mpsi_fluid_limit(f));
  mpsi_fail_where(f->context, f->steps, id);
  return status;
}

/* Loads and the caller's forces on particles, over the step, before the pressure solution. */
static mps_status add_loads(mps_fluid *f, const char *function) {
  MPSI_TRY(mpsi_fluid_find_loads(f, function, f->time));
  f->load_time = f->time;
  f->driven = f->push[0] != NULL;
  for (int c = 0; f->driven && c < 2; c++)
    for (int64_t i = 0; i < f->count; i++) f->u[c][i] += f->dt * f->push[c][i];
  return MPS_OK;
}

/* State that a failed step restores. */
static void note_state(mps_fluid *f) {
  f->before = f->report;
  f->load_time_before = f->load_time;
  for (int b = 0; b < f->walls; b++) f->wall[b].before = f->wall[b].load;
  for (int b = 0; b < f->bodies; b++) {
    mpsi_fluid_body *body = &f->body[b];
    memcpy(body->rate_before, body->rate, sizeof body->rate);
    memcpy(body->mass_before, body->mass, sizeof body->mass);
  }
}

/* Discards an open step, if any. */
static void abandon(mps_fluid *f) {
  if (f->stage == MPSI_FLUID_BETWEEN) return;
  f->report = f->before;
  f->load_time = f->load_time_before;
  for (int b = 0; b < f->walls; b++) f->wall[b].load = f->wall[b].before;
  for (int b = 0; b < f->bodies; b++) {
    mpsi_fluid_body *body = &f->body[b];
    memcpy(body->rate, body->rate_before, sizeof body->rate);
    memcpy(body->mass, body->mass_before, sizeof body->mass);
  }
  f->stage = MPSI_FLUID_BETWEEN;
  f->stale = true;
  mpsi_fluid_drop_leaving(f);
}

/* A step is made in three parts. They read and write the cloud; the fields change when all is done.
 * Where one fails, neighbours are computed again when needed. */
static mps_status begin(mps_fluid *f, const char *function, double dt) {
  mps_status status = mpsi_particles_ready(f->particles, function);
  if (status == MPS_OK) status = mpsi_fluid_look_ahead(f, function, dt);
  MPSI_TRY(mpsi_fluid_agree(f, function, status));
  f->stage = MPSI_FLUID_BEGUN;
  f->dt = dt;
  note_state(f);
  mpsi_fluid_begin_walls(f, dt);
  mpsi_fluid_begin_bound(f);
  mpsi_fluid_load_cloud(f);
  if (!(f->g > 0.0)) mpsi_fluid_find_stir(f);
  status = add_loads(f, function);
  if (status == MPS_OK) status = mpsi_fluid_find_pores(f, function, dt);
  if (status == MPS_OK) status = mpsi_fluid_begin_exchange(f, function);
  const bool classical = f->classical.gamma > 0.0;
  if (!classical)
    status = mpsi_fluid_look_around(f, function, status);
  else
    status = mpsi_fluid_classical_look(f, function, status);
  return status == MPS_OK ? mpsi_fluid_prepare_pressure(f, function) : status;
}

static mps_status solve(mps_fluid *f, const char *function) {
  return mpsi_fluid_any_afloat(f) ? mpsi_fluid_solve_afloat(f, function)
                                  : mpsi_fluid_solve_pressure(f, function);
}

static mps_status finish(mps_fluid *f, const char *function) {
  const mps_status walls = mpsi_fluid_check_walls(f, function);
  if (walls != MPS_OK) return walls;
  mpsi_fluid_send_local(f); /* for the work of loads, and for the surface at walls */
  mpsi_fluid_find_velocities(f);
  double way;
  const int64_t bad = mpsi_fluid_advance(f, &way);
  mpsi_fluid_end_exchange(f);
  MPSI_TRY(mpsi_fluid_lost(f, function));
  f->too_long = bad >= 0 && f->shortens && isfinite(way);
  if (f->too_long) return MPS_ERROR_DIVERGED; /* without a message: take_own_step tries again */
  if (bad >= 0) return went_wrong(f, function, bad, way);
  f->stage = MPSI_FLUID_MOVED;
  MPSI_TRY(mpsi_fluid_load_walls(f, function));
  return mpsi_fluid_check_bound(f, function);
}

/* After all parts: keeps the new state and sorts it now and then. */
static mps_status keep(mps_fluid *f, const char *function) {
  mpsi_fluid_end_walls(f);
  f->stage = MPSI_FLUID_BETWEEN;
  mpsi_fluid_add_impulses(f);
  mpsi_fluid_book_momentum(f);
  f->work_loads += mpsi_fluid_work_of_loads(f);
  store_cloud(f);
  f->time += f->dt;
  f->steps++;
  mpsi_fluid_warn_of_guards(f);
  mpsi_fluid_warn_of_angles(f);
  mpsi_fluid_warn_of_ground(f);
  mpsi_fluid_warn_of_bodies(f);
  mpsi_fluid_warn_of_air(f);
  mpsi_fluid_drop_leaving(f);
  mpsi_fluid_remove_outflow(f);
  if (f->steps % SORT_EVERY != 0) return MPS_OK;
  f->stale = true;
  return mpsi_fluid_sort(f, function);
}

static mps_status take_step(mps_fluid *f, const char *function, double dt) {
  mps_status status = begin(f, function, dt);
  if (status == MPS_OK) status = solve(f, function);
  if (status == MPS_OK) status = finish(f, function);
  if (status == MPS_OK) return keep(f, function);
  abandon(f);
  return status;
}

/* ---- running --------------------------------------------------------------------------------- */

/* The step that gravity and viscosity allow a fluid at rest, s. */
static double limit_at_rest(const mps_fluid *f) {
  double limit = f->g > 0.0 ? AT_REST * sqrt(f->l0 / f->g) : INFINITY;
  if (f->def.viscosity > 0.0)
    limit = fmin(limit, 0.2 * f->l0 * f->l0 * f->def.density / f->def.viscosity);
  return limit;
}

/* The step that is recommended, s; where `call`, callers' functions that loads follow are called: a
 * reading does not. */
static double find_limit(const mps_fluid *f, bool call) {
  double limit = limit_at_rest(f);
  /* what stands for gravity: at rest, and where a drop turns, no velocity limits the step */
  const double push = f->g > 0.0 ? 0.0 : mpsi_fluid_pushed(f, call);
  if (push > 0.0) limit = fmin(limit, AT_REST * sqrt(f->l0 / push));
  if (f->speed > 0.0) limit = fmin(limit, 0.25 * f->l0 * mpsi_fluid_least_porosity(f) / f->speed);
  for (int b = 0; b < f->walls; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used) continue;
    double u = fabs(w->rate);
    for (int64_t k = 0; k < w->nodes; k++) u = fmax(u, fabs(w->now.u[k]));
    if (u > 0.0) limit = fmin(limit, 0.2 * f->l0 / u);
  }
  return limit;
}

double mpsi_fluid_limit(const void *solver) { return find_limit(solver, false); }

double mpsi_fluid_dt(void *solver, const char *function) {
  const mps_fluid *f = solver;
  return isnan(f->def.dt) ? mpsi_fluid_limit(f) : f->def.dt;
}

/* Of the step that is about to be made. */
static double dt_of(const mps_fluid *f) {
  return isnan(f->def.dt) ? find_limit(f, true) : f->def.dt;
}

/* The library chooses no step below LEAST_STEP of that at rest, or of a thousandth of the run
 * (`span`, s) where nothing limits that: the fluid has diverged, and the run would hardly end. */
static mps_status check_dt(mps_fluid *f, const char *function, double dt, double span) {
  const double rest = limit_at_rest(f);
  const double least = LEAST_STEP * (isfinite(rest) ? rest : 1e-3 * span);
  if (isnan(f->def.dt) && isfinite(least) && dt < least)
    return mpsi_fail(
        f->context, function, MPS_ERROR_DIVERGED,
        "step %lld, t = %g s: velocities of %g m/s limit the step to %g s; below %g s it "
        "is not chosen: give dt",
        (long long)f->steps, f->time, f->speed, dt, least);
  if (isfinite(dt)) return MPS_OK;
  return mpsi_fail(f->context, function, MPS_ERROR_STATE,
                   "nothing limits the step: without gravity, motion and loads, give dt");
}

/* A step that the library chooses, halved where a particle goes too far in it: where water strikes
 * water or a wall, velocities grow by more within a step than the limit, that of the velocities
 * before it, allows for. *dt (s): tried first, then made. */
static mps_status take_own_step(mps_fluid *f, const char *function, double *dt) {
  for (int halved = 0;; halved++) {
    f->shortens = isnan(f->def.dt) && halved < HALVINGS;
    f->too_long = false;
    const mps_status status = take_step(f, function, *dt);
    f->shortens = false;
    if (!f->too_long) return status;
    *dt *= 0.5;
  }
}

/* A step of at most `full` of which whole ones fill the rest; far from its end just `full`, as a
 * change of the step shows in the pressure. */
static double even_step(double rest, double full) {
  const double steps = ceil(rest / full * (1.0 - 1e-9));
  return steps > EVEN_STEPS ? full : rest / steps;
}

mps_status mpsi_fluid_begin_march(void *solver, const char *function, mpsi_march *m) {
  const mps_fluid *f = solver;
  return isnan(f->def.dt) ? MPS_OK : mpsi_march_check(m, f->context, function, f->def.dt);
}

mps_status mpsi_fluid_advance_march(void *solver, const char *function, mpsi_march *m,
                                    int64_t count) {
  mps_fluid *f = solver;
  (void)count; /* 1 */
  const bool run = mpsi_march_is_run(m);
  const double rest = m->t_end - f->time, full = dt_of(f);
  MPSI_TRY(check_dt(f, function, full, run ? m->t_end - m->start : INFINITY));
  const bool last = run && rest <= full * (1.0 + 1e-9);
  double dt = !run ? full : last ? rest : even_step(rest, full);
  const mps_status status = take_own_step(f, function, &dt);
  m->last = last && dt == rest;
  if (status == MPS_OK && m->last) f->time = m->t_end;
  return status;
}

/* ---- a step in parts ------------------------------------------------------------------------- */

mps_status mps_fluid_begin_step(mps_fluid *f, double dt) {
  if (!f) return mpsi_null(__func__, "fluid");
  MPSI_TRY(mpsi_fluid_ready(f, __func__));
  MPSI_TRY(mpsi_fluid_check_dt(f, __func__, dt));
  if (f->classical.gamma > 0.0)
    return mpsi_fail(f->context, __func__, MPS_ERROR_STATE,
                     "the classical scheme's steps cannot be made in parts");
  mpsi_guard_enter(&f->guard, f->context, __func__);
  mps_status status = mpsi_solver_check_cancel(&f->base, __func__);
  if (status == MPS_OK && isnan(dt)) dt = dt_of(f), status = check_dt(f, __func__, dt, INFINITY);
  if (status == MPS_OK) {
    status = begin(f, __func__, dt);
    if (status != MPS_OK) abandon(f);
  }
  mpsi_guard_end(&f->guard);
  return status;
}

static mps_status check_stage(mps_fluid *f, const char *function, mpsi_fluid_stage least) {
  const mps_status status = mpsi_fluid_free(f, function);
  if (status != MPS_OK || f->stage >= least) return status;
  return mpsi_fail(f->context, function, MPS_ERROR_STATE,
                   f->stage == MPSI_FLUID_BETWEEN ? "no step is open: begin it first"
                                                  : "the open step's pressure has not been solved");
}

mps_status mps_fluid_solve_pressure(mps_fluid *f) {
  if (!f) return mpsi_null(__func__, "fluid");
  MPSI_TRY(check_stage(f, __func__, MPSI_FLUID_BEGUN));
  for (int b = 0; b < f->walls; b++) f->wall[b].former = f->wall[b].load;
  mpsi_guard_enter(&f->guard, f->context, __func__);
  mps_status status = mpsi_fluid_agree(f, __func__, mpsi_fluid_look_ahead(f, __func__, f->dt));
  if (status == MPS_OK) {
    f->stage = MPSI_FLUID_BEGUN;
    mpsi_fluid_begin_walls(f, f->dt);
    status = mpsi_fluid_agree_same(f, __func__, MPS_OK);
    if (status == MPS_OK) status = solve(f, __func__);
    f->stage = status == MPS_OK ? MPSI_FLUID_SOLVED : MPSI_FLUID_BEGUN;
  }
  mpsi_guard_end(&f->guard);
  if (status == MPS_OK) {
    status = mpsi_fluid_load_walls(f, __func__);
    if (status != MPS_OK) f->stage = MPSI_FLUID_BEGUN;
  }
  for (int b = 0; b < f->walls && status != MPS_OK; b++) f->wall[b].load = f->wall[b].former;
  return status;
}

mps_status mps_fluid_end_step(mps_fluid *f) {
  if (!f) return mpsi_null(__func__, "fluid");
  MPSI_TRY(check_stage(f, __func__, MPSI_FLUID_SOLVED));
  MPSI_TRY(mpsi_fluid_agree(f, __func__, mpsi_particles_ready(f->particles, __func__)));
  mps_status status = finish(f, __func__);
  if (status == MPS_OK) return keep(f, __func__);
  abandon(f);
  return status;
}

mps_status mps_fluid_abandon_step(mps_fluid *f) {
  if (!f) return mpsi_null(__func__, "fluid");
  MPSI_TRY(check_stage(f, __func__, MPSI_FLUID_BEGUN));
  abandon(f);
  for (int b = 0; b < f->walls; b++) f->wall[b].given = f->wall[b].placed = false;
  return MPS_OK;
}
