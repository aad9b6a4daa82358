/* model.c - the tank of mps-seawall: water, walls, and the elastic structure behind the right one.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include <mps/experimental/papers.h>

#include <math.h>
#include <stdlib.h>

int64_t seawall_paper_particles(const seawall_settings *s) {
  const int64_t columns = llround(s->length / s->spacing), rows = llround(s->depth / s->spacing);
  const int64_t thick = llround(s->wall_thickness / s->spacing);
  const int64_t high = llround(s->wall_height / s->spacing) + SEAWALL_LAYERS;
  return columns * (rows + SEAWALL_LAYERS) + (SEAWALL_LAYERS + thick) * high;
}

static mps_status make_fluid(app *a, seawall *w) {
  mps_context *context = a->context;
  const seawall_settings *s = &w->s;
  const double corner[2] = {0.0, 0.0};
  mps_fluid_def def = mps_fluid_defaults();
  def.dt = s->dt, def.level = s->depth, def.density = WAVES_DENSITY;
  def.tolerance = s->tolerance;
  w->motion = (waves_piston){s->amplitude, s->period, s->ramp};
  mps_status status = waves_fill(context, s->length, s->depth, s->spacing, &w->water);
  if (status == MPS_OK && s->disturb > 0.0)
    status = waves_disturb(w->water, s->disturb * s->spacing, (uint64_t)s->seed);
  if (status == MPS_OK)
    status = mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, waves_move_piston,
                                    &w->motion, NULL, &w->piston);
  def.domain = a->domain;
  status = app_settle(a, status);
  if (status == MPS_OK) status = mps_fluid_create(context, w->water, &def, &w->fluid);
  if (status == MPS_OK && s->method == 1)
    status = mps_experimental_fluid_classical(w->fluid, s->share);
  if (status == MPS_OK && !waves_choose_solver(a, s->solver, w->fluid, w->why, sizeof w->why))
    return MPS_ERROR_UNSUPPORTED;
  if (status == MPS_OK) status = waves_add_wall(w->fluid, corner, 0.0, 1.0, NULL, NULL);
  if (status == MPS_OK) status = waves_add_wall(w->fluid, corner, 1.0, 0.0, w->piston, NULL);
  if (status != MPS_OK) return status;
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
  wall.kind = MPS_BOUNDARY_ROLLER; /* slip */
  wall.point[0] = s->length;
  wall.normal[0] = -1.0;
  if (s->coupled) wall.nodes = w->wall.centre, wall.node_count = w->wall.count;
  return mps_fluid_add_boundary(w->fluid, &wall, NULL);
}

/* Its face is the plane of the fluid's wall; its particles begin half a spacing behind. The layer
 * at the bed is held. */
static mps_status make_wall(app *a, seawall *w) {
  const seawall_settings *s = &w->s;
  const strip_def def = {.lower = {s->length, 0.0},
                         .upper = {s->length + s->wall_thickness, s->wall_height},
                         .spacing = s->spacing,
                         .young = s->young,
                         .poisson = s->poisson,
                         .density = s->wall_density,
                         .published = s->wall_method == 1,
                         .clamped = STRIP_BOTTOM,
                         .level = STRIP_TOP,
                         .wet = STRIP_LEFT,
                         .domain = a->domain};
  mps_status status = strip_make(a->context, &def, &w->wall);
  if (status != MPS_OK) return status;
  w->pressure = calloc((size_t)w->wall.count, sizeof *w->pressure);
  return w->pressure ? MPS_OK : MPS_ERROR_MEMORY;
}

static mps_status make_records(seawall *w) {
  const seawall_settings *s = &w->s;
  const size_t n = (size_t)mps_particles_count(w->wall.set);
  w->capacity = (int64_t)ceil(s->duration / s->sample - 1e-9);
  w->room = (int64_t)ceil(16.0 * s->depth / s->spacing) + 16;
  w->frame = calloc((size_t)s->frames + 2, sizeof *w->frame);
  w->steps = (int64_t)ceil(s->duration / s->dt) + 8;
  w->force = calloc((size_t)w->steps, sizeof *w->force);
  w->look.y = calloc((size_t)w->room, sizeof(double));
  w->look.pressure = calloc((size_t)w->room, sizeof(double));
  w->look.displacement = calloc(2 * n, sizeof(double));
  w->restarted = NAN;
  return w->frame && w->force && w->look.y && w->look.pressure && w->look.displacement
             ? MPS_OK
             : MPS_ERROR_MEMORY;
}

void seawall_rows(seawall *w) {
  rows_look(&w->rows);
  w->sample = w->rows.row, w->samples = w->rows.count;
}

mps_status seawall_build(app *a, seawall *w) {
  static const rows_column columns[] = {{"force", "N", 0},  {"moment", "N m", 0},
                                        {"level", "m", 0},  {"deflection", "m", 0},
                                        {"piston", "m", 0}, {0}};
  mps_status status = app_settle(a, make_wall(a, w));
  if (status == MPS_OK) status = make_fluid(a, w);
  if (status == MPS_OK && w->s.coupled) status = seawall_couple(a->context, w);
  if (status == MPS_OK) status = rows_begin(&w->rows, mps_fluid_solver(w->fluid), columns);
  return status == MPS_OK ? make_records(w) : status;
}

void seawall_free(seawall *w) {
  mps_recorder_destroy(&w->series);
  mps_recorder_destroy(&w->wall_series);
  mps_fluid_destroy(&w->fluid);
  mps_signal_destroy(&w->piston);
  mps_particles_destroy(&w->water);
  seawall_free_coupled(&w->both);
  strip_free(&w->wall);
  for (int64_t k = 0; k < w->frames; k++) free(w->frame[k].value);
  free(w->frame);
  rows_end(&w->rows);
  free(w->force);
  free(w->linear);
  free(w->pressure);
  free(w->look.y);
  free(w->look.pressure);
  free(w->look.displacement);
}
