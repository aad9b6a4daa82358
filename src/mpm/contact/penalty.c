/* penalty.c - penalty contact from particles to nodes, Nakamura (29), (30): the particles of a
 * block are summed into tiles of the worker, one for each pair of the block and a body, and these
 * are added to the nodes in the order of the colours. Tiles of other ranks arrive with those of
 * momentum (step/tiles.c). SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/contact/pairs.h"

#include <string.h>

bool mpsi_mpm_has_penalty(const mpsi_contacts *contacts, const mpsi_cell_block *cells,
                          int32_t pair) {
  return cells->inside &&
         !mpsi_by_impulses(contacts->handle[contacts->cell_pair[cells->first_pair + pair].body]);
}

mpsi_penalty_node *mpsi_mpm_penalty_tile(const mpsi_grid *grid, const mpsi_worker *worker,
                                         int32_t pair) {
  return worker->penalty + (int64_t)pair * grid->tile_nodes;
}

bool mpsi_mpm_penalty_room(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contact) {
  int32_t most = 0;
  if (contact->penalty_bodies == 0) return true;
  for (int64_t b = 0; b < grid->cell_count; b++)
    if (grid->cells[b].pairs > most) most = grid->cells[b].pairs;
  const int64_t each = (int64_t)most * grid->tile_nodes;
  if (!mpsi_room_ensure(context, &contact->penalty_room, each * grid->worker_count,
                        sizeof(mpsi_penalty_node)))
    return false;
  for (int32_t k = 0; k < grid->worker_count; k++)
    grid->workers[k].penalty = (mpsi_penalty_node *)contact->penalty_room.item + k * each;
  return true;
}

void mpsi_mpm_clear_penalty(const mpsi_grid *grid, const mpsi_contacts *contacts,
                            const mpsi_cell_block *cells, const mpsi_worker *worker) {
  const size_t bytes = (size_t)(cells->high[0] - cells->low[0]) * sizeof(mpsi_penalty_node);
  for (int32_t q = 0; q < cells->pairs; q++) {
    if (!mpsi_mpm_has_penalty(contacts, cells, q)) continue;
    mpsi_penalty_node *tile = mpsi_mpm_penalty_tile(grid, worker, q);
    for (int k = cells->low[2]; k < cells->high[2]; k++)
      for (int j = cells->low[1]; j < cells->high[1]; j++)
        memset(tile + mpsi_tile_index(cells->low[0], j, k), 0, bytes);
  }
}

static void add_row(const mpsi_grid *grid, const mpsi_contacts *contacts,
                    const mpsi_cell_block *cells, int32_t body, int j, int k,
                    const mpsi_penalty_node *row) {
  for (int i = cells->low[0]; i < cells->high[0]; i++) {
    const mpsi_penalty_node *from = &row[i - cells->low[0]];
    if (from->mass == 0.0) continue;
    const int64_t node = mpsi_node_under(grid, cells, i, j, k);
    int32_t t = grid->nodes[node / grid->block_nodes].first_pair;
    while (contacts->node_pair[t].body != body) t++;
    mpsi_contact_node *to =
        &contacts->node[t * (int64_t)grid->block_nodes + node % grid->block_nodes];
    to->mass += from->mass;
    for (int c = 0; c < 3; c++) to->slip[c] += from->slip[c], to->force[c] += from->force[c];
  }
}

void mpsi_mpm_add_penalty(const mpsi_grid *grid, const mpsi_contacts *contacts,
                          const mpsi_cell_block *cells, const mpsi_worker *worker) {
  for (int32_t q = 0; q < cells->pairs; q++) {
    if (!mpsi_mpm_has_penalty(contacts, cells, q)) continue;
    const int32_t body = contacts->cell_pair[cells->first_pair + q].body;
    const mpsi_penalty_node *tile = mpsi_mpm_penalty_tile(grid, worker, q);
    for (int k = cells->low[2]; k < cells->high[2]; k++)
      for (int j = cells->low[1]; j < cells->high[1]; j++)
        add_row(grid, contacts, cells, body, j, k, tile + mpsi_tile_index(cells->low[0], j, k));
  }
}
