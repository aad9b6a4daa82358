/* room_array.h - arrays of a struct that grow: the memory of a member `name` is the member
 * name_room. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "room.h"

/* As mpsi_room_ensure; the pointer at `array` is that of the memory then. */
bool mpsi_room_bind(mps_context *context, mpsi_room *room, void *array, int64_t count, size_t size);
#define MPSI_ENSURE(context, owner, name, count)                                                   \
  mpsi_room_bind(context, &(owner)->name##_room, &(owner)->name, count, sizeof *(owner)->name)
