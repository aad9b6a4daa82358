/* error.c - the record of an error on the context and on the thread, and the log.
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

/* A getter by its name in a program: without the _sized of the function behind it. */
static void name_function(mps_error *error, const char *function) {
  const size_t length = strlen(function), tail = strlen("_sized");
  const bool sized = length > tail && strcmp(function + length - tail, "_sized") == 0;
  snprintf(error->function, sizeof error->function, "%.*s", (int)(sized ? length - tail : length),
           function);
}

/* Where a failure is recorded: without a context on the thread alone. */
static mps_error *record_of(mps_context *context) {
  return context ? &context->error : &mpsi_thread_error;
}

/* Ends a change of the record of `context`: it is the thread's last one too. */
static void publish(const mps_context *context) {
  if (context) mpsi_thread_error = context->error;
}

mps_status mpsi_fail(mps_context *context, const char *function, mps_status status,
                     const char *format, ...) {
  if (!function) return status;
  mps_error *error = record_of(context);
  error->status = status;
  error->step = error->particle = -1;
  name_function(error, function);
  name_kind(error, function);
  va_list args;
  va_start(args, format);
  vsnprintf(error->message, sizeof error->message, format, args);
  va_end(args);
  if (context) context->failures++;
  publish(context);
  return status;
}

void mpsi_fail_where(mps_context *context, int64_t step, int64_t particle) {
  context->error.step = step;
  context->error.particle = particle;
  publish(context);
}

void mpsi_fail_object(mps_context *context, const char *format, ...) {
  mps_error *error = record_of(context);
  va_list args;
  va_start(args, format);
  vsnprintf(error->object, sizeof error->object, format, args);
  va_end(args);
  publish(context);
}

mps_status mpsi_null(const char *function, const char *argument) {
  return mpsi_fail(NULL, function, MPS_ERROR_ARGUMENT, "%s is NULL", argument);
}

mps_status mpsi_as(mps_context *context, const char *function, mps_status status) {
  if (status == MPS_OK) return status;
  mps_error *error = record_of(context);
  mps_error former = *error;
  name_kind(&former, error->function);
  if (strcmp(former.object, error->object) == 0)
    name_kind(error, function); /* else it has a name */
  name_function(error, function);
  publish(context);
  return status;
}

mps_status mpsi_fail_of(mps_context *context, mps_status status, const char *argument) {
  if (status != MPS_ERROR_ARGUMENT) return status;
  mps_error *error = record_of(context);
  char *message = error->message;
  const size_t capacity = sizeof error->message, most = capacity / 4;
  const size_t length = strlen(argument) < most ? strlen(argument) : most, before = length + 2;
  if (strncmp(message, argument, length) == 0 && message[length] == ':') return status;
  const size_t rest = strlen(message) + before < capacity ? strlen(message) : capacity - 1 - before;
  memmove(message + before, message, rest);
  memcpy(message, argument, length);
  memcpy(message + length, ": ", 2);
  message[before + rest] = '\0';
  publish(context);
  return status;
}

mps_status mpsi_fail_memory(mps_context *context, const char *function, size_t bytes) {
  return mpsi_fail(context, function, MPS_ERROR_MEMORY, "could not allocate %zu bytes", bytes);
}

int64_t mpsi_failures(const mps_context *context) { return context->failures; }

const mps_error *mps_context_error(const mps_context *context) {
  return context ? &context->error : &mpsi_thread_error;
}

void mps_context_clear_error(mps_context *context) {
  *record_of(context) = (mps_error){.step = -1, .particle = -1};
}

mps_status mps_context_set_error(mps_context *context, mps_status status, const char *function,
                                 const char *message) {
  if (!message) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "message is NULL");
  if (status <= MPS_OK || status > MPS_ERROR_INTERNAL)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "status is %s, must be one of MPS_ERROR_...",
                     mpsi_name_of("mps_status", status).text);
  return mpsi_fail(context, function ? function : "caller", status, "%s", message);
}
