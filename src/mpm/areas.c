/* areas.c - how much of a surface each touch stands for, where the shear stress that the surface
 * bears has a strength or an adhesion in Pa. Particles are no measure: where soil flows along a
 * body few of those that touch it in one step do. The soil in the layer next to the surface is: a
 * particle of volume V at the distance D from it stands for the area
 *
 *   a = V w(D),   w = 2/d (1 - D/d) up to d = 4 half sizes or a cell, whose integral is 1,
 *
 * in axisymmetry brought from its own radius to that of its foot. It goes by bilinear weights to
 * the corners of the cell of the foot, and from these in equal parts to the touches that are
 * pressed within two cells, by cubic weights: the sum of their areas is that of the surface that
 * soil covers. SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include <string.h>

#define LAYER 4.0 /* half sizes, at most a cell: two layers of particles */

/* ---- nodes ----------------------------------------------------------------------------------- */

/* Nodes around the foot x, under the tile of a block of cells, for body b. */
typedef struct around {
  int count;
  mpsi_area *node[MPSI_STENCIL];
  double weight[MPSI_STENCIL];
} around;

/* Bilinear weights over the corners of the foot's cell (`side` 2), or cubic ones over four nodes an
 * axis (4). The foot is hardly a cell off a particle of the block: what would lie beyond the tile
 * is at its edge. */
static void find_around(const mps_mpm *mpm, const mpsi_cell_block *cells, int32_t b,
                        const double *x, int side, around *out) {
  int low[3] = {0};
  double w[3][4] = {{1.0}, {1.0}, {1.0}};
  for (int c = 0; c < mpm->dim; c++) {
    const double local = mpsi_grid_coordinate(mpm, c, x[c]) - (double)cells->at[c] * MPSI_SIDE;
    low[c] = (int)fmin(MPSI_TILE_SIDE - side, fmax(0.0, floor(local) + 1.0 - side / 2));
    const double part = fmin(1.0, fmax(0.0, local - low[c] + 1.0 - side / 2));
    if (side == 4)
      mpsi_weights(3, 1.0 + part, w[c]);
    else
      w[c][0] = 1.0 - part, w[c][1] = part;
  }
  const int planes = mpm->dim == 3 ? side : 1;
  out->count = 0;
  for (int n = 0; n < side * side * planes; n++) {
    const int i = n % side, j = n / side % side, k = n / side / side;
    const int64_t node = mpsi_node_under(mpm, cells, low[0] + i, low[1] + j, low[2] + k);
    int64_t t = mpm->grid.nodes[node / mpm->grid.block_nodes].first_pair;
    while (mpm->contact.node_pair[t].body != b) t++;
    out->node[out->count] =
        mpm->contact.impulses.area + t * mpm->grid.block_nodes + node % mpm->grid.block_nodes;
    out->weight[out->count++] = w[0][i] * w[1][j] * w[2][k];
  }
}

/* ---- particles ------------------------------------------------------------------------------- */

static double layer_of(const mps_mpm *mpm, const mps_contact *contact) {
  return fmin(LAYER * contact->def.offset, mpm->def.cell);
}

static double area_of(const mps_mpm *mpm, const mps_contact *contact, int64_t k,
                      const mpsi_foot *foot) {
  const double deep = layer_of(mpm, contact), distance = fmax(0.0, foot->distance);
  if (!(distance < deep)) return 0.0;
  const double area = mpm->p.V[k] * 2.0 / deep * (1.0 - distance / deep);
  return mpm->def.geometry == MPS_MPM_AXISYMMETRIC ? area * foot->at[0] / mpm->p.x[0][k] : area;
}

/* Those of a pair of a block and a body. Distances change no faster than places: see touches.c. */
static void add_particles(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_cell_pair *pair) {
  const mps_contact *contact = mpm->contact.handle[pair->body];
  double known[3] = {0.0}, distance = -1.0;
  for (int64_t k = cells->begin; k < cells->end; k++) {
    double x[3] = {0.0}, square = 0.0;
    for (int c = 0; c < mpm->dim; c++) {
      x[c] = mpm->p.x[c][k];
      square += (x[c] - known[c]) * (x[c] - known[c]);
    }
    const double slack = distance - layer_of(mpm, contact);
    if (slack > 0.0 && square < slack * slack) continue;
    const mpsi_foot foot = mpsi_body_foot(contact->body, x);
    memcpy(known, x, sizeof known);
    distance = foot.distance;
    const double area = area_of(mpm, contact, k, &foot);
    around at;
    if (!(area > 0.0)) continue;
    find_around(mpm, cells, pair->body, foot.at, 2, &at);
    for (int q = 0; q < at.count; q++) at.node[q]->area += at.weight[q] * area;
  }
}

static void add_block(void *data, int64_t unit, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_impulses *all = &mpm->contact.impulses;
  const mpsi_cell_block *cells = &mpm->grid.cells[mpm->grid.coloured[all->area_first + unit]];
  (void)worker;
  for (int32_t q = 0; q < cells->pairs; q++) {
    const mpsi_cell_pair *pair = &mpm->contact.cell_pair[cells->first_pair + q];
    if (mpsi_has_strength(mpm->contact.handle[pair->body])) add_particles(mpm, cells, pair);
  }
}

/* ---- touches --------------------------------------------------------------------------------- */

static bool is_pressed(const mpsi_touch *touch) { return touch->impulse.push > 0.0; }

static void count_block(void *data, int64_t unit, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_impulses *all = &mpm->contact.impulses;
  const mpsi_touch_block *block = &all->block[all->area_first + unit];
  (void)worker;
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    const mpsi_touch *touch = &all->touch[n];
    around at;
    if (!mpsi_has_strength(mpm->contact.handle[touch->body]) || !is_pressed(touch)) continue;
    find_around(mpm, &mpm->grid.cells[block->cells], touch->body, touch->impulse.at, 4, &at);
    for (int q = 0; q < at.count; q++) at.node[q]->touches += at.weight[q];
  }
}

/* One that was not counted takes the share of one that was. */
static void share_block(void *data, int64_t unit, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_impulses *all = &mpm->contact.impulses;
  const mpsi_touch_block *block = &all->block[unit];
  (void)worker;
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    mpsi_touch *touch = &all->touch[n];
    const mps_contact_def *def = &mpm->contact.handle[touch->body]->def;
    around at;
    double area = 0.0;
    if (!mpsi_has_strength(mpm->contact.handle[touch->body])) continue;
    find_around(mpm, &mpm->grid.cells[block->cells], touch->body, touch->impulse.at, 4, &at);
    for (int q = 0; q < at.count; q++)
      if (at.weight[q] > 0.0)
        area += at.weight[q] * at.node[q]->area /
                fmax(at.node[q]->touches, is_pressed(touch) ? 0.0 : 1.0);
    touch->impulse.adhesion = mpm->run.dt * area * def->adhesion;
    if (!isnan(def->strength)) touch->impulse.strength = mpm->run.dt * area * def->strength;
  }
}

/* ---- a step ---------------------------------------------------------------------------------- */

bool mpsi_mpm_area_room(mps_mpm *mpm) {
  mpsi_impulses *all = &mpm->contact.impulses;
  bool wanted = false;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    wanted = wanted || mpsi_has_strength(mpm->contact.handle[b]);
  const int64_t nodes = wanted ? mpm->contact.node_pair_count * mpm->grid.block_nodes : 0;
  all->area_count = 0;
  if (!mpsi_room_ensure(mpm->context, &all->area_room, nodes, sizeof *all->area)) return false;
  all->area = all->area_room.item;
  all->area_count = nodes;
  return true;
}

/* Blocks of one colour share no node. */
void mpsi_mpm_find_areas(mps_mpm *mpm) {
  mpsi_impulses *all = &mpm->contact.impulses;
  if (all->area_count == 0 || all->touch_count == 0) return;
  memset(all->area, 0, (size_t)all->area_count * sizeof *all->area);
  for (int k = 0; k < MPSI_CORNERS; k++) {
    all->area_first = mpm->grid.colour[k];
    mpsi_parallel_for(mpm->context, mpm->grid.colour[k + 1] - all->area_first, add_block, mpm);
  }
}

void mpsi_mpm_share_areas(mps_mpm *mpm) {
  mpsi_impulses *all = &mpm->contact.impulses;
  if (all->area_count == 0) return;
  for (int64_t k = 0; k < all->area_count; k++) all->area[k].touches = 0.0;
  for (int k = 0; k < MPSI_CORNERS; k++) {
    all->area_first = all->colour[k];
    mpsi_parallel_for(mpm->context, all->colour[k + 1] - all->area_first, count_block, mpm);
  }
  mpsi_parallel_for(mpm->context, all->block_count, share_block, mpm);
}
