/* context.h - in the place, with the guard and the type of MPSolve's header of that name.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_CONTEXT_H
#define MPS_CONTEXT_H

#ifdef __cplusplus
extern "C" {
#endif

struct mps_context {
  int degree;
};
typedef struct mps_context mps_context;

mps_context *mps_context_new(void);
int mps_context_get_degree(mps_context *context);
void mps_context_free(mps_context *context);

#ifdef __cplusplus
}
#endif

#endif
