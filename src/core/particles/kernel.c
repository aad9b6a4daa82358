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
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (kind < MPS_KERNEL_MPS || kind > MPS_KERNEL_SMOOTH)
    return mpsi_fail(
        context, __func__, MPS_ERROR_ARGUMENT,
        "kind is %d, allowed are 0 (re/r - 1), 1 and 2 (quadratic and cubic B-spline) and "
        "3 (smooth)",
        kind);
  const mps_status status =
      mpsi_check_range(context, __func__, "radius of influence", radius, MPSI_RANGE_SPACING);
  if (status != MPS_OK) return status;
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

double mps_kernel_weight(const mps_kernel *kernel, double r) {
  if (!kernel || !(r >= 0.0) || r >= kernel->radius) return 0.0;
  if (kernel->kind == MPS_KERNEL_MPS) return r > 0.0 ? kernel->radius / r - 1.0 : 0.0;
  if (kernel->kind == MPS_KERNEL_SMOOTH) return smooth(r / kernel->radius);
  const double s = r / node_distance(kernel);
  if (kernel->kind == MPS_KERNEL_SPLINE2)
    return s < 0.5 ? 0.75 - s * s : 0.5 * (1.5 - s) * (1.5 - s);
  return s < 1.0 ? 2.0 / 3.0 - s * s + 0.5 * s * s * s : (2.0 - s) * (2.0 - s) * (2.0 - s) / 6.0;
}

double mps_kernel_derivative(const mps_kernel *kernel, double r) {
  if (!kernel || !(r > 0.0) || r >= kernel->radius) return 0.0;
  if (kernel->kind == MPS_KERNEL_MPS) return -kernel->radius / (r * r);
  if (kernel->kind == MPS_KERNEL_SMOOTH) {
    const double q = r / kernel->radius, a = 1.0 - q;
    return -20.0 * q * a * a * a / kernel->radius;
  }
  const double h = node_distance(kernel), s = r / h;
  if (kernel->kind == MPS_KERNEL_SPLINE2) return (s < 0.5 ? -2.0 * s : s - 1.5) / h;
  return (s < 1.0 ? 1.5 * s * s - 2.0 * s : -0.5 * (2.0 - s) * (2.0 - s)) / h;
}

/* Five Gauss points on each of a spline's two pieces: exact up to degree 9. */
static double spline_moment(const mps_kernel *kernel, int32_t power) {
  static const double point[3] = {0.0, 0.53846931010568309, 0.90617984593866399};
  static const double weight[3] = {0.56888888888888889, 0.47862867049936647, 0.23692688505618909};
  const double h = node_distance(kernel), joint = kernel->kind == MPS_KERNEL_SPLINE2 ? 0.5 * h : h;
  double sum = 0.0;
  for (int piece = 0; piece < 2; piece++) {
    const double a = piece ? joint : 0.0, b = piece ? kernel->radius : joint;
    for (int k = -2; k <= 2; k++) {
      const double r = 0.5 * (a + b) + 0.5 * (b - a) * (k < 0 ? -point[-k] : point[k]);
      sum += 0.5 * (b - a) * weight[k < 0 ? -k : k] * mps_kernel_weight(kernel, r) * pow(r, power);
    }
  }
  return sum;
}

/* Integral of (1 - q)^4 (1 + 4 q) q^(n - 1) from 0 to 1: B(n, 5) + 4 B(n + 1, 5). */
static double smooth_moment(int32_t n) {
  const double beta = 24.0 / ((double)n * (n + 1) * (n + 2) * (n + 3) * (n + 4));
  return beta * (1.0 + 4.0 * n / (n + 5.0));
}

mps_status mps_kernel_moment(mps_context *context, const mps_kernel *kernel, int32_t dim,
                             int32_t order, double *out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!kernel || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     kernel ? "out" : "kernel");
  if (dim < 1 || dim > 3 || order < 0 || order > 4)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "dim is %d and order %d, allowed are 1 to 3 and 0 to 4", dim, order);
  const double pi = 3.14159265358979323846, sphere[3] = {2.0, 2.0 * pi, 4.0 * pi};
  const int32_t n = dim + order;
  if (kernel->kind == MPS_KERNEL_MPS && n == 1)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "the integral of re/r - 1 over a line diverges: dim is 1 and order 0");
  double radial;
  if (kernel->kind == MPS_KERNEL_MPS)
    radial = pow(kernel->radius, n) / ((double)n * (n - 1));
  else if (kernel->kind == MPS_KERNEL_SMOOTH)
    radial = pow(kernel->radius, n) * smooth_moment(n);
  else
    radial = spline_moment(kernel, n - 1);
  *out = sphere[dim - 1] * radial;
  return MPS_OK;
}

mps_status mps_kernel_density(mps_context *context, const mps_kernel *kernel, int32_t dim,
                              double spacing, double *out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!kernel || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     kernel ? "out" : "kernel");
  if (dim != 2 && dim != 3)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "dim is %d, must be 2 or 3", dim);
  const mps_status status =
      mpsi_check_range(context, __func__, "spacing", spacing, MPSI_RANGE_SPACING);
  if (status != MPS_OK) return status;
  const double ratio = kernel->radius / spacing;
  if (ratio > 1000.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "radius/spacing is %g, must be at most 1000", ratio);
  const int m = (int)ratio + 1, mz = dim == 3 ? m : 0;
  double sum = 0.0;
  for (int k = -mz; k <= mz; k++) {
    if (dim == 3 && mpsi_cancelled(context)) /* 1000 spacings take half a minute */
      return mpsi_fail(context, __func__, MPS_ERROR_CANCELLED, "stopped by the cancel hook");
    for (int j = -m; j <= m; j++) {
      const int beside = m * m - j * j - k * k,
                reach = beside > 0 ? (int)sqrt((double)beside) + 1 : 0;
      for (int i = -reach; i <= reach; i++)
        if (i != 0 || j != 0 || k != 0)
          sum += mps_kernel_weight(kernel, spacing * sqrt((double)(i * i + j * j + k * k)));
    }
  }
  *out = sum;
  return MPS_OK;
}
