/* restart.c - the history of the run, in a file to restart from (common/resume.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "consolidation.h"

void consolidation_pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  resume_pass(b, &sim->rows, sizeof sim->rows);
  if (resume_wrong(b, sim->rows < 0 || sim->rows > sim->times * sim->steps)) {
    sim->rows = 0;
    return;
  }
  resume_pass(b, sim->row, (size_t)sim->rows * sizeof *sim->row);
}
