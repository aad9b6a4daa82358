/* mps/elastic_motion.h - motions of implicit elasticity in time, their state, and vibration: the
 * matrices of statics with the lumped mass density * cell volume and the damping C = a0 M + a1 K.
 *
 * Thread rule: as mps/elastic.h, which includes this header.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_ELASTIC_MOTION_H
#define LIBMPS_ELASTIC_MOTION_H

#include "elastic.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_elastic_motion_def {
  uint32_t struct_size;
  int32_t reserved;
  double dt;      /* s, 1e-30 to 1e30; no default */
  double rho_inf; /* generalised alpha (Chung and Hulbert): spectral radius at infinite frequency,
                     in [0, 1]; default 1: Newmark's average acceleration, which keeps the energy */
  double beta, gamma;  /* Newmark's, both in place of rho_inf; NaN (default): of rho_inf. gamma in
                          [1/2, 1], beta in [(gamma + 1/2)^2 / 4, 10] */
  double mass_damping; /* a0, 1/s, >= 0; default 0 */
  double stiffness_damping; /* a1, s, >= 0; default 0 */
  double ratio[2]; /* damping ratios in [0, 1) at the two frequencies, in place of a0 and a1, which
                      must result >= 0; NaN (default): none */
  double frequency[2]; /* Hz, > 0, different */
  double time;         /* s, of the start, finite; default 0 */
} mps_elastic_motion_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_elastic_motion_def_init(mps_elastic_motion_def *def, size_t size);
static inline mps_elastic_motion_def mps_elastic_motion_defaults(void) {
  mps_elastic_motion_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_motion_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Begins a motion from the fields `displacement`, `velocity` (0 without) and `density`.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range; MPS_ERROR_FIELD: no field `density`;
 *  MPS_ERROR_NUMERIC: a displacement or velocity beyond 1e100 m or m/s; MPS_ERROR_STATE: as
 *  mps_elastic_solve; MPS_ERROR_CANCELLED; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_start(mps_elastic *e,
                                                   const mps_elastic_motion_def *def);
/** Takes `count` (>= 0) steps, and writes `displacement`, `velocity`, `acceleration` and
 *  `reaction`. Loads and boundaries may be changed between calls; their values at the end of a step
 *  act. A step that fails (MPS_ERROR_NUMERIC: a speed beyond 1e100 m/s, or as mps_elastic_solve) or
 *  is cancelled (MPS_ERROR_CANCELLED) is undone: state, time and fields are those after the last
 *  complete step. MPS_ERROR_STATE: no motion under way. */
MPS_API MPS_NODISCARD mps_status mps_elastic_step(mps_elastic *e, int64_t count);
/** Called at the start of a run, then every `every` steps and at the end, with fields up to date. A
 *  status other than MPS_OK ends the run, which returns it. */
typedef mps_status (*mps_elastic_fn)(void *user, mps_elastic *e);
/** Steps to exactly t_end (s, not before the present time) in equal steps of at most dt, which is
 *  kept. `callback` may be NULL, `every` >= 1. MPS_ERROR_ARGUMENT: `t_end` or `every` out of range;
 *  otherwise errors as mps_elastic_step, or the status of `callback`. */
MPS_API MPS_NODISCARD mps_status mps_elastic_run(mps_elastic *e, double t_end, int64_t every,
                                                 mps_elastic_fn callback, void *user);
/** Time (s) since the start of the motion; 0 without a motion. */
MPS_API double mps_elastic_time(const mps_elastic *e);
/** Number of steps since the start of the motion; 0 without a motion. */
MPS_API int64_t mps_elastic_steps(const mps_elastic *e);
/** Time step (s); 0 without a motion. */
MPS_API double mps_elastic_dt(const mps_elastic *e);
/** Largest stable time step (s): infinite, since all are stable. */
MPS_API double mps_elastic_limit(const mps_elastic *e);
/** Sets the time step (s, 1e-30 to 1e30) from the next step on; the matrix is factored again.
 *  MPS_ERROR_ARGUMENT: out of range; MPS_ERROR_STATE: no motion under way, or as
 *  mps_elastic_update_material. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_dt(mps_elastic *e, double dt);

/** Keeps the state of the motion and of the set (removed particles, numbers of facets), with
 *  impulses and works, in memory; *snapshot NULL: created, else filled again. Between steps only;
 *  on an error nothing has changed. MPS_ERROR_ARGUMENT: a snapshot of another solver;
 *  MPS_ERROR_STATE: no motion under way, or a step is running; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_snapshot(mps_elastic *e, mps_snapshot **snapshot);
/** Restores a snapshot, bit for bit. Loads, values and signals of boundaries, dt and moduli stay.
 *  On an error nothing has changed. MPS_ERROR_ARGUMENT: a snapshot of another solver;
 *  MPS_ERROR_STATE: no motion under way, or other boundaries or cuts. */
MPS_API MPS_NODISCARD mps_status mps_elastic_rollback(mps_elastic *e, const mps_snapshot *snapshot);
/** Writes the state to a file, as mps_elastic_snapshot; of `info` (NULL: nothing) user_key and
 *  user_data are written too. MPS_ERROR_IO: the file cannot be written; MPS_ERROR_STATE: as
 *  mps_elastic_snapshot; MPS_ERROR_UNSUPPORTED: no HDF5. */
MPS_API MPS_NODISCARD mps_status mps_elastic_save(mps_elastic *e, const char *path,
                                                  const mps_checkpoint *info);
/** Restores a file of mps_elastic_save, as mps_elastic_rollback, into a solver that was built and
 *  started in the same way; `info` (may be NULL) as for mps_checkpoint_info. On an error nothing
 *  has changed: statuses of mps_checkpoint_read, and MPS_ERROR_STATE as mps_elastic_rollback. */
MPS_API MPS_NODISCARD mps_status mps_elastic_restore(mps_elastic *e, const char *path,
                                                     mps_checkpoint *info);

/** The lowest `count` circular eigenfrequencies (rad/s, ascending) of the supported body and, where
 *  `shapes` is not NULL, its modes: shapes[(k * n + i) * 3 + c], i in the set's present order, each
 *  of unit modal mass. By ARPACK on the inverse (shift-invert at 0). Reads `density`. One
 *  calculation at a time in a process: others wait. MPS_ERROR_ARGUMENT: `count` below 1, or not
 *  below the number of unknowns; MPS_ERROR_FIELD: no field `density`; MPS_ERROR_UNSUPPORTED: no
 *  ARPACK, or too many unknowns for its integers; MPS_ERROR_NUMERIC: no convergence;
 *  MPS_ERROR_STATE: as mps_elastic_solve; MPS_ERROR_CANCELLED; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_modes(mps_elastic *e, int32_t count, double *omega,
                                                   double *shapes);

MPS_EXTERN_C_END
#endif
