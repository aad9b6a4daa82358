/* budget.h - energies and momenta, and the works of a step.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/exact.h"
#include "dynamics/boundary/loads.h"

#include <mps/dynamics.h>

/* Works and energies, J, since the state began. */
typedef struct mpsi_dynamics_works {
  mpsi_exact loads, boundaries, damping;
  double start; /* kinetic and strain energy at the start */
  double part;  /* of one block, on its way into `boundaries` */
  int64_t block;
} mpsi_dynamics_works;

/* Terms of a step for the works. */
typedef struct mpsi_dynamics_account {
  mps_dynamics *dynamics;
  const mpsi_dynamics_forces *forces;
  const double *drag; /* NULL: dissipation of damping is not summed */
  double kick;
} mpsi_dynamics_account;

/* Keeps the velocities of a block's particles before a step; after it, adds up the works. */
void mpsi_dynamics_note_velocities(mps_dynamics *dynamics, int64_t block);
void mpsi_dynamics_count_works(mpsi_dynamics_account *account);
/* Kinetic and strain energy of the present state, J. */
mps_status mpsi_dynamics_energies(mps_dynamics *dynamics, const char *function, double *kinetic,
                                  double *strain);

mps_status mpsi_dynamics_get_totals(void *dynamics, const char *function, mps_totals *out);
