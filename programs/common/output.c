/* output.c - result files: one program writes into a directory at a time, every write is checked,
 * and only complete files get their name.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "output.h"

#include "options.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- directory ------------------------------------------------------------------------------- */

static bool make_one(app *a, const char *path) {
  struct stat info;
  if (mkdir(path, 0777) == 0) return true;
  const int reason = errno;
  if (stat(path, &info) == 0 && S_ISDIR(info.st_mode)) return true;
  return app_error(a, "cannot make the directory %s: %s", path,
                   strerror(reason == EEXIST ? ENOTDIR : reason));
}

/* A lock ends with the process, however that ends. NFS locks no directory, but files of it; where
 * neither can be locked, nothing is. */
static int lock(int directory) {
  int fd = directory, result = flock(fd, LOCK_EX | LOCK_NB);
  if (result != 0 && errno != EWOULDBLOCK) {
    fd = openat(directory, ".lock", O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    result = fd < 0 ? 0 : flock(fd, LOCK_EX | LOCK_NB);
    if (fd < 0) fd = directory;
  }
  const bool busy = result != 0 && errno == EWOULDBLOCK;
  if (fd != directory) close(directory);
  if (busy) close(fd);
  return busy ? -1 : fd;
}

/* Of this process until its end. It may ask for the directory that it asked for last again. */
static bool lock_directory(app *a, const char *path) {
  static dev_t device;
  static ino_t number;
  static int held = -1;
  struct stat info;
  const int directory = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return true; /* without the right to read it */
  const bool known = fstat(directory, &info) == 0;
  if (known && held >= 0 && device == info.st_dev && number == info.st_ino) {
    close(directory);
    return true;
  }
  const int fd = lock(directory);
  if (fd < 0)
    return app_error(a, "another program is writing into the directory %s: choose another --out",
                     path);
  held = fd;
  if (known) device = info.st_dev, number = info.st_ino;
  return true;
}

bool output_directory(app *a, const char *path) {
  char *copy = strdup(path);
  if (!copy) return app_no_memory(a);
  bool ok = true;
  for (char *slash = strchr(copy + 1, '/'); ok && slash; slash = strchr(slash + 1, '/')) {
    *slash = '\0';
    ok = make_one(a, copy);
    *slash = '/';
  }
  ok = ok && make_one(a, copy);
  free(copy);
  if (ok && access(path, W_OK | X_OK) != 0)
    return app_error(a, "cannot write into the directory %s: %s", path, strerror(errno));
  return ok && lock_directory(a, path);
}

/* ---- files ----------------------------------------------------------------------------------- */

static char *join(const char *directory, const char *name, const char *suffix) {
  const size_t size = strlen(directory) + strlen(name) + strlen(suffix) + 2;
  char *path = malloc(size);
  if (path) snprintf(path, size, "%s/%s%s", directory, name, suffix);
  return path;
}

static void forget(output *file) {
  free(file->path);
  free(file->temporary);
  free(file->columns);
  *file = (output){0};
}

int output_exclusive(const char *path) {
  struct stat info;
  if (lstat(path, &info) == 0) {
    if (!S_ISREG(info.st_mode)) {
      errno = EEXIST;
      return -1;
    }
    unlink(path); /* of a program that was killed: the directory is locked */
  }
  return open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

bool output_open(output *file, app *a, const char *directory, const char *name) {
  *file = (output){.a = a};
  file->path = join(directory, name, "");
  file->temporary = join(directory, name, ".part");
  if (!file->path || !file->temporary) {
    forget(file);
    return app_no_memory(a);
  }
  const int fd = output_exclusive(file->temporary);
  file->stream = fd < 0 ? NULL : fdopen(fd, "w");
  if (file->stream) return true;
  app_error(a, "cannot write %s: %s", file->temporary,
            errno == EEXIST ? "something that is no file has this name" : strerror(errno));
  if (fd >= 0) close(fd);
  forget(file);
  return false;
}

bool output_close(output *file) {
  if (!file->stream) return false;
  if (fflush(file->stream) != 0 && !file->error) file->error = errno;
  if (fclose(file->stream) != 0 && !file->error) file->error = errno;
  bool ok = file->error == 0;
  if (ok && rename(file->temporary, file->path) != 0) {
    file->error = errno;
    ok = false;
  }
  if (ok) {
    app_wrote(file->a, file->path);
    if (file->bad[0]) app_warn(file->a, "%s: %s", file->path, file->bad);
  } else {
    app_error(file->a, "cannot write %s: %s", file->path, strerror(file->error));
    unlink(file->temporary);
  }
  forget(file);
  return ok;
}

void output_discard(output *file) {
  if (file->stream) fclose(file->stream), unlink(file->temporary);
  forget(file);
}

bool output_reserve(output *file) {
  if (!file->stream) return false;
  char *path = file->path, *temporary = file->temporary;
  if (fflush(file->stream) != 0 && !file->error) file->error = errno;
  if (fclose(file->stream) != 0 && !file->error) file->error = errno;
  app *a = file->a;
  const bool ok =
      file->error == 0 || app_error(a, "cannot write %s: %s", path, strerror(file->error));
  if (ok) {
    free(a->reserved[0]);
    free(a->reserved[1]);
    a->reserved[0] = temporary, a->reserved[1] = path;
    file->temporary = file->path = NULL;
  } else {
    unlink(temporary);
  }
  forget(file);
  return ok;
}

void output_list(output *file, const char *format, va_list args) {
  if (file->stream && vfprintf(file->stream, format, args) < 0 && !file->error)
    file->error = errno ? errno : EIO;
}

void output_text(output *file, const char *format, ...) {
  va_list args;
  va_start(args, format);
  output_list(file, format, args);
  va_end(args);
}

/* ---- numbers --------------------------------------------------------------------------------- */

const char *output_number(char text[32], double value) {
  for (int digits = 6; digits <= 17; digits++) {
    snprintf(text, 32, "%.*g", digits, value);
    if (strtod(text, NULL) == value) break;
  }
  return text;
}

void csv_header(output *file, const char *columns) {
  free(file->columns);
  file->columns = strdup(columns);
  if (!file->columns && !file->error) file->error = ENOMEM;
  for (const char *c = columns; *c; c++)
    if (*c != '?') output_text(file, "%c", *c);
  output_text(file, "\n");
}

bool csv_open(output *file, app *a, const char *directory, const char *name, const char *columns) {
  if (!output_open(file, a, directory, name)) return false;
  csv_header(file, columns);
  return true;
}

/* The name of column `k`, without its question mark; true where it has one. */
static bool find_column(const output *file, int64_t k, char name[64]) {
  const char *at = file->columns ? file->columns : "";
  for (int64_t i = 0; i < k && *at; i++) at += strcspn(at, ",") + (strchr(at, ',') != NULL);
  size_t length = strcspn(at, ",");
  const bool optional = length > 0 && at[length - 1] == '?';
  if (optional) length--;
  if (length > 0)
    snprintf(name, 64, "%.*s", (int)(length < 63 ? length : 63), at);
  else
    snprintf(name, 64, "column %lld", (long long)k + 1);
  return optional;
}

/* `first`: the column of values[0]. */
static void write_row(output *file, int64_t first, int64_t count, const double *values) {
  file->rows++;
  for (int64_t i = 0; i < count; i++) {
    char name[64];
    if (i > 0) output_text(file, ",");
    if (isfinite(values[i])) {
      output_text(file, "%.9g", values[i]);
    } else if (!find_column(file, first + i, name) && !file->bad[0]) {
      snprintf(file->bad, sizeof file->bad, "%s of row %lld is not a number: the cell is empty",
               name, (long long)file->rows);
    }
  }
  output_text(file, "\n");
}

void csv_row(output *file, int64_t count, const double *values) {
  write_row(file, 0, count, values);
}

void csv_named_row(output *file, const char *text, int64_t count, const double *values) {
  int64_t first = 1;
  for (const char *c = text; *c; c++) first += *c == ',';
  output_text(file, "%s,", text);
  write_row(file, first, count, values);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

void json_begin(output *file) {
  output_text(file, "{");
  file->first = true;
}

static void json_key(output *file, const char *key) {
  output_text(file, "%s\n  \"%s\": ", file->first ? "" : ",", key);
  file->first = false;
}

void json_number(output *file, const char *key, double value) {
  char text[32];
  json_key(file, key);
  output_text(file, "%s", isfinite(value) ? output_number(text, value) : "null");
}

void json_numbers(output *file, int64_t count, const json_pair *pairs) {
  for (int64_t k = 0; k < count; k++) json_number(file, pairs[k].key, pairs[k].value);
}

void json_integer(output *file, const char *key, int64_t value) {
  json_key(file, key);
  output_text(file, "%lld", (long long)value);
}

void json_number_if(output *file, bool known, const char *key, double value) {
  json_number(file, key, known ? value : NAN);
}

void json_integer_if(output *file, bool known, const char *key, int64_t value) {
  if (known)
    json_integer(file, key, value);
  else
    json_number(file, key, NAN);
}

static void write_string(output *file, const char *text) {
  output_text(file, "\"");
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    if (*c == '"' || *c == '\\')
      output_text(file, "\\%c", *c);
    else if (*c < 0x20)
      output_text(file, "\\u%04x", *c);
    else
      output_text(file, "%c", *c);
  }
  output_text(file, "\"");
}

void json_text(output *file, const char *key, const char *text) {
  json_key(file, key);
  write_string(file, text);
}

void json_end(output *file) { output_text(file, "\n}\n"); }

/* ---- summary.json ---------------------------------------------------------------------------- */

/* On one line: the names are also those of results, which other programs look for by line. */
static void write_options(output *file) {
  const char *sep = "";
  char value[600];
  json_key(file, "options");
  output_text(file, "{");
  for (const option *o = options_read(); o && (o->name || o->help); o++) {
    if (!o->name || options_free(o->name)) continue;
    options_json(o, value, sizeof value);
    output_text(file, "%s\"%s\": %s", sep, o->name, value);
    sep = ", ";
  }
  output_text(file, "}");
}

static void write_warnings(output *file, const app *a) {
  json_key(file, "warnings");
  output_text(file, "[");
  for (int k = 0; k < a->warnings; k++) {
    if (k > 0) output_text(file, ", ");
    write_string(file, a->warning[k]);
  }
  output_text(file, "]");
}

bool summary_open(output *file, app *a, const char *directory) {
  if (!output_open(file, a, directory, "summary.json")) return false;
  json_begin(file);
  json_text(file, "program", a->program);
  json_text(file, "version", mps_version());
  json_text(file, "outcome", a->outcome);
  write_options(file);
  write_warnings(file, a);
  return true;
}

bool summary_bare(app *a, const char *directory) {
  output f;
  if (!summary_open(&f, a, directory)) return false;
  json_end(&f);
  return output_close(&f);
}

bool summary_reserve(app *a, const char *directory) {
  const char *outcome = a->outcome;
  output f;
  a->outcome = "interrupted";
  const bool opened = summary_open(&f, a, directory);
  a->outcome = outcome;
  if (!opened) return false;
  json_end(&f);
  return output_reserve(&f);
}
