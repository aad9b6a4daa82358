/* start.c - the definition of a modified Cam-Clay, K0 of one-dimensional virgin
 * compression, and whether a state can be a first one.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material/constants.h"

#include <mps/soil.h>

#include <stdio.h>

mps_status mpsi_define_cam_clay(mps_context *context, const char *function, const void *values,
                                mpsi_law *law) {
  const mps_material_cam_clay_def *d = values;
  const double sine = 3.0 * d->critical_slope / (6.0 + d->critical_slope);
  const double ratio = (3.0 - sine) / (3.0 + sine);
  const bool by_nu = isnan(d->shear_modulus);
  const double bulk = (1.0 + d->void_ratio) * d->preconsolidation / d->swelling;
  const double share = 1.5 * (1.0 - 2.0 * d->poisson) / (1.0 + d->poisson);
  const double shear = by_nu ? share * bulk : d->shear_modulus;
  *law = (mpsi_law){.has_moduli = true,
                    .shear = shear,
                    .bulk = bulk,
                    .lambda = bulk - 2.0 / 3.0 * shear,
                    .per_bulk = 1.0 / bulk,
                    .slope = d->critical_slope,
                    .compression = d->compression,
                    .swelling = d->swelling,
                    .shear_ratio = by_nu ? share : 0.0,
                    .lode = d->lode ? ratio * ratio * ratio * ratio : 1.0,
                    .first_pc = d->preconsolidation,
                    .first_void = d->void_ratio,
                    .least_pressure =
                        isnan(d->least_pressure) ? 1e-3 * d->preconsolidation : d->least_pressure};
  law->log_least = log(law->least_pressure);
  return MPS_OK;
}

/* Virgin compression without lateral strain: deviatoric over volume strain is 2/3, plastic by the
 * flow rule 2 eta/(M^2 - eta^2), elastic by 2 (1 + nu) eta/(9 (1 - 2 nu)). The left side grows with
 * eta between 0 and M. With a constant G the elastic part is left out: it has no constant ratio. */
double mpsi_cam_clay_k0(const mpsi_law *law) {
  const double m2 = law->slope * law->slope, plastic = law->compression - law->swelling;
  const double elastic = law->shear_ratio > 0.0 ? law->swelling / (3.0 * law->shear_ratio) : 0.0;
  double low = 0.0, high = fmin(law->slope, 3.0 - 1e-9);
  for (int i = 0; i < 200 && high - low > 1e-16 * high; i++) {
    const double eta = 0.5 * (low + high);
    const double rate = 2.0 * eta * plastic / (m2 - eta * eta) + elastic * eta;
    if (rate < 2.0 / 3.0 * law->compression)
      low = eta;
    else
      high = eta;
  }
  return (3.0 - low) / (3.0 + 2.0 * low);
}

double mps_material_normal_k0(const mps_material *material) {
  return material && material->type->kind == MPSI_LAW_CAM_CLAY ? mpsi_cam_clay_k0(&material->law)
                                                               : NAN;
}

bool mpsi_material_check_state(const mps_material *material, int32_t dim, const double *stress,
                               const double *history, char *reason, size_t size) {
  const mpsi_law *law = &material->law;
  const double given = history[MPSI_CLAY_PC], pc = given != 0.0 ? given : law->first_pc;
  const double p = -(stress[0] + stress[1] + stress[2]) / 3.0;
  double s[6] = {0.0}, square = 0.0;
  for (int c = 0; c < 2 * dim; c++) {
    s[c] = c < 3 ? stress[c] + p : stress[c];
    square += (c < 3 ? 1.5 : 3.0) * s[c] * s[c];
  }
  if (!(p > 0.0)) {
    (void)snprintf(reason, size,
                   "has the mean effective pressure %g Pa, must be > 0: give it an initial stress, "
                   "at the ground's surface a surcharge",
                   p);
    return false;
  }
  const double needed = p + square / (mpsi_cam_clay_slope2(law, s, sqrt(square)) * p);
  if (needed <= pc * (1.0 + 1e-6)) return true;
  (void)snprintf(
      reason, size,
      "begins outside the yield surface: p = %g Pa and q = %g Pa need a preconsolidation "
      "of at least %g Pa, it is %g Pa",
      p, sqrt(square), needed, pc);
  return false;
}
