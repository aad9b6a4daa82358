/* pairs.c - before each step: which blocks of cells and of nodes are near which bodies. Only these
 * pairs are searched for contact. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/contact/pairs.h"
#include "mpm/particles/loads.h"
#include "mpm/ranks/partition.h"
#include "core/base/room_array.h"

#include <string.h>

/* Half the diagonal, in cells, of a tile or block of `side` nodes an axis, with a margin for
 * round-off: a body that contains one of its nodes is no farther than that from its centre. */
static double half_diagonal(const mpsi_grid *grid, int side) {
  return 0.5 * (side - 1) * sqrt((double)grid->dim) * (1.0 + 1e-9);
}

static void find_middle(const mpsi_grid *grid, const int32_t *at, int side, double *x) {
  const double middle = 0.5 * (side - 1), local[3] = {middle, middle, middle};
  mpsi_node_position(grid, at, local, x);
}

bool mpsi_mpm_body_reaches(const mpsi_grid *grid, const mpsi_contacts *contacts, int32_t body,
                           const int32_t *at, int side) {
  double x[3];
  find_middle(grid, at, side, x);
  return mpsi_body_reaches(contacts->body[body], x, half_diagonal(grid, side) * grid->cell);
}

/* Words of a set of bodies, a bit each. */
static int64_t words_of(const mpsi_contacts *contacts) { return (contacts->bodies + 63) / 64; }

static bool has_bit(const uint64_t *row, int32_t bit) { return row[bit / 64] >> (bit % 64) & 1; }

static void set_bit(uint64_t *row, int32_t bit) { row[bit / 64] |= UINT64_C(1) << (bit % 64); }

static uint64_t *near_row(const mpsi_contacts *contacts, int64_t g) {
  return (uint64_t *)contacts->near_room.item + g * words_of(contacts);
}

/* mpsi_mpm_body_reaches in a loop over blocks, with bounds from the last one; x: centre of the
 * block. */
static bool reaches_next(const mpsi_contacts *contacts, int32_t body, const double *x,
                         double reach) {
  return mpsi_body_reaches_next(contacts->body[body], x, reach, &contacts->state[body].last);
}

static void begin_loop(const mpsi_contacts *contacts) {
  for (int32_t b = 0; b < contacts->bodies; b++)
    contacts->state[b].last = (mpsi_last_distance){.distance = 0.0};
}

/* Bodies near each block of nodes, by the position of the block alone: so all ranks that have the
 * block find the same nodes inside bodies and the same supports cut. */
static void find_bodies_of_nodes(const mpsi_grid *grid, const mpsi_contacts *contacts) {
  const double reach = half_diagonal(grid, MPSI_SIDE) * grid->cell;
  begin_loop(contacts);
  for (int64_t g = 0; g < grid->node_count; g++) {
    uint64_t *near = near_row(contacts, g);
    double x[3];
    memset(near, 0, (size_t)words_of(contacts) * sizeof *near);
    find_middle(grid, grid->nodes[g].at, MPSI_SIDE, x);
    for (int32_t k = 0; k < contacts->bodies; k++)
      if (reaches_next(contacts, k, x, reach)) set_bit(near, k);
  }
}

/* Lengths of the lists of pairs, loads and masks. */
typedef struct pair_counts {
  int64_t cells, loads, nodes, near;
} pair_counts;

static void add_cell_pair(const mpsi_grid *grid, const mpsi_contacts *contacts, int64_t b,
                          int32_t body, pair_counts *count) {
  const mpsi_cell_block *cells = &grid->cells[b];
  for (int q = 0; q < 1 << grid->dim; q++) set_bit(near_row(contacts, cells->to[q]), body);
  if (count->cells < contacts->cell_pair_room.capacity) {
    mpsi_cell_pair *pair = (mpsi_cell_pair *)contacts->cell_pair_room.item + count->cells;
    pair->cells = (int32_t)b;
    pair->body = body;
    pair->first_load = count->loads;
  }
  count->cells++;
  count->loads += contacts->handle[body]->parts;
}

/* Lists the pairs of blocks of cells and bodies; false where their memory is too small: `count` has
 * the lengths for a second call. */
static bool list_cell_pairs(const mpsi_grid *grid, const mpsi_contacts *contacts,
                            pair_counts *count) {
  const double reach = half_diagonal(grid, MPSI_TILE_SIDE) * grid->cell;
  count->cells = count->loads = 0;
  find_bodies_of_nodes(grid, contacts);
  begin_loop(contacts);
  for (int64_t b = 0; b < grid->cell_count; b++) {
    mpsi_cell_block *cells = &grid->cells[b];
    double x[3];
    cells->first_pair = (int32_t)count->cells;
    find_middle(grid, cells->at, MPSI_TILE_SIDE, x);
    for (int32_t k = 0; k < contacts->bodies; k++)
      if (reaches_next(contacts, k, x, reach)) add_cell_pair(grid, contacts, b, k, count);
    cells->pairs = (int32_t)count->cells - cells->first_pair;
  }
  return count->cells <= contacts->cell_pair_room.capacity;
}

/* Friction with a body that moves freely depends on the mass of all nodes in contact with it. */
static bool needs_mass(const mpsi_contacts *contacts, int32_t body) {
  return contacts->handle[body]->def.friction > 0.0 && !mpsi_by_impulses(contacts->handle[body]) &&
         contacts->body[body]->def.motion != MPS_BODY_MOTION_DRIVEN;
}

/* Lists the pairs of blocks of nodes and bodies; false as list_cell_pairs. */
static bool list_node_pairs(const mpsi_grid *grid, const mpsi_contacts *contacts,
                            pair_counts *count) {
  count->nodes = count->near = 0;
  for (int64_t g = 0; g < grid->node_count; g++) {
    mpsi_node_block *nodes = &grid->nodes[g];
    const uint64_t *near = near_row(contacts, g);
    nodes->first_pair = (int32_t)count->nodes;
    nodes->waits = nodes->inside = nodes->thin = false;
    for (int32_t k = 0; k < contacts->bodies; k++) {
      if (!has_bit(near, k)) continue;
      nodes->waits = nodes->waits || needs_mass(contacts, k);
      if (count->nodes < contacts->node_pair_room.capacity)
        ((mpsi_node_pair *)contacts->node_pair_room.item)[count->nodes] =
            (mpsi_node_pair){(int32_t)g, k, 0.0};
      count->nodes++;
    }
    nodes->pairs = (int32_t)count->nodes - nodes->first_pair;
    nodes->near = nodes->pairs > 0 ? (int32_t)count->near++ : -1;
  }
  return count->nodes <= contacts->node_pair_room.capacity;
}

/* Memory for the surface normals at the nodes, and for the nodal sums of penalty contacts. */
static bool ensure_nodes(mps_context *context, mpsi_contacts *contact, int64_t nodes) {
  if (!MPSI_ENSURE(context, contact, normal, nodes) ||
      !MPSI_ENSURE(context, contact, node, contact->penalty_bodies > 0 ? nodes : 0))
    return false;
  return true;
}

/* Makes both lists, each a second time where its memory was too small. */
static bool make_lists(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contact,
                       pair_counts *count) {
  bool good = mpsi_room_ensure(context, &contact->near_room, grid->node_count * words_of(contact),
                               sizeof(uint64_t));
  if (good && !list_cell_pairs(grid, contact, count)) {
    good =
        mpsi_room_ensure(context, &contact->cell_pair_room, count->cells, sizeof(mpsi_cell_pair));
    if (good) list_cell_pairs(grid, contact, count);
  }
  if (good && !list_node_pairs(grid, contact, count)) {
    good =
        mpsi_room_ensure(context, &contact->node_pair_room, count->nodes, sizeof(mpsi_node_pair));
    if (good) list_node_pairs(grid, contact, count);
  }
  return good;
}

mps_status mpsi_mpm_list_pairs(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contact,
                               const char *function) {
  pair_counts count = {0};
  contact->penalty_bodies = 0;
  for (int32_t b = 0; b < contact->bodies; b++) {
    contact->penalty_bodies += !mpsi_by_impulses(contact->handle[b]);
    contact->handle[b]->parts = contact->body[b]->parts;
  }
  bool good = make_lists(context, grid, contact, &count);
  const int64_t nodes = count.nodes * grid->block_nodes;
  const int64_t masks = count.near * grid->block_nodes;
  good = good && ensure_nodes(context, contact, nodes) && mpsi_mpm_sum_room(context, contact) &&
         MPSI_ENSURE(context, contact, load, count.loads) &&
         MPSI_ENSURE(context, contact, held, nodes) &&
         MPSI_ENSURE(context, contact, inside, masks) &&
         MPSI_ENSURE(context, contact, reached, masks);
  if (!good)
    return mpsi_fail_memory(context, function,
                            (size_t)(count.cells + 1) * sizeof(mpsi_cell_pair) +
                                (size_t)nodes * (sizeof *contact->normal + sizeof *contact->node));
  contact->cell_pair = contact->cell_pair_room.item;
  contact->node_pair = contact->node_pair_room.item;
  contact->cell_pair_count = count.cells;
  contact->node_pair_count = count.nodes;
  contact->mask_count = count.near;
  if (mpsi_mpm_penalty_room(context, grid, contact)) return MPS_OK;
  return mpsi_fail_memory(context, function, (size_t)grid->tile_nodes * sizeof(mpsi_penalty_node));
}

void mpsi_mpm_find_contact_mass(const mpsi_grid *grid, const mpsi_contacts *contact,
                                mpsi_partition *partition) {
  mpsi_exact *sum = contact->sum_room.item; /* a body has one part at least */
  bool any = false;
  for (int32_t b = 0; b < contact->bodies; b++) any = any || needs_mass(contact, b);
  if (!any) return;
  memset(sum, 0, (size_t)contact->bodies * sizeof *sum);
  for (int64_t t = 0; t < contact->node_pair_count; t++) {
    const mpsi_node_pair *pair = &contact->node_pair[t];
    if (needs_mass(contact, pair->body) &&
        (!partition || mpsi_mpm_counts_node_block(grid, pair->nodes)))
      mpsi_exact_add(&sum[pair->body], pair->mass);
  }
  if (partition && partition->lost == MPS_OK)
    partition->lost =
        mpsi_domain_sum_exact(partition->domain, "mps_mpm_step", contact->bodies, sum);
  for (int32_t b = 0; b < contact->bodies; b++) contact->state[b].mass = mpsi_exact_value(&sum[b]);
}
