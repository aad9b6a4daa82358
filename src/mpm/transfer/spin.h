/* spin.h - conservation of angular momentum in the transfer beside bodies. The nodes transfer to a
 * particle, besides its velocity, the angular momentum m sum phi_i (x_i - x_p) x v_i about its
 * position. With a full support this is m times the antisymmetric part of the velocity gradient L
 * times the second moment of the weights,
 *
 *   sum phi_i s_a s_b = m2 h^2 delta_ab,   moment_ab = m m2 h^2 (L_ba - L_ab),
 *
 * and the particle transfers the same back to the nodes: angular momentum is conserved. In a
 * support that bodies cut, the second moments sum phi_i s_a s_b of the gather and of the next
 * scatter differ from m2 h^2 and from each other, and the velocities of the nodes have an angular
 * momentum that no gradient represents. There the gather sets the antisymmetric part of L such that
 * the formula above is true, and the scatter adds a rigid rotation to the particle's velocities
 * such that the nodes get just this angular momentum. Constitutive laws see the derivatives of the
 * velocity, not L.
 *
 * For files that are compiled for several instruction sets, after loops.h. Lengths in cells;
 * particles in the lanes of a vector. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "least_squares.h"

/* Fraction of a full support's inertia below which the rotation would be too fast. */
#define MPSI_LEAST_INERTIA 0.1

/* Lanes with conserved angular momentum: particles that see nodes in bodies with contact by
 * impulses, or whose stencil has inactive ones behind thin bodies. Not in axisymmetry, where a
 * particle is a ring; penalty contact stays as published. */
MPSI_INLINE mpsi_mask mpsi_conserves_spin(const mpsi_grid *grid, const mpsi_cut *b) {
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC || grid->by_weight) return (mpsi_mask){0};
  return b->held & MPSI_IMPULSE ? b->beside : b->parted != 0;
}

MPSI_INLINE bool mpsi_any_lane(mpsi_mask lanes) {
  return (lanes[0] | lanes[1] | lanes[2] | lanes[3]) != 0;
}

/* ---- particles to nodes ---------------------------------------------------------------------- */

/* Contributions of the particles to node i. Each is a linear function of s, given by its
 * coefficients of 1, s_x, s_y, s_z, times phi_i or w_i; the mass is m phi_i. */
typedef struct mpsi_source {
  mpsi_quad m;
  mpsi_quad momentum[3][4]; /* kg m/s, times phi_i; by component */
  mpsi_quad turn[3][3]; /* kg m2/s, times the derivative of phi_i along each axis: angular momentum
                           that no rotation carries */
  mpsi_quad by_weight[3][4]; /* kg m/s, times w_i: the momentum turn . grad phi_i */
  mpsi_quad force[3][4];     /* N, times w_i */
} mpsi_source;

/* Second moments K = sum phi s s^T of the shape functions. */
MPSI_INLINE void mpsi_find_second(int dim, int spline, const mpsi_cut *b, mpsi_quad K[3][3]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) K[r][c] = (mpsi_quad){0.0};
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const mpsi_quad value = mpsi_row_value(dim, b, b->q[0], j, k), y = b->s[1][j];
      mpsi_quad one = {0.0}, by_x = {0.0};
      for (int i = 0, n = 16 * k + 4 * j; i <= spline; i++, n++) {
        const mpsi_quad x = b->s[0][i], phi = b->w[n] * (value + b->q[0][1] * x);
        one += phi, by_x += phi * x, K[0][0] += phi * x * x;
      }
      K[0][1] += by_x * y, K[1][1] += one * y * y;
      if (dim == 2) continue;
      const mpsi_quad z = b->s[2][k];
      K[0][2] += by_x * z, K[1][2] += one * y * z, K[2][2] += one * z * z;
    }
  for (int r = 0; r < dim; r++)
    for (int c = 0; c < r; c++) K[r][c] = K[c][r];
}

/* Rotation `spin` about each axis that supplies the missing angular momentum `lack`; returns the
 * lanes whose inertia is large enough for it. `full`: second moment of a full support. */
MPSI_INLINE mpsi_mask mpsi_find_spin(int dim, double full, mpsi_quad K[3][3], const mpsi_quad *lack,
                                     mpsi_quad *spin) {
  const mpsi_quad trace = dim == 2 ? K[0][0] + K[1][1] : K[0][0] + K[1][1] + K[2][2];
  mpsi_mask turns = trace > MPSI_LEAST_INERTIA * 2.0 * full;
  if (dim == 2) {
    spin[2] = lack[2] / trace;
    return turns;
  }
  mpsi_quad inertia[4][4];
  for (int a = 0; a < 3; a++)
    for (int c = a; c < 3; c++) inertia[a][c] = (a == c ? trace : (mpsi_quad){0.0}) - K[a][c];
  const mpsi_quad determinant = mpsi_invert_lanes(3, inertia);
  turns &= determinant * 9.0 > MPSI_LEAST_INERTIA * 8.0 * full * trace * trace;
  for (int a = 0; a < 3; a++)
    spin[a] = inertia[a][0] * lack[0] + inertia[a][1] * lack[1] + inertia[a][2] * lack[2];
  return turns;
}

/* Completes the angular momentum of the lanes `keeps`: adds a rotation to their momenta; or, where
 * the inertia is too small for that, the momentum s->turn . grad phi, which has the same angular
 * momentum. Returns whether any lane has the latter. */
MPSI_INLINE bool mpsi_add_rotation(const mpsi_grid *grid, int dim, int spline, const mpsi_cut *b,
                                   mpsi_mask keeps, mpsi_source *s) {
  const double full = 1.0 / mpsi_inverse_moment(spline);
  mpsi_quad K[3][3], lack[3] = {{0.0}}, spin[3] = {{0.0}};
  mpsi_find_second(dim, spline, b, K);
  for (int a = 0; a < dim; a++) {
    const int o = (a + 1) % 3, axis = (a + 2) % 3;
    if (o >= dim) continue;
    lack[axis] = full * (s->momentum[o][1 + a] - s->momentum[a][1 + o]);
    for (int d = 0; d < dim; d++)
      lack[axis] -= K[a][d] * s->momentum[o][1 + d] - K[o][d] * s->momentum[a][1 + d];
  }
  const mpsi_mask turns = mpsi_find_spin(dim, full, K, lack, spin) & keeps;
  for (int a = 0; a < dim; a++) {
    const int o = (a + 1) % 3, axis = (a + 2) % 3;
    if (o >= dim) continue;
    const mpsi_quad more = (mpsi_quad)((mpsi_mask)spin[axis] & turns);
    const mpsi_quad turn = (mpsi_quad)((mpsi_mask)(0.5 * grid->cell * lack[axis]) & ~turns & keeps);
    s->momentum[o][1 + a] += more, s->momentum[a][1 + o] -= more;
    s->turn[o][a] = turn, s->turn[a][o] = -turn;
  }
  for (int a = 0; a < dim; a++)
    for (int c = 0; c <= dim; c++) {
      s->by_weight[a][c] = (mpsi_quad){0.0};
      for (int d = 0; d < dim; d++) s->by_weight[a][c] += s->turn[a][d] * b->q[1 + d][c];
    }
  return mpsi_any_lane(keeps & ~turns);
}

/* ---- nodes to particles ---------------------------------------------------------------------- */

/* Sets the antisymmetric part of the velocity gradients L[component][axis] (1/s) of the lanes
 * `keeps`, from the angular momentum of the nodes, moment[component][axis] = sum phi s v. */
MPSI_INLINE void mpsi_set_spin(int dim, int spline, double inverse, mpsi_mask keeps,
                               mpsi_quad (*moment)[3], mpsi_quad (*L)[3]) {
  const double scale = mpsi_inverse_moment(spline) * inverse;
  for (int a = 0; a < dim; a++)
    for (int b = a + 1; b < dim; b++) {
      const mpsi_quad spin = scale * (moment[b][a] - moment[a][b]);
      const mpsi_quad more = (mpsi_quad)((mpsi_mask)(0.5 * (spin - (L[b][a] - L[a][b]))) & keeps);
      L[b][a] += more;
      L[a][b] -= more;
    }
}
