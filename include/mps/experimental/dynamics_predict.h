/* mps/experimental/dynamics_predict.h - the stable time step of explicit elastodynamics predicted
 * by linear theory, without a model.
 *
 * Thread rule: one thread at a time per context.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_DYNAMICS_PREDICT_H
#define LIBMPS_EXPERIMENTAL_DYNAMICS_PREDICT_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../dynamics.h"

MPS_EXTERN_C_BEGIN

/** Input of mps_dynamics_predict: uniform ground, without particles. */
typedef struct mps_dynamics_predict_def {
  uint32_t struct_size;
  int32_t integrator; /* MPS_DYNAMICS_INTEGRATOR_VERLET (default) or _LEAPFROG */
  double spacing;     /* D, m, between particles, 1e-9 to 1e9; no default */
  double shear_velocity, pressure_velocity; /* m/s, 1e-6 to 1e9, the second at least sqrt(2) times
                                               the first; no default */
  double damping;      /* h of Rayleigh damping, as a fraction of critical, 0 to 1000; default 0 */
  double f1, f2;       /* Hz, 1e-20 to 1e9: where the damping ratio is h; default 1 and 14 */
  double radius_ratio; /* radius of influence over spacing, above 1 to 4; default 1.5 */
} mps_dynamics_predict_def;

static inline mps_dynamics_predict_def mps_dynamics_predict_defaults(void) {
  mps_dynamics_predict_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_DYNAMICS_PREDICT, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_dynamics_prediction {
  double dt;    /* s: a stable time step by linear theory, edges of a body allowed for */
  double omega; /* rad/s, highest eigenfrequency of the infinite lattice */
} mps_dynamics_prediction;

/** Stable time step of a body of uniform ground by linear theory, without a solver.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range, or a `size` unknown to this library;
 *  MPS_ERROR_NUMERIC: the result is beyond double precision, or no particle is within the radius. */
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
