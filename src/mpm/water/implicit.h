/* implicit.h - pressures of cells that are implicit in time (implicit.c), in one process.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_WATER_IMPLICIT_H
#define MPSI_MPM_WATER_IMPLICIT_H

#include "water.h"

enum { MPSI_PORE_AROUND = 27, MPSI_PORE_SPAN = 4 }; /* blocks; nodes of a cell along each axis */

/* Arrays by nodes of the grid are vectors of the system: values of cells. */
struct mpsi_pore_system {
  int32_t (*around)[MPSI_PORE_AROUND]; /* by blocks: those around it, itself in the middle, or -1 */
  int32_t *tile; /* by blocks: numbers of the nodes (and cells) in reach of its own, or -1 */
  double *mass;  /* kg, by nodes */
  double (*velocity)[3];    /* by nodes */
  uint8_t *held;            /* by nodes: bit c, component c is prescribed */
  int32_t *row;             /* by cells: where its forces are */
  double *force;            /* of each filled cell [dim][span^dim]: sum V grad phi, m3/m */
  double (*conductance)[6]; /* m3/(s Pa), by cells: to those beside */
  double *diagonal, *scale; /* m3/Pa of storage and drained faces; root of space/V */
  double *change, *residual, *direction, *product; /* Pa; m3 */
  double *inverse;                                 /* of the matrix's diagonal */
  double *part;                                    /* of sums, by blocks */
  int64_t iterations;                              /* of the last step */
  mpsi_room around_room, mass_room, velocity_room, held_room, row_room, force_room;
  mpsi_room conductance_room, vector_room, tile_room, part_room;
};

/* Room for the present blocks. MPS_ERROR_MEMORY. */
mps_status mpsi_pore_make_system(mps_mpm *mpm, const char *function);
/* The pressures `now` at the end of the step, from those at its start, changes of volume and faces.
 * MPS_ERROR_NUMERIC: no solution to the tolerance; MPS_ERROR_MEMORY. */
mps_status mpsi_pore_solve(mps_mpm *mpm, const char *function);
void mpsi_pore_free_system(mps_context *context, mpsi_pore_system **system);

#endif
