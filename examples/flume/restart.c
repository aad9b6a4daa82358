/* restart.c - a run of mps-flume in a file: the state of the fluid, of the pistons, the samples,
 * the water at the largest force and of the animation, and the shapes of the model file, which must
 * be those of the run (common/resume.h). SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct notes {
  int64_t samples, frames;
  double maker[MPS_ABSORBER_MEMORY], end[MPS_ABSORBER_MEMORY];
  mps_fluid_report report;
} notes;

static bool restore_piston(mps_absorber *piston, const double *memory) {
  return !piston || mps_absorber_set_memory(piston, memory) == MPS_OK;
}

static void pass_look(resume_bytes *b, flume_look *look) {
  struct {
    double t, force;
    int64_t count, faces;
  } n = {look->t, look->force, look->count, look->faces};
  resume_pass(b, &n, sizeof n);
  if (resume_wrong(b, n.count < 0 || n.count > look->room || n.faces < 0 || n.faces > b->size))
    return;
  if (b->reads && n.faces > 0) {
    float *more = realloc(look->face, 3 * (size_t)n.faces * sizeof *more);
    if (!more) {
      b->status = MPS_ERROR_MEMORY;
      return;
    }
    look->face = more;
  }
  look->t = n.t, look->force = n.force, look->count = n.count, look->faces = n.faces;
  resume_pass(b, look->value, 3 * (size_t)n.count * sizeof *look->value);
  resume_pass(b, look->face, 3 * (size_t)n.faces * sizeof *look->face);
}

/* A number for each coordinate: a struct may have bytes between its members. */
static void pass_points(resume_bytes *b, int count, const double (*point)[2], bool *same) {
  for (int k = 0; k < 2 * count; k++) {
    double x = point[k / 2][k % 2];
    resume_pass(b, &x, sizeof x);
    *same = *same && x == point[k / 2][k % 2];
  }
}

static void pass_shapes(flume *m, resume_bytes *b) {
  const flume_shapes *p = &m->shape;
  int32_t count[5] = {p->bed, p->structure, p->body, p->rocks, p->probes};
  const int32_t now[5] = {p->bed, p->structure, p->body, p->rocks, p->probes};
  resume_pass(b, count, sizeof count);
  bool same = memcmp(count, now, sizeof now) == 0;
  if (same) {
    pass_points(b, p->bed, p->bed_point, &same);
    pass_points(b, p->structure, p->structure_point, &same);
    pass_points(b, p->body, p->body_point, &same);
    pass_points(b, p->probes, p->probe, &same);
  }
  for (int k = 0; k < p->rocks && same; k++) {
    const flume_rock *r = &p->rock[k];
    const double value[4][2] = {{r->corners, r->porosity},
                                {r->diameter, r->alpha},
                                {r->beta, isnan(r->KC) ? 0.0 : r->KC},
                                {r->gamma, 0.0}};
    pass_points(b, 4, value, &same);
    if (same) pass_points(b, r->corners, r->corner, &same);
  }
  if (resume_wrong(b, !same) && !same)
    snprintf(m->why, sizeof m->why, "%.150s was made with other shapes than those of %.150s",
             m->s.restart, m->s.model ? m->s.model : "the options");
}

static void pass(void *user, resume_bytes *b) {
  flume *m = user;
  notes n;
  bool good = true;
  memset(&n, 0, sizeof n);
  n.samples = m->samples, n.frames = m->frames, n.report = m->report;
  if (m->maker) good = good && mps_absorber_get_memory(m->maker, n.maker) == MPS_OK;
  if (m->end) good = good && mps_absorber_get_memory(m->end, n.end) == MPS_OK;
  pass_shapes(m, b);
  resume_pass(b, &n, sizeof n);
  good = good && n.samples >= 0 && n.samples <= m->capacity && n.frames >= 0 &&
         n.frames <= m->frame_room;
  if (resume_wrong(b, !good)) return;
  if (b->reads &&
      resume_wrong(b, !restore_piston(m->maker, n.maker) || !restore_piston(m->end, n.end)))
    return;
  m->samples = n.samples, m->frames = n.frames, m->report = n.report;
  resume_pass(b, m->sample, (size_t)m->samples * sizeof *m->sample);
  pass_look(b, &m->look);
  for (int64_t k = 0; k < m->frames; k++) pass_look(b, &m->frame[k]);
}

static resume parts(flume *m) {
  return resume_of_fluid("mps-flume 2", m->table, pass, m, m->fluid, m->a);
}

mps_status flume_save(void *user) {
  flume *m = user;
  const resume r = parts(m);
  return resume_save(&r, m->s.checkpoint);
}

mps_status flume_peek(mps_context *context, flume *m) {
  const resume r = parts(m);
  return resume_peek(context, &r, m->s.restart, m->why, sizeof m->why);
}

mps_status flume_restore(mps_context *context, flume *m) {
  const resume r = parts(m);
  return resume_go_on(context, &r, m->s.restart, &m->restarted, &m->saves);
}
