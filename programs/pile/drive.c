/* drive.c - penetration of the pile: forces by part and the level of the plug along the path, and
 * after every step a check for particles inside the wall.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include <math.h>
#include <stdlib.h>

#define ROWS_PER_CELL 5   /* of path */
#define WINDOW 4          /* cells of path: half before the row, half after it */
#define INSIDE 1e-6       /* cells: deeper below the surface counts as inside the wall */
#define VOLUME_EVERY 10   /* steps */
#define MOST_COLUMNS 4096 /* of the soil inside the pile */

double pile_depth(const pile *p) {
  mps_body_state state;
  if (mps_body_get_state(p->m.body[0], &state) != MPS_OK) return NAN;
  return p->s.height - state.position[1];
}

/* ---- looks ----------------------------------------------------------------------------------- */

static mps_status look_at_volumes(pile *p) {
  mps_view volume, mass;
  mps_status status = mps_particles_view(p->m.particles, "volume", &volume);
  if (status == MPS_OK) status = mps_particles_view(p->m.particles, "mass", &mass);
  if (status != MPS_OK) return status;
  double most = p->seen.ratio_max, least = p->seen.ratio_min;
  for (int64_t k = 0; k < volume.shape[0]; k++) {
    const double ratio = p->s.density * *mps_view_f64(&volume, k, 0) / *mps_view_f64(&mass, k, 0);
    most = ratio > most ? ratio : most;
    least = ratio < least ? ratio : least;
  }
  p->seen.ratio_max = most, p->seen.ratio_min = least;
  return MPS_OK;
}

static mps_status look_at_speeds(pile *p) {
  mps_view v;
  const mps_status status = mps_particles_view(p->m.particles, "velocity", &v);
  for (int64_t k = 0; status == MPS_OK && k < v.shape[0]; k++)
    p->seen.rest_speed =
        fmax(p->seen.rest_speed, hypot(*mps_view_f64(&v, k, 0), *mps_view_f64(&v, k, 1)));
  return status;
}

/* Maximum over all ranks of the checks of their own particles. Collective. */
static mps_status join_looks(pile *p, mps_status status) {
  pile_seen *s = &p->seen;
  double most[] = {s->ratio_max, -s->ratio_min, s->deepest, s->rest_speed};
  mps_domain *domain = p->m.a->domain;
  if (!domain) return status;
  status = mps_domain_agree(domain, status);
  if (status == MPS_OK) status = mps_domain_max(domain, 4, most);
  if (status != MPS_OK) return status;
  s->ratio_max = most[0], s->ratio_min = -most[1], s->deepest = most[2], s->rest_speed = most[3];
  return mpm_counts_join(&p->m, &p->inside, &s->inside);
}

/* The body is queried only for particles in its bounds. */
static mps_status look_for_intruders(pile *p) {
  mps_view x;
  mps_status status = mps_particles_view(p->m.particles, "position", &x);
  const double tip = p->s.height - pile_depth(p);
  int64_t inside = 0;
  for (int64_t k = 0; status == MPS_OK && k < x.shape[0]; k++) {
    const double at[2] = {*mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1)};
    if (at[0] < p->inner || at[0] > p->outer || at[1] < tip) continue;
    double distance = 0.0;
    status = mps_body_distance(p->m.body[0], 1, at, &distance, NULL, NULL, NULL);
    p->seen.deepest = fmax(p->seen.deepest, -distance);
    if (distance < -INSIDE * p->s.h) inside++;
  }
  return status == MPS_OK ? mpm_counts_note(&p->m, &p->inside, inside, &p->seen.inside) : status;
}

/* Top of the soil inside the pile above the tip (m): the highest particles of columns one cell
 * wide, with half a spacing, weighted by the columns' areas. NaN where the pile is above the soil.
 */
static mps_status find_plug(pile *p, double *plug) {
  mps_view x;
  double top[MOST_COLUMNS], sum = 0.0, area = 0.0;
  mps_status status = mps_particles_view(p->m.particles, "position", &x);
  if (status != MPS_OK) return status;
  const int columns = (int)fmin(MOST_COLUMNS, nearbyint(p->inner / p->s.h));
  for (int c = 0; c < columns; c++) top[c] = -INFINITY;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double c = *mps_view_f64(&x, k, 0) / p->inner * columns;
    if (c < columns) top[(int)c] = fmax(top[(int)c], *mps_view_f64(&x, k, 1));
  }
  if (p->m.a->domain) status = mps_domain_max(p->m.a->domain, columns, top);
  if (status != MPS_OK) return status;
  for (int c = 0; c < columns; c++) {
    sum += (c + 0.5) * top[c];
    area += c + 0.5;
  }
  const double level = sum / area + 0.5 * mps_particles_spacing(p->m.particles);
  *plug = level - (p->s.height - pile_depth(p));
  if (!(*plug > 0.0)) *plug = NAN;
  return MPS_OK;
}

/* ---- rows ------------------------------------------------------------------------------------ */

/* Upward impulses on the pile so far (N s). */
static mps_status read_impulses(pile *p, double *up) {
  static const char *const names[PILE_PARTS] = {"tip", "inside", "outside"};
  up[PILE_TOTAL] = 0.0;
  for (int k = 0; k < PILE_PARTS; k++) {
    mps_reaction r;
    const mps_status status =
        mps_body_get_reaction(p->m.body[0], mps_body_find_part(p->m.body[0], names[k]), &r);
    if (status != MPS_OK) return status;
    up[k] = r.impulse[1];
    up[PILE_TOTAL] += up[k];
  }
  return MPS_OK;
}

static mps_status end_row(pile *p, double t) {
  double up[PILE_FORCES], plug;
  mps_status status = read_impulses(p, up);
  if (status == MPS_OK) status = find_plug(p, &plug);
  const double span = t - p->last_time;
  if (status != MPS_OK || !(span > 0.0) || p->rows == p->capacity) return status;
  pile_row *row = &p->row[p->rows++];
  *row = (pile_row){.depth = pile_depth(p), .plug = plug};
  for (int k = 0; k < PILE_FORCES; k++) {
    row->force[k] = (up[k] - p->last_impulse[k]) / span;
    p->last_impulse[k] = up[k];
  }
  const double mean = row->force[PILE_TOTAL];
  row->jitter = sqrt(fmax(0.0, p->squares / span - mean * mean));
  p->last_time = t;
  p->squares = 0.0;
  p->m.samples = p->rows;
  return MPS_OK;
}

/* Means over WINDOW cells of path, less where the path begins and ends. */
static void smooth(pile *p) {
  const int64_t half = ROWS_PER_CELL * WINDOW / 2;
  for (int64_t i = 0; i < p->rows; i++) {
    const int64_t first = i < half ? 0 : i - half;
    const int64_t last = i + half < p->rows ? i + half : p->rows - 1;
    for (int k = 0; k < PILE_FORCES; k++) {
      double sum = 0.0;
      for (int64_t j = first; j <= last; j++) sum += p->row[j].force[k];
      p->row[i].smooth[k] = sum / (double)(last - first + 1);
    }
  }
}

/* ---- the run --------------------------------------------------------------------------------- */

static mps_status watch(pile *p, double t, double depth) {
  const double contact = p->t_start + (p->s.h - p->s.h / 4.0) / p->s.rate;
  mps_status status = look_for_intruders(p);
  if (status == MPS_OK && (mps_mpm_steps(p->m.mpm) % VOLUME_EVERY == 0 || t >= p->t_end))
    status = look_at_volumes(p);
  if (status == MPS_OK && depth < 0.0 && t > 0.5 * contact && t < contact)
    status = look_at_speeds(p);
  return status;
}

static mps_status after_step(void *user, mps_mpm *mpm) {
  pile *p = user;
  mps_reaction r;
  const double t = mps_mpm_time(mpm), depth = pile_depth(p);
  mps_status status = watch(p, t, depth);
  if (status == MPS_OK) status = mps_body_get_reaction(p->m.body[0], -1, &r);
  if (status == MPS_OK) p->squares += (t - p->last_step) * r.force[1] * r.force[1];
  p->last_step = t;
  const double next = p->stride * (double)(p->rows + 1) - p->s.h;
  const double step = p->s.depth / fmax(1.0, (double)p->s.frames);
  const bool row = depth >= next || t >= p->t_end;
  const bool frame =
      p->frames < p->s.frames && depth >= step * (double)(p->frames + 1) * (1.0 - 1e-9);
  if (row || frame || resume_is_due(&p->saves, t)) status = join_looks(p, status);
  if (status == MPS_OK && row) status = end_row(p, t);
  if (status == MPS_OK && frame) status = pile_take_frame(p);
  /* last after a step: the file then has everything of that step */
  if (status == MPS_OK) resume_save_when_due(p->m.a, &p->saves, t);
  return status;
}

mps_status pile_begin(pile *p) {
  p->stride = p->s.h / ROWS_PER_CELL;
  p->capacity = (int64_t)((p->s.depth + p->s.h) / p->stride) + 2;
  p->seen = (pile_seen){.ratio_min = INFINITY};
  p->row = calloc((size_t)p->capacity, sizeof *p->row);
  return p->row ? MPS_OK : MPS_ERROR_MEMORY;
}

/* The first checkpoint shows that the file can be written. Ctrl-C stops the run between two steps,
 * by the context's hook. */
mps_status pile_drive(void *user) {
  pile *p = user;
  mps_status status = pile_save(p);
  if (status == MPS_ERROR_UNSUPPORTED) status = MPS_OK; /* a libmps without HDF5 */
  if (status != MPS_OK) return status;
  progress_part(&p->m.a->bar, 0.0, 1.0, 0.0, p->t_end);
  p->m.samples = p->rows; /* after a restart */
  status = mpm_model_advance(&p->m, p->t_end, 1, after_step, p);
  const mps_status joined = join_looks(p, MPS_OK);
  if (status == MPS_ERROR_CANCELLED && joined == MPS_OK) resume_save_now(p->m.a, &p->saves);
  if (status == MPS_ERROR_CANCELLED) resume_tell(&p->saves);
  if (status == MPS_OK) status = joined;
  p->m.failed = p->m.failed || p->saves.lost;
  smooth(p);
  return status;
}
