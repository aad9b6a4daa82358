/* dynamics_private.h - the members of the explicit MPS solver, and its files:
 *
 *   structure.c   order, pairs, mesh and arrays of the set's particles
 *   batch.c       pairs of a batch of blocks at a time; mesh.c arranges them
 *   present.c     the present state as every part reads it: time, velocity, mass
 *   coefficients.c  what forces need of the ground, particle by particle
 *   ground.c      what the body is made of; fields that the caller edits
 *   partition.c   the part of one rank in a body that lies on several
 *   change.c      change of the set, by a removal or the restoration of a state
 *   removal.c     particles that leave between two steps
 *   begin.c       the initial state, and what the fields show of the present one
 *   dt.c          the length of the time step
 *   step.c        the step: forces (kernels.c), loads, dashpots, what is held or driven, budget
 *   constrain.c   dashpots and held or driven degrees of freedom around a step
 *   selection.c   which particles a boundary or load is on
 *   boundary.c    boundaries: definitions, lists, reactions
 *   loads.c       loads: definitions, the forces of a step
 *   budget.c      energies and momenta, works of a step
 *   run.c         step and run as the caller sees them, hooks, callbacks
 *   limit.c       the stability limit; tangent.c, lattice.c its operators
 *   state.c       snapshots and checkpoints; files.c checkpoints of several ranks
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_DYNAMICS_PRIVATE_H
#define MPSI_DYNAMICS_PRIVATE_H

#include "core/base/exact.h"
#include "core/context/guard.h"
#include "core/particles/particles_internal.h"
#include "core/state/state.h"
#include "domain/halo.h"
#include "dynamics/step/kernels.h"
#include "dynamics/pairs/layout.h"
#include "dynamics/pairs/mesh.h"

#include <mps/dynamics.h>
#include <mps/io.h>

#define MPSI_DYN_LEAST_DT 1e-12 /* s */
#define MPSI_DYN_MOST_DT 1e9
#define MPSI_DYN_MOST_SPACINGS 1e9 /* extent of a set: positions keep a millionth of a spacing */

/* Selection of a boundary or load: particles, signals of x and y. */
typedef struct mpsi_dynamics_part {
  int64_t *id; /* as defined, also of removed particles */
  int64_t listed;
  int64_t count;
  int32_t *particle; /* present indices of the remaining particles, ascending */
  int64_t total;     /* when it was defined, on all ranks */
  mps_signal *signal[2];
  double factor[2];
} mpsi_dynamics_part;

typedef struct mpsi_dynamics_boundary {
  mpsi_dynamics_part part;
  int32_t kind;
  uint32_t dofs;                   /* held or driven */
  int32_t normal;                  /* viscous */
  double density, shear, pressure; /* viscous: of the half space, NaN: of each particle */
  /* At the end of the step under way, driven: factor times displacement and velocity of the signal;
   * at its start: factor times acceleration; viscous: factor times velocity. 0 without signal. */
  double reach[3], speed[3], gain[3], incoming[3];
  /* Sums: of the last step (N s, N m s), and since it was made, the latter with the work (J). Terms
   * are summed within a block of particles, and blocks exactly, on any number of ranks. */
  mpsi_exact pushed[3], impulse[3]; /* x, y, moment about the origin */
  mpsi_exact work;
  double kick;                     /* s that the last step's forces acted for, 0: no step yet */
  double block_sum[3], block_work; /* of one block, on their way into the sums */
  int64_t block;
} mpsi_dynamics_boundary;

typedef struct mpsi_dynamics_load {
  mpsi_dynamics_part part;
  int32_t kind;
  double amount[2]; /* traction: N a particle; body: m/s2 */
  double now[2];    /* factor times signal at the start of the step under way */
} mpsi_dynamics_load;

/* A prescribed (held or driven) degree of freedom. */
typedef struct mpsi_dynamics_bound {
  int32_t particle, component; /* 0 x, 1 y, 2 rotation */
  int32_t boundary;
  double rest;   /* its displacement (m, rad) less `reach` of the boundary */
  double at;     /* its displacement before the step, m, rad */
  double before; /* its velocity before the step, m/s, rad/s */
  double force;  /* on the particle in the last step, N, N m */
  double c, s;   /* rotation: its trigonometry (mpsi_dynamics_state) */
} mpsi_dynamics_bound;

/* A dashpot on one component of one particle: acceleration c (target - v). */
typedef struct mpsi_dynamics_dashpot {
  int32_t particle, component;
  int32_t boundary;              /* or -1: between the body and a free-field column */
  int32_t partner;               /* free-field particle whose velocity is the target, or -1 */
  bool idle;                     /* the degree of freedom is prescribed */
  double c;                      /* 1/s */
  double before, partner_before; /* velocities before the step, m/s */
  double force;                  /* on the particle in the last step, N */
} mpsi_dynamics_dashpot;

/* Prescribed degrees of freedom and dashpots of all boundaries. */
typedef struct mpsi_dynamics_lists {
  mpsi_dynamics_bound *bound;
  mpsi_dynamics_dashpot *dashpot;
  int64_t bounds, dashpots;
  int32_t *owner; /* 1 + the boundary that has each degree of freedom, component by component */
} mpsi_dynamics_lists;

/* Structure of the set's particles: the solver's present one lies in its own members. */
#define MPSI_DYN_SLAB_COLUMNS 15
typedef struct mpsi_dynamics_structure {
  int64_t count, body, pairs;
  bool lattice;
  mpsi_dynamics_mesh mesh;
  double *slab, *scratch, *part;
  int64_t stride, room; /* of the slab: from column to column, pair slots */
  int32_t *bad;
  mpsi_dynamics_dashpot *column_dashpot;
  int64_t column_dashpots;
  int64_t ghosts;  /* particles of other ranks, behind the own ones */
  mpsi_halo *halo; /* exchange of their values; NULL: one rank */
} mpsi_dynamics_structure;

/* Extremes over all particles, of all ranks. */
typedef struct mpsi_dynamics_extremes {
  double mu, lambda, lightest; /* most, most (Pa), least density (kg/m3) */
  double alpha[2], beta[2];    /* least and most */
} mpsi_dynamics_extremes;

/* Works and energies, J, since the state began. */
typedef struct mpsi_dynamics_works {
  mpsi_exact loads, boundaries, damping;
  double start; /* kinetic and strain energy at the start */
  double part;  /* of one block, on its way into `boundaries` */
  int64_t block;
} mpsi_dynamics_works;

struct mps_dynamics {
  mps_context *context;
  mps_particles *particles;
  mpsi_holder holder;              /* of the particles */
  mps_dynamics_def def;            /* with a share in the material */
  mps_kernel *kernel;              /* w(r), shared */
  double spacing, radius, density; /* D, re (m), n0 */
  mps_domain *domain;              /* shared; NULL: none */
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

  /* boundaries and loads: by number, NULL where free */
  mpsi_dynamics_boundary **boundary;
  mpsi_dynamics_load **load;
  int32_t boundary_room, load_room;
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
  bool diverged;
  bool begun;   /* works.start is known */
  bool no_rate; /* restoring_old is of former moduli: damping has no rate yet */
  mpsi_guard guard;
  bool unread;           /* material fields have been edited, and are not consistent so far */
  bool cautious;         /* a rank has a signal that may fail: ranks agree before each step */
  bool begins;           /* the motion was edited on a rank; the next step starts from it */
  const char *rewritten; /* field of the motion that the caller has edited, or NULL */
  const char *broken;    /* read-only field that was edited, or NULL */
  bool have_limit;
  mps_dynamics_linear_limit limit; /* valid when have_limit */
  mpsi_dynamics_works works;
  struct mpsi_identity *identity;      /* state.c */
  struct mpsi_dynamics_change *change; /* change.c: under way, or NULL */
  mps_snapshot *present;               /* of mps_dynamics_refresh, NULL before the first */
};

/* ---- present.c ---- */

/* MPS_ERROR_STATE when a call of the solver is under way. */
mps_status mpsi_dynamics_enter(mps_dynamics *dynamics, const char *function);
/* Column of a field that the solver has added itself: never NULL. */
double *mpsi_dynamics_column(const mps_dynamics *dynamics, const char *name, int32_t component);
/* Velocity of a degree of freedom (component 0, 1, 2) half a step before the present state (Euler:
 * of it). */
double mpsi_dynamics_velocity(const mps_dynamics *dynamics, int32_t component, int64_t k);
/* Mass (kg) or moment of inertia (kg m2) of a degree of freedom. */
double mpsi_dynamics_mass(const mps_dynamics *dynamics, int32_t component, int64_t k);
/* Body or material have changed: the limit and the dt derived from it are invalid. */
void mpsi_dynamics_forget_limit(mps_dynamics *dynamics);
/* Allocates the arrays of the energy budget, once. False: out of memory. */
bool mpsi_dynamics_reserve_accounts(mps_dynamics *dynamics);
/* Arrays for the dissipation of Rayleigh damping. */
mps_status mpsi_dynamics_reserve_watch(mps_dynamics *dynamics, const char *function);

/* ---- coefficients.c ---- */

/* Coefficients of each particle, from its fields; returns whether one has changed. */
bool mpsi_dynamics_set_coefficients(mps_dynamics *dynamics);
void mpsi_dynamics_choose_damping(mps_dynamics *dynamics); /* from the extremes */

/* ---- structure.c ---- */

/* Adds the fields that the solver writes. */
mps_status mpsi_dynamics_add_fields(mps_dynamics *dynamics, const char *function);
/* Sorts the set. */
mps_status mpsi_dynamics_sort(mps_dynamics *dynamics, const char *function);
/* Makes the structure of sorted particles, of the set or of `geometry`. On an error nothing else
 * has changed. */
mps_status mpsi_dynamics_make_structure(mps_dynamics *dynamics, const char *function,
                                        const mpsi_dynamics_geometry *geometry,
                                        mpsi_dynamics_structure *out);
/* Sorted particles of the solver's body at these reference positions. */
mpsi_dynamics_geometry mpsi_dynamics_geometry_of(const mps_dynamics *dynamics, int64_t count,
                                                 const double *x, const double *y,
                                                 const int64_t *side);
/* Identifies the pairs of a body: a hash of the reference positions, 32 bits. */
int64_t mpsi_dynamics_hash_positions(int64_t count, const double *x, const double *y);
void mpsi_dynamics_free_structure(mps_dynamics *dynamics, mpsi_dynamics_structure *structure);
/* Puts it in place of the solver's own, which is released; finds columns and coefficients. */
void mpsi_dynamics_use_structure(mps_dynamics *dynamics, mpsi_dynamics_structure *structure);
/* Finds the columns of the fields in the set. */
void mpsi_dynamics_bind(mps_dynamics *dynamics);

/* ---- change.c ---- */

/* New structure for other particles, made beside the present one, which it then replaces. */
typedef struct mpsi_dynamics_change {
  int32_t *now; /* of a removal: new index of each particle, -1: removed; else NULL */
  mpsi_dynamics_structure structure;
  mpsi_dynamics_lists lists;     /* room */
  double *force, *before, *drag; /* each NULL where the solver has none */
  double energy;                 /* of a removal: J, before */
} mpsi_dynamics_change;
/* Makes dynamics->change for sorted particles. */
mps_status mpsi_dynamics_prepare_change(mps_dynamics *dynamics, const char *function,
                                        const mpsi_dynamics_geometry *geometry);
/* Replaces the present structure, once the set has those particles: cannot fail. */
void mpsi_dynamics_use_change(mps_dynamics *dynamics);
void mpsi_dynamics_drop_change(mps_dynamics *dynamics);
/* Structure of a former state (core/state.h). */
mps_status mpsi_dynamics_prepare_state(void *solver, const char *function, const mps_snapshot *from,
                                       const char *source, mps_status disagreement);

mps_status mpsi_dynamics_add_reference(mps_dynamics *dynamics, const char *function);
mpsi_dynamics_geometry mpsi_dynamics_present_geometry(const mps_dynamics *dynamics);
mps_status mpsi_dynamics_allocate(mps_dynamics *dynamics, const char *function,
                                  mpsi_dynamics_structure *out);

/* ---- partition.c: of a domain of several ranks; collective ---- */

/* Keeps this rank's part of the sorted set; the rest is in *former. `status` is that of this rank
 * so far. */
mps_status mpsi_dynamics_take_partition(mps_dynamics *dynamics, const char *function,
                                        mps_status status, mpsi_dynamics_structure *out,
                                        mpsi_storage **former, mpsi_backup *backup);
/* deal.c: the first particle of a body of so many that rank `rank` has. */
int64_t mpsi_dynamics_first_of_rank(int64_t body, int64_t rank, int64_t ranks);
/* deal.c: for a set in parts, which it sorts, the halo of a rank. Arrays are indexed by local
 * numbers: blocks ascend as in the whole body. */
typedef struct mpsi_dynamics_window {
  int64_t count, whole; /* local numbers, those of missing particles counted; particles of all */
  int64_t first, last;  /* own ones */
  int64_t *block;       /* its number in the whole body, by block here */
  int64_t *near, nears; /* particles of the search for pairs, ascending */
  double *x, *y;        /* m */
  int64_t *side;        /* all 0: there are no free-field columns */
  double edge[2];       /* x of the whole body's outermost particles, m */
} mpsi_dynamics_window;
mps_status mpsi_dynamics_deal(mps_dynamics *dynamics, const char *function,
                              mpsi_dynamics_window *out);
/* Present displacement and rotation of ghosts; nothing to do on one rank. */
mps_status mpsi_dynamics_bring_motion(mps_dynamics *dynamics, const char *function);
/* After mpsi_dynamics_set_coefficients: those of ghosts, extremes, kind of damping. */
mps_status mpsi_dynamics_join_coefficients(mps_dynamics *dynamics, const char *function,
                                           mps_status status);

/* ---- files.c: checkpoints of several ranks ---- */

mps_status mpsi_dynamics_save_partitions(mps_dynamics *dynamics, const mpsi_state_of *of,
                                         const char *function, const char *path,
                                         const mps_checkpoint *info);
mps_status mpsi_dynamics_take_values(void *solver, const char *function, mps_status status,
                                     mps_snapshot *values);

/* ---- removal.c: the holder's functions ---- */

mps_status mpsi_dynamics_remove(void *self, const char *function, int64_t count,
                                const int64_t *ids);
void mpsi_dynamics_renew(void *self);

/* ---- ground.c ---- */

mps_status mpsi_dynamics_check_ground(mps_particles *particles, const char *function);
/* Writes wave velocities of `count` particles, or of all (0, NULL): all or nothing. */
mps_status mpsi_dynamics_write_material(mps_particles *particles, const char *function,
                                        const mps_material *material, int64_t count,
                                        const int64_t *ids);
/* Kinetic and strain energy of the budget: 0 before it starts. A change of the body between steps
 * shifts the budget's initial value by the difference. Fails with a domain only. */
mps_status mpsi_dynamics_present_energy(mps_dynamics *dynamics, const char *function,
                                        double *energy);
/* The holder's commit: a field has been edited. */
mps_status mpsi_dynamics_commit(void *self, const char *function, const char *field,
                                const double *former);
/* Before a step: reads edited material fields, and finds whether the motion was edited (begins), or
 * returns the error of either. `status` is this rank's so far. */
mps_status mpsi_dynamics_reread_ground(mps_dynamics *dynamics, const char *function,
                                       mps_status status);
/* Before a query of the state: both. */
mps_status mpsi_dynamics_read_edits(mps_dynamics *dynamics, const char *function,
                                    mps_status status);

/* ---- begin.c, dt.c, run.c ---- */

/* Begins a new history from displacement, rotation, velocity and spin. */
mps_status mpsi_dynamics_begin(mps_dynamics *dynamics, const char *function, double time);
#define MPSI_DYNAMICS_FASTEST                                                                      \
  1e100 /* m/s, also of the spin times the spacing: of no greater speed                            \
           is the kinetic energy a number */
/* Brings position, velocity, spin and reaction up to date. */
void mpsi_dynamics_publish(mps_dynamics *dynamics);
/* Chooses dt where the definition does not give it, and warns of one above the limit. */
mps_status mpsi_dynamics_choose_dt(mps_dynamics *dynamics, const char *function);
/* run.c: MPS_ERROR_STATE when the run has diverged. */
mps_status mpsi_dynamics_check_diverged(const mps_dynamics *dynamics, const char *function);
/* run.c: MPS_ERROR_STATE when a call is under way or the run has diverged; reads edited material
 * fields and chooses dt if need be. */
mps_status mpsi_dynamics_ready(mps_dynamics *dynamics, const char *function);

/* ---- step.c ---- */

/* Evaluates all signals for the next step, of `length`: an error has changed nothing, and is that
 * of all ranks. */
mps_status mpsi_dynamics_look_ahead(mps_dynamics *dynamics, const char *function, double length);
/* Takes `count` steps of `length`; the last writes accelerations when `output`. On an error of a
 * signal the step is not made. */
mps_status mpsi_dynamics_advance(mps_dynamics *dynamics, const char *function, int64_t count,
                                 double length, bool output);

/* ---- selection.c ---- */

/* Selects the particles of a definition. `all`: neither list nor box selects all. */
typedef struct mpsi_dynamics_selection {
  const int64_t *ids;
  int64_t id_count;
  const double *lower, *upper;
  mps_signal *const *signal;
  const double *factor;
  bool all;
} mpsi_dynamics_selection;
/* Selection by the members that the definitions of boundaries and loads share. */
#define MPSI_DYNAMICS_SELECTION(def, everything)                                                   \
  {                                                                                                \
    .ids = (def).ids, .id_count = (def).id_count, .lower = (def).lower, .upper = (def).upper,      \
    .signal = (def).signal, .factor = (def).factor, .all = (everything)                            \
  }
/* Status of all ranks, and whether all definitions are the same: the selection, which is added to
 * the list, and the list. */
mps_status mpsi_dynamics_agree_definition(mps_dynamics *dynamics, const char *function,
                                          mps_status status, const mpsi_dynamics_selection *s,
                                          mpsi_given *list);
/* Collective, as all definitions of boundaries and loads; `status` is that of this rank so far. */
mps_status mpsi_dynamics_select(mps_dynamics *dynamics, const char *function, mps_status status,
                                const mpsi_dynamics_selection *selection, mpsi_dynamics_part *out);
/* Room for `slot` in an array of pointers to boundaries or loads, of which there are `room`. */
mps_status mpsi_dynamics_reserve_slot(mps_dynamics *dynamics, const char *function, int32_t slot,
                                      void **slots, int32_t *room);
/* MPS_ERROR_ARGUMENT where `what` (boundary, load) of a number is not there. */
mps_status mpsi_dynamics_check_there(const mps_dynamics *dynamics, const char *function,
                                     const char *what, bool there, int32_t number);
/* Finds its particles in the present set. */
void mpsi_dynamics_find_part(const mps_dynamics *dynamics, mpsi_dynamics_part *part);
void mpsi_dynamics_release_part(mps_dynamics *dynamics, mpsi_dynamics_part *part);

/* ---- boundary.c ---- */

/* Lists prescribed degrees of freedom and dashpots, without changes of the state. */
mps_status mpsi_dynamics_list_boundaries(mps_dynamics *dynamics, const char *function);
/* Sets the present state as the initial one of prescribed degrees of freedom. */
mps_status mpsi_dynamics_take_bounds(mps_dynamics *dynamics, const char *function);
void mpsi_dynamics_free_boundaries(mps_dynamics *dynamics);
/* Room for the lists of the present boundaries on a body of `particles` and so many dashpots of
 * free-field columns; then, when nothing can fail any more, the lists themselves. */
mps_status mpsi_dynamics_reserve_lists(mps_dynamics *dynamics, const char *function,
                                       int64_t particles, int64_t column_dashpots,
                                       mpsi_dynamics_lists *out);
void mpsi_dynamics_use_lists(mps_dynamics *dynamics, mpsi_dynamics_lists *room);
void mpsi_dynamics_free_lists(mps_dynamics *dynamics, mpsi_dynamics_lists *lists);
/* Rates of all dashpots, from the fields. */
void mpsi_dynamics_renew_dashpots(mps_dynamics *dynamics);

/* ---- constrain.c ---- */

/* Evaluates the signals for a step from `now` to `then`: the only part of a step that can fail. */
mps_status mpsi_dynamics_evaluate_signals(mps_dynamics *dynamics, const char *function, double now,
                                          double then);
/* Status of all ranks, and MPS_ERROR_ARGUMENT where signals of boundaries or loads have given them
 * different values; in the same reduction the greatest of each of `values`, at most
 * MPSI_DOMAIN_ALONG - 2. Collective. */
mps_status mpsi_dynamics_agree_signals(mps_dynamics *dynamics, const char *function,
                                       mps_status status, int32_t count, double *values);
void mpsi_dynamics_dashpots_before(mps_dynamics *dynamics);
/* Begin and end of the sums of the boundaries' forces in a step. */
void mpsi_dynamics_begin_counting(mps_dynamics *dynamics);
void mpsi_dynamics_end_counting(mps_dynamics *dynamics, double kick);
void mpsi_dynamics_dashpots_after(mps_dynamics *dynamics, double kick, bool output);
void mpsi_dynamics_hold_bounds(mps_dynamics *dynamics, double kick, bool output);

/* ---- loads.c ---- */

mps_status mpsi_dynamics_evaluate_loads(mps_dynamics *dynamics, const char *function, double now);
/* Forces (N) on the particles in the coming step, component 0 or 1: a sum of up to two columns. */
typedef struct mpsi_dynamics_forces {
  const double *load[2], *external[2]; /* NULL: none */
  bool any;
} mpsi_dynamics_forces;
mpsi_dynamics_forces mpsi_dynamics_find_forces(mps_dynamics *dynamics);
/* Adds the contribution of loads to the step that block b has just taken. */
void mpsi_dynamics_apply_forces(mps_dynamics *dynamics, const mpsi_dynamics_forces *forces,
                                int64_t b, const mpsi_dynamics_step *step);
void mpsi_dynamics_free_loads(mps_dynamics *dynamics);

/* ---- budget.c ---- */

/* Terms of a step for the works. */
typedef struct mpsi_dynamics_account {
  mps_dynamics *dynamics;
  const mpsi_dynamics_forces *forces;
  const double *drag; /* NULL: dissipation of damping is not summed */
  double kick;
} mpsi_dynamics_account;
/* Keeps the velocities of a block's particles before a step; after it, adds up the works. */
void mpsi_dynamics_note_velocities(mps_dynamics *dynamics, int64_t block);
void mpsi_dynamics_count_works(mpsi_dynamics_account *account);

/* Kinetic and strain energy of the present state, J. */
mps_status mpsi_dynamics_energies(mps_dynamics *dynamics, const char *function, double *kinetic,
                                  double *strain);

/* ---- limit.c, tangent.c, lattice.c ---- */

/* y = S x, the symmetric tangent at the reference state: S = M^-1/2 K M^-1/2 over the 3 count
 * unknowns (x, y, rotation each in a row); held ones give 0. `weight` (NULL: 1) multiplies each
 * particle's pressure, its mean each pair's shear force. `work` has 4 (count + ghosts) doubles,
 * `weight` count + ghosts. Fails with a domain only. */
mps_status mpsi_dynamics_tangent_apply(mps_dynamics *dynamics, const char *function,
                                       const double *weight, const double *x, double *y,
                                       double *work);
/* Square of the highest eigenfrequency (rad/s)^2 of the infinite square lattice; `torque` as above;
 * `kernel` NULL: re/r - 1. */
double mpsi_dynamics_lattice_omega2(const mps_kernel *kernel, double spacing, double radius_ratio,
                                    double vs, double vp, double torque);
/* Largest stable dt of Verlet and leapfrog for a mode of frequency^2 omega2 (rad/s)^2. */
double mpsi_dynamics_damped_limit(double omega2, double alpha, double beta);

#endif
