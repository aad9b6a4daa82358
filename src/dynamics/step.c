/* step.c - running the explicit MPS solver: initial state, steps, the run loop, divergence.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles_internal.h"
#include "dynamics_private.h"

#include <float.h>
#include <string.h>

/* ---- initial state ----------------------------------------------------------------------------
 */

/* The columns that make the initial state: displacement, rotation, velocity, spin. */
static void state_columns(const mps_dynamics *dynamics, double *columns[6]) {
  const mpsi_dynamics_state *s = &dynamics->state;
  double *list[6] = {s->dx, s->dy, s->th, s->vx, s->vy, s->vth};
  memcpy(columns, list, sizeof list);
}

static void start_history(mps_dynamics *dynamics) {
  mpsi_dynamics_state *s = &dynamics->state;
  double *d[3] = {s->dx, s->dy, s->th}, *o[3] = {s->ox, s->oy, s->oth};
  double *v[3] = {s->vx, s->vy, s->vth};
  for (int c = 0; c < 3; c++)
    for (int64_t k = 0; k < dynamics->count; k++) o[c][k] = d[c][k] - dynamics->dt * v[c][k];
}

void mpsi_dynamics_begin(mps_dynamics *dynamics, double time) {
  dynamics->base_time = time;
  dynamics->steps = dynamics->base_step = 0;
  dynamics->fresh = true;
  dynamics->diverged = false;
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *inverse[3] = {s->ix, s->iy, s->ith};
  double *v[3] = {s->vx, s->vy, s->vth};
  for (int c = 0; c < 3; c++) /* held: at rest */
    for (int64_t k = 0; k < dynamics->count; k++)
      if (inverse[c][k] == 0.0) v[c][k] = 0.0;
  /* driven particles: where the signal is, at the speed it has */
  for (int64_t k = 0; k < dynamics->drives; k++) {
    const mpsi_dynamics_drive *drive = &dynamics->drive[k];
    (drive->component == 0 ? s->dx : s->dy)[drive->particle] =
        drive->factor * mps_signal_displacement(drive->signal, time);
    (drive->component == 0 ? s->vx : s->vy)[drive->particle] =
        drive->factor * mps_signal_velocity(drive->signal, time);
  }
  start_history(dynamics);
  dynamics->kernels->trig[dynamics->def.rotation == MPS_ROTATION_MEAN_MATRIX](&dynamics->state, 0,
                                                                              dynamics->count);
  mpsi_dynamics_publish(dynamics);
}

void mpsi_dynamics_rewind(mps_dynamics *dynamics) {
  double *column[6];
  state_columns(dynamics, column);
  for (int c = 0; c < 6; c++)
    memcpy(column[c], dynamics->initial + c * dynamics->count,
           (size_t)dynamics->count * sizeof(double));
  mpsi_dynamics_begin(dynamics, dynamics->initial_time);
}

mps_status mps_dynamics_restart(mps_dynamics *dynamics, double time) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  if (!isfinite(time))
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                     "time is %g s, must be finite", time);
  double *column[6];
  state_columns(dynamics, column);
  for (int c = 0; c < 6; c++)
    for (int64_t k = 0; k < dynamics->count; k++)
      if (!isfinite(column[c][k]))
        return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                         "the initial state of particle %lld is not finite (%g)",
                         (long long)mpsi_particles_integers(dynamics->particles, "id")[k],
                         column[c][k]);
  if (!dynamics->initial)
    dynamics->initial = mpsi_alloc(dynamics->context, 6 * dynamics->count, sizeof(double));
  if (!dynamics->initial)
    return mpsi_fail_memory(dynamics->context, __func__, (size_t)dynamics->count * 48);
  for (int c = 0; c < 6; c++)
    memcpy(dynamics->initial + c * dynamics->count, column[c],
           (size_t)dynamics->count * sizeof(double));
  dynamics->initial_time = time;
  mpsi_dynamics_begin(dynamics, time);
  return MPS_OK;
}

mps_status mps_dynamics_resume(mps_dynamics *dynamics, double time, int64_t step) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  if (!isfinite(time) || step < 0)
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                     "time is %g s and step %lld: must be finite and >= 0", time, (long long)step);
  if (dynamics->dt == 0.0)
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_STATE,
                     "give the time step of the checkpoint in the definition or by "
                     "mps_dynamics_set_dt before resuming");
  if (step == 0) return mps_dynamics_restart(dynamics, time); /* no history yet */
  dynamics->steps = step;
  /* Later times must be rounded as in the run that went before: counted from its start, where that
   * gives the time of the checkpoint, which is so unless dt was changed on the way. */
  const bool from_start = dynamics->initial_time + (double)step * dynamics->dt == time;
  dynamics->base_time = from_start ? dynamics->initial_time : time;
  dynamics->base_step = from_start ? 0 : step;
  dynamics->fresh = false;
  dynamics->history_dt = dynamics->dt;
  dynamics->diverged = false;
  dynamics->kernels->trig[dynamics->def.rotation == MPS_ROTATION_MEAN_MATRIX](&dynamics->state, 0,
                                                                              dynamics->count);
  return MPS_OK;
}

void mpsi_dynamics_publish(mps_dynamics *dynamics) {
  mpsi_dynamics_state *s = &dynamics->state;
  double *d[3] = {s->dx, s->dy, s->th}, *o[3] = {s->ox, s->oy, s->oth};
  double *v[3] = {s->vx, s->vy, s->vth};
  for (int c = 0; c < 2; c++) {
    const double *reference = mpsi_dynamics_column(dynamics, "reference", c);
    double *position = mpsi_dynamics_column(dynamics, "position", c);
    for (int64_t k = 0; k < dynamics->count; k++) position[k] = reference[k] + d[c][k];
  }
  if (dynamics->def.integrator != MPS_INTEGRATOR_VERLET || dynamics->fresh) return;
  for (int c = 0; c < 3; c++)
    for (int64_t k = 0; k < dynamics->count; k++) v[c][k] = (d[c][k] - o[c][k]) / dynamics->dt;
}

/* ---- time step ---------------------------------------------------------------------------------
 */

/* A bound of the limit that costs nothing: the endless lattice of the stiffest and lightest
 * material in the set. Below it no warning is due. Off a lattice there is none: 0. */
static double cheap_limit(mps_dynamics *dynamics) {
  if (!dynamics->lattice) return 0.0;
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *rho = mpsi_dynamics_column(dynamics, "density", 0);
  double mu = 0.0, lambda = 0.0, light = INFINITY, alpha = 0.0, beta = 0.0;
  for (int64_t k = 0; k < dynamics->count; k++) {
    mu = fmax(mu, s->mu[k]), lambda = fmax(lambda, s->lambda[k]), light = fmin(light, rho[k]);
    alpha = fmax(alpha, s->alpha[k]), beta = fmax(beta, s->beta[k]);
  }
  const double omega2 = mpsi_dynamics_lattice_omega2(
      mps_particles_spacing(dynamics->particles), dynamics->def.radius_ratio, light,
      sqrt(mu / light), sqrt((lambda + 2.0 * mu) / light), dynamics->def.torque);
  /* Shear is softer where neighbours are missing, pressure can be stiffer: up to 1.13 times omega
   * over all the shapes tried, and only where the highest mode is not the spin's. */
  return (lambda <= 7.0 * mu ? 0.95 : 0.8) * mpsi_dynamics_damped_limit(omega2, alpha, beta);
}

/* Warns of a `dt` above the limit. */
static mps_status compare_dt(mps_dynamics *dynamics, double dt) {
  const bool euler = dynamics->def.integrator == MPS_INTEGRATOR_EULER;
  if (!euler && dt <= cheap_limit(dynamics)) return MPS_OK;
  mps_linear_limit limit;
  const mps_status status = mps_dynamics_limit_linear(dynamics, 0.0, &limit);
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
  mps_linear_limit limit;
  const mps_status status = mps_dynamics_limit_linear(dynamics, 0.0, &limit);
  if (status != MPS_OK) return status;
  if (!(limit.dt > 0.0))
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "Euler without damping has no stable time step to choose: give dt");
  if (isinf(limit.dt))
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "no force between particles that can move limits the time step: give dt");
  dynamics->dt = dynamics->def.courant * limit.dt;
  start_history(dynamics);
  return MPS_OK;
}

mps_status mpsi_dynamics_settle_dt(mps_dynamics *dynamics, const char *function) {
  if (dynamics->checked) return MPS_OK;
  const mps_status status =
      dynamics->dt == 0.0 ? choose_dt(dynamics, function) : compare_dt(dynamics, dynamics->dt);
  dynamics->checked = status == MPS_OK;
  return status;
}

double mps_dynamics_dt(mps_dynamics *dynamics) {
  if (!dynamics || mpsi_dynamics_settle_dt(dynamics, __func__) != MPS_OK) return 0.0;
  return dynamics->dt;
}

mps_status mps_dynamics_set_dt(mps_dynamics *dynamics, double dt) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  if (!isfinite(dt) || dt <= 0.0)
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                     "dt is %g s, must be finite and > 0", dt);
  const mps_status status = compare_dt(dynamics, dt);
  if (status != MPS_OK) return status;
  dynamics->base_time = mps_dynamics_time(dynamics);
  dynamics->base_step = dynamics->steps;
  const double ratio = dynamics->dt > 0.0 ? dt / dynamics->dt : 1.0;
  mpsi_dynamics_state *s = &dynamics->state;
  double *d[3] = {s->dx, s->dy, s->th}, *o[3] = {s->ox, s->oy, s->oth};
  const bool start = dynamics->fresh;
  dynamics->dt = dynamics->def.dt = dt; /* as if the definition had given it */
  dynamics->checked = true;
  if (start)
    start_history(dynamics);
  else
    for (int c = 0; c < 3; c++)
      for (int64_t k = 0; k < dynamics->count; k++) o[c][k] = d[c][k] - ratio * (d[c][k] - o[c][k]);
  return MPS_OK;
}

/* ---- steps ------------------------------------------------------------------------------------
 */

#define SMALL_BODY 40 /* blocks, about 20 000 particles */

typedef struct work {
  mps_dynamics *dynamics;
  mpsi_dynamics_step step;
  mpsi_dynamics_pass1_fn pass1;
  mpsi_dynamics_pass2_fn pass2;
  int64_t grain; /* blocks a unit of work */
} work;

static void first_pass(void *data, int64_t unit, int32_t worker) {
  const work *w = data;
  mps_dynamics *dynamics = w->dynamics;
  const int64_t last = (unit + 1) * w->grain, n = dynamics->mesh.blocks;
  for (int64_t b = unit * w->grain; b < last && b < n; b++)
    w->pass1(&dynamics->state, &dynamics->mesh, b, dynamics->scratch + worker * MPSI_DYN_SCRATCH);
}

static void second_pass(void *data, int64_t unit, int32_t worker) {
  const work *w = data;
  mps_dynamics *dynamics = w->dynamics;
  const int64_t last = (unit + 1) * w->grain, n = dynamics->mesh.blocks;
  for (int64_t b = unit * w->grain; b < last && b < n; b++)
    dynamics->bad[b] = w->pass2(&dynamics->state, &dynamics->mesh, b, &w->step,
                                dynamics->scratch + worker * MPSI_DYN_SCRATCH);
}

/* The particle that broke the limit, its acceleration and where it is. */
static mps_status report_divergence(mps_dynamics *dynamics, const char *function, double now) {
  const mpsi_dynamics_state *s = &dynamics->state;
  int64_t worst = -1;
  double most = 0.0;
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++)
    for (int64_t k = dynamics->mesh.block[b].begin;
         dynamics->bad[b] && k < dynamics->mesh.block[b].end; k++) {
      const double a = hypot(s->ax[k], s->ay[k]);
      if (worst >= 0 && !(a > most) && !isnan(a)) continue;
      worst = k;
      most = a;
      if (isnan(a)) break;
    }
  dynamics->diverged = true;
  if (worst < 0) worst = 0;
  const long long id = (long long)mpsi_particles_integers(dynamics->particles, "id")[worst];
  const mps_status status = mpsi_fail(
      dynamics->context, function, MPS_ERROR_DIVERGED,
      "diverged at step %lld, t = %.6g s: |acceleration| of particle %lld at (%.6g, %.6g) m is "
      "%.4g m/s2, beyond %g; dt is %.6g s%s: take a smaller time step",
      (long long)dynamics->steps, now, id, mpsi_dynamics_column(dynamics, "reference", 0)[worst],
      mpsi_dynamics_column(dynamics, "reference", 1)[worst], most, dynamics->def.divergence,
      dynamics->dt,
      dynamics->have_limit && dynamics->dt > dynamics->limit.dt
          ? ", above the linear stability limit"
          : "");
  mpsi_fail_where(dynamics->context, dynamics->steps, id);
  return status;
}

static bool take_step(work *w, bool output) {
  mps_dynamics *dynamics = w->dynamics;
  const double now = mps_dynamics_time(dynamics);
  w->step.first = dynamics->fresh;
  w->step.output = output;
  if (dynamics->dashpots) mpsi_dynamics_dashpots_before(dynamics);
  const int64_t units = (dynamics->mesh.blocks + w->grain - 1) / w->grain;
  mpsi_parallel_for(dynamics->context, units, first_pass, w);
  mpsi_parallel_for(dynamics->context, units, second_pass, w);
  dynamics->steps++;
  dynamics->fresh = false;
  dynamics->history_dt = dynamics->dt;
  w->step.rate = 1.0 / dynamics->dt;
  if (dynamics->dashpots) mpsi_dynamics_dashpots_after(dynamics, now, output);
  if (dynamics->drives)
    mpsi_dynamics_apply_drives(dynamics, mps_dynamics_time(dynamics), now, output);
  bool bad = false;
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++) bad = bad || dynamics->bad[b];
  return !bad;
}

mps_status mpsi_dynamics_advance(mps_dynamics *dynamics, const char *function, int64_t count,
                                 bool output) {
  const int removal = dynamics->def.rotation == MPS_ROTATION_MEAN_MATRIX;
  const double limit = dynamics->def.divergence;
  /* Small bodies are one unit of work, run where the caller is: two barriers a step cost more
   * than sharing gains. */
  const int64_t blocks = dynamics->mesh.blocks;
  const int64_t units = blocks < SMALL_BODY ? 1 : 8 * mps_context_threads(dynamics->context);
  work w = {.dynamics = dynamics,
            .step = {.dt = dynamics->dt,
                     .rate = 1.0 / (dynamics->fresh ? dynamics->dt : dynamics->history_dt),
                     .limit2 = fmin(limit * limit, DBL_MAX)}, /* never lets an infinite one pass */
            .pass1 = dynamics->kernels->pass1[removal][dynamics->damping == MPSI_DYN_BY_PAIRS],
            .pass2 = dynamics->kernels->pass2[removal][dynamics->damping][dynamics->def.integrator],
            .grain = (blocks + units - 1) / units};
  for (int64_t k = 0; k < count; k++) {
    const double now = mps_dynamics_time(dynamics);
    if (!take_step(&w, output && k == count - 1)) return report_divergence(dynamics, function, now);
  }
  return MPS_OK;
}

#define PROMPT_WORK 5000000 /* particle-steps between looks at the cancel hook: some 0.1 s */

static mps_status ready(mps_dynamics *dynamics, const char *function) {
  if (dynamics->diverged)
    return mpsi_fail(dynamics->context, function, MPS_ERROR_STATE,
                     "the run has diverged: mps_dynamics_restart begins a new one");
  return mpsi_dynamics_settle_dt(dynamics, function);
}

mps_status mps_dynamics_step(mps_dynamics *dynamics, int64_t count) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  if (count < 0)
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  mps_status status = ready(dynamics, __func__);
  if (status != MPS_OK) return status;
  status = mpsi_dynamics_advance(dynamics, __func__, count, true);
  mpsi_dynamics_publish(dynamics);
  return status;
}

/* Calls the caller's callback, and keeps a record of its refusal when it left none. */
static mps_status ask(mps_dynamics *dynamics, const char *function, mps_dynamics_fn callback,
                      void *user) {
  const mps_status status = callback(user, dynamics);
  if (status != MPS_OK && mps_context_error(dynamics->context)->status != status)
    return mpsi_fail(dynamics->context, function, status,
                     "stopped by the callback with status %d at step %lld, t = %g s", (int)status,
                     (long long)dynamics->steps, mps_dynamics_time(dynamics));
  return status;
}

mps_status mps_dynamics_run(mps_dynamics *dynamics, double t_end, int64_t every,
                            mps_dynamics_fn callback, void *user) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_context *context = dynamics->context;
  if (!isfinite(t_end) || every < 1)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "t_end is %g s and every %lld: must be finite and >= 1", t_end,
                     (long long)every);
  mps_status status = ready(dynamics, __func__);
  if (status != MPS_OK) return status;
  const double start = mps_dynamics_time(dynamics);
  const double exact = (t_end - start) / dynamics->dt;
  if (exact > 1e15)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "a run to %g s takes %g steps of dt = %g s: too many", t_end, exact,
                     dynamics->dt);
  const int64_t total = exact > 0.0 ? (int64_t)ceil(exact - 1e-9) : 0;
  int64_t report = total / 100 > 0 ? total / 100 : 1;
  const int64_t prompt = PROMPT_WORK / dynamics->count + 1;
  if (report > prompt) report = prompt;
  if (callback) status = ask(dynamics, __func__, callback, user);
  for (int64_t done = 0; status == MPS_OK && done < total;) {
    int64_t n = every - done % every, m = report - done % report;
    n = n < m ? n : m;
    if (n > total - done) n = total - done;
    done += n;
    const bool call = callback && (done % every == 0 || done == total);
    status = mpsi_dynamics_advance(dynamics, __func__, n, call || done == total);
    if (call || done == total || status != MPS_OK) mpsi_dynamics_publish(dynamics);
    if (status == MPS_OK && call) status = ask(dynamics, __func__, callback, user);
    if (done % report == 0 || done == total) {
      mpsi_progress(context, "dynamics", dynamics->steps, mps_dynamics_time(dynamics) - start,
                    t_end - start);
      if (status == MPS_OK && mpsi_cancelled(context)) {
        mpsi_dynamics_publish(dynamics);
        status = mpsi_fail(context, __func__, MPS_ERROR_CANCELLED,
                           "stopped by the cancel hook at step %lld, t = %g s",
                           (long long)dynamics->steps, mps_dynamics_time(dynamics));
      }
    }
  }
  return status;
}
