/* cg.h - conjugate gradients without a matrix.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* ---- cg.c ------------------------------------------------------------------------------------ */
mps_status mpsi_elastic_cg(mps_elastic *e, const char *function, double shift, const double *rhs,
                           double *solution);
