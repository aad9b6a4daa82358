/* near.h - neighbour lists and their weights.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/particles/moments.h"

#include <mps/fluid.h>

#define MPSI_FLUID_WIDE 8 /* lists of neighbours are filled up to a multiple of this */

/* Whether a particle has images among its neighbours, neighbours within .7 l0, a body's corner
 * within 1.5 l0, neighbours in other blocks of the matrix, an acute corner of the water, between a
 * face and a boundary, within 3.1 l0, and images in faces with friction among its neighbours. */
enum {
  MPSI_FLUID_NEAR_IMAGES = 1,
  MPSI_FLUID_NEAR_CLOSE = 2,
  MPSI_FLUID_NEAR_CORNER = 4,
  MPSI_FLUID_NEAR_OTHERS = 8,
  MPSI_FLUID_NEAR_WEDGE = 16,
  MPSI_FLUID_NEAR_ROUGH = 32
};

#define MPSI_FLUID_CLOSE 0.7 /* l0 */

/* Of a lattice of spacing l0; `water`: the radius where there is no rock, m. */
mpsi_fluid_weight mpsi_fluid_make_weight(double l0, double re, double water);
/* Room for a sorted cloud of so many: five values of 4 bytes each lie in lower_room. */
int64_t mpsi_fluid_sorted_room(int64_t all);
mps_status mpsi_fluid_find_neighbours(mps_fluid *fluid, const char *function);
