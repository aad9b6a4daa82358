/* friction.c - contact at the nodes: the normal forces of all bodies first, then Coulomb friction
 * body by body, Nakamura (31)-(34), and what the bodies feel.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include <string.h>

static double dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void mpsi_mpm_apply_contact(mps_mpm *mpm, int64_t g) {
  const mpsi_node_block *nodes = &mpm->grid.nodes[g];
  mpsi_node *node = mpm->grid.node + mpsi_first_node(mpm, g);
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    const mpsi_contact_node *at = mpm->contact.node + (int64_t)t * mpm->grid.block_nodes;
    mpm->contact.node_pair[t].mass = 0.0;
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      const double m = node[k][MPSI_MASS];
      if (!(m > 0.0) || at[k].mass == 0.0) continue;
      if (at[k].mass > 0.0) mpm->contact.node_pair[t].mass += m;
      for (int c = 0; c < mpm->dim; c++)
        node[k][MPSI_VECTOR + c] += mpm->run.dt * at[k].force[c] / m;
    }
  }
}

/* The part of a stick force that a body leaves: 1 for a prescribed one. A free one moves too: two
 * masses m (all nodes in contact) and M (the body's, at this point and along the unit vector
 * `along`) lose their relative velocity by the reduced mass m M/(m + M). */
static double stick_share(const mps_mpm *mpm, int32_t b, const double *x, const double *along) {
  const mps_body *body = mpm->contact.body[b];
  if (body->def.motion == MPS_BODY_MOTION_PRESCRIBED) return 1.0;
  const double *R = body->pose.R;
  const double r[3] = {x[0] - body->pose.x[0], x[1] - body->pose.x[1], x[2] - body->pose.x[2]};
  const double arm[3] = {r[1] * along[2] - r[2] * along[1], r[2] * along[0] - r[0] * along[2],
                         r[0] * along[1] - r[1] * along[0]};
  double inverse = 1.0 / body->def.mass;
  for (int c = mpm->dim == 2 ? 2 : 0; c < 3; c++) { /* the body's axes are the principal ones */
    const double own = R[c] * arm[0] + R[3 + c] * arm[1] + R[6 + c] * arm[2];
    inverse += own * own / body->def.inertia[c];
  }
  return 1.0 / (1.0 + mpm->contact.mass[b] * inverse);
}

/* Tangential force (34) at a node; false where there is none. `v` and `before` are v_i and v_i^n.
 */
static bool tangential(const mps_mpm *mpm, int32_t b, const mpsi_contact_node *at, const double *x,
                       const double *v, const double *before, double m, double *force) {
  const double fn = sqrt(dot(at->force, at->force));
  if (!(at->mass > 0.0) || !(m > 0.0) || !(fn > 0.0)) return false;
  double n[3], s[3];
  for (int c = 0; c < 3; c++) {
    n[c] = at->force[c] / fn;
    s[c] = v[c] - before[c] - at->slip[c] / at->mass;
  }
  const double across = dot(s, n);
  for (int c = 0; c < 3; c++) s[c] -= across * n[c];
  const double slip = sqrt(dot(s, s));
  if (!(slip > 0.0)) return false;
  for (int c = 0; c < 3; c++) s[c] /= slip;
  const double stick = m * slip / mpm->run.dt * stick_share(mpm, b, x, s);
  const double f = fmin(stick, mpm->contact.body[b]->def.friction * fn);
  for (int c = 0; c < 3; c++) force[c] = -f * s[c];
  return true;
}

void mpsi_mpm_apply_friction(mps_mpm *mpm, int64_t g) {
  const mpsi_node_block *nodes = &mpm->grid.nodes[g];
  mpsi_node *node = mpm->grid.node + mpsi_first_node(mpm, g);
  mpsi_node *side = nodes->side >= 0 ? mpm->grid.side + mpsi_first_node(mpm, nodes->side) : NULL;
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    const int32_t b = mpm->contact.node_pair[t].body;
    mpsi_contact_node *at = mpm->contact.node + (int64_t)t * mpm->grid.block_nodes;
    if (mpm->contact.body[b]->def.friction == 0.0 || mpm->contact.node_pair[t].mass == 0.0)
      continue;
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      int place[3];
      double x[3], f[3];
      mpsi_unravel(k, MPSI_SIDE, place);
      const double local[3] = {place[0], place[1], place[2]}, m = node[k][MPSI_MASS];
      mpsi_node_position(mpm, nodes->at, local, x);
      const bool rubs =
          tangential(mpm, b, &at[k], x, node[k] + MPSI_VECTOR, side[k] + MPSI_VECTOR, m, f);
      for (int c = 0; c < 3; c++) {
        at[k].slip[c] = rubs ? f[c] / at[k].mass : 0.0;
        if (rubs) node[k][MPSI_VECTOR + c] += mpm->run.dt * f[c] / m;
      }
    }
  }
}

/* Reactions of all blocks, in their order, to the bodies; then the bodies move. */
void mpsi_mpm_update_bodies(mps_mpm *mpm) {
  for (int32_t b = 0; b < mpm->contact.bodies; b++) {
    mpsi_load load[MPS_BODY_MAX_PARTS] = {{{0}, {0}}};
    int64_t contacts[MPS_BODY_MAX_PARTS] = {0};
    for (int64_t k = 0; k < mpm->contact.cell_pair_count; k++) {
      const mpsi_cell_pair *pair = &mpm->contact.cell_pair[k];
      if (pair->body != b || !pair->touched) continue;
      for (int32_t part = 0; part < mpm->contact.body[b]->parts; part++) {
        for (int c = 0; c < 3; c++) {
          load[part].force[c] += pair->load[part].force[c];
          load[part].moment[c] += pair->load[part].moment[c];
        }
        contacts[part] += pair->contacts[part];
      }
    }
    mpsi_body_react(mpm->contact.body[b], mpm->run.dt, load, contacts);
    mpsi_body_advance(mpm->contact.body[b], mpm->run.dt);
  }
}
