/* main.c - a user's program, in the common part of C and C++: it makes a context and a kernel and
 * compares one value with its closed form.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/context.h>
#include <mps/kernel.h>

#include <math.h>
#include <stdio.h>

int main(void) {
  mps_context *context = NULL;
  mps_kernel *kernel = NULL;
  char text[256] = "";
  double n0 = 0.0;
  if (mps_context_create(NULL, &context, text, sizeof text) != MPS_OK) {
    fprintf(stderr, "%s\n", text);
    return 1;
  }
  mps_status status = mps_kernel_create(context, MPS_KERNEL_MPS, 1.5, &kernel);
  if (status == MPS_OK) n0 = 4.0 * (mps_kernel_weight(kernel, 1.0) + mps_kernel_weight(kernel, sqrt(2.0)));
  if (status != MPS_OK) fprintf(stderr, "%s\n", mps_context_error(context)->message);
  mps_kernel_destroy(&kernel);
  mps_context_destroy(&context);

  /* Four neighbours at distance 1 and four at sqrt(2), weight 1.5/r - 1. */
  const double expected = 4.0 * 0.5 + 4.0 * (1.5 / sqrt(2.0) - 1.0);
  printf("libmps %s: n0 = %.15g, expected %.15g\n", mps_version(), n0, expected);
  return status == MPS_OK && fabs(n0 - expected) < 1e-14 ? 0 : 1;
}
