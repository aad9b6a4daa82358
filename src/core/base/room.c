/* room.c - see room.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "room_array.h"

#include <string.h>

#define LEAST_ROOM 16 /* items */

bool mpsi_room_fit(mps_context *context, mpsi_room *room, int64_t count, size_t size) {
  if (count <= room->capacity) return true;
  void *item = mpsi_alloc(context, count, size);
  if (!item) return false;
  mpsi_free(context, room->item);
  *room = (mpsi_room){item, count};
  return true;
}

bool mpsi_room_ensure(mps_context *context, mpsi_room *room, int64_t count, size_t size) {
  if (count <= room->capacity) return true;
  const int64_t wanted = room->capacity > 0 ? count + count / 4 : count;
  return mpsi_room_fit(context, room, wanted < LEAST_ROOM ? LEAST_ROOM : wanted, size);
}

bool mpsi_room_bind(mps_context *context, mpsi_room *room, void *array, int64_t count,
                    size_t size) {
  const bool good = mpsi_room_ensure(context, room, count, size);
  memcpy(array, &room->item, sizeof room->item);
  return good;
}

bool mpsi_room_keep(mps_context *context, mpsi_room *room, int64_t count, size_t size) {
  if (count <= room->capacity) return true;
  const int64_t twice = 2 * room->capacity > count ? 2 * room->capacity : count;
  const int64_t wanted = twice < LEAST_ROOM ? LEAST_ROOM : twice;
  if (!mpsi_grow(context, &room->item, room->capacity, wanted, size)) return false;
  room->capacity = wanted;
  return true;
}
