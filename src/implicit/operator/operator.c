/* operator.c - the stiffness operator f = K u, without a matrix. Both discretisations are one
 * energy,
 *
 *   Pi = sum_i V_i W(G_i) + 1/2 sum_{i<j} (kappa_i + kappa_j) w/r^2 |e_ij|^2
 *
 * conservative: G_i from shared cell faces (central where both face neighbours exist, one sided at
 *   surfaces), W = mu eps:eps + lambda/2 (tr eps)^2, e_ij = u_j - u_i - (G_i + G_j)/2 (x_j - x_i),
 *   kappa = 2 alpha mu d V / n_i;
 *   joints.c has the face values between two materials, bending.c a third sum, of bending within
 *   cells;
 * published: G_i = (d/n*) sum_j (u_j - u_i) (x) t w/r, so that (7) R = curl and (8) D = trace,
 *   W = n*_i/n0 (lambda/2 D^2 - mu/2 R^2), e_ij = u_j - u_i, kappa = 2 mu d V / n0: Chikazawa (10)
 *   with R and D eliminated, corrected as docs/verification/implicit-elastic.md says.
 *
 * For the forces on its own particles a rank of a shared body needs stresses with joints of one
 * layer around them, stresses without joints of two layers, and the gradients of the pairs of
 * these; joints there need one layer more.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "operator.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/body/bending.h"
#include "implicit/body/gradient.h"

typedef struct operator_task {
  mps_elastic *e;
  const double *u;
  double *gradient, *stress, *f;
} operator_task;

/* ---- pairs ----------------------------------------------------------------------------------- */

static void stretch(const mps_elastic *e, const double *u, const double *gradient, int64_t i,
                    int32_t k, double *out) {
  const mpsi_links *l = &e->links;
  const int d = e->dim;
  const int64_t j = mpsi_elastic_neighbours(e, i)[k];
  for (int c = 0; c < d; c++) out[c] = u[j * d + c] - u[i * d + c];
  if (!e->conservative) return;
  const double *gi = gradient + mpsi_elastic_slot(e, i) * d * d;
  const double *gj = gradient + mpsi_elastic_slot(e, j) * d * d;
  for (int c = 0; c < d; c++)
    for (int b = 0; b < d; b++)
      out[c] -= 0.5 * (gi[c * d + b] + gj[c * d + b]) * e->spacing * l->step[k][b];
}

void mpsi_elastic_stretch(const mps_elastic *e, const double *u, int64_t i, int32_t k,
                          double *out) {
  stretch(e, u, e->gradient, i, k, out);
}

/* ---- forces ---------------------------------------------------------------------------------- */

/* dPi/dG_i of the first sum, times V_i. */
static void local_stress(const mps_elastic *e, int64_t i, const double *G, double *P) {
  const int d = e->dim;
  double trace = 0.0;
  for (int c = 0; c < d; c++) trace += G[c * d + c];
  if (!e->conservative) {
    const double v = e->volume[i] * mpsi_elastic_divisor(e, i) / e->density0;
    const double rotation = G[2] - G[1];
    P[0] = P[3] = v * e->lambda[i] * trace;
    P[2] = -v * e->mu[i] * rotation;
    P[1] = -P[2];
    return;
  }
  for (int c = 0; c < d; c++)
    for (int b = 0; b < d; b++)
      P[c * d + b] = e->volume[i] * (e->mu[i] * (G[c * d + b] + G[b * d + c]) +
                                     (b == c ? e->lambda[i] * trace : 0.0));
}

/* P_i = dPi/dG_i, pairs included, and the part of f_i that comes from u_i in pairs. */
static void stress_at(void *task, int64_t i) {
  const operator_task *t = task;
  const mps_elastic *e = t->e;
  const mpsi_links *l = &e->links;
  const int d = e->dim;
  const bool moment = e->conservative;
  const int64_t slot = mpsi_elastic_slot(e, i), *to = mpsi_elastic_neighbours(e, i);
  double *P = t->stress + slot * d * d, *f = t->f + i * d;
  local_stress(e, i, t->gradient + slot * d * d, P);
  for (int c = 0; c < d; c++) f[c] = 0.0;
  mpsi_elastic_bending_force(e, t->u, i, f);
  for (int32_t k = 0; k < l->count; k++) {
    const int64_t j = to[k];
    if (j < 0) continue;
    double pull[3];
    const double s = mpsi_elastic_bond(e, i, j, k);
    stretch(e, t->u, t->gradient, i, k, pull);
    for (int c = 0; c < d; c++) {
      pull[c] *= s;
      f[c] -= pull[c];
      for (int b = 0; moment && b < d; b++)
        P[c * d + b] -= 0.5 * pull[c] * e->spacing * l->step[k][b];
    }
  }
}

/* f_p += sum over the gradients of which p is a site: gathered, so that the order is fixed. */
static void force_at(void *task, int64_t p) {
  const operator_task *t = task;
  const mps_elastic *e = t->e;
  const mpsi_links *l = &e->links;
  const int d = e->dim;
  int64_t sites[MPSI_STENCIL_MAX];
  const int64_t *to = mpsi_elastic_neighbours(e, p);
  const double *own = t->stress + mpsi_elastic_slot(e, p) * d * d;
  double g[MPSI_STENCIL_MAX][3], *f = t->f + p * d;
  /* The neighbours whose gradients use p are the sites of p's own; p sits opposite there. */
  const int32_t m = mpsi_elastic_stencil(e, p, sites, g);
  for (int c = 0; c < d; c++)
    for (int b = 0; b < d; b++) f[c] += own[c * d + b] * g[0][b];
  const bool conservative = e->conservative;
  for (int32_t a = 0, used = 1; used < m; a++) {
    const int32_t k = conservative ? l->face[a / 2][a % 2] : a;
    const int64_t j = to[k];
    if (j < 0) continue;
    const double *P = t->stress + mpsi_elastic_slot(e, j) * d * d;
    double back[3];
    used++;
    mpsi_elastic_coefficient(e, j, l->count - 1 - k, back);
    for (int c = 0; c < d; c++)
      for (int b = 0; b < d; b++) f[c] += P[c * d + b] * back[b];
  }
}

mps_status mpsi_elastic_apply(mps_elastic *e, const char *function, const double *u, double *f) {
  operator_task task = {.e = e, .u = u, .gradient = e->gradient, .stress = e->stress_work, .f = f};
  mpsi_elastic_gradients(e, u, e->gradient);
  mpsi_elastic_for_span(e, e->span[2], stress_at, &task);
  mpsi_elastic_joint_forces(e, e->stress_work, f);
  mpsi_elastic_for_span(e, e->span[0], force_at, &task);
  return mpsi_elastic_complete(e, function, f);
}
