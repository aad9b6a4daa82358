/* forces.h - forces of the cells on their nodes, for pressures that are implicit (forces.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "system.h"

/* Forces of the cells, also in the wide halo, and masses of this rank's nodes. Collective.
 * MPS_ERROR_MEMORY. */
mps_status mpsi_pore_find_forces(mps_mpm *mpm, const char *function);
/* foresee.c: after contacts: velocities of the nodes as boundaries will leave them without a
 * correction, their inertias against one and which components are prescribed, also in the wide
 * halo. Collective. */
mps_status mpsi_pore_find_nodes(mps_mpm *mpm, const char *function);
