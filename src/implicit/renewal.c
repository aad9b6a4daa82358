/* renewal.c - boundaries or moduli that change while a motion is under way.
 *
 * A step begins with M a + C v + K u = F + R at the present time, from which the last step has left
 * its acceleration, its inner forces K (u + a1 v) and what boundaries hold. Where K or what is held
 * is another now, these are found again before the next step, for the present displacements and
 * velocities: what is free gets the acceleration that balances it, what is held that of its
 * boundary. The strain energy that other moduli give the present displacements is no work: the
 * budget goes on from it (mpsi_elastic_former_strain).
 *
 * Which moduli and fixed directions the forces are of is known by hashes, so that a rollback or a
 * file leads to the same as going on. SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_private.h"

#include "core/hash.h"

#include <string.h>

enum { MODULI, SUPPORTS };

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
    e->fabric[MODULI] = (int64_t)moduli, e->fabric[SUPPORTS] = (int64_t)held;
    e->fabric_known = true;
  }
  memcpy(fabric, e->fabric, sizeof e->fabric);
}

/* Half of u . K u, of the moduli that the forces are of; without a look at the former operator the
 * inner forces tell it but for stiffness damping. */
double mpsi_elastic_former_strain(mps_elastic *e, double present) {
  mpsi_elastic_motion *m = e->motion;
  int64_t now[2];
  mpsi_elastic_find_fabric(e, now);
  if (now[MODULI] == m->fabric[MODULI]) return present;
  if (m->strain_known) return m->strain;
  double sum = 0.0;
  for (int64_t k = 0; k < e->n * e->dim; k++) sum += 0.5 * e->displacement[k] * m->inner[k];
  return sum;
}

mps_status mpsi_elastic_note_strain(mps_elastic *e, const char *function) {
  mpsi_elastic_motion *m = e->motion;
  int64_t now[2];
  if (!m) return MPS_OK;
  mpsi_elastic_find_fabric(e, now);
  if (now[MODULI] != m->fabric[MODULI]) return MPS_OK; /* of the first of several changes */
  const mps_status status = mpsi_elastic_strain_energy(e, function, &m->strain);
  m->strain_known = status == MPS_OK;
  return status;
}

mps_status mpsi_elastic_renew_motion(mps_elastic *e, const char *function) {
  mpsi_elastic_motion *m = e->motion;
  int64_t now[2];
  double strain = 0.0;
  mpsi_elastic_find_fabric(e, now);
  if (memcmp(now, m->fabric, sizeof now) == 0) return MPS_OK;
  const bool other = now[MODULI] != m->fabric[MODULI];
  mps_status status = mpsi_elastic_drive(e, function, m->time);
  if (status == MPS_OK && other) status = mpsi_elastic_strain_energy(e, function, &strain);
  if (status != MPS_OK) return status;
  double *inner = m->next[MPSI_NEXT_INNER], *held = m->next[MPSI_NEXT_HELD];
  memcpy(e->load, m->force, (size_t)(e->n * e->dim) * sizeof *m->force);
  status = mpsi_elastic_find_forces(e, function, e->displacement, m->velocity, inner, held);
  if (status != MPS_OK) return status;
  if (other) e->ledger.strain += strain - mpsi_elastic_former_strain(e, strain);
  memcpy(m->inner, inner, (size_t)(e->n * e->dim) * sizeof *inner);
  memcpy(m->held, held, (size_t)(e->n * e->dim) * sizeof *held);
  mpsi_elastic_balance(e);
  mpsi_elastic_keep_fixed(e, m->held);
  memcpy(m->fabric, now, sizeof now);
  m->strain_known = false;
  return MPS_OK;
}
