/* cut_contact.h - penalty contact of a particle with a cut support: normal force, slip and
 * friction, Nakamura (28)-(30). SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_CUT_CONTACT_H
#define MPSI_MPM_CUT_CONTACT_H

#include "mpm/contact/particle.h"
#include "least_squares.h"

/* Contact sums of body b at node `local` of block g. */
static mpsi_contact_node *contact_node_of(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                          int32_t g, int local, int32_t b) {
  int32_t t = grid->nodes[g].first_pair;
  while (contacts->node_pair[t].body != b) t++;
  return &contacts->node[(int64_t)t * grid->block_nodes + local];
}

/* Tile node to which contributions to node (i, j, k) of the stencil are added: its image for a
 * ghost. */
static int tile_node_of(const mpsi_support *s, int i, int j, int k) {
  const int side = MPSI_SIDE, plane = side * side;
  return mpsi_tile_index((s->corner[0][i] ? side : 0) + s->local[0][i],
                         (s->corner[1][j] ? side : 0) + s->local[1][j] / side,
                         (s->corner[2][k] ? side : 0) + s->local[2][k] / plane);
}

/* Whether the body of the block's pair `number` has penalty contact and contains a node of the
 * stencil, in the domain or outside. */
static bool mpsi_contains_node(const mpsi_grid *grid, const mpsi_contacts *contacts,
                               const mpsi_cell_block *cells, int dim, int spline,
                               const mpsi_support *s, int32_t number) {
  const int32_t body = contacts->cell_pair[cells->first_pair + number].body;
  bool any = false;
  if (mpsi_by_impulses(contacts->handle[body])) return false;
  MPSI_FOR_NODES(dim, spline) {
    const mpsi_node_block *nodes = &grid->nodes[mpsi_support_block(cells, s, i, j, k)];
    if (!nodes->inside) continue;
    int32_t t = nodes->first_pair;
    while (contacts->node_pair[t].body != body) t++;
    any = any || contacts->held[(int64_t)t * grid->block_nodes + mpsi_support_local(s, i, j, k)];
    (void)n;
  }
  return any;
}

/* Penalty contact of particle p with the body of the block's pair `number`, Nakamura (28)-(30):
 * adds normal force and slip to the nodes by phi, and the reaction to the loads on the body. */
MPSI_INLINE void mpsi_scatter_contact(mps_mpm *mpm, const mpsi_cell_block *cells,
                                      const mpsi_worker *worker, int dim, int spline, int64_t p,
                                      const mpsi_cut *b, const mpsi_support *at,
                                      const mpsi_shape_values *f, int32_t number) {
  mpsi_cell_pair *pair = &mpm->contact.cell_pair[cells->first_pair + number];
  const mps_body *body = mpm->contact.body[pair->body];
  mpsi_contact_particle c;
  if (mpsi_by_impulses(mpm->contact.handle[pair->body]) ||
      !mpsi_find_contact(&mpm->grid, &mpm->p, &mpm->def, mpm->contact.handle[pair->body], dim, p,
                         &c))
    return;
  pair->in_contact = true;
  mpsi_pair_load *load = &mpm->contact.load[pair->first_load + c.part];
  load->contacts++;
  if (c.depth > pair->deepest) pair->deepest = c.depth, pair->deep = p;
  double arm[3], reaction[3];
  for (int a = 0; a < 3; a++) arm[a] = c.x[a] - body->pose.x[a], reaction[a] = -c.force[a];
  mpsi_contact_add_load(&load->by, arm, reaction);
  MPSI_FOR_NODES(dim, spline) {
    if (f->w[n] == 0.0) continue;
    mpsi_penalty_node *to =
        mpsi_mpm_penalty_tile(&mpm->grid, worker, number) + tile_node_of(at, i, j, k);
    const double mass = mpm->p.m[p] * f->phi[n];
    double slip[3] = {0.0}, force[3] = {0.0};
    for (int a = 0; a < dim; a++) slip[a] = mass * c.slip[a], force[a] = f->phi[n] * c.force[a];
    if (mpsi_is_folded(at, i, j, k)) {
      mpsi_reflect_at(mpm, cells, b, i, j, k, slip, 0.0);
      mpsi_reflect_at(mpm, cells, b, i, j, k, force, mpm->run.dt);
    }
    to->mass += mass;
    for (int a = 0; a < dim; a++) to->slip[a] += slip[a], to->force[a] += force[a];
  }
}

/* Adds the reaction to the nodes' friction to the load on the surface part that particle p is in
 * contact with: at each node the particle's fraction of the mass in contact. */
MPSI_INLINE void mpsi_add_friction_load(mps_mpm *mpm, const mpsi_cell_block *cells, int dim,
                                        int spline, int64_t p, const mpsi_cut *b,
                                        const mpsi_support *at, const mpsi_shape_values *f,
                                        mpsi_cell_pair *pair) {
  const mps_body *body = mpm->contact.body[pair->body];
  mpsi_contact_particle c;
  if (!pair->in_contact || mpsi_by_impulses(mpm->contact.handle[pair->body]) ||
      mpm->contact.handle[pair->body]->def.friction == 0.0 ||
      !mpsi_find_contact(&mpm->grid, &mpm->p, &mpm->def, mpm->contact.handle[pair->body], dim, p,
                         &c))
    return;
  MPSI_FOR_NODES(dim, spline) {
    if (f->w[n] == 0.0) continue;
    const mpsi_contact_node *from =
        contact_node_of(&mpm->grid, &mpm->contact, mpsi_support_block(cells, at, i, j, k),
                        mpsi_support_local(at, i, j, k), pair->body);
    const double local[3] = {b->at[0] + i, b->at[1] + j, b->at[2] + k};
    const double mass = mpm->p.m[p] * f->phi[n];
    double arm[3], reaction[3], slip[3] = {from->slip[0], from->slip[1], from->slip[2]};
    if (mpsi_is_folded(at, i, j, k)) { /* friction of the node, and the wall's reaction to it */
      mpsi_reflect_at(mpm, cells, b, i, j, k, slip, 0.0);
      double given[3] = {slip[0], slip[1], slip[2]};
      mpsi_reflect_at(mpm, cells, b, i, j, k, given, mpm->run.dt * mass);
    }
    mpsi_node_position(&mpm->grid, cells->at, local, arm);
    for (int a = 0; a < 3; a++) arm[a] -= body->pose.x[a], reaction[a] = -mass * slip[a];
    mpsi_contact_add_load(&mpm->contact.load[pair->first_load + c.part].by, arm, reaction);
  }
}

#endif
