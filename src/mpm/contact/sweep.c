/* sweep.c - projected Gauss-Seidel update of each contact constraint of a block, see impulses.c.
 * The four values of a node are one vector, and so are its weights. Compiled once for each
 * instruction set. SPDX-License-Identifier: BSD-3-Clause */
#include "contact/update.h"
#include "mpm/base/loops.h"
#include "mpm/contact/pairs.h"

#define WAYS 8 /* independent partial sums: additions do not wait for one another */

/* psi of node number i of a constraint, for the four values of a node. */
MPSI_INLINE mpsi_quad psi_of(const double *weight, bool even, int32_t i) {
  /* the first lane multiplies the mass of the node and is not used */
  if (!even) return mpsi_get(weight + 4 * i);
  const double psi = weight[2 * i + 1];
  return (mpsi_quad){psi, psi, psi, psi};
}

MPSI_INLINE void kick_nodes(double *const *node, const double *weight, bool even, int32_t nodes,
                            mpsi_quad impulse) {
  for (int32_t i = 0; i < nodes; i++)
    mpsi_put(node[i],
             mpsi_get(node[i]) + psi_of(weight, even, i) * (weight[(even ? 2 : 4) * i] * impulse));
}

/* Changes the velocities of the constraint's nodes, and of a free body, by the impulse `by`. */
MPSI_INLINE void kick(mpsi_impulses *all, int64_t n, const double *by) {
  const mpsi_constraint *constraint = &all->constraint[n];
  const mpsi_quad impulse = {0.0, by[0], by[1], by[2]};
  double *const *node = all->node + n * all->stride;
  const double *weight = all->weight[n * all->stride];
  if (constraint->even)
    kick_nodes(node, weight, true, constraint->nodes, impulse);
  else
    kick_nodes(node, weight, false, constraint->nodes, impulse);
  if (all->body[constraint->body].free)
    mpsi_impulse_kick(&all->body[constraint->body], constraint->impulse.at, by);
}

/* first + sum psi v over the nodes of a constraint. */
MPSI_INLINE mpsi_quad sum_nodes(double *const *node, const double *weight, bool even, int32_t nodes,
                                mpsi_quad first) {
  mpsi_quad sum[WAYS] = {first};
  int32_t i = 0;
  for (; i + WAYS <= nodes; i += WAYS)
    for (int w = 0; w < WAYS; w++) sum[w] += psi_of(weight, even, i + w) * mpsi_get(node[i + w]);
  for (int w = 0; i < nodes; i++, w++) sum[w] += psi_of(weight, even, i) * mpsi_get(node[i]);
  for (int half = WAYS / 2; half > 0; half /= 2)
    for (int w = 0; w < half; w++) sum[w] += sum[w + half];
  return sum[0];
}

/* Velocity of the ground at the foot of a constraint. */
MPSI_INLINE void velocity_at(const mpsi_impulses *all, int64_t n, double *v) {
  const mpsi_constraint *constraint = &all->constraint[n];
  double *const *node = all->node + n * all->stride;
  const double *weight = all->weight[n * all->stride];
  const mpsi_quad carried = {0.0, constraint->carried[0], constraint->carried[1],
                             constraint->carried[2]};
  const mpsi_quad sum = constraint->even
                            ? sum_nodes(node, weight, true, constraint->nodes, carried)
                            : sum_nodes(node, weight, false, constraint->nodes, carried);
  for (int a = 0; a < 3; a++) v[a] = sum[MPSI_VECTOR + a];
}

void MPSI_LEVELLED(mpsi_mpm_foot_velocity)(const mpsi_impulses *all, int64_t constraint,
                                           double *v) {
  velocity_at(all, constraint, v);
}

/* Applies the impulses of listed particles to the nodes, or their opposites. */
MPSI_INLINE void kick_groups(mpsi_impulses *all, const mpsi_constraint_block *block, double sign) {
  const int64_t first = block->first + block->count;
  for (int64_t n = first; n < first + block->groups; n++) {
    const double *by = all->constraint[n].impulse.tangent_impulse;
    kick_nodes(all->node + n * all->stride, all->weight[n * all->stride], false,
               all->constraint[n].nodes,
               (mpsi_quad){0.0, sign * by[0], sign * by[1], sign * by[2]});
  }
}

void MPSI_LEVELLED(mpsi_mpm_release)(mpsi_impulses *all, const mpsi_constraint_block *block) {
  kick_groups(all, block, -1.0);
}

/* Warm start: applies the impulses of the last step, in `tangent_impulse`, in the ratio of the
 * steps' dt. */
void MPSI_LEVELLED(mpsi_mpm_warm)(mpsi_impulses *all, double dt,
                                  const mpsi_constraint_block *block) {
  const double fraction = all->warm_dt > 0.0 ? dt / all->warm_dt : 0.0;
  for (int64_t n = block->first; n < block->first + block->count; n++) {
    mpsi_impulse *c = &all->constraint[n].impulse;
    const double last[3] = {c->tangent_impulse[0], c->tangent_impulse[1], c->tangent_impulse[2]};
    double by[3];
    mpsi_impulse_warm(c, &all->body[all->constraint[n].body], last, fraction, by);
    if (c->normal_impulse > 0.0) kick(all, n, by);
  }
  if (block->groups > 0) kick_groups(all, block, 1.0);
}

/* Share of an impulse by which a constraint of listed particles yields: bounds the impulses of
 * constraints that contradict one another. */
#define YIELD 1e-8

/* One update of the constraints of listed particles. */
MPSI_APART void sweep_groups(mpsi_impulses *all, mpsi_constraint_block *block, bool back) {
  double changed = 0.0, impulses = 0.0;
  for (int64_t i = 0; i < block->groups; i++) {
    const int64_t n = block->first + block->count + (back ? block->groups - 1 - i : i);
    mpsi_impulse *c = &all->constraint[n].impulse;
    double u[3], by[3];
    velocity_at(all, n, u);
    for (int a = 0; a < 3; a++) {
      by[a] = -(u[a] + YIELD * c->mobility[a] * c->tangent_impulse[a]) * c->normal[a];
      c->tangent_impulse[a] += by[a];
    }
    kick_nodes(all->node + n * all->stride, all->weight[n * all->stride], false,
               all->constraint[n].nodes, (mpsi_quad){0.0, by[0], by[1], by[2]});
    changed += mpsi_dot3(by, by);
    impulses += mpsi_dot3(c->tangent_impulse, c->tangent_impulse);
  }
  block->group_changed = changed;
  block->group_impulses = impulses;
}

/* One Gauss-Seidel update of each constraint of a block, with the sums of squares of impulses and
 * of their changes, by which the sweeps end. */
void MPSI_LEVELLED(mpsi_mpm_sweep)(mpsi_impulses *all, int32_t dim, mpsi_constraint_block *block,
                                   bool back) {
  double changed = 0.0, impulses = 0.0;
  if (block->groups > 0 && back) sweep_groups(all, block, back);
  for (int64_t i = 0; i < block->count; i++) {
    const int64_t n = back ? block->first + block->count - 1 - i : block->first + i;
    const mpsi_impulse_body *body = &all->body[all->constraint[n].body];
    mpsi_impulse *c = &all->constraint[n].impulse;
    double u[3], surface[3], by[3];
    velocity_at(all, n, u);
    mpsi_impulse_surface(body, c->at, surface);
    for (int a = 0; a < 3; a++) u[a] = a < dim ? u[a] - surface[a] : 0.0;
    if (mpsi_impulse_update(c, body, u, by)) {
      kick(all, n, by);
      changed += mpsi_dot3(by, by);
    }
    impulses +=
        c->normal_impulse * c->normal_impulse + mpsi_dot3(c->tangent_impulse, c->tangent_impulse);
  }
  block->changed = changed;
  block->impulses = impulses;
  if (block->groups > 0 && !back) sweep_groups(all, block, back);
}
