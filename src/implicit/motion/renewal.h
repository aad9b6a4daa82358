/* renewal.h - forces at the start of a step, with the present moduli and boundaries.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* inner = K (u + a1 v); held = inner + a0 M v - load along fixed directions. */
mps_status mpsi_elastic_find_forces(mps_elastic *e, const char *function, const double *u,
                                    const double *v, double *inner, double *held);
/* a = M^-1 (F - C v - K u) along free directions; that of the boundaries along fixed ones. */
void mpsi_elastic_balance(mps_elastic *e);
/* Before a step: the forces at its beginning, with the present moduli and boundaries. */
mps_status mpsi_elastic_renew_motion(mps_elastic *e, const char *function);
