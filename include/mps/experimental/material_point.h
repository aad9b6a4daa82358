/* mps/experimental/material_point.h - constitutive laws at one point: a law called by hand, a point
 * driven along a path of strain or of stress.
 *
 * Thread rule: one thread at a time per context.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_MATERIAL_POINT_H
#define LIBMPS_EXPERIMENTAL_MATERIAL_POINT_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../material_law.h"

MPS_EXTERN_C_BEGIN

/* ---- use without a solver -------------------------------------------------------------------- */

/** Applies one step of the law to a block of particles. MPS_ERROR_ARGUMENT for a malformed block
 * (nothing is changed), or the status of a user's law that fails, MPS_ERROR_NUMERIC where it leaves
 * a value that is not finite; values of other laws are not checked: a NaN stays in its particle.
 * Errors go to `context`, which need not be the material's: threads that update concurrently use a
 * context each. No allocation. */
MPS_API MPS_NODISCARD mps_status mps_material_update(mps_context *context,
                                                     const mps_material *material,
                                                     const mps_material_block *block);

#define MPS_MATERIAL_POINT_HISTORY 1024

/** One particle with its state, to drive a law along a strain path. The history has room for every
 *  law: none has more than MPS_MATERIAL_POINT_HISTORY columns. Frozen layout. */
typedef struct mps_material_point {
  double stress[6];      /* Pa; may be set before the first step */
  double deformation[9]; /* starts as the unit tensor */
  double volume_ratio;   /* starts as 1 */
  double history[MPS_MATERIAL_POINT_HISTORY];
  int64_t flags; /* of the last step */
  double time;   /* s */
} mps_material_point;

/** Sets the state before the first step. MPS_ERROR_ARGUMENT: `material` or `point` is NULL. */
MPS_API MPS_NODISCARD mps_status mps_material_point_init(mps_context *context,
                                                         const mps_material *material,
                                                         mps_material_point *point);
/** `steps` (>= 1) steps of dt = duration/steps (s, > 0) with the constant velocity gradient[3 i +
 *  j] (1/s, finite), always in three dimensions. MPS_ERROR_ARGUMENT: `steps`, `duration` or
 *  `gradient` out of range; MPS_ERROR_NUMERIC: a user's law leaves a value that is not finite; or
 *  the status of that law. */
MPS_API MPS_NODISCARD mps_status mps_material_point_drive(mps_context *context,
                                                          const mps_material *material,
                                                          mps_material_point *point,
                                                          const double gradient[9], double duration,
                                                          int64_t steps);

/* ---- a point along a path of stress and strain ------------------------------------------------
 */

/** Bits of `controlled`, in the order of a stress's components. */
#define MPS_MATERIAL_POINT_XX 1
#define MPS_MATERIAL_POINT_YY 2
#define MPS_MATERIAL_POINT_ZZ 4
#define MPS_MATERIAL_POINT_XY 8
#define MPS_MATERIAL_POINT_ZX 16
#define MPS_MATERIAL_POINT_YZ 32

/** `steps` (>= 1) steps of duration/steps with the velocity gradient[3 i + j] (1/s), of which the
 *  components in `controlled` (bits above) are found such that those components of the stress go in
 *  equal parts from the present values to `target` (6, Pa; others are not read). A controlled shear
 *  strain is symmetric, and adds to `gradient`. `found` (9, 1/s; may be NULL): the gradient of the
 *  last step. MPS_ERROR_ARGUMENT as mps_material_point_drive, and bits or targets out of range;
 *  MPS_ERROR_NUMERIC: no strain gives that stress, as beyond a law's strength; the point is
 *  unchanged then. */
MPS_API MPS_NODISCARD mps_status
mps_material_point_control(mps_context *context, const mps_material *material,
                           mps_material_point *point, const double gradient[9], uint32_t controlled,
                           const double target[6], double duration, int64_t steps, double found[9]);

MPS_EXTERN_C_END
#endif
