/* walls.c - action of the boundaries on the nodes of the domain's sides and of boxes. Each changes
 * the velocity of a node after all other forces, by an impulse; the sums of these impulses are the
 * reactions of mps_mpm_get_reaction.
 *
 * Coulomb friction along a frictional side, Nakamura (33), (34): the impulse normal to the side
 * removes the velocity into it; the impulse along the side is the smaller of mu times that and the
 * impulse that stops the sliding. In saturated ground the limit is of the ground's part of the
 * normal impulse (absorb.c). SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/room_array.h"
#include "corners.h"
#include "free_field.h"
#include "kinds.h"
#include "mpm/base/energy.h"
#include "mpm/contact/thin_bodies.h"
#include "mpm/ranks/partition.h"

#include <string.h>

/* ---- lists of nodes -------------------------------------------------------------------------- */

/* Lists the boundary conditions of each block of nodes; false where there is no memory, `count` is
 * the number needed. */
static bool list_held(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                      mpsi_partition *partition, int64_t *count, int64_t *dashpots,
                      int64_t *borne) {
  mpsi_held *held = boundaries->held_room.item;
  const int64_t plane = grid->block_nodes / MPSI_SIDE;
  *count = *dashpots = *borne = 0;
  for (int64_t g = 0; g < grid->node_count; g++) {
    mpsi_node_block *nodes = &grid->nodes[g];
    nodes->first_held = (int32_t)*count;
    for (int32_t k = 0; k < boundaries->count; k++) {
      mpsi_range r;
      const mpsi_boundary_kind *kind = mpsi_kind_of(&boundaries->boundary[k]);
      if (kind->turn == MPSI_TURN_NEVER || boundaries->boundary[k].ids ||
          !mpsi_find_range(grid->dim, nodes->at, &boundaries->boundary[k], &r))
        continue;
      if (*count < boundaries->held_room.capacity) {
        held[*count] = (mpsi_held){.boundary = k,
                                   .dashpot = kind->absorbs ? *dashpots : -1,
                                   .borne = kind->friction ? *borne : -1,
                                   .counted = !partition || mpsi_mpm_counts_node_block(grid, g),
                                   .whole = !partition || mpsi_mpm_node_block_complete(grid, g)};
        memcpy(held[*count].at, nodes->at, sizeof nodes->at);
      }
      if (kind->absorbs) *dashpots += plane;
      if (kind->friction) *borne += plane;
      (*count)++;
    }
    nodes->held_count = (int32_t)*count - nodes->first_held;
  }
  return *count <= boundaries->held_room.capacity;
}

static void swap_rooms(mpsi_room *a, mpsi_room *b) {
  const mpsi_room old = *a;
  *a = *b;
  *b = old;
}

/* Makes a new list in other memory than the old one, which stays valid if there is no memory. */
static mps_status make_list(const mpsi_boundary_setup *setup, const char *function) {
  int64_t count, dashpots, borne;
  setup->boundaries->outdated = true;
  MPSI_TRY(mpsi_mpm_list_mirrors(setup->context, setup->grid, setup->boundaries, setup->mirrors,
                                 setup->def, function));
  swap_rooms(&setup->boundaries->held_room, &setup->boundaries->old_held_room);
  swap_rooms(&setup->boundaries->dashpot_room, &setup->boundaries->old_dashpot_room);
  bool good =
      list_held(setup->grid, setup->boundaries, setup->partition, &count, &dashpots, &borne);
  if (!good) {
    good = MPSI_ENSURE(setup->context, setup->boundaries, held, count);
    if (good)
      list_held(setup->grid, setup->boundaries, setup->partition, &count, &dashpots, &borne);
  }
  good = good && MPSI_ENSURE(setup->context, setup->boundaries, dashpot, dashpots) &&
         (!setup->water || MPSI_ENSURE(setup->context, setup->boundaries, borne, borne));
  if (!good) {
    swap_rooms(&setup->boundaries->held_room, &setup->boundaries->old_held_room);
    swap_rooms(&setup->boundaries->dashpot_room, &setup->boundaries->old_dashpot_room);
  }
  setup->boundaries->held = setup->boundaries->held_room.item;
  setup->boundaries->dashpot = setup->boundaries->dashpot_room.item;
  if (!good)
    return mpsi_fail_memory(setup->context, function,
                            (size_t)count * sizeof *setup->boundaries->held +
                                (size_t)dashpots * sizeof(mpsi_dashpot) +
                                (size_t)borne * sizeof(mpsi_borne));
  setup->boundaries->outdated = false;
  setup->boundaries->held_count = count;
  setup->boundaries->dashpot_count = dashpots;
  setup->boundaries->borne_count = setup->water ? borne : 0;
  if (borne > 0 && setup->water)
    memset(setup->boundaries->borne, 0, (size_t)borne * sizeof *setup->boundaries->borne);
  if (dashpots > 0)
    memset(setup->boundaries->dashpot, 0, (size_t)dashpots * sizeof *setup->boundaries->dashpot);
  return MPS_OK;
}

/* Lists the boundary conditions, with the dashpots of the list before. */
static mps_status list_again(const mpsi_boundary_setup *setup, const char *function,
                             mps_status status) {
  const mpsi_held_list old = {setup->boundaries->held, setup->boundaries->held_count,
                              setup->boundaries->dashpot};
  if (status == MPS_OK) status = make_list(setup, function);
  if (!mpsi_mpm_absorbs(setup->boundaries)) return status;
  if (setup->partition) {
    status = mpsi_domain_agree(setup->partition->domain, function, status);
    if (status == MPS_OK) status = mpsi_mpm_send_dashpots(setup, function, &old);
    setup->boundaries->outdated = status != MPS_OK;
  } else if (status == MPS_OK) {
    mpsi_mpm_carry_dashpots(setup->grid, setup->boundaries, &old);
  }
  return status;
}

mps_status mpsi_mpm_update_boundaries(const mpsi_boundary_setup *setup, const char *function,
                                      mps_status status) {
  mpsi_boundaries *b = setup->boundaries;
  if (b->outdated) status = list_again(setup, function, status);
  if (!b->renew || !mpsi_mpm_absorbs(b)) return status;
  if (setup->partition)
    status = mpsi_mpm_exchange_dashpots(setup, function, status);
  else if (status == MPS_OK)
    mpsi_mpm_find_dashpots(setup->grid, setup->p, b, NULL);
  b->renew = status != MPS_OK;
  return status;
}

mps_status mpsi_mpm_list_boundaries(const mpsi_boundary_setup *setup, const char *function,
                                    mps_status status) {
  setup->boundaries->outdated = setup->boundaries->renew = true;
  return mpsi_mpm_update_boundaries(setup, function, status);
}

void mpsi_mpm_plan_dashpots(mpsi_boundaries *boundaries, int64_t steps) {
  enum { EVERY = 8 };
  boundaries->renew = boundaries->renew || steps % EVERY == 0;
}

mps_status mpsi_mpm_put_dashpots(const mpsi_boundary_setup *setup, const char *function,
                                 int64_t count, const mpsi_dashpot *dashpot) {
  MPSI_TRY(make_list(setup, function));
  setup->boundaries->renew = false;
  const int64_t plane = setup->grid->block_nodes / MPSI_SIDE;
  int64_t expected = 0;
  for (int64_t t = 0; t < setup->boundaries->held_count; t++) {
    const mpsi_held *held = &setup->boundaries->held[t];
    if (held->dashpot < 0 || !held->whole) continue;
    if (expected + plane <= count)
      memcpy(setup->boundaries->dashpot + held->dashpot, dashpot + expected,
             (size_t)plane * sizeof *dashpot);
    expected += plane;
  }
  if (count == expected) return MPS_OK;
  return mpsi_fail(setup->context, function, MPS_ERROR_FORMAT,
                   "there are %lld dashpots of absorbing walls, must be %lld", (long long)count,
                   (long long)expected);
}

void mpsi_mpm_keep_dashpots(mpsi_boundaries *boundaries, int64_t count,
                            const mpsi_dashpot *dashpot) {
  if (count > 0) memcpy(boundaries->warm_room.item, dashpot, (size_t)count * sizeof *dashpot);
  boundaries->warm = count;
}

/* ---- boundary conditions of a node ----------------------------------------------------------- */

#define BLOCK (MPSI_SIDE * MPSI_SIDE * MPSI_SIDE) /* most nodes of a block */

/* A block of nodes whose boundary conditions are applied. */
typedef struct block {
  const mpsi_grid *grid;
  const mpsi_boundaries *boundaries;
  double dt;              /* s */
  mpsi_node *node, *side; /* side: NULL where the block has none */
  uint8_t *held;          /* bit c: a boundary alone determines component c */
  bool again;             /* values across thin bodies, whose nodes have been counted already */
  mpsi_held *first;       /* its boundary conditions, `held_count` of them */
  int32_t held_count;
  bool joined; /* two sides of the kind that acts now may share nodes of this block */
  double (*normal_impulse)[BLOCK]; /* mpsi_side_impulses; written before it is read */
} block;

typedef void (*prescribe_fn)(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k);

/* Adds an impulse on component c of node k to those of the boundary, which moves with boundary->v.
 */
static void count_impulse(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k, int c,
                          double impulse) {
  double x[3];
  mpsi_node_place(b->grid, held->at, k, x);
  held->impulse[c] += impulse;
  held->moment[(c + 2) % 3] -= x[(c + 1) % 3] * impulse; /* x cross impulse */
  held->moment[(c + 1) % 3] += x[(c + 2) % 3] * impulse;
  held->work += impulse * boundary->v[c];
}

/* Sets component c of the velocity of node k to v, by an impulse of the boundary, which moves with
 * boundary->v. */
static void set(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k, int c, double v) {
  double *at = &b->node[k][MPSI_VECTOR + c];
  count_impulse(b, boundary, held, k, c, b->node[k][MPSI_MASS] * (v - *at));
  *at = v;
}

static void prescribe_across(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k) {
  set(b, boundary, held, k, boundary->axis, boundary->v[boundary->axis]);
  b->held[k] |= (uint8_t)(1u << boundary->axis);
}

/* ---- sides that join ------------------------------------------------------------------------- */

/* Sides of one kind that share a node: what they do there together does not depend on the order of
 * their numbers. */
typedef struct meeting {
  int32_t count;
  mpsi_held *held[3];
  const mpsi_boundary *boundary[3];
} meeting;

static bool covers(const block *b, const mpsi_boundary *boundary, const mpsi_held *held, int k) {
  int place[3];
  mpsi_unravel(k, MPSI_SIDE, place);
  for (int c = 0; c < b->grid->dim; c++) {
    const int64_t node = (int64_t)held->at[c] * MPSI_SIDE + place[c];
    if (node < boundary->first[c] || node > boundary->last[c]) return false;
  }
  return true;
}

/* The sides of the kind of `held` that share node k, in the order of their numbers. */
static meeting find_meeting(const block *b, mpsi_held *held, int k) {
  const mpsi_boundary *all = b->boundaries->boundary, *boundary = &all[held->boundary];
  meeting out = {1, {held}, {boundary}};
  if (!b->joined || held->boundary >= MPSI_SIDES) return out;
  out.count = 0;
  for (int32_t t = 0; t < b->held_count; t++) {
    mpsi_held *other = &b->first[t];
    const mpsi_boundary *side = &all[other->boundary];
    if (other->boundary >= MPSI_SIDES || side->kind != boundary->kind ||
        !covers(b, side, other, k) || out.count == 3)
      continue;
    out.held[out.count] = other;
    out.boundary[out.count++] = side;
  }
  return out;
}

static void absorb_at_corner(block *b, const meeting *m, int k) {
  mpsi_dashpot *dashpot[3];
  double v[3], force[3][3];
  for (int32_t s = 0; s < m->count; s++)
    dashpot[s] =
        &b->boundaries->dashpot[m->held[s]->dashpot + mpsi_plane_index(m->boundary[s]->axis, k)];
  const double *before = b->side ? b->side[k] + MPSI_VECTOR : NULL;
  mpsi_mpm_apply_dashpots(b->grid->dim, b->dt, m->count, m->boundary, dashpot, b->node[k], before,
                          v, force);
  for (int c = 0; c < b->grid->dim; c++) {
    if (b->held[k] >> c & 1) continue;
    for (int32_t s = 0; s < m->count; s++)
      count_impulse(b, m->boundary[s], m->held[s], k, c, b->dt * force[s][c]);
    b->node[k][MPSI_VECTOR + c] = v[c];
  }
}

static void absorb(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k) {
  if (!(b->node[k][MPSI_MASS] > 0.0)) return;
  const meeting sides = find_meeting(b, held, k);
  if (sides.count > 1) {
    if (sides.held[0] == held) absorb_at_corner(b, &sides, k);
    return;
  }
  double v[3];
  const double *before = b->side ? b->side[k] + MPSI_VECTOR : NULL;
  mpsi_dashpot *dashpot =
      &b->boundaries->dashpot[held->dashpot + mpsi_plane_index(boundary->axis, k)];
  mpsi_mpm_apply_dashpot(b->grid, b->dt, boundary, dashpot, b->node[k], before, v);
  for (int c = 0; c < b->grid->dim; c++)
    if (!(b->held[k] >> c & 1)) set(b, boundary, held, k, c, v[c]);
}

/* Changes component c of the velocity of node k by an impulse; its work is another's to count. */
static void add_impulse(block *b, mpsi_held *held, int k, int c, double impulse) {
  double x[3];
  mpsi_node_place(b->grid, held->at, k, x);
  held->impulse[c] += impulse;
  held->moment[(c + 2) % 3] -= x[(c + 1) % 3] * impulse;
  held->moment[(c + 1) % 3] += x[(c + 2) % 3] * impulse;
  b->node[k][MPSI_VECTOR + c] += impulse / b->node[k][MPSI_MASS];
}

/* Traction by the stresses of the column at a free-field side. */
static void add_traction(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k) {
  int plane;
  const mpsi_field_node *beside = mpsi_mpm_beside(b->grid, boundary, held->at, k, &plane);
  if (!beside || b->again || !(b->node[k][MPSI_MASS] > 0.0)) return;
  for (int c = 0; c < 2; c++) add_impulse(b, held, k, c, b->dt * beside->traction[plane][c]);
}

/* Dashpots between the column and a free-field side, implicit; then the work of both: that of the
 * stresses by the velocity of the node at the end, that of the dashpots by the column's. */
static void absorb_to_field(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k) {
  int plane;
  const mpsi_field_node *beside = mpsi_mpm_beside(b->grid, boundary, held->at, k, &plane);
  const double m = b->node[k][MPSI_MASS];
  if (!beside || b->again || !(m > 0.0)) return;
  for (int c = 0; c < 2; c++) {
    const double damping = plane > 0 ? 0.0 : c == boundary->axis ? beside->across : beside->along;
    const double per_mass = b->dt * damping / m, *v = &b->node[k][MPSI_VECTOR + c];
    const double impulse = m * (per_mass / (1.0 + per_mass)) * (beside->v[c] - *v);
    if (!(b->held[k] >> c & 1)) {
      add_impulse(b, held, k, c, impulse);
      held->work += impulse * beside->v[c];
    }
    held->work += b->dt * beside->traction[plane][c] * *v;
  }
}

/* Removes the velocity into a frictional side. */
static void stop_inward(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k) {
  const int c = boundary->axis, number = held->boundary;
  const double into = (b->node[k][MPSI_VECTOR + c] - boundary->v[c]) * (number % 2 ? 1.0 : -1.0);
  b->normal_impulse[number][k] = into > 0.0 ? b->node[k][MPSI_MASS] * into : 0.0;
  if (!(into > 0.0)) return;
  set(b, boundary, held, k, c, boundary->v[c]);
  b->held[k] |= (uint8_t)(1u << c);
}

static double most_friction(const block *b, const mpsi_boundary *boundary, const mpsi_held *held,
                            int k) {
  return boundary->friction * mpsi_side_share(b->boundaries, held, k) *
         b->normal_impulse[held->boundary][k];
}

/* Whether a node with the velocity `v` along axis c would go into a frictional side that shares it;
 * *stop: the velocity of that side. */
static bool goes_beyond(const meeting *sides, int c, double v, double *stop) {
  for (int32_t s = 0; s < sides->count; s++) {
    if (sides->boundary[s]->axis != c) continue;
    *stop = sides->boundary[s]->v[c];
    return (v - *stop) * (sides->held[s]->boundary % 2 ? 1.0 : -1.0) > 0.0;
  }
  return false;
}

/* Friction along the edge of sides that all bear, the only direction in which their node moves; up
 * to another one of `sides`. */
static void slow_along_edge(block *b, const meeting *sides, const meeting *m, const double *most,
                            int k) {
  const double mass = b->node[k][MPSI_MASS];
  for (int c = 0; c < b->grid->dim; c++) {
    if (b->held[k] >> c & 1) continue;
    double velocity[3], impulse[3], stop, part = 1.0;
    for (int32_t s = 0; s < m->count; s++) velocity[s] = m->boundary[s]->v[c];
    double *v = &b->node[k][MPSI_VECTOR + c];
    double after = mpsi_mpm_edge_friction(m->count, mass, *v, velocity, most, impulse);
    if (goes_beyond(sides, c, after, &stop)) {
      part = (stop - *v) / (after - *v);
      after = stop;
      b->held[k] |= (uint8_t)(1u << c);
    }
    *v = after;
    for (int32_t s = 0; s < m->count; s++)
      count_impulse(b, m->boundary[s], m->held[s], k, c, part * impulse[s]);
  }
}

/* Friction of one side along the components that are free. Those that it would take into another
 * one of `sides` end there: what is left of the limit *most then acts along the others, and the
 * function returns true. */
static bool slide(block *b, const meeting *sides, const mpsi_boundary *boundary, mpsi_held *held,
                  int k, double *most) {
  const double m = b->node[k][MPSI_MASS];
  double slip[3] = {0.0}, square = 0.0, used = 0.0, stop;
  bool ended = false;
  for (int c = 0; c < b->grid->dim; c++) {
    if (b->held[k] >> c & 1) continue;
    slip[c] = b->node[k][MPSI_VECTOR + c] - boundary->v[c];
    square += slip[c] * slip[c];
  }
  const double speed = sqrt(square);
  if (!(speed > 0.0)) return false;
  const double left = *most < m * speed ? 1.0 - *most / (m * speed) : 0.0;
  for (int c = 0; c < b->grid->dim; c++) {
    if (slip[c] == 0.0 || !goes_beyond(sides, c, boundary->v[c] + left * slip[c], &stop)) continue;
    const double impulse = m * (stop - b->node[k][MPSI_VECTOR + c]);
    used += impulse * impulse;
    set(b, boundary, held, k, c, stop);
    b->held[k] |= (uint8_t)(1u << c);
    ended = true;
  }
  for (int c = 0; c < b->grid->dim && !ended; c++)
    if (slip[c] != 0.0) set(b, boundary, held, k, c, boundary->v[c] + left * slip[c]);
  if (ended) *most = sqrt(fmax(*most * *most - used, 0.0));
  return ended;
}

static void apply_friction(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k) {
  double most = most_friction(b, boundary, held, k), limit[3];
  if (!(most > 0.0) || !(b->node[k][MPSI_MASS] > 0.0)) return;
  const meeting sides = find_meeting(b, held, k);
  meeting bearing = {.count = 0};
  for (int32_t s = 0; s < sides.count; s++) {
    limit[bearing.count] = most_friction(b, sides.boundary[s], sides.held[s], k);
    bearing.boundary[bearing.count] = sides.boundary[s],
    bearing.held[bearing.count] = sides.held[s];
    bearing.count += limit[bearing.count] > 0.0;
  }
  if (bearing.count > 1) {
    if (bearing.held[0] == held) slow_along_edge(b, &sides, &bearing, limit, k);
    return;
  }
  while (slide(b, &sides, boundary, held, k, &most)) continue;
}

/* At the corner of fixed sides each component across one of them is its velocity; the one along
 * their edge the mean of theirs. */
static void prescribe_corner(block *b, const meeting *m, int k) {
  for (int c = 0; c < b->grid->dim; c++) {
    double v = 0.0, share[3];
    for (int32_t s = 0; s < m->count; s++) {
      share[s] = mpsi_mpm_corner_share(m->count, m->boundary, UINT32_MAX, c, s);
      v += share[s] * m->boundary[s]->v[c];
    }
    double *at = &b->node[k][MPSI_VECTOR + c];
    const double impulse = b->node[k][MPSI_MASS] * (v - *at);
    for (int32_t s = 0; s < m->count; s++)
      if (share[s] > 0.0) count_impulse(b, m->boundary[s], m->held[s], k, c, share[s] * impulse);
    *at = v;
  }
  b->held[k] |= (uint8_t)m->boundary[0]->dofs;
}

/* Prescribes all components at a fixed side, the chosen ones in a box. */
static void prescribe(block *b, const mpsi_boundary *boundary, mpsi_held *held, int k) {
  const meeting sides = find_meeting(b, held, k);
  if (sides.count > 1) {
    if (sides.held[0] == held) prescribe_corner(b, &sides, k);
    return;
  }
  for (int c = 0; c < b->grid->dim; c++)
    if (boundary->dofs >> c & 1) set(b, boundary, held, k, c, boundary->v[c]);
  b->held[k] |= (uint8_t)boundary->dofs;
}

/* ---- boundary conditions of a block ---------------------------------------------------------- */

static void for_range(block *b, const mpsi_boundary *boundary, mpsi_held *held, prescribe_fn work) {
  mpsi_range r;
  if (!mpsi_find_range(b->grid->dim, held->at, boundary, &r)) return;
  const int64_t counted = b->again ? held->count : 0;
  held->count = 0;
  for (int z = r.low[2]; z <= r.high[2]; z++)
    for (int y = r.low[1]; y <= r.high[1]; y++)
      for (int x = r.low[0]; x <= r.high[0]; x++) {
        const int k = (z * MPSI_SIDE + y) * MPSI_SIDE + x;
        held->count += b->node[k][MPSI_MASS] > 0.0;
        work(b, boundary, held, k);
      }
  if (b->again) held->count = counted;
}

static void begin_block(const mpsi_grid *grid, const mpsi_boundaries *boundaries, double dt,
                        int64_t g, uint8_t *fixed, block *b) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  b->grid = grid, b->boundaries = boundaries, b->dt = dt;
  b->node = grid->node + mpsi_first_node(grid, g);
  b->side = nodes->side >= 0 ? grid->side + mpsi_first_node(grid, nodes->side) : NULL;
  b->held = fixed;
  b->first = boundaries->held + nodes->first_held, b->held_count = nodes->held_count;
  b->again = g >= grid->node_count;
  memset(fixed, 0, (size_t)grid->block_nodes);
}

void mpsi_mpm_begin_held(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int64_t g) {
  mpsi_held *first = boundaries->held + grid->nodes[g].first_held;
  for (int32_t t = 0; t < grid->nodes[g].held_count; t++) {
    memset(first[t].impulse, 0, sizeof first[t].impulse);
    memset(first[t].moment, 0, sizeof first[t].moment);
    first[t].work = 0.0;
    first[t].count = 0;
  }
}

/* Whether two sides of `kind` are among the boundary conditions of the block. */
static bool sides_join(const block *b, int32_t kind) {
  int32_t count = 0;
  for (int32_t t = 0; t < b->held_count && b->first[t].boundary < MPSI_SIDES; t++)
    count += b->boundaries->boundary[b->first[t].boundary].kind == kind;
  return count > 1;
}

void mpsi_mpm_prescribe_mirrors(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                                const mpsi_mirrors *mirrors, double dt, int64_t g) {
  uint8_t fixed[BLOCK];
  const mpsi_node_block *nodes = &grid->nodes[g];
  mpsi_held *first = boundaries->held + nodes->first_held;
  if (nodes->held_count == 0) return;
  block b = {.normal_impulse = NULL}; /* mirrors have no friction */
  begin_block(grid, boundaries, dt, g, fixed, &b);
  b.joined = sides_join(&b, MPS_BOUNDARY_HELD);
  static const mpsi_prescribes passes[] = {MPSI_PRESCRIBES_ACROSS, MPSI_PRESCRIBES_ALL};
  for (int pass = 0; pass < 2; pass++) /* where neither is prescribed, the nodes move */
    for (int32_t t = 0; t < nodes->held_count; t++) {
      const mpsi_boundary *boundary = &boundaries->boundary[first[t].boundary];
      if (mpsi_is_mirror(mirrors, first[t].boundary) &&
          mpsi_kind_of(boundary)->prescribes == passes[pass])
        for_range(&b, boundary, &first[t], pass == 0 ? prescribe_across : prescribe);
    }
  for (int k = 0; k < grid->block_nodes && nodes->split; k++)
    for (int c = 0; c < grid->dim; c++)
      if (fixed[k] >> c & 1) b.side[k][MPSI_VECTOR + c] = b.node[k][MPSI_VECTOR + c];
}

/* Boundaries that act normal to walls come before friction: where two walls join, friction along
 * one must not move a node into the other. */
void mpsi_mpm_prescribe_nodes(const mpsi_grid *grid, const mpsi_boundaries *boundaries, double dt,
                              int64_t g, mpsi_side_impulses scratch, uint8_t *fixed) {
  static const struct {
    int32_t kind;
    prescribe_fn work;
  } order[] = {{MPS_BOUNDARY_FREE_FIELD, add_traction}, {MPS_BOUNDARY_ROLLER, prescribe_across},
               {MPS_BOUNDARY_ABSORBING, absorb},        {MPS_BOUNDARY_FREE_FIELD, absorb_to_field},
               {MPS_BOUNDARY_FRICTIONAL, stop_inward},  {MPS_BOUNDARY_FRICTIONAL, apply_friction},
               {MPS_BOUNDARY_HELD, prescribe},          {MPS_BOUNDARY_DRIVEN, prescribe}};
  const mpsi_node_block *nodes = &grid->nodes[g];
  if (nodes->held_count == 0) return;
  mpsi_held *first = boundaries->held + nodes->first_held;
  block b;
  begin_block(grid, boundaries, dt, g, fixed, &b);
  b.normal_impulse = scratch;
  for (size_t pass = 0; pass < sizeof order / sizeof *order; pass++) {
    b.joined = sides_join(&b, order[pass].kind);
    for (int32_t t = 0; t < nodes->held_count; t++) {
      const mpsi_boundary *boundary = &boundaries->boundary[first[t].boundary];
      if (boundary->kind == order[pass].kind) for_range(&b, boundary, &first[t], order[pass].work);
    }
  }
}

/* ---- a step ---------------------------------------------------------------------------------- */

void mpsi_mpm_begin_boundaries(const mpsi_boundaries *boundaries, double dt) {
  for (int32_t k = 0; k < boundaries->count; k++)
    if (boundaries->boundary[k].finds) boundaries->boundary[k].found += dt;
}

/* Adds the sums of the step before to those of all steps. */
static void begin_sums(mpsi_boundary *boundary) {
  if (!boundary->sums) return;
  for (int k = 0; k < MPSI_BOUNDARY_MASS; k++)
    mpsi_exact_merge(&boundary->sums->all[k], &boundary->sums->step[k]);
  memset(boundary->sums->step, 0, sizeof boundary->sums->step);
  boundary->count = 0;
}

void mpsi_mpm_sum_boundaries(const mpsi_grid *grid, mpsi_boundaries *boundaries,
                             const mpsi_mirrors *mirrors, mpsi_energy *energy) {
  mpsi_boundary *boundary = boundaries->boundary;
  for (int32_t k = 0; k < boundaries->count; k++) {
    begin_sums(&boundary[k]);
    if (boundary[k].found >= boundary[k].settle) boundary[k].finds = false;
  }
  for (int64_t t = 0; t < boundaries->held_count; t++) {
    const mpsi_held *held = &boundaries->held[t];
    if (!held->counted) continue;
    mpsi_mpm_boundary_add_impulse(&boundary[held->boundary], held->impulse, held->moment,
                                  held->work, held->count);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARIES, held->work);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARY_LOSS, held->work);
  }
  mpsi_mpm_sum_mirrors(grid, boundaries, mirrors, energy);
}
