/* mpm_course.h - the course of a run, of WLS-MPM or a fluid, from sample to sample: its frames for
 * ParaView, its checkpoints and restart (resume.h). A program builds its model between
 * mpm_course_peek and mpm_course_begin, and calls mpm_course_sample after each sample and
 * mpm_course_end at last. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm_heap.h"
#include "mpm_model.h"
#include "resume.h"
#include "rows.h"

/* Options of a program, and the rows of its table. */
typedef struct mpm_course_options {
  int64_t frames;
  const char *checkpoint, *restart;
  double every_checkpoint; /* s; NaN: a tenth of the run */
} mpm_course_options;
#define MPM_COURSE_OPTIONS(o, most)                                                                \
  OPTION_INTEGER_IN("frames", OPTION_FROM_TO(0.0, most), &(o)->frames, NULL),                      \
      RESUME_OPTIONS(&(o)->checkpoint, &(o)->every_checkpoint, "default a tenth of the run",       \
                     &(o)->restart)

typedef struct mpm_course {
  const mpm_course_options *options;
  mpm_model *m;
  const char *directory, *what; /* of the series: DIR/WHAT.vtkhdf */
  double duration;              /* s, of the whole run */
  /* as in resume */
  const char *key;
  const option *table;
  void (*pass)(void *user, resume_bytes *b);
  void *user;
  const rows_column *columns; /* of `rows`; NULL: the program keeps its results in another way */
  /* made here */
  result_rows rows;
  mps_recorder *series; /* rank 0; made with the first frame: a series without one is none */
  double from;          /* s, time of the checkpoint that the run continues from; NaN: the start */
  bool opened;
  resume_schedule saves;
} mpm_course;

/* With what all courses have; `what`, `duration` and `columns` are the program's to set. */
mpm_course mpm_course_of(const mpm_course_options *options, mpm_model *m, const char *directory,
                         const char *key, void (*pass)(void *user, resume_bytes *b), void *user);
/* The options of the checkpoint that the run continues from are these; nothing to do without one.
 */
mps_status mpm_course_peek(mpm_course *c, mps_context *context);
/* History of the run, read before the model is built, where needed to build it. */
mps_status mpm_course_load(mpm_course *c, mps_context *context);
/* Once the model is built: restores the checkpoint, if any, if it is of this model (`restores`) and
 * not of an earlier one of the run. */
mps_status mpm_course_begin(mpm_course *c, mps_context *context, bool restores);
/* A row of results, of a course with `columns`. */
mps_status mpm_course_add(mpm_course *c, const void *row);
/* After sample `k` of 0 to `samples`, of which 0 is the start: the frame and the checkpoint that
 * are due. Where a run ends before its time, that sample is the last one, `k` = `samples`: the
 * series has its end. */
mps_status mpm_course_sample(mpm_course *c, int64_t k, int64_t samples);
/* A frame at another time. */
mps_status mpm_course_frame(mpm_course *c);
/* Closes the series, of a run that ended with `status`, and writes a checkpoint of one that Ctrl-C
 * has ended. Returns `status`, or that of an error here. */
mps_status mpm_course_end(mpm_course *c, mps_status status);
/* In `pass`, of what stands in files (resume_same): where it is not the `same` as at the start, the
 * reason is that `what`, "the layers have", changed. False then, and after any error. */
bool mpm_course_same(mpm_course *c, resume_bytes *b, bool same, const char *what);

/* A snapshot in the data of a checkpoint. */
void resume_pass_snapshot(resume_bytes *b, mpm_snapshot *shot);
