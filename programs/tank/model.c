/* model.c - the water of mps-tank, its walls, and a run that samples forces and levels.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include "common/frame.h"

#include <mps/experimental/papers.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define CLASSICAL_SHARE 0.2 /* of the density error, corrected in each step */

/* ---- water ----------------------------------------------------------------------------------- */

/* First mode of sloshing: a particle of the lattice where linear theory has it. */
static void displace(const tank_settings *s, double *x) {
  const double k = WAVES_PI / s->length, at = x[0], y = x[1], a = s->amplitude;
  x[0] -= a * sin(k * at) * cosh(k * y) / sinh(k * s->depth);
  x[1] += a * cos(k * at) * sinh(k * y) / sinh(k * s->depth);
}

static mps_status fill_tank(const tank_settings *s, mps_particles *water) {
  const int64_t columns = llround(s->length / s->spacing), rows = llround(s->depth / s->spacing);
  double *x = malloc((size_t)(columns * rows) * 2 * sizeof *x);
  int64_t count = 0;
  uint64_t state = 1;
  if (!x) return MPS_ERROR_MEMORY;
  for (int64_t j = 0; j < rows; j++)
    for (int64_t i = 0; i < columns; i++) {
      double *at = x + 2 * count;
      at[0] = ((double)i + 0.5) * s->spacing, at[1] = ((double)j + 0.5) * s->spacing;
      if (tank_in_box(s, at[0], at[1])) continue;
      count++;
      if (s->kind == TANK_SLOSHING) displace(s, at);
      for (int c = 0; c < 2; c++) at[c] += s->disturb * s->spacing * waves_noise(&state);
    }
  const mps_status status = mps_particles_append(water, count, x);
  free(x);
  return status;
}

/* A disc whose velocity is (-x, y)/s. */
static mps_status fill_drop(const tank_settings *s, mps_particles *water) {
  const double middle[2] = {0.0, 0.0};
  mps_view x;
  mps_edit u;
  mps_status status = mps_particles_fill_ball(water, middle, s->depth, NULL);
  if (status == MPS_OK && s->disturb > 0.0)
    status = waves_disturb(water, s->disturb * s->spacing, 1);
  if (status == MPS_OK) status = mps_particles_add_field(water, "velocity", 0);
  if (status == MPS_OK) status = mps_particles_view(water, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(water, "velocity", &u);
  for (int64_t i = 0; status == MPS_OK && i < x.shape[0]; i++) {
    *mps_edit_f64(&u, i, 0) = -*mps_view_f64(&x, i, 0);
    *mps_edit_f64(&u, i, 1) = *mps_view_f64(&x, i, 1);
  }
  if (status == MPS_OK) status = mps_particles_commit(water, &u);
  return status;
}

/* ---- walls ----------------------------------------------------------------------------------- */

/* A bed that bends has the structure's points. */
static mps_status add_bed(tank_model *m) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.normal[1] = 1.0;
  def.nodes = m->structure.x, def.node_count = m->structure.points;
  return mps_fluid_add_boundary(m->fluid, &def, NULL);
}

static mps_status add_walls(mps_context *context, tank_model *m) {
  const double corner[2] = {0.0, 0.0}, right[2] = {m->s.length, 0.0};
  mps_status status = MPS_OK;
  m->motion = (waves_piston){m->s.amplitude, m->s.period, m->s.ramp};
  if (m->s.kind == TANK_PISTON || m->s.kind == TANK_RESONANCE)
    status = mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, waves_move_piston,
                                    &m->motion, NULL, &m->piston);
  if (tank_is_coupled(&m->s)) status = tank_make_structure(context, m);
  status = app_settle(m->a, status);
  if (status == MPS_OK) status = add_bed(m);
  if (status == MPS_OK) status = waves_add_wall(m->fluid, corner, 1.0, 0.0, m->piston, NULL);
  if (status == MPS_OK) status = waves_add_wall(m->fluid, right, -1.0, 0.0, NULL, NULL);
  return status;
}

mps_status tank_build(app *a, tank_model *m) {
  mps_context *context = a->context;
  const tank_settings *s = &m->s;
  static const rows_column columns[] = {{"left", "N", 0},
                                        {"right", "N", 0},
                                        {"level", "m", TANK_GAUGES + 1},
                                        {"a", "m", 0},
                                        {"b", "m", 0},
                                        {"centre", "Pa", 0},
                                        {"kinetic", "J", 0},
                                        {"potential", "J", 0},
                                        {"deflection", "m", 0},
                                        {0}};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  set.spacing = s->spacing;
  def.domain = a->domain;
  def.dt = s->dt;
  def.viscosity = s->viscosity;
  def.density = WAVES_DENSITY;
  def.tolerance = s->tolerance;
  if (s->kind == TANK_DROP)
    def.gravity[1] = 0.0;
  else
    def.level = s->depth;
  mps_status status = mps_particles_create(context, &set, &m->water);
  if (status == MPS_OK)
    status = s->kind == TANK_DROP ? fill_drop(s, m->water) : fill_tank(s, m->water);
  status = app_settle(a, status);
  if (status == MPS_OK) status = mps_fluid_create(context, m->water, &def, &m->fluid);
  if (status == MPS_OK && s->scheme == 1)
    status = mps_experimental_fluid_classical(m->fluid, CLASSICAL_SHARE);
  if (status == MPS_OK && !waves_choose_solver(a, s->solver, m->fluid, m->why, sizeof m->why))
    return MPS_ERROR_UNSUPPORTED;
  if (status == MPS_OK && s->kind != TANK_DROP) status = add_walls(context, m);
  if (status == MPS_OK && s->kind == TANK_FLOAT) status = tank_make_box(context, m);
  if (status == MPS_OK && s->kind == TANK_FLOAT) status = tank_launch(m);
  m->restarted = NAN;
  m->capacity = (int64_t)ceil(s->duration / s->sample - 1e-9);
  return status == MPS_OK ? rows_begin(&m->rows, mps_fluid_solver(m->fluid), columns) : status;
}

/* ---- the run --------------------------------------------------------------------------------- */

/* Semi-axes from the second moments, and the pressure of the particles in the middle. */
static mps_status measure_drop(tank_model *m, tank_sample *sample) {
  mps_view x, p;
  mps_status status = mps_particles_view(m->water, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(m->water, "pressure", &p);
  if (status != MPS_OK) return status;
  double sum[2] = {0.0, 0.0}, pressure = 0.0;
  int64_t middle = 0;
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const double at[2] = {*mps_view_f64(&x, i, 0), *mps_view_f64(&x, i, 1)};
    for (int c = 0; c < 2; c++) sum[c] += at[c] * at[c];
    if (hypot(at[0], at[1]) > 3.0 * m->s.spacing) continue;
    pressure += *mps_view_f64(&p, i, 0);
    middle++;
  }
  const double n = (double)x.shape[0];
  sample->a = 2.0 * sqrt(sum[0] / n), sample->b = 2.0 * sqrt(sum[1] / n);
  sample->centre = middle ? pressure / (double)middle : 0.0;
  return MPS_OK;
}

static mps_status measure_tank(tank_model *m, tank_sample *sample) {
  const tank_settings *s = &m->s;
  mps_reaction left, right;
  double station[TANK_GAUGES + 1];
  for (int k = 0; k < TANK_GAUGES; k++) station[k] = isnan(s->gauge[k]) ? 0.0 : s->gauge[k];
  station[TANK_GAUGES] = s->length - s->spacing;
  mps_status status = mps_fluid_get_reaction(m->fluid, TANK_LEFT, &left);
  if (status == MPS_OK) status = mps_fluid_get_reaction(m->fluid, TANK_RIGHT, &right);
  if (status == MPS_OK)
    status = mps_fluid_get_levels(m->fluid, TANK_GAUGES + 1, station, sample->level);
  if (status != MPS_OK) return status;
  for (int k = 0; k <= TANK_GAUGES; k++) sample->level[k] -= s->depth;
  sample->deflection = tank_is_coupled(s) ? tank_deflection(m) : 0.0;
  if (s->kind == TANK_FLOAT) {
    mps_body_state box;
    status = mps_body_get_state(m->box, &box);
    if (status != MPS_OK) return status;
    sample->deflection = box.position[1] - s->depth;
    m->roll = fmax(m->roll, fabs(box.rotation[2]));
  }
  sample->left = left.force[0]; /* opposite forces on walls and water */
  sample->right = -right.force[0];
  return MPS_OK;
}

void tank_look(tank_model *m) {
  rows_look(&m->rows);
  m->sample = m->rows.row, m->samples = m->rows.count;
}

static mps_status take_sample(tank_model *m) {
  tank_sample sample = {.t = mps_fluid_time(m->fluid)};
  mps_totals sum;
  mps_status status = m->s.kind == TANK_DROP ? measure_drop(m, &sample) : measure_tank(m, &sample);
  if (status == MPS_OK) status = mps_fluid_get_totals(m->fluid, &sum);
  if (status == MPS_OK) status = mps_fluid_get_report(m->fluid, &m->report);
  if (status != MPS_OK) return status;
  sample.kinetic = sum.kinetic, sample.potential = sum.strain;
  status = rows_add(&m->rows, &sample);
  tank_look(m);
  return status;
}

/* Frames are spread over the samples; the first is the start. */
static mps_status write_frame(tank_model *m, int64_t k, int64_t count) {
  if (!frame_is_due(k, count, m->s.frames)) return MPS_OK;
  mps_status status = MPS_OK;
  if (m->a->rank == 0 && !m->series) /* with the first frame: a series without one is none */
    status = frame_series(m->a, m->water, m->s.out, "water", m->restarted, &m->series);
  if (status == MPS_OK && m->series)
    status = mps_recorder_write(m->series, mps_fluid_time(m->fluid));
  return app_settle(m->a, status);
}

/* Samples are taken after the first step that reaches their time: no step is shortened for them. */
mps_status tank_run(app *a, tank_model *m) {
  const tank_settings *s = &m->s;
  const int64_t count = m->capacity;
  mps_status status = isnan(m->restarted) ? write_frame(m, 0, count) : MPS_OK;
  for (int64_t k = m->samples + 1; k <= count && status == MPS_OK; k++) {
    const double t = fmin((double)k * s->sample, s->duration) * (1.0 - 1e-9);
    while (status == MPS_OK && mps_fluid_time(m->fluid) < t) {
      status = tank_is_coupled(s) ? tank_coupled_step(m) : mps_fluid_step(m->fluid, 1);
      char text[64];
      snprintf(text, sizeof text, "t = %.3f s", mps_fluid_time(m->fluid));
      progress_draw(&a->bar, mps_fluid_time(m->fluid) / s->duration, text);
    }
    if (status == MPS_OK) status = take_sample(m);
    if (status == MPS_OK) status = write_frame(m, k, count);
    if (status == MPS_OK) resume_save_when_due(a, &m->saves, mps_fluid_time(m->fluid));
  }
  if (status == MPS_ERROR_CANCELLED) resume_save_now(a, &m->saves);
  return status;
}

void tank_free(tank_model *m) {
  mps_recorder_destroy(&m->series);
  tank_free_structure(&m->structure);
  mps_fluid_destroy(&m->fluid);
  mps_body_destroy(&m->box);
  mps_signal_destroy(&m->piston);
  mps_particles_destroy(&m->water);
  rows_end(&m->rows);
  free(m->linear);
}
