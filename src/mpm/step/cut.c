/* cut.c - before each step: blocks with particles whose supports are cut, and blocks in which
 * forces are summed apart from momenta (see mpsi_cell_block).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "core/base/room_array.h"

/* Range of nodes, low to high - 1, of a tile. */
typedef struct box {
  int low[3], high[3];
} box;

static bool is_empty(const box *a) {
  return a->low[0] >= a->high[0] || a->low[1] >= a->high[1] || a->low[2] >= a->high[2];
}

static box common(const box *a, const box *b) {
  box out;
  for (int c = 0; c < 3; c++) {
    out.low[c] = a->low[c] > b->low[c] ? a->low[c] : b->low[c];
    out.high[c] = a->high[c] < b->high[c] ? a->high[c] : b->high[c];
  }
  return out;
}

/* Tile nodes, of those that the block's stencils may use, that belong to the block of nodes under
 * corner q, from its node `low` to `high`. */
static box box_under(const mpsi_cell_block *cells, int q, const int32_t *low, const int32_t *high) {
  box used, out;
  for (int c = 0; c < 3; c++) {
    const int first = q >> c & 1 ? MPSI_SIDE : 0;
    used.low[c] = cells->low[c], used.high[c] = cells->high[c];
    out.low[c] = first + low[c], out.high[c] = first + high[c];
  }
  return common(&used, &out);
}

/* Range of the nodes of all stencils with a node in a body; empty where there are none. */
static box near_bodies(const mpsi_grid *grid, const mpsi_cell_block *cells) {
  const int reach = grid->spline;
  box out = {{MPSI_TILE_SIDE, MPSI_TILE_SIDE, MPSI_TILE_SIDE}, {0}};
  for (int q = 0; q < 1 << grid->dim; q++) {
    const mpsi_node_block *nodes = &grid->nodes[cells->to[q]];
    if (!nodes->inside) continue;
    const box in = box_under(cells, q, nodes->low, nodes->high);
    for (int c = 0; c < 3 && !is_empty(&in); c++) {
      if (in.low[c] - reach < out.low[c]) out.low[c] = in.low[c] - reach;
      if (in.high[c] + reach > out.high[c]) out.high[c] = in.high[c] + reach;
    }
  }
  return out;
}

/* Whether the stencils may have nodes beside a thin body. */
static bool near_thin(const mpsi_grid *grid, const mpsi_contacts *contacts,
                      const mpsi_cell_block *cells) {
  bool any = false;
  for (int q = 0; q < 1 << grid->dim; q++) any = any || grid->nodes[cells->to[q]].thin;
  return any && contacts->thin;
}

/* Assigns side values to the blocks of nodes under a cut block of cells, and marks those that are
 * split. `apart`: forces are needed apart from the momenta at all nodes; `finds`: an absorbing side
 * needs the forces of this step. */
static void mark_cut(mpsi_grid *grid, const mpsi_contacts *contacts, const mpsi_cell_block *cells,
                     const box *near, bool apart, bool finds) {
  static const int32_t low[3] = {0}, high[3] = {MPSI_SIDE, MPSI_SIDE, MPSI_SIDE};
  const bool all = apart || grid->by_weight || grid->flip > 0.0 || (finds && cells->edge);
  bool rough = false;
  for (int32_t k = 0; cells->inside && k < cells->pairs; k++) {
    const int32_t body = contacts->cell_pair[cells->first_pair + k].body;
    const mps_contact *contact = contacts->handle[body];
    rough = rough || (contact->def.friction > 0.0 && !mpsi_by_impulses(contact));
  }
  for (int q = 0; q < 1 << grid->dim; q++) {
    mpsi_node_block *nodes = &grid->nodes[cells->to[q]];
    box under = box_under(cells, q, low, high);
    under = common(&under, near);
    const bool in_contact = !is_empty(&under);
    if (!in_contact && !cells->edge && !grid->standard && !apart) continue;
    if (nodes->side < 0) nodes->side = (int32_t)grid->side_count++;
    nodes->split = nodes->split || all || (in_contact && (rough || cells->pairs > 1));
  }
}

/* Blocks that store the fits of their particles: those beside bodies; false: memory refused. */
static bool list_fits(mps_context *context, mpsi_grid *grid) {
  int64_t count = 0;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    mpsi_cell_block *cells = &grid->cells[b];
    cells->first_fit = cells->inside ? count : -1;
    if (cells->inside) count += cells->end - cells->begin;
  }
  if (!MPSI_ENSURE(context, grid, fit, count) || !MPSI_ENSURE(context, grid, fitted, count))
    return false;
  return true;
}

/* Cut: some particle may have a cut support, or, with the standard scheme, one without a fit.
 * Split: friction at nodes needs the velocity before the forces; so do the energy budget, damping
 * by forces, FLIP, and the transfer by weights, which divides momentum and force by different
 * masses, as nodes of small mass between two bodies do (node_update.c). */
static mps_status find_cut(mps_mpm *mpm, const char *function) {
  const bool apart =
      mpsi_forces_apart(&mpm->energy, &mpm->settling, &mpm->p, &mpm->def) || mpm->grid.apart;
  bool finds = false; /* an absorbing side needs the forces of its first step */
  for (int32_t k = 0; k < MPSI_SIDES; k++) {
    const mpsi_boundary *boundary = &mpm->boundaries.boundary[k];
    finds = finds || (boundary->finds && !(boundary->settle > 0.0));
  }
  for (int64_t g = 0; g < mpm->grid.node_count; g++)
    mpm->grid.nodes[g].side = -1, mpm->grid.nodes[g].split = false;
  mpm->grid.side_count = 0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    mpsi_cell_block *cells = &mpm->grid.cells[b];
    const box near = near_bodies(&mpm->grid, cells);
    cells->inside = !is_empty(&near);
    cells->thin = cells->ghost ? cells->thin && mpm->contact.thin
                               : near_thin(&mpm->grid, &mpm->contact, cells);
    cells->cut = cells->edge || cells->inside || cells->thin || mpm->grid.standard;
    if (cells->cut || apart) mark_cut(&mpm->grid, &mpm->contact, cells, &near, apart, finds);
  }
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    mpsi_cell_block *cells = &mpm->grid.cells[b];
    cells->split = false;
    for (int q = 0; q < 1 << mpm->grid.dim; q++)
      cells->split = cells->split || mpm->grid.nodes[cells->to[q]].split;
    cells->apart = cells->split || cells->cut;
  }
  if (!mpsi_mpm_list_across(mpm->context, &mpm->grid, &mpm->mirrors, &mpm->contact) ||
      !list_fits(mpm->context, &mpm->grid) ||
      !MPSI_ENSURE(mpm->context, &mpm->grid, side, mpm->grid.side_count * mpm->grid.block_nodes))
    return mpsi_fail_memory(mpm->context, function,
                            (size_t)(mpm->grid.side_count * mpm->grid.block_nodes) *
                                sizeof *mpm->grid.side);
  return MPS_OK;
}

mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function, mps_status status) {
  mpm->contact.penalty_bodies = 0;
  mpsi_inside_search search = {.context = mpm->context,
                               .grid = &mpm->grid,
                               .p = &mpm->p,
                               .contact = &mpm->contact,
                               .kernels = mpm->kernels};
  const mpsi_pass pass = {.data = &search,
                          .update = mpsi_mpm_find_inside,
                          .gather = mpsi_mpm_mark_reached,
                          .ghosts = true};
  if (mpm->contact.bodies > 0) {
    if (status == MPS_OK)
      status = mpsi_mpm_list_pairs(mpm->context, &mpm->grid, &mpm->contact, function);
    if (status == MPS_OK &&
        !mpsi_mpm_begin_across(mpm->context, &mpm->grid, &mpm->p, &mpm->contact))
      status = mpsi_fail_memory(mpm->context, function,
                                (size_t)(mpm->contact.node_pair_count * mpm->grid.block_nodes) *
                                    sizeof *mpm->contact.sight);
    if (status == MPS_OK && mpm->contact.cell_pair_count > 0)
      mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
    if (mpm->partition) { /* collective: also where the status of this rank is an error */
      for (int64_t b = 0; status == MPS_OK && b < mpm->grid.cell_count; b++)
        mpm->grid.cells[b].thin = near_thin(&mpm->grid, &mpm->contact, &mpm->grid.cells[b]);
      search.failed = status != MPS_OK;
      const mps_status lost = mpsi_mpm_exchange_corners(&search, mpm->partition, function);
      if (lost != MPS_OK) status = lost;
    }
  }
  return status == MPS_OK ? find_cut(mpm, function) : status;
}
