/* kernel.c - weight functions: w = re/r - 1, Yoshida (A8), the B-splines of grids, Nakamura (36),
 * the smooth one of the fluid, and the density of a lattice, Yoshida (A9).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

#include "core/base/ranges.h"
#include "core/context/retain.h"

struct mps_kernel {
  mps_context *context;
  int32_t kind;
  double radius;
  atomic_int references;
};

mps_status mps_kernel_create(mps_context *context, int32_t kind, double radius, mps_kernel **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (kind < MPS_KERNEL_MPS || kind > MPS_KERNEL_SMOOTH)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "kind is %d, allowed are MPS_KERNEL_MPS, _SPLINE2, _SPLINE3 and _SMOOTH",
                     kind);
  MPSI_TRY(mpsi_check_range(context, __func__, "radius of influence", radius, MPSI_RANGE_SPACING));
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

int32_t mps_kernel_get_kind(const mps_kernel *kernel) { return kernel ? kernel->kind : -1; }

/* Distance between the nodes of a spline's grid. */
static double node_distance(const mps_kernel *k) {
  return k->radius / (k->kind == MPS_KERNEL_SPLINE2 ? 1.5 : 2.0);
}

/* (1 - q)^4 (1 + 4 q), q = r/re. */
static double smooth(double q) {
  const double a = (1.0 - q) * (1.0 - q);
  return a * a * (1.0 + 4.0 * q);
}

#define NEAREST 1e-130 /* m: re/r - 1 and its derivative stay numbers */

double mps_kernel_weight(const mps_kernel *kernel, double r) {
  if (!kernel || !(r >= 0.0) || r >= kernel->radius) return 0.0;
  if (kernel->kind == MPS_KERNEL_MPS)
    return r > 0.0 ? kernel->radius / fmax(r, NEAREST) - 1.0 : 0.0;
  if (kernel->kind == MPS_KERNEL_SMOOTH) return smooth(r / kernel->radius);
  const double s = r / node_distance(kernel);
  if (kernel->kind == MPS_KERNEL_SPLINE2)
    return s < 0.5 ? 0.75 - s * s : 0.5 * (1.5 - s) * (1.5 - s);
  return s < 1.0 ? 2.0 / 3.0 - s * s + 0.5 * s * s * s : (2.0 - s) * (2.0 - s) * (2.0 - s) / 6.0;
}

double mps_kernel_derivative(const mps_kernel *kernel, double r) {
  if (!kernel || !(r > 0.0) || r >= kernel->radius) return 0.0;
  if (kernel->kind == MPS_KERNEL_MPS) {
    const double apart = fmax(r, NEAREST);
    return -kernel->radius / (apart * apart);
  }
  if (kernel->kind == MPS_KERNEL_SMOOTH) {
    const double q = r / kernel->radius, a = 1.0 - q;
    return -20.0 * q * a * a * a / kernel->radius;
  }
  const double h = node_distance(kernel), s = r / h;
  if (kernel->kind == MPS_KERNEL_SPLINE2) return (s < 0.5 ? -2.0 * s : s - 1.5) / h;
  return (s < 1.0 ? 1.5 * s * s - 2.0 * s : -0.5 * (2.0 - s) * (2.0 - s)) / h;
}

double mpsi_kernel_density(const mps_kernel *kernel, double spacing) {
  const int m = (int)(kernel->radius / spacing) + 1;
  double sum = 0.0;
  for (int j = -m; j <= m; j++) {
    const int beside = m * m - j * j, reach = beside > 0 ? (int)sqrt((double)beside) + 1 : 0;
    for (int i = -reach; i <= reach; i++)
      if (i != 0 || j != 0)
        sum += mps_kernel_weight(kernel, spacing * sqrt((double)(i * i + j * j)));
  }
  return sum;
}
