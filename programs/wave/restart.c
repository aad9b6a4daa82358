/* restart.c - options and results in a checkpoint of mps-wave (common/resume.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wave.h"

#include <stdlib.h>

/* The layers stand in a file, and must be those of the start; then the rows and the peaks. */
static void pass(void *user, resume_bytes *b) {
  results_so_far *r = user;
  receivers *q = r->record;
  const layers *ground = &r->s->ground;
  int64_t rows = q->rows, width = q->count + 1, peaks = r->peaks->count;
  r->same = resume_same(b, &ground->count, sizeof ground->count) &&
            resume_same(b, ground->layer, (size_t)ground->count * sizeof *ground->layer) &&
            resume_same(b, &width, sizeof width) && resume_same(b, &peaks, sizeof peaks);
  resume_pass(b, &rows, sizeof rows);
  if (resume_wrong(b, !r->same || rows < 0 || rows > b->size)) return;
  if (b->reads) {
    free(q->row);
    q->rows = q->capacity = 0;
    q->row = malloc((size_t)(rows * width + 1) * sizeof *q->row);
    if (!q->row) b->status = MPS_ERROR_MEMORY;
    if (q->row) q->rows = q->capacity = rows;
  }
  resume_pass(b, q->row, (size_t)(rows * width) * sizeof *q->row);
  resume_pass(b, r->peaks->peak, (size_t)peaks * sizeof *r->peaks->peak);
  resume_pass(b, &r->every, sizeof r->every);
  resume_pass(b, &q->energies, sizeof q->energies);
  double *const energy[] = {&q->energy_least, &q->energy_most, &q->energy_sum};
  for (int k = 0; k < 3; k++) resume_pass(b, energy[k], sizeof *energy[k]);
}

resume restart_parts(app *a, results_so_far *r, mps_dynamics *dynamics) {
  return (resume){.key = RESTART_KEY,
                  .table = options_read(),
                  .others = "duration|frames|dt|courant|paper",
                  .pass = pass,
                  .user = r,
                  .dynamics = dynamics,
                  .a = a,
                  .domain = a->domain};
}
