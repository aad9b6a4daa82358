/* update.h - one Gauss-Seidel update of a contact (impulse.h), for the loops of a sweep: updates
 * are many, and each depends on the previous one. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "impulse.h"

#include <math.h>

#define MPSI_LEAST_MOBILE 1e-3 /* of the direction that gives most */

/* As fmax, without a call. */
static inline double mpsi_larger(double a, double b) { return b > a ? b : a; }

/* Takes T back to what the surface bears: the cone |T| <= mu P, with adhesion and up to a strength.
 */
static inline void mpsi_impulse_into_cone(const mpsi_impulse *c, double *tangent_impulse) {
  const double cone = c->normal_impulse > 0.0 ? c->friction * c->normal_impulse + c->adhesion : 0.0;
  const double square = mpsi_dot3(tangent_impulse, tangent_impulse),
               most = cone < c->strength ? cone : c->strength;
  if (!(square > most * most)) return; /* most contacts stick: no root */
  const double fraction = most / sqrt(square);
  for (int a = 0; a < 3; a++) tangent_impulse[a] *= fraction;
}

/* 1/m_c along the unit vector d, > 0: that of the weakest direction counts for a thousandth at
 * least, where boundaries fix the nodes. Of a vector of another length, whose square is `square`: times
 * that. */
static inline double mpsi_impulse_mobility_along(const mpsi_impulse *c, const mpsi_impulse_body *b,
                                                 const double *d, double square) {
  const double *m = c->mobility, most = mpsi_larger(m[0], mpsi_larger(m[1], m[2]));
  const double own = m[0] * d[0] * d[0] + m[1] * d[1] * d[1] + m[2] * d[2] * d[2];
  return mpsi_larger(own, MPSI_LEAST_MOBILE * most * square) +
         (b->free ? mpsi_impulse_mobility(b->body, c->at, d) : 0.0);
}

/* One Gauss-Seidel update: P and T such that the contact alone, all others as they are, is
 * satisfied from the relative velocity u (m/s, of the particle's side less the body's, at the
 * foot). `by` (N s) is the change on the particle. Returns whether there is any. The slip is not
 * brought to unit length, which saves a root and three divisions. An update depends on the previous
 * one, so that every operation in a row counts. */
static inline bool mpsi_impulse_update(mpsi_impulse *c, const mpsi_impulse_body *b, const double *u,
                                       double *by) {
  const double across = mpsi_dot3(u, c->normal), before = c->normal_impulse;
  c->normal_impulse = mpsi_larger(0.0, before + (c->aim - across) * c->inertia);
  if (before == 0.0 && c->normal_impulse == 0.0)
    return false; /* nor was there a T, nor may there be */
  for (int a = 0; a < 3; a++) by[a] = (c->normal_impulse - before) * c->normal[a];
  if (c->friction > 0.0 || c->adhesion > 0.0) {
    double slip[3], tangent_impulse[3];
    for (int a = 0; a < 3; a++) slip[a] = u[a] - across * c->normal[a];
    double stop = c->inertia;
    if (!c->even) {
      const double square = mpsi_dot3(slip, slip);
      stop = square > 0.0 ? square / mpsi_impulse_mobility_along(c, b, slip, square) : 0.0;
    }
    for (int a = 0; a < 3; a++) tangent_impulse[a] = c->tangent_impulse[a] - stop * slip[a];
    mpsi_impulse_into_cone(c, tangent_impulse);
    for (int a = 0; a < 3; a++) {
      by[a] += tangent_impulse[a] - c->tangent_impulse[a];
      c->tangent_impulse[a] = tangent_impulse[a];
    }
  }
  return by[0] != 0.0 || by[1] != 0.0 || by[2] != 0.0;
}
