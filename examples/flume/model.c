/* model.c - the flume: water, bed, maker, and at the other end a piston, a wall, a caisson or a
 * dike with an open side behind, one polyline with the bed, over which the water that has passed
 * the crest leaves. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CLEAR 0.45 /* spacings between the water's particles and the face of a structure */

/* ---- the structure --------------------------------------------------------------------------- */

/* The face from the toe over the crest to its rear edge, below which it stands upright. */
static void make_face(flume *m) {
  const flume_settings *s = &m->s;
  const double high = s->depth + s->crest,
               lean = s->wall == FLUME_SLOPE ? s->cotangent * high : 0.0;
  const double simple[3][2] = {{0.0, 0.0}, {lean, high}, {lean + s->width, high}};
  const bool profile = s->wall == FLUME_PROFILE;
  m->corners = profile ? s->points : 3;
  for (int k = 0; k < m->corners; k++) {
    const double *point = profile ? s->profile[k] : simple[k];
    m->corner[k][0] = s->length + point[0], m->corner[k][1] = point[1];
  }
  m->heel = m->corner[m->corners - 1][0];
  m->outlet = m->heel + fmax(0.3, 8.0 * s->spacing);
}

/* Height (m) of the face above the bed. */
double flume_ground(const flume *m, double x) {
  double y = 0.0;
  for (int k = 0; k + 1 < m->corners; k++) {
    const double *p = m->corner[k], *q = m->corner[k + 1];
    if (x >= p[0] && x <= q[0] && q[0] > p[0])
      y = p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]);
  }
  return x <= m->heel ? y : 0.0;
}

/* Distance (m) of a point from the face. */
static double from_face(const flume *m, const double *x) {
  double least = INFINITY;
  for (int k = 0; k + 1 < m->corners; k++) {
    const double *p = m->corner[k], *q = m->corner[k + 1], e[2] = {q[0] - p[0], q[1] - p[1]};
    const double along =
        ((x[0] - p[0]) * e[0] + (x[1] - p[1]) * e[1]) / (e[0] * e[0] + e[1] * e[1]);
    const double s = fmin(fmax(along, 0.0), 1.0);
    least = fmin(least, hypot(x[0] - p[0] - s * e[0], x[1] - p[1] - s * e[1]));
  }
  return least;
}

/* Columns and rows of the spacing from the origin, up to the face of a structure. */
static mps_status fill(const flume *m, mps_particles *water) {
  const flume_settings *s = &m->s;
  const double reach = flume_has_body(s) ? m->heel : s->length;
  const int64_t columns = llround(reach / s->spacing), rows = llround(s->depth / s->spacing);
  double *x = malloc((size_t)(columns * rows) * 2 * sizeof *x);
  int64_t count = 0;
  uint64_t state = (uint64_t)s->seed;
  bool dry = false;
  if (!x) return MPS_ERROR_MEMORY;
  for (int64_t j = 0; j < rows; j++, dry = false)
    for (int64_t i = 0; i < columns; i++) {
      double *at = x + 2 * count;
      at[0] = ((double)i + 0.5) * s->spacing, at[1] = ((double)j + 0.5) * s->spacing;
      dry = dry || at[1] < flume_ground(m, at[0]) || (flume_has_body(s) && at[0] > m->heel);
      for (int c = 0; c < 2; c++) at[c] += s->disturb * s->spacing * waves_noise(&state);
      if (dry || (m->corners > 0 && from_face(m, at) < CLEAR * s->spacing)) continue;
      count++;
    }
  const mps_status status = mps_particles_append(water, count, x);
  free(x);
  return status;
}

/* Bed, face, crest, its rear and the bed behind, which continues below the open side. */
static mps_status add_ground(const flume *m) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  double xy[FLUME_POINTS + 3][3] = {{0.0}};
  int n = 1;
  for (int k = 0; k < m->corners; k++, n++) memcpy(xy[n], m->corner[k], sizeof m->corner[k]);
  xy[n++][0] = m->heel;
  xy[n++][0] = m->outlet;
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.corners = xy[0], def.corner_count = n;
  return mps_fluid_add_boundary(m->fluid, &def, NULL);
}

static mps_status add_bed(const flume *m) {
  const double corner[2] = {0.0, 0.0};
  if (flume_has_body(&m->s)) return add_ground(m);
  return waves_add_wall(m->fluid, corner, 0.0, 1.0, NULL, NULL);
}

/* ---- the flume ------------------------------------------------------------------------------- */

/* The far end: a wall that may be a piston, or the side over which water leaves. */
static mps_status add_end(flume *m) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = flume_has_body(&m->s) ? MPS_BOUNDARY_OPEN : MPS_BOUNDARY_ROLLER;
  def.point[0] = flume_has_body(&m->s) ? m->outlet : m->s.length;
  def.normal[0] = -1.0;
  return mps_fluid_add_boundary(m->fluid, &def, NULL);
}

static mps_status add_zone(flume *m) {
  mps_fluid_load_def def = mps_fluid_load_defaults();
  def.kind = MPS_FLUID_LOAD_DAMPING;
  def.lower[0] = m->s.length - m->s.zone * m->wave_length, def.upper[0] = m->s.length;
  def.side = 1;
  def.rate = m->s.rate / m->s.period;
  return mps_fluid_add_load(m->fluid, &def, NULL);
}

static mps_status make_fluid(app *a, flume *m) {
  const flume_settings *s = &m->s;
  const double corner[2] = {0.0, 0.0};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  set.spacing = s->spacing;
  def.domain = a->domain;
  def.density = WAVES_DENSITY, def.level = s->depth;
  def.tolerance = s->tolerance;
  mps_status status = mps_particles_create(a->context, &set, &m->water);
  if (status == MPS_OK) status = fill(m, m->water);
  status = app_settle(a, status);
  if (status == MPS_OK) status = mps_fluid_create(a->context, m->water, &def, &m->fluid);
  if (status == MPS_OK && !waves_choose_solver(a, s->solver, m->fluid, m->why, sizeof m->why))
    return MPS_ERROR_UNSUPPORTED;
  if (status == MPS_OK) status = add_bed(m);
  if (status == MPS_OK) status = waves_add_wall(m->fluid, corner, 1.0, 0.0, NULL, NULL);
  if (status == MPS_OK) status = add_end(m);
  if (status == MPS_OK && s->absorb == FLUME_ZONE) status = add_zone(m);
  return status;
}

mps_status flume_build(app *a, flume *m) {
  mps_status status = flume_make_pistons(a, m);
  if (flume_has_body(&m->s)) make_face(m);
  if (status == MPS_OK) status = make_fluid(a, m);
  m->restarted = NAN;
  m->capacity = (int64_t)ceil(m->s.duration / m->s.sample - 1e-9);
  m->sample = calloc((size_t)m->capacity + 1, sizeof *m->sample);
  m->look = (flume_look){.force = -INFINITY, .room = m->water ? mps_particles_count(m->water) : 1};
  m->look.value = calloc(3 * (size_t)m->look.room, sizeof *m->look.value);
  return status == MPS_OK && !(m->sample && m->look.value) ? MPS_ERROR_MEMORY : status;
}

void flume_free(flume *m) {
  mps_recorder_destroy(&m->series);
  mps_fluid_destroy(&m->fluid);
  mps_particles_destroy(&m->water);
  mps_absorber_destroy(&m->maker);
  mps_absorber_destroy(&m->end);
  mps_waves_destroy(&m->waves);
  free(m->sample);
  free(m->look.value);
}
