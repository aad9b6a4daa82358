/* boundary_kind.h - names of mps_boundary_kind, for the error of a solver without a kind.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_BOUNDARY_KIND_H
#define MPSI_BOUNDARY_KIND_H

#include <mps/solver.h>

#include <stdbool.h>

/* Without a default case, so that a compiler names a kind that is missing here (-Wswitch). */
static inline const char *mpsi_boundary_kind_name(int32_t kind) {
  switch ((mps_boundary_kind)kind) {
  case MPS_BOUNDARY_HELD:
    return "HELD";
  case MPS_BOUNDARY_DRIVEN:
    return "DRIVEN";
  case MPS_BOUNDARY_ROLLER:
    return "ROLLER";
  case MPS_BOUNDARY_FRICTIONAL:
    return "FRICTIONAL";
  case MPS_BOUNDARY_ABSORBING:
    return "ABSORBING";
  case MPS_BOUNDARY_FREE_FIELD:
    return "FREE_FIELD";
  case MPS_BOUNDARY_FREE:
    return "FREE";
  case MPS_BOUNDARY_OPEN:
    return "OPEN";
  }
  return "of no name";
}

/* Is `kind` one of a solver's, given as bits 1 << kind? Each solver lists its kinds, so that it
 * refuses one that is added for another. */
static inline bool mpsi_boundary_kind_in(int32_t kind, uint32_t kinds) {
  return kind >= 0 && kind < 32 && (kinds >> kind & 1);
}

#endif
