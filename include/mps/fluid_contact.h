/* mps/fluid_contact.h - rigid bodies in a fluid: standing, moved and floating ones.
 *
 * Thread rule: as mps/fluid.h, which includes this header.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_FLUID_CONTACT_H
#define LIBMPS_FLUID_CONTACT_H

#include "fluid.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_fluid_contact_def {
  uint32_t struct_size;
  int32_t kind;   /* mps_boundary_kind of the body's surface: HELD (no slip, default) or ROLLER */
  int32_t floats; /* 1: the fluid moves the body, see mps_fluid_float_body; 0 (default): the caller
                     or another solver */
  int32_t reserved;
} mps_fluid_contact_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown
 *  to this library. */
MPS_API mps_status mps_fluid_contact_def_init(mps_fluid_contact_def *def, size_t size);
static inline mps_fluid_contact_def mps_fluid_contact_defaults(void) {
  mps_fluid_contact_def def;
  memset(&def, 0, sizeof def);
  if (mps_fluid_contact_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a rigid body to the fluid: a convex polygon (mps_body_create_box, _polygon) with edges of
 *  at least l0, standing on a boundary, through the surface or all in the water; all bodies
 *  together may have 50 000 edges. Bodies side by side make a face of several parts, with concave
 * corners between them too. `def` NULL: the defaults. The caller moves it (mps_body_advance,
 *  mps_body_set_motion), or another solver does: its pose and velocity when a step is made, or
 *  solved for in parts, are those of the end of that step. At the end of each step it receives
 *  the water's forces (mps_body_get_reaction; a free body moves by them), in addition to those of
 * other solvers that it is in contact with. It is kept alive.
 *
 *  `out` (may be NULL) receives the handle (mps/contact.h): mps_contact_destroy removes the body
 *  from the water, in an open step at the end of that step; mps_contact_get_reaction gives the
 * water's action on it, by parts, in an open step of the last solution: moments about its reference
 * point, moment_impulse about its present position; `count` is that of wetted points. Force and
 * moment are those of the pressures, impulses include collisions and smoothing, as those of
 * mps_body_get_reaction; they act on a floating body one step later. mps_contact_get_particles is
 * MPS_ERROR_UNSUPPORTED.
 *
 *  MPS_ERROR_ARGUMENT: another shape; a particle inside or closer than .3 l0; less than 15 degrees
 *  of fluid between an edge and the boundary that it stands on (a body that rolls there later has a
 *  warning in the log, once); nearer than re to a polyline; too many edges. MPS_ERROR_STATE: the
 * fluid has the body already. */
MPS_API MPS_NODISCARD mps_status mps_fluid_add_contact(mps_fluid *fluid, mps_body *body,
                                                       const mps_fluid_contact_def *def,
                                                       mps_contact **out);
/** Pressure (Pa) at `count` points of a body (3 values each, m), within 0.01 l0 of its present
 *  surface, as mps_fluid_get_pressure. MPS_ERROR_ARGUMENT: the contact is none of this fluid's,
 *  `count` below 0, or a point off the body; MPS_ERROR_STATE: the open step's pressure has not been
 *  solved; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_body_pressure(const mps_fluid *fluid,
                                                             const mps_contact *contact,
                                                             int64_t count, const double *x,
                                                             double *pressure);
/** `floats` 1: from now on the fluid moves the body in each of its steps, such that the water's
 *  pressure, the body's mass, gravity and load (mps_body_set_load), and the impulses of other
 *  solvers since its last step are in balance, however light the body is. Its draft is right to 1
 *  %, its height to .02 l0, as the level of the water. No boundary acts on it: keep it off the
 *  ground. 0: the caller or another solver moves it, by the forces of the last step, which is
 *  unstable where it is lighter than the water that it accelerates. MPS_ERROR_ARGUMENT: the contact
 *  is none of this fluid's, or the body is not free (MPS_BODY_MOTION_FREE). MPS_ERROR_STATE:
 *  another solver moves it. */
MPS_API MPS_NODISCARD mps_status mps_fluid_float_body(mps_fluid *fluid, mps_contact *contact,
                                                      int32_t floats);

MPS_EXTERN_C_END
#endif
