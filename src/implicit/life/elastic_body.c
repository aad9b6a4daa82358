/* elastic_body.c - the body of a solver: its material, its cuts, and derived data.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_body.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/body/window.h"

#include "material/material_internal.h"

#include <float.h>
#include <string.h>

#define MOST_CONTRAST 1e8 /* of Young's moduli in a body, without a warning */

/* ---- material and cuts ----------------------------------------------------------------------- */

/* Writes `young` and `poisson` of `count` particles, or of all (0, NULL). */
static mps_status write_material(mps_elastic *e, const char *function, const mps_material *material,
                                 int64_t count, const int64_t *ids) {
  mps_moduli m = {0};
  mps_status status = mpsi_as(e->context, function, mps_material_get_moduli(material, 1.0, &m));
  double *young = mpsi_particles_column(e->particles, "young", 0);
  double *poisson = mpsi_particles_column(e->particles, "poisson", 0);
  if (status != MPS_OK || !young || !poisson) return status;
  const int64_t most = ids ? count : mps_particles_count(e->particles);
  for (int64_t k = 0; k < most; k++) {
    const int64_t at = ids ? mps_particles_index(e->particles, ids[k]) : k;
    young[at] = m.young, poisson[at] = m.poisson;
  }
  return MPS_OK;
}

/* The definition's material, at creation. */
mps_status mpsi_elastic_add_material(mps_elastic *e, const char *function) {
  mps_status status = mpsi_material_check_elastic(e->context, function, e->def.material);
  if (status == MPS_OK)
    status = mpsi_as(e->context, function, mps_particles_add_field(e->particles, "young", 0));
  if (status == MPS_OK)
    status = mpsi_as(e->context, function, mps_particles_add_field(e->particles, "poisson", 0));
  return status == MPS_OK ? write_material(e, function, e->def.material, 0, NULL) : status;
}

static mps_status check_moduli(mps_elastic *e, const char *function, int64_t i, double young,
                               double poisson) {
  const double least = !e->conservative ? 0.0 : -0.99;
  if (!(young >= MPSI_ELASTIC_LEAST && young <= MPSI_ELASTIC_MOST))
    return mpsi_elastic_bad_value(e, function, "young", i, young, "allowed is 1e-30 to 1e30 (Pa)");
  if (poisson >= least && poisson < 0.5) return MPS_OK;
  return mpsi_elastic_bad_value(e, function, "poisson", i, poisson,
                                least < 0.0
                                    ? "must be at least -0.99 and below 0.5"
                                    : "must be at least 0 and below 0.5 (published method)");
}

mps_status mpsi_elastic_set_moduli(mps_elastic *e, const char *function, int64_t i, double young,
                                   double poisson) {
  const mps_status status = check_moduli(e, function, i, young, poisson);
  if (status != MPS_OK) return status;
  const double two_mu = young / (1.0 + poisson);
  const bool plane_stress = e->dim == 2 && e->def.state == MPS_ELASTIC_STATE_PLANE_STRESS;
  e->mu[i] = 0.5 * two_mu;
  e->lambda[i] = two_mu * poisson / (plane_stress ? 1.0 - poisson : 1.0 - 2.0 * poisson);
  e->poisson[i] = poisson;
  return MPS_OK;
}

/* lambda and mu of every particle; nothing has changed on an error. */
static mps_status read_material(mps_elastic *e, const char *function) {
  double *young = mpsi_alloc(e->context, 2 * e->n, sizeof *young);
  if (!young) return mpsi_fail_memory(e->context, function, (size_t)(2 * e->n) * sizeof *young);
  double *poisson = young + e->n;
  mps_status status = mpsi_elastic_read(e, function, "young", young, 1);
  if (status == MPS_OK) status = mpsi_elastic_read(e, function, "poisson", poisson, 1);
  for (int64_t i = 0; i < e->n && status == MPS_OK; i++)
    status = check_moduli(e, function, i, young[i], poisson[i]);
  for (int64_t i = 0; i < e->n && status == MPS_OK; i++)
    status = mpsi_elastic_set_moduli(e, function, i, young[i], poisson[i]);
  mpsi_free(e->context, young);
  return status;
}

/* The equations of a soft body with hard inclusions are solved to the rounding of the hard ones'
 * forces: the remaining digits of the soft body. The energy that this adds is `scheme`. */
static void warn_of_contrast(const mps_elastic *e) {
  double least = INFINITY, most = 0.0;
  for (int64_t i = 0; i < e->n; i++) {
    const double young = 2.0 * e->mu[i] * (1.0 + e->poisson[i]);
    least = fmin(least, young), most = fmax(most, young);
  }
  if (!(most > MOST_CONTRAST * (1.0 + 1e-9) * least)) return; /* rounding */
  mpsi_log(
      e->context, MPS_CONTEXT_LOG_WARNING,
      "Young's modulus is %g to %g Pa in one body, a contrast of %.3g: above %g rounding "
      "may add energies of %.1g of the largest term of the budget; particles that are to be rigid "
      "can be held by a boundary, or be 1e4 times as stiff as the others",
      least, most, most / least, MOST_CONTRAST, 1e-14 * most / least);
}

/* Data derived from the fields `young` and `poisson`; on an error nothing has changed. */
static mps_status renew_material(mps_elastic *e, const char *function) {
  const size_t bytes = (size_t)e->n * sizeof(double);
  double *const moduli[3] = {e->lambda, e->mu, e->poisson};
  double *former = mpsi_alloc(e->context, 3 * e->n, sizeof *former);
  if (!former) return mpsi_fail_memory(e->context, function, 3 * bytes);
  for (int k = 0; k < 3; k++) memcpy(former + k * e->n, moduli[k], bytes);
  mps_status status = mpsi_elastic_note_strain(e, function);
  if (status == MPS_OK) status = mpsi_fail_of(e->context, read_material(e, function), "e");
  if (status == MPS_OK) status = mpsi_elastic_find_joints(e, function);
  if (status == MPS_OK) mpsi_elastic_measure(e);
  if (status == MPS_OK) warn_of_contrast(e);
  for (int k = 0; k < 3 && status != MPS_OK; k++) memcpy(moduli[k], former + k * e->n, bytes);
  mpsi_free(e->context, former);
  return status;
}

mps_status mps_elastic_update_material(mps_elastic *e) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  return mpsi_elastic_leave(e, renew_material(e, __func__));
}

mps_status mps_elastic_set_material(mps_elastic *e, const mps_material *material, int64_t count,
                                    const int64_t *ids) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_material_give(&given, material);
  mpsi_give(&given, "count", (double)count);
  mpsi_give_bytes(&given, "a hash of ids", count > 0 ? ids : NULL, (size_t)count * sizeof *ids);
  double *former = mpsi_alloc(e->context, 2 * e->n, sizeof *former);
  if (!former) status = mpsi_fail_memory(e->context, __func__, (size_t)e->n * 16);
  status = mpsi_elastic_agree_given(e, __func__, status, &given);
  if (status == MPS_OK) status = mpsi_material_check_elastic(e->context, __func__, material);
  if (status == MPS_OK)
    status = mpsi_particles_check_ids_or_all(e->particles, __func__, count, ids);
  if (status == MPS_OK) status = mpsi_elastic_read(e, __func__, "young", former, 1);
  if (status == MPS_OK) status = mpsi_elastic_read(e, __func__, "poisson", former + e->n, 1);
  if (status == MPS_OK) {
    status = write_material(e, __func__, material, count, ids);
    if (status == MPS_OK) status = renew_material(e, __func__);
    for (int k = 0; k < 2 && status != MPS_OK; k++) { /* the fields exist: it cannot fail */
      const mps_status back =
          mpsi_elastic_write(e, __func__, k ? "poisson" : "young", former + k * e->n, 1);
      (void)back;
    }
  }
  mpsi_free(e->context, former);
  return mpsi_elastic_leave(e, status);
}

/* Can the surface pass through these particles? */
static mps_status check_cut(const mps_elastic *e, const char *function, int32_t axis, int32_t side,
                            int64_t count, const int64_t *ids) {
  if (axis < 0 || axis >= e->dim || (side != -1 && side != 1))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "axis is %d and side %d, allowed are 0..%d and -1 or 1", axis, side,
                     e->dim - 1);
  if (count < 0 || (count > 0 && !ids))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld (must be >= 0) or ids is NULL", (long long)count);
  for (int64_t i = 0; i < count; i++) {
    const int64_t found = mpsi_elastic_find(e, ids[i]);
    if (found < 0)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)i,
                       (long long)ids[i]);
    if (e->faces[found] >> (2 * axis + (side > 0)) & 1)
      return mpsi_fail(e->context, function, MPS_ERROR_STATE,
                       "particle %lld has a neighbour on side %d of %c: no surface can pass "
                       "through it there",
                       (long long)ids[i], side, "xyz"[axis]);
  }
  return MPS_OK;
}

mps_status mps_elastic_cut(mps_elastic *e, int32_t axis, int32_t side, int64_t count,
                           const int64_t *ids) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "axis", axis);
  mpsi_give(&given, "side", side);
  mpsi_give(&given, "count", (double)count);
  mpsi_give_bytes(&given, "a hash of ids", count > 0 ? ids : NULL, (size_t)count * sizeof *ids);
  status = check_cut(e, __func__, axis, side, count, ids);
  status = mpsi_elastic_leave(e, mpsi_elastic_agree_given(e, __func__, status, &given));
  if (status != MPS_OK) return status;
  mpsi_elastic_end_motion(e); /* the masses of its cells have changed */
  for (int64_t k = 0; k < count; k++) {
    const int64_t i = mpsi_elastic_find(e, ids[k]);
    const uint8_t bit = (uint8_t)(1 << (2 * axis + (side > 0)));
    if (e->mass && !(e->cut[i] & bit)) e->mass[i] *= 0.5;
    e->cut[i] |= bit;
  }
  mpsi_elastic_measure(e);
  return MPS_OK;
}

/* ---- its arrays ---- */

mps_status mpsi_elastic_allocate(mps_elastic *e, const char *function) {
  const int64_t n = e->n, all = n * e->dim;
  const struct {
    void **array;
    int64_t count;
    size_t size;
  } arrays[] = {
      {(void **)&e->id, n, sizeof(int64_t)},
      {(void **)&e->x, all, sizeof(double)},
      {(void **)&e->faces, n, sizeof(uint8_t)},
      {(void **)&e->cut, n, sizeof(uint8_t)},
      {(void **)&e->volume, n, sizeof(double)},
      {(void **)&e->lambda, n, sizeof(double)},
      {(void **)&e->mu, n, sizeof(double)},
      {(void **)&e->poisson, n, sizeof(double)},
      {(void **)&e->support_of, n, sizeof(int64_t)},
      {(void **)&e->load, all, sizeof(double)},
      {(void **)&e->displacement, all, sizeof(double)},
      {(void **)&e->reaction, all, sizeof(double)},
      {(void **)&e->work, all, sizeof(double)},
      {(void **)&e->dof, all, sizeof(int64_t)},
  };
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) {
    *arrays[k].array = mpsi_alloc(e->context, arrays[k].count, arrays[k].size);
    if (!*arrays[k].array)
      return mpsi_fail_memory(e->context, function, (size_t)arrays[k].count * arrays[k].size);
  }
  for (int64_t i = 0; i < n; i++) e->support_of[i] = -1;
  return MPS_OK;
}

void mpsi_elastic_free_body(mps_elastic *e) {
  mps_context *context = e->context;
  mpsi_cholesky_destroy(&e->cholesky);
  mpsi_elastic_disconnect(e);
  mpsi_elastic_drop_joints(e);
  void *arrays[] = {
      e->id,      e->x,       e->cut,      e->volume,       e->lambda,  e->mu,
      e->poisson, e->facets,  e->load,     e->reaction,     e->work,    e->dof,
      e->faces,   e->column,  e->row,      e->value,        e->rhs,     e->solution,
      e->mass,    e->cg_work, e->supports, e->displacement, e->bending, e->support_of};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) mpsi_free(context, arrays[k]);
}

mps_status mpsi_elastic_make_body(mps_elastic *e, const char *function, bool moduli_known) {
  mps_status status = mpsi_elastic_connect(e, function);
  if (status == MPS_OK && !moduli_known) status = read_material(e, function);
  if (status == MPS_OK) status = mpsi_elastic_find_joints(e, function);
  if (status == MPS_OK) status = mpsi_elastic_find_facets(e, function);
  if (status == MPS_OK) mpsi_elastic_measure(e);
  if (status == MPS_OK && !moduli_known) warn_of_contrast(e);
  return status;
}
