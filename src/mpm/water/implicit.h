/* implicit.h - pressures of cells that are implicit in time (implicit.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "system.h"

/* The velocities of the nodes by what the pressures of cells are above those that P2G had.
 * Collective. MPS_ERROR_MEMORY. */
mps_status mpsi_pore_press_nodes(mps_mpm *mpm, const char *function);
/* The pressures `now` at the end of the step, from those at its start, the velocities of the nodes
 * and faces; corrects the velocities and the impulses of contacts. Collective. MPS_ERROR_NUMERIC:
 * no solution to the tolerance; MPS_ERROR_MEMORY. */
mps_status mpsi_pore_solve(mps_mpm *mpm, const char *function);
