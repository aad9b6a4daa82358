/* shared_nodes.c - replicas of the nodes that constraints of all partner ranks use, each once,
 * found by a hash of their coordinates (exchange.h). SPDX-License-Identifier: BSD-3-Clause */
#include "exchange.h"
#include "core/base/order.h"
#include "mpm/contact/thin_bodies.h"

#include "mpm/grid/blocks.h"

#include <string.h>

/* The node in this rank's grid, or NULL. */
static double *find_home(const mpsi_grid *grid, const int32_t *at, bool across) {
  int32_t block[3], local = 0;
  for (int c = 2; c >= 0; c--) {
    block[c] =
        c < grid->dim ? at[c] >= 0 ? at[c] / MPSI_SIDE : -((MPSI_SIDE - 1 - at[c]) / MPSI_SIDE) : 0;
    local = local * MPSI_SIDE + (at[c] - block[c] * MPSI_SIDE);
  }
  int64_t low;
  MPSI_BISECT(low, grid->node_count, middle, mpsi_block_before(grid->nodes[middle].at, block));
  if (low == grid->node_count || memcmp(grid->nodes[low].at, block, sizeof block) != 0) return NULL;
  if (across && grid->nodes[low].across < 0) return NULL;
  return grid->node[mpsi_first_node(grid, across ? grid->nodes[low].across : low) + local];
}

/* Slot of the hash table that has the node, or is free for it. */
static int64_t slot_of(const mpsi_contact_exchange *r, const int32_t *at, int32_t kind) {
  const mpsi_shared_node *shared = r->shared.item;
  const int32_t *lookup = r->lookup.item;
  uint64_t key = (uint64_t)kind;
  for (int c = 0; c < 3; c++) key = (key ^ (uint32_t)at[c]) * UINT64_C(0x9E3779B97F4A7C15);
  int64_t slot = (int64_t)(key >> 20) & (r->slots - 1);
  while (lookup[slot] >= 0 && (memcmp(shared[lookup[slot]].at, at, sizeof shared->at) != 0 ||
                               shared[lookup[slot]].kind != kind))
    slot = (slot + 1) & (r->slots - 1);
  return slot;
}

mpsi_shared_node *mpsi_mpm_shared_node(mpsi_contact_exchange *r, const mpsi_grid *grid,
                                       const int32_t *at, int32_t kind, const double *value) {
  mpsi_shared_node *shared = r->shared.item;
  int32_t *lookup = r->lookup.item;
  const int64_t slot = slot_of(r, at, kind);
  if (lookup[slot] >= 0) return &shared[lookup[slot]];
  mpsi_shared_node *node = &shared[r->nodes];
  memcpy(node->at, at, sizeof node->at);
  memcpy(node->value, value, sizeof node->value);
  node->kind = kind;
  node->home = kind < MPSI_SHARED_AREA ? find_home(grid, at, kind == MPSI_SHARED_ACROSS) : NULL;
  lookup[slot] = (int32_t)r->nodes++;
  return node;
}

mpsi_area *mpsi_mpm_shared_area(const mpsi_contact_exchange *r, const int32_t *block, const int *at,
                                int32_t body) {
  int32_t place[3];
  for (int c = 0; c < 3; c++) place[c] = block[c] * MPSI_SIDE + at[c];
  const int32_t found =
      ((const int32_t *)r->lookup.item)[slot_of(r, place, MPSI_SHARED_AREA + body)];
  return found < 0 ? NULL : &((mpsi_shared_node *)r->shared.item)[found].area;
}
