/* walls.c - nodes that are not free: the walls of the domain and the boxes of nodes with prescribed
 * velocity. What they do to the velocity of a node, after all other forces, is an impulse; the sum
 * of these is the force that mps_mpm_get_wall_force tells.
 *
 * Coulomb friction along a frictional wall, (33), (34): the impulse across the wall is known once
 * the velocity into it has been taken away, so the impulse along it is the smaller of that times mu
 * and what stops the sliding.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include "core/retain.h"

#include <string.h>

#define ON_NODE 1e-6 /* cells: the edge of a box this close to a node holds it */

/* ---- which nodes ----------------------------------------------------------------------------- */

/* Nodes of a block that a hold holds, from low to high. */
typedef struct range {
  int low[3], high[3];
} range;

static bool find_range(const mps_mpm *mpm, const int32_t *at, const mpsi_hold *hold, range *out) {
  for (int c = 0; c < 3; c++) {
    const int64_t first = (int64_t)at[c] * MPSI_SIDE;
    const int64_t last = first + (c < mpm->dim ? MPSI_SIDE - 1 : 0);
    if (hold->first[c] > last || hold->last[c] < first) return false;
    out->low[c] = hold->first[c] > first ? (int)(hold->first[c] - first) : 0;
    out->high[c] = (int)((hold->last[c] < last ? hold->last[c] : last) - first);
  }
  return true;
}

/* Lists what holds which block; false where there is no room, `count` says how much is needed. */
static bool list(mps_mpm *mpm, int64_t *count, int64_t *dashes) {
  mpsi_held *held = mpm->boundaries.held_room.item;
  *count = *dashes = 0;
  for (int64_t g = 0; g < mpm->grid.node_count; g++) {
    mpsi_node_block *nodes = &mpm->grid.nodes[g];
    nodes->first_held = (int32_t)*count;
    for (int32_t k = 0; k < MPSI_HOLDS; k++) {
      range r;
      const int32_t kind = mpm->boundaries.hold[k].kind;
      if (kind == MPSI_HOLD_NONE || !find_range(mpm, nodes->at, &mpm->boundaries.hold[k], &r))
        continue;
      const bool absorbs = kind == MPS_WALL_ABSORBING;
      if (*count < mpm->boundaries.held_room.capacity) {
        held[*count] = (mpsi_held){.hold = k, .dash = absorbs ? *dashes : -1};
        memcpy(held[*count].at, nodes->at, sizeof nodes->at);
      }
      if (absorbs) *dashes += mpm->grid.block_nodes / MPSI_SIDE;
      (*count)++;
    }
    nodes->holds = (int32_t)*count - nodes->first_held;
  }
  return *count <= mpm->boundaries.held_room.capacity;
}

static void swap_rooms(mpsi_room *a, mpsi_room *b) {
  const mpsi_room old = *a;
  *a = *b;
  *b = old;
}

/* A new list, in other memory than the old one. */
static mps_status make_list(mps_mpm *mpm, const char *function) {
  int64_t count, dashes;
  swap_rooms(&mpm->boundaries.held_room, &mpm->boundaries.old_held_room);
  swap_rooms(&mpm->boundaries.dash_room, &mpm->boundaries.old_dash_room);
  bool good = list(mpm, &count, &dashes);
  if (!good) {
    good = mpsi_room_ensure(mpm->context, &mpm->boundaries.held_room, count,
                            sizeof *mpm->boundaries.held);
    if (good) list(mpm, &count, &dashes);
  }
  good = good && mpsi_room_ensure(mpm->context, &mpm->boundaries.dash_room, dashes,
                                  sizeof *mpm->boundaries.dash);
  mpm->boundaries.held = mpm->boundaries.held_room.item;
  mpm->boundaries.dash = mpm->boundaries.dash_room.item;
  mpm->boundaries.held_count = good ? count : 0;
  mpm->boundaries.dash_count = good ? dashes : 0;
  if (!good)
    return mpsi_fail_memory(mpm->context, function,
                            (size_t)count * sizeof *mpm->boundaries.held +
                                (size_t)dashes * sizeof(mpsi_dash));
  if (dashes > 0) memset(mpm->boundaries.dash, 0, (size_t)dashes * sizeof *mpm->boundaries.dash);
  return MPS_OK;
}

mps_status mpsi_mpm_list_holds(mps_mpm *mpm, const char *function) {
  const mpsi_held *old = mpm->boundaries.held;
  const mpsi_dash *old_dash = mpm->boundaries.dash;
  const int64_t old_count = mpm->boundaries.held_count;
  const mps_status status = make_list(mpm, function);
  if (status == MPS_OK && mpm->boundaries.dash_count > 0)
    mpsi_mpm_place_dashes(mpm, old, old_count, old_dash);
  return status;
}

mps_status mpsi_mpm_put_dashes(mps_mpm *mpm, const char *function, int64_t count,
                               const mpsi_dash *dash) {
  const mps_status status = make_list(mpm, function);
  if (status != MPS_OK) return status;
  if (count != mpm->boundaries.dash_count)
    return mpsi_fail(mpm->context, function, MPS_ERROR_FORMAT,
                     "there are %lld dashpots of absorbing walls, must be %lld", (long long)count,
                     (long long)mpm->boundaries.dash_count);
  if (count > 0) memcpy(mpm->boundaries.dash, dash, (size_t)count * sizeof *dash);
  return MPS_OK;
}

/* ---- a node ---------------------------------------------------------------------------------- */

#define BLOCK (MPSI_SIDE * MPSI_SIDE * MPSI_SIDE) /* nodes at most */

/* A block at work. */
typedef struct block {
  mps_mpm *mpm;
  mpsi_node *node, *side;         /* side: NULL where the block has none */
  uint8_t held[BLOCK];            /* bit c: nothing else moves component c */
  double push[MPSI_WALLS][BLOCK]; /* N s, of frictional walls at their nodes */
} block;

typedef void (*hold_fn)(block *b, const mpsi_hold *hold, mpsi_held *held, int k);

static void set(block *b, mpsi_held *held, int k, int c, double v) {
  double *at = &b->node[k][MPSI_VECTOR + c];
  held->impulse[c] += b->node[k][MPSI_MASS] * (v - *at);
  *at = v;
}

static void apply_roller(block *b, const mpsi_hold *hold, mpsi_held *held, int k) {
  set(b, held, k, hold->axis, hold->v[hold->axis]);
  b->held[k] |= (uint8_t)(1u << hold->axis);
}

static void apply_dashpot(block *b, const mpsi_hold *hold, mpsi_held *held, int k) {
  if (!(b->node[k][MPSI_MASS] > 0.0)) return;
  double v[3];
  const double *before = b->side ? b->side[k] + MPSI_VECTOR : NULL;
  mpsi_dash *dash = &b->mpm->boundaries.dash[held->dash + mpsi_plane_index(hold->axis, k)];
  mpsi_mpm_dash(b->mpm, hold, dash, b->node[k], before, v);
  for (int c = 0; c < b->mpm->dim; c++)
    if (!(b->held[k] >> c & 1)) set(b, held, k, c, v[c]);
}

/* Takes away the velocity into a frictional wall. */
static void stop_normal(block *b, const mpsi_hold *hold, mpsi_held *held, int k) {
  const int c = hold->axis, number = held->hold;
  const double into = (b->node[k][MPSI_VECTOR + c] - hold->v[c]) * (number % 2 ? 1.0 : -1.0);
  b->push[number][k] = into > 0.0 ? b->node[k][MPSI_MASS] * into : 0.0;
  if (!(into > 0.0)) return;
  set(b, held, k, c, hold->v[c]);
  b->held[k] |= (uint8_t)(1u << c);
}

static void apply_wall_friction(block *b, const mpsi_hold *hold, mpsi_held *held, int k) {
  const double most = hold->friction * b->push[held->hold][k], m = b->node[k][MPSI_MASS];
  double slip[3] = {0.0}, square = 0.0;
  if (!(most > 0.0) || !(m > 0.0)) return;
  for (int c = 0; c < b->mpm->dim; c++) {
    if (b->held[k] >> c & 1) continue;
    slip[c] = b->node[k][MPSI_VECTOR + c] - hold->v[c];
    square += slip[c] * slip[c];
  }
  const double speed = sqrt(square);
  if (!(speed > 0.0)) return;
  const double left = most < m * speed ? 1.0 - most / (m * speed) : 0.0;
  for (int c = 0; c < b->mpm->dim; c++)
    if (slip[c] != 0.0) set(b, held, k, c, hold->v[c] + left * slip[c]);
}

static void apply_fixed(block *b, const mpsi_hold *hold, mpsi_held *held, int k) {
  for (int c = 0; c < b->mpm->dim; c++) set(b, held, k, c, hold->v[c]);
}

static void apply_prescribed(block *b, const mpsi_hold *hold, mpsi_held *held, int k) {
  set(b, held, k, hold->axis, hold->v[hold->axis]);
}

/* ---- a block --------------------------------------------------------------------------------- */

static void for_range(block *b, const mpsi_hold *hold, mpsi_held *held, hold_fn work) {
  range r;
  if (!find_range(b->mpm, held->at, hold, &r)) return;
  for (int z = r.low[2]; z <= r.high[2]; z++)
    for (int y = r.low[1]; y <= r.high[1]; y++)
      for (int x = r.low[0]; x <= r.high[0]; x++)
        work(b, hold, held, (z * MPSI_SIDE + y) * MPSI_SIDE + x);
}

/* What acts across walls comes before friction: where walls meet, that of one must not move a node
 * into the other. */
void mpsi_mpm_hold_nodes(mps_mpm *mpm, int64_t g) {
  static const struct {
    int32_t kind;
    hold_fn work;
  } order[] = {{MPS_WALL_ROLLER, apply_roller},    {MPS_WALL_ABSORBING, apply_dashpot},
               {MPS_WALL_FRICTIONAL, stop_normal}, {MPS_WALL_FRICTIONAL, apply_wall_friction},
               {MPS_WALL_FIXED, apply_fixed},      {MPSI_HOLD_BOX, apply_prescribed}};
  const mpsi_node_block *nodes = &mpm->grid.nodes[g];
  if (nodes->holds == 0) return;
  mpsi_held *first = mpm->boundaries.held + nodes->first_held;
  block b; /* push is written before it is read */
  b.mpm = mpm;
  b.node = mpm->grid.node + mpsi_first_node(mpm, g);
  b.side = nodes->side >= 0 ? mpm->grid.side + mpsi_first_node(mpm, nodes->side) : NULL;
  memset(b.held, 0, sizeof b.held);
  for (int32_t t = 0; t < nodes->holds; t++) memset(first[t].impulse, 0, sizeof first[t].impulse);
  for (size_t pass = 0; pass < sizeof order / sizeof *order; pass++)
    for (int32_t t = 0; t < nodes->holds; t++) {
      const mpsi_hold *hold = &mpm->boundaries.hold[first[t].hold];
      if (hold->kind == order[pass].kind) for_range(&b, hold, &first[t], order[pass].work);
    }
}

/* ---- a step ---------------------------------------------------------------------------------- */

void mpsi_mpm_begin_holds(mps_mpm *mpm, double dt) {
  for (int32_t k = 0; k < MPSI_HOLDS; k++) {
    mpsi_hold *hold = &mpm->boundaries.hold[k];
    if (hold->finds) hold->found += dt;
    for (int c = 0; c < mpm->dim; c++)
      hold->v[c] = hold->signal[c] ? hold->factor[c] * mps_signal_velocity(hold->signal[c],
                                                                           mpm->run.time + 0.5 * dt)
                                   : 0.0;
  }
}

void mpsi_mpm_sum_holds(mps_mpm *mpm) {
  for (int32_t k = 0; k < MPSI_HOLDS; k++) {
    memset(mpm->boundaries.hold[k].force, 0, sizeof mpm->boundaries.hold[k].force);
    if (mpm->boundaries.hold[k].found >= mpm->def.settle) mpm->boundaries.hold[k].finds = false;
  }
  for (int64_t t = 0; t < mpm->boundaries.held_count; t++)
    for (int c = 0; c < mpm->dim; c++)
      mpm->boundaries.hold[mpm->boundaries.held[t].hold].force[c] +=
          mpm->boundaries.held[t].impulse[c] / mpm->run.dt;
}

/* ---- walls ----------------------------------------------------------------------------------- */

mps_status mpsi_mpm_check_wall(mps_context *context, const char *function, int32_t axis, bool upper,
                               int32_t kind, double friction, bool on_axis, bool standard) {
  const char *side = upper ? "upper" : "lower";
  if (kind < MPS_WALL_ROLLER || kind > MPS_WALL_ABSORBING)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "wall_%s[%d] is %d, allowed are 0 (roller), 1 (fixed), 2 (frictional) and 3 "
                     "(absorbing)",
                     side, axis, kind);
  if (!isfinite(friction) || friction < 0.0 || (friction > 0.0 && kind != MPS_WALL_FRICTIONAL))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "wall_friction_%s[%d] is %g with a wall of kind %d, must be finite and >= 0, "
                     "and 0 for other than frictional walls (2)",
                     side, axis, friction, kind);
  if (standard && kind == MPS_WALL_ABSORBING)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "wall_%s[%d] is 3 (absorbing) with scheme 1 (standard), whose splines reach "
                     "over the wall: allowed with 0 (WLS)",
                     side, axis);
  if (on_axis && (kind == MPS_WALL_FRICTIONAL || kind == MPS_WALL_ABSORBING))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "wall_%s[%d] is %d on the axis r = 0, allowed are 0 (roller) and 1 (fixed)",
                     side, axis, kind);
  return MPS_OK;
}

void mpsi_mpm_place_wall(mps_mpm *mpm, int32_t number, int32_t kind, double friction) {
  mpsi_hold *hold = &mpm->boundaries.hold[number];
  const int axis = number / 2;
  const int64_t at = number % 2 ? mpm->grid.high[axis] : mpm->grid.low[axis];
  hold->axis = axis;
  hold->friction = friction;
  hold->finds = kind == MPS_WALL_ABSORBING;
  hold->found = 0.0;
  /* the standard scheme has nodes beyond the wall too */
  const int64_t beyond = mpm->standard ? MPSI_SIDE : 0;
  for (int c = 0; c < mpm->dim; c++)
    hold->first[c] = mpm->grid.low[c] - beyond, hold->last[c] = mpm->grid.high[c] + beyond;
  if (number % 2)
    hold->first[axis] = at;
  else
    hold->last[axis] = at;
  hold->kind = axis < mpm->dim && at > -MPSI_NO_WALL && at < MPSI_NO_WALL ? kind : MPSI_HOLD_NONE;
}

static bool on_axis(const mps_mpm *mpm, int32_t number) {
  return mpm->def.geometry == MPS_AXISYMMETRIC && number == 0 && mpm->def.lower[0] == 0.0;
}

static mps_status find_wall(mps_mpm *mpm, const char *function, int32_t axis, int32_t upper,
                            int32_t *number) {
  if (axis < 0 || axis >= mpm->dim || upper < 0 || upper > 1)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "axis is %d and upper %d, allowed are 0 to %d and 0 or 1", axis, upper,
                     mpm->dim - 1);
  *number = 2 * axis + upper;
  if (mpm->boundaries.hold[*number].kind != MPSI_HOLD_NONE) return MPS_OK;
  return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                   "the domain has no %s wall across %c", upper ? "upper" : "lower", "xyz"[axis]);
}

mps_status mps_mpm_set_wall(mps_mpm *mpm, int32_t axis, int32_t upper, int32_t wall,
                            double friction) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  int32_t number = 0;
  mps_status status = find_wall(mpm, __func__, axis, upper, &number);
  if (status == MPS_OK)
    status = mpsi_mpm_check_wall(mpm->context, __func__, axis, upper == 1, wall, friction,
                                 on_axis(mpm, number), mpm->standard);
  if (status != MPS_OK) return status;
  mpsi_mpm_place_wall(mpm, number, wall, friction);
  mpm->run.stale = true;
  return MPS_OK;
}

static mps_status check_drive(mps_mpm *mpm, const char *function, int32_t component,
                              const mps_signal *signal, double factor) {
  if (component < 0 || component >= mpm->dim)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "component is %d, allowed are 0 to %d", component, mpm->dim - 1);
  if (!isfinite(factor) ||
      (signal && !isfinite(factor * mps_signal_velocity(signal, mpm->run.time))))
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "factor is %g, it and the velocity that it makes must be finite", factor);
  return MPS_OK;
}

static void take_signal(mpsi_hold *hold, int32_t component, mps_signal *signal, double factor) {
  mps_signal *old = hold->signal[component];
  hold->signal[component] = signal ? mpsi_signal_retain(signal) : NULL;
  hold->factor[component] = factor;
  mps_signal_destroy(&old);
}

mps_status mps_mpm_drive_wall(mps_mpm *mpm, int32_t axis, int32_t upper, int32_t component,
                              mps_signal *signal, double factor) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  int32_t number = 0;
  mps_status status = find_wall(mpm, __func__, axis, upper, &number);
  if (status == MPS_OK) status = check_drive(mpm, __func__, component, signal, factor);
  if (status != MPS_OK) return status;
  mpsi_hold *hold = &mpm->boundaries.hold[number];
  if (hold->kind == MPS_WALL_ROLLER && component != axis)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "component is %d, of a roller across axis %d only %d is held", component, axis,
                     axis);
  if (on_axis(mpm, number) && component == 0 && signal)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "component is 0 on the axis r = 0, where the radial velocity is 0");
  take_signal(hold, component, signal, factor);
  return MPS_OK;
}

mps_status mps_mpm_get_wall_force(mps_mpm *mpm, int32_t axis, int32_t upper, double *force) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!force) return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "force is NULL");
  int32_t number = 0;
  const mps_status status = find_wall(mpm, __func__, axis, upper, &number);
  if (status == MPS_OK) memcpy(force, mpm->boundaries.hold[number].force, 3 * sizeof *force);
  return status;
}

/* ---- boxes ----------------------------------------------------------------------------------- */

/* First or last node of a box that begins or ends at x. */
static int64_t box_node(const mps_mpm *mpm, int c, double x, bool last) {
  const double X = mpsi_grid_coordinate(mpm, c, x);
  if (!(X > -(double)MPSI_NO_WALL)) return -MPSI_NO_WALL;
  if (!(X < (double)MPSI_NO_WALL)) return MPSI_NO_WALL;
  return (int64_t)(last ? floor(X + ON_NODE) : ceil(X - ON_NODE));
}

mps_status mps_mpm_drive_nodes(mps_mpm *mpm, const double *lower, const double *upper,
                               int32_t component, mps_signal *signal, double factor, int32_t *box) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!lower || !upper || !box)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     !lower   ? "lower"
                     : !upper ? "upper"
                              : "box");
  const mps_status status = check_drive(mpm, __func__, component, signal, factor);
  if (status != MPS_OK) return status;
  mpsi_hold made = {.kind = MPSI_HOLD_BOX, .axis = component};
  for (int c = 0; c < mpm->dim; c++) {
    made.first[c] = box_node(mpm, c, lower[c], false);
    made.last[c] = box_node(mpm, c, upper[c], true);
    if (!(lower[c] <= upper[c]) || made.first[c] > made.last[c])
      return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                       "the box is [%g, %g] m in %c, must hold a node: origin %g m plus a multiple "
                       "of the cell %g m",
                       lower[c], upper[c], "xyz"[c], mpm -> def.origin[c], mpm->def.cell);
  }
  int32_t number = MPSI_WALLS;
  while (number < MPSI_HOLDS && mpm->boundaries.hold[number].kind != MPSI_HOLD_NONE) number++;
  if (number == MPSI_HOLDS)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "the solver has %d boxes of nodes, the most there can be", MPS_MPM_MAX_BOXES);
  mpm->boundaries.hold[number] = made;
  take_signal(&mpm->boundaries.hold[number], component, signal, factor);
  mpm->run.stale = true;
  *box = number - MPSI_WALLS;
  return MPS_OK;
}

static mps_status find_box(mps_mpm *mpm, const char *function, int32_t box) {
  if (box >= 0 && box < MPS_MPM_MAX_BOXES &&
      mpm->boundaries.hold[MPSI_WALLS + box].kind == MPSI_HOLD_BOX)
    return MPS_OK;
  return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                   "box is %d, must be a number that mps_mpm_drive_nodes gave", box);
}

mps_status mps_mpm_free_nodes(mps_mpm *mpm, int32_t box) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mps_status status = find_box(mpm, __func__, box);
  if (status != MPS_OK) return status;
  mpsi_hold *hold = &mpm->boundaries.hold[MPSI_WALLS + box];
  take_signal(hold, hold->axis, NULL, 0.0);
  hold->kind = MPSI_HOLD_NONE;
  mpm->run.stale = true;
  return MPS_OK;
}

mps_status mps_mpm_get_nodes_force(mps_mpm *mpm, int32_t box, double *force) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!force) return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "force is NULL");
  const mps_status status = find_box(mpm, __func__, box);
  if (status == MPS_OK)
    memcpy(force, mpm->boundaries.hold[MPSI_WALLS + box].force, 3 * sizeof *force);
  return status;
}
