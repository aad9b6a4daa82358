/* sweeps.h - relative change of the impulses in the last Gauss-Seidel sweep of a step, by which the
 * sweeps end. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_SWEEPS_H
#define MPSI_MPM_SWEEPS_H

#include <mps/mpm.h>

enum { MPSI_SWEEP_CHANGED, MPSI_SWEEP_IMPULSES, MPSI_SWEEP_SUMS };

/* Largest sums over a block of cells of this rank of the squares of changes and of impulses, (N
 * s)2. Their maxima over all ranks do not depend on the number of ranks. */
void mpsi_mpm_sweep_sums(const mpsi_contacts *contacts, double *most);
/* Root of the change over the impulses; 0 without a change. */
double mpsi_mpm_relative_change(const double *most);

#endif
