/* pcg.c - conjugate gradients for the pressure, preconditioned by a modified incomplete Cholesky
 * factorisation (L + D) D^-1 (L + D)^T of diagonal blocks of the matrix: L is the matrix's own
 * lower part, and what elimination would fill in goes to the pivots D, most of it (Gustafsson
 * 1978).
 *
 * The matrix is not stored: a row is the weights of the particle's neighbours, and vectors that are
 * multiplied have the values of the ghosts' parents appended. The start vector is extrapolated from
 * the last two steps (pressure.c), which more than halves the iterations in waves. The blocks
 * depend on the number of particles alone, and sums are made chunk by chunk, so the result does not
 * depend on the threads. SPDX-License-Identifier: BSD-3-Clause */
#include "loops.h"

#include <string.h>

#define BLOCK 2560       /* particles in a block of the preconditioner, about */
#define MOST_BLOCKS 32   /* larger blocks instead */
#define MODIFIED 0.95    /* share of the fill that goes to the pivots */
#define LEAST_PIVOT 1e-3 /* of the diagonal */
#define TURN_CHUNK 4096

/* ---- preconditioner -------------------------------------------------------------------------- */

typedef struct blocks {
  int64_t count, size;
} blocks;

static blocks cut(const mps_fluid *f) {
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  int64_t wanted = (f->count + BLOCK - 1) / BLOCK;
  if (wanted > MOST_BLOCKS) wanted = MOST_BLOCKS;
  const int64_t each = (chunks + wanted - 1) / wanted; /* whole chunks */
  return (blocks){(chunks + each - 1) / each, each * MPSI_FLUID_CHUNK};
}

/* Row i of L, scaled by the pivots' inverses; the pivot of row i, and what is right of it. A
 * neighbour and its image are two entries. */
static int32_t lower_row(const mps_fluid *f, int64_t first, int64_t end, int64_t i, int32_t *column,
                         float *lower) {
  const mpsi_fluid_system *s = &f->system;
  const int32_t *index = f->index + f->start[i];
  const double *w = f->w + f->start[i], *inverse = s->inverse, *upper = s->z;
  double pivot = s->diagonal[i], right = 0.0;
  int32_t count = 0;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t ghost = index[k] - f->count;
    const int32_t j = ghost < 0 ? index[k] : f->parent[ghost];
    if (j < first || j >= end || f->state[j] == MPSI_FLUID_APART) continue;
    if (j == i) pivot -= w[k];
    if (j > i) right += w[k];
    if (j >= i) continue;
    const double l = w[k] * inverse[j];
    pivot -= l * (w[k] + MODIFIED * (upper[j] - w[k]));
    column[count] = j, lower[count] = (float)-l;
    count++;
  }
  s->z[i] = right;
  s->inverse[i] = 1.0 / fmax(pivot, LEAST_PIVOT * s->diagonal[i]);
  return count;
}

typedef struct factor_pass {
  mps_fluid *fluid;
  blocks blocks;
  int64_t room; /* entries for each block */
  atomic_bool full;
} factor_pass;

static void factor_block(void *data, int64_t b, int32_t worker) {
  (void)worker;
  factor_pass *p = data;
  mps_fluid *f = p->fluid;
  mpsi_fluid_system *s = &f->system;
  const int64_t first = b * p->blocks.size;
  const int64_t end = first + p->blocks.size < f->count ? first + p->blocks.size : f->count;
  int64_t at = b * p->room;
  for (int64_t i = first; i < end; i++) {
    if (at + f->near[i] > (b + 1) * p->room) {
      atomic_store(&p->full, true);
      return;
    }
    s->lower_start[i] = (int32_t)(at - b * p->room);
    if (f->state[i] == MPSI_FLUID_APART)
      s->inverse[i] = 1.0;
    else
      at += lower_row(f, first, end, i, s->lower_col + at, s->lower + at);
    s->lower_end[i] = (int32_t)(at - b * p->room);
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

/* r = b - A x, and the square of b. */
static void first_residual(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  mpsi_fluid_system *s = &f->system;
  double bb = 0.0;
  f->loops->times(f, begin, end, s->x, s->q);
  for (int64_t i = begin; i < end; i++) {
    s->r[i] = s->right[i] - s->q[i];
    s->q[i] = 0.0;
    bb += s->right[i] * s->right[i];
  }
  s->sums[2 * chunk] = bb;
}

/* q = A p and p . q. */
static void multiply(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  mpsi_fluid_system *s = &f->system;
  s->sums[2 * chunk] = f->loops->times(f, begin, end, s->p, s->q);
}

/* x += alpha p, r -= alpha q and z from r in a block. */
static void precondition(void *data, int64_t b, int32_t worker) {
  (void)worker;
  const iteration *it = data;
  mps_fluid *f = it->fluid;
  const int64_t first = b * it->blocks.size, last = first + it->blocks.size;
  f->loops->precondition(f, first, last < f->count ? last : f->count, b * it->room, it->alpha,
                         f->system.sums + 2 * b);
}

/* p = z + beta p */
static void turn(void *data, int64_t unit, int32_t worker) {
  (void)worker;
  const iteration *it = data;
  const mpsi_fluid_system *s = &it->fluid->system;
  const int64_t begin = unit * TURN_CHUNK, last = begin + TURN_CHUNK;
  const int64_t end = last < it->fluid->count ? last : it->fluid->count;
  for (int64_t i = begin; i < end; i++) s->p[i] = s->z[i] + it->beta * s->p[i];
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
  double rz = 0.0;
  for (int64_t k = 0;; k++) {
    mpsi_parallel_for(f->context, it.blocks.count, precondition, &it);
    const double rr = total(f, it.blocks.count, 0), next = total(f, it.blocks.count, 1);
    if (rr <= enough) return k;
    if (!isfinite(rr) || k == f->def.iterations) return -1;
    it.beta = k == 0 ? 0.0 : next / rz;
    mpsi_parallel_for(f->context, (f->count + TURN_CHUNK - 1) / TURN_CHUNK, turn, &it);
    append_ghosts(f, s->p);
    rz = next;
    mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, multiply);
    it.alpha = rz / total(f, chunks, 0);
  }
}
