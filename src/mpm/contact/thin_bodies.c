/* thin_bodies.c - nodes that thin bodies separate from particles: see thin_bodies.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/rotation.h"
#include "core/base/room_array.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/pairs.h"

#include <string.h>

#define CLEAR 0.02   /* cells: least distance of a line of sight's ends from the surface */
#define CLOSED 0.002 /* cells: a line that comes nearer enters the body */
enum { MOST_STEPS = 200 };

/* ---- nodes ----------------------------------------------------------------------------------- */

bool mpsi_mpm_begin_across(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                           mpsi_contacts *contact) {
  const bool can = contact->penalty_bodies == 0 && !grid->standard;
  contact->thin = false;
  for (int32_t b = 0; b < contact->bodies; b++) {
    contact->state[b].parts = can && contact->handle[b]->thin;
    contact->thin = contact->thin || contact->state[b].parts;
  }
  if (!contact->thin) return true;
  const int64_t block = grid->block_nodes;
  const bool good = MPSI_ENSURE(context, contact, sight, contact->node_pair_count * block) &&
                    MPSI_ENSURE(context, contact, beside, contact->mask_count * block) &&
                    MPSI_ENSURE(context, contact, across, p->count);
  return good;
}

/* Origin of the lines of sight of x, and its distance from the surface. */
static mpsi_sight origin_of(const mpsi_grid *grid, const mpsi_foot *foot, const double *x) {
  const double clear = CLEAR * grid->cell;
  mpsi_sight out = {.distance = fmax(foot->distance, clear)};
  for (int c = 0; c < grid->dim; c++)
    out.at[c] = foot->distance < clear ? foot->at[c] + clear * foot->normal[c] : x[c];
  memcpy(out.normal, foot->normal, sizeof out.normal);
  return out;
}

static bool near_thin(const mpsi_contacts *contacts, const mpsi_node_block *nodes) {
  bool any = false;
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++)
    any = any || contacts->state[contacts->node_pair[t].body].parts;
  return any;
}

/* Only nodes within half a cell's diagonal of a body are beside it: a body between two nodes of a
 * stencil passes through one of its cells, and no point of a cell is farther from its nearest
 * corner than that. */
void mpsi_mpm_find_sight(const mpsi_grid *grid, const mpsi_contacts *contacts, int64_t g) {
  mpsi_node_block *nodes = &grid->nodes[g];
  nodes->thin = false;
  if (!near_thin(contacts, nodes)) return;
  const double half = 0.5 * sqrt((double)grid->dim) * grid->cell * (1.0 + 1e-9);
  uint8_t *beside = contacts->beside + mpsi_first_node(grid, nodes->near);
  memset(beside, 0, (size_t)grid->block_nodes);
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + nodes->pairs; t++) {
    const int32_t b = contacts->node_pair[t].body;
    mpsi_sight *sight = contacts->sight + (int64_t)t * grid->block_nodes;
    for (int k = 0; k < grid->block_nodes && contacts->state[b].parts; k++) {
      double x[3];
      mpsi_node_place(grid, nodes->at, k, x);
      const mpsi_foot foot = mpsi_body_foot(contacts->body[b], x);
      sight[k] = origin_of(grid, &foot, x);
      if (sight[k].distance > half) continue;
      beside[k] = 1;
      nodes->thin = true;
    }
  }
}

/* ---- blocks ---------------------------------------------------------------------------------- */

/* Memory for `count` blocks of nodes, keeping the present ones. */
static bool keep_and_widen(mps_context *context, mpsi_grid *grid, int64_t count) {
  const bool good = mpsi_room_keep(context, &grid->nodes_room, count, sizeof *grid->nodes) &&
                    MPSI_ENSURE(context, grid, node, count * grid->block_nodes);
  grid->nodes = grid->nodes_room.item;
  return good;
}

/* Second tiles for the workers, and a second mass for each ghost of a mirror. */
static bool ensure_tiles(mps_context *context, mpsi_grid *grid, mpsi_mirrors *mirrors) {
  const int64_t tile = grid->tile_nodes, plane = mpsi_mirror_plane(grid->tile_nodes);
  if (!mpsi_room_ensure(context, &grid->across_room, 2 * tile * grid->worker_count,
                        sizeof *grid->node) ||
      !MPSI_ENSURE(context, mirrors, mass, 2 * mirrors->count * plane))
    return false;
  for (int32_t k = 0; k < grid->worker_count; k++) {
    grid->workers[k].across_tile = (mpsi_node *)grid->across_room.item + 2 * tile * k;
    grid->workers[k].across_force = grid->workers[k].across_tile + tile;
  }
  return true;
}

/* Makes the block for the values across `nodes`: boundaries, damping and energy as theirs, but no
 * penalty contact. */
static void make_across(mpsi_grid *grid, const mpsi_node_block *nodes) {
  mpsi_node_block *across = &grid->nodes[nodes->across];
  *across = *nodes;
  across->across = across->near = -1;
  across->pairs = 0;
  across->inside = across->thin = across->waits = false;
  if (nodes->side >= 0) across->side = (int32_t)grid->side_count++;
}

bool mpsi_mpm_list_across(mps_context *context, mpsi_grid *grid, mpsi_mirrors *mirrors,
                          const mpsi_contacts *contacts) {
  int64_t count = grid->node_count;
  grid->across_count = 0;
  for (int64_t g = 0; g < grid->node_count; g++) grid->nodes[g].across = -1;
  for (int64_t b = 0; b < grid->cell_count && contacts->thin; b++)
    for (int q = 0; q < 1 << grid->dim && grid->cells[b].thin; q++) {
      mpsi_node_block *nodes = &grid->nodes[grid->cells[b].to[q]];
      if (nodes->across < 0) nodes->across = (int32_t)count++;
    }
  if (count == grid->node_count) return true;
  if (!keep_and_widen(context, grid, count) || !ensure_tiles(context, grid, mirrors)) return false;
  for (int64_t g = 0; g < grid->node_count; g++)
    if (grid->nodes[g].across >= 0) make_across(grid, &grid->nodes[g]);
  grid->across_count = count - grid->node_count;
  return true;
}

/* ---- lines of sight -------------------------------------------------------------------------- */

/* Coordinate (m) of the mirror at the upper or lower end of axis c. */
static double mirror_at(const mpsi_grid *grid, int c, bool upper) {
  const int64_t node = upper ? grid->high[c] : grid->low[c];
  return grid->origin[c] + grid->cell * (double)node;
}

/* Replaces a point beyond a mirror by its image. */
static void fold(const mpsi_grid *grid, const mpsi_cell_block *cells, double *x) {
  for (int c = 0; c < grid->dim; c++)
    for (int upper = 0; upper < 2; upper++) {
      if (!(cells->mirrors >> (2 * c + upper) & 1)) continue;
      const double wall = mirror_at(grid, c, upper);
      if (upper ? x[c] > wall : x[c] < wall) x[c] = 2.0 * wall - x[c];
    }
}

/* Parameter at which the line a + t way, t to 1, crosses a mirror next after t; INFINITY: none. */
static double next_mirror(const mpsi_grid *grid, const mpsi_cell_block *cells, const double *a,
                          const double *way, double t) {
  double next = INFINITY;
  for (int k = 0; k < 2 * grid->dim; k++) {
    if (!(cells->mirrors >> k & 1) || way[k / 2] == 0.0) continue;
    const double at = (mirror_at(grid, k / 2, k % 2) - a[k / 2]) / way[k / 2];
    if (at > t && at < next) next = at;
  }
  return next;
}

/* Whether the straight line from `from` to `to` (m), both outside the body, is free of it; the body
 * is mirrored as the ground is. Steps of the distance to the surface cannot pass it. */
static bool is_free(const mpsi_grid *grid, const mpsi_cell_block *cells, const mps_body *body,
                    const mpsi_sight *from, const double *to) {
  double way[3] = {0.0}, x[3] = {0.0}, distance = from->distance;
  for (int c = 0; c < grid->dim; c++) way[c] = to[c] - from->at[c];
  const double length = sqrt(mpsi_dot3(way, way));
  double t = 0.0;
  for (int step = 0; step < MOST_STEPS; step++) {
    const double next = next_mirror(grid, cells, from->at, way, t) + 1e-9;
    t = fmin(t + distance / length, next);
    if (!(t < 1.0)) return true;
    for (int c = 0; c < grid->dim; c++) x[c] = from->at[c] + t * way[c];
    fold(grid, cells, x);
    distance = mpsi_body_foot(body, x).distance;
    if (distance < CLOSED * grid->cell) return false;
  }
  return true;
}

/* Origin of lines of sight of tile node `at` for the body; a `ghost` has that of its image,
 * mirrored. */
static mpsi_sight sight_of(const mpsi_grid *grid, const mpsi_contacts *contacts,
                           const mpsi_cell_block *cells, int32_t body, const int *at, bool *ghost) {
  int place[3];
  *ghost = false;
  for (int c = 0; c < 3; c++) {
    place[c] = c < grid->dim ? mpsi_mpm_mirror_partner(grid, cells, c, at[c]) : 0;
    *ghost = *ghost || (c < grid->dim && place[c] != at[c]);
  }
  const int32_t g = mpsi_block_under(cells, place[0], place[1], place[2]);
  int32_t t = grid->nodes[g].first_pair;
  while (contacts->node_pair[t].body != body) t++;
  mpsi_sight out =
      contacts
          ->sight[(int64_t)t * grid->block_nodes + mpsi_local_under(place[0], place[1], place[2])];
  for (int c = 0; c < grid->dim; c++)
    if (place[c] != at[c]) out.at[c] = 2.0 * mirror_at(grid, c, place[c] < at[c]) - out.at[c];
  return out;
}

/* Whether tile node `at`, not a ghost, lies before the tangent plane at the particle's foot: a
 * convex body cannot separate it then. The same is true if the particle lies before the node's
 * tangent plane. */
static bool is_before(const mpsi_grid *grid, const mpsi_cell_block *cells, const int *at,
                      const mpsi_foot *foot) {
  const double local[3] = {at[0], at[1], at[2]};
  double x[3], across = 0.0;
  for (int c = 0; c < grid->dim && cells->mirrors; c++)
    if (mpsi_mpm_mirror_partner(grid, cells, c, at[c]) != at[c]) return false;
  mpsi_node_position(grid, cells->at, local, x);
  for (int c = 0; c < grid->dim; c++) across += (x[c] - foot->at[c]) * foot->normal[c];
  return across > 0.0;
}

/* Whether tile node `at` lies a cell or more below the tangent plane at the particle's foot, along
 * the axis that is nearest to the normal. */
static bool is_deep(const mpsi_grid *grid, const mpsi_cell_block *cells, const int *at,
                    const mpsi_foot *foot) {
  const double local[3] = {at[0], at[1], at[2]};
  double x[3], depth = 0.0, cell = 0.0;
  mpsi_node_position(grid, cells->at, local, x);
  for (int c = 0; c < grid->dim; c++) {
    depth -= (x[c] - foot->at[c]) * foot->normal[c];
    cell = fmax(cell, fabs(foot->normal[c]) * grid->cell);
  }
  return depth > (1.0 - 1e-9) * cell;
}

/* Adds the nodes of the stencil from `base` that body b separates from a particle at x. */
static void add_parted_by(const mpsi_grid *grid, const mpsi_contacts *contacts,
                          const mpsi_cell_block *cells, int32_t b, const int *base, const double *x,
                          mpsi_parted *out) {
  const mps_body *body = contacts->body[b];
  const bool convex = contacts->handle[b]->convex;
  const mpsi_foot foot = mpsi_body_foot(body, x);
  const mpsi_sight own = origin_of(grid, &foot, x);
  const int n = grid->spline;
  if (own.distance > 2.0 * sqrt((double)grid->dim) * grid->cell) return;
  for (int k = 0; k <= (grid->dim == 3 ? n : 0); k++)
    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n; i++) {
        const int at[3] = {base[0] + i, base[1] + j, base[2] + k};
        if (convex && is_before(grid, cells, at, &foot)) continue;
        bool ghost;
        const mpsi_sight node = sight_of(grid, contacts, cells, b, at, &ghost);
        double way[3];
        for (int c = 0; c < 3; c++) way[c] = node.at[c] - own.at[c];
        const double reach = own.distance + (ghost ? 0.0 : node.distance);
        if (convex && !ghost && mpsi_dot3(way, node.normal) < node.distance) continue;
        /* two overlapping balls that contain no part of the body */
        if (mpsi_dot3(way, way) < reach * reach) continue;
        if (is_free(grid, cells, body, &own, node.at)) continue;
        const uint64_t bit = UINT64_C(1) << (16 * k + 4 * j + i);
        out->across |= bit;
        if (is_deep(grid, cells, at, &foot)) out->cut |= bit;
      }
}

mpsi_parted mpsi_mpm_find_parted(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                 const mpsi_cell_block *cells, const int *base, const double *x) {
  mpsi_parted out = {0, 0};
  for (int32_t q = 0; q < cells->pairs; q++) {
    const int32_t b = contacts->cell_pair[cells->first_pair + q].body;
    if (contacts->state[b].parts) add_parted_by(grid, contacts, cells, b, base, x, &out);
  }
  return out;
}
