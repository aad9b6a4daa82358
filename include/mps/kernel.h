/* mps/kernel.h - weight functions of the particle methods.
 *
 * Each solver has a weight function of its own, so that programs need no kernel: one is for another
 * radius or shape, given to a solver's definition, and for evaluations by the caller. A kernel is
 * immutable after creation: it may be shared by objects, contexts and threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_KERNEL_H
#define LIBMPS_KERNEL_H

#include "context.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_kernel mps_kernel;

typedef enum mps_kernel_kind {
  MPS_KERNEL_MPS = 0,     /* w(r) = re/r - 1 for 0 < r < re, else 0: Yoshida (A8), Chikazawa (6) */
  MPS_KERNEL_SPLINE2 = 1, /* quadratic B-spline on nodes h = re/1.5 apart: 3/4 - (r/h)^2, then
                             (3/2 - r/h)^2/2 from r = h/2 on */
  MPS_KERNEL_SPLINE3 = 2, /* cubic B-spline on nodes h = re/2 apart: 2/3 - (r/h)^2 + (r/h)^3/2, then
                             (2 - r/h)^3/6 from r = h on: the weights of a grid, Nakamura (36) */
  MPS_KERNEL_SMOOTH = 3   /* (1 - r/re)^4 (1 + 4 r/re): twice differentiable, of the fluid */
} mps_kernel_kind;

/** Creates a kernel with radius of influence `radius` (re, m, 1e-12 to 1e12). `kind` is an
 *  mps_kernel_kind. MPS_ERROR_ARGUMENT: `kind` or `radius` out of range; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_kernel_create(mps_context *context, int32_t kind,
                                                   double radius, mps_kernel **out);
/** Releases and nulls; accepts NULL. Objects that use the kernel keep their own reference. */
MPS_API void mps_kernel_destroy(mps_kernel **kernel);

/* Queries: thread safe. */

/** mps_kernel_kind, -1 for NULL. */
MPS_API int32_t mps_kernel_get_kind(const mps_kernel *kernel);
/** Radius of influence re (m). */
MPS_API double mps_kernel_radius(const mps_kernel *kernel);
/** w(r), r in m, without a unit. Zero at r >= re and r < 0; re/r - 1 is 0 at r = 0 too: a particle
 *  is not its own neighbour. */
MPS_API double mps_kernel_weight(const mps_kernel *kernel, double r);
/** dw/dr (1/m). Zero where the weight is. */
MPS_API double mps_kernel_derivative(const mps_kernel *kernel, double r);

MPS_EXTERN_C_END
#endif
