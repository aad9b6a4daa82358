/* exchange.h - contact by impulses on several ranks. Constraints of one rank change nodes that
 * constraints of others read, update by update (impulses.c): a message for each update would cost
 * more than the update. So each rank sends its constraints, and the nodes that they use, to its
 * contact partners (partners.h) and sweeps over all of them in the order that one rank would have:
 * the same arithmetic on each, and no message between sweeps. A step costs one message between any
 * two partners. Warm-start impulses are exchanged before particles change ranks (warm_start.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "impulses.h"

#include <mps/experimental/domain.h>
#include <mps/mpm.h>

struct mpsi_grid;

/* Replica of a node that some constraint uses, updated identically on all partners; or the area
 * that soil covers at a node (area.c). */
enum {
  MPSI_SHARED_NODE,
  MPSI_SHARED_ACROSS,
  MPSI_SHARED_AREA
}; /* MPSI_SHARED_AREA + b: area at body b */
typedef struct mpsi_shared_node {
  int32_t at[3]; /* coordinates in the whole grid, in cells */
  int32_t kind;  /* MPSI_SHARED_...; ACROSS: the node's values across a thin body (thin_bodies.h) */
  union {
    double value[4];
    mpsi_area area;
  };
  double *home; /* the node in grid.node; NULL: this rank does not have it */
} mpsi_shared_node;

typedef struct mpsi_contact_exchange {
  int64_t constraints;  /* over all ranks */
  int64_t nodes, slots; /* lengths of `shared`, of `lookup` */
  mpsi_room constraint, block, weight, node, shared, lookup, warm, mail, list;
} mpsi_contact_exchange;

/* warm_start.c: collects the warm-start impulses of the particles of all ranks on each, before
 * particles change ranks or a checkpoint is written. `status`: of the call so far on this rank.
 * Collective. */
mps_status mpsi_mpm_share_warm_start(mpsi_impulses *impulses, const mps_particles *particles,
                                     mps_domain *domain, const char *function, mps_status status);
/* warm_start.c: sorts the warm-start impulses by particle and body, the same order on any number of
 * ranks. Not collective. */
void mpsi_mpm_order_warm_start(mpsi_impulses *impulses);
/* Replaces this rank's constraints in contact.impulses by those of all partners, in the order that
 * one rank would have, until the next step finds its own. All ranks first agree on `status`.
 * Collective. */
mps_status mpsi_mpm_exchange_contacts(const mpsi_contact_stage *stage, const char *function,
                                      mps_status status);
/* After the sweeps: copies the velocities of the replicas to this rank's nodes. Not collective. */
void mpsi_mpm_end_contact_exchange(mpsi_contacts *contacts);
/* shared_nodes.c: the replica of the node at `at`, made with these values if there is none yet; its
 * memory is allocated before. Not collective. */
mpsi_shared_node *mpsi_mpm_shared_node(mpsi_contact_exchange *exchange,
                                       const struct mpsi_grid *grid, const int32_t *at,
                                       int32_t kind, const double *value);
/* shared_nodes.c: the area at the node `at` under the tile of a block of cells, or NULL where soil
 * covers no surface. Not collective. */
mpsi_area *mpsi_mpm_shared_area(const mpsi_contact_exchange *exchange, const int32_t *block,
                                const int *at, int32_t body);
void mpsi_mpm_free_contact_exchange(mps_context *context, mpsi_contacts *contacts);
