/* contact.h - one particle against one body: seed B (27), (28).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_CONTACT_H
#define MPSI_MPM_CONTACT_H

#include "shape.h"

typedef struct mpsi_contact {
  double force[2]; /* normal force on the particle, N */
  double slip[2];  /* velocity of the surface less that of the particle's material there, m/s */
  int32_t part;    /* of the surface */
} mpsi_contact;

/* False where the particle does not touch the body. The state of the particle is that at the
 * beginning of the step. */
MPSI_INLINE bool mpsi_touches(const mps_mpm *mpm, const mps_body *body, int64_t particle,
                              mpsi_contact *out) {
  const mpsi_columns *p = &mpm->p;
  const double x[2] = {p->x[0][particle], p->x[1][particle]};
  const mpsi_foot foot = mpsi_body_foot(body, x);
  const double d = foot.distance - mpm->gap;
  if (!(d < 0.0)) return false;
  double k = mpsi_body_penalty(body, mpm->modulus, 2.0 * mpm->gap, mpm->def.cell, mpm->def.courant);
  if (mpm->def.geometry == MPS_AXISYMMETRIC) k *= x[0];
  const double dx = foot.at[0] - x[0], dy = foot.at[1] - x[1];
  double v[3];
  mpsi_body_velocity(&body->pose, foot.at, v);
  for (int c = 0; c < 2; c++) {
    out->force[c] = -k * d * foot.normal[c];
    out->slip[c] =
        v[c] - (p->v[c][particle] + p->L[2 * c][particle] * dx + p->L[2 * c + 1][particle] * dy);
  }
  out->part = body->part_of[foot.face];
  return true;
}

#endif
