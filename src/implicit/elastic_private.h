/* elastic_private.h - the members of mps_elastic and what its source files offer one another.
 *
 * lattice.c   sites, neighbours, n_i           operator.c  gradient and K u, matrix free
 * joints.c    faces between two materials
 * supports.c  fixed directions, free unknowns  rigid.c     which rigid motions are left free
 * loads.c     facets and nodal forces          assemble.c  the sparse matrix of free unknowns
 * system.c    factor, solve, refine            cholesky.c  CHOLMOD;  cg.c  conjugate gradients
 * stress.c    stresses, sections, energy       newmark.c, modes.c  dynamics
 *
 * Vectors over all particles are indexed [i * dim + c], i being the particle's id: sorting the set
 * does not matter. Vectors of free unknowns hold the local directions that no support fixes.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_ELASTIC_PRIVATE_H
#define MPSI_ELASTIC_PRIVATE_H

#include "cholesky.h"
#include "core/internal.h"

#include <mps/elastic.h>

#define MPSI_STENCIL_MAX 64 /* sites of one gradient: a disc of radius < 4 has 45 */
#define MPSI_CHUNK 2048     /* particles of one unit of parallel work */

/* Neighbours on the lattice, by offset. */
typedef struct mpsi_links {
  int32_t count;      /* offsets shorter than re; offset k and count - 1 - k are opposite */
  int32_t (*step)[3]; /* lattice units */
  double *weight;     /* w(r) */
  double *r2;         /* r^2, m2 */
  bool *far;          /* more than one cell along some axis */
  int32_t face[3][2]; /* which offset is one step down (0) or up (1) along an axis */
  int64_t *to;        /* to[i * count + k]: the neighbour, or -1 */
} mpsi_links;

/* The supports of one particle. `basis` has the fixed directions first, then free ones, all
 * orthonormal; `fixed` are the displacements along the first `count`. */
typedef struct mpsi_support {
  int64_t particle;
  int32_t count;
  double normal[3][3], value[3]; /* as given: normal . u = value, normals of unit length */
  double basis[3][3];            /* basis[c] is direction c */
  double fixed[3];
} mpsi_support;

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

struct mps_elastic {
  mps_context *context;
  mps_particles *particles;
  mps_elastic_def def;
  int32_t dim, modes; /* modes: rigid motions, 3 or 6 */
  bool conservative;  /* method */
  int64_t n;
  double spacing;

  double *x; /* reference positions, n * dim */
  mpsi_links links;
  double *density; /* n_i */
  double density0; /* n0 */
  uint8_t *faces;  /* which face neighbours exist: bit 2 * axis + up */
  uint8_t *cut;    /* bit 2 * axis + (side > 0) */
  double *volume;  /* V_i, cuts and thickness included, m3 */
  double *lambda, *mu, *poisson;
  double *kappa; /* pair stiffness of particle i: a pair has (kappa_i + kappa_j) w / r^2 */

  mpsi_joint *joints; /* ascending in `low`, then axis */
  int64_t joint_count;
  int64_t *joint_at;     /* [i * 2 dim + 2 axis + up], or -1; NULL without joints */
  double *joint_scratch; /* joints * dim */

  mpsi_support *supports;
  int64_t support_count, support_capacity;
  int64_t *support_of; /* index in supports, or -1 */

  mpsi_facet *facets;
  int64_t facet_count;

  double *load;         /* nodal forces, n * dim */
  double *displacement; /* n * dim */
  double *reaction;     /* n * dim */
  double *gradient;     /* scratch of the operator: n * dim * dim */
  double *stress_work;  /* scratch of the operator: n * dim * dim */
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
  double *mass;           /* n, or NULL until dynamics asks for it */
  mps_elastic_report report;

  struct mpsi_motion *motion; /* NULL: no dynamics under way */
};

/* ---- lattice.c --------------------------------------------------------------------------------
 */
/* Fills links, density and density0 from x; every fault is reported for `function`. */
mps_status mpsi_elastic_connect(mps_elastic *e, const char *function);
void mpsi_elastic_disconnect(mps_elastic *e);

/* ---- operator.c -------------------------------------------------------------------------------
 */
/* Coefficient (a vector of dim values, 1/m) of neighbour k in the gradient at i. */
void mpsi_elastic_coefficient(const mps_elastic *e, int64_t i, int32_t k, double *g);
/* All sites of the plain gradient at i: G_i u = sum_a u[site a] (x) g[a]; site 0 is i itself. Face
 * values are means: joints come on top. */
int32_t mpsi_elastic_stencil(const mps_elastic *e, int64_t i, int64_t *sites, double (*g)[3]);
/* f += G_i^T moment, moment[c][b] (N m): a load's first moment about particle i. */
void mpsi_elastic_spread(const mps_elastic *e, int64_t i, const double (*moment)[3], double *f);
/* Displacement gradients G[(i * dim + c) * dim + b] = d u_c / d x_b. */
void mpsi_elastic_gradients(mps_elastic *e, const double *u, double *gradient);
/* f = K u. */
void mpsi_elastic_apply(mps_elastic *e, const double *u, double *f);
/* ---- joints.c ---------------------------------------------------------------------------------
 */
/* Finds the joints of the present material; the pattern of the matrix ends where they changed. */
mps_status mpsi_elastic_find_joints(mps_elastic *e, const char *function);
void mpsi_elastic_drop_joints(mps_elastic *e);
mpsi_joint_law mpsi_elastic_joint_law(const mps_elastic *e, const mpsi_joint *q);
double mpsi_elastic_face_weight(const mps_elastic *e, int64_t i, int axis, int up);
/* From plain gradients to those with the face values of joints. */
void mpsi_elastic_joint_gradients(mps_elastic *e, const double *u, double *gradient);
/* Its transpose: P = dPi/dG to the stresses of plain gradients, and forces. */
void mpsi_elastic_joint_forces(mps_elastic *e, double *stress, double *f);
/* The gradient at i with all its coefficients. */
void mpsi_elastic_wide_gradient(const mps_elastic *e, int64_t i, mpsi_wide *w);
/* Has i a face that is a joint? */
static inline bool mpsi_elastic_at_joint(const mps_elastic *e, int64_t i) {
  if (!e->joint_at) return false;
  for (int face = 0; face < 2 * e->dim; face++)
    if (e->joint_at[i * 2 * e->dim + face] >= 0) return true;
  return false;
}
/* Does the pair of i and its neighbour j at offset k, farther than one cell along some axis, reach
 * across a joint? The mean of its ends' gradients is then not that of its path. */
bool mpsi_elastic_pair_crosses(const mps_elastic *e, int64_t i, int64_t j, int32_t k);
/* Stiffness of the pair of i and its neighbour j at offset k: energy 1/2 s |.|^2. Between two
 * materials with the harmonic mean of their shear moduli. */
static inline double mpsi_elastic_bond(const mps_elastic *e, int64_t i, int64_t j, int32_t k) {
  double kappa = e->kappa[i] + e->kappa[j];
  if (e->joint_at) {
    const double a = e->mu[i], b = e->mu[j];
    if (a != b) kappa = 2.0 * (e->kappa[i] * b + e->kappa[j] * a) / (a + b);
    if (e->links.far[k] && mpsi_elastic_pair_crosses(e, i, j, k)) return 0.0;
  }
  return kappa * e->links.weight[k] / e->links.r2[k];
}
/* Relative displacement of pair (i, k) that its stiffness works on, from u and the gradients. */
void mpsi_elastic_stretch(const mps_elastic *e, const double *u, int64_t i, int32_t k, double *out);
/* Particles of chunk `chunk`: [*first, *last). */
static inline void mpsi_elastic_chunk(const mps_elastic *e, int64_t chunk, int64_t *first,
                                      int64_t *last) {
  *first = chunk * MPSI_CHUNK;
  *last = *first + MPSI_CHUNK < e->n ? *first + MPSI_CHUNK : e->n;
}
static inline int64_t mpsi_elastic_chunks(const mps_elastic *e) {
  return (e->n + MPSI_CHUNK - 1) / MPSI_CHUNK;
}

/* ---- supports.c -------------------------------------------------------------------------------
 */
/* Numbers the free unknowns. */
void mpsi_elastic_number(mps_elastic *e);
/* Unit vector of local direction c of particle i. */
void mpsi_elastic_direction(const mps_elastic *e, int64_t i, int32_t c, double *out);
/* u += the prescribed displacements (prescribed true), and those of the free unknowns. */
void mpsi_elastic_expand(const mps_elastic *e, const double *free_values, bool prescribed,
                         double *u);
/* The free components of a vector over all particles. */
void mpsi_elastic_reduce(const mps_elastic *e, const double *f, double *free_values);
/* Keeps only the components of f along fixed directions. */
void mpsi_elastic_keep_fixed(const mps_elastic *e, double *f);

/* ---- rigid.c ----------------------------------------------------------------------------------
 */
/* MPS_ERROR_STATE naming the rigid motions that the supports leave free. */
mps_status mpsi_elastic_check_supported(mps_elastic *e, const char *function);

/* ---- loads.c ----------------------------------------------------------------------------------
 */
mps_status mpsi_elastic_find_facets(mps_elastic *e, const char *function);
/* Resultant of nodal forces. */
void mpsi_elastic_resultant(const mps_elastic *e, const double *f, const double *about,
                            double *force, double *moment);

/* ---- elastic.c --------------------------------------------------------------------------------
 */
/* Reads `density` into mass. */
mps_status mpsi_elastic_read_mass(mps_elastic *e, const char *function);
/* Volumes and pair stiffnesses from cuts and material. */
void mpsi_elastic_measure(mps_elastic *e);
/* Writes components [0, components) of field `name` from values[i * components + c]. */
mps_status mpsi_elastic_write(mps_elastic *e, const char *function, const char *name,
                              const double *values, int32_t components);
mps_status mpsi_elastic_read(mps_elastic *e, const char *function, const char *name, double *values,
                             int32_t components);

/* ---- assemble.c -------------------------------------------------------------------------------
 */
mps_status mpsi_elastic_assemble(mps_elastic *e, const char *function);

/* ---- system.c ---------------------------------------------------------------------------------
 */
mps_status mpsi_elastic_prepare(mps_elastic *e, const char *function);
/* Makes sure that the factor is that of K + shift * M. */
mps_status mpsi_elastic_factor(mps_elastic *e, const char *function, double shift);
/* solution = (K + shift M)^-1 rhs for `count` right-hand sides, free unknowns. */
mps_status mpsi_elastic_backsolve(mps_elastic *e, const char *function, int64_t count,
                                  const double *rhs, double *solution);

/* ---- cg.c -------------------------------------------------------------------------------------
 */
mps_status mpsi_elastic_cg(mps_elastic *e, const char *function, double shift, const double *rhs,
                           double *solution);

/* ---- newmark.c --------------------------------------------------------------------------------
 */
void mpsi_elastic_end_motion(mps_elastic *e);

#endif
