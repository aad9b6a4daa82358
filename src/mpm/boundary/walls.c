/* walls.c - action of the boundaries on the nodes of the domain's sides, boxes of nodes and lists
 * of particles with prescribed velocity. Each changes the velocity of a node after all other
 * forces, by an impulse; the sums of these impulses are the reactions of mps_mpm_get_reaction.
 *
 * Coulomb friction along a frictional side, Nakamura (33), (34): the impulse normal to the side
 * removes the velocity into it; the impulse along the side is the smaller of mu times that and the
 * impulse that stops the sliding. SPDX-License-Identifier: BSD-3-Clause */
#include "free_field.h"
#include "mpm/base/all_parts.h"

#include <string.h>

/* ---- lists of nodes -------------------------------------------------------------------------- */

/* Lists the boundary conditions of each block of nodes; false where there is no memory, `count` is
 * the number needed. */
static bool list_held(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                      mpsi_partition *partition, int64_t *count, int64_t *dashpots) {
  mpsi_held *held = boundaries->held_room.item;
  *count = *dashpots = 0;
  for (int64_t g = 0; g < grid->node_count; g++) {
    mpsi_node_block *nodes = &grid->nodes[g];
    nodes->first_held = (int32_t)*count;
    for (int32_t k = 0; k < boundaries->holds; k++) {
      mpsi_range r;
      const int32_t kind = boundaries->hold[k].kind;
      if (kind == MPSI_BOUNDARY_NONE || kind == MPS_BOUNDARY_OPEN || boundaries->hold[k].ids ||
          !mpsi_find_range(grid->dim, nodes->at, &boundaries->hold[k], &r))
        continue;
      const bool absorbs = kind == MPS_BOUNDARY_ABSORBING;
      if (*count < boundaries->held_room.capacity) {
        held[*count] = (mpsi_held){.hold = k,
                                   .dashpot = absorbs ? *dashpots : -1,
                                   .counted = !partition || mpsi_mpm_counts_node_block(grid, g),
                                   .whole = !partition || mpsi_mpm_node_block_complete(grid, g)};
        memcpy(held[*count].at, nodes->at, sizeof nodes->at);
      }
      if (absorbs) *dashpots += grid->block_nodes / MPSI_SIDE;
      (*count)++;
    }
    nodes->holds = (int32_t)*count - nodes->first_held;
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
  int64_t count, dashpots;
  setup->boundaries->outdated = true;
  const mps_status status = mpsi_mpm_list_mirrors(setup->context, setup->grid, setup->boundaries,
                                                  setup->mirrors, setup->def, function);
  if (status != MPS_OK) return status;
  swap_rooms(&setup->boundaries->held_room, &setup->boundaries->old_held_room);
  swap_rooms(&setup->boundaries->dashpot_room, &setup->boundaries->old_dashpot_room);
  bool good = list_held(setup->grid, setup->boundaries, setup->partition, &count, &dashpots);
  if (!good) {
    good = mpsi_room_ensure(setup->context, &setup->boundaries->held_room, count,
                            sizeof *setup->boundaries->held);
    if (good) list_held(setup->grid, setup->boundaries, setup->partition, &count, &dashpots);
  }
  good = good && mpsi_room_ensure(setup->context, &setup->boundaries->dashpot_room, dashpots,
                                  sizeof *setup->boundaries->dashpot);
  if (!good) {
    swap_rooms(&setup->boundaries->held_room, &setup->boundaries->old_held_room);
    swap_rooms(&setup->boundaries->dashpot_room, &setup->boundaries->old_dashpot_room);
    return mpsi_fail_memory(setup->context, function,
                            (size_t)count * sizeof *setup->boundaries->held +
                                (size_t)dashpots * sizeof(mpsi_dashpot));
  }
  setup->boundaries->held = setup->boundaries->held_room.item;
  setup->boundaries->dashpot = setup->boundaries->dashpot_room.item;
  setup->boundaries->outdated = false;
  setup->boundaries->held_count = count;
  setup->boundaries->dashpot_count = dashpots;
  if (dashpots > 0)
    memset(setup->boundaries->dashpot, 0, (size_t)dashpots * sizeof *setup->boundaries->dashpot);
  return MPS_OK;
}

mps_status mpsi_mpm_list_boundaries(const mpsi_boundary_setup *setup, const char *function,
                                    mps_status status) {
  const mpsi_held_list old = {setup->boundaries->held, setup->boundaries->held_count,
                              setup->boundaries->dashpot};
  if (status == MPS_OK) status = make_list(setup, function);
  if (!mpsi_mpm_absorbs(setup->boundaries)) return status;
  if (!setup->partition) {
    if (status == MPS_OK)
      mpsi_mpm_place_dashpots(setup->grid, setup->p, setup->boundaries, NULL, old.held, old.count,
                              old.dashpot);
    return status;
  }
  status = mpsi_domain_agree(setup->partition->domain, function, status);
  if (status == MPS_OK) status = mpsi_mpm_exchange_dashpots(setup, function, &old);
  setup->boundaries->outdated = status != MPS_OK;
  return status;
}

mps_status mpsi_mpm_update_boundaries(const mpsi_boundary_setup *setup, const char *function,
                                      mps_status status) {
  return setup->boundaries->outdated ? mpsi_mpm_list_boundaries(setup, function, status) : status;
}

mps_status mpsi_mpm_put_dashpots(const mpsi_boundary_setup *setup, const char *function,
                                 int64_t count, const mpsi_dashpot *dashpot) {
  const mps_status status = make_list(setup, function);
  if (status != MPS_OK) return status;
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
  double normal_impulse[MPSI_SIDES]
                       [BLOCK]; /* N s, normal impulses of frictional sides at their nodes */
} block;

typedef void (*hold_fn)(block *b, const mpsi_boundary *hold, mpsi_held *held, int k);

/* Sets component c of the velocity of node k to v, by an impulse of the boundary, which moves with
 * hold->v. */
static void set(block *b, const mpsi_boundary *hold, mpsi_held *held, int k, int c, double v) {
  double *at = &b->node[k][MPSI_VECTOR + c];
  const double impulse = b->node[k][MPSI_MASS] * (v - *at);
  double x[3];
  mpsi_node_place(b->grid, held->at, k, x);
  held->impulse[c] += impulse;
  held->moment[(c + 2) % 3] -= x[(c + 1) % 3] * impulse; /* x cross impulse */
  held->moment[(c + 1) % 3] += x[(c + 2) % 3] * impulse;
  held->work += impulse * hold->v[c];
  *at = v;
}

static void hold_across(block *b, const mpsi_boundary *hold, mpsi_held *held, int k) {
  set(b, hold, held, k, hold->axis, hold->v[hold->axis]);
  b->held[k] |= (uint8_t)(1u << hold->axis);
}

static void absorb(block *b, const mpsi_boundary *hold, mpsi_held *held, int k) {
  if (!(b->node[k][MPSI_MASS] > 0.0)) return;
  double v[3];
  const double *before = b->side ? b->side[k] + MPSI_VECTOR : NULL;
  mpsi_dashpot *dashpot = &b->boundaries->dashpot[held->dashpot + mpsi_plane_index(hold->axis, k)];
  mpsi_mpm_apply_dashpot(b->grid, b->dt, hold, dashpot, b->node[k], before, v);
  for (int c = 0; c < b->grid->dim; c++)
    if (!(b->held[k] >> c & 1)) set(b, hold, held, k, c, v[c]);
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
static void add_traction(block *b, const mpsi_boundary *hold, mpsi_held *held, int k) {
  int plane;
  const mpsi_field_node *beside = mpsi_mpm_beside(b->grid, hold, held->at, k, &plane);
  if (!beside || b->again || !(b->node[k][MPSI_MASS] > 0.0)) return;
  for (int c = 0; c < 2; c++) add_impulse(b, held, k, c, b->dt * beside->traction[plane][c]);
}

/* Dashpots between the column and a free-field side, implicit; then the work of both: that of the
 * stresses by the velocity of the node at the end, that of the dashpots by the column's. */
static void absorb_to_field(block *b, const mpsi_boundary *hold, mpsi_held *held, int k) {
  int plane;
  const mpsi_field_node *beside = mpsi_mpm_beside(b->grid, hold, held->at, k, &plane);
  const double m = b->node[k][MPSI_MASS];
  if (!beside || b->again || !(m > 0.0)) return;
  for (int c = 0; c < 2; c++) {
    const double damping = plane > 0 ? 0.0 : c == hold->axis ? beside->across : beside->along;
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
static void stop_inward(block *b, const mpsi_boundary *hold, mpsi_held *held, int k) {
  const int c = hold->axis, number = held->hold;
  const double into = (b->node[k][MPSI_VECTOR + c] - hold->v[c]) * (number % 2 ? 1.0 : -1.0);
  b->normal_impulse[number][k] = into > 0.0 ? b->node[k][MPSI_MASS] * into : 0.0;
  if (!(into > 0.0)) return;
  set(b, hold, held, k, c, hold->v[c]);
  b->held[k] |= (uint8_t)(1u << c);
}

static void apply_friction(block *b, const mpsi_boundary *hold, mpsi_held *held, int k) {
  const double most = hold->friction * b->normal_impulse[held->hold][k], m = b->node[k][MPSI_MASS];
  double slip[3] = {0.0}, square = 0.0;
  if (!(most > 0.0) || !(m > 0.0)) return;
  for (int c = 0; c < b->grid->dim; c++) {
    if (b->held[k] >> c & 1) continue;
    slip[c] = b->node[k][MPSI_VECTOR + c] - hold->v[c];
    square += slip[c] * slip[c];
  }
  const double speed = sqrt(square);
  if (!(speed > 0.0)) return;
  const double left = most < m * speed ? 1.0 - most / (m * speed) : 0.0;
  for (int c = 0; c < b->grid->dim; c++)
    if (slip[c] != 0.0) set(b, hold, held, k, c, hold->v[c] + left * slip[c]);
}

/* Prescribes all components at a fixed side, the chosen ones in a box. */
static void prescribe(block *b, const mpsi_boundary *hold, mpsi_held *held, int k) {
  for (int c = 0; c < b->grid->dim; c++)
    if (hold->dofs >> c & 1) set(b, hold, held, k, c, hold->v[c]);
  b->held[k] |= (uint8_t)hold->dofs;
}

/* ---- boundary conditions of a block ---------------------------------------------------------- */

static void for_range(block *b, const mpsi_boundary *hold, mpsi_held *held, hold_fn work) {
  mpsi_range r;
  if (!mpsi_find_range(b->grid->dim, held->at, hold, &r)) return;
  const int64_t counted = b->again ? held->count : 0;
  held->count = 0;
  for (int z = r.low[2]; z <= r.high[2]; z++)
    for (int y = r.low[1]; y <= r.high[1]; y++)
      for (int x = r.low[0]; x <= r.high[0]; x++) {
        const int k = (z * MPSI_SIDE + y) * MPSI_SIDE + x;
        held->count += b->node[k][MPSI_MASS] > 0.0;
        work(b, hold, held, k);
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
  b->again = g >= grid->node_count; /* normal_impulse is written before it is read */
  memset(fixed, 0, (size_t)grid->block_nodes);
}

void mpsi_mpm_begin_held(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int64_t g) {
  mpsi_held *first = boundaries->held + grid->nodes[g].first_held;
  for (int32_t t = 0; t < grid->nodes[g].holds; t++) {
    memset(first[t].impulse, 0, sizeof first[t].impulse);
    memset(first[t].moment, 0, sizeof first[t].moment);
    first[t].work = 0.0;
    first[t].count = 0;
  }
}

void mpsi_mpm_prescribe_mirrors(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                                const mpsi_mirrors *mirrors, double dt, int64_t g) {
  uint8_t fixed[BLOCK];
  const mpsi_node_block *nodes = &grid->nodes[g];
  mpsi_held *first = boundaries->held + nodes->first_held;
  if (nodes->holds == 0) return;
  block b;
  begin_block(grid, boundaries, dt, g, fixed, &b);
  for (int pass = 0; pass < 2; pass++)
    for (int32_t t = 0; t < nodes->holds; t++) {
      const mpsi_boundary *hold = &boundaries->hold[first[t].hold];
      const bool holds_all = hold->kind == MPS_BOUNDARY_HELD;
      if (hold->kind == MPS_BOUNDARY_FREE_FIELD) continue; /* its nodes move */
      if (mpsi_is_mirror(mirrors, first[t].hold) && holds_all == (pass == 1))
        for_range(&b, hold, &first[t], holds_all ? prescribe : hold_across);
    }
  for (int k = 0; k < grid->block_nodes && nodes->split; k++)
    for (int c = 0; c < grid->dim; c++)
      if (fixed[k] >> c & 1) b.side[k][MPSI_VECTOR + c] = b.node[k][MPSI_VECTOR + c];
}

/* Boundaries that act normal to walls come before friction: where two walls join, friction along
 * one must not move a node into the other. */
void mpsi_mpm_prescribe_nodes(const mpsi_grid *grid, const mpsi_boundaries *boundaries, double dt,
                              int64_t g, uint8_t *fixed) {
  static const struct {
    int32_t kind;
    hold_fn work;
  } order[] = {{MPS_BOUNDARY_FREE_FIELD, add_traction}, {MPS_BOUNDARY_ROLLER, hold_across},
               {MPS_BOUNDARY_ABSORBING, absorb},        {MPS_BOUNDARY_FREE_FIELD, absorb_to_field},
               {MPS_BOUNDARY_FRICTIONAL, stop_inward},  {MPS_BOUNDARY_FRICTIONAL, apply_friction},
               {MPS_BOUNDARY_HELD, prescribe},          {MPS_BOUNDARY_DRIVEN, prescribe}};
  const mpsi_node_block *nodes = &grid->nodes[g];
  if (nodes->holds == 0) return;
  mpsi_held *first = boundaries->held + nodes->first_held;
  block b;
  begin_block(grid, boundaries, dt, g, fixed, &b);
  for (size_t pass = 0; pass < sizeof order / sizeof *order; pass++)
    for (int32_t t = 0; t < nodes->holds; t++) {
      const mpsi_boundary *hold = &boundaries->hold[first[t].hold];
      if (hold->kind == order[pass].kind) for_range(&b, hold, &first[t], order[pass].work);
    }
}

/* ---- a step ---------------------------------------------------------------------------------- */

void mpsi_mpm_begin_boundaries(const mpsi_boundaries *boundaries, double dt) {
  for (int32_t k = 0; k < boundaries->holds; k++)
    if (boundaries->hold[k].finds) boundaries->hold[k].found += dt;
}

/* Adds the sums of the step before to those of all steps. */
static void begin_sums(mpsi_boundary *hold) {
  if (!hold->sums) return;
  for (int k = 0; k < MPSI_BOUNDARY_MASS; k++)
    mpsi_exact_merge(&hold->sums->all[k], &hold->sums->step[k]);
  memset(hold->sums->step, 0, sizeof hold->sums->step);
  hold->count = 0;
}

void mpsi_mpm_sum_boundaries(const mpsi_grid *grid, mpsi_boundaries *boundaries,
                             const mpsi_mirrors *mirrors, mpsi_energy *energy, double dt) {
  mpsi_boundary *hold = boundaries->hold;
  boundaries->dt = dt;
  for (int32_t k = 0; k < boundaries->holds; k++) {
    begin_sums(&hold[k]);
    if (hold[k].found >= hold[k].settle) hold[k].finds = false;
  }
  for (int64_t t = 0; t < boundaries->held_count; t++) {
    const mpsi_held *held = &boundaries->held[t];
    if (!held->counted) continue;
    mpsi_mpm_boundary_add_impulse(&hold[held->hold], held->impulse, held->moment, held->work,
                                  held->count);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARIES, held->work);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARY_LOSS, held->work);
  }
  mpsi_mpm_sum_mirrors(grid, boundaries, mirrors, energy);
}

/* ---- particles ------------------------------------------------------------------------------- */

/* Block of cells that particle k is sorted to. */
static mpsi_cell_block *block_of(const mpsi_grid *grid, int64_t k) {
  int64_t low = 0, high = grid->cell_count;
  while (high - low > 1) {
    const int64_t middle = low + (high - low) / 2;
    if (grid->cells[middle].begin <= k)
      low = middle;
    else
      high = middle;
  }
  return &grid->cells[low];
}

/* Marks the block, as G2P does, where the particle has left the block's tile or the domain. */
static void check_place(const mpsi_grid *grid, const mpsi_columns *p,
                        const mpsi_boundaries *boundaries, int64_t k) {
  mpsi_cell_block *cells = block_of(grid, k);
  const double first = grid->spline == 3 ? 1.0 : 0.5;
  for (int c = 0; c < grid->dim; c++) {
    const double X = mpsi_grid_at(grid, c, p->x[c][k]);
    const double local = X - (double)cells->at[c] * MPSI_SIDE - first;
    if (!(local >= cells->low[c] && local < cells->high[c] - mpsi_reach(grid, c)))
      cells->left = true;
    if (X >= (double)grid->low[c] && X <= (double)grid->high[c]) continue;
    if (mpsi_mpm_passes(grid, boundaries, c, X))
      cells->gone = true;
    else if (cells->bad < 0)
      cells->bad = k, cells->lost = true;
  }
}

/* Prescribes the velocity of a particle; m dv is the impulse. */
static void drive_particle(const mpsi_grid *grid, const mpsi_columns *p,
                           const mpsi_boundaries *boundaries, mpsi_energy *energy, double dt,
                           mpsi_boundary *hold, int64_t k) {
  double x[3] = {0.0}, impulse[3] = {0.0}, work = 0.0, kinetic = 0.0;
  for (int c = 0; c < grid->dim; c++) x[c] = p->x[c][k];
  for (int c = 0; c < grid->dim; c++) {
    if (!(hold->dofs >> c & 1)) continue;
    const double change = hold->v[c] - p->v[c][k];
    impulse[c] = p->m[k] * change;
    work += impulse[c] * hold->v[c];
    kinetic += 0.5 * impulse[c] * (hold->v[c] + p->v[c][k]);
    p->v[c][k] = hold->v[c];
    p->x[c][k] += dt * change;
  }
  double moment[3];
  for (int c = 0; c < 3; c++) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    moment[c] = x[a] * impulse[b] - x[b] * impulse[a];
  }
  mpsi_mpm_boundary_add_impulse(hold, impulse, moment, work, 1);
  mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARIES, work);
  mpsi_mpm_energy_add(energy, MPSI_ENERGY_KINETIC, kinetic);
  mpsi_mpm_energy_add(energy, MPSI_ENERGY_TRANSFER, work - kinetic);
  check_place(grid, p, boundaries, k);
}

void mpsi_mpm_drive_particles(const mpsi_grid *grid, const mpsi_columns *p,
                              const mpsi_boundaries *boundaries, mpsi_energy *energy, double dt) {
  for (int32_t b = MPSI_SIDES; b < boundaries->holds; b++) {
    mpsi_boundary *hold = &boundaries->hold[b];
    for (int64_t i = 0; hold->ids && i < hold->id_count; i++) {
      const int64_t k = mps_particles_index(p->set, hold->ids[i]);
      if (k >= 0) drive_particle(grid, p, boundaries, energy, dt, hold, k);
    }
  }
}
