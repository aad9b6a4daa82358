/* properties.c - what the fluid is made of: the viscosity of a Newtonian material, the density of
 * the set's field. The fluid is one material, incompressible: a bulk modulus has no part in it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "properties.h"

#include "core/definition/digits.h"
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

