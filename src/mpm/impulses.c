/* impulses.c - the impulses of a step, by sweeps of projected Gauss and Seidel over the touches
 * (touches.c): each visit satisfies one contact exactly with all others as they are
 * (contact/impulse.h), and moves its nodes by psi_i J/m_i at once. Sweeps go forward and backward
 * in turn, and begin with the impulses of the last step.
 *
 * Blocks of one colour share no node: where no body moves freely, their sweeps are independent and
 * shared out among the threads, with the same bits. A free body is in contact with all blocks at
 * once; then one thread takes them in their order. SPDX-License-Identifier: BSD-3-Clause */
#include "contact/visit.h"
#include "kernels.h"

#include <string.h>

#define SHARED 512 /* touches: below, sharing the work costs more than it gains */

/* x and y side by side; z by itself, in space. */
typedef double two __attribute__((vector_size(16), aligned(8), may_alias));

static void kick(const mps_mpm *mpm, mpsi_impulses *all, int64_t n, const double *by) {
  double(*weight)[3] = all->weight + n * all->stride;
  double **node = all->node + n * all->stride;
  const two xy = {by[0], by[1]};
  for (int32_t i = 0; i < all->touch[n].nodes; i++) {
    const double f = 1.0 / node[i][MPSI_MASS];
    *(two *)(node[i] + MPSI_VECTOR) += f * *(const two *)weight[i] * xy;
    if (mpm->dim == 3) node[i][MPSI_VECTOR + 2] += f * weight[i][2] * by[2];
  }
  mpsi_impulse_kick(&all->body[all->touch[n].body], all->touch[n].impulse.at, by);
}

/* Velocity of the particle's side at the foot. */
static void velocity_at(const mps_mpm *mpm, const mpsi_impulses *all, int64_t n, double *v) {
  double(*weight)[3] = all->weight + n * all->stride;
  double *const *node = all->node + n * all->stride;
  const int32_t nodes = all->touch[n].nodes;
  memcpy(v, all->touch[n].carried, sizeof all->touch[n].carried);
  const bool space = mpm->dim == 3;
  two even = {v[0], v[1]}, odd = {0.0}; /* apart: neither waits for the other */
  double even_z = v[2], odd_z = 0.0;
  for (int32_t i = 0; i < nodes; i++) {
    even += *(const two *)weight[i] * *(const two *)(node[i] + MPSI_VECTOR);
    if (space) even_z += weight[i][2] * node[i][MPSI_VECTOR + 2];
    if (++i == nodes) break;
    odd += *(const two *)weight[i] * *(const two *)(node[i] + MPSI_VECTOR);
    if (space) odd_z += weight[i][2] * node[i][MPSI_VECTOR + 2];
  }
  v[0] = even[0] + odd[0], v[1] = even[1] + odd[1], v[2] = even_z + odd_z;
}

/* ---- a block --------------------------------------------------------------------------------- */

/* `rub` holds the last step's impulse. */
static void warm_block(mps_mpm *mpm, mpsi_touch_block *block) {
  mpsi_impulses *all = &mpm->contact.impulses;
  const double share = all->kept_dt > 0.0 ? mpm->run.dt / all->kept_dt : 0.0;
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    mpsi_impulse *c = &all->touch[n].impulse;
    const double last[3] = {c->rub[0], c->rub[1], c->rub[2]};
    double by[3];
    mpsi_impulse_warm(c, &all->body[all->touch[n].body], last, share, by);
    if (c->push > 0.0) kick(mpm, all, n, by);
  }
}

static void sweep_block(mps_mpm *mpm, mpsi_touch_block *block, bool back) {
  mpsi_impulses *all = &mpm->contact.impulses;
  for (int64_t i = 0; i < block->count; i++) {
    const int64_t n = back ? block->first + block->count - 1 - i : block->first + i;
    const mpsi_impulse_body *body = &all->body[all->touch[n].body];
    mpsi_impulse *c = &all->touch[n].impulse;
    double u[3], surface[3], by[3];
    velocity_at(mpm, all, n, u);
    mpsi_impulse_surface(body, c->at, surface);
    for (int a = 0; a < 3; a++) u[a] = a < mpm->dim ? u[a] - surface[a] : 0.0;
    if (mpsi_impulse_visit(c, body, u, by)) kick(mpm, all, n, by);
  }
}

/* ---- all blocks ------------------------------------------------------------------------------ */

typedef struct sweep {
  mps_mpm *mpm;
  int64_t first; /* block */
  bool warm, back;
} sweep;

static void one_block(void *data, int64_t unit, int32_t worker) {
  const sweep *s = data;
  mpsi_touch_block *block = &s->mpm->contact.impulses.block[s->first + unit];
  (void)worker;
  if (s->warm)
    warm_block(s->mpm, block);
  else
    sweep_block(s->mpm, block, s->back);
}

static void sweep_all(mps_mpm *mpm, bool warm, bool back) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  const bool shared = !all->free_bodies && mpm->grid.worker_count > 1 && all->touch_count > SHARED;
  sweep s = {mpm, 0, warm, back};
  if (!shared) {
    for (int64_t k = 0; k < all->block_count; k++)
      one_block(&s, back ? all->block_count - 1 - k : k, 0);
    return;
  }
  for (int k = 0; k < MPSI_CORNERS; k++) {
    const int colour = back ? MPSI_CORNERS - 1 - k : k;
    s.first = all->colour[colour];
    mpsi_parallel_for(mpm->context, all->colour[colour + 1] - s.first, one_block, &s);
  }
}

/* ---- a step ---------------------------------------------------------------------------------- */

/* The impulse `by` on the particle, to what its block and the body feel. */
static void add_reaction(mps_mpm *mpm, const mpsi_touch *touch, const double *by) {
  mpsi_cell_pair *pair = &mpm->contact.cell_pair[touch->pair];
  const double *x = mpm->contact.body[touch->body]->pose.x;
  double arm[3], force[3];
  for (int a = 0; a < 3; a++) {
    force[a] = -by[a] / mpm->run.dt;
    arm[a] = touch->impulse.at[a] - x[a];
  }
  pair->touched = true;
  pair->contacts[touch->part]++;
  mpsi_contact_add_load(&pair->load[touch->part], arm, force);
}

/* What the bodies feel, and what the next step begins with. */
static void take_over(mps_mpm *mpm) {
  mpsi_impulses *all = &mpm->contact.impulses;
  mpsi_kept_impulse *next = all->next_room.item;
  int64_t count = 0;
  for (int64_t n = 0; n < all->touch_count; n++) {
    const mpsi_touch *touch = &all->touch[n];
    const mpsi_impulse *c = &touch->impulse;
    if (!(c->push > 0.0)) continue;
    next[count] = (mpsi_kept_impulse){.id = touch->id, .body = touch->body};
    for (int a = 0; a < 3; a++) next[count].by[a] = c->push * c->normal[a] + c->rub[a];
    if (touch->pair >= 0) add_reaction(mpm, touch, next[count].by);
    count++;
  }
  const mpsi_room old = all->kept_room;
  all->kept_room = all->next_room;
  all->next_room = old;
  all->kept = all->kept_room.item;
  all->kept_count = count;
  all->kept_dt = mpm->run.dt;
}

void mpsi_mpm_apply_impulses(mps_mpm *mpm) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  int32_t sweeps = 0;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    if (mpsi_by_impulses(mpm->contact.handle[b]) && mpm->contact.handle[b]->def.sweeps > sweeps)
      sweeps = mpm->contact.handle[b]->def.sweeps;
  if (all->touch_count > 0) sweep_all(mpm, true, false);
  for (int32_t s = 0; s < sweeps && all->touch_count > 0; s++) {
    if (s % 2 == 0) mpsi_mpm_share_areas(mpm);
    sweep_all(mpm, false, s % 2 != 0);
  }
  mpsi_mpm_mirror_touches(mpm);
  take_over(mpm);
}

void mpsi_mpm_find_impulse_loss(mps_mpm *mpm) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  if (!mpm->energy.counts) return;
  for (int64_t n = 0; n < all->touch_count; n++) {
    const mpsi_touch *touch = &all->touch[n];
    const mpsi_impulse *c = &touch->impulse;
    double v[3], surface[3];
    if (!(c->push > 0.0) || touch->pair < 0) continue;
    velocity_at(mpm, all, n, v);
    mpsi_body_velocity(&mpm->contact.body[touch->body]->pose, c->at, surface);
    double work = 0.0, loss = 0.0;
    for (int a = 0; a < mpm->dim; a++) {
      const double by = c->push * c->normal[a] + c->rub[a];
      work += by * surface[a];
      loss += by * (surface[a] - v[a]);
    }
    mpsi_mpm_energy_add(mpm, MPSI_ENERGY_FRICTION_LOSS, loss);
    mpsi_mpm_energy_add(mpm, MPSI_ENERGY_STEPPING, -work);
  }
}

void mpsi_mpm_free_impulses(mps_mpm *mpm) {
  mpsi_impulses *all = &mpm->contact.impulses;
  void *rooms[] = {all->touch_room.item, all->block_room.item,     all->weight_room.item,
                   all->node_room.item,  all->candidate_room.item, all->kept_room.item,
                   all->next_room.item,  all->lookup_room.item,    all->area_room.item,
                   all->around_room.item};
  for (size_t k = 0; k < sizeof rooms / sizeof *rooms; k++) mpsi_free(mpm->context, rooms[k]);
}
