/* stress.c - strain and stress at particles, principal values, von Mises stress, section forces,
 * strain energy.
 *
 * conservative: eps = sym G, sigma = lambda tr(eps) + 2 mu eps.
 * published: the virial stress of the pairs, sigma_i = (d/n_i) sum_j w p_ij (x) t_ij with the pair
 *   vector p_ij of Chikazawa (10), symmetric part.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_private.h"

#include "core/symmetric.h"

#include <string.h>

/* ---- strain and stress ----------------------------------------------------------------------- */

static void symmetric_part(int d, const double *G, double (*out)[3]) {
  memset(out, 0, 9 * sizeof **out);
  for (int c = 0; c < d; c++)
    for (int b = 0; b < d; b++) out[c][b] = 0.5 * (G[c * d + b] + G[b * d + c]);
}

/* The components that plane stress or strain leave out. */
static void complete_plane(const mps_elastic *e, int64_t i, double (*strain)[3],
                           double (*stress)[3]) {
  if (e->dim == 3) return;
  const double nu = e->poisson[i];
  if (e->def.state == MPS_ELASTIC_PLANE_STRAIN)
    stress[2][2] = nu * (stress[0][0] + stress[1][1]);
  else
    strain[2][2] = -nu / (1.0 - nu) * (strain[0][0] + strain[1][1]);
}

static void hooke(const mps_elastic *e, int64_t i, const double (*strain)[3], double (*stress)[3]) {
  double trace = 0.0;
  for (int c = 0; c < e->dim; c++) trace += strain[c][c];
  for (int c = 0; c < 3; c++)
    for (int b = 0; b < 3; b++)
      stress[c][b] =
          2.0 * e->mu[i] * strain[c][b] + (c == b && c < e->dim ? e->lambda[i] * trace : 0.0);
}

/* R and D of particle i from its gradient. */
static void rotation_and_dilatation(const mps_elastic *e, int64_t i, double *r, double *d) {
  const double *G = e->gradient + i * 4;
  *r = G[2] - G[1];
  *d = G[0] + G[3];
}

static void virial(const mps_elastic *e, int64_t i, double (*stress)[3]) {
  const mpsi_links *l = &e->links;
  memset(stress, 0, 9 * sizeof **stress);
  double ri, di, rj, dj;
  rotation_and_dilatation(e, i, &ri, &di);
  for (int32_t k = 0; k < l->count; k++) {
    const int64_t j = l->to[i * l->count + k];
    if (j < 0) continue;
    const double r = sqrt(l->r2[k]), mu = 0.5 * (e->mu[i] + e->mu[j]);
    const double t[2] = {l->step[k][0] * e->spacing / r, l->step[k][1] * e->spacing / r};
    const double s[2] = {-t[1], t[0]};
    rotation_and_dilatation(e, j, &rj, &dj);
    for (int c = 0; c < 2; c++) {
      const double du = e->displacement[j * 2 + c] - e->displacement[i * 2 + c];
      const double p = 2.0 * mu * du / r - 0.5 * (e->mu[i] * ri + e->mu[j] * rj) * s[c] +
                       0.5 * (e->lambda[i] * di + e->lambda[j] * dj) * t[c];
      for (int b = 0; b < 2; b++) {
        const double part = 0.5 * 2.0 / e->density[i] * l->weight[k] * p * t[b];
        stress[c][b] += part;
        stress[b][c] += part;
      }
    }
  }
}

/* ---- principal values ------------------------------------------------------------------------ */

/* Principal values, largest first. */
static void principal(const double (*stress)[3], double *out) {
  mpsi_symmetric_principal(stress, out, NULL);
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < 2; k++)
      if (out[k] < out[k + 1]) {
        const double swap = out[k];
        out[k] = out[k + 1];
        out[k + 1] = swap;
      }
}

static double von_mises(const double *p) {
  const double a = p[0] - p[1], b = p[1] - p[2], c = p[2] - p[0];
  return sqrt(0.5 * (a * a + b * b + c * c));
}

mps_status mps_elastic_stress(mps_elastic *e) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mps_status within = mpsi_elastic_check_between(e, __func__);
  if (within != MPS_OK) return within;
  double *values = mpsi_alloc(e->context, 16 * e->n, sizeof *values);
  if (!values) return mpsi_fail_memory(e->context, __func__, (size_t)(16 * e->n) * sizeof *values);
  double *strains = values, *stresses = values + 6 * e->n, *principals = values + 12 * e->n;
  double *mises = values + 15 * e->n;
  const int32_t m = 2 * e->dim; /* components */
  mpsi_elastic_gradients(e, e->displacement, e->gradient);
  for (int64_t i = 0; i < e->n; i++) {
    double strain[3][3], stress[3][3];
    symmetric_part(e->dim, e->gradient + i * e->dim * e->dim, strain);
    if (!e->conservative)
      virial(e, i, stress);
    else
      hooke(e, i, (const double(*)[3])strain, stress);
    complete_plane(e, i, strain, stress);
    for (int k = 0; k < m; k++) {
      strains[i * m + k] = strain[mpsi_symmetric_row[k]][mpsi_symmetric_column[k]];
      stresses[i * m + k] = stress[mpsi_symmetric_row[k]][mpsi_symmetric_column[k]];
    }
    principal((const double(*)[3])stress, principals + i * 3);
    mises[i] = von_mises(principals + i * 3);
  }
  mps_status status = mpsi_elastic_write(e, __func__, "strain", strains, m);
  if (status == MPS_OK) status = mpsi_elastic_write(e, __func__, "stress", stresses, m);
  if (status == MPS_OK) status = mpsi_elastic_write(e, __func__, "principal", principals, 3);
  if (status == MPS_OK) status = mpsi_elastic_write(e, __func__, "von_mises", mises, 1);
  mpsi_free(e->context, values);
  return status;
}

/* ---- sections and energy --------------------------------------------------------------------- */

mps_status mps_elastic_section(mps_elastic *e, int32_t axis, double position, const double *about,
                               double *force, double *moment) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (axis < 0 || axis >= e->dim || !isfinite(position))
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                     "axis is %d (allowed are 0..%d), position is %g m (must be finite)", axis,
                     e->dim - 1, position);
  const mps_status status = mpsi_elastic_check_between(e, __func__);
  if (status != MPS_OK) return status;
  /* K u is what loads and reactions put on each particle. Those on the near side are balanced
   * across the section by minus their sum. */
  mpsi_elastic_apply(e, e->displacement, e->work);
  for (int64_t i = 0; i < e->n; i++)
    for (int c = 0; c < e->dim; c++)
      e->work[i * e->dim + c] = e->x[i * e->dim + axis] > position ? 0.0 : -e->work[i * e->dim + c];
  mpsi_elastic_resultant(e, e->work, about, force, moment);
  return MPS_OK;
}

mps_status mps_elastic_energy(mps_elastic *e, double *strain, double *stabilising) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mps_status status = mpsi_elastic_check_between(e, __func__);
  if (status != MPS_OK) return status;
  const int64_t all = e->n * e->dim;
  double total = 0.0, pairs = 0.0;
  mpsi_elastic_apply(e, e->displacement, e->work);
  for (int64_t k = 0; k < all; k++) total += 0.5 * e->displacement[k] * e->work[k];
  for (int64_t i = 0; i < e->n; i++)
    for (int32_t k = 0; k < e->links.count; k++) {
      const int64_t j = e->links.to[i * e->links.count + k];
      double pull[3];
      if (j < i) continue;
      mpsi_elastic_stretch(e, e->displacement, i, k, pull);
      for (int c = 0; c < e->dim; c++)
        pairs += 0.5 * mpsi_elastic_bond(e, i, j, k) * pull[c] * pull[c];
    }
  if (strain) *strain = total;
  if (stabilising) *stabilising = e->conservative ? pairs : 0.0;
  return MPS_OK;
}
