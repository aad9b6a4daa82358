/* clay_points.h - two clays and the paths of a point that the tests of Cam-Clay share.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_CLAY_POINTS_H
#define MPS_TEST_CLAY_POINTS_H

#include "material_paths.h"

/* A clay with its isotropic first state. */
typedef struct clay {
  double M, lambda, kappa, nu, e0, p0, R;
} clay;

/* Normally consolidated kaolin, and a stiff clay that has borne four times its pressure. */
static const clay clays[2] = {{0.92, 0.205, 0.044, 0.25, 1.4, 100e3, 1.0},
                              {1.2, 0.10, 0.02, 0.2, 0.8, 50e3, 4.0}};

static inline mps_material_cam_clay_def clay_def(const clay *c) {
  DEF(material_cam_clay, def, .critical_slope = c->M, .compression = c->lambda,
      .swelling = c->kappa, .poisson = c->nu, .void_ratio = c->e0,
      .preconsolidation = c->R * c->p0);
  return def;
}

static inline mps_material *make_clay(const clay *c) {
  const mps_material_cam_clay_def def = clay_def(c);
  MAKE_KEPT(material, m, create_cam_clay, context, &def);
  return m;
}

/* p and q of a stress, Pa. */
static inline double clay_p(const mps_material_point *x) { return -mean_stress(x->stress); }
static inline double clay_q(const mps_material_point *x) { return ROOT3 * root_j2(x->stress); }

enum { CLAY_STRAIN, CLAY_PC, CLAY_VOID, CLAY_GAP };

#endif
