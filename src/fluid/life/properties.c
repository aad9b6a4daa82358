/* properties.c - what the fluid is made of: the viscosity of a Newtonian material, the density of the
 * set's field. The fluid is one material, incompressible: a bulk modulus has no part in it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "properties.h"
#include "fluid/base/access.h"
#include "fluid/ranks/partition.h"

#include "core/base/digits.h"
#include "core/particles/particles_internal.h"
#include "material/material_internal.h"

#define USUAL_DENSITY 1000.0 /* kg/m3, of a set without the field */

/* The one density of the set. */
static mps_status read_density(mps_context *context, const char *function,
                               const mps_particles *particles, double *density) {
  mps_particles *set = (mps_particles *)particles; /* only read */
  const double *rho = mpsi_particles_column(set, "density", 0);
  const int64_t *id = mpsi_particles_integers(set, "id");
  if (!rho) {
    *density = USUAL_DENSITY;
    return MPS_OK;
  }
  for (int64_t i = 1; i < mps_particles_count(particles); i++)
    if (!(rho[i] == rho[0]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "particles: density of particle %lld is %g kg/m3, that of particle %lld %g: "
                       "the fluid is of one density; make the field one value, or give `density` "
                       "of the definition",
                       (long long)id[i], rho[i], (long long)id[0], rho[0]);
  *density = rho[0];
  return MPS_OK;
}

static mps_status read_viscosity(mps_context *context, const char *function,
                                 const mps_material *material, double *viscosity) {
  const mps_status status = mpsi_material_check_newtonian(context, function, material);
  if (status == MPS_OK) *viscosity = mpsi_material_viscosity(material);
  return status;
}

mps_status mpsi_fluid_check_viscosity(mps_context *context, const char *function,
                                      double viscosity) {
  if (viscosity >= 0.0 && viscosity <= 1e6) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "viscosity of the fluid is %s, allowed is in [0, 1e6] Pa s",
                   mpsi_outside(viscosity, 0.0, 1e6).text);
}

mps_status mpsi_fluid_read_material(mps_context *context, const char *function,
                                    const mps_particles *particles, mps_fluid_def *def) {
  mps_status status = MPS_OK;
  if (isnan(def->density)) status = read_density(context, function, particles, &def->density);
  if (isnan(def->viscosity)) def->viscosity = 0.0;
  if (status == MPS_OK && def->material)
    status = read_viscosity(context, function, def->material, &def->viscosity);
  def->material = NULL; /* its constants are copied */
  return status;
}

/* A list has to name all particles: there is one fluid. */
static mps_status check_list(mps_fluid *f, const char *function, int64_t count,
                             const int64_t *ids) {
  mps_status status = mpsi_particles_check_ids_or_all(f->particles, function, count, ids);
  if (status != MPS_OK || !ids) return status;
  const int64_t n = mps_particles_count(f->particles);
  int64_t named = 0;
  bool *seen = mpsi_alloc(f->context, n, sizeof *seen);
  if (!seen) return mpsi_fail_memory(f->context, function, (size_t)n * sizeof *seen);
  for (int64_t k = 0; k < count; k++) {
    const int64_t i = mps_particles_index(f->particles, ids[k]);
    named += !seen[i];
    seen[i] = true;
  }
  mpsi_free(f->context, seen);
  if (named == n) return MPS_OK;
  return mpsi_fail(f->context, function, MPS_ERROR_UNSUPPORTED,
                   "ids are %lld of the %lld particles: a fluid is of one material, give all of "
                   "them or NULL with count 0",
                   (long long)named, (long long)n);
}

mps_status mps_fluid_set_material(mps_fluid *f, const mps_material *material, int64_t count,
                                  const int64_t *ids) {
  if (!f) return MPS_ERROR_ARGUMENT;
  double viscosity = 0.0;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  status = read_viscosity(f->context, __func__, material, &viscosity);
  if (status == MPS_OK) status = mpsi_fluid_check_viscosity(f->context, __func__, viscosity);
  if (status == MPS_OK) status = check_list(f, __func__, count, ids);
  status = mpsi_domain_agree_same(f->def.domain, __func__, status, "viscosity of the material",
                                  viscosity);
  if (status == MPS_OK) f->def.viscosity = viscosity;
  return status;
}
