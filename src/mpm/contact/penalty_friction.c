/* penalty_friction.c - penalty contact at the nodes of a block: the normal forces of all bodies
 * first, then Coulomb friction body by body, Nakamura (31)-(34); and the loads on the bodies, from
 * contact of either method. The equations of one particle or node are in src/contact: friction.c
 * has (31)-(34). SPDX-License-Identifier: BSD-3-Clause */
#include "body/rotation.h"
#include "mpm/contact/pairs.h"
#include "mpm/particles/loads.h"
#include "mpm/ranks/partition.h"
#include "mpm/step/damping.h"

#include <string.h>

void mpsi_mpm_apply_contact(const mpsi_grid *grid, const mpsi_contacts *contacts, double dt,
                            int64_t g) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  mpsi_node *node = grid->node + mpsi_first_node(grid, g);
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    contacts->node_pair[t].mass = 0.0;
    if (mpsi_by_impulses(contacts->handle[contacts->node_pair[t].body])) continue;
    const mpsi_contact_node *at = contacts->node + (int64_t)t * grid->block_nodes;
    for (int k = 0; k < grid->block_nodes; k++) {
      const double m = node[k][MPSI_MASS];
      if (!(m > 0.0) || at[k].mass == 0.0) continue;
      if (at[k].mass > 0.0) contacts->node_pair[t].mass += m;
      for (int c = 0; c < grid->dim; c++) node[k][MPSI_VECTOR + c] += dt * at[k].force[c] / m;
    }
  }
}

void mpsi_mpm_apply_friction(const mpsi_grid *grid, const mpsi_contacts *contacts, double dt,
                             int64_t g) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  mpsi_node *node = grid->node + mpsi_first_node(grid, g);
  mpsi_node *side = nodes->side >= 0 ? grid->side + mpsi_first_node(grid, nodes->side) : NULL;
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    const int32_t b = contacts->node_pair[t].body;
    if (contacts->handle[b]->def.friction == 0.0 || contacts->node_pair[t].mass == 0.0) continue;
    mpsi_contact_node *at = contacts->node + (int64_t)t * grid->block_nodes;
    for (int k = 0; k < grid->block_nodes; k++) {
      mpsi_contact_motion motion = {
          .mass = node[k][MPSI_MASS], .v = node[k] + MPSI_VECTOR, .v0 = side[k] + MPSI_VECTOR};
      double f[3];
      mpsi_node_place(grid, nodes->at, k, motion.x);
      const bool frictional = mpsi_contact_friction(contacts->handle[b], grid->dim, &at[k], &motion,
                                                    contacts->state[b].mass, dt, f);
      for (int c = 0; c < 3; c++) {
        at[k].slip[c] = frictional ? f[c] / at[k].mass : 0.0;
        if (frictional) node[k][MPSI_VECTOR + c] += dt * f[c] / motion.mass;
      }
    }
  }
}

/* ---- loads on the bodies --------------------------------------------------------------------- */

enum { FORCE = 0, MOMENT = 3, CONTACTS = 6, SUMS };
typedef mpsi_exact load_sums[SUMS];

static int32_t all_parts(const mpsi_contacts *contacts) {
  int32_t parts = 0;
  for (int32_t b = 0; b < contacts->bodies; b++) parts += contacts->handle[b]->parts;
  return parts;
}

bool mpsi_mpm_sum_room(mps_context *context, mpsi_contacts *contacts) {
  return mpsi_room_ensure(context, &contacts->sum_room, all_parts(contacts), sizeof(load_sums));
}

/* Adds the loads on body b on this rank to the exact sums of its parts. */
static void add_loads(const mpsi_grid *grid, const mpsi_contacts *contacts, int32_t b,
                      load_sums *sum) {
  for (int64_t k = 0; k < contacts->cell_pair_count; k++) {
    const mpsi_cell_pair *pair = &contacts->cell_pair[k];
    if (pair->body != b || !pair->in_contact || grid->cells[pair->cells].ghost) continue;
    for (int32_t part = 0; part < contacts->handle[b]->parts; part++) {
      const mpsi_pair_load *load = &contacts->load[pair->first_load + part];
      for (int c = 0; c < 3; c++) {
        mpsi_exact_add(&sum[part][FORCE + c], load->by.force[c]);
        mpsi_exact_add(&sum[part][MOMENT + c], load->by.moment[c]);
      }
      mpsi_exact_add(&sum[part][CONTACTS], (double)load->contacts);
    }
  }
}

/* Reactions of body b by the sums over its parts, its motion, and the work of contact. */
static void react(const mpsi_contacts *contacts, mpsi_energy *energy, const mpsi_settling *settling,
                  double dt, int32_t b, load_sums *sum) {
  mps_contact *contact = contacts->handle[b];
  const mps_body *body = contacts->body[b];
  const bool moves = !settling->on;
  for (int32_t part = 0; part < contact->parts; part++) {
    mpsi_part_load *load = &contact->source.part[part];
    for (int c = 0; c < 3; c++) {
      load->force.force[c] = mpsi_exact_value(&sum[part][FORCE + c]);
      load->force.moment[c] = mpsi_exact_value(&sum[part][MOMENT + c]);
    }
    load->count = (int64_t)mpsi_exact_value(&sum[part][CONTACTS]);
  }
  mpsi_contact_react(contact, dt, moves);
  const bool moved = moves && contact->source.moves;
  const double *v = moved ? body->middle_v : body->pose.v;
  const double *spin = moved ? body->middle_spin : body->pose.spin;
  for (int32_t part = 0; part < contact->parts; part++) {
    const mpsi_load *by = &contact->source.part[part].force;
    energy->bodies -= dt * (mpsi_dot3(by->force, v) + mpsi_dot3(by->moment, spin));
  }
}

/* Reactions of the bodies, by exact sums over the blocks of all ranks, independent of the
 * partition. Then the bodies move. */
void mpsi_mpm_update_bodies(const mpsi_grid *grid, const mpsi_contacts *contacts,
                            mpsi_energy *energy, mpsi_partition *partition,
                            const mpsi_settling *settling, double dt) {
  load_sums *sum = contacts->sum_room.item, *of = sum;
  const int32_t parts = all_parts(contacts);
  memset(sum, 0, (size_t)parts * sizeof *sum);
  for (int32_t b = 0; b < contacts->bodies; of += contacts->handle[b++]->parts)
    add_loads(grid, contacts, b, of);
  if (partition && partition->lost == MPS_OK)
    partition->lost =
        mpsi_domain_sum_exact(partition->domain, "mps_mpm_step", parts * SUMS, sum[0]);
  of = sum;
  for (int32_t b = 0; b < contacts->bodies; of += contacts->handle[b++]->parts)
    react(contacts, energy, settling, dt, b, of);
}
