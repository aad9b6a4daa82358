/* model.c - the flume: water, bed, maker, and at the other end a piston, a wall, a caisson or a
 * dike with an open side behind, over which the water that has passed the crest leaves.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdlib.h>

#define CLEAR 0.45 /* spacings between the water's particles and a slope */

/* Distance (m) of a point in the water from the face of the dike. */
static double from_slope(const flume_settings *s, const double *x) {
  return (s->length - x[0] + s->cotangent * x[1]) / hypot(1.0, s->cotangent);
}

/* Columns and rows of the spacing from the origin, and over a slope up to its face. */
static mps_status fill(const flume_settings *s, mps_particles *water) {
  const double reach = s->length + (s->wall == FLUME_SLOPE ? s->cotangent * s->depth : 0.0);
  const int64_t columns = llround(reach / s->spacing), rows = llround(s->depth / s->spacing);
  double *x = malloc((size_t)(columns * rows) * 2 * sizeof *x);
  int64_t count = 0;
  uint64_t state = (uint64_t)s->seed;
  if (!x) return MPS_ERROR_MEMORY;
  for (int64_t j = 0; j < rows; j++)
    for (int64_t i = 0; i < columns; i++) {
      double *at = x + 2 * count;
      at[0] = ((double)i + 0.5) * s->spacing, at[1] = ((double)j + 0.5) * s->spacing;
      for (int c = 0; c < 2; c++) at[c] += s->disturb * s->spacing * waves_noise(&state);
      if (s->wall == FLUME_SLOPE && from_slope(s, at) < CLEAR * s->spacing) continue;
      count++;
    }
  const mps_status status = mps_particles_append(water, count, x);
  free(x);
  return status;
}

/* The outline, anticlockwise from the toe. */
static void outline(flume *m) {
  const flume_settings *s = &m->s;
  const double high = s->depth + s->crest;
  const double lean = s->wall == FLUME_SLOPE ? s->cotangent * high : 0.0;
  m->heel = s->length + lean + s->width;
  m->outlet = m->heel + fmax(0.3, 8.0 * s->spacing);
  const double corner[4][2] = {
      {s->length, 0.0}, {m->heel, 0.0}, {m->heel, high}, {s->length + lean, high}};
  m->corners = 4;
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 2; c++) m->corner[k][c] = corner[k][c];
}

static mps_status add_body(app *a, flume *m) {
  mps_body_def def = mps_body_defaults();
  mps_fluid_contact_def contact = mps_fluid_contact_defaults();
  double xy[8];
  for (int k = 0; k < 8; k++) xy[k] = m->corner[k / 2][k % 2];
  contact.kind = MPS_BOUNDARY_ROLLER; /* slip */
  mps_status status = mps_body_create_polygon(a->context, &def, m->corners, xy, &m->body);
  if (status == MPS_OK) status = mps_fluid_add_contact(m->fluid, m->body, &contact, &m->contact);
  return status;
}

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
  if (status == MPS_OK) status = fill(s, m->water);
  status = app_settle(a, status);
  if (status == MPS_OK) status = mps_fluid_create(a->context, m->water, &def, &m->fluid);
  if (status == MPS_OK && !waves_choose_solver(a, s->solver, m->fluid, m->why, sizeof m->why))
    return MPS_ERROR_UNSUPPORTED;
  if (status == MPS_OK) status = waves_add_wall(m->fluid, corner, 0.0, 1.0, NULL, NULL);
  if (status == MPS_OK) status = waves_add_wall(m->fluid, corner, 1.0, 0.0, NULL, NULL);
  if (status == MPS_OK) status = add_end(m);
  if (status == MPS_OK && flume_has_body(s)) status = add_body(a, m);
  if (status == MPS_OK && s->absorb == FLUME_ZONE) status = add_zone(m);
  return status;
}

mps_status flume_build(app *a, flume *m) {
  mps_status status = flume_make_pistons(a, m);
  if (flume_has_body(&m->s)) outline(m);
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
  mps_contact_destroy(&m->contact);
  mps_fluid_destroy(&m->fluid);
  mps_body_destroy(&m->body);
  mps_particles_destroy(&m->water);
  mps_absorber_destroy(&m->maker);
  mps_absorber_destroy(&m->end);
  mps_waves_destroy(&m->waves);
  free(m->sample);
  free(m->look.value);
}
