/* mps/mpm_settle.h - static equilibrium of WLS-MPM: ground that settles under its weight or a load,
 * in far fewer steps than a slow loading takes.
 *
 * The particles swing towards equilibrium, and stop whenever their kinetic energy has passed a peak
 * (dynamic relaxation with kinetic damping). Everything is as in a step of mps_mpm_step but for
 * this: the time stands still, so signals of loads keep their value; boundaries and bodies in
 * contact are at rest, whatever drives them. Reactions are those of the last step; impulses, works,
 * the budget and mps_mpm_steps go on. Laws whose stress depends on the rate of strain see the rates
 * of this motion, which are not those of the real one.
 *
 * Thread rule: as mps/mpm.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MPM_SETTLE_H
#define LIBMPS_MPM_SETTLE_H

#include "mpm.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_mpm_settle_def {
  uint32_t struct_size;
  int32_t reserved;
  int64_t max_steps; /* >= 1; default 20000 */
  double tolerance;  /* largest `unbalanced` of mps_mpm_settled, in (0, 1); NaN (default): 1e-3 */
} mps_mpm_settle_def;

MPS_API mps_status mps_mpm_settle_def_init(mps_mpm_settle_def *def, size_t size);
static inline mps_mpm_settle_def mps_mpm_settle_defaults(void) {
  mps_mpm_settle_def def;
  memset(&def, 0, sizeof def);
  if (mps_mpm_settle_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Where it ended. */
typedef struct mps_mpm_settled {
  int64_t steps, peaks; /* steps taken, in all calls that went on from one another; how often the
                           particles were stopped */
  double unbalanced;    /* sum over the nodes of the size of the force that nothing balances, over
                           `applied`; components that a boundary prescribes do not count */
  double applied;       /* N, sum of the sizes of gravity and loads on the particles, and of the
                           forces of boundaries and bodies on the nodes */
  double kinetic;       /* J, of the nodes in the last step */
} mps_mpm_settled;

/** Stops the particles and takes steps until two things are true of one that starts from rest:
 *  `unbalanced` is within the tolerance, and it was so in the step before. Then all velocities and
 *  their gradients are 0. Progress is told every 100 steps, the cancel hook asked after each.
 *  `def` NULL: the defaults; `out` may be NULL. MPS_ERROR_CANCELLED: the particles are left as they
 *  swing, `out` is written, and another call goes on, as does one after a rollback or a restore to
 *  this state: in the end all is as if nothing had cut it, the counts of `out` too. Where a step of
 *  mps_mpm_step or mps_mpm_run comes first, the particles stop before it. MPS_ERROR_NUMERIC: not
 *  within `max_steps`, as where ground flows; the particles stay where they are, at rest, and `out`
 *  is written: another call goes on from there. MPS_ERROR_UNSUPPORTED: a body in contact moves
 *  freely. MPS_ERROR_STATE: no particles, and so no dt. MPS_ERROR_DIVERGED as of mps_mpm_step. */
MPS_API MPS_NODISCARD mps_status mps_mpm_settle_sized(mps_mpm *mpm, const mps_mpm_settle_def *def,
                                                      mps_mpm_settled *out, size_t size);
static inline mps_status mps_mpm_settle(mps_mpm *mpm, const mps_mpm_settle_def *def,
                                        mps_mpm_settled *out) {
  return mps_mpm_settle_sized(mpm, def, out, out ? sizeof *out : 0);
}

MPS_EXTERN_C_END
#endif
