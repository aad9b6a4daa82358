/* assemble.c - the sparse symmetric matrix of the free unknowns: lower triangle, compressed
 * columns, rows ascending.
 *
 * Row block p of K is gathered from all parts of the energy (see operator.c) that p takes part in:
 * gradients of p and of its stencil neighbours, and pairs of which a site is p. Rows are
 * independent, so they are shared among threads and come out the same for every number of them.
 * What is structurally zero (the offset stencils of a square lattice cancel in many places) is not
 * stored: the pattern depends on shape and supports only, never on the material.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_private.h"

#include <stdlib.h>
#include <string.h>

#define ROW_MAX 2048 /* sites that share an energy with one particle: (2 * 4 + 3)^3 and more */
#define PAIR_MAX 16  /* sites of a pair's relative displacement: 2 + 2 * 7 at most */

typedef struct block {
  int64_t site;
  double value[3][3];
  bool used[3][3];
} block;

/* One worker's sparse accumulator. */
typedef struct gather {
  int32_t *slot; /* of site, or -1; n of them */
  int32_t count;
  int64_t particle;
  block blocks[ROW_MAX];
  int32_t order[ROW_MAX];
} gather;

typedef struct assembly {
  mps_elastic *e;
  gather *gathers; /* one a worker */
  int64_t *length; /* of each column, in the counting pass */
  bool fill;
} assembly;

static block *block_of(gather *g, int64_t site) {
  if (g->slot[site] < 0) {
    g->slot[site] = g->count;
    block *b = &g->blocks[g->count++];
    memset(b, 0, sizeof *b);
    b->site = site;
  }
  return &g->blocks[g->slot[site]];
}

static void add(block *b, int c, int f, double value) {
  b->value[c][f] += value;
  b->used[c][f] = true;
}

/* ---- parts of the energy
 * -------------------------------------------------------------------------- */

/* Coupling of sites with gradient coefficients a and b in V W(G), conservative. */
static void couple_conservative(const mps_elastic *e, int64_t i, const double *a, const double *b,
                                block *out) {
  const double v = e->volume[i], lambda = v * e->lambda[i], mu = v * e->mu[i];
  double product = 0.0;
  bool any = false;
  for (int c = 0; c < e->dim; c++) {
    product += a[c] * b[c];
    any |= a[c] != 0.0 && b[c] != 0.0;
  }
  for (int c = 0; c < e->dim; c++)
    for (int f = 0; f < e->dim; f++) {
      const bool one = a[c] != 0.0 && b[f] != 0.0, two = b[c] != 0.0 && a[f] != 0.0;
      if (one || two || (c == f && any))
        add(out, c, f, lambda * a[c] * b[f] + mu * b[c] * a[f] + (c == f ? mu * product : 0.0));
    }
}

/* The same of (10) with R and D eliminated. */
static void couple_published(const mps_elastic *e, int64_t i, const double *a, const double *b,
                             block *out) {
  const double n = e->def.divisor == MPS_ELASTIC_CONSTANT ? 1.0 : e->density[i] / e->density0;
  const double v = e->volume[i] * n;
  const double ra[2] = {-a[1], a[0]}, rb[2] = {-b[1], b[0]};
  for (int c = 0; c < 2; c++)
    for (int f = 0; f < 2; f++)
      if ((a[c] != 0.0 && b[f] != 0.0) || (ra[c] != 0.0 && rb[f] != 0.0))
        add(out, c, f, v * (e->lambda[i] * a[c] * b[f] - e->mu[i] * ra[c] * rb[f]));
}

static void gather_gradient(const mps_elastic *e, int64_t i, gather *g) {
  int64_t sites[MPSI_STENCIL_MAX];
  double coefficient[MPSI_STENCIL_MAX][3];
  const int32_t m = mpsi_elastic_stencil(e, i, sites, coefficient);
  int32_t mine = 0;
  while (sites[mine] != g->particle) mine++;
  for (int32_t b = 0; b < m; b++) {
    block *out = block_of(g, sites[b]);
    if (e->def.method == MPS_ELASTIC_CONSERVATIVE)
      couple_conservative(e, i, coefficient[mine], coefficient[b], out);
    else
      couple_published(e, i, coefficient[mine], coefficient[b], out);
  }
}

static int32_t merge(int64_t *sites, double *c, int32_t m, int64_t site, double value) {
  for (int32_t a = 0; a < m; a++)
    if (sites[a] == site) {
      c[a] += value;
      return m;
    }
  sites[m] = site;
  c[m] = value;
  return m + 1;
}

/* e_ij = sum_a c[a] u[site a] for the pair of i and its neighbour at offset k. */
static int32_t pair_sites(const mps_elastic *e, int64_t i, int32_t k, int64_t *sites, double *c) {
  const mpsi_links *l = &e->links;
  const int64_t j = l->to[i * l->count + k];
  sites[0] = i;
  sites[1] = j;
  c[0] = -1.0;
  c[1] = 1.0;
  int32_t m = 2;
  for (int end = 0; end < 2; end++) {
    int64_t own[MPSI_STENCIL_MAX];
    double g[MPSI_STENCIL_MAX][3];
    const int32_t count = mpsi_elastic_stencil(e, end ? j : i, own, g);
    for (int32_t a = 0; a < count; a++) {
      double part = 0.0;
      for (int b = 0; b < e->dim; b++) part += g[a][b] * e->spacing * l->step[k][b];
      if (part != 0.0) m = merge(sites, c, m, own[a], -0.5 * part);
    }
  }
  return m;
}

static void gather_pair(const mps_elastic *e, int64_t i, int32_t k, gather *g) {
  const int64_t j = e->links.to[i * e->links.count + k];
  int64_t sites[PAIR_MAX];
  double c[PAIR_MAX];
  const int32_t m = pair_sites(e, i, k, sites, c);
  int32_t mine = 0;
  while (mine < m && sites[mine] != g->particle) mine++;
  if (mine == m || c[mine] == 0.0) return;
  const double s = mpsi_elastic_bond(e, i, j, k) * c[mine];
  for (int32_t b = 0; b < m; b++) {
    if (c[b] == 0.0) continue;
    block *out = block_of(g, sites[b]);
    for (int x = 0; x < e->dim; x++) add(out, x, x, s * c[b]);
  }
}

/* ---- one row block
 * ------------------------------------------------------------------------------------ */

/* Particles whose gradients use p: p itself, then its stencil neighbours. */
static int32_t users(const mps_elastic *e, int64_t p, int64_t *list) {
  double unused[MPSI_STENCIL_MAX][3];
  return mpsi_elastic_stencil(e, p, list, unused);
}

static void gather_conservative(const mps_elastic *e, const int64_t *list, int32_t count,
                                gather *g) {
  const mpsi_links *l = &e->links;
  for (int32_t a = 0; a < count; a++) {
    const int64_t i = list[a];
    for (int32_t k = 0; k < l->count; k++) {
      const int64_t j = l->to[i * l->count + k];
      if (j < 0) continue;
      bool twice = false; /* both ends are in the list: taken once, from the smaller */
      for (int32_t b = 0; b < count && !twice; b++) twice = list[b] == j;
      if (!twice || i < j) gather_pair(e, i, k, g);
    }
  }
}

static void gather_row(const mps_elastic *e, int64_t p, gather *g) {
  const mpsi_links *l = &e->links;
  int64_t list[MPSI_STENCIL_MAX];
  const int32_t count = users(e, p, list);
  g->count = 0;
  g->particle = p;
  for (int32_t a = 0; a < count; a++) gather_gradient(e, list[a], g);
  if (e->def.method == MPS_ELASTIC_CONSERVATIVE) {
    gather_conservative(e, list, count, g);
    return;
  }
  for (int32_t k = 0; k < l->count; k++) {
    const int64_t j = l->to[p * l->count + k];
    if (j < 0) continue;
    const double s = mpsi_elastic_bond(e, p, j, k);
    block *own = block_of(g, p), *other = block_of(g, j);
    for (int c = 0; c < 2; c++) {
      add(own, c, c, s);
      add(other, c, c, -s);
    }
  }
}

/* Into the local directions of both particles, where supports have turned them. */
static void turn(const mps_elastic *e, int64_t p, block *b) {
  if (e->support_of[p] < 0 && e->support_of[b->site] < 0) return;
  double rows[3][3], cols[3][3], half[3][3];
  const int d = e->dim;
  for (int c = 0; c < d; c++) {
    mpsi_elastic_direction(e, p, c, rows[c]);
    mpsi_elastic_direction(e, b->site, c, cols[c]);
  }
  for (int r = 0; r < d; r++)
    for (int f = 0; f < d; f++) {
      half[r][f] = 0.0;
      for (int c = 0; c < d; c++) half[r][f] += rows[r][c] * b->value[c][f];
    }
  for (int r = 0; r < d; r++)
    for (int s = 0; s < d; s++) {
      b->value[r][s] = 0.0;
      b->used[r][s] = true;
      for (int f = 0; f < d; f++) b->value[r][s] += half[r][f] * cols[s][f];
    }
}

static int by_site(const void *a, const void *b) {
  const int64_t x = ((const int64_t *)a)[0], y = ((const int64_t *)b)[0];
  return (x > y) - (x < y);
}

/* Column block p: the blocks of sites >= p in ascending order. K is symmetric: row = column. */
static void emit(assembly *t, gather *g) {
  const mps_elastic *e = t->e;
  const int d = e->dim;
  const int64_t p = g->particle;
  int64_t order[ROW_MAX][2];
  int32_t count = 0;
  for (int32_t a = 0; a < g->count; a++)
    if (g->blocks[a].site >= p) {
      order[count][0] = g->blocks[a].site;
      order[count++][1] = a;
      turn(e, p, &g->blocks[a]);
    }
  qsort(order, (size_t)count, sizeof *order, by_site);
  for (int c = 0; c < d; c++) {
    const int64_t column = e->dof[p * d + c];
    if (column < 0) continue;
    int64_t at = t->fill ? e->column[column] : 0;
    for (int32_t a = 0; a < count; a++) {
      const block *b = &g->blocks[order[a][1]];
      for (int f = 0; f < d; f++) {
        const int64_t row = e->dof[b->site * d + f];
        if (row < column || !b->used[c][f]) continue;
        if (t->fill) {
          e->row[at] = row;
          e->value[at] = b->value[c][f];
        }
        at++;
      }
    }
    if (!t->fill) t->length[column] = at;
  }
}

static void assemble_chunk(void *data, int64_t chunk, int32_t worker) {
  assembly *t = data;
  gather *g = &t->gathers[worker];
  int64_t first, last;
  mpsi_elastic_chunk(t->e, chunk, &first, &last);
  for (int64_t p = first; p < last; p++) {
    gather_row(t->e, p, g);
    emit(t, g);
    for (int32_t a = 0; a < g->count; a++) g->slot[g->blocks[a].site] = -1;
  }
}

/* ---- the matrix
 * -------------------------------------------------------------------------------------- */

static void drop_matrix(mps_elastic *e) {
  mpsi_free(e->context, e->column);
  mpsi_free(e->context, e->row);
  mpsi_free(e->context, e->value);
  mpsi_free(e->context, e->rhs);
  mpsi_free(e->context, e->solution);
  e->column = e->row = NULL;
  e->value = e->rhs = e->solution = NULL;
  e->pattern_valid = e->values_valid = e->analysed = e->factored = false;
}

/* Counts the entries of each column and allocates the matrix. */
static mps_status make_pattern(mps_elastic *e, const char *function, assembly *t) {
  drop_matrix(e);
  mpsi_elastic_number(e);
  const int64_t n = e->unknowns;
  if (!(e->column = mpsi_alloc(e->context, n + 1, sizeof *e->column)) ||
      !(e->rhs = mpsi_alloc(e->context, n, sizeof *e->rhs)) ||
      !(e->solution = mpsi_alloc(e->context, n, sizeof *e->solution)))
    return mpsi_fail_memory(e->context, function, (size_t)n * sizeof *e->rhs);
  t->length = e->column + 1;
  t->fill = false;
  mpsi_parallel_for(e->context, mpsi_elastic_chunks(e), assemble_chunk, t);
  for (int64_t c = 0; c < n; c++) e->column[c + 1] += e->column[c];
  const int64_t nonzeros = e->column[n];
  if (!(e->row = mpsi_alloc(e->context, nonzeros, sizeof *e->row)) ||
      !(e->value = mpsi_alloc(e->context, nonzeros, sizeof *e->value)))
    return mpsi_fail_memory(e->context, function, (size_t)nonzeros * sizeof *e->value);
  return MPS_OK;
}

mps_status mpsi_elastic_assemble(mps_elastic *e, const char *function) {
  if (e->pattern_valid && e->values_valid) return MPS_OK;
  const int32_t workers = mps_context_threads(e->context);
  assembly t = {.e = e, .fill = true};
  int32_t *slots = NULL;
  mps_status status = MPS_OK;
  if (!(t.gathers = mpsi_alloc(e->context, workers, sizeof *t.gathers)) ||
      !(slots = mpsi_alloc(e->context, workers * e->n, sizeof *slots)))
    status = mpsi_fail_memory(e->context, function, (size_t)(workers * e->n) * sizeof *slots);
  else {
    for (int64_t k = 0; k < workers * e->n; k++) slots[k] = -1;
    for (int32_t w = 0; w < workers; w++) t.gathers[w].slot = slots + w * e->n;
    if (!e->pattern_valid) status = make_pattern(e, function, &t);
  }
  if (status == MPS_OK) {
    t.fill = true;
    mpsi_parallel_for(e->context, mpsi_elastic_chunks(e), assemble_chunk, &t);
    e->pattern_valid = e->values_valid = true;
    e->factored = false;
  }
  mpsi_free(e->context, t.gathers);
  mpsi_free(e->context, slots);
  return status;
}
