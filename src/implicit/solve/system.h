/* system.h - factor, solve, refine: (K + shift M)^-1.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* ---- system.c -------------------------------------------------------------------------------- */
mps_status mpsi_elastic_prepare(mps_elastic *e, const char *function);
/* Makes sure that the factor is that of K + shift * M. */
mps_status mpsi_elastic_factor(mps_elastic *e, const char *function, double shift);
/* solution = (K + shift M)^-1 rhs for `count` right-hand sides, free unknowns. */
mps_status mpsi_elastic_backsolve(mps_elastic *e, const char *function, int64_t count,
                                  const double *rhs, double *solution);
/* Vectors of `count` cases in the set's present order, three components a particle. */
void mpsi_elastic_to_caller(const mps_elastic *e, int64_t count, double *ours, double *out);
