/* resume.h - a run in a file to restart from: the checkpoint of a solver, and in its user_data the
 * options of the program and the history of the run. Results after a restart are those of an
 * uninterrupted run.
 *
 * A program lists its data in one function, for writing and reading:
 *   static void pass(void *user, resume_bytes *b) {
 *     resume_pass(b, &rows, sizeof rows);
 *     if (resume_wrong(b, rows < 0 || rows > capacity)) return;
 *     resume_pass(b, row, rows * sizeof *row);
 *   }
 * and saves between steps by resume_save, to continue by resume_peek and resume_restore.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "app.h"
#include "options.h"

#include <mps/dynamics.h>
#include <mps/experimental/domain.h>
#include <mps/fluid.h>
#include <mps/io.h>
#include <mps/mpm.h>

/* Copies to or from bytes in turn; only counts where there are none. */
typedef struct resume_bytes {
  char *at;
  int64_t bytes, size; /* passed so far; there are, when reading */
  bool reads;
  mps_status status; /* of reading: MPS_ERROR_FORMAT, MPS_ERROR_MEMORY */
} resume_bytes;

/* Does nothing after an error. */
void resume_pass(resume_bytes *b, void *value, size_t size);
/* While reading, records that the data are invalid (`wrong`). True after any error. */
bool resume_wrong(resume_bytes *b, bool wrong);
/* Passes values that a run must be continued with, as those of a file that may have changed. False
 * while reading where they differ. */
bool resume_same(resume_bytes *b, const void *value, size_t size);

typedef struct resume {
  const char *key; /* names the program and the layout of the bytes */
  const option *table;
  void (*pass)(void *user, resume_bytes *b); /* NULL: the solver has all (rows.h) */
  void *user;                                /* of pass */
  mps_mpm *mpm;                              /* the solver: this one */
  mps_fluid *fluid;                          /* or this */
  mps_dynamics *dynamics;                    /* or this */
  const char *others; /* "a|b": options that the run may go on with others of; NULL: none */
  app *a;             /* its warnings are kept too: summary.json has those of the whole run */
  mps_domain *domain; /* of several ranks: saving, peeking and restoring are collective */
} resume;

mps_status resume_save(const resume *r, const char *path);
/* Compares the options of the file with these, but for those that a run may continue with others of
 * (--out, --threads and those of checkpoints): before a model is built. MPS_ERROR_ARGUMENT: in
 * `why` the first that differs; `why` is "" where the library has recorded the error. */
mps_status resume_peek(mps_context *context, const resume *r, const char *path, char *why,
                       size_t size);
/* After resume_peek: the history of the run, without the solver. */
mps_status resume_load(mps_context *context, const resume *r, const char *path);
/* After resume_peek, once the model is built: the solver and the history of the run. */
mps_status resume_restore(mps_context *context, const resume *r, const char *path);

/* Of a program on a fluid, of one process or of the ranks of the app. */
resume resume_of_fluid(const char *key, const option *table, void (*pass)(void *, resume_bytes *),
                       void *user, mps_fluid *fluid, app *a);

/* Rows of a program's table of options. */
#define RESUME_OPTIONS(checkpoint, every, note, restart)                                           \
  OPTION_TEXT("checkpoint", checkpoint, NULL),                                                     \
      OPTION_NUMBER("every-checkpoint", every, note, NAN), OPTION_TEXT("restart", restart, NULL)

/* The files of a run, before it begins, by one rule for all programs. A restarted run replaces no
 * results: where *out has a summary.json, they go to OUT-from-T, T (s) the time of the checkpoint,
 * and a line says so; that one must be new. *checkpoint becomes OUT/checkpoint.h5 where it is NULL;
 * a path that the library could not write is an error now. Strings that change are kept here. False
 * after an error line. */
bool resume_places(app *a, const char *restart, const char **checkpoint, const char **out);

/* Checkpoints on the way. A failure is reported, once, and does not end the run. */
typedef struct resume_schedule {
  const char *path;               /* NULL: none are written */
  double every;                   /* s, or m of path */
  mps_status (*save)(void *user); /* writes `path` */
  void *user;
  int64_t count; /* multiples of `every` that have passed: resume_schedule_at */
  bool lost;     /* the last one could not be written */
  bool saved;    /* the last one was written */
} resume_schedule;

/* Where a run begins or continues (`now` as `every`): what was due until then is not due again. */
void resume_schedule_at(resume_schedule *s, double now);
bool resume_is_due(const resume_schedule *s, double now);
void resume_save_when_due(app *a, resume_schedule *s, double now);
void resume_save_now(app *a, resume_schedule *s);
/* resume_restore of a fluid; *restarted: the time (s) from which the run continues, also for what
 * is due. */
mps_status resume_go_on(mps_context *context, const resume *r, const char *path, double *restarted,
                        resume_schedule *s);
/* "To go on: ..." on stdout, after Ctrl-C, where a checkpoint was written. */
void resume_tell(const resume_schedule *s);
