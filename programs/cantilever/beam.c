/* beam.c - the exact solution of the cantilever, Chikazawa (11) (Timoshenko and Goodier, article
 * 21). SPDX-License-Identifier: BSD-3-Clause */
#include "cantilever.h"

/* In plane strain E and nu are replaced by E / (1 - nu^2) and nu / (1 - nu). */
static double plane_young(const beam *b) {
  return b->plane_strain ? b->young / (1.0 - b->poisson * b->poisson) : b->young;
}

static double plane_poisson(const beam *b) {
  return b->plane_strain ? b->poisson / (1.0 - b->poisson) : b->poisson;
}

static double inertia(const beam *b) { return b->height * b->height * b->height / 12.0; }

void beam_displacement(const beam *b, double x, double y, double *u) {
  const double l = b->length, nu = plane_poisson(b), half = 0.5 * b->height;
  const double scale = b->load / (plane_young(b) * inertia(b));
  u[0] = scale *
         (0.5 * x * x * y + nu * y * y * y / 6.0 - (1.0 + nu) * y * y * y / 3.0 - 0.5 * l * l * y);
  u[1] = -scale / 6.0 *
         (x * x * x - 3.0 * l * l * x + 2.0 * l * l * l + 6.0 * (1.0 + nu) * half * half * (l - x) +
          3.0 * nu * x * y * y);
}

void beam_stress(const beam *b, double x, double y, double *stress) {
  stress[0] = b->load / inertia(b) * x * y;
  stress[1] = 0.0;
  stress[2] = 0.5 * b->load / inertia(b) * (0.25 * b->height * b->height - y * y);
}

void beam_traction(const beam *b, double y, double *traction) {
  double stress[3];
  beam_stress(b, 0.0, y, stress);
  traction[0] = -stress[0];
  traction[1] = -stress[2];
}

void beam_wall(const beam *b, double y, double *u) {
  u[0] = u[1] = 0.0;
  if (!b->clamped) beam_displacement(b, b->length, y, u);
}

void beam_lame(const beam *b, double *lambda, double *mu) {
  *mu = 0.5 * b->young / (1.0 + b->poisson);
  *lambda = 2.0 * *mu * b->poisson / (b->plane_strain ? 1.0 - 2.0 * b->poisson : 1.0 - b->poisson);
}
