/* world.h - what a test on the ranks that mpirun starts begins and ends with: a context, and the
 * domain of all ranks. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPI_WORLD_H
#define MPS_TEST_MPI_WORLD_H

#include "test_common.h"

#include <mps/experimental/petsc.h>

static mps_context *own;
static mps_domain *domain;

static bool begin_world(void) {
  own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const mps_status status = mps_petsc_domain_create_world(own, &domain);
  if (status != MPS_OK) fprintf(stderr, "no domain: %s\n", mps_status_text(status));
  return status == MPS_OK;
}

static int end_world(int failed) {
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
  return failed;
}

#endif
