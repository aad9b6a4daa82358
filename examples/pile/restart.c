/* restart.c - the run in a file to go on from: the solver's checkpoint, and in its user_data what
 * the run has seen so far. What is written again is what would have been written without a stop.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KEY "mps-pile 2" /* of the layout of the bytes below */

/* A run may go on with others of these. */
static const char *const free_options[] = {"out",     "threads", "checkpoint", "every-checkpoint",
                                           "restart", NULL};

/* ---- the run's own bytes --------------------------------------------------------------------- */

/* What comes first; then the rows, then of each frame its depth and values. */
typedef struct notes {
  char options[1536]; /* see options_record */
  int64_t rows, frames, frames_kept;
  double last_time, last_step, squares, last_impulse[PILE_FORCES];
  pile_seen seen;
} notes;

/* Goes along bytes, copying to or from them; only counting where there are none. */
typedef struct cursor {
  char *at;
  int64_t bytes;
  bool writes;
} cursor;

static void pass(cursor *c, void *value, size_t size) {
  c->bytes += (int64_t)size;
  if (!c->at) return;
  if (c->writes)
    memcpy(c->at, value, size);
  else
    memcpy(value, c->at, size);
  c->at += size;
}

static size_t frame_bytes(const pile *p) {
  return (size_t)mps_particles_count(p->m.particles) * FIELDS * sizeof(float);
}

static void pass_rows(cursor *c, pile *p) {
  pass(c, p->row, (size_t)p->rows * sizeof *p->row);
  for (int64_t f = 0; f < p->frames_kept; f++) {
    pass(c, &p->frame[f].depth, sizeof p->frame[f].depth);
    pass(c, p->frame[f].value, frame_bytes(p));
  }
}

static void pass_all(cursor *c, pile *p) {
  notes n;
  memset(&n, 0, sizeof n);
  n.rows = p->rows, n.frames = p->frames, n.frames_kept = p->frames_kept;
  n.last_time = p->last_time, n.last_step = p->last_step, n.squares = p->squares;
  memcpy(n.last_impulse, p->last_impulse, sizeof n.last_impulse);
  n.seen = p->seen;
  if (!options_record(p->table, free_options, n.options, sizeof n.options)) n.options[0] = '\0';
  pass(c, &n, sizeof n);
  pass_rows(c, p);
}

/* Room for the frames that the notes tell of; false when out of memory. */
static bool take_notes(pile *p, const notes *n) {
  p->rows = n->rows, p->frames = n->frames;
  p->last_time = n->last_time, p->last_step = n->last_step, p->squares = n->squares;
  memcpy(p->last_impulse, n->last_impulse, sizeof p->last_impulse);
  p->seen = n->seen;
  for (; p->frames_kept < n->frames_kept; p->frames_kept++)
    if (!(p->frame[p->frames_kept].value = malloc(frame_bytes(p)))) return false;
  return true;
}

/* ---- to the file and back -------------------------------------------------------------------- */

mps_status pile_save(pile *p) {
  cursor c = {.writes = true};
  pass_all(&c, p); /* counts */
  mps_checkpoint info = mps_checkpoint_defaults();
  snprintf(info.user_key, sizeof info.user_key, KEY);
  info.user_bytes = c.bytes;
  info.user_data = c.at = malloc((size_t)c.bytes);
  if (!c.at) return MPS_ERROR_MEMORY;
  pass_all(&c, p);
  const mps_status status = mps_mpm_save(p->m.mpm, p->s.checkpoint, &info);
  free(info.user_data);
  return status;
}

void pile_try_save(pile *p) {
  const mps_status status = pile_save(p);
  if (status != MPS_OK && !p->checkpoint_lost) {
    app_error(p->m.a, "no checkpoint at %.4g m, the run goes on: %s", pile_depth(p),
              status == MPS_ERROR_MEMORY ? "out of memory"
                                         : mps_context_error(p->m.a->context)->message);
  }
  p->checkpoint_lost = p->m.failed = status != MPS_OK;
}

/* The file's own bytes, for the caller to free. */
static mps_status load(mps_context *context, const pile *p, mps_checkpoint *info) {
  *info = mps_checkpoint_defaults();
  snprintf(info->user_key, sizeof info->user_key, KEY); /* the library refuses another one */
  mps_status status = mps_checkpoint_info(context, p->s.restart, info);
  if (status != MPS_OK) return status;
  info->user_data = calloc((size_t)info->user_bytes + sizeof(notes), 1);
  if (!info->user_data) return MPS_ERROR_MEMORY;
  return mps_checkpoint_info(context, p->s.restart, info);
}

mps_status pile_peek(mps_context *context, pile *p) {
  mps_checkpoint info;
  mps_status status = load(context, p, &info);
  if (status == MPS_OK) {
    const notes *n = info.user_data;
    char differs[600] = "";
    if (!memchr(n->options, '\0', sizeof n->options) ||
        !options_agree(p->table, free_options, n->options, differs, sizeof differs)) {
      snprintf(p->m.why, sizeof p->m.why, "%.150s was made with other options: %.200s",
               p->s.restart, differs);
      status = MPS_ERROR_ARGUMENT;
    }
  }
  free(info.user_data);
  return status;
}

/* The options have been compared, and the library found the file undamaged: the lengths agree,
 * unless another version of this program wrote it. */
static mps_status read_notes(pile *p, char *bytes, int64_t size) {
  notes n;
  cursor c = {.at = bytes};
  if (size < (int64_t)sizeof n) return MPS_ERROR_FORMAT;
  pass(&c, &n, sizeof n);
  if (n.rows < 0 || n.rows > p->capacity || n.frames < 0 || n.frames > p->s.frames ||
      n.frames_kept != pile_pictures(p, n.frames))
    return MPS_ERROR_FORMAT;
  const int64_t frame = (int64_t)(sizeof p->frame[0].depth + frame_bytes(p));
  if (size != (int64_t)(sizeof n + (size_t)n.rows * sizeof *p->row) + n.frames_kept * frame)
    return MPS_ERROR_FORMAT;
  if (!take_notes(p, &n)) return MPS_ERROR_MEMORY;
  pass_rows(&c, p);
  return MPS_OK;
}

mps_status pile_restore(mps_context *context, pile *p) {
  mps_checkpoint info;
  mps_status status = load(context, p, &info);
  if (status == MPS_OK) status = mps_mpm_restore(p->m.mpm, p->s.restart, &info);
  if (status == MPS_OK) status = read_notes(p, info.user_data, info.user_bytes);
  free(info.user_data);
  if (status == MPS_OK)
    p->checkpoints = (int64_t)((pile_depth(p) + p->s.h) / p->s.every_checkpoint);
  return status;
}
