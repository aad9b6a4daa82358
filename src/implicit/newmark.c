/* newmark.c - motion of the structure: Newmark's method on M a + K u = F with the static solver's
 * operator and lumped mass.
 *
 *   u* = u + dt v + (1/2 - beta) dt^2 a,  v* = v + (1 - gamma) dt a
 *   (K + M / (beta dt^2)) w = F - K u*,   u' = u* + w,  a' = w / (beta dt^2),  v' = v* + gamma dt
 * a'
 *
 * Unknown is the correction w, so that a structure at rest stays exactly at rest and the static
 * solution is a fixed point. beta = 1/4, gamma = 1/2 conserves u.K u/2 + v.M v/2 without loads.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "defs.h"
#include "elastic_private.h"

#include <string.h>

typedef struct mpsi_motion {
  mps_newmark_def def;
  int64_t steps;
  double *velocity, *acceleration; /* n * dim */
} mpsi_motion;

void mpsi_elastic_end_motion(mps_elastic *e) {
  if (!e->motion) return;
  mpsi_free(e->context, e->motion->velocity);
  mpsi_free(e->context, e->motion->acceleration);
  mpsi_free(e->context, e->motion);
  e->motion = NULL;
}

static mps_status check_def(mps_context *context, const char *function,
                            const mps_newmark_def *def) {
  if (!(def->dt > 0.0 && isfinite(def->dt)))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "dt is %g s, must be finite and > 0",
                     def->dt);
  const double g = def->gamma, least = 0.25 * (g + 0.5) * (g + 0.5);
  if (!(g >= 0.5 && g <= 1.0 && def->beta >= least * (1.0 - 1e-12) && def->beta <= 10.0))
    return mpsi_fail(
        context, function, MPS_ERROR_ARGUMENT,
        "gamma is %g, must be in [0.5, 1]; beta is %g, must be in [(gamma + 1/2)^2 / 4, "
        "10] for an unconditionally stable step",
        g, def->beta);
  return MPS_OK;
}

/* a = M^-1 (F - K u) on what is free; prescribed particles rest. */
static void balance(mps_elastic *e, double *acceleration) {
  const int64_t all = e->n * e->dim;
  mpsi_elastic_apply(e, e->displacement, e->work);
  for (int64_t k = 0; k < all; k++) e->work[k] = e->load[k] - e->work[k];
  mpsi_elastic_reduce(e, e->work, e->rhs);
  memset(acceleration, 0, (size_t)all * sizeof *acceleration);
  mpsi_elastic_expand(e, e->rhs, false, acceleration);
  for (int64_t k = 0; k < all; k++) acceleration[k] /= e->mass[k / e->dim];
}

/* The field if the set has it, else zero. */
static mps_status read_or_zero(mps_elastic *e, const char *function, const char *name,
                               double *values) {
  mps_view view;
  if (mps_particles_view(e->particles, name, &view) == MPS_OK)
    return mpsi_elastic_read(e, function, name, values, e->dim);
  memset(values, 0, (size_t)(e->n * e->dim) * sizeof *values);
  return MPS_OK;
}

/* Free components from `values`, fixed ones as prescribed. */
static void impose(mps_elastic *e, bool prescribed, double *values) {
  mpsi_elastic_reduce(e, values, e->rhs);
  memset(values, 0, (size_t)(e->n * e->dim) * sizeof *values);
  mpsi_elastic_expand(e, e->rhs, prescribed, values);
}

mps_status mps_elastic_start(mps_elastic *e, const mps_newmark_def *user_def) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_newmark_def def = mpsi_newmark_defaults;
  mps_status status = MPSI_DEF_READ(e->context, __func__, mps_newmark_def, user_def, &def);
  if (status == MPS_OK) status = check_def(e->context, __func__, &def);
  if (status == MPS_OK) status = mpsi_elastic_read_mass(e, __func__);
  if (status == MPS_OK) status = mpsi_elastic_prepare(e, __func__);
  if (status == MPS_OK)
    status = mpsi_elastic_factor(e, __func__, 1.0 / (def.beta * def.dt * def.dt));
  for (int a = 0; a < 2 && status == MPS_OK; a++)
    status = mps_particles_add_field(e->particles, a ? "acceleration" : "velocity", 0);
  if (status != MPS_OK) return status;
  mpsi_elastic_end_motion(e);
  const int64_t all = e->n * e->dim;
  mpsi_motion *m = mpsi_alloc(e->context, 1, sizeof *m);
  if (!m) return mpsi_fail_memory(e->context, __func__, sizeof *m);
  e->motion = m;
  m->def = def;
  if (!(m->velocity = mpsi_alloc(e->context, all, sizeof(double))) ||
      !(m->acceleration = mpsi_alloc(e->context, all, sizeof(double)))) {
    mpsi_elastic_end_motion(e);
    return mpsi_fail_memory(e->context, __func__, (size_t)all * sizeof(double));
  }
  status = read_or_zero(e, __func__, "displacement", e->displacement);
  if (status == MPS_OK) status = read_or_zero(e, __func__, "velocity", m->velocity);
  if (status != MPS_OK) {
    mpsi_elastic_end_motion(e);
    return status;
  }
  impose(e, true, e->displacement);
  impose(e, false, m->velocity);
  balance(e, m->acceleration);
  return MPS_OK;
}

static mps_status step_once(mps_elastic *e, const char *function) {
  mpsi_motion *m = e->motion;
  const int64_t all = e->n * e->dim;
  const double dt = m->def.dt, beta = m->def.beta, gamma = m->def.gamma;
  for (int64_t k = 0; k < all; k++) {
    e->displacement[k] += dt * m->velocity[k] + (0.5 - beta) * dt * dt * m->acceleration[k];
    m->velocity[k] += (1.0 - gamma) * dt * m->acceleration[k];
  }
  impose(e, true, e->displacement);
  impose(e, false, m->velocity); /* of supports added since the start */
  mpsi_elastic_apply(e, e->displacement, e->work);
  for (int64_t k = 0; k < all; k++) e->work[k] = e->load[k] - e->work[k];
  mpsi_elastic_reduce(e, e->work, e->rhs);
  const mps_status status = mpsi_elastic_backsolve(e, function, 1, e->rhs, e->solution);
  if (status != MPS_OK) return status;
  memset(m->acceleration, 0, (size_t)all * sizeof(double));
  mpsi_elastic_expand(e, e->solution, false, m->acceleration);
  for (int64_t k = 0; k < all; k++) {
    e->displacement[k] += m->acceleration[k];
    m->acceleration[k] /= beta * dt * dt;
    m->velocity[k] += gamma * dt * m->acceleration[k];
  }
  m->steps++;
  return MPS_OK;
}

static mps_status publish(mps_elastic *e, const char *function) {
  mpsi_motion *m = e->motion;
  mpsi_elastic_apply(e, e->displacement, e->work);
  for (int64_t k = 0; k < e->n * e->dim; k++) e->reaction[k] = e->work[k] - e->load[k];
  mpsi_elastic_keep_fixed(e, e->reaction);
  mps_status status = mpsi_elastic_write(e, function, "displacement", e->displacement, e->dim);
  if (status == MPS_OK) status = mpsi_elastic_write(e, function, "velocity", m->velocity, e->dim);
  if (status == MPS_OK)
    status = mpsi_elastic_write(e, function, "acceleration", m->acceleration, e->dim);
  if (status == MPS_OK) status = mpsi_elastic_write(e, function, "reaction", e->reaction, e->dim);
  return status;
}

mps_status mps_elastic_step(mps_elastic *e, int64_t count) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (!e->motion)
    return mpsi_fail(e->context, __func__, MPS_ERROR_STATE,
                     "no motion under way: call mps_elastic_start first");
  if (count < 0)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  const mps_newmark_def *def = &e->motion->def;
  mps_status status = mpsi_elastic_prepare(e, __func__);
  if (status == MPS_OK)
    status = mpsi_elastic_factor(e, __func__, 1.0 / (def->beta * def->dt * def->dt));
  for (int64_t k = 0; k < count && status == MPS_OK; k++) {
    status = step_once(e, __func__);
    if (status == MPS_OK && mpsi_cancelled(e->context))
      status = mpsi_fail(e->context, __func__, MPS_ERROR_CANCELLED, "cancelled");
    if (status != MPS_OK) mpsi_fail_where(e->context, e->motion->steps, -1);
  }
  return status == MPS_OK ? publish(e, __func__) : status;
}

double mps_elastic_time(const mps_elastic *e) {
  return e && e->motion ? (double)e->motion->steps * e->motion->def.dt : 0.0;
}

mps_status mps_elastic_kinetic_energy(const mps_elastic *e, double *out) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = 0.0;
  if (!e->motion)
    return mpsi_fail(e->context, __func__, MPS_ERROR_STATE,
                     "no motion under way: call mps_elastic_start first");
  for (int64_t k = 0; k < e->n * e->dim; k++)
    *out += 0.5 * e->mass[k / e->dim] * e->motion->velocity[k] * e->motion->velocity[k];
  return MPS_OK;
}
