/* exchange.c - exchange of momentum between water and walls besides the pressure.
 *
 * To a wall: of a pair of a particle and an image the change of velocity along the normals of the
 * walls that the image is mirrored at, by smoothing and by collisions; that along a wall of no slip
 * by the viscosity; and the momentum of a particle that is moved back from a wall. It is part of
 * the wall's impulse, and of a body's; it acts on a floating body in the next step. Friction has
 * sums of its own, which are part of the wall's force.
 *
 * The remainder is an error of the scheme: the gradients of the pressure at the particles sum up to
 * the pressures along the walls only nearly, smoothing of gentle flow is not the same from both
 * sides of a pair, and cut velocities and shifts change momentum too. It is found as what the water
 * has gained less all of the above, gravity and loads.
 *
 * Sums are made by chunk, and over chunks without round-off: the same bits on any number of ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/step/exchange.h"

#include "fluid/boundary/polyline.h"
#include "fluid/ranks/partition.h"

#include "core/base/exact.h"

#include <string.h>

/* Values of a row: gain x, y; of each wall x, y, moment, work, and as many by friction where it has
 * some. */
enum { GAIN = 2, OF_WALL = 4 };

static int64_t chunks_of(const mps_fluid *f) {
  return (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
}

static double *row_of(const mps_fluid *f, int64_t chunk) {
  return (double *)f->exchange.rows.item + chunk * f->exchange.width;
}

static double mass_of(const mps_fluid *f) {
  return f->def.density * f->l0 * f->l0 * f->def.measure;
}

/* Room in a row for the friction of a wall. */
static void begin_friction(mps_fluid *f, mpsi_fluid_wall *w) {
  w->first_shear = f->exchange.width;
  w->sheared = (mpsi_fluid_struck){{0.0}, 0.0, 0.0};
  if (w->friction > 0.0) f->exchange.width += OF_WALL;
}

mps_status mpsi_fluid_begin_exchange(mps_fluid *f, const char *function) {
  mpsi_fluid_exchange *e = &f->exchange;
  e->width = GAIN;
  for (int b = 0; b < f->walls; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    w->first_sum = e->width;
    if (w->used || w->line) e->width += OF_WALL;
    if (w->used) begin_friction(f, w);
    for (int64_t k = 0; w->line && k < w->line->count; k++)
      begin_friction(f, &w->line->segment[k].wall);
  }
  const int64_t values = chunks_of(f) * e->width;
  if (!mpsi_room_ensure(f->context, &e->rows, values, sizeof(double)))
    return mpsi_fail_memory(f->context, function, (size_t)values * sizeof(double));
  if (!mpsi_room_ensure(f->context, &e->sums, e->width, sizeof(mpsi_exact)))
    return mpsi_fail_memory(f->context, function, (size_t)e->width * sizeof(mpsi_exact));
  memset(e->rows.item, 0, (size_t)values * sizeof(double));
  return MPS_OK;
}

void mpsi_fluid_drop_exchange(mps_fluid *f) {
  MPSI_FREE(f->context, f->exchange.rows.item, f->exchange.sums.item);
}

/* ---- in the loops over particles ------------------------------------------------------------- */

void mpsi_fluid_exchange_wall(const mps_fluid *f, int64_t chunk, int wall, int64_t i,
                              const double *dv) {
  const mpsi_fluid_wall *w = &f->wall[wall];
  const double x = f->x[0][i], y = f->x[1][i], mass = mass_of(f);
  const double across = dv[0] * w->normal[0] + dv[1] * w->normal[1];
  double *sum = row_of(f, chunk) + w->first_sum;
  sum[0] += mass * dv[0], sum[1] += mass * dv[1];
  sum[2] += mass * (x * dv[1] - y * dv[0]);
  sum[3] += mass * across * mpsi_fluid_of_wall(w, w->mean, x, y);
}

double mpsi_fluid_moves_along(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t i) {
  if (w->of_body == 0) return 0.0;
  const mpsi_fluid_pose *p = &f->body[w->of_body - 1].next;
  const double d = mpsi_fluid_distance(w, mpsi_fluid_places(f, w), f->x[0][i], f->x[1][i]);
  const double x = f->x[0][i] - d * w->normal[0] - p->x[0];
  const double y = f->x[1][i] - d * w->normal[1] - p->x[1];
  const double v[2] = {p->v[0] - p->spin * y, p->v[1] + p->spin * x};
  return v[1] * w->normal[0] - v[0] * w->normal[1];
}

/* Adds mass dv (N s) at a particle's foot on a wall that moves along itself to four sums. */
static void add_along(const mps_fluid *f, const mpsi_fluid_wall *w, int64_t i, const double *dv,
                      double moves, double *sum) {
  const double d = mpsi_fluid_distance(w, mpsi_fluid_places(f, w), f->x[0][i], f->x[1][i]);
  const double x = f->x[0][i] - d * w->normal[0], y = f->x[1][i] - d * w->normal[1];
  const double mass = mass_of(f);
  sum[0] += mass * dv[0], sum[1] += mass * dv[1];
  sum[2] += mass * (x * dv[1] - y * dv[0]);
  sum[3] += mass * moves * (dv[1] * w->normal[0] - dv[0] * w->normal[1]);
}

void mpsi_fluid_exchange_drag(const mps_fluid *f, int64_t chunk, int wall, int64_t i,
                              const double *dv) {
  const mpsi_fluid_wall *w = &f->wall[wall];
  add_along(f, w, i, dv, mpsi_fluid_moves_along(f, w, i), row_of(f, chunk) + w->first_sum);
}

void mpsi_fluid_exchange_friction(const mps_fluid *f, int64_t chunk, const mpsi_fluid_wall *w,
                                  int64_t i, const double *dv, double moves) {
  add_along(f, w, i, dv, moves, row_of(f, chunk) + w->first_shear);
}

/* Of a pair of i and the image M j, j gets -M^T dv: both together (1 - M^T) dv. */
static void exchange_in_line(const mps_fluid *f, const mpsi_fluid_path *path, int64_t chunk,
                             int64_t i, const double *dv) {
  double back[2] = {dv[0], dv[1]};
  mpsi_fluid_reflect_back(path, back);
  for (int c = 0; c < 2; c++) back[c] = 0.5 * (dv[c] - back[c]);
  mpsi_fluid_exchange_wall(f, chunk, mpsi_fluid_segment_of(f, path->segment[0])->boundary, i, back);
}

static bool no_slip(const mps_fluid *f, const mpsi_fluid_path *path) {
  return mpsi_fluid_segment_of(f, path->segment[0])->wall.kind == MPS_BOUNDARY_HELD;
}

void mpsi_fluid_exchange_along_line(const mps_fluid *f, int64_t chunk, int64_t ghost, int64_t i,
                                    const double *dv) {
  const mpsi_fluid_path *path = mpsi_fluid_path_of(f, ghost);
  if (!path || !no_slip(f, path)) return;
  double along[2] = {dv[0], dv[1]};
  mpsi_fluid_reflect_back(path, along);
  for (int c = 0; c < 2; c++) along[c] = 0.5 * (dv[c] + along[c]);
  mpsi_fluid_exchange_wall(f, chunk, mpsi_fluid_segment_of(f, path->segment[0])->boundary, i,
                           along);
}

void mpsi_fluid_exchange_image(const mps_fluid *f, int64_t chunk, int64_t ghost, int64_t i,
                               const double *dv) {
  const mpsi_fluid_path *path = mpsi_fluid_path_of(f, ghost);
  if (path) exchange_in_line(f, path, chunk, i, dv);
  MPSI_FLUID_FLIPS(k, f->flips[ghost]) {
    const int b = f->flips[ghost].wall[k];
    const double *N = f->wall[b].normal, across = dv[0] * N[0] + dv[1] * N[1];
    mpsi_fluid_exchange_wall(f, chunk, b, i, (double[]){across * N[0], across * N[1]});
  }
}

void mpsi_fluid_stick(const mps_fluid *f, int64_t ghost, double *u) {
  MPSI_FLUID_FLIPS(k, f->flips[ghost]) {
    const mpsi_fluid_wall *w = &f->wall[f->flips[ghost].wall[k]];
    const double *N = w->normal;
    if (!w->sticky) continue;
    const double across = u[0] * N[0] + u[1] * N[1];
    const double moves = mpsi_fluid_moves_along(f, w, f->parent[ghost]);
    const double along[2] = {-N[1] * moves, N[0] * moves};
    for (int c = 0; c < 2; c++) u[c] = 2.0 * (across * N[c] + along[c]) - u[c];
  }
  const mpsi_fluid_path *path = mpsi_fluid_path_of(f, ghost);
  if (!path || !no_slip(f, path)) return;
  mpsi_fluid_reflect_back(path, u);
  for (int c = 0; c < 2 && path->count % 2 == 1; c++) u[c] = -u[c];
}

void mpsi_fluid_gain(const mps_fluid *f, int64_t chunk, const double *du) {
  double *sum = row_of(f, chunk);
  sum[0] += du[0], sum[1] += du[1];
}

/* ---- after them ------------------------------------------------------------------------------ */

static mpsi_fluid_struck struck_by(const mpsi_exact *of) {
  return (mpsi_fluid_struck){{mpsi_exact_value(&of[0]), mpsi_exact_value(&of[1])},
                             mpsi_exact_value(&of[2]),
                             mpsi_exact_value(&of[3])};
}

void mpsi_fluid_end_exchange(mps_fluid *f) {
  mpsi_fluid_exchange *e = &f->exchange;
  mpsi_exact *sum = e->sums.item;
  memset(sum, 0, (size_t)e->width * sizeof *sum);
  for (int64_t chunk = 0; chunk < chunks_of(f); chunk++) {
    const int64_t first = chunk * MPSI_FLUID_CHUNK;
    const double *row = row_of(f, chunk);
    if (first < f->own[0] || first >= f->own[1]) continue;
    for (int64_t k = 0; k < e->width; k++)
      if (row[k] != 0.0) mpsi_exact_add(&sum[k], row[k]);
  }
  mpsi_fluid_reduce_exact(f, (int32_t)e->width, sum);
  for (int c = 0; c < 2; c++) e->gain[c] = mass_of(f) * mpsi_exact_value(&sum[c]);
  for (int b = 0; b < f->walls; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used && !w->line) continue;
    w->struck = struck_by(&sum[w->first_sum]);
    if (w->used && w->friction > 0.0) w->sheared = struck_by(&sum[w->first_shear]);
    for (int64_t k = 0; w->line && w->friction > 0.0 && k < w->line->count; k++) {
      mpsi_fluid_wall *part = &w->line->segment[k].wall;
      part->sheared = struck_by(&sum[part->first_shear]);
    }
  }
}

/* Impulse (N s) of gravity, loads and the caller's forces in the step. */
static void find_loads(const mps_fluid *f, double *impulse) {
  const double mass = mass_of(f);
  for (int c = 0; c < 2; c++) {
    double sum = 0.0;
    for (int64_t i = 0; f->push[0] && i < f->count; i++) sum += f->push[c][i];
    impulse[c] = mass * f->dt * (sum - f->g * f->up[c] * (double)f->count);
  }
}

void mpsi_fluid_book_momentum(mps_fluid *f) {
  mpsi_fluid_exchange *e = &f->exchange;
  double loads[2], rest[2];
  find_loads(f, loads);
  for (int c = 0; c < 2; c++) {
    rest[c] = e->gain[c] - loads[c];
    for (int b = 0; b < f->boundaries; b++) {
      const mpsi_fluid_wall *w = &f->wall[b];
      if (w->used || w->line) rest[c] -= f->dt * w->load.force[c] + w->struck.impulse[c];
    }
    for (int b = 0; b < f->bodies; b++) {
      const mpsi_fluid_body *body = &f->body[b];
      for (int32_t part = 0; body->body && part < body->body->parts; part++)
        rest[c] += f->dt * body->source->part[part].force.force[c];
      for (int k = 0; body->body && k < body->faces; k++) {
        const mpsi_fluid_wall *w = &f->wall[body->first + k];
        if (!w->used) continue;
        rest[c] -= w->struck.impulse[c] + (body->floats ? w->sheared.impulse[c] : 0.0);
      }
    }
    e->loads[c] += loads[c];
    e->scheme[c] += rest[c];
  }
}
