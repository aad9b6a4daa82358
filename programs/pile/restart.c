/* restart.c - the history of the run, in a file to restart from (common/resume.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include <stdlib.h>
#include <string.h>

/* Header; then the rows, then of each frame its depth and values. */
typedef struct notes {
  int64_t rows, frames, frames_kept;
  double last_time, last_step, squares, last_impulse[PILE_FORCES];
  pile_seen seen;
} notes;

static size_t frame_bytes(const pile *p) { return (size_t)p->particles * FIELDS * sizeof(float); }

static void take_notes(pile *p, resume_bytes *b, const notes *n) {
  if (resume_wrong(b, n->rows < 0 || n->rows > p->capacity || n->frames < 0 ||
                          n->frames > p->s.frames || n->frames_kept != pile_pictures(p, n->frames)))
    return;
  p->rows = n->rows, p->frames = n->frames;
  p->last_time = n->last_time, p->last_step = n->last_step, p->squares = n->squares;
  memcpy(p->last_impulse, n->last_impulse, sizeof p->last_impulse);
  p->seen = n->seen;
  for (; p->frames_kept < n->frames_kept; p->frames_kept++)
    if (!(p->frame[p->frames_kept].value = malloc(frame_bytes(p)))) {
      b->status = MPS_ERROR_MEMORY;
      return;
    }
}

static void pass(void *user, resume_bytes *b) {
  pile *p = user;
  notes n;
  memset(&n, 0, sizeof n);
  n.rows = p->rows, n.frames = p->frames, n.frames_kept = p->frames_kept;
  n.last_time = p->last_time, n.last_step = p->last_step, n.squares = p->squares;
  memcpy(n.last_impulse, p->last_impulse, sizeof n.last_impulse);
  n.seen = p->seen;
  resume_pass(b, &n, sizeof n);
  if (b->reads && b->status == MPS_OK) take_notes(p, b, &n);
  if (b->status != MPS_OK) return;
  resume_pass(b, p->row, (size_t)p->rows * sizeof *p->row);
  for (int64_t f = 0; f < p->frames_kept; f++) {
    resume_pass(b, &p->frame[f].depth, sizeof p->frame[f].depth);
    resume_pass(b, p->frame[f].value, frame_bytes(p));
  }
}

static resume parts(pile *p) {
  return (resume){.key = "mps-pile 4",
                  .table = p->table,
                  .pass = pass,
                  .user = p,
                  .mpm = p->m.mpm,
                  .a = p->m.a,
                  .domain = p->m.a->domain};
}

mps_status pile_save(void *user) {
  pile *p = user;
  const resume r = parts(p);
  return resume_save(&r, p->s.checkpoint);
}

mps_status pile_peek(mps_context *context, pile *p) {
  const resume r = parts(p);
  return resume_peek(context, &r, p->s.restart, p->m.why, sizeof p->m.why);
}

mps_status pile_restore(mps_context *context, pile *p) {
  const resume r = parts(p);
  const mps_status status = resume_restore(context, &r, p->s.restart);
  if (status == MPS_OK) resume_schedule_at(&p->saves, mps_mpm_time(p->m.mpm));
  return status;
}
