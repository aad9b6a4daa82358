/* penalty_contact.h - contact of particles with rigid bodies, whatever the solver: the normal force
 * on a particle, Nakamura (27), (28); Coulomb friction at a node, (31)-(34); which nodes of a grid
 * a particle at a surface may use, Nakamura 5.1; and the force on the body. How a solver finds what
 * is near a body, and keeps sums at its nodes, is its own: WLS-MPM does so in mpm/contact/pairs.c
 * and inside.c. Vectors have three components, of which the last is 0 in 2D.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body/contact_internal.h"

/* ---- a particle at a surface ----------------------------------------------------------------- */

/* How stiff a contact is: see mpsi_contact_penalty. */
typedef struct mpsi_contact_law {
  double spacing; /* m, of the particles */
  double modulus; /* Pa, K + 4G/3 of the particle's material */
  double cell;    /* m */
  double courant;
  double weight; /* factor of the stiffness: measure, and the radius (m) in axisymmetry */
} mpsi_contact_law;

typedef struct mpsi_contact_particle {
  double x[3];     /* of the particle, m */
  double force[3]; /* normal force on the particle, N */
  double slip[3];  /* velocity of the surface less that of the particle's material there, m/s */
  int32_t part;    /* of the surface */
  double depth;    /* m, below the surface; negative above */
} mpsi_contact_particle;

/* The contact of the particle at out->x, with velocity v and its gradient L (dim x dim, rows; 1/s);
 * false where it is not in contact with the body. */
static inline bool mpsi_contact_find(const mps_contact *contact, int dim,
                                     const mpsi_contact_law *law, const double *v, const double *L,
                                     mpsi_contact_particle *out) {
  const mps_body *body = contact->body;
  const mpsi_foot foot = mpsi_body_foot(body, out->x);
  const double d = foot.distance - contact->def.offset;
  if (!(d < 0.0)) return false;
  const double k = law->weight * mpsi_contact_penalty(contact, law->modulus, law->spacing,
                                                      law->cell, law->courant);
  double surface[3];
  mpsi_body_velocity(&body->pose, foot.at, surface);
  for (int c = 0; c < dim; c++) {
    double material = v[c];
    for (int a = 0; a < dim; a++) material += L[dim * c + a] * (foot.at[a] - out->x[a]);
    out->force[c] = -k * d * foot.normal[c];
    out->slip[c] = surface[c] - material;
  }
  out->part = mpsi_contact_part(contact, foot.face);
  out->depth = -foot.distance;
  return true;
}

/* Adds force f at `arm` from the body's reference point to a load. */
static inline void mpsi_contact_add_load(mpsi_load *load, const double *arm, const double *f) {
  for (int c = 0; c < 3; c++) load->force[c] += f[c];
  load->moment[0] += arm[1] * f[2] - arm[2] * f[1];
  load->moment[1] += arm[2] * f[0] - arm[0] * f[2];
  load->moment[2] += arm[0] * f[1] - arm[1] * f[0];
}

/* ---- a node ---------------------------------------------------------------------------------- */

/* A node and a body: sums over the particles in contact. */
typedef struct mpsi_contact_node {
  double mass;     /* W: sum phi m of the particles in contact, Nakamura (30) */
  double slip[3];  /* S: sum phi m slip; then the tangential force over W */
  double force[3]; /* N, normal force fn, Nakamura (29) */
} mpsi_contact_node;

/* A node of a grid in a step. */
typedef struct mpsi_contact_motion {
  double x[3];      /* m */
  double mass;      /* kg */
  const double *v;  /* m/s, with the forces of the step */
  const double *v0; /* m/s, without them */
} mpsi_contact_motion;

/* Tangential force (N) of the body on a node in a step of dt (s): it stops the sliding, but is at
 * most friction times the normal force. `all_mass` (kg) is that of all nodes in contact with the
 * body. False where there is none. */
bool mpsi_contact_friction(const mps_contact *contact, int dim, const mpsi_contact_node *at,
                           const mpsi_contact_motion *node, double all_mass, double dt,
                           double *force);
