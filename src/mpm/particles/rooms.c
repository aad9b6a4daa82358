/* rooms.c - see rooms.h: memory for the sort, loads, means of the change of volume and the filter
 * of stresses. SPDX-License-Identifier: BSD-3-Clause */
#include "rooms.h"
#include "core/particles/particles_internal.h"

#include "mpm/grid/blocks.h"

#include <string.h>

/* Columns over the particles, all in one piece of memory. */
static bool make_columns(mps_context *context, mpsi_room *room, int64_t particles, int32_t columns,
                         double **column) {
  const int64_t line = MPSI_ALIGNMENT / (int64_t)sizeof(double);
  const int64_t stride = (particles + MPSI_PARTICLES_PADDING + line - 1) / line * line;
  if (!mpsi_room_ensure(context, room, columns * stride, sizeof(double))) return false;
  const int64_t widest = room->capacity / columns / line * line;
  for (int c = 0; c < columns; c++)
    column[c] = (double *)room->item + c * (widest > stride ? widest : stride);
  return true;
}

bool mpsi_mpm_force_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                         mpsi_rooms *rooms, int64_t particles) {
  return make_columns(context, &rooms->force, particles, grid->dim, p->f);
}

bool mpsi_mpm_volume_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                          mpsi_rooms *r, int64_t particles, bool means, bool filter) {
  /* G2P writes the columns that exist */
  means = means || r->strain.item, filter = filter || r->rough.item;
  const bool stencil = means || filter;
  const bool good =
      (!stencil || (mpsi_room_ensure(context, &r->stencil, particles, sizeof *p->stencil) &&
                    make_columns(context, &r->places, particles, grid->dim, p->t))) &&
      (!means || make_columns(context, &r->strain, particles, grid->dim * grid->dim, p->D)) &&
      (!filter || make_columns(context, &r->rough, particles, 1, &p->rough));
  p->stencil = r->stencil.item;
  return good;
}

bool mpsi_mpm_make_room(mps_context *context, mpsi_grid *grid, mpsi_columns *p, mpsi_rooms *r,
                        int64_t particles) {
  const bool good = mpsi_room_ensure(context, &r->radix, 2 * particles, sizeof *grid->radix) &&
                    mpsi_mpm_volume_room(context, grid, p, r, particles, !p->laws.at_once,
                                         p->laws.some_filtered) &&
                    (!r->force.item || mpsi_mpm_force_room(context, grid, p, r, particles));
  grid->radix = r->radix.item;
  return good;
}

bool mpsi_mpm_shrink_room(mps_context *context, mpsi_grid *grid, mpsi_columns *p, mpsi_rooms *r,
                          int64_t particles) {
  mpsi_room *const rooms[] = {&r->radix, &r->stencil, &r->places, &r->strain, &r->rough};
  for (size_t k = 0; k < sizeof rooms / sizeof *rooms; k++) {
    mpsi_free(context, rooms[k]->item);
    *rooms[k] = (mpsi_room){0};
  }
  memset(p->D, 0, sizeof p->D);
  memset(p->t, 0, sizeof p->t);
  p->rough = NULL;
  return mpsi_mpm_make_room(context, grid, p, r, particles);
}
