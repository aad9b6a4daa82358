/* window.c - the particles whose neighbours, joints and stiffnesses a rank has: those of its
 * window, or the whole body; volumes and pair stiffnesses there.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "window.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/body/bending.h"
#include "solver/linear.h"

void mpsi_elastic_measure(mps_elastic *e) {
  const int d = e->dim;
  for (int64_t i = 0; i < e->n; i++) {
    e->volume[i] =
        d == 2 ? e->spacing * e->spacing * e->def.measure : e->spacing * e->spacing * e->spacing;
    for (int bit = 0; bit < 2 * d; bit++)
      if (e->cut[i] & 1 << bit) e->volume[i] *= 0.5;
  }
  for (int64_t k = e->window.from; k < e->window.to; k++) {
    const int64_t i = mpsi_elastic_in_order(e, k), slot = mpsi_elastic_slot(e, i);
    e->kappa[slot] = e->conservative
                         ? 2.0 * e->def.alpha * e->mu[i] * d * e->volume[i] / e->density[slot]
                         : 2.0 * e->mu[i] * d * e->volume[i] / e->density0;
  }
  mpsi_elastic_measure_bending(e);
  e->values_valid = e->fabric_known = false;
}

/* Do all ranks of the domain solve together with the present solver? */
static bool solves_together(const mps_elastic *e) {
  return mpsi_linear_serves(&e->base, e->n * e->dim) && e->conservative && mpsi_domain_many(e->domain);
}

mps_status mpsi_elastic_choose_window(mps_elastic *e, const char *function) {
  const bool shared = solves_together(e);
  if (e->shared == shared) return MPS_OK;
  mps_elastic next = *e, former = *e;
  next.shared = shared;
  mpsi_elastic_lose_window(&next);
  mps_status status = mpsi_elastic_connect(&next, function);
  if (status == MPS_OK) status = mpsi_elastic_find_joints(&next, function);
  if (status != MPS_OK) {
    mpsi_elastic_disconnect(&next);
    mpsi_elastic_drop_joints(&next);
    mpsi_free(e->context, next.bending);
    return status;
  }
  *e = next;
  mpsi_elastic_disconnect(&former);
  mpsi_elastic_drop_joints(&former);
  mpsi_free(e->context, former.bending);
  mpsi_elastic_measure(e);
  e->pattern_valid = false;
  return MPS_OK;
}
