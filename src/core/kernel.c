/* kernel.c - weight functions: w = re/r - 1, Yoshida (A8), and its lattice density, Yoshida (A9).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "internal.h"

#include "retain.h"

struct mps_kernel {
  mps_context *context;
  mps_kernel_kind kind;
  double radius;
  atomic_int references;
};

mps_status mps_kernel_create(mps_context *context, mps_kernel_kind kind, double radius,
                             mps_kernel **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (kind != MPS_KERNEL_MPS)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "kind is %d, allowed is 0 (MPS: re/r - 1)", (int)kind);
  if (!isfinite(radius) || radius <= 0.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "radius of influence is %g m, must be finite and > 0", radius);
  mps_kernel *kernel = mpsi_alloc(context, 1, sizeof *kernel);
  if (!kernel) return mpsi_fail_memory(context, __func__, sizeof *kernel);
  kernel->context = mpsi_context_retain(context);
  kernel->kind = kind;
  kernel->radius = radius;
  atomic_init(&kernel->references, 1);
  *out = kernel;
  return MPS_OK;
}

mps_kernel *mpsi_kernel_retain(mps_kernel *kernel) {
  atomic_fetch_add(&kernel->references, 1);
  return kernel;
}

void mps_kernel_destroy(mps_kernel **kernel) {
  if (!kernel || !*kernel) return;
  mps_kernel *k = *kernel;
  *kernel = NULL;
  if (atomic_fetch_sub(&k->references, 1) != 1) return;
  mps_context *context = k->context;
  mpsi_free(context, k);
  mpsi_context_release(context);
}

double mps_kernel_radius(const mps_kernel *kernel) { return kernel ? kernel->radius : 0.0; }

double mps_kernel_weight(const mps_kernel *kernel, double r) {
  if (!kernel || !(r > 0.0) || r >= kernel->radius) return 0.0;
  return kernel->radius / r - 1.0;
}

mps_status mps_kernel_density(mps_context *context, const mps_kernel *kernel, int32_t dim,
                              double spacing, double *out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!kernel || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     kernel ? "out" : "kernel");
  if (dim != 2 && dim != 3)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "dim is %d, must be 2 or 3", dim);
  if (!isfinite(spacing) || spacing <= 0.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "spacing is %g m, must be finite and > 0", spacing);
  const double ratio = kernel->radius / spacing;
  if (ratio > 1000.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "radius/spacing is %g, must be at most 1000", ratio);
  const int m = (int)ratio + 1, mz = dim == 3 ? m : 0;
  double sum = 0.0;
  for (int k = -mz; k <= mz; k++)
    for (int j = -m; j <= m; j++)
      for (int i = -m; i <= m; i++)
        sum += mps_kernel_weight(kernel, spacing * sqrt((double)(i * i + j * j + k * k)));
  *out = sum;
  return MPS_OK;
}
