/* spin.h - the moment of momentum of particles beside bodies. The nodes give a particle, besides
 * its velocity, the moment m sum phi_i (x_i - x_p) x v_i of their momenta about it. Where the
 * support is full that is m times the spin of the slope L by the second moment of the weights,
 *
 *   sum phi_i s_a s_b = m2 h^2 delta_ab,   moment_ab = m m2 h^2 (L_ba - L_ab),
 *
 * and so is what the particle gives back: nothing is lost. Where bodies cut it, the two moments
 * sum phi_i s_a s_b of the step that gathers and the step that scatters differ from that and from
 * each other, and the velocities of the nodes have a moment that no slope has. There the spin of L
 * is set such that the same formula holds, and on the way back to the nodes the particle turns so
 * much faster or slower that it gives just that moment. The laws see the derivatives, not L.
 *
 * For files that are compiled for several instruction sets, after loops.h. Lengths in cells.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_SPIN_H
#define MPSI_MPM_SPIN_H

#include "mpm/base/loops.h"

#define MPSI_LEAST_INERTIA 0.1 /* of a full support: below, turning would take too large a spin */

/* Whether a particle whose stencil has nodes in bodies (`held`: MPSI_IMPULSE, MPSI_PENALTY or both)
 * keeps its moment: not in axisymmetry, where particles are rings, nor with penalty contact, which
 * is as published. */
MPSI_INLINE bool mpsi_keeps_spin(const mps_mpm *mpm, uint32_t held) {
  return (held & MPSI_IMPULSE) != 0 && mpm->def.geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC &&
         !mpm->standard && !mpm->by_weight;
}

/* Sets the spin of the slopes L (1/s) by sum phi s_a v of the nodes, one for each axis a. */
MPSI_INLINE void mpsi_take_spin(int dim, int spline, double inverse, const mpsi_quad *moment,
                                double (*L)[4]) {
  const double scale = mpsi_inverse_moment(spline) * inverse;
  for (int a = 0; a < dim; a++)
    for (int b = a + 1; b < dim; b++) {
      const double spin = scale * (moment[a][1 + b] - moment[b][1 + a]);
      const double more = 0.5 * (spin - (L[a][1 + b] - L[b][1 + a]));
      L[a][1 + b] += more;
      L[b][1 + a] -= more;
    }
}

/* By `spin` more about each axis. */
MPSI_INLINE void mpsi_add_spin(int dim, const double *spin, mpsi_quad *L) {
  for (int a = 0; a < dim; a++) {
    const int b = (a + 1) % 3, axis = (a + 2) % 3;
    if (b >= dim) continue;
    L[a][1 + b] += spin[axis];
    L[b][1 + a] -= spin[axis];
  }
}

/* `m`: sum phi P P^T with P = [1, s]; L: slopes, m/s a cell. Adds to L the rotation by which the
 * particle gives its moment, and returns true; or, where its inertia is too small for that, returns
 * false and sets `turn`: with momentum turn . grad phi (m2/s) besides, nodes get the same. */
MPSI_INLINE bool mpsi_give_spin(int dim, int spline, double cell, double m[4][4], mpsi_quad *L,
                                mpsi_quad *turn) {
  const double full = 1.0 / mpsi_inverse_moment(spline);
  double K[3][3] = {{0.0}}, lack[3] = {0.0}, spin[3] = {0.0}, inertia[4][4] = {{0.0}};
  for (int a = 0; a < dim; a++)
    for (int b = 0; b < dim; b++) K[a][b] = a < b ? m[1 + a][1 + b] : m[1 + b][1 + a];
  for (int a = 0; a < dim; a++) {
    const int b = (a + 1) % 3, axis = (a + 2) % 3;
    if (b >= dim) continue;
    lack[axis] = full * (L[a][1 + b] - L[b][1 + a]);
    for (int d = 0; d < dim; d++) lack[axis] -= K[a][d] * L[d][1 + b] - K[b][d] * L[d][1 + a];
  }
  const double trace = K[0][0] + K[1][1] + K[2][2];
  double least = trace / (2.0 * full); /* of the inertias about the axes; in space a bound below */
  if (dim == 2) {
    spin[2] = lack[2] / trace;
  } else {
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) inertia[a][b] = (a == b ? trace : 0.0) - K[a][b];
    least = fmin(least, mpsi_invert(3, inertia) * 9.0 / (8.0 * full * trace * trace));
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) spin[a] += inertia[a][b] * lack[b];
  }
  const bool turns = least > MPSI_LEAST_INERTIA;
  for (int a = 0; a < 3 && !turns; a++) spin[a] = 0.5 * cell * lack[a];
  mpsi_add_spin(dim, spin, turns ? L : turn);
  return turns;
}

#endif
