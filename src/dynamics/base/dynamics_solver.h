/* dynamics_solver.h - the explicit MPS solver, put together from its parts: each has a header of
 * its own. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_DYNAMICS_DYNAMICS_SOLVER_H
#define MPSI_DYNAMICS_DYNAMICS_SOLVER_H

#include "core/base/exact.h"
#include "core/context/guard.h"
#include "core/particles/particles_internal.h"
#include "core/state/state.h"
#include "domain/halo.h"
#include "dynamics/base/coefficients.h"
#include "dynamics/base/present.h"
#include "dynamics/base/selection.h"
#include "dynamics/boundary/boundary.h"
#include "dynamics/boundary/loads.h"
#include "dynamics/pairs/layout.h"
#include "dynamics/pairs/mesh.h"
#include "dynamics/pairs/structure.h"
#include "dynamics/step/bound.h"
#include "dynamics/step/budget.h"
#include "dynamics/step/kernels.h"
#include "solver/solver_base.h"

#include <mps/dynamics.h>
#include <mps/io.h>

#define MPSI_DYN_LEAST_DT 1e-12 /* s */
#define MPSI_DYN_MOST_DT 1e9
#define MPSI_DYN_MOST_SPACINGS 1e9 /* extent of a set: positions keep a millionth of a spacing */

struct mps_dynamics {
  MPSI_SOLVER_BASE;
  mps_dynamics_def def;            /* with a share in the material */
  mps_kernel *kernel;              /* w(r), shared */
  double spacing, radius, density; /* D, re (m), n0 */
  int64_t count;                   /* particles, free-field columns included */
  int64_t body;                    /* particles of the body: 0 .. body - 1 */
  int64_t ghosts;                  /* of other ranks: count .. count + ghosts - 1 */
  int64_t whole, whole_body;       /* as count and body, of all ranks */
  bool lead;                       /* sums over columns, which all ranks have, are this rank's */
  mpsi_halo *halo;                 /* NULL: one rank */
  mpsi_dynamics_extremes extremes;
  int64_t pairs;  /* of all ranks */
  int64_t places; /* hash of the reference positions that the pairs are made of */
  bool lattice;   /* all pairs' offsets are whole spacings */
  mpsi_dynamics_mesh mesh;
  mpsi_dynamics_state state;
  const mpsi_dynamics_kernels *kernels;
  double *slab;    /* the arrays of state that are not particle fields */
  double *scratch; /* MPSI_DYN_SCRATCH a worker */
  int32_t *bad;    /* one a block */
  mpsi_dynamics_damping damping;
  double torque; /* factor on all torques: 1, or 2 as printed */

  /* what boundaries and loads do */
  mpsi_dynamics_bound *bound;            /* in order of component and memory */
  mpsi_dynamics_dashpot *dashpot;        /* columns first, then edges; from the far end of memory */
  mpsi_dynamics_dashpot *column_dashpot; /* those of the free-field columns */
  int64_t bounds, dashpots, column_dashpots;
  double *force[2]; /* of all loads, N: present when there is a load */
  bool forces_stale;
  double *before; /* 3 columns of velocities before a step, NULL until works are counted */
  double *drag;   /* 3 columns of accelerations by Rayleigh damping, NULL: not summed */
  double *part;   /* 2 partial sums a block */

  /* time */
  double dt;        /* s, chosen or given; NaN: not yet */
  double length;    /* s, of the steps being taken */
  double kept;      /* s, of the last step taken: restoring_old is that old */
  double lag;       /* s, from displacement_old to displacement (Verlet) */
  double base_time; /* time = base_time + (steps - base_step) length */
  int64_t base_step, steps;
  bool fresh;   /* no step since creation or restart: no history */
  bool checked; /* dt has been compared with the linear limit */
  bool chosen;  /* dt is the caller's by mps_dynamics_set_dt: it may be above the limit */
  bool diverged;
  bool begun;            /* works.start is known */
  bool no_rate;          /* restoring_old is of former moduli: damping has no rate yet */
  bool unread;           /* material fields have been edited, and are not consistent so far */
  bool cautious;         /* a rank has a signal that may fail: ranks agree before each step */
  bool begins;           /* the motion was edited on a rank; the next step starts from it */
  const char *rewritten; /* field of the motion that the caller has edited, or NULL */
  const char *broken;    /* read-only field that was edited, or NULL */
  bool have_limit;
  mps_dynamics_linear_limit limit; /* valid when have_limit */
  mpsi_dynamics_works works;
  struct mpsi_dynamics_change *change; /* Under way, or NULL */
  mps_snapshot *present;               /* of mps_dynamics_refresh, NULL before the first */
  mpsi_dynamics_bound_state limits;
  const mpsi_dynamics_keeper *keeper; /* life/state.c */
};

/* Boundary or load of a number; NULL where it is free. Numbers are below the counts. */
static inline int32_t mpsi_dynamics_boundary_count(const mps_dynamics *dynamics) {
  return dynamics->conditions[MPSI_BOUNDARIES].capacity;
}
static inline mpsi_dynamics_boundary *mpsi_dynamics_boundary_of(const mps_dynamics *dynamics,
                                                                int32_t number) {
  return dynamics->conditions[MPSI_BOUNDARIES].own[number];
}
static inline int32_t mpsi_dynamics_load_count(const mps_dynamics *dynamics) {
  return dynamics->conditions[MPSI_LOADS].capacity;
}
static inline mpsi_dynamics_load *mpsi_dynamics_load_of(const mps_dynamics *dynamics,
                                                        int32_t number) {
  return dynamics->conditions[MPSI_LOADS].own[number];
}

#endif
