/* soften.c - strength that falls with the plastic strain and grows with the rate, of von Mises and
 * Mohr-Coulomb: su = su0 (1 + mu log10(max(1, rate/reference))) (dr + (1 - dr) exp(-gamma/gamma_s))
 * (Einav & Randolph 2005, with gamma_s = xi95/3). A band of a softening law is as wide as the grid
 * makes it, so that gamma_s = slip/band with the width `band` that the solver's grid gives it makes
 * the work of a band that of its slip, whatever the grid.
 *
 * Returns take the strength at the end of the step: the plastic strain is the unknown of one
 * equation.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

#define ROOT3 1.7320508075688772

/* ---- definition ------------------------------------------------------------------------------ */

/* The length of the band; `fall` (Pa) of the strength su, in all. */
static mps_status check_length(mps_context *context, const char *function, double slip, double band,
                               double fall, double shear) {
  if (isnan(slip) || isnan(band))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s is NaN: softening needs slip and band (m), else its work follows the "
                     "grid. band: 1.5 cells with cubic weights, 1.4 with quadratic ones",
                     isnan(slip) ? "slip" : "band");
  if (fall * band < shear * slip) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "slip is %g m, must be above %g m: the strength would fall by %g Pa over a "
                   "strain of slip/band, steeper than the shear modulus %g Pa unloads",
                   slip, fall * band / shear, fall, shear);
}

static double shear_of(double young, double poisson) { return young / (2.0 * (1.0 + poisson)); }

mps_status mpsi_law_soften_mises(mps_context *context, const char *function, mpsi_law *law,
                                 const mps_material_von_mises_def *def) {
  law->residual = def->residual;
  law->per_strain = def->residual < 1.0 ? ROOT3 * def->band / def->slip : 0.0;
  law->rate_factor = def->rate_factor;
  law->per_rate = 1.0 / def->rate_reference;
  law->softens = def->residual < 1.0 || def->rate_factor > 0.0;
  if (def->residual == 1.0) return MPS_OK;
  return check_length(context, function, def->slip, def->band,
                      (1.0 - def->residual) * def->yield_stress / ROOT3,
                      shear_of(def->young, def->poisson));
}

mps_status mpsi_law_soften_mohr_coulomb(mps_context *context, const char *function, mpsi_law *law,
                                        const mps_material_mohr_coulomb_def *def) {
  const double phi = isnan(def->residual_friction) ? def->friction : def->residual_friction;
  const double c = isnan(def->residual_cohesion) ? def->cohesion : def->residual_cohesion;
  const bool falls = phi < def->friction || c < def->cohesion;
  law->per_strain = falls ? ROOT3 * def->band / def->slip : 0.0;
  law->rate_factor = def->rate_factor;
  law->per_rate = 1.0 / def->rate_reference;
  law->tan_phi = tan(def->friction), law->tan_phi_last = tan(phi);
  law->tan_psi = tan(def->dilation);
  law->cohesion = def->cohesion, law->cohesion_last = c;
  law->softens = falls || def->rate_factor > 0.0;
  if (law->softens) law->kappa = -1e300; /* the inscribed cone finds all particles */
  law->given_cut = def->tension;
  law->softens_linearly = falls && def->softening == MPS_MATERIAL_SOFTENING_LINEAR;
  if (!falls) return MPS_OK;
  return check_length(context, function, def->slip, def->band, def->cohesion - c,
                      shear_of(def->young, def->poisson));
}

/* ---- strength -------------------------------------------------------------------------------- */

double mpsi_softening_share(const mpsi_law *law, double plastic_strain) {
  const double x = law->per_strain * plastic_strain;
  if (law->softens_linearly) return fmax(0.0, 1.0 - x);
  return exp(-x);
}

double mpsi_rate_factor(const mpsi_law *law, double rate) {
  const double ratio = rate * law->per_rate;
  return law->rate_factor > 0.0 && ratio > 1.0 ? 1.0 + law->rate_factor * log10(ratio) : 1.0;
}

double mpsi_soften_mises(const mpsi_law *law, double trial, double strength,
                         double *plastic_strain) {
  const double first = *plastic_strain, stiff = 3.0 * law->shear;
  const double soft = (1.0 - law->residual) * strength;
  if (!(trial > strength * law->residual + soft * mpsi_softening_share(law, first))) return 0.0;
  /* trial - 3 G x - strength(first + x) = 0. It falls in x, and its slope falls too unless the rate
   * makes the strength fall faster than 3 G: then the bracket is halved. */
  double low = 0.0, high = trial / stiff, x = 0.0;
  for (int i = 0; i < 100 && high - low > 1e-16 * high; i++) {
    const double fall = soft * mpsi_softening_share(law, first + x);
    const double f = trial - stiff * x - (strength * law->residual + fall);
    if (f > 0.0)
      low = x;
    else
      high = x;
    const double slope = law->per_strain * fall - stiff, next = x - f / slope;
    const double former = x;
    x = slope < 0.0 && next >= low && next <= high ? next : 0.5 * (low + high);
    if (fabs(x - former) <= 1e-15 * x) break;
  }
  *plastic_strain = first + x;
  return stiff * x;
}

/* ---- Mohr-Coulomb ---------------------------------------------------------------------------- */

/* The constants of the pyramid at a plastic strain and rate. */
static void weaken(mpsi_law *now, const mpsi_law *law, double plastic_strain, double factor) {
  const double share = law->per_strain > 0.0 ? mpsi_softening_share(law, plastic_strain) : 1.0;
  const double slope = law->tan_phi_last + share * (law->tan_phi - law->tan_phi_last);
  const double c = factor * (law->cohesion_last + share * (law->cohesion - law->cohesion_last));
  const double cosine = 1.0 / sqrt(1.0 + slope * slope), flow = share * law->tan_psi;
  now->sin_phi = slope * cosine;
  now->c_cos_phi = c * cosine;
  now->sin_psi = flow < slope ? flow / sqrt(1.0 + flow * flow) : now->sin_phi;
  now->apex = slope > 0.0 ? c / slope : INFINITY;
  now->cut = law->given_cut < now->apex ? law->given_cut : INFINITY;
}

/* One return with the strength of a guess of the final plastic strain: by how much the guess
 * exceeds what comes out. */
typedef struct attempt {
  double stress[6], strain, gap, opened, excess;
  int64_t flags;
} attempt;

static attempt attempt_return(const mpsi_law *law, mpsi_law *now, int32_t dim, double least,
                              double factor, const double *stress, double strain, double gap,
                              double guess) {
  attempt a = {.strain = strain, .gap = gap};
  for (int32_t c = 0; c < 2 * dim; c++) a.stress[c] = stress[c];
  weaken(now, law, guess, factor);
  a.flags = mpsi_mohr_coulomb_return(now, dim, least, a.stress, &a.strain, &a.gap, &a.opened);
  a.excess = guess - a.strain;
  return a;
}

int64_t mpsi_soften_mohr_coulomb(const mpsi_law *law, int32_t dim, double rate, double least,
                                 double *stress, double *plastic_strain, double *gap,
                                 double *opened) {
  mpsi_law now = *law;
  const double factor = mpsi_rate_factor(law, rate), first = *plastic_strain;
  attempt a = attempt_return(law, &now, dim, least, factor, stress, first, *gap, first);
  if (a.flags == 0) return 0;
  if (law->per_strain > 0.0 &&
      a.excess < 0.0) { /* Illinois; with all strength lost it is the most */
    double low = first, f_low = a.excess;
    attempt b = attempt_return(law, &now, dim, least, factor, stress, first, *gap, INFINITY);
    double high = b.strain, f_high;
    a = attempt_return(law, &now, dim, least, factor, stress, first, *gap, high);
    f_high = a.excess;
    for (int i = 0; i < 100 && f_high > 1e-15 * high && high - low > 1e-15 * high; i++) {
      const double x = low - f_low * (high - low) / (f_high - f_low);
      a = attempt_return(law, &now, dim, least, factor, stress, first, *gap, x);
      if (fabs(a.excess) <= 1e-15 * x) break;
      if (a.excess < 0.0) {
        low = x, f_low = a.excess;
        f_high *= 0.5;
      } else {
        high = x, f_high = a.excess;
        f_low *= 0.5;
      }
    }
  }
  for (int32_t c = 0; c < 2 * dim; c++) stress[c] = a.stress[c];
  *plastic_strain = a.strain;
  *gap = a.gap;
  *opened = a.opened;
  return a.flags;
}
