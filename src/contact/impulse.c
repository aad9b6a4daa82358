/* impulse.c - see impulse.h. SPDX-License-Identifier: BSD-3-Clause */
#include "update.h"

#include <string.h>

#define LARGEST_STRAIN 0.2 /* bound of the elastic strain that changes the size of a particle */
#define RECOVERED 0.05     /* fraction of an overlap removed in a step */
#define FASTEST 0.02       /* of the wave speed: most at which an overlap opens */

/* ---- geometry -------------------------------------------------------------------------------- */

double mpsi_impulse_half_size(double half, double wave, double shear, const double *stress,
                              const double *n) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  if (!(shear > 0.0)) return half;
  double across = 0.0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) across += n[a] * n[b] * stress[symmetric[a][b]];
  const double lame = wave - 2.0 * shear, trace = stress[0] + stress[1] + stress[2];
  const double strain = (across - lame / (3.0 * lame + 2.0 * shear) * trace) / (2.0 * shear);
  return half * (1.0 + fmin(LARGEST_STRAIN, fmax(-LARGEST_STRAIN, strain)));
}

double mpsi_impulse_aim(double gap, double dt, double usual, double speed) {
  return gap > 0.0 ? -gap / dt : fmin(-RECOVERED * gap / usual, FASTEST * speed);
}

/* ---- the body's side ------------------------------------------------------------------------- */

/* Component a of R I^-1 R^T m: the spin by a unit of time of the moment m. The body's axes are the
 * principal ones; in the plane it turns about z alone. */
static void spin_by(const mps_body *body, const double *m, double *spin) {
  const double *R = body->pose.R;
  for (int c = 0; c < 3; c++) spin[c] = 0.0;
  if (body->axial) return;
  for (int a = body->dim == 2 ? 2 : 0; a < 3; a++) {
    const double own = (R[a] * m[0] + R[3 + a] * m[1] + R[6 + a] * m[2]) / body->def.inertia[a];
    for (int c = 0; c < 3; c++) spin[c] += R[3 * c + a] * own;
  }
}

void mpsi_impulse_begin_body(mpsi_impulse_body *b, const mps_body *body, double dt) {
  const mps_body_def *def = &body->def;
  *b = (mpsi_impulse_body){.body = body, .free = def->motion != MPS_BODY_MOTION_DRIVEN};
  memcpy(b->v, body->pose.v, sizeof b->v);
  memcpy(b->spin, body->pose.spin, sizeof b->spin);
  for (int k = 0; k < 2; k++) b->left[k] = b->free ? 1.0 / (1.0 + dt * def->damping[k]) : 1.0;
  if (!b->free) return;
  double moment[3], spin[3];
  for (int c = 0; c < 3; c++) moment[c] = dt * body->load.moment[c] + body->pending.moment[c];
  spin_by(body, moment, spin);
  for (int c = 0; c < 3; c++) {
    const double force = dt * body->load.force[c] + body->pending.force[c];
    b->spin[c] = b->left[1] * (b->spin[c] + spin[c]);
    if (!mpsi_body_moves_along(body, c)) continue;
    b->v[c] = b->left[0] * (b->v[c] + force / def->mass + dt * def->gravity[c]);
  }
}

double mpsi_impulse_mobility(const mps_body *body, const double *x, const double *along) {
  if (body->def.motion == MPS_BODY_MOTION_DRIVEN) return 0.0;
  double r[3], arm[3], spin[3];
  if (body->axial) return along[1] * along[1] / body->def.mass;
  for (int c = 0; c < 3; c++) r[c] = x[c] - body->pose.x[c];
  mpsi_cross3(r, along, arm);
  spin_by(body, arm, spin);
  return mpsi_dot3(along, along) / body->def.mass + mpsi_dot3(arm, spin);
}

void mpsi_impulse_kick(mpsi_impulse_body *b, const double *x, const double *by) {
  if (!b->free) return;
  double r[3], moment[3], spin[3];
  for (int c = 0; c < 3; c++) r[c] = x[c] - b->body->pose.x[c];
  mpsi_cross3(by, r, moment); /* r x -by */
  spin_by(b->body, moment, spin);
  for (int c = 0; c < 3; c++) {
    b->spin[c] += b->left[1] * spin[c];
    if (mpsi_body_moves_along(b->body, c)) b->v[c] -= b->left[0] * by[c] / b->body->def.mass;
  }
}

/* ---- a contact ------------------------------------------------------------------------------- */

void mpsi_impulse_warm(mpsi_impulse *c, const mpsi_impulse_body *b, const double *last,
                       double fraction, double *by) {
  const double across = mpsi_dot3(last, c->normal);
  c->inertia = 1.0 / mpsi_impulse_mobility_along(c, b, c->normal, 1.0);
  c->even = !b->free && c->mobility[0] == c->mobility[1] && c->mobility[1] == c->mobility[2];
  c->normal_impulse = mpsi_larger(0.0, fraction * across);
  for (int a = 0; a < 3; a++)
    c->tangent_impulse[a] =
        c->normal_impulse > 0.0 ? fraction * (last[a] - across * c->normal[a]) : 0.0;
  mpsi_impulse_into_cone(c, c->tangent_impulse);
  for (int a = 0; a < 3; a++) by[a] = c->normal_impulse * c->normal[a] + c->tangent_impulse[a];
}
