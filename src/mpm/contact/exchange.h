/* exchange.h - contact by impulses on several ranks. Constraints of one rank change nodes that
 * constraints of others read, update by update (impulses.c): a message for each would cost more
 * than the updates. So each rank sends its constraints and the nodes that they use to its contact
 * partners (partners.h) and sweeps over all of them as one rank would: the same arithmetic on each,
 * and no message between sweeps. A step costs a message between any two partners, and the sweeps
 * that one rank would make over their constraints. Warm-start impulses are exchanged before
 * particles change ranks (warm_start.c). SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_EXCHANGE_H
#define MPSI_MPM_EXCHANGE_H

#include "impulses.h"

#include <mps/domain.h>
#include <mps/mpm.h>

struct mpsi_grid;

/* Replica of a node that some constraint uses, updated identically on all partners; or the
 * area that soil covers there (area.c). */
enum { MPSI_SHARED_NODE, MPSI_SHARED_ACROSS, MPSI_SHARED_AREA }; /* and on, of each body */
typedef struct mpsi_shared_node {
  int32_t at[3]; /* of the whole grid */
  int32_t kind;  /* MPSI_SHARED_..., ACROSS: its values across a thin body (thin_bodies.h) */
  union {
    double value[4];
    mpsi_area area;
  };
  double *home; /* of grid.node, or NULL: of another rank */
} mpsi_shared_node;

typedef struct mpsi_contact_exchange {
  int64_t constraints;  /* of all ranks */
  int64_t nodes, slots; /* of `shared`, of `lookup` */
  mpsi_room constraint, block, weight, node, shared, lookup, warm, mail, list;
} mpsi_contact_exchange;

/* warm_start.c: what contacts keep of the particles of any rank is on all, before particles change
 * ranks or a checkpoint is written. `status`: of the call so far on this rank. Collective. */
mps_status mpsi_mpm_share_warm_start(mpsi_impulses *impulses, const mps_particles *particles,
                                     mps_domain *domain, const char *function, mps_status status);
/* warm_start.c: the same in an order of its own, on any number of ranks. Not collective. */
void mpsi_mpm_order_warm_start(mpsi_impulses *impulses);
/* The constraints of all partners take the place of this rank's in contact.impulses, in the order
 * of one rank, until the next step finds its own. First all agree on `status`. Collective. */
mps_status mpsi_mpm_exchange_contacts(mps_mpm *mpm, const char *function, mps_status status);
/* After the sweeps: velocities to the nodes that are here. Not collective. */
void mpsi_mpm_end_contact_exchange(mpsi_contacts *contacts);
/* shared_nodes.c: the node of all ranks at `at`; where none is yet, one with these values, for
 * which there is room. Not collective. */
mpsi_shared_node *mpsi_mpm_shared_node(mpsi_contact_exchange *exchange,
                                       const struct mpsi_grid *grid, const int32_t *at,
                                       int32_t kind, const double *value);
/* shared_nodes.c: the area at the node `at` under the tile of a block of cells, or NULL: soil
 * covers nothing there. Not collective. */
mpsi_area *mpsi_mpm_shared_area(const mpsi_contact_exchange *exchange, const int32_t *block,
                                const int *at, int32_t body);
void mpsi_mpm_free_contact_exchange(mps_context *context, mpsi_contacts *contacts);

#endif
