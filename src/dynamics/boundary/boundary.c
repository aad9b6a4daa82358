/* boundary.c - definitions of boundaries of the explicit MPS solver: particles, degrees of freedom,
 * and the lists that a step uses (constrain.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "boundary.h"
#include "dynamics/base/dynamics_solver.h"
#include "signal/signal_internal.h"

#include <stdlib.h>
#include <string.h>

/* ---- a boundary ------------------------------------------------------------------------------ */

static mps_status check(void *solver, const char *function, int32_t number, const void *known) {
  mps_dynamics *dynamics = solver;
  const mps_dynamics_boundary_def *def = known;
  if (def->dofs & ~(MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION))
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "dofs is %u, allowed are MPS_DOF_X, MPS_DOF_Y, MPS_DOF_ROTATION, or-ed, and 0 "
                     "for all",
                     def->dofs);
  return mpsi_particles_committed(dynamics->particles, function);
}

static mps_status make(void *solver, const char *function, int32_t number, void *known, void *own) {
  mps_dynamics_boundary_def *def = known;
  mpsi_dynamics_boundary *b = own;
  b->def = def;
  b->kind = def->kind;
  b->dofs = def->dofs;
  if (def->dofs == 0 && def->kind != MPS_BOUNDARY_ABSORBING)
    b->dofs = MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION;
  for (int c = 0; c < 2; c++)
    if (def->kind == MPS_BOUNDARY_DRIVEN && def->signal[c])
      b->dofs |= c == 0 ? MPS_DOF_X : MPS_DOF_Y;
  b->part.signal = def->signal;
  b->part.factor = def->factor;
  return mpsi_dynamics_make_part(solver, function, (int64_t *)def->ids, &def->id_count, &b->part);
}

static void drop(void *solver, void *own) {
  mpsi_free(((mps_dynamics *)solver)->context, ((mpsi_dynamics_boundary *)own)->part.particle);
}

/* ---- the lists ------------------------------------------------------------------------------- */

typedef mpsi_dynamics_lists lists;

void mpsi_dynamics_free_lists(mps_dynamics *dynamics, lists *l) {
  MPSI_FREE(dynamics->context, l->bound, l->dashpot, l->owner);
  *l = (lists){0};
}

static const uint32_t dof_of[3] = {MPS_DOF_X, MPS_DOF_Y, MPS_DOF_ROTATION};

/* Number + 1 of the boundary that has each degree of freedom, 0 none; component by component. */
static void find_owners(const mps_dynamics *dynamics, int32_t *owner) {
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++) {
    const mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, k);
    for (int c = 0; b && c < 3; c++)
      for (int64_t p = 0; (b->dofs & dof_of[c]) && p < b->part.count; p++)
        owner[c * dynamics->count + b->part.particle[p]] = k + 1;
  }
}

/* Fills the list of prescribed degrees of freedom. Entries of an unchanged boundary are copied; new
 * ones start from the present value. */
static void list_bounds(const mps_dynamics *dynamics, const int32_t *owner, int32_t changed,
                        lists *l) {
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *const displacement[3] = {s->dx, s->dy, s->th};
  const mpsi_dynamics_bound *old = dynamics->bound, *end = old + dynamics->bounds;
  for (int c = 0; c < 3; c++)
    for (int64_t i = 0; i < dynamics->count; i++) {
      const int32_t number = owner[c * dynamics->count + i] - 1;
      if (number < 0) continue;
      while (old < end && (old->component < c || (old->component == c && old->particle < i))) old++;
      mpsi_dynamics_bound *q = &l->bound[l->bounds++];
      if (old < end && old->component == c && old->particle == i && old->boundary == number &&
          number != changed) {
        *q = *old;
        continue;
      }
      *q = (mpsi_dynamics_bound){
          .particle = (int32_t)i,
          .component = c,
          .boundary = number,
          .rest = displacement[c][i] - mpsi_dynamics_boundary_of(dynamics, number)->reach[c],
          .at = displacement[c][i],
          .before = dynamics->fresh ? mpsi_dynamics_boundary_of(dynamics, number)->speed[c]
                                    : mpsi_dynamics_velocity(dynamics, c, i),
          .c = s->c[i],
          .s = s->s[i]};
    }
}

static int compare_dashpots(const void *left, const void *right) {
  const mpsi_dynamics_dashpot *a = left, *b = right;
  if (a->particle != b->particle) return a->particle > b->particle ? -1 : 1;
  if (a->component != b->component) return a->component < b->component ? -1 : 1;
  if (a->boundary != b->boundary) return a->boundary < b->boundary ? -1 : 1;
  return a->partner < b->partner ? -1 : a->partner > b->partner;
}

/* Rate (1/s) of the dashpots, from the fields: impedance of a face of length D over the mass rho
 * D^2. */
static void set_rates(const mps_dynamics *dynamics, int64_t count, mpsi_dynamics_dashpot *dashpot) {
  const double *rho = mpsi_dynamics_column(dynamics, "density", 0);
  const double *vs = mpsi_dynamics_column(dynamics, "shear_velocity", 0);
  const double *vp = mpsi_dynamics_column(dynamics, "pressure_velocity", 0);
  for (int64_t k = 0; k < count; k++) {
    mpsi_dynamics_dashpot *q = &dashpot[k];
    const int32_t i = q->particle;
    if (q->boundary < 0) { /* of a column: its own ground */
      q->c = (q->component == 0 ? vp : vs)[q->partner] / dynamics->spacing;
      continue;
    }
    const mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, q->boundary);
    const bool along = q->component == b->def->axis;
    const double own = along ? vp[i] : vs[i],
                 outside = along ? b->def->pressure_velocity : b->def->shear_velocity;
    const double impedance = (isnan(b->def->density) ? rho[i] : b->def->density) *
                             (isnan(outside) ? own : outside); /* kg/(m2 s) */
    q->c = impedance / (rho[i] * dynamics->spacing);
  }
}

void mpsi_dynamics_renew_dashpots(mps_dynamics *dynamics) {
  set_rates(dynamics, dynamics->dashpots, dynamics->dashpot);
}

/* Fills the list of dashpots: columns last in memory, first here, since an edge needs the velocity
 * of its column after the step. */
static void list_dashpots(const mps_dynamics *dynamics, const int32_t *owner, lists *l) {
  for (int64_t k = 0; k < dynamics->column_dashpots; k++)
    l->dashpot[l->dashpots++] = dynamics->column_dashpot[k];
  for (int32_t number = 0; number < mpsi_dynamics_boundary_count(dynamics); number++) {
    const mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, number);
    if (!b || b->kind != MPS_BOUNDARY_ABSORBING) continue;
    for (int64_t p = 0; p < b->part.count; p++)
      for (int c = 0; c < 2; c++)
        l->dashpot[l->dashpots++] = (mpsi_dynamics_dashpot){
            .particle = b->part.particle[p], .component = c, .boundary = number, .partner = -1};
  }
  set_rates(dynamics, l->dashpots, l->dashpot);
  for (int64_t k = 0; k < l->dashpots; k++)
    l->dashpot[k].idle = owner[l->dashpot[k].component * dynamics->count + l->dashpot[k].particle];
  qsort(l->dashpot, (size_t)l->dashpots, sizeof *l->dashpot, compare_dashpots);
}

mps_status mpsi_dynamics_reserve_lists(mps_dynamics *dynamics, const char *function,
                                       int64_t particles, int64_t column_dashpots, lists *out) {
  mps_context *context = dynamics->context;
  int64_t bounds = 0, dashpots = column_dashpots; /* at most */
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++) {
    const mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, k);
    for (int c = 0; b && c < 3; c++) bounds += b->dofs & dof_of[c] ? b->part.listed : 0;
    if (b && b->kind == MPS_BOUNDARY_ABSORBING) dashpots += 2 * b->part.listed;
  }
  *out = (lists){0};
  out->owner = mpsi_alloc(context, 3 * particles, sizeof *out->owner);
  out->bound = mpsi_alloc(context, bounds, sizeof *out->bound);
  out->dashpot = mpsi_alloc(context, dashpots, sizeof *out->dashpot);
  if (out->owner && out->bound && out->dashpot) return MPS_OK;
  mpsi_dynamics_free_lists(dynamics, out);
  return mpsi_fail_memory(context, function, (size_t)bounds * sizeof *out->bound);
}

/* Makes the lists of the present boundaries, of which `changed` (-1: none) has just been defined.
 */
static mps_status make_lists(mps_dynamics *dynamics, const char *function, int32_t changed,
                             lists *out) {
  MPSI_TRY(mpsi_dynamics_reserve_lists(dynamics, function, dynamics->count,
                                       dynamics->column_dashpots, out));
  find_owners(dynamics, out->owner);
  list_bounds(dynamics, out->owner, changed, out);
  list_dashpots(dynamics, out->owner, out);
  return MPS_OK;
}

/* Whether the set of prescribed degrees of freedom has changed: then the stability limit has, too.
 */
static bool other_freedoms(const mps_dynamics *dynamics, const lists *l) {
  if (l->bounds != dynamics->bounds) return true;
  for (int64_t k = 0; k < l->bounds; k++)
    if (l->bound[k].particle != dynamics->bound[k].particle ||
        l->bound[k].component != dynamics->bound[k].component)
      return true;
  return false;
}

static void put_lists(mps_dynamics *dynamics, lists *l, int32_t changed, bool other) {
  mpsi_dynamics_state *s = &dynamics->state;
  double *const velocity[3] = {s->vx, s->vy, s->vth};
  if (other) {
    dynamics->have_limit = dynamics->checked = false;
    if (dynamics->fresh && isnan(dynamics->def.dt)) dynamics->dt = NAN;
  }
  for (int64_t k = 0; dynamics->fresh && k < l->bounds; k++) { /* at rest, or with the signal */
    const mpsi_dynamics_bound *q = &l->bound[k];
    if (q->boundary == changed) velocity[q->component][q->particle] = q->before;
  }
  MPSI_FREE(dynamics->context, dynamics->bound, dynamics->dashpot);
  dynamics->bound = l->bound;
  dynamics->bounds = l->bounds;
  dynamics->dashpot = l->dashpot;
  dynamics->dashpots = l->dashpots;
  mpsi_free(dynamics->context, l->owner);
  *l = (lists){0};
}

void mpsi_dynamics_use_lists(mps_dynamics *dynamics, lists *out) {
  for (int64_t k = 0; k < 3 * dynamics->count; k++) out->owner[k] = 0;
  find_owners(dynamics, out->owner);
  list_bounds(dynamics, out->owner, -1, out);
  list_dashpots(dynamics, out->owner, out);
  put_lists(dynamics, out, -1, other_freedoms(dynamics, out));
}

/* Values of the signals of a driven boundary at time t. */
static mps_status evaluate(mps_dynamics *dynamics, const char *function, int32_t number,
                           mpsi_dynamics_boundary *b, double t) {
  if (!b || b->kind != MPS_BOUNDARY_DRIVEN) return MPS_OK;
  for (int c = 0; c < 2; c++) {
    mpsi_signal_motion at;
    const mpsi_signal_use use = {dynamics->context, function, "boundary", number, c};
    MPSI_TRY(mpsi_signal_evaluate(b->part.signal[c], use, t, &at));
    b->reach[c] = b->part.factor[c] * at.u;
    b->speed[c] = b->part.factor[c] * at.v;
  }
  return MPS_OK;
}

mps_status mpsi_dynamics_list_boundaries(mps_dynamics *dynamics, const char *function) {
  lists l;
  const mps_status status = make_lists(dynamics, function, -1, &l);
  if (status == MPS_OK) put_lists(dynamics, &l, -1, other_freedoms(dynamics, &l));
  return status;
}

mps_status mpsi_dynamics_take_bounds(mps_dynamics *dynamics, const char *function) {
  const double now = mpsi_dynamics_time(dynamics);
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++) {
    MPSI_TRY(evaluate(dynamics, function, k, mpsi_dynamics_boundary_of(dynamics, k), now));
  }
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *const displacement[3] = {s->dx, s->dy, s->th};
  double *const velocity[3] = {s->vx, s->vy, s->vth};
  for (int64_t k = 0; k < dynamics->bounds; k++) {
    mpsi_dynamics_bound *q = &dynamics->bound[k];
    const mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, q->boundary);
    q->at = displacement[q->component][q->particle];
    q->rest = q->at - b->reach[q->component];
    q->before = velocity[q->component][q->particle] = b->speed[q->component];
    q->force = 0.0;
    q->c = s->c[q->particle];
    q->s = s->s[q->particle];
  }
  return MPS_OK;
}

/* ---- what the caller does -------------------------------------------------------------------- */

static mps_status apply(void *solver, const char *function, int32_t number, void *def, void *own,
                        void *former) {
  mps_dynamics *dynamics = solver;
  mpsi_dynamics_boundary *now = own;
  const mpsi_dynamics_boundary *before = former;
  void **const slot = &dynamics->conditions[MPSI_BOUNDARIES].own[number];
  lists l = {0};
  if (now && before) {
    memcpy(now->pushed, before->pushed, sizeof now->pushed);
    memcpy(now->impulse, before->impulse, sizeof now->impulse);
    now->work = before->work;
    now->kick = before->kick;
  }
  mps_status status = evaluate(dynamics, function, number, now, mpsi_dynamics_time(dynamics));
  if (status == MPS_OK && !mpsi_dynamics_reserve_accounts(dynamics))
    status = mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 24);
  *slot = now;
  if (status == MPS_OK) status = make_lists(dynamics, function, number, &l);
  double other = status == MPS_OK && other_freedoms(dynamics, &l);
  status = mpsi_domain_agree_max(dynamics->domain, function, status, 1, &other);
  if (status == MPS_OK) {
    put_lists(dynamics, &l, number, other != 0.0);
    return MPS_OK;
  }
  *slot = former;
  mpsi_dynamics_free_lists(dynamics, &l);
  return status;
}

const mpsi_condition_kind mpsi_dynamics_boundaries = {
    MPSI_CONDITION_OF(DYNAMICS, dynamics, BOUNDARY, boundary),
    .role = MPSI_SIGNAL_MOTION,
    .list = {{"ids", "id_count", 1}},
    .most = INT32_MAX - 8,
    .size = sizeof(mpsi_dynamics_boundary),
    .check = check,
    .selects = true,
    .counts = mpsi_dynamics_counts,
    .make = make,
    .apply = apply,
    .drop = drop,
};

mps_status mpsi_dynamics_get_reaction(void *solver, const char *function, mps_status status,
                                      int32_t number, mps_reaction *out) {
  mps_dynamics *dynamics = solver;
  MPSI_TRY(mpsi_domain_agree_same(dynamics->domain, function, status, "number", number));
  const mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, number);
  const double rate = b->kick > 0.0 ? 1.0 / b->kick : 0.0;
  mpsi_exact sum[7];
  double value[7];
  int64_t count = b->kick > 0.0 ? mpsi_dynamics_counted(dynamics, &b->part) : 0;
  memcpy(sum, b->pushed, sizeof b->pushed);
  memcpy(sum + 3, b->impulse, sizeof b->impulse);
  sum[6] = b->work;
  MPSI_TRY(mpsi_domain_sum_exact(dynamics->domain, function, 7, sum));
  MPSI_TRY(mpsi_domain_sum(dynamics->domain, function, 1, &count));
  for (int k = 0; k < 7; k++) value[k] = mpsi_exact_value(&sum[k]);
  *out = (mps_reaction){
      .force = {value[0] * rate, value[1] * rate, 0.0},
      .moment = {0.0, 0.0, value[2] * rate},
      .impulse = {value[3], value[4], 0.0},
      .moment_impulse = {0.0, 0.0, value[5]},
      .count = count,
      .work = value[6],
  };
  return MPS_OK;
}

void mpsi_dynamics_free_boundaries(mps_dynamics *dynamics) {
  MPSI_FREE(dynamics->context, dynamics->bound, dynamics->dashpot, dynamics->column_dashpot);
}
