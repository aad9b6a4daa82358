/* budget.c - energies and works (mps/solver.h, mps_totals).
 *
 * In a step from u, v to u', v' the forces do work with the mean of their values before and after
 * it, over du = u' - u. With Newmark's average acceleration, M (a + a')/2 . du is the change of
 * kinetic energy of free components, so that the equations of motion at both ends, times du, are
 * the budget. Prescribed components receive their kinetic energy from their boundary. What the
 * solution of a step leaves of its equations, conjugate gradients up to the tolerance, is a force
 * without an owner, whose work is counted too.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "budget.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/body/fabric.h"
#include "implicit/operator/operator.h"

#include <string.h>

static double kinetic_energy(const mps_elastic *e, const double *v) {
  double sum = 0.0;
  for (int64_t k = 0; k < e->n * e->dim; k++) sum += 0.5 * e->mass[k / e->dim] * v[k] * v[k];
  return sum;
}

mps_status mpsi_elastic_strain_energy(mps_elastic *e, const char *function, double *out) {
  const mps_status status = mpsi_elastic_apply(e, function, e->displacement, e->work);
  *out = 0.0;
  for (int64_t k = 0; k < e->n * e->dim; k++) *out += 0.5 * e->displacement[k] * e->work[k];
  return status;
}

mps_status mpsi_elastic_note_strain(mps_elastic *e, const char *function) {
  mpsi_elastic_motion *m = e->motion;
  int64_t now[2];
  if (!m) return MPS_OK;
  mpsi_elastic_find_fabric(e, now);
  if (now[MPSI_FABRIC_MODULI] != m->fabric[MPSI_FABRIC_MODULI])
    return MPS_OK; /* of the first of several changes */
  const mps_status status = mpsi_elastic_strain_energy(e, function, &m->strain);
  m->strain_known = status == MPS_OK;
  return status;
}

mps_status mpsi_elastic_begin_ledger(mps_elastic *e, const char *function) {
  e->ledger = (mpsi_ledger){.kinetic = kinetic_energy(e, e->motion->velocity)};
  return mpsi_elastic_strain_energy(e, function, &e->ledger.strain);
}

void mpsi_elastic_count_solution(mps_elastic *e) {
  const int64_t all = e->n * e->dim;
  e->ledger = (mpsi_ledger){.loads = 0.0};
  for (int64_t k = 0; k < all; k++) {
    e->ledger.loads += 0.5 * e->load[k] * e->displacement[k];
    e->ledger.left -= 0.5 * (e->work[k] + e->reaction[k]) * e->displacement[k];
    e->work[k] = 0.5 * e->reaction[k];
  }
  mpsi_elastic_forget_reactions(e);
  e->ledger.boundaries = mpsi_elastic_count_work(e, e->work, e->displacement, NULL, NULL);
  mpsi_elastic_count_reactions(e, 0.0);
}

/* Work over `du` of the forces that the equations of motion lack along free directions, mean of
 * both ends of the step: M a + C v + K u - F, which is 0 where they are solved exactly. */
static double work_of_residuals(mps_elastic *e, const double *du, const double *v, const double *a,
                                const double *inner) {
  const mpsi_elastic_motion *m = e->motion;
  double *sum = m->scratch, all = 0.0, fixed = 0.0;
  for (int64_t k = 0; k < e->n * e->dim; k++) {
    const double mass = e->mass[k / e->dim];
    sum[k] = mass * (a[k] + m->acceleration[k]) + m->a0 * mass * (v[k] + m->velocity[k]) +
             inner[k] + m->inner[k] - e->load[k] - m->force[k];
    all += 0.5 * sum[k] * du[k];
  }
  mpsi_elastic_keep_fixed(e, sum);
  for (int64_t k = 0; k < e->n * e->dim; k++) fixed += 0.5 * sum[k] * du[k];
  return all - fixed;
}

void mpsi_elastic_count_step(mps_elastic *e, const double *u, const double *v, const double *a,
                             const double *inner, const double *held) {
  mpsi_elastic_motion *m = e->motion;
  mpsi_ledger *l = &e->ledger;
  double *du = e->work, *mean = m->scratch;
  for (int64_t k = 0; k < e->n * e->dim; k++) {
    du[k] = u[k] - e->displacement[k];
    mean[k] = 0.5 * (held[k] + m->held[k]);
    l->loads += 0.5 * (e->load[k] + m->force[k]) * du[k];
    l->inner += 0.5 * (inner[k] + m->inner[k]) * du[k];
    l->mass_damping += 0.5 * m->a0 * e->mass[k / e->dim] * (v[k] + m->velocity[k]) * du[k];
  }
  l->boundaries += mpsi_elastic_count_work(e, mean, du, m->velocity, v);
  l->left += work_of_residuals(e, du, v, a, inner);
}

static void sum_momenta(const mps_elastic *e, mps_totals *t) {
  for (int64_t i = 0; i < e->n; i++) {
    double x[3] = {0.0, 0.0, 0.0}, p[3] = {0.0, 0.0, 0.0};
    t->volume += e->volume[i];
    if (e->mass) t->mass += e->mass[i];
    for (int c = 0; e->motion && c < e->dim; c++) {
      x[c] = e->x[i * e->dim + c] + e->displacement[i * e->dim + c];
      p[c] = e->mass[i] * e->motion->velocity[i * e->dim + c];
    }
    for (int c = 0; c < 3; c++) {
      const int a = (c + 1) % 3, b = (c + 2) % 3;
      t->linear[c] += p[c];
      t->angular[c] += x[a] * p[b] - x[b] * p[a];
    }
  }
}

mps_status mpsi_elastic_get_totals(void *solver, const char *function, mps_totals *out) {
  mps_elastic *e = solver;
  MPSI_TRY(mpsi_elastic_check_between(e, function));
  const mpsi_elastic_motion *m = e->motion;
  const mpsi_ledger *l = &e->ledger;
  mps_totals t = {.work_loads = l->loads, .work_boundaries = l->boundaries};
  sum_momenta(e, &t);
  const bool agreed = mpsi_elastic_begin_reading(e);
  mps_status status = mpsi_elastic_strain_energy(e, function, &t.strain);
  e->agreed = agreed;
  if (status != MPS_OK) return status;
  t.scheme = t.dissipated = 0.0 - l->left; /* 0, not -0 */
  if (m) {
    t.kinetic = kinetic_energy(e, m->velocity);
    const double kept = mpsi_elastic_former_strain(e, t.strain) - l->strain;
    const double damping = l->mass_damping + (m->a1 > 0.0 ? l->inner - kept : 0.0);
    if (!m->conserving)
      t.scheme = l->loads + l->boundaries - damping - kept - (t.kinetic - l->kinetic);
    t.dissipated = damping + t.scheme;
  }
  *out = t;
  return MPS_OK;
}
