/* run.c - the run: both pistons are advanced before each step by the level at their face; levels,
 * force and what has passed the crest are sampled.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/frame.h"

#include <math.h>
#include <stdio.h>

/* ---- pistons --------------------------------------------------------------------------------- */

static mps_status move_piston(flume *m, mps_absorber *piston, int32_t wall, double face, double dt,
                              double *moved) {
  const double t = mps_fluid_time(m->fluid);
  double level, u;
  mps_status status = mps_fluid_get_levels(m->fluid, 1, &face, &level);
  if (status == MPS_OK) status = mps_absorber_advance(piston, t, dt, level - m->s.depth, moved, &u);
  return status == MPS_OK ? mps_fluid_set_wall_motion(m->fluid, wall, moved, &u) : status;
}

static double place_of(const mps_absorber *piston) {
  mps_absorber_report r = {.displacement = 0.0};
  return piston && mps_absorber_get_report(piston, &r) == MPS_OK ? r.displacement : 0.0;
}

/* The maker without absorption moves as it is asked to. */
static mps_status move_maker(flume *m, double dt) {
  const double t = mps_fluid_time(m->fluid) + dt;
  double s, u;
  if (m->maker)
    return move_piston(m, m->maker, FLUME_MAKER, place_of(m->maker) + 0.5 * m->s.spacing, dt, &s);
  const mps_status status = mps_waves_get_piston(m->waves, 1, &t, &s, &u, NULL, NULL);
  return status == MPS_OK ? mps_fluid_set_wall_motion(m->fluid, FLUME_MAKER, &s, &u) : status;
}

static mps_status keep_memory(const mps_absorber *piston, double *memory) {
  return piston ? mps_absorber_get_memory(piston, memory) : MPS_OK;
}

static mps_status make_step(flume *m) {
  const double dt = mps_fluid_dt(m->fluid);
  double s;
  mps_status status = move_maker(m, dt);
  if (status == MPS_OK && m->end)
    status = move_piston(m, m->end, FLUME_END, m->s.length - place_of(m->end) - 0.5 * m->s.spacing,
                         dt, &s);
  if (status == MPS_OK) status = mps_fluid_begin_step(m->fluid, dt);
  if (status == MPS_OK) status = mps_fluid_solve_pressure(m->fluid);
  return status == MPS_OK ? mps_fluid_end_step(m->fluid) : status;
}

/* Where a step is not made, as after Ctrl-C, the pistons are those before it: the checkpoint's. */
static mps_status step(flume *m) {
  double maker[MPS_ABSORBER_MEMORY], end[MPS_ABSORBER_MEMORY];
  mps_status status = keep_memory(m->maker, maker);
  if (status == MPS_OK) status = keep_memory(m->end, end);
  if (status == MPS_OK) status = make_step(m);
  if (status != MPS_OK && m->maker && mps_absorber_set_memory(m->maker, maker) != MPS_OK)
    return MPS_ERROR_STATE;
  if (status != MPS_OK && m->end && mps_absorber_set_memory(m->end, end) != MPS_OK)
    return MPS_ERROR_STATE;
  return status;
}

/* ---- samples --------------------------------------------------------------------------------- */

/* Water behind the crest, and what has left over the open side. A film that stays on the crest has
 * not passed it. */
static mps_status measure_passed(flume *m, flume_sample *sample) {
  mps_reaction side;
  mps_view x;
  int64_t behind = 0;
  mps_status status = mps_fluid_get_reaction(m->fluid, FLUME_END, &side);
  if (status == MPS_OK) status = mps_particles_view(m->water, "position", &x);
  if (status != MPS_OK) return status;
  for (int64_t i = 0; i < x.shape[0]; i++) behind += *mps_view_f64(&x, i, 0) > m->heel;
  sample->volume = side.removed_mass / WAVES_DENSITY + (double)behind * m->s.spacing * m->s.spacing;
  return MPS_OK;
}

/* Towards the lee, and about the heel: a moment that tips it over is positive. The first and the
 * last segment are the bed. */
static mps_status measure_structure(const flume *m, flume_sample *sample) {
  enum { MOST = FLUME_POINTS + 3 };
  double force[3 * MOST], moment[MOST];
  int64_t count;
  const mps_status status =
      mps_fluid_get_segments(m->fluid, FLUME_BED, MOST, &count, force, moment);
  for (int64_t k = 1; status == MPS_OK && k + 1 < count; k++) { /* on the water */
    sample->force -= force[3 * k];
    sample->moment += moment[k] - m->heel * force[3 * k + 1];
  }
  return status;
}

static mps_status measure_force(flume *m, flume_sample *sample) {
  const double foot[3] = {m->s.length - 0.5 * m->s.spacing, 0.0, 0.0};
  mps_reaction r;
  mps_status status = mps_fluid_get_pressure(m->fluid, FLUME_BED, 1, foot, &sample->foot);
  if (status != MPS_OK || flume_has_body(&m->s))
    return status == MPS_OK ? measure_structure(m, sample) : status;
  status = mps_fluid_get_reaction(m->fluid, FLUME_END, &r);
  if (status == MPS_OK) /* opposite forces on wall and water */
    sample->force = -r.force[0], sample->moment = r.moment[2];
  return status;
}

/* Keeps the water of the largest force once the maker has its amplitude, without a structure that
 * of the last sample. */
static mps_status take_look(flume *m, const flume_sample *sample) {
  mps_view x, p;
  const bool most = sample->t >= m->s.ramp && sample->force > m->look.force;
  if (m->s.wall != FLUME_OPEN_END && m->look.count > 0 && !most) return MPS_OK;
  mps_status status = mps_particles_view(m->water, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(m->water, "pressure", &p);
  if (status != MPS_OK) return status;
  m->look.t = sample->t;
  m->look.force = sample->t >= m->s.ramp ? sample->force : -INFINITY;
  m->look.count = x.shape[0] < m->look.room ? x.shape[0] : m->look.room;
  for (int64_t i = 0; i < m->look.count; i++) {
    for (int c = 0; c < 2; c++) m->look.value[3 * i + c] = (float)*mps_view_f64(&x, i, c);
    m->look.value[3 * i + 2] = (float)*mps_view_f64(&p, i, 0);
  }
  return MPS_OK;
}

static mps_status take_sample(flume *m) {
  flume_sample sample = {.t = mps_fluid_time(m->fluid)};
  mps_status status = mps_fluid_get_levels(m->fluid, m->gauges, m->s.gauge, sample.level);
  for (int k = 0; k < m->gauges; k++) sample.level[k] -= m->s.depth;
  if (status == MPS_OK && m->s.wall != FLUME_OPEN_END) status = measure_force(m, &sample);
  if (status == MPS_OK && flume_has_body(&m->s)) status = measure_passed(m, &sample);
  if (status == MPS_OK && !m->maker)
    status = mps_waves_get_piston(m->waves, 1, &sample.t, &sample.maker, NULL, NULL, NULL);
  if (status == MPS_OK) status = mps_fluid_get_report(m->fluid, &m->report);
  if (status != MPS_OK) return status;
  if (m->maker) sample.maker = place_of(m->maker);
  sample.end = place_of(m->end);
  m->sample[m->samples++] = sample;
  return take_look(m, &sample);
}

/* Frames are spread over the samples; the first is the start. */
static mps_status write_frame(flume *m, int64_t k) {
  if (!frame_is_due(k, m->capacity, m->s.frames)) return MPS_OK;
  mps_status status = MPS_OK;
  if (m->a->rank == 0 && !m->series) /* with the first frame: a series without one is none */
    status = frame_series(m->a, m->water, m->s.out, "water", m->restarted, &m->series);
  if (status == MPS_OK && m->series)
    status = mps_recorder_write(m->series, mps_fluid_time(m->fluid));
  return app_settle(m->a, status);
}

/* The last two samples may fall into one step. */
static bool is_new(const flume *m) {
  return m->samples == 0 || mps_fluid_time(m->fluid) > m->sample[m->samples - 1].t;
}

/* Samples are taken after the first step that reaches their time: no step is shortened for them. */
mps_status flume_run(app *a, flume *m) {
  const flume_settings *s = &m->s;
  mps_status status = isnan(m->restarted) ? write_frame(m, 0) : MPS_OK;
  for (int64_t k = m->samples + 1; k <= m->capacity && status == MPS_OK; k++) {
    const double t = fmin((double)k * s->sample, s->duration) * (1.0 - 1e-9);
    while (status == MPS_OK && mps_fluid_time(m->fluid) < t) {
      char text[64];
      status = step(m);
      snprintf(text, sizeof text, "t = %.2f s", mps_fluid_time(m->fluid));
      progress_draw(&a->bar, mps_fluid_time(m->fluid) / s->duration, text);
    }
    if (status == MPS_OK && is_new(m)) status = take_sample(m);
    if (status == MPS_OK) status = write_frame(m, k);
    if (status == MPS_OK) resume_save_when_due(a, &m->saves, mps_fluid_time(m->fluid));
  }
  if (status == MPS_ERROR_CANCELLED) resume_save_now(a, &m->saves);
  return status;
}
