/* boundary_kind.h - names of mps_boundary_kind, for the error of a solver without a kind.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_BOUNDARY_KIND_H
#define MPSI_BOUNDARY_KIND_H

#include <mps/solver.h>

#include <stdbool.h>

static inline const char *mpsi_boundary_kind_name(int32_t kind) {
  static const char *const names[] = {"HELD",      "DRIVEN",     "ROLLER", "FRICTIONAL",
                                      "ABSORBING", "FREE_FIELD", "FREE",   "OPEN"};
  return kind >= 0 && kind <= MPS_BOUNDARY_OPEN ? names[kind] : "of no name";
}

/* Is `kind` one of a solver's, given as bits 1 << kind? */
static inline bool mpsi_boundary_kind_in(int32_t kind, uint32_t kinds) {
  return kind >= 0 && kind <= MPS_BOUNDARY_OPEN && (kinds >> kind & 1);
}

#endif
