/* laws.c - the laws of the layers of mps-site-response: each has the shear modulus rho Vs^2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180.0)

static double shear_of(const site_layer *l) { return l->density * l->vs * l->vs; }
static double young_of(const site_layer *l) { return 2.0 * (1.0 + l->poisson) * shear_of(l); }

static mps_status make_small_strain(mps_context *c, const site_layer *l, mps_material **out) {
  mps_material_small_strain_def d = mps_material_small_strain_defaults();
  d.shear_modulus = shear_of(l), d.poisson = l->poisson;
  d.reference_strain = l->reference_strain, d.curvature = l->curvature;
  d.strength = l->strength;
  return mps_material_create_small_strain(c, &d, out);
}

static mps_status make_mohr_coulomb(mps_context *c, const site_layer *l, mps_material **out) {
  mps_material_mohr_coulomb_def d = mps_material_mohr_coulomb_defaults();
  d.young = young_of(l), d.poisson = l->poisson;
  d.friction = l->phi * DEGREE, d.dilation = l->psi * DEGREE, d.cohesion = l->cohesion;
  d.void_ratio = l->e0, d.max_void_ratio = l->e_max;
  return mps_material_create_mohr_coulomb(c, &d, out);
}

static mps_status make_cyclic_sand(mps_context *c, const site_layer *l, mps_material **out) {
  mps_material_cyclic_sand_def d = mps_material_cyclic_sand_defaults();
  d.young = young_of(l), d.poisson = l->poisson;
  d.friction = l->phi * DEGREE, d.dilation = l->psi * DEGREE, d.cohesion = l->cohesion;
  d.void_ratio = l->e0, d.max_void_ratio = l->e_max;
  d.relative_density = l->relative_density, d.blow_count = l->blow_count;
  return mps_material_create_cyclic_sand(c, &d, out);
}

mps_status site_make_law(mps_context *c, const site_layer *l, mps_material **out) {
  switch (l->law) {
  case SITE_SMALL_STRAIN:
    return make_small_strain(c, l, out);
  case SITE_MOHR_COULOMB:
    return make_mohr_coulomb(c, l, out);
  case SITE_CYCLIC_SAND:
    return make_cyclic_sand(c, l, out);
  default:
    return mps_material_create_linear_elastic(c, young_of(l), l->poisson, out);
  }
}
