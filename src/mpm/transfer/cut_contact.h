/* cut_contact.h - penalty contact of a particle with a cut support: normal force, slip and
 * friction, Nakamura (28)-(30). SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/contact/particle.h"
#include "mpm/base/run.h"
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

/* Whether the body of the block's pair `number` has penalty contact and contains a node that the
 * particle sees, in the domain or outside. */
static bool mpsi_sees_body(const mpsi_transfer *work, int dim, int spline, const mpsi_single *one,
                           int32_t number) {
  const mpsi_contacts *contacts = work->contact;
  const int32_t body = contacts->cell_pair[work->cells->first_pair + number].body;
  bool any = false;
  if (mpsi_by_impulses(contacts->handle[body])) return false;
  MPSI_FOR_NODES(dim, spline) {
    const mpsi_node_block *nodes =
        &work->grid->nodes[mpsi_support_block(work->cells, one->at, i, j, k)];
    if (!nodes->inside || !mpsi_sees(dim, one->batch, i, j, k)[one->lane]) continue;
    int32_t t = nodes->first_pair;
    while (contacts->node_pair[t].body != body) t++;
    any =
        any ||
        contacts->held[(int64_t)t * work->grid->block_nodes + mpsi_support_local(one->at, i, j, k)];
    (void)n;
  }
  return any;
}

/* Penalty contact of a particle with the body of the block's pair `number`, Nakamura (28)-(30):
 * adds normal force and slip to the nodes by phi, and the reaction to the loads on the body. */
MPSI_INLINE void mpsi_scatter_contact(const mpsi_transfer *work, int dim, int spline,
                                      const mpsi_single *one, int32_t number) {
  mpsi_cell_pair *pair = &work->contact->cell_pair[work->cells->first_pair + number];
  const mps_contact *contact = work->contact->handle[pair->body];
  const mps_body *body = work->contact->body[pair->body];
  const mpsi_shape_values *f = &one->f;
  mpsi_contact_particle c;
  if (mpsi_by_impulses(contact) ||
      !mpsi_find_contact(work->grid, work->p, work->def, contact, dim, one->particle, &c))
    return;
  pair->in_contact = true;
  mpsi_pair_load *load = &work->contact->load[pair->first_load + c.part];
  load->contacts++;
  if (c.depth > pair->deepest) pair->deepest = c.depth, pair->deep = one->particle;
  double arm[3], reaction[3];
  for (int a = 0; a < 3; a++) arm[a] = c.x[a] - body->pose.x[a], reaction[a] = -c.force[a];
  mpsi_contact_add_load(&load->by, arm, reaction);
  MPSI_FOR_NODES(dim, spline) {
    if (f->w[n] == 0.0) continue;
    mpsi_penalty_node *to =
        mpsi_mpm_penalty_tile(work->grid, work->worker, number) + tile_node_of(one->at, i, j, k);
    const double mass = work->p->m[one->particle] * f->phi[n];
    double slip[3] = {0.0}, force[3] = {0.0};
    for (int a = 0; a < dim; a++) slip[a] = mass * c.slip[a], force[a] = f->phi[n] * c.force[a];
    if (mpsi_is_folded(one->at, i, j, k)) {
      mpsi_reflect_at(work, one->batch, i, j, k, slip, 0.0);
      mpsi_reflect_at(work, one->batch, i, j, k, force, work->run->dt);
    }
    to->mass += mass;
    for (int a = 0; a < dim; a++) to->slip[a] += slip[a], to->force[a] += force[a];
  }
}

/* Adds the reaction to the nodes' friction to the load on the surface part that a particle is in
 * contact with: at each node the particle's fraction of the mass in contact. */
MPSI_INLINE void mpsi_add_friction_load(const mpsi_transfer *work, int dim, int spline,
                                        const mpsi_single *one, mpsi_cell_pair *pair) {
  const mps_contact *contact = work->contact->handle[pair->body];
  const mps_body *body = work->contact->body[pair->body];
  const mpsi_cut *b = one->batch;
  mpsi_contact_particle c;
  if (!pair->in_contact || mpsi_by_impulses(contact) || contact->def.friction == 0.0 ||
      !mpsi_find_contact(work->grid, work->p, work->def, contact, dim, one->particle, &c))
    return;
  MPSI_FOR_NODES(dim, spline) {
    if (one->f.w[n] == 0.0) continue;
    const mpsi_contact_node *from = contact_node_of(
        work->grid, work->contact, mpsi_support_block(work->cells, one->at, i, j, k),
        mpsi_support_local(one->at, i, j, k), pair->body);
    const double local[3] = {b->at[0] + i, b->at[1] + j, b->at[2] + k};
    const double mass = work->p->m[one->particle] * one->f.phi[n];
    double arm[3], reaction[3], slip[3] = {from->slip[0], from->slip[1], from->slip[2]};
    if (mpsi_is_folded(one->at, i, j,
                       k)) { /* friction of the node, and the wall's reaction to it */
      mpsi_reflect_at(work, b, i, j, k, slip, 0.0);
      double given[3] = {slip[0], slip[1], slip[2]};
      mpsi_reflect_at(work, b, i, j, k, given, work->run->dt * mass);
    }
    mpsi_node_position(work->grid, work->cells->at, local, arm);
    for (int a = 0; a < 3; a++) arm[a] -= body->pose.x[a], reaction[a] = -mass * slip[a];
    mpsi_contact_add_load(&work->contact->load[pair->first_load + c.part].by, arm, reaction);
  }
}
