/* pcg.c - conjugate gradients for the pressure, preconditioned by a modified incomplete Cholesky
 * factorisation U^T D U of diagonal blocks of the matrix A: U^T is unit lower triangular, U^T D - D
 * is the matrix's own lower part, and most of the fill of the elimination is added to the pivots D
 * (Gustafsson 1978).
 *
 * As the factors have the matrix's own entries, no product with A is needed (Eisenstat 1981): for z
 * = U^-1 v, and A = U^T D + D U + (diag A - 2 D) + C, C the entries of A between blocks,
 *
 *   U^-T A z = D z + U^-T (D v + (diag A - 2 D) z + C z).
 *
 * So an iteration is a solution with U (descend), then one with U^T (rise), for all rows of a
 * block; blocks wait for each other twice. The sums of both are all that an iteration needs
 * (Chronopoulos and Gear 1989): r is the residual times U^-T, p the direction, s = U^-T A p.
 *
 * For large fluids a coarse space (coarse.h) removes the smooth error, so that the iterations
 * hardly grow with the number of particles.
 *
 * The factors are kept in single precision: below a tolerance of 1e-6 the residual is computed
 * again with A itself and the remainder is solved for. A is not stored: a row is the weights of the
 * particle's neighbours, and vectors that it multiplies have the values of the ghosts' parents
 * appended. The start vector is extrapolated from the last two steps (pressure.c), which more than
 * halves the iterations in waves. The blocks depend on the number of particles alone, and sums are
 * made chunk by chunk, so the result does not depend on the threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pcg.h"
#include "fluid/base/access.h"
#include "coarse.h"
#include "fluid/base/loops.h"
#include "fluid/ranks/partition.h"

#include <string.h>

/* Fraction of the fill that is added to the pivots. It serves the smooth error: with a coarse
 * space, which removes that, less of it takes fewer iterations (4.3 in place of 5.2 with 1e4
 * particles, 7.7 in place of 9.0 with 1e5). */
#define MODIFIED 0.95
#define MODIFIED_DEFLATED 0.8
#define LEAST_PIVOT 1e-3 /* of the diagonal */
/* The residual is computed first at LOOK_FROM times the rz at which it would be small enough if
 * both fell in proportion, and again when rz has fallen by LOOK_AGAIN or less. */
#define LOOK_FROM 4.0
#define LOOK_AGAIN 0.25
#define SINGLE 1e-6   /* tolerance that factors in single precision allow */
#define DEFLATED 1e-4 /* of the residual, in one go with the coarse space: see mpsi_fluid_pcg */

/* ---- preconditioner -------------------------------------------------------------------------- */

/* Row i of the unit lower triangular U^T, without the 1 on its diagonal: the entries go to `column`
 * and `lower`, their number is returned. Also the pivot (s->r, its reciprocal s->inverse), the sum
 * of the entries right of the diagonal (s->z) and diag A - 2 D (u_new[1], which has no other use
 * before the pressure is known). A neighbour and its image are two entries. Rounding of an entry to
 * single precision is added to the diagonals, so that the row sums stay exact: without a free
 * surface the matrix would become indefinite otherwise. */
static int32_t lower_row(mps_fluid *f, int64_t first, int64_t end, int64_t i, double modified,
                         uint16_t *column, float *lower) {
  const mpsi_fluid_system *s = &f->system;
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  const float *inverse = s->inverse;
  const double *upper = s->z;
  double own = s->diagonal[i], pivot = 0.0, right = 0.0;
  int32_t count = 0;
  bool others = false;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t ghost = index[k] - f->count;
    const int32_t j = ghost < 0 ? index[k] : f->parent[ghost];
    if (f->state[j] == MPSI_FLUID_APART) continue;
    others = others || j < first || j >= end;
    if (j < first || j >= end) continue;
    if (j == i) own -= w[k];
    if (j > i) right += w[k];
    if (j >= i) continue;
    const double l = w[k] * (double)inverse[j];
    pivot -= l * (w[k] + modified * (upper[j] - w[k]));
    column[count] = (uint16_t)(j - first), lower[count] = (float)-l;
    const double missed = w[k] + (double)lower[count] * s->r[j];
    own -= missed, f->u_new[1][j] -= missed;
    count++;
  }
  pivot = fmax(own + pivot, LEAST_PIVOT * s->diagonal[i]);
  s->inverse[i] = (float)(1.0 / pivot);
  pivot = 1.0 / (double)s->inverse[i];
  s->z[i] = right, s->r[i] = pivot;
  f->u_new[1][i] = own - 2.0 * pivot;
  f->company[i] =
      (uint8_t)((f->company[i] & ~MPSI_FLUID_NEAR_OTHERS) | (others ? MPSI_FLUID_NEAR_OTHERS : 0));
  return count;
}

typedef struct factor_pass {
  mps_fluid *fluid;
  mpsi_fluid_blocks blocks;
  int64_t capacity, all; /* entries for each block but the last, and for all */
  atomic_bool full;
} factor_pass;

static void factor_block(void *data, int64_t b, int32_t worker) {
  factor_pass *p = data;
  mps_fluid *f = p->fluid;
  mpsi_fluid_system *s = &f->system;
  const int64_t first = b * p->blocks.size;
  const int64_t end = first + p->blocks.size < f->count ? first + p->blocks.size : f->count;
  const int64_t limit = (b + 1) * p->capacity < p->all ? (b + 1) * p->capacity : p->all;
  const double modified =
      f->report.surface > 0 && mpsi_fluid_has_coarse(f) ? MODIFIED_DEFLATED : MODIFIED;
  int64_t at = b * p->capacity;
  for (int64_t i = first; i < end; i++) {
    if (at + f->near[i] > limit) {
      atomic_store(&p->full, true);
      return;
    }
    if (f->state[i] == MPSI_FLUID_APART)
      s->inverse[i] = 1.0f, f->u_new[1][i] = -1.0;
    else
      at += lower_row(f, first, end, i, modified, s->lower_col + at, s->lower + at);
    s->lower_end[i] = (int32_t)(at - b * p->capacity);
  }
}

mps_status mpsi_fluid_factor(mps_fluid *f, const char *function) {
  mpsi_fluid_system *s = &f->system;
  factor_pass p = {.fluid = f, .blocks = mpsi_fluid_cut(f)};
  for (;;) {
    p.capacity = f->most_lower * p.blocks.size / 8;
    p.all = f->most_lower * f->count / 8 + p.blocks.size;
    mps_status status = MPS_OK;
    if (!mpsi_room_fit(f->context, &f->lower_col_room, p.all, sizeof *s->lower_col) ||
        !mpsi_room_fit(f->context, &f->lower_room, p.all, sizeof *s->lower))
      status = mpsi_fail_memory(f->context, function, (size_t)p.all * 6);
    s->lower_col = f->lower_col_room.item;
    s->lower = f->lower_room.item;
    atomic_store(&p.full, false);
    if (status == MPS_OK) mpsi_fluid_units(f, p.blocks.size, factor_block, &p);
    double full = atomic_load(&p.full);
    status = mpsi_fluid_agree_max(f, function, status, 1, &full);
    if (status == MPS_OK && full == 0.0)
      return mpsi_fluid_coarsen(f, function, p.blocks.size, p.blocks.count);
    if (status != MPS_OK) return status;
    f->most_lower += 1 + f->most_lower / 128;
  }
}

/* ---- the iteration --------------------------------------------------------------------------- */

typedef struct iteration {
  mps_fluid *fluid;
  mpsi_fluid_blocks blocks;
  int64_t capacity;
  double alpha, beta;
} iteration;

/* Sum over `count` chunks or blocks of sum `which` (0 or 1) of the two that each has stored. */
static double total(const mps_fluid *f, int64_t count, int which) {
  double sum = 0.0;
  for (int64_t k = 0; k < count; k++) sum += f->system.sums[2 * k + which];
  return sum;
}

/* r = b - A x, and the squares of r and b; resets the iteration. */
static void first_residual(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  mpsi_fluid_system *s = &f->system;
  double rr = 0.0, bb = 0.0;
  f->loops->times(f, begin, end, s->x, s->q);
  for (int64_t i = begin; i < end; i++) {
    s->r[i] = s->right[i] - s->q[i];
    s->p[i] = s->q[i] = s->z[i] = f->u_new[0][i] = 0.0;
    rr += s->r[i] * s->r[i];
    bb += s->right[i] * s->right[i];
  }
  s->sums[2 * chunk] = rr, s->sums[2 * chunk + 1] = bb;
}

static int64_t end_of(const iteration *it, int64_t b) {
  const int64_t last = (b + 1) * it->blocks.size;
  return last < it->fluid->count ? last : it->fluid->count;
}

static void start_block(void *data, int64_t b, int32_t worker) {
  const iteration *it = data;
  mps_fluid *f = it->fluid;
  const int64_t first = b * it->blocks.size, end = end_of(it, b);
  f->loops->forward(f, first, end, b * it->capacity, f->system.r);
  f->system.sums[2 * b] = f->loops->descend(f, first, end, b * it->capacity, 0.0, 0.0);
  if (f->coarse->used) mpsi_fluid_coarse_restrict(f, b, f->system.z);
}

static void descend(void *data, int64_t b, int32_t worker) {
  const iteration *it = data;
  mps_fluid *f = it->fluid;
  if (f->coarse->used)
    mpsi_fluid_coarse_deflate(f->coarse, b * it->blocks.size, end_of(it, b), f->system.z);
  f->system.sums[2 * b] = f->loops->descend(f, b * it->blocks.size, end_of(it, b), b * it->capacity,
                                            it->alpha, it->beta);
  if (f->coarse->used) mpsi_fluid_coarse_restrict(f, b, f->system.z);
}

static void rise(void *data, int64_t b, int32_t worker) {
  const iteration *it = data;
  mps_fluid *f = it->fluid;
  f->system.sums[2 * b + 1] =
      f->loops->rise(f, b * it->blocks.size, end_of(it, b), b * it->capacity);
}

static void norm(void *data, int64_t b, int32_t worker) {
  const iteration *it = data;
  mps_fluid *f = it->fluid;
  f->system.sums[2 * b + 1] =
      f->loops->norm(f, b * it->blocks.size, end_of(it, b), b * it->capacity, f->system.r);
}

/* Iterates from the residual r, whose square is rr, until that is `enough`; counts in *done. The
 * preconditioner's norm, known in each iteration, decides when to compute that of the residual. */
static bool iterate(iteration *it, double rr, double enough, int64_t *done) {
  mps_fluid *f = it->fluid;
  const int64_t number = it->blocks.count;
  it->beta = 0.0;
  mpsi_fluid_units(f, it->blocks.size, start_block, it);
  mpsi_fluid_send_sums(f, it->blocks.size);
  double rz = total(f, number, 0), look_at = LOOK_FROM * rz * enough / rr;
  for (int64_t k = 0;; k++) {
    if (rz <= look_at) {
      mpsi_fluid_units(f, it->blocks.size, norm, it);
      mpsi_fluid_send_sums(f, it->blocks.size);
      rr = total(f, number, 1);
      if (rr <= enough) return true;
      look_at = rz * fmax(LOOK_AGAIN, enough / rr);
    }
    if (!isfinite(rz) || *done == f->def.iterations) return false;
    if (f->coarse->used) mpsi_fluid_coarse_solve(f);
    mpsi_fluid_send_halo(f, 1, &f->system.z);
    mpsi_fluid_units(f, it->blocks.size, rise, it);
    mpsi_fluid_send_sums(f, it->blocks.size);
    const double before = it->alpha, qz = total(f, number, 1);
    it->alpha = k == 0 ? rz / qz : rz / (qz - it->beta * rz / before);
    mpsi_fluid_units(f, it->blocks.size, descend, it);
    mpsi_fluid_send_sums(f, it->blocks.size);
    (*done)++;
    const double next = total(f, number, 0);
    it->beta = next / rz;
    rz = next;
  }
}

int64_t mpsi_fluid_pcg(mps_fluid *f) {
  mpsi_fluid_system *s = &f->system;
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  const double tolerance = f->def.tolerance;
  iteration it = {.fluid = f, .blocks = mpsi_fluid_cut(f)};
  it.capacity = f->most_lower * it.blocks.size / 8;
  int64_t done = 0;
  for (double left = INFINITY;;) {
    mpsi_fluid_send_halo(f, 1, &s->x);
    for (int64_t g = 0; g < f->ghosts; g++) s->x[f->count + g] = s->x[f->parent[g]];
    mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, first_residual);
    mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
    const double rr = total(f, chunks, 0), bb = total(f, chunks, 1);
    const double enough = tolerance * tolerance * bb;
    if (bb == 0.0) memset(s->x, 0, (size_t)(f->count + f->ghosts) * sizeof *s->x);
    if (bb == 0.0) return 0;
    if (rr <= enough || !(rr < 0.25 * left)) return isfinite(rr) ? done : -1; /* or round-off */
    /* Round-off of the factors slowly restores components of the coarse space, which no iteration
     * removes: the solution proceeds by some digits at a time. */
    const double begin = f->coarse->used ? mpsi_fluid_coarse_start(f) : rr;
    const double goal = f->coarse->used ? fmax(enough, DEFLATED * DEFLATED * begin) : enough;
    if (!iterate(&it, begin, goal, &done)) return -1;
    if (tolerance >= SINGLE && goal == enough) return done;
    left = rr;
  }
}
