/* outside.c - the pressure equation for a linear solver of the caller (solver/linear.h): the matrix
 * by rows with the ghosts' columns added to their parents', and the residual of its solution.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "outside.h"
#include "fluid/base/access.h"
#include "fluid/base/loops.h"
#include "fluid/ranks/partition.h"
#include "solver/linear.h"

#include <string.h>

void mpsi_fluid_free_outside(mps_fluid *f) {
  MPSI_FREE(f->context, f->outside.start_room.item, f->outside.column_room.item,
            f->outside.value_room.item);
}

bool mpsi_fluid_solved_outside(const mps_fluid *f) {
  return mpsi_linear_serves(&f->base, f->count);
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
  const mpsi_fluid_outside *o = &f->outside;
  int64_t at = mpsi_fluid_pairs(f, begin) - mpsi_fluid_pairs(f, f->own[0]) + begin - f->own[0];
  for (int64_t i = begin; i < end; i++) {
    int64_t *const length = (int64_t *)o->start_room.item + i - f->own[0] + 1;
    *length =
        fill_row(f, i, (int32_t *)o->column_room.item + at, (double *)o->value_room.item + at);
    at += *length;
  }
}

static mps_status reserve(mps_fluid *f, const char *function) {
  mpsi_fluid_outside *o = &f->outside;
  const int64_t last = f->own[1] - 1, rows = f->own[1] - f->own[0];
  const int64_t entries =
      rows > 0 ? mpsi_fluid_pairs(f, last) + f->near[last] - mpsi_fluid_pairs(f, f->own[0]) + rows
               : 0;
  if (!mpsi_room_ensure(f->context, &o->start_room, rows + 1, sizeof(int64_t)) ||
      !mpsi_room_ensure(f->context, &o->column_room, entries, sizeof(int32_t)) ||
      !mpsi_room_ensure(f->context, &o->value_room, entries, sizeof(double)))
    return mpsi_fail_memory(f->context, function, (size_t)entries * 12);
  return MPS_OK;
}

/* The rows of the chunks, moved together. */
static void close_gaps(mps_fluid *f) {
  const mpsi_fluid_outside *o = &f->outside;
  int64_t *start = o->start_room.item;
  int32_t *column = o->column_room.item;
  double *value = o->value_room.item;
  int64_t at = 0, from = 0;
  start[0] = 0;
  for (int64_t row = 0; row < f->own[1] - f->own[0]; row++) {
    const int64_t i = f->own[0] + row, length = start[row + 1];
    if (i % MPSI_FLUID_CHUNK == 0)
      from = mpsi_fluid_pairs(f, i) - mpsi_fluid_pairs(f, f->own[0]) + row;
    memmove(column + at, column + from, (size_t)length * sizeof *column);
    memmove(value + at, value + from, (size_t)length * sizeof *value);
    at += length, from += length;
    start[row + 1] = at;
  }
}

mps_status mpsi_fluid_hand_matrix(mps_fluid *f, const char *function) {
  const mpsi_fluid_outside *o = &f->outside;
  MPSI_TRY(mpsi_fluid_agree(f, function, reserve(f, function)));
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, fill_chunk);
  close_gaps(f);
  mps_linear_matrix matrix = {.all = f->count,
                              .first = f->own[0],
                              .rows = f->own[1] - f->own[0],
                              .block = 1,
                              .start = o->start_room.item,
                              .column = o->column_room.item,
                              .value = o->value_room.item};
  return mpsi_linear_hand(&f->base, function, &matrix);
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
  mpsi_fluid_system *s = &f->system;
  const int64_t own = f->own[0];
  double rr = 0.0, bb = 0.0;
  MPSI_TRY(mpsi_linear_solve(&f->base, function, f->def.tolerance, s->right + own, s->x + own));
  mpsi_fluid_send_halo(f, 1, &s->x);
  for (int64_t g = 0; g < f->ghosts; g++) s->x[f->count + g] = s->x[f->parent[g]];
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, residual);
  mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
  MPSI_TRY(mpsi_fluid_lost(f, function));
  for (int64_t k = 0; k < (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK; k++)
    rr += s->sums[2 * k], bb += s->sums[2 * k + 1];
  MPSI_TRY(mpsi_linear_check(&f->base, function, f->def.tolerance, 0.0, rr, bb));
  f->report.iterations = f->linear->result.iterations;
  f->report.all_iterations += f->report.iterations;
  return MPS_OK;
}
