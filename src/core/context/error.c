/* error.c - the record of an error on the context, and the log.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "context_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *mps_status_text(mps_status status) {
  switch (status) {
#define STATUS_CASE(name, value, text)                                                             \
  case MPS_##name:                                                                                 \
    return text;
    MPS_STATUS_TABLE(STATUS_CASE)
#undef STATUS_CASE
  default:
    return "unknown status code";
  }
}

/* The kind of object that a function belongs to: "mpm" of mps_mpm_step. */
static void name_kind(mps_error *error, const char *function) {
  const char *kind = strncmp(function, "mps_", 4) == 0 ? function + 4 : function;
  snprintf(error->object, sizeof error->object, "%.*s", (int)strcspn(kind, "_"), kind);
}

mps_status mpsi_fail(mps_context *context, const char *function, mps_status status,
                     const char *format, ...) {
  if (!context) return status;
  mps_error *error = &context->error;
  error->status = status;
  error->step = error->particle = -1;
  snprintf(error->function, sizeof error->function, "%s", function);
  name_kind(error, function);
  va_list args;
  va_start(args, format);
  vsnprintf(error->message, sizeof error->message, format, args);
  va_end(args);
  context->failures++;
  return status;
}

void mpsi_fail_where(mps_context *context, int64_t step, int64_t particle) {
  context->error.step = step;
  context->error.particle = particle;
}

void mpsi_fail_object(mps_context *context, const char *format, ...) {
  if (!context) return;
  va_list args;
  va_start(args, format);
  vsnprintf(context->error.object, sizeof context->error.object, format, args);
  va_end(args);
}

mps_status mpsi_as(mps_context *context, const char *function, mps_status status) {
  if (status == MPS_OK || !context) return status;
  mps_error *error = &context->error;
  mps_error former = *error;
  name_kind(&former, error->function);
  if (strcmp(former.object, error->object) == 0)
    name_kind(error, function); /* else it has a name */
  snprintf(error->function, sizeof error->function, "%s", function);
  return status;
}

mps_status mpsi_fail_of(mps_context *context, mps_status status, const char *argument) {
  if (status != MPS_ERROR_ARGUMENT || !context) return status;
  mps_error *error = &context->error;
  char *message = error->message;
  const size_t room = sizeof error->message, most = room / 4;
  const size_t length = strlen(argument) < most ? strlen(argument) : most, before = length + 2;
  if (strncmp(message, argument, length) == 0 && message[length] == ':') return status;
  const size_t rest = strlen(message) + before < room ? strlen(message) : room - 1 - before;
  memmove(message + before, message, rest);
  memcpy(message, argument, length);
  memcpy(message + length, ": ", 2);
  message[before + rest] = '\0';
  return status;
}

mps_status mpsi_fail_memory(mps_context *context, const char *function, size_t bytes) {
  return mpsi_fail(context, function, MPS_ERROR_MEMORY, "could not allocate %zu bytes", bytes);
}

int64_t mpsi_failures(const mps_context *context) { return context->failures; }

const mps_error *mps_context_error(const mps_context *context) {
  return context ? &context->error : NULL;
}

void mps_context_clear_error(mps_context *context) {
  if (!context) return;
  memset(&context->error, 0, sizeof context->error);
  context->error.step = context->error.particle = -1;
}

mps_status mps_context_set_error(mps_context *context, mps_status status, const char *function,
                                 const char *message) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (status <= MPS_OK || status > MPS_ERROR_INTERNAL || !message)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "status is %d with message %s, must be one of MPS_ERROR_... with a message",
                     (int)status, message ? "given" : "NULL");
  return mpsi_fail(context, function ? function : "caller", status, "%s", message);
}

void mpsi_log(mps_context *context, int32_t level, const char *format, ...) {
  if (!context->def.log) return;
  char message[512];
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  context->def.log(context->def.log_user, level, message);
}
