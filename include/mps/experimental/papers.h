/* mps/experimental/papers.h - variants of the published methods, for comparisons and studies. Their
 * names begin with mps_experimental_.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_PAPERS_H
#define LIBMPS_EXPERIMENTAL_PAPERS_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../dynamics.h"
#include "../elastic.h"
#include "../fluid.h"
#include "../mpm.h"

MPS_EXTERN_C_BEGIN

/** As mps_elastic_create, for the method that Chikazawa prints in (10), corrected, with R and D
 *  eliminated; two-dimensional, 0 <= nu < 0.5. The sums (7), (8) are divided by each particle's own
 *  number density, or (constant not 0) by that of the full lattice, as printed: then a rigid
 *  rotation causes stress at surfaces. radius_ratio is 3 by default; loads on facets act without
 *  their first moments. MPS_ERROR_UNSUPPORTED: a set that is not 2D, or no CHOLMOD; other errors as
 *  mps_elastic_create. */
MPS_API MPS_NODISCARD mps_status mps_experimental_elastic_published(mps_context *context,
                                                                    mps_particles *particles,
                                                                    const mps_elastic_def *def,
                                                                    int32_t constant,
                                                                    mps_elastic **out);

/** Before the first step: doubles the torques of explicit dynamics, as Yoshida (A14) is printed.
 *  Angular momentum is then not conserved, and the stability limit lower by about sqrt(2).
 *  MPS_ERROR_STATE after a step. */
MPS_API MPS_NODISCARD mps_status mps_experimental_dynamics_printed_torque(mps_dynamics *dynamics);

/** Weights of the particle-to-grid transfer of velocity in WLS-MPM. */
typedef enum mps_experimental_transfer {
  MPS_EXPERIMENTAL_TRANSFER_SHAPE = 0, /* the shape functions: momentum is kept everywhere */
  MPS_EXPERIMENTAL_TRANSFER_WEIGHT = 1 /* the weights, Nakamura (12), (39): near bodies and edges
                                          the momentum drifts */
} mps_experimental_transfer;

/** Before the first step: chooses mps_experimental_transfer. MPS_ERROR_ARGUMENT: no such value, or
 *  WEIGHT with `flip_time` or a free-field side; MPS_ERROR_STATE after a step. */
MPS_API MPS_NODISCARD mps_status mps_experimental_mpm_transfer(mps_mpm *mpm, int32_t transfer);

/** Velocity gradient that the laws of WLS-MPM receive. */
typedef enum mps_experimental_strain {
  MPS_EXPERIMENTAL_STRAIN_DERIVATIVE = 0, /* of the field that the shape functions span */
  MPS_EXPERIMENTAL_STRAIN_FIT = 1 /* `velocity_gradient`, the slope of the fit, Nakamura (42):
                                     bodies in large bending creep */
} mps_experimental_strain;

/** Before the first step: chooses mps_experimental_strain. MPS_ERROR_ARGUMENT: no such value;
 *  MPS_ERROR_STATE after a step. */
MPS_API MPS_NODISCARD mps_status mps_experimental_mpm_strain(mps_mpm *mpm, int32_t strain);

/** Before the first step: the original material point method in place of WLS-MPM, Nakamura Table 1.
 *  The B-splines and their own derivatives are the shape functions, also at bodies and sides, and
 *  particles carry no velocity gradient to the nodes. Nodes beyond a side are prescribed as those
 * on it. With a and v, the nodes' acceleration and velocity interpolated to the particle, its
 * velocity becomes flip (v_p + dt a) + (1 - flip) v, flip in [0, 1]; 1: FLIP, Table 1; 0: PIC. It
 * moves with v. MPS_ERROR_ARGUMENT: `flip` out of range, `flip_time` given, an absorbing or
 * free-field side; MPS_ERROR_STATE after a step. */
MPS_API MPS_NODISCARD mps_status mps_experimental_mpm_standard(mps_mpm *mpm, double flip);

/** Before the first step: the fluid by the classical scheme (Koshizuka, Tamako and Oka 1995) in
 *  place of the library's own; the fraction `gamma`, in (0, 1], of the density error is corrected
 *  in each step. Its pressure is noisy, the more the larger gamma is. gamma 1 needs particles on a
 *  regular lattice at the start, or the run diverges (MPS_ERROR_DIVERGED); 0.2 does not. Without
 *  viscosity, free surface (levels are NaN) and accelerations of walls; a step cannot be made in
 *  parts. MPS_ERROR_ARGUMENT: `gamma` out of range; MPS_ERROR_STATE after a step. Collective. */
MPS_API MPS_NODISCARD mps_status mps_experimental_fluid_classical(mps_fluid *fluid, double gamma);

MPS_EXTERN_C_END
#endif
