/* room.h - arrays that grow and are filled anew: the grid and its lists follow the particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_ROOM_H
#define MPSI_MPM_ROOM_H

#include "core/internal.h"

typedef struct mpsi_room {
  void *item;
  int64_t capacity;
} mpsi_room;

/* Ensures room for `count` items, keeping none of the contents; false when out of memory. */
bool mpsi_room_ensure(mps_context *context, mpsi_room *room, int64_t count, size_t size);

#endif
