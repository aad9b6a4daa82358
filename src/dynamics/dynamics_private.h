/* dynamics_private.h - the members of the explicit MPS solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_DYNAMICS_PRIVATE_H
#define MPSI_DYNAMICS_PRIVATE_H

#include "kernels.h"
#include "mesh.h"

#include <mps/dynamics.h>

/* A component driven by a signal. */
typedef struct mpsi_dynamics_drive {
  int32_t particle, component;
  mps_signal *signal; /* owned through mps_dynamics.signals */
  double factor;
} mpsi_dynamics_drive;

/* A dashpot on one component of one particle: acceleration c (target - v). */
typedef struct mpsi_dynamics_dashpot {
  int32_t particle, component;
  int32_t partner;    /* free-field particle whose velocity is the target, or -1 */
  double c;           /* 1/s */
  mps_signal *signal; /* incoming wave: the target is 2 factor v_in; NULL: 0 */
  double factor;
  double before, partner_before; /* velocities before the step, m/s */
} mpsi_dynamics_dashpot;

struct mps_dynamics {
  mps_context *context;
  mps_particles *particles;
  mps_dynamics_def def;
  double radius, density; /* re (m), n0 */
  int64_t count;          /* particles, free-field columns included */
  int64_t body;           /* particles of the body: 0 .. body - 1 */
  int64_t pairs;
  bool lattice; /* all pairs' offsets are whole spacings */
  mpsi_dynamics_mesh mesh;
  mpsi_dynamics_state state;
  const mpsi_dynamics_kernels *kernels;
  double *slab;    /* the arrays of state that are not particle fields */
  double *scratch; /* MPSI_DYN_SCRATCH a worker */
  int32_t *bad;    /* one a block */
  mpsi_dynamics_drive *drive;
  mpsi_dynamics_dashpot *dashpot;
  mps_signal **signals; /* every signal kept alive */
  int64_t drives, drive_room, dashpots, dashpot_room, signal_count, signal_room;
  bool dashpots_sorted;
  mpsi_dynamics_damping damping;
  bool fresh;   /* no step since creation or restart: G_{-1} = G_0 */
  bool checked; /* dt has been compared with the linear limit */
  bool diverged;
  bool have_limit;
  mps_linear_limit limit; /* valid when have_limit */
  double dt;              /* s, 0: not yet chosen */
  double history_dt;      /* s, of the last step taken: restoring_old is that old */
  double base_time;       /* time = base_time + (steps - base_step) dt */
  int64_t base_step, steps;
  double *initial; /* copy of the initial displacement, rotation, velocity and spin */
  double initial_time;
};

/* Column of a field that the solver has added itself: never NULL. */
double *mpsi_dynamics_column(const mps_dynamics *dynamics, const char *name, int32_t component);

/* Sets the history (old positions, trigonometry) that displacement, rotation, velocity and spin
 * imply, time and step 0. */
void mpsi_dynamics_begin(mps_dynamics *dynamics, double time);
/* The same from the kept initial state. */
void mpsi_dynamics_rewind(mps_dynamics *dynamics);
/* Steps without touching the public fields beyond those that carry the state; the last step
 * writes accelerations when `output`. */
mps_status mpsi_dynamics_advance(mps_dynamics *dynamics, const char *function, int64_t count,
                                 bool output);
/* Brings position, velocity and spin up to date. */
void mpsi_dynamics_publish(mps_dynamics *dynamics);
/* Chooses dt where the definition left it open, and warns of one above the limit. */
mps_status mpsi_dynamics_settle_dt(mps_dynamics *dynamics, const char *function);

/* Imposes driven displacements at time t; with `output` their accelerations at time `now`. */
void mpsi_dynamics_apply_drives(mps_dynamics *dynamics, double t, double now, bool output);
/* Dashpots around a step: remember the velocities before, correct those after. */
void mpsi_dynamics_dashpots_before(mps_dynamics *dynamics);
void mpsi_dynamics_dashpots_after(mps_dynamics *dynamics, double now, bool output);
bool mpsi_dynamics_add_dashpot(mps_dynamics *dynamics, mpsi_dynamics_dashpot dashpot);

/* y = S x, the symmetric tangent at the reference state: S = M^-1/2 K M^-1/2 over the 3 count
 * unknowns (x, y, rotation each in a row); held ones give 0. `weight` (NULL: 1) multiplies each
 * particle's pressure, its mean each pair's shear force. `work` has 4 count doubles. */
void mpsi_dynamics_tangent_apply(mps_dynamics *dynamics, const double *weight, const double *x,
                                 double *y, double *work);

/* Square of the highest eigenfrequency (rad/s)^2 of the endless square lattice. */
double mpsi_dynamics_lattice_omega2(double spacing, double radius_ratio, double density, double vs,
                                    double vp, int32_t torque);
/* Yoshida's scheme at the limit z = -1: largest dt for a mode of frequency^2 omega2. */
double mpsi_dynamics_damped_limit(double omega2, double alpha, double beta);

#endif
