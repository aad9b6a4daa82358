/* mps/dynamics.h - explicit MPS elastodynamics (Yoshida): earthquake response of an elastic body
 * of particles in plane strain, with Euler, leapfrog and Verlet time integration, Rayleigh
 * damping, driven, viscous and free-field boundaries, and the stability limit of the time step.
 *
 * Three unknowns a particle: two displacements (m) and a rotation (rad). Neighbours and the
 * weight function come from the reference positions, at creation those without the displacement,
 * and never change. Restoring forces follow
 * from displacement differences, so that small strains keep all their digits.
 *
 * The solver works in the fields of the particle set itself (zero copy) and sorts the set once,
 * at creation. It reads `density` (kg/m3, > 0), `shear_velocity` Vs (m/s, > 0),
 * `pressure_velocity` Vp (m/s, Vp >= sqrt(2) Vs so that lambda >= 0) and, if present, `damping`
 * (ratio h, >= 0) at creation; `displacement`, `velocity`, `rotation`, `spin` at creation and at
 * mps_dynamics_restart; it writes these and `position`, `acceleration`, `pressure` and the history
 * fields `displacement_old`, `rotation_old`, `restoring_old`.
 *
 * After a step to time t = mps_dynamics_time the positions, displacements and rotations are those
 * of t; accelerations and pressures those that the step began with, of t - dt; velocity and spin
 * those of t - dt/2 (Verlet, leapfrog) or of t (Euler).
 *
 * Thread rule: one thread at a time per context; a step itself runs on the context's executor, and
 * its results are the same bit for bit for every number of threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_DYNAMICS_H
#define LIBMPS_DYNAMICS_H

#include "kernel.h"
#include "particles.h"
#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_dynamics mps_dynamics;

typedef enum mps_integrator {
  MPS_INTEGRATOR_EULER = 0,    /* Yoshida (2), (3) corrected */
  MPS_INTEGRATOR_LEAPFROG = 1, /* Yoshida (4), (5) */
  MPS_INTEGRATOR_VERLET = 2    /* Yoshida (8) */
} mps_integrator;

/** How the rigid rotation is taken out of a pair's relative position. */
typedef enum mps_rotation {
  MPS_ROTATION_MEAN_ANGLE = 11, /* Yoshida (11): u = r - R((th_i + th_j)/2) r0 */
  MPS_ROTATION_MEAN_MATRIX = 12 /* Yoshida (12): u = r - (R_i + R_j)/2 r0 */
} mps_rotation;

typedef enum mps_torque {
  MPS_TORQUE_CONSERVING = 0, /* Yoshida (A14) with prefactor d: angular momentum is conserved */
  MPS_TORQUE_PRINTED = 1     /* prefactor 2d as printed: not conserving, for comparison only */
} mps_torque;

/** Stiffness-proportional damping where the ratio h differs between particles. With one ratio for
 * all the two are the same. */
typedef enum mps_damping {
  MPS_DAMPING_PAIR = 0,    /* as element damping, Yoshida (A15): keeps momentum, dissipates always */
  MPS_DAMPING_PARTICLE = 1 /* Yoshida (A24): each particle's whole restoring force times its h; the
                              stress at a layer boundary is then undamped */
} mps_damping;

typedef struct mps_dynamics_def {
  uint32_t struct_size;
  int32_t integrator; /* mps_integrator, default VERLET */
  int32_t rotation;   /* mps_rotation, default MEAN_MATRIX (12) */
  int32_t torque;     /* mps_torque, default CONSERVING */
  double dt; /* s, > 0, or 0 (default): `courant` times the linear limit, found at the first step */
  double courant;      /* fraction of the linear limit for dt = 0, in (0, 1]; default 0.9 */
  double radius_ratio; /* re / D, in (1, 4]; default 1.5 */
  double f1, f2;       /* Rayleigh characteristic frequencies, Hz, > 0; default 1 and 14 */
  double period_x; /* m: the body repeats itself in x with this period; 0 (default): it does not */
  double divergence; /* m/s2, > 0: |acceleration| beyond it stops the run; default 1e15 */
  int32_t isa;       /* x86-64 level of the inner loops: 0 (default) the best there is, or 1, 3, 4;
                        every level gives the same results bit for bit */
  int32_t damping;   /* mps_damping, default PAIR */
} mps_dynamics_def;

MPS_API mps_status mps_dynamics_def_init(mps_dynamics_def *def, size_t size);
static inline mps_dynamics_def mps_dynamics_defaults(void) {
  mps_dynamics_def def;
  memset(&def, 0, sizeof def);
  if (mps_dynamics_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a solver for the 2D set `particles`, sorting it (its epoch changes) and pinning it:
 *  until the solver is destroyed no particle can be added. `def` NULL: defaults. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_create(mps_context *context, mps_particles *particles,
                                                     const mps_dynamics_def *def,
                                                     mps_dynamics **out);
MPS_API void mps_dynamics_destroy(mps_dynamics **dynamics);

/* ---- boundaries: before the first step ------------------------------------------------------- */

/** Holds the degrees of freedom `dofs` (MPS_DOF_... or-ed) of `count` particles at their present
 *  value: MPS_DOF_Y is a horizontal roller (S wave), MPS_DOF_X a vertical one (P wave). */
MPS_API MPS_NODISCARD mps_status mps_dynamics_hold(mps_dynamics *dynamics, uint32_t dofs,
                                                   int64_t count, const int64_t *ids);
/** Drives component `component` (0 x, 1 y) of `count` particles with factor * displacement of
 *  `signal` at each instant (E+F input; rigid base). The signal is kept alive. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_drive(mps_dynamics *dynamics, int32_t component,
                                                    mps_signal *signal, double factor,
                                                    int64_t count, const int64_t *ids);

/** A viscous (Lysmer-Kuhlemeyer) boundary: dashpots to a half space outside, one face of length D
 *  a particle, and an incoming wave: traction rho V (2 v_in - v), V = Vp along the normal and Vs
 *  across. Treated at mid-step, so it does not lower the stable time step (Euler: explicitly). */
typedef struct mps_viscous_def {
  uint32_t struct_size;
  int32_t normal; /* direction of the face's normal: 0 x, 1 (default) y */
  double density, shear_velocity, pressure_velocity; /* of the half space; 0 (default): of each
                                                        particle itself */
  mps_signal *incoming[2]; /* incoming wave (x, y): its velocity is used; NULL: none */
  double factor;           /* on the incoming wave, default 1 */
} mps_viscous_def;

MPS_API mps_status mps_viscous_def_init(mps_viscous_def *def, size_t size);
static inline mps_viscous_def mps_viscous_defaults(void) {
  mps_viscous_def def;
  memset(&def, 0, sizeof def);
  if (mps_viscous_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}
MPS_API MPS_NODISCARD mps_status mps_dynamics_viscous(mps_dynamics *dynamics,
                                                      const mps_viscous_def *def, int64_t count,
                                                      const int64_t *ids);

typedef enum mps_side { MPS_SIDE_LEFT = 1, MPS_SIDE_RIGHT = 2 } mps_side;

/** Before mps_dynamics_create: appends a free-field column beside the vertical left or right edge
 *  of the set, `gap` spacings away (integer >= 2): one copy, fields included, of each particle of
 *  that edge, marked in the field `free_field`. The solver moves the column as horizontally
 *  endless ground, gives the edge the forces of the ground that is missing beside it, and puts
 *  dashpots between edge and column, so that level ground responds exactly as the column and
 *  waves from inside leave. Base conditions must include the column: select by a box wide enough.
 */
MPS_API MPS_NODISCARD mps_status mps_dynamics_add_free_field(mps_particles *particles,
                                                             mps_side side, int32_t gap);

/* ---- running --------------------------------------------------------------------------------- */

/** Takes `count` (>= 0) steps, then brings all fields up to date. MPS_ERROR_DIVERGED: an
 *  acceleration beyond the limit of the definition, or not finite; the error record names step,
 *  time and particle; the fields show the diverging state. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_step(mps_dynamics *dynamics, int64_t count);

/** Called at the start of a run, then every `every` steps and at the end, with fields up to date.
 *  It may read everything, but not step, restart or destroy the solver or change dt. Return MPS_OK
 *  to go on; any other status ends the run, which returns it. */
typedef mps_status (*mps_dynamics_fn)(void *user, mps_dynamics *dynamics);

/** Steps to the first instant >= t_end (s), calling `callback` (may be NULL) every `every` (>= 1)
 *  steps, the context's progress hook at least about 100 times, and its cancel hook with it: some
 *  ten times a second. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_run(mps_dynamics *dynamics, double t_end,
                                                  int64_t every, mps_dynamics_fn callback,
                                                  void *user);

/** Reads displacement, velocity, rotation and spin from the fields as a new initial state at rest
 *  history (G_{-1} = G_0), time `time` (s), step 0. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_restart(mps_dynamics *dynamics, double time);
/** Goes on bit for bit from a checkpoint whose fields (displacement, rotation, velocity, spin and
 *  the three history fields) the caller has put back: same definition, boundaries and dt, `time`
 * and `step` as they were. Input that depends on time (signals) is the same bit for bit if the time
 * at the start (0, or that of mps_dynamics_restart) is the same too and dt never changed; else time
 *  may differ in its last digit. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_resume(mps_dynamics *dynamics, double time,
                                                     int64_t step);
/** Sets the time step (s, > 0, finite). A warning is logged when it is above the linear limit.
 *  Between steps: the velocity is kept. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_set_dt(mps_dynamics *dynamics, double dt);

MPS_API double mps_dynamics_time(const mps_dynamics *dynamics); /* s */
MPS_API int64_t mps_dynamics_steps(const mps_dynamics *dynamics);
/** Time step (s); finds it first when the definition left it to the library. 0 on failure. */
MPS_API double mps_dynamics_dt(mps_dynamics *dynamics);
/** Number of interacting pairs (each once). */
MPS_API int64_t mps_dynamics_pairs(const mps_dynamics *dynamics);

/** Energies (J per metre of thickness) of the present state. Kinetic and spin energy are
 *  v-.M.v+ / 2 with the velocities half a step before and after (Euler: v.M.v / 2): with the strain
 *  energy that is the invariant of Verlet and leapfrog, exact for a linear body without damping.
 *  Free-field columns are not counted. */
typedef struct mps_dynamics_energy {
  double kinetic, spin;     /* of translation, of rotation */
  double shear, volumetric; /* of the pairs (mu), of the pressures (lambda) */
  double total;
} mps_dynamics_energy;
MPS_API MPS_NODISCARD mps_status mps_dynamics_get_energy(mps_dynamics *dynamics,
                                                         mps_dynamics_energy *out);

/** Momenta per metre of thickness (kg/s, kg m/s): linear, and about the origin: orbital, spin. */
typedef struct mps_dynamics_momentum {
  double linear[2], orbital, spin;
} mps_dynamics_momentum;
MPS_API MPS_NODISCARD mps_status mps_dynamics_get_momentum(mps_dynamics *dynamics,
                                                           mps_dynamics_momentum *out);

/* ---- the stability limit of the time step ---------------------------------------------------- */

/** Limit by linear theory: the highest eigenfrequency of the tangent at the reference state. */
typedef struct mps_linear_limit {
  double dt;       /* largest stable step, s; Euler without damping: 0 unless `duration` was given;
                      infinite where nothing can move against anything else */
  double omega;    /* highest eigenfrequency of the undamped set, rad/s */
  double residual; /* relative bound on the error of omega^2 */
  int64_t iterations;
} mps_linear_limit;

/** No time stepping: Lanczos iteration on the tangent with the boundaries set so far; damping may
 *  differ from particle to particle. `duration` (s, >= 0): for Euler, which has no limit without
 *  damping but grows slowly, the largest step (up to 4/omega) whose amplification over `duration`
 *  stays below 1e15; 0: the asymptotic limit. Other integrators ignore it. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_limit_linear(mps_dynamics *dynamics, double duration,
                                                           mps_linear_limit *out);

typedef struct mps_bisection_def {
  uint32_t struct_size;
  int32_t reserved;
  double criterion;    /* m/s2, > 0: a run is unstable when any |acceleration| exceeds it; 1e15 */
  double accuracy;     /* ratio of the bounds at which to stop, > 1; default 1.2 (Yoshida, 3.3) */
  double duration;     /* s of each run, > 0; default 2.5 */
  double lower, upper; /* s: first bounds, lower < upper; 0 (default): from the linear limit. They
                          are tried and moved apart until one is stable and the other not. */
} mps_bisection_def;

MPS_API mps_status mps_bisection_def_init(mps_bisection_def *def, size_t size);
static inline mps_bisection_def mps_bisection_defaults(void) {
  mps_bisection_def def;
  memset(&def, 0, sizeof def);
  if (mps_bisection_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_bisection {
  double stable, unstable; /* s: the final bounds, unstable / stable <= accuracy */
  int64_t runs, steps;     /* what it took */
} mps_bisection;

/** Limit by time stepping, Yoshida 3.3: runs from the initial state (the fields at creation or at
 *  the last restart) with the geometric mean of the bounds until their ratio is below the
 *  accuracy; ends in the initial state with the former dt. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_limit_stepping(mps_dynamics *dynamics,
                                                             const mps_bisection_def *def,
                                                             mps_bisection *out);

/** What mps_dynamics_predict_dt is asked: uniform ground, no particles needed. */
typedef struct mps_predict_def {
  uint32_t struct_size;
  int32_t integrator;                       /* mps_integrator: VERLET (default) or LEAPFROG */
  double spacing;                           /* D = 2R, m */
  double shear_velocity, pressure_velocity; /* m/s */
  double damping;                           /* h, >= 0; default 0 */
  double f1, f2;                            /* Hz; default 1 and 14 */
  double radius_ratio;                      /* default 1.5 */
} mps_predict_def;

MPS_API mps_status mps_predict_def_init(mps_predict_def *def, size_t size);
static inline mps_predict_def mps_predict_defaults(void) {
  mps_predict_def def;
  memset(&def, 0, sizeof def);
  if (mps_predict_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

typedef struct mps_prediction {
  double linear;               /* s: own linear theory, edges of a body allowed for; use this one */
  double omega;                /* rad/s, highest eigenfrequency of the endless lattice */
  double printed_s, printed_p; /* s: Yoshida (14)-(16) with Table 2; NaN outside its range of h,
                                  0.001 to 0.22; h = 0 is the paper's undamped case, its 0.001 */
  double printed;              /* the smaller of the two */
  int32_t printed_in_range;    /* 1: R, V and h within the range of the paper's study */
  int32_t printed_is_safe;     /* 1: printed <= linear. It can be 1.5 times above. */
} mps_prediction;

MPS_API MPS_NODISCARD mps_status mps_dynamics_predict_dt(mps_context *context,
                                                         const mps_predict_def *def,
                                                         mps_prediction *out);

#define MPS_FIT_MAX_DAMPINGS 32

/** Regression Yoshida (14)-(16): dt = a1 (R/V)^a2 for each damping ratio; log10 a1 and log10 a2
 *  are quadratics of log10 h over h <= h_max. */
typedef struct mps_limit_fit {
  int32_t dampings; /* number of distinct h */
  int32_t reserved;
  double h[MPS_FIT_MAX_DAMPINGS], a1[MPS_FIT_MAX_DAMPINGS], a2[MPS_FIT_MAX_DAMPINGS];
  double b1[3], b2[3]; /* b11 b12 b13 and b21 b22 b23 */
  double rms;          /* relative rms of the fitted against the given dt, h <= h_max */
} mps_limit_fit;

/** Fits `count` limits dt[k] (s) of radius R[k] (m), velocity V[k] (m/s), damping h[k] (> 0) by
 *  LAPACK least squares. Each h needs at least 2 distinct R/V, and h_max at least 3 distinct h. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_fit_limits(mps_context *context, int64_t count,
                                                         const double *R, const double *V,
                                                         const double *h, const double *dt,
                                                         double h_max, mps_limit_fit *out);
/** dt (s) of a fit's quadratics at R, V, h. */
MPS_API double mps_limit_fit_dt(const mps_limit_fit *fit, double R, double V, double h);
/** The printed Table 2 as a fit (only b1 and b2 are set): wave 'S' or 'P'. */
MPS_API MPS_NODISCARD mps_status mps_limit_fit_printed(mps_context *context, char wave,
                                                       mps_limit_fit *out);

MPS_EXTERN_C_END
#endif
