/* overtopping.c - mean overtopping discharge and run-up by the formulas of EurOtop (2018), the mean
 * of the tests or with coefficients a standard deviation off, Q = q/(g Hm0^3)^1/2, R = Rc/Hm0:
 *
 *   (7.1)  .047 exp(-(2.35 R)^1.3)               .007, .23  vertical, no influencing foreshore
 *   (7.5)  .05 exp(-2.78 R)                      .012, .17  foreshore, depth^2/(Hm0 L) > .23
 *   (7.7)  .011 (Hm0/(h s))^1/2 exp(-2.2 R)      .0045      impulsive, R < 1.35
 *   (7.8)  .0014 (Hm0/(h s))^1/2 R^-3            .0006      impulsive, R >= 1.35
 *   (5.10) .023/tan(a)^1/2 gb xi exp(-(2.7 R/(xi gb gf gB gv))^1.3)  .003, .20, at most
 *   (5.11) .09 exp(-(1.5 R/(gf gB g*))^1.3)      .0135, .15
 *   (5.1)  Ru2/Hm0 = 1.65 gb gf gB xi            .10
 *   (5.2)  gf gB (4 - 1.5/(gb xi)^1/2)           .07
 *
 * L and s = Hm0/L of deep water for T(m-1,0). SPDX-License-Identifier: BSD-3-Clause */
#include "core/definition/digits.h"
#include "waves_private.h"

#include <mps/experimental/wave_loads.h>

#define CREST_MOST 3.5   /* Rc/Hm0 of the tests */
#define BREAKER_MOST 5.0 /* xi of (5.10), (5.11) */

static double breaker(const mps_eurotop_def *d) {
  const double L = d->gravity * d->period * d->period / (2.0 * MPSI_WAVES_PI);
  return 1.0 / d->cotangent / sqrt(d->height / L);
}

static mps_status check_breaker(mps_context *context, const char *function,
                                const mps_eurotop_def *d) {
  if (breaker(d) < BREAKER_MOST) return MPS_OK;
  return mpsi_fail(
      context, function, MPS_ERROR_ARGUMENT,
      "period %g s, height %g m and cotangent %g have a breaker parameter of %g, must be below 5",
      d->period, d->height, d->cotangent, breaker(d));
}

static mps_status check_def(mps_context *context, const mps_eurotop_def *d) {
  static const char function[] = "mps_eurotop_evaluate_sized";
  if (!(d->crest <= CREST_MOST * d->height)) /* or NaN, as run-up needs none */
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "crest is %s m, must be at most %g m, 3.5 times height",
                     mpsi_outside(d->crest, 0.0, CREST_MOST * d->height).text,
                     CREST_MOST * d->height);
  return d->wall == MPS_EUROTOP_WALL_SLOPE ? check_breaker(context, function, d) : MPS_OK;
}

static int32_t choose_vertical(const mps_eurotop_def *d) {
  const double L = d->gravity * d->period * d->period / (2.0 * MPSI_WAVES_PI);
  if (!d->foreshore && d->depth > 4.0 * d->height) return MPS_EUROTOP_FORMULA_DEEP;
  if (d->depth * d->depth > 0.23 * d->height * L) return MPS_EUROTOP_FORMULA_FORESHORE;
  return d->crest < 1.35 * d->height ? MPS_EUROTOP_FORMULA_IMPULSIVE_LOW
                                     : MPS_EUROTOP_FORMULA_IMPULSIVE_HIGH;
}

/* q (m2/s) with coefficients `n` standard deviations to the side of more water. */
static double discharge(const mps_eurotop_def *d, int32_t formula, double n) {
  const double R = d->crest / d->height, scale = sqrt(d->gravity * pow(d->height, 3.0));
  const double L = d->gravity * d->period * d->period / (2.0 * MPSI_WAVES_PI);
  const double impulse = sqrt(L / d->depth); /* (Hm0/(h s))^1/2 */
  const double xi = d->wall == MPS_EUROTOP_WALL_SLOPE ? breaker(d) : NAN;
  const double rough = d->roughness * d->obliquity;
  switch (formula) {
  case MPS_EUROTOP_FORMULA_DEEP:
    return scale * (0.047 + 0.007 * n) * exp(-pow((2.35 - 0.23 * n) * R, 1.3));
  case MPS_EUROTOP_FORMULA_FORESHORE:
    return scale * (0.05 + 0.012 * n) * exp(-(2.78 - 0.17 * n) * R);
  case MPS_EUROTOP_FORMULA_IMPULSIVE_LOW:
    return scale * (0.011 + 0.0045 * n) * impulse * exp(-2.2 * R);
  case MPS_EUROTOP_FORMULA_IMPULSIVE_HIGH:
    return scale * (0.0014 + 0.0006 * n) * impulse * pow(R, -3.0);
  case MPS_EUROTOP_FORMULA_BREAKING:
    return scale * (0.023 + 0.003 * n) * sqrt(d->cotangent) * d->berm * xi *
           exp(-pow((2.7 - 0.2 * n) * R / (xi * d->berm * rough * d->crown), 1.3));
  default:
    return scale * (0.09 + 0.0135 * n) *
           exp(-pow((1.5 - 0.15 * n) * R / (rough * d->promenade), 1.3));
  }
}

/* The lesser of the two formulas of a slope. */
static double wall_discharge(const mps_eurotop_def *d, double n, int32_t *formula) {
  if (d->wall == MPS_EUROTOP_WALL_VERTICAL) {
    *formula = choose_vertical(d);
    return discharge(d, *formula, n);
  }
  const double breaking = discharge(d, MPS_EUROTOP_FORMULA_BREAKING, n);
  const double most = discharge(d, MPS_EUROTOP_FORMULA_NON_BREAKING, n);
  *formula = breaking < most ? MPS_EUROTOP_FORMULA_BREAKING : MPS_EUROTOP_FORMULA_NON_BREAKING;
  return fmin(breaking, most);
}

mps_status mps_eurotop_evaluate_sized(mps_context *context, const mps_eurotop_def *user_def,
                                      mps_eurotop *out, size_t size) {
  if (!context) return mpsi_null(__func__, "context");
  mps_eurotop_def d;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_eurotop_def, user_def, &d));
  MPSI_TRY(mpsi_out_check(context, __func__, out, size));
  MPSI_TRY(check_def(context, &d));
  mps_eurotop r = {.breaker = d.wall == MPS_EUROTOP_WALL_SLOPE ? breaker(&d) : NAN};
  int32_t ignored;
  r.low = wall_discharge(&d, -1.0, &ignored);
  r.high = wall_discharge(&d, 1.0, &ignored);
  r.discharge = wall_discharge(&d, d.design, &r.formula);
  return mpsi_out_write(context, __func__, out, size, &r, sizeof r);
}

/* ---- run-up ---------------------------------------------------------------------------------- */

static mps_status check_run_up(mps_context *context, const char *function,
                               const mps_eurotop_def *d) {
  if (d->wall != MPS_EUROTOP_WALL_SLOPE)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "wall is %s, must be MPS_EUROTOP_WALL_SLOPE: at a vertical wall there is no "
                     "run-up",
                     mpsi_name_of("mps_eurotop_wall", d->wall).text);
  return check_breaker(context, function, d);
}

/* Ru2% (m) with the coefficient `n` standard deviations to the side of more water. */
static double run_up(const mps_eurotop_def *d, double n, int32_t *breaking) {
  const double xi = breaker(d), rough = d->roughness * d->obliquity * d->height;
  const double first = (1.65 + 0.1 * n) * d->berm * rough * xi;
  const double most = (1.0 + 0.07 * n) * rough * (4.0 - 1.5 / sqrt(d->berm * xi));
  *breaking = first < most || most < 0.0; /* the limit is none of long slopes, xi below .14 */
  return *breaking ? first : most;
}

mps_status mps_eurotop_find_run_up_sized(mps_context *context, const mps_eurotop_def *user_def,
                                         mps_eurotop_run_up *out, size_t size) {
  if (!context) return mpsi_null(__func__, "context");
  mps_eurotop_def d;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_eurotop_def, user_def, &d));
  MPSI_TRY(mpsi_out_check(context, __func__, out, size));
  MPSI_TRY(check_run_up(context, __func__, &d));
  int32_t ignored;
  mps_eurotop_run_up r = {.breaker = breaker(&d)};
  r.low = run_up(&d, -1.0, &ignored);
  r.high = run_up(&d, 1.0, &ignored);
  r.height = run_up(&d, d.design, &r.breaking);
  return mpsi_out_write(context, __func__, out, size, &r, sizeof r);
}
