/* mps/fluid_load.h - loads of a fluid: accelerations, pressures on its surface, zones that damp
 * waves.
 *
 * Thread rule: as mps/fluid.h, which includes this header.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_FLUID_LOAD_H
#define LIBMPS_FLUID_LOAD_H

#include "fluid.h"

MPS_EXTERN_C_BEGIN

typedef enum mps_fluid_load_kind {
  MPS_FLUID_LOAD_BODY = 0,     /* `acceleration` on the particles chosen: a shaken tank, wind */
  MPS_FLUID_LOAD_PRESSURE = 1, /* `pressure` on the free surface that the chosen particles make: a
                                 squall, the air in a chamber. Not with the classical scheme */
  MPS_FLUID_LOAD_DAMPING = 2   /* -`rate` u: a zone in which waves fade */
} mps_fluid_load_kind;

/** A load, times factor times signal in each component, on the particles of a list, those in a box
 *  at the beginning of a step, or all where neither is given. Loads add up. Forces that another
 *  code computes go into the field `external_force` instead. */
typedef struct mps_fluid_load_def {
  uint32_t struct_size;
  int32_t kind;       /* mps_fluid_load_kind, default BODY */
  const int64_t *ids; /* copied; ids that are not in the set are ignored. NULL (default): the box */
  int64_t id_count;   /* 0 (default): the box */
  double lower[3], upper[3]; /* m; +-infinity is allowed; NaN (default): no bound */
  double acceleration[3];    /* m/s2, |a| at most 1e6; [2] must be 0; default 0 */
  double pressure;           /* Pa, |p| at most 1e12, above the air's elsewhere; default 0. Where it
                                is negative the water below may have as much suction: let the box
                                reach three spacings into it */
  mps_signal *signal[3];     /* of PRESSURE [0]: its displacement is read as a number, at the time
                                that a step begins with; NULL (default): 1. Kept alive */
  double factor[3];          /* finite; of PRESSURE and DAMPING [0]; default 1 */
  double rate;  /* 1/s, DAMPING: 0 to 1e6, where factor and signal are 1; more than 1/dt counts
                   as that. Of a zone one wave length L long R = .01 to .04 with 10 a period, for
                   depths of L/12 to L/3; default 0 */
  int32_t side; /* DAMPING: 1: the rate rises from 0 at lower[0] with the square of the distance to
                   `rate` at upper[0], -1: from 0 at upper[0]; both are finite then. 0 (default):
                   it is the same in all the box */
  int32_t reserved;
} mps_fluid_load_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_fluid_load_def_init(mps_fluid_load_def *def, size_t size);
static inline mps_fluid_load_def mps_fluid_load_defaults(void) {
  mps_fluid_load_def def;
  memset(&def, 0, sizeof def);
  if (mps_fluid_load_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a load, between steps; `number` (may be NULL) receives the lowest free number, from 0.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range, or too many loads; MPS_ERROR_STATE: a step
 *  is open, or a callback of the solver is running; MPS_ERROR_UNSUPPORTED: a pressure with the
 *  classical scheme; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_add_load(mps_fluid *fluid, const mps_fluid_load_def *def,
                                                    int32_t *number);
/** Gives load `number` another definition. MPS_ERROR_ARGUMENT: no load `number`; otherwise errors
 *  as mps_fluid_add_load. */
MPS_API MPS_NODISCARD mps_status mps_fluid_set_load(mps_fluid *fluid, int32_t number,
                                                    const mps_fluid_load_def *def);
/** Removes load `number`. MPS_ERROR_ARGUMENT: no load of that number; MPS_ERROR_STATE: a step is
 *  open, or a callback of the solver is running. */
MPS_API MPS_NODISCARD mps_status mps_fluid_remove_load(mps_fluid *fluid, int32_t number);

MPS_EXTERN_C_END
#endif
