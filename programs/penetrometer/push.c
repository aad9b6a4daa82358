/* push.c - penetration of the tip: forces by part along the path, after every step a check for
 * particles inside the tip, and at the end the section through the axis.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define INSIDE 1e-6     /* cells: deeper below the surface counts as inside the tip */
#define VOLUME_EVERY 10 /* steps */

/* The reference point moves as the lowest point does. */
double pen_depth(const penetrometer *p, const pen_run *r) {
  mps_body_state state;
  const double above = p->s.tip == PEN_SPHERE ? pen_radius(p) : 0.0;
  if (mps_body_get_state(r->m.body[0], &state) != MPS_OK) return NAN;
  return r->size[pen_up(r)] + above - state.position[pen_up(r)];
}

double pen_reached(const pen_run *r) { return r->rows > 0 ? r->row[r->rows - 1].depth : 0.0; }

/* ---- looks ----------------------------------------------------------------------------------- */

static mps_status look_at_volumes(const penetrometer *p, pen_run *r) {
  mps_view volume, mass;
  mps_status status = mps_particles_view(r->m.particles, "volume", &volume);
  if (status == MPS_OK) status = mps_particles_view(r->m.particles, "mass", &mass);
  for (int64_t k = 0; status == MPS_OK && k < volume.shape[0]; k++) {
    const double ratio = p->s.density * *mps_view_f64(&volume, k, 0) / *mps_view_f64(&mass, k, 0);
    r->ratio_max = fmax(r->ratio_max, ratio);
    r->ratio_min = fmin(r->ratio_min, ratio);
  }
  return status;
}

/* The body is queried for particles above its lowest point, and within the radius of a cone or
 * sphere. */
static mps_status look_for_intruders(const penetrometer *p, pen_run *r) {
  mps_view x;
  mps_status status = mps_particles_view(r->m.particles, "position", &x);
  if (status != MPS_OK) return status;
  const int up = pen_up(r);
  const double tip = r->size[up] - pen_depth(p, r);
  const double reach = p->s.tip == PEN_STL ? INFINITY : pen_radius(p);
  int64_t count = 0, inside = 0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double at[3] = {*mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1),
                          up == 2 ? *mps_view_f64(&x, k, 2) : 0.0};
    if (at[up] < tip || at[0] * at[0] + (up == 2 ? at[1] * at[1] : 0.0) > reach * reach) continue;
    for (int c = 0; c <= up; c++) r->near[(up + 1) * count + c] = at[c];
    count++;
  }
  if (count > 0)
    status = mps_body_distance(r->m.body[0], count, r->near, r->distance, NULL, NULL, NULL);
  for (int64_t k = 0; status == MPS_OK && k < count; k++) {
    r->deepest = fmax(r->deepest, -r->distance[k]);
    if (r->distance[k] < -INSIDE * p->s.h) inside++;
  }
  return status == MPS_OK ? mpm_counts_note(&r->m, &r->counts, inside, &r->inside) : status;
}

/* Maximum over all ranks of the checks of their own particles. Collective. */
static mps_status join_looks(pen_run *r, mps_status status) {
  double most[] = {r->ratio_max, -r->ratio_min, r->deepest};
  mps_domain *domain = r->m.a->domain;
  if (!domain) return status;
  status = mps_domain_agree(domain, status);
  if (status == MPS_OK) status = mps_domain_max(domain, 3, most);
  if (status != MPS_OK) return status;
  r->ratio_max = most[0], r->ratio_min = -most[1], r->deepest = most[2];
  return mpm_counts_join(&r->m, &r->counts, &r->inside);
}

/* ---- rows ------------------------------------------------------------------------------------ */

/* Upward impulses on the tip so far (N s). A mesh is all tip. */
static mps_status read_impulses(const pen_run *r, double *up) {
  static const char *const names[] = {"tip", "shaft"};
  mps_reaction reaction;
  mps_status status = mps_body_get_reaction(r->m.body[0], -1, &reaction);
  up[PEN_TOTAL] = up[PEN_TIP] = r->factor * reaction.impulse[pen_up(r)];
  up[PEN_SHAFT] = 0.0;
  for (int k = 0; k < 2 && status == MPS_OK; k++) {
    const int32_t part = mps_body_find_part(r->m.body[0], names[k]);
    if (part < 0) continue;
    status = mps_body_get_reaction(r->m.body[0], part, &reaction);
    up[k] = r->factor * reaction.impulse[pen_up(r)];
  }
  return status;
}

static mps_status end_row(const penetrometer *p, pen_run *r, double t) {
  double up[PEN_FORCES];
  const double span = t - r->last_time;
  const mps_status status = read_impulses(r, up);
  if (status != MPS_OK || !(span > 0.0) || r->rows == r->capacity) return status;
  pen_row *row = &r->row[r->rows++];
  row->depth = pen_depth(p, r);
  for (int k = 0; k < PEN_FORCES; k++) {
    row->force[k] = (up[k] - r->last_impulse[k]) / span;
    r->last_impulse[k] = up[k];
  }
  r->last_time = t;
  r->m.samples = r->rows;
  return MPS_OK;
}

/* In the second half of the wait the force of ground at rest is read; the first row begins at its
 * end. */
static mps_status wait_for_rest(const penetrometer *p, pen_run *r, double t) {
  double up[PEN_FORCES];
  if (t < 0.5 * p->hold) return MPS_OK;
  const bool first = r->last_time == 0.0;
  if (!first && t < p->hold) return MPS_OK;
  const mps_status status = read_impulses(r, up);
  if (status != MPS_OK) return status;
  if (!first) r->rest = (up[PEN_TIP] - r->last_impulse[PEN_TIP]) / (t - r->last_time);
  for (int k = 0; k < PEN_FORCES; k++) r->last_impulse[k] = up[k];
  r->last_time = t;
  return MPS_OK;
}

/* Means over 4 cells of path or a tenth of it, less where the path begins and ends. */
static void smooth(const penetrometer *p, pen_run *r) {
  const int64_t half = (int64_t)(fmin(2.0 * p->s.h, 0.05 * pen_path(p)) / p->stride);
  for (int64_t i = 0; i < r->rows; i++) {
    int64_t reach = half < i ? half : i; /* as far to either side: no lag on a slope */
    if (reach > r->rows - 1 - i) reach = r->rows - 1 - i;
    if (reach < half / 4) reach = half / 4; /* but at the ends */
    const int64_t first = i < reach ? 0 : i - reach;
    const int64_t last = i + reach < r->rows ? i + reach : r->rows - 1;
    for (int k = 0; k < PEN_FORCES; k++) {
      double sum = 0.0;
      for (int64_t j = first; j <= last; j++) sum += r->row[j].force[k];
      r->row[i].smooth[k] = sum / (double)(last - first + 1);
    }
  }
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

typedef struct push {
  penetrometer *p;
  pen_run *r;
} push;

static mps_status after_step(void *user, mps_mpm *mpm) {
  const push *now = user;
  penetrometer *p = now->p;
  pen_run *r = now->r;
  if (progress_interrupted()) return MPS_ERROR_CANCELLED; /* the solver's own question is rarer */
  const double t = mps_mpm_time(mpm), depth = pen_depth(p, r);
  mps_status status = look_for_intruders(p, r);
  if (status == MPS_OK && (mps_mpm_steps(mpm) % VOLUME_EVERY == 0 || t >= p->t_end))
    status = look_at_volumes(p, r);
  if (status == MPS_OK && r->last_time < p->hold) return wait_for_rest(p, r, t);
  const double next = p->s.start + p->stride * (double)(r->rows + 1) - pen_gap(p);
  if (depth < next && t < p->t_end) return status;
  status = join_looks(r, status);
  if (status == MPS_OK) status = end_row(p, r, t);
  const int64_t rows = (int64_t)(pen_path(p) / p->stride);
  return status == MPS_OK ? mpm_course_sample(&p->course, r->rows, rows) : status;
}

static mps_status march(penetrometer *p, pen_run *r) {
  push now = {p, r};
  mps_status status = MPS_OK;
  r->m.samples = r->rows;
  progress_part(&r->m.a->bar, p->now * 0.9,
                p->runs == 1  ? 1.0
                : p->now == 0 ? 0.9
                              : 0.1,
                0.0, p->t_end);
  if (r->rows == 0) status = mpm_course_sample(&p->course, 0, r->capacity);
  if (status == MPS_OK) status = mpm_model_advance(&r->m, p->t_end, 1, after_step, &now);
  const mps_status joined = join_looks(r, MPS_OK);
  if (status == MPS_OK) status = joined;
  if (status == MPS_OK && p->runs == 2 && p->now == 0) resume_save_now(r->m.a, &p->course.saves);
  status = mpm_course_end(&p->course, status);
  r->steps = mps_mpm_steps(r->m.mpm);
  smooth(p, r);
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
