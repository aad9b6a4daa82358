/* restart.c - the history of the run, in a file to restart from (common/resume.h); the
 * structure of a coupled run has a file of its own beside it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Header; then the settings of the pictures, and of each frame its header and values.
 */
typedef struct notes {
  int64_t frames, points, forces, learnt;
  seawall_sample at;
} notes;

static void pass_frames(resume_bytes *b, seawall *w, int64_t frames) {
  for (int64_t k = 0; k < frames && b->status == MPS_OK; k++) {
    seawall_frame *f = &w->frame[k];
    resume_pass(b, &f->t, sizeof f->t);
    resume_pass(b, &f->piston, sizeof f->piston);
    resume_pass(b, &f->count, sizeof f->count);
    if (resume_wrong(b, f->count < 0 || f->count > b->size)) return;
    const size_t values = 3 * (size_t)f->count * sizeof *f->value;
    if (b->reads && !(f->value = malloc(values + 1))) b->status = MPS_ERROR_MEMORY;
    if (b->reads) w->frames = k + 1;
    resume_pass(b, f->value, values);
  }
}

static void pass(void *user, resume_bytes *b) {
  seawall *w = user;
  notes n;
  memset(&n, 0, sizeof n);
  n.frames = w->frames, n.points = w->look.points;
  n.forces = w->forces, n.learnt = w->both.learnt, n.at = w->look.at;
  resume_pass(b, &n, sizeof n);
  if (resume_wrong(b, n.frames < 0 || n.frames > w->s.frames + 1 || n.points < 0 ||
                          n.points > w->room || n.forces < 0 || n.forces > w->steps ||
                          n.learnt < 0 || n.learnt > w->both.room))
    return;
  w->look.points = n.points;
  w->forces = n.forces, w->both.learnt = n.learnt, w->look.at = n.at;
  resume_pass(b, w->force, (size_t)w->forces * sizeof *w->force);
  resume_pass(b, w->look.y, (size_t)w->look.points * sizeof(double));
  resume_pass(b, w->look.pressure, (size_t)w->look.points * sizeof(double));
  resume_pass(b, w->look.displacement,
              2 * (size_t)mps_particles_count(w->wall.set) * sizeof(double));
  if (w->s.coupled) {
    resume_pass(b, w->both.before, (size_t)w->wall.count * sizeof(double));
    resume_pass(b, w->both.middle, (size_t)w->wall.count * sizeof(double));
    resume_pass(b, w->both.memory, (size_t)w->both.learnt * sizeof(double));
  }
  pass_frames(b, w, n.frames);
}

static resume parts(seawall *w) {
  return resume_of_fluid("mps-seawall 5", w->table, pass, w, w->fluid, w->a);
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
      app_settle(w->a, mps_coupling_get_memory(w->both.coupling, w->both.room, &w->both.learnt,
                                               w->both.memory));
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

mps_status seawall_save(void *user) {
  seawall *w = user;
  const resume r = parts(w);
  const mps_status status = w->s.coupled ? save_wall(w) : MPS_OK;
  return status == MPS_OK ? resume_save(&r, w->s.checkpoint) : status;
}

mps_status seawall_peek(mps_context *context, seawall *w) {
  const resume r = parts(w);
  return resume_peek(context, &r, w->s.restart, w->why, sizeof w->why);
}

mps_status seawall_restore(mps_context *context, seawall *w) {
  const resume r = parts(w);
  const mps_status status = resume_restore(context, &r, w->s.restart);
  w->restarted = mps_fluid_time(w->fluid);
  seawall_rows(w);
  return status == MPS_OK && w->s.coupled ? restore_wall(w) : status;
}
