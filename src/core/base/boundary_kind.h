/* boundary_kind.h - names of mps_boundary_kind, for the error of a solver without a kind.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/solver.h>

#include <stdbool.h>

#define MPSI_BOUNDARY_KINDS 8 /* a row each in the tables of solvers */

/* Without its prefix: HELD. */
static inline const char *mpsi_boundary_kind_name(int32_t kind) {
  _Static_assert(MPS_BOUNDARY_OPEN + 1 == MPSI_BOUNDARY_KINDS, "the last kind");
  const char *name = mps_boundary_kind_name(kind);
  return name ? name + sizeof "MPS_BOUNDARY_" - 1 : "of no name";
}
