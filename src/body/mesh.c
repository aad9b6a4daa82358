/* mesh.c - checks of a closed surface of triangles: joined points, two triangles at every edge, one
 * fan of triangles at every vertex, outward normals.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mesh.h"

#include "core/base/text.h"
#include "rotation.h"

#include <stdio.h>
#include <string.h>

/* A triangle whose height is below this part of its longest side has no direction. */
#define FLAT 1e-12
/* Of the longest side of the box: corners as near as that are joined where the surface has a hole
 * otherwise. Programs that write each triangle by itself round a corner differently in each. */
#define NEAR 1e-6
#define FILE_LIMIT ((int64_t)1 << 30) /* bytes of the largest STL file that is read */

static const double *point(const mpsi_mesh *mesh, int64_t t, int k) {
  return mesh->xyz + 3 * (int64_t)mesh->corner[3 * t + k];
}

static uint64_t mix(uint64_t x) { /* the finaliser of MurmurHash3 */
  x = (x ^ (x >> 33)) * UINT64_C(0xff51afd7ed558ccd);
  x = (x ^ (x >> 33)) * UINT64_C(0xc4ceb9fe1a85ec53);
  return x ^ (x >> 33);
}

/* An empty table of numbers >= 0 with room for `count` of them. */
typedef struct table {
  int32_t *item; /* number + 1, 0 where there is none */
  uint64_t mask;
} table;

static bool table_begin(mps_context *context, int64_t count, table *out) {
  int64_t size = 16;
  while (size < 2 * count) size *= 2;
  *out = (table){mpsi_alloc(context, size, sizeof *out->item), (uint64_t)size - 1};
  return out->item != NULL;
}

/* ---- points ---------------------------------------------------------------------------------- */

static uint64_t point_hash(const double *x) {
  uint64_t hash = 0;
  for (int c = 0; c < 3; c++) {
    const double value = x[c] + 0.0; /* -0 becomes 0 */
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    hash = mix(hash ^ bits);
  }
  return hash;
}

/* Copies the points, without duplicates, and the corners with their new numbers. */
static mps_status join_points(mps_context *context, const char *function, mpsi_mesh *mesh,
                              int64_t count, const double *xyz, const int32_t *corner) {
  table known;
  int32_t *number = NULL;
  if (table_begin(context, count, &known)) number = mpsi_alloc(context, count, sizeof *number);
  if (!number) {
    mpsi_free(context, known.item);
    return mpsi_fail_memory(context, function, (size_t)count * sizeof *number);
  }
  for (int64_t i = 0; i < count; i++) {
    const double *x = xyz + 3 * i;
    uint64_t slot = point_hash(x) & known.mask;
    for (; known.item[slot] > 0; slot = (slot + 1) & known.mask) {
      const double *y = mesh->xyz + 3 * (int64_t)(known.item[slot] - 1);
      if (x[0] == y[0] && x[1] == y[1] && x[2] == y[2]) break;
    }
    if (known.item[slot] == 0) {
      memcpy(mesh->xyz + 3 * mesh->vertices, x, 3 * sizeof *x);
      known.item[slot] = (int32_t)++mesh->vertices;
    }
    number[i] = known.item[slot] - 1;
  }
  for (int64_t s = 0; s < 3 * mesh->triangles; s++)
    mesh->corner[s] = number[corner ? corner[s] : s];
  MPSI_FREE(context, known.item, number);
  return MPS_OK;
}

/* ---- points that are nearly the same --------------------------------------------------------- */

static double square_between(const double *a, const double *b) {
  const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return mpsi_dot3(d, d);
}

/* Groups of points: each has a parent, at last the first of the group by its coordinates, which is
 * the same in any order of the points. */
typedef struct groups {
  const double *xyz;
  int32_t *parent, *next; /* next: point in the same cell, or -1 */
  table cells;            /* first point of a cell, by the hash of the cell */
  double width;           /* m: nearer points are one */
} groups;

static int32_t root_of(const groups *g, int32_t i) {
  while (g->parent[i] != i) i = g->parent[i] = g->parent[g->parent[i]];
  return i;
}

static bool is_before(const double *a, const double *b) {
  for (int c = 0; c < 3; c++)
    if (a[c] != b[c]) return a[c] < b[c];
  return false;
}

static void unite(const groups *g, int32_t i, int32_t j) {
  const int32_t a = root_of(g, i), b = root_of(g, j);
  if (a == b) return;
  const bool first = is_before(g->xyz + 3 * (int64_t)a, g->xyz + 3 * (int64_t)b);
  g->parent[first ? b : a] = first ? a : b;
}

static int32_t *cell_at(const groups *g, const double *x, const int *step) {
  double cell[3];
  for (int c = 0; c < 3; c++) cell[c] = floor(x[c] / g->width) + step[c];
  return &g->cells.item[point_hash(cell) & g->cells.mask];
}

/* Cells that share a place of the table only cost time: distances decide. */
static void add_point(const groups *g, int32_t i) {
  const double *x = g->xyz + 3 * (int64_t)i;
  static const int here[3] = {0, 0, 0};
  for (int k = 0; k < 27; k++) {
    const int step[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
    for (int32_t j = *cell_at(g, x, step) - 1; j >= 0; j = g->next[j])
      if (square_between(x, g->xyz + 3 * (int64_t)j) <= g->width * g->width) unite(g, i, j);
  }
  int32_t *own = cell_at(g, x, here);
  g->next[i] = *own - 1, *own = i + 1;
}

/* Joins the corners that are nearer than NEAR; *joined: whether there are any. A chain of points
 * that is longer than four times that is a fine part of the surface, and nothing is joined. */
static mps_status join_near(mps_context *context, const char *function, mpsi_mesh *mesh,
                            bool *joined) {
  groups g = {.xyz = mesh->xyz, .width = NEAR * 2.0 * mesh->size};
  *joined = false;
  g.parent = mpsi_alloc(context, 2 * mesh->vertices, sizeof *g.parent);
  if (!g.parent || !table_begin(context, mesh->vertices, &g.cells)) {
    mpsi_free(context, g.parent);
    return mpsi_fail_memory(context, function, (size_t)mesh->vertices * 4 * sizeof *g.parent);
  }
  g.next = g.parent + mesh->vertices;
  for (int32_t i = 0; i < mesh->vertices; i++) g.parent[i] = i;
  for (int32_t i = 0; i < mesh->vertices; i++) add_point(&g, i);
  bool together = true;
  for (int32_t i = 0; i < mesh->vertices; i++) {
    const int32_t root = root_of(&g, i);
    *joined = *joined || root != i;
    together =
        together && square_between(mesh->xyz + 3 * (int64_t)i, mesh->xyz + 3 * (int64_t)root) <=
                        16.0 * g.width * g.width;
  }
  *joined = *joined && together;
  for (int64_t s = 0; s < 3 * mesh->triangles && *joined; s++)
    mesh->corner[s] = root_of(&g, mesh->corner[s]);
  MPSI_FREE(context, g.cells.item, g.parent);
  return MPS_OK;
}

/* ---- triangles ------------------------------------------------------------------------------- */

/* Twice the area vector of triangle t. */
static void area_vector(const mpsi_mesh *mesh, int64_t t, double *out) {
  const double *a = point(mesh, t, 0), *b = point(mesh, t, 1), *c = point(mesh, t, 2);
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  mpsi_cross3(u, v, out);
}

static double longest_side(const mpsi_mesh *mesh, int64_t t) {
  double longest = 0.0;
  for (int e = 0; e < 3; e++) {
    const double *a = point(mesh, t, e), *b = point(mesh, t, (e + 1) % 3);
    const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    longest = fmax(longest, sqrt(mpsi_dot3(d, d)));
  }
  return longest;
}

static mps_status find_normals(mps_context *context, const char *function, mpsi_mesh *mesh) {
  for (int64_t t = 0; t < mesh->triangles; t++) {
    double *n = mesh->normal + 3 * t;
    area_vector(mesh, t, n);
    const double length = sqrt(mpsi_dot3(n, n)), side = longest_side(mesh, t);
    if (!(length > FLAT * side * side) || !isfinite(length)) {
      const double *a = point(mesh, t, 0), *b = point(mesh, t, 1), *c = point(mesh, t, 2);
      return mpsi_fail(
          context, function, MPS_ERROR_ARGUMENT,
          "triangles: triangle %lld with the corners (%g, %g, %g), (%g, %g, %g) and (%g, %g, %g) m "
          "has no area",
          (long long)t, a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
    }
    for (int c = 0; c < 3; c++) n[c] /= length;
  }
  return MPS_OK;
}

static double volume(const mpsi_mesh *mesh) {
  double sum = 0.0;
  for (int64_t t = 0; t < mesh->triangles; t++) {
    double n[3];
    area_vector(mesh, t, n);
    const double *a = point(mesh, t, 0);
    const double from[3] = {a[0] - mesh->middle[0], a[1] - mesh->middle[1], a[2] - mesh->middle[2]};
    sum += mpsi_dot3(from, n);
  }
  return sum / 6.0;
}

static void turn_over(mpsi_mesh *mesh) {
  for (int64_t t = 0; t < mesh->triangles; t++) {
    int32_t *c = mesh->corner + 3 * t;
    const int32_t second = c[1];
    c[1] = c[2], c[2] = second;
  }
}

static void find_box(mpsi_mesh *mesh) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int64_t s = 0; s < 3 * mesh->triangles; s++)
    for (int c = 0; c < 3; c++) {
      const double x = mesh->xyz[3 * (int64_t)mesh->corner[s] + c];
      low[c] = fmin(low[c], x), high[c] = fmax(high[c], x);
    }
  mesh->size = 0.0;
  for (int c = 0; c < 3; c++) {
    mesh->middle[c] = 0.5 * low[c] + 0.5 * high[c];
    mesh->size = fmax(mesh->size, 0.5 * high[c] - 0.5 * low[c]);
  }
}

/* ---- edges ----------------------------------------------------------------------------------- */

static void side_ends(const mpsi_mesh *mesh, int64_t side, int32_t *from, int32_t *to) {
  const int64_t t = side / 3;
  *from = mesh->corner[side];
  *to = mesh->corner[3 * t + (side + 1) % 3];
}

static mps_status fail_edge(mps_context *context, const char *function, const mpsi_mesh *mesh,
                            int64_t side, const char *what) {
  int32_t from, to;
  side_ends(mesh, side, &from, &to);
  const double *a = mesh->xyz + 3 * (int64_t)from, *b = mesh->xyz + 3 * (int64_t)to;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "the edge of triangle %lld from (%g, %g, %g) to (%g, %g, %g) m %s",
                   (long long)(side / 3), a[0], a[1], a[2], b[0], b[1], b[2], what);
}

/* Side s belongs to the edge whose first side is `other`. */
static mps_status join_sides(mps_context *context, const char *function, mpsi_mesh *mesh, int64_t s,
                             int64_t other) {
  char what[128];
  const long long t = other / 3;
  if (mesh->across[other] >= 0) {
    snprintf(what, sizeof what, "belongs to two other triangles, %lld and %lld", t,
             (long long)mesh->across[other] / 3);
    return fail_edge(context, function, mesh, s, what);
  }
  if (mesh->corner[s] == mesh->corner[other]) {
    snprintf(what, sizeof what,
             "runs the same way in triangle %lld: one of the two is turned inside out", t);
    return fail_edge(context, function, mesh, s, what);
  }
  mesh->across[s] = (int32_t)other, mesh->across[other] = (int32_t)s;
  return MPS_OK;
}

/* The corner nearest to an end of the edge `hole` among the ends of others that belong to one
 * triangle, in a message: how far the two sides of a gap are apart. */
static mps_status fail_hole(mps_context *context, const char *function, const mpsi_mesh *mesh,
                            int64_t hole) {
  int32_t end[2], other[2];
  double nearest = INFINITY;
  const double *at = NULL;
  char what[200] = "belongs to no other triangle: a hole";
  side_ends(mesh, hole, &end[0], &end[1]);
  for (int64_t s = 0; s < 3 * mesh->triangles; s++) {
    if (mesh->across[s] >= 0) continue;
    side_ends(mesh, s, &other[0], &other[1]);
    for (int k = 0; k < 4; k++) {
      const int32_t v = other[k % 2];
      const double *x = mesh->xyz + 3 * (int64_t)v;
      const double square = square_between(mesh->xyz + 3 * (int64_t)end[k / 2], x);
      if (v != end[0] && v != end[1] && square < nearest) nearest = square, at = x;
    }
  }
  if (at)
    snprintf(what, sizeof what,
             "belongs to no other triangle: a hole; the next corner at a hole, (%g, %g, %g) m, is "
             "%.3g m away, corners up to %.3g m apart are joined",
             at[0], at[1], at[2], sqrt(nearest), NEAR * 2.0 * mesh->size);
  return fail_edge(context, function, mesh, hole, what);
}

/* *hole: the first side without another triangle, or -1. */
static mps_status match_edges(mps_context *context, const char *function, mpsi_mesh *mesh,
                              int64_t *hole) {
  const int64_t sides = 3 * mesh->triangles;
  table known; /* of the first side at each edge */
  if (!table_begin(context, sides / 2 + 1, &known))
    return mpsi_fail_memory(context, function, (size_t)sides * sizeof *known.item);
  mps_status status = MPS_OK;
  int64_t edges = 0;
  for (int64_t s = 0; s < sides; s++) mesh->across[s] = -1;
  for (int64_t s = 0; s < sides && status == MPS_OK; s++) {
    int32_t from, to, f = 0, g = 0;
    side_ends(mesh, s, &from, &to);
    const uint64_t low = (uint64_t)(from < to ? from : to),
                   high = (uint64_t)(from < to ? to : from);
    uint64_t slot = mix(low << 32 | high) & known.mask;
    for (; known.item[slot] > 0; slot = (slot + 1) & known.mask) {
      side_ends(mesh, known.item[slot] - 1, &f, &g);
      if ((f == from && g == to) || (f == to && g == from)) break;
    }
    const int64_t other = known.item[slot] - 1;
    if (other < 0 && ++edges > sides / 2) break; /* more than can have two: one is found below */
    if (other < 0)
      known.item[slot] = (int32_t)(s + 1);
    else
      status = join_sides(context, function, mesh, s, other);
  }
  *hole = -1;
  for (int64_t s = sides - 1; s >= 0; s--)
    if (mesh->across[s] < 0) *hole = s;
  mpsi_free(context, known.item);
  return status;
}

/* ---- vertices -------------------------------------------------------------------------------- */

/* The triangles at a vertex must be one fan: with two fans inside and outside are ambiguous. */
static mps_status check_fans(mps_context *context, const char *function, const mpsi_mesh *mesh) {
  int32_t *count = mpsi_alloc(context, mesh->vertices, sizeof *count);
  if (!count) return mpsi_fail_memory(context, function, (size_t)mesh->vertices * sizeof *count);
  for (int64_t s = 0; s < 3 * mesh->triangles; s++) count[mesh->corner[s]]++;
  mps_status status = MPS_OK;
  for (int64_t s = 0; s < 3 * mesh->triangles && status == MPS_OK; s++) {
    const int32_t v = mesh->corner[s];
    if (count[v] == 0) continue; /* seen already */
    int64_t at = s;
    do {
      count[v]--;
      at = mesh->across[3 * (at / 3) + (at + 2) % 3];
    } while (at != s);
    if (count[v] != 0)
      status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "at (%g, %g, %g) m, a corner of triangle %lld, parts of the surface have "
                         "a single point in common",
                         mesh->xyz[3 * (int64_t)v], mesh->xyz[3 * (int64_t)v + 1],
                         mesh->xyz[3 * (int64_t)v + 2], (long long)(s / 3));
  }
  mpsi_free(context, count);
  return status;
}

static void find_vertex_normals(mpsi_mesh *mesh) {
  for (int64_t t = 0; t < mesh->triangles; t++)
    for (int k = 0; k < 3; k++) {
      const double *a = point(mesh, t, k), *b = point(mesh, t, (k + 1) % 3);
      const double *c = point(mesh, t, (k + 2) % 3);
      const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      const double v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      double across[3];
      mpsi_cross3(u, v, across);
      const double angle = atan2(sqrt(mpsi_dot3(across, across)), mpsi_dot3(u, v));
      double *n = mesh->vertex_normal + 3 * (int64_t)mesh->corner[3 * t + k];
      for (int i = 0; i < 3; i++) n[i] += angle * mesh->normal[3 * t + i];
    }
}

/* ---- life ------------------------------------------------------------------------------------ */

static mps_status check_arrays(mps_context *context, const char *function, int64_t vertices,
                               const double *xyz, int64_t triangles, const int32_t *corner) {
  if (triangles < 4 || triangles > MPSI_MESH_MAX_TRIANGLES)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "triangles is %lld, must be 4 to %d",
                     (long long)triangles, MPSI_MESH_MAX_TRIANGLES);
  if (vertices < 4 || vertices > 3 * triangles)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "vertices is %lld, must be 4 to 3 times the triangles (%lld)",
                     (long long)vertices, (long long)triangles);
  for (int64_t i = 0; i < 3 * vertices; i++)
    if (!(fabs(xyz[i]) <= MPSI_BODY_FAR))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "xyz: vertex %lld has %c = %g m, must be finite", (long long)(i / 3),
                       "xyz"[i % 3], xyz[i]);
  for (int64_t s = 0; corner && s < 3 * triangles; s++)
    if (corner[s] < 0 || corner[s] >= vertices)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "triangle %lld has the corner %d, must be 0 to %lld", (long long)(s / 3),
                       corner[s], (long long)vertices - 1);
  return MPS_OK;
}

static mps_status allocate(mps_context *context, const char *function, int64_t vertices,
                           int64_t triangles, mpsi_mesh **out) {
  mpsi_mesh *mesh = mpsi_alloc(context, 1, sizeof *mesh);
  if (!mesh) return mpsi_fail_memory(context, function, sizeof *mesh);
  mesh->triangles = triangles;
  mesh->xyz = mpsi_alloc(context, 3 * vertices, sizeof *mesh->xyz);
  if (mesh->xyz) mesh->corner = mpsi_alloc(context, 3 * triangles, sizeof *mesh->corner);
  if (mesh->corner) mesh->across = mpsi_alloc(context, 3 * triangles, sizeof *mesh->across);
  if (mesh->across) mesh->normal = mpsi_alloc(context, 3 * triangles, sizeof *mesh->normal);
  if (mesh->normal) mesh->vertex_normal = mpsi_alloc(context, 3 * vertices, sizeof(double));
  *out = mesh;
  if (mesh->vertex_normal) return MPS_OK;
  return mpsi_fail_memory(context, function, (size_t)(triangles + vertices) * 3 * sizeof(double));
}

static mps_status build(mps_context *context, const char *function, mpsi_mesh *mesh) {
  int64_t hole = -1;
  bool joined = false;
  find_box(mesh);
  if (volume(mesh) < 0.0) turn_over(mesh);
  MPSI_TRY(find_normals(context, function, mesh));
  MPSI_TRY(match_edges(context, function, mesh, &hole));
  if (hole >= 0) MPSI_TRY(join_near(context, function, mesh, &joined));
  if (joined) MPSI_TRY(find_normals(context, function, mesh));
  if (joined) MPSI_TRY(match_edges(context, function, mesh, &hole));
  if (hole >= 0) MPSI_TRY(fail_hole(context, function, mesh, hole));
  MPSI_TRY(check_fans(context, function, mesh));
  const double inside = volume(mesh), size = mesh->size;
  if (!(inside > FLAT * size * size * size) || !isfinite(inside))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the mesh encloses %g m3 in a box of half side %g m, must be > 0", inside,
                     size);
  find_vertex_normals(mesh);
  return mpsi_mesh_index(context, function, mesh);
}

mps_status mpsi_mesh_create(mps_context *context, const char *function, int64_t vertices,
                            const double *xyz, int64_t triangles, const int32_t *corner,
                            mpsi_mesh **out) {
  MPSI_TRY(check_arrays(context, function, vertices, xyz, triangles, corner));
  mpsi_mesh *mesh = NULL;
  mps_status status = allocate(context, function, vertices, triangles, &mesh);
  if (status == MPS_OK) status = join_points(context, function, mesh, vertices, xyz, corner);
  if (status == MPS_OK) status = build(context, function, mesh);
  if (status == MPS_OK)
    *out = mesh;
  else
    mpsi_mesh_destroy(context, mesh);
  return status;
}

static mps_status make_body(mps_context *context, const char *function, const mps_body_def *def,
                            int64_t vertices, const double *xyz, int64_t triangles,
                            const int32_t *corner, const char *path, mps_body **out) {
  mpsi_mesh *mesh = NULL;
  mps_status status = mpsi_mesh_create(context, function, vertices, xyz, triangles, corner, &mesh);
  char file[96];
  const size_t length = path ? strlen(path) : 0;
  snprintf(file, sizeof file, "path '%s'", length > 80 ? path + length - 80 : path ? path : "");
  if (path) status = mpsi_fail_of(context, status, file);
  if (status == MPS_OK)
    status = mpsi_body_new(context, function, def, 3, MPSI_MESH, triangles, out);
  if (status == MPS_OK)
    (*out)->mesh = mesh;
  else
    mpsi_mesh_destroy(context, mesh);
  return status;
}

mps_status mps_body_create_mesh(mps_context *context, const mps_body_def *def, int64_t vertices,
                                const double *xyz, int64_t triangles, const int32_t *corner,
                                mps_body **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!xyz || !corner)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL", xyz ? "corner" : "xyz");
  return make_body(context, __func__, def, vertices, xyz, triangles, corner, NULL, out);
}

mps_status mps_body_create_stl(mps_context *context, const mps_body_def *def, const char *path,
                               double scale, mps_body **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!path) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "path is NULL");
  if (!isfinite(scale) || scale <= 0.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "scale is %g, must be finite and > 0",
                     scale);
  char *data = NULL;
  int64_t size = 0, triangles = 0;
  double *xyz = NULL;
  mps_status status = mpsi_file_read(context, __func__, path, FILE_LIMIT, &data, &size);
  if (status == MPS_OK)
    status = mpsi_stl_read(context, __func__, path, data, size, scale, &triangles, &xyz);
  mpsi_free(context, data);
  if (status == MPS_OK)
    status = make_body(context, __func__, def, 3 * triangles, xyz, triangles, NULL, path, out);
  mpsi_free(context, xyz);
  return status;
}
