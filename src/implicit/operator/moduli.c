/* moduli.c - Lame's constants of the particles, from the fields `young` and `poisson`.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "moduli.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/body/joints.h"
#include "implicit/body/window.h"
#include "implicit/operator/budget.h"

#include <string.h>

#define MOST_POISSON 0.49 /* in plane strain and space, without a warning */
#define MOST_CONTRAST 1e8 /* of Young's moduli in a body, without a warning */

static mps_status check_moduli(mps_elastic *e, const char *function, int64_t i, double young,
                               double poisson) {
  const double least = !e->conservative ? 0.0 : -0.99;
  if (!(young >= MPSI_ELASTIC_LEAST && young <= MPSI_ELASTIC_MOST))
    return mpsi_elastic_bad_value(e, function, "young", i, young, "allowed is 1e-30 to 1e30 (Pa)");
  if (poisson >= least && poisson < 0.5) return MPS_OK;
  return mpsi_elastic_bad_value(e, function, "poisson", i, poisson,
                                least < 0.0
                                    ? "must be at least -0.99 and below 0.5"
                                    : "must be at least 0 and below 0.5 (published method)");
}

mps_status mpsi_elastic_set_moduli(mps_elastic *e, const char *function, int64_t i, double young,
                                   double poisson) {
  MPSI_TRY(check_moduli(e, function, i, young, poisson));
  const double two_mu = young / (1.0 + poisson);
  const bool plane_stress = e->dim == 2 && e->def.state == MPS_ELASTIC_STATE_PLANE_STRESS;
  e->mu[i] = 0.5 * two_mu;
  e->lambda[i] = two_mu * poisson / (plane_stress ? 1.0 - poisson : 1.0 - 2.0 * poisson);
  e->poisson[i] = poisson;
  return MPS_OK;
}

mps_status mpsi_elastic_read_material(mps_elastic *e, const char *function) {
  double *young = mpsi_alloc(e->context, 2 * e->n, sizeof *young);
  if (!young) return mpsi_fail_memory(e->context, function, (size_t)(2 * e->n) * sizeof *young);
  double *poisson = young + e->n;
  mps_status status = mpsi_elastic_read(e, function, "young", young, 1);
  if (status == MPS_OK) status = mpsi_elastic_read(e, function, "poisson", poisson, 1);
  for (int64_t i = 0; i < e->n && status == MPS_OK; i++)
    status = check_moduli(e, function, i, young[i], poisson[i]);
  for (int64_t i = 0; i < e->n && status == MPS_OK; i++)
    status = mpsi_elastic_set_moduli(e, function, i, young[i], poisson[i]);
  mpsi_free(e->context, young);
  return status;
}

/* Where the volume is all but kept, the change of volume in each cell is one condition too many for
 * the particles around it: in plane strain a beam ten cells high lacks 4, 19, 34 % of its
 * deflection with 0.499, 0.4999, 0.49999. */
static void warn_of_volume(const mps_elastic *e) {
  double most = 0.0;
  if (e->dim == 2 && e->def.state == MPS_ELASTIC_STATE_PLANE_STRESS) return;
  for (int64_t i = 0; i < e->n; i++) most = fmax(most, e->poisson[i]);
  if (!(most > MOST_POISSON * (1.0 + 1e-9))) return;
  mpsi_log(e->context, MPS_CONTEXT_LOG_WARNING,
           "poisson is up to %g, above %g: the body is too stiff by up to a third where its cells "
           "are few, and stresses are wrong by factors; take %g where the volume is to be kept",
           most, MOST_POISSON, MOST_POISSON);
}

/* The equations of a soft body with hard inclusions are solved to the rounding of the hard ones'
 * forces: the remaining digits of the soft body. The energy that this adds is `scheme`. */
void mpsi_elastic_warn_of_moduli(const mps_elastic *e) {
  double least = INFINITY, most = 0.0;
  for (int64_t i = 0; i < e->n; i++) {
    const double young = 2.0 * e->mu[i] * (1.0 + e->poisson[i]);
    least = fmin(least, young), most = fmax(most, young);
  }
  warn_of_volume(e);
  if (!(most > MOST_CONTRAST * (1.0 + 1e-9) * least)) return; /* rounding */
  mpsi_log(
      e->context, MPS_CONTEXT_LOG_WARNING,
      "Young's modulus is %g to %g Pa in one body, a contrast of %.3g: above %g rounding "
      "may add energies of %.1g of the largest term of the budget; particles that are to be rigid "
      "can be held by a boundary, or be 1e4 times as stiff as the others",
      least, most, most / least, MOST_CONTRAST, 1e-14 * most / least);
}

mps_status mpsi_elastic_renew_material(mps_elastic *e, const char *function) {
  const size_t bytes = (size_t)e->n * sizeof(double);
  double *const moduli[3] = {e->lambda, e->mu, e->poisson};
  double *former = mpsi_alloc(e->context, 3 * e->n, sizeof *former);
  if (!former) return mpsi_fail_memory(e->context, function, 3 * bytes);
  for (int k = 0; k < 3; k++) memcpy(former + k * e->n, moduli[k], bytes);
  mps_status status = mpsi_elastic_note_strain(e, function);
  if (status == MPS_OK)
    status = mpsi_fail_of(e->context, mpsi_elastic_read_material(e, function), "e");
  if (status == MPS_OK) status = mpsi_elastic_find_joints(e, function);
  if (status == MPS_OK) mpsi_elastic_measure(e);
  if (status == MPS_OK) mpsi_elastic_warn_of_moduli(e);
  if (status == MPS_OK) e->unread = false;
  for (int k = 0; k < 3 && status != MPS_OK; k++) memcpy(moduli[k], former + k * e->n, bytes);
  mpsi_free(e->context, former);
  return status;
}
