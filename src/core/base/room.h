/* room.h - arrays that grow and are filled anew, such as a grid and its lists that follow the
 * particles. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_ROOM_H
#define MPSI_ROOM_H

#include "core/internal.h"

typedef struct mpsi_room {
  void *item;
  int64_t capacity;
} mpsi_room;

/* Ensures room for `count` items, keeping none of the contents; false when out of memory. Exactly
 * as much at first, then a little more than asked for: what moves needs no more. */
bool mpsi_room_ensure(mps_context *context, mpsi_room *room, int64_t count, size_t size);
/* The same, never more than asked for: for what is large. */
bool mpsi_room_fit(mps_context *context, mpsi_room *room, int64_t count, size_t size);

#endif
