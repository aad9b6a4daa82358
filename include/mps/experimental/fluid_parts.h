/* mps/experimental/fluid_parts.h - a step of a fluid in parts, for two-way coupling.
 *
 * Thread rule: as mps/fluid.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_FLUID_PARTS_H
#define LIBMPS_EXPERIMENTAL_FLUID_PARTS_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../fluid.h"

MPS_EXTERN_C_BEGIN

/* A step in parts, for two-way coupling of the water and another system:
 *
 *   mps_fluid_begin_step(fluid, dt);                  neighbour lists, matrix of the pressure
 *                                                     equation and its preconditioner, which stay
 *   do {
 *     mps_fluid_set_boundary_motion(fluid, wall, s, v);   at the end of the step: a guess
 *     mps_fluid_solve_pressure(fluid);                only the right side changes
 *     mps_fluid_get_reaction(fluid, wall, &reaction); forces and pressures at mid step
 *   } while (v does not agree with these forces);
 *   mps_fluid_end_step(fluid);                        velocities and positions
 *
 * The pressure acts throughout the step: it is to be used as that at its middle. With one solution
 * a step in parts is mps_fluid_step bit for bit. In between, the set's fields and the time are
 * those before the step, and only mps_fluid_set_boundary_motion and queries may be called: other
 * functions return MPS_ERROR_STATE, as do the parts in another order. */

/** Begins a step of `dt` (s; NaN: mps_fluid_dt). After an error no step is open.
 *  MPS_ERROR_ARGUMENT: `dt` out of range; MPS_ERROR_STATE: a step is open, a field is being edited,
 *  or the classical scheme; MPS_ERROR_DIVERGED, MPS_ERROR_NUMERIC, MPS_ERROR_CANCELLED and
 *  MPS_ERROR_MEMORY as mps_fluid_step. */
MPS_API MPS_NODISCARD mps_status mps_fluid_begin_step(mps_fluid *fluid, double dt);
/** Solves for the pressure with the walls' present motions; MPS_ERROR_NUMERIC: it did not converge;
 *  the step stays open. MPS_ERROR_STATE: no step is open. */
MPS_API MPS_NODISCARD mps_status mps_fluid_solve_pressure(mps_fluid *fluid);
/** Ends the step with the last solution. A motion set since the last solution has to be solved for
 *  first (MPS_ERROR_STATE). After MPS_ERROR_DIVERGED or MPS_ERROR_MEMORY the step is undone and no
 *  step is open. */
MPS_API MPS_NODISCARD mps_status mps_fluid_end_step(mps_fluid *fluid);
/** Discards the open step: the state is that before it. MPS_ERROR_STATE: no step is open. */
MPS_API MPS_NODISCARD mps_status mps_fluid_abandon_step(mps_fluid *fluid);

MPS_EXTERN_C_END
#endif
