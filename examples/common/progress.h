/* progress.h - progress bar on a terminal and clean stop by Ctrl-C, wired to the context's hooks.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_PROGRESS_H
#define EXAMPLES_PROGRESS_H

#include <mps/context.h>

#include <stdbool.h>

typedef struct progress {
  bool terminal; /* stderr is one: otherwise nothing is drawn */
  bool drawn;
  double started; /* s, monotonic clock */
} progress;

enum { PROGRESS_LAST_LINE = 1400 };

/* Starts the clock and, from now on, turns the first Ctrl-C into a request to stop; a second one
 * kills the program as usual. A write beyond a limit on the size of files fails like one to a full
 * disk, instead of killing the program. */
void progress_start(progress *bar);
/* From now on SIGTERM and SIGUSR1 are requests to stop too: mpirun and srun send them to ranks. */
void progress_heed_launcher(void);
/* Draws the bar: `fraction` in 0..1, `text` a few words. */
void progress_draw(progress *bar, double fraction, const char *text);
/* Takes the bar off the terminal, before a line is printed. */
void progress_clear(progress *bar);
/* Ctrl-C was pressed. */
bool progress_interrupted(void);
/* For a computation that nothing can stop, such as the factorisation of a matrix: until the next
 * call with NULL, Ctrl-C prints `line` and ends the program at once with exit code 130. Meanwhile
 * no file may be open. */
void progress_leave_at_once(const char *line);

/* Hooks of a context; `user` is the progress (cancel: not used). */
void progress_hook(void *user, const mps_progress *p);
int32_t progress_cancel_hook(void *user);

#endif
