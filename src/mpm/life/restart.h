/* restart.h - state of the WLS-MPM solver besides the fields of its set, in the form of snapshots
 * and checkpoints. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_RESTART_H
#define MPSI_MPM_RESTART_H

#include "body/body_internal.h"

#include <mps/mpm.h>

/* A block of cells: index of its first particle, coordinates (3), and the part of its tile in use
 * (low 3, high 3). They are of the last sort: the present positions do not determine them. */
enum { MPSI_BLOCK_AT = 1, MPSI_BLOCK_LOW = 4, MPSI_BLOCK_HIGH = 7, MPSI_BLOCK = 10 };
typedef int64_t mpsi_block[MPSI_BLOCK];

/* Dashpot at a node of an absorbing wall. */
typedef struct mpsi_dashpot {
  double across, along; /* rho c A, kg/s */
  double rest[3];       /* N, force of the wall at rest */
} mpsi_dashpot;
enum { MPSI_DASH = 5 }; /* doubles */

#define MPSI_SIDES 6 /* 2 axis + upper */

#endif
