/* boundary.c - definitions of boundaries of the explicit MPS solver: particles, degrees of freedom,
 * and the lists that a step uses (constrain.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/boundary_kind.h"
#include "core/particles/particles_internal.h"
#include "boundary.h"
#include "dynamics/base/dynamics_solver.h"
#include "signal/signal_internal.h"
#include "core/base/digits.h"

#include <stdlib.h>
#include <string.h>

static const mps_dynamics_boundary_def boundary_defaults = {
    .struct_size = sizeof(mps_dynamics_boundary_def),
    .kind = MPS_BOUNDARY_HELD,
    .lower = {NAN, NAN, NAN},
    .upper = {NAN, NAN, NAN},
    .normal = 1,
    .factor = {1.0, 1.0, 1.0},
    .density = NAN,
    .shear_velocity = NAN,
    .pressure_velocity = NAN,
};

mps_status mps_dynamics_boundary_def_init(mps_dynamics_boundary_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_dynamics_boundary_def, def, size, &boundary_defaults);
}

/* ---- a boundary ------------------------------------------------------------------------------ */

static mps_status check_def(mps_dynamics *dynamics, const char *function,
                            const mps_dynamics_boundary_def *def) {
  mps_context *context = dynamics->context;
  const uint32_t all = MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION;
  const bool absorbing = def->kind == MPS_BOUNDARY_ABSORBING;
  if (!mpsi_boundary_kind_in(def->kind, 1u << MPS_BOUNDARY_HELD | 1u << MPS_BOUNDARY_DRIVEN |
                                            1u << MPS_BOUNDARY_ABSORBING))
    return mpsi_fail(
        context, function, MPS_ERROR_ARGUMENT,
        "kind is %d (%s), explicit dynamics has 0 (HELD), 1 (DRIVEN) and 4 (ABSORBING)", def->kind,
        mpsi_boundary_kind_name(def->kind));
  if ((def->dofs & ~all) || (absorbing && def->dofs))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "dofs is %u, allowed is %s", def->dofs,
                     absorbing ? "0 of an absorbing boundary"
                               : "a combination of 1 (x), 2 (y) and 8 (rotation), 0 for all");
  if (def->kind == MPS_BOUNDARY_HELD && (def->signal[0] || def->signal[1]))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "a held boundary takes no signal: make its kind DRIVEN");
  if (def->kind == MPS_BOUNDARY_DRIVEN && !def->signal[0] && !def->signal[1])
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "a driven boundary needs a signal: signal[0] and signal[1] are NULL");
  if (def->normal != 0 && def->normal != 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "normal is %d, allowed are 0 (x) and 1 (y)", def->normal);
  const double values[3] = {def->density, def->shear_velocity, def->pressure_velocity};
  const char *const names[3] = {"density", "shear_velocity", "pressure_velocity"};
  for (int k = 0; k < 3; k++)
    if (!isnan(values[k]) && !(values[k] >= 1e-6 && values[k] <= 1e9))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "%s is %s, must be in 1e-6..1e9, or NaN for that of the particles", names[k],
                       mpsi_outside(values[k], 1e-6, 1e9).text);
  return MPS_OK;
}

static void release(mps_dynamics *dynamics, mpsi_dynamics_boundary **boundary) {
  if (*boundary) mpsi_dynamics_release_part(dynamics, &(*boundary)->part);
  mpsi_free(dynamics->context, *boundary);
  *boundary = NULL;
}

/* A boundary made from the caller's definition, on all ranks or none. */
static mps_status make(mps_dynamics *dynamics, const char *function, mps_status status,
                       int32_t number, const mps_dynamics_boundary_def *user_def,
                       mpsi_dynamics_boundary **out) {
  mps_dynamics_boundary_def def = boundary_defaults;
  *out = NULL;
  if (status == MPS_OK)
    status = MPSI_DEF_READ(dynamics->context, function, mps_dynamics_boundary_def, user_def, &def);
  if (status == MPS_OK) status = check_def(dynamics, function, &def);
  mpsi_dynamics_boundary *b = NULL;
  if (status == MPS_OK && !(b = mpsi_alloc(dynamics->context, 1, sizeof *b)))
    status = mpsi_fail_memory(dynamics->context, function, sizeof *b);
  const mpsi_dynamics_selection selection = MPSI_DYNAMICS_SELECTION(def, false);
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "number", number);
  MPSI_GIVE(&given, &def, kind);
  MPSI_GIVE(&given, &def, dofs);
  MPSI_GIVE(&given, &def, normal);
  MPSI_GIVE(&given, &def, density);
  MPSI_GIVE(&given, &def, shear_velocity);
  MPSI_GIVE(&given, &def, pressure_velocity);
  status = mpsi_dynamics_agree_definition(dynamics, function, status, &selection, &given);
  if (status != MPS_OK) {
    mpsi_free(dynamics->context, b);
    return status;
  }
  status = mpsi_dynamics_select(dynamics, function, status, &selection, &b->part);
  b->kind = def.kind;
  b->normal = def.normal;
  b->dofs = def.dofs;
  if (def.dofs == 0 && def.kind != MPS_BOUNDARY_ABSORBING)
    b->dofs = MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION;
  for (int c = 0; c < 2; c++)
    if (def.kind == MPS_BOUNDARY_DRIVEN && def.signal[c]) b->dofs |= c == 0 ? MPS_DOF_X : MPS_DOF_Y;
  b->density = def.density;
  b->shear = def.shear_velocity;
  b->pressure = def.pressure_velocity;
  if (status != MPS_OK) release(dynamics, &b);
  *out = b;
  return status;
}

/* ---- the lists ------------------------------------------------------------------------------- */

typedef mpsi_dynamics_lists lists;

void mpsi_dynamics_free_lists(mps_dynamics *dynamics, lists *l) {
  mpsi_free(dynamics->context, l->bound);
  mpsi_free(dynamics->context, l->dashpot);
  mpsi_free(dynamics->context, l->owner);
  *l = (lists){0};
}

static const uint32_t dof_of[3] = {MPS_DOF_X, MPS_DOF_Y, MPS_DOF_ROTATION};

/* Number + 1 of the boundary that has each degree of freedom, 0 none; component by component. */
static void find_owners(const mps_dynamics *dynamics, int32_t *owner) {
  for (int32_t k = 0; k < dynamics->boundary_room; k++) {
    const mpsi_dynamics_boundary *b = dynamics->boundary[k];
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
      *q = (mpsi_dynamics_bound){.particle = (int32_t)i,
                                 .component = c,
                                 .boundary = number,
                                 .rest = displacement[c][i] - dynamics->boundary[number]->reach[c],
                                 .at = displacement[c][i],
                                 .before = dynamics->fresh ? dynamics->boundary[number]->speed[c]
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
    const mpsi_dynamics_boundary *b = dynamics->boundary[q->boundary];
    const bool along = q->component == b->normal;
    const double own = along ? vp[i] : vs[i], outside = along ? b->pressure : b->shear;
    const double impedance = (isnan(b->density) ? rho[i] : b->density) *
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
  for (int32_t number = 0; number < dynamics->boundary_room; number++) {
    const mpsi_dynamics_boundary *b = dynamics->boundary[number];
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
  for (int32_t k = 0; k < dynamics->boundary_room; k++) {
    const mpsi_dynamics_boundary *b = dynamics->boundary[k];
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
  const mps_status status = mpsi_dynamics_reserve_lists(dynamics, function, dynamics->count,
                                                        dynamics->column_dashpots, out);
  if (status != MPS_OK) return status;
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
  mpsi_free(dynamics->context, dynamics->bound);
  mpsi_free(dynamics->context, dynamics->dashpot);
  dynamics->bound = l->bound;
  dynamics->bounds = l->bounds;
  dynamics->dashpot = l->dashpot;
  dynamics->dashpots = l->dashpots;
  mpsi_free(dynamics->context, l->owner);
  *l = (lists){0};
}

void mpsi_dynamics_use_lists(mps_dynamics *dynamics, lists *room) {
  for (int64_t k = 0; k < 3 * dynamics->count; k++) room->owner[k] = 0;
  find_owners(dynamics, room->owner);
  list_bounds(dynamics, room->owner, -1, room);
  list_dashpots(dynamics, room->owner, room);
  put_lists(dynamics, room, -1, other_freedoms(dynamics, room));
}

/* Values of the signals of a driven boundary at time t. */
static mps_status evaluate(mps_dynamics *dynamics, const char *function, int32_t number,
                           mpsi_dynamics_boundary *b, double t) {
  if (!b || b->kind != MPS_BOUNDARY_DRIVEN) return MPS_OK;
  for (int c = 0; c < 2; c++) {
    mpsi_signal_motion at;
    const mpsi_signal_use use = {dynamics->context, function, "boundary", number, c};
    const mps_status status = mpsi_signal_evaluate(b->part.signal[c], use, t, &at);
    if (status != MPS_OK) return status;
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
  const double now = mps_dynamics_time(dynamics);
  for (int32_t k = 0; k < dynamics->boundary_room; k++) {
    const mps_status status = evaluate(dynamics, function, k, dynamics->boundary[k], now);
    if (status != MPS_OK) return status;
  }
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *const displacement[3] = {s->dx, s->dy, s->th};
  double *const velocity[3] = {s->vx, s->vy, s->vth};
  for (int64_t k = 0; k < dynamics->bounds; k++) {
    mpsi_dynamics_bound *q = &dynamics->bound[k];
    const mpsi_dynamics_boundary *b = dynamics->boundary[q->boundary];
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

/* Swaps `boundary` (NULL: none) with that of slot `number`, which may be NULL. */
static mps_status exchange(mps_dynamics *dynamics, const char *function, int32_t number,
                           mpsi_dynamics_boundary **boundary) {
  mpsi_dynamics_boundary *former = dynamics->boundary[number];
  lists l = {0};
  mps_status status = evaluate(dynamics, function, number, *boundary, mps_dynamics_time(dynamics));
  if (status == MPS_OK && !mpsi_dynamics_reserve_accounts(dynamics))
    status = mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 24);
  dynamics->boundary[number] = *boundary;
  if (status == MPS_OK) status = make_lists(dynamics, function, number, &l);
  double other = status == MPS_OK && other_freedoms(dynamics, &l);
  status = mpsi_domain_agree_max(dynamics->domain, function, status, 1, &other);
  if (status != MPS_OK) {
    dynamics->boundary[number] = former;
    mpsi_dynamics_free_lists(dynamics, &l);
    return status;
  }
  put_lists(dynamics, &l, number, other != 0.0);
  *boundary = former;
  return MPS_OK;
}

static mps_status check_number(const mps_dynamics *dynamics, const char *function, int32_t number) {
  const bool there = number >= 0 && number < dynamics->boundary_room && dynamics->boundary[number];
  return mpsi_dynamics_check_there(dynamics, function, "boundary", there, number);
}

mps_status mps_dynamics_add_boundary(mps_dynamics *dynamics, const mps_dynamics_boundary_def *def,
                                     int32_t *number) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  int32_t at = 0;
  while (at < dynamics->boundary_room && dynamics->boundary[at]) at++;
  void *slots = dynamics->boundary;
  status = mpsi_dynamics_reserve_slot(dynamics, __func__, at, &slots, &dynamics->boundary_room);
  dynamics->boundary = slots;
  mpsi_dynamics_boundary *boundary = NULL;
  status = make(dynamics, __func__, status, at, def, &boundary);
  if (status == MPS_OK) status = exchange(dynamics, __func__, at, &boundary);
  release(dynamics, &boundary);
  if (status == MPS_OK && number) *number = at;
  return status;
}

mps_status mps_dynamics_set_boundary(mps_dynamics *dynamics, int32_t number,
                                     const mps_dynamics_boundary_def *def) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  mpsi_dynamics_boundary *boundary = NULL;
  status =
      make(dynamics, __func__, check_number(dynamics, __func__, number), number, def, &boundary);
  if (status == MPS_OK) {
    const mpsi_dynamics_boundary *former = dynamics->boundary[number];
    memcpy(boundary->pushed, former->pushed, sizeof boundary->pushed);
    memcpy(boundary->impulse, former->impulse, sizeof boundary->impulse);
    memcpy(&boundary->work, &former->work, sizeof boundary->work);
    boundary->kick = former->kick;
    status = exchange(dynamics, __func__, number, &boundary);
  }
  release(dynamics, &boundary);
  return status;
}

mps_status mps_dynamics_remove_boundary(mps_dynamics *dynamics, int32_t number) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  status = mpsi_domain_agree_same(dynamics->domain, __func__,
                                  check_number(dynamics, __func__, number), "number", number);
  mpsi_dynamics_boundary *boundary = NULL;
  if (status == MPS_OK) status = exchange(dynamics, __func__, number, &boundary);
  release(dynamics, &boundary);
  return status;
}

mps_status mps_dynamics_get_reaction_sized(const mps_dynamics *dynamics, int32_t number,
                                           mps_reaction *out, size_t size) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = check_number(dynamics, "mps_dynamics_get_reaction", number);
  status = mpsi_domain_agree_same(dynamics->domain, "mps_dynamics_get_reaction", status, "number",
                                  number);
  if (status != MPS_OK) return status;
  const mpsi_dynamics_boundary *b = dynamics->boundary[number];
  const double rate = b->kick > 0.0 ? 1.0 / b->kick : 0.0;
  mpsi_exact sum[7];
  double value[7];
  memcpy(sum, b->pushed, sizeof b->pushed);
  memcpy(sum + 3, b->impulse, sizeof b->impulse);
  sum[6] = b->work;
  status = mpsi_domain_sum_exact(dynamics->domain, "mps_dynamics_get_reaction", 7, sum);
  if (status != MPS_OK) return status;
  for (int k = 0; k < 7; k++) value[k] = mpsi_exact_value(&sum[k]);
  const mps_reaction r = {
      .force = {value[0] * rate, value[1] * rate, 0.0},
      .moment = {0.0, 0.0, value[2] * rate},
      .impulse = {value[3], value[4], 0.0},
      .moment_impulse = {0.0, 0.0, value[5]},
      .count = b->kick <= 0.0                       ? 0
               : mpsi_domain_many(dynamics->domain) ? b->part.total
                                                    : b->part.count,
      .work = value[6],
  };
  return mpsi_out_write(dynamics->context, "mps_dynamics_get_reaction", out, size, &r, sizeof r);
}

void mpsi_dynamics_free_boundaries(mps_dynamics *dynamics) {
  for (int32_t k = 0; k < dynamics->boundary_room; k++) release(dynamics, &dynamics->boundary[k]);
  mpsi_free(dynamics->context, dynamics->boundary);
  mpsi_free(dynamics->context, dynamics->bound);
  mpsi_free(dynamics->context, dynamics->dashpot);
  mpsi_free(dynamics->context, dynamics->column_dashpot);
}
