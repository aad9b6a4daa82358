/* stress.c - strain and stress at particles, principal values, von Mises stress, section forces,
 * strain energy.
 *
 * conservative: eps = sym G, sigma = lambda tr(eps) + 2 mu eps.
 * published: the virial stress of the pairs, sigma_i = (d/n_i) sum_j w p_ij (x) t_ij with the pair
 *   vector p_ij of Chikazawa (10), symmetric part.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/implicit_solver.h"
#include "implicit/body/gradient.h"
#include "implicit/operator/operator.h"

#include "core/base/symmetric.h"

#include <string.h>

/* ---- strain and stress ----------------------------------------------------------------------- */

static void symmetric_part(int d, const double *G, double (*out)[3]) {
  memset(out, 0, 9 * sizeof **out);
  for (int c = 0; c < d; c++)
    for (int b = 0; b < d; b++) out[c][b] = 0.5 * (G[c * d + b] + G[b * d + c]);
}

/* The out-of-plane components of plane stress or strain. */
static void complete_plane(const mps_elastic *e, int64_t i, double (*strain)[3],
                           double (*stress)[3]) {
  if (e->dim == 3) return;
  const double nu = e->poisson[i];
  if (e->def.state == MPS_ELASTIC_STATE_PLANE_STRAIN)
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
  const double *G = e->gradient + mpsi_elastic_slot(e, i) * 4;
  *r = G[2] - G[1];
  *d = G[0] + G[3];
}

static void virial(const mps_elastic *e, int64_t i, double (*stress)[3]) {
  const mpsi_links *l = &e->links;
  memset(stress, 0, 9 * sizeof **stress);
  double ri, di, rj, dj;
  rotation_and_dilatation(e, i, &ri, &di);
  for (int32_t k = 0; k < l->count; k++) {
    const int64_t j = mpsi_elastic_neighbours(e, i)[k];
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
        const double part =
            0.5 * 2.0 / e->density[mpsi_elastic_slot(e, i)] * l->weight[k] * p * t[b];
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

/* Output of a particle: strain, stress, principal stresses, von Mises stress. */
typedef struct table {
  const mps_elastic *e;
  int32_t columns;
  double *column[16];
} table;
#define ROW 18 /* columns of a row, with room to copy them by two or three */

static mps_status open_table(mps_elastic *e, const char *function, table *t) {
  const struct {
    const char *name;
    int32_t columns;
  } fields[] = {{"strain", 2 * e->dim}, {"stress", 2 * e->dim}, {"principal", 3}, {"von_mises", 1}};
  const int32_t before = mps_particles_field_count(e->particles);
  *t = (table){.e = e};
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) {
    const mps_status status =
        mpsi_as(e->context, function, mps_particles_add_field(e->particles, fields[k].name, 0));
    if (status == MPS_OK) continue;
    mpsi_particles_drop_fields(e->particles, before);
    return mpsi_fail(e->context, function, status, "field '%s' cannot be made", fields[k].name);
  }
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
    for (int32_t c = 0; c < fields[k].columns; c++)
      t->column[t->columns++] = mpsi_particles_column(e->particles, fields[k].name, c);
  return MPS_OK;
}

/* Values of columns first, first + 1 ... of particle i. */
static void put_row(const table *t, int64_t i, int32_t first, int32_t count, const double *row) {
  const int64_t at = mps_particles_index(t->e->particles, t->e->id[i]);
  for (int32_t c = 0; c < count && first + c < t->columns; c++) t->column[first + c][at] = row[c];
}

static void find_row(const mps_elastic *e, int64_t i, double *row) {
  double strain[3][3], stress[3][3];
  const int32_t m = 2 * e->dim; /* components */
  symmetric_part(e->dim, e->gradient + mpsi_elastic_slot(e, i) * e->dim * e->dim, strain);
  if (!e->conservative)
    virial(e, i, stress);
  else
    hooke(e, i, (const double(*)[3])strain, stress);
  complete_plane(e, i, strain, stress);
  for (int k = 0; k < m; k++) {
    row[k] = strain[mpsi_symmetric_row[k]][mpsi_symmetric_column[k]];
    row[m + k] = stress[mpsi_symmetric_row[k]][mpsi_symmetric_column[k]];
  }
  principal((const double(*)[3])stress, row + 2 * m);
  row[2 * m + 3] = von_mises(row + 2 * m);
}

/* Each rank computes its own particles and sends them to all ranks, some columns at a time. */
static mps_status share_table(mps_elastic *e, const char *function, mps_status status,
                              const table *t) {
  const int64_t from = e->span[0].from, words = (e->span[0].to - from) * ROW;
  double *own = mpsi_alloc(e->context, words, sizeof *own);
  if (status == MPS_OK && !own)
    status = mpsi_fail_memory(e->context, function, (size_t)words * sizeof *own);
  for (int64_t k = from; status == MPS_OK && k < e->span[0].to; k++)
    find_row(e, e->at[k], own + (k - from) * ROW);
  status = mpsi_elastic_agree(e, function, status);
  for (int32_t c = 0; status == MPS_OK && c < t->columns; c += e->dim) {
    for (int64_t k = from; k < e->span[0].to; k++)
      memcpy(e->work + e->at[k] * e->dim, own + (k - from) * ROW + c, (size_t)e->dim * sizeof *own);
    status = mpsi_elastic_complete(e, function, e->work);
    for (int64_t i = 0; status == MPS_OK && i < e->n; i++)
      put_row(t, i, c, e->dim, e->work + i * e->dim);
  }
  mpsi_free(e->context, own);
  return status;
}

mps_status mps_elastic_update_stress(mps_elastic *e) {
  if (!e) return mpsi_null(__func__, "elastic");
  MPSI_TRY(mpsi_elastic_check_between(e, __func__));
  MPSI_TRY(mpsi_elastic_agree(e, __func__, mpsi_particles_committed(e->particles, __func__)));
  table t;
  const int32_t fields = mps_particles_field_count(e->particles);
  mpsi_elastic_gradients(e, e->displacement, e->gradient);
  mps_status status = open_table(e, __func__, &t);
  if (e->shared) {
    const bool agreed = mpsi_elastic_begin_reading(e);
    status = share_table(e, __func__, status, &t);
    e->agreed = agreed;
    if (status != MPS_OK) mpsi_particles_drop_fields(e->particles, fields);
    return status;
  }
  for (int64_t i = 0; status == MPS_OK && i < e->n; i++) {
    double row[ROW];
    find_row(e, i, row);
    put_row(&t, i, 0, t.columns, row);
  }
  return status;
}

/* ---- sections and energy --------------------------------------------------------------------- */

mps_status mps_elastic_get_section(const mps_elastic *handle, int32_t axis, double position,
                                   const double *about, double *force, double *moment) {
  mps_elastic *e = (mps_elastic *)handle; /* scratch and messages only: the state stays */
  if (!e) return mpsi_null(__func__, "elastic");
  if (axis < 0 || axis >= e->dim)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "axis is %d, allowed are 0 to %d",
                     axis, e->dim - 1);
  if (!isfinite(position))
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "position is %g m, must be finite",
                     position);
  MPSI_TRY(mpsi_elastic_check_about(e, __func__, about));
  MPSI_TRY(mpsi_elastic_check_between(e, __func__));
  const bool agreed = mpsi_elastic_begin_reading(e);
  /* K u is the force of loads and reactions on each particle. Forces on the near side are balanced
   * across the section by minus their sum. */
  mps_status status = mpsi_elastic_apply(e, __func__, e->displacement, e->work);
  e->agreed = agreed;
  if (status != MPS_OK) return status;
  for (int64_t i = 0; i < e->n; i++)
    for (int c = 0; c < e->dim; c++)
      e->work[i * e->dim + c] = e->x[i * e->dim + axis] > position ? 0.0 : -e->work[i * e->dim + c];
  mpsi_elastic_resultant(e, e->work, about, force, moment);
  return MPS_OK;
}
