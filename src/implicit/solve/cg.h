/* cg.h - conjugate gradients without a matrix.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

#include <stdbool.h>

#define MPSI_CG_PATIENCE 2000

/* ---- cg.c ------------------------------------------------------------------------------------ */
/* solution = (K + shift M)^-1 rhs. MPS_ERROR_NUMERIC where it does not converge; where `good` is
 * not NULL, it says whether it has after MPSI_CG_PATIENCE iterations, and of a matrix that is not
 * positive definite nothing else is said. */
mps_status mpsi_elastic_cg(mps_elastic *e, const char *function, double shift, const double *rhs,
                           double *solution, bool *good);
