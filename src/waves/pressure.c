/* pressure.c - pressures of waves on vertical walls.
 *
 * Sainflou (1928): the mean level rises by pi H^2 coth(kd)/L, the wave's pressure at the bed is rho
 * g H/cosh kd, and the pressure is linear between the surface and the bed.
 *
 * Goda (1974; Random Seas 2000): eta* = .75 (1 + cos b) H, p1 = (1 + cos b)/2 (a1 + a2 cos^2 b) rho
 * g H, a1 = .6 + (2kh/sinh 2kh)^2/2, a2 = min((hb - d)/(3 hb) (H/d)^2, 2d/H), a3 = 1 - h'/h (1 -
 * 1/cosh kh), p2 = p1/cosh kh, p3 = a3 p1, p4 = p1 (1 - hc/eta*), pu = (1 + cos b)/2 a1 a3 rho g H.
 *
 * Takahashi, Tanimoto and Shimosako (1994): a2 not below aI = aI0 aI1, aI0 = H/d, at most 2; with
 * d11 = .93 (B/L - .12) + .36 ((h - d)/h - .6) and d22 = -.36 (B/L - .12) + .93 ((h - d)/h - .6),
 * d1 = 20 or 15 d11 and d2 = 4.9 or 3 d22 where these are negative or positive, aI1 = cos d2/cosh
 * d1 for d2 <= 0, else 1/(cosh d1 (cosh d2)^1/2). SPDX-License-Identifier: BSD-3-Clause */
#include "dispersion.h"
#include "waves_private.h"

#include <mps/experimental/wave_loads.h>

static double wave_number(double period, double depth, double gravity) {
  const double omega = 2.0 * MPSI_WAVES_PI / period;
  return mpsi_waves_depths(omega * omega * depth / gravity) / depth;
}

/* ---- Sainflou -------------------------------------------------------------------------------- */

static mps_status check_sainflou(mps_context *context, const mps_sainflou_def *d) {
  const char *function = "mps_sainflou_evaluate_sized";
  MPSI_TRY(mpsi_waves_check_range(context, function, d->period, d->depth, d->gravity));
  const double k = wave_number(d->period, d->depth, d->gravity);
  const double most = 0.142 * 2.0 * MPSI_WAVES_PI / k * tanh(k * d->depth);
  if (d->height > most)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "height is %g m, must be at most the breaking height %g m: "
                     "Sainflou's waves do not break",
                     d->height, most);
  const double rise = 0.5 * k * d->height * d->height / tanh(k * d->depth);
  if (d->height - rise >= d->depth)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "height is %g m: the trough, %g m below the water at rest, would "
                     "be at the bed in a depth of %g m",
                     d->height, d->height - rise, d->depth);
  return MPS_OK;
}

/* A triangle from `top` (m above the bed) down to the pressure `bed`. */
static void triangle(double top, double bed, double *force, double *moment) {
  *force = 0.5 * top * bed;
  *moment = top * *force / 3.0;
}

mps_status mps_sainflou_evaluate_sized(mps_context *context, const mps_sainflou_def *user_def,
                                       mps_sainflou *out, size_t size) {
  if (!context) return mpsi_null(__func__, "context");
  mps_sainflou_def d;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_sainflou_def, user_def, &d));
  MPSI_TRY(mpsi_out_check(context, __func__, out, size));
  MPSI_TRY(check_sainflou(context, &d));
  const double k = wave_number(d.period, d.depth, d.gravity), weight = d.density * d.gravity;
  mps_sainflou r;
  r.rise = 0.5 * k * d.height * d.height / tanh(k * d.depth);
  r.bed = weight * d.height / cosh(fmin(k * d.depth, 700.0));
  triangle(d.depth + r.rise + d.height, weight * d.depth + r.bed, &r.crest_force, &r.crest_moment);
  triangle(d.depth + r.rise - d.height, weight * d.depth - r.bed, &r.trough_force,
           &r.trough_moment);
  return mpsi_out_write(context, __func__, out, size, &r, sizeof r);
}

/* ---- Goda ------------------------------------------------------------------------------------ */

static mps_status check_goda(mps_context *context, const char *function, mps_goda_def *d) {
  MPSI_TRY(mpsi_waves_check_range(context, function, d->period, d->depth, d->gravity));
  if (isnan(d->seaward)) d->seaward = d->depth;
  if (isnan(d->berm_depth)) d->berm_depth = d->depth;
  if (isnan(d->base)) d->base = d->depth;
  if (isnan(d->arm)) d->arm = 0.5 * d->width;
  return MPS_OK;
}

static double impulsive_coefficient(const mps_goda_def *d, double L) {
  const double part = d->berm_width / L - 0.12, high = (d->depth - d->berm_depth) / d->depth - 0.6;
  const double d11 = 0.93 * part + 0.36 * high, d22 = -0.36 * part + 0.93 * high;
  const double d1 = d11 <= 0.0 ? 20.0 * d11 : 15.0 * d11;
  const double d2 = d22 <= 0.0 ? 4.9 * d22 : 3.0 * d22;
  const double shape = d2 <= 0.0 ? cos(d2) : 1.0 / sqrt(cosh(d2));
  return fmin(d->height / d->berm_depth, 2.0) * shape / cosh(fmin(fabs(d1), 700.0));
}

static void find_pressures(const mps_goda_def *d, mps_goda *r) {
  const double k = wave_number(d->period, d->depth, d->gravity), kh = k * d->depth;
  const double c = cos(d->angle), H = d->height,
               scale = 0.5 * (1.0 + c) * d->density * d->gravity * H;
  const double bed = 1.0 / cosh(fmin(kh, 700.0));
  const double shallow = kh < 300.0 ? 2.0 * kh / sinh(2.0 * kh) : 0.0;
  r->alpha[0] = 0.6 + 0.5 * shallow * shallow;
  r->alpha[1] = fmin((d->seaward - d->berm_depth) / (3.0 * d->seaward) * (H / d->berm_depth) *
                         (H / d->berm_depth),
                     2.0 * d->berm_depth / H);
  r->impulsive = d->impulsive ? impulsive_coefficient(d, 2.0 * MPSI_WAVES_PI / k) : NAN;
  if (r->impulsive > r->alpha[1]) r->alpha[1] = r->impulsive;
  r->alpha[2] = 1.0 - d->base / d->depth * (1.0 - bed);
  r->reach = 0.75 * (1.0 + c) * H;
  r->p1 = scale * (r->alpha[0] + r->alpha[1] * c * c);
  r->p2 = r->p1 * bed;
  r->p3 = r->alpha[2] * r->p1;
  r->p4 = r->reach > d->crest ? r->p1 * (1.0 - d->crest / r->reach) : 0.0;
  r->pu = scale * r->alpha[0] * r->alpha[2];
}

mps_status mps_goda_evaluate_sized(mps_context *context, const mps_goda_def *user_def,
                                   mps_goda *out, size_t size) {
  if (!context) return mpsi_null(__func__, "context");
  mps_goda_def d;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_goda_def, user_def, &d));
  MPSI_TRY(mpsi_out_check(context, __func__, out, size));
  MPSI_TRY(check_goda(context, __func__, &d));
  mps_goda r;
  find_pressures(&d, &r);
  const double above_rest = fmin(r.reach, d.crest), h = d.base; /* trapezia above and below */
  r.force = 0.5 * (r.p1 + r.p3) * h + 0.5 * (r.p1 + r.p4) * above_rest;
  r.moment = (2.0 * r.p1 + r.p3) * h * h / 6.0 + 0.5 * (r.p1 + r.p4) * h * above_rest +
             (r.p1 + 2.0 * r.p4) * above_rest * above_rest / 6.0;
  r.uplift = 0.5 * r.pu * d.width;
  r.uplift_moment = 2.0 / 3.0 * r.uplift * d.width;
  r.sliding = d.friction * (d.weight - r.uplift) / r.force;
  r.overturning = (d.weight * d.arm - r.uplift_moment) / r.moment;
  return mpsi_out_write(context, __func__, out, size, &r, sizeof r);
}
