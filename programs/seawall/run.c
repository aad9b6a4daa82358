/* run.c - waves against the wall: at every sample the pressures of the water are applied to the
 * facets of the structure, which is solved with the kept factor; or both are coupled.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include "common/frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- a moment -------------------------------------------------------------------------------- */

static mps_status bend_wall(seawall *w, double *deflection) {
  const strip *wall = &w->wall;
  const double edge = 0.25 * w->s.spacing;
  const double lower[2] = {-INFINITY, wall->def.upper[1] - edge}, upper[2] = {INFINITY, INFINITY};
  mps_status status = MPS_OK;
  if (!w->s.coupled) {
    status = mps_fluid_get_pressure(w->fluid, SEAWALL_WALL, wall->count, wall->centre, w->pressure);
    if (status == MPS_OK) status = strip_load(&w->wall, w->pressure);
    if (status == MPS_OK) status = mps_elastic_solve(wall->solver);
  }
  return status == MPS_OK ? strip_displacement(&w->wall, lower, upper, 0, deflection) : status;
}

static mps_status take_look(seawall *w, const seawall_sample *sample) {
  seawall_look *look = &w->look;
  double *x = malloc(3 * (size_t)w->room * sizeof *x);
  mps_view u;
  mps_status status = app_settle(w->a, x ? MPS_OK : MPS_ERROR_MEMORY);
  if (status == MPS_OK)
    status = mps_fluid_get_boundary_points(w->fluid, SEAWALL_WALL, w->room, &look->points, x,
                                           look->pressure);
  if (look->points > w->room) look->points = w->room;
  for (int64_t k = 0; status == MPS_OK && k < look->points; k++) look->y[k] = x[3 * k + 1];
  if (status == MPS_OK) status = mps_particles_view(w->wall.set, "displacement", &u);
  for (int64_t i = 0; status == MPS_OK && i < u.shape[0]; i++)
    for (int c = 0; c < 2; c++) look->displacement[2 * i + c] = *mps_view_f64(&u, i, c);
  look->at = *sample;
  free(x);
  return status;
}

/* The classical scheme has no levels: that of as much water as there is in the last columns. */
static mps_status find_level(const seawall *w, double station, double *level) {
  mps_view x;
  int64_t count = 0;
  if (w->s.method == 0) return mps_fluid_get_levels(w->fluid, 1, &station, level);
  const mps_status status = mps_particles_view(w->water, "position", &x);
  for (int64_t i = 0; status == MPS_OK && i < x.shape[0]; i++)
    count += *mps_view_f64(&x, i, 0) > w->s.length - SEAWALL_COLUMNS * w->s.spacing;
  *level = (double)count * w->s.spacing / SEAWALL_COLUMNS;
  return status;
}

static mps_status take_sample(seawall *w) {
  const double station = w->s.length - w->s.spacing;
  seawall_sample sample = {.t = mps_fluid_time(w->fluid)};
  double motion[3];
  mps_reaction r;
  mps_status status = mps_fluid_get_reaction(w->fluid, SEAWALL_WALL, &r);
  if (status == MPS_OK) status = find_level(w, station, &sample.level);
  if (status == MPS_OK) status = waves_move_piston(&w->motion, sample.t, motion);
  if (status == MPS_OK) status = bend_wall(w, &sample.deflection);
  if (status != MPS_OK) return status;
  sample.force = -r.force[0]; /* opposite forces on wall and water */
  sample.moment = r.moment[2];
  sample.level -= w->s.depth;
  sample.piston = motion[0];
  status = rows_add(&w->rows, &sample);
  seawall_rows(w);
  if (status != MPS_OK || sample.t > SEAWALL_LOOK + 0.5 * w->s.sample) return status;
  return take_look(w, &sample);
}

/* ---- frames ---------------------------------------------------------------------------------- */

static mps_status take_frame(seawall *w) {
  seawall_frame *f = &w->frame[w->frames];
  double motion[3];
  mps_view x, p;
  mps_status status = mps_particles_view(w->water, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(w->water, "pressure", &p);
  f->t = mps_fluid_time(w->fluid);
  if (status == MPS_OK) status = waves_move_piston(&w->motion, f->t, motion);
  if (status != MPS_OK) return status;
  f->piston = motion[0];
  f->count = x.shape[0];
  f->value = malloc(3 * (size_t)f->count * sizeof *f->value);
  status = app_settle(w->a, f->value ? MPS_OK : MPS_ERROR_MEMORY);
  if (status != MPS_OK) return status;
  for (int64_t i = 0; i < f->count; i++) {
    float *at = f->value + 3 * i;
    for (int c = 0; c < 2; c++) at[c] = (float)*mps_view_f64(&x, i, c);
    at[2] = (float)*mps_view_f64(&p, i, 0);
    if (mps_fluid_steps(w->fluid) == 0) /* nothing is solved yet: at rest */
      at[2] = (float)(WAVES_DENSITY * WAVES_G * (w->s.depth - (double)at[1]));
  }
  w->frames++;
  if (w->a->rank == 0 && !w->series) /* with the first frame: a series without one is none */
    status = frame_series(w->a, w->water, w->s.out, "water", w->restarted, &w->series);
  if (status == MPS_OK && w->a->rank == 0 && !w->wall_series)
    status = frame_series(w->a, w->wall.set, w->s.out, "wall", w->restarted, &w->wall_series);
  if (status == MPS_OK && w->series) status = mps_recorder_write(w->series, f->t);
  if (status == MPS_OK && w->wall_series) status = mps_recorder_write(w->wall_series, f->t);
  return app_settle(w->a, status);
}

/* Frames are spread over the samples; the first is the start. */
static bool is_due(const seawall *w, int64_t k) {
  return frame_is_due(k, w->capacity, w->s.frames);
}

/* ---- the run --------------------------------------------------------------------------------- */

static mps_status note_force(seawall *w) {
  mps_reaction r;
  const mps_status status = mps_fluid_get_reaction(w->fluid, SEAWALL_WALL, &r);
  if (status == MPS_OK && w->forces < w->steps) w->force[w->forces++] = -r.force[0];
  return status;
}

double seawall_smooth(const seawall *w, int64_t k) {
  const int64_t half = (int64_t)(0.5 * SEAWALL_WINDOW / w->s.dt);
  double sum = 0.0, whole = 0.0;
  const int64_t first = k - half > 0 ? k - half : 0;
  const int64_t last = k + half < w->forces - 1 ? k + half : w->forces - 1;
  for (int64_t i = first; i <= last; i++) {
    const double weight = 1.0 + cos(WAVES_PI * (double)(i - k) / (double)(half + 1));
    sum += weight * w->force[i], whole += weight;
  }
  return sum / whole;
}

static mps_status advance(app *a, seawall *w, double t) {
  mps_status status = MPS_OK;
  while (status == MPS_OK && mps_fluid_time(w->fluid) < t) {
    status = w->s.coupled ? seawall_coupled_step(w) : mps_fluid_step(w->fluid, 1);
    if (status == MPS_OK) status = note_force(w);
    char text[64];
    snprintf(text, sizeof text, "t = %.3f s", mps_fluid_time(w->fluid));
    progress_draw(&a->bar, mps_fluid_time(w->fluid) / w->s.duration, text);
  }
  return status;
}

/* Samples are those after the first step that reaches their time: no step is shortened for them, so
 * that a restarted run is the same as an uninterrupted one. */
mps_status seawall_run(app *a, seawall *w) {
  const seawall_settings *s = &w->s;
  mps_status status = isnan(w->restarted) && is_due(w, 0) ? take_frame(w) : MPS_OK;
  for (int64_t k = w->samples + 1; k <= w->capacity && status == MPS_OK; k++) {
    status = advance(a, w, fmin((double)k * s->sample, s->duration) * (1.0 - 1e-9));
    if (status == MPS_OK) status = take_sample(w);
    if (status == MPS_OK && is_due(w, k)) status = take_frame(w);
    if (status == MPS_OK) resume_save_when_due(a, &w->saves, mps_fluid_time(w->fluid));
  }
  if (status == MPS_ERROR_CANCELLED) resume_save_now(a, &w->saves);
  return status;
}
