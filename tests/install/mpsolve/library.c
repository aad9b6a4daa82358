/* library.c - stands for libmps.so.3 of MPSolve: a context of its own, under MPSolve's names.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mps.h>

#include <stdlib.h>

mps_context *mps_context_new(void) {
  mps_context *context = malloc(sizeof *context);
  if (context) context->degree = 3;
  return context;
}

int mps_context_get_degree(mps_context *context) { return context->degree; }

void mps_context_free(mps_context *context) { free(context); }
