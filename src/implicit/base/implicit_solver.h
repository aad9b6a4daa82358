/* implicit_solver.h - the implicit solver of thick elastic structures, put together from its parts:
 * each has a header of its own. Vectors over all particles are indexed [i * dim + c], i being the
 * rank of the particle's id: sorting the set does not matter. Vectors of free unknowns are the
 * local directions that no support fixes. Arrays of the operator have the particles of the window
 * (ranks/partition.h), indexed by mpsi_elastic_slot(e, i). SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/context/guard.h"
#include "core/internal.h"
#include "core/particles/particles_internal.h"
#include "core/state/state.h"
#include "domain/domain_internal.h"
#include "implicit/base/access.h"
#include "implicit/body/facets.h"
#include "implicit/body/joints.h"
#include "implicit/body/lattice.h"
#include "implicit/boundary/boundaries.h"
#include "implicit/boundary/loads.h"
#include "implicit/boundary/supports.h"
#include "implicit/operator/budget.h"
#include "implicit/ranks/partition.h"
#include "implicit/solve/cholesky.h"
#include "implicit/solve/outside.h"
#include "solver/solver_base.h"

#include <mps/elastic.h>

#define MPSI_ELASTIC_LEAST 1e-30 /* of a positive quantity in SI units */
#define MPSI_ELASTIC_MOST 1e30
#define MPSI_ELASTIC_FURTHEST 1e100  /* m, m/s: energies are numbers */
#define MPSI_ELASTIC_STRONGEST 1e150 /* N on a particle, likewise */
#define MPSI_ELASTIC_CHUNK 2048      /* particles of one unit of parallel work */

struct mps_elastic {
  MPSI_SOLVER_BASE;
  mps_elastic_def def;
  int32_t dim, modes; /* modes: rigid motions, 3 or 6 */
  bool conservative;  /* method; else the published one */
  bool constant;      /* published: divided by n0, else by n_i */
  bool within;        /* a step is running */
  bool warned_thin;   /* see thin.c */
  bool unread;        /* `young` or `poisson` have been edited since they were read */
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

  mpsi_support *supports;
  int64_t support_count;
  int64_t *support_of; /* index in supports, or -1 */

  mpsi_facet *facets;
  int64_t facet_count;

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
  bool use_cg;           /* no factor */
  bool iterates;         /* a few solutions at rest take less time by conjugate gradients than one
                            factor: the caller leaves the choice */
  bool by_cg;            /* the present solution; of K + shift * M */
  double shift;
  double *rhs, *solution; /* unknowns each */
  double *cg_work;        /* 5 * unknowns, or NULL */
  double *mass;           /* n, or NULL until a motion needs it */
  mps_elastic_report report;

  mpsi_elastic_outside outside; /* the matrix of a linear solver of the caller */

  int64_t fabric[2]; /* Hashes, where known */
  bool fabric_known;
  mpsi_ledger ledger;
  struct mpsi_elastic_motion *motion; /* NULL: no dynamics under way */
  struct mpsi_elastic_motion *ended;  /* by a removal: its numbers without arrays, or NULL */
  struct mpsi_elastic_change *change; /* Under way, or NULL */
};

MPSI_CONDITION_ACCESS(mpsi_elastic_boundary, mps_elastic, MPSI_BOUNDARIES, mpsi_elastic_boundary)
MPSI_CONDITION_ACCESS(mpsi_elastic_load, mps_elastic, MPSI_LOADS, mpsi_elastic_load)

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

/* Has i a face that is a joint? */
static inline bool mpsi_elastic_at_joint(const mps_elastic *e, int64_t i) {
  if (!e->joint_at) return false;
  const int64_t *joint = e->joint_at + mpsi_elastic_slot(e, i) * 2 * e->dim;
  for (int face = 0; face < 2 * e->dim; face++)
    if (joint[face] >= 0) return true;
  return false;
}

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

/* Particles of chunk `chunk` of the whole body: [*first, *last). */
static inline void mpsi_elastic_chunk(const mps_elastic *e, int64_t chunk, int64_t *first,
                                      int64_t *last) {
  *first = chunk * MPSI_ELASTIC_CHUNK;
  *last = *first + MPSI_ELASTIC_CHUNK < e->n ? *first + MPSI_ELASTIC_CHUNK : e->n;
}

static inline int64_t mpsi_elastic_chunks(const mps_elastic *e) {
  return (e->n + MPSI_ELASTIC_CHUNK - 1) / MPSI_ELASTIC_CHUNK;
}
