/* gradients.c - see gradients.h. The preconditioner is additive: the reciprocal diagonal D^-1, and
 * beside it, for all but small systems, the solution of the coarse equation (coarse.h),
 *
 *   z = D^-1 r + Z E^-1 Z^T r.
 *
 * Iterations end on r.D^-1 r, whatever the preconditioner.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "gradients.h"

#include "coarse.h"
#include "operator.h"
#include "outside.h"
#include "solver/linear.h"

#define TOLERANCE 1e-9 /* of the residual, over the right-hand side */
enum { MOST_ITERATIONS = 5000 };
typedef struct mpsi_pore_system system_of;

/* d = 0, the direction 0; r.D^-1 r to the sums. */
static void start(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  int shift[MPSI_PORE_MOST_SPAN];
  mpsi_pore_list_shifts(&mpm->grid, shift);
  s->part[g] = 0.0;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    const int64_t at = first + k;
    if (!mpsi_pore_is_unknown(mpm->water, g, k)) continue;
    s->inverse[at] = 1.0 / mpsi_pore_diagonal_of(mpm, s, g, k, shift);
    s->change[at] = s->direction[at] = 0.0;
    s->part[g] += s->residual[at] * s->residual[at] * s->inverse[at];
  }
  mpsi_pore_coarse_restrict(mpm, g);
}

/* Along the direction; the new r.D^-1 r to the sums. */
static void advance(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  s->part[g] = 0.0;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k)) continue;
    const int64_t at = first + k;
    s->change[at] += factor * s->direction[at];
    s->residual[at] -= factor * s->product[at];
    s->part[g] += s->residual[at] * s->residual[at] * s->inverse[at];
  }
  mpsi_pore_coarse_restrict(mpm, g);
}

/* The new direction: z, and `factor` of the former one. */
static void turn(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (mpsi_pore_is_unknown(mpm->water, g, k))
      s->direction[first + k] = s->inverse[first + k] * s->residual[first + k] +
                                mpsi_pore_coarse_at(mpm, g, k) + factor * s->direction[first + k];
}

static mps_status refuse(mps_mpm *mpm, const char *function, double rest, double least) {
  const mps_status status =
      mpsi_fail(mpm->context, function, MPS_ERROR_NUMERIC,
                "step %lld: pressures of the pore water have a residual of %g after %lld "
                "iterations, must come to %g: choose a smaller dt or K_w",
                (long long)mpm->run.steps, sqrt(rest), (long long)mpm->water->system->iterations,
                sqrt(least));
  /* all ranks have the same sums, and fail alike */
  return mpsi_domain_agree(mpm->domain, function, status);
}

/* Squares of the residual: r.D^-1 r, and r.z. */
typedef struct squares {
  double rest, all;
} squares;

/* Work on blocks that ends with a new residual, and its squares. */
static mps_status renew(mps_mpm *mpm, const char *function, mpsi_pore_task task, double factor,
                        squares *out) {
  double more = 0.0;
  mps_status status = mpsi_pore_sum_blocks(mpm, function, task, factor, &out->rest);
  if (status == MPS_OK && isfinite(out->rest))
    status = mpsi_pore_coarse_solve(mpm, function, &more);
  out->all = out->rest + more;
  return status;
}

static mps_status iterate(mps_mpm *mpm, const char *function, double before, squares *now) {
  double along;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, turn, before > 0.0 ? now->all / before : 0.0);
  MPSI_TRY(mpsi_pore_apply(mpm, function, &along));
  return renew(mpm, function, advance, now->all / along, now);
}

/* The solution of the caller's solver, and whether it is one. */
static mps_status ask_outside(mps_mpm *mpm, const char *function, double before, squares *now) {
  double along;
  MPSI_TRY(mpsi_pore_solve_outside(mpm, function, TOLERANCE));
  MPSI_TRY(mpsi_pore_apply(mpm, function, &along));
  MPSI_TRY(renew(mpm, function, advance, 1.0, now));
  return mpsi_linear_check(&mpm->base, function, TOLERANCE, 0.0, now->rest, before);
}

static mps_status run_iterations(mps_mpm *mpm, const char *function, double least, squares *now) {
  system_of *s = mpm->water->system;
  double before = 0.0; /* r.z of the iteration before */
  mps_status status = MPS_OK;
  for (s->iterations = 0; status == MPS_OK && (now->rest > least || !isfinite(now->rest));
       s->iterations++) {
    const double last = now->all;
    if (s->iterations == MOST_ITERATIONS || !isfinite(now->rest))
      return refuse(mpm, function, now->rest, least);
    status = iterate(mpm, function, before, now);
    before = last;
  }
  return status;
}

mps_status mpsi_pore_find_changes(mps_mpm *mpm, const char *function) {
  squares now;
  MPSI_TRY(mpsi_pore_find_coarse(mpm, function));
  MPSI_TRY(renew(mpm, function, start, 0.0, &now));
  if (mpsi_pore_solved_outside(mpm) && isfinite(now.rest))
    return ask_outside(mpm, function, now.rest, &now);
  return run_iterations(mpm, function, TOLERANCE * TOLERANCE * now.rest, &now);
}
