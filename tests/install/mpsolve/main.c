/* main.c - one source that uses MPSolve and libmps. Both have <mps/context.h>: the compiler
 * searches MPSolve's directory first, and the headers of libmps name one another relatively to
 * themselves. SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mps.h> /* MPSolve's */

#include <mps/dynamics.h>
#include <mps/mpm.h>

#include <stdio.h>

int main(void) {
  char text[256] = "";
  mps_context *context = NULL;
  const mps_status status = mps_context_create(NULL, &context, text, sizeof text);
  mps_context_destroy(&context);

  mps_context *polynomials = mps_context_new();
  const int degree = polynomials ? mps_context_get_degree(polynomials) : 0;
  if (polynomials) mps_context_free(polynomials);
  printf("libmps %s %s, a polynomial of degree %d\n", mps_version(), text, degree);
  return status == MPS_OK && degree == 3 ? 0 : 1;
}
