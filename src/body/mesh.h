/* mesh.h - closed meshes of triangles as the surface of a rigid body.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body_internal.h"

#define MPSI_MESH_MAX_TRIANGLES 20000000

/* Side s = 3 t + e of triangle t runs from its corner e to corner (e + 1) % 3. */
struct mpsi_mesh {
  int64_t vertices, triangles;
  double *xyz;           /* m, 3 a vertex */
  int32_t *corner;       /* 3 a triangle, anticlockwise seen from outside */
  int32_t *across;       /* 3 a triangle: the side of the other triangle at this side */
  double *normal;        /* 3 a triangle, unit, outward */
  double *vertex_normal; /* 3 a vertex: normals of its triangles weighted with their angles */
  double middle[3];      /* m, of the box around it */
  double size;           /* m, half the longest side of the box */
  void *device, *scene;  /* Embree's, see mesh_foot.c */
};

/* Copies, joins coinciding points, checks, turns the triangles outwards. `corner` NULL means that
 * every three points are a triangle. */
mps_status mpsi_mesh_create(mps_context *context, const char *function, int64_t vertices,
                            const double *xyz, int64_t triangles, const int32_t *corner,
                            mpsi_mesh **out);
void mpsi_mesh_destroy(mps_context *context, mpsi_mesh *mesh); /* accepts NULL */

/* The search tree of Embree over a mesh whose triangles are known. */
mps_status mpsi_mesh_index(mps_context *context, const char *function, mpsi_mesh *mesh);

/* As mpsi_body_foot, in the body's frame. */
mpsi_foot mpsi_mesh_foot(const mpsi_mesh *mesh, const double *x);
/* Distance (m) from the centre of triangle t straight inwards to the next triangle, INFINITY where
 * that does not face the other way: see mpsi_body_thickness. */
double mpsi_mesh_wall(const mpsi_mesh *mesh, int64_t t);

/* The triangles of an STL file in memory, 9 numbers each, times `scale`; `path` is for messages. To
 * be released with mpsi_free. */
mps_status mpsi_stl_read(mps_context *context, const char *function, const char *path,
                         const char *data, int64_t size, double scale, int64_t *triangles,
                         double **xyz);
