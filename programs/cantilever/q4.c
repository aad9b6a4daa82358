/* q4.c - bilinear quadrilaterals on a regular grid, full 2 x 2 integration, banded Cholesky by
 * LAPACK.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cantilever.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

/* Corners of the reference square, in the order of an element's nodes. */
static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

static void shape_gradient(const q4 *f, int node, double xi, double eta, double *g) {
  g[0] = 0.5 * corner[node][0] * (1 + eta * corner[node][1]) / f->hx;
  g[1] = 0.5 * corner[node][1] * (1 + xi * corner[node][0]) / f->hy;
}

static void element_stiffness(const q4 *f, double k[8][8]) {
  const double at = sqrt(1.0 / 3.0), weight = 0.25 * f->hx * f->hy;
  double lambda, mu;
  beam_lame(f->problem, &lambda, &mu);
  for (int p = 0; p < 64; p++) k[p / 8][p % 8] = 0.0;
  for (int point = 0; point < 4; point++) {
    double g[4][2];
    for (int a = 0; a < 4; a++)
      shape_gradient(f, a, at * corner[point][0], at * corner[point][1], g[a]);
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++)
        for (int c = 0; c < 2; c++)
          for (int d = 0; d < 2; d++)
            k[2 * a + c][2 * b + d] +=
                weight * (lambda * g[a][c] * g[b][d] + mu * g[a][d] * g[b][c] +
                          (c == d ? mu * (g[a][0] * g[b][0] + g[a][1] * g[b][1]) : 0.0));
  }
}

static int64_t node(const q4 *f, int64_t i, int64_t j) { return i * f->ny + j; }

/* Consistent nodal forces of the shear on the end x = 0. */
static void load_end(const q4 *f, double *force) {
  static const double at[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
  static const double weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  for (int64_t j = 0; j + 1 < f->ny; j++)
    for (int p = 0; p < 3; p++) {
      double t[2];
      const double up = 0.5 * (1.0 + at[p]);
      beam_traction(f->problem, -0.5 * f->problem->height + ((double)j + up) * f->hy, t);
      for (int c = 0; c < 2; c++) {
        force[2 * node(f, 0, j) + c] += weight[p] * f->hy * (1.0 - up) * t[c];
        force[2 * node(f, 0, j + 1) + c] += weight[p] * f->hy * up * t[c];
      }
    }
}

/* Lower band by columns: entry (r, c) at band[(r - c) + c * (width + 1)]. */
static void assemble(const q4 *f, double *band, int64_t width) {
  double k[8][8];
  element_stiffness(f, k);
  for (int64_t i = 0; i + 1 < f->nx; i++)
    for (int64_t j = 0; j + 1 < f->ny; j++) {
      const int64_t nodes[4] = {node(f, i, j), node(f, i + 1, j), node(f, i + 1, j + 1),
                                node(f, i, j + 1)};
      for (int p = 0; p < 8; p++)
        for (int q = 0; q < 8; q++) {
          const int64_t r = 2 * nodes[p / 2] + p % 2, c = 2 * nodes[q / 2] + q % 2;
          if (r >= c) band[(r - c) + c * (width + 1)] += k[p][q];
        }
    }
}

/* The wall's nodes are the last unknowns: their columns become those of the identity. */
static void hold_wall(const q4 *f, double *band, int64_t width) {
  const int64_t size = 2 * f->nx * f->ny, first = size - 2 * f->ny;
  double *u = f->u;
  for (int64_t j = 0; j < f->ny; j++)
    beam_wall(f->problem, -0.5 * f->problem->height + (double)j * f->hy, u + first + 2 * j);
  for (int64_t c = first > width ? first - width : 0; c < size; c++)
    for (int64_t r = c > first ? c : first; r <= c + width && r < size; r++) {
      double *entry = &band[(r - c) + c * (width + 1)];
      if (c < first) u[c] -= *entry * u[r];
      *entry = r == c ? 1.0 : 0.0;
    }
}

bool q4_solve(const beam *problem, int64_t nx, int64_t ny, q4 *out) {
  const int64_t size = 2 * nx * ny, width = 2 * ny + 3;
  *out = (q4){.problem = problem,
              .nx = nx,
              .ny = ny,
              .hx = problem->length / (double)(nx - 1),
              .hy = problem->height / (double)(ny - 1)};
  double *band = calloc((size_t)(size * (width + 1)), sizeof *band);
  out->u = calloc((size_t)size, sizeof *out->u);
  bool done = band && out->u;
  if (done) {
    assemble(out, band, width);
    load_end(out, out->u);
    hold_wall(out, band, width);
    done = LAPACKE_dpbsv(LAPACK_COL_MAJOR, 'L', (lapack_int)size, (lapack_int)width, 1, band,
                         (lapack_int)width + 1, out->u, (lapack_int)size) == 0;
  }
  free(band);
  if (!done) q4_free(out);
  return done;
}

void q4_free(q4 *f) {
  free(f->u);
  f->u = NULL;
}

void q4_at(const q4 *f, double x, double y, double *u) {
  const double px = x / f->hx, py = (y + 0.5 * f->problem->height) / f->hy;
  const int64_t i = (int64_t)fmin(fmax(floor(px), 0.0), (double)(f->nx - 2));
  const int64_t j = (int64_t)fmin(fmax(floor(py), 0.0), (double)(f->ny - 2));
  const double a = px - (double)i, b = py - (double)j;
  for (int c = 0; c < 2; c++)
    u[c] = (1 - a) * (1 - b) * f->u[2 * node(f, i, j) + c] +
           a * (1 - b) * f->u[2 * node(f, i + 1, j) + c] +
           a * b * f->u[2 * node(f, i + 1, j + 1) + c] +
           (1 - a) * b * f->u[2 * node(f, i, j + 1) + c];
}
