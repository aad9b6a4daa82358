/* start.c - the definition of a modified Cam-Clay, K0 of one-dimensional virgin
 * compression, and whether a state can be a first one.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material/constants.h"
#include "core/base/digits.h"

#include <mps/soil.h>

#include <stdio.h>

static mps_status check_between(mps_context *context, const char *function, const char *name,
                                double value, double low, double high) {
  if (value >= low && value <= high) return MPS_OK; /* not NaN */
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %s, must be %g to %g", name,
                   mpsi_outside(value, low, high).text, low, high);
}

static mps_status check_numbers(mps_context *context, const char *function,
                                const mps_material_cam_clay_def *d) {
  const double most = d->preconsolidation / 10.0;
  mps_status status =
      check_between(context, function, "critical_slope: M", d->critical_slope, 0.05, 2.9);
  if (status == MPS_OK)
    status = check_between(context, function, "compression: lambda", d->compression, 1e-4, 5.0);
  if (status == MPS_OK)
    status = check_between(context, function, "swelling: kappa", d->swelling, 1e-5, 5.0);
  if (status == MPS_OK && !(d->swelling < d->compression))
    status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "swelling: kappa is %g, must be below compression, lambda, %g", d->swelling,
                       d->compression);
  if (status == MPS_OK && isnan(d->shear_modulus))
    status = check_between(context, function, "poisson: Poisson's ratio", d->poisson, 0.0, 0.49);
  if (status == MPS_OK && !isnan(d->shear_modulus))
    status =
        mpsi_check_range(context, function, "shear_modulus", d->shear_modulus, MPSI_RANGE_MODULUS);
  if (status == MPS_OK)
    status = check_between(context, function, "void_ratio", d->void_ratio, 0.01, 20.0);
  if (status == MPS_OK)
    status = check_between(context, function, "preconsolidation", d->preconsolidation, 1e-3, 1e12);
  if (status == MPS_OK && !isnan(d->least_pressure) &&
      !(d->least_pressure > 0.0 && d->least_pressure <= most))
    status =
        mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                  "least_pressure is %g Pa, must be > 0 and at most preconsolidation/10, %g Pa",
                  d->least_pressure, most);
  return status;
}

mps_status mpsi_define_cam_clay(mps_context *context, const char *function, const void *values,
                                mpsi_law *law) {
  const mps_material_cam_clay_def *d = values;
  if (d->lode != 0 && d->lode != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "lode is %d, must be 0 or 1",
                     (int)d->lode);
  const mps_status status = check_numbers(context, function, d);
  if (status != MPS_OK) return status;
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
  double square = 0.0;
  for (int c = 0; c < 2 * dim; c++) {
    const double s = c < 3 ? stress[c] + p : stress[c];
    square += (c < 3 ? 1.5 : 3.0) * s * s;
  }
  if (!(p > 0.0)) {
    (void)snprintf(reason, size,
                   "has the mean effective pressure %g Pa, must be > 0: give it an initial stress, "
                   "at the ground's surface a surcharge",
                   p);
    return false;
  }
  const double needed = p + square / (law->slope * law->slope * p);
  if (needed <= pc * (1.0 + 1e-6)) return true;
  (void)snprintf(
      reason, size,
      "begins outside the yield surface: p = %g Pa and q = %g Pa need a preconsolidation "
      "of at least %g Pa, it is %g Pa",
      p, sqrt(square), needed, pc);
  return false;
}
