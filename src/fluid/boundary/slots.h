/* slots.h - the numbers of boundaries, bodies and their faces.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

#include <stdbool.h>

/* slots.c. A boundary of this number, faces of a body (first: that of them), a body of this number;
 * false, or -1: no memory. */
bool mpsi_fluid_make_boundary(mps_fluid *fluid, int32_t number);
int mpsi_fluid_make_faces(mps_fluid *fluid, int faces);
bool mpsi_fluid_make_body(mps_fluid *fluid, int32_t number);
/* Boundaries and bodies without members at the end of the lists, and `faces` walls from `first` on,
 * leave them. */
void mpsi_fluid_drop_slots(mps_fluid *fluid, int first, int faces);
