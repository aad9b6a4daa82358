/* app.c - start, end and error lines of an example program.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "app.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void print_warning(void *user, int32_t level, const char *message) {
  app *a = user;
  if (level != MPS_LOG_WARNING) return;
  progress_clear(&a->bar);
  fprintf(stderr, "%s: warning: %s\n", a->program, message);
}

bool app_start(app *a, const char *program, int64_t threads) {
  *a = (app){.program = program, .outcome = "complete"};
  progress_start(&a->bar);
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

int app_finish(app *a, int code) {
  progress_clear(&a->bar);
  mps_context_destroy(&a->context);
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

bool app_error(app *a, const char *format, ...) {
  progress_clear(&a->bar);
  fprintf(stderr, "%s: ", a->program);
  va_list args;
  va_start(args, format);
  vfprintf(stderr, format, args);
  va_end(args);
  fputc('\n', stderr);
  return false;
}

bool app_no_memory(app *a) { return app_error(a, "out of memory"); }

bool app_check(app *a, mps_status status) {
  if (status == MPS_OK) return true;
  const mps_error *error = mps_context_error(a->context);
  if (!error || error->status != status) return app_error(a, "%s", mps_status_text(status));
  return app_error(a, "%s", error->message);
}

int app_end_run(app *a, mps_status status, double time, bool any) {
  a->outcome = status == MPS_OK                ? "complete"
               : status == MPS_ERROR_CANCELLED ? "interrupted"
                                               : "failed";
  if (status != MPS_ERROR_CANCELLED) return app_check(a, status) ? APP_OK : APP_FAILED;
  app_error(a, "interrupted at t = %.4g s: %s", time,
            any ? "the results end there" : "there are no results yet, nothing is written");
  return APP_INTERRUPTED;
}

void app_leave_at_once(const app *a, bool on) {
  char line[PROGRESS_LAST_LINE];
  if (a->results[0])
    snprintf(line, sizeof line, "%s: interrupted, written so far: %s", a->program, a->results);
  else
    snprintf(line, sizeof line, "%s: interrupted, nothing is written", a->program);
  progress_leave_at_once(on ? line : NULL);
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

void app_tell_results(const app *a, const char *directory) {
  printf("Results: %s/ (%s)\n", directory, a->results);
}
