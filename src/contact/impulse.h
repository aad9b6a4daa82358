/* impulse.h - contact by impulses at the foot of a particle, whatever the solver: docs/theory/
 * contact.md derives it. A particle p with its nearest point x_c on the surface (the foot), the
 * outward normal n there and its own half size e is in contact over the gap g = D - e, D the
 * surface's distance. An impulse P n + T, with P >= 0 and |T| <= mu P, acts at x_c such that the
 * relative velocity there, u, is at least w along n (P > 0: just w) and does not slide unless |T|
 * is at its bound. The mass on the other side (nodes of a grid, ...) belongs to the solver, which
 * passes u and the mobility 1/m_c of its side. Vectors have three components, of which the last
 * is 0 in 2D. One Gauss-Seidel update is in update.h. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body/contact_internal.h"
#include "body/rotation.h"

/* ---- geometry -------------------------------------------------------------------------------- */

/* Half the size (m) along n of a particle that has half the size `half` unstrained: half (1 +
 * eps_nn), with the elastic strain of the stress (Pa; xx, yy, zz, xy, zx, yz) in a material of wave
 * modulus K + 4G/3 and shear modulus G (Pa), between +-0.2. `half` where G is 0. */
double mpsi_impulse_half_size(double half, double wave, double shear, const double *stress,
                              const double *n);

/* Whether a particle of half size `half` over the gap g (m) may be in contact within dt, where body
 * and particle approach each other by `closing` (m/s). */
static inline bool mpsi_impulse_near(double gap, double half, double closing, double dt) {
  return gap <= 0.2 * half + dt * fmax(0.0, closing);
}

/* Where the impulse acts, from the particle (0) to its foot (1): at the foot, unless the particle
 * has come nearer to the surface than 3/4 of its half size; from 1/4 on at itself. Where soil can
 * flow such that the foot is clear and the particle sinks, as below a pointed tip on the axis, that
 * keeps the particle out. */
static inline double mpsi_impulse_lever(double distance, double half) {
  return fmin(1.0, fmax(0.0, 2.0 * distance / half - 0.5));
}

/* Rest gap (m), from which the gap of a particle counts that the body bears when their contact
 * begins; 0 of others. Ground that has a stress then is at rest: its particles have the size of the
 * lattice with that stress, not without. What overlaps then bears where it is until it has come
 * off: pushed out it would keep the speed of that, energy from nothing. Only what slides along the
 * surface, as beside a cone, comes out, over a spacing. `before`: of the last step; `slid` (m):
 * since then; `half` (m): half the size of the particle. */
static inline double mpsi_impulse_rest_gap(double gap, double before, double slid, double half) {
  if (before > 0.0) return before;
  return fmin(0.0, fmax(gap, before * fmax(0.0, 1.0 - 0.5 * slid / half)));
}

/* w (m/s): a gap may close within dt, no more; a twentieth of an overlap opens again in a step of
 * the `usual` size (s, at least dt), by at most 0.02 of `speed` (m/s, of waves and particles). A
 * shorter step, as at the end of a run, opens no faster: else its force would grow as 1/dt^2. */
double mpsi_impulse_aim(double gap, double dt, double usual, double speed);

/* ---- the body's side ------------------------------------------------------------------------- */

/* A body as the impulses of a step change its velocities; its place is that before the step. */
typedef struct mpsi_impulse_body {
  const mps_body *body;
  bool free;            /* impulses move it */
  double v[3], spin[3]; /* m/s, rad/s: at the end of the step, by all that is known so far */
  double left[2];       /* what damping leaves of a change of v, of spin */
} mpsi_impulse_body;

/* The body with the velocities to which its loads, gravity, damping and impulses of other contacts
 * will bring it in dt. */
void mpsi_impulse_begin_body(mpsi_impulse_body *b, const mps_body *body, double dt);
/* Velocity v (m/s) of its surface at x. */
static inline void mpsi_impulse_surface(const mpsi_impulse_body *b, const double *x, double *v) {
  const double *center = b->body->pose.x;
  const double r[3] = {x[0] - center[0], x[1] - center[1], x[2] - center[2]};
  mpsi_cross3(b->spin, r, v);
  for (int c = 0; c < 3; c++) v[c] += b->v[c];
}
/* 1/kg: velocity at x along the unit vector `along` by a unit impulse there; 0 of a driven body. Of
 * a vector of another length: times its square. */
double mpsi_impulse_mobility(const mps_body *body, const double *x, const double *along);
/* The impulse `by` (N s) on the particle at x takes its opposite to the body. */
void mpsi_impulse_kick(mpsi_impulse_body *b, const double *x, const double *by);

/* ---- a contact ------------------------------------------------------------------------------- */

typedef struct mpsi_impulse {
  double at[3], normal[3];                   /* m, where it acts; n */
  double aim;                                /* m/s, w */
  double mobility[3];                        /* 1/kg, 1/m_c of the solver's side along x, y, z */
  double friction;                           /* mu */
  double adhesion;                           /* N s, what |T| may be besides mu P where P > 0, */
  double strength;                           /* and at all; INFINITY: no bound */
  double normal_impulse, tangent_impulse[3]; /* N s: P; T */
  double inertia; /* kg: 1 over the mobility of both sides along n; mpsi_impulse_warm */
  bool even;      /* that mobility is the same in all directions; likewise */
} mpsi_impulse;

/* Begins with `share` of the last step's impulse `last` (N s), split on the present normal, or with
 * none where that pulled; `by` (N s) is what acts on the particle. Before all updates of a step. */
void mpsi_impulse_warm(mpsi_impulse *c, const mpsi_impulse_body *b, const double *last,
                       double fraction, double *by);
