/* boundaries.c - plane walls: definitions, checks, and how they are added, changed and removed.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/boundary/walls.h"
#include "fluid/base/access.h"
#include "fluid/boundary/slots.h"
#include "fluid/boundary/clearance.h"
#include "fluid/ranks/partition.h"

#include "core/context/retain.h"
#include "signal/signal_internal.h"

#define LEAST_WALL 0.3 /* l0: distance of a particle from a wall */

static mps_status check(void *solver, const char *function, int32_t number, const void *known) {
  mps_fluid *f = solver;
  const mps_fluid_boundary_def *d = known;
  const double length = hypot(d->normal[0], d->normal[1]);
  if (d->corner_count != 0)
    return mpsi_fluid_check_corners(f, function, d->corner_count, d->corners);
  if (length > 1e-150 && length < 1e150) return MPS_OK;
  return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                   "normal is (%g, %g), must be finite and not zero", d->normal[0], d->normal[1]);
}

/* Whether the corner of the wall and boundary b lies behind another boundary. */
static bool cut_off(const mps_fluid *f, const mpsi_fluid_wall *w, int b, int32_t number) {
  const mpsi_fluid_wall *o = &f->wall[b];
  const double det = w->normal[0] * o->normal[1] - w->normal[1] * o->normal[0];
  const double p = w->at[0] * w->normal[0] + w->at[1] * w->normal[1];
  const double q = o->at[0] * o->normal[0] + o->at[1] * o->normal[1] + o->now.s[0];
  const double x = (p * o->normal[1] - q * w->normal[1]) / det;
  const double y = (q * w->normal[0] - p * o->normal[0]) / det;
  for (int k = 0; k < f->boundaries; k++) {
    const mpsi_fluid_wall *other = &f->wall[k];
    if (k != b && k != number && other->used &&
        mpsi_fluid_distance(other, other->now.s, x, y) < -f->reach)
      return true;
  }
  return false;
}

/* The wall against particles and other walls. */
static mps_status check_place(mps_fluid *f, const char *function, const mpsi_fluid_wall *w,
                              int32_t number) {
  const double *x = mpsi_particles_column(f->particles, "position", 0);
  const double *y = mpsi_particles_column(f->particles, "position", 1);
  for (int64_t i = 0; i < f->count; i++) {
    const double d = mpsi_fluid_distance(w, w->now.s, x[i], y[i]);
    if (d < LEAST_WALL * f->l0)
      return mpsi_fail(
          f->context, function, MPS_ERROR_ARGUMENT,
          "point: particle %lld at (%g, %g) m lies %g m %s the boundary, must lie inside "
          "it by at least %g l0 = %g m",
          (long long)mpsi_particles_integers(f->particles, "id")[i], x[i], y[i], fabs(d),
          d < 0.0 ? "outside" : "inside", LEAST_WALL, LEAST_WALL * f->l0);
  }
  for (int b = 0; b < f->boundaries; b++) {
    if (b == number || !f->wall[b].line) continue;
    MPSI_TRY(mpsi_fluid_check_meeting(f, function, w, number, f->wall[b].line));
  }
  for (int b = 0; b < f->boundaries; b++) {
    const double *N = f->wall[b].normal, cosine = N[0] * w->normal[0] + N[1] * w->normal[1];
    if (!f->wall[b].used || b == number) continue;
    /* opposite walls are parallel; otherwise the fluid's corner has pi - acos(cosine) */
    if (cosine < -1e-6 && cosine > -1.0 + 1e-9 && !cut_off(f, w, b, number))
      return mpsi_fail(
          f->context, function, MPS_ERROR_ARGUMENT,
          "the boundary and boundary %d enclose %g degrees of fluid, allowed are 90 and "
          "more",
          b, 180.0 - acos(cosine) * 57.29577951308232);
  }
  return MPS_OK;
}

/* The present value of the signal (NULL: none) is a displacement of 0. */
static mps_status start_motion(mps_fluid *f, const char *function, const mps_signal *signal,
                               int32_t number, mpsi_fluid_wall *w) {
  const mpsi_signal_use use = {f->context, function, "boundary", number, -1};
  const mpsi_guard outer = mpsi_guard_close(&f->guard, f->context, "a signal of the solver");
  mpsi_signal_motion m;
  const mps_status status = mpsi_signal_evaluate(signal, use, f->time, &m);
  f->guard = outer;
  if (status == MPS_OK) w->origin = m.u, w->rate = w->factor * m.v;
  return status;
}

/* A wall without motion, of which the segments are parts. */
static mps_status make_line(mps_fluid *f, const char *function, const mps_fluid_boundary_def *def,
                            int32_t number, mpsi_fluid_wall *w) {
  *w = (mpsi_fluid_wall){.kind = def->kind, .factor = 1.0, .friction = def->friction_factor};
  mps_status status = mpsi_fluid_make_motion(f, function, w, 0, NULL);
  if (status == MPS_OK)
    status = mpsi_fluid_make_polyline(f, function, number, def->corner_count, def->corners, w);
  return status == MPS_OK ? mpsi_fluid_check_bodies(f, function, w->line) : status;
}

/* The wall of a definition, with room for it. */
static mps_status make(void *solver, const char *function, int32_t number, void *known, void *own) {
  mps_fluid *f = solver;
  const mps_fluid_boundary_def *def = known;
  mpsi_fluid_wall *w = own;
  if (!mpsi_fluid_make_boundary(f, number))
    return mpsi_fail_memory(f->context, function, ((size_t)f->walls + 1) * sizeof *f->wall);
  if (def->corner_count != 0) return make_line(f, function, def, number, w);
  const double length = hypot(def->normal[0], def->normal[1]);
  const bool open = def->kind == MPS_BOUNDARY_OPEN;
  *w = (mpsi_fluid_wall){.used = !open,
                         .open = open,
                         .kind = def->kind,
                         .factor = def->factor,
                         .friction = def->friction_factor};
  for (int c = 0; c < 2; c++) w->at[c] = def->point[c], w->normal[c] = def->normal[c] / length;
  mps_status status = start_motion(f, function, def->signal, number, w);
  if (status == MPS_OK)
    status = mpsi_fluid_make_motion(f, function, w, def->node_count, def->nodes);
  if (status == MPS_OK && !open) status = check_place(f, function, w, number);
  if (def->signal) w->signal = mpsi_signal_retain(def->signal);
  return status;
}

/* What a wall has when it gets another definition. */
static void carry_over(const mpsi_fluid_wall *old, mpsi_fluid_wall *now) {
  if (now->nodes == old->nodes && !now->line && !old->line)
    for (int64_t k = 0; k < now->nodes; k++) now->now.u[k] = old->now.u[k];
  now->load = old->load;
  for (int c = 0; c < 2; c++) now->impulse[c] = old->impulse[c];
  now->moment_impulse = old->moment_impulse;
  now->work = old->work;
  now->removed = old->removed;
  now->removed_mass = old->removed_mass;
}

/* Moves the wall made to its place among the others; bodies may stand on others now. */
static mps_status apply(void *solver, const char *function, int32_t number, void *def, void *own,
                        void *former) {
  mps_fluid *f = solver;
  mpsi_fluid_wall *now = own, *place = &f->wall[number];
  const mps_status status =
      mpsi_domain_agree_same(f->domain, function, MPS_OK, "the signal's present displacement",
                             now ? now->origin : 0.0); /* of functions of the caller */
  if (status != MPS_OK) return status;
  if (now && former) carry_over(place, now);
  mpsi_fluid_drop_wall(f, place);
  if (now) {
    *place = *now;
    *now = (mpsi_fluid_wall){0};
  }
  mpsi_fluid_drop_slots(f, 0, 0);
  mpsi_fluid_place_bodies(f);
  mpsi_fluid_forget_segments(f);
  f->stale = true, f->unknown = 1;
  return MPS_OK;
}

static void drop(void *solver, void *own) {
  mpsi_fluid_drop_wall(solver, own);
  mpsi_fluid_drop_slots(solver, 0, 0);
}

const mpsi_condition_kind mpsi_fluid_boundaries = {
    MPSI_CONDITION_OF(FLUID, fluid, BOUNDARY, boundary),
    .role = MPSI_SIGNAL_MOTION,
    .list = {{"nodes", "node_count", 3}, {"corners", "corner_count", 3}},
    .most = MPS_FLUID_MAX_BOUNDARIES,
    .size = sizeof(mpsi_fluid_wall),
    .check = check,
    .make = make,
    .apply = apply,
    .drop = drop,
};
