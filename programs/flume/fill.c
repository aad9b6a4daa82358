/* fill.c - particles of the water at rest: a lattice of the spacing, in rock one whose cells have
 * the same volume of water, l0^2/porosity. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdlib.h>

#define CLEAR 0.45 /* spacings between the water's particles and a face */
#define APART 0.55 /* spacings between the two lattices, at least */
#define PARTS 7    /* of a cell that a face cuts, along each side */

typedef struct filling {
  const flume *m;
  double *x;
  int64_t count, room;
  uint64_t state;
  bool full, cut; /* no memory; faces cut cells */
} filling;

static void add(filling *f, const double *x) {
  if (f->count == f->room) {
    f->full = true;
    return;
  }
  f->x[2 * f->count] = x[0], f->x[2 * f->count + 1] = x[1];
  f->count++;
}

static double clearance(const flume *m) {
  return fmin(CLEAR, 0.5 - m->s.disturb) * m->s.spacing * (1.0 - 1e-9);
}

/* Moves a particle that is too near a face off it. False: there is a face on both sides. */
static bool keep_clear(const flume *m, double *x) {
  double on[2];
  int32_t wall;
  const double least = clearance(m), distance = flume_nearest_face(m, x, on, &wall);
  if (distance >= least) return true;
  if (!(distance > 0.0)) return false;
  for (int c = 0; c < 2; c++) x[c] = on[c] + (x[c] - on[c]) * (1.0 + 1e-9) * least / distance;
  return flume_nearest_face(m, x, on, &wall) >= least && !flume_is_solid(m, x[0], x[1]);
}

/* Columns and rows from the origin. */
static bool site(const flume *m, double x, double y) {
  return !flume_is_solid(m, x, y) && flume_is_wet(m, x, y) && flume_rock_at(m, x, y) < 0;
}

/* Part of the cell of the lattice about x that water fills, with its centre in place of x. */
static double water_in(const flume *m, double *x) {
  const double l0 = m->s.spacing;
  double on[2], sum[2] = {0.0, 0.0};
  int32_t wall, count = 0;
  bool wet = false;
  if (flume_nearest_face(m, x, on, &wall) >= 0.71 * l0) return site(m, x[0], x[1]) ? 1.0 : 0.0;
  if (flume_rock_at(m, x[0], x[1]) >= 0) return 0.0;
  for (int k = 0; k < PARTS * PARTS; k++) {
    const double at[2] = {x[0] + l0 * ((k % PARTS + 0.5) / PARTS - 0.5),
                          x[1] + l0 * ((k / PARTS + 0.5) / PARTS - 0.5)};
    if (flume_is_solid(m, at[0], at[1])) continue;
    wet = wet || flume_is_wet(m, at[0], at[1]);
    for (int c = 0; c < 2; c++) sum[c] += at[c];
    count++;
  }
  for (int c = 0; c < 2 && count > 0; c++) x[c] = sum[c] / count;
  return wet ? (double)count / (PARTS * PARTS) : 0.0;
}

/* Of the cells that faces cut as many have a particle as their water needs: the error is carried
 * on to the next one. */
static void fill_water(filling *f) {
  const flume *m = f->m;
  const flume_settings *s = &m->s;
  const double reach = flume_is_open(m) ? m->heel[0] : m->outlet;
  const int64_t columns = llround(reach / s->spacing), rows = llround(s->depth / s->spacing);
  const int64_t lowest = (int64_t)floor(m->cells.lower / s->spacing);
  double carried = 0.0;
  for (int64_t j = lowest; j < rows; j++)
    for (int64_t i = 0; i < columns; i++) {
      double at[2] = {((double)i + 0.5) * s->spacing, ((double)j + 0.5) * s->spacing};
      const double part = water_in(m, at);
      f->cut = f->cut || (part > 0.0 && part < 1.0);
      carried += part;
      for (int c = 0; c < 2; c++) at[c] += s->disturb * s->spacing * waves_noise(&f->state);
      if (carried < 0.5 || flume_is_solid(m, at[0], at[1]) || !keep_clear(m, at)) continue;
      add(f, at);
      carried -= 1.0;
    }
}

/* Whether the lattice of the water has a particle near a point of the rock's. */
static bool is_taken(const flume *m, const double *x) {
  const double l0 = m->s.spacing;
  const double near[2] = {(floor(x[0] / l0) + 0.5) * l0, (floor(x[1] / l0) + 0.5) * l0};
  return site(m, near[0], near[1]) && hypot(x[0] - near[0], x[1] - near[1]) < APART * l0;
}

/* Whole rows between bottom and top of the rock's box, up to the level of the water, and as many
 * whole columns as its water needs. */
static void fill_rock(filling *f, int number) {
  const flume *m = f->m;
  const flume_rock *r = &m->shape.rock[number];
  double lower[2] = {INFINITY, INFINITY}, upper[2] = {-INFINITY, -INFINITY}, pitch[2];
  int64_t cells[2];
  for (int k = 0; k < r->corners; k++)
    for (int c = 0; c < 2; c++)
      lower[c] = fmin(lower[c], r->corner[k][c]), upper[c] = fmax(upper[c], r->corner[k][c]);
  lower[0] = fmax(lower[0], 0.0), upper[0] = fmin(upper[0], m->outlet);
  lower[1] = fmax(lower[1], m->cells.lower), upper[1] = fmin(upper[1], m->s.depth);
  const double area = m->s.spacing * m->s.spacing / r->porosity; /* of a particle */
  for (int c = 1; c >= 0; c--) {
    const double wanted = c ? sqrt(area) : area / pitch[1];
    cells[c] = (int64_t)fmax(round((upper[c] - lower[c]) / wanted), 0.0);
    pitch[c] = (upper[c] - lower[c]) / (double)(cells[c] > 0 ? cells[c] : 1);
  }
  for (int64_t j = 0; j < cells[1]; j++)
    for (int64_t i = 0; i < cells[0]; i++) {
      double at[2] = {lower[0] + ((double)i + 0.5) * pitch[0],
                      lower[1] + ((double)j + 0.5) * pitch[1]};
      if (flume_rock_at(m, at[0], at[1]) != number || flume_is_solid(m, at[0], at[1]) ||
          !flume_is_wet(m, at[0], at[1]) || is_taken(m, at))
        continue;
      for (int c = 0; c < 2; c++) at[c] += m->s.disturb * m->s.spacing * waves_noise(&f->state);
      if (flume_face_distance(m, at) >= clearance(m)) add(f, at);
    }
}

/* Particles that steps have brought nearer to a face than a new fluid accepts. */
mps_status flume_clear_faces(const flume *m) {
  mps_edit x;
  mps_status status = mps_particles_edit(m->water, "position", &x);
  if (status != MPS_OK) return status;
  for (int64_t i = 0; i < x.view.shape[0]; i++) {
    double *to[2] = {mps_edit_f64(&x, i, 0), mps_edit_f64(&x, i, 1)}, at[2] = {*to[0], *to[1]};
    if (keep_clear(m, at)) *to[0] = at[0], *to[1] = at[1];
  }
  return mps_particles_commit(m->water, &x);
}

mps_status flume_fill(const flume *m, mps_particles *water, bool *cut) {
  const double l0 = m->s.spacing;
  const double area = m->outlet * (m->s.depth - m->cells.lower + 2.0 * l0) / (l0 * l0);
  filling f = {.m = m, .room = 2 * (int64_t)area + 1000, .state = (uint64_t)m->s.seed};
  f.x = malloc(2 * (size_t)f.room * sizeof *f.x);
  if (!f.x) return MPS_ERROR_MEMORY;
  fill_water(&f);
  for (int k = 0; k < m->shape.rocks; k++) fill_rock(&f, k);
  const mps_status status = f.full ? MPS_ERROR_MEMORY : mps_particles_append(water, f.count, f.x);
  free(f.x);
  *cut = f.cut;
  return status;
}
