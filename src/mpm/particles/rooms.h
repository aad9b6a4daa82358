/* rooms.h - memory with an entry for each particle, besides its fields (rooms.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/parts.h"
#include "core/base/room.h"

#include <mps/context.h>

typedef struct mpsi_rooms {
  mpsi_room radix, stencil, places; /* places: memory of the columns t */
  mpsi_room strain;                 /* memory of the columns D */
  mpsi_room rough;
  mpsi_room gone;  /* marks of particles to remove; none where none can be removed */
  mpsi_room force; /* memory of the columns f; none without loads */
} mpsi_rooms;

/* Memory for what the solver stores for each particle; false: refused. Memory for the forces of
 * loads is allocated where there are any, or by mpsi_mpm_force_room. */
bool mpsi_mpm_make_room(mps_context *context, mpsi_grid *grid, mpsi_columns *p, mpsi_rooms *rooms,
                        int64_t particles);
/* Memory as by mpsi_mpm_make_room, without the present contents and no larger than needed. */
bool mpsi_mpm_shrink_room(mps_context *context, mpsi_grid *grid, mpsi_columns *p, mpsi_rooms *rooms,
                          int64_t particles);
bool mpsi_mpm_force_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                         mpsi_rooms *rooms, int64_t particles);
/* Memory for means of the change of volume and for the filter of stresses, as the laws need
 * them. */
bool mpsi_mpm_volume_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                          mpsi_rooms *rooms, int64_t particles, bool means, bool filter);
