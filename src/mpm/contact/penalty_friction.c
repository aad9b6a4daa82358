/* penalty_friction.c - penalty contact at the nodes of a block: the normal forces of all bodies
 * first, then Coulomb friction body by body, Nakamura (31)-(34); then the forces on the bodies, by
 * whatever contact. The equations of one particle or node are in src/contact: friction.c has
 * (31)-(34). SPDX-License-Identifier: BSD-3-Clause */
#include "body/rotation.h"
#include "mpm/base/mpm_solver.h"

#include <string.h>

void mpsi_mpm_apply_contact(mps_mpm *mpm, int64_t g) {
  const mpsi_node_block *nodes = &mpm->grid.nodes[g];
  mpsi_node *node = mpm->grid.node + mpsi_first_node(mpm, g);
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    mpm->contact.node_pair[t].mass = 0.0;
    if (mpsi_by_impulses(mpm->contact.handle[mpm->contact.node_pair[t].body])) continue;
    const mpsi_contact_node *at = mpm->contact.node + (int64_t)t * mpm->grid.block_nodes;
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      const double m = node[k][MPSI_MASS];
      if (!(m > 0.0) || at[k].mass == 0.0) continue;
      if (at[k].mass > 0.0) mpm->contact.node_pair[t].mass += m;
      for (int c = 0; c < mpm->grid.dim; c++)
        node[k][MPSI_VECTOR + c] += mpm->run.dt * at[k].force[c] / m;
    }
  }
}

void mpsi_mpm_apply_friction(mps_mpm *mpm, int64_t g) {
  const mpsi_node_block *nodes = &mpm->grid.nodes[g];
  mpsi_node *node = mpm->grid.node + mpsi_first_node(mpm, g);
  mpsi_node *side = nodes->side >= 0 ? mpm->grid.side + mpsi_first_node(mpm, nodes->side) : NULL;
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    const int32_t b = mpm->contact.node_pair[t].body;
    if (mpm->contact.handle[b]->def.friction == 0.0 || mpm->contact.node_pair[t].mass == 0.0)
      continue;
    mpsi_contact_node *at = mpm->contact.node + (int64_t)t * mpm->grid.block_nodes;
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      const double m = node[k][MPSI_MASS];
      double x[3], f[3];
      mpsi_node_place(mpm, nodes->at, k, x);
      const bool frictional = mpsi_contact_friction(
          mpm->contact.handle[b], mpm->grid.dim, &at[k], mpm->contact.state[b].mass, x,
          node[k] + MPSI_VECTOR, side[k] + MPSI_VECTOR, m, mpm->run.dt, f);
      for (int c = 0; c < 3; c++) {
        at[k].slip[c] = frictional ? f[c] / at[k].mass : 0.0;
        if (frictional) node[k][MPSI_VECTOR + c] += mpm->run.dt * f[c] / m;
      }
    }
  }
}

/* ---- what the bodies feel -------------------------------------------------------------------- */

enum { FORCE = 0, MOMENT = 3, CONTACTS = 6, SUMS };
typedef mpsi_exact load_sums[SUMS];

static int32_t all_parts(const mps_mpm *mpm) {
  int32_t parts = 0;
  for (int32_t b = 0; b < mpm->contact.bodies; b++) parts += mpm->contact.handle[b]->parts;
  return parts;
}

bool mpsi_mpm_sum_room(mps_mpm *mpm) {
  return mpsi_room_ensure(mpm->context, &mpm->contact.sum_room, all_parts(mpm), sizeof(load_sums));
}

/* Of body b on this rank, to the sums of its parts. */
static void add_loads(const mps_mpm *mpm, int32_t b, load_sums *sum) {
  for (int64_t k = 0; k < mpm->contact.cell_pair_count; k++) {
    const mpsi_cell_pair *pair = &mpm->contact.cell_pair[k];
    if (pair->body != b || !pair->in_contact || mpm->grid.cells[pair->cells].ghost) continue;
    for (int32_t part = 0; part < mpm->contact.handle[b]->parts; part++) {
      const mpsi_pair_load *load = &mpm->contact.load[pair->first_load + part];
      for (int c = 0; c < 3; c++) {
        mpsi_exact_add(&sum[part][FORCE + c], load->by.force[c]);
        mpsi_exact_add(&sum[part][MOMENT + c], load->by.moment[c]);
      }
      mpsi_exact_add(&sum[part][CONTACTS], (double)load->contacts);
    }
  }
}

static void react(mps_mpm *mpm, int32_t b, load_sums *sum) {
  mps_contact *contact = mpm->contact.handle[b];
  const mps_body *body = mpm->contact.body[b];
  const bool moves = !mpm->settling.on;
  for (int32_t part = 0; part < contact->parts; part++) {
    mpsi_part_load *load = &contact->source.part[part];
    for (int c = 0; c < 3; c++) {
      load->force.force[c] = mpsi_exact_value(&sum[part][FORCE + c]);
      load->force.moment[c] = mpsi_exact_value(&sum[part][MOMENT + c]);
    }
    load->count = (int64_t)mpsi_exact_value(&sum[part][CONTACTS]);
  }
  mpsi_contact_react(contact, mpm->run.dt, moves);
  const bool moved = moves && contact->source.moves;
  const double *v = moved ? body->middle_v : body->pose.v;
  const double *spin = moved ? body->middle_spin : body->pose.spin;
  for (int32_t part = 0; part < contact->parts; part++) {
    const mpsi_load *by = &contact->source.part[part].force;
    mpm->energy.bodies -= mpm->run.dt * (mpsi_dot3(by->force, v) + mpsi_dot3(by->moment, spin));
  }
}

/* Reactions to the bodies, by the sums over all blocks on all ranks: exact, independent of the
 * partition. Then the bodies move. */
void mpsi_mpm_update_bodies(mps_mpm *mpm) {
  load_sums *sum = mpm->contact.sum_room.item, *of = sum;
  const int32_t parts = all_parts(mpm);
  memset(sum, 0, (size_t)parts * sizeof *sum);
  for (int32_t b = 0; b < mpm->contact.bodies; of += mpm->contact.handle[b++]->parts)
    add_loads(mpm, b, of);
  if (mpm->partition && mpm->partition->lost == MPS_OK)
    mpm->partition->lost =
        mpsi_domain_sum_exact(mpm->partition->domain, "mps_mpm_step", parts * SUMS, sum[0]);
  of = sum;
  for (int32_t b = 0; b < mpm->contact.bodies; of += mpm->contact.handle[b++]->parts)
    react(mpm, b, of);
}
