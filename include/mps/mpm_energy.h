/* mps/mpm_energy.h - where the energy of a run of WLS-MPM goes. With `budget` 1 in the definition
 * of the solver,
 *
 *   kinetic + strain + dissipated - work_loads - work_boundaries - work_bodies
 *
 * of mps_mpm_get_totals stays as it was to round-off (1e-12 of the sum of all terms' sizes in the
 * tests), wherever fields and particles are left as the steps have made them: each term is measured
 * where it happens, and mps_mpm_losses.residual is what they leave.
 *
 * `strain` is the work, by the strains that the laws see, against the stresses that the laws give
 * back, and the energy of the contacts' springs. Of elastic laws that is all; of elastic-plastic
 * ones the change of the energy of the stress by Hooke's law; of fluids the work of the pressure;
 * of users' laws, which do not tell, all. Loads do work by the velocity that the nodes give the
 * particles, boundaries and bodies by their own: a free body by the mean of before and after the
 * step, so that `work_bodies` is minus the `work_contacts` of mps_body_totals, to rounding, of
 * bodies that this solver alone moves. One that another solver moves does its work by the velocity
 * that it has in this solver's step.
 *
 * Thread rule: as mps/mpm.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MPM_ENERGY_H
#define LIBMPS_MPM_ENERGY_H

#include "mpm.h"

MPS_EXTERN_C_BEGIN

/** Where `dissipated` of mps_totals went, J since creation; `scheme` there is transfer + stepping +
 *  strain.
 */
typedef struct mps_mpm_losses {
  double laws;       /* plasticity and viscosity */
  double boundaries; /* friction of sides, dashpots with their forces at rest */
  double bodies;     /* friction of bodies; by impulses also what their closing of gaps takes and
                        their opening of overlaps gives */
  double damping;    /* what the definition's damping, and mps_mpm_settle, take */
  double transfer;   /* kinetic energy of the particles less that of the nodes before the forces,
                        and of the nodes less that of the particles after them. WLS takes energy
                        at lengths of a few cells; what a velocity gradient carries to the nodes
                        comes back as a negative part. With it the work of loads by the momentum that
                        a node of hardly any or of negative mass returns to its particles */
  double stepping;   /* by the explicit step: impulses act at once, stresses and contacts by their
                        values at its beginning. Swings about 0 where all is smooth; an impact on
                        what holds or drives is here */
  double residual;   /* work less all changes and losses: round-off */
  double strain;     /* work of the nodes against the stresses less that by the gradient which the
                        laws see: forces come from the slope of the fit, strains from the derivative
                        of the shape functions, or (F-bar) from means of cells. Of both signs */
} mps_mpm_losses;
/** MPS_ERROR_STATE: the definition's `budget` is 0. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_losses_sized(const mps_mpm *mpm, mps_mpm_losses *out,
                                                          size_t size);
static inline mps_status mps_mpm_get_losses(const mps_mpm *mpm, mps_mpm_losses *out) {
  return mps_mpm_get_losses_sized(mpm, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
