/* restart.c - the history of the run in space, in a file to restart from (common/resume.h). The
 * axisymmetric run that may follow is short, and is repeated.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer.h"

void pen_pass(void *user, resume_bytes *b) {
  penetrometer *p = user;
  pen_run *r = &p->run[0];
  resume_pass(b, &r->rows, sizeof r->rows);
  if (resume_wrong(b, r->rows < 0 || r->rows > r->capacity)) {
    r->rows = 0;
    return;
  }
  resume_pass(b, r->row, (size_t)r->rows * sizeof *r->row);
  resume_pass(b, &r->last_time, sizeof r->last_time);
  resume_pass(b, r->last_impulse, sizeof r->last_impulse);
  resume_pass(b, &r->rest, sizeof r->rest);
  resume_pass(b, &r->inside, sizeof r->inside);
  double *const values[] = {&r->deepest, &r->ratio_max, &r->ratio_min};
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    resume_pass(b, values[k], sizeof *values[k]);
}
