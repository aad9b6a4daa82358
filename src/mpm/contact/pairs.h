/* pairs.h - contact on the grid. A block and a body near it are a pair: the lists of pairs are
 * rebuilt before each step, so that only the blocks near a body are searched for contact.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PAIRS_H
#define MPSI_MPM_PAIRS_H

#include "thin_bodies.h"
#include "contact/contact.h"
#include "exchange.h"
#include "impulses.h"
#include "partners.h"
#include "core/base/room.h"

#include <mps/mpm.h>

#include <stdatomic.h>

/* A block of cells and a body near its particles. */
typedef struct mpsi_cell_pair {
  int32_t cells, body;
  bool in_contact;                     /* some particle is in contact */
  double deepest;                      /* m, >= 0, of a particle below the surface */
  int64_t deep;                        /* that particle */
  int64_t first_load;                  /* of contact.load, one a part of the body */
  int64_t first_candidate, candidates; /* for contact by impulses: see constraints.c */
} mpsi_cell_pair;

/* Of the particles of a pair on one part of the body: forces, and how many are in contact. */
typedef struct mpsi_pair_load {
  mpsi_load by;
  int64_t contacts;
} mpsi_pair_load;

/* A block of nodes and a body that may act on it; its nodes are contact.node[k * block_nodes]. */
typedef struct mpsi_node_pair {
  int32_t nodes, body;
  double mass; /* kg, of the nodes in contact */
} mpsi_node_pair;

/* Sums at a node of particles in penalty contact: as in mpsi_contact_node. */
typedef struct mpsi_penalty_node {
  double mass, slip[3], force[3];
} mpsi_penalty_node;

/* What contact with each body has besides the handle, in the order of these. */
typedef struct mpsi_contact_state {
  double mass;             /* kg, of the nodes in contact with the body */
  bool parts;              /* the body parts particles (thin_bodies.h), in the step being made */
  bool warned;             /* the log knows that its penalty is too stiff for dt */
  double v[3], spin[3];    /* m/s, rad/s: of the body, while it stands still (settle.c) */
  mpsi_last_distance last; /* of a loop over blocks */
} mpsi_contact_state;

typedef struct mpsi_contacts {
  mps_contact **handle;
  mps_body **body; /* of each */
  mpsi_contact_state *state;
  int32_t bodies, penalty_bodies; /* the latter: how many of them by penalty contact */
  double least_mass;              /* kg, of a particle; in axisymmetry over its radius, kg/m */
  mpsi_cell_pair *cell_pair;
  mpsi_node_pair *node_pair;
  mpsi_pair_load *load;     /* of each cell pair, by parts of its body */
  mpsi_contact_node *node;  /* with penalty contact, of each node of each node pair; */
  double (*normal)[3];      /* of the surface there, where `held` and `reached`; */
  uint8_t *held;            /* whether it is in the pair's body */
  uint8_t *inside;          /* MPSI_INSIDE and more, by all bodies; mask_count * block_nodes */
  bool thin;                /* some body parts particles (thin_bodies.h) */
  mpsi_sight *sight;        /* as node, where there are such bodies; */
  mpsi_parted *across;      /* of each particle queried: mpsi_mpm_find_parted */
  uint8_t *beside;          /* as inside: beside or in one of them */
  _Atomic uint8_t *reached; /* corner of a cell that holds a particle; likewise */
  int64_t cell_pair_count, node_pair_count, mask_count;
  mpsi_impulses impulses;
  mpsi_contact_partners partners; /* of several ranks; none are before the first contact */
  mpsi_contact_exchange exchange; /* constraints of partners */
  mpsi_room handle_room, body_room, state_room; /* kept as they grow: contacts.c */
  mpsi_room near_room;                          /* by blocks of nodes, bit b: body b is near */
  mpsi_room cell_pair_room, node_pair_room, load_room, node_room, normal_room, held_room,
      inside_room, reached_room, sight_room, beside_room, across_room, penalty_room;
  mpsi_room sum_room; /* exact sums by parts of all bodies: penalty_friction.c */
} mpsi_contacts;

/* cut.c: all that is to be known of bodies near particles before a step; which blocks are cut and
 * split. It calls the next ones. `status`: of the step so far on this rank here; collective
 * where there are bodies. */
mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function, mps_status status);
/* pairs.c: lists the pairs; whether a body may have a node inside of the tile or block at `at` of
 * `side` nodes an axis; the masses that friction with free bodies needs, once those of the node
 * pairs are known: of all ranks. */
mps_status mpsi_mpm_list_pairs(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contact,
                               const char *function);
bool mpsi_mpm_body_reaches(const mpsi_grid *grid, const mpsi_contacts *contacts, int32_t body,
                           const int32_t *at, int side);
void mpsi_mpm_find_contact_mass(const mpsi_grid *grid, const mpsi_contacts *contact,
                                mpsi_partition *partition);
/* penalty.c: room for their tiles, the pairs being listed; whether a block has one for its pair
 * number `pair`; that one; emptied; added to the nodes; all of that with p2g in between. */
bool mpsi_mpm_penalty_room(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contact);
bool mpsi_mpm_has_penalty(const mpsi_contacts *contacts, const mpsi_cell_block *cells,
                          int32_t pair);
mpsi_penalty_node *mpsi_mpm_penalty_tile(const mpsi_grid *grid, const mpsi_worker *worker,
                                         int32_t pair);
void mpsi_mpm_clear_penalty(const mpsi_grid *grid, const mpsi_contacts *contacts,
                            const mpsi_cell_block *cells, const mpsi_worker *worker);
void mpsi_mpm_add_penalty(const mpsi_grid *grid, const mpsi_contacts *contacts,
                          const mpsi_cell_block *cells, const mpsi_worker *worker);
void mpsi_mpm_scatter_penalty(mps_mpm *mpm, int64_t b, int32_t worker);
/* inside.c: nodes of a block inside bodies; corners of the cells of a block that hold particles. */
void mpsi_mpm_find_inside(mps_mpm *mpm, int64_t g, int32_t worker);
void mpsi_mpm_mark_reached(mps_mpm *mpm, int64_t b, int32_t worker);
/* The same of ghosts from other ranks, where `known` here. Collective. */
mps_status mpsi_mpm_exchange_corners(mps_mpm *mpm, const char *function, bool known);
/* area.c: the areas that particles of the pair stand for, to nodes of the tile; false: none. */
bool mpsi_mpm_sum_areas(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_contacts *contacts,
                        const mpsi_cell_pair *pair, double *tile);
/* penalty_friction.c: normal forces of all bodies on a block of nodes; friction; forces on the
 * bodies, and their motion, for which there is memory. */
bool mpsi_mpm_sum_room(mps_context *context, mpsi_contacts *contacts);
void mpsi_mpm_apply_contact(const mpsi_grid *grid, const mpsi_contacts *contacts, double dt,
                            int64_t g);
void mpsi_mpm_apply_friction(const mpsi_grid *grid, const mpsi_contacts *contacts, double dt,
                             int64_t g);
void mpsi_mpm_update_bodies(mps_mpm *mpm);
/* contacts.c: MPS_ERROR_ARGUMENT where particles from index `from` on lie inside the body, unless
 * the contact pushes them out. */
mps_status mpsi_mpm_check_inside(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const char *function, const mps_contact *contact, int64_t from);
/* removal.c: whether some body takes away what it finds; before a step, what they take, `cleared`
 * where they do, on whatever rank (`status`: of the step so far on this rank); and, when its
 * contact is made, what one takes. The latter two are collective. */
bool mpsi_mpm_some_take_away(const mpsi_contacts *contacts);
mps_status mpsi_mpm_clear_bodies(mps_mpm *mpm, const char *function, mps_status status,
                                 bool *cleared);
mps_status mpsi_mpm_clear_body(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               mpsi_contacts *contacts, mpsi_partition *partition,
                               const char *function, mps_contact *contact);
/* contacts.c: MPS_ERROR_DIVERGED where a particle is deeper in a body than its contact allows; ends
 * all contacts. */
mps_status mpsi_mpm_check_depth(mps_context *context, const mpsi_columns *p,
                                const mpsi_contacts *contacts, const mpsi_run *run,
                                const char *function);
void mpsi_mpm_end_contacts(mpsi_contacts *contacts);

#endif
