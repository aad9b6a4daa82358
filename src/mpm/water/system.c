/* system.c - see system.h. SPDX-License-Identifier: BSD-3-Clause */
#include "system.h"

#include "core/base/room_array.h"
#include "wide_halo.h"

#include <string.h>

/* Below so many terms of G a loop is over before a second thread has begun it. */
enum { FEWEST_TERMS = 32 * MPSI_SIDE * MPSI_SIDE * MPSI_PORE_SPAN * MPSI_PORE_SPAN };

typedef struct mpsi_pore_system system_of;

/* ---- memory ------------------------------------------------------------------------------------
 */

/* Number of the block at `at` of those that the system has, or -1. */
static int32_t find_block(const mpsi_grid *grid, const system_of *s, const int32_t *at) {
  const int32_t own = mpsi_pore_own_block(grid, at);
  if (own >= 0 && mpsi_mpm_counts_node_block(grid, own)) return own;
  const int32_t wide = mpsi_pore_wide_block_at(s->wide_halo, at);
  return wide < 0 ? -1 : (int32_t)grid->node_count + wide;
}

static void find_around_block(const mpsi_grid *grid, system_of *s, int64_t g, const int32_t *of) {
  for (int k = 0; k < MPSI_PORE_AROUND; k++) {
    int32_t at[3], step[3];
    mpsi_unravel(k, 3, step);
    for (int c = 0; c < 3; c++) at[c] = of[c] + step[c] - 1;
    s->around[g][k] = grid->dim == 2 && step[2] != 1 ? -1 : find_block(grid, s, at);
  }
}

static void find_around(const mpsi_grid *grid, system_of *s) {
  for (int64_t g = 0; g < grid->node_count; g++) find_around_block(grid, s, g, grid->nodes[g].at);
  for (int64_t k = 0; s->wide_halo && k < s->wide_halo->blocks; k++)
    find_around_block(grid, s, grid->node_count + s->wide_halo->block[k].number,
                      s->wide_halo->block[k].at);
}

static mps_status make_room(mps_mpm *mpm, const char *function) {
  enum { VECTORS = 10 };
  system_of *s = mpm->water->system;
  const int64_t blocks = mpm->grid.node_count,
                all = blocks + (s->wide_halo ? s->wide_halo->blocks : 0);
  const int64_t nodes = blocks * mpm->grid.block_nodes + (s->wide_halo ? s->wide_halo->cells : 0);
  const int places = mpsi_pore_box_places(&mpm->grid);
  const bool good =
      MPSI_ENSURE(mpm->context, s, around, all) && MPSI_ENSURE(mpm->context, s, inertia, nodes) &&
      MPSI_ENSURE(mpm->context, s, turned, nodes) &&
      MPSI_ENSURE(mpm->context, s, velocity, nodes) && MPSI_ENSURE(mpm->context, s, held, nodes) &&
      MPSI_ENSURE(mpm->context, s, row, nodes) &&
      MPSI_ENSURE(mpm->context, s, conductance, nodes) &&
      mpsi_room_ensure(mpm->context, &s->vector_room, VECTORS * nodes, sizeof(double)) &&
      MPSI_ENSURE(mpm->context, s, reach, all * places) &&
      MPSI_ENSURE(mpm->context, s, part, blocks);
  if (!good)
    return mpsi_fail_memory(mpm->context, function, (size_t)(VECTORS * nodes) * sizeof(double));
  double **const vector[VECTORS] = {&s->diagonal,  &s->ahead,   &s->change,  &s->residual,
                                    &s->direction, &s->product, &s->inverse, &s->squeeze,
                                    &s->space,     &s->carried};
  for (int k = 0; k < VECTORS; k++) *vector[k] = (double *)s->vector_room.item + k * nodes;
  return MPS_OK;
}

static mps_status make_first(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  if (s) return MPS_OK;
  s = mpm->water->system = mpsi_alloc(mpm->context, 1, sizeof *s);
  if (!s) return mpsi_fail_memory(mpm->context, function, sizeof *s);
  memset(s, 0, sizeof *s);
  return MPS_OK;
}

/* On several ranks, with another wide halo than in the last step: all agree on their memory. */
static mps_status renew(mps_mpm *mpm, const char *function, mps_status status) {
  mps_domain *domain = mpm->domain;
  MPSI_TRY(mpsi_domain_agree(domain, function, status));
  MPSI_TRY(mpsi_pore_find_wide_halo(mpm, function));
  status = mpsi_domain_agree(domain, function, make_room(mpm, function));
  if (status != MPS_OK) mpm->water->system->wide_halo->searches = -1;
  return status;
}

mps_status mpsi_pore_make_system(mps_mpm *mpm, const char *function, mps_status status) {
  if (status == MPS_OK) status = make_first(mpm, function);
  const system_of *s = mpm->water->system;
  if (!mpm->partition) {
    if (status == MPS_OK) status = make_room(mpm, function);
  } else if (!s || !s->wide_halo || s->wide_halo->searches != mpm->partition->searches) {
    status = renew(mpm, function, status);
  }
  if (status == MPS_OK) find_around(&mpm->grid, mpm->water->system);
  return status;
}

void mpsi_pore_free_system(mps_context *context, mpsi_pore_system **pointer) {
  system_of *s = *pointer;
  *pointer = NULL;
  if (!s) return;
  mpsi_pore_free_wide_halo(context, &s->wide_halo);
  const mpsi_pore_contacts *c = &s->contacts;
  MPSI_FREE(context, s->around_room.item, s->inertia_room.item, s->velocity_room.item,
            s->held_room.item, s->row_room.item, s->force_room.item, s->vector_room.item,
            s->conductance_room.item, s->reach_room.item, s->part_room.item, s->turned_room.item,
            c->contact_room.item, c->entry_room.item, c->node_room.item, c->index_room.item,
            c->word_room.item, c->known_room.item, c->mover_room.item);
  mpsi_free(context, s);
}

/* ---- loops over blocks ----------------------------------------------------------------------- */

int64_t mpsi_pore_number(const mpsi_grid *grid, const system_of *s, int64_t g, int local) {
  if (g < grid->node_count) return mpsi_first_node(grid, g) + local;
  const int32_t cell = s->wide_halo->cell[(g - grid->node_count) * grid->block_nodes + local];
  return cell < 0 ? -1 : grid->node_count * grid->block_nodes + cell;
}

int64_t mpsi_pore_node_at(const mpsi_grid *grid, const system_of *s, const int32_t *at,
                          bool *counted) {
  int32_t block[3] = {0};
  int local = 0;
  for (int c = 2; c >= 0; c--) {
    const int32_t place = c < grid->dim ? at[c] & (MPSI_SIDE - 1) : 0;
    block[c] = c < grid->dim ? (at[c] - place) / MPSI_SIDE : 0;
    local = MPSI_SIDE * local + place;
  }
  const int32_t g = find_block(grid, s, block);
  *counted = g >= 0 && g < grid->node_count;
  return g < 0 ? -1 : mpsi_pore_number(grid, s, g, local);
}

int64_t mpsi_pore_at(const mpsi_grid *grid, const system_of *s, int64_t g, const int *offset) {
  int block = 0, local = 0;
  for (int c = 2; c >= 0; c--) {
    const int place = c < grid->dim ? offset[c] : 0;
    block = 3 * block + (place < 0 ? 0 : place < MPSI_SIDE ? 1 : 2);
    local = MPSI_SIDE * local + (place & (MPSI_SIDE - 1));
  }
  const int64_t to = s->around[g][block];
  return to < 0 ? -1 : mpsi_pore_number(grid, s, to, local);
}

typedef struct block_loop {
  mps_mpm *mpm;
  mpsi_pore_blocks which;
  mpsi_pore_task task;
  double factor;
} block_loop;

static void run_block(void *data, int64_t g, int32_t worker) {
  const block_loop *loop = data;
  const mpsi_grid *grid = &loop->mpm->grid;
  if (g < grid->node_count && loop->which != MPSI_PORE_ALL)
    if (loop->which == MPSI_PORE_COMPUTED ? grid->nodes[g].foreign
                                          : !mpsi_mpm_counts_node_block(grid, g))
      return;
  loop->task(loop->mpm, loop->mpm->water->system, g, loop->factor);
}

void mpsi_pore_for_blocks(mps_mpm *mpm, mpsi_pore_blocks which, mpsi_pore_task task,
                          double factor) {
  block_loop loop = {mpm, which, task, factor};
  const bool wide =
      mpm->water->system->wide_halo && (which == MPSI_PORE_ALL || which == MPSI_PORE_NEAR);
  const int64_t blocks = mpm->grid.node_count + (wide ? mpm->water->system->wide_halo->blocks : 0);
  if (blocks * mpm->grid.block_nodes * mpsi_pore_span_nodes(&mpm->grid) >= FEWEST_TERMS) {
    mpsi_parallel_for(mpm->context, blocks, run_block, &loop);
    return;
  }
  for (int64_t g = 0; g < blocks; g++) run_block(&loop, g, 0);
}

mps_status mpsi_pore_sum_blocks(mps_mpm *mpm, const char *function, mpsi_pore_task task,
                                double factor, double *out) {
  const mpsi_grid *grid = &mpm->grid;
  mpsi_exact sum = {{0}};
  mps_status status = MPS_OK;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, task, factor);
  for (int64_t g = 0; g < grid->node_count; g++)
    if (mpsi_mpm_counts_node_block(grid, g)) mpsi_exact_add(&sum, mpm->water->system->part[g]);
  if (mpm->partition) status = mpsi_domain_sum_exact(mpm->domain, function, 1, &sum);
  *out = mpsi_exact_value(&sum);
  return status;
}

static void find_reach(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  int32_t *reach = s->reach + g * mpsi_pore_box_places(grid);
  for (int t = 0; t < mpsi_pore_box_places(grid); t++) {
    int offset[3];
    mpsi_unravel(t, MPSI_PORE_BOX, offset);
    for (int c = 0; c < 3; c++) offset[c] -= MPSI_PORE_BEFORE;
    reach[t] = (int32_t)mpsi_pore_at(grid, s, g, offset);
  }
}

void mpsi_pore_find_reach(mps_mpm *mpm) {
  mpsi_pore_for_blocks(mpm, MPSI_PORE_ALL, find_reach, 0.0);
}
