/* pore_solver.c - the solution for implicit pressures (mps/pore_solver.h): a solver of the
 * caller, and the report.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/ranks/partition.h"
#include "mpm/water/solve/coarse.h"
#include "mpm/water/solve/outside.h"

#include <mps/pore_solver.h>

static const mps_pore_solver_def defaults = {.struct_size = sizeof(mps_pore_solver_def)};

mps_status mps_pore_solver_def_init(mps_pore_solver_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_pore_solver_def, def, size, &defaults);
}

static mps_status check(mps_mpm *mpm, const char *function, const mps_pore_solver_def *user_def,
                        mps_pore_solver_def *def) {
  mps_status status = mpsi_mpm_usable(mpm, function);
  if (status == MPS_OK && !mpm->water)
    return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                     "the solver has no pore water: mps_mpm_add_pore_water adds it");
  if (status == MPS_OK && user_def)
    status = MPSI_DEF_READ(mpm->context, function, mps_pore_solver_def, user_def, def);
  if (status != MPS_OK || !user_def) return status;
  if (!def->rows || !def->solve)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "rows is %s and solve %s: both must be given", def->rows ? "given" : "NULL",
                     def->solve ? "given" : "NULL");
  if (def->least < 0)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT, "least is %lld, must be >= 0",
                     (long long)def->least);
  return MPS_OK;
}

/* Status of all ranks, and a check that all have such a solver. */
static mps_status agree(const mps_mpm *mpm, const char *function, mps_status status, bool given,
                        const mps_pore_solver_def *def) {
  mpsi_given list;
  if (!mpm->partition) return status;
  mpsi_given_begin(&list);
  mpsi_give(&list, "having a solver", given);
  mpsi_give(&list, "having forget", def->forget != NULL);
  MPSI_GIVE(&list, def, least);
  return mpsi_domain_agree_given(mpm->partition->domain, function, status, &list);
}

mps_status mps_mpm_set_pore_solver(mps_mpm *mpm, const mps_pore_solver_def *user_def) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  mps_pore_solver_def def = defaults;
  mpsi_pore_outside *outside = NULL;
  mps_status status = check(mpm, __func__, user_def, &def);
  if (status == MPS_OK && user_def) {
    outside = mpsi_alloc(mpm->context, 1, sizeof *outside);
    if (!outside) status = mpsi_fail_memory(mpm->context, __func__, sizeof *outside);
  }
  status = agree(mpm, __func__, status, user_def != NULL, &def);
  if (status != MPS_OK) {
    mpsi_free(mpm->context, outside);
    return status;
  }
  if (outside) *outside = (mpsi_pore_outside){.def = def};
  mpsi_pore_drop_solver(mpm->context, mpm->water);
  mpm->water->outside = outside;
  return MPS_OK;
}

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
