/* mesh_shapes.h - closed meshes for tests: a geodesic sphere, a torus and a block with a notch.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MESH_SHAPES_H
#define MESH_SHAPES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#define MESH_TRIANGLES 1280

/* Corners are not shared: three points a triangle. */
typedef struct mesh_shape {
  int64_t triangles;
  double xyz[9 * MESH_TRIANGLES];
  int32_t corner[3 * MESH_TRIANGLES];
} mesh_shape;

static inline void mesh_add(mesh_shape *m, const double *a, const double *b, const double *c) {
  const double *const points[3] = {a, b, c};
  for (int k = 0; k < 3; k++) {
    memcpy(m->xyz + 9 * m->triangles + 3 * k, points[k], 3 * sizeof(double));
    m->corner[3 * m->triangles + k] = (int32_t)(3 * m->triangles + k);
  }
  m->triangles++;
}

static inline void mesh_middle(const double *a, const double *b, double *out) {
  double length = 0.0;
  for (int c = 0; c < 3; c++) out[c] = a[c] + b[c], length += out[c] * out[c];
  for (int c = 0; c < 3; c++) out[c] /= sqrt(length);
}

static inline void mesh_divide(mesh_shape *m, const double *a, const double *b, const double *c,
                               int level) {
  if (level == 0) {
    mesh_add(m, a, b, c);
    return;
  }
  double ab[3], bc[3], ca[3];
  mesh_middle(a, b, ab);
  mesh_middle(b, c, bc);
  mesh_middle(c, a, ca);
  mesh_divide(m, a, ab, ca, level - 1);
  mesh_divide(m, ab, b, bc, level - 1);
  mesh_divide(m, ca, bc, c, level - 1);
  mesh_divide(m, ab, bc, ca, level - 1);
}

/* Unit sphere: 20 * 4^level triangles, level 0 to 3. */
static inline void mesh_sphere(mesh_shape *m, int level) {
  const double g = 0.5 + sqrt(1.25), s = 1.0 / sqrt(1.0 + g * g), t = g * s;
  const double p[12][3] = {{-s, t, 0}, {s, t, 0}, {-s, -t, 0}, {s, -t, 0},
                           {0, -s, t}, {0, s, t}, {0, -s, -t}, {0, s, -t},
                           {t, 0, -s}, {t, 0, s}, {-t, 0, -s}, {-t, 0, s}};
  static const int f[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                               {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                               {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                               {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  m->triangles = 0;
  for (int k = 0; k < 20; k++) mesh_divide(m, p[f[k][0]], p[f[k][1]], p[f[k][2]], level);
}

static inline void mesh_torus_point(int i, int j, double *out) {
  const double two_pi = 8.0 * atan(1.0), u = two_pi * (i % 24) / 24, v = two_pi * (j % 12) / 12;
  out[0] = (0.9 + 0.35 * cos(v)) * cos(u);
  out[1] = (0.9 + 0.35 * cos(v)) * sin(u);
  out[2] = 0.35 * sin(v);
}

static inline void mesh_torus(mesh_shape *m) {
  m->triangles = 0;
  for (int i = 0; i < 24; i++)
    for (int j = 0; j < 12; j++) {
      double a[3], b[3], c[3], d[3];
      mesh_torus_point(i, j, a);
      mesh_torus_point(i + 1, j, b);
      mesh_torus_point(i + 1, j + 1, c);
      mesh_torus_point(i, j + 1, d);
      mesh_add(m, a, b, c);
      mesh_add(m, a, c, d);
    }
}

/* An L of limbs 0.5 wide in a square of side 1, `thickness` high. */
static inline void mesh_block(mesh_shape *m, double thickness) {
  static const double xy[6][2] = {{0, 0}, {1, 0}, {1, 0.5}, {0.5, 0.5}, {0.5, 1}, {0, 1}};
  static const int cap[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  double low[6][3], high[6][3];
  for (int k = 0; k < 6; k++)
    for (int c = 0; c < 3; c++) {
      low[k][c] = c < 2 ? xy[k][c] : 0.0;
      high[k][c] = c < 2 ? xy[k][c] : thickness;
    }
  m->triangles = 0;
  for (int k = 0; k < 4; k++) {
    mesh_add(m, low[cap[k][0]], low[cap[k][2]], low[cap[k][1]]);
    mesh_add(m, high[cap[k][0]], high[cap[k][1]], high[cap[k][2]]);
  }
  for (int k = 0; k < 6; k++) {
    const int n = (k + 1) % 6;
    mesh_add(m, low[k], low[n], high[n]);
    mesh_add(m, low[k], high[n], high[k]);
  }
}

#endif
