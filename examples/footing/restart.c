/* restart.c - what the run has seen so far, in a file to go on from (common/resume.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "footing.h"

static void pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  resume_pass(b, &sim->rows, sizeof sim->rows);
  if (resume_wrong(b, sim->rows < 0 || sim->rows > sim->samples)) {
    sim->rows = 0;
    return;
  }
  resume_pass(b, &sim->last_time, sizeof sim->last_time);
  resume_pass(b, &sim->last_impulse, sizeof sim->last_impulse);
  resume_pass(b, sim->path, (size_t)sim->rows * sizeof *sim->path);
  resume_pass(b, sim->q, (size_t)sim->rows * sizeof *sim->q);
}

static resume parts(simulation *sim) {
  return (resume){"mps-footing 1",           sim->table, pass, sim, .mpm = sim->m.mpm,
                  .domain = sim->m.a->domain};
}

mps_status footing_save(void *user) {
  simulation *sim = user;
  const resume r = parts(sim);
  return resume_save(&r, sim->s.checkpoint);
}

mps_status footing_peek(mps_context *context, simulation *sim) {
  const resume r = parts(sim);
  return resume_peek(context, &r, sim->s.restart, sim->m.why, sizeof sim->m.why);
}

mps_status footing_restore(mps_context *context, simulation *sim) {
  const resume r = parts(sim);
  const mps_status status = resume_restore(context, &r, sim->s.restart);
  sim->m.samples = sim->rows;
  return status;
}
