/* run.c - the run: both pistons are advanced before each step by the level at their face; levels,
 * force and what has passed the crest are sampled.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/frame.h"

#include <mps/experimental/fluid_parts.h>
#include <math.h>
#include <stdio.h>

#define SLOPE_FROM 2.5  /* spacings from a piston's face, of the other end of the slope there */
#define MIDDLE 3.0      /* periods over which the mean place of a piston is taken */
#define GROUP 2.0       /* periods of a sea, of the return of two pistons */
#define LAST_STEPS 32.0 /* that are equal, and shorter, to end the run at its duration */

/* ---- pistons --------------------------------------------------------------------------------- */

/* Level (m above the water at rest) `place` m behind the face of a piston at `face`, which is its
 * middle place: eta(0) = eta(X) - X eta_x, by the theory of the piston. Mean and slow part of X
 * eta_x, of second order, would move pistons off and send long waves. `inward`: sign of x into the
 * water. */
static mps_status level_behind(const flume *m, double face, double place, double inward,
                               double *level) {
  const double near = 0.5 * m->s.spacing, far = SLOPE_FROM * m->s.spacing;
  const double at[2] = {face + inward * near, face + inward * far};
  double eta[2];
  const mps_status status = mps_fluid_get_levels(m->fluid, 2, at, eta);
  const double slope = isnan(eta[1]) ? 0.0 : (eta[1] - eta[0]) / (far - near);
  const bool solitary = m->s.waves == FLUME_SOLITARY; /* its theory has the level at the face */
  *level = eta[0] - m->s.depth - (solitary ? 0.0 : place * slope);
  return status;
}

static double place_of(const mps_absorber *piston) {
  mps_absorber_report r = {.displacement = 0.0};
  return piston && mps_absorber_get_report(piston, &r) == MPS_OK ? r.displacement : 0.0;
}

static mps_status move_piston(flume *m, mps_absorber *piston, int32_t wall, double dt,
                              double *moved, double *level) {
  const bool maker = piston == m->maker;
  const double t = mps_fluid_time(m->fluid), mean = m->mean[!maker].offset, s = place_of(piston);
  double u;
  mps_status status = level_behind(m, maker ? s : m->outlet - s, s - m->mean[!maker].middle,
                                   maker ? 1.0 : -1.0, level);
  if (status == MPS_OK) status = mps_absorber_advance(piston, t, dt, *level - mean, moved, &u);
  return status == MPS_OK ? mps_fluid_set_boundary_motion(m->fluid, wall, moved, &u) : status;
}

/* A piston is given the level at its face without `offset`, so that its mean place stays. Before a
 * wall the mean level of standing waves at the face is some mm above that of the flume, and the
 * slow part of the second order that the maker is asked for is that of an infinitely long flume;
 * both change the mean level of a closed one. So the offset is the mean b at the face in a flume
 * whose piston stands at X = 0,
 *
 *   c' = (eta - X d/L - c)/tau,  b' = (c - b)/tau,
 *
 * by which slow motions are X' = -(g d)^1/2 X/L. tau is a period, or half the time that long waves
 * take through the flume, which are still absorbed. What b has of the waves, 1/(1 + (omega tau)^2)
 * of them at most .025, turns the level that the maker follows, and half of that is sent back: with
 * one filter in place of two it was .06, and incident waves 7 % too low to 5 % too high by the
 * distance of the wall. All absorb about their mean places. */
static void follow_wall(flume *m, double level, double dt) {
  flume_mean *mean = &m->mean[0];
  const double through = m->toe / sqrt(WAVES_G * m->s.depth);
  const double part = -expm1(-dt / fmax(m->s.period, 0.5 * through));
  mean->slow += part * (level - place_of(m->maker) * m->s.depth / m->toe - mean->slow);
  mean->offset += part * (mean->slow - mean->offset);
}

/* No level takes two pistons back that move together, and waves that arrive, or .1 mm of mean level
 * at one face, move them by centimetres. So each returns with the velocity v,
 *
 *   v' = -(X/(12 theta) + v)/(2 theta),
 *
 * X its place over theta, slow against waves, the groups of a sea and long waves through the flume.
 * Of the level at its face b, the mean above the asked one over theta, and what moves all of the
 * water, L/(2 g) (v_1' - v_2')/2, is not absorbed. */
static void follow_two(flume *m, const double *above, double dt) {
  const double T = m->s.period, d[2] = {m->s.depth, flume_end_depth(m)};
  const double through = m->toe / sqrt(WAVES_G * fmin(d[0], d[1]));
  const double theta = fmax((m->s.waves == FLUME_REGULAR ? 1.0 : GROUP) * T, 0.4 * through);
  mps_absorber *const piston[2] = {m->maker, m->end};
  double rate[2];
  for (int k = 0; k < 2; k++) {
    flume_mean *mean = &m->mean[k];
    mps_absorber_report r = {.displacement = 0.0};
    if (mps_absorber_get_report(piston[k], &r) != MPS_OK) return;
    mean->place += -expm1(-dt / theta) * (r.displacement - mean->place);
    rate[k] = -(mean->place / (12.0 * theta) + mean->speed) / (2.0 * theta);
    mean->speed += rate[k] * dt;
  }
  for (int k = 0; k < 2; k++) {
    flume_mean *mean = &m->mean[k];
    const double push = 0.25 * m->toe / WAVES_G * (rate[k] - rate[1 - k]);
    mean->slow += -expm1(-dt / T) * (above[k] - push - mean->slow);
    mean->level += -expm1(-dt / theta) * (mean->slow - mean->level);
    mean->offset = mean->level + push + mean->speed * sqrt(d[k] / WAVES_G);
  }
}

/* `level`: at both faces; `asked`: at the maker's. */
static void follow_means(flume *m, const double *level, double asked, double dt) {
  const double share = -expm1(-dt / (MIDDLE * m->s.period));
  const double above[2] = {level[0] - asked, level[1]};
  m->mean[0].middle += share * (place_of(m->maker) - m->mean[0].middle);
  m->mean[1].middle += share * (place_of(m->end) - m->mean[1].middle);
  if (isnan(level[0]) || isnan(level[1])) return; /* no water at a face */
  if (m->maker && m->end) follow_two(m, above, dt);
  if (m->maker && !m->end) follow_wall(m, level[0], dt);
}

double flume_maker_place(const flume *m) {
  double s = 0.0;
  const double t = mps_fluid_time(m->fluid);
  if (m->maker) return place_of(m->maker);
  return mps_waves_get_piston(m->waves, 1, &t, &s, NULL, NULL, NULL) == MPS_OK ? s : 0.0;
}

/* The maker without absorption moves as it is asked to. */
static mps_status move_maker(flume *m, double dt, double *level) {
  const double t = mps_fluid_time(m->fluid) + dt;
  double s, u;
  if (m->maker) return move_piston(m, m->maker, FLUME_MAKER, dt, &s, level);
  const mps_status status = mps_waves_get_piston(m->waves, 1, &t, &s, &u, NULL, NULL);
  return status == MPS_OK ? mps_fluid_set_boundary_motion(m->fluid, FLUME_MAKER, &s, &u) : status;
}

static mps_status keep_memory(const mps_absorber *piston, double *memory) {
  return piston ? mps_absorber_get_memory(piston, memory) : MPS_OK;
}

/* The library's limit is .1 (l0/g)^1/2, and where the water is fast a quarter of the spacing over
 * its speed. Waves keep their height with twice the first; the second holds for any flow. */
double flume_dt(const flume *m) {
  mps_view u;
  double square = 0.0, porosity = 1.0;
  const double most = 0.1 * sqrt(m->s.spacing / WAVES_G), limit = mps_fluid_limit(m->fluid);
  if (limit < most * (1.0 - 1e-9)) return fmin(limit, m->s.dt);
  if (mps_particles_view(m->water, "velocity", &u) != MPS_OK) return fmin(limit, m->s.dt);
  for (int64_t i = 0; i < u.shape[0]; i++) {
    const double x = *mps_view_f64(&u, i, 0), y = *mps_view_f64(&u, i, 1);
    square = fmax(square, x * x + y * y);
  }
  for (int k = 0; k < m->shape.rocks; k++) porosity = fmin(porosity, m->shape.rock[k].porosity);
  return fmin(m->s.dt, 0.25 * m->s.spacing * porosity / (sqrt(square) + 1e-300));
}

/* As of mps_fluid_run: the last steps, or all of fewer, are equal. */
static double step_size(const flume *m) {
  const double dt = flume_dt(m), left = m->s.duration - mps_fluid_time(m->fluid);
  const double count = ceil(left / dt * (1.0 - 1e-9));
  return count <= LAST_STEPS ? fmin(left / fmax(count, 1.0), dt) : dt;
}

static mps_status make_step(flume *m) {
  const double dt = step_size(m), t = mps_fluid_time(m->fluid);
  double s, level[2] = {0.0, 0.0}, asked = 0.0;
  mps_status status = move_maker(m, dt, &level[0]);
  if (status == MPS_OK && m->end) status = move_piston(m, m->end, FLUME_END, dt, &s, &level[1]);
  if (status == MPS_OK && m->end)
    status = mps_waves_get_piston(m->waves, 1, &t, NULL, NULL, NULL, &asked);
  if (status == MPS_OK) status = mps_fluid_begin_step(m->fluid, dt);
  if (status == MPS_OK) status = mps_fluid_solve_pressure(m->fluid);
  if (status == MPS_OK) status = mps_fluid_end_step(m->fluid);
  if (status == MPS_OK) follow_means(m, level, asked, dt);
  return status == MPS_OK ? flume_refill(m, dt) : status;
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
  const double each = m->s.spacing * m->s.spacing;
  const int64_t count = mps_particles_count(m->water), before = flume_count_water(m);
  mps_reaction side;
  const mps_status status = mps_fluid_get_reaction(m->fluid, FLUME_END, &side);
  if (status != MPS_OK) return status;
  sample->volume = side.removed_mass / WAVES_DENSITY + (double)(count - before) * each;
  sample->returned = (double)m->returned * each, sample->water = (double)before * each;
  return MPS_OK;
}

/* Keeps the water of the largest force once the maker has its amplitude, without a structure that
 * of the last sample. */
static mps_status take_look(flume *m, const flume_sample *sample) {
  const bool most = sample->t >= m->s.ramp && sample->force > m->look.force;
  if (flume_is_loaded(m) && m->look.count > 0 && !most) return MPS_OK;
  m->look.force = sample->t >= m->s.ramp ? sample->force : -INFINITY;
  return flume_look_at(m, &m->look, true);
}

/* Frames of the animation lie evenly in the last three periods. */
static mps_status take_frame(flume *m) {
  const double span = fmin(3.0 * m->s.period, m->s.duration);
  const int64_t k = m->frames, last = m->frame_room - 1;
  const double due = m->s.duration - span * (1.0 - (double)k / (double)(last > 0 ? last : 1));
  if (k > last || mps_fluid_time(m->fluid) < due * (1.0 - 1e-9)) return MPS_OK;
  m->frames++;
  return flume_look_at(m, &m->frame[k], false);
}

static mps_status take_sample(flume *m) {
  flume_sample sample = {.t = mps_fluid_time(m->fluid)};
  mps_status status = mps_fluid_get_levels(m->fluid, m->gauges, m->s.gauge, sample.level);
  for (int k = 0; k < m->gauges; k++) sample.level[k] -= m->s.depth;
  if (status == MPS_OK) status = flume_measure_loads(m, &sample);
  if (status == MPS_OK) status = flume_measure_climb(m, &sample);
  if (status == MPS_OK && flume_is_open(m)) status = measure_passed(m, &sample);
  if (status == MPS_OK) status = mps_fluid_get_report(m->fluid, &m->report);
  if (status != MPS_OK) return status;
  sample.maker = flume_maker_place(m);
  sample.end = place_of(m->end);
  status = rows_add(&m->rows, &sample);
  flume_rows(m);
  if (status == MPS_OK) status = take_frame(m);
  return status == MPS_OK ? take_look(m, &sample) : status;
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
