/* elastic.c - the solver object: checks of the definition, creation, material, cuts, fields.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "defs.h"
#include "elastic_private.h"

#include "core/particles_internal.h"
#include "core/retain.h"
#include "material/material_internal.h"

#include <mps/experimental.h>

#include <stdlib.h>
#include <string.h>

#define LEAST 1e-30 /* of a positive quantity in SI units */
#define MOST 1e30

/* ---- definition ------------------------------------------------------------------------------ */

static mps_status check_choice(mps_context *context, const char *function, const char *name,
                               int32_t value, int32_t low, int32_t high) {
  if (value >= low && value <= high) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %d, allowed are %d..%d", name,
                   value, low, high);
}

/* Written so that NaN is refused. */
static mps_status check_range(mps_context *context, const char *function, const char *name,
                              double value, double low, double high) {
  if (value >= low && value <= high) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %g, allowed is %g to %g", name,
                   value, low, high);
}

static mps_status check_numbers(mps_context *context, const char *function,
                                const mps_elastic_def *def) {
  mps_status status = MPS_OK;
  if (!(def->radius_ratio > 1.0 && def->radius_ratio <= 4.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "radius_ratio is %g, must be above 1 and at most 4 (NaN: default)",
                     def->radius_ratio);
  if (!(def->memory_limit >= 0.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "memory_limit is %g bytes, must be >= 0 (NaN: none)", def->memory_limit);
  if (def->iterations < 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "iterations is %lld, must be >= 0 (0: default)", (long long)def->iterations);
  status = check_range(context, function, "measure", def->measure, LEAST, MOST);
  if (status == MPS_OK) status = check_range(context, function, "alpha", def->alpha, 0.03, 100.0);
  if (status == MPS_OK && !isnan(def->bending))
    status = check_range(context, function, "bending", def->bending, 0.0, 1.0);
  if (status == MPS_OK)
    status = check_range(context, function, "tolerance", def->tolerance, 1e-14, 1e-2);
  return status;
}

static mps_status read_def(mps_context *context, const char *function, const mps_elastic_def *user,
                           int32_t dim, double spacing, bool published, mps_elastic_def *def) {
  *def = mpsi_elastic_defaults;
  mps_status status = MPS_OK;
  if (user) status = MPSI_DEF_READ(context, function, mps_elastic_def, user, def);
  const struct {
    const char *name;
    int32_t value, low, high;
  } choices[] = {
      {"state", def->state, MPS_ELASTIC_PLANE_STRESS, MPS_ELASTIC_PLANE_STRAIN},
      {"solver", def->solver, MPS_ELASTIC_AUTO, MPS_ELASTIC_CG},
      {"ordering", def->ordering, MPS_ELASTIC_ORDER_BEST, MPS_ELASTIC_ORDER_METIS},
      {"refinements", def->refinements, 0, 10},
      {"blas_threads", def->blas_threads, 0, 1024},
  };
  for (size_t k = 0; k < sizeof choices / sizeof *choices && status == MPS_OK; k++)
    status = check_choice(context, function, choices[k].name, choices[k].value, choices[k].low,
                          choices[k].high);
  if (status != MPS_OK) return status;
  if (def->kernel) def->radius_ratio = mps_kernel_radius(def->kernel) / spacing;
  if (def->kernel && !(def->radius_ratio > 1.0 && def->radius_ratio <= 4.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the kernel's radius of influence is %g m, must be above the spacing %g m and "
                     "at most 4 times that",
                     mps_kernel_radius(def->kernel), spacing);
  if (isnan(def->radius_ratio)) def->radius_ratio = published ? 3.0 : 1.5;
  if (isnan(def->memory_limit)) def->memory_limit = INFINITY;
  if (isnan(def->measure) || dim == 3) def->measure = 1.0;
  if (isnan(def->alpha)) def->alpha = mpsi_elastic_defaults.alpha;
  if (isnan(def->tolerance)) def->tolerance = mpsi_elastic_defaults.tolerance;
  if (published && dim == 3)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the published method is two-dimensional: at surfaces in 3D a rigid rotation "
                     "would cause stress; use mps_elastic_create");
  return check_numbers(context, function, def);
}

/* ---- calls back from the solver ----------------------------------------------------------------
 */

mps_status mpsi_elastic_enter(mps_elastic *e, const char *function) {
  mps_status status = mpsi_guard_check(&e->guard, e->context, function);
  if (status == MPS_OK) status = mpsi_particles_ready(e->particles, function);
  if (status == MPS_OK) mpsi_guard_enter(&e->guard, e->context, function);
  return status;
}

mps_status mpsi_elastic_leave(mps_elastic *e, mps_status status) {
  mpsi_guard_end(&e->guard);
  e->within = false;
  return status;
}

mps_status mpsi_elastic_check_between(const mps_elastic *e, const char *function) {
  if (!e->within) return MPS_OK;
  return mpsi_fail(e->context, function, MPS_ERROR_STATE,
                   "called back from within %s: the state is between two steps", e->guard.callback);
}

int64_t mpsi_elastic_find(const mps_elastic *e, int64_t id) {
  int64_t low = 0, high = e->n;
  if (id >= 0 && id < e->n && e->id[id] == id) return id; /* as long as none is missing */
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (e->id[middle] < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < e->n && e->id[low] == id ? low : -1;
}

/* ---- fields ---------------------------------------------------------------------------------- */

mps_status mpsi_elastic_read(mps_elastic *e, const char *function, const char *name, double *values,
                             int32_t components) {
  for (int32_t c = 0; c < components; c++) {
    const double *column = mpsi_particles_column(e->particles, name, c);
    if (!column)
      return mpsi_fail(e->context, function, MPS_ERROR_FIELD,
                       "the particles have no field '%s' (component %d of %d)", name, c,
                       components);
    for (int64_t i = 0; i < e->n; i++)
      values[i * components + c] = column[mps_particles_index(e->particles, e->id[i])];
  }
  return MPS_OK;
}

mps_status mpsi_elastic_write(mps_elastic *e, const char *function, const char *name,
                              const double *values, int32_t components) {
  mps_status status = mps_particles_add_field(e->particles, name, 0);
  if (status != MPS_OK)
    return mpsi_fail(e->context, function, status, "field '%s' cannot be made", name);
  for (int32_t c = 0; c < components; c++) {
    double *column = mpsi_particles_column(e->particles, name, c);
    for (int64_t i = 0; i < e->n; i++)
      column[mps_particles_index(e->particles, e->id[i])] = values[i * components + c];
  }
  return MPS_OK;
}

static mps_status bad_value(mps_elastic *e, const char *function, const char *name, int64_t i,
                            double value, const char *allowed) {
  const mps_status status =
      mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "%s of particle %lld is %g, %s", name,
                (long long)e->id[i], value, allowed);
  mpsi_fail_where(e->context, -1, e->id[i]);
  return status;
}

mps_status mpsi_elastic_read_mass(mps_elastic *e, const char *function) {
  double *mass = mpsi_alloc(e->context, e->n, sizeof *mass);
  if (!mass) return mpsi_fail_memory(e->context, function, (size_t)e->n * sizeof *mass);
  mps_status status = mpsi_elastic_read(e, function, "density", mass, 1);
  for (int64_t i = 0; i < e->n && status == MPS_OK; i++) {
    if (!(mass[i] >= LEAST && mass[i] <= MOST))
      status = bad_value(e, function, "density", i, mass[i], "allowed is 1e-30 to 1e30 (kg/m3)");
    mass[i] *= e->volume[i];
  }
  if (status != MPS_OK) {
    mpsi_free(e->context, mass);
    return status;
  }
  mpsi_free(e->context, e->mass);
  e->mass = mass;
  return MPS_OK;
}

/* ---- material and cuts ----------------------------------------------------------------------- */

void mpsi_elastic_measure(mps_elastic *e) {
  const int d = e->dim;
  for (int64_t i = 0; i < e->n; i++) {
    e->volume[i] =
        d == 2 ? e->spacing * e->spacing * e->def.measure : e->spacing * e->spacing * e->spacing;
    for (int bit = 0; bit < 2 * d; bit++)
      if (e->cut[i] & 1 << bit) e->volume[i] *= 0.5;
    e->kappa[i] = e->conservative ? 2.0 * e->def.alpha * e->mu[i] * d * e->volume[i] / e->density[i]
                                  : 2.0 * e->mu[i] * d * e->volume[i] / e->density0;
  }
  mpsi_elastic_measure_bending(e);
  e->values_valid = false;
}

/* Writes `young` and `poisson` of `count` particles, or of all (0, NULL). */
static mps_status write_material(mps_elastic *e, const mps_material *material, int64_t count,
                                 const int64_t *ids) {
  mps_moduli m = {0};
  mps_status status = mps_material_get_moduli(material, 1.0, &m);
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
static mps_status add_material(mps_elastic *e, const char *function) {
  mps_status status = mpsi_material_check_elastic(e->context, function, e->def.material);
  if (status == MPS_OK) status = mps_particles_add_field(e->particles, "young", 0);
  if (status == MPS_OK) status = mps_particles_add_field(e->particles, "poisson", 0);
  return status == MPS_OK ? write_material(e, e->def.material, 0, NULL) : status;
}

static mps_status check_moduli(mps_elastic *e, const char *function, int64_t i, double young,
                               double poisson) {
  const double least = !e->conservative ? 0.0 : -0.99;
  if (!(young >= LEAST && young <= MOST))
    return bad_value(e, function, "young", i, young, "allowed is 1e-30 to 1e30 (Pa)");
  if (poisson >= least && poisson < 0.5) return MPS_OK;
  return bad_value(e, function, "poisson", i, poisson,
                   least < 0.0 ? "must be at least -0.99 and below 0.5"
                               : "must be at least 0 and below 0.5 (published method)");
}

mps_status mpsi_elastic_set_moduli(mps_elastic *e, const char *function, int64_t i, double young,
                                   double poisson) {
  const mps_status status = check_moduli(e, function, i, young, poisson);
  if (status != MPS_OK) return status;
  const double two_mu = young / (1.0 + poisson);
  const bool plane_stress = e->dim == 2 && e->def.state == MPS_ELASTIC_PLANE_STRESS;
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

mps_status mps_elastic_update_material(mps_elastic *e) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  status = read_material(e, __func__);
  if (status == MPS_OK) status = mpsi_elastic_find_joints(e, __func__);
  if (status == MPS_OK) mpsi_elastic_measure(e);
  return mpsi_elastic_leave(e, status);
}

mps_status mps_elastic_set_material(mps_elastic *e, const mps_material *material, int64_t count,
                                    const int64_t *ids) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  double *former = mpsi_alloc(e->context, 2 * e->n, sizeof *former);
  if (!former) status = mpsi_fail_memory(e->context, __func__, (size_t)e->n * 16);
  if (status == MPS_OK) status = mpsi_material_check_elastic(e->context, __func__, material);
  if (status == MPS_OK)
    status = mpsi_particles_check_ids_or_all(e->particles, __func__, count, ids);
  if (status == MPS_OK) status = mpsi_elastic_read(e, __func__, "young", former, 1);
  if (status == MPS_OK) status = mpsi_elastic_read(e, __func__, "poisson", former + e->n, 1);
  if (status == MPS_OK) {
    status = write_material(e, material, count, ids);
    if (status == MPS_OK) status = read_material(e, __func__);
    if (status == MPS_OK) status = mpsi_elastic_find_joints(e, __func__);
    if (status == MPS_OK) mpsi_elastic_measure(e);
    for (int k = 0; k < 2 && status != MPS_OK; k++) { /* the fields are there: it cannot fail */
      const mps_status back =
          mpsi_elastic_write(e, __func__, k ? "poisson" : "young", former + k * e->n, 1);
      (void)back;
    }
  }
  mpsi_free(e->context, former);
  return mpsi_elastic_leave(e, status);
}

mps_status mps_elastic_cut(mps_elastic *e, int32_t axis, int32_t side, int64_t count,
                           const int64_t *ids) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (axis < 0 || axis >= e->dim || (side != -1 && side != 1))
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                     "axis is %d and side %d, allowed are 0..%d and -1 or 1", axis, side,
                     e->dim - 1);
  if (count < 0 || (count > 0 && !ids))
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                     "count is %lld (must be >= 0) or ids is NULL", (long long)count);
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  (void)mpsi_elastic_leave(e, status);
  const int32_t k = e->links.face[axis][side > 0];
  for (int64_t i = 0; i < count; i++) {
    const int64_t found = mpsi_elastic_find(e, ids[i]);
    if (found < 0)
      return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)i,
                       (long long)ids[i]);
    if (e->links.to[found * e->links.count + k] >= 0)
      return mpsi_fail(e->context, __func__, MPS_ERROR_STATE,
                       "particle %lld has a neighbour on side %d of %c: no surface can pass "
                       "through it there",
                       (long long)ids[i], side, "xyz"[axis]);
  }
  mpsi_elastic_end_motion(e); /* its masses are no longer those of the cells */
  mpsi_free(e->context, e->mass);
  e->mass = NULL;
  for (int64_t i = 0; i < count; i++)
    e->cut[mpsi_elastic_find(e, ids[i])] |= (uint8_t)(1 << (2 * axis + (side > 0)));
  mpsi_elastic_measure(e);
  return MPS_OK;
}

/* ---- life ------------------------------------------------------------------------------------ */

mps_status mpsi_elastic_allocate(mps_elastic *e, const char *function) {
  const int64_t n = e->n, all = n * e->dim;
  const struct {
    void **array;
    int64_t count;
    size_t size;
  } arrays[] = {
      {(void **)&e->id, n, sizeof(int64_t)},
      {(void **)&e->x, all, sizeof(double)},
      {(void **)&e->density, n, sizeof(double)},
      {(void **)&e->faces, n, sizeof(uint8_t)},
      {(void **)&e->cut, n, sizeof(uint8_t)},
      {(void **)&e->volume, n, sizeof(double)},
      {(void **)&e->lambda, n, sizeof(double)},
      {(void **)&e->mu, n, sizeof(double)},
      {(void **)&e->poisson, n, sizeof(double)},
      {(void **)&e->kappa, n, sizeof(double)},
      {(void **)&e->support_of, n, sizeof(int64_t)},
      {(void **)&e->load, all, sizeof(double)},
      {(void **)&e->displacement, all, sizeof(double)},
      {(void **)&e->reaction, all, sizeof(double)},
      {(void **)&e->gradient, all * e->dim, sizeof(double)},
      {(void **)&e->stress_work, all * e->dim, sizeof(double)},
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

void mps_elastic_destroy(mps_elastic **elastic) {
  if (!elastic || !*elastic) return;
  mps_elastic *e = *elastic;
  mps_context *context = e->context;
  /* from a callback: whoever works on it needs it still */
  if (mpsi_guard_check(&e->guard, context, __func__) != MPS_OK) return;
  *elastic = NULL;
  mpsi_elastic_end_motion(e);
  mpsi_elastic_drop_change(e);
  mpsi_elastic_drop_boundaries(e);
  mpsi_state_forget(&e->identity);
  mpsi_elastic_drop_loads(e);
  mpsi_elastic_drop_outside(e);
  mpsi_elastic_free_body(e);
  mps_kernel_destroy(&e->def.kernel);
  mps_material_destroy(&e->def.material);
  mpsi_particles_release(e->particles, &e->holder);
  mpsi_free(context, e);
  mpsi_context_release(context);
}

void mpsi_elastic_free_body(mps_elastic *e) {
  mps_context *context = e->context;
  mpsi_cholesky_destroy(&e->cholesky);
  mpsi_elastic_disconnect(e);
  mpsi_elastic_drop_joints(e);
  void *arrays[] = {e->id,           e->x,          e->density,     e->cut,   e->volume,
                    e->lambda,       e->mu,         e->poisson,     e->kappa, e->facets,
                    e->load,         e->reaction,   e->gradient,    e->work,  e->dof,
                    e->displacement, e->column,     e->stress_work, e->row,   e->value,
                    e->faces,        e->rhs,        e->solution,    e->mass,  e->cg_work,
                    e->supports,     e->support_of, e->bending};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) mpsi_free(context, arrays[k]);
}

static int compare_ids(const void *a, const void *b) {
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
  return (x > y) - (x < y);
}

mps_status mpsi_elastic_make_body(mps_elastic *e, const char *function, bool moduli_known) {
  mps_status status = mpsi_elastic_connect(e, function);
  if (status == MPS_OK && !moduli_known) status = read_material(e, function);
  if (status == MPS_OK) status = mpsi_elastic_find_joints(e, function);
  if (status == MPS_OK) status = mpsi_elastic_find_facets(e, function);
  if (status == MPS_OK) mpsi_elastic_measure(e);
  return status;
}

static mps_status build(mps_elastic *e, const char *function) {
  mps_status status = mpsi_elastic_allocate(e, function);
  if (status == MPS_OK && e->def.material) status = add_material(e, function);
  if (status == MPS_OK) {
    memcpy(e->id, mpsi_particles_integers(e->particles, "id"), (size_t)e->n * sizeof *e->id);
    qsort(e->id, (size_t)e->n, sizeof *e->id, compare_ids);
  }
  if (status == MPS_OK) status = mpsi_elastic_read(e, function, "position", e->x, e->dim);
  for (int64_t i = 0; i < e->n * e->dim && status == MPS_OK; i++)
    if (!isfinite(e->x[i]))
      status = bad_value(e, function, "position", i / e->dim, e->x[i], "must be finite");
  if (status == MPS_OK) status = mpsi_elastic_make_body(e, function, false);
  if (status == MPS_OK) status = mps_particles_add_field(e->particles, "displacement", 0);
  if (status == MPS_OK) status = mps_particles_add_field(e->particles, "reaction", 0);
  return status;
}

/* The lattice is found once: other positions than those are not for this solver. */
static mps_status refuse_positions(void *self, const char *function, const char *field,
                                   const double *former) {
  mps_elastic *e = self;
  bool same = true;
  (void)former;
  for (int32_t c = 0; c < e->dim && strcmp(field, "position") == 0; c++) {
    const double *x = mpsi_particles_column(e->particles, "position", c);
    for (int64_t i = 0; i < e->n && same; i++)
      same = x[mps_particles_index(e->particles, e->id[i])] == e->x[i * e->dim + c];
  }
  if (same) return MPS_OK;
  return mpsi_fail(
      e->context, function, MPS_ERROR_STATE,
      "the particle set is held by a solver of implicit elasticity, which relies on the "
      "positions: write the former ones back, or destroy it first");
}

mps_status mpsi_elastic_create(mps_context *context, const char *function, mps_particles *particles,
                               const mps_elastic_def *user_def, bool published, bool constant,
                               mps_elastic **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!particles || mps_particles_count(particles) == 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "particles is %s",
                     particles ? "empty" : "NULL");
  if (mpsi_particles_context(particles) != context)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the particle set was made from another context");
  mps_elastic_def def;
  mps_status status = read_def(context, function, user_def, mps_particles_dim(particles),
                               mps_particles_spacing(particles), published, &def);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, function, MPSI_USE_FIX);
  if (status != MPS_OK) return status;
  mpsi_backup backup;
  status = mpsi_particles_back_up(particles, function, &backup);
  if (status != MPS_OK) return status;
  mps_elastic *e = mpsi_alloc(context, 1, sizeof *e);
  if (!e) {
    mpsi_backup_drop(particles, &backup);
    return mpsi_fail_memory(context, function, sizeof *e);
  }
  e->context = mpsi_context_retain(context);
  e->particles = particles;
  e->holder = (mpsi_holder){.name = "a solver of implicit elasticity (mps_elastic)",
                            .self = e,
                            .kind = MPSI_USE_FIX,
                            .commit = refuse_positions,
                            .remove = mpsi_elastic_remove,
                            .renew = mpsi_elastic_renew};
  (void)mpsi_particles_hold(particles, function, &e->holder); /* checked above */
  e->def = def;
  if (def.kernel) e->def.kernel = mpsi_kernel_retain(def.kernel);
  if (def.material) e->def.material = mpsi_material_retain(def.material);
  e->conservative = !published;
  e->constant = constant;
  e->dim = mps_particles_dim(particles);
  e->modes = e->dim == 2 ? 3 : 6;
  e->n = mps_particles_count(particles);
  e->spacing = mps_particles_spacing(particles);
  status = build(e, function);
  if (status != MPS_OK) {
    mpsi_particles_go_back(particles, &backup);
    mps_elastic_destroy(&e);
    return status;
  }
  mpsi_backup_drop(particles, &backup);
  *out = e;
  return MPS_OK;
}

mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                              const mps_elastic_def *def, mps_elastic **out) {
  return mpsi_elastic_create(context, __func__, particles, def, false, false, out);
}

mps_status mps_experimental_elastic_published(mps_context *context, mps_particles *particles,
                                              const mps_elastic_def *def, int32_t constant,
                                              mps_elastic **out) {
  return mpsi_elastic_create(context, __func__, particles, def, true, constant != 0, out);
}

mps_status mps_elastic_get_def_sized(const mps_elastic *e, mps_elastic_def *out, size_t size) {
  if (!e) return MPS_ERROR_ARGUMENT;
  return mpsi_def_write(e->context, "mps_elastic_get_def", out, size, &e->def, sizeof e->def);
}

mps_particles *mps_elastic_particles(const mps_elastic *e) { return e ? e->particles : NULL; }
mps_context *mps_elastic_context(const mps_elastic *e) { return e ? e->context : NULL; }
