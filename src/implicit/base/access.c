/* access.c - access to the solver object: its guard, ranks of ids, and the set's fields as vectors
 * over all particles. SPDX-License-Identifier: BSD-3-Clause */
#include "access.h"
#include "core/base/order.h"
#include "implicit/base/implicit_solver.h"

#include <stdlib.h>
#include <string.h>

/* ---- called within a callback of the solver -------------------------------------------------- */

mps_status mpsi_elastic_ready(void *solver, const char *function) {
  mps_elastic *e = solver;
  e->agreed = false;
  return mpsi_elastic_agree(e, function, mpsi_particles_ready(e->particles, function));
}

mps_status mpsi_elastic_enter(mps_elastic *e, const char *function) {
  const mps_status status = mpsi_solver_enter(&e->base, function);
  if (status == MPS_OK) mpsi_guard_enter(&e->guard, e->context, function);
  return status;
}

mps_status mpsi_elastic_agree(void *solver, const char *function, mps_status status) {
  mps_elastic *e = solver;
  if (e->agreed || !mpsi_domain_many(e->domain)) return status;
  status = mpsi_domain_agree(e->domain, function, status);
  e->agreed = status != MPS_OK;
  return status;
}

mps_status mpsi_elastic_agree_same(mps_elastic *e, const char *function, mps_status status,
                                   const char *name, double value) {
  if (e->agreed || !mpsi_domain_many(e->domain)) return status;
  status = mpsi_domain_agree_same(e->domain, function, status, name, value);
  e->agreed = status != MPS_OK;
  return status;
}

mps_status mpsi_elastic_agree_given(mps_elastic *e, const char *function, mps_status status,
                                    const mpsi_given *list) {
  if (e->agreed || !mpsi_domain_many(e->domain)) return status;
  status = mpsi_domain_agree_given(e->domain, function, status, list);
  e->agreed = status != MPS_OK;
  return status;
}

mps_status mpsi_elastic_leave(mps_elastic *e, mps_status status) {
  const char *function = e->guard.callback; /* that of mpsi_elastic_enter */
  mpsi_guard_end(&e->guard);
  e->within = false;
  return mpsi_elastic_agree(e, function, status);
}

bool mpsi_elastic_begin_reading(mps_elastic *e) {
  const bool agreed = e->agreed;
  e->agreed = false;
  return agreed;
}

mps_status mpsi_elastic_check_between(const mps_elastic *e, const char *function) {
  if (!e->within) return MPS_OK;
  return mpsi_fail(e->context, function, MPS_ERROR_STATE,
                   "called back from within %s: the state is between two steps", e->guard.callback);
}

int64_t mpsi_elastic_find(const mps_elastic *e, int64_t id) {
  int64_t low;
  if (id >= 0 && id < e->n && e->id[id] == id) return id; /* as long as none is missing */
  MPSI_BISECT(low, e->n, middle, e->id[middle] < id);
  return low < e->n && e->id[low] == id ? low : -1;
}

void mpsi_elastic_sort_ids(int64_t count, int64_t *ids) {
  qsort(ids, (size_t)count, sizeof *ids, mpsi_ascending);
}

/* ---- fields ---------------------------------------------------------------------------------- */

mps_status mpsi_elastic_read(mps_elastic *e, const char *function, const char *name, double *values,
                             int32_t components) {
  for (int32_t c = 0; c < components; c++) {
    const double *column = mpsi_particles_column(e->particles, name, c);
    if (!column) {
      const bool moduli = strcmp(name, "young") == 0 || strcmp(name, "poisson") == 0;
      return mpsi_fail(e->context, function, MPS_ERROR_FIELD,
                       "the particle set has no field '%s': set it with %s", name,
                       moduli ? "mps_particles_set or mps_particles_set_material, or give the "
                                "`material` of the definition"
                              : "mps_particles_set");
    }
    for (int64_t i = 0; i < e->n; i++)
      values[i * components + c] = column[mps_particles_index(e->particles, e->id[i])];
  }
  return MPS_OK;
}

mps_status mpsi_elastic_write(mps_elastic *e, const char *function, const char *name,
                              const double *values, int32_t components) {
  mps_status status = mpsi_as(e->context, function, mps_particles_add_field(e->particles, name, 0));
  if (status != MPS_OK)
    return mpsi_fail(e->context, function, status, "field '%s' cannot be made", name);
  for (int32_t c = 0; c < components; c++) {
    double *column = mpsi_particles_column(e->particles, name, c);
    for (int64_t i = 0; i < e->n; i++)
      column[mps_particles_index(e->particles, e->id[i])] = values[i * components + c];
  }
  return MPS_OK;
}

mps_status mpsi_elastic_bad_value(mps_elastic *e, const char *function, const char *name, int64_t i,
                                  double value, const char *allowed) {
  const mps_status status =
      mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "%s of particle %lld is %g, %s", name,
                (long long)e->id[i], value, allowed);
  mpsi_fail_where(e->context, -1, e->id[i]);
  return status;
}

/* The factor of K + shift M is that of the former masses. */
static void use_mass(mps_elastic *e, double *mass) {
  const bool same = mass && e->mass && memcmp(mass, e->mass, (size_t)e->n * sizeof *mass) == 0;
  if (!same && e->factored_shift != 0.0) e->factored = false;
  e->mass = mass;
}

mps_status mpsi_elastic_read_mass(mps_elastic *e, const char *function, double **former) {
  double *mass = mpsi_alloc(e->context, e->n, sizeof *mass);
  *former = e->mass;
  if (!mass) return mpsi_fail_memory(e->context, function, (size_t)e->n * sizeof *mass);
  mps_status status = mpsi_elastic_read(e, function, "density", mass, 1);
  for (int64_t i = 0; i < e->n && status == MPS_OK; i++) {
    if (!(mass[i] >= MPSI_ELASTIC_LEAST && mass[i] <= MPSI_ELASTIC_MOST))
      status = mpsi_elastic_bad_value(e, function, "density", i, mass[i],
                                      "allowed is 1e-30 to 1e30 (kg/m3)");
    mass[i] *= e->volume[i];
  }
  status = mpsi_fail_of(e->context, status, "e");
  if (status == MPS_OK)
    use_mass(e, mass);
  else
    mpsi_free(e->context, mass);
  return status;
}

void mpsi_elastic_finish_mass(mps_elastic *e, double *former, bool renewed) {
  if (e->mass == former) return;
  double *const other = renewed ? former : e->mass;
  if (!renewed) use_mass(e, former);
  mpsi_free(e->context, other);
}
