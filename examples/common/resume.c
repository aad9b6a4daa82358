/* resume.c - see resume.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "resume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OPTIONS = 2048 }; /* bytes of the options' text, which comes first */

/* A run may go on with others of these. */
static const char *const free_options[] = {"out",     "threads", "checkpoint", "every-checkpoint",
                                           "restart", NULL};

void resume_pass(resume_bytes *b, void *value, size_t size) {
  b->bytes += (int64_t)size;
  if (!b->at || b->status != MPS_OK) return;
  if (resume_wrong(b, b->bytes > b->size) || size == 0) return;
  if (b->reads)
    memcpy(value, b->at, size);
  else
    memcpy(b->at, value, size);
  b->at += size;
}

bool resume_wrong(resume_bytes *b, bool wrong) {
  if (b->reads && wrong && b->status == MPS_OK) b->status = MPS_ERROR_FORMAT;
  return b->status != MPS_OK;
}

/* Options and bytes into `info`, whose user_data is to be freed also after an error. */
static mps_status pack(const resume *r, mps_checkpoint *info) {
  char text[OPTIONS] = "";
  *info = mps_checkpoint_defaults();
  resume_bytes count = {0};
  r->pass(r->user, &count);
  info->user_bytes = OPTIONS + count.bytes;
  info->user_data = malloc((size_t)info->user_bytes);
  if (!info->user_data) return MPS_ERROR_MEMORY;
  snprintf(info->user_key, sizeof info->user_key, "%s", r->key);
  if (!options_record(r->table, free_options, text, sizeof text)) return MPS_ERROR_MEMORY;
  memcpy(info->user_data, text, OPTIONS);
  resume_bytes b = {.at = (char *)info->user_data + OPTIONS, .size = count.bytes};
  r->pass(r->user, &b);
  return MPS_OK;
}

static mps_status agree(const resume *r, mps_status status) {
  return r->domain ? mps_domain_agree(r->domain, status) : status;
}

mps_status resume_save(const resume *r, const char *path) {
  mps_checkpoint info;
  mps_status status = agree(r, pack(r, &info));
  if (status == MPS_OK)
    status = r->fluid ? mps_fluid_save(r->fluid, path, &info) : mps_mpm_save(r->mpm, path, &info);
  free(info.user_data);
  return status;
}

/* The bytes into `info`, whose user_data is to be freed. */
static mps_status read_bytes(mps_context *context, const resume *r, const char *path,
                             mps_checkpoint *info) {
  *info = mps_checkpoint_defaults();
  snprintf(info->user_key, sizeof info->user_key, "%s", r->key); /* the library compares it */
  mps_status status = mps_checkpoint_info(context, path, info);
  if (status != MPS_OK) return status;
  info->user_data = calloc((size_t)info->user_bytes + OPTIONS, 1);
  return info->user_data ? mps_checkpoint_info(context, path, info) : MPS_ERROR_MEMORY;
}

mps_status resume_peek(mps_context *context, const resume *r, const char *path, char *why,
                       size_t size) {
  mps_checkpoint info;
  char differs[600] = "";
  mps_status status = read_bytes(context, r, path, &info);
  why[0] = '\0';
  if (status == MPS_OK &&
      (!memchr(info.user_data, '\0', OPTIONS) ||
       !options_agree(r->table, free_options, info.user_data, differs, sizeof differs))) {
    snprintf(why, size, "%.150s was made with other options: %.200s", path, differs);
    status = MPS_ERROR_ARGUMENT;
  }
  free(info.user_data);
  return agree(r, status);
}

static mps_status unpack(const resume *r, const mps_checkpoint *info) {
  resume_bytes b = {
      .at = (char *)info->user_data + OPTIONS, .size = info->user_bytes - OPTIONS, .reads = true};
  r->pass(r->user, &b);
  resume_wrong(&b, b.bytes != b.size);
  return b.status;
}

mps_status resume_restore(mps_context *context, const resume *r, const char *path) {
  mps_checkpoint info;
  mps_status status = agree(r, read_bytes(context, r, path, &info));
  if (status == MPS_OK)
    status =
        r->fluid ? mps_fluid_restore(r->fluid, path, &info) : mps_mpm_restore(r->mpm, path, &info);
  if (status == MPS_OK) status = unpack(r, &info);
  free(info.user_data);
  return agree(r, status);
}

/* ---- on the way ------------------------------------------------------------------------------ */

void resume_default_path(const char **checkpoint, const char *out, char *path, size_t size) {
  if (*checkpoint) return;
  snprintf(path, size, "%s/checkpoint.h5", out);
  *checkpoint = path;
}

static int64_t due(const resume_schedule *s, double now) {
  return (int64_t)floor(now / s->every + 1e-9);
}

void resume_schedule_at(resume_schedule *s, double now) { s->count = due(s, now); }

/* A libmps without HDF5 writes none. */
void resume_save_now(app *a, resume_schedule *s) {
  if (!s->path) return;
  const mps_status status = s->save(s->user);
  const bool lost = status != MPS_OK && status != MPS_ERROR_UNSUPPORTED;
  if (lost && !s->lost) {
    const mps_error *error = mps_context_error(a->context);
    app_error(a, "no checkpoint is written, the run goes on: %s",
              error->status == status ? error->message : mps_status_text(status));
  }
  s->lost = lost, s->saved = status == MPS_OK;
}

bool resume_is_due(const resume_schedule *s, double now) { return due(s, now) > s->count; }

void resume_save_when_due(app *a, resume_schedule *s, double now) {
  if (!resume_is_due(s, now)) return;
  resume_schedule_at(s, now);
  resume_save_now(a, s);
}
