/* grid.c - one block of nodes: the sums of the tiles that cover it, velocities before and after the
 * forces, seed B (25), (26), (39), and the walls of the domain.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include <string.h>

/* Shape functions of a fit can be negative, so that a node with hardly any particle could get a
 * tiny or negative mass: at least this fraction of its mass by weights, which never is. */
#define LEAST_MASS 0.02

void mpsi_mpm_update_nodes(mps_mpm *mpm, int64_t g) {
  const mpsi_nodes *nodes = &mpm->nodes[g];
  double sum[MPSI_SUMS][MPSI_OWN] = {{0}};
  for (int q = 0; q < 4; q++) {
    if (nodes->from[q] < 0) continue;
    const double(*tile)[MPSI_TILE] = (const double(*)[MPSI_TILE])mpm->tile[nodes->from[q]];
    const int i0 = MPSI_SIDE * (q & 1), j0 = MPSI_SIDE * (q >> 1);
    for (int part = 0; part < MPSI_SUMS; part++)
      for (int j = 0; j < MPSI_SIDE && j + j0 < MPSI_TILE_SIDE; j++)
        for (int i = 0; i < MPSI_SIDE && i + i0 < MPSI_TILE_SIDE; i++)
          sum[part][j * MPSI_SIDE + i] += tile[part][(j + j0) * MPSI_TILE_SIDE + i + i0];
  }
  double(*node)[MPSI_OWN] = mpm->node[g];
  for (int k = 0; k < MPSI_OWN; k++) {
    const double weight = sum[MPSI_M][k] + sum[MPSI_EXCESS][k];
    const double m = fmax(sum[MPSI_M][k], LEAST_MASS * weight);
    const double carried = mpm->def.transfer == MPS_TRANSFER_WEIGHT ? weight : m;
    const bool there = weight > 0.0;
    node[MPSI_NM][k] = there ? m : 0.0;
    node[MPSI_NX][k] = there ? sum[MPSI_PX][k] / carried : 0.0;
    node[MPSI_NY][k] = there ? sum[MPSI_PY][k] / carried : 0.0;
    node[MPSI_VX][k] = there ? node[MPSI_NX][k] + mpm->dt * (sum[MPSI_FX][k] / m) : 0.0;
    node[MPSI_VY][k] = there ? node[MPSI_NY][k] + mpm->dt * (sum[MPSI_FY][k] / m) : 0.0;
  }
  if (mpm->meeting_count > 0) mpsi_mpm_touch(mpm, g);
}

/* Nodes of the wall along axis c at node index `at`. */
static void hold_wall(mps_mpm *mpm, int64_t g, int c, int64_t at, int32_t wall) {
  const int64_t local = at - (int64_t)mpm->nodes[g].at[c] * MPSI_SIDE;
  if (local < 0 || local >= MPSI_SIDE) return;
  for (int other = 0; other < 2; other++) {
    if (other != c && wall == MPS_WALL_ROLLER) continue;
    double *v = mpm->node[g][MPSI_VX + other];
    for (int k = 0; k < MPSI_SIDE; k++)
      v[c == 0 ? k * MPSI_SIDE + (int)local : (int)local * MPSI_SIDE + k] = 0.0;
  }
}

void mpsi_mpm_finish_nodes(mps_mpm *mpm, int64_t g) {
  if (mpm->meeting_count > 0) mpsi_mpm_rub(mpm, g);
  for (int c = 0; c < 2; c++) {
    hold_wall(mpm, g, c, mpm->low[c], mpm->def.wall_lower[c]);
    hold_wall(mpm, g, c, mpm->high[c], mpm->def.wall_upper[c]);
  }
}
