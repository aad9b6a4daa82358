/* pairs.c - the pairs of the reference lattice closer than re, Yoshida (A8): those of the body,
 * with its period; those of a free-field column, which represents horizontally infinite ground; and
 * the forces of that ground on the edge of the body.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "layout.h"

#include <mps/experimental/neighbours.h>

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* A growing list of pairs. */
typedef struct pair_list {
  mps_context *context;
  mpsi_dynamics_pair *pair;
  int64_t count, capacity;
} pair_list;

static bool push(pair_list *list, mpsi_dynamics_pair pair) {
  if (list->count == list->capacity) {
    const int64_t capacity = list->capacity ? 2 * list->capacity : 1024;
    if (!mpsi_grow(list->context, (void **)&list->pair, list->count, capacity, sizeof pair))
      return false;
    list->capacity = capacity;
  }
  list->pair[list->count++] = pair;
  return true;
}

/* The offset b - a. Those of lattice neighbours are made exact multiples of D: their round-off,
 * large where the origin is far away, would split runs. */
static double snapped(double a, double b, double spacing) {
  const double offset = b - a, whole = nearbyint(offset / spacing) * spacing;
  const double round_off = 1e-9 * spacing + 2.0 * DBL_EPSILON * (fabs(a) + fabs(b));
  return fabs(offset - whole) <= round_off ? whole : offset;
}

/* Position arrays of the body, with the copies that a period puts right of it. */
typedef struct cloud {
  double *x;     /* x then y, `count` each */
  int64_t *from; /* particle of each point */
  int64_t count, own;
} cloud;

static bool make_cloud(mps_context *context, const mpsi_dynamics_geometry *g, cloud *out) {
  int64_t own = 0, copies = 0;
  double left = g->edge ? g->edge[0] : INFINITY;
  for (int64_t k = 0; k < g->count; k++)
    if (!g->side || !g->side[k]) left = fmin(left, g->x[k]), own++;
  const double reach = g->period_x > 0.0 ? left + g->radius : -INFINITY;
  for (int64_t k = 0; k < own; k++) copies += g->x[k] < reach;
  const int64_t n = own + copies;
  *out = (cloud){.x = mpsi_alloc(context, 2 * n, sizeof(double)),
                 .from = mpsi_alloc(context, n, sizeof(int64_t)),
                 .count = n,
                 .own = own};
  if (!out->x || !out->from) return false;
  /* the body comes first in the sorted order, so its particles are 0 .. own - 1 */
  for (int64_t k = 0, c = own; k < own; k++) {
    out->x[k] = g->x[k];
    out->x[n + k] = g->y[k];
    out->from[k] = k;
    if (g->x[k] >= reach) continue;
    out->x[c] = g->x[k] + g->period_x;
    out->x[n + c] = g->y[k];
    out->from[c++] = k;
  }
  return true;
}

/* Each pair once; copies only as the far end. */
static bool wanted(const cloud *points, const uint8_t *keep, int64_t a, int64_t b) {
  if (b < points->own && b < a) return false;
  return !keep || keep[a] || keep[points->from[b]];
}

/* Room for exactly the pairs of the body. */
static bool reserve(const cloud *points, const uint8_t *keep, const int64_t *offset,
                    const int64_t *index, pair_list *list) {
  int64_t count = 0;
  for (int64_t a = 0; a < points->own; a++)
    for (int64_t k = offset[a]; k < offset[a + 1]; k++) count += wanted(points, keep, a, index[k]);
  list->pair = mpsi_alloc(list->context, count, sizeof *list->pair);
  list->capacity = list->pair ? count : 0;
  return list->pair != NULL;
}

static mps_status body_pairs(const mpsi_dynamics_geometry *g, const cloud *points,
                             const uint8_t *keep, const int64_t *offset, const int64_t *index,
                             pair_list *list, const char *function) {
  if (!reserve(points, keep, offset, index, list))
    return mpsi_fail_memory(list->context, function, sizeof(mpsi_dynamics_pair));
  for (int64_t a = 0; a < points->own; a++)
    for (int64_t k = offset[a]; k < offset[a + 1]; k++) {
      const int64_t b = index[k];
      if (!wanted(points, keep, a, b)) continue;
      const double *x = points->x, *y = points->x + points->count;
      const double dx = snapped(x[a], x[b], g->spacing), dy = snapped(y[a], y[b], g->spacing);
      if (!(dx * dx + dy * dy > 1e-12 * g->spacing * g->spacing))
        return mpsi_fail(list->context, function, MPS_ERROR_ARGUMENT,
                         "two particles lie at the same point (%g, %g) m", x[a], y[a]);
      const int32_t i = (int32_t)a, j = (int32_t)points->from[b];
      if (!push(list, (mpsi_dynamics_pair){i, j, i, j, dx, dy}))
        return mpsi_fail_memory(list->context, function, sizeof(mpsi_dynamics_pair));
    }
  return MPS_OK;
}

static mps_status find_body_pairs(const mpsi_dynamics_geometry *g, const uint8_t *keep,
                                  pair_list *list, const char *function) {
  mps_context *context = list->context;
  cloud points = {0};
  mps_neighbours *lists = NULL;
  mps_neighbours_def def = mps_neighbours_defaults();
  def.dim = 2;
  /* lattice distances are round numbers: r0 = re must be out whatever the round-off */
  def.radius = g->radius * (1.0 - 1e-9);
  mps_status status = MPS_OK;
  if (!make_cloud(context, g, &points))
    status = mpsi_fail_memory(context, function, (size_t)g->count * 24);
  const bool any = status == MPS_OK && points.count > 0; /* none on a rank without particles */
  if (any) status = mpsi_as(context, function, mps_neighbours_create(context, &def, &lists));
  if (any && status == MPS_OK) {
    const mps_view view = {.data = points.x,
                           .shape = {points.count, 2, 1},
                           .stride = {1, points.count, 1},
                           .dtype = {2, 64, 1}};
    status = mpsi_as(context, function, mps_neighbours_build(lists, &view));
  }
  if (any && status == MPS_OK) {
    const int64_t *offset, *index;
    status = mpsi_as(context, function, mps_neighbours_lists(lists, NULL, &offset, &index));
    if (status == MPS_OK) status = body_pairs(g, &points, keep, offset, index, list, function);
  }
  mps_neighbours_destroy(&lists);
  MPSI_FREE(context, points.x, points.from);
  return status;
}

/* ---- free-field columns ---------------------------------------------------------------------- */

/* A column as sorted: particles first .. first + rows - 1, bottom up, rows D apart. */
typedef struct column {
  int64_t first, rows;
  double bottom;
  int side;
} column;

static column find_column(const mpsi_dynamics_geometry *g, int side) {
  column c = {.side = side};
  for (int64_t k = g->count - 1; g->side && k >= 0; k--)
    if (g->side[k] == side) {
      c.first = k;
      c.bottom = g->y[k];
      c.rows++;
    }
  return c;
}

/* at[depth * rows + row] = body particle `depth` columns in from the edge, in the column's row. */
static bool map_edge(mps_context *context, const mpsi_dynamics_geometry *g, const column *c,
                     int depths, int64_t **at) {
  double edge = g->edge ? g->edge[c->side - 1] : c->side == 1 ? INFINITY : -INFINITY;
  for (int64_t k = 0; k < g->count && !g->side[k]; k++)
    edge = c->side == 1 ? fmin(edge, g->x[k]) : fmax(edge, g->x[k]);
  *at = mpsi_alloc(context, c->rows * depths, sizeof(int64_t));
  if (!*at) return false;
  for (int64_t k = 0; k < c->rows * depths; k++) (*at)[k] = -1;
  for (int64_t k = 0; k < g->count && !g->side[k]; k++) {
    const double in = fabs(g->x[k] - edge) / g->spacing, up = (g->y[k] - c->bottom) / g->spacing;
    const int64_t depth = (int64_t)nearbyint(in), row = (int64_t)nearbyint(up);
    if (depth < depths && row >= 0 && row < c->rows && fabs(in - (double)depth) < 1e-6 &&
        fabs(up - (double)row) < 1e-6)
      (*at)[depth * c->rows + row] = k;
  }
  return true;
}

/* One pair type of infinite ground: offset (kx, ky) lattice spacings, kx >= 0. */
static bool column_offset(const mpsi_dynamics_geometry *g, const column *c, const int64_t *at,
                          int kx, int ky, pair_list *list) {
  const double r0x = kx * g->spacing, r0y = ky * g->spacing;
  for (int64_t row = 0; row < c->rows; row++) {
    const int64_t other = row + ky;
    if (other < 0 || other >= c->rows) continue;
    const int32_t i = (int32_t)(c->first + row), j = (int32_t)(c->first + other);
    if (!push(list, (mpsi_dynamics_pair){i, j, i, j, r0x, r0y})) return false;
    /* For particles up to kx - 1 columns in from the edge, the far end of this pair is missing. On
     * the left they are its j, on the right its i. */
    for (int depth = 0; depth < kx; depth++) {
      mpsi_dynamics_pair ghost = {i, j, -1, -1, r0x, r0y};
      if (c->side == 1)
        ghost.tj = (int32_t)at[depth * c->rows + other];
      else
        ghost.ti = (int32_t)at[depth * c->rows + row];
      if ((ghost.ti >= 0 || ghost.tj >= 0) && !push(list, ghost)) return false;
    }
  }
  return true;
}

static mps_status find_column_pairs(const mpsi_dynamics_geometry *g, int side, pair_list *list,
                                    const char *function) {
  const column c = find_column(g, side);
  if (c.rows == 0) return MPS_OK;
  for (int64_t row = 0; row < c.rows; row++)
    if (g->side[c.first + row] != side ||
        fabs(g->y[c.first + row] - c.bottom - (double)row * g->spacing) > 1e-6 * g->spacing)
      return mpsi_fail(list->context, function, MPS_ERROR_ARGUMENT,
                       "the %s free-field column is not a straight stack of particles one spacing "
                       "apart (row %lld)",
                       side == 1 ? "left" : "right", (long long)row);
  const int reach = (int)ceil(g->radius / g->spacing);
  int64_t *at = NULL;
  bool ok = map_edge(list->context, g, &c, reach, &at);
  for (int kx = 0; ok && kx <= reach; kx++)
    for (int ky = -reach; ok && ky <= reach; ky++)
      if ((kx > 0 || ky > 0) &&
          sqrt((double)(kx * kx + ky * ky)) * g->spacing < g->radius * (1.0 - 1e-9))
        ok = column_offset(g, &c, at, kx, ky, list);
  mpsi_free(list->context, at);
  return ok ? MPS_OK : mpsi_fail_memory(list->context, function, sizeof(mpsi_dynamics_pair));
}

mps_status mpsi_dynamics_layout_edges(mps_context *context, const char *function,
                                      const mpsi_dynamics_geometry *g, int64_t *edge) {
  for (int64_t k = 0; k < g->count; k++) edge[k] = -1;
  for (int side = 1; side <= 2; side++) {
    const column c = find_column(g, side);
    int64_t *at = NULL;
    if (c.rows == 0) continue;
    if (!map_edge(context, g, &c, 1, &at))
      return mpsi_fail_memory(context, function, (size_t)c.rows * sizeof *at);
    for (int64_t row = 0; row < c.rows; row++) edge[c.first + row] = at[row];
    mpsi_free(context, at);
  }
  return MPS_OK;
}

mps_status mpsi_dynamics_layout_pairs(mps_context *context, const char *function,
                                      const mpsi_dynamics_geometry *g, const uint8_t *keep,
                                      int64_t *count, mpsi_dynamics_pair **pairs,
                                      int64_t *distinct) {
  pair_list list = {.context = context};
  mps_status status = find_body_pairs(g, keep, &list, function);
  *distinct = list.count;
  for (int side = 1; status == MPS_OK && side <= 2; side++)
    status = find_column_pairs(g, side, &list, function);
  if (status != MPS_OK) {
    mpsi_free(context, list.pair);
    list.pair = NULL;
  }
  *count = list.count;
  *pairs = list.pair;
  return status;
}
