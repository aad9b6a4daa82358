/* history_file.c - a history as a CSV file: written whole, and followed by appending rows. The file
 * is cut where a rollback has dropped rows, and after a write that failed, so that it always ends
 * with a whole row. SPDX-License-Identifier: BSD-3-Clause */
#include "histories.h"
#include "io/replace.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CELL = 32 }; /* bytes of a number and a comma */

/* ---- text ------------------------------------------------------------------------------------ */

typedef struct text {
  char *at;
  int64_t used, capacity;
} text;

static bool reserve(mps_context *context, text *t, int64_t more) {
  void *at = t->at;
  if (t->used + more <= t->capacity) return true;
  const int64_t capacity = 2 * t->capacity + more;
  if (!mpsi_grow(context, &at, t->capacity, capacity, 1)) return false;
  t->at = at;
  t->capacity = capacity;
  return true;
}

/* A cell of the header; quotes within it are doubled. */
static void put_name(text *t, const mpsi_history_column *c) {
  char cell[2 * MPSI_HISTORY_TEXT + 2];
  const int name = (int)strlen(c->name);
  snprintf(cell, sizeof cell, "%s%s%s", c->name, *c->unit ? "_" : "", c->unit);
  for (int k = name; cell[k]; k++)
    if (cell[k] == '/' || cell[k] == ' ') cell[k] = '_';
  const bool quoted = strpbrk(cell, ",\"") || *cell == ' ';
  if (quoted) t->at[t->used++] = '"';
  for (int k = 0; cell[k]; k++) {
    if (cell[k] == '"') t->at[t->used++] = '"';
    t->at[t->used++] = cell[k];
  }
  if (quoted) t->at[t->used++] = '"';
}

static bool put_header(mps_context *context, const mps_history *h, text *t) {
  if (!reserve(context, t, h->width * (4 * MPSI_HISTORY_TEXT + 8))) return false;
  for (int64_t k = 0; k < h->width; k++) {
    put_name(t, &h->column[k]);
    t->at[t->used++] = k + 1 < h->width ? ',' : '\n';
  }
  return true;
}

/* The shortest of the usual forms that reads back as the same. */
static void put_number(text *t, double value) {
  int digits = 15, used = 0;
  char *at = t->at + t->used;
  do used = snprintf(at, CELL, "%.*g", digits, value);
  while (strtod(at, NULL) != value && digits++ < 17);
  t->used += used;
}

static bool put_row(mps_context *context, const mps_history *h, int64_t row, text *t) {
  if (!reserve(context, t, h->width * CELL)) return false;
  for (int64_t k = 0; k < h->width; k++) {
    const double value = h->row[row * h->width + k];
    if (!isnan(value)) put_number(t, value);
    t->at[t->used++] = k + 1 < h->width ? ',' : '\n';
  }
  return true;
}

/* Rows from `first` on, behind the header where that is 0. `end` (or NULL) gets the places in a
 * file in which end[first] is known, or 0 in one with the header. */
static bool put_rows(const mps_history *h, int64_t first, bool header, text *t, int64_t *end) {
  const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  if (plain == (locale_t)0) return false;
  const locale_t hosts = uselocale(plain);
  const int64_t start = end && !header ? end[first] : 0;
  bool good = !header || put_header(h->context, h, t);
  if (good && header && end) end[0] = t->used;
  for (int64_t k = first; good && k < h->rows; k++) {
    good = put_row(h->context, h, k, t);
    if (end) end[k + 1] = start + t->used;
  }
  (void)uselocale(hosts);
  freelocale(plain);
  return good;
}

/* False: errno. */
static bool write_text(int fd, const text *t) {
  for (int64_t done = 0; done < t->used;) {
    const ssize_t put = write(fd, t->at + done, (size_t)(t->used - done));
    if (put < 0 && errno == EINTR) continue;
    if (put == 0) errno = ENOSPC;
    if (put <= 0) return false;
    done += put;
  }
  return true;
}

/* ---- the whole file -------------------------------------------------------------------------- */

static mps_status replace(const mps_history *h, const char *function, const char *path,
                          int64_t *end) {
  mps_context *context = h->context;
  mpsi_replacement to;
  text t = {NULL, 0, 0};
  mps_status status = mpsi_replace_begin(context, function, path, false, &to);
  if (status != MPS_OK) return status;
  if (!put_rows(h, 0, true, &t, end))
    status = mpsi_fail_memory(context, function, (size_t)(h->rows * h->width * CELL));
  else if (!write_text(to.fd, &t))
    status = mpsi_fail_io(context, function, "write", to.part, errno);
  mpsi_free(context, t.at);
  if (status == MPS_OK) return mpsi_replace_commit(context, function, &to);
  mpsi_replace_abandon(context, &to);
  return status;
}

mps_status mpsi_history_write_file(const mps_history *h, const char *function, const char *path) {
  return replace(h, function, path, NULL);
}

mps_status mpsi_history_try_path(mps_context *context, const char *function, const char *path) {
  mpsi_replacement to;
  const mps_status status = mpsi_replace_begin(context, function, path, false, &to);
  if (status == MPS_OK) mpsi_replace_abandon(context, &to);
  return status;
}

/* ---- the file that follows the rows ---------------------------------------------------------- */

static mps_status begin_file(mps_history *h, const char *function) {
  mpsi_history_file *f = &h->file;
  MPSI_TRY(replace(h, function, f->path, f->end));
  f->fd = open(f->path, O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC);
  if (f->fd < 0) return mpsi_fail_io(h->context, function, "open", f->path, errno);
  f->rows = h->rows;
  return MPS_OK;
}

mps_status mpsi_history_append(mps_history *h, const char *function) {
  mpsi_history_file *f = &h->file;
  void *end = f->end;
  if (h->rows + 1 > f->ends) {
    const int64_t more = 2 * h->rows + 64;
    if (!mpsi_grow(h->context, &end, f->ends, more, sizeof *f->end))
      return mpsi_fail_memory(h->context, function, (size_t)more * sizeof *f->end);
    f->end = end, f->ends = more;
  }
  if (f->fd < 0) return begin_file(h, function);
  text t = {NULL, 0, 0};
  mps_status status = MPS_OK;
  if (!put_rows(h, f->rows, false, &t, f->end))
    status =
        mpsi_fail_memory(h->context, function, (size_t)((h->rows - f->rows) * h->width * CELL));
  else if (ftruncate(f->fd, (off_t)f->end[f->rows]) != 0 || !write_text(f->fd, &t))
    status = mpsi_fail_io(h->context, function, "write", f->path, errno);
  if (status == MPS_OK)
    f->rows = h->rows;
  else if (ftruncate(f->fd, (off_t)f->end[f->rows]) != 0) /* the next write cuts it again */
    mpsi_log(h->context, MPS_CONTEXT_LOG_WARNING, "'%.300s' ends with a part of a row", f->path);
  mpsi_free(h->context, t.at);
  return status;
}

void mpsi_history_close_file(mps_history *h) {
  mpsi_history_file *f = &h->file;
  if (f->fd >= 0) close(f->fd);
  MPSI_FREE(h->context, f->path, f->end);
  *f = (mpsi_history_file){.fd = -1};
}
