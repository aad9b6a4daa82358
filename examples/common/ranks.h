/* ranks.h - a program that mpirun or srun has started as several processes, the ranks of one model:
 * how many there are, what joins them, and threads for each. The library that joins them,
 * libmps-petsc, is loaded only then: without mpirun a program knows neither MPI nor PETSc.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_RANKS_H
#define EXAMPLES_RANKS_H

#include <mps/domain.h>
#include <mps/elastic.h>
#include <mps/fluid.h>

#include <stdbool.h>

/* As the launcher says in the environment; 1 and 0 without one. */
int32_t ranks_launched(void);
int32_t ranks_number(void);
/* On all ranks but the first, stdout goes nowhere: rank 0 speaks. */
void ranks_hush(void);

/* Makes the domain of all ranks in `context`. False: in `why` what is in the way. */
bool ranks_join(mps_context *context, mps_domain **out, char *why, size_t size);
/* Keeps the command line for ranks_same_options. */
void ranks_keep_options(int argc, char **argv);
/* Whether this rank was started with the options of rank 0, but for --threads; else what is not the
 * same in `why`. Collective. */
bool ranks_same_options(mps_domain *domain, char *why, size_t size);
/* Has `elastic` solved by all ranks of its domain, by PETSc's multigrid; *solver is made at the
 * first call, and goes with ranks_drop_solver after all that it solves for. False as above.
 * Collective. */
bool ranks_solve_elastic(mps_context *context, mps_elastic *elastic, void **solver, char *why,
                         size_t size);
/* Has the pressure of `fluid` solved by PETSc, `method` of mps_petsc_method, of one process too.
 * False as above. Collective. */
bool ranks_solve_fluid(mps_context *context, mps_fluid *fluid, int32_t method, void **solver,
                       char *why, size_t size);
void ranks_drop_solver(void **solver);
/* Threads for this rank: the processors that it may use, where others of its node may use the same
 * ones over their number. Collective. */
mps_status ranks_threads(mps_domain *domain, int64_t *threads);

#endif
