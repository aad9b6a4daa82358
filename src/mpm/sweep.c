/* sweep.c - a visit of projected Gauss and Seidel to each touch of a block, see impulses.c. Node by
 * node the four values are one vector, and so are the weights, whose first lane has 1/m of the
 * node. Compiled once for each instruction set. SPDX-License-Identifier: BSD-3-Clause */
#include "contact/visit.h"
#include "loops.h"

#define WAYS 4 /* sums side by side: none waits for the one before */

/* What the impulse `by` does to the nodes, and to the body. */
MPSI_INLINE void kick(mpsi_impulses *all, int64_t n, const double *by) {
  const mpsi_touch *touch = &all->touch[n];
  const mpsi_quad impulse = {0.0, by[0], by[1], by[2]};
  double *const *node = all->node + n * all->stride;
  double(*weight)[4] = all->weight + n * all->stride;
  for (int32_t i = 0; i < touch->nodes; i++) {
    const mpsi_quad w = mpsi_get(weight[i]);
    mpsi_put(node[i], mpsi_get(node[i]) + w * (w[0] * impulse));
  }
  if (all->body[touch->body].free)
    mpsi_impulse_kick(&all->body[touch->body], touch->impulse.at, by);
}

/* Velocity of the particle's side at the foot. */
MPSI_INLINE void velocity_at(const mpsi_impulses *all, int64_t n, double *v) {
  const mpsi_touch *touch = &all->touch[n];
  double *const *node = all->node + n * all->stride;
  double(*weight)[4] = all->weight + n * all->stride;
  mpsi_quad sum[WAYS] = {{0.0, touch->carried[0], touch->carried[1], touch->carried[2]}};
  int32_t i = 0;
  for (; i + WAYS <= touch->nodes; i += WAYS)
    for (int w = 0; w < WAYS; w++) sum[w] += mpsi_get(weight[i + w]) * mpsi_get(node[i + w]);
  for (; i < touch->nodes; i++) sum[0] += mpsi_get(weight[i]) * mpsi_get(node[i]);
  const mpsi_quad all_ways = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  for (int a = 0; a < 3; a++) v[a] = all_ways[MPSI_VECTOR + a];
}

void MPSI_LEVELLED(mpsi_mpm_foot_velocity)(const mps_mpm *mpm, int64_t touch, double *v) {
  velocity_at(&mpm->contact.impulses, touch, v);
}

/* `rub` holds the last step's impulse. */
void MPSI_LEVELLED(mpsi_mpm_warm)(mps_mpm *mpm, const mpsi_touch_block *block) {
  mpsi_impulses *all = &mpm->contact.impulses;
  const double share = all->kept_dt > 0.0 ? mpm->run.dt / all->kept_dt : 0.0;
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    mpsi_impulse *c = &all->touch[n].impulse;
    const double last[3] = {c->rub[0], c->rub[1], c->rub[2]};
    double by[3];
    mpsi_impulse_warm(c, &all->body[all->touch[n].body], last, share, by);
    if (c->push > 0.0) kick(all, n, by);
  }
}

void MPSI_LEVELLED(mpsi_mpm_sweep)(mps_mpm *mpm, const mpsi_touch_block *block, bool back) {
  mpsi_impulses *all = &mpm->contact.impulses;
  for (int64_t i = 0; i < block->count; i++) {
    const int64_t n = back ? block->first + block->count - 1 - i : block->first + i;
    const mpsi_impulse_body *body = &all->body[all->touch[n].body];
    mpsi_impulse *c = &all->touch[n].impulse;
    double u[3], surface[3], by[3];
    velocity_at(all, n, u);
    mpsi_impulse_surface(body, c->at, surface);
    for (int a = 0; a < 3; a++) u[a] = a < mpm->dim ? u[a] - surface[a] : 0.0;
    if (mpsi_impulse_visit(c, body, u, by)) kick(all, n, by);
  }
}
