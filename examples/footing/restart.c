/* restart.c - the history of the run, in a file to restart from (common/resume.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "footing.h"

void footing_pass(void *user, resume_bytes *b) {
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
