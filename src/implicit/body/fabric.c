/* fabric.c - hashes of the moduli and fixed directions to which the forces of a motion belong, so
 * that a run after a rollback or from a file is the same as an uninterrupted one.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fabric.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"

#include "core/base/hash.h"

#include <string.h>

void mpsi_elastic_find_fabric(mps_elastic *e, int64_t fabric[2]) {
  if (!e->fabric_known) {
    const size_t bytes = (size_t)e->n * sizeof(double);
    uint64_t moduli = mpsi_hash(mpsi_hash(MPSI_HASH, e->lambda, bytes), e->mu, bytes);
    uint64_t held = MPSI_HASH;
    for (int64_t k = 0; k < e->support_count; k++) {
      const mpsi_support *s = &e->supports[k];
      held = mpsi_hash(held, &s->particle, sizeof s->particle);
      held = mpsi_hash(held, s->normal, (size_t)s->count * sizeof s->normal[0]);
    }
    e->fabric[MPSI_FABRIC_MODULI] = (int64_t)moduli,
    e->fabric[MPSI_FABRIC_SUPPORTS] = (int64_t)held;
    e->fabric_known = true;
  }
  memcpy(fabric, e->fabric, sizeof e->fabric);
}

/* Half of u . K u, with the moduli of the forces; without the former operator it follows from the
 * inner forces, except for stiffness damping. */
double mpsi_elastic_former_strain(mps_elastic *e, double present) {
  mpsi_elastic_motion *m = e->motion;
  int64_t now[2];
  mpsi_elastic_find_fabric(e, now);
  if (now[MPSI_FABRIC_MODULI] == m->fabric[MPSI_FABRIC_MODULI]) return present;
  if (m->strain_known) return m->strain;
  double sum = 0.0;
  for (int64_t k = 0; k < e->n * e->dim; k++) sum += 0.5 * e->displacement[k] * m->inner[k];
  return sum;
}
