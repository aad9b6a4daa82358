/* same.h - two sets of particles have the same fields, bit for bit: of a run that was cut and one
 * that was not, of other threads, of ranks. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_KIT_SAME_H
#define MPS_TEST_KIT_SAME_H

#include "test_common.h"

/* In the same order. `what` begins the message of a failure. */
void assert_same_rows(mps_particles *a, mps_particles *b, const char *what);

/* Each particle by its id, whatever the orders. */
void assert_same_by_id(mps_particles *a, mps_particles *b, const char *what);

#endif
