/* kernels.h - the inner loops of a time step, compiled for several instruction sets.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "dynamics/pairs/mesh.h"

#include <mps/dynamics.h>

#include <float.h>

/* The arrays of a body, one value a particle, in sorted order. Names follow the paper. */
typedef struct mpsi_dynamics_state {
  double *rx, *ry;       /* reference position, m */
  double *dx, *dy, *th;  /* displacement (m), rotation (rad): r = r0 + d */
  double *ox, *oy, *oth; /* the same one step earlier (Verlet) */
  double *vx, *vy, *vth; /* velocity at mid-step (leapfrog) or at the step (Euler) */
  double *gx, *gy, *gth; /* M^-1 times the restoring force: m/s2, rad/s2 */
  double *sx, *sy, *sth; /* damping by pairs: each pair's force times its beta */
  double *hx, *hy, *hth; /* M^-1 times beta times the restoring force, one step earlier */
  double *ax, *ay;       /* acceleration, written on demand */
  double *p;             /* pressure, Pa */
  double *c, *s;         /* removal (12): cos th - 1, sin th; (11): cos th/2 - 1, sin th/2 */
  double *mu, *lambda;   /* Pa */
  double *ix, *iy, *ith; /* 1/rho for x and y, 3/(rho D^2) for the torque */
  double *alpha, *beta;  /* Rayleigh coefficients, 1/s and s */
  double *ex, *ey;       /* a slot a pair: kc e, from the first pass to the second */
} mpsi_dynamics_state;

/* Twice the shear modulus of a pair. Half of its length lies in either material, and both halves
 * bear the same stress, so it is the harmonic mean: with the arithmetic one of (A6) a soft layer on
 * stiff ground lacks half a spacing of its thickness. Where both are the same it is their sum, to
 * the last bit. DBL_MIN: lanes without a pair have 0, and would divide by it, which a host may
 * trap.
 */
static inline double mpsi_dynamics_pair_shear(double a, double b) {
  const double least = a < b ? a : b, most = a < b ? b : a;
  return 4.0 * least * (most / (least + most + DBL_MIN));
}

/* Which stiffness-proportional damping a body needs. One ratio for all: by particles is the same as
 * by pairs, and cheaper. */
typedef enum mpsi_dynamics_damping {
  MPSI_DYN_UNDAMPED = 0,
  MPSI_DYN_BY_PARTICLES = 1, /* Yoshida (A24): beta_i times the particle's whole force */
  MPSI_DYN_BY_PAIRS = 2      /* Yoshida (A15): each pair's shear force times the mean beta, each
                            particle's      pressure times its own, as element damping does */
} mpsi_dynamics_damping;

/* Parameters of one step. */
typedef struct mpsi_dynamics_step {
  double dt;      /* s: of the displacement */
  double kick;    /* s: duration of the forces: dt, or its mean with that of the previous step */
  double rate;    /* 1/s: of the previous step, for the rate of the damping force */
  double limit2;  /* square of the divergence criterion, (m/s2)^2 */
  int32_t first;  /* no history yet: the damping force has no rate */
  int32_t output; /* 1: write acceleration */
  /* Accelerations by Rayleigh damping, 3 columns of `stride`; NULL: not stored. */
  double *drag;
  int64_t stride;
} mpsi_dynamics_step;

/* Doubles of scratch memory a worker needs. */
#define MPSI_DYN_SCRATCH (7 * MPSI_DYN_BLOCK + 32 * MPSI_DYN_CHUNK)

/* Terms of the first pass: each includes those before it. */
typedef enum mpsi_dynamics_sums {
  MPSI_DYN_PRESSURES = 0, /* all that ghost blocks need */
  MPSI_DYN_FORCES = 1,
  MPSI_DYN_DAMPED_FORCES = 2 /* of damping by pairs */
} mpsi_dynamics_sums;

/* First pass over one block: shear and normal forces, torques, divergence, pressure. */
typedef void (*mpsi_dynamics_pass1_fn)(const mpsi_dynamics_state *state,
                                       const mpsi_dynamics_mesh *mesh, int64_t block,
                                       double *scratch);
/* Second pass: pressure forces, damping, integration. Returns non-zero when an acceleration is
 * beyond the limit or not finite. */
typedef int (*mpsi_dynamics_pass2_fn)(const mpsi_dynamics_state *state,
                                      const mpsi_dynamics_mesh *mesh, int64_t block,
                                      const mpsi_dynamics_step *step, double *scratch);
/* c and s of particles [begin, end) from th. */
typedef void (*mpsi_dynamics_trig_fn)(const mpsi_dynamics_state *state, int64_t begin, int64_t end);

typedef struct mpsi_dynamics_kernels {
  mpsi_dynamics_pass1_fn pass1[2][3]; /* MPS_DYNAMICS_ROTATION_..., mpsi_dynamics_sums */
  mpsi_dynamics_pass2_fn pass2[2][3]
                              [3]; /* removal, mpsi_dynamics_damping, MPS_DYNAMICS_INTEGRATOR_... */
  mpsi_dynamics_trig_fn trig[2];
} mpsi_dynamics_kernels;

/* The loops of an x86-64 level, as given by mpsi_context_level. */
const mpsi_dynamics_kernels *mpsi_dynamics_kernels_select(int32_t level);
