/* bending.c - bending stiffness of a single cell (conservative method).
 *
 * The strain of a cell is constant in V W(G), so that a beam of n cells across lacks 1/n^2 of its
 * bending stiffness: E h^3/12 a cell. Strains that vary across the cell have no energy; the terms
 * of beams, plates and shafts are added,
 *
 *   1/2 int (E x_b^2 u_a,ab^2 + E x_a^2 u_b,ab^2 + mu x^2 u_c,ab^2) dV = 1/2 V h^2/12 (...)
 *
 * for each pair of axes a, b (c: the third one), E the modulus of uniaxial stress. The mixed
 * derivative u_,ab = (u_1 - u_2 - u_3 + u_4)/h^2 is that of a square of four particles; each cell
 * gives equal shares of its energy to the squares that it is a corner of.
 *
 * Where a joint runs between the corners, stretches along a are in series along a and parallel
 * across it: harmonic means of E along a, sums across; shear is harmonic in both. A square in the
 * corner of a joint has no stiffness. In layers under constant traction, and in every linear field,
 * the derivative is zero on each square: such states stay exact.
 *
 * One-sided gradients at free surfaces are too stiff, by about as much in thick bodies, so that a
 * body of one material is not corrected by default; the layers of a composite have fewer cells and
 * less surface. SPDX-License-Identifier: BSD-3-Clause */
#include "bending.h"
#include "implicit/base/implicit_solver.h"

static const int8_t plane_axes[3][2] = {{0, 1}, {0, 2}, {1, 2}};

static int planes(const mps_elastic *e) { return e->dim == 2 ? 1 : 3; }

static int64_t beside(const mps_elastic *e, int64_t i, int axis, int up) {
  return i < 0 ? -1 : mpsi_elastic_neighbours(e, i)[e->links.face[axis][up]];
}

/* The square with lower corner `low`: low, along a, along b, across. False: one does not exist. */
static bool square(const mps_elastic *e, int64_t low, int plane, int64_t *corner) {
  const int a = plane_axes[plane][0], b = plane_axes[plane][1];
  corner[0] = low;
  corner[1] = beside(e, low, a, 1);
  corner[2] = beside(e, low, b, 1);
  corner[3] = beside(e, corner[1], b, 1);
  return corner[1] >= 0 && corner[2] >= 0 && corner[3] >= 0;
}

/* The lower corner of the square in which p is corner k, or -1. */
static int64_t lower_corner(const mps_elastic *e, int64_t p, int plane, int k) {
  if (k & 1) p = beside(e, p, plane_axes[plane][0], 0);
  return k & 2 ? beside(e, p, plane_axes[plane][1], 0) : p;
}

/* ---- stiffness of squares -------------------------------------------------------------------- */

/* Modulus of uniaxial stress: E, or E / (1 - nu^2) in plane strain. */
static double uniaxial(const mps_elastic *e, int64_t i) {
  const double l = e->lambda[i], m = e->mu[i];
  return e->dim == 2 ? 4.0 * m * (l + m) / (l + 2.0 * m) : m * (3.0 * l + 2.0 * m) / (l + m);
}

static double harmonic(double a, double b) { return a == b ? a : 2.0 * a * b / (a + b); }

static bool same(const mps_elastic *e, int64_t i, int64_t j) {
  return e->lambda[i] == e->lambda[j] && e->mu[i] == e->mu[j];
}

/* Its share of V h^2/12 for one square, in terms of differences: / h^4. */
static double share(const mps_elastic *e, int64_t i, int plane) {
  int count = 0;
  for (int k = 0; k < 4; k++) {
    int64_t corner[4];
    const int64_t low = lower_corner(e, i, plane, k);
    count += low >= 0 && square(e, low, plane, corner);
  }
  return e->volume[i] / (12.0 * count * e->spacing * e->spacing);
}

static void stiffness(const mps_elastic *e, const int64_t *corner, int plane, double *out) {
  double part[4], modulus[4], shear[4];
  const double weight = isnan(e->def.bending) ? 1.0 : e->def.bending;
  if (!(same(e, corner[0], corner[1]) && same(e, corner[2], corner[3])) &&
      !(same(e, corner[0], corner[2]) && same(e, corner[1], corner[3])))
    return;
  for (int k = 0; k < 4; k++) {
    part[k] = weight * share(e, corner[k], plane);
    modulus[k] = uniaxial(e, corner[k]);
    shear[k] = e->mu[corner[k]];
  }
  const double all = part[0] + part[1] + part[2] + part[3];
  for (int c = 0; c < e->dim; c++)
    out[c] = all * harmonic(harmonic(shear[0], shear[1]), harmonic(shear[2], shear[3]));
  out[plane_axes[plane][0]] = (part[0] + part[1]) * harmonic(modulus[0], modulus[1]) +
                              (part[2] + part[3]) * harmonic(modulus[2], modulus[3]);
  out[plane_axes[plane][1]] = (part[0] + part[2]) * harmonic(modulus[0], modulus[2]) +
                              (part[1] + part[3]) * harmonic(modulus[1], modulus[3]);
}

bool mpsi_elastic_has_bending(const mps_elastic *e, bool joints) {
  return e->conservative && (isnan(e->def.bending) ? joints : e->def.bending > 0.0);
}

int64_t mpsi_elastic_bending_size(const mps_elastic *e) {
  return mpsi_elastic_slots(e) * planes(e) * e->dim;
}

static double *of_square(const mps_elastic *e, int64_t low, int plane) {
  return e->bending + (mpsi_elastic_slot(e, low) * planes(e) + plane) * e->dim;
}

void mpsi_elastic_measure_bending(mps_elastic *e) {
  if (!e->bending) return;
  for (int64_t k = e->span[3].from; k < e->span[3].to; k++) /* rows reach two layers far */
    for (int plane = 0; plane < planes(e); plane++) {
      const int64_t i = mpsi_elastic_in_order(e, k);
      int64_t corner[4];
      double *out = of_square(e, i, plane);
      for (int c = 0; c < e->dim; c++) out[c] = 0.0;
      if (square(e, i, plane, corner)) stiffness(e, corner, plane, out);
    }
}

/* ---- forces and the matrix ------------------------------------------------------------------- */

static double sign(int k) { return k == 0 || k == 3 ? 1.0 : -1.0; }

void mpsi_elastic_bending_force(const mps_elastic *e, const double *u, int64_t p, double *f) {
  const int d = e->dim;
  if (!e->bending) return;
  for (int plane = 0; plane < planes(e); plane++)
    for (int k = 0; k < 4; k++) {
      int64_t corner[4];
      const int64_t low = lower_corner(e, p, plane, k);
      if (low < 0 || !square(e, low, plane, corner)) continue;
      const double *stiff = of_square(e, low, plane);
      for (int c = 0; c < d; c++) /* differences, so that a translation gives exactly zero */
        f[c] += sign(k) * stiff[c] *
                ((u[corner[0] * d + c] - u[corner[1] * d + c]) -
                 (u[corner[2] * d + c] - u[corner[3] * d + c]));
    }
}

int32_t mpsi_elastic_bending_row(const mps_elastic *e, int64_t p, mpsi_bending_term *terms) {
  const int d = e->dim;
  int32_t found = 0;
  if (!e->bending) return 0;
  for (int plane = 0; plane < planes(e); plane++)
    for (int k = 0; k < 4; k++) {
      int64_t corner[4];
      const int64_t low = lower_corner(e, p, plane, k);
      if (low < 0 || !square(e, low, plane, corner)) continue;
      const double *stiff = of_square(e, low, plane);
      for (int s = 0; s < 4; s++) {
        mpsi_bending_term *term = &terms[found++];
        term->site = corner[s];
        for (int c = 0; c < d; c++) term->value[c] = sign(k) * sign(s) * stiff[c];
      }
    }
  return found;
}
