/* impulses.h - contact by impulses on the grid (impulses.c, constraints.c): which particles may
 * reach which body in a step, the nodes through which they act, and the warm start of the next
 * step. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_IMPULSES_H
#define MPSI_MPM_IMPULSES_H

#include "contact/corner.h"
#include "contact/impulse.h"
#include "mpm/base/parts.h"
#include "core/base/room.h"

#include <mps/mpm.h>

/* A particle that may reach a body in the step being made. Its weights and nodes are weight[k *
 * stride] and on, node[k * stride] and on, k its number in the list. A weight has 1/m of the node
 * and then psi for each component of its velocity, in the places that they have in the node: these
 * differ where ghosts of mirrors (mirror.h) stand for nodes. Where none may, the constraint is
 * `even`, and its weights are pairs of 1/m and psi, from the same place on: half the memory to read
 * in a sweep. */
typedef struct mpsi_constraint {
  mpsi_impulse impulse;
  double x[3];       /* m, of the particle */
  double carried[3]; /* m/s, velocity at the foot that moving mirrors give besides the nodes */
  int64_t particle;  /* index, */
  int64_t id;        /* and what it keeps when the particles are sorted */
  int64_t pair;      /* of contact.cell_pair; -1: of another rank (exchange.h), as its particle */
  int32_t body, part, nodes;
  bool even;
  int32_t areas; /* nodes whose areas it shares, of around[] (area.c) */
} mpsi_constraint;

/* The constraints of a block of cells: consecutive in the list. */
typedef struct mpsi_constraint_block {
  int64_t first, count;
  int32_t cells;            /* -1: of another rank */
  int32_t at[3];            /* of the cells */
  double changed, impulses; /* (N s)2, sums of squares in the last sweep: changes, impulses */
} mpsi_constraint_block;

/* What a body gave to a particle in the last step. */
typedef struct mpsi_warm_impulse {
  int64_t id, body;
  double by[3]; /* N s */
} mpsi_warm_impulse;

/* At a node, for one body: the area that soil covers, and the normal impulses of the constraints
 * that bear it (area.c). */
typedef struct mpsi_area {
  double area;   /* m2, of the measure */
  double normal; /* N s, weighted */
} mpsi_area;
typedef struct mpsi_area_share {
  mpsi_area *node;
  double weight;
} mpsi_area_share;

typedef struct mpsi_impulses {
  mpsi_constraint *constraint;
  mpsi_constraint_block *block; /* colour by colour */
  double (*weight)[4];
  double **node; /* its four values: see mpsi_node */
  int32_t *candidate;
  int64_t constraint_count, block_count;
  int64_t colour[9]; /* first block of each in `block` */
  int32_t stride;
  bool free_bodies;        /* one of those in contact moves freely */
  mpsi_impulse_body *body; /* of each contact */
  mpsi_warm_impulse *warm; /* of the last step */
  int64_t warm_count;
  double warm_dt; /* s, of that step */
  int64_t sweeps; /* of that step, and the relative change of impulses in the last of them */
  double left;
  int32_t *lookup; /* by particle and body: index into `kept`, or -1; lookup_mask + 1 of them */
  uint64_t lookup_mask;
  bool areas;      /* some contact has a strength or an adhesion */
  mpsi_area *area; /* as contact.node; on several ranks see exchange.h */
  int64_t area_count;
  int64_t area_first; /* block of the colour in work */
  mpsi_area_share *around;
  mpsi_room constraint_room, block_room, weight_room, node_room, candidate_room, warm_room,
      next_room, lookup_room, area_room, around_room, body_room;
} mpsi_impulses;

/* constraints.c: before anything moves, candidates for contact in the step to be made, and room;
 * then, the masses of the nodes known, the constraints with their weights, and how deep particles
 * are. */
mps_status mpsi_mpm_find_constraints(mps_mpm *mpm, const char *function);
void mpsi_mpm_fit_constraints(mps_mpm *mpm);
/* area.c: room for the areas of the step and of so many constraints; the areas; and the shear
 * strength of each constraint by its part of them, with the present normal impulses. */
bool mpsi_mpm_area_room(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contacts,
                        mpsi_partition *partition, int64_t constraints);
void mpsi_mpm_find_areas(mps_mpm *mpm);
void mpsi_mpm_distribute_areas(mps_mpm *mpm);
/* constraints.c: what mirrors give with the impulses of a step. */
void mpsi_mpm_mirror_constraints(mps_mpm *mpm);
/* constraints.c: prepares `lookup` (false: memory refused), by which the next finds the impulse of
 * the last step on a particle, or NULL; where a particle bears on the contact's body; a contact has
 * ended: bodies above it move down by one. */
bool mpsi_mpm_index_impulses(mps_context *context, mpsi_contacts *contacts);
const mpsi_warm_impulse *mpsi_mpm_warm_impulse(const mpsi_contacts *contacts, int64_t id,
                                               int32_t body);
mpsi_bearing mpsi_mpm_bearing(const mpsi_grid *grid, const mpsi_columns *p,
                              const mps_contact *contact, int64_t particle, const double *x);
void mpsi_mpm_forget_impulses(mpsi_contacts *contacts, int32_t body);
/* impulses.c: the impulses of a step, to nodes and pairs; and, the nodes' last velocities known,
 * what the contacts have lost. */
void mpsi_mpm_apply_impulses(mps_mpm *mpm);
void mpsi_mpm_find_impulse_loss(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                mpsi_energy *energy, const mpsi_kernels *kernels);
void mpsi_mpm_free_impulses(mps_context *context, mpsi_contacts *contacts);

static inline bool mpsi_has_strength(const mps_contact *contact) {
  return contact->def.adhesion > 0.0 || !isnan(contact->def.strength);
}

static inline bool mpsi_by_impulses(const mps_contact *contact) {
  return contact->def.method == MPS_CONTACT_METHOD_IMPULSE;
}

/* The weights of an even constraint. */
static inline double (*mpsi_even_weights(const mpsi_impulses *all, int64_t constraint))[2] {
  return (double(*)[2])(double *)all->weight[constraint * all->stride];
}

#endif
