/* mps/experimental/settle.h - static equilibrium of WLS-MPM: ground that settles under its weight
 * or a load, in far fewer steps than a slow loading takes.
 *
 * The particles oscillate about equilibrium, and are stopped when their kinetic energy has passed a
 * peak (dynamic relaxation with kinetic damping). Steps are those of mps_mpm_step, with these
 * differences: the time is constant, so signals of loads keep their value; boundaries and bodies in
 * contact are at rest, also driven ones; implicit pressures of undrained pore water are found as
 * explicit ones, with the shorter steps of these. Reactions are those of the last step; impulses,
 * works, the budget and mps_mpm_steps continue. Laws whose stress depends on the rate of strain see
 * the rates of this motion, which are not those of the real one. Ground that fails comes to rest
 * too, where it has flowed to: displacements show whether it stood.
 *
 * Thread rule: as mps/mpm.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_SETTLE_H
#define LIBMPS_EXPERIMENTAL_SETTLE_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../mpm.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_mpm_settle_def {
  uint32_t struct_size;
  int32_t reserved;
  int64_t max_steps; /* >= 1; default 20000 */
  double tolerance;  /* largest `unbalanced` of mps_mpm_settled, in (0, 1); NaN (default): 1e-3 */
} mps_mpm_settle_def;

static inline mps_mpm_settle_def mps_mpm_settle_defaults(void) {
  mps_mpm_settle_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MPM_SETTLE, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Result of mps_mpm_settle. */
typedef struct mps_mpm_settled {
  int64_t steps, peaks; /* steps taken, in all calls that continue one another; number of times the
                           particles were stopped */
  double unbalanced;    /* sum over the nodes of the size of the unbalanced force, over `applied`;
                           without components that a boundary prescribes */
  double applied;       /* N, sum of the sizes of gravity and loads on the particles, and of the
                           forces of boundaries and bodies on the nodes */
  double kinetic;       /* J, of the nodes in the last step */
} mps_mpm_settled;

/** Stops the particles and takes steps until `unbalanced` is within the tolerance in a step that
 *  starts from rest and in the step before it. Then all velocities and their gradients are 0. The
 *  progress hook is called every 100 steps, the cancel hook after each. `def` NULL: the defaults;
 *  `out` may be NULL. MPS_ERROR_CANCELLED: the particles stay in motion, `out` is written, and
 *  another call continues, also after a rollback or a restore to this state, with the same result
 *  as an uninterrupted call, the counts of `out` included. If mps_mpm_step or mps_mpm_run is called
 *  first, the particles are stopped before it. MPS_ERROR_NUMERIC: not within `max_steps`, as where
 *  ground flows; the particles stay at rest at their present positions, and `out` is written:
 *  another call continues from there. MPS_ERROR_UNSUPPORTED: a body in contact moves freely, or
 *  pore water flows (mps/experimental/pore_water.h). MPS_ERROR_STATE: no particles, and so no dt.
 *  MPS_ERROR_DIVERGED as of mps_mpm_step. */
MPS_API MPS_NODISCARD mps_status mps_mpm_settle_sized(mps_mpm *mpm, const mps_mpm_settle_def *def,
                                                      mps_mpm_settled *out, size_t size);
static inline mps_status mps_mpm_settle(mps_mpm *mpm, const mps_mpm_settle_def *def,
                                        mps_mpm_settled *out) {
  return mps_mpm_settle_sized(mpm, def, out, out ? sizeof *out : 0);
}

MPS_EXTERN_C_END
#endif
