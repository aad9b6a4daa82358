/* step.c - the time step of the explicit MPS solver: initial state, choice of dt, the parts of a
 * step in order, divergence.
 *
 * A step of length dt_k from x_k with the velocity v- half a step before:
 *   v+ = v- + (dt_{k-1} + dt_k)/2 a(x_k),  x_{k+1} = x_k + dt_k v+,
 * which is Verlet and leapfrog of constant dt, and stays of second order where dt changes (Euler:
 * x + dt v-, v- + dt a). Forces so act for the "kick" (dt_{k-1} + dt_k)/2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles_internal.h"
#include "dynamics_private.h"

#include <float.h>
#include <string.h>

double mpsi_dynamics_velocity(const mps_dynamics *dynamics, int32_t component, int64_t k) {
  const mpsi_dynamics_state *s = &dynamics->state;
  if (dynamics->def.integrator != MPS_DYNAMICS_INTEGRATOR_VERLET || dynamics->fresh)
    return (component == 0 ? s->vx : component == 1 ? s->vy : s->vth)[k];
  if (component == 2) return (s->th[k] - s->oth[k]) / dynamics->lag;
  return component == 0 ? (s->dx[k] - s->ox[k]) / dynamics->lag
                        : (s->dy[k] - s->oy[k]) / dynamics->lag;
}

double mpsi_dynamics_mass(const mps_dynamics *dynamics, int32_t component, int64_t k) {
  const double D = dynamics->spacing, area = D * D;
  const double mass = area * dynamics->def.measure / dynamics->state.ix[k];
  return component == 2 ? mass * area / 6.0 : mass;
}

/* ---- initial state -----------------------------------------------------------------------------
 */

/* Displacements of a step of `length` before the first, as the initial velocities imply. */
static void start_history(mps_dynamics *dynamics, double length) {
  mpsi_dynamics_state *s = &dynamics->state;
  double *d[3] = {s->dx, s->dy, s->th}, *o[3] = {s->ox, s->oy, s->oth};
  double *v[3] = {s->vx, s->vy, s->vth};
  for (int c = 0; c < 3; c++)
    for (int64_t k = 0; k < dynamics->count; k++) o[c][k] = d[c][k] - length * v[c][k];
  dynamics->lag = dynamics->kept = length;
}

mps_status mpsi_dynamics_begin(mps_dynamics *dynamics, const char *function, double time) {
  const double former[2] = {dynamics->base_time, dynamics->length};
  const int64_t counted[2] = {dynamics->base_step, dynamics->steps};
  const bool fresh = dynamics->fresh;
  dynamics->base_time = time;
  dynamics->steps = dynamics->base_step = 0;
  dynamics->fresh = true;
  dynamics->kernels->trig[dynamics->def.rotation](&dynamics->state, 0, dynamics->count);
  const mps_status status =
      mpsi_domain_settle(dynamics->domain, function, mpsi_dynamics_take_bounds(dynamics, function));
  if (status != MPS_OK) { /* a signal refused */
    dynamics->base_time = former[0];
    dynamics->base_step = counted[0], dynamics->steps = counted[1];
    dynamics->fresh = fresh;
    return status;
  }
  dynamics->diverged = dynamics->begun = dynamics->no_rate = false;
  dynamics->rewritten = NULL;
  memset(&dynamics->works, 0, sizeof dynamics->works);
  for (int32_t k = 0; k < dynamics->boundary_room; k++) {
    mpsi_dynamics_boundary *b = dynamics->boundary[k];
    if (!b) continue;
    memset(b->pushed, 0, sizeof b->pushed);
    memset(b->impulse, 0, sizeof b->impulse);
    memset(&b->work, 0, sizeof b->work);
    b->kick = 0.0;
  }
  for (int64_t k = 0; k < dynamics->dashpots; k++) dynamics->dashpot[k].force = 0.0;
  mpsi_dynamics_publish(dynamics);
  return MPS_OK;
}

mps_status mps_dynamics_restart(mps_dynamics *dynamics, double time) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  if (!isfinite(time))
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                     "time is %g s, must be finite", time);
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *const column[6] = {s->dx, s->dy, s->th, s->vx, s->vy, s->vth};
  for (int c = 0; c < 6 && status == MPS_OK; c++)
    for (int64_t k = 0; k < dynamics->count && status == MPS_OK; k++)
      if (!isfinite(column[c][k]))
        status = mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                           "the initial state of particle %lld is not finite (%g)",
                           (long long)mpsi_particles_integers(dynamics->particles, "id")[k],
                           column[c][k]);
  status = mpsi_domain_settle_same(dynamics->domain, __func__, status, "time", time);
  if (status != MPS_OK) return status;
  return mpsi_dynamics_begin(dynamics, __func__, time);
}

static void publish_reactions(mps_dynamics *dynamics) {
  double *const r[2] = {mpsi_particles_column(dynamics->particles, "reaction", 0),
                        mpsi_particles_column(dynamics->particles, "reaction", 1)};
  if (!r[0]) return;
  for (int64_t k = 0; k < dynamics->count; k++) r[0][k] = r[1][k] = 0.0;
  for (int64_t k = 0; k < dynamics->bounds; k++)
    if (dynamics->bound[k].component < 2)
      r[dynamics->bound[k].component][dynamics->bound[k].particle] += dynamics->bound[k].force;
  for (int64_t k = 0; k < dynamics->dashpots; k++)
    if (dynamics->dashpot[k].boundary >= 0)
      r[dynamics->dashpot[k].component][dynamics->dashpot[k].particle] +=
          dynamics->dashpot[k].force;
}

void mpsi_dynamics_publish(mps_dynamics *dynamics) {
  mpsi_dynamics_state *s = &dynamics->state;
  const double *const d[3] = {s->dx, s->dy, s->th}, *const o[3] = {s->ox, s->oy, s->oth};
  const double *const reference[2] = {s->rx, s->ry};
  double *const v[3] = {s->vx, s->vy, s->vth};
  for (int c = 0; c < 2; c++) {
    double *position = mpsi_dynamics_column(dynamics, "position", c);
    for (int64_t k = 0; k < dynamics->count; k++) position[k] = reference[c][k] + d[c][k];
  }
  publish_reactions(dynamics);
  if (dynamics->def.integrator != MPS_DYNAMICS_INTEGRATOR_VERLET || dynamics->fresh) return;
  for (int c = 0; c < 3; c++)
    for (int64_t k = 0; k < dynamics->count; k++) v[c][k] = (d[c][k] - o[c][k]) / dynamics->lag;
}

/* ---- the time step's length --------------------------------------------------------------------
 */

/* Warns of a `dt` above the limit. */
static mps_status compare_dt(mps_dynamics *dynamics, double dt) {
  const bool euler = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER;
  if (!euler && dt <= mps_dynamics_limit(dynamics)) return MPS_OK;
  mps_dynamics_linear_limit limit;
  const mps_status status = mps_dynamics_find_limit(dynamics, 0.0, &limit);
  if (status != MPS_OK) return status;
  if (euler && limit.dt == 0.0)
    mpsi_log(dynamics->context, MPS_LOG_WARNING,
             "Euler without damping has no stable time step: the motion grows at any dt");
  else if (dt > limit.dt)
    mpsi_log(dynamics->context, MPS_LOG_WARNING,
             "dt = %g s is above the linear stability limit %.4g s: the run may diverge", dt,
             limit.dt);
  return MPS_OK;
}

/* Chooses dt from the limit. */
static mps_status choose_dt(mps_dynamics *dynamics, const char *function) {
  mps_dynamics_linear_limit limit;
  const mps_status status = mps_dynamics_find_limit(dynamics, 0.0, &limit);
  if (status != MPS_OK) return status;
  if (!(limit.dt > 0.0))
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "Euler without damping has no stable time step to choose: give dt");
  if (isinf(limit.dt))
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "no force between particles that can move limits the time step: give dt");
  dynamics->dt = dynamics->def.courant * limit.dt;
  return MPS_OK;
}

mps_status mpsi_dynamics_settle_dt(mps_dynamics *dynamics, const char *function) {
  if (dynamics->checked) return MPS_OK;
  const mps_status status =
      isnan(dynamics->dt) ? choose_dt(dynamics, function) : compare_dt(dynamics, dynamics->dt);
  dynamics->checked = status == MPS_OK;
  return status;
}

void mpsi_dynamics_forget_limit(mps_dynamics *dynamics) {
  dynamics->have_limit = dynamics->checked = false;
  if (isnan(dynamics->def.dt)) dynamics->dt = NAN;
}

double mps_dynamics_dt(mps_dynamics *dynamics) {
  if (!dynamics || mpsi_dynamics_settle_dt(dynamics, __func__) != MPS_OK) return 0.0;
  return dynamics->dt;
}

mps_status mps_dynamics_set_dt(mps_dynamics *dynamics, double dt) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  if (!(dt >= MPSI_DYN_LEAST_DT && dt <= MPSI_DYN_MOST_DT))
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                     "dt is %g s, must be in %g..%g", dt, MPSI_DYN_LEAST_DT, MPSI_DYN_MOST_DT);
  status = mpsi_domain_settle_same(dynamics->domain, __func__, status, "dt", dt);
  if (status == MPS_OK) status = compare_dt(dynamics, dt);
  if (status != MPS_OK) return status;
  dynamics->dt = dynamics->def.dt = dt; /* as if the definition had given it */
  dynamics->checked = true;
  return MPS_OK;
}

double mps_dynamics_time(const mps_dynamics *dynamics) {
  if (!dynamics) return 0.0;
  return dynamics->base_time + (double)(dynamics->steps - dynamics->base_step) * dynamics->length;
}

int64_t mps_dynamics_steps(const mps_dynamics *dynamics) { return dynamics ? dynamics->steps : 0; }

/* Makes `length` that of the steps to come. */
static void set_length(mps_dynamics *dynamics, double length) {
  if (dynamics->length == length) return;
  dynamics->base_time = mps_dynamics_time(dynamics);
  dynamics->base_step = dynamics->steps;
  dynamics->length = length;
}

/* ---- a step ------------------------------------------------------------------------------------
 */

#define SMALL_BODY 40 /* blocks, about 20 000 particles */

typedef struct work {
  mps_dynamics *dynamics;
  mpsi_dynamics_step step;
  mpsi_dynamics_pass1_fn pass1;
  mpsi_dynamics_pass2_fn pass2;
  mpsi_dynamics_forces forces;
  bool account;       /* works of loads or damping are counted */
  int64_t grain;      /* blocks a unit of work */
  int64_t begin, end; /* turns of the first pass under way */
} work;

static void first_pass(void *data, int64_t unit, int32_t worker) {
  const work *w = data;
  mps_dynamics *dynamics = w->dynamics;
  const int32_t *turn = dynamics->mesh.turn;
  const int64_t first = w->begin + unit * w->grain, last = first + w->grain;
  for (int64_t b = first; b < last && b < w->end; b++)
    w->pass1(&dynamics->state, &dynamics->mesh, turn ? turn[b] : b,
             dynamics->scratch + worker * MPSI_DYN_SCRATCH);
}

static void pass_turns(work *w, int64_t begin, int64_t end) {
  w->begin = begin, w->end = end;
  mpsi_parallel_for(w->dynamics->context, (end - begin + w->grain - 1) / w->grain, first_pass, w);
}

/* The first pass of all blocks. What lies on other ranks arrives while those blocks are at work
 * that do not need it. */
static mps_status pass_all(work *w) {
  mps_dynamics *dynamics = w->dynamics;
  const mpsi_dynamics_mesh *mesh = &dynamics->mesh;
  mpsi_dynamics_state *s = &dynamics->state;
  double *const column[3] = {s->dx, s->dy, s->th};
  mps_status status = MPS_OK;
  if (dynamics->halo) status = mpsi_halo_begin(dynamics->halo, "mps_dynamics_step", 3, column);
  if (status != MPS_OK) return status;
  pass_turns(w, 0, mesh->interior);
  if (!dynamics->halo) return MPS_OK;
  status = mpsi_halo_end(dynamics->halo, "mps_dynamics_step", column);
  if (status != MPS_OK) return status;
  dynamics->kernels->trig[dynamics->def.rotation](s, dynamics->count,
                                                  dynamics->count + dynamics->ghosts);
  pass_turns(w, mesh->interior, mesh->blocks + mesh->ghosts);
  return MPS_OK;
}

static void second_pass(void *data, int64_t unit, int32_t worker) {
  const work *w = data;
  mps_dynamics *dynamics = w->dynamics;
  const int64_t last = (unit + 1) * w->grain, n = dynamics->mesh.blocks;
  for (int64_t b = unit * w->grain; b < last && b < n; b++) {
    if (w->account) mpsi_dynamics_note_velocities(dynamics, b);
    dynamics->bad[b] = w->pass2(&dynamics->state, &dynamics->mesh, b, &w->step,
                                dynamics->scratch + worker * MPSI_DYN_SCRATCH);
    if (w->forces.any) mpsi_dynamics_apply_forces(dynamics, &w->forces, b, &w->step);
  }
}

/* The particle of this rank that has the greatest acceleration where the limit is broken, -1: none
 * has; NaN is beyond all others. */
static int64_t find_worst(const mps_dynamics *dynamics, double *most) {
  const mpsi_dynamics_state *s = &dynamics->state;
  int64_t worst = -1;
  *most = 0.0;
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++)
    for (int64_t k = dynamics->mesh.block[b].begin;
         dynamics->bad[b] && k < dynamics->mesh.block[b].end; k++) {
      const double a = hypot(s->ax[k], s->ay[k]);
      if (worst >= 0 && !(a > *most) && !isnan(a)) continue;
      worst = k;
      *most = a;
      if (isnan(a)) return k;
    }
  return worst;
}

/* The particle that broke the limit, its acceleration and where it is: of several ranks the one
 * with the greatest acceleration tells. */
static mps_status report_divergence(mps_dynamics *dynamics, const char *function) {
  const mpsi_dynamics_state *s = &dynamics->state;
  const double now = mps_dynamics_time(dynamics) - dynamics->length;
  double most;
  const int64_t worst = find_worst(dynamics, &most);
  double key = worst < 0 ? -1.0 : isnan(most) ? INFINITY : most, greatest = key;
  mps_status status = mpsi_domain_max(dynamics->domain, function, 1, &greatest);
  dynamics->diverged = true;
  if (status != MPS_OK) return status;
  if (worst >= 0 && key == greatest) {
    const long long id = (long long)mpsi_particles_integers(dynamics->particles, "id")[worst];
    status = mpsi_fail(
        dynamics->context, function, MPS_ERROR_DIVERGED,
        "diverged at step %lld, t = %.6g s: |acceleration| of particle %lld at (%.6g, %.6g) m is "
        "%.4g m/s2, beyond %g; dt is %.6g s%s: take a smaller time step",
        (long long)dynamics->steps, now, id, s->rx[worst], s->ry[worst], most,
        dynamics->def.divergence, dynamics->length,
        dynamics->have_limit && dynamics->length > dynamics->limit.dt
            ? ", above the linear stability limit"
            : "");
    mpsi_fail_where(dynamics->context, dynamics->steps, id);
  }
  return mpsi_domain_settle(dynamics->domain, function, status);
}

/* Before a step of `length`: the displacements of a step before it, if the last was another. */
static void fit_history(mps_dynamics *dynamics) {
  const double length = dynamics->length, ratio = length / dynamics->lag;
  mpsi_dynamics_state *s = &dynamics->state;
  const double *const d[3] = {s->dx, s->dy, s->th};
  double *const o[3] = {s->ox, s->oy, s->oth};
  if (dynamics->fresh) {
    start_history(dynamics, length);
  } else if (dynamics->lag != length) {
    if (dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_VERLET)
      for (int c = 0; c < 3; c++)
        for (int64_t k = 0; k < dynamics->count; k++)
          o[c][k] = d[c][k] - ratio * (d[c][k] - o[c][k]);
    dynamics->lag = length;
  }
}

/* The kinetic and strain energy that the budget starts from. */
static mps_status begin_budget(mps_dynamics *dynamics, const char *function) {
  double kinetic, strain;
  if (dynamics->begun) return MPS_OK;
  const mps_status status = mpsi_dynamics_energies(dynamics, function, &kinetic, &strain);
  if (status != MPS_OK) return status;
  dynamics->works.start = kinetic + strain;
  dynamics->begun = true;
  return MPS_OK;
}

/* Whether an acceleration is beyond the limit, given by its square. What holds or drives a particle
 * gives it its acceleration; the loops have found that of the forces. */
static bool diverges(mps_dynamics *dynamics, double limit2) {
  mpsi_dynamics_state *s = &dynamics->state;
  double *const a[2] = {s->ax, s->ay};
  bool any = false;
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++) any = any || dynamics->bad[b];
  if (!any) return false;
  for (int64_t k = 0; k < dynamics->bounds; k++) {
    const mpsi_dynamics_bound *q = &dynamics->bound[k];
    if (q->component < 2)
      a[q->component][q->particle] = dynamics->boundary[q->boundary]->gain[q->component];
  }
  any = false;
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++) {
    if (!dynamics->bad[b]) continue;
    dynamics->bad[b] = 0;
    for (int64_t k = dynamics->mesh.block[b].begin; k < dynamics->mesh.block[b].end; k++)
      if (!(s->ax[k] * s->ax[k] + s->ay[k] * s->ay[k] <= limit2)) dynamics->bad[b] = 1;
    any = any || dynamics->bad[b];
  }
  return any;
}

/* All of a step but asking the signals, which can fail, as can other ranks. */
static mps_status take_step(work *w, bool output, bool *diverged) {
  mps_dynamics *dynamics = w->dynamics;
  const double kick = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER || dynamics->fresh
                          ? dynamics->length
                          : 0.5 * (dynamics->kept + dynamics->length);
  fit_history(dynamics);
  w->step.kick = kick;
  w->step.rate = 1.0 / dynamics->kept;
  w->step.first = dynamics->fresh || dynamics->no_rate;
  w->step.output = output;
  mpsi_dynamics_begin_counting(dynamics);
  mpsi_dynamics_dashpots_before(dynamics);
  const int64_t units = (dynamics->mesh.blocks + w->grain - 1) / w->grain;
  const mps_status status = pass_all(w);
  if (status != MPS_OK) return status;
  mpsi_parallel_for(dynamics->context, units, second_pass, w);
  dynamics->steps++;
  dynamics->fresh = dynamics->no_rate = false;
  dynamics->kept = dynamics->length;
  mpsi_dynamics_dashpots_after(dynamics, kick, output);
  mpsi_dynamics_hold_bounds(dynamics, kick, output);
  mpsi_dynamics_end_counting(dynamics, kick);
  if (w->account) {
    mpsi_dynamics_account account = {dynamics, &w->forces, w->step.drag, kick};
    mpsi_dynamics_count_works(&account);
  }
  *diverged = diverges(dynamics, w->step.limit2);
  return MPS_OK;
}

/* What has become of the ranks: `status` of this one, and whether its last step has diverged. */
static mps_status settle_step(mps_dynamics *dynamics, const char *function, mps_status status,
                              bool *diverged) {
  double any = *diverged;
  status = mpsi_domain_settle_max(dynamics->domain, function, status, 1, &any);
  if (status != MPS_OK || any == 0.0) return status;
  return report_divergence(dynamics, function);
}

mps_status mpsi_dynamics_advance(mps_dynamics *dynamics, const char *function, int64_t count,
                                 double length, bool output) {
  const double limit = dynamics->def.divergence;
  const bool watch = dynamics->def.watch_damping && dynamics->damping != MPSI_DYN_UNDAMPED;
  /* Small bodies are one unit of work, run where the caller is: two barriers a step cost more
   * than sharing gains. */
  const int64_t blocks = dynamics->mesh.blocks;
  const int64_t units = blocks < SMALL_BODY ? 1 : 8 * mps_context_threads(dynamics->context);
  const int32_t removal = dynamics->def.rotation, integrator = dynamics->def.integrator;
  work w = {.dynamics = dynamics,
            .step = {.dt = length,
                     .limit2 = fmin(limit * limit, DBL_MAX), /* never lets an infinite one pass */
                     .stride = dynamics->count},
            .pass1 = dynamics->kernels->pass1[removal][dynamics->damping == MPSI_DYN_BY_PAIRS],
            .pass2 = dynamics->kernels->pass2[removal][dynamics->damping][integrator],
            .grain = blocks > 0 ? (blocks + units - 1) / units : 1};
  if (count == 0) return MPS_OK;
  mps_status status = mpsi_particles_ready(dynamics->particles, function);
  if (status == MPS_OK && mpsi_particles_column(dynamics->particles, "external_force", 0) &&
      !mpsi_dynamics_reserve_accounts(dynamics))
    status = mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 24);
  status = mpsi_domain_settle(dynamics->domain, function, status);
  if (status == MPS_OK) status = mpsi_dynamics_take_edits(dynamics, function);
  if (status != MPS_OK) return status;
  set_length(dynamics, length);
  if (dynamics->fresh) start_history(dynamics, length);
  status = begin_budget(dynamics, function);
  if (status != MPS_OK) return status;
  dynamics->stepping = true;
  bool diverged = false; /* the step before */
  w.step.drag = watch ? dynamics->drag : NULL;
  for (int64_t k = 0; status == MPS_OK && k < count; k++) {
    const double now = mps_dynamics_time(dynamics);
    const double then =
        dynamics->base_time + (double)(dynamics->steps + 1 - dynamics->base_step) * length;
    status = mpsi_dynamics_ask_signals(dynamics, function, now, then);
    if (status == MPS_OK) status = mpsi_dynamics_ask_loads(dynamics, function, now);
    status = settle_step(dynamics, function, status, &diverged);
    if (status != MPS_OK) break;
    w.forces = mpsi_dynamics_find_forces(dynamics);
    w.account = w.forces.any || watch;
    status = take_step(&w, output && k == count - 1, &diverged);
    if (status == MPS_OK && (k == count - 1 || !mpsi_domain_many(dynamics->domain)))
      status = settle_step(dynamics, function, MPS_OK, &diverged);
  }
  dynamics->stepping = false;
  return status;
}
