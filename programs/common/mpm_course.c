/* mpm_course.c - see mpm_course.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_course.h"

#include "frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

mpm_course mpm_course_of(const mpm_course_options *options, mpm_model *m, const char *directory,
                         const char *key, void (*pass)(void *user, resume_bytes *b), void *user) {
  return (mpm_course){.options = options,
                      .m = m,
                      .directory = directory,
                      .key = key,
                      .table = options_read(),
                      .pass = pass,
                      .user = user};
}

static resume parts(const mpm_course *c) {
  return (resume){.key = c->key,
                  .table = c->table,
                  .pass = c->pass,
                  .user = c->user,
                  .mpm = c->m->mpm,
                  .fluid = c->m->fluid,
                  .a = c->m->a,
                  .domain = c->m->a->domain};
}

static double now(const mpm_course *c) {
  return c->m->fluid ? mps_fluid_time(c->m->fluid) : mps_mpm_time(c->m->mpm);
}

static mps_status save(void *user) {
  const mpm_course *c = user;
  const resume r = parts(c);
  return resume_save(&r, c->options->checkpoint);
}

mps_status mpm_course_peek(mpm_course *c, mps_context *context) {
  const resume r = parts(c);
  return c->options->restart
             ? resume_peek(context, &r, c->options->restart, c->m->why, sizeof c->m->why)
             : MPS_OK;
}

mps_status mpm_course_load(mpm_course *c, mps_context *context) {
  const resume r = parts(c);
  return c->options->restart ? resume_load(context, &r, c->options->restart) : MPS_OK;
}

bool mpm_course_same(mpm_course *c, resume_bytes *b, bool same, const char *what) {
  if (!same)
    snprintf(c->m->why, sizeof c->m->why, "%s changed since the checkpoint %.300s was written",
             what, c->options->restart);
  return !resume_wrong(b, !same);
}

mps_status mpm_course_begin(mpm_course *c, mps_context *context, bool restores) {
  const resume r = parts(c);
  const mpm_course_options *o = c->options;
  c->from = NAN;
  mps_status status =
      c->columns ? rows_begin(&c->rows, mps_mpm_solver(c->m->mpm), c->columns) : MPS_OK;
  c->m->history = c->rows.history;
  if (status == MPS_OK && o->restart && restores) {
    status = resume_restore(context, &r, o->restart);
    if (c->columns) rows_look(&c->rows), c->m->samples = c->rows.count;
    c->from = now(c);
  }
  const double every = isnan(o->every_checkpoint) ? 0.1 * c->duration : o->every_checkpoint;
  const bool lost = c->saves.lost; /* of the previous model: one warning */
  c->saves = (resume_schedule){
      .path = o->checkpoint, .every = every, .save = save, .user = c, .lost = lost};
  resume_schedule_at(&c->saves, now(c));
  return status;
}

mps_status mpm_course_frame(mpm_course *c) {
  mps_status status = MPS_OK;
  if (!c->opened) status = mpm_model_series(c->m, c->directory, c->what, c->from, &c->series);
  c->opened = true;
  return status == MPS_OK ? mpm_model_frame(c->m, c->series) : status;
}

mps_status mpm_course_add(mpm_course *c, const void *row) {
  const mps_status status = rows_add(&c->rows, row);
  c->m->samples = c->rows.count;
  return status;
}

mps_status mpm_course_sample(mpm_course *c, int64_t k, int64_t samples) {
  mps_status status = MPS_OK;
  if (frame_is_due(k, samples, c->options->frames)) status = mpm_course_frame(c);
  if (status == MPS_OK) resume_save_when_due(c->m->a, &c->saves, now(c));
  return status;
}

mps_status mpm_course_end(mpm_course *c, mps_status status) {
  if (status == MPS_ERROR_CANCELLED && (c->m->mpm || c->m->fluid)) {
    resume_save_now(c->m->a, &c->saves);
    if (c->m->a->rank == 0) resume_tell(&c->saves);
  }
  c->m->failed = c->m->failed || c->saves.lost;
  const mps_status closed = mps_recorder_close(&c->series);
  return status == MPS_OK ? closed : status;
}

void resume_pass_snapshot(resume_bytes *b, mpm_snapshot *shot) {
  resume_pass(b, &shot->time, sizeof shot->time);
  resume_pass(b, &shot->count, sizeof shot->count);
  if (resume_wrong(b, shot->count < 0 || shot->count > b->size)) {
    shot->count = 0;
    return;
  }
  const size_t bytes = 3 * (size_t)shot->count * sizeof *shot->row;
  if (b->reads) free(shot->row);
  if (b->reads && !(shot->row = malloc(bytes + 1))) b->status = MPS_ERROR_MEMORY;
  resume_pass(b, shot->row, bytes);
}
