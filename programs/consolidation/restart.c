/* restart.c - the history of the run, in a file to restart from (common/resume.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "consolidation.h"

/* The layers stand in a file, and must be those of the start. */
static bool pass_layers(simulation *sim, resume_bytes *b) {
  const strata *g = &sim->ground;
  const double means[3] = {sim->k, sim->modulus, sim->height};
  if (!sim->s.layers) return true;
  const bool same = resume_same(b, means, sizeof means) &&
                    resume_same(b, &g->count, sizeof g->count) &&
                    resume_same(b, g->layer, (size_t)g->count * sizeof *g->layer);
  if (mpm_course_same(&sim->course, b, same, "the layers have")) return true;
  sim->rows = 0;
  return false;
}

void consolidation_pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  resume_pass(b, &sim->rows, sizeof sim->rows);
  if (resume_wrong(b, sim->rows < 0 || sim->rows > sim->times * sim->steps)) {
    sim->rows = 0;
    return;
  }
  if (!pass_layers(sim, b)) return;
  resume_pass(b, sim->row, (size_t)sim->rows * sizeof *sim->row);
}
