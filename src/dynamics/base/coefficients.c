/* coefficients.c - coefficients of each particle for forces and steps: moduli, 1/mass, 1/inertia,
 * Rayleigh damping. SPDX-License-Identifier: BSD-3-Clause */
#include "coefficients.h"
#include "dynamics/base/dynamics_solver.h"

/* Sets a coefficient; returns whether it has changed. */
static bool put(double *at, double value) {
  const bool other = *at != value;
  *at = value;
  return other;
}

void mpsi_dynamics_choose_damping(mps_dynamics *dynamics) {
  const double *beta = dynamics->extremes.beta;
  dynamics->damping = MPSI_DYN_UNDAMPED;
  if (beta[1] > 0.0)
    dynamics->damping = beta[0] == beta[1] || dynamics->def.damping == MPS_DYNAMICS_DAMPING_PARTICLE
                            ? MPSI_DYN_BY_PARTICLES
                            : MPSI_DYN_BY_PAIRS;
}

bool mpsi_dynamics_set_coefficients(mps_dynamics *dynamics) {
  const double *rho = mpsi_dynamics_column(dynamics, "density", 0);
  const double *vs = mpsi_dynamics_column(dynamics, "shear_velocity", 0);
  const double *vp = mpsi_dynamics_column(dynamics, "pressure_velocity", 0);
  const double *h = mpsi_dynamics_column(dynamics, "damping", 0);
  const double D = mps_particles_spacing(dynamics->particles);
  const double f1 = dynamics->def.f1, f2 = dynamics->def.f2, pi = 3.14159265358979323846;
  /* I = rho D^4/6 and one half of each pair's moment to either end: 3/(rho D^2) */
  const double spin = 3.0 * dynamics->torque;
  mpsi_dynamics_extremes e = {.lightest = INFINITY, .alpha[0] = INFINITY, .beta[0] = INFINITY};
  bool other = false;
  mpsi_dynamics_state *s = &dynamics->state;
  for (int64_t k = 0; k < dynamics->count; k++) {
    const double lambda = rho[k] * (vp[k] * vp[k] - 2.0 * vs[k] * vs[k]);
    other |= put(&s->mu[k], rho[k] * vs[k] * vs[k]);
    other |= put(&s->lambda[k], lambda > 0.0 ? lambda : 0.0);
    other |= put(&s->ix[k], 1.0 / rho[k]);
    s->iy[k] = s->ix[k];
    other |= put(&s->ith[k], spin / (rho[k] * D * D));
    const double ratio = h ? h[k] : 0.0;
    other |= put(&s->alpha[k], ratio * 4.0 * pi * f1 * f2 / (f1 + f2));
    other |= put(&s->beta[k], ratio / (pi * (f1 + f2)));
    e.mu = fmax(e.mu, s->mu[k]), e.lambda = fmax(e.lambda, s->lambda[k]);
    e.lightest = fmin(e.lightest, 1.0 / s->ix[k]);
    e.alpha[0] = fmin(e.alpha[0], s->alpha[k]), e.alpha[1] = fmax(e.alpha[1], s->alpha[k]);
    e.beta[0] = fmin(e.beta[0], s->beta[k]), e.beta[1] = fmax(e.beta[1], s->beta[k]);
  }
  dynamics->extremes = e;
  mpsi_dynamics_choose_damping(dynamics);
  return other;
}
