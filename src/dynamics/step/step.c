/* step.c - the time step of the explicit MPS solver: the parts of a step in order, divergence.
 *
 * A step of length dt_k from x_k with the velocity v- half a step before:
 *   v+ = v- + (dt_{k-1} + dt_k)/2 a(x_k),  x_{k+1} = x_k + dt_k v+,
 * which is Verlet and leapfrog of constant dt, and stays of second order where dt changes (Euler:
 * x + dt v-, v- + dt a). Forces so act for the "kick" (dt_{k-1} + dt_k)/2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "step.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/boundary/constrain.h"
#include "dynamics/ranks/partition.h"
#include "dynamics/step/begin.h"
#include "dynamics/step/bound.h"

#include <float.h>
#include <string.h>

/* Displacements of a step of `length` before the first, as the initial velocities imply. */
static void start_history(mps_dynamics *dynamics, double length) {
  mpsi_dynamics_state *s = &dynamics->state;
  double *d[3] = {s->dx, s->dy, s->th}, *o[3] = {s->ox, s->oy, s->oth};
  double *v[3] = {s->vx, s->vy, s->vth};
  for (int c = 0; c < 3; c++)
    for (int64_t k = 0; k < dynamics->count; k++) o[c][k] = d[c][k] - length * v[c][k];
  dynamics->lag = dynamics->kept = length;
}

/* Makes `length` that of the steps to come. */
static void set_length(mps_dynamics *dynamics, double length) {
  if (dynamics->length == length) return;
  dynamics->base_time = mpsi_dynamics_time(dynamics);
  dynamics->base_step = dynamics->steps;
  dynamics->length = length;
}

/* ---- a step ---------------------------------------------------------------------------------- */

#define ALARM2 (MPSI_DYNAMICS_ALARM * MPSI_DYNAMICS_ALARM)
#define SMALL_BODY 40 /* blocks, about 20 000 particles */

typedef struct work {
  mps_dynamics *dynamics;
  mpsi_dynamics_step step;
  mpsi_dynamics_pass1_fn pass1, ghost_pass1;
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
  for (int64_t t = first; t < last && t < w->end; t++) {
    const int64_t b = turn ? turn[t] : t;
    (b < dynamics->mesh.blocks ? w->pass1 : w->ghost_pass1)(
        &dynamics->state, &dynamics->mesh, b, dynamics->scratch + worker * MPSI_DYN_SCRATCH);
  }
}

static void pass_turns(work *w, int64_t begin, int64_t end) {
  w->begin = begin, w->end = end;
  mpsi_parallel_for(w->dynamics->context, (end - begin + w->grain - 1) / w->grain, first_pass, w);
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

static const char *is_above_limit(const mps_dynamics *dynamics) {
  return dynamics->have_limit && dynamics->length > dynamics->limit.dt
             ? ", above the linear stability limit"
             : "";
}

/* The particle of this rank with the greatest acceleration beyond the limit, -1: none; NaN is the
 * greatest. */
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

/* The fastest particle of a body that has more energy than it can have. Collective. */
static mps_status report_energy(mps_dynamics *dynamics, const char *function) {
  double most = -1.0;
  int64_t at = 0;
  for (int64_t k = 0; k < dynamics->body; k++) {
    const double v =
        hypot(mpsi_dynamics_velocity(dynamics, 0, k), mpsi_dynamics_velocity(dynamics, 1, k));
    if (v > most) most = v, at = k;
  }
  double fastest = most;
  mps_status status = mpsi_domain_max(dynamics->domain, function, 1, &fastest);
  if (status != MPS_OK) return status;
  if (most < fastest || dynamics->body == 0)
    return mpsi_domain_agree(dynamics->domain, function, MPS_OK);
  const long long id = (long long)mpsi_particles_integers(dynamics->particles, "id")[at];
  status = mpsi_fail(
      dynamics->context, function, MPS_ERROR_DIVERGED,
      "diverged at step %lld, t = %.6g s: the kinetic energy is %.4g J, beyond %.4g J, %g times "
      "the energy at the start and the work done since; particle %lld at (%.6g, %.6g) m is the "
      "fastest with %.4g m/s; dt is %.6g s%s: take a smaller time step",
      (long long)dynamics->steps, mps_dynamics_time(dynamics), dynamics->limits.excess,
      dynamics->limits.most, dynamics->limits.factor, id, dynamics->state.rx[at],
      dynamics->state.ry[at], most, dynamics->length, is_above_limit(dynamics));
  mpsi_fail_where(dynamics->context, dynamics->steps, id);
  return mpsi_domain_agree(dynamics->domain, function, status);
}

/* The particle beyond the limit, its acceleration and position: of several ranks that with the
 * greatest acceleration reports. */
static mps_status report_divergence(mps_dynamics *dynamics, const char *function) {
  const mpsi_dynamics_state *s = &dynamics->state;
  const double now = mpsi_dynamics_time(dynamics) - dynamics->length;
  double most;
  const int64_t worst = find_worst(dynamics, &most);
  double key = worst < 0 ? -1.0 : isnan(most) ? INFINITY : most, greatest = key;
  if (dynamics->limits.excess > 0.0) return report_energy(dynamics, function);
  mps_status status = mpsi_domain_max(dynamics->domain, function, 1, &greatest);
  if (status != MPS_OK) return status;
  if (worst >= 0 && key == greatest) {
    const long long id = (long long)mpsi_particles_integers(dynamics->particles, "id")[worst];
    status = mpsi_fail(
        dynamics->context, function, MPS_ERROR_DIVERGED,
        "diverged at step %lld, t = %.6g s: |acceleration| of particle %lld at (%.6g, %.6g) m is "
        "%.4g m/s2, beyond %g; dt is %.6g s%s: take a smaller time step",
        (long long)dynamics->steps, now, id, s->rx[worst], s->ry[worst], most,
        dynamics->def.divergence, dynamics->length, is_above_limit(dynamics));
    mpsi_fail_where(dynamics->context, dynamics->steps, id);
  }
  return mpsi_domain_agree(dynamics->domain, function, status);
}

/* ---- speeds ------------------------------------------------------------------------------------
 * Accelerations are bounded in every step; a velocity that is edited, driven by a boundary or due
 * to a torque may be so large that the kinetic energy is not finite. */

/* Whether a velocity (column `a`, or the change of a displacement from `b` to `a`) is beyond
 * `most`.
 */
static bool any_beyond(const double *a, const double *b, int64_t begin, int64_t end, double most) {
  int64_t beyond = 0;
  if (b)
    for (int64_t k = begin; k < end; k++) beyond |= !(fabs(a[k] - b[k]) <= most);
  else
    for (int64_t k = begin; k < end; k++) beyond |= !(fabs(a[k]) <= most);
  return beyond != 0;
}

static void check_block_speeds(void *data, int64_t b, int32_t worker) {
  mps_dynamics *dynamics = data;
  const mpsi_dynamics_state *s = &dynamics->state;
  const mpsi_dynamics_block *block = &dynamics->mesh.block[b];
  const bool verlet = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_VERLET;
  const double *const now[3] = {s->dx, s->dy, s->th}, *const old[3] = {s->ox, s->oy, s->oth};
  const double *const v[3] = {s->vx, s->vy, s->vth};
  dynamics->bad[b] = 0;
  for (int c = 0; c < 3; c++) {
    const double most = c == 2 ? MPSI_DYNAMICS_FASTEST / dynamics->spacing : MPSI_DYNAMICS_FASTEST;
    if (verlet ? any_beyond(now[c], old[c], block->begin, block->end, most * dynamics->lag)
               : any_beyond(v[c], NULL, block->begin, block->end, most))
      dynamics->bad[b] = 1;
  }
}

static bool too_fast(mps_dynamics *dynamics) {
  bool any = false;
  mpsi_parallel_for(dynamics->context, dynamics->mesh.blocks, check_block_speeds, dynamics);
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++) any = any || dynamics->bad[b];
  return any;
}

/* Of several ranks the lowest with such a particle names its first one. */
static mps_status report_speed(mps_dynamics *dynamics, const char *function) {
  const mpsi_dynamics_state *s = &dynamics->state;
  int64_t found = -1;
  for (int64_t b = 0; b < dynamics->mesh.blocks && found < 0; b++)
    for (int64_t k = dynamics->mesh.block[b].begin;
         dynamics->bad[b] && k < dynamics->mesh.block[b].end && found < 0; k++)
      for (int c = 0; c < 3; c++)
        if (!(fabs(mpsi_dynamics_velocity(dynamics, c, k)) * (c == 2 ? dynamics->spacing : 1.0) <=
              MPSI_DYNAMICS_FASTEST))
          found = k;
  mps_status status = MPS_OK;
  if (found >= 0) {
    const long long id = (long long)mpsi_particles_integers(dynamics->particles, "id")[found];
    status = mpsi_fail(dynamics->context, function, MPS_ERROR_DIVERGED,
                       "diverged at step %lld, t = %.6g s: particle %lld at (%.6g, %.6g) m moves "
                       "with (%.4g, %.4g) m/s and turns with %.4g rad/s, beyond %g m/s",
                       (long long)dynamics->steps, mpsi_dynamics_time(dynamics), id, s->rx[found],
                       s->ry[found], mpsi_dynamics_velocity(dynamics, 0, found),
                       mpsi_dynamics_velocity(dynamics, 1, found),
                       mpsi_dynamics_velocity(dynamics, 2, found), MPSI_DYNAMICS_FASTEST);
    mpsi_fail_where(dynamics->context, dynamics->steps, id);
  }
  return mpsi_domain_agree(dynamics->domain, function, status);
}

/* Before a step of `length`: the displacements of a previous step of that length, if the last one
 * had another. */
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

/* Initial kinetic and strain energy of the budget. */
static mps_status begin_budget(mps_dynamics *dynamics, const char *function) {
  double kinetic, strain;
  if (dynamics->begun) return MPS_OK;
  MPSI_TRY(mpsi_dynamics_energies(dynamics, function, &kinetic, &strain));
  dynamics->works.start = kinetic + strain;
  dynamics->begun = true;
  return MPS_OK;
}

/* A prescribed degree of freedom has the acceleration of its boundary; the loops have computed that
 * of the forces. */
static void drive_accelerations(mps_dynamics *dynamics) {
  double *const a[2] = {dynamics->state.ax, dynamics->state.ay};
  for (int64_t k = 0; k < dynamics->bounds; k++) {
    const mpsi_dynamics_bound *q = &dynamics->bound[k];
    if (q->component < 2)
      a[q->component][q->particle] =
          mpsi_dynamics_boundary_of(dynamics, q->boundary)->gain[q->component];
  }
}

/* Whether an acceleration is beyond the limit, given by its square; of the blocks that the loops
 * have found near it. */
static int find_level(mps_dynamics *dynamics, double limit2) {
  const mpsi_dynamics_state *s = &dynamics->state;
  bool any = false;
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++) any = any || dynamics->bad[b];
  if (!any) return MPSI_DYNAMICS_CALM;
  drive_accelerations(dynamics);
  any = false;
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++) {
    if (!dynamics->bad[b]) continue;
    dynamics->bad[b] = 0;
    for (int64_t k = dynamics->mesh.block[b].begin; k < dynamics->mesh.block[b].end; k++)
      if (!(s->ax[k] * s->ax[k] + s->ay[k] * s->ay[k] <= limit2)) dynamics->bad[b] = 1;
    any = any || dynamics->bad[b];
  }
  return any ? MPSI_DYNAMICS_DIVERGED : MPSI_DYNAMICS_ALARMED;
}

/* Notes how the last step ended on all ranks; true: it has diverged. */
static bool note_level(mps_dynamics *dynamics, double level) {
  dynamics->limits.alarmed = level >= MPSI_DYNAMICS_ALARMED;
  return level >= MPSI_DYNAMICS_DIVERGED;
}

/* Status of all ranks: `status` of this one, how its last step has ended, and, for signals that are
 * functions of the caller, whether they have the same values in the next. */
static mps_status agree_on_step(mps_dynamics *dynamics, const char *function, mps_status status,
                                int level) {
  double any = level;
  status = dynamics->cautious ? mpsi_dynamics_agree_signals(dynamics, function, status, 1, &any)
                              : mpsi_domain_agree_max(dynamics->domain, function, status, 1, &any);
  if (status != MPS_OK || !note_level(dynamics, any)) return status;
  return report_divergence(dynamics, function);
}

/* The same at the end of a call, with the speeds; refresh leaves both to the step itself. */
static mps_status agree_on_last(mps_dynamics *dynamics, const char *function, int level) {
  const bool looks = isinf(dynamics->def.divergence);
  double any[2] = {level, level < MPSI_DYNAMICS_DIVERGED && !looks && too_fast(dynamics)};
  MPSI_TRY(mpsi_domain_agree_max(dynamics->domain, function, MPS_OK, 2, any));
  if (note_level(dynamics, any[0])) return report_divergence(dynamics, function);
  return any[1] != 0.0 ? report_speed(dynamics, function) : MPS_OK;
}

/* The first pass of all blocks. The halo exchange overlaps with the blocks that do not need it. */
static mps_status pass_blocks(work *w, const char *function) {
  mps_dynamics *dynamics = w->dynamics;
  const mpsi_dynamics_mesh *mesh = &dynamics->mesh;
  mpsi_dynamics_state *s = &dynamics->state;
  double *const column[3] = {s->dx, s->dy, s->th};
  mps_status status = MPS_OK;
  if (dynamics->halo) status = mpsi_halo_begin(dynamics->halo, function, 3, column);
  if (status != MPS_OK) return status;
  pass_turns(w, 0, mesh->interior);
  if (!dynamics->halo) return MPS_OK;
  MPSI_TRY(mpsi_halo_end(dynamics->halo, function, column));
  dynamics->kernels->trig[dynamics->def.rotation](s, dynamics->count,
                                                  dynamics->count + dynamics->ghosts);
  pass_turns(w, mesh->interior, mesh->blocks + mesh->ghosts);
  return MPS_OK;
}

/* The first pass, and the status of the ranks: the reduction of whether the last step has diverged
 * starts before it and ends after it, so that no rank waits for one that is less than a pass
 * behind. Where a signal may fail, ranks agree before. */
static mps_status pass_all(work *w, const char *function, mps_status status, int level) {
  mps_dynamics *dynamics = w->dynamics;
  if (dynamics->cautious) {
    status = agree_on_step(dynamics, function, status, level);
    return status == MPS_OK ? pass_blocks(w, function) : status;
  }
  double any = level;
  if (status == MPS_OK)
    status = mpsi_domain_vote_begin(dynamics->domain, function, status, 1, &any);
  if (status == MPS_OK && !mpsi_domain_many(dynamics->domain) && note_level(dynamics, any))
    return report_divergence(dynamics, function);
  if (status == MPS_OK) status = pass_blocks(w, function);
  if (status == MPS_OK) status = mpsi_domain_vote_end(dynamics->domain, function, 1, &any);
  if (status != MPS_OK || !note_level(dynamics, any)) return status;
  return report_divergence(dynamics, function);
}

/* After a step that has diverged: the state before it, if it was saved. Else its fields: the
 * pressures of all particles at their present positions, at any point of a call and on any number
 * of ranks; and prescribed motions. */
static mps_status end_diverged(work *w, const char *function, mps_status status) {
  status = mpsi_dynamics_undo(w->dynamics, function, status);
  if (!w->dynamics->diverged) return status;
  drive_accelerations(w->dynamics);
  const mps_status lost = mpsi_dynamics_bring_motion(w->dynamics, function);
  if (lost == MPS_OK) pass_turns(w, 0, w->dynamics->mesh.blocks + w->dynamics->mesh.ghosts);
  return lost == MPS_OK ? status : lost;
}

/* The part of a step after the first pass. */
static mps_status take_step(work *w, const char *function, bool output, int *level) {
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
  mpsi_parallel_for(dynamics->context, units, second_pass, w);
  dynamics->steps++;
  dynamics->fresh = dynamics->no_rate = false;
  dynamics->kept = dynamics->length;
  mpsi_dynamics_dashpots_after(dynamics, kick, output);
  mpsi_dynamics_prescribe_bounds(dynamics, kick, output);
  mpsi_dynamics_end_counting(dynamics, kick);
  if (w->account) {
    mpsi_dynamics_account account = {dynamics, &w->forces, w->step.drag, kick};
    mpsi_dynamics_count_works(&account);
  }
  const double limit = dynamics->def.divergence;
  *level = find_level(dynamics, fmin(limit * limit, DBL_MAX));
  const mps_status status = mpsi_dynamics_find_excess(dynamics, function);
  if (dynamics->limits.excess > 0.0) *level = MPSI_DYNAMICS_DIVERGED;
  return status;
}

/* Values of the signals for the next step, of `length`. */
static mps_status evaluate_signals(mps_dynamics *dynamics, const char *function, double length) {
  const double now = mpsi_dynamics_time(dynamics);
  const double then =
      length == dynamics->length
          ? dynamics->base_time + (double)(dynamics->steps + 1 - dynamics->base_step) * length
          : now + length;
  MPSI_TRY(mpsi_dynamics_evaluate_signals(dynamics, function, now, then));
  return mpsi_dynamics_evaluate_loads(dynamics, function, now);
}

mps_status mpsi_dynamics_look_ahead(mps_dynamics *dynamics, const char *function, double length) {
  const mps_status status = evaluate_signals(dynamics, function, length);
  return dynamics->cautious ? mpsi_dynamics_agree_signals(dynamics, function, status, 0, NULL)
                            : status;
}

mps_status mpsi_dynamics_advance(mps_dynamics *dynamics, const char *function, int64_t count,
                                 double length, bool output) {
  const double limit = dynamics->def.divergence;
  const bool watch = dynamics->def.watch_damping && dynamics->damping != MPSI_DYN_UNDAMPED;
  /* Small bodies are one unit of work on the calling thread: two barriers a step cost more than
   * threads gain. */
  const int64_t blocks = dynamics->mesh.blocks;
  const int64_t units = blocks < SMALL_BODY ? 1 : 8 * mps_context_threads(dynamics->context);
  const int32_t removal = dynamics->def.rotation, integrator = dynamics->def.integrator;
  const int32_t sums =
      dynamics->damping == MPSI_DYN_BY_PAIRS ? MPSI_DYN_DAMPED_FORCES : MPSI_DYN_FORCES;
  work w = {.dynamics = dynamics,
            .step = {.dt = length,
                     /* never accepts an infinite one */
                     .limit2 = fmin(limit * limit * ALARM2, DBL_MAX),
                     .stride = dynamics->count},
            .pass1 = dynamics->kernels->pass1[removal][sums],
            .ghost_pass1 = dynamics->kernels->pass1[removal][MPSI_DYN_PRESSURES],
            .pass2 = dynamics->kernels->pass2[removal][dynamics->damping][integrator],
            .grain = blocks > 0 ? (blocks + units - 1) / units : 1};
  if (count == 0) return MPS_OK;
  MPSI_TRY(mpsi_dynamics_look_ahead(dynamics, function, length));
  MPSI_TRY(mpsi_dynamics_save_before(dynamics, function));
  set_length(dynamics, length);
  if (dynamics->fresh) start_history(dynamics, length);
  mps_status status = begin_budget(dynamics, function);
  if (status != MPS_OK) return status;
  int level = MPSI_DYNAMICS_CALM; /* of the step before */
  w.step.drag = watch ? dynamics->drag : NULL;
  for (int64_t k = 0; k < count; k++) {
    if (k > 0) status = evaluate_signals(dynamics, function, length);
    status = pass_all(&w, function, status, level);
    if (status == MPS_OK && k > 0) status = mpsi_dynamics_save_before(dynamics, function);
    if (status == MPS_ERROR_DIVERGED) return end_diverged(&w, function, status);
    if (status != MPS_OK) return status;
    w.forces = mpsi_dynamics_find_forces(dynamics);
    w.account = w.forces.any || watch;
    MPSI_TRY(take_step(&w, function, output && k == count - 1, &level));
  }
  status = agree_on_last(dynamics, function, level);
  return status == MPS_ERROR_DIVERGED ? end_diverged(&w, function, status) : status;
}
