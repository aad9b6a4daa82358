/* boundaries.c - plane walls: definitions, checks, and how they are added, changed and removed.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/base/access.h"
#include "fluid/boundary/slots.h"
#include "fluid/boundary/clearance.h"
#include "fluid/ranks/partition.h"

#include "core/base/boundary_kind.h"
#include "signal/signal_internal.h"

#define LEAST_WALL 0.3 /* l0: distance of a particle from a wall */

static const mps_fluid_boundary_def boundary_defaults = {
    .struct_size = sizeof(mps_fluid_boundary_def), .factor = 1.0};

mps_status mps_fluid_boundary_def_init(mps_fluid_boundary_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_fluid_boundary_def, def, size, &boundary_defaults);
}

/* Members of a definition that a polyline has not. */
static mps_status check_line(mps_fluid *f, const char *function, const mps_fluid_boundary_def *d) {
  if (d->kind != MPS_BOUNDARY_HELD && d->kind != MPS_BOUNDARY_ROLLER)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "kind of the boundary is %d (%s): a polyline is 0 (HELD) or 2 (ROLLER)",
                     d->kind, mpsi_boundary_kind_name(d->kind));
  if (d->signal || d->node_count != 0)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "the boundary has corners, and a signal or nodes: a polyline does not move");
  return MPS_OK;
}

static mps_status check_boundary(mps_fluid *f, const char *function,
                                 const mps_fluid_boundary_def *d) {
  const double length = hypot(d->normal[0], d->normal[1]);
  if (!mpsi_boundary_kind_in(d->kind, 1u << MPS_BOUNDARY_HELD | 1u << MPS_BOUNDARY_DRIVEN |
                                          1u << MPS_BOUNDARY_ROLLER | 1u << MPS_BOUNDARY_OPEN))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "kind of the boundary is %d (%s), the fluid has 0 (HELD), 1 (DRIVEN), 2 "
                     "(ROLLER) and 7 (OPEN)",
                     d->kind, mpsi_boundary_kind_name(d->kind));
  if (d->kind == MPS_BOUNDARY_HELD && d->signal)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "a held boundary takes no signal: make its kind DRIVEN, or ROLLER for slip");
  if (d->kind == MPS_BOUNDARY_OPEN && (d->signal || d->node_count > 0))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "the open boundary has a signal or nodes: an open side does not move");
  if (d->corner_count != 0) return check_line(f, function, d);
  if (!(length > 1e-150 && length < 1e150) || d->normal[2] != 0.0)
    return mpsi_fail(
        f->context, function, MPS_ERROR_ARGUMENT,
        "normal of the boundary is (%g, %g, %g): it must lie in the plane and have a length",
        d->normal[0], d->normal[1], d->normal[2]);
  if (!(fabs(d->point[0]) <= 1e12 && fabs(d->point[1]) <= 1e12) || !isfinite(d->factor))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "point of the boundary is (%g, %g) m and factor %g: must be finite, the point "
                     "within 1e12 m",
                     d->point[0], d->point[1], d->factor);
  if (d->node_count < 0 || d->node_count > 1000000 || (d->node_count > 0 && !d->nodes) ||
      (d->node_count > 1 && d->signal))
    return mpsi_fail(
        f->context, function, MPS_ERROR_ARGUMENT,
        "node_count of the boundary is %lld with nodes %s and %s signal: allowed are 0 "
        "to 1e6 with nodes given, and at most one node with a signal",
        (long long)d->node_count, d->nodes ? "given" : "NULL", d->signal ? "a" : "no");
  for (int64_t k = 0; k < 3 * d->node_count; k++)
    if (!(fabs(d->nodes[k]) <= 1e12))
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "nodes: node %lld has a coordinate of %g m, must be within 1e12 m",
                       (long long)(k / 3), d->nodes[k]);
  return MPS_OK;
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
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "point: particle %lld at (%g, %g) m is %g m inside the boundary, must be at "
                       "least %g l0 = %g m",
                       (long long)mpsi_particles_integers(f->particles, "id")[i], x[i], y[i], d,
                       LEAST_WALL, LEAST_WALL * f->l0);
  }
  for (int b = 0; b < f->boundaries; b++) {
    if (b == number || !f->wall[b].line) continue;
    const mps_status status = mpsi_fluid_check_meeting(f, function, w, number, f->wall[b].line);
    if (status != MPS_OK) return status;
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
                            int32_t number, mpsi_fluid_wall *out) {
  mpsi_fluid_wall w = {.kind = def->kind, .factor = 1.0};
  mps_status status = mpsi_fluid_make_motion(f, function, &w, 0, NULL);
  if (status == MPS_OK)
    status = mpsi_fluid_make_polyline(f, function, number, def->corner_count, def->corners, &w);
  if (status == MPS_OK) status = mpsi_fluid_check_bodies(f, function, w.line);
  if (status == MPS_OK)
    *out = w;
  else
    mpsi_fluid_drop_wall(f, &w);
  return status;
}

/* Checks a definition and makes its wall, of `number`. */
static mps_status make_wall(mps_fluid *f, const char *function,
                            const mps_fluid_boundary_def *user_def, int32_t number,
                            mpsi_fluid_wall *out) {
  if (!user_def) return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "def is NULL");
  mps_fluid_boundary_def def = boundary_defaults;
  mps_status status = MPSI_DEF_READ(f->context, function, mps_fluid_boundary_def, user_def, &def);
  if (status == MPS_OK) status = check_boundary(f, function, &def);
  if (status != MPS_OK) return status;
  if (def.corner_count != 0) return make_line(f, function, &def, number, out);
  const double length = hypot(def.normal[0], def.normal[1]);
  const bool open = def.kind == MPS_BOUNDARY_OPEN;
  mpsi_fluid_wall w = {.used = !open, .open = open, .kind = def.kind, .factor = def.factor};
  for (int c = 0; c < 2; c++) w.at[c] = def.point[c], w.normal[c] = def.normal[c] / length;
  status = start_motion(f, function, def.signal, number, &w);
  if (status == MPS_OK) status = mpsi_fluid_make_motion(f, function, &w, def.node_count, def.nodes);
  if (status == MPS_OK && !open) status = check_place(f, function, &w, number);
  if (status != MPS_OK) {
    mpsi_fluid_drop_wall(f, &w);
    return status;
  }
  if (def.signal) w.signal = mpsi_signal_retain(def.signal);
  *out = w;
  return MPS_OK;
}

/* Makes the wall on all ranks, or on none; `status` is that of this rank so far. */
static mps_status make_alike(mps_fluid *f, const char *function, mps_status status,
                             const mps_fluid_boundary_def *def, int32_t number,
                             mpsi_fluid_wall *w) {
  *w = (mpsi_fluid_wall){0};
  if (status == MPS_OK) status = make_wall(f, function, def, number, w);
  if (f->partition) {
    mpsi_given given;
    mpsi_given_begin(&given);
    mpsi_give(&given, "number", number);
    mpsi_give(&given, "kind", w->kind);
    mpsi_give_vector(&given, "point", 2, w->at);
    mpsi_give_vector(&given, "normal", 2, w->normal);
    mpsi_give(&given, "factor", w->factor);
    mpsi_give(&given, "the signal's present displacement", w->origin);
    mpsi_give(&given, "node_count", (double)w->nodes);
    mpsi_give_bytes(&given, "a hash of nodes", w->node, (size_t)w->nodes * 8);
    mpsi_fluid_give_corners(&given, w->line);
    mpsi_signal_give(&given, "a hash of signal", w->signal);
    status = mpsi_domain_agree_given(f->def.domain, function, status, &given);
  }
  if (status != MPS_OK) mpsi_fluid_drop_wall(f, w);
  return status;
}

/* After a change of boundaries, or an attempt: bodies may stand on others now. */
static void have_changed(mps_fluid *f, mps_status status) {
  mpsi_fluid_drop_slots(f, 0, 0);
  if (status != MPS_OK) return;
  mpsi_fluid_place_bodies(f);
  mpsi_fluid_forget_segments(f);
  f->stale = true, f->unknown = 1;
}

mps_status mps_fluid_add_boundary(mps_fluid *f, const mps_fluid_boundary_def *def,
                                  int32_t *number) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  int32_t b = 0;
  while (MPSI_FLUID_IS_BOUNDARY(f, b)) b++;
  if (b == MPS_FLUID_MAX_BOUNDARIES)
    status = mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                       "the fluid has %d boundaries, the most there can be", b);
  else if (!mpsi_fluid_make_boundary(f, b))
    status = mpsi_fail_memory(f->context, __func__, ((size_t)f->walls + 1) * sizeof *f->wall);
  mpsi_fluid_wall wall;
  status = make_alike(f, __func__, status, def, b, &wall);
  if (status == MPS_OK) f->wall[b] = wall;
  have_changed(f, status);
  if (status != MPS_OK) return status;
  if (number) *number = b;
  return MPS_OK;
}

static mps_status check_number(mps_fluid *f, const char *function, int32_t number) {
  if (!MPSI_FLUID_IS_BOUNDARY(f, number))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "the fluid has no boundary of number %d", number);
  return MPS_OK;
}

mps_status mps_fluid_set_boundary(mps_fluid *f, int32_t number, const mps_fluid_boundary_def *def) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  mpsi_fluid_wall wall;
  status = make_alike(f, __func__, check_number(f, __func__, number), def, number, &wall);
  if (status != MPS_OK) return status;
  mpsi_fluid_wall *old = &f->wall[number];
  if (wall.nodes == old->nodes && !wall.line && !old->line)
    for (int64_t k = 0; k < wall.nodes; k++) wall.now.u[k] = old->now.u[k];
  wall.load = old->load;
  for (int c = 0; c < 2; c++) wall.impulse[c] = old->impulse[c];
  wall.moment_impulse = old->moment_impulse;
  wall.work = old->work;
  wall.removed = old->removed;
  wall.removed_mass = old->removed_mass;
  mpsi_fluid_drop_wall(f, old);
  *old = wall;
  have_changed(f, status);
  return MPS_OK;
}

mps_status mps_fluid_remove_boundary(mps_fluid *f, int32_t number) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  status = mpsi_domain_agree_same(f->def.domain, __func__, check_number(f, __func__, number),
                                  "number", number);
  if (status != MPS_OK) return status;
  mpsi_fluid_drop_wall(f, &f->wall[number]);
  have_changed(f, status);
  return MPS_OK;
}
