/* contacts.c - contacts with bodies in the operator of implicit pressures. Where the ground bears on
 * a body its velocity is that of the surface, whatever the pressures: with the rows C of the
 * contacts (psi n at their nodes, constraints.c) a correction m^-1 G d of the velocities is
 * projected,
 *
 *   (1 - m^-1 C^T Y C) m^-1 G d,   Y = diag(1/sum over k of |C m^-1 C^T|_jk)
 *
 * Y is the inverse of C m^-1 C^T for a motion that neighbouring contacts share, and never more, so
 * that the operator stays symmetric and positive definite. A body that pushes the ground thus
 * raises the pressures at once; with contacts left out these lagged by as many steps as forces of
 * the water are stiffer than its storage. SPDX-License-Identifier: BSD-3-Clause */
#include "contacts.h"

#include "mpm/contact/exchange.h"
#include "mpm/contact/pairs.h"

#include <string.h>

/* Of what a sliding contact may bear, above which it slides. */
#define SLIDES 0.999999

static bool does_stick(const mpsi_impulse *c) {
  const double most = c->friction * c->normal_impulse + c->adhesion;
  return most > 0.0 && mpsi_dot3(c->tangent_impulse, c->tangent_impulse) <
                           SLIDES * SLIDES * most * most &&
         c->strength == INFINITY;
}

static bool make_room(mps_mpm *mpm, mpsi_pore_contacts *out) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  mps_context *context = mpm->context;
  int64_t most = all->constraint_count * all->stride;
  const int64_t nodes = mpm->grid.node_count * mpm->grid.block_nodes;
  const bool good =
      mpsi_room_ensure(context, &out->contact_room, all->constraint_count, sizeof *out->contact) &&
      mpsi_room_ensure(context, &out->node_room, most, sizeof *out->node) &&
      mpsi_room_ensure(context, &out->weight_room, most, sizeof *out->weight) &&
      mpsi_room_ensure(context, &out->left_room, 3 * all->constraint_count, sizeof *out->left) &&
      mpsi_room_ensure(context, &out->share_room, nodes, 3 * sizeof(double));
  out->contact = out->contact_room.item;
  out->node = out->node_room.item;
  out->weight = out->weight_room.item;
  out->left = out->left_room.item;
  return good;
}

/* Component a of what the contact holds, along the axis or of the normal. */
static double part_of(const mpsi_pore_contact *c, int a) {
  return c->sticks ? 1.0 : fabs(c->normal[a]);
}

static void add_contact(const mps_mpm *mpm, int64_t n, int32_t *entries, mpsi_pore_contacts *out) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  const mpsi_pore_system *s = mpm->water->system;
  const mpsi_constraint *from = &all->constraint[n];
  const double *weight = all->weight[n * all->stride];
  mpsi_pore_contact *to = &out->contact[out->count++];
  *to = (mpsi_pore_contact){.constraint = n, .first = *entries, .sticks = does_stick(&from->impulse)};
  memcpy(to->normal, from->impulse.normal, sizeof to->normal);
  for (int32_t i = 0; i < from->nodes; i++) {
    const int64_t node = (double(*)[4])all->node[n * all->stride + i] - mpm->grid.node;
    if (node >= mpm->grid.node_count * mpm->grid.block_nodes) continue; /* across a thin body */
    out->node[*entries] = (int32_t)node;
    for (int a = 0; a < 3; a++)
      out->weight[*entries][a] = s->held[node] >> a & 1 ? 0.0
                                 : from->even           ? weight[2 * i + 1]
                                                        : weight[4 * i + MPSI_VECTOR + a];
    to->nodes++;
    ++*entries;
  }
}

/* Y of all contacts. */
static void find_yields(const mps_mpm *mpm, mpsi_pore_contacts *all) {
  const mpsi_pore_system *s = mpm->water->system;
  double(*share)[3] = all->share_room.item;
  for (int64_t k = 0; k < all->count; k++)
    for (int32_t e = all->contact[k].first; e < all->contact[k].first + all->contact[k].nodes; e++)
      memset(share[all->node[e]], 0, sizeof *share);
  for (int64_t k = 0; k < all->count; k++)
    for (int32_t e = all->contact[k].first; e < all->contact[k].first + all->contact[k].nodes; e++)
      for (int a = 0; a < 3; a++)
        share[all->node[e]][a] += part_of(&all->contact[k], a) * fabs(all->weight[e][a]);
  for (int64_t k = 0; k < all->count; k++) {
    mpsi_pore_contact *c = &all->contact[k];
    double sum[3] = {0.0};
    for (int32_t e = c->first; e < c->first + c->nodes; e++)
      for (int a = 0; a < mpm->grid.dim; a++)
        sum[a] += part_of(c, a) * fabs(all->weight[e][a]) * share[all->node[e]][a] /
                  s->mass[all->node[e]];
    const double most = c->sticks ? fmax(sum[0], fmax(sum[1], sum[2])) : sum[0] + sum[1] + sum[2];
    c->yield = most > 0.0 ? 1.0 / most : 0.0;
  }
}

mps_status mpsi_pore_find_contacts(mps_mpm *mpm, const char *function) {
  mpsi_pore_contacts *out = &mpm->water->system->contacts;
  const mpsi_impulses *all = &mpm->contact.impulses;
  int32_t entries = 0;
  out->count = 0;
  if (mpm->contact.bodies == 0 || mpm->contact.cell_pair_count == 0 || all->constraint_count == 0)
    return MPS_OK;
  if (!make_room(mpm, out))
    return mpsi_fail_memory(mpm->context, function,
                            (size_t)all->constraint_count * sizeof *out->contact);
  for (int64_t n = 0; n < all->constraint_count; n++)
    if (all->constraint[n].impulse.normal_impulse > 0.0) add_contact(mpm, n, &entries, out);
  find_yields(mpm, out);
  return MPS_OK;
}

void mpsi_pore_hold_contacts(mps_mpm *mpm) {
  mpsi_pore_system *s = mpm->water->system;
  const mpsi_pore_contacts *all = &s->contacts;
  for (int64_t k = 0; k < all->count; k++) {
    const mpsi_pore_contact *c = &all->contact[k];
    double v[3] = {0.0};
    for (int32_t e = c->first; e < c->first + c->nodes; e++)
      for (int a = 0; a < mpm->grid.dim; a++)
        v[a] += all->weight[e][a] * s->velocity[all->node[e]][a];
    const double across = mpsi_dot3(v, c->normal);
    for (int a = 0; a < 3; a++)
      all->left[3 * k + a] = c->yield * (c->sticks ? v[a] : across * c->normal[a]);
  }
  for (int64_t k = 0; k < all->count; k++) {
    const mpsi_pore_contact *c = &all->contact[k];
    for (int32_t e = c->first; e < c->first + c->nodes; e++)
      for (int a = 0; a < mpm->grid.dim; a++)
        s->velocity[all->node[e]][a] -=
            all->weight[e][a] * all->left[3 * k + a] / s->mass[all->node[e]];
  }
}

void mpsi_pore_bear_contacts(mps_mpm *mpm) {
  const mpsi_pore_contacts *all = &mpm->water->system->contacts;
  for (int64_t k = 0; k < all->count; k++) {
    mpsi_impulse *c = &mpm->contact.impulses.constraint[all->contact[k].constraint].impulse;
    double by[3];
    for (int a = 0; a < 3; a++) by[a] = -mpm->run.dt * all->left[3 * k + a];
    const double across = mpsi_dot3(by, c->normal);
    c->normal_impulse = fmax(0.0, c->normal_impulse + across);
    for (int a = 0; a < 3; a++) c->tangent_impulse[a] += by[a] - across * c->normal[a];
  }
}

void mpsi_pore_free_contacts(mps_context *context, mpsi_pore_contacts *contacts) {
  const mpsi_room room[] = {contacts->contact_room, contacts->node_room, contacts->weight_room,
                            contacts->left_room, contacts->share_room};
  for (size_t k = 0; k < sizeof room / sizeof *room; k++) mpsi_free(context, room[k].item);
}
