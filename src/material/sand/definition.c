/* definition.c - the definition of cyclic sand: Mohr-Coulomb, and the constants of the volume
 * strain of cyclic shear. Byrne (1991): C1 = 7600 Dr^-2.5 with the relative density Dr in percent,
 * or 8.7 (N1)60^-1.25, and C2 = 0.4/C1. Martin, Finn and Seed (1975): four constants.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/digits.h"
#include "material/constants.h"

#include <mps/soil.h>

#define LEAST_DENSITY 0.1
#define MOST_BLOWS 60.0
#define MOST_C 100.0
#define LEAST_C1 1e-4
#define MOST_THRESHOLD 0.01

static mps_status check_between(mps_context *context, const char *function, const char *name,
                                double value, double low, double high) {
  if (value >= low && value <= high) return MPS_OK; /* not NaN */
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %s, must be %g to %g", name,
                   mpsi_outside(value, low, high).text, low, high);
}

/* Which of the three gives C1: one, and no other. */
static mps_status check_given(mps_context *context, const char *function,
                              const mps_material_cyclic_sand_def *d) {
  const int given = !isnan(d->relative_density) + !isnan(d->blow_count) + !isnan(d->c1);
  if (given != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%d of relative_density, blow_count and c1 are given, must be one of them",
                     given);
  if (isnan(d->c1) && !isnan(d->c2))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "c2 is %g without c1: relative_density and blow_count give both", d->c2);
  if (isnan(d->c3) != isnan(d->c4))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s is not given: c3 and c4 go together", isnan(d->c3) ? "c3" : "c4");
  if (!isnan(d->c3) && (isnan(d->c1) || isnan(d->c2)))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s is not given: c3 and c4 need c1 and c2", isnan(d->c1) ? "c1" : "c2");
  return MPS_OK;
}

static mps_status check_constants(mps_context *context, const char *function,
                                  const mps_material_cyclic_sand_def *d) {
  mps_status status = check_given(context, function, d);
  if (status == MPS_OK && !isnan(d->relative_density))
    status = check_between(context, function, "relative_density", d->relative_density,
                           LEAST_DENSITY, 1.0);
  if (status == MPS_OK && !isnan(d->blow_count))
    status = check_between(context, function, "blow_count", d->blow_count, 1.0, MOST_BLOWS);
  if (status == MPS_OK && !isnan(d->c1))
    status = check_between(context, function, "c1", d->c1, LEAST_C1, MOST_C);
  if (status == MPS_OK && !isnan(d->c2))
    status = check_between(context, function, "c2", d->c2, 0.0, MOST_C);
  if (status == MPS_OK && !isnan(d->c3))
    status = check_between(context, function, "c3", d->c3, LEAST_C1, MOST_C);
  if (status == MPS_OK && !isnan(d->c4))
    status = check_between(context, function, "c4", d->c4, LEAST_C1, MOST_C);
  if (status == MPS_OK)
    status = check_between(context, function, "threshold", d->threshold, 0.0, MOST_THRESHOLD);
  if (status != MPS_OK) return status;
  if (d->strain_limit > d->threshold && d->strain_limit <= 1.0) return MPS_OK; /* not NaN */
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "strain_limit is %s, must be above the threshold, %g, and at most 1",
                   mpsi_outside(d->strain_limit, d->threshold, 1.0).text, d->threshold);
}

mps_status mpsi_define_cyclic_sand(mps_context *context, const char *function, const void *values,
                                   mpsi_law *law) {
  const mps_material_cyclic_sand_def *d = values;
  mps_material_mohr_coulomb_def strength = mps_material_mohr_coulomb_defaults();
  strength.young = d->young, strength.poisson = d->poisson;
  strength.friction = d->friction, strength.dilation = d->dilation;
  strength.cohesion = d->cohesion;
  mps_status status = mpsi_define_mohr_coulomb(context, function, &strength, law);
  if (status == MPS_OK) status = check_constants(context, function, d);
  if (status != MPS_OK) return status;
  double c1 = d->c1;
  if (!isnan(d->relative_density)) c1 = 7600.0 * pow(100.0 * d->relative_density, -2.5);
  if (!isnan(d->blow_count)) c1 = 8.7 * pow(d->blow_count, -1.25);
  law->contract[0] = c1;
  law->contract[1] = isnan(d->c2) ? 0.4 / c1 : d->c2;
  law->contract[2] = isnan(d->c3) ? 0.0 : d->c3;
  law->contract[3] = isnan(d->c4) ? 0.0 : d->c4;
  law->threshold = d->threshold;
  law->strain_limit = d->strain_limit;
  return MPS_OK;
}
