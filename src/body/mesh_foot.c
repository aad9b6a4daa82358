/* mesh_foot.c - the nearest point of a mesh, by a tree of Embree. Only this file uses Embree.
 *
 * Embree works in single precision, so it only discards triangles that are surely too far: the
 * others are measured here in double precision, in the radius found so far and a little more. Of
 * equally near triangles the lowest number prevails, so that the result does not depend on the
 * order of the search. Sign and normal are those of the feature the foot lies on: a triangle's
 * normal, the sum of the two normals at an edge, or that at a vertex weighted with the triangles'
 * angles, whose sign is right for every closed surface (Baerentzen and Aanaes 2005).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/context/first_use.h"
#include "embree_calls.h"
#include "mesh.h"
#include "rotation.h"

#include <pthread.h>
#include <string.h>

/* In units of the mesh's size: far above the round-off of Embree's single precision. */
#define SLACK 4e-6
#define SLACK_RELATIVE 1e-5
#define TOO_FAR 1e5 /* beyond, single precision does not distinguish the triangles */

typedef struct search {
  const mpsi_mesh *mesh;
  const double *x;
  double slack;  /* in units of the mesh's size */
  double square; /* of the distance, m2; of the nearest triangle so far: */
  int64_t triangle;
  int where;    /* -1: inner point, 0 to 2: on that side, 3 to 5: at corner 0 to 2 */
  double at[3]; /* m */
} search;

/* ---- the tree -------------------------------------------------------------------------------- */

static void fill_vertices(const mpsi_mesh *mesh, float *to) {
  for (int64_t i = 0; i < 3 * mesh->vertices; i++)
    to[i] = (float)((mesh->xyz[i] - mesh->middle[i % 3]) / mesh->size);
}

const mpsi_embree_calls *mpsi_embree;

static mps_status find_embree(mps_context *context, const char *function) {
  static pthread_mutex_t finding = PTHREAD_MUTEX_INITIALIZER;
  char why[300] = "";
  pthread_mutex_lock(&finding);
  if (!mpsi_embree) mpsi_embree = mpsi_embree_find(why, sizeof why);
  const bool found = mpsi_embree;
  pthread_mutex_unlock(&finding);
  if (found) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                   "meshes of triangles need Embree, which cannot be loaded: %s", why);
}

mps_status mpsi_mesh_index(mps_context *context, const char *function, mpsi_mesh *mesh) {
  MPSI_TRY(find_embree(context, function));
  /* One thread builds: no pool of threads remains in the host program. */
  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  mesh->device = device;
  if (!device) return mpsi_fail(context, function, MPS_ERROR_MEMORY, "Embree made no device");
  RTCScene scene = rtcNewScene(device);
  RTCGeometry triangles = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  mesh->scene = scene;
  float *vertices = rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            3 * sizeof(float), (size_t)mesh->vertices);
  if (vertices) {
    fill_vertices(mesh, vertices);
    rtcSetSharedGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->corner,
                               0, 3 * sizeof *mesh->corner, (size_t)mesh->triangles);
    rtcCommitGeometry(triangles);
    rtcAttachGeometry(scene, triangles);
    rtcCommitScene(scene);
  }
  rtcReleaseGeometry(triangles); /* the scene keeps it */
  const enum RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return MPS_OK;
  /* where an allocation of its own fails Embree knows no reason; the triangles have been checked */
  if (error == RTC_ERROR_OUT_OF_MEMORY || error == RTC_ERROR_UNKNOWN)
    return mpsi_fail(context, function, MPS_ERROR_MEMORY,
                     "Embree was refused memory for %lld triangles (error %d)",
                     (long long)mesh->triangles, (int)error);
  return mpsi_fail(context, function, MPS_ERROR_INTERNAL,
                   "Embree failed with error %d on %lld triangles", (int)error,
                   (long long)mesh->triangles);
}

static void drop_index(mpsi_mesh *mesh) {
  if (mesh->scene) rtcReleaseScene(mesh->scene);
  if (mesh->device) rtcReleaseDevice(mesh->device);
}

/* ---- one triangle ---------------------------------------------------------------------------- */

/* Nearest point of the side a b to x; where < 0: an inner one, else 0 for a and 1 for b. */
static double side_foot(const double *a, const double *b, const double *x, double *at, int *end) {
  const double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double p[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]};
  const double along = mpsi_dot3(p, e), length2 = mpsi_dot3(e, e);
  *end = along <= 0.0 ? 0 : along >= length2 ? 1 : -1;
  double square = 0.0;
  for (int c = 0; c < 3; c++) {
    at[c] = *end == 0 ? a[c] : *end == 1 ? b[c] : a[c] + along / length2 * e[c];
    square += (x[c] - at[c]) * (x[c] - at[c]);
  }
  return square;
}

static void keep(search *s, double square, int64_t t, int where, const double *at) {
  if (square > s->square || (square == s->square && t >= s->triangle)) return;
  s->square = square;
  s->triangle = t;
  s->where = where;
  memcpy(s->at, at, sizeof s->at);
}

/* A point beyond some sides of the triangle has its foot on one of these. */
static void measure(search *s, int64_t t) {
  const mpsi_mesh *mesh = s->mesh;
  const int32_t *corner = mesh->corner + 3 * t;
  const double *n = mesh->normal + 3 * t, *x = s->x;
  search best = {.square = INFINITY, .triangle = INT64_MAX};
  bool beyond = false;
  for (int e = 0; e < 3; e++) {
    const double *a = mesh->xyz + 3 * (int64_t)corner[e];
    const double *b = mesh->xyz + 3 * (int64_t)corner[(e + 1) % 3];
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double p[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]};
    double across[3], at[3];
    mpsi_cross3(u, p, across);
    if (mpsi_dot3(across, n) >= 0.0) continue;
    beyond = true;
    int end;
    const double square = side_foot(a, b, x, at, &end);
    if (square < best.square) keep(&best, square, t, end < 0 ? e : 3 + (e + end) % 3, at);
  }
  if (!beyond) {
    const double *a = mesh->xyz + 3 * (int64_t)corner[0];
    const double p[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]}, d = mpsi_dot3(p, n);
    const double at[3] = {x[0] - d * n[0], x[1] - d * n[1], x[2] - d * n[2]};
    keep(&best, d * d, t, -1, at);
  }
  keep(s, best.square, t, best.where, best.at);
}

/* ---- the nearest ----------------------------------------------------------------------------- */

static float radius(const search *s) {
  return (float)(sqrt(s->square) / s->mesh->size * (1.0 + SLACK_RELATIVE) + s->slack);
}

static bool query_triangle(struct RTCPointQueryFunctionArguments *args) {
  search *s = args->userPtr;
  measure(s, args->primID);
  const float smaller = radius(s);
  if (!(smaller < args->query->radius)) return false;
  args->query->radius = smaller;
  return true;
}

static search nearest(const mpsi_mesh *mesh, const double *x) {
  search s = {.mesh = mesh, .x = x, .square = INFINITY, .triangle = INT64_MAX};
  double q[3], far = 0.0;
  for (int c = 0; c < 3; c++) {
    q[c] = (x[c] - mesh->middle[c]) / mesh->size;
    far = fmax(far, fabs(q[c]));
  }
  if (!(far < TOO_FAR)) {
    for (int64_t t = 0; t < mesh->triangles; t++) measure(&s, t);
    return s;
  }
  s.slack = SLACK * (1.0 + far);
  measure(&s, 0);
  struct RTCPointQuery query = {(float)q[0], (float)q[1], (float)q[2], 0.0f, radius(&s)};
  struct RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(mesh->scene, &query, &context, query_triangle, &s);
  return s;
}

/* The outward direction at the feature that the foot lies on, not of unit length. */
static void feature_normal(const mpsi_mesh *mesh, int64_t t, int where, double *n) {
  memcpy(n, mesh->normal + 3 * t, 3 * sizeof *n);
  if (where >= 3) {
    memcpy(n, mesh->vertex_normal + 3 * (int64_t)mesh->corner[3 * t + where - 3], 3 * sizeof *n);
  } else if (where >= 0) {
    const double *other = mesh->normal + 3 * (int64_t)(mesh->across[3 * t + where] / 3);
    for (int c = 0; c < 3; c++) n[c] += other[c];
  }
}

mpsi_foot mpsi_mesh_foot(const mpsi_mesh *mesh, const double *x) {
  const search s = nearest(mesh, x);
  mpsi_foot f = {.face = s.triangle, .narrowing = 1.0};
  double n[3], from[3];
  feature_normal(mesh, s.triangle, s.where, n);
  for (int c = 0; c < 3; c++) {
    f.at[c] = s.at[c];
    from[c] = x[c] - s.at[c];
  }
  const double side = mpsi_dot3(from, n), sign = side < 0.0 ? -1.0 : 1.0, d = sqrt(s.square);
  f.distance = sign * d;
  if (s.where < 0) {
    memcpy(f.normal, n, sizeof f.normal);
    return f;
  }
  /* On an edge the direction to x is round-off: there the feature's own normal is used. */
  const bool on = d <= 1e-14 * mesh->size;
  const double *along = on ? n : from, length = sqrt(mpsi_dot3(along, along));
  for (int c = 0; c < 3; c++) f.normal[c] = (on ? 1.0 : sign) * along[c] / length;
  f.narrowing = mpsi_rim_narrowing(mpsi_dot3(f.normal, mesh->normal + 3 * s.triangle));
  return f;
}

/* ---- walls ----------------------------------------------------------------------------------- */

static void first_hit(RTCScene scene, struct RTCRayHit *ray) {
#if MPSI_EMBREE == 3
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, ray);
#else
  struct RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  rtcIntersect1(scene, ray, &arguments);
#endif
}

double mpsi_mesh_wall(const mpsi_mesh *mesh, int64_t t) {
  const double *n = mesh->normal + 3 * t;
  double centre[3];
  struct RTCRayHit ray = {.ray = {.tnear = (float)SLACK, .tfar = INFINITY, .mask = UINT32_MAX},
                          .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
  float *from = &ray.ray.org_x, *along = &ray.ray.dir_x;
  for (int c = 0; c < 3; c++) {
    centre[c] = 0.0;
    for (int k = 0; k < 3; k++)
      centre[c] += mesh->xyz[3 * (int64_t)mesh->corner[3 * t + k] + c] / 3.0;
    from[c] = (float)((centre[c] - mesh->middle[c]) / mesh->size);
    along[c] = (float)-n[c];
  }
  first_hit(mesh->scene, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID || ray.hit.primID == (unsigned)t) return INFINITY;
  const double *m = mesh->normal + 3 * (int64_t)ray.hit.primID, facing = mpsi_dot3(n, m);
  if (facing > MPSI_BODY_OPPOSITE) return INFINITY;
  const double *a = mesh->xyz + 3 * (int64_t)mesh->corner[3 * (int64_t)ray.hit.primID];
  const double to[3] = {centre[0] - a[0], centre[1] - a[1], centre[2] - a[2]};
  return mpsi_dot3(to, m) / facing;
}

void mpsi_mesh_destroy(mps_context *context, mpsi_mesh *mesh) {
  if (!mesh) return;
  drop_index(mesh);
  MPSI_FREE(context, mesh->xyz, mesh->corner, mesh->across, mesh->normal, mesh->vertex_normal,
            mesh);
}
