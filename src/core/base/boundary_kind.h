/* boundary_kind.h - the kinds of mps_boundary_kind that a solver has.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/solver.h>

#include <stdbool.h>

#define MPSI_BOUNDARY_KINDS 8 /* a row each in the tables of solvers */

_Static_assert(MPS_BOUNDARY_OPEN + 1 == MPSI_BOUNDARY_KINDS, "the last kind");
