/* restart.c - a run of mps-flume in a file: the state of the pistons, the water at the largest
 * force and of the animation, and the probes of the model file, which must be those of the run
 * (common/resume.h). SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct notes {
  int64_t frames, returned;
  double due;
  flume_mean mean[2];
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
  if (resume_wrong(b, n.count < 0 || n.count > b->size || n.faces < 0 || n.faces > b->size)) return;
  if (b->reads && !flume_look_room(look, n.count)) {
    b->status = MPS_ERROR_MEMORY;
    return;
  }
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

/* Bed, structure, body and rock the library compares with those of its file. */
static void pass_probes(flume *m, resume_bytes *b) {
  int64_t count = m->shape.probes;
  double then[FLUME_PROBES][2] = {{0.0}};
  memcpy(then, m->shape.probe, sizeof then);
  resume_pass(b, &count, sizeof count);
  resume_pass(b, then, sizeof then);
  const bool same = count == m->shape.probes && memcmp(then, m->shape.probe, sizeof then) == 0;
  if (resume_wrong(b, !same) && !same)
    snprintf(m->why, sizeof m->why, "%.150s was made with other probes than those of %.150s",
             m->s.restart, m->s.model ? m->s.model : "the options");
}

static void pass(void *user, resume_bytes *b) {
  flume *m = user;
  notes n;
  bool good = true;
  memset(&n, 0, sizeof n);
  n.frames = m->frames, n.report = m->report;
  n.returned = m->returned, n.due = m->due;
  memcpy(n.mean, m->mean, sizeof n.mean);
  if (m->maker) good = good && mps_absorber_get_memory(m->maker, n.maker) == MPS_OK;
  if (m->end) good = good && mps_absorber_get_memory(m->end, n.end) == MPS_OK;
  pass_probes(m, b);
  resume_pass(b, &n, sizeof n);
  good = good && n.frames >= 0 && n.frames <= m->frame_room && n.returned >= 0 && n.due >= 0.0 &&
         n.due <= 1.0;
  for (size_t k = 0; k < sizeof n.mean / (sizeof(double)); k++)
    good = good && fabs(((const double *)n.mean)[k]) <= 1e6;
  if (resume_wrong(b, !good)) return;
  if (b->reads &&
      resume_wrong(b, !restore_piston(m->maker, n.maker) || !restore_piston(m->end, n.end)))
    return;
  m->frames = n.frames, m->report = n.report;
  m->returned = n.returned, m->due = n.due;
  memcpy(m->mean, n.mean, sizeof n.mean);
  pass_look(b, &m->look);
  for (int64_t k = 0; k < m->frames; k++) pass_look(b, &m->frame[k]);
}

static resume parts(flume *m) {
  return resume_of_fluid("mps-flume 7", m->table, pass, m, m->fluid, m->a);
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
  const mps_status status = resume_go_on(context, &r, m->s.restart, &m->restarted, &m->saves);
  flume_rows(m);
  return status;
}
