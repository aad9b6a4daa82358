/* slots.c - the numbers of walls and bodies: boundaries by the caller's number, then the faces of
 * bodies, in one list that grows; bodies in another. Between steps alone, as images have the
 * numbers of the walls that they are mirrored at.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "slots.h"
#include "fluid/base/flow_solver.h"

#include <string.h>

/* Room for so many walls, the wedges and clipped polygons among them. */
static bool reserve(mps_fluid *f, int32_t walls) {
  enum { ENDS = 2, PLACES = 3 * 2 };
  if (!mpsi_room_ensure(f->context, &f->wedge_room, ENDS * (int64_t)walls, sizeof *f->wedge) ||
      !mpsi_room_ensure(f->context, &f->clip_room, PLACES * (int64_t)walls, sizeof(double)) ||
      !mpsi_room_keep(f->context, &f->wall_room, walls, sizeof *f->wall))
    return false;
  f->wall = f->wall_room.item;
  f->wedge = f->wedge_room.item;
  f->wedges = 0; /* found again */
  return true;
}

/* Moves the walls from `at` on by so many places, and the faces of bodies with them. */
static void move_walls(mps_fluid *f, int at, int by) {
  memmove(f->wall + at + by, f->wall + at, (size_t)(f->walls - at) * sizeof *f->wall);
  for (int b = 0; b < f->bodies; b++)
    if (f->body[b].first >= at) f->body[b].first += by;
  f->walls += by;
}

bool mpsi_fluid_make_boundary(mps_fluid *f, int32_t number) {
  const int32_t more = number + 1 - f->boundaries;
  if (more <= 0) return true;
  if (!reserve(f, f->walls + more)) return false;
  move_walls(f, f->boundaries, more);
  memset(f->wall + f->boundaries, 0, (size_t)more * sizeof *f->wall);
  f->boundaries += more;
  return true;
}

int mpsi_fluid_make_faces(mps_fluid *f, int faces) {
  const int first = f->walls;
  if (!reserve(f, f->walls + faces)) return -1;
  memset(f->wall + first, 0, (size_t)faces * sizeof *f->wall);
  f->walls += faces;
  return first;
}

bool mpsi_fluid_make_body(mps_fluid *f, int32_t number) {
  if (number < f->bodies) return true;
  if (!mpsi_room_keep(f->context, &f->body_room, number + 1, sizeof *f->body)) return false;
  f->body = f->body_room.item;
  memset(f->body + f->bodies, 0, (size_t)(number + 1 - f->bodies) * sizeof *f->body);
  f->bodies = number + 1;
  return true;
}

void mpsi_fluid_drop_slots(mps_fluid *f, int first, int faces) {
  if (faces > 0) move_walls(f, first + faces, -faces);
  while (f->bodies > 0 && !f->body[f->bodies - 1].body) f->bodies--;
  int32_t last = f->boundaries;
  while (last > 0 && !f->wall[last - 1].motion) last--;
  if (last < f->boundaries) move_walls(f, f->boundaries, last - f->boundaries);
  f->boundaries = last;
}
