/* area.c - the area of the surface that each contact constraint represents, where the shear stress
 * on the surface has a strength or an adhesion in Pa, and the ground's part of the stress there.
 * The constraints of one step do not measure it: where soil flows along a body, few of the
 * particles beside it are in contact in any one step. The layer of soil next to the surface does: a
 * particle of volume V at the distance D from the surface represents the area
 *
 *   a = V J w(D),   w = t^2/d for t = D/d from 0 to 1, (1 - (t - 1)^2)/d from 1 to 2,
 *
 * d being the spacing of the particles. J is the ratio of an area on the body to its area on the
 * parallel surface through the particle (mpsi_foot), in axisymmetry with the ratio of the radii.
 * The integral of w is 1. Rows of particles d apart sum up to 1 wherever they begin, since w(D) +
 * w(D + d) = 1/d; where they are compressed the sum changes with the square of the strain alone, as
 * w' = 1/d^2 at d/2; and where no particle is nearer than g, (g/d)^3/3 of the area is lacking.
 * Where 2 d is more than a cell h, for which tiles have no room, w = 2/h (1 - D/h), which lacks 2
 * g/h.
 *
 * The area is distributed by bilinear weights to the corners of the cell that contains the foot,
 * and from these to the constraints within two cells, by cubic weights times their normal impulses:
 * the sum of their areas is that of the surface that soil covers. The factor is needed because
 * among constraints that share nodes only the sum of the normal impulses is determined: with equal
 * parts, a constraint with hardly any normal impulse could not carry the shear of its part by
 * friction.
 *
 * In saturated ground friction is limited by mu P s'/(s' + p), with the effective stress s' across
 * the surface and the pressure p of the water: means over the same layer, weighted by volumes
 * alone, by the same way over the nodes. The constraints themselves do not have them: particles
 * that bear have more of s' than those between them, and P changes from step to step while s' and p
 * do not. Sums of a block are made separately and added to the nodes in the order of the colours;
 * those of other ranks arrive with their constraints (exchange.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/kernels.h"
#include "core/base/room_array.h"
#include "mpm/base/run.h"
#include "mpm/contact/pairs.h"
#include "mpm/ranks/partition.h"

#include <string.h>

/* ---- nodes ----------------------------------------------------------------------------------- */

/* Nodes around a foot, under the tile of a block of cells, with weights. */
typedef struct around {
  int low[3], side;
  double w[3][4];
} around;

/* Bilinear weights over the corners of the cell of the foot x (`side` 2), or cubic ones over four
 * nodes an axis (4). The foot is less than about a cell from a particle of the block; nodes beyond
 * the tile are replaced by those at its edge. `block`: coordinates of the block of cells. */
static around find_around(const mpsi_grid *grid, const int32_t *block, const double *x, int side) {
  around out = {.side = side, .w = {{1.0}, {1.0}, {1.0}}};
  for (int c = 0; c < grid->dim; c++) {
    const double local = mpsi_grid_at(grid, c, x[c]) - (double)block[c] * MPSI_SIDE;
    const int low = (int)fmin(MPSI_TILE_SIDE - side, fmax(0.0, floor(local) + 1.0 - side / 2));
    const double part = fmin(1.0, fmax(0.0, local - low + 1.0 - side / 2));
    out.low[c] = low;
    if (side == 4)
      mpsi_weights(3, 1.0 + part, out.w[c]);
    else
      out.w[c][0] = 1.0 - part, out.w[c][1] = part;
  }
  return out;
}

static int nodes_around(const mpsi_grid *grid, int side) {
  return grid->dim == 3 ? side * side * side : side * side;
}

/* Position under the tile and weight of node n around the foot. */
static double node_around(const around *a, int n, int *at) {
  const int i[3] = {n % a->side, n / a->side % a->side, n / a->side / a->side};
  for (int c = 0; c < 3; c++) at[c] = a->low[c] + i[c];
  return a->w[0][i[0]] * a->w[1][i[1]] * a->w[2][i[2]];
}

static mpsi_area *area_under(const mpsi_grid *grid, const mpsi_contacts *contacts,
                             const mpsi_cell_block *cells, const int *at, int32_t b) {
  const int64_t node = mpsi_node_under(grid, cells, at[0], at[1], at[2]);
  int64_t t = grid->nodes[node / grid->block_nodes].first_pair;
  while (contacts->node_pair[t].body != b) t++;
  return contacts->impulses.area + t * grid->block_nodes + node % grid->block_nodes;
}

/* ---- particles ------------------------------------------------------------------------------- */

/* Layer of soil next to the surface, m: spacing of its rows of particles; thickness. */
typedef struct layer {
  double row, reach;
} layer;

static layer find_layer(const mpsi_grid *grid, const mpsi_columns *p) {
  const double row = mps_particles_spacing(p->set);
  return (layer){row, fmin(2.0 * row, grid->cell)};
}

/* Weight w (1/m) at the distance D (m), less than the thickness of the layer. */
static double weight_at(layer l, double distance) {
  const double t = fmax(0.0, distance) / l.row;
  if (l.reach < 2.0 * l.row * (1.0 - 1e-9))
    return 2.0 / l.reach * (1.0 - fmax(0.0, distance) / l.reach);
  return (t < 1.0 ? t * t : t * (2.0 - t)) / l.row;
}

/* What a particle at a foot represents of the surface. */
static mpsi_area area_of(const mpsi_grid *grid, const mpsi_columns *p, layer l, int64_t k,
                         const mpsi_foot *foot, bool wet) {
  mpsi_area out = {.area = 0.0};
  if (!(foot->distance < l.reach)) return out;
  out.area = p->V[k] * foot->narrowing * weight_at(l, foot->distance);
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC)
    out.area = out.area * foot->at[0] / p->x[0][k];
  if (!wet) return out;
  out.borne = mpsi_mpm_borne(p, grid->dim, k, foot->normal);
  out.borne.ground *= p->V[k];
  out.borne.water *= p->V[k];
  return out;
}

/* Particles that the distance of the last one excludes are skipped, as in constraints.c. */
bool mpsi_mpm_sum_areas(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_contacts *contacts,
                        const mpsi_cell_pair *pair, mpsi_area *tile) {
  const mpsi_cell_block *cells = &grid->cells[pair->cells];
  const mps_contact *contact = contacts->handle[pair->body];
  const layer l = find_layer(grid, p);
  double known[3] = {0.0}, distance = -1.0;
  bool any = false;
  if (!mpsi_has_areas(contact, contacts->wet)) return false;
  memset(tile, 0, (size_t)grid->tile_nodes * sizeof *tile);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    double x[3] = {0.0}, square = 0.0;
    for (int c = 0; c < grid->dim; c++) {
      x[c] = p->x[c][k];
      square += (x[c] - known[c]) * (x[c] - known[c]);
    }
    const double slack = distance - l.reach;
    if (slack > 0.0 && square < slack * slack) continue;
    const mpsi_foot foot = mpsi_body_foot(contact->body, x);
    memcpy(known, x, sizeof known);
    distance = foot.distance;
    const mpsi_area own = area_of(grid, p, l, k, &foot, contacts->wet);
    if (!(own.area > 0.0)) continue;
    const around corners = find_around(grid, cells->at, foot.at, 2);
    for (int n = 0; n < nodes_around(grid, 2); n++) {
      int at[3];
      const double weight = node_around(&corners, n, at);
      mpsi_mpm_add_area(&tile[mpsi_tile_index(at[0], at[1], at[2])], weight * own.area,
                        (mpsi_borne){weight * own.borne.ground, weight * own.borne.water});
    }
    any = true;
  }
  return any;
}

static void add_block(void *data, int64_t unit, int32_t worker) {
  const mpsi_contact_stage *stage = data;
  const mpsi_grid *grid = stage->transfer.grid;
  const mpsi_impulses *all = &stage->contact->impulses;
  const mpsi_cell_block *cells = &grid->cells[grid->coloured[all->area_first + unit]];
  mpsi_area *tile = grid->workers[worker].scratch;
  _Static_assert(sizeof(mpsi_area[MPSI_TILE_SIDE * MPSI_TILE_SIDE * MPSI_TILE_SIDE]) <=
                     MPSI_WORKER_SCRATCH,
                 "scratch of a worker");
  for (int32_t q = 0; q < cells->pairs; q++) {
    const mpsi_cell_pair *pair = &stage->contact->cell_pair[cells->first_pair + q];
    if (!mpsi_mpm_sum_areas(grid, stage->transfer.p, stage->contact, pair, tile)) continue;
    for (int k = 0; k < grid->tile_nodes; k++) {
      int at[3];
      mpsi_unravel(k, MPSI_TILE_SIDE, at);
      if (tile[k].area > 0.0)
        mpsi_mpm_add_area(area_under(grid, stage->contact, cells, at, pair->body), tile[k].area,
                          tile[k].borne);
    }
  }
}

/* ---- constraints ----------------------------------------------------------------------------- */

/* The nodes around the feet of a block's constraints; friction of what the ground bears there. */
static void surround_block(void *data, int64_t unit, int32_t worker) {
  const mpsi_contact_stage *stage = data;
  const mpsi_grid *grid = stage->transfer.grid;
  mpsi_impulses *all = &stage->contact->impulses;
  const mpsi_constraint_block *block = &all->block[unit];
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    mpsi_constraint *constraint = &all->constraint[n];
    mpsi_borne borne = {0.0, 0.0};
    constraint->areas = 0;
    if (!mpsi_has_areas(stage->contact->handle[constraint->body], stage->contact->wet)) continue;
    const around nodes = find_around(grid, block->at, constraint->impulse.at, 4);
    for (int k = 0; k < nodes_around(grid, 4); k++) {
      int at[3];
      const double weight = node_around(&nodes, k, at);
      mpsi_area *area =
          stage->partition
              ? mpsi_mpm_shared_area(&stage->contact->exchange, block->at, at, constraint->body)
              : area_under(grid, stage->contact, &grid->cells[block->cells], at, constraint->body);
      if (!area || !(area->area > 0.0 && weight > 0.0)) continue;
      all->around[n * nodes_around(grid, 4) + constraint->areas++] =
          (mpsi_area_share){area, weight};
      borne.ground += weight * area->borne.ground, borne.water += weight * area->borne.water;
    }
    constraint->impulse.friction *= mpsi_ground_share(borne); /* of dry ground 1 */
  }
}

static void count_block(void *data, int64_t unit, int32_t worker) {
  const mpsi_contact_stage *stage = data;
  const mpsi_grid *grid = stage->transfer.grid;
  const mpsi_impulses *all = &stage->contact->impulses;
  const mpsi_constraint_block *block = &all->block[all->area_first + unit];
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    const mpsi_area_share *at = all->around + n * nodes_around(grid, 4);
    const double normal = all->constraint[n].impulse.normal_impulse;
    for (int q = 0; q < all->constraint[n].areas && normal > 0.0; q++)
      at[q].node->normal += at[q].weight * normal;
  }
}

static void share_block(void *data, int64_t unit, int32_t worker) {
  const mpsi_contact_stage *stage = data;
  const mpsi_grid *grid = stage->transfer.grid;
  const mpsi_impulses *all = &stage->contact->impulses;
  const mpsi_constraint_block *block = &all->block[unit];
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    mpsi_constraint *constraint = &all->constraint[n];
    const mpsi_area_share *at = all->around + n * nodes_around(grid, 4);
    const mps_contact_def *def = &stage->contact->handle[constraint->body]->def;
    double area = 0.0;
    if (!mpsi_has_strength(stage->contact->handle[constraint->body])) continue;
    for (int q = 0; q < constraint->areas; q++)
      if (at[q].node->normal > 0.0)
        area += at[q].weight * constraint->impulse.normal_impulse * at[q].node->area /
                at[q].node->normal;
    constraint->impulse.adhesion = stage->transfer.run->dt * area * def->adhesion;
    if (!isnan(def->strength))
      constraint->impulse.strength = stage->transfer.run->dt * area * def->strength;
  }
}

/* ---- a step ---------------------------------------------------------------------------------- */

bool mpsi_mpm_area_room(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contacts,
                        mpsi_partition *partition, int64_t constraints) {
  mpsi_impulses *all = &contacts->impulses;
  bool wanted = false;
  all->areas = all->strengths = false;
  for (int32_t b = 0; b < contacts->bodies; b++) {
    wanted = wanted || mpsi_has_areas(contacts->handle[b], contacts->wet);
    all->strengths = all->strengths || mpsi_has_strength(contacts->handle[b]);
  }
  if (!wanted) return true;
  const int64_t nodes = partition ? 0 : contacts->node_pair_count * grid->block_nodes;
  if (!MPSI_ENSURE(context, all, area, nodes) ||
      !MPSI_ENSURE(context, all, around, constraints * nodes_around(grid, 4)))
    return false;
  all->area_count = nodes;
  all->areas = true;
  return true;
}

/* Blocks of one colour share no node, so that their sums are added without conflicts. */
void mpsi_mpm_find_areas(const mpsi_contact_stage *stage) {
  const mpsi_grid *grid = stage->transfer.grid;
  mpsi_impulses *all = &stage->contact->impulses;
  if (!all->areas || all->constraint_count == 0) return;
  if (!stage->partition) memset(all->area, 0, (size_t)all->area_count * sizeof *all->area);
  for (int k = 0; k < MPSI_CORNERS && !stage->partition; k++) {
    all->area_first = grid->colour[k];
    mpsi_parallel_for(stage->context, grid->colour[k + 1] - all->area_first, add_block,
                      (void *)stage);
  }
  mpsi_parallel_for(stage->context, all->block_count, surround_block, (void *)stage);
}

void mpsi_mpm_distribute_areas(const mpsi_contact_stage *stage) {
  const mpsi_grid *grid = stage->transfer.grid;
  mpsi_impulses *all = &stage->contact->impulses;
  if (!all->strengths) return;
  for (int64_t n = 0; n < all->constraint_count; n++)
    for (int32_t q = 0; q < all->constraint[n].areas; q++)
      all->around[n * nodes_around(grid, 4) + q].node->normal = 0.0;
  for (int k = 0; k < MPSI_CORNERS; k++) {
    all->area_first = all->colour[k];
    mpsi_parallel_for(stage->context, all->colour[k + 1] - all->area_first, count_block,
                      (void *)stage);
  }
  mpsi_parallel_for(stage->context, all->block_count, share_block, (void *)stage);
}
