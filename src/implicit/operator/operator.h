/* operator.h - K u, matrix free.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#include <mps/elastic.h>

/* f = K u. Collective where the body is shared, and fails only with the domain. */
MPS_NODISCARD mps_status mpsi_elastic_apply(mps_elastic *e, const char *function, const double *u,
                                            double *f);
/* Relative displacement of pair (i, k), conjugate to its stiffness, from u and the gradients. */
void mpsi_elastic_stretch(const mps_elastic *e, const double *u, int64_t i, int32_t k, double *out);
