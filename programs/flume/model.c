/* model.c - the flume: water, ground, maker, a caisson on rock, and at the other end a piston, a
 * wall or the open side over which water that has passed the crest leaves.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <mps/experimental/fluid_rock.h>
#include <mps/experimental/waves.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FOLLOWED 30 /* rows: half a period by default */

#define REST_STEPS 300
#define REST_SPEED 0.05 /* of g dt: the fastest particle of water at rest */

/* ---- boundaries ------------------------------------------------------------------------------ */

static mps_status add_line(const flume *m, int count, const double (*point)[2], bool closed) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  double xy[2 * FLUME_POINTS + 5][3] = {{0.0}};
  for (int k = 0; k < count + closed; k++) memcpy(xy[k], point[k % count], sizeof point[0]);
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.corners = xy[0], def.corner_count = count + closed;
  def.friction_factor = m->s.roughness;
  return mps_fluid_add_boundary(m->fluid, &def, NULL);
}

/* A plane where nothing stands on it and it has no corners. */
static mps_status add_bed(const flume *m) {
  mps_fluid_boundary_def plane = mps_fluid_boundary_defaults();
  if (flume_has_structure(m) || m->shape.bed > 0) return add_line(m, m->grounds, m->ground, false);
  plane.kind = MPS_BOUNDARY_ROLLER; /* slip */
  plane.normal[1] = 1.0;
  plane.friction_factor = m->s.roughness;
  return mps_fluid_add_boundary(m->fluid, &plane, NULL);
}

static mps_status add_rock(const flume *m, const flume_rock *r) {
  mps_fluid_rock_def def = mps_fluid_rock_defaults();
  double xy[FLUME_POINTS][3] = {{0.0}};
  for (int k = 0; k < r->corners; k++) memcpy(xy[k], r->corner[k], sizeof r->corner[k]);
  def.corners = xy[0], def.corner_count = r->corners;
  def.porosity = r->porosity, def.diameter = r->diameter;
  def.alpha = r->alpha, def.beta = r->beta, def.KC = r->KC, def.gamma = r->gamma;
  return mps_fluid_add_rock(m->fluid, &def, NULL);
}

/* The far end: a wall that may be a piston, or the side over which water leaves. */
static mps_status add_end(const flume *m) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = flume_is_open(m) ? MPS_BOUNDARY_OPEN : MPS_BOUNDARY_ROLLER;
  def.point[0] = m->outlet;
  def.normal[0] = -1.0;
  return mps_fluid_add_boundary(m->fluid, &def, NULL);
}

static mps_status add_zone(const flume *m) {
  mps_fluid_load_def def = mps_fluid_load_defaults();
  def.kind = MPS_FLUID_LOAD_DAMPING;
  def.lower[0] = m->outlet - m->s.zone * m->wave_length, def.upper[0] = m->outlet;
  def.rise = 1;
  def.rate = m->s.rate / m->s.period;
  return mps_fluid_add_load(m->fluid, &def, NULL);
}

static mps_status add_boundaries(const flume *m) {
  const double corner[2] = {0.0, 0.0};
  mps_status status = add_bed(m);
  if (status == MPS_OK) status = waves_add_wall(m->fluid, corner, 1.0, 0.0, NULL, NULL);
  if (status == MPS_OK) status = add_end(m);
  if (status == MPS_OK && flume_has_body(m))
    status = add_line(m, m->shape.body, m->shape.body_point, true);
  for (int k = 0; k < m->shape.rocks && status == MPS_OK; k++)
    status = add_rock(m, &m->shape.rock[k]);
  if (status == MPS_OK && m->s.absorb == FLUME_ZONE) status = add_zone(m);
  return status;
}

/* ---- the flume ------------------------------------------------------------------------------- */

static mps_status make_fluid(app *a, flume *m) {
  mps_fluid_def def = mps_fluid_defaults();
  def.domain = a->domain;
  def.density = WAVES_DENSITY, def.level = m->s.depth;
  def.tolerance = m->s.tolerance;
  mps_status status = mps_fluid_create(a->context, m->water, &def, &m->fluid);
  if (status == MPS_OK && !waves_choose_solver(a, m->s.solver, m->fluid, m->why, sizeof m->why))
    return MPS_ERROR_UNSUPPORTED;
  return status == MPS_OK ? add_boundaries(m) : status;
}

/* Water that a lattice fills is at rest between walls along its rows and columns. Beside a slope it
 * falls by a part of a spacing, stops at once, and strikes it with three times the force at rest.
 * So it comes to rest first, without speed from one step to the next: each step then moves it by at
 * most g dt^2, a hundredth of a spacing. */
static mps_status bring_to_rest(app *a, flume *m) {
  mps_status status = make_fluid(a, m);
  double fastest = INFINITY;
  for (int k = 0; status == MPS_OK && k < REST_STEPS && fastest > REST_SPEED; k++) {
    mps_view v;
    const double fall = WAVES_G * mps_fluid_dt(m->fluid);
    status = mps_fluid_step(m->fluid, 1);
    if (status == MPS_OK) status = mps_particles_view(m->water, "velocity", &v);
    fastest = 0.0;
    for (int64_t i = 0; status == MPS_OK && i < v.shape[0]; i++)
      fastest = fmax(fastest, hypot(*mps_view_f64(&v, i, 0), *mps_view_f64(&v, i, 1)) / fall);
    for (int c = 0; c < 2 && status == MPS_OK; c++)
      status = mps_particles_set(m->water, "velocity", c, 0.0);
  }
  mps_fluid_destroy(&m->fluid);
  return status == MPS_OK ? flume_clear_faces(m) : status;
}

static mps_status make_water(app *a, flume *m) {
  mps_particles_def set = mps_particles_defaults();
  set.spacing = m->s.spacing;
  mps_status status = mps_particles_create(a->context, &set, &m->water);
  bool cut = false;
  if (status == MPS_OK) status = flume_fill(m, m->water, &cut);
  status = app_settle(a, status);
  if (status == MPS_OK && cut && !m->s.restart) status = bring_to_rest(a, m);
  return status == MPS_OK ? make_fluid(a, m) : status;
}

/* Room for the water at the largest force and for the frames of the animation. */
static bool make_looks(flume *m) {
  const int64_t room = m->water ? mps_particles_count(m->water) : 1;
  m->frame_room = m->s.animation;
  m->frame = calloc((size_t)m->frame_room + 1, sizeof *m->frame);
  m->look = (flume_look){.force = -INFINITY, .room = room};
  m->look.value = calloc(3 * (size_t)room, sizeof *m->look.value);
  bool good = m->frame && m->look.value;
  for (int64_t k = 0; good && k < m->frame_room; k++) {
    m->frame[k].room = room;
    m->frame[k].value = calloc(3 * (size_t)room, sizeof *m->frame[k].value);
    good = m->frame[k].value != NULL;
  }
  return good;
}

void flume_rows(flume *m) {
  rows_look(&m->rows);
  m->sample = m->rows.row, m->samples = m->rows.count;
}

mps_status flume_build(app *a, flume *m) {
  static const rows_column columns[] = {{"maker", "m", 0},
                                        {"end", "m", 0},
                                        {"level", "m", FLUME_GAUGES},
                                        {"force", "N", 0},
                                        {"moment", "N m", 0},
                                        {"uplift", "N", 0},
                                        {"uplift_moment", "N m", 0},
                                        {"foot", "Pa", 0},
                                        {"volume", "m2", 0},
                                        {"returned", "m2", 0},
                                        {"water", "m2", 0},
                                        {"head", "m", 0},
                                        {"run_up", "m", 0},
                                        {"resolved", "m", 0},
                                        {"layer", "m", 0},
                                        {"probe", "Pa", FLUME_PROBES},
                                        {0}};
  mps_status status = flume_make_pistons(a, m);
  if (status == MPS_OK) status = make_water(a, m);
  m->restarted = NAN;
  m->capacity = (int64_t)ceil(m->s.duration / m->s.sample - 1e-9);
  flume_find_rest(m);
  if (status == MPS_OK && flume_is_open(m)) m->filled = flume_count_water(m);
  if (status == MPS_OK) status = rows_begin(&m->rows, mps_fluid_solver(m->fluid), columns);
  if (status == MPS_OK) status = rows_follow(&m->rows, m->s.out, "history.csv", FOLLOWED);
  return status == MPS_OK && !make_looks(m) ? MPS_ERROR_MEMORY : status;
}

void flume_free(flume *m) {
  mps_recorder_destroy(&m->series);
  mps_fluid_destroy(&m->fluid);
  mps_particles_destroy(&m->water);
  mps_absorber_destroy(&m->maker);
  mps_absorber_destroy(&m->end);
  mps_waves_destroy(&m->waves);
  mps_signal_destroy(&m->record);
  document_free(m->text);
  for (int64_t k = 0; m->frame && k < m->frame_room; k++) free(m->frame[k].value);
  free(m->frame);
  rows_end(&m->rows);
  free(m->look.value);
  free(m->look.face);
  free(m->cells.wet);
}
