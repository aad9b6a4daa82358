/* cholesky.c - sparse Cholesky factorisation by CHOLMOD. The only file that includes cholmod.h.
 *
 * Each object has a cholmod_common of its own, which prints nothing and reports through its status.
 * CHOLMOD takes its memory from SuiteSparse's process-wide hooks, which belong to the host program
 * and are not changed; after any failure all memory of CHOLMOD is released.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cholesky.h"
#include "foreign.h"

#include <cholmod.h>

#include <string.h>

struct mpsi_cholesky {
  mps_context *context;
  cholmod_common common;
  cholmod_factor *factor;
  cholmod_dense *result, *y, *e; /* of the triangular solution */
  mpsi_ordering ordering;
  int32_t threads; /* of BLAS */
  bool ldlt, factored;
};

/* Errors are read from common->status after each call; the handler only has to exist, so that
 * CHOLMOD does not print. */
static void quiet(int status, const char *file, int line, const char *message) {}

static mps_status failure(mpsi_cholesky *c, const char *function, const char *what) {
  switch (c->common.status) {
  case CHOLMOD_OUT_OF_MEMORY:
    return mpsi_fail(c->context, function, MPS_ERROR_MEMORY,
                     "CHOLMOD ran out of memory in %s while it held %.3g MB: set memory_limit to "
                     "solve by conjugate gradients instead",
                     what, (double)c->common.memory_inuse * 1e-6);
  case CHOLMOD_TOO_LARGE:
    return mpsi_fail(c->context, function, MPS_ERROR_UNSUPPORTED,
                     "the problem is too large for CHOLMOD's integers in %s", what);
  case CHOLMOD_NOT_INSTALLED:
    return mpsi_fail(c->context, function, MPS_ERROR_UNSUPPORTED,
                     "this CHOLMOD was built without a part that %s needs (METIS or supernodal)",
                     what);
  default:
    return mpsi_fail(c->context, function, MPS_ERROR_INTERNAL, "CHOLMOD status %d in %s",
                     c->common.status, what);
  }
}

mps_status mpsi_cholesky_create(mps_context *context, const char *function, mpsi_ordering ordering,
                                bool ldlt, int32_t threads, mpsi_cholesky **out) {
  mpsi_cholesky *c = mpsi_alloc(context, 1, sizeof *c);
  if (!c) return mpsi_fail_memory(context, function, sizeof *c);
  c->context = context;
  c->ordering = ordering;
  c->ldlt = ldlt;
  c->threads = threads;
  if (!cholmod_l_start(&c->common)) {
    mpsi_free(context, c);
    return mpsi_fail(context, function, MPS_ERROR_MEMORY,
                     "CHOLMOD was refused the memory to start");
  }
  c->common.print = 0;
  c->common.try_catch = 0;
  c->common.error_handler = quiet;
  c->common.supernodal = ldlt ? CHOLMOD_SIMPLICIAL : CHOLMOD_SUPERNODAL;
  c->common.final_ll = !ldlt;
  /* METIS prints when memory is short. CHOLMOD first checks that twice the memory of METIS is
   * available, and otherwise orders by AMD. */
  c->common.metis_memory = 2.0;
  c->common.quick_return_if_not_posdef = 1;
  *out = c;
  return MPS_OK;
}

void mpsi_cholesky_destroy(mpsi_cholesky **cholesky) {
  mpsi_cholesky *c = *cholesky;
  if (!c) return;
  cholmod_l_free_dense(&c->result, &c->common);
  cholmod_l_free_dense(&c->y, &c->common);
  cholmod_l_free_dense(&c->e, &c->common);
  cholmod_l_free_factor(&c->factor, &c->common);
  cholmod_l_finish(&c->common);
  mpsi_free(c->context, c);
  *cholesky = NULL;
}

/* CHOLMOD's picture of the caller's arrays: nothing is copied. */
static cholmod_sparse wrap(const mpsi_matrix *a) {
  cholmod_sparse s;
  memset(&s, 0, sizeof s);
  s.nrow = s.ncol = (size_t)a->n;
  s.nzmax = (size_t)a->column[a->n];
  s.p = (void *)a->column;
  s.i = (void *)a->row;
  s.x = (void *)a->value;
  s.stype = -1; /* lower triangle */
  s.itype = CHOLMOD_LONG;
  s.xtype = a->value ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  s.dtype = CHOLMOD_DOUBLE;
  s.sorted = 1;
  s.packed = 1;
  return s;
}

static void choose_orderings(mpsi_cholesky *c) {
  cholmod_common *common = &c->common;
  common->nmethods = c->ordering == MPSI_ORDER_BEST ? 2 : 1;
  common->method[0].ordering = c->ordering == MPSI_ORDER_METIS ? CHOLMOD_METIS : CHOLMOD_AMD;
  common->method[1].ordering = CHOLMOD_METIS;
  common->postorder = 1;
}

/* The graph of groups, in column (groups + 1) and row; `mark` is scratch of `groups`. With row NULL
 * it only counts: column[groups] is the room that row needs. */
static void compress(const mpsi_matrix *a, const int64_t *group, int64_t groups, int64_t *column,
                     int64_t *row, int64_t *mark) {
  int64_t count = 0, unknown = 0;
  for (int64_t g = 0; g < groups; g++) mark[g] = -1;
  for (int64_t g = 0; g < groups; g++) {
    column[g] = count;
    for (; unknown < a->n && group[unknown] == g; unknown++)
      for (int64_t k = a->column[unknown]; k < a->column[unknown + 1]; k++) {
        const int64_t r = group[a->row[k]];
        if (mark[r] == g) continue;
        mark[r] = g;
        if (row) row[count] = r;
        count++;
      }
  }
  column[groups] = count;
}

/* Orders the groups; *order[k] becomes the k-th unknown to be eliminated. */
static mps_status order_groups(mpsi_cholesky *c, const char *function, const mpsi_matrix *a,
                               const int64_t *group, int64_t groups, int64_t *scratch,
                               int64_t *order, mpsi_ordering *chosen) {
  int64_t *column = scratch, *mark = scratch + groups + 1;
  compress(a, group, groups, column, NULL, mark);
  int64_t *row = mpsi_alloc(c->context, column[groups], sizeof *row);
  if (!row) return mpsi_fail_memory(c->context, function, (size_t)column[groups] * sizeof *row);
  compress(a, group, groups, column, row, mark);
  const mpsi_matrix graph = {.n = groups, .column = column, .row = row};
  cholmod_sparse s = wrap(&graph);
  s.sorted = 0;
  choose_orderings(c);
  /* Only the ordering is needed: not the supernodes of this small factor. */
  c->common.supernodal = CHOLMOD_SIMPLICIAL;
  cholmod_factor *small = cholmod_l_analyze(&s, &c->common);
  c->common.supernodal = c->ldlt ? CHOLMOD_SIMPLICIAL : CHOLMOD_SUPERNODAL;
  mpsi_free(c->context, row);
  if (!small || c->common.status < CHOLMOD_OK) {
    const mps_status status = failure(c, function, "the ordering");
    cholmod_l_free_factor(&small, &c->common);
    return status;
  }
  *chosen = small->ordering == CHOLMOD_METIS ? MPSI_ORDER_METIS : MPSI_ORDER_AMD;
  for (int64_t g = 0, unknown = 0; g < groups; g++) { /* column becomes: first unknown of g */
    column[g] = unknown;
    while (unknown < a->n && group[unknown] == g) unknown++;
    column[g + 1] = unknown;
  }
  const int64_t *permutation = small->Perm;
  int64_t count = 0;
  for (int64_t k = 0; k < groups; k++) {
    const int64_t g = permutation[k];
    for (int64_t unknown = column[g]; unknown < column[g + 1]; unknown++) order[count++] = unknown;
  }
  cholmod_l_free_factor(&small, &c->common);
  return MPS_OK;
}

/* CHOLMOD cannot end a stage before it is complete: the hook is called between them. */
static mps_status call_cancel(mpsi_cholesky *c, const char *function, const char *what) {
  if (!mpsi_cancelled(c->context)) return MPS_OK;
  return mpsi_fail(c->context, function, MPS_ERROR_CANCELLED, "cancelled before %s", what);
}

/* The analysis of the whole matrix in the given order. */
static mps_status analyse_ordered(mpsi_cholesky *c, const char *function, const mpsi_matrix *a,
                                  int64_t *order, mpsi_cholesky_symbolic *out) {
  cholmod_sparse s = wrap(a);
  s.x = NULL;
  s.xtype = CHOLMOD_PATTERN;
  c->common.nmethods = 1;
  c->common.method[0].ordering = CHOLMOD_GIVEN;
  c->factor = cholmod_l_analyze_p(&s, order, NULL, 0, &c->common);
  if (!c->factor || c->common.status < CHOLMOD_OK) {
    const mps_status status = failure(c, function, "the analysis");
    cholmod_l_free_factor(&c->factor, &c->common);
    return status;
  }
  out->nonzeros = (int64_t)c->common.lnz;
  out->flops = c->common.fl;
  /* Supernodal: dense blocks with their padding and the row lists; simplicial: value and row. */
  out->bytes = c->factor->is_super ? 8.0 * (double)c->factor->xsize + 8.0 * (double)c->factor->ssize
                                   : 16.0 * c->common.lnz;
  return MPS_OK;
}

mps_status mpsi_cholesky_analyse(mpsi_cholesky *c, const char *function, const mpsi_matrix *a,
                                 const int64_t *group, int64_t groups,
                                 mpsi_cholesky_symbolic *out) {
  MPSI_TRY(call_cancel(c, function, "the ordering"));
  cholmod_l_free_factor(&c->factor, &c->common);
  c->factored = false;
  const int64_t words = 2 * groups + 1 + a->n;
  int64_t *scratch = mpsi_alloc(c->context, words, sizeof *scratch);
  if (!scratch) return mpsi_fail_memory(c->context, function, (size_t)words * sizeof *scratch);
  int64_t *order = scratch + (words - a->n);
  mps_status status = order_groups(c, function, a, group, groups, scratch, order, &out->ordering);
  if (status == MPS_OK) status = call_cancel(c, function, "the analysis");
  if (status == MPS_OK) status = analyse_ordered(c, function, a, order, out);
  mpsi_free(c->context, scratch);
  return status;
}

mps_status mpsi_cholesky_factor(mpsi_cholesky *c, const char *function, const mpsi_matrix *a,
                                int64_t *bad) {
  *bad = -1;
  MPSI_TRY(call_cancel(c, function, "the factorisation"));
  c->factored = false;
  cholmod_sparse s = wrap(a);
  mpsi_foreign_enter(c->threads);
  cholmod_l_factorize(&s, c->factor, &c->common);
  mpsi_foreign_leave();
  if (c->common.status < CHOLMOD_OK) return failure(c, function, "the factorisation");
  if (c->common.status == CHOLMOD_NOT_POSDEF || c->factor->minor < c->factor->n) {
    const int64_t *permutation = c->factor->Perm;
    const size_t minor = c->factor->minor;
    *bad = minor < c->factor->n ? (permutation ? permutation[minor] : (int64_t)minor) : -1;
    return mpsi_fail(c->context, function, MPS_ERROR_NUMERIC,
                     "the matrix is not positive definite at unknown %lld of %lld", (long long)*bad,
                     (long long)a->n);
  }
  c->factored = true;
  return MPS_OK;
}

/* The work of a supernodal solution. CHOLMOD would allocate it itself, but 3.0.14 continues when
 * the first of the two allocations fails and the second succeeds. */
static bool ensure_work(mpsi_cholesky *c, int64_t count) {
  if (!c->factor->is_super) return true;
  const size_t n = c->factor->n, k = (size_t)count;
  return cholmod_l_ensure_dense(&c->y, n, k, n, CHOLMOD_REAL, &c->common) &&
         cholmod_l_ensure_dense(&c->e, k, c->factor->maxesize, k, CHOLMOD_REAL, &c->common);
}

mps_status mpsi_cholesky_solve(mpsi_cholesky *c, const char *function, int64_t count,
                               const double *b, double *x) {
  const int64_t n = (int64_t)c->factor->n;
  cholmod_dense right;
  memset(&right, 0, sizeof right);
  right.nrow = right.d = (size_t)n;
  right.ncol = (size_t)count;
  right.nzmax = (size_t)(n * count);
  right.x = (void *)b;
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  /* The three work arrays stay for the next call, which then allocates nothing. */
  mpsi_foreign_enter(c->threads);
  const bool good =
      ensure_work(c, count) && cholmod_l_solve2(CHOLMOD_A, c->factor, &right, NULL, &c->result,
                                                NULL, &c->y, &c->e, &c->common);
  mpsi_foreign_leave();
  if (!good) return failure(c, function, "the triangular solution");
  memcpy(x, c->result->x, (size_t)(n * count) * sizeof *x);
  return MPS_OK;
}

double mpsi_cholesky_rcond(mpsi_cholesky *c) {
  return c->factored ? cholmod_l_rcond(c->factor, &c->common) : 0.0;
}

double mpsi_cholesky_peak_bytes(const mpsi_cholesky *c) { return (double)c->common.memory_usage; }
