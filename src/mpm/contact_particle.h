/* contact_particle.h - one particle against one body: Nakamura (27), (28).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_CONTACT_PARTICLE_H
#define MPSI_MPM_CONTACT_PARTICLE_H

#include "mpm_private.h"

typedef struct mpsi_contact_particle {
  double x[3];     /* of the particle, m */
  double force[3]; /* normal force on the particle, N */
  double slip[3];  /* velocity of the surface less that of the particle's material there, m/s */
  int32_t part;    /* of the surface */
} mpsi_contact_particle;

/* False where the particle does not touch the body. The state of the particle is that at the
 * beginning of the step. */
MPSI_INLINE bool mpsi_find_contact(const mps_mpm *mpm, const mps_body *body, int dim,
                                   int64_t particle, mpsi_contact_particle *out) {
  const mpsi_columns *p = &mpm->p;
  *out = (mpsi_contact_particle){.part = 0};
  for (int c = 0; c < dim; c++) out->x[c] = p->x[c][particle];
  const mpsi_foot foot = mpsi_body_foot(body, out->x);
  const double d = foot.distance - mpm->contact.gap;
  if (!(d < 0.0)) return false;
  double k = mpsi_body_penalty(body, mpsi_law_of(mpm, particle)->modulus, 2.0 * mpm->contact.gap,
                               mpm->def.cell, mpm->def.courant);
  if (mpm->def.geometry == MPS_AXISYMMETRIC) k *= out->x[0];
  double v[3];
  mpsi_body_velocity(&body->pose, foot.at, v);
  for (int c = 0; c < dim; c++) {
    double material = p->v[c][particle];
    for (int a = 0; a < dim; a++)
      material += p->L[dim * c + a][particle] * (foot.at[a] - out->x[a]);
    out->force[c] = -k * d * foot.normal[c];
    out->slip[c] = v[c] - material;
  }
  out->part = body->part_of[foot.face];
  return true;
}

#endif
