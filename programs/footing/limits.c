/* limits.c - the exact capacity of rigid, perfectly plastic ground under mps-footing, Pa.
 *
 * Friction and weight, or clay whose strength grows with depth: the method of characteristics,
 * which supposes associated flow, an upper bound for less dilation; a low estimate is that of Davis
 * (1968), with cos(psi) cos(phi)/(1 - sin(psi) sin(phi)) times c and tan(phi). Clay: Prandtl (52),
 * whatever the weight and the base. A circle: smooth, R. T. Shield, J. Mech. Phys. Solids 4 (1955)
 * 10-16; rough, G. Eason and R. T. Shield, Z. angew. Math. Phys. 11 (1960) 33-43. A thin layer: G.
 * G. Meyerhof, T. K. Chaplin 1953. An eccentric load: G. G. Meyerhof 1953, the width B - 2 e bears,
 * without tension. Two layers are known by bounds alone: R. S. Merifield et al., Geotechnique 49
 * (1999) 471. SPDX-License-Identifier: BSD-3-Clause */
#include "footing.h"

#include <math.h>

#define PI 3.14159265358979323846
/* Of the weight of half a width: cohesion of ground that has no other strength. */
#define LITTLE 1e-4
#define DEEPEST                                                                                    \
  0.05 /* of the half width: a footing that sinks is borne by the ground beside it                 \
        */

enum { LINES = 40, KEPT = 8 };

static bool is_same(const strip_footing *a, const strip_footing *b) {
  return a->half_width == b->half_width && a->cohesion == b->cohesion && a->weight == b->weight &&
         a->gradient == b->gradient && a->surcharge == b->surcharge && a->friction == b->friction &&
         a->rough == b->rough;
}

/* The error of the characteristics falls with the square of the lines and is extrapolated. Pace,
 * path, inset and comparison of a run ask for the same few capacities, of .1 s each: they are kept.
 */
static double capacity_of(const strip_footing *f) {
  static struct {
    strip_footing of;
    double q;
  } known[KEPT];
  static int found;
  for (int k = 0; k < found && k < KEPT; k++)
    if (is_same(&known[k].of, f)) return known[k].q;
  const double coarse = characteristics_capacity(f, LINES / 2);
  const int at = found++ % KEPT;
  known[at].of = *f;
  known[at].q = (4.0 * characteristics_capacity(f, LINES) - coarse) / 3.0;
  return known[at].q;
}

/* alpha in sqrt(J2) + alpha I1 = kappa, as mps_material_cone has it, for an angle whose sine this
 * is.
 */
static double slope_of(int cone, double sine) {
  if (cone == MPS_MATERIAL_CONE_CIRCUMSCRIBED) return 2.0 * sine / (sqrt(3.0) * (3.0 - sine));
  if (cone == MPS_MATERIAL_CONE_EXTENSION) return 2.0 * sine / (sqrt(3.0) * (3.0 + sine));
  return sine / sqrt(9.0 + 3.0 * sine * sine);
}

/* At the limit load nothing flows out of the plane: s_zz = -2 a q with a the slope of the flow, and
 * Mohr's circle in the plane has the radius q sqrt(1 - 3 a^2), which makes of the cone the angle
 * below. All cones have the apex of the pyramid, c cot(phi). */
footing_strength footing_find_strength(const settings *s) {
  const double phi = s->phi * PI / 180.0, psi = isnan(s->psi) ? phi : s->psi * PI / 180.0;
  footing_strength out = {phi, psi, s->cohesion};
  if (s->cone == MPS_MATERIAL_CONE_PLANE_STRAIN) return out;
  const double alpha = slope_of(s->cone, sin(phi)), flow = slope_of(s->cone, sin(psi));
  const double less = sqrt(fmax(0.0, 1.0 - 3.0 * flow * flow));
  const double sine = 3.0 * alpha * less / (1.0 - 3.0 * alpha * flow);
  out.phi = sine >= 0.0 && sine < 1.0 ? asin(sine) : 0.5 * PI;
  out.psi = less > 0.0 ? fmin(asin(fmin(1.0, 3.0 * flow / less)), out.phi) : out.phi;
  out.cohesion *= tan(out.phi) / tan(phi);
  return out;
}

static double by_characteristics(const settings *s, bool rough, double psi) {
  strip_footing f = {.half_width = s->half_width,
                     .cohesion = s->cohesion,
                     .weight = s->density * s->gravity,
                     .gradient = s->gradient,
                     .surcharge = s->surcharge,
                     .rough = rough};
  if (s->model == DRUCKER_PRAGER) {
    const footing_strength of = footing_find_strength(s);
    const double share = cos(psi) * cos(of.phi) / (1.0 - sin(psi) * sin(of.phi));
    f.friction = atan(share * tan(of.phi));
    f.cohesion = of.cohesion * share;
    if (f.surcharge == 0.0) f.cohesion = fmax(f.cohesion, LITTLE * f.weight * f.half_width);
  }
  return capacity_of(&f);
}

double footing_find_bound(const settings *s) {
  const footing_limits l = footing_find_limits(s);
  const bool deep = s->pace[FOOTING_UNDEFORMED].settlement > DEEPEST * s->half_width;
  if (deep || footing_is_whole(s) || footing_is_thin(s)) return NAN;
  return isnan(l.exact) ? fmax(l.smooth, l.rough) : l.exact;
}

footing_limits footing_find_limits(const settings *s) {
  const double c = s->cohesion;
  footing_limits l = {(2.0 + PI) * c, (2.0 + PI) * c, NAN, NAN, "Prandtl"};
  const bool cone = s->model == DRUCKER_PRAGER;
  if (cone || s->gradient > 0.0) {
    const footing_strength of = footing_find_strength(s);
    l.smooth = by_characteristics(s, false, of.phi), l.rough = by_characteristics(s, true, of.phi);
    if (cone && s->psi < s->phi) l.davis = by_characteristics(s, s->mu > 0.0, of.psi);
    l.source = "characteristics";
  } else if (s->top > 0.0) {
    l.smooth = l.rough = NAN;
  } else if (footing_is_thin(s)) {
    l.rough = fmax(l.rough, (PI + 1.0 + s->half_width / s->depth) * c);
    l.smooth = NAN, l.source = "Meyerhof and Chaplin";
  } else if (footing_is_whole(s)) {
    l.smooth = l.rough *= 1.0 - s->eccentricity / s->half_width;
    l.source = "Meyerhof, B - 2 e";
  } else if (s->shape == CIRCLE) {
    l.smooth = 5.69 * c, l.rough = 6.05 * c;
    l.source = s->mu > 0.0 ? "Eason and Shield" : "Shield";
  }
  /* Coulomb's friction lets the base bear c, as a rough one does, where mu q > c. */
  const double enough = cone                  ? tan(footing_find_strength(s).phi)
                        : s->shape == CIRCLE  ? c / l.smooth
                        : l.smooth == l.rough ? 0.0
                                              : 1.0;
  l.exact = s->mu >= enough ? l.rough : s->mu == 0.0 ? l.smooth : NAN;
  return l;
}
