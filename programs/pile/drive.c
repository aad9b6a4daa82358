/* drive.c - penetration of the pile: forces by part and the level of the plug along the path, and
 * after every step a check for particles inside the wall.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include <math.h>
#include <stdlib.h>

#define WINDOW (4 * PILE_ROWS) /* rows of 4 cells of path: half before the row, half after it */
#define VOLUME_EVERY 10        /* steps */
#define MOST_COLUMNS 4096      /* of the soil inside the pile */

/* Top of the soil inside the pile above the tip (m): the highest particles of columns one cell
 * wide, with half a spacing, weighted by the columns' areas. NaN where the pile is above the soil.
 */
static mps_status find_plug(pile *p, double *plug) {
  mps_view x;
  double top[MOST_COLUMNS], sum = 0.0, base = 0.0;
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
    base += c + 0.5;
  }
  const double level = sum / base + 0.5 * mps_particles_spacing(p->m.particles);
  *plug = level - (p->s.height - push_depth(&p->push));
  if (!(*plug > 0.0)) *plug = NAN;
  return MPS_OK;
}

/* ---- the run --------------------------------------------------------------------------------- */

static mps_status watch(pile *p, double t, double depth) {
  const double contact = p->t_start + (p->s.h - p->s.h / 4.0) / p->s.rate;
  const bool rests = depth < 0.0 && t > 0.5 * contact && t < contact;
  mps_status status =
      push_look(&p->push, mps_mpm_steps(p->m.mpm) % VOLUME_EVERY == 0 || t >= p->t_end);
  if (status == MPS_OK && rests) status = push_look_at_speeds(&p->push);
  return status == MPS_OK ? push_note_jitter(&p->push, t) : status;
}

static mps_status end_row(pile *p, double t) {
  push_row *row;
  double plug;
  mps_status status = find_plug(p, &plug);
  if (status == MPS_OK) status = push_end_row(&p->push, t, &row);
  if (status == MPS_OK && row) row->plug = plug;
  return status;
}

static mps_status after_step(void *user, mps_mpm *mpm) {
  pile *p = user;
  const double t = mps_mpm_time(mpm), depth = push_depth(&p->push);
  mps_status status = watch(p, t, depth);
  const int64_t frames = p->s.course.frames;
  const double next = p->stride * (double)(p->push.rows + 1) - p->s.h;
  const double step = p->s.depth / fmax(1.0, (double)frames);
  const bool row = depth >= next || t >= p->t_end;
  const bool frame = p->frames < frames && depth >= step * (double)(p->frames + 1) * (1.0 - 1e-9);
  if (row || frame || resume_is_due(&p->course.saves, t)) status = push_join(&p->push, status);
  if (status == MPS_OK && row) status = end_row(p, t);
  if (status == MPS_OK && frame) status = pile_take_frame(p);
  /* last after a step: the file then has everything of that step */
  if (status == MPS_OK) resume_save_when_due(p->m.a, &p->course.saves, t);
  return status;
}

/* Ctrl-C stops the run between two steps, by the context's hook. */
mps_status pile_drive(void *user) {
  pile *p = user;
  progress_part(&p->m.a->bar, 0.0, 1.0, 0.0, p->t_end);
  p->m.samples = p->push.rows; /* after a restart */
  mps_status status = mpm_model_advance(&p->m, p->t_end, 1, after_step, p);
  const mps_status joined = push_join(&p->push, MPS_OK);
  if (status == MPS_OK) status = joined;
  push_smooth(&p->push, WINDOW / 2, WINDOW / 2);
  return mpm_course_end(&p->course, status);
}
