/* cg.h - conjugate gradients without a matrix.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_ELASTIC_CG_H
#define MPSI_ELASTIC_CG_H

#include <mps/elastic.h>

/* ---- cg.c ------------------------------------------------------------------------------------ */
mps_status mpsi_elastic_cg(mps_elastic *e, const char *function, double shift, const double *rhs,
                           double *solution);

#endif
