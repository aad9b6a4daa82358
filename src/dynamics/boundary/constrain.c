/* constrain.c - boundaries in a step: dashpots, and prescribed degrees of freedom.
 *
 * A dashpot acts with the mean of the velocities before and after the step, which leaves the stable
 * time step unchanged: (1 + c dt/2) v+ = (1 - c dt/2) v- + dt (a + c target). It is applied as a
 * correction to the unconstrained step, as are prescribed motions: the step moves every particle
 * freely, then the boundary sets displacement and velocity; mass times the change of velocity is
 * its impulse on the particle, damping, loads and restoring force included, and that times the mean
 * of the velocities before and after the step is its work.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "constrain.h"
#include "dynamics/base/dynamics_solver.h"
#include "signal/signal_internal.h"

#include <string.h>

/* Displacement, previous displacement (Verlet), velocity and acceleration of one component. */
typedef struct motion {
  double *d, *o, *v, *a;
} motion;

static motion component(const mps_dynamics *dynamics, int32_t c) {
  const mpsi_dynamics_state *s = &dynamics->state;
  if (c == 2) return (motion){s->th, s->oth, s->vth, NULL};
  return c == 0 ? (motion){s->dx, s->ox, s->vx, s->ax} : (motion){s->dy, s->oy, s->vy, s->ay};
}

mps_status mpsi_dynamics_evaluate_signals(mps_dynamics *dynamics, const char *function, double now,
                                          double then) {
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++) {
    mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, k);
    for (int c = 0; b && c < 2; c++) {
      mpsi_signal_motion start, end;
      const double factor = b->part.factor[c];
      if (!b->part.signal[c]) continue;
      const mpsi_signal_use use = {dynamics->context, function, "boundary", k, c};
      mps_status status = mpsi_signal_evaluate(b->part.signal[c], use, now, &start);
      if (status == MPS_OK && b->kind == MPS_BOUNDARY_DRIVEN) {
        status = mpsi_signal_evaluate(b->part.signal[c], use, then, &end);
        if (status != MPS_OK) return status;
        b->reach[c] = factor * end.u;
        b->speed[c] = factor * end.v;
        b->gain[c] = factor * start.a;
      }
      if (status != MPS_OK) return status;
      b->incoming[c] = factor * start.v;
    }
  }
  return MPS_OK;
}

/* Signal values of a step, compared between ranks: functions of the caller may differ. */
mps_status mpsi_dynamics_agree_signals(mps_dynamics *dynamics, const char *function,
                                       mps_status status, int32_t count, double *values) {
  mpsi_given list = MPSI_GIVEN;
  for (int32_t k = 0; status == MPS_OK && k < mpsi_dynamics_boundary_count(dynamics); k++) {
    const mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, k);
    if (!b) continue;
    mpsi_give_vector(&list, "the displacement of a boundary", 2, b->reach);
    mpsi_give_vector(&list, "the velocity of a boundary", 2, b->speed);
    mpsi_give_vector(&list, "the acceleration of a boundary", 2, b->gain);
    mpsi_give_vector(&list, "the incoming velocity of a boundary", 2, b->incoming);
  }
  for (int32_t k = 0; status == MPS_OK && k < mpsi_dynamics_load_count(dynamics); k++)
    if (mpsi_dynamics_load_of(dynamics, k))
      mpsi_give_vector(&list, "the present factor on a load", 2,
                       mpsi_dynamics_load_of(dynamics, k)->now);
  return mpsi_domain_agree_given_max(dynamics->domain, function, status, &list, count, values);
}

/* ---- dashpots -------------------------------------------------------------------------------- */

static double velocity_after(const mps_dynamics *dynamics, const motion *m, int32_t i) {
  if (dynamics->def.integrator != MPS_DYNAMICS_INTEGRATOR_VERLET) return m->v[i];
  return (m->d[i] - m->o[i]) / dynamics->length;
}

void mpsi_dynamics_dashpots_before(mps_dynamics *dynamics) {
  for (int64_t k = 0; k < dynamics->dashpots; k++) {
    mpsi_dynamics_dashpot *q = &dynamics->dashpot[k];
    const motion m = component(dynamics, q->component);
    q->before = velocity_after(dynamics, &m, q->particle);
    if (q->partner >= 0) q->partner_before = velocity_after(dynamics, &m, q->partner);
  }
}

/* Velocity of the far end of a dashpot, m/s. */
static double target(const mps_dynamics *dynamics, const mpsi_dynamics_dashpot *q,
                     const motion *m) {
  if (q->partner < 0)
    return 2.0 * mpsi_dynamics_boundary_of(dynamics, q->boundary)->incoming[q->component];
  const double after = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER
                           ? q->partner_before
                           : velocity_after(dynamics, m, q->partner);
  return 0.5 * (q->partner_before + after);
}

/* Coordinate (m) at the start of the step that has just been taken. */
static double coordinate(const mps_dynamics *dynamics, int32_t c, int32_t i) {
  const mpsi_dynamics_state *s = &dynamics->state;
  const double reference = (c == 0 ? s->rx : s->ry)[i];
  if (dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_VERLET)
    return reference + (c == 0 ? s->ox : s->oy)[i];
  const double d = (c == 0 ? s->dx : s->dy)[i];
  return reference + d - dynamics->length * (c == 0 ? s->vx : s->vy)[i];
}

/* ---- sums of impulses and works -------------------------------------------------------------- */

static void flush(mpsi_exact *sum, double *part) {
  if (*part != 0.0) mpsi_exact_add(sum, *part);
  *part = 0.0;
}

static void flush_boundary(mpsi_dynamics_boundary *b) {
  for (int c = 0; c < 3; c++) {
    if (b->block_sum[c] != 0.0) mpsi_exact_add(&b->pushed[c], b->block_sum[c]);
    flush(&b->impulse[c], &b->block_sum[c]);
  }
  flush(&b->work, &b->block_work);
}

void mpsi_dynamics_begin_counting(mps_dynamics *dynamics) {
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++)
    if (mpsi_dynamics_boundary_of(dynamics, k))
      memset(mpsi_dynamics_boundary_of(dynamics, k)->pushed, 0,
             sizeof mpsi_dynamics_boundary_of(dynamics, k)->pushed);
}

/* After a list: the next one starts with sums of its own, also where a rank has a single block. */
static void flush_all(mps_dynamics *dynamics) {
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++)
    if (mpsi_dynamics_boundary_of(dynamics, k))
      flush_boundary(mpsi_dynamics_boundary_of(dynamics, k));
  flush(&dynamics->works.boundaries, &dynamics->works.part);
}

void mpsi_dynamics_end_counting(mps_dynamics *dynamics, double kick) {
  flush_all(dynamics);
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++)
    if (mpsi_dynamics_boundary_of(dynamics, k)) mpsi_dynamics_boundary_of(dynamics, k)->kick = kick;
}

/* The work of boundaries and dashpots on a particle of the body. */
static void count_work(mps_dynamics *dynamics, int32_t i, double work) {
  const int64_t block = mpsi_dynamics_block_of(dynamics->body, i);
  if (i >= dynamics->body) return;
  if (block != dynamics->works.block) flush(&dynamics->works.boundaries, &dynamics->works.part);
  dynamics->works.block = block;
  dynamics->works.part += work;
}

/* Counts the impulse (N s, N m s) of a boundary on a component of particle i, whose velocity it
 * changed from `before` to `after`. */
static void count_impulse(mps_dynamics *dynamics, mpsi_dynamics_boundary *b, int32_t c, int32_t i,
                          double impulse, double before, double after) {
  if (i >= dynamics->body && !dynamics->lead) return; /* a column, counted by another rank */
  const double work = 0.5 * impulse * (before + after);
  const int64_t block = mpsi_dynamics_block_of(dynamics->body, i);
  count_work(dynamics, i, work);
  if (block != b->block) flush_boundary(b);
  b->block = block;
  b->block_work += work;
  if (c < 2) b->block_sum[c] += impulse;
  b->block_sum[2] +=
      c == 2 ? impulse : (c == 0 ? -impulse : impulse) * coordinate(dynamics, 1 - c, i);
}

static void count_dashpot(mps_dynamics *dynamics, mpsi_dynamics_dashpot *q, double pull,
                          double before, double after, double kick) {
  const double v =
      dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? before : 0.5 * (before + after);
  const double impulse =
      kick * mpsi_dynamics_mass(dynamics, q->component, q->particle) * q->c * (pull - v);
  q->force = impulse / kick;
  if (q->boundary < 0) {
    count_work(dynamics, q->particle, 0.5 * impulse * (before + after));
    return;
  }
  count_impulse(dynamics, mpsi_dynamics_boundary_of(dynamics, q->boundary), q->component,
                q->particle, impulse, before, after);
}

void mpsi_dynamics_dashpots_after(mps_dynamics *dynamics, double kick, bool output) {
  const double dt = dynamics->length;
  const int integrator = dynamics->def.integrator;
  for (int64_t k = 0, next; k < dynamics->dashpots; k = next) {
    mpsi_dynamics_dashpot *first = &dynamics->dashpot[k];
    const motion m = component(dynamics, first->component);
    const int32_t i = first->particle;
    double c = 0.0, pull = 0.0; /* all dashpots of this component together */
    for (next = k; next < dynamics->dashpots && dynamics->dashpot[next].particle == i &&
                   dynamics->dashpot[next].component == first->component;
         next++) {
      c += dynamics->dashpot[next].c;
      pull += dynamics->dashpot[next].c * target(dynamics, &dynamics->dashpot[next], &m);
      dynamics->dashpot[next].force = 0.0;
    }
    if (first->idle) continue; /* held or driven */
    const double before = first->before, ordinary = velocity_after(dynamics, &m, i);
    double after;
    if (integrator == MPS_DYNAMICS_INTEGRATOR_EULER)
      after = ordinary + kick * (pull - c * before);
    else
      after = (ordinary - 0.5 * c * kick * before + kick * pull) / (1.0 + 0.5 * c * kick);
    for (int64_t q = k; q < next; q++)
      count_dashpot(dynamics, &dynamics->dashpot[q], target(dynamics, &dynamics->dashpot[q], &m),
                    before, after, kick);
    if (integrator == MPS_DYNAMICS_INTEGRATOR_VERLET) {
      m.d[i] = m.o[i] + dt * after;
    } else {
      m.v[i] = after;
      if (integrator == MPS_DYNAMICS_INTEGRATOR_LEAPFROG) m.d[i] += dt * (after - ordinary);
    }
    if (output) m.a[i] = (after - before) / kick;
  }
}

/* ---- held and driven ------------------------------------------------------------------------- */

void mpsi_dynamics_prescribe_bounds(mps_dynamics *dynamics, double kick, bool output) {
  const mpsi_dynamics_state *s = &dynamics->state;
  const int integrator = dynamics->def.integrator;
  const double rate = 1.0 / dynamics->length;
  for (int64_t k = 0; k < dynamics->bounds; k++) {
    mpsi_dynamics_bound *q = &dynamics->bound[k];
    if (k == 0 || q->component != q[-1].component) flush_all(dynamics);
    mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, q->boundary);
    const int32_t i = q->particle, c = q->component;
    const motion m = component(dynamics, c);
    const double to = q->rest + b->reach[c];
    const bool euler = integrator == MPS_DYNAMICS_INTEGRATOR_EULER;
    const double after = euler ? b->speed[c] : (to - q->at) * rate;
    const double change = euler ? after - m.v[i] : (to - m.d[i]) * rate; /* m/s */
    if (integrator != MPS_DYNAMICS_INTEGRATOR_VERLET) m.v[i] = after;
    m.d[i] = q->at = to;
    const double impulse = mpsi_dynamics_mass(dynamics, c, i) * change;
    count_impulse(dynamics, b, c, i, impulse, q->before, after);
    q->before = after;
    q->force = impulse / kick;
    if (c == 2)
      s->c[i] = q->c, s->s[i] = q->s;
    else if (output)
      m.a[i] = b->gain[c];
  }
}
