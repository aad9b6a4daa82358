/* pairs.h - contact on the grid. A block and a body near it are a pair: the lists of pairs are
 * rebuilt before each step, so that only the blocks near a body are searched for contact.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "thin_bodies.h"
#include "contact/penalty_contact.h"
#include "exchange.h"
#include "impulses.h"
#include "partners.h"
#include "core/base/room.h"

#include <mps/mpm.h>

#include <stdatomic.h>

/* A block of cells and a body near its particles. */
typedef struct mpsi_cell_pair {
  int32_t cells, body;
  bool in_contact;    /* some particle of the block is in contact */
  double deepest;     /* m, >= 0: greatest depth of a particle below the surface */
  int64_t deep;       /* index of that particle */
  int64_t first_load; /* index in contact.load, one load for each part of the body */
  int64_t first_candidate,
      candidates; /* contact by impulses: range of impulses.candidate (constraints.c) */
  int64_t strips; /* of these, now at the beginning of the range: beyond an inset edge */
} mpsi_cell_pair;

/* Load of a pair's particles on one part of the body, and the number of particles in contact. */
typedef struct mpsi_pair_load {
  mpsi_load by;
  int64_t contacts;
} mpsi_pair_load;

/* A block of nodes and a body that may act on it. The data of pair k at the nodes are
 * contact.node[k * block_nodes] and on. */
typedef struct mpsi_node_pair {
  int32_t nodes, body;
  double mass; /* kg, sum over the nodes in contact */
} mpsi_node_pair;

/* Sums at a node over the particles in penalty contact, as in mpsi_contact_node. */
typedef struct mpsi_penalty_node {
  double mass, slip[3], force[3];
} mpsi_penalty_node;

/* State of the contact with each body, in the order of `handle`. */
typedef struct mpsi_contact_state {
  double mass;        /* kg, sum over the nodes in contact with the body */
  bool parts;         /* the body makes nodes two-sided in this step (thin_bodies.h) */
  bool warned;        /* the log has a warning that the penalty is too stiff for dt, */
  bool overlaps;      /* one that it overlaps a body before it, */
  bool leaves;        /* one that it goes through a side of the domain, */
  bool wet;           /* and one of its friction by penalty where water bears */
  int64_t first_step; /* of the contact: number of steps before it */
  double v[3],
      spin[3]; /* m/s, rad/s: velocity of the body outside mps_mpm_settle, which keeps it at rest */
  mpsi_last_distance last; /* bounds from the last block of a loop over blocks */
} mpsi_contact_state;

typedef struct mpsi_contacts {
  mps_contact **handle;
  mps_body **body; /* body of each contact */
  mpsi_contact_state *state;
  int32_t bodies, penalty_bodies; /* number of contacts; of those by penalty */
  bool wet;                       /* there is water in the pores, in the step being made */
  double least_mass; /* kg, least mass of a particle; in axisymmetry over its radius, kg/m */
  mpsi_cell_pair *cell_pair;
  mpsi_node_pair *node_pair;
  mpsi_pair_load *load;    /* of each cell pair, by parts of its body */
  mpsi_contact_node *node; /* penalty contact: sums at each node of each node pair */
  double (*normal)[3];     /* surface normals at the same nodes, where `held` and `reached` */
  uint8_t *held;           /* at the same nodes: the node lies in the pair's body */
  uint8_t
      *inside; /* MPSI_INSIDE and other bits, of all bodies together; mask_count * block_nodes */
  bool thin;   /* some body makes nodes two-sided (thin_bodies.h) */
  mpsi_sight *sight;   /* indexed as `node`; only with thin bodies */
  mpsi_parted *across; /* of each particle beside thin bodies: mpsi_mpm_find_parted */
  uint8_t *beside;     /* indexed as `inside`: the node is beside or in a thin body */
  _Atomic uint8_t
      *reached; /* indexed as `inside`: the node is a corner of a cell with a particle */
  int64_t cell_pair_count, node_pair_count, mask_count;
  mpsi_impulses impulses;
  mpsi_contact_partners partners; /* on several ranks; allocated with the first contact */
  mpsi_contact_exchange exchange; /* constraints of partners */
  mpsi_room handle_room, body_room, state_room; /* contents are kept as they grow (contacts.c) */
  mpsi_room near_room;                          /* by block of nodes; bit b: body b is near */
  mpsi_room cell_pair_room, node_pair_room, load_room, node_room, normal_room, held_room,
      inside_room, reached_room, sight_room, beside_room, across_room, penalty_room;
  mpsi_room sum_room; /* exact sums by parts of all bodies: penalty_friction.c */
} mpsi_contacts;

/* pairs.c: lists the pairs of blocks and bodies; whether a body may contain a node of the tile or
 * block at `at`, with `side` nodes an axis; sums the mass in contact with each body that moves
 * freely over its node pairs, on all ranks: friction needs it. */
mps_status mpsi_mpm_list_pairs(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contact,
                               const char *function);
bool mpsi_mpm_body_reaches(const mpsi_grid *grid, const mpsi_contacts *contacts, int32_t body,
                           const int32_t *at, int side);
void mpsi_mpm_find_contact_mass(const mpsi_grid *grid, const mpsi_contacts *contact,
                                mpsi_partition *partition);
/* penalty.c: memory for tiles of penalty contact, after the pairs are listed; whether a block has
 * one for its pair number `pair`; that tile; sets the block's tiles to zero; adds them to the
 * nodes; both of these with P2G in between. */
bool mpsi_mpm_penalty_room(mps_context *context, const mpsi_grid *grid, mpsi_contacts *contact);
bool mpsi_mpm_has_penalty(const mpsi_contacts *contacts, const mpsi_cell_block *cells,
                          int32_t pair);
mpsi_penalty_node *mpsi_mpm_penalty_tile(const mpsi_grid *grid, const mpsi_worker *worker,
                                         int32_t pair);
void mpsi_mpm_clear_penalty(const mpsi_grid *grid, const mpsi_contacts *contacts,
                            const mpsi_cell_block *cells, const mpsi_worker *worker);
void mpsi_mpm_add_penalty(const mpsi_grid *grid, const mpsi_contacts *contacts,
                          const mpsi_cell_block *cells, const mpsi_worker *worker);
/* inside.c: tasks of a pass, whose data is an mpsi_inside_search (base/kernels.h): nodes of a block
 * that lie inside bodies; corners of a block's cells with particles. */
void mpsi_mpm_find_inside(void *search, int64_t g, int32_t worker);
void mpsi_mpm_mark_reached(void *search, int64_t b, int32_t worker);
/* inside.c: marks the corners of the cells of ghost blocks with particles, as their ranks have
 * found them. Collective. */
mps_status mpsi_mpm_exchange_corners(mpsi_inside_search *of, mpsi_partition *partition,
                                     const char *function);
/* area.c: distributes the surface area that the pair's particles represent to the nodes of the
 * tile; false: there is none. */
bool mpsi_mpm_sum_areas(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_contacts *contacts,
                        const mpsi_cell_pair *pair, mpsi_area *tile);
/* penalty_friction.c: memory for the sums of loads; normal penalty forces of all bodies on a block
 * of nodes; friction; loads on the bodies, and their motion. */
bool mpsi_mpm_sum_room(mps_context *context, mpsi_contacts *contacts);
void mpsi_mpm_apply_contact(const mpsi_grid *grid, const mpsi_contacts *contacts, double dt,
                            int64_t g);
void mpsi_mpm_apply_friction(const mpsi_grid *grid, const mpsi_contacts *contacts, double dt,
                             int64_t g);
void mpsi_mpm_update_bodies(const mpsi_grid *grid, const mpsi_contacts *contacts,
                            mpsi_energy *energy, mpsi_partition *partition,
                            const mpsi_settling *settling, double dt);
/* contacts.c: MPS_ERROR_ARGUMENT where particles from index `from` on lie inside the body, unless
 * the contact pushes them out. */
mps_status mpsi_mpm_check_inside(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const char *function, const mps_contact *contact, int64_t from);
/* contacts.c: MPS_ERROR_ARGUMENT where two bodies of the solver overlap. */
mps_status mpsi_mpm_check_overlaps(mps_context *context, const mpsi_grid *grid,
                                   const mpsi_contacts *contacts, const char *function);
/* contacts.c: logs, once a body, that it has come to overlap another one. */
void mpsi_mpm_warn_about_overlaps(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_contacts *contacts, int64_t steps);
/* removal.c, bodies that remove particles from their inside: whether there is any; before a step,
 * removal by all (`cleared`: some rank has removed particles; `status`: of the step so far on this
 * rank); removal by one when its contact is made. The latter two are collective. */
bool mpsi_mpm_any_body_removes(const mpsi_contacts *contacts);
mps_status mpsi_mpm_clear_bodies(const mpsi_contact_setup *setup, const char *function,
                                 mps_status status, bool *cleared);
mps_status mpsi_mpm_clear_body(const mpsi_contact_setup *setup, const char *function,
                               mps_contact *contact);
/* contacts.c: MPS_ERROR_DIVERGED where a particle is deeper in a body than its contact allows; ends
 * all contacts. */
mps_status mpsi_mpm_check_depth(mps_context *context, const mpsi_columns *p,
                                const mpsi_contacts *contacts, const mpsi_run *run,
                                const char *function);
void mpsi_mpm_end_contacts(mpsi_contacts *contacts);

/* What adding and querying contacts work on. */
struct mpsi_contact_setup {
  mps_context *context;
  const mpsi_grid *grid;
  const mpsi_columns *p;
  mpsi_rooms *rooms;
  mpsi_contacts *contact;
  mpsi_partition *partition; /* NULL: one rank */
  mpsi_run *run;
  const mps_mpm_def *def;
};

/* contacts.c: mps_mpm_add_contact, for the public `function`; `self` owns the contact. */
mps_status mpsi_mpm_add_contact(const mpsi_contact_setup *setup, const char *function,
                                const mpsi_contact_owner *owner, void *self, mps_body *body,
                                const mps_contact_def *def, mps_contact **out);
/* contacts.c: ends a contact; the particles in contact with its body, `count` of them. */
void mpsi_mpm_end_contact(const mpsi_grid *grid, mpsi_contacts *contacts, mps_contact *contact);
mps_status mpsi_mpm_list_in_contact(const mpsi_contact_setup *setup, const mps_contact *contact,
                                    const mpsi_contact_list *out, int64_t *count);
