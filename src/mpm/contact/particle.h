/* particle.h - contact of one particle with one body, by the functions of src/contact.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/columns.h"
#include "pairs.h"

/* Depth, force and slip of a particle in contact with a body, by its state at the beginning of the
 * step; false where it is not in contact. */
MPSI_INLINE bool mpsi_find_contact(const mpsi_grid *grid, const mpsi_columns *p,
                                   const mps_mpm_def *def, const mps_contact *contact, int dim,
                                   int64_t particle, mpsi_contact_particle *out) {
  double v[3], L[9];
  *out = (mpsi_contact_particle){.part = 0};
  for (int c = 0; c < dim; c++) out->x[c] = p->x[c][particle], v[c] = p->v[c][particle];
  for (int c = 0; c < dim * dim; c++) L[c] = p->L[c][particle];
  const mpsi_contact_law law = {
      .spacing = mps_particles_spacing(p->set),
      .modulus = mpsi_mpm_stiffness(p, particle) * mpsi_law_of(p, particle)->modulus,
      .cell = grid->cell,
      .courant = def->courant,
      .weight = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? grid->measure * out->x[0]
                                                                : grid->measure};
  return mpsi_contact_find(contact, dim, &law, v, L, out);
}
