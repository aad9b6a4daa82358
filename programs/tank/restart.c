/* restart.c - the history of the run, in a file to restart from (common/resume.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include <string.h>

/* Header; then the memory of the coupling. */
typedef struct notes {
  int64_t learnt;
  mps_fluid_report report;
  tank_motion at[TANK_SHAPES];
  double force[TANK_SHAPES];
} notes;

static void pass(void *user, resume_bytes *b) {
  tank_model *m = user;
  tank_structure *p = &m->structure;
  notes n;
  memset(&n, 0, sizeof n);
  n.learnt = p->learnt, n.report = m->report;
  memcpy(n.at, p->at, sizeof n.at);
  memcpy(n.force, p->force, sizeof n.force);
  resume_pass(b, &n, sizeof n);
  if (resume_wrong(b, n.learnt < 0 || n.learnt > p->room)) return;
  p->learnt = n.learnt, m->report = n.report;
  memcpy(p->at, n.at, sizeof n.at);
  memcpy(p->force, n.force, sizeof n.force);
  resume_pass(b, p->memory, (size_t)p->learnt * sizeof *p->memory);
}

static resume parts(tank_model *m) {
  return resume_of_fluid("mps-tank 4", m->table, pass, m, m->fluid, m->a);
}

mps_status tank_save(void *user) {
  tank_model *m = user;
  const resume r = parts(m);
  const mps_status status = app_settle(m->a, tank_remember(&m->structure));
  return status == MPS_OK ? resume_save(&r, m->s.checkpoint) : status;
}

mps_status tank_peek(mps_context *context, tank_model *m) {
  const resume r = parts(m);
  return resume_peek(context, &r, m->s.restart, m->why, sizeof m->why);
}

mps_status tank_restore(mps_context *context, tank_model *m) {
  const resume r = parts(m);
  const mps_status status = resume_go_on(context, &r, m->s.restart, &m->restarted, &m->saves);
  tank_look(m);
  return status == MPS_OK ? tank_recall(&m->structure) : status;
}
