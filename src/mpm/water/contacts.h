/* contacts.h - contacts with bodies in the operator of implicit pressures (contacts.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "system.h"

/* The contacts of the step that bear, after its sweeps. Collective. MPS_ERROR_MEMORY. */
mps_status mpsi_pore_find_contacts(mps_mpm *mpm, const char *function);
/* Takes from the velocities of the system's nodes what moves the ground in these contacts.
 * Collective. */
mps_status mpsi_pore_hold_contacts(mps_mpm *mpm, const char *function);
/* Adds what the last call of that has taken, over the step, to the impulses of the contacts. */
void mpsi_pore_bear_contacts(mps_mpm *mpm);
