/* restart.c - the run in a file to go on from: the fluid's checkpoint, and in its user_data what
 * the run has seen so far. What is written again is what would have been written without a stop.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KEY "mps-seawall 1" /* of the layout of the bytes below */

/* A run may go on with others of these. */
static const char *const free_options[] = {"out",     "threads", "checkpoint", "every-checkpoint",
                                           "restart", NULL};

/* What comes first; then the samples, the look, and of each frame its header and values. */
typedef struct notes {
  char options[1536];
  int64_t samples, frames, points, checkpoints, forces, learnt;
  seawall_sample at;
} notes;

/* Goes along bytes, copying to or from them; only counting where there are none. */
typedef struct cursor {
  char *at;
  int64_t bytes, size; /* passed so far; there are, when reading */
  bool writes, damaged;
} cursor;

static void pass(cursor *c, void *value, size_t size) {
  c->bytes += (int64_t)size;
  if (!c->at || c->damaged) return;
  if (!c->writes && c->bytes > c->size) {
    c->damaged = true;
    return;
  }
  if (c->writes)
    memcpy(c->at, value, size);
  else
    memcpy(value, c->at, size);
  c->at += size;
}

static void pass_frames(cursor *c, seawall *w, int64_t frames) {
  for (int64_t k = 0; k < frames && !c->damaged; k++) {
    seawall_frame *f = &w->frame[k];
    pass(c, &f->t, sizeof f->t);
    pass(c, &f->piston, sizeof f->piston);
    pass(c, &f->count, sizeof f->count);
    const size_t values = 3 * (size_t)f->count * sizeof *f->value;
    if (!c->writes && c->at) {
      if (f->count < 0 || f->count > c->size || !(f->value = malloc(values + 1))) {
        c->damaged = true;
        return;
      }
      w->frames = k + 1;
    }
    pass(c, f->value, values);
  }
}

static void pass_all(cursor *c, seawall *w) {
  notes n;
  memset(&n, 0, sizeof n);
  n.samples = w->samples, n.frames = w->frames, n.points = w->look.points;
  n.checkpoints = w->checkpoints;
  n.forces = w->forces, n.learnt = w->both.learnt, n.at = w->look.at;
  if (!options_record(w->table, free_options, n.options, sizeof n.options)) n.options[0] = '\0';
  pass(c, &n, sizeof n);
  if (!c->writes && c->at) {
    if (c->damaged || n.samples < 0 || n.samples > w->capacity || n.frames < 0 ||
        n.frames > w->s.frames + 1 || n.points < 0 || n.points > w->room || n.forces < 0 ||
        n.forces > w->steps || n.learnt < 0 || n.learnt > w->both.room) {
      c->damaged = true;
      return;
    }
    w->samples = n.samples, w->look.points = n.points, w->checkpoints = n.checkpoints;
    w->forces = n.forces, w->both.learnt = n.learnt, w->look.at = n.at;
  }
  pass(c, w->sample, (size_t)w->samples * sizeof *w->sample);
  pass(c, w->force, (size_t)w->forces * sizeof *w->force);
  pass(c, w->look.y, (size_t)w->look.points * sizeof(double));
  pass(c, w->look.pressure, (size_t)w->look.points * sizeof(double));
  pass(c, w->look.displacement, 2 * (size_t)mps_particles_count(w->wall.set) * sizeof(double));
  if (w->s.coupled) {
    pass(c, w->both.before, (size_t)w->wall.count * sizeof(double));
    pass(c, w->both.memory, (size_t)w->both.learnt * sizeof(double));
  }
  pass_frames(c, w, n.frames);
}

/* ---- to the file and back -------------------------------------------------------------------- */

/* The structure's file beside the fluid's. */
static void name_wall(char *path, size_t size, const char *checkpoint) {
  snprintf(path, size, "%s.wall", checkpoint);
}

static mps_status save_wall(seawall *w) {
  char path[1300];
  mps_checkpoint info = mps_checkpoint_defaults();
  name_wall(path, sizeof path, w->s.checkpoint);
  const mps_status status =
      mps_coupling_get_memory(w->both.coupling, w->both.room, w->both.memory, &w->both.learnt);
  return status == MPS_OK ? mps_elastic_save(w->wall.solver, path, &info) : status;
}

/* Both files must be of the same moment. */
static mps_status restore_wall(seawall *w) {
  char path[1300];
  mps_checkpoint info = mps_checkpoint_defaults();
  name_wall(path, sizeof path, w->s.restart);
  const mps_status status = mps_elastic_restore(w->wall.solver, path, &info);
  if (status != MPS_OK) return status;
  if (mps_elastic_steps(w->wall.solver) != mps_fluid_steps(w->fluid)) {
    snprintf(w->why, sizeof w->why, "%.150s and %.150s are not of the same moment", w->s.restart,
             path);
    return MPS_ERROR_FORMAT;
  }
  return mps_coupling_set_memory(w->both.coupling, w->both.learnt, w->both.memory);
}

mps_status seawall_save(seawall *w) {
  if (!w->s.checkpoint) return MPS_OK;
  if (w->s.coupled) {
    const mps_status saved = save_wall(w);
    if (saved != MPS_OK) return saved;
  }
  cursor c = {.writes = true};
  pass_all(&c, w); /* counts */
  mps_checkpoint info = mps_checkpoint_defaults();
  snprintf(info.user_key, sizeof info.user_key, KEY);
  info.user_bytes = c.bytes;
  info.user_data = c.at = malloc((size_t)c.bytes);
  if (!c.at) return MPS_ERROR_MEMORY;
  pass_all(&c, w);
  const mps_status status = mps_fluid_save(w->fluid, w->s.checkpoint, &info);
  free(info.user_data);
  return status;
}

/* The file's own bytes, for the caller to free. */
static mps_status load(mps_context *context, const seawall *w, mps_checkpoint *info) {
  *info = mps_checkpoint_defaults();
  snprintf(info->user_key, sizeof info->user_key, KEY); /* the library refuses another one */
  mps_status status = mps_checkpoint_info(context, w->s.restart, info);
  if (status != MPS_OK) return status;
  info->user_data = calloc((size_t)info->user_bytes + sizeof(notes), 1);
  if (!info->user_data) return MPS_ERROR_MEMORY;
  return mps_checkpoint_info(context, w->s.restart, info);
}

mps_status seawall_peek(mps_context *context, seawall *w) {
  mps_checkpoint info;
  mps_status status = load(context, w, &info);
  if (status == MPS_OK) {
    const notes *n = info.user_data;
    char differs[600] = "";
    if (!memchr(n->options, '\0', sizeof n->options) ||
        !options_agree(w->table, free_options, n->options, differs, sizeof differs)) {
      snprintf(w->why, sizeof w->why, "%.150s was made with other options: %.200s", w->s.restart,
               differs);
      status = MPS_ERROR_ARGUMENT;
    }
  }
  free(info.user_data);
  return status;
}

mps_status seawall_restore(mps_context *context, seawall *w) {
  mps_checkpoint info;
  mps_status status = load(context, w, &info);
  if (status == MPS_OK) status = mps_fluid_restore(w->fluid, w->s.restart, &info);
  if (status == MPS_OK) {
    cursor c = {.at = info.user_data, .size = info.user_bytes};
    pass_all(&c, w);
    if (c.damaged || c.bytes != info.user_bytes) status = MPS_ERROR_FORMAT;
    w->restarted = mps_fluid_time(w->fluid);
    if (status == MPS_OK && w->s.coupled) status = restore_wall(w);
  }
  free(info.user_data);
  return status;
}
