/* renewal.c - boundaries or moduli that change while a motion is under way.
 *
 * A step begins with M a + C v + K u = F + R at the present time, of which the last step keeps the
 * acceleration, the inner forces K (u + a1 v) and the reactions. Where K or the fixed directions
 * have changed, these are computed again before the next step, for the present displacements and
 * velocities: free directions get the acceleration of the balance of forces, fixed ones that of
 * their boundary. The change of strain energy by a change of moduli is no work: the budget
 * continues from the new value (mpsi_elastic_former_strain, fabric.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "renewal.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/body/fabric.h"
#include "implicit/operator/operator.h"

#include <string.h>

mps_status mpsi_elastic_find_forces(mps_elastic *e, const char *function, const double *u,
                                    const double *v, double *inner, double *held) {
  mpsi_elastic_motion *m = e->motion;
  const int64_t all = e->n * e->dim;
  for (int64_t k = 0; k < all; k++) m->scratch[k] = u[k] + m->a1 * v[k];
  const mps_status status = mpsi_elastic_apply(e, function, m->scratch, inner);
  for (int64_t k = 0; k < all; k++)
    held[k] = inner[k] + m->a0 * e->mass[k / e->dim] * v[k] - e->load[k];
  return status;
}

void mpsi_elastic_balance(mps_elastic *e) {
  mpsi_elastic_motion *m = e->motion;
  const int64_t all = e->n * e->dim;
  for (int64_t k = 0; k < all; k++) m->acceleration[k] = -m->held[k] / e->mass[k / e->dim];
  mpsi_elastic_impose(e, 2, m->acceleration);
}

mps_status mpsi_elastic_renew_motion(mps_elastic *e, const char *function) {
  mpsi_elastic_motion *m = e->motion;
  int64_t now[2];
  double strain = 0.0;
  mpsi_elastic_find_fabric(e, now);
  if (memcmp(now, m->fabric, sizeof now) == 0) return MPS_OK;
  const bool other = now[MPSI_FABRIC_MODULI] != m->fabric[MPSI_FABRIC_MODULI];
  MPSI_TRY(mpsi_elastic_drive(e, function, m->time));
  if (other) MPSI_TRY(mpsi_elastic_strain_energy(e, function, &strain));
  double *inner = m->next[MPSI_NEXT_INNER], *held = m->next[MPSI_NEXT_HELD];
  memcpy(e->load, m->force, (size_t)(e->n * e->dim) * sizeof *m->force);
  MPSI_TRY(mpsi_elastic_find_forces(e, function, e->displacement, m->velocity, inner, held));
  if (other) e->ledger.strain += strain - mpsi_elastic_former_strain(e, strain);
  memcpy(m->inner, inner, (size_t)(e->n * e->dim) * sizeof *inner);
  memcpy(m->held, held, (size_t)(e->n * e->dim) * sizeof *held);
  mpsi_elastic_balance(e);
  mpsi_elastic_keep_fixed(e, m->held);
  memcpy(m->fabric, now, sizeof now);
  m->strain_known = false;
  return MPS_OK;
}
