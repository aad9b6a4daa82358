/* impulse.c - see impulse.h. SPDX-License-Identifier: BSD-3-Clause */
#include "impulse.h"

#include <string.h>

#define LARGEST_STRAIN 0.2 /* elastic: beyond it the law's own answer is not a size any more */
#define RECOVERED 0.05     /* of an overlap, in a step: more is rougher */
#define LEAST_MOBILE 1e-3  /* of the direction that gives most */
#define FASTEST 0.02       /* of the waves, at which an overlap opens: it must not throw */

/* As fmax, without a call. */
static inline double larger(double a, double b) { return b > a ? b : a; }

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
  for (int a = body->dim == 2 ? 2 : 0; a < 3; a++) {
    const double own = (R[a] * m[0] + R[3 + a] * m[1] + R[6 + a] * m[2]) / body->def.inertia[a];
    for (int c = 0; c < 3; c++) spin[c] += R[3 * c + a] * own;
  }
}

void mpsi_impulse_begin_body(mpsi_impulse_body *b, const mps_body *body, double dt) {
  const mps_body_def *def = &body->def;
  *b = (mpsi_impulse_body){.body = body, .free = def->motion != MPS_BODY_MOTION_PRESCRIBED};
  memcpy(b->v, body->pose.v, sizeof b->v);
  memcpy(b->spin, body->pose.spin, sizeof b->spin);
  for (int k = 0; k < 2; k++) b->left[k] = b->free ? 1.0 / (1.0 + dt * def->damping[k]) : 1.0;
  if (!b->free) return;
  double moment[3], spin[3];
  for (int c = 0; c < 3; c++) moment[c] = dt * body->load.moment[c] + body->pending.moment[c];
  spin_by(body, moment, spin);
  for (int c = 0; c < 3; c++) {
    const double force = dt * body->load.force[c] + body->pending.force[c];
    b->v[c] = b->left[0] * (b->v[c] + force / def->mass + dt * def->gravity[c]);
    b->spin[c] = b->left[1] * (b->spin[c] + spin[c]);
  }
}

double mpsi_impulse_mobility(const mps_body *body, const double *x, const double *along) {
  if (body->def.motion == MPS_BODY_MOTION_PRESCRIBED) return 0.0;
  double r[3], arm[3], spin[3];
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
    b->v[c] -= b->left[0] * by[c] / b->body->def.mass;
    b->spin[c] += b->left[1] * spin[c];
  }
}

/* ---- a contact ------------------------------------------------------------------------------- */

/* Takes T back to what the surface bears: the cone |T| <= mu P, with adhesion and up to a strength.
 */
static void into_cone(const mpsi_impulse *c, double *rub) {
  const double cone = c->push > 0.0 ? c->friction * c->push + c->adhesion : 0.0;
  const double square = mpsi_dot3(rub, rub), most = cone < c->strength ? cone : c->strength;
  if (!(square > most * most)) return; /* most contacts stick: no root */
  const double share = most / sqrt(square);
  for (int a = 0; a < 3; a++) rub[a] *= share;
}

/* 1/m_c along the unit vector d, > 0: that of the weakest direction counts for a thousandth at
 * least, where walls hold the nodes. Of a vector of another length, whose square is `square`: times
 * that. */
static double mobility_along(const mpsi_impulse *c, const mpsi_impulse_body *b, const double *d,
                             double square) {
  const double *m = c->mobility, most = larger(m[0], larger(m[1], m[2]));
  const double own = m[0] * d[0] * d[0] + m[1] * d[1] * d[1] + m[2] * d[2] * d[2];
  return larger(own, LEAST_MOBILE * most * square) +
         (b->free ? mpsi_impulse_mobility(b->body, c->at, d) : 0.0);
}

void mpsi_impulse_warm(mpsi_impulse *c, const mpsi_impulse_body *b, const double *last,
                       double share, double *by) {
  const double across = mpsi_dot3(last, c->normal);
  c->inertia = 1.0 / mobility_along(c, b, c->normal, 1.0);
  c->push = larger(0.0, share * across);
  for (int a = 0; a < 3; a++)
    c->rub[a] = c->push > 0.0 ? share * (last[a] - across * c->normal[a]) : 0.0;
  into_cone(c, c->rub);
  for (int a = 0; a < 3; a++) by[a] = c->push * c->normal[a] + c->rub[a];
}

/* Visits are many and each waits for the one before: the slip is not brought to unit length, which
 * saves a root and three divisions. */
bool mpsi_impulse_visit(mpsi_impulse *c, const mpsi_impulse_body *b, const double *u, double *by) {
  const double across = mpsi_dot3(u, c->normal), before = c->push;
  c->push = larger(0.0, before + (c->aim - across) * c->inertia);
  for (int a = 0; a < 3; a++) by[a] = (c->push - before) * c->normal[a];
  if (c->friction > 0.0 || c->adhesion > 0.0) {
    double slip[3], rub[3];
    for (int a = 0; a < 3; a++) slip[a] = u[a] - across * c->normal[a];
    const double square = mpsi_dot3(slip, slip);
    const double stop = square > 0.0 ? square / mobility_along(c, b, slip, square) : 0.0;
    for (int a = 0; a < 3; a++) rub[a] = c->rub[a] - stop * slip[a];
    into_cone(c, rub);
    for (int a = 0; a < 3; a++) {
      by[a] += rub[a] - c->rub[a];
      c->rub[a] = rub[a];
    }
  }
  return by[0] != 0.0 || by[1] != 0.0 || by[2] != 0.0;
}
