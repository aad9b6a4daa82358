/* restart.c - a run of mps-flume in a file: the state of the fluid, of the pistons, the samples,
 * the water at the largest force (common/resume.h). SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <string.h>

typedef struct notes {
  int64_t samples, count;
  double t, force;
  double maker[MPS_ABSORBER_MEMORY], end[MPS_ABSORBER_MEMORY];
  mps_fluid_report report;
} notes;

static bool restore_piston(mps_absorber *piston, const double *memory) {
  return !piston || mps_absorber_set_memory(piston, memory) == MPS_OK;
}

static void pass(void *user, resume_bytes *b) {
  flume *m = user;
  notes n;
  memset(&n, 0, sizeof n);
  n.samples = m->samples, n.report = m->report;
  n.count = m->look.count, n.t = m->look.t, n.force = m->look.force;
  bool good = true;
  if (m->maker) good = good && mps_absorber_get_memory(m->maker, n.maker) == MPS_OK;
  if (m->end) good = good && mps_absorber_get_memory(m->end, n.end) == MPS_OK;
  resume_pass(b, &n, sizeof n);
  good =
      good && n.samples >= 0 && n.samples <= m->capacity && n.count >= 0 && n.count <= m->look.room;
  if (resume_wrong(b, !good)) return;
  if (b->reads &&
      resume_wrong(b, !restore_piston(m->maker, n.maker) || !restore_piston(m->end, n.end)))
    return;
  m->samples = n.samples, m->report = n.report;
  m->look.count = n.count, m->look.t = n.t, m->look.force = n.force;
  resume_pass(b, m->sample, (size_t)m->samples * sizeof *m->sample);
  resume_pass(b, m->look.value, 3 * (size_t)m->look.count * sizeof *m->look.value);
}

static resume parts(flume *m) {
  return (resume){.key = "mps-flume 1",
                  .table = m->table,
                  .pass = pass,
                  .user = m,
                  .fluid = m->fluid,
                  .a = m->a,
                  .domain = m->a->domain};
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
  const mps_status status = resume_restore(context, &r, m->s.restart);
  m->restarted = mps_fluid_time(m->fluid);
  resume_schedule_at(&m->saves, m->restarted);
  return status;
}
