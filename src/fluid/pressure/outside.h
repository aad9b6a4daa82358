/* outside.h - the pressure equation for a linear solver of the caller.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/room.h"

#include <mps/fluid.h>

#include <stdbool.h>

/* Memory of the matrix: int64_t, int32_t, double. */
typedef struct mpsi_fluid_outside {
  mpsi_room start_room, column_room, value_room;
} mpsi_fluid_outside;

bool mpsi_fluid_solved_outside(const mps_fluid *fluid);
mps_status mpsi_fluid_hand_matrix(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_solve_outside(mps_fluid *fluid, const char *function);
void mpsi_fluid_free_outside(mps_fluid *fluid);
