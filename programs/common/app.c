/* app.c - start, end and error lines of an example program.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "app.h"

#include "options.h"
#include "page.h"
#include "ranks.h"
#include "table.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void note_warning(app *a, const char *message) {
  if (a->rank > 0) return;
  for (int k = 0; k < a->warnings;
       k++) /* that of the run which this one continues from, or again */
    if (strcmp(a->warning[k], message) == 0) return;
  if (a->warnings < 2) {
    progress_clear(&a->bar);
    fprintf(stderr, "%s: warning: %s%s\n", a->program, message,
            a->warnings == 1 ? " (summary.json lists further ones)" : "");
  }
  char *copy = a->warnings < APP_WARNINGS ? strdup(message) : NULL;
  if (copy) a->warning[a->warnings++] = copy;
}

static void print_warning(void *user, int32_t level, const char *message) {
  app *a = user;
  if (level == MPS_CONTEXT_LOG_WARNING && !a->no_warnings) note_warning(a, message);
}

static bool make_context(app *a, int64_t threads) {
  mps_context_def def = mps_context_defaults();
  def.threads = (int32_t)threads;
  def.log = print_warning;
  def.log_user = a;
  def.progress = progress_hook;
  def.progress_user = &a->bar;
  def.cancel = progress_cancel_hook;
  char why[256];
  if (mps_context_create(&def, &a->context, why, sizeof why) != MPS_OK)
    return app_error(a, "%s", why);
  return true;
}

/* The number of threads belongs to the context and the ranks agree upon it by a temporary domain.
 */
static bool join(app *a, int64_t threads) {
  mps_context_def def = mps_context_defaults();
  mps_context *early = NULL;
  mps_domain *first = NULL;
  char why[512];
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  bool ok = mps_context_create(&def, &early, why, sizeof why) == MPS_OK &&
            ranks_join(early, &first, why, sizeof why);
  if (!ok) app_error(a, "%s", why);
  int64_t share = 1;
  if (ok) ok = ranks_threads(first, &share) == MPS_OK;
  if (ok) { /* all are here: from now on an error on one is an error on all */
    double failed = !make_context(a, threads > 0 ? threads : share);
    const bool own = failed == 0.0;
    ok = mps_domain_max(first, 1, &failed) == MPS_OK && failed == 0.0 && own;
  }
  if (ok && !ranks_join(a->context, &a->domain, why, sizeof why)) ok = app_error(a, "%s", why);
  mps_domain_destroy(&first);
  mps_context_destroy(&early);
  if (ok)
    ok = app_agree(a, ranks_same_options(a->domain, why, sizeof why) || app_error(a, "%s", why));
  return ok;
}

bool app_start(app *a, const char *program, int64_t threads) {
  *a = (app){.program = program, .outcome = "finished", .rank = ranks_number()};
  progress_start(&a->bar, program);
  char doubt[200];
  for (int k = 0; options_doubt(k, doubt, sizeof doubt); k++) note_warning(a, doubt);
  for (int k = 0; options_noted(k); k++) note_warning(a, options_noted(k));
  if (*table_note()) note_warning(a, table_note());
  if (ranks_launched() == 1) return make_context(a, threads);
  progress_heed_launcher();
  a->bar.terminal = a->bar.terminal && a->rank == 0;
  return join(a, threads);
}

bool app_agree(app *a, bool ok) {
  if (!a->domain) return ok;
  const int32_t ranks = mps_domain_size(a->domain);
  double worst = ok ? 0.0 : ranks - a->rank; /* the lowest failed rank reports */
  const mps_status status = mps_domain_max(a->domain, 1, &worst);
  if (status != MPS_OK) return app_check(a, status);
  if (worst == 0.0) return true;
  a->agreed = true;
  if (a->rank > 0 && worst == ranks - a->rank) {
    fprintf(stderr, "%s: rank %d: %s\n", a->program, (int)a->rank, a->line);
    fflush(stderr);
  }
  return false;
}

mps_status app_settle(app *a, mps_status status) {
  return a->domain ? mps_domain_agree(a->domain, status) : status;
}

/* Two numbers for each value, since no NaN may be among them. */
mps_status app_share(app *a, bool mine, int count, double *values) {
  if (!a->domain) return MPS_OK;
  double *both = calloc(2 * (size_t)count + 1, sizeof *both);
  mps_status status = mps_domain_agree(a->domain, both ? MPS_OK : MPS_ERROR_MEMORY);
  for (int k = 0; status == MPS_OK && k < count; k++) {
    const bool none = isnan(values[k]);
    both[2 * k] = !mine ? -INFINITY : none ? 0.0 : values[k];
    both[2 * k + 1] = mine && none;
  }
  if (status == MPS_OK) status = mps_domain_max(a->domain, 2 * count, both);
  for (int k = 0; status == MPS_OK && k < count; k++)
    values[k] = both[2 * k + 1] == 1.0 ? NAN : both[2 * k];
  free(both);
  return status;
}

int app_finish(app *a, int code) {
  progress_clear(&a->bar);
  if (a->domain && code == APP_FAILED && !a->agreed) {
    /* the other ranks may wait for this one: an exit without MPI_Finalize ends them all */
    if (a->rank > 0) fprintf(stderr, "%s: rank %d: %s\n", a->program, (int)a->rank, a->line);
    fflush(NULL);
    _exit(code);
  }
  ranks_drop_solver(&a->equations);
  mps_domain_destroy(&a->domain);
  mps_context_destroy(&a->context);
  while (a->warnings > 0) free(a->warning[--a->warnings]);
  if (code == APP_OK && progress_interrupted()) {
    app_error(a, "interrupted: the results were complete");
    code = APP_INTERRUPTED;
  }
  const bool bad = ferror(stdout) != 0;
  if ((fclose(stdout) != 0 || bad) && code == APP_OK) {
    app_error(a, "standard output: %s", errno ? strerror(errno) : "write error");
    code = APP_FAILED;
  }
  return code;
}

static bool inside_character(char c) { return ((unsigned char)c & 0xc0) == 0x80; } /* of UTF-8 */

void app_print_line(const char *format, va_list args) {
  enum { MOST = 900, FIRST = 500, LAST = 350 };
  char line[16384];
  vsnprintf(line, sizeof line, format, args);
  const size_t length = strlen(line);
  if (length <= MOST) {
    fprintf(stderr, "%s\n", line);
    return;
  }
  size_t first = FIRST, last = length - LAST;
  while (inside_character(line[first])) first--;
  while (inside_character(line[last])) last++;
  fprintf(stderr, "%.*s ... %s\n", (int)first, line, line + last);
}

bool app_error(app *a, const char *format, ...) {
  va_list args;
  va_start(args, format);
  if (a->rank > 0) {
    vsnprintf(a->line, sizeof a->line, format, args);
  } else {
    progress_clear(&a->bar);
    fprintf(stderr, "%s: ", a->program);
    app_print_line(format, args);
  }
  va_end(args);
  return false;
}

bool app_lacks_hdf5(app *a, mps_status status) {
  if (status != MPS_ERROR_UNSUPPORTED) return false;
  if (mps_library_has(MPS_FEATURE_HDF5) && !a->no_hdf5)
    app_warn(a, "no series and no checkpoint is written: %s",
             mps_context_error(a->context)->message);
  a->no_hdf5 = true;
  return true;
}

void app_warn(app *a, const char *format, ...) {
  char line[500];
  va_list args;
  va_start(args, format);
  vsnprintf(line, sizeof line, format, args);
  va_end(args);
  note_warning(a, line);
}

bool app_no_memory(app *a) { return app_error(a, "out of memory"); }

bool app_check(app *a, mps_status status) {
  if (status == MPS_OK) return true;
  const mps_error *error = mps_context_error(a->context);
  if (!error || error->status != status) return app_error(a, "%s", mps_status_text(status));
  return app_error(a, "%s", error->message);
}

int app_end_run(app *a, mps_status status, double time, bool any) {
  a->outcome = status == MPS_OK                ? "finished"
               : status == MPS_ERROR_CANCELLED ? "interrupted"
                                               : "failed";
  if (status != MPS_ERROR_CANCELLED) return app_check(a, status) ? APP_OK : APP_FAILED;
  app_error(a, "interrupted at t = %.4g s: %s", time,
            any ? "the results end there" : "there are no results yet");
  return APP_INTERRUPTED;
}

static void forget_reserved(app *a) {
  if (a->reserved[0]) unlink(a->reserved[0]);
  for (int k = 0; k < 2; k++) {
    free(a->reserved[k]);
    a->reserved[k] = NULL;
  }
}

void app_leave_at_once(app *a, bool on) {
  char line[PROGRESS_LAST_LINE - 8];
  const char *slash = a->reserved[1] ? strrchr(a->reserved[1], '/') : NULL;
  if (a->results[0])
    snprintf(line, sizeof line, "%s: interrupted, written so far: %s%s%s", a->program, a->results,
             slash ? ", " : "", slash ? slash + 1 : "");
  else
    snprintf(line, sizeof line, "%s: interrupted: there are no results yet", a->program);
  /* of several ranks, mpirun ends all */
  progress_leave_at_once(on && a->rank == 0 ? line : NULL, a->reserved[0], a->reserved[1]);
  if (!on) forget_reserved(a);
}

/* ---- what was written ------------------------------------------------------------------------ */

static bool ends_with(const char *name, const char *end) {
  const size_t n = strlen(name), m = strlen(end);
  return n >= m && strcmp(name + n - m, end) == 0;
}

/* The name is a whole item of the list "a, b, c". */
static bool is_listed(const char *list, const char *name) {
  const size_t n = strlen(name);
  for (const char *at = strstr(list, name); at; at = strstr(at + 1, name))
    if ((at == list || at[-1] == ' ') && (at[n] == ',' || at[n] == '\0')) return true;
  return false;
}

void app_wrote(app *a, const char *path) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  const size_t used = strlen(a->results);
  if (ends_with(name, ".gp") || is_listed(a->results, name)) return;
  if (used + strlen(name) + 3 > sizeof a->results) return;
  snprintf(a->results + used, sizeof a->results - used, "%s%s", used ? ", " : "", name);
}

void app_tell_results(app *a, const char *directory) {
  if (a->rank == 0) (void)page_write(a, directory); /* an error line says why */
  printf("Results: %s/ (%s)\n", directory, a->results);
}
