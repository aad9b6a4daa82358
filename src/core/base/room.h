/* room.h - arrays that grow and are refilled, such as a grid and its lists that follow the
 * particles. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

typedef struct mpsi_room {
  void *item;
  int64_t capacity;
} mpsi_room;

/* Ensures room for `count` items, without their contents; false when out of memory. Exactly as much
 * at first, then slightly more, so that arrays of moving particles are rarely reallocated. */
bool mpsi_room_ensure(mps_context *context, mpsi_room *room, int64_t count, size_t size);
/* The same, never more than `count`: for large arrays. */
bool mpsi_room_fit(mps_context *context, mpsi_room *room, int64_t count, size_t size);

/* The same, and what is there stays: for lists to which items are added. */
bool mpsi_room_keep(mps_context *context, mpsi_room *room, int64_t count, size_t size);
