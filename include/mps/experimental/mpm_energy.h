/* mps/experimental/mpm_energy.h - energy budget of WLS-MPM. With `budget` 1 in the definition of
 * the solver,
 *
 *   kinetic + strain + dissipated - work_loads - work_boundaries - work_bodies
 *
 * of mps_mpm_get_totals is constant to round-off, as long as the caller edits no fields and adds or
 * removes no particles: each term is measured in its stage of the step, and
 * mps_mpm_energy_report.residual is the error of their sum.
 *
 * `strain` is recoverable work: for elastic laws the whole work of the stress on the strain
 * increments of the laws; for elastic-plastic laws the change of the stress's energy by Hooke's
 * law; for the small-strain law the work less what its layers dissipate; for fluids the work of the
 * pressure; for users' laws, whose dissipation is unknown, the whole work; and the energy of
 * penalty contacts. Loads do work by the velocity that the nodes give the particles, boundaries and
 * bodies by their own: a free body by the mean of before and after the step, so that `work_bodies`
 * is minus the `work_contacts` of mps_body_totals, to rounding, of bodies that this solver alone
 * moves. One that another solver moves does its work by the velocity that it has in this solver's
 * step.
 *
 * Thread rule: as mps/mpm.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_MPM_ENERGY_H
#define LIBMPS_EXPERIMENTAL_MPM_ENERGY_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../mpm.h"

MPS_EXTERN_C_BEGIN

/** Parts of `dissipated` of mps_totals, J since creation; `scheme` there is transfer + stepping +
 *  strain. */
typedef struct mps_mpm_energy_report {
  double laws;       /* plasticity and viscosity */
  double boundaries; /* friction of sides, dashpots with their forces at rest */
  double bodies;  /* friction of bodies; by impulses also the energy lost in closing gaps and gained
                     in opening overlaps */
  double damping; /* the definition's damping, and mps_mpm_settle */
  double transfer; /* kinetic energy of the particles less that of the nodes before the forces,
                      and of the nodes less that of the particles after them. WLS dissipates energy
                      at lengths of a few cells; the kinetic energy of velocity gradients returns as
                      a negative part. Includes the work of loads on nodes with almost no mass or a
                      negative one, whose momentum returns to their particles */
  double stepping; /* by the explicit step: impulses act at once, stresses and contacts by their
                      values at its beginning. Oscillates about 0 in smooth motion; an impact on a
                      boundary is here */
  double residual; /* work less all changes and losses: round-off */
  double strain; /* work of the nodes against the stresses less that by the velocity gradient of the
                    laws: forces come from the slope of the fit, strains from the derivative of the
                    shape functions, or (F-bar) from means of cells. Of both signs */
} mps_mpm_energy_report;
/** Parts of the dissipation since creation. MPS_ERROR_STATE: the definition's `budget` is 0;
 *  MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_energy_report_sized(const mps_mpm *mpm,
                                                                 mps_mpm_energy_report *out,
                                                                 size_t size);
static inline mps_status mps_mpm_get_energy_report(const mps_mpm *mpm, mps_mpm_energy_report *out) {
  return mps_mpm_get_energy_report_sized(mpm, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
