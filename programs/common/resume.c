/* resume.c - see resume.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "resume.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OPTIONS = 2048 }; /* bytes of the options' text, which comes first */

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

bool resume_same(resume_bytes *b, const void *value, size_t size) {
  char *at = b->at;
  b->bytes += (int64_t)size;
  if (!at || b->status != MPS_OK || resume_wrong(b, b->bytes > b->size)) return true;
  b->at += size;
  if (b->reads) return memcmp(at, value, size) == 0;
  memcpy(at, value, size);
  return true;
}

/* The warnings so far; those of the file replace the present ones of this process. Of several ranks
 * only the first has them, and all must write the same: none. */
static void pass_warnings(const resume *r, resume_bytes *b) {
  app *a = r->a;
  int count = a && !r->domain ? a->warnings : 0;
  resume_pass(b, &count, sizeof count);
  if (resume_wrong(b, count < 0 || count > APP_WARNINGS || (count > 0 && !a))) return;
  if (b->reads)
    while (a && a->warnings > 0) free(a->warning[--a->warnings]);
  for (int k = 0; k < count; k++) {
    int length = b->reads ? 0 : (int)strlen(a->warning[k]);
    resume_pass(b, &length, sizeof length);
    if (resume_wrong(b, length < 0 || length > b->size)) return;
    if (b->reads && !(a->warning[k] = calloc((size_t)length + 1, 1))) {
      b->status = MPS_ERROR_MEMORY;
      return;
    }
    if (b->reads) a->warnings = k + 1;
    resume_pass(b, a->warning[k], (size_t)length);
  }
}

/* Options and bytes into `info`, whose user_data is to be freed also after an error. */
static mps_status pack(const resume *r, mps_checkpoint *info) {
  char text[OPTIONS] = "";
  *info = mps_checkpoint_defaults();
  resume_bytes count = {0};
  pass_warnings(r, &count);
  if (r->pass) r->pass(r->user, &count);
  info->user_bytes = OPTIONS + count.bytes;
  info->user_data = malloc((size_t)info->user_bytes);
  if (!info->user_data) return MPS_ERROR_MEMORY;
  snprintf(info->user_key, sizeof info->user_key, "%s", r->key);
  if (!options_record(r->table, text, sizeof text)) return MPS_ERROR_MEMORY;
  memcpy(info->user_data, text, OPTIONS);
  resume_bytes b = {.at = (char *)info->user_data + OPTIONS, .size = count.bytes};
  pass_warnings(r, &b);
  if (r->pass) r->pass(r->user, &b);
  return MPS_OK;
}

static mps_status agree(const resume *r, mps_status status) {
  return r->domain ? mps_domain_agree(r->domain, status) : status;
}

mps_status resume_save(const resume *r, const char *path) {
  mps_checkpoint info;
  mps_status status = agree(r, pack(r, &info));
  if (status == MPS_OK)
    status = r->fluid      ? mps_fluid_save(r->fluid, path, &info)
             : r->dynamics ? mps_dynamics_save(r->dynamics, path, &info)
                           : mps_mpm_save(r->mpm, path, &info);
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
       !options_agree(r->table, info.user_data, r->others, differs, sizeof differs))) {
    snprintf(why, size, "%.150s was made with other options: %.200s", path, differs);
    status = MPS_ERROR_ARGUMENT;
  }
  free(info.user_data);
  return agree(r, status);
}

static mps_status unpack(const resume *r, const mps_checkpoint *info) {
  resume_bytes b = {
      .at = (char *)info->user_data + OPTIONS, .size = info->user_bytes - OPTIONS, .reads = true};
  pass_warnings(r, &b);
  if (r->pass) r->pass(r->user, &b);
  resume_wrong(&b, b.bytes != b.size);
  return b.status;
}

mps_status resume_load(mps_context *context, const resume *r, const char *path) {
  mps_checkpoint info;
  mps_status status = agree(r, read_bytes(context, r, path, &info));
  if (status == MPS_OK) status = unpack(r, &info);
  free(info.user_data);
  return agree(r, status);
}

mps_status resume_restore(mps_context *context, const resume *r, const char *path) {
  mps_checkpoint info;
  mps_status status = agree(r, read_bytes(context, r, path, &info));
  if (status == MPS_OK)
    status = r->fluid      ? mps_fluid_restore(r->fluid, path, &info)
             : r->dynamics ? mps_dynamics_restore(r->dynamics, path, &info)
                           : mps_mpm_restore(r->mpm, path, &info);
  if (status == MPS_OK) status = unpack(r, &info);
  free(info.user_data);
  return agree(r, status);
}

resume resume_of_fluid(const char *key, const option *table, void (*pass)(void *, resume_bytes *),
                       void *user, mps_fluid *fluid, app *a) {
  return (resume){.key = key,
                  .table = table,
                  .pass = pass,
                  .user = user,
                  .fluid = fluid,
                  .a = a,
                  .domain = a->domain};
}

/* ---- on the way ------------------------------------------------------------------------------ */

static bool has_results(const char *directory) {
  char path[1300];
  struct stat info;
  return snprintf(path, sizeof path, "%s/summary.json", directory) < (int)sizeof path &&
         stat(path, &info) == 0;
}

static bool name_results(app *a, const char *restart, const char **out) {
  static char next[1200];
  mps_checkpoint info = mps_checkpoint_defaults();
  if (!restart || !has_results(*out)) return true;
  if (!app_check(a, mps_checkpoint_info(a->context, restart, &info))) return false;
  if (snprintf(next, sizeof next, "%s-from-%.6g", *out, info.time) >= (int)sizeof next)
    return app_error(a, "--out is too long");
  if (has_results(next))
    return app_error(a, "%s and %s have results already: --out must be another directory", *out,
                     next);
  *out = next;
  if (a->rank == 0) printf("Results go to %s\n", next);
  return true;
}

/* A new file needs a directory that is there. Of OUT/checkpoint.h5 it is made later. */
static bool check_directory(app *a, const char *path) {
  char directory[1200];
  const char *slash = strrchr(path, '/');
  if (!slash || slash == path) return true;
  if (snprintf(directory, sizeof directory, "%.*s", (int)(slash - path), path) >=
      (int)sizeof directory)
    return app_error(a, "--checkpoint is too long");
  if (access(directory, W_OK | X_OK) == 0) return true;
  return app_error(a, "cannot write --checkpoint %s: %s", path, strerror(errno));
}

/* What the library finds when it saves, before hours of computing. */
static bool check_place(app *a, const char *path) {
  mps_checkpoint info = mps_checkpoint_defaults();
  struct stat file;
  if (stat(path, &file) != 0) return check_directory(a, path);
  if (!S_ISREG(file.st_mode))
    return app_error(a, "--checkpoint is %s, a %s: it must be a new file or a checkpoint", path,
                     S_ISDIR(file.st_mode) ? "directory" : "device or pipe");
  if (file.st_size == 0) return true;
  const mps_status status = mps_checkpoint_info(a->context, path, &info);
  if (status != MPS_ERROR_FORMAT) return true;
  return app_error(a, "--checkpoint is %s, which is no checkpoint and is not replaced", path);
}

bool resume_places(app *a, const char *restart, const char **checkpoint, const char **out) {
  static char path[1200];
  struct stat info;
  if (!name_results(a, restart, out)) return false;
  if (*checkpoint && !mps_library_has(MPS_FEATURE_HDF5))
    return app_error(a, "--checkpoint needs a libmps with HDF5 (CMake option MPS_HDF5)");
  if (*checkpoint) return check_place(a, *checkpoint);
  if (snprintf(path, sizeof path, "%s/checkpoint.h5", *out) >= (int)sizeof path)
    return app_error(a, "--out is too long");
  *checkpoint = path;
  return stat(*out, &info) != 0 || check_place(a, path);
}

static int64_t due(const resume_schedule *s, double now) {
  return (int64_t)floor(now / s->every + 1e-9);
}

void resume_schedule_at(resume_schedule *s, double now) { s->count = due(s, now); }

void resume_save_now(app *a, resume_schedule *s) {
  if (!s->path) return;
  const mps_status status = s->save(s->user);
  const bool lost = status != MPS_OK && !app_lacks_hdf5(a, status);
  if (lost && !s->lost) {
    const mps_error *error = mps_context_error(a->context);
    app_error(a, "no checkpoint is written, the run goes on: %s",
              error->status == status ? error->message : mps_status_text(status));
  }
  s->lost = lost, s->saved = status == MPS_OK;
}

mps_status resume_go_on(mps_context *context, const resume *r, const char *path, double *restarted,
                        resume_schedule *s) {
  const mps_status status = resume_restore(context, r, path);
  *restarted = mps_fluid_time(r->fluid);
  resume_schedule_at(s, *restarted);
  return status;
}

bool resume_is_due(const resume_schedule *s, double now) { return due(s, now) > s->count; }

void resume_save_when_due(app *a, resume_schedule *s, double now) {
  if (!resume_is_due(s, now)) return;
  resume_schedule_at(s, now);
  resume_save_now(a, s);
}

void resume_tell(const resume_schedule *s) {
  if (s->saved) printf("To go on: the same command with --restart %s\n", s->path);
}
