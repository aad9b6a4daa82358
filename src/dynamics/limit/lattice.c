/* lattice.c - the stable time step of uniform ground without any particles, by linear theory on the
 * infinite lattice.
 *
 * On the infinite square lattice the tangent has plane waves exp(i k.x): a Hermitian 3 x 3 problem
 * for each wave vector. Its highest eigenvalue over all wave vectors bounds the scheme. For Vp/Vs
 * below about 3.7 it is the spin mode k = 0: w^2 = 24 Vs^2/D^2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "lattice.h"
#include "dynamics/base/dynamics_solver.h"

#include <mps/experimental/dynamics_predict.h>

#define WAVES 96 /* wave vectors a direction in [0, pi/D] */
/* A body has edges, where neighbours are missing. The spin mode has a lower frequency there; modes
 * of volume change have higher ones, most in a strip two or three particles thick: measured over
 * all strips and Vp/Vs up to 50, by 5.3 % for re = 1.5 D and 13.3 % at most for others, nothing
 * below Vp = 3.4 Vs. */
static double edge_factor(const mps_dynamics_predict_def *def) {
  if (def->pressure_velocity <= 3.3 * def->shear_velocity) return 1.0;
  return def->radius_ratio <= 1.5 ? 1.06 : 1.14;
}

/* Symbol of the tangent at wave numbers (a, b)/D, with lengths in D and velocities in Vs: real
 * after the displacements are turned by i. m is symmetric: x, y, spin. */
typedef struct symbol {
  double xx, yy, xy, xs, ys, ss;
} symbol;

/* Weight at the distance r, in spacings; of re/r - 1 where `kernel` is NULL. */
static double weight(const mps_kernel *kernel, double ratio, double r) {
  if (mps_kernel_get_kind(kernel) <= MPS_KERNEL_MPS) return ratio / r - 1.0;
  return mps_kernel_weight(kernel, r * mps_kernel_radius(kernel) / ratio);
}

static symbol lattice_symbol(const mps_kernel *kernel, double ratio, double density, double lambda,
                             double inertia, double a, double b) {
  const double d = 2.0;
  const int reach = (int)ceil(ratio);
  symbol m = {0};
  double gx = 0.0, gy = 0.0; /* divergence operator: (d/n0) sum w/r0 e sin(k.r0) */
  for (int i = -reach; i <= reach; i++)
    for (int j = -reach; j <= reach; j++) {
      const double r2 = i * i + j * j, r = sqrt(r2);
      if (r2 == 0.0 || r >= ratio * (1.0 - 1e-9)) continue;
      const double w = weight(kernel, ratio, r), phase = a * i + b * j;
      const double stiff = 4.0 * d / density * w / r2;
      /* u = (U_j - U_i) - 1/2 (th_i + th_j) (-r0y, r0x) */
      m.xx += stiff * (1.0 - cos(phase));
      m.yy += stiff * (1.0 - cos(phase));
      m.xs += stiff * 0.5 * sin(phase) * j;
      m.ys -= stiff * 0.5 * sin(phase) * i;
      m.ss += stiff * 0.25 * (1.0 + cos(phase)) * r2;
      gx += d / density * w / r2 * i * sin(phase);
      gy += d / density * w / r2 * j * sin(phase);
    }
  m.xx += lambda * gx * gx;
  m.yy += lambda * gy * gy;
  m.xy += lambda * gx * gy;
  m.xs /= sqrt(inertia);
  m.ys /= sqrt(inertia);
  m.ss /= inertia;
  return m;
}

/* Highest eigenvalue of a symmetric 3 x 3 matrix (trigonometric solution of its cubic). */
static double highest(symbol m) {
  const double mean = (m.xx + m.yy + m.ss) / 3.0;
  const double x = m.xx - mean, y = m.yy - mean, s = m.ss - mean;
  const double q = (x * x + y * y + s * s + 2.0 * (m.xy * m.xy + m.xs * m.xs + m.ys * m.ys)) / 6.0;
  if (q <= 0.0) return mean;
  const double det =
      x * (y * s - m.ys * m.ys) - m.xy * (m.xy * s - m.ys * m.xs) + m.xs * (m.xy * m.ys - y * m.xs);
  const double c = fmax(-1.0, fmin(1.0, 0.5 * det / (q * sqrt(q))));
  return mean + 2.0 * sqrt(q) * cos(acos(c) / 3.0);
}

double mpsi_dynamics_lattice_omega2(const mps_kernel *kernel, double spacing, double radius_ratio,
                                    double vs, double vp, double torque) {
  const double pi = 3.14159265358979323846;
  const double lambda = fmax(0.0, vp * vp / (vs * vs) - 2.0);
  const double inertia = 1.0 / (6.0 * torque);
  const int reach = (int)ceil(radius_ratio);
  double n0 = 0.0, most = 0.0;
  for (int i = -reach; i <= reach; i++)
    for (int j = -reach; j <= reach; j++) {
      const double r = sqrt((double)(i * i + j * j));
      if (r > 0.0 && r < radius_ratio * (1.0 - 1e-9)) n0 += weight(kernel, radius_ratio, r);
    }
  for (int i = 0; i <= WAVES; i++) /* the lattice is symmetric in x, y and x <-> y */
    for (int j = 0; j <= i; j++)
      most = fmax(most, highest(lattice_symbol(kernel, radius_ratio, n0, lambda, inertia,
                                               pi * i / WAVES, pi * j / WAVES)));
  return most * vs * vs / (spacing * spacing);
}

double mpsi_dynamics_damped_limit(double omega2, double alpha, double beta) {
  const double b = beta + alpha / omega2;
  return 4.0 / omega2 / (b + sqrt(b * b + 4.0 / omega2)); /* without cancellation */
}

mps_status mps_dynamics_predict_sized(mps_context *context,
                                      const mps_dynamics_predict_def *user_def,
                                      mps_dynamics_prediction *out, size_t size) {
  static const char *const function = "mps_dynamics_predict";
  if (!context) return mpsi_null(__func__, "context");
  mps_dynamics_predict_def def;
  MPSI_TRY(MPSI_DEF_READ(context, function, mps_dynamics_predict_def, user_def, &def));
  const double pi = 3.14159265358979323846, h = def.damping;
  const double omega2 = mpsi_dynamics_lattice_omega2(
      NULL, def.spacing, def.radius_ratio, def.shear_velocity, def.pressure_velocity, 1.0);
  mps_dynamics_prediction p = {.omega = sqrt(omega2)};
  const double edge = edge_factor(&def) * p.omega;
  p.dt = mpsi_dynamics_damped_limit(edge * edge, h * 4.0 * pi * def.f1 * def.f2 / (def.f1 + def.f2),
                                    h / (pi * (def.f1 + def.f2)));
  if (!(isfinite(p.omega) && p.omega > 0.0 && isfinite(p.dt) && p.dt > 0.0))
    return mpsi_fail(context, function, MPS_ERROR_NUMERIC,
                     "omega is %g rad/s and dt %g s with radius_ratio %.12g, velocities %g and %g "
                     "m/s and spacing %g m: beyond double precision",
                     p.omega, p.dt, def.radius_ratio, def.shear_velocity, def.pressure_velocity,
                     def.spacing);
  return mpsi_out_write(context, function, out, size, &p, sizeof p);
}
