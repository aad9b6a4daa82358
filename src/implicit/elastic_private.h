/* elastic_private.h - the members of mps_elastic and the interfaces between its source files.
 *
 * access.c    guard, ids, fields as vectors   body.c      material, cuts, derived data
 * lattice.c   sites, neighbours, n_i           gradient.c  the displacement gradient
 * window.c    the part that a rank has         operator.c  K u, matrix free
 * joints.c    faces between two materials      bending.c   bending within a cell; thin.c warns
 * supports.c  fixed directions, free unknowns  rigid.c     rigid motions without support
 * boundaries.c  prescribed displacements, reactions  facets.c    the surface
 * loads.c     nodal forces                     assemble.c  the sparse matrix of free unknowns
 * system.c    factor, solve, refine            cholesky.c  CHOLMOD;  cg.c  conjugate gradients
 * outside.c   a solver of the caller           partition.c  a rank's part of the operator
 * stress.c    stresses, sections, energy       motion.c, motion_state.c, budget.c,
 *                                              renewal.c, modes.c     dynamics
 * change.c    particles removed, or restored by a former state;  restart.c  that state
 *
 * Vectors over all particles are indexed [i * dim + c], i being the rank of the particle's id:
 * sorting the set does not matter. Vectors of free unknowns hold the local directions that no
 * support fixes. Arrays of the operator have the particles of the window (partition.c), indexed by
 * mpsi_elastic_slot(e, i). SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_ELASTIC_PRIVATE_H
#define MPSI_ELASTIC_PRIVATE_H

#include "core/particles/particles_internal.h"
#include "implicit/solve/cholesky.h"
#include "core/context/guard.h"
#include "core/internal.h"
#include "core/state/state.h"
#include "domain/domain_internal.h"

#include <mps/elastic_solver.h>

#define MPSI_STENCIL_MAX 64      /* sites of one gradient: a disc of radius < 4 has 45 */
#define MPSI_ELASTIC_LEAST 1e-30 /* of a positive quantity in SI units */
#define MPSI_ELASTIC_MOST 1e30
#define MPSI_ELASTIC_FURTHEST 1e100  /* m, m/s: energies are numbers */
#define MPSI_ELASTIC_STRONGEST 1e150 /* N on a particle, likewise */
#define MPSI_ELASTIC_CHUNK 2048      /* particles of one unit of parallel work */

/* Neighbours on the lattice, by offset. */
typedef struct mpsi_links {
  int32_t count;      /* offsets shorter than re; offset k and count - 1 - k are opposite */
  int32_t (*step)[3]; /* lattice units */
  double *weight;     /* w(r) */
  double *r2;         /* r^2, m2 */
  bool *far;          /* more than one cell along some axis */
  int32_t face[3][2]; /* which offset is one step down (0) or up (1) along an axis */
  int64_t *to;        /* to[slot * count + k]: the neighbour of the window's particle, or -1 */
} mpsi_links;

/* An interval of the order of layers (partition.c). */
typedef struct mpsi_span {
  int64_t from, to;
} mpsi_span;
#define MPSI_SPANS 9 /* own particles, and with 1 to 8 layers around them */

/* A boundary of the caller. */
typedef struct mpsi_elastic_boundary {
  bool used;
  int32_t kind;
  uint32_t dofs;
  double normal[3]; /* unit */
  int64_t count;
  int64_t *id;     /* count, also of removed particles */
  double *values;  /* count * 3, a roller's count; or NULL */
  int64_t present; /* of these, in the present body */
  mps_signal *signal[3];
  double factor[3];
  double motion[3][3]; /* factor * signal at the time driven to: [derivative][component] */
  mps_reaction reaction;
} mpsi_elastic_boundary;

/* The supports of one particle: rows normal . u = value, of unit length. `basis` has the fixed
 * directions first, then free ones, all orthonormal; `fixed` are displacement, velocity and
 * acceleration along the first `count`. */
typedef struct mpsi_support {
  int64_t particle;
  int32_t count;
  int32_t owner[3];  /* boundary of the row */
  int32_t signal[3]; /* component of the owner's motion */
  double normal[3][3], offset[3];
  double basis[3][3]; /* basis[c] is direction c */
  double fixed[3][3]; /* [derivative][direction] */
} mpsi_support;

/* Force and first moment int t_c (x - x_i)_b of a load on one cell, which may have been removed. */
typedef struct mpsi_patch {
  int64_t id;
  double force[3], moment[3][3];
} mpsi_patch;

typedef struct mpsi_elastic_load {
  bool used;
  int32_t kind;
  double force[3]; /* BODY, GRAVITY */
  mps_signal *signal[3];
  double factor[3], scale[3]; /* scale: factor times the signal's value, at the requested time */
  mpsi_patch *patches;
  int64_t count, capacity;
} mpsi_elastic_load;

/* Works since the motion began, or of the last static solution (J). */
typedef struct mpsi_ledger {
  double loads, boundaries;
  double inner; /* of K (u + a1 v): strain energy and stiffness damping together */
  double mass_damping;
  double left;            /* of the forces that the solutions leave unbalanced */
  double kinetic, strain; /* at the start */
} mpsi_ledger;

/* A face between cells of different material: `low` is below it along `axis`, `high` above. */
typedef struct mpsi_joint {
  int64_t low, high;
  int64_t axis;
} mpsi_joint;

/* Coefficients (m) of the face value's correction at a joint, see joints.c. */
typedef struct mpsi_joint_law {
  double normal, lateral, shear;
} mpsi_joint_law;

#define MPSI_WIDE_MAX                                                                              \
  20 /* sites of a gradient at joints: the particle, faces and edges of a cube */

/* A gradient whose components mix: G[row] = sum_s sum_f c[s][row][f] u[site s][f], row = c * dim +
 * b. */
typedef struct mpsi_wide {
  int32_t count;
  int64_t site[MPSI_WIDE_MAX];
  double c[MPSI_WIDE_MAX][9][3];
} mpsi_wide;

typedef struct mpsi_facet {
  int64_t particle;
  int8_t axis, side;
} mpsi_facet;

/* A solver of the caller. */
typedef struct mpsi_elastic_outside {
  mps_elastic_solver_def def;
  bool valid;      /* its matrix is the present one, K + shift M */
  double shift;    /* 1/s2 */
  double stiffest; /* the greatest of its values, N/m */
  int64_t nonzeros;
} mpsi_elastic_outside;

/* Rows of the particles [from, to) of the order of layers: all directions of each. */
typedef struct mpsi_elastic_rows {
  int64_t from, to;
  int64_t *start;
  int32_t *column;
  double *value;
} mpsi_elastic_rows;

struct mps_elastic {
  mps_context *context;
  mps_particles *particles;
  mpsi_holder holder; /* of the particles */
  mps_elastic_def def;
  int32_t dim, modes; /* modes: rigid motions, 3 or 6 */
  bool conservative;  /* method; else the published one */
  bool constant;      /* published: divided by n0, else by n_i */
  mpsi_guard guard;   /* of the running public function */
  bool within;        /* a step is running */
  bool warned_thin;   /* see thin.c */
  bool agreed;        /* of several ranks: they have agreed on the error of this function */
  int64_t *id;        /* of each particle, ascending */
  int64_t n;
  double spacing;

  double *x; /* reference positions, n * dim */
  mpsi_links links;
  double *density; /* n_i, of the window */
  double density0; /* n0 */
  uint8_t *faces;  /* which face neighbours exist: bit 2 * axis + up */
  uint8_t *cut;    /* bit 2 * axis + (side > 0) */
  double *volume;  /* V_i, cuts and thickness included, m3 */
  double *lambda, *mu, *poisson;
  double *kappa; /* of the window, pair stiffness: a pair has (kappa_i + kappa_j) w / r^2 */

  double *bending; /* N/m: [(slot * planes + plane) * dim + c], see bending.c; NULL: without */

  bool shared;         /* ranks solve together, and the window is not the whole body */
  int64_t *at, *place; /* order of layers: particles, and where each is; NULL: that of ids */
  mpsi_span span[MPSI_SPANS];
  mpsi_span window;

  mpsi_joint *joints; /* ascending in `low`, then axis */
  int64_t joint_count;
  int64_t *joint_at;     /* [slot * 2 dim + 2 axis + up], or -1; NULL without joints */
  double *joint_scratch; /* joints * dim */

  mpsi_elastic_boundary *boundaries;
  int32_t boundary_count;
  mpsi_support *supports;
  int64_t support_count;
  int64_t *support_of; /* index in supports, or -1 */

  mpsi_facet *facets;
  int64_t facet_count;

  mpsi_elastic_load *loads;
  int32_t load_count;
  mpsi_patch *spare; /* room for the patches of a load that is set */
  int64_t spare_capacity;
  double *load;         /* nodal forces, n * dim */
  double *displacement; /* n * dim */
  double *reaction;     /* n * dim */
  double *gradient;     /* scratch of the operator: window * dim * dim */
  double *stress_work;  /* scratch of the operator: window * dim * dim */
  double *work;         /* scratch: n * dim */

  /* The system of free unknowns; lower triangle in compressed columns. */
  int64_t unknowns;
  int64_t *dof; /* of local direction c of particle i, or -1 */
  int64_t *column, *row;
  double *value;
  bool pattern_valid, values_valid; /* of the matrix */
  mpsi_cholesky *cholesky;          /* with the symbolic factor once analysed */
  mpsi_cholesky_symbolic symbolic;
  bool analysed, factored;
  double factored_shift; /* the factor is that of K + shift * M */
  bool use_cg;
  double *rhs, *solution; /* unknowns each */
  double *cg_work;        /* 5 * unknowns, or NULL */
  double *mass;           /* n, or NULL until a motion needs it */
  mps_elastic_report report;

  mpsi_elastic_outside *outside; /* NULL: the library's own solvers */

  int64_t fabric[2]; /* fabric.c: hashes, where known */
  bool fabric_known;
  mpsi_identity *identity; /* of its snapshots */
  mpsi_ledger ledger;
  struct mpsi_elastic_motion *motion; /* NULL: no dynamics under way */
  struct mpsi_elastic_motion *ended;  /* by a removal: its numbers without arrays, or NULL */
  struct mpsi_elastic_change *change; /* change.c: under way, or NULL */
};

/* ---- partition.c
 * ----------------------------------------------------------------------------------
 */
/* Where the operator's arrays have particle i of the window. */
static inline int64_t mpsi_elastic_slot(const mps_elastic *e, int64_t i) {
  return e->place ? e->place[i] - e->window.from : i;
}
static inline int64_t mpsi_elastic_slots(const mps_elastic *e) {
  return e->window.to - e->window.from;
}
/* Particle k in the order of layers, and where i is in it. */
static inline int64_t mpsi_elastic_in_order(const mps_elastic *e, int64_t k) {
  return e->at ? e->at[k] : k;
}
static inline int64_t mpsi_elastic_place(const mps_elastic *e, int64_t i) {
  return e->place ? e->place[i] : i;
}
static inline bool mpsi_elastic_within(const mps_elastic *e, mpsi_span span, int64_t i) {
  const int64_t k = mpsi_elastic_place(e, i);
  return span.from <= k && k < span.to;
}
static inline const int64_t *mpsi_elastic_neighbours(const mps_elastic *e, int64_t i) {
  return e->links.to + mpsi_elastic_slot(e, i) * e->links.count;
}
/* Order, spans and window of e->shared, from positions. */
mps_status mpsi_elastic_open_window(mps_elastic *e, const char *function);
/* Collective where the body is shared: each value, given by one rank and -INFINITY on others (none
 * NaN), is sent to all. `status` is this rank's so far. */
MPS_NODISCARD mps_status mpsi_elastic_join(mps_elastic *e, const char *function, mps_status status,
                                           int64_t count, double *values);
/* The same for a vector over all particles, with the rows of each owner. */
MPS_NODISCARD mps_status mpsi_elastic_complete(mps_elastic *e, const char *function,
                                               double *values);

/* ---- lattice.c ------------------------------------------------------------------------------- */
/* Opens the window and fills links, density and density0 from x, with the other arrays of the
 * operator; errors are reported for `function`. */
mps_status mpsi_elastic_connect(mps_elastic *e, const char *function);
void mpsi_elastic_disconnect(mps_elastic *e);
/* Clears the pointers of both windows and of joints, which have been moved to another object. */
void mpsi_elastic_lose_window(mps_elastic *e);
/* Neighbours across faces of all particles, on any rank, by a temporary table of sites. */
typedef struct mpsi_sites mpsi_sites;
mps_status mpsi_elastic_open_sites(mps_elastic *e, const char *function, mpsi_sites **out);
void mpsi_elastic_close_sites(mps_elastic *e, mpsi_sites *sites);
int64_t mpsi_elastic_beside(const mpsi_sites *sites, int64_t i, int axis, int up);
/* n*_i of the published method: n_i, or n0. */
double mpsi_elastic_divisor(const mps_elastic *e, int64_t i);
/* Coefficient (a vector of dim values, 1/m) of neighbour k in the gradient at i. */
void mpsi_elastic_coefficient(const mps_elastic *e, int64_t i, int32_t k, double *g);
/* All sites of the plain gradient at i: G_i u = sum_a u[site a] (x) g[a]; site 0 is i itself. Face
 * values are means: joints come on top. */
int32_t mpsi_elastic_stencil(const mps_elastic *e, int64_t i, int64_t *sites, double (*g)[3]);

/* ---- gradient.c ---- */
/* f += G_i^T moment, moment[c][b] (N m): a load's first moment about particle i. */
void mpsi_elastic_spread(const mps_elastic *e, int64_t i, const double (*moment)[3], double *f);
/* Displacement gradients G[(slot * dim + c) * dim + b] = d u_c / d x_b, of own particles and the
 * layers that their pairs reach. */
void mpsi_elastic_gradients(mps_elastic *e, const double *u, double *gradient);

/* ---- operator.c ---- */
/* f = K u. Collective where the body is shared, and fails only with the domain. */
MPS_NODISCARD mps_status mpsi_elastic_apply(mps_elastic *e, const char *function, const double *u,
                                            double *f);
/* ---- joints.c -------------------------------------------------------------------------------- */
/* Finds the joints of the present material; discards the pattern of the matrix where they have
 * changed. */
mps_status mpsi_elastic_find_joints(mps_elastic *e, const char *function);
void mpsi_elastic_drop_joints(mps_elastic *e);
/* From plain gradients to those with the face values of joints. */
void mpsi_elastic_joint_gradients(mps_elastic *e, const double *u, double *gradient);
/* Its transpose: P = dPi/dG to the stresses of plain gradients, and forces. */
void mpsi_elastic_joint_forces(mps_elastic *e, double *stress, double *f);
/* The gradient at i with all its coefficients. */
void mpsi_elastic_wide_gradient(const mps_elastic *e, int64_t i, mpsi_wide *w);
/* Has i a face that is a joint? */
static inline bool mpsi_elastic_at_joint(const mps_elastic *e, int64_t i) {
  if (!e->joint_at) return false;
  const int64_t *joint = e->joint_at + mpsi_elastic_slot(e, i) * 2 * e->dim;
  for (int face = 0; face < 2 * e->dim; face++)
    if (joint[face] >= 0) return true;
  return false;
}
/* Does the pair of i and its neighbour j at offset k, farther than one cell along some axis, reach
 * across a joint? The mean of its ends' gradients is then not that of its path. */
bool mpsi_elastic_pair_crosses(const mps_elastic *e, int64_t i, int64_t j, int32_t k);
/* Stiffness of the pair of i and its neighbour j at offset k: energy 1/2 s |.|^2. Between two
 * materials with the harmonic mean of their shear moduli. */
static inline double mpsi_elastic_bond(const mps_elastic *e, int64_t i, int64_t j, int32_t k) {
  const double ki = e->kappa[mpsi_elastic_slot(e, i)], kj = e->kappa[mpsi_elastic_slot(e, j)];
  double kappa = ki + kj;
  if (e->joint_at) {
    const double a = e->mu[i], b = e->mu[j];
    if (a != b) kappa = 2.0 * (ki * b + kj * a) / (a + b);
    if (e->links.far[k] && mpsi_elastic_pair_crosses(e, i, j, k)) return 0.0;
  }
  return kappa * e->links.weight[k] / e->links.r2[k];
}
/* Relative displacement of pair (i, k), conjugate to its stiffness, from u and the gradients. */
void mpsi_elastic_stretch(const mps_elastic *e, const double *u, int64_t i, int32_t k, double *out);
/* ---- bending.c ------------------------------------------------------------------------------- */
#define MPSI_BENDING_MAX 48 /* terms of a row: 12 squares of 4 corners */
typedef struct mpsi_bending_term {
  int64_t site;
  double value[3]; /* couples equal components */
} mpsi_bending_term;
/* thin.c: warns once, before the first solution. */
mps_status mpsi_elastic_warn_of_thin_parts(mps_elastic *e, const char *function);
/* Is bending stiffness in use, in a body with joints or without? Its array, of this size, is made
 * with them (joints.c). */
bool mpsi_elastic_has_bending(const mps_elastic *e, bool joints);
int64_t mpsi_elastic_bending_size(const mps_elastic *e);
/* Stiffnesses of squares, from volumes and material. */
void mpsi_elastic_measure_bending(mps_elastic *e);
/* f += the forces of squares on particle p under the displacements u. */
void mpsi_elastic_bending_force(const mps_elastic *e, const double *u, int64_t p, double *f);
/* The row of particle p; the number of terms, of which several may have the same site. */
int32_t mpsi_elastic_bending_row(const mps_elastic *e, int64_t p, mpsi_bending_term *terms);
/* Particles of chunk `chunk` of the whole body: [*first, *last). */
static inline void mpsi_elastic_chunk(const mps_elastic *e, int64_t chunk, int64_t *first,
                                      int64_t *last) {
  *first = chunk * MPSI_ELASTIC_CHUNK;
  *last = *first + MPSI_ELASTIC_CHUNK < e->n ? *first + MPSI_ELASTIC_CHUNK : e->n;
}
static inline int64_t mpsi_elastic_chunks(const mps_elastic *e) {
  return (e->n + MPSI_ELASTIC_CHUNK - 1) / MPSI_ELASTIC_CHUNK;
}
/* lattice.c: work(task, k) for all k of [0, count), chunk by chunk in parallel; and for all
 * particles of a span. */
typedef void (*mpsi_elastic_work)(void *task, int64_t k);
void mpsi_elastic_for_each(mps_elastic *e, int64_t count, mpsi_elastic_work work, void *task);
void mpsi_elastic_for_span(mps_elastic *e, mpsi_span span, mpsi_elastic_work work, void *task);

/* ---- supports.c ------------------------------------------------------------------------------ */
/* Adds the row normal . u to the support of a particle, or replaces a parallel one. False: the
 * direction is fixed already by the others. */
bool mpsi_elastic_add_row(mpsi_support *s, int dim, const double *normal, double offset,
                          int32_t owner, int32_t signal);
/* Length of row r along direction c of its basis. */
double mpsi_elastic_row(const mpsi_support *s, int32_t r, int32_t c);
/* Numbers the free unknowns. */
void mpsi_elastic_number(mps_elastic *e);
/* Unit vector of local direction c of particle i. */
void mpsi_elastic_direction(const mps_elastic *e, int64_t i, int32_t c, double *out);
/* u += the prescribed displacements (prescribed true), and those of the free unknowns. */
void mpsi_elastic_expand(const mps_elastic *e, const double *free_values, bool prescribed,
                         double *u);
/* Replaces the components along fixed directions by those prescribed: displacements (derivative
 * 0), velocities (1), accelerations (2). */
void mpsi_elastic_impose(const mps_elastic *e, int derivative, double *values);
/* The free components of a vector over all particles. */
void mpsi_elastic_reduce(const mps_elastic *e, const double *f, double *free_values);
/* Keeps only the components of f along fixed directions. */
void mpsi_elastic_keep_fixed(const mps_elastic *e, double *f);

/* ---- boundaries.c ---------------------------------------------------------------------------- */
/* Prescribed displacements, velocities and accelerations become those of time t. */
mps_status mpsi_elastic_drive(mps_elastic *e, const char *function, double t);
/* Resultants of e->reaction by boundary; dt > 0: adds the mean of former and new ones times dt to
 * the impulses. */
void mpsi_elastic_count_reactions(mps_elastic *e, double dt);
/* Adds the work of `force` (n * dim, of fixed directions) over the displacements `du` by boundary,
 * and the change of kinetic energy of driven particles from v0 to v1 (NULL: statics); returns the
 * sum. */
double mpsi_elastic_count_work(mps_elastic *e, const double *force, const double *du,
                               const double *v0, const double *v1);
void mpsi_elastic_forget_reactions(mps_elastic *e);
void mpsi_elastic_drop_boundaries(mps_elastic *e);

/* Supports from the present boundaries. On an error the former ones stay. */
mps_status mpsi_elastic_make_supports(mps_elastic *e, const char *function);

/* ---- change.c -------------------------------------------------------------------------------- */
/* The holder's functions. */
mps_status mpsi_elastic_remove(void *self, const char *function, int64_t count, const int64_t *ids);
void mpsi_elastic_renew(void *self);
/* For a state to restore (core/state.h): prepares, then replaces the body by that of the state. */
mps_status mpsi_elastic_prepare_state(void *self, const char *function, const mps_snapshot *from,
                                      const char *source, mps_status disagreement);
void mpsi_elastic_bind(void *self);
void mpsi_elastic_drop_change(mps_elastic *e);

/* ---- rigid.c --------------------------------------------------------------------------------- */
/* MPS_ERROR_STATE, naming the rigid motions without support. */
mps_status mpsi_elastic_check_supported(mps_elastic *e, const char *function);

/* ---- facets.c -------------------------------------------------------------------------------- */
mps_status mpsi_elastic_find_facets(mps_elastic *e, const char *function);
/* The cell of particle i reaches from low to high (relative to the particle) along `axis`. */
void mpsi_elastic_reach(const mps_elastic *e, int64_t i, int axis, double *low, double *high);
/* The facet as a box relative to its particle. */
void mpsi_elastic_facet_box(const mps_elastic *e, const mpsi_facet *f, double *low, double *high);

/* ---- loads.c --------------------------------------------------------------------------------- */
/* With a load of gravity: reads `density` again, as mpsi_elastic_read_mass. */
mps_status mpsi_elastic_weigh(mps_elastic *e, const char *function, double **former);
/* The nodal forces of all loads and of `external_force` at time t, to e->load. */
mps_status mpsi_elastic_gather_loads(mps_elastic *e, const char *function, double t);
/* MPS_ERROR_ARGUMENT unless the point of moments (NULL: the origin) is finite. */
mps_status mpsi_elastic_check_about(const mps_elastic *e, const char *function,
                                    const double *about);
void mpsi_elastic_drop_loads(mps_elastic *e);
/* Resultant of nodal forces. */
void mpsi_elastic_resultant(const mps_elastic *e, const double *f, const double *about,
                            double *force, double *moment);

/* ---- elastic.c ------------------------------------------------------------------------------- */

/* ---- access.c ---- */
/* MPS_ERROR_STATE within a callback of the solver; until `leave` it is busy. */
mps_status mpsi_elastic_enter(mps_elastic *e, const char *function);
mps_status mpsi_elastic_leave(mps_elastic *e, mps_status status);
/* On several ranks: an error of one is that of all. All ranks make the same calls, up to the first
 * that returns an error; `leave` is the last. */
mps_status mpsi_elastic_agree(mps_elastic *e, const char *function, mps_status status);
/* The same, and MPS_ERROR_ARGUMENT where ranks have different values of `name`. */
mps_status mpsi_elastic_agree_given(mps_elastic *e, const char *function, mps_status status,
                                    const mpsi_given *list);
mps_status mpsi_elastic_agree_same(mps_elastic *e, const char *function, mps_status status,
                                   const char *name, double value);
/* For collective queries, also within a callback: e->agreed is restored afterwards. */
bool mpsi_elastic_begin_reading(mps_elastic *e);
/* For queries that use the scratch arrays: MPS_ERROR_STATE within a step. */
mps_status mpsi_elastic_check_between(const mps_elastic *e, const char *function);
/* The rank of an id, or -1; and ids in their order. */
int64_t mpsi_elastic_find(const mps_elastic *e, int64_t id);
void mpsi_elastic_sort_ids(int64_t count, int64_t *ids);
/* Writes components [0, components) of field `name` from values[i * components + c]. */
mps_status mpsi_elastic_write(mps_elastic *e, const char *function, const char *name,
                              const double *values, int32_t components);
mps_status mpsi_elastic_read(mps_elastic *e, const char *function, const char *name, double *values,
                             int32_t components);
/* Reads `density` into mass, *former: the masses before (after an error too, and nothing has
 * changed). mpsi_elastic_finish_mass ends this. */
mps_status mpsi_elastic_read_mass(mps_elastic *e, const char *function, double **former);
/* Frees the former masses, or on an error the new ones, and restores the former ones. */
void mpsi_elastic_finish_mass(mps_elastic *e, double *former, bool renewed);
/* MPS_ERROR_ARGUMENT that names the field, the particle and what is allowed. */
mps_status mpsi_elastic_bad_value(mps_elastic *e, const char *function, const char *name, int64_t i,
                                  double value, const char *allowed);

/* ---- body.c ---- */
/* The arrays of e->n particles; their values from ids, positions, cuts and material; and the
 * release of both. */
mps_status mpsi_elastic_allocate(mps_elastic *e, const char *function);
mps_status mpsi_elastic_make_body(mps_elastic *e, const char *function, bool moduli_known);
void mpsi_elastic_free_body(mps_elastic *e);
/* The definition's material to the fields, at creation. */
mps_status mpsi_elastic_add_material(mps_elastic *e, const char *function);
/* Moduli of particle i; MPS_ERROR_ARGUMENT naming one that is out of range. */
mps_status mpsi_elastic_set_moduli(mps_elastic *e, const char *function, int64_t i, double young,
                                   double poisson);

/* ---- window.c ---- */
/* Volumes and pair stiffnesses from cuts and material. */
void mpsi_elastic_measure(mps_elastic *e);
/* The window of the rank where all ranks of the domain solve together with the present solver, else
 * the whole body. */
mps_status mpsi_elastic_choose_window(mps_elastic *e, const char *function);

/* ---- assemble.c ------------------------------------------------------------------------------ */
mps_status mpsi_elastic_assemble(mps_elastic *e, const char *function);
/* Whole rows of K + shift M with numbered unknowns, whose arrays become the caller's (also on an
 * error); fixed directions have a diagonal alone. */
mps_status mpsi_elastic_assemble_rows(mps_elastic *e, const char *function, double shift,
                                      mpsi_elastic_rows *rows);
/* Without a matrix: numbers the unknowns and allocates their vectors. */
mps_status mpsi_elastic_make_vectors(mps_elastic *e, const char *function);

/* ---- outside.c ------------------------------------------------------------------------------- */
void mpsi_elastic_drop_outside(mps_elastic *e);
/* solution = (K + shift M)^-1 rhs. */
mps_status mpsi_elastic_solve_outside(mps_elastic *e, const char *function, double shift,
                                      const double *rhs, double *solution);

/* ---- system.c -------------------------------------------------------------------------------- */
mps_status mpsi_elastic_prepare(mps_elastic *e, const char *function);
/* Makes sure that the factor is that of K + shift * M. */
mps_status mpsi_elastic_factor(mps_elastic *e, const char *function, double shift);
/* solution = (K + shift M)^-1 rhs for `count` right-hand sides, free unknowns. */
mps_status mpsi_elastic_backsolve(mps_elastic *e, const char *function, int64_t count,
                                  const double *rhs, double *solution);

/* Vectors of `count` cases in the set's present order, three components a particle. */
void mpsi_elastic_to_caller(const mps_elastic *e, int64_t count, double *ours, double *out);

/* ---- cg.c ------------------------------------------------------------------------------------ */
mps_status mpsi_elastic_cg(mps_elastic *e, const char *function, double shift, const double *rhs,
                           double *solution);

/* ---- motion.c -------------------------------------------------------------------------------- */
typedef struct mpsi_elastic_motion {
  double dt, time;
  int64_t steps;
  double alpha_m, alpha_f, beta, gamma; /* of the family */
  double a0, a1;                        /* C = a0 M + a1 K */
  bool conserving;                      /* average acceleration */
  double *velocity, *acceleration;      /* n * dim, as all here */
  double *force;                        /* loads at the end of the last step */
  double *inner;                        /* K (u + a1 v) there */
  double *held;                         /* inner + a0 M v - force along fixed directions */
  double *next[5];                      /* of the step being made: MPSI_NEXT_U ... */
  double *scratch;
  int64_t fabric[2]; /* of the moduli and fixed directions to which inner, held and acceleration
                        belong (fabric.c) */
  bool strain_known; /* after a change of moduli: */
  double strain;     /* J, with those */
} mpsi_elastic_motion;
enum { MPSI_NEXT_U, MPSI_NEXT_V, MPSI_NEXT_A, MPSI_NEXT_INNER, MPSI_NEXT_HELD };

/* ---- fabric.c ---- */
enum { MPSI_FABRIC_MODULI, MPSI_FABRIC_SUPPORTS };
/* Hashes of moduli and fixed directions. */
void mpsi_elastic_find_fabric(mps_elastic *e, int64_t fabric[2]);
/* Strain energy at the end of the last step; `present`: with the present moduli, J. */
double mpsi_elastic_former_strain(mps_elastic *e, double present);

/* ---- renewal.c ---- */
/* inner = K (u + a1 v); held = inner + a0 M v - load along fixed directions. */
mps_status mpsi_elastic_find_forces(mps_elastic *e, const char *function, const double *u,
                                    const double *v, double *inner, double *held);
/* a = M^-1 (F - C v - K u) along free directions; that of the boundaries along fixed ones. */
void mpsi_elastic_balance(mps_elastic *e);
/* Before a step: the forces at its beginning, with the present moduli and boundaries. */
mps_status mpsi_elastic_renew_motion(mps_elastic *e, const char *function);

/* ---- motion_state.c ---- */
void mpsi_elastic_end_motion(mps_elastic *e);
/* Ends it, except for its numbers, which a rollback may need. */
void mpsi_elastic_suspend_motion(mps_elastic *e);
/* Arrays of e's particles; moving them to `to`; and their end. */
mps_status mpsi_elastic_allocate_motion(mps_elastic *e, const char *function,
                                        mpsi_elastic_motion *m);
void mpsi_elastic_move_arrays(mpsi_elastic_motion *from, mpsi_elastic_motion *to);
void mpsi_elastic_free_arrays(mps_elastic *e, mpsi_elastic_motion *m);

/* ---- budget.c -------------------------------------------------------------------------------- */
mps_status mpsi_elastic_strain_energy(mps_elastic *e, const char *function, double *out);
/* Before a change of moduli: keeps the strain energy of a motion under way. */
mps_status mpsi_elastic_note_strain(mps_elastic *e, const char *function);
/* At the start of a motion. */
mps_status mpsi_elastic_begin_ledger(mps_elastic *e, const char *function);
/* Statics, loaded in proportion from rest; e->work is the load less K u. */
void mpsi_elastic_count_solution(mps_elastic *e);
/* Works of a step to displacements u, velocities v, accelerations a and forces inner, held. */
void mpsi_elastic_count_step(mps_elastic *e, const double *u, const double *v, const double *a,
                             const double *inner, const double *held);

#endif
