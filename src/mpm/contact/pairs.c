/* pairs.c - before each step: which blocks of cells and of nodes are near which bodies. Only these
 * pairs are searched for contact. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"

#include <string.h>

/* Half the diagonal of a tile or block of `side` nodes an axis, in cells, and a little for
 * round-off: a body that has a node of it inside is no further than that from its centre. */
static double half_diagonal(const mps_mpm *mpm, int side) {
  return 0.5 * (side - 1) * sqrt((double)mpm->dim) * (1.0 + 1e-9);
}

static void find_middle(const mps_mpm *mpm, const int32_t *at, int side, double *x) {
  const double middle = 0.5 * (side - 1), local[3] = {middle, middle, middle};
  mpsi_node_position(mpm, at, local, x);
}

bool mpsi_mpm_body_reaches(const mps_mpm *mpm, int32_t body, const int32_t *at, int side) {
  double x[3];
  find_middle(mpm, at, side, x);
  return mpsi_body_reaches(mpm->contact.body[body], x, half_diagonal(mpm, side) * mpm->def.cell);
}

/* The same in a loop over blocks; `last` of each body. */
static uint32_t find_bodies(const mps_mpm *mpm, const int32_t *at, int side, double reach,
                            mpsi_last_distance *last) {
  uint32_t bodies = 0;
  double x[3];
  find_middle(mpm, at, side, x);
  for (int32_t k = 0; k < mpm->contact.bodies; k++)
    if (mpsi_body_reaches_next(mpm->contact.body[k], x, reach, &last[k]))
      bodies |= UINT32_C(1) << k;
  return bodies;
}

/* By the place of the block alone: so all ranks that have it know the same nodes to be inside, and
 * the same supports to be cut. */
static void find_bodies_of_nodes(mps_mpm *mpm) {
  const double reach = half_diagonal(mpm, MPSI_SIDE) * mpm->def.cell;
  mpsi_last_distance last[MPS_MPM_MAX_CONTACTS] = {{.distance = 0.0}};
  for (int64_t g = 0; g < mpm->grid.node_count; g++) {
    mpsi_node_block *nodes = &mpm->grid.nodes[g];
    nodes->bodies = find_bodies(mpm, nodes->at, MPSI_SIDE, reach, last);
  }
}

/* Lists the pairs of blocks of cells and bodies; false where there is no room for them all, `count`
 * says how many there are. */
static bool list_cell_pairs(mps_mpm *mpm, int64_t *count) {
  const double reach = half_diagonal(mpm, MPSI_TILE_SIDE) * mpm->def.cell;
  mpsi_last_distance last[MPS_MPM_MAX_CONTACTS] = {{.distance = 0.0}};
  *count = 0;
  find_bodies_of_nodes(mpm);
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    mpsi_cell_block *cells = &mpm->grid.cells[b];
    const uint32_t near = find_bodies(mpm, cells->at, MPSI_TILE_SIDE, reach, last);
    cells->first_pair = (int32_t)*count;
    for (int32_t k = 0; near && k < mpm->contact.bodies; k++) {
      if (!(near >> k & 1)) continue;
      for (int q = 0; q < 1 << mpm->dim; q++)
        mpm->grid.nodes[cells->to[q]].bodies |= UINT32_C(1) << k;
      if (*count < mpm->contact.cell_pair_room.capacity) {
        mpsi_cell_pair *pair = (mpsi_cell_pair *)mpm->contact.cell_pair_room.item + *count;
        pair->cells = (int32_t)b;
        pair->body = k;
      }
      (*count)++;
    }
    cells->pairs = (int32_t)*count - cells->first_pair;
  }
  return *count <= mpm->contact.cell_pair_room.capacity;
}

/* Friction with a body that moves freely depends on the mass of all nodes in contact with it. */
static bool asks_for_mass(const mps_mpm *mpm, int32_t body) {
  return mpm->contact.handle[body]->def.friction > 0.0 &&
         !mpsi_by_impulses(mpm->contact.handle[body]) &&
         mpm->contact.body[body]->def.motion != MPS_BODY_MOTION_DRIVEN;
}

/* The pairs of blocks of nodes and bodies. The same in two goes: see list_cell_pairs. */
static bool list_node_pairs(mps_mpm *mpm, int64_t *count, int64_t *near) {
  *count = *near = 0;
  for (int64_t g = 0; g < mpm->grid.node_count; g++) {
    mpsi_node_block *nodes = &mpm->grid.nodes[g];
    nodes->first_pair = (int32_t)*count;
    nodes->near = nodes->bodies ? (int32_t)(*near)++ : -1;
    nodes->waits = false;
    for (int32_t k = 0; nodes->bodies && k < mpm->contact.bodies; k++) {
      if (!(nodes->bodies >> k & 1)) continue;
      nodes->waits = nodes->waits || asks_for_mass(mpm, k);
      if (*count < mpm->contact.node_pair_room.capacity)
        ((mpsi_node_pair *)mpm->contact.node_pair_room.item)[*count] =
            (mpsi_node_pair){(int32_t)g, k, 0.0};
      (*count)++;
    }
    nodes->pairs = (int32_t)*count - nodes->first_pair;
  }
  return *count <= mpm->contact.node_pair_room.capacity;
}

/* Penalty contacts have sums at the nodes; all have normals there. */
static bool ensure_nodes(mps_mpm *mpm, int64_t nodes) {
  mpsi_contacts *contact = &mpm->contact;
  if (!mpsi_room_ensure(mpm->context, &contact->normal_room, nodes, sizeof *contact->normal) ||
      !mpsi_room_ensure(mpm->context, &contact->node_room, contact->penalty_bodies > 0 ? nodes : 0,
                        sizeof *contact->node))
    return false;
  contact->normal = contact->normal_room.item;
  contact->node = contact->node_room.item;
  return true;
}

mps_status mpsi_mpm_list_pairs(mps_mpm *mpm, const char *function) {
  mps_context *context = mpm->context;
  mpsi_contacts *contact = &mpm->contact;
  int64_t cell_pairs = 0, node_pairs = 0, near = 0;
  bool good = true;
  if (!list_cell_pairs(mpm, &cell_pairs)) {
    good = mpsi_room_ensure(context, &contact->cell_pair_room, cell_pairs, sizeof(mpsi_cell_pair));
    if (good) list_cell_pairs(mpm, &cell_pairs);
  }
  if (good && !list_node_pairs(mpm, &node_pairs, &near)) {
    good = mpsi_room_ensure(context, &contact->node_pair_room, node_pairs, sizeof(mpsi_node_pair));
    if (good) list_node_pairs(mpm, &node_pairs, &near);
  }
  const int64_t nodes = node_pairs * mpm->grid.block_nodes, masks = near * mpm->grid.block_nodes;
  good = good && ensure_nodes(mpm, nodes) && mpsi_mpm_load_room(mpm) &&
         mpsi_room_ensure(context, &contact->inside_room, masks, sizeof *contact->inside) &&
         mpsi_room_ensure(context, &contact->reached_room, masks, sizeof *contact->reached);
  if (!good)
    return mpsi_fail_memory(context, function,
                            (size_t)(cell_pairs + 1) * sizeof(mpsi_cell_pair) +
                                (size_t)nodes * (sizeof *contact->normal + sizeof *contact->node));
  contact->cell_pair = contact->cell_pair_room.item;
  contact->node_pair = contact->node_pair_room.item;
  contact->inside = contact->inside_room.item;
  contact->reached = contact->reached_room.item;
  contact->cell_pair_count = cell_pairs;
  contact->node_pair_count = node_pairs;
  contact->mask_count = near;
  return MPS_OK;
}

void mpsi_mpm_find_contact_mass(mps_mpm *mpm) {
  mpsi_exact sum[MPS_MPM_MAX_CONTACTS];
  bool any = false;
  for (int32_t b = 0; b < mpm->contact.bodies; b++) any = any || asks_for_mass(mpm, b);
  if (!any) return;
  memset(sum, 0, sizeof sum);
  for (int64_t t = 0; t < mpm->contact.node_pair_count; t++) {
    const mpsi_node_pair *pair = &mpm->contact.node_pair[t];
    if (asks_for_mass(mpm, pair->body) &&
        (!mpm->partition || mpsi_mpm_counts_node_block(mpm, pair->nodes)))
      mpsi_exact_add(&sum[pair->body], pair->mass);
  }
  if (mpm->partition && mpm->partition->lost == MPS_OK)
    mpm->partition->lost =
        mpsi_domain_sum_exact(mpm->partition->domain, "mps_mpm_step", mpm->contact.bodies, sum);
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    mpm->contact.mass[b] = mpsi_exact_value(&sum[b]);
}
