/* progress.h - progress bar on a terminal and clean stop by Ctrl-C, wired to the context's hooks.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/context.h>

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

typedef struct progress {
  bool terminal; /* whether stderr is a terminal; if not, nothing is drawn */
  bool drawn;
  double started;      /* s, monotonic clock: when the bar was drawn first */
  double first, shown; /* fractions of the whole: drawn first, and last */
  double done, share;  /* fractions of the whole: before the present part, and of this part */
  double from, to; /* s, solver time at both ends of the part; equal: as the solver reports it */
  double call;     /* s, solver time at the begin of the solver's present call */
  /* of progress_by_clock */
  pthread_t clock;     /* the thread that draws */
  bool ticks;          /* the thread exists */
  atomic_bool stopped; /* asks the thread to end */
  double began, takes; /* s: when the part began, and its expected duration */
  const char *doing;   /* words beside the bar */
} progress;

enum { PROGRESS_LAST_LINE = 1400, PROGRESS_PATH = 1400 };

/* Starts the clock and, from now on, turns Ctrl-C, SIGTERM and SIGHUP (unless it is ignored, as
 * after nohup) into a request to stop. A second one changes nothing, as a terminal and a program
 * that started this one may both pass on the same; a third Ctrl-C ends the program at once, with
 * exit code 130 and a line after the name of the `program`. A write beyond a limit on the size of
 * files, or into a broken pipe, fails like one to a full disk, instead of killing the program. */
void progress_start(progress *bar, const char *program);
/* From now on SIGUSR1 is a request to stop too: mpirun and srun send it to ranks. */
void progress_heed_launcher(void);
/* The part `share` of the whole that the hook draws from now on, with `done` before it, in which
 * the solver's time goes from `from` to `to` (s). There is one bar, of all that a program does:
 * without parts the one call of the solver is the whole. A part of several calls sets `call` before
 * each: the solver passes the hook the time since then. */
void progress_part(progress *bar, double done, double share, double from, double to);
/* Draws the bar: `fraction` of the whole in 0..1, at least that drawn last; `text` a few words. */
void progress_draw(progress *bar, double fraction, const char *text);
/* Erases the bar from the terminal, before a line is printed. */
void progress_clear(progress *bar);
/* Ctrl-C was pressed, or another signal asked to stop. */
bool progress_interrupted(void);
/* For an uninterruptible computation, such as the factorisation of a matrix: until the next call
 * with NULL, Ctrl-C gives the file `part` the name `whole` (NULL: there is none), prints `line` and
 * ends the program at once with exit code 130. Meanwhile no file may be open. */
void progress_leave_at_once(const char *line, const char *part, const char *whole);
/* For a computation without a hook: until the next call a thread draws the bar by the clock, as a
 * part (progress_part) that takes some `seconds`; 0: no longer. A longer one slows down at the
 * part's end. */
void progress_by_clock(progress *bar, double seconds, const char *text);

/* Hooks of a context; `user` is the progress (cancel: not used). */
void progress_hook(void *user, const mps_context_progress *p);
int32_t progress_cancel_hook(void *user);
