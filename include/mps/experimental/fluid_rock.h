/* mps/experimental/fluid_rock.h - permeable regions in a fluid: rock, rubble mounds, the core of a
 * breakwater.
 *
 * In a region of porosity e the field `velocity` is the discharge velocity U, e times that of the
 * water in the pores, which is continuous at the region's face. Particles move with U/e; each is
 * l0^2 of water, so their spacing in the region is l0/e^.5. Fill such regions with that spacing:
 * e/l0^2 particles a square metre. The radius of the weights in the region is 2.4 such spacings, at
 * most 3.6 l0 and at least that of the definition, which is that in water. The resistance of the
 * pores is by Darcy and Forchheimer (van Gent 1995),
 *
 *   (1 + Cm)/e dU/dt = -grad p/rho + g - (a + b |U|) U,   div U = 0,
 *   a = alpha (1-e)^2/e^3 nu/D50^2,  b = beta (1 + 7.5/KC) (1-e)/(e^3 D50),  Cm = gamma (1-e)/e,
 *
 * implicit in time. Thread rule: as mps/fluid.h. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_FLUID_ROCK_H
#define LIBMPS_EXPERIMENTAL_FLUID_ROCK_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../fluid.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_fluid_rock_def {
  uint32_t struct_size;
  int32_t reserved;
  int64_t corner_count;  /* 3 to 10000; no default */
  const double *corners; /* of a polygon, 3 values each (m, z 0), either way round, copied; no
                            default. Where several contain a particle the lowest number counts */
  double porosity;       /* e, 0.1 to 1; no default */
  double diameter;       /* D50, m, 1e-6 to 100; no default */
  double alpha;          /* 0 to 1e6; default 1000 (van Gent); 500 with beta 2 (Jensen 2014) */
  double beta;           /* 0 to 1e3; default 1.1 (van Gent) */
  double KC;             /* Keulegan-Carpenter number, 1e-6 to 1e300; NaN (default): no such term,
                            as in flow in one direction */
  double gamma;          /* added mass, 0 to 10; default 0.34 */
  double viscosity;      /* nu of the water in the pores, m2/s, 0 to 1; default 1e-6 */
} mps_fluid_rock_def;

static inline mps_fluid_rock_def mps_fluid_rock_defaults(void) {
  mps_fluid_rock_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_FLUID_ROCK, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a region of rock at rest, between steps; `number` (may be NULL) receives the lowest free
 *  number, from 0. Particles may be in it. Its force on the water is part of impulse_scheme of the
 *  totals, its work of `dissipated`; the totals count U as the velocity of a particle.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range; a body or a plane wall nearer to a polyline
 *  or its corners than the radius in the rock, which is the re of mps/fluid.h then;
 *  MPS_ERROR_STATE: a step is open, or a callback of the solver is running;
 *  MPS_ERROR_UNSUPPORTED: the classical scheme; MPS_ERROR_MEMORY. On an error nothing has changed.
 */
MPS_API MPS_NODISCARD mps_status mps_fluid_add_rock(mps_fluid *fluid, const mps_fluid_rock_def *def,
                                                    int32_t *number);
/** Removes region `number`. MPS_ERROR_ARGUMENT: no region of that number; MPS_ERROR_STATE: a step
 * is open, or a callback of the solver is running. */
MPS_API MPS_NODISCARD mps_status mps_fluid_remove_rock(mps_fluid *fluid, int32_t number);

MPS_EXTERN_C_END
#endif
