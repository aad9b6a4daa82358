/* elastic_moduli.c - constants of isotropic elasticity, and the fields that the solvers of
 * elasticity read, from a material.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"
#include "core/particles/particles_internal.h"

#include <string.h>

static mps_moduli moduli_of(double shear, double bulk, double density) {
  const double wave = bulk + 4.0 / 3.0 * shear;
  return (mps_moduli){.young = 9.0 * bulk * shear / (3.0 * bulk + shear),
                      .poisson = 0.5 * (3.0 * bulk - 2.0 * shear) / (3.0 * bulk + shear),
                      .shear = shear,
                      .bulk = bulk,
                      .lambda = bulk - 2.0 / 3.0 * shear,
                      .wave = wave,
                      .density = density,
                      .shear_velocity = sqrt(shear / density),
                      .pressure_velocity = sqrt(wave / density)};
}

mps_status mps_moduli_from_elastic_sized(mps_context *context, double young, double poisson,
                                         double density, mps_moduli *out, size_t size) {
  static const char function[] = "mps_moduli_from_elastic";
  if (!context) return mpsi_null(__func__, "context");
  MPSI_TRY(mpsi_check_elastic(context, function, young, poisson));
  MPSI_TRY(mpsi_check_range(context, function, "density", density, MPSI_RANGE_DENSITY));
  const mpsi_law law = mpsi_law_elastic(young, poisson);
  mps_moduli m = moduli_of(law.shear, law.bulk, density);
  m.young = young, m.poisson = poisson; /* to the last bit */
  return mpsi_out_write(context, function, out, size, &m, sizeof m);
}

mps_status mps_moduli_from_velocities_sized(mps_context *context, double shear_velocity,
                                            double pressure_velocity, double density,
                                            mps_moduli *out, size_t size) {
  static const char function[] = "mps_moduli_from_velocities";
  if (!context) return mpsi_null(__func__, "context");
  mps_status status = mpsi_check_range(context, function, "shear_velocity: the shear wave velocity",
                                       shear_velocity, MPSI_RANGE_WAVE_VELOCITY);
  if (status == MPS_OK)
    status = mpsi_check_range(context, function, "pressure_velocity: the pressure wave velocity",
                              pressure_velocity, MPSI_RANGE_WAVE_VELOCITY);
  if (status == MPS_OK)
    status = mpsi_check_range(context, function, "density", density, MPSI_RANGE_DENSITY);
  if (status != MPS_OK) return status;
  const double ratio = pressure_velocity / shear_velocity, square = ratio * ratio;
  const double poisson = 0.5 * (square - 2.0) / (square - 1.0);
  if (!(square > 4.0 / 3.0) || !mpsi_in_range(MPSI_RANGE_POISSON, poisson))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "pressure_velocity: the pressure wave velocity is %g times the shear wave "
                     "velocity, Poisson's "
                     "ratio would be %.6g: must be -0.999 to 0.49999 (1.155 to 223 times)",
                     ratio, poisson);
  const double shear = density * shear_velocity * shear_velocity;
  mps_moduli m = moduli_of(shear, shear * (square - 4.0 / 3.0), density);
  m.shear_velocity = shear_velocity, m.pressure_velocity = pressure_velocity;
  status =
      mpsi_check_range(context, function,
                       "shear_velocity and pressure_velocity: Young's modulus by these velocities",
                       m.young, MPSI_RANGE_MODULUS);
  return status == MPS_OK ? mpsi_out_write(context, function, out, size, &m, sizeof m) : status;
}

mps_status mps_material_get_moduli_sized(const mps_material *material, double density,
                                         mps_moduli *out, size_t size) {
  static const char function[] = "mps_material_get_moduli";
  if (!material) return mpsi_null(__func__, "material");
  mps_context *context = material->context;
  if (!material->law.has_moduli)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the law '%s' has no elastic constants that the library knows",
                     material->name);
  MPSI_TRY(mpsi_check_range(context, function, "density", density, MPSI_RANGE_DENSITY));
  const mps_moduli m = moduli_of(material->law.shear, material->law.bulk, density);
  return mpsi_out_write(context, function, out, size, &m, sizeof m);
}

/* ---- fields ---------------------------------------------------------------------------------- */

static const char set_material[] = "mps_particles_set_material";

mps_status mpsi_material_check_elastic(mps_context *context, const char *function,
                                       const mps_material *material) {
  if (!material) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "material is NULL");
  if (material->by_field)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the law %s has factors of each particle, which solvers of elasticity do not "
                     "read: set their fields young or shear_velocity",
                     material->name);
  if (material->type->traits & MPSI_LAW_IS_LINEAR) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                   "the law is %s: fields and solvers of elasticity take linear_elastic ground "
                   "only; WLS-MPM takes other laws as they are",
                   material->name);
}

enum { GROUND = 5 }; /* fields that follow from a material and a density */
static const char *const ground[GROUND] = {"density", "young", "poisson", "shear_velocity",
                                           "pressure_velocity"};

/* Writes the fields, of which `former` are the present values. On an error of a holder all are as
 * before, and holders that have read them read them again. */
static mps_status write_ground(mps_particles *particles, const double value[GROUND], int64_t count,
                               const int64_t *ids, double *former) {
  const int64_t all = mps_particles_count(particles);
  mps_status status = MPS_OK;
  int read = 0;
  for (int k = 0; k < GROUND; k++) {
    double *column = mpsi_particles_column(particles, ground[k], 0);
    memcpy(former + k * all, column, (size_t)all * sizeof *former);
    for (int64_t i = 0; i < (ids ? count : all); i++)
      column[ids ? mps_particles_index(particles, ids[i]) : i] = value[k];
  }
  for (; read < GROUND && status == MPS_OK; read++) /* masses follow from densities */
    status = mpsi_particles_notify(particles, set_material, ground[read], read ? NULL : former);
  if (status == MPS_OK) return MPS_OK;
  for (int k = 0; k < GROUND; k++) {
    double *column = mpsi_particles_column(particles, ground[k], 0);
    for (int64_t i = 0; i < all; i++) {
      const double refused = column[i];
      column[i] = former[k * all + i];
      former[k * all + i] = refused;
    }
  }
  for (int k = 0; k < read - 1; k++)
    (void)mpsi_particles_notify(particles, set_material, ground[k], k ? NULL : former);
  return status;
}

mps_status mps_particles_set_material(mps_particles *particles, const mps_material *material,
                                      double density, const int64_t *ids, int64_t count) {
  if (!particles) return mpsi_null(__func__, "particles");
  mps_context *context = mpsi_particles_context(particles);
  mps_moduli m = {0};
  mps_status status = mpsi_material_check_elastic(context, set_material, material);
  if (status == MPS_OK && material->context != context)
    status = mpsi_fail(context, set_material, MPS_ERROR_ARGUMENT,
                       "the material was made from another context");
  if (status == MPS_OK)
    status = mpsi_particles_check_ids_or_all(particles, set_material, count, ids);
  if (status == MPS_OK)
    status = mpsi_as(context, __func__, mps_material_get_moduli(material, density, &m));
  if (status == MPS_OK) status = mpsi_particles_writable(particles, set_material);
  const int32_t before = mps_particles_field_count(particles);
  const int64_t all = mps_particles_count(particles);
  double *former = NULL;
  for (int k = 0; k < GROUND && status == MPS_OK; k++)
    status = mpsi_as(context, __func__, mps_particles_add_field(particles, ground[k], 0));
  if (status == MPS_OK && !(former = mpsi_alloc(context, GROUND * all, sizeof *former)))
    status = mpsi_fail_memory(context, set_material, (size_t)all * GROUND * sizeof *former);
  const double value[] = {density, m.young, m.poisson, m.shear_velocity, m.pressure_velocity};
  if (status == MPS_OK) status = write_ground(particles, value, count, ids, former);
  if (status != MPS_OK) mpsi_particles_drop_fields(particles, before);
  mpsi_free(context, former);
  return status;
}
