/* push.c - penetration of the tip: forces by part along the path, after every step a check for
 * particles inside the tip, and at the end the section through the axis.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define VOLUME_EVERY 10 /* steps */

double pen_reached(const pen_run *r) {
  return r->push.rows > 0 ? r->push.row[r->push.rows - 1].depth : 0.0;
}

/* ---- rows ------------------------------------------------------------------------------------ */

/* In the second half of the wait the force of ground at rest is read; the first row begins at its
 * end. */
static mps_status wait_for_rest(const penetrometer *p, pen_run *r, double t) {
  double up[PUSH_FORCES];
  push *now = &r->push;
  if (t < 0.5 * p->hold) return MPS_OK;
  const bool first = now->last_time == 0.0;
  if (!first && t < p->hold) return MPS_OK;
  const mps_status status = push_impulses(now, up);
  if (status != MPS_OK) return status;
  if (!first) r->rest = (up[PEN_TIP] - now->last_impulse[PEN_TIP]) / (t - now->last_time);
  for (int k = 0; k < PUSH_FORCES; k++) now->last_impulse[k] = up[k];
  now->last_time = t;
  return MPS_OK;
}

/* ---- the end --------------------------------------------------------------------------------- */

/* Particles of the section: within a spacing of y = 0. In axial symmetry also a wedge of 20
 * degrees, drawn by its distance from the axis: next to the tip the soil is stretched, and few
 * particles are in the thin slice. */
static bool in_section(const penetrometer *p, double thick, double x, double y) {
  return fabs(y) < thick || (p->s.tip != PEN_STL && fabs(y) < 0.364 * fabs(x));
}

/* Displacements, and the particles in the section. */
static mps_status look_at_section(const penetrometer *p, pen_run *r, mps_particles *set) {
  mps_view x, start, strain;
  mps_edit moved;
  const int up = pen_up(r);
  int64_t *rows = mpm_rows_by_id(set);
  mps_status status = rows ? mps_particles_add_field(set, "displacement", 0) : MPS_ERROR_MEMORY;
  if (status == MPS_OK) status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(set, "user.start", &start);
  if (status == MPS_OK) status = mps_particles_edit(set, "displacement", &moved);
  if (status != MPS_OK) {
    free(rows);
    return status;
  }
  const bool plastic = mps_particles_has_field(set, "plastic_strain") &&
                       mps_particles_view(set, "plastic_strain", &strain) == MPS_OK;
  const double thick = mps_particles_spacing(set);
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const int64_t k = rows[i];
    double square = 0.0;
    for (int c = 0; c <= up; c++) {
      const double d = *mps_view_f64(&x, k, c) - *mps_view_f64(&start, k, c);
      *mps_edit_f64(&moved, k, c) = d;
      square += d * d;
    }
    const double X = *mps_view_f64(&x, k, 0), Y = up == 2 ? *mps_view_f64(&x, k, 1) : 0.0;
    if (!in_section(p, thick, X, Y)) continue;
    const double from_axis = p->s.tip == PEN_STL ? X : copysign(hypot(X, Y), X);
    r->point[r->points++] =
        (pen_point){up == 2 ? from_axis : -X, *mps_view_f64(&x, k, up) - r->size[up], sqrt(square),
                    plastic ? *mps_view_f64(&strain, k, 0) : 0.0};
  }
  free(rows);
  status = mps_particles_commit(set, &moved);
  return status == MPS_OK ? mps_particles_remove_field(set, "user.start") : status;
}

static mps_status take_section(const penetrometer *p, pen_run *r) {
  mps_particles *whole;
  mps_status status = mpm_model_whole(&r->m, &whole);
  if (status == MPS_OK && whole) status = look_at_section(p, r, whole);
  return mpm_model_tell(&r->m, status, 0, NULL);
}

/* ---- the run --------------------------------------------------------------------------------- */

static mps_status after_step(void *user, mps_mpm *mpm) {
  penetrometer *p = user;
  pen_run *r = &p->run[p->now];
  push_row *row;
  if (progress_interrupted()) return MPS_ERROR_CANCELLED; /* the solver's own question is rarer */
  const double t = mps_mpm_time(mpm);
  mps_status status = push_look(&r->push, mps_mpm_steps(mpm) % VOLUME_EVERY == 0 || t >= p->t_end);
  if (status == MPS_OK && r->push.last_time < p->hold) return wait_for_rest(p, r, t);
  const double next = p->s.start + p->stride * (double)(r->push.rows + 1) - pen_gap(p);
  if (push_depth(&r->push) < next && t < p->t_end) return status;
  status = push_join(&r->push, status);
  if (status == MPS_OK) status = push_end_row(&r->push, t, &row);
  const int64_t rows = (int64_t)(pen_path(p) / p->stride);
  return status == MPS_OK ? mpm_course_sample(&p->course, r->push.rows, rows) : status;
}

static mps_status march(penetrometer *p, pen_run *r) {
  push *now = &r->push;
  const bool alone = p->runs == 1;
  mps_status status = MPS_OK;
  r->m.samples = now->rows;
  progress_part(&r->m.a->bar, p->now * 0.9, alone ? 1.0 : p->now == 0 ? 0.9 : 0.1, 0.0, p->t_end);
  if (now->rows == 0) status = mpm_course_sample(&p->course, 0, now->capacity);
  if (status == MPS_OK) status = mpm_model_advance(&r->m, p->t_end, 1, after_step, p);
  const mps_status joined = push_join(now, MPS_OK);
  if (status == MPS_OK) status = joined;
  if (status == MPS_OK && p->runs == 2 && p->now == 0) resume_save_now(r->m.a, &p->course.saves);
  status = mpm_course_end(&p->course, status);
  r->steps = mps_mpm_steps(r->m.mpm);
  /* 4 cells of path or a tenth of it */
  const int64_t half = (int64_t)(fmin(2.0 * p->s.h, 0.05 * pen_path(p)) / p->stride);
  push_smooth(now, half, half / 4);
  const bool ended = status == MPS_OK || status == MPS_ERROR_CANCELLED;
  const mps_status taken = ended ? take_section(p, r) : MPS_OK;
  return status == MPS_OK ? taken : status;
}

mps_status pen_push(void *user) {
  penetrometer *p = user;
  mps_status status = march(p, &p->run[0]);
  if (status != MPS_OK || p->runs < 2) return status;
  pen_run *r = &p->run[1];
  p->now = 1;
  status = pen_build_run(p, false);
  if (status == MPS_OK) {
    printf("axisymmetric: %lld particles, dt %.4g s\n", (long long)r->particles, r->dt);
    fflush(stdout);
    status = march(p, r);
  }
  mpm_model_destroy(&r->m); /* its results are in rows and points */
  return status;
}
