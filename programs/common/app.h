/* app.h - common parts of the example programs: the name for error lines, the library context with
 * its hooks, and exit codes.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "progress.h"

#include <mps/experimental/domain.h>

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>

#if defined(__GNUC__) || defined(__clang__)
#define APP_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define APP_PRINTF(fmt, args)
#endif

/* Exit codes. */
enum { APP_OK = 0, APP_FAILED = 1, APP_USAGE = 2, APP_INTERRUPTED = 130 };

enum { APP_WARNINGS = 16 };

typedef struct app {
  const char *program; /* "mps-wave" */
  mps_context *context;
  progress bar;
  bool no_gnuplot;             /* the note about it has been printed */
  bool no_hdf5;                /* app_lacks_hdf5 has warned */
  bool no_warnings;            /* the library's are not printed: the program expects them */
  const char *outcome;         /* of the run: "finished", "interrupted", "failed" or "diverged" */
  char *warning[APP_WARNINGS]; /* the first ones, for summary.json */
  int warnings;
  char results[1024]; /* names of the files written */
  char *reserved[2];  /* output_reserve: present and final name of the file; NULL: none */
  /* of several ranks */
  mps_domain *domain; /* NULL: one process */
  int32_t rank;       /* rank 0 prints and writes; 0 of one process */
  void *equations;    /* ranks_solve */
  bool agreed;        /* an error is known to all ranks */
  char line[700];     /* the error line of this rank */
} app;

/* Creates the context on `threads` threads (0: all processors), its warnings and progress going to
 * stderr, and Ctrl-C, SIGTERM and SIGHUP to its cancel hook. False, with an error line, when that
 * fails. Where mpirun has started several ranks, with the domain for the solvers, and `threads` of
 * each rank (0: its part of the node); one of these signals, or SIGUSR1, to any rank then stops
 * all. */
bool app_start(app *a, const char *program, int64_t threads);
/* After work that differs between ranks: true where `ok` on all ranks. Else one rank reports the
 * error, and all return false. Collective; what the library does on all ranks is agreed upon by
 * itself, but a rank that fails alone must come here before the next collective call. */
bool app_agree(app *a, bool ok);
/* Sends `values` of the one rank where they are `mine` to all, bit for bit except for the kind of a
 * NaN. Nothing to do in one process. Collective. */
mps_status app_share(app *a, bool mine, int count, double *values);
/* mps_domain_agree of the ranks; `status` in one process. */
mps_status app_settle(app *a, mps_status status);

/* Destroys the context and closes stdout. Returns `code`; where it was APP_OK, APP_FAILED when what
 * was printed could not be written, and APP_INTERRUPTED, with a line that says so, when Ctrl-C came
 * too late to stop anything. */
int app_finish(app *a, int code);

/* One line "program: ..." to stderr; of several ranks rank 0 prints it, the others keep theirs for
 * app_agree. Returns false, for `return app_error(...)`. */
bool app_error(app *a, const char *format, ...) APP_PRINTF(2, 3);
/* One line "program: warning: ..." to stderr, as of the library's warnings: of the first two. All
 * of them are in summary.json. */
void app_warn(app *a, const char *format, ...) APP_PRINTF(2, 3);
/* A line on stderr. Of one that a value of thousands of characters makes too long, beginning and
 * end are printed. */
void app_print_line(const char *format, va_list args);

/* As app_error, out of memory. */
bool app_no_memory(app *a);
/* True for MPS_OK; otherwise prints the record of the context. */
bool app_check(app *a, mps_status status);

/* Reports how a run ended at `time` (s), and sets `outcome`. Prints nothing for MPS_OK; else one
 * line, which for Ctrl-C (MPS_ERROR_CANCELLED) says whether there are results to write (`any`).
 * Returns the exit code. */
int app_end_run(app *a, mps_status status, double time, bool any);

/* Around an uninterruptible computation, such as the factorisation of a matrix: while `on`, Ctrl-C
 * ends the program at once, with a line that names the files written so far and exit code 130. None
 * may be open. The file of output_reserve gets its final name then; once this is off, it is
 * removed. */
void app_leave_at_once(app *a, bool on);

/* After a call that writes HDF5: true where the run continues without, by `status`. A library that
 * was built with HDF5 and cannot write (it does not load) is warned of, once. */
bool app_lacks_hdf5(app *a, mps_status status);

/* Notes a result file that is complete. */
void app_wrote(app *a, const char *path);
/* Writes index.html of the files written, and prints "Results: DIR/ (files)". */
void app_tell_results(app *a, const char *directory);
