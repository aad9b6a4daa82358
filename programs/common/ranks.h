/* ranks.h - a program that mpirun or srun has started as several processes, the ranks of one model:
 * their number, their domain, and threads for each. The library of the domain, libmps-petsc, is
 * loaded only then: without mpirun a program uses neither MPI nor PETSc.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/experimental/domain.h>
#include <mps/experimental/linear_solver.h>

#include <stdbool.h>

/* From the launcher's environment; 1 and 0 without one. */
int32_t ranks_launched(void);
int32_t ranks_number(void);
/* On all ranks but the first, stdout is discarded: rank 0 prints. */
void ranks_hush(void);

/* Makes the domain of all ranks in `context`. False: the reason in `why`. */
bool ranks_join(mps_context *context, mps_domain **out, char *why, size_t size);
/* Keeps the command line for ranks_same_options. */
void ranks_keep_options(int argc, char **argv);
/* Whether this rank was started with the options of rank 0, but for --threads; else the difference
 * in `why`. Collective. */
bool ranks_same_options(mps_domain *domain, char *why, size_t size);
/* Lets PETSc, by `method` of mps_petsc_method (0: multigrid), solve `equation` of `solver`
 * (mps_linear_equation) on all ranks of its domain, or in one process; *petsc is made at the first
 * call, and destroyed by ranks_drop_solver after the solvers that it is set for. False as above.
 * Collective. */
bool ranks_solve(mps_solver *solver, int32_t equation, int32_t method, void **petsc, char *why,
                 size_t size);
void ranks_drop_solver(void **petsc);
/* Threads for this rank: the processors that it may use, divided by the number of ranks of its node
 * that may use the same ones. Collective. */
mps_status ranks_threads(mps_domain *domain, int64_t *threads);
