/* outside.h - a solver of the caller for the pressure equation.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_FLUID_OUTSIDE_H
#define MPSI_FLUID_OUTSIDE_H

#include "core/base/room.h"

#include <mps/fluid.h>

#include <stdbool.h>

/* A solver of the caller, and its matrix; see outside.c. */
typedef struct mpsi_fluid_outside {
  void *user;
  mps_status (*matrix)(void *user, int64_t rows, const int64_t *start, const int32_t *column,
                       const double *value);
  mps_status (*solve)(void *user, const double *b, double tolerance, double *x,
                      int64_t *iterations);
  mps_status (*forget)(void *user);
  mps_status (*rows_of_rank)(void *user, int64_t all, int64_t first, int64_t rows,
                             const int64_t *start, const int32_t *column, const double *value);
  int64_t least, rows; /* rows: room of start */
  int64_t *start;
  mpsi_room column_room, value_room; /* int32_t, double */
} mpsi_fluid_outside;

bool mpsi_fluid_solved_outside(const mps_fluid *fluid);
mps_status mpsi_fluid_hand_matrix(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_solve_outside(mps_fluid *fluid, const char *function);
void mpsi_fluid_drop_solver(mps_fluid *fluid);
/* Lets a solver of the caller discard its data of former equations. */
mps_status mpsi_fluid_forget(mps_fluid *fluid, const char *function);

#endif
