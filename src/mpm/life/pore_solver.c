/* pore_solver.c - the solution for implicit pressures (mps/pore_solver.h): its report.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/water/solve/coarse.h"

#include <mps/pore_solver.h>

mps_status mps_mpm_get_pore_report_sized(const mps_mpm *mpm, mps_pore_report *out, size_t size) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  mps_pore_report report = {0};
  if (!mpm->water)
    return mpsi_fail(mpm->context, "mps_mpm_get_pore_report", MPS_ERROR_STATE,
                     "the solver has no pore water");
  const mpsi_pore_system *s = mpm->water->system;
  if (s && s->coarse && mpm->water->def.scheme == MPS_PORE_SCHEME_IMPLICIT) {
    report.unknowns = s->unknowns;
    report.coarse = s->coarse->used ? s->coarse->matrix.rows : 0;
    report.iterations = s->iterations;
  }
  return mpsi_out_write(mpm->context, "mps_mpm_get_pore_report", out, size, &report, sizeof report);
}
