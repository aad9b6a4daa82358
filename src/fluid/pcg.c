/* pcg.c - conjugate gradients for the pressure, preconditioned by an incomplete Cholesky factor
 * without fill, L D L^T, of diagonal blocks of the matrix.
 *
 * The matrix is not stored: a row is the weights of the particle's neighbours, and vectors that are
 * multiplied have the values of the ghosts' parents appended. The start vector is extrapolated from
 * the last two steps (pressure.c), which more than halves the iterations in waves. The blocks
 * depend on the number of particles alone, and sums are made chunk by chunk, so the result does not
 * depend on the threads. SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_private.h"

#include <string.h>

#define BLOCK 2560       /* particles in a block of the preconditioner, about */
#define LEAST_PIVOT 1e-3 /* of the diagonal */
#define MOST_LOWER 256   /* entries of a row of L */

/* ---- preconditioner -------------------------------------------------------------------------- */

typedef struct blocks {
  int64_t count, size;
} blocks;

static blocks cut(const mps_fluid *f) {
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  const int64_t wanted = (f->count + BLOCK - 1) / BLOCK;
  const int64_t each = (chunks + wanted - 1) / wanted; /* whole chunks */
  return (blocks){(chunks + each - 1) / each, each * MPSI_FLUID_CHUNK};
}

/* Row i of the block's matrix left of the diagonal, columns ascending; the diagonal without what
 * the particle's own images take back. */
static int32_t lower_row(const mps_fluid *f, int64_t first, int64_t i, int32_t *column,
                         double *value, double *diagonal) {
  const int32_t *index = f->index + f->start[i];
  const double *w = f->w + f->start[i];
  int32_t count = 0;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t ghost = index[k] - f->count;
    const int32_t j = ghost < 0 ? index[k] : f->parent[ghost];
    if (j == i) *diagonal -= w[k];
    if (j >= i || j < first || f->state[j] == MPSI_FLUID_APART) continue;
    int32_t at = count;
    while (at > 0 && column[at - 1] > j) at--;
    if (at > 0 && column[at - 1] == j) {
      value[at - 1] -= w[k];
      continue;
    }
    if (count == MOST_LOWER) continue; /* left out of the preconditioner only */
    for (int32_t e = count; e > at; e--) column[e] = column[e - 1], value[e] = value[e - 1];
    column[at] = j, value[at] = -w[k];
    count++;
  }
  return count;
}

typedef struct factor_pass {
  mps_fluid *fluid;
  blocks blocks;
  int64_t room; /* entries for each block */
  atomic_bool full;
} factor_pass;

/* One block, row by row; `row` holds (L D)_i. */
static void factor_block(void *data, int64_t b, int32_t worker) {
  (void)worker;
  factor_pass *p = data;
  mps_fluid *f = p->fluid;
  mpsi_fluid_system *s = &f->system;
  const int64_t first = b * p->blocks.size;
  const int64_t end = first + p->blocks.size < f->count ? first + p->blocks.size : f->count;
  int32_t *column = s->lower_col + b * p->room, at = 0, found[MOST_LOWER + 1];
  float *lower = s->lower + b * p->room;
  double value[MOST_LOWER + 1], *row = s->z;
  memset(row + first, 0, (size_t)(end - first) * sizeof *row);
  for (int64_t i = first; i < end; i++) {
    double diagonal = s->diagonal[i];
    s->lower_start[i] = at;
    const int32_t count =
        f->state[i] == MPSI_FLUID_APART ? 0 : lower_row(f, first, i, found, value, &diagonal);
    if (at + count > p->room) {
      atomic_store(&p->full, true);
      return;
    }
    const double whole = diagonal;
    for (int32_t k = 0; k < count; k++) {
      const int32_t j = found[k];
      const int32_t last = s->lower_end[j];
      double sum = value[k], other = 0.0;
      int32_t e = s->lower_start[j];
      for (; e + 2 <= last; e += 2) {
        sum -= row[column[e]] * lower[e];
        other -= row[column[e + 1]] * lower[e + 1];
      }
      if (e < last) sum -= row[column[e]] * lower[e];
      row[j] = sum + other;
    }
    for (int32_t k = 0; k < count; k++) {
      const double sum = row[found[k]], l = sum * s->inverse[found[k]];
      column[at + k] = found[k];
      lower[at + k] = (float)l;
      diagonal -= sum * l;
      row[found[k]] = 0.0;
    }
    at += count;
    s->lower_end[i] = at;
    s->inverse[i] = 1.0 / fmax(diagonal, LEAST_PIVOT * whole);
  }
}

mps_status mpsi_fluid_factor(mps_fluid *f, const char *function) {
  mpsi_fluid_system *s = &f->system;
  factor_pass p = {.fluid = f, .blocks = cut(f)};
  for (;;) {
    p.room = f->most_lower * p.blocks.size;
    const int64_t all = p.room * p.blocks.count;
    if (!mpsi_fluid_room_fit(f->context, &f->lower_col_room, all, sizeof *s->lower_col) ||
        !mpsi_fluid_room_fit(f->context, &f->lower_room, all, sizeof *s->lower))
      return mpsi_fail_memory(f->context, function, (size_t)all * 8);
    s->lower_col = f->lower_col_room.item;
    s->lower = f->lower_room.item;
    atomic_store(&p.full, false);
    mpsi_parallel_for(f->context, p.blocks.count, factor_block, &p);
    if (!atomic_load(&p.full)) return MPS_OK;
    f->most_lower += f->most_lower / 8;
  }
}

/* ---- the iteration --------------------------------------------------------------------------- */

typedef struct iteration {
  mps_fluid *fluid;
  blocks blocks;
  int64_t room;
  double alpha, beta;
} iteration;

/* Sum over the chunks or blocks of the one or the other of their two sums. */
static double total(const mps_fluid *f, int64_t count, int which) {
  double sum = 0.0;
  for (int64_t k = 0; k < count; k++) sum += f->system.sums[2 * k + which];
  return sum;
}

static void append_ghosts(const mps_fluid *f, double *v) {
  for (int64_t g = 0; g < f->ghosts; g++) v[f->count + g] = v[f->parent[g]];
}

static double row_times(const mps_fluid *f, int64_t i, const double *v) {
  const int32_t *index = f->index + f->start[i];
  const double *w = f->w + f->start[i];
  const int32_t near = f->near[i];
  double sum[4] = {0.0, 0.0, 0.0, 0.0}; /* four chains of additions at a time */
  int32_t k = 0;
  for (; k + 4 <= near; k += 4)
    for (int c = 0; c < 4; c++) sum[c] += w[k + c] * v[index[k + c]];
  for (; k < near; k++) sum[0] += w[k] * v[index[k]];
  return f->system.diagonal[i] * v[i] - ((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

/* r = b - A x, and the square of b. */
static void first_residual(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  mpsi_fluid_system *s = &f->system;
  double bb = 0.0;
  for (int64_t i = begin; i < end; i++) {
    const bool apart = f->state[i] == MPSI_FLUID_APART;
    s->r[i] = apart ? 0.0 : s->right[i] - row_times(f, i, s->x);
    bb += s->right[i] * s->right[i];
  }
  s->sums[2 * chunk] = bb;
}

/* q = A p and p . q. */
static void multiply(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  mpsi_fluid_system *s = &f->system;
  double pq = 0.0;
  for (int64_t i = begin; i < end; i++) {
    s->q[i] = f->state[i] == MPSI_FLUID_APART ? 0.0 : row_times(f, i, s->p);
    pq += s->p[i] * s->q[i];
  }
  s->sums[2 * chunk] = pq;
}

/* x += alpha p, r -= alpha q, z = (L D L^T)^-1 r in a block; r . r and r . z. */
static void precondition(void *data, int64_t b, int32_t worker) {
  (void)worker;
  const iteration *it = data;
  mps_fluid *f = it->fluid;
  mpsi_fluid_system *s = &f->system;
  const int64_t first = b * it->blocks.size;
  const int64_t end = first + it->blocks.size < f->count ? first + it->blocks.size : f->count;
  const int32_t *column = s->lower_col + b * it->room;
  const float *lower = s->lower + b * it->room;
  double rr = 0.0, rz = 0.0, *z = s->z;
  for (int64_t i = first; i < end; i++) {
    s->x[i] += it->alpha * s->p[i];
    const double r = s->r[i] - it->alpha * s->q[i];
    const int32_t last = s->lower_end[i];
    double sum = r, other = 0.0; /* two chains of additions */
    int32_t e = s->lower_start[i];
    for (; e + 2 <= last; e += 2) {
      sum -= lower[e] * z[column[e]];
      other -= lower[e + 1] * z[column[e + 1]];
    }
    if (e < last) sum -= lower[e] * z[column[e]];
    s->r[i] = r, z[i] = sum + other;
    rr += r * r;
  }
  for (int64_t i = first; i < end; i++) z[i] *= s->inverse[i];
  for (int64_t i = end - 1; i >= first; i--) {
    const double here = z[i];
    for (int32_t e = s->lower_start[i]; e < s->lower_end[i]; e++) z[column[e]] -= lower[e] * here;
    rz += s->r[i] * here;
  }
  s->sums[2 * b] = rr, s->sums[2 * b + 1] = rz;
}

static void turn_direction(mps_fluid *f, double beta) {
  mpsi_fluid_system *s = &f->system;
  for (int64_t i = 0; i < f->count; i++) s->p[i] = s->z[i] + beta * s->p[i];
  append_ghosts(f, s->p);
}

int64_t mpsi_fluid_pcg(mps_fluid *f) {
  mpsi_fluid_system *s = &f->system;
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  iteration it = {.fluid = f, .blocks = cut(f)};
  it.room = f->most_lower * it.blocks.size;
  append_ghosts(f, s->x);
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, first_residual);
  const double enough = f->def.tolerance * f->def.tolerance * total(f, chunks, 0);
  memset(s->p, 0, (size_t)(f->count + f->ghosts) * sizeof *s->p);
  memset(s->q, 0, (size_t)f->count * sizeof *s->q);
  double rz = 0.0;
  for (int64_t k = 0;; k++) {
    mpsi_parallel_for(f->context, it.blocks.count, precondition, &it);
    const double rr = total(f, it.blocks.count, 0), next = total(f, it.blocks.count, 1);
    if (rr <= enough) return k;
    if (!isfinite(rr) || k == f->def.iterations) return -1;
    turn_direction(f, k == 0 ? 0.0 : next / rz);
    rz = next;
    mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, multiply);
    it.alpha = rz / total(f, chunks, 0);
  }
}
