/* app.c - start, end and error lines of an example program.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "app.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void print_warning(void *user, mps_log_level level, const char *message) {
  app *a = user;
  if (level != MPS_LOG_WARNING) return;
  progress_clear(&a->bar);
  fprintf(stderr, "%s: warning: %s\n", a->program, message);
}

bool app_start(app *a, const char *program, int64_t threads) {
  *a = (app){.program = program};
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
