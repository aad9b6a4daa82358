/* friction.c - Coulomb friction between the particles at a node and a body, Nakamura (31)-(34).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penalty_contact.h"

#include "body/rotation.h"

/* The part of a stick force that a body leaves: 1 for a prescribed one. A free one moves too: two
 * masses m (`all_mass`, of all nodes in contact) and M (the body's, at this point and along the
 * unit vector `along`) lose their relative velocity by the reduced mass m M/(m + M). */
static double stick_share(const mps_body *body, int dim, double all_mass, const double *x,
                          const double *along) {
  if (body->def.motion == MPS_BODY_MOTION_DRIVEN) return 1.0;
  const double *R = body->pose.R;
  const double r[3] = {x[0] - body->pose.x[0], x[1] - body->pose.x[1], x[2] - body->pose.x[2]};
  const double arm[3] = {r[1] * along[2] - r[2] * along[1], r[2] * along[0] - r[0] * along[2],
                         r[0] * along[1] - r[1] * along[0]};
  double inverse = 1.0 / body->def.mass;
  for (int c = dim == 2 ? 2 : 0; c < 3; c++) { /* the body's axes are the principal ones */
    const double own = R[c] * arm[0] + R[3 + c] * arm[1] + R[6 + c] * arm[2];
    inverse += own * own / body->def.inertia[c];
  }
  return 1.0 / (1.0 + all_mass * inverse);
}

bool mpsi_contact_friction(const mps_contact *contact, int dim, const mpsi_contact_node *at,
                           const mpsi_contact_motion *node, double all_mass, double dt,
                           double *force) {
  const double fn = sqrt(mpsi_dot3(at->force, at->force));
  if (!(at->mass > 0.0) || !(node->mass > 0.0) || !(fn > 0.0)) return false;
  double n[3], s[3];
  for (int c = 0; c < 3; c++) {
    n[c] = at->force[c] / fn;
    s[c] = node->v[c] - node->v0[c] - at->slip[c] / at->mass; /* velocity of slip, (31) */
  }
  const double across = mpsi_dot3(s, n); /* its tangential part, (32) */
  for (int c = 0; c < 3; c++) s[c] -= across * n[c];
  const double slip = sqrt(mpsi_dot3(s, s));
  if (!(slip > 0.0)) return false;
  for (int c = 0; c < 3; c++) s[c] /= slip;
  /* the force that would end the slip, (33), and Coulomb's bound on it, (34) */
  const double stick =
      node->mass * slip / dt * stick_share(contact->body, dim, all_mass, node->x, s);
  const double f = fmin(stick, contact->friction * fn);
  for (int c = 0; c < 3; c++) force[c] = -f * s[c];
  return true;
}
