/* history.c - histories of a solver (mps/history.h): columns, rows, and their place in its state.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain/domain_internal.h"
#include "histories.h"

#include <stdio.h>
#include <string.h>

static bool writes(const mps_history *h) { return mps_domain_rank(h->domain) <= 0; }

/* ---- creation -------------------------------------------------------------------------------- */

static mps_status check_name(mps_solver *s, const char *function, const char *name) {
  static const char allowed[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
  const size_t length = name ? strspn(name, allowed) : 0;
  if (!name) return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT, "name is NULL");
  if (length == 0 || length >= MPSI_HISTORY_NAME || name[length])
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                     "name is '%.60s', must be 1 to %d letters, digits, '_' or '-'", name,
                     MPSI_HISTORY_NAME - 1);
  for (const mps_history *h = s->histories; h; h = h->next)
    if (strcmp(h->name, name) == 0)
      return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                       "name is '%s', and the solver has a history of that name", name);
  return MPS_OK;
}

static mps_status read_text(mps_context *context, const char *function, const char *what, int64_t k,
                            int32_t least, const char *text, char *out) {
  const int32_t length = text ? (int32_t)strnlen(text, MPSI_HISTORY_TEXT) : 0;
  bool plain = length >= least && length < MPSI_HISTORY_TEXT;
  for (int32_t i = 0; i < length; i++) plain = plain && (unsigned char)text[i] >= ' ';
  if (!text)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s[%lld] is NULL", what, (long long)k);
  if (!plain)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s[%lld] is '%.60s', must be %d to %d bytes without line breaks", what,
                     (long long)k, text, least, MPSI_HISTORY_TEXT - 1);
  if (length > 0) memcpy(out, text, (size_t)length);
  return MPS_OK;
}

/* -1: none. */
static int64_t find(const mps_history *h, const char *name) {
  for (int64_t k = 0; name && k < h->width; k++)
    if (strcmp(h->column[k].name, name) == 0) return k;
  return -1;
}

static mps_status read_columns(mps_history *h, const char *function, const char *const *columns,
                               const char *const *units) {
  const int64_t width = h->width;
  memcpy(h->column[0].name, "t", 2);
  memcpy(h->column[0].unit, "s", 2);
  mps_status status = MPS_OK;
  for (h->width = 1; h->width < width && status == MPS_OK;) {
    const int64_t k = h->width - 1;
    mpsi_history_column *c = &h->column[h->width];
    if (find(h, columns[k]) >= 0)
      return mpsi_fail(h->context, function, MPS_ERROR_ARGUMENT,
                       "columns[%lld] is '%.60s', which another column is", (long long)k,
                       columns[k]);
    status = read_text(h->context, function, "columns", k, 1, columns[k], c->name);
    if (status == MPS_OK && units)
      status = read_text(h->context, function, "units", k, 0, units[k], c->unit);
    h->width++;
  }
  return status;
}

/* "t [s], settlement [m]" */
static bool list_names(mps_history *h) {
  const size_t most = (size_t)h->width * (2 * MPSI_HISTORY_TEXT + 5) + 1;
  size_t used = 0;
  h->names = mpsi_alloc(h->context, (int64_t)most, 1);
  for (int64_t k = 0; h->names && k < h->width; k++) {
    const mpsi_history_column *c = &h->column[k];
    used += (size_t)snprintf(h->names + used, most - used, "%s%s%s%s%s", k ? ", " : "", c->name,
                             *c->unit ? " [" : "", c->unit, *c->unit ? "]" : "");
  }
  return h->names != NULL;
}

static void end(mps_history *h) {
  mps_context *context = h->context;
  for (int64_t k = 0; h->column && k < h->width; k++)
    mpsi_release(h->column[k].release, h->column[k].user);
  MPSI_FREE(context, h->column, h->names, h->row);
  mps_domain_destroy(&h->domain);
  mpsi_free(context, h);
  mpsi_context_release(context);
}

static mps_status make(mps_solver *s, const char *function, const char *name, int32_t count,
                       const char *const *columns, const char *const *units, mps_history **out) {
  mps_status status = check_name(s, function, name);
  if (status == MPS_OK && (count < 1 || count > MPSI_HISTORY_COLUMNS))
    status = mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT, "count is %d, must be 1 to %d",
                       count, MPSI_HISTORY_COLUMNS);
  if (status == MPS_OK && !columns)
    status = mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT, "columns is NULL");
  if (status != MPS_OK) return status;
  mps_history *h = mpsi_alloc(s->context, 1, sizeof *h);
  if (!h) return mpsi_fail_memory(s->context, function, sizeof *h);
  h->context = mpsi_context_retain(s->context);
  h->domain = mpsi_domain_retain(s->domain);
  h->width = count + 1;
  h->file.fd = -1;
  snprintf(h->name, sizeof h->name, "%s", name);
  h->column = mpsi_alloc(h->context, h->width, sizeof *h->column);
  if (h->column) status = read_columns(h, function, columns, units);
  if (status == MPS_OK && (!h->column || !list_names(h)))
    status = mpsi_fail_memory(h->context, function, (size_t)h->width * sizeof *h->column);
  if (status == MPS_OK)
    *out = h;
  else
    end(h);
  return status;
}

mps_status mps_history_create(mps_solver *s, const char *name, const char *const *columns,
                              const char *const *units, int32_t count, mps_history **out) {
  if (!s) return mpsi_null(__func__, "solver");
  if (!out) return mpsi_fail(s->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_history *made = NULL;
  MPSI_TRY(mpsi_guard_check_between(&s->guard, s->context, __func__));
  mps_status status = make(s, __func__, name, count, columns, units, &made);
  status = mpsi_domain_agree_same(s->domain, __func__, status, "count", count);
  if (status != MPS_OK) {
    if (made) end(made);
    return status;
  }
  mps_history **last = &s->histories;
  while (*last) last = &(*last)->next;
  made->solver = s;
  *last = *out = made;
  return MPS_OK;
}

static void leave(mps_history *h) {
  mps_history **at = &h->solver->histories;
  while (*at != h) at = &(*at)->next;
  *at = h->next;
  h->solver = NULL, h->next = NULL;
}

void mpsi_histories_leave(mps_solver *solver) {
  while (solver->histories) leave(solver->histories);
}

static mps_status check_free(const mps_history *h, const char *function) {
  if (!h->busy) return MPS_OK;
  return mpsi_fail(h->context, function, MPS_ERROR_STATE,
                   "called from the source of a column of '%s': it may only read", h->name);
}

void mps_history_destroy(mps_history **history) {
  if (!history || !*history) return;
  mps_history *h = *history;
  if (check_free(h, __func__) != MPS_OK) return;
  *history = NULL;
  if (h->file.path && writes(h)) (void)mpsi_history_append(h, __func__);
  mpsi_history_close_file(h);
  if (h->solver) leave(h);
  end(h);
}

/* ---- rows ------------------------------------------------------------------------------------ */

static mps_status check_column(const mps_history *h, const char *function, const char *name,
                               int64_t first, int64_t *out) {
  *out = find(h, name);
  if (*out >= first) return MPS_OK;
  if (!name) return mpsi_fail(h->context, function, MPS_ERROR_ARGUMENT, "column is NULL");
  return mpsi_fail(h->context, function, MPS_ERROR_ARGUMENT,
                   "column is '%.60s', must be one of '%s': %.300s", name, h->name, h->names);
}

mps_status mps_history_set_source(mps_history *h, const char *column, mps_history_fn fn, void *user,
                                  mps_release_fn release) {
  if (!h) return mpsi_null(__func__, "history");
  int64_t k = -1;
  MPSI_TRY(check_free(h, __func__));
  MPSI_TRY(check_column(h, __func__, column, 1, &k));
  const mpsi_history_column former = h->column[k];
  h->column[k].source = fn, h->column[k].user = user, h->column[k].release = release;
  mpsi_release(former.release, former.user);
  return MPS_OK;
}

static mps_status ask(mps_history *h, const char *function, mpsi_history_column *c, double *value) {
  mps_solver *s = h->solver;
  const int64_t failures = mpsi_failures(h->context);
  const mpsi_guard former = mpsi_guard_close(&s->guard, h->context, "the source of a column");
  h->busy = true;
  *value = NAN;
  const mps_status status = c->source(c->user, s, value);
  h->busy = false;
  s->guard = former;
  return mpsi_callback_status(h->context, function, "the source of a column", failures, status);
}

static mps_status fill(mps_history *h, const char *function, double time, int32_t count,
                       const double *values, double *row) {
  int32_t given = 0;
  for (int64_t k = 1; k < h->width; k++) given += !h->column[k].source;
  if (count != given)
    return mpsi_fail(h->context, function, MPS_ERROR_ARGUMENT,
                     "count is %d, must be %d: the columns of '%s' without a source", count, given,
                     h->name);
  if (count > 0 && !values)
    return mpsi_fail(h->context, function, MPS_ERROR_ARGUMENT, "values is NULL");
  if (isinf(time))
    return mpsi_fail(h->context, function, MPS_ERROR_ARGUMENT,
                     "time is %g s, must be finite, or NaN for that of the solver", time);
  row[0] = isnan(time) ? h->solver->kind->time(h->solver) : time;
  given = 0;
  for (int64_t k = 1; k < h->width; k++)
    if (!h->column[k].source) row[k] = values[given++];
  return MPS_OK;
}

static mps_status complete_file(mps_history *h, const char *function) {
  MPSI_TRY(mpsi_domain_agree(h->domain, function,
                             writes(h) ? mpsi_history_append(h, function) : MPS_OK));
  h->file.rows = h->rows; /* on all ranks, or they disagree on when the next block is full */
  return MPS_OK;
}

/* Of several ranks: the row of rank 0. */
static mps_status share(mps_history *h, const char *function, double *row) {
  const int32_t ranks = mps_domain_size(h->domain), rank = mps_domain_rank(h->domain);
  const int64_t bytes = h->width * (int64_t)sizeof *row;
  if (!mpsi_domain_many(h->domain)) return MPS_OK;
  mpsi_mailbox box;
  mps_domain_message *message = mpsi_alloc(h->context, ranks, sizeof *message);
  mps_status status =
      message ? MPS_OK : mpsi_fail_memory(h->context, function, (size_t)ranks * sizeof *message);
  status = mpsi_domain_agree(h->domain, function, status);
  for (int32_t k = 1; k < ranks && status == MPS_OK; k++)
    message[k - 1] = (mps_domain_message){.rank = k, .bytes = bytes, .data = row};
  if (status == MPS_OK)
    status = mpsi_domain_exchange(h->domain, function, rank == 0 ? ranks - 1 : 0, message, &box);
  if (status == MPS_OK && rank > 0 && box.count == 1) memcpy(row, box.mail[0].data, (size_t)bytes);
  if (status == MPS_OK) mpsi_domain_free_mail(&box);
  mpsi_free(h->context, message);
  return status;
}

static bool reserve(mps_history *h, int64_t rows) {
  void *row = h->row;
  if (rows <= h->capacity) return true;
  const int64_t more = rows < 2 * h->capacity ? 2 * h->capacity : rows < 64 ? 64 : rows;
  if (!mpsi_grow(h->context, &row, h->capacity * h->width, more * h->width, sizeof *h->row))
    return false;
  h->row = row;
  h->capacity = more;
  return true;
}

mps_status mps_history_record(mps_history *h, double time, const double *values, int32_t count) {
  if (!h) return mpsi_null(__func__, "history");
  mps_status status = check_free(h, __func__);
  if (status == MPS_OK && !h->solver)
    status = mpsi_fail(h->context, __func__, MPS_ERROR_STATE,
                       "the solver of '%s' has been destroyed: no row can be added", h->name);
  if (status == MPS_OK) status = mpsi_guard_check_between(&h->solver->guard, h->context, __func__);
  if (status != MPS_OK) return status;
  if (!reserve(h, h->rows + 1))
    status = mpsi_fail_memory(h->context, __func__, (size_t)h->width * sizeof *h->row);
  double *row = status == MPS_OK ? h->row + h->rows * h->width : NULL;
  if (status == MPS_OK) status = fill(h, __func__, time, count, values, row);
  status = mpsi_domain_agree(h->domain, __func__, status);
  for (int64_t k = 1; k < h->width && status == MPS_OK; k++)
    if (h->column[k].source)
      status = mpsi_domain_agree(h->domain, __func__, ask(h, __func__, &h->column[k], &row[k]));
  if (status == MPS_OK) status = share(h, __func__, row);
  if (status != MPS_OK) return status;
  h->rows++, h->epoch++;
  if (!h->file.path || h->rows - h->file.rows < h->file.every) return MPS_OK;
  status = complete_file(h, __func__);
  if (status == MPS_ERROR_MEMORY) h->rows--, h->epoch--; /* before anything was written */
  return status;
}

int64_t mps_history_count(const mps_history *h) { return h ? h->rows : 0; }

mps_status mps_history_view(const mps_history *h, const char *column, mps_view *out) {
  if (!h) return mpsi_null(__func__, "history");
  if (!out) return mpsi_fail(h->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  int64_t k = -1;
  MPSI_TRY(check_column(h, __func__, column, 0, &k));
  *out = (mps_view){.data = h->row ? h->row + k : NULL,
                    .shape = {h->rows, 1, 1},
                    .stride = {h->width, 1, 1},
                    .dtype = {2, 64, 1},
                    .flags = MPS_VIEW_READONLY,
                    .epoch = h->epoch,
                    .device_type = 0};
  return MPS_OK;
}

/* ---- the file -------------------------------------------------------------------------------- */

mps_status mps_history_write(mps_history *h, const char *path) {
  if (!h) return mpsi_null(__func__, "history");
  if (!path) return mpsi_fail(h->context, __func__, MPS_ERROR_ARGUMENT, "path is NULL");
  return mpsi_domain_agree(h->domain, __func__,
                           writes(h) ? mpsi_history_write_file(h, __func__, path) : MPS_OK);
}

mps_status mps_history_open(mps_history *h, const char *path, int64_t every) {
  if (!h) return mpsi_null(__func__, "history");
  char *copy = NULL;
  mps_status status = check_free(h, __func__);
  if (status == MPS_OK && every < 1)
    status = mpsi_fail(h->context, __func__, MPS_ERROR_ARGUMENT, "every is %lld, must be >= 1",
                       (long long)every);
  const int64_t size = path ? (int64_t)strlen(path) + 1 : 0;
  if (status == MPS_OK && path && !(copy = mpsi_alloc(h->context, size, 1)))
    status = mpsi_fail_memory(h->context, __func__, (size_t)size);
  if (copy) memcpy(copy, path, (size_t)size);
  if (status == MPS_OK && path && writes(h))
    status = mpsi_history_try_path(h->context, __func__, path);
  if (status == MPS_OK && h->file.path && writes(h)) status = mpsi_history_append(h, __func__);
  status = mpsi_domain_agree(h->domain, __func__, status);
  if (status != MPS_OK) {
    mpsi_free(h->context, copy);
    return status;
  }
  mpsi_history_close_file(h);
  h->file.path = copy, h->file.every = every;
  return MPS_OK;
}

mps_status mps_history_flush(mps_history *h) {
  if (!h) return mpsi_null(__func__, "history");
  if (!h->file.path)
    return mpsi_fail(h->context, __func__, MPS_ERROR_STATE,
                     "'%s' has no open file: mps_history_open gives one", h->name);
  return complete_file(h, __func__);
}

/* ---- the state of the solver ----------------------------------------------------------------- */

static int64_t count_names(const void *history) {
  return (int64_t)strlen(((const mps_history *)history)->names);
}

static void get_names(const void *history, void *values) {
  memcpy(values, ((const mps_history *)history)->names, (size_t)count_names(history));
}

static void keep_names(void *history, int64_t rows, const void *values) {}

static bool same_names(const void *history, int64_t rows, const void *values) {
  return rows == count_names(history) &&
         memcmp(values, ((const mps_history *)history)->names, (size_t)rows) == 0;
}

/* Numbers, not rows: the columns of another history are found by their names. */
static int64_t count_numbers(const void *history) {
  const mps_history *h = history;
  return h->rows * h->width;
}

static void get_numbers(const void *history, void *values) {
  memcpy(values, ((const mps_history *)history)->row,
         (size_t)count_numbers(history) * sizeof(double));
}

static bool whole_rows(const void *history, int64_t numbers, const void *values) {
  return numbers % ((const mps_history *)history)->width == 0;
}

static bool reserve_numbers(void *history, int64_t numbers, const void *values) {
  mps_history *h = history;
  return reserve(h, numbers / h->width);
}

/* Rows of the file that are the same stay there. */
static void set_numbers(void *history, int64_t numbers, const void *values) {
  mps_history *h = history;
  const size_t bytes = (size_t)h->width * sizeof *h->row;
  const int64_t rows = numbers / h->width;
  int64_t same = 0;
  while (same < rows && same < h->file.rows &&
         memcmp(h->row + same * h->width, (const double *)values + same * h->width, bytes) == 0)
    same++;
  if (rows > 0) memcpy(h->row, values, (size_t)rows * bytes);
  h->file.rows = same;
  h->rows = rows;
  h->epoch++;
}

void mpsi_histories_list_state(mpsi_state *state, void *solver) {
  static const mpsi_state_table names = {.type = MPSI_STATE_BYTES,
                                         .columns = 1,
                                         .rows = count_names,
                                         .get = get_names,
                                         .set = keep_names};
  static const mpsi_state_table rows = {.type = MPSI_STATE_F64,
                                        .columns = 1,
                                        .rows = count_numbers,
                                        .get = get_numbers,
                                        .reserve = reserve_numbers,
                                        .set = set_numbers};
  for (mps_history *h = ((mps_solver *)solver)->histories; h; h = h->next) {
    char name[MPSI_STATE_NAME / 2];
    snprintf(name, sizeof name, "history.%s", h->name);
    mpsi_state_add_optional(state, name, &rows, whole_rows, h);
    snprintf(name, sizeof name, "history.%s.names", h->name);
    mpsi_state_add_optional(state, name, &names, same_names, h);
  }
}
