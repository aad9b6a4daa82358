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

/* Starts the clock and, from now on, turns the first Ctrl-C into a request to stop; a second one
 * kills the program as usual. */
void progress_start(progress *bar);
/* Draws the bar: `fraction` in 0..1, `text` a few words. */
void progress_draw(progress *bar, double fraction, const char *text);
/* Takes the bar off the terminal, before a line is printed. */
void progress_clear(progress *bar);
/* Ctrl-C was pressed. */
bool progress_interrupted(void);

/* Hooks of a context; `user` is the progress (cancel: not used). */
void progress_hook(void *user, const mps_progress *p);
int32_t progress_cancel_hook(void *user);

#endif
