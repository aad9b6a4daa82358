/* mps/pore_solver.h - the solution for the implicit pressures of the pore water
 * (MPS_PORE_SCHEME_IMPLICIT of mps/pore_water.h): how many iterations it takes.
 *
 * Thread rule: as mps/mpm.h. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_PORE_SOLVER_H
#define LIBMPS_PORE_SOLVER_H

#include "pore_water.h"

MPS_EXTERN_C_BEGIN

/** The solution for the implicit pressures of the pore water in the last step. */
typedef struct mps_pore_report {
  int64_t unknowns;   /* cells with a pressure of their own, of all ranks */
  int64_t coarse;     /* unknowns of the coarse equation; 0: without one */
  int64_t iterations; /* of the conjugate gradients */
} mps_pore_report;
/** All are 0 before the first step and with explicit pressures. MPS_ERROR_ARGUMENT: NULL, or a
 *  `size` unknown to this library; MPS_ERROR_STATE: no water. Not collective. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_pore_report_sized(const mps_mpm *mpm,
                                                               mps_pore_report *out, size_t size);
static inline mps_status mps_mpm_get_pore_report(const mps_mpm *mpm, mps_pore_report *out) {
  return mps_mpm_get_pore_report_sized(mpm, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
