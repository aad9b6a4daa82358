/* mps/dynamics_limit.h - the stability limit of the time step of explicit elastodynamics: an
 * estimate, the limit by linear theory, and its prediction without a model.
 *
 * Thread rule: as mps/dynamics.h, which includes this header.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_DYNAMICS_LIMIT_H
#define LIBMPS_DYNAMICS_LIMIT_H

#include "dynamics.h"

MPS_EXTERN_C_BEGIN

/** A stable time step (s) at once: the linear limit where it is known, else a lower bound of it
 *  from the stiffest and lightest material on a lattice, at most a quarter below it where all
 *  ground is alike. NaN: not known off a lattice before mps_dynamics_find_limit; 0: Euler,
 *  likewise. */
MPS_API double mps_dynamics_limit(const mps_dynamics *dynamics);

/** Limit by linear theory: the highest eigenfrequency of the tangent at the reference state. */
typedef struct mps_dynamics_linear_limit {
  double dt;       /* largest stable step, s; Euler without damping: 0 unless `duration` was given;
                      infinite where no relative motion is possible */
  double omega;    /* highest eigenfrequency of the undamped set, rad/s */
  double residual; /* relative bound on the error of omega^2 */
  int64_t iterations;
} mps_dynamics_linear_limit;

/** No time stepping: Lanczos iteration on the tangent with the present boundaries; damping may
 *  differ from particle to particle. Costs from some tens to a few thousand steps, once as long as
 *  nothing changes. `duration` (s, >= 0): for Euler, which has no limit without damping but grows
 *  slowly, the largest step (up to 4/omega) whose amplification over `duration` stays below 1e15;
 *  0: the asymptotic limit. Other integrators ignore it. MPS_ERROR_ARGUMENT: `duration` below 0 or
 *  not finite; MPS_ERROR_NUMERIC: no convergence; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_find_limit_sized(mps_dynamics *dynamics,
                                                               double duration,
                                                               mps_dynamics_linear_limit *out,
                                                               size_t size);
static inline mps_status mps_dynamics_find_limit(mps_dynamics *dynamics, double duration,
                                                 mps_dynamics_linear_limit *out) {
  return mps_dynamics_find_limit_sized(dynamics, duration, out, sizeof *out);
}

/** Input of mps_dynamics_predict: uniform ground, without particles. */
typedef struct mps_dynamics_predict_def {
  uint32_t struct_size;
  int32_t integrator; /* MPS_DYNAMICS_INTEGRATOR_VERLET (default) or _LEAPFROG */
  double spacing;     /* D = 2R, m */
  double shear_velocity, pressure_velocity; /* m/s */
  double damping;                           /* h, >= 0; default 0 */
  double f1, f2;                            /* Hz; default 1 and 14 */
  double radius_ratio;                      /* default 1.5 */
} mps_dynamics_predict_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_dynamics_predict_def_init(mps_dynamics_predict_def *def, size_t size);
static inline mps_dynamics_predict_def mps_dynamics_predict_defaults(void) {
  mps_dynamics_predict_def def;
  memset(&def, 0, sizeof def);
  if (mps_dynamics_predict_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_dynamics_prediction {
  double dt;    /* s: a stable time step by linear theory, edges of a body allowed for */
  double omega; /* rad/s, highest eigenfrequency of the infinite lattice */
} mps_dynamics_prediction;

/** Stable time step of a body of uniform ground by linear theory, without a solver.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_predict_sized(mps_context *context,
                                                            const mps_dynamics_predict_def *def,
                                                            mps_dynamics_prediction *out,
                                                            size_t size);
static inline mps_status mps_dynamics_predict(mps_context *ctx, const mps_dynamics_predict_def *def,
                                              mps_dynamics_prediction *out) {
  return mps_dynamics_predict_sized(ctx, def, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
