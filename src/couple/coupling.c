/* coupling.c - the coupling as an object: definition, guesses, the next values to try, memory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "coupling_private.h"

#include <math.h>
#include <string.h>

#define MEMORY_HEAD 6 /* format, size, steps, columns, factor, repeats: before the arrays */
#define MEMORY_FORMAT 1.0
#define LARGEST 1e100 /* of a value: sums of squares and extrapolations stay finite */

static bool allocate(mps_coupling *c) {
  const int64_t n = c->def.size, most = c->def.columns;
  double **const vectors[] = {&c->x,           &c->residual, &c->answer,  &c->last_residual,
                              &c->last_answer, &c->past[0],  &c->past[1], &c->past[2]};
  enum { VECTORS = sizeof vectors / sizeof *vectors };
  c->block = mpsi_alloc(c->context, n * (VECTORS + 3 * most) + most * (most + 1), sizeof *c->block);
  c->column = mpsi_alloc(c->context, most, sizeof *c->column);
  if (!c->block || !c->column) return false;
  double *at = c->block;
  for (int k = 0; k < VECTORS; k++, at += n) *vectors[k] = at;
  for (int64_t k = 0; k < most; k++, at += 2 * n)
    c->column[k].residual = at, c->column[k].answer = at + n;
  c->basis = at;
  c->triangle = c->basis + n * most;
  c->share = c->triangle + most * most;
  return true;
}

static void release(mps_coupling *c) { MPSI_FREE(c->context, c->block, c->column, c); }

mps_status mps_coupling_create(mps_context *context, const mps_coupling_def *user_def,
                               mps_coupling **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!user_def || !out)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL", user_def ? "out" : "def");
  *out = NULL;
  mps_coupling_def def;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_coupling_def, user_def, &def));
  if (def.columns > def.size) def.columns = (int32_t)def.size;
  mps_coupling *c = mpsi_alloc(context, 1, sizeof *c);
  if (!c) return mpsi_fail_memory(context, __func__, sizeof *c);
  c->context = context;
  c->def = def;
  c->factor = def.relaxation;
  if (!allocate(c)) {
    release(c);
    return mpsi_fail_memory(context, __func__,
                            (size_t)(def.size * def.columns) * 3 * sizeof(double));
  }
  mpsi_context_retain(context);
  *out = c;
  return MPS_OK;
}

void mps_coupling_destroy(mps_coupling **coupling) {
  if (!coupling || !*coupling) return;
  mps_context *context = (*coupling)->context;
  release(*coupling);
  *coupling = NULL;
  mpsi_context_release(context);
}

/* ---- a step ---------------------------------------------------------------------------------- */

mps_status mps_coupling_begin(mps_coupling *c, const double *start, double *guess) {
  if (!c) return mpsi_null(__func__, "coupling");
  if (!guess) return mpsi_fail(c->context, __func__, MPS_ERROR_ARGUMENT, "guess is NULL");
  const int64_t n = c->def.size;
  for (int64_t i = 0; start && i < n; i++)
    if (!(fabs(start[i]) <= LARGEST))
      return mpsi_fail(c->context, __func__, MPS_ERROR_ARGUMENT,
                       "start value %lld is %g, must be within %g", (long long)i, start[i],
                       LARGEST);
  static const double weight[MPSI_COUPLING_PAST][MPSI_COUPLING_PAST] = {
      {1.0, 0.0, 0.0}, {2.0, -1.0, 0.0}, {3.0, -3.0, 1.0}};
  const int64_t order = c->steps - 1 < c->def.order ? c->steps - 1 : c->def.order;
  if (c->open) mpsi_coupling_forget(c, 0, c->steps);
  for (int64_t i = 0; i < n; i++) {
    double value = start ? start[i] : 0.0;
    for (int64_t k = 0; !start && k <= order; k++) value += weight[order][k] * c->past[k][i];
    guess[i] = c->x[i] = value;
  }
  c->open = true, c->agreed = false;
  c->repeats = 0;
  return MPS_OK;
}

static void relax(mps_coupling *c, double factor) {
  for (int64_t i = 0; i < c->def.size; i++) c->x[i] += factor * c->residual[i];
}

/* Aitken's factor, from this residual and the last; the first of a step is the last of the one
 * before. */
static void update_factor(mps_coupling *c) {
  double product = 0.0, square = 0.0;
  for (int64_t i = 0; i < c->def.size; i++) {
    const double change = c->residual[i] - c->last_residual[i];
    product += c->last_residual[i] * change, square += change * change;
  }
  const double factor = square > 0.0 ? c->factor * (-product / square) : 0.0;
  if (factor != 0.0 && isfinite(factor)) c->factor = factor;
}

static void improve(mps_coupling *c) {
  const bool again = c->repeats > 1;
  if (c->def.method == MPS_COUPLING_METHOD_CONSTANT) {
    relax(c, c->def.relaxation);
  } else if (c->def.method == MPS_COUPLING_METHOD_AITKEN) {
    if (again) update_factor(c);
    relax(c, c->factor);
  } else {
    if (again) mpsi_coupling_learn(c);
    if (!mpsi_coupling_quasi_newton(c)) relax(c, c->def.relaxation);
  }
}

/* Euclidean norm; values of which all squares underflow are scaled by a power of two. */
static double norm(int64_t n, const double *a) {
  double most = 0.0, sum = 0.0;
  const double square = mpsi_coupling_dot(n, a, a);
  if (square > 1e-200) return sqrt(square);
  for (int64_t i = 0; i < n; i++) most = fmax(most, fabs(a[i]));
  if (most == 0.0) return 0.0;
  const int scale = ilogb(most);
  for (int64_t i = 0; i < n; i++) {
    const double x = scalbn(a[i], -scale);
    sum += x * x;
  }
  return scalbn(sqrt(sum), scale);
}

/* The next iterate must be one that a solver can take. */
static mps_status check_iterate(mps_coupling *c, const char *function) {
  for (int64_t i = 0; i < c->def.size; i++)
    if (!(fabs(c->x[i]) <= LARGEST)) {
      const double value = c->x[i];
      c->factor = c->def.relaxation;
      return mpsi_fail(c->context, function, MPS_ERROR_NUMERIC,
                       "repeat %d of the coupling gives value %lld as %g, must be within %g: the "
                       "repeats diverge",
                       c->repeats, (long long)i, value, LARGEST);
    }
  return MPS_OK;
}

mps_status mps_coupling_next(mps_coupling *c, const double *answer, double *guess, int32_t *done) {
  if (!c) return mpsi_null(__func__, "coupling");
  if (!answer || !guess || !done)
    return mpsi_fail(c->context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     !answer ? "answer"
                     : guess ? "done"
                             : "guess");
  if (!c->open)
    return mpsi_fail(c->context, __func__, MPS_ERROR_STATE,
                     "no step of the coupling is begun: mps_coupling_begin comes first");
  const int64_t n = c->def.size;
  for (int64_t i = 0; i < n; i++)
    if (!(fabs(answer[i]) <= LARGEST))
      return mpsi_fail(c->context, __func__, MPS_ERROR_NUMERIC,
                       "answer %lld at repeat %d of the coupling is %g, must be within %g",
                       (long long)i, c->repeats + 1, answer[i], LARGEST);
  memcpy(c->answer, answer, (size_t)n * sizeof *answer);
  for (int64_t i = 0; i < n; i++) c->residual[i] = answer[i] - c->x[i];
  const double r = norm(n, c->residual), whole = norm(n, answer);
  c->repeats++, c->all_repeats++;
  c->relative = whole > 0.0 ? fmin(r / whole, LARGEST) : r;
  *done = c->agreed = r <= c->def.tolerance * whole || r <= c->def.floor * sqrt((double)n);
  if (*done) {
    memcpy(guess, c->x, (size_t)n * sizeof *guess);
    return MPS_OK;
  }
  if (c->repeats >= c->def.repeats)
    return mpsi_fail(c->context, __func__, MPS_ERROR_NUMERIC,
                     "the coupling does not agree after %d repeats: residual %g of the answer, "
                     "allowed %g",
                     c->repeats, c->relative, c->def.tolerance);
  improve(c);
  MPSI_TRY(check_iterate(c, __func__));
  memcpy(c->last_residual, c->residual, (size_t)n * sizeof *guess);
  memcpy(c->last_answer, c->answer, (size_t)n * sizeof *guess);
  memcpy(guess, c->x, (size_t)n * sizeof *guess);
  return MPS_OK;
}

mps_status mps_coupling_accept(mps_coupling *c) {
  if (!c) return mpsi_null(__func__, "coupling");
  if (!c->open || !c->agreed)
    return mpsi_fail(
        c->context, __func__, MPS_ERROR_STATE,
        "the step of the coupling is not agreed on: mps_coupling_next has not said so");
  mpsi_coupling_watch(c);
  double *oldest = c->past[MPSI_COUPLING_PAST - 1];
  memmove(c->past + 1, c->past, (MPSI_COUPLING_PAST - 1) * sizeof *c->past);
  c->past[0] = oldest;
  memcpy(oldest, c->x, (size_t)c->def.size * sizeof *oldest);
  c->open = false;
  c->steps++;
  mpsi_coupling_forget(c, c->steps - c->def.reuse, INT64_MAX);
  return MPS_OK;
}

mps_status mps_coupling_get_report_sized(const mps_coupling *c, mps_coupling_report *out,
                                         size_t size) {
  if (!c) return mpsi_null(__func__, "coupling");
  const mps_coupling_report report = {c->steps, c->all_repeats, c->repeats, c->columns,
                                      c->relative};
  return mpsi_out_write(c->context, "mps_coupling_get_report", out, size, &report, sizeof report);
}

/* ---- memory ---------------------------------------------------------------------------------- */

mps_status mps_coupling_get_memory(const mps_coupling *c, int64_t capacity, int64_t *count,
                                   double *values) {
  if (!c) return mpsi_null(__func__, "coupling");
  if (!count || capacity < 0 || (capacity > 0 && !values))
    return mpsi_fail(c->context, __func__, MPS_ERROR_ARGUMENT, "%s",
                     !count ? "count is NULL" : "capacity is negative or values is NULL");
  if (c->open)
    return mpsi_fail(c->context, __func__, MPS_ERROR_STATE,
                     "a step of the coupling is under way: its memory is that between steps");
  const int64_t n = c->def.size;
  *count = MEMORY_HEAD + MPSI_COUPLING_PAST * n + c->columns * (1 + 2 * n);
  if (capacity < *count) return MPS_OK;
  const double head[MEMORY_HEAD] = {MEMORY_FORMAT, (double)n, (double)c->steps,
                                    c->columns,    c->factor, (double)c->all_repeats};
  double *at = values;
  memcpy(at, head, sizeof head);
  at += MEMORY_HEAD;
  for (int k = 0; k < MPSI_COUPLING_PAST; k++, at += n)
    memcpy(at, c->past[k], (size_t)n * sizeof *at);
  for (int32_t k = 0; k < c->columns; k++, at += 2 * n) {
    *at++ = (double)c->column[k].step;
    memcpy(at, c->column[k].residual, (size_t)n * sizeof *at);
    memcpy(at + n, c->column[k].answer, (size_t)n * sizeof *at);
  }
  return MPS_OK;
}

mps_status mps_coupling_set_memory(mps_coupling *c, int64_t count, const double *values) {
  if (!c) return mpsi_null(__func__, "coupling");
  if (!values) return mpsi_fail(c->context, __func__, MPS_ERROR_ARGUMENT, "values is NULL");
  const int64_t n = c->def.size;
  const double most = c->def.columns;
  const bool good =
      count >= MEMORY_HEAD && values[0] == MEMORY_FORMAT && values[1] == (double)n &&
      values[2] >= 0.0 && values[2] < 9e15 && values[3] >= 0.0 && values[3] <= most &&
      values[3] == floor(values[3]) && isfinite(values[4]) && values[5] >= 0.0 &&
      values[5] < 9e15 &&
      count == MEMORY_HEAD + MPSI_COUPLING_PAST * n + (int64_t)values[3] * (1 + 2 * n);
  if (!good)
    return mpsi_fail(c->context, __func__, MPS_ERROR_FORMAT,
                     "these %lld values are not the memory of a coupling of %lld values",
                     (long long)count, (long long)n);
  for (int64_t i = 0; i < count; i++)
    if (!(fabs(values[i]) <= 4.0 * LARGEST)) /* columns are differences of differences */
      return mpsi_fail(c->context, __func__, MPS_ERROR_FORMAT,
                       "value %lld of the coupling's memory is %g, must be within %g", (long long)i,
                       values[i], 4.0 * LARGEST);
  for (int64_t k = 0; k < (int64_t)values[3]; k++) {
    const double step = values[MEMORY_HEAD + MPSI_COUPLING_PAST * n + k * (1 + 2 * n)];
    if (!(step >= 0.0 && step <= values[2]))
      return mpsi_fail(c->context, __func__, MPS_ERROR_FORMAT,
                       "column %lld of the coupling's memory is of step %g, allowed are 0 to %g",
                       (long long)k, step, values[2]);
  }
  c->steps = (int64_t)values[2], c->columns = (int32_t)values[3], c->factor = values[4];
  c->all_repeats = (int64_t)values[5];
  const double *at = values + MEMORY_HEAD;
  for (int k = 0; k < MPSI_COUPLING_PAST; k++, at += n)
    memcpy(c->past[k], at, (size_t)n * sizeof *at);
  for (int32_t k = 0; k < c->columns; k++, at += 2 * n) {
    c->column[k].step = (int64_t)*at++;
    memcpy(c->column[k].residual, at, (size_t)n * sizeof *at);
    memcpy(c->column[k].answer, at + n, (size_t)n * sizeof *at);
  }
  c->open = false;
  c->swing = (mpsi_coupling_swing){.warned = c->swing.warned};
  return MPS_OK;
}
