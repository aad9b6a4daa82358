/* resume.h - a run in a file to go on from: the checkpoint of a solver, and in its user_data the
 * options of the program and what the run has seen so far. What is written after a restart is what
 * would have been written without a stop.
 *
 * A program lists what it keeps in one function, which serves both ways:
 *   static void pass(void *user, resume_bytes *b) {
 *     resume_pass(b, &rows, sizeof rows);
 *     if (resume_wrong(b, rows < 0 || rows > capacity)) return;
 *     resume_pass(b, row, rows * sizeof *row);
 *   }
 * and saves between steps by resume_pack and mps_S_save, to go on by resume_read, mps_S_restore and
 * resume_unpack. SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_RESUME_H
#define EXAMPLES_RESUME_H

#include "app.h"
#include "options.h"

#include <mps/io.h>

/* Goes along bytes, copying to or from them; only counting where there are none. */
typedef struct resume_bytes {
  char *at;
  int64_t bytes, size; /* passed so far; there are, when reading */
  bool reads;
  mps_status status; /* of reading: MPS_ERROR_FORMAT, MPS_ERROR_MEMORY */
} resume_bytes;

/* Does nothing after an error. */
void resume_pass(resume_bytes *b, void *value, size_t size);
/* While reading, notes that what was read cannot be (`wrong`). True after any error. */
bool resume_wrong(resume_bytes *b, bool wrong);

typedef struct resume {
  const char *key; /* names the program and the layout of the bytes */
  const option *table;
  void (*pass)(void *user, resume_bytes *b);
  void *user; /* of pass */
} resume;

/* Fills `info` for mps_S_save. Free its user_data afterwards, also after an error. */
mps_status resume_pack(const resume *r, mps_checkpoint *info);
/* Compares the options of the file with these, but for those that a run may go on with others of
 * (--out, --threads and those of checkpoints): before a model is built. MPS_ERROR_ARGUMENT: in
 * `why` the first that differs; `why` is "" where the library says what is wrong. */
mps_status resume_peek(mps_context *context, const resume *r, const char *path, char *why,
                       size_t size);
/* Reads the bytes into `info`, for mps_S_restore and resume_unpack. Free its user_data. */
mps_status resume_read(mps_context *context, const resume *r, const char *path,
                       mps_checkpoint *info);
mps_status resume_unpack(const resume *r, const mps_checkpoint *info);

/* Checkpoints on the way. One that fails is told, once, and does not end the run. */
typedef struct resume_schedule {
  const char *path;               /* NULL: none are written */
  double every;                   /* s */
  mps_status (*save)(void *user); /* writes `path` */
  void *user;
  int64_t count; /* times `every` that the run has gone: resume_schedule_at */
  bool lost;     /* the last one could not be written */
  bool saved;    /* the last one was written */
} resume_schedule;

/* Where a run begins or goes on: what was due until then is not due again. */
void resume_schedule_at(resume_schedule *s, double time);
void resume_save_when_due(app *a, resume_schedule *s, double time);
void resume_save_now(app *a, resume_schedule *s);

#endif
