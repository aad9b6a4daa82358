/* joints.h - faces between cells of different material, and the face value's correction there.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

#include <stdbool.h>

/* A face between cells of different material: `low` is below it along `axis`, `high` above. */
typedef struct mpsi_joint {
  int64_t low, high;
  int64_t axis;
} mpsi_joint;

/* Coefficients (m) of the face value's correction at a joint, see joints.c. */
typedef struct mpsi_joint_law {
  double normal, lateral, shear;
} mpsi_joint_law;

#define MPSI_WIDE_MAX                                                                              \
  20 /* sites of a gradient at joints: the particle, faces and edges of a cube */

/* A gradient whose components mix: G[row] = sum_s sum_f c[s][row][f] u[site s][f], row = c * dim +
 * b. */
typedef struct mpsi_wide {
  int32_t count;
  int64_t site[MPSI_WIDE_MAX];
  double c[MPSI_WIDE_MAX][9][3];
} mpsi_wide;

/* Finds the joints of the present material; discards the pattern of the matrix where they have
 * changed. */
mps_status mpsi_elastic_find_joints(mps_elastic *e, const char *function);
void mpsi_elastic_drop_joints(mps_elastic *e);
/* From plain gradients to those with the face values of joints. */
void mpsi_elastic_joint_gradients(mps_elastic *e, const double *u, double *gradient);
/* Its transpose: P = dPi/dG to the stresses of plain gradients, and forces. */
void mpsi_elastic_joint_forces(mps_elastic *e, double *stress, double *f);
/* The gradient at i with all its coefficients. */
void mpsi_elastic_wide_gradient(const mps_elastic *e, int64_t i, mpsi_wide *w);
/* Does the pair of i and its neighbour j at offset k, farther than one cell along some axis, reach
 * across a joint? The mean of its ends' gradients is then not that of its path. */
bool mpsi_elastic_pair_crosses(const mps_elastic *e, int64_t i, int64_t j, int32_t k);
