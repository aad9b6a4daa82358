/* warnings.c - messages for the log hook, and the warnings that a context keeps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "context_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void keep(mps_context *context, const char *text) {
  int64_t k = 0;
  while (k < context->warnings && strcmp(context->warning[k].text, text) != 0) k++;
  if (k == MPSI_MOST_WARNINGS) return;
  if (k == context->warnings) context->warnings++;
  mps_context_warning *warning = &context->warning[k];
  warning->times++;
  memcpy(warning->text, text, strlen(text) + 1);
}

void mpsi_log(mps_context *context, int32_t level, const char *format, ...) {
  if (!context->def.log && level != MPS_CONTEXT_LOG_WARNING) return;
  char message[sizeof context->warning->text];
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  if (level == MPS_CONTEXT_LOG_WARNING) keep(context, message);
  if (context->def.log) context->def.log(context->def.log_user, level, message);
}

int64_t mps_context_warning_count(const mps_context *context) {
  return context ? context->warnings : 0;
}

mps_status mps_context_get_warning_sized(const mps_context *handle, int64_t index,
                                         mps_context_warning *out, size_t size) {
  static const char function[] = "mps_context_get_warning";
  mps_context *context = (mps_context *)handle; /* its record alone */
  if (!context) return mpsi_null(__func__, "context");
  if (index < 0 || index >= context->warnings)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "index is %lld, and the context has %lld warnings", (long long)index,
                     (long long)context->warnings);
  const mps_context_warning *warning = &context->warning[index];
  return mpsi_out_write(context, function, out, size, warning, sizeof *warning);
}

void mps_context_clear_warnings(mps_context *context) {
  if (!context) return;
  memset(context->warning, 0, sizeof context->warning);
  context->warnings = 0;
}
