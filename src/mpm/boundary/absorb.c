/* absorb.c - absorbing walls of the WLS-MPM grid: the dashpots of Lysmer and Kuhlemeyer, traction R
 * - rho c_p v across the wall and R - rho c_s v along it.
 *
 * A dashpot acts on each node of the wall. Its coefficient rho c A is distributed by the particles
 * in the cells at the wall: each represents the area V/h and adds rho c V/h = c m/h to the wall's
 * nodes by the least-squares shape functions of that plane, which are those of the masses there
 * (Nakamura (5), (6) with one axis less). So a wall covered in part has the right total force, and
 * its nodes the right ratio of damping to mass. Coefficients are found every eighth step, and when
 * the caller has changed something. The particles of a block are summed separately: on several
 * ranks such sums are received from others (dashpots.c).
 *
 * R is the traction by the stress at rest: the mean of the force on the node while the wall is held
 * and settles, or what balances the forces of the first step.
 *
 * By the same sums frictional sides of saturated ground find in each step what ground and water
 * bear at their nodes (mpsi_borne times the volume of each particle). SPDX-License-Identifier:
 * BSD-3-Clause */
#include "mpm/base/shape.h"
#include "mpm/ranks/messages.h"
#include "mpm/contact/thin_bodies.h"

#include "corners.h"
#include "kinds.h"

#include <string.h>

void mpsi_mpm_apply_dashpot(const mpsi_grid *grid, double dt, const mpsi_boundary *boundary,
                            mpsi_dashpot *dashpot, const double *node, const double *before,
                            double *velocity) {
  const double per_mass = dt / node[MPSI_MASS];
  const bool settles = boundary->finds && boundary->settle > 0.0;
  for (int c = 0; c < grid->dim; c++) {
    const double v = node[MPSI_VECTOR + c],
                 damping = c == boundary->axis ? dashpot->across : dashpot->along;
    if (settles) {
      const double force = (boundary->v[c] - v) / per_mass;
      dashpot->rest[c] += (force - dashpot->rest[c]) * (dt / boundary->found);
      velocity[c] = boundary->v[c];
      continue;
    }
    if (boundary->finds) dashpot->rest[c] = before ? (before[c] - v) / per_mass : 0.0;
    /* implicit: stable for every dt */
    velocity[c] =
        (v + per_mass * (dashpot->rest[c] + damping * boundary->v[c])) / (1.0 + per_mass * damping);
  }
}

bool mpsi_mpm_absorbs(const mpsi_boundaries *boundaries) {
  bool any = false;
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    any = any || mpsi_kind_of(&boundaries->boundary[k])->absorbs;
  return any;
}

/* ---- coefficients ---------------------------------------------------------------------------- */

/* Shape functions along one axis, fitted over the nodes of the domain. */
static void fit_along(const mpsi_grid *grid, int c, double X, int64_t *base, double *phi) {
  double w[4], s[4], m0 = 0.0, m1 = 0.0, m2 = 0.0;
  const double lowest = mpsi_base(grid->spline, X);
  *base = (int64_t)lowest;
  mpsi_weights(grid->spline, X - lowest, w);
  for (int i = 0; i < 4; i++) {
    const int64_t n = *base + i;
    s[i] = (double)i - (X - lowest);
    if (n < grid->use_low[c] || n > grid->use_high[c]) w[i] = 0.0;
    m0 += w[i], m1 += w[i] * s[i], m2 += w[i] * s[i] * s[i];
  }
  for (int i = 0; i < 4; i++) phi[i] = w[i] * (m2 - m1 * s[i]) / (m0 * m2 - m1 * m1);
  for (int i = 0; i < 4; i++) { /* ghosts of a mirror beside the wall are added to their partners */
    const int64_t n = *base + i;
    const int64_t wall = n < grid->low[c] ? grid->low[c] : grid->high[c];
    if ((n >= grid->low[c] && n <= grid->high[c]) || phi[i] == 0.0) continue;
    phi[2 * wall - n - *base] += phi[i];
    phi[i] = 0.0;
  }
}

/* Adds to the sums of a node of the wall. */
static void add_terms(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int32_t number,
                      int64_t node, const double *term) {
  const mpsi_node_block *nodes = &grid->nodes[node / grid->block_nodes];
  int32_t t = nodes->first_held;
  while (boundaries->held[t].boundary != number) t++;
  const mpsi_held *held = &boundaries->held[t];
  const int plane =
      mpsi_plane_index(boundaries->boundary[number].axis, (int)(node % grid->block_nodes));
  if (held->borne >= 0) {
    boundaries->borne[held->borne + plane].ground += term[0];
    boundaries->borne[held->borne + plane].water += term[1];
  } else {
    boundaries->dashpot[held->dashpot + plane].across += term[0];
    boundaries->dashpot[held->dashpot + plane].along += term[1];
  }
}

/* Index, in the plane across `axis`, of tile node `at`. */
static int tile_plane_index(int axis, const int *at) {
  return at[axis == 2 ? 1 : 2] * MPSI_TILE_SIDE + at[axis == 0 ? 1 : 0];
}

/* What a particle of which `part` lies in a cell at the wall adds to the sums there. */
static void find_terms(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_boundary *boundary,
                       int64_t k, double part, double *term) {
  const double per_area = part * p->m[k] * grid->inverse, density = p->m[k] / p->V[k];
  double wave, shear, normal[3] = {0.0};
  if (mpsi_kind_of(boundary)->friction) {
    normal[boundary->axis] = 1.0;
    const mpsi_borne borne = mpsi_mpm_borne(p, grid->dim, k, normal);
    term[0] = part * p->V[k] * borne.ground;
    term[1] = part * p->V[k] * borne.water;
    return;
  }
  mpsi_mpm_saturated(p, k, &wave, &shear);
  term[0] = per_area * sqrt(wave / density);
  term[1] = per_area * sqrt(shear / density);
}

/* Adds a particle to the nodes of the wall in the plane of a tile. */
static void add_particle(const mpsi_grid *grid, const mpsi_columns *p,
                         const mpsi_boundaries *boundaries, const mpsi_cell_block *cells,
                         int32_t number, int64_t k, double part, double (*tile)[2]) {
  const int axis = boundaries->boundary[number].axis;
  double term[2];
  find_terms(grid, p, &boundaries->boundary[number], k, part, term);
  int64_t base[3] = {0};
  double phi[3][4] = {{1.0}, {1.0}, {1.0}};
  for (int c = 0; c < grid->dim; c++)
    if (c == axis)
      base[c] = boundaries->boundary[number].first[c];
    else
      fit_along(grid, c, mpsi_grid_at(grid, c, p->x[c][k]), &base[c], phi[c]);
  for (int n = 0; n < MPSI_STENCIL; n++) {
    const int i[3] = {n % 4, n / 4 % 4, n / 16};
    const double fraction = phi[0][i[0]] * phi[1][i[1]] * phi[2][i[2]];
    if (fraction == 0.0) continue;
    int at[3];
    for (int c = 0; c < 3; c++) at[c] = (int)(base[c] + i[c] - (int64_t)cells->at[c] * MPSI_SIDE);
    double *to = tile[tile_plane_index(axis, at)];
    to[0] += fraction * term[0];
    to[1] += fraction * term[1];
  }
}

bool mpsi_mpm_sum_at_side(const mpsi_grid *grid, const mpsi_columns *p,
                          const mpsi_boundaries *boundaries, const mpsi_cell_block *cells,
                          int32_t number, double (*tile)[2]) {
  const int c = boundaries->boundary[number].axis;
  /* layer of cells at the wall */
  const int64_t layer = boundaries->boundary[number].first[c] - number % 2;
  const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
  if (layer < first || layer >= first + MPSI_TILE_SIDE) return false;
  memset(tile, 0, MPSI_DASH_PLANE * sizeof *tile);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    const double part = mpsi_mpm_part_at_side(grid, number, mpsi_grid_at(grid, c, p->x[c][k]));
    if (part > 0.0) add_particle(grid, p, boundaries, cells, number, k, part, tile);
  }
  return true;
}

static void add_tile(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                     const mpsi_cell_block *cells, int32_t number, const double *tile) {
  const mpsi_boundary *boundary = &boundaries->boundary[number];
  const int axis = boundary->axis, planes = grid->dim == 3 ? MPSI_TILE_SIDE : 1;
  for (int k = 0; k < planes * MPSI_TILE_SIDE; k++) {
    const int u = k % MPSI_TILE_SIDE, v = k / MPSI_TILE_SIDE;
    int at[3] = {axis == 0 ? 0 : u, axis == 0 ? u : axis == 2 ? v : 0, axis == 2 ? 0 : v};
    at[axis] = (int)(boundary->first[axis] - (int64_t)cells->at[axis] * MPSI_SIDE);
    if (tile[2 * k] == 0.0 && tile[2 * k + 1] == 0.0) continue;
    add_terms(grid, boundaries, number, mpsi_node_under(grid, cells, at[0], at[1], at[2]),
              tile + 2 * k);
  }
}

static void add_wall(const mpsi_grid *grid, const mpsi_columns *p,
                     const mpsi_boundaries *boundaries, const mpsi_partition *ranks,
                     int32_t number) {
  for (int64_t b = 0; b < grid->cell_count; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    double own[MPSI_DASH_PLANE][2], *tile;
    (void)mpsi_mpm_find_message(ranks, cells, &tile);
    if (tile)
      tile += number * (ranks->doubles / MPSI_SIDES);
    else if (mpsi_mpm_sum_at_side(grid, p, boundaries, cells, number, own))
      tile = own[0];
    if (tile) add_tile(grid, boundaries, cells, number, tile);
  }
}

/* ---- lists ----------------------------------------------------------------------------------- */

/* Order of the list: by block, ascending in z, y, x, then by boundary. */
int mpsi_mpm_compare_held(const mpsi_held *a, const mpsi_held *b) {
  for (int c = 2; c >= 0; c--)
    if (a->at[c] != b->at[c]) return a->at[c] < b->at[c] ? -1 : 1;
  return (a->boundary > b->boundary) - (a->boundary < b->boundary);
}

void mpsi_mpm_carry_dashpots(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                             const mpsi_held_list *old) {
  const size_t plane = (size_t)(grid->block_nodes / MPSI_SIDE);
  int64_t from = 0;
  for (int64_t t = 0; t < boundaries->held_count; t++) {
    const mpsi_held *held = &boundaries->held[t];
    if (held->dashpot < 0) continue;
    while (from < old->count && mpsi_mpm_compare_held(&old->held[from], held) < 0) from++;
    if (from == old->count || mpsi_mpm_compare_held(&old->held[from], held) != 0 ||
        old->held[from].dashpot < 0 || !old->held[from].whole)
      continue;
    memcpy(boundaries->dashpot + held->dashpot, old->dashpot + old->held[from].dashpot,
           plane * sizeof *old->dashpot);
  }
}

void mpsi_mpm_find_dashpots(const mpsi_grid *grid, const mpsi_columns *p,
                            const mpsi_boundaries *boundaries, const mpsi_partition *ranks) {
  mpsi_dashpot *all = boundaries->dashpot;
  for (int64_t k = 0; k < boundaries->dashpot_count; k++) all[k].across = all[k].along = 0.0;
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (mpsi_kind_of(&boundaries->boundary[k])->absorbs) add_wall(grid, p, boundaries, ranks, k);
  for (int64_t k = 0; k < boundaries->dashpot_count; k++) { /* fits can be negative */
    all[k].across = fmax(all[k].across, 0.0);
    all[k].along = fmax(all[k].along, 0.0);
  }
}

bool mpsi_mpm_has_friction(const mpsi_boundaries *boundaries) {
  bool any = false;
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    any = any || mpsi_kind_of(&boundaries->boundary[k])->friction;
  return any;
}

void mpsi_mpm_sum_borne(const mpsi_grid *grid, const mpsi_columns *p,
                        const mpsi_boundaries *boundaries, const mpsi_partition *ranks) {
  const size_t bytes = (size_t)boundaries->borne_count * sizeof *boundaries->borne;
  if (bytes > 0) memset(boundaries->borne, 0, bytes);
  for (int32_t k = 0; k < MPSI_SIDES; k++)
    if (mpsi_kind_of(&boundaries->boundary[k])->friction) add_wall(grid, p, boundaries, ranks, k);
}
