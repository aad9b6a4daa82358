/* impulses.h - contact by impulses on the grid (impulses.c, constraints.c): which particles may
 * reach which body in a step, the nodes through which they act, and the warm start of the next
 * step. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "contact/corner.h"
#include "contact/edge.h"
#include "contact/impulse.h"
#include "mpm/base/parts.h"
#include "mpm/grid/blocks.h"
#include "core/base/room.h"

#include <mps/mpm.h>

#include <string.h>

/* Contact constraint: a particle that may reach a body in this step. Constraint k of the list has
 * weight[k * stride] and on, node[k * stride] and on. The weight of a node is 1/m, followed by psi
 * for each component of its velocity. The psi differ between components where ghosts of mirrors
 * (mirror.h) have been replaced by their images. Elsewhere the constraint is `even` and its weights
 * are pairs of 1/m and psi, from the same place on: half the memory to read in a sweep. */
typedef struct mpsi_constraint {
  mpsi_impulse impulse;
  double x[3];       /* m, of the particle */
  double rest_gap;   /* m: mpsi_impulse_rest_gap */
  double carried[3]; /* m/s, part of the velocity at the foot that comes from the velocity of
                        mirrors */
  int64_t particle;  /* index of the particle */
  int64_t id;        /* its id, which does not change when particles are sorted */
  int64_t pair;      /* index in contact.cell_pair; -1: constraint and particle of another rank
                        (exchange.h) */
  int32_t body, part, nodes;
  bool even;
  int32_t point; /* of mpsi_inset_edge: the impulse acts at that inset edge, by weights of a fit
                    there; 0: elsewhere */
  int32_t areas; /* number of nodes, in around[], whose areas it has a part of (area.c) */
} mpsi_constraint;

/* Half spacings along and across the face within which a particle may take over an inset edge that
 * bears. Ground that flows out under a smooth face is stretched: its columns come 1.5 spacings
 * apart, and the next one has moved off the face while the edge bore for it. */
#define MPSI_EDGE_WINDOW 4.0
#define MPSI_EDGE_REACH 1.0

/* Constraints of a block of cells, consecutive in the list: contacts, then groups of listed
 * particles (prescribed.h). Of the latter `particle` is the number of the group, the body is -1 -
 * list, `carried` is less the prescribed velocity, `impulse.normal` has the inverses of the
 * mobilities (0: a component that is not prescribed) and `tangent_impulse` the impulse. */
typedef struct mpsi_constraint_block {
  int64_t first, count, groups;
  int32_t cells;            /* block of cells; -1: of another rank */
  int32_t at[3];            /* coordinates of the block */
  double changed, impulses; /* (N s)2, sums of squares in the last sweep: changes, impulses */
  double group_changed, group_impulses; /* likewise, of the groups */
} mpsi_constraint_block;

/* Impulse of a body on a particle in the last step, from which the sweeps of the next one start:
 * on the same particle, or at the inset edge `point` on the particle that bears there. With the
 * point MPSI_REST_GAP not an impulse but the particle's rest gap, by[0] (m). */
#define MPSI_REST_GAP INT32_MAX
typedef struct mpsi_warm_impulse {
  int64_t id;
  int32_t body, point;
  double by[3]; /* N s */
} mpsi_warm_impulse;

/* At a node, for one body: the area of the surface that soil covers, what ground and water bear
 * there, and the sum of the normal impulses of the constraints beside it (area.c). */
typedef struct mpsi_area {
  double area;      /* m2, for the thickness or sector angle of the model */
  mpsi_borne borne; /* Pa m3, sums over particles; with water */
  double normal;    /* N s, weighted */
} mpsi_area;
static inline void mpsi_mpm_add_area(mpsi_area *to, double area, mpsi_borne borne) {
  to->area += area;
  to->borne.ground += borne.ground;
  to->borne.water += borne.water;
}
typedef struct mpsi_area_share {
  mpsi_area *node;
  double weight;
} mpsi_area_share;

typedef struct mpsi_impulses {
  mpsi_constraint *constraint;
  mpsi_constraint_block *block; /* in the order of the colours */
  double (*weight)[4];
  double **node; /* its four values, as in mpsi_node */
  int32_t *candidate;
  int64_t constraint_count, block_count;
  int64_t contact_count; /* of the constraints; without bodies: of all */
  int64_t colour[9];     /* first block of each colour in `block` */
  int32_t stride;
  bool free_bodies;        /* a body in contact moves freely */
  mpsi_impulse_body *body; /* body of each contact */
  mpsi_warm_impulse *warm; /* impulses of the last step */
  int64_t warm_count;
  double warm_dt; /* s, dt of that step */
  int64_t sweeps; /* number of sweeps of that step; relative change of the impulses in the last of
                     them */
  double left;
  int32_t *
      lookup; /* hash table by particle and body: index into `warm`, or -1; lookup_mask + 1 slots */
  uint64_t lookup_mask;
  bool areas;      /* some contact needs them: mpsi_has_areas; */
  bool strengths;  /* has a strength or an adhesion */
  mpsi_area *area; /* indexed as contact.node; on several ranks see exchange.h */
  int64_t area_count;
  int64_t area_first; /* first block of the colour being processed */
  mpsi_area_share *around;
  mpsi_room constraint_room, block_room, weight_room, node_room, candidate_room, warm_room,
      next_room, lookup_room, area_room, around_room, body_room;
} mpsi_impulses;

/* constraints.c: before anything moves, candidates for contact in the step, and memory for their
 * constraints; then, with the masses of the nodes, the constraints with weights and warm start, and
 * the depth of particles. */
mps_status mpsi_mpm_find_constraints(const mpsi_contact_stage *stage, const char *function);
void mpsi_mpm_fit_constraints(const mpsi_contact_stage *stage);
/* step/inset_edges.c: the bearers of inset edges among the candidates, of all ranks. Collective. */
mps_status mpsi_mpm_find_bearers(const mpsi_contact_stage *stage, const char *function,
                                 mps_status status);
/* area.c: memory for the areas of the step and of so many constraints; areas at the nodes, and
 * friction of the constraints by what ground and water bear there; shear strength of each
 * constraint by its part of these, with the present normal impulses. */
bool mpsi_mpm_area_room(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contacts,
                        mpsi_partition *partition, int64_t constraints);
void mpsi_mpm_find_areas(const mpsi_contact_stage *stage);
void mpsi_mpm_distribute_areas(const mpsi_contact_stage *stage);
/* constraints.c: adds the mirrors' part of a step's contact impulses to the impulses of the
 * walls. */
void mpsi_mpm_mirror_constraints(const mpsi_contact_stage *stage);
/* warm_start.c: builds the hash table `lookup` (false: memory refused); the impulse of the last
 * step on a particle (point 0) or its rest gap (MPSI_REST_GAP), or NULL where there was none;
 * removes the impulses of a contact that has ended, and moves the bodies above it down by one.
 * constraints.c: foot and half size with which a particle bears on the contact's body. */
bool mpsi_mpm_index_impulses(mps_context *context, mpsi_contacts *contacts);
const mpsi_warm_impulse *mpsi_mpm_warm_impulse(const mpsi_contacts *contacts, int64_t id,
                                               int32_t body, int32_t point);
mpsi_bearing mpsi_mpm_bearing(const mpsi_grid *grid, const mpsi_columns *p,
                              const mps_contact *contact, int64_t particle, const double *x);
void mpsi_mpm_forget_impulses(mpsi_contacts *contacts, int32_t body);
/* impulses.c: sweeps over the constraints and adds their impulses to nodes; adds them to pairs, and
 * keeps them for the next step; then, with the final velocities of the nodes, the energy lost in
 * the contacts. */
void mpsi_mpm_apply_impulses(const mpsi_contact_stage *stage);
/* Relative change of the impulses in the last Gauss-Seidel sweep of a step, by which the sweeps
 * end. */
enum { MPSI_SWEEP_CHANGED, MPSI_SWEEP_IMPULSES, MPSI_SWEEP_SUMS };

/* Largest sums over a block of cells of this rank of the squares of changes and of impulses, (N
 * s)2. Their maxima over all ranks do not depend on the number of ranks. */
void mpsi_mpm_sweep_sums(const mpsi_contacts *contacts, double *most);
/* Root of the change over the impulses; 0 without a change. */
double mpsi_mpm_relative_change(const double *most);
/* A sweep over all blocks: an update of each constraint, the warm start, or the impulses of listed
 * particles off the nodes. */
typedef enum mpsi_sweep_kind {
  MPSI_SWEEP_UPDATE,
  MPSI_SWEEP_WARM,
  MPSI_SWEEP_RELEASE
} mpsi_sweep_kind;
void mpsi_mpm_sweep_all(const mpsi_contact_stage *stage, mpsi_sweep_kind kind, bool back);
void mpsi_mpm_end_impulses(const mpsi_contact_stage *stage);
void mpsi_mpm_find_impulse_loss(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                mpsi_energy *energy, const mpsi_kernels *kernels);
void mpsi_mpm_free_impulses(mps_context *context, mpsi_contacts *contacts);

static inline bool mpsi_has_strength(const mps_contact *contact) {
  return contact->def.adhesion > 0.0 || !isnan(contact->def.strength);
}

static inline bool mpsi_by_impulses(const mps_contact *contact) {
  return contact->def.method == MPS_CONTACT_METHOD_IMPULSE;
}

/* In saturated ground (`wet`) friction is of what the ground bears beside the surface. */
static inline bool mpsi_has_areas(const mps_contact *contact, bool wet) {
  return mpsi_has_strength(contact) ||
         (wet && contact->def.friction > 0.0 && mpsi_by_impulses(contact));
}

/* Weights of an even constraint: pairs of 1/m and psi. */
static inline double (*mpsi_even_weights(const mpsi_impulses *all, int64_t constraint))[2] {
  return (double(*)[2])(double *)all->weight[constraint * all->stride];
}

/* Adds a node with a weight for each component to a constraint, at first without any
 * (`may_be_there`: the node can be listed already, when it is the image of a ghost too). */
static inline void mpsi_mpm_add_node(mpsi_constraint *constraint, double **node, double (*to)[4],
                                     double *at, const double *weight, bool may_be_there) {
  int32_t i = may_be_there ? 0 : constraint->nodes;
  while (i < constraint->nodes && node[i] != at) i++;
  if (i == constraint->nodes) {
    node[constraint->nodes++] = at;
    to[i][MPSI_MASS] = 1.0 / at[MPSI_MASS];
    memcpy(to[i] + MPSI_VECTOR, weight, 3 * sizeof *weight);
    return;
  }
  for (int a = 0; a < 3; a++) to[i][MPSI_VECTOR + a] += weight[a];
}
