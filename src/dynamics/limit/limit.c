/* limit.c - the largest stable time step by linear theory, without time stepping.
 *
 * Verlet and leapfrog with Rayleigh damping first become unstable at the amplification z = -1.
 * There 4 = lambda_max [ 2 dt A + dt^2 M^-1 K + 2 dt M^-1 K_beta ],  A = diag(alpha_i), K_beta the
 * stiffness with each part times its beta (by pairs), or diag(beta_i) K (by particles);
 * for one damping ratio that is dt = -(beta + alpha/w^2) + sqrt((beta + alpha/w^2)^2 + 4/w^2).
 * The highest eigenvalue comes from Lanczos iteration on the symmetric tangent.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/limit/dt.h"
#include "dynamics/limit/lattice.h"
#include "dynamics/limit/tangent.h"

#include <fenv.h>
#include <lapacke.h>
#include <string.h>

#define LANCZOS_MOST 400
#define LANCZOS_EVERY 10 /* iterations between checks of the result */
/* Enough: a relative bound on the error of the eigenvalue, or, where eigenvalues cluster, a
 * thousandth of that as relative change between two looks. */
#define LANCZOS_BOUND 1e-7
#define UNEVEN_BOUND 1e-5 /* for the rounds of uneven_limit */

#define FUNCTION "mps_dynamics_find_limit"

/* ---- Lanczos --------------------------------------------------------------------------------- */

/* The tridiagonal matrix, and memory to solve it. */
typedef struct tridiagonal {
  double diagonal[LANCZOS_MOST], off[LANCZOS_MOST];
  double d[LANCZOS_MOST], e[LANCZOS_MOST], w[LANCZOS_MOST], z[LANCZOS_MOST];
} tridiagonal;

/* The operator 2 dt A + dt^2 S + 2 dt S_beta in symmetric form; dt = 0 stands for S itself. */
typedef struct operator_data {
  mps_dynamics *dynamics;
  double dt;
  double *weight, *scaled, *work; /* m, 3 n, 4 m; m with ghosts */
  tridiagonal *of;
} operator_data;

static mps_status apply(operator_data *op, const double *x, double *y) {
  const int64_t n = op->dynamics->count, m = n + op->dynamics->ghosts;
  mps_status status;
  const double dt = op->dt;
  const double *alpha = op->dynamics->state.alpha, *beta = op->dynamics->state.beta;
  if (dt == 0.0) {
    return mpsi_dynamics_tangent_apply(op->dynamics, FUNCTION, NULL, x, y, op->work);
  }
  for (int64_t k = 0; k < m; k++) op->weight[k] = dt * dt + 2.0 * dt * beta[k];
  if (op->dynamics->damping == MPSI_DYN_BY_PAIRS) {
    status = mpsi_dynamics_tangent_apply(op->dynamics, FUNCTION, op->weight, x, y, op->work);
  } else { /* diag(w) S is similar to diag(sqrt w) S diag(sqrt w) */
    for (int64_t k = 0; k < 3 * n; k++) op->scaled[k] = sqrt(op->weight[k % n]) * x[k];
    status = mpsi_dynamics_tangent_apply(op->dynamics, FUNCTION, NULL, op->scaled, y, op->work);
    for (int64_t k = 0; k < 3 * n; k++) y[k] *= sqrt(op->weight[k % n]);
  }
  for (int64_t k = 0; k < 3 * n; k++) y[k] += 2.0 * dt * alpha[k % n] * x[k];
  return status;
}

/* Sums over blocks are exact: the same on any number of ranks. */
static mps_status dot(const mps_dynamics *dynamics, const double *a, const double *b, double *out) {
  mpsi_exact sum = {{0}};
  for (int c = 0; c < 3; c++)
    for (int64_t i = 0; i < dynamics->mesh.blocks; i++) {
      const mpsi_dynamics_block *block = &dynamics->mesh.block[i];
      if (block->begin >= dynamics->body && !dynamics->lead) continue;
      const int64_t first = c * dynamics->count;
      double part = 0.0;
      for (int64_t k = first + block->begin; k < first + block->end; k++) part += a[k] * b[k];
      mpsi_exact_add(&sum, part);
    }
  const mps_status status = mpsi_domain_sum_exact(dynamics->domain, FUNCTION, 1, &sum);
  *out = mpsi_exact_value(&sum);
  return status;
}

/* Start near the usual highest mode, the uniform spin, with a component in every other. A function
 * of the id alone: the order of the particles does not matter. */
static void start_vector(const mps_dynamics *dynamics, double *v) {
  const int64_t n = dynamics->count;
  const int64_t *id = mpsi_particles_integers(dynamics->particles, "id");
  for (int c = 0; c < 3; c++)
    for (int64_t k = 0; k < n; k++) {
      uint64_t h = (uint64_t)id[k] * 3u + (uint64_t)c + 1u;
      h *= 0x9e3779b97f4a7c15u;
      h = (h ^ (h >> 31)) * 0xbf58476d1ce4e5b9u;
      h ^= h >> 29;
      v[c * n + k] = (c == 2 ? 1.0 : 0.0) + 0.2 * ((double)(h >> 11) * 0x1p-53 - 0.5);
    }
  for (int64_t k = 0; k < dynamics->bounds; k++) /* not part of the problem */
    v[dynamics->bound[k].component * n + dynamics->bound[k].particle] = 0.0;
}

typedef struct ritz {
  double value, error; /* highest eigenvalue and a bound on its error */
  int64_t iterations;
} ritz;

/* Highest eigenvalue of the tridiagonal matrix, and the last component of its vector. Rank 0 finds
 * them: processors of several kinds may not find the same bits. */
static mps_status highest(const mps_dynamics *dynamics, int m, tridiagonal *t, double *value,
                          double *last) {
  double found[2] = {-INFINITY, -INFINITY};
  mps_status status = MPS_OK;
  if (mps_domain_rank(dynamics->domain) <= 0) {
    lapack_int count = 0, support[2];
    memcpy(t->d, t->diagonal, (size_t)m * sizeof *t->d);
    memcpy(t->e, t->off, (size_t)m * sizeof *t->e);
    fenv_t traps; /* LAPACK tries out at first whether the processor has infinities and NaN */
    (void)feholdexcept(&traps);
    const lapack_int info = LAPACKE_dstevr(LAPACK_COL_MAJOR, 'V', 'I', m, t->d, t->e, 0.0, 0.0, m,
                                           m, 0.0, &count, t->w, t->z, m, support);
    (void)fesetenv(&traps);
    if (info == 0 && count == 1)
      found[0] = t->w[0], found[1] = t->z[m - 1];
    else
      status = mpsi_fail(
          dynamics->context, FUNCTION,
          info == LAPACK_WORK_MEMORY_ERROR ? MPS_ERROR_MEMORY : MPS_ERROR_NUMERIC,
          "LAPACK %s the tridiagonal eigenproblem of %d rows",
          info == LAPACK_WORK_MEMORY_ERROR ? "was refused the memory for" : "could not solve", m);
  }
  status = mpsi_domain_agree_max(dynamics->domain, FUNCTION, status, 2, found);
  *value = found[0], *last = found[1];
  return status;
}

static mps_status lanczos(operator_data *op, double bound, double *basis, ritz *out) {
  const int64_t n = 3 * op->dynamics->count;
  double *v = basis, *before = basis + n, *next = basis + 2 * n;
  double value = 0.0, last = 0.0, norm, a = 0.0;
  start_vector(op->dynamics, v);
  mps_status status = dot(op->dynamics, v, v, &norm);
  norm = sqrt(norm);
  *out = (ritz){0.0, 0.0, 0};
  if (norm == 0.0 || status != MPS_OK) return status; /* 0: everything is held */
  for (int64_t k = 0; k < n; k++) v[k] /= norm, before[k] = 0.0;
  norm = 0.0;
  for (int m = 1; m <= LANCZOS_MOST; m++) {
    status = apply(op, v, next);
    if (status == MPS_OK) status = dot(op->dynamics, v, next, &a);
    if (status != MPS_OK) return status;
    for (int64_t k = 0; k < n; k++) next[k] -= a * v[k] + norm * before[k];
    op->of->diagonal[m - 1] = a;
    status = dot(op->dynamics, next, next, &norm);
    if (status != MPS_OK) return status;
    norm = op->of->off[m - 1] = sqrt(norm);
    const bool stuck = !(norm > 1e-14 * fabs(a));
    if (m % LANCZOS_EVERY == 0 || stuck || m == LANCZOS_MOST) {
      const double former = value;
      status = highest(op->dynamics, m, op->of, &value, &last);
      if (status != MPS_OK) return status;
      *out = (ritz){value, fabs(norm * last), m};
      if (stuck || out->error <= bound * value || value - former <= 1e-3 * bound * value)
        return MPS_OK;
    }
    double *spare = before;
    before = v;
    v = next;
    next = spare;
    for (int64_t k = 0; k < n; k++) v[k] /= norm;
  }
  return MPS_OK;
}

/* ---- limits ---------------------------------------------------------------------------------- */

typedef mpsi_dynamics_extremes range; /* of damping */

/* dt at which lambda_max of the damped operator is 4. lambda grows with dt at least like dt and at
 * most like dt^2, which brackets the root after each round; a secant in logarithms finds it. */
static mps_status uneven_limit(operator_data *op, double *basis, const range *r, double omega2,
                               double *dt, int64_t *iterations) {
  double low = mpsi_dynamics_damped_limit(omega2, r->alpha[1], r->beta[1]);
  double high = mpsi_dynamics_damped_limit(omega2, r->alpha[0], r->beta[0]);
  double power = 0.75, last_dt = 0.0, last_value = 0.0;
  op->dt = low;
  for (int round = 0; round < 20; round++) {
    ritz top;
    MPSI_TRY(lanczos(op, UNEVEN_BOUND, basis, &top));
    *iterations += top.iterations;
    const double ratio = 4.0 / top.value;
    if (round > 0 && top.value != last_value)
      power = fmin(1.0, fmax(0.5, log(op->dt / last_dt) / log(top.value / last_value)));
    last_dt = op->dt;
    last_value = top.value;
    low = fmax(low, op->dt * (ratio > 1.0 ? sqrt(ratio) : ratio));
    high = fmin(high, op->dt * (ratio > 1.0 ? ratio : sqrt(ratio)));
    if (high - low <= UNEVEN_BOUND * high) break;
    op->dt = fmin(high, fmax(low, op->dt * pow(ratio, power)));
  }
  *dt = low * (1.0 - UNEVEN_BOUND); /* never above the limit */
  op->dt = 0.0;
  return MPS_OK;
}

/* Are all roots of z^3 + a2 z^2 + a1 z + a0 inside the unit circle (Jury)? */
static bool inside_unit_circle(double a2, double a1, double a0) {
  return fabs(a0) < 1.0 && 1.0 + a2 + a1 + a0 > 0.0 && 1.0 - a2 + a1 - a0 > 0.0 &&
         fabs(a0 * a0 - 1.0) > fabs(a0 * a2 - a1);
}

/* Euler's amplification of a mode stays below `growth` a step. With r_k = z^k its scheme reads
 * z (z-1)^2 + alpha dt z (z-1) + w^2 dt^2 z + beta dt w^2 (z-1) = 0. */
static bool euler_stable(double dt, double omega2, double alpha, double beta, double growth) {
  const double a2 = -2.0 + alpha * dt, a0 = -beta * dt * omega2;
  const double a1 = 1.0 - alpha * dt + omega2 * dt * dt + beta * dt * omega2;
  return inside_unit_circle(a2 / growth, a1 / (growth * growth), a0 / (growth * growth * growth));
}

/* All frequencies up to the highest, for the least and the most damped particle. */
static bool euler_all_stable(double dt, double omega2, const range *r, double duration) {
  const double growth = duration > 0.0 ? exp(log(1e15) * fmin(dt / duration, 1.0)) : 1.0;
  for (int which = 0; which < 2; which++)
    for (int k = 0; k <= 400; k++)
      if (!euler_stable(dt, omega2 * pow(10.0, -k / 40.0), r->alpha[which], r->beta[which], growth))
        return false;
  return true;
}

static double euler_limit(double omega2, const range *r, double duration) {
  double unstable = 4.0 / sqrt(omega2), stable = unstable;
  while (!euler_all_stable(stable, omega2, r, duration)) {
    unstable = stable;
    stable *= 0.8;
    if (stable * sqrt(omega2) < 1e-9) return 0.0;
  }
  if (stable == unstable) return stable;
  while (unstable - stable > 1e-9 * stable) {
    const double middle = 0.5 * (stable + unstable);
    if (euler_all_stable(middle, omega2, r, duration))
      stable = middle;
    else
      unstable = middle;
  }
  return stable;
}

/* Doubles of memory: three Lanczos vectors and a scaled one of 3 n each, 4 m of work for the
 * tangent, weights; m is n with ghosts. Then the tridiagonal matrix. */
static int64_t memory_size(const mps_dynamics *dynamics) {
  return 12 * dynamics->count + 5 * (dynamics->count + dynamics->ghosts) +
         (int64_t)(sizeof(tridiagonal) / sizeof(double));
}

static mps_status find_limit(mps_dynamics *dynamics, double duration, double *memory,
                             mps_dynamics_linear_limit *out) {
  const int64_t n = 3 * dynamics->count;
  operator_data op = {
      .dynamics = dynamics,
      .scaled = memory + 3 * n,
      .work = memory + 4 * n,
      .weight = memory + 4 * n + 4 * (dynamics->count + dynamics->ghosts),
      .of = (tridiagonal *)(memory + 4 * n + 5 * (dynamics->count + dynamics->ghosts))};
  ritz top;
  MPSI_TRY(lanczos(&op, LANCZOS_BOUND, memory, &top));
  const range r = dynamics->extremes;
  *out = (mps_dynamics_linear_limit){.dt = INFINITY, .iterations = top.iterations};
  if (!(top.value > 0.0)) { /* no forces: only alpha is left */
    if (r.alpha[1] > 0.0) out->dt = 2.0 / r.alpha[1];
    return MPS_OK;
  }
  out->omega = sqrt(top.value);
  out->residual = top.error / top.value;
  if (dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER)
    out->dt = euler_limit(top.value, &r, duration);
  else if (r.beta[0] == r.beta[1])
    out->dt = mpsi_dynamics_damped_limit(top.value, r.alpha[0], r.beta[0]);
  else
    return uneven_limit(&op, memory, &r, top.value, &out->dt, &out->iterations);
  return MPS_OK;
}

mps_status mps_dynamics_find_limit_sized(mps_dynamics *dynamics, double duration,
                                         mps_dynamics_linear_limit *out, size_t size) {
  static const char *const function = FUNCTION;
  if (!dynamics) return mpsi_null(__func__, "dynamics");
  mps_context *context = dynamics->context;
  if (!isfinite(duration) || duration < 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "duration is %g s, must be finite and >= 0", duration);
  const bool plain = duration == 0.0 || dynamics->def.integrator != MPS_DYNAMICS_INTEGRATOR_EULER;
  mps_dynamics_linear_limit limit = dynamics->limit;
  if (!plain || !dynamics->have_limit) {
    double *memory = mpsi_alloc(context, memory_size(dynamics), sizeof *memory);
    mps_status status = memory ? MPS_OK
                               : mpsi_fail_memory(context, function,
                                                  (size_t)memory_size(dynamics) * sizeof *memory);
    status = mpsi_domain_agree(dynamics->domain, function, status);
    if (status == MPS_OK) status = find_limit(dynamics, duration, memory, &limit);
    mpsi_free(context, memory);
    if (status != MPS_OK) return status;
  }
  if (plain) {
    dynamics->limit = limit;
    dynamics->have_limit = true;
  }
  return mpsi_out_write(context, function, out, size, &limit, sizeof limit);
}

double mpsi_dynamics_lattice_bound(const mps_dynamics *dynamics) {
  const mpsi_dynamics_extremes *e = &dynamics->extremes;
  const double omega2 = mpsi_dynamics_lattice_omega2(
      dynamics->kernel, dynamics->spacing, dynamics->def.radius_ratio, sqrt(e->mu / e->lightest),
      sqrt((e->lambda + 2.0 * e->mu) / e->lightest), dynamics->torque);
  /* Where neighbours are missing shear is softer, and pressure can be stiffer: up to 1.13 times
   * omega over all shapes examined, and only where the highest mode is not that of the spin. */
  return (e->lambda <= 7.0 * e->mu ? 0.95 : 0.8) *
         mpsi_dynamics_damped_limit(omega2, e->alpha[1], e->beta[1]);
}

double mpsi_dynamics_limit(const void *solver) {
  const mps_dynamics *dynamics = solver;
  if (dynamics->have_limit) return dynamics->limit.dt;
  if (dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER) return 0.0;
  return dynamics->lattice ? mpsi_dynamics_lattice_bound(dynamics) : NAN;
}
