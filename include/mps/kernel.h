/* mps/kernel.h - weight functions of the particle methods.
 *
 * A kernel is immutable after creation: it may be shared by objects, contexts and threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_KERNEL_H
#define LIBMPS_KERNEL_H

#include "context.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_kernel mps_kernel;

typedef enum mps_kernel_kind {
  MPS_KERNEL_MPS = 0 /* w(r) = re/r - 1 for 0 < r < re, else 0: Yoshida (A8), Chikazawa (6) */
} mps_kernel_kind;

/** Creates a kernel with radius of influence `radius` (re, m, finite, > 0). */
MPS_API MPS_NODISCARD mps_status mps_kernel_create(mps_context *context, mps_kernel_kind kind,
                                                   double radius, mps_kernel **out);
/** Releases and nulls; accepts NULL. Objects that use the kernel keep their own reference. */
MPS_API void mps_kernel_destroy(mps_kernel **kernel);

/** Radius of influence re (m). */
MPS_API double mps_kernel_radius(const mps_kernel *kernel);
/** w(r), r in m. Zero at r <= 0 and r >= re. */
MPS_API double mps_kernel_weight(const mps_kernel *kernel, double r);
/** Interior particle number density n0 = sum_j w(r0_ij) of the infinite square (dim 2) or cubic
 *  (dim 3) lattice of spacing `spacing` (m, > 0): Yoshida (A9) with the sum over j. */
MPS_API MPS_NODISCARD mps_status mps_kernel_density(mps_context *context, const mps_kernel *kernel,
                                                    int32_t dim, double spacing, double *out);

MPS_EXTERN_C_END
#endif
