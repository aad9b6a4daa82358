/* app.h - what every example program carries through a run: its name for error lines, the library
 * context with its hooks, and its exit codes.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_APP_H
#define EXAMPLES_APP_H

#include "progress.h"

#include <mps/context.h>

#include <stdbool.h>
#include <stdint.h>

#if defined(__GNUC__) || defined(__clang__)
#define APP_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define APP_PRINTF(fmt, args)
#endif

/* Exit codes. */
enum { APP_OK = 0, APP_FAILED = 1, APP_USAGE = 2, APP_INTERRUPTED = 130 };

typedef struct app {
  const char *program; /* "mps-wave" */
  mps_context *context;
  progress bar;
  bool no_gnuplot; /* the note about it has been printed */
} app;

/* Creates the context on `threads` threads (0: all processors), its warnings and progress going to
 * stderr and Ctrl-C to its cancel hook. False, with an error line, when that fails. */
bool app_start(app *a, const char *program, int64_t threads);
/* Destroys the context and closes stdout. Returns `code`, or APP_FAILED when it was APP_OK but
 * what was printed could not be written. */
int app_finish(app *a, int code);

/* One line "program: ..." to stderr. Returns false, for `return app_error(...)`. */
bool app_error(app *a, const char *format, ...) APP_PRINTF(2, 3);
/* As app_error, out of memory. */
bool app_no_memory(app *a);
/* True for MPS_OK; otherwise prints the record of the context. */
bool app_check(app *a, mps_status status);

#endif
