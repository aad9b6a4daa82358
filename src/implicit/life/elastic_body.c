/* elastic_body.c - the body of a solver: its material, its cuts, and derived data.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_body.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/body/window.h"
#include "implicit/operator/moduli.h"

#include "material/material_internal.h"

#include <string.h>

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

mps_status mps_elastic_set_material(mps_elastic *e, const mps_material *material,
                                    const int64_t *ids, int64_t count) {
  if (!e) return mpsi_null(__func__, "elastic");
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  mpsi_given given = MPSI_GIVEN;
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
    if (status == MPS_OK) status = mpsi_elastic_renew_material(e, __func__);
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
static mps_status check_cut(const mps_elastic *e, const char *function, int32_t side,
                            const int64_t *ids, int64_t count) {
  if (side < 0 || side >= 2 * e->dim)
    return mpsi_fail(
        e->context, function, MPS_ERROR_ARGUMENT, "side is %s, allowed are MPS_SIDE_X_LOWER to %s",
        mpsi_name_of("mps_side", side).text, mpsi_name_of("mps_side", 2 * e->dim - 1).text);
  if (count < 0)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  if (count > 0 && !ids) return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "ids is NULL");
  for (int64_t i = 0; i < count; i++) {
    const int64_t found = mpsi_elastic_find(e, ids[i]);
    if (found < 0)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)i,
                       (long long)ids[i]);
    if (e->faces[found] >> side & 1)
      return mpsi_fail(e->context, function, MPS_ERROR_STATE,
                       "particle %lld has a neighbour on the %s side of %c: no surface can pass "
                       "through it there",
                       (long long)ids[i], side % 2 ? "upper" : "lower", "xyz"[side / 2]);
  }
  return MPS_OK;
}

mps_status mps_elastic_cut(mps_elastic *e, int32_t side, const int64_t *ids, int64_t count) {
  if (!e) return mpsi_null(__func__, "elastic");
  MPSI_TRY(mpsi_elastic_enter(e, __func__));
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "side", side);
  mpsi_give(&given, "count", (double)count);
  mpsi_give_bytes(&given, "a hash of ids", count > 0 ? ids : NULL, (size_t)count * sizeof *ids);
  mps_status status = check_cut(e, __func__, side, ids, count);
  MPSI_TRY(mpsi_elastic_leave(e, mpsi_elastic_agree_given(e, __func__, status, &given)));
  mpsi_elastic_end_motion(e); /* the masses of its cells have changed */
  for (int64_t k = 0; k < count; k++) {
    const int64_t i = mpsi_elastic_find(e, ids[k]);
    const uint8_t bit = (uint8_t)(1 << side);
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
  MPSI_FREE(context, e->id, e->x, e->cut, e->volume, e->lambda, e->mu, e->poisson, e->facets,
            e->load, e->reaction, e->work, e->dof, e->faces, e->column, e->row, e->value, e->rhs,
            e->solution, e->mass, e->cg_work, e->supports, e->displacement, e->bending,
            e->support_of);
}

mps_status mpsi_elastic_make_body(mps_elastic *e, const char *function, bool moduli_known) {
  mps_status status = mpsi_elastic_connect(e, function);
  if (status == MPS_OK && !moduli_known) status = mpsi_elastic_read_material(e, function);
  if (status == MPS_OK) status = mpsi_elastic_find_joints(e, function);
  if (status == MPS_OK) status = mpsi_elastic_find_facets(e, function);
  if (status == MPS_OK) mpsi_elastic_measure(e);
  if (status == MPS_OK && !moduli_known) mpsi_elastic_warn_of_moduli(e);
  return status;
}
