/* outside.c - the pressure equation for a solver of the caller (mps/fluid_solver.h): the matrix by
 * rows with the ghosts' columns added to their parents', and the check of its solution.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "outside.h"
#include "fluid/base/access.h"
#include "fluid/base/loops.h"
#include "fluid/ranks/partition.h"

#include <mps/fluid_solver.h>

#include <string.h>

#define ROUNDING 1e-12 /* of |b|: the smallest tolerance that is required of a solver */

static const mps_fluid_solver_def defaults = {.struct_size = sizeof(mps_fluid_solver_def)};

mps_status mps_fluid_solver_def_init(mps_fluid_solver_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_fluid_solver_def, def, size, &defaults);
}

void mpsi_fluid_drop_solver(mps_fluid *f) {
  if (!f->outside) return;
  void *const parts[] = {f->outside->start, f->outside->column_room.item,
                         f->outside->value_room.item, f->outside};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(f->context, parts[k]);
  f->outside = NULL;
}

/* Status of all ranks, and a check that all have such a solver. */
static mps_status agree_on_solver(mps_fluid *f, const char *function, mps_status status, bool given,
                                  const mps_fluid_solver_def *def) {
  mpsi_given list;
  mpsi_given_begin(&list);
  mpsi_give(&list, "having a solver", given);
  mpsi_give(&list, "having rows", def->rows != NULL);
  mpsi_give(&list, "having forget", def->forget != NULL);
  MPSI_GIVE(&list, def, least);
  return mpsi_domain_agree_given(f->def.domain, function, status, &list);
}

mps_status mps_fluid_set_solver(mps_fluid *f, const mps_fluid_solver_def *user_def) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_fluid_ready(f, __func__);
  mps_fluid_solver_def def = defaults;
  if (status == MPS_OK && user_def)
    status = MPSI_DEF_READ(f->context, __func__, mps_fluid_solver_def, user_def, &def);
  if (status != MPS_OK && !f->partition) return status;
  if (status == MPS_OK && user_def && f->partition && !def.rows)
    status =
        mpsi_fail(f->context, __func__, MPS_ERROR_UNSUPPORTED,
                  "rows is NULL: a fluid of several ranks has its pressure solved by the library, "
                  "or by a solver that takes each rank's rows");
  if (status == MPS_OK && user_def && (!def.matrix || !def.solve || def.least < 0))
    status = mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                       "matrix is %s, solve %s, least %lld: both must be given, and least >= 0",
                       def.matrix ? "given" : "NULL", def.solve ? "given" : "NULL",
                       (long long)def.least);
  mpsi_fluid_outside *outside = NULL;
  if (status == MPS_OK && user_def) {
    outside = mpsi_alloc(f->context, 1, sizeof *outside);
    if (!outside) status = mpsi_fail_memory(f->context, __func__, sizeof *outside);
  }
  status = agree_on_solver(f, __func__, status, user_def != NULL, &def);
  if (status != MPS_OK) {
    mpsi_free(f->context, outside);
    return status;
  }
  if (outside)
    *outside = (mpsi_fluid_outside){.user = def.user,
                                    .matrix = def.matrix,
                                    .solve = def.solve,
                                    .forget = def.forget,
                                    .rows_of_rank = def.rows,
                                    .least = def.least};
  mpsi_fluid_drop_solver(f);
  f->outside = outside;
  return MPS_OK;
}

mps_status mpsi_fluid_forget(mps_fluid *f, const char *function) {
  if (!f->outside || !f->outside->forget) return MPS_OK;
  mpsi_guard_enter(&f->guard, f->context, "the callback forget of mps_fluid_set_solver");
  const mps_status status = f->outside->forget(f->outside->user);
  return mpsi_guard_leave(&f->guard, f->context, function, status);
}

bool mpsi_fluid_solved_outside(const mps_fluid *f) {
  return f->outside && f->count >= f->outside->least;
}

/* ---- matrix ---------------------------------------------------------------------------------- */

/* Row i to `column` and `value`, which have room for near[i] + 1; returns its length. */
static int64_t fill_row(const mps_fluid *f, int64_t i, int32_t *column, double *value) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  int64_t count = 1;
  column[0] = (int32_t)i, value[0] = f->system.diagonal[i];
  if (f->state[i] == MPSI_FLUID_APART) return 1;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int32_t j = index[k] < f->count ? index[k] : f->parent[index[k] - f->count];
    if (f->state[j] == MPSI_FLUID_APART) continue;
    int64_t at = count;
    while (at > 0 && column[at - 1] > j) at--;
    if (at > 0 && column[at - 1] == j) {
      value[at - 1] -= w[k];
      continue;
    }
    for (int64_t e = count; e > at; e--) column[e] = column[e - 1], value[e] = value[e - 1];
    column[at] = j, value[at] = -w[k];
    count++;
  }
  return count;
}

/* The rows of a chunk one after the other, in the memory behind its pairs and diagonals; start[i +
 * 1] receives the length of row i. */
static void fill_chunk(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  (void)chunk;
  mpsi_fluid_outside *o = f->outside;
  int64_t at = mpsi_fluid_pairs(f, begin) - mpsi_fluid_pairs(f, f->own[0]) + begin - f->own[0];
  for (int64_t i = begin; i < end; i++) {
    int64_t *const length = &o->start[i - f->own[0] + 1];
    *length =
        fill_row(f, i, (int32_t *)o->column_room.item + at, (double *)o->value_room.item + at);
    at += *length;
  }
}

static mps_status make_room(mps_fluid *f, const char *function) {
  mpsi_fluid_outside *o = f->outside;
  const int64_t last = f->own[1] - 1, rows = f->own[1] - f->own[0];
  const int64_t entries =
      rows > 0 ? mpsi_fluid_pairs(f, last) + f->near[last] - mpsi_fluid_pairs(f, f->own[0]) + rows
               : 0;
  if (o->rows < rows || !o->start) {
    mpsi_free(f->context, o->start);
    o->rows = 0;
    o->start = mpsi_alloc(f->context, rows + 1, sizeof *o->start);
    if (!o->start) return mpsi_fail_memory(f->context, function, (size_t)rows * 8);
    o->rows = rows;
  }
  if (!mpsi_room_ensure(f->context, &o->column_room, entries, sizeof(int32_t)) ||
      !mpsi_room_ensure(f->context, &o->value_room, entries, sizeof(double)))
    return mpsi_fail_memory(f->context, function, (size_t)entries * 12);
  return MPS_OK;
}

/* The rows of the chunks, moved together. */
static void close_gaps(mps_fluid *f) {
  mpsi_fluid_outside *o = f->outside;
  int32_t *column = o->column_room.item;
  double *value = o->value_room.item;
  int64_t at = 0, from = 0;
  o->start[0] = 0;
  for (int64_t row = 0; row < f->own[1] - f->own[0]; row++) {
    const int64_t i = f->own[0] + row, length = o->start[row + 1];
    if (i % MPSI_FLUID_CHUNK == 0)
      from = mpsi_fluid_pairs(f, i) - mpsi_fluid_pairs(f, f->own[0]) + row;
    memmove(column + at, column + from, (size_t)length * sizeof *column);
    memmove(value + at, value + from, (size_t)length * sizeof *value);
    at += length, from += length;
    o->start[row + 1] = at;
  }
}

mps_status mpsi_fluid_hand_matrix(mps_fluid *f, const char *function) {
  mpsi_fluid_outside *o = f->outside;
  mps_status status = mpsi_fluid_agree(f, function, make_room(f, function));
  if (status != MPS_OK) return status;
  const int32_t *column = o->column_room.item;
  const double *value = o->value_room.item;
  const int64_t rows = f->own[1] - f->own[0];
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, fill_chunk);
  close_gaps(f);
  mpsi_guard_enter(&f->guard, f->context,
                   f->partition ? "the callback rows of mps_fluid_set_solver"
                                : "the callback matrix of mps_fluid_set_solver");
  status = f->partition
               ? o->rows_of_rank(o->user, f->count, f->own[0], rows, o->start, column, value)
               : o->matrix(o->user, rows, o->start, column, value);
  return mpsi_fluid_agree(f, function, mpsi_guard_leave(&f->guard, f->context, function, status));
}

/* ---- solution -------------------------------------------------------------------------------- */

static void residual(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  mpsi_fluid_system *s = &f->system;
  double rr = 0.0, bb = 0.0;
  f->loops->times(f, begin, end, s->x, s->q);
  for (int64_t i = begin; i < end; i++) {
    const double r = f->state[i] == MPSI_FLUID_APART ? s->x[i] : s->right[i] - s->q[i];
    rr += r * r, bb += s->right[i] * s->right[i];
  }
  s->sums[2 * chunk] = rr, s->sums[2 * chunk + 1] = bb;
}

mps_status mpsi_fluid_solve_outside(mps_fluid *f, const char *function) {
  mpsi_fluid_outside *o = f->outside;
  mpsi_fluid_system *s = &f->system;
  int64_t iterations = 0;
  mpsi_guard_enter(&f->guard, f->context, "the callback solve of mps_fluid_set_solver");
  mps_status status = o->solve(o->user, s->right, f->def.tolerance, s->x, &iterations);
  status = mpsi_fluid_agree(f, function, mpsi_guard_leave(&f->guard, f->context, function, status));
  if (status != MPS_OK) return status;
  for (int64_t g = 0; g < f->ghosts; g++) s->x[f->count + g] = s->x[f->parent[g]];
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, residual);
  mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
  const mps_status lost = mpsi_fluid_lost(f, function);
  if (lost != MPS_OK) return lost;
  double rr = 0.0, bb = 0.0;
  for (int64_t k = 0; k < (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK; k++)
    rr += s->sums[2 * k], bb += s->sums[2 * k + 1];
  const double allowed = f->def.tolerance * 1.01 + ROUNDING;
  if (!(rr <= allowed * allowed * bb))
    return mpsi_fail(f->context, function, MPS_ERROR_NUMERIC,
                     "step %lld, t = %g s: the pressure of the callback solve has the residual %g "
                     "of the right side, allowed is %g; the step is not made",
                     (long long)f->steps, f->time, bb > 0.0 ? sqrt(rr / bb) : sqrt(rr),
                     f->def.tolerance);
  f->report.iterations = iterations;
  f->report.all_iterations += iterations;
  return MPS_OK;
}
