/* boundary_kind.h - the kinds of mps_boundary_kind that a solver has.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_BOUNDARY_KIND_H
#define MPSI_BOUNDARY_KIND_H

#include <mps/solver.h>

#include <stdbool.h>

#define MPSI_BOUNDARY_KINDS 8 /* a row each in the tables of solvers */

_Static_assert(MPS_BOUNDARY_OPEN + 1 == MPSI_BOUNDARY_KINDS, "the last kind");

/* Is `kind` one of a solver's, given as bits 1 << kind? Each solver lists its kinds, so that it
 * refuses one that is added for another. */
static inline bool mpsi_boundary_kind_in(int32_t kind, uint32_t kinds) {
  return kind >= 0 && kind < 32 && (kinds >> kind & 1);
}

#endif
