/* constants.c - elastic constants, and the cones of Drucker and Prager that
 * match Mohr and Coulomb, Nakamura (55)-(56).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constants.h"

#define ROOT3 1.7320508075688772
/* ---- checks ---------------------------------------------------------------------------------- */

mps_status mpsi_check_elastic(mps_context *context, const char *function, double young,
                              double poisson) {
  MPSI_TRY(mpsi_check_range(context, function, "young", young, MPSI_RANGE_MODULUS));
  return mpsi_check_range(context, function, "poisson", poisson, MPSI_RANGE_POISSON);
}

/* ---- constants ------------------------------------------------------------------------------- */

mpsi_law mpsi_law_elastic(double young, double poisson) {
  const double shear = young / (2.0 * (1.0 + poisson));
  const double bulk = young / (3.0 * (1.0 - 2.0 * poisson));
  return (mpsi_law){.has_moduli = true,
                    .shear = shear,
                    .bulk = bulk,
                    .lambda = bulk - 2.0 / 3.0 * shear,
                    .per_bulk = 1.0 / bulk};
}

void mpsi_law_add_dilation_end(mpsi_law *law, double dilation, double void_ratio,
                               double max_void_ratio) {
  const bool ends = dilation > 0.0 && !isnan(max_void_ratio);
  law->loosest = ends ? (1.0 + max_void_ratio) / (1.0 + void_ratio) : 0.0;
}

double mpsi_law_wave_modulus(const mpsi_law *law) { return law->bulk + 4.0 / 3.0 * law->shear; }

/* Slope of the cone that matches an angle; for the plane strain cone's flow the inscribed one,
 * which in plane strain flows with just that angle of dilation. */
static double slope(mps_material_cone cone, double angle) {
  const double sine = sin(angle);
  switch (cone) {
  case MPS_MATERIAL_CONE_CIRCUMSCRIBED:
    return 2.0 * sine / (ROOT3 * (3.0 - sine));
  case MPS_MATERIAL_CONE_EXTENSION:
    return 2.0 * sine / (ROOT3 * (3.0 + sine));
  default:
    return sine / sqrt(9.0 + 3.0 * sine * sine); /* (56) */
  }
}

/* Plane strain: at the limit load the flow out of the plane is zero, so that s_zz = -2 a q with a
 * the flow's slope, and the radius of Mohr's circle is r = q sqrt(1 - 3 a^2). Put into (55) and
 * compared with r + m sin(phi) = c cos(phi), m the mean stress in the plane. */
static double plane_strain_slope(double sine, double flow) {
  return sine / (3.0 * (sqrt(1.0 - 3.0 * flow * flow) + flow * sine));
}

void mpsi_law_add_cone(mpsi_law *law, mps_material_cone cone, double friction, double dilation,
                       double cohesion, double tension) {
  const double sine = sin(friction);
  law->alpha_flow = slope(cone, dilation);
  law->alpha = cone == MPS_MATERIAL_CONE_PLANE_STRAIN ? plane_strain_slope(sine, law->alpha_flow)
                                                      : slope(cone, friction);
  /* Every one of these cones has the pyramid's apex, p = c cot(phi); without friction all four have
   * a slope of 0 and differ in radius only. */
  double per_cohesion = 1.0; /* kappa / (c cos(phi)) */
  if (friction > 0.0)
    per_cohesion = 3.0 * law->alpha / sine;
  else if (cone == MPS_MATERIAL_CONE_CIRCUMSCRIBED || cone == MPS_MATERIAL_CONE_EXTENSION)
    per_cohesion = 2.0 / ROOT3;
  law->kappa = per_cohesion * cohesion * cos(friction);
  law->cone = 1.0 / (law->shear + 9.0 * law->bulk * law->alpha * law->alpha_flow);
  const double apex = law->alpha > 0.0 ? law->kappa / (3.0 * law->alpha) : INFINITY;
  law->tension = tension < apex ? tension : apex;
  law->q_tension = tension < apex ? law->kappa - 3.0 * law->alpha * tension : 0.0;
  if (isinf(law->tension)) law->q_tension = law->kappa;
}
