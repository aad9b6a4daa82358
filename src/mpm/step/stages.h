/* stages.h - stages of a step common to one process (step.c) and several ranks (step_on_ranks.c,
 * which adds the exchanges between them). SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_STAGES_H
#define MPSI_MPM_STAGES_H

#include "mpm/base/mpm_solver.h"
#include "mpm/grid/pass.h"

/* A step, as data of its contact stage. */
typedef struct mpsi_step {
  mps_mpm *mpm;
  const char *function;
  double dt; /* s */
  mps_status status;
} mpsi_step;

/* Last preparation, after bodies have removed particles: forces on particles, energies and the
 * unbalanced force before the step. Nothing has moved. */
mps_status mpsi_step_begin_sums(mps_mpm *mpm, const char *function);
/* Sets the dt of the step; warns once of one that is too long for the Courant limit or for a
 * penalty contact. */
void mpsi_step_begin(mps_mpm *mpm, double dt);
/* Pressures of pore water that are implicit, and the velocities of nodes that they correct. */
mps_status mpsi_step_predict(mps_mpm *mpm, const char *function);
/* Particles to nodes in one process: clear, scatter, update. */
mpsi_pass mpsi_step_scatter_pass(mps_mpm *mpm);
/* Nodes to particles: adds finish and gather to the pass. */
void mpsi_step_gather_pass(mpsi_pass *pass);
/* A step without contact: clears the warm-start impulses, and begins the boundaries. */
void mpsi_step_without_contact(const mpsi_boundaries *boundaries, mpsi_contacts *contacts,
                               double dt);
/* All particles have moved: reactions of boundaries, particles with a prescribed velocity, energy
 * lost in contacts, laws by means of the change of volume. */
void mpsi_step_after_gather(mps_mpm *mpm);
/* Restores the state at the beginning of the step after a law of the caller has refused. The law's
 * status with its record, or MPS_OK where the law of another rank has refused. */
mps_status mpsi_step_refuse(mps_mpm *mpm, const char *function);
/* Completes the step: reactions and poses of bodies, energy, time. */
void mpsi_step_complete(mps_mpm *mpm);

/* step.c: the step in one process. */
mps_status mpsi_mpm_step_alone(mps_mpm *mpm, const char *function, double dt);

#endif
