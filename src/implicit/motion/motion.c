/* motion.c - motion of the structure: M a + C v + K u = F, C = a0 M + a1 K, with the static
 * solver's operator and lumped mass, by the generalised alpha method (Chung and Hulbert), of which
 * Newmark's method is the member with alpha_m = alpha_f = 0.
 *
 *   u* = u + dt v + (1/2 - beta) dt^2 a,  v* = v + (1 - gamma) dt a
 *   u' = u* + w,  v' = v* + gamma/(beta dt) w,  a' = w / (beta dt^2)
 *   (1 - am) M a' + am M a + (1 - af) (C v' + K u') + af (C v + K u) = (1 - af) F' + af F
 *
 * Unknown is the correction w, so that a structure at rest stays exactly at rest and the static
 * solution is a fixed point. Its matrix is a multiple of K + shift M. Prescribed components follow
 * their boundary. A step is computed beside the present state, which it replaces when complete.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/body/fabric.h"
#include "implicit/motion/motion.h"
#include "implicit/motion/renewal.h"
#include "implicit/operator/operator.h"
#include "implicit/solve/system.h"
#include "core/definition/digits.h"

#include <string.h>

/* ---- definition ------------------------------------------------------------------------------ */

static mps_status check_dt(mps_context *context, const char *function, double dt) {
  if (dt >= MPSI_ELASTIC_LEAST && dt <= MPSI_ELASTIC_MOST) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "dt is %s s, allowed is %g to %g",
                   mpsi_outside(dt, MPSI_ELASTIC_LEAST, MPSI_ELASTIC_MOST).text, MPSI_ELASTIC_LEAST,
                   MPSI_ELASTIC_MOST);
}

static mps_status read_family(mps_context *context, const char *function,
                              const mps_elastic_motion_def *def, mpsi_elastic_motion *m) {
  const double r = def->rho_inf;
  m->alpha_m = m->alpha_f = 0.0;
  m->beta = 0.25;
  m->gamma = 0.5;
  if (r < 1.0) { /* Chung and Hulbert (25), (17), (20) */
    m->alpha_m = (2.0 * r - 1.0) / (r + 1.0);
    m->alpha_f = r / (r + 1.0);
    m->gamma = 0.5 - m->alpha_m + m->alpha_f;
    m->beta = 0.25 * (m->gamma + 0.5) * (m->gamma + 0.5);
  }
  if (isnan(def->beta)) {
    m->conserving = r == 1.0;
    return MPS_OK;
  }
  const double g = def->gamma, least = 0.25 * (g + 0.5) * (g + 0.5);
  if (!(def->beta >= least * (1.0 - 1e-12)))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "beta is %s, must be at least (gamma + 1/2)^2 / 4, %g, for an "
                     "unconditionally stable step",
                     mpsi_outside(def->beta, least, 10.0).text, least);
  m->beta = def->beta;
  m->gamma = g;
  m->conserving = def->beta == 0.25 && g == 0.5;
  return MPS_OK;
}

/* a0 and a1 from h = a0 / (2 w) + a1 w / 2 at both circular frequencies. */
static mps_status read_damping(mps_context *context, const char *function,
                               const mps_elastic_motion_def *def, mpsi_elastic_motion *m) {
  m->a0 = def->mass_damping;
  m->a1 = def->stiffness_damping;
  const double *h = def->ratio, *f = def->frequency;
  if (isnan(h[0])) return MPS_OK;
  if (f[0] == f[1])
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "frequency[0] and frequency[1] are both %g Hz, must differ", f[0]);
  const double pi = 3.14159265358979323846, w0 = 2 * pi * f[0], w1 = 2 * pi * f[1];
  m->a1 = 2.0 * (h[1] * w1 - h[0] * w0) / (w1 * w1 - w0 * w0);
  m->a0 = 2.0 * h[0] * w0 - m->a1 * w0 * w0;
  const double tiny = 1e-12;
  if (m->a1 >= -tiny * h[0] / w0 && m->a0 >= -tiny * h[0] * w0) {
    m->a0 = fmax(m->a0, 0.0);
    m->a1 = fmax(m->a1, 0.0);
    return MPS_OK;
  }
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "ratios %g at %g Hz and %g at %g Hz need negative coefficients (a0 %g, a1 %g): "
                   "other frequencies would gain energy",
                   h[0], f[0], h[1], f[1], m->a0, m->a1);
}

/* The matrix of a step is `factor` (K + shift M). */
static double shift_of(const mpsi_elastic_motion *m, double dt, double *factor) {
  const double af = 1.0 - m->alpha_f, stiff = af * (1.0 + m->a1 * m->gamma / (m->beta * dt));
  const double heavy =
      (1.0 - m->alpha_m) / (m->beta * dt * dt) + af * m->a0 * m->gamma / (m->beta * dt);
  *factor = stiff;
  return heavy / stiff;
}

static void exchange(double **a, double **b) {
  double *keep = *a;
  *a = *b;
  *b = keep;
}

/* ---- start ----------------------------------------------------------------------------------- */

/* The field if the set has it, else zero. */
static mps_status read_or_zero(mps_elastic *e, const char *function, const char *name,
                               double *values) {
  memset(values, 0, (size_t)(e->n * e->dim) * sizeof *values);
  if (!mpsi_particles_column(e->particles, name, 0)) return MPS_OK;
  return mpsi_elastic_read(e, function, name, values, e->dim);
}

static void set_reaction(mps_elastic *e, const double *held, const double *a) {
  for (int64_t k = 0; k < e->n * e->dim; k++) e->reaction[k] = held[k] + e->mass[k / e->dim] * a[k];
  mpsi_elastic_keep_fixed(e, e->reaction);
}

/* At the start (`a` NULL: the accelerations follow from these), and at the end, `time`, of step
 * `steps`. */
static mps_status check_finite(const mps_elastic *e, const char *function, int64_t steps,
                               double time, const double *u, const double *v, const double *a) {
  for (int64_t k = 0; k < e->n * e->dim; k++) {
    const double acceleration = a ? a[k] : 0.0;
    if (isfinite(acceleration) && fabs(u[k]) <= MPSI_ELASTIC_FURTHEST &&
        fabs(v[k]) <= MPSI_ELASTIC_FURTHEST)
      continue;
    const mps_status status = mpsi_fail(
        e->context, function, a ? MPS_ERROR_DIVERGED : MPS_ERROR_NUMERIC,
        "t = %g s: the motion of particle %lld is beyond double precision: displacement "
        "%g m, velocity %g m/s, acceleration %g m/s2; allowed are %g m and m/s",
        time, (long long)e->id[k / e->dim], u[k], v[k], acceleration, MPSI_ELASTIC_FURTHEST);
    mpsi_fail_where(e->context, steps, e->id[k / e->dim]);
    return status;
  }
  return MPS_OK;
}

/* Do all ranks start the same motion? */
static mps_status agree_on_motion(mps_elastic *e, const char *function, mps_status status,
                                  const mps_elastic_motion_def *def) {
  mpsi_given given = MPSI_GIVEN;
  MPSI_GIVE_DEF(&given, mps_elastic_motion_def, def);
  return mpsi_elastic_agree_given(e, function, status, &given);
}

/* `mass`: the former masses, restored on an error. */
static mps_status begin(mps_elastic *e, const char *function, const mps_elastic_motion_def *user,
                        double **mass) {
  mps_elastic_motion_def def = mps_elastic_motion_defaults();
  mpsi_elastic_motion made = {.dt = 0.0}, *m = NULL;
  mps_status status = MPSI_DEF_READ(e->context, function, mps_elastic_motion_def, user, &def);
  made.dt = def.dt, made.time = def.time;
  if (status == MPS_OK) status = read_family(e->context, function, &def, &made);
  if (status == MPS_OK) status = read_damping(e->context, function, &def, &made);
  if (status == MPS_OK) status = mpsi_elastic_read_mass(e, function, mass);
  status = agree_on_motion(e, function, status, &def);
  if (status == MPS_OK) status = mpsi_elastic_prepare(e, function);
  double factor;
  if (status == MPS_OK)
    status = mpsi_elastic_factor(e, function, shift_of(&made, made.dt, &factor));
  for (int a = 0; a < 2 && status == MPS_OK; a++)
    status = mpsi_as(e->context, function,
                     mps_particles_add_field(e->particles, a ? "acceleration" : "velocity", 0));
  if (status == MPS_OK) status = mpsi_elastic_drive(e, function, made.time);
  if (status == MPS_OK) status = mpsi_elastic_gather_loads(e, function, made.time);
  if (status != MPS_OK) return status;
  mpsi_elastic_motion *former = e->motion;
  if (!(m = mpsi_alloc(e->context, 1, sizeof *m)))
    return mpsi_fail_memory(e->context, function, sizeof *m);
  *m = made;
  e->motion = m;
  status = mpsi_elastic_allocate_motion(e, function, m);
  if (status == MPS_OK) status = read_or_zero(e, function, "velocity", m->velocity);
  if (status == MPS_OK) status = read_or_zero(e, function, "displacement", m->next[MPSI_NEXT_U]);
  if (status == MPS_OK) {
    mpsi_elastic_impose(e, 0, m->next[MPSI_NEXT_U]);
    mpsi_elastic_impose(e, 1, m->velocity);
    status = check_finite(e, function, -1, made.time, m->next[MPSI_NEXT_U], m->velocity, NULL);
  }
  if (status == MPS_OK) exchange(&e->displacement, &m->next[MPSI_NEXT_U]);
  mpsi_elastic_motion *const kept = status == MPS_OK ? e->motion : former;
  mpsi_elastic_motion *const ended = status == MPS_OK ? NULL : e->ended;
  if (status == MPS_OK) e->motion = former;
  if (status != MPS_OK) e->ended = NULL;
  mpsi_elastic_end_motion(e); /* the former one, or the new one after an error */
  e->motion = kept, e->ended = ended;
  return status;
}

mps_status mps_elastic_start(mps_elastic *e, const mps_elastic_motion_def *def) {
  if (!e) return mpsi_null(__func__, "elastic");
  MPSI_TRY(mpsi_elastic_enter(e, __func__));
  e->within = true;
  const int32_t fields = mps_particles_field_count(e->particles);
  double *mass = e->mass;
  mps_status status = begin(e, __func__, def, &mass);
  mpsi_elastic_finish_mass(e, mass, status == MPS_OK);
  if (status != MPS_OK) mpsi_particles_drop_fields(e->particles, fields);
  if (status == MPS_OK) {
    mpsi_elastic_motion *m = e->motion;
    memcpy(m->force, e->load, (size_t)(e->n * e->dim) * sizeof *m->force);
    status = mpsi_elastic_find_forces(e, __func__, e->displacement, m->velocity, m->inner, m->held);
    mpsi_elastic_balance(e);
    mpsi_elastic_keep_fixed(e, m->held);
    set_reaction(e, m->held, m->acceleration);
    mpsi_elastic_forget_reactions(e);
    mpsi_elastic_count_reactions(e, 0.0);
    mpsi_elastic_find_fabric(e, m->fabric);
    if (status == MPS_OK) status = mpsi_elastic_begin_ledger(e, __func__);
  }
  return mpsi_elastic_leave(e, status);
}

/* ---- one step -------------------------------------------------------------------------------- */

/* The equations of the step without w, to e->rhs. */
static mps_status find_right_side(mps_elastic *e, const char *function, double factor) {
  mpsi_elastic_motion *m = e->motion;
  const double am = m->alpha_m, af = m->alpha_f;
  const double *u1 = m->next[MPSI_NEXT_U], *v1 = m->next[MPSI_NEXT_V];
  const int64_t all = e->n * e->dim;
  for (int64_t k = 0; k < all; k++)
    m->scratch[k] = (1.0 - af) * (u1[k] + m->a1 * v1[k]) +
                    (af != 0.0 ? af * (e->displacement[k] + m->a1 * m->velocity[k]) : 0.0);
  const mps_status status = mpsi_elastic_apply(e, function, m->scratch, e->work);
  for (int64_t k = 0; k < all; k++) {
    const double inertia =
        am * m->acceleration[k] + m->a0 * ((1.0 - af) * v1[k] + af * m->velocity[k]);
    e->work[k] =
        (1.0 - af) * e->load[k] + af * m->force[k] - e->work[k] - e->mass[k / e->dim] * inertia;
  }
  mpsi_elastic_reduce(e, e->work, e->rhs);
  for (int64_t k = 0; k < e->unknowns; k++) e->rhs[k] /= factor;
  return status;
}

/* The new state becomes the present one. */
static void accept(mps_elastic *e, double dt, double time) {
  mpsi_elastic_motion *m = e->motion;
  mpsi_elastic_count_step(e, m->next[MPSI_NEXT_U], m->next[MPSI_NEXT_V], m->next[MPSI_NEXT_A],
                          m->next[MPSI_NEXT_INNER], m->next[MPSI_NEXT_HELD]);
  exchange(&e->displacement, &m->next[MPSI_NEXT_U]);
  exchange(&m->velocity, &m->next[MPSI_NEXT_V]);
  exchange(&m->acceleration, &m->next[MPSI_NEXT_A]);
  exchange(&m->inner, &m->next[MPSI_NEXT_INNER]);
  exchange(&m->held, &m->next[MPSI_NEXT_HELD]);
  memcpy(m->force, e->load, (size_t)(e->n * e->dim) * sizeof *m->force);
  set_reaction(e, m->held, m->acceleration);
  mpsi_elastic_count_reactions(e, dt);
  m->time = time;
  m->steps++;
}

/* One step of length dt, after which the time is `time`. On an error nothing has changed. */
static mps_status step_once(mps_elastic *e, const char *function, double dt, double time) {
  mpsi_elastic_motion *m = e->motion;
  const int64_t all = e->n * e->dim;
  double factor, *u1 = m->next[MPSI_NEXT_U], *v1 = m->next[MPSI_NEXT_V], *a1 = m->next[MPSI_NEXT_A];
  const double shift = shift_of(m, dt, &factor);
  MPSI_TRY(mpsi_elastic_prepare(e, function));
  MPSI_TRY(mpsi_elastic_factor(e, function, shift));
  MPSI_TRY(mpsi_elastic_renew_motion(e, function));
  MPSI_TRY(mpsi_elastic_drive(e, function, time));
  MPSI_TRY(mpsi_elastic_gather_loads(e, function, time));
  for (int64_t k = 0; k < all; k++) {
    u1[k] =
        e->displacement[k] + dt * m->velocity[k] + (0.5 - m->beta) * dt * dt * m->acceleration[k];
    v1[k] = m->velocity[k] + (1.0 - m->gamma) * dt * m->acceleration[k];
    a1[k] = 0.0;
  }
  mpsi_elastic_impose(e, 0, u1);
  mpsi_elastic_impose(e, 1, v1);
  mps_status status = find_right_side(e, function, factor);
  if (status == MPS_OK) status = mpsi_elastic_backsolve(e, function, 1, e->rhs, e->solution);
  if (status != MPS_OK) return status;
  memset(m->scratch, 0, (size_t)all * sizeof *m->scratch);
  mpsi_elastic_expand(e, e->solution, false, m->scratch);
  for (int64_t k = 0; k < all; k++) {
    const double w = m->scratch[k];
    u1[k] += w;
    v1[k] += m->gamma * (w / (m->beta * dt));
    a1[k] = w / (m->beta * dt * dt);
  }
  mpsi_elastic_impose(e, 2, a1);
  if ((status = check_finite(e, function, m->steps, time, u1, v1, a1)) != MPS_OK) return status;
  MPSI_TRY(mpsi_elastic_find_forces(e, function, u1, v1, m->next[MPSI_NEXT_INNER],
                                    m->next[MPSI_NEXT_HELD]));
  mpsi_elastic_keep_fixed(e, m->next[MPSI_NEXT_HELD]);
  accept(e, dt, time);
  return MPS_OK;
}

/* Fails only where the caller has removed a field. */
static mps_status publish(mps_elastic *e, const char *function) {
  mpsi_elastic_motion *m = e->motion;
  MPSI_TRY(mpsi_elastic_write(e, function, "displacement", e->displacement, e->dim));
  MPSI_TRY(mpsi_elastic_write(e, function, "velocity", m->velocity, e->dim));
  MPSI_TRY(mpsi_elastic_write(e, function, "acceleration", m->acceleration, e->dim));
  return mpsi_elastic_write(e, function, "reaction", e->reaction, e->dim);
}

/* ---- for the loop of all solvers ------------------------------------------------------------- */

static mps_status check_motion(const mps_elastic *e, const char *function) {
  if (e->motion) return MPS_OK;
  return mpsi_fail(e->context, function, MPS_ERROR_STATE,
                   "no motion under way: call mps_elastic_start first");
}

mps_status mpsi_elastic_begin_march(void *solver, const char *function, mpsi_march *m) {
  const mps_elastic *e = solver;
  mps_status status = check_motion(e, function);
  if (status != MPS_OK || !mpsi_march_is_run(m)) return status;
  MPSI_TRY(mpsi_march_check(m, e->context, function, e->motion->dt));
  m->total = (int64_t)ceil((m->t_end - m->start) / e->motion->dt * (1.0 - 1e-12));
  m->length = m->total > 0 ? (m->t_end - m->start) / (double)m->total : e->motion->dt;
  return m->callback ? publish(solver, function) : MPS_OK; /* for its first call */
}

mps_status mpsi_elastic_advance_march(void *solver, const char *function, mpsi_march *m,
                                      int64_t count) {
  mps_elastic *e = solver;
  (void)count; /* 1 */
  const bool run = mpsi_march_is_run(m);
  const double dt = run ? m->length : e->motion->dt;
  e->within = true;
  mps_status status = step_once(
      e, function, dt,
      !run      ? e->motion->time + dt
      : m->last ? m->t_end
                : m->start + (m->t_end - m->start) * (double)(m->done + 1) / (double)m->total);
  e->within = false;
  if (status != MPS_OK && status != MPS_ERROR_DIVERGED) /* that has a particle */
    mpsi_fail_where(e->context, e->motion->steps, -1);
  return status == MPS_OK && m->calls ? publish(e, function) : status;
}

/* The fields of the last complete step, also after an error; the first error stays on record. */
mps_status mpsi_elastic_end_march(void *solver, const char *function, const mpsi_march *m,
                                  mps_status status) {
  mps_elastic *e = solver;
  if (status == MPS_OK || e->motion->steps > m->before) {
    const mps_status published = publish(e, function); /* the fields exist since the start */
    if (status == MPS_OK) status = published;
  }
  return mpsi_elastic_agree(e, function, status);
}

double mpsi_elastic_limit(const void *solver) { return INFINITY; }

mps_status mpsi_elastic_check_dt(void *solver, const char *function, double dt) {
  const mps_elastic *e = solver;
  MPSI_TRY(check_motion(e, function));
  return check_dt(e->context, function, dt);
}

mps_status mpsi_elastic_use_dt(void *solver, const char *function, double dt) {
  ((mps_elastic *)solver)->motion->dt = dt;
  return MPS_OK;
}
