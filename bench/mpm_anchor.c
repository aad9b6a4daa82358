/* mpm_anchor.c - the yardstick of bench-mpm.
 *
 * A node is one vector {m, p_x, p_y, p_z}. With full support grad phi_i = D w_i (x_i - x_p), D =
 * 3/h2 (cubic) or 4/h2 (quadratic), so what a particle gives to a node is w_i (A + B d), d = (x_i -
 * x_p)/h: A holds m and m v, the columns of B hold m h L - dt V D h sigma. The weights factor over
 * the axes, so a row along x is w_y w_z (P + d_y Y + d_z Z) with P, Y, Z already multiplied by the
 * weights along x. Consecutive particles of one cell add up a slab of nodes in registers.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_anchor.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))
#ifdef __clang__ /* the iterations of the next loop use different columns */
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif
#define BLOCK 64   /* particles whose columns are turned into vectors together */
#define SEGMENT 16 /* particles of one cell at most added up at once */
#define MARGIN 2   /* cells of the grid around the block */

typedef double v4 __attribute__((vector_size(32)));
typedef double v4u __attribute__((vector_size(32), aligned(8), may_alias));

/* A row is ROW vectors of NODES nodes. Vectors that are wider than those of the processor would go
 * through memory: a yardstick ten times too long. */
#ifdef __AVX512F__
#define NODES 2
typedef double vec __attribute__((vector_size(64)));
typedef double vecu __attribute__((vector_size(64), aligned(8), may_alias));
#else
#define NODES 1
typedef v4 vec;
typedef v4u vecu;
#endif
#define ROW (4 / NODES)

/* ---- vectors --------------------------------------------------------------------------------- */

/* Vectors of a row with some weight. */
INLINE int row_vectors(int degree) { return (degree + NODES) / NODES; }
INLINE v4 load4(const double *p) { return *(const v4u *)p; }
INLINE vec load(const double *p) { return *(const vecu *)p; }
INLINE void store4(double *p, v4 a) { *(v4u *)p = a; }
INLINE void store(double *p, vec a) { *(vecu *)p = a; }

/* The four at `p` for every node of a vector; eight may be read. */
INLINE vec each_node(const double *p) {
  const vec a = load(p);
#if NODES == 1
  return a;
#elif defined(__clang__)
  return __builtin_shufflevector(a, a, 0, 1, 2, 3, 0, 1, 2, 3);
#else
  typedef int64_t i8 __attribute__((vector_size(64)));
  return __builtin_shuffle(a, (i8){0, 1, 2, 3, 0, 1, 2, 3});
#endif
}

/* The sum over the nodes of a vector. */
INLINE v4 over_nodes(vec a) {
  double all[4 * NODES];
  store(all, a);
  return NODES == 2 ? load4(all) + load4(all + 4 * (NODES - 1)) : load4(all);
}

/* ---- weights: polynomials in t = (x_p - x_1)/h, node 1 the second of the support ------------- */

/* Coefficient of t^power in the weight of node i; the fourth quadratic weight is zero. */
#define CUBIC_0(i) ((i) == 0 ? 1.0 / 6 : (i) == 1 ? 2.0 / 3 : (i) == 2 ? 1.0 / 6 : 0.0)
#define CUBIC_1(i) ((i) == 0 ? -0.5 : (i) == 2 ? 0.5 : 0.0)
#define CUBIC_2(i) ((i) == 0 ? 0.5 : (i) == 1 ? -1.0 : (i) == 2 ? 0.5 : 0.0)
#define CUBIC_3(i) ((i) == 0 ? -1.0 / 6 : (i) == 1 ? 0.5 : (i) == 2 ? -0.5 : 1.0 / 6)
#define QUADRATIC_0(i) ((i) == 1 ? 0.75 : (i) == 3 ? 0.0 : 0.125)
#define QUADRATIC_1(i) ((i) == 0 ? -0.5 : (i) == 2 ? 0.5 : 0.0)
#define QUADRATIC_2(i) ((i) == 1 ? -1.0 : (i) == 3 ? 0.0 : 0.5)
#define FOUR(c)                                                                                    \
  (v4) { c(0), c(1), c(2), c(3) }
#if NODES == 2
#define BY_NODE(c, i)                                                                              \
  (vec) { c(i), c(i), c(i), c(i), c(i + 1), c(i + 1), c(i + 1), c(i + 1) }
#else
#define BY_NODE(c, i)                                                                              \
  (vec) { c(i), c(i), c(i), c(i) }
#endif
#define PLACE(i) ((double)(i)-1.0)

/* Along a slow axis: w[0..3] weights, w[4..7] weights times distance. */
INLINE void weights(int degree, double t, double w[8]) {
  const v4 cubic = FOUR(CUBIC_0) + t * (FOUR(CUBIC_1) + t * (FOUR(CUBIC_2) + t * FOUR(CUBIC_3)));
  const v4 quadratic = FOUR(QUADRATIC_0) + t * (FOUR(QUADRATIC_1) + t * FOUR(QUADRATIC_2));
  const v4 a = degree == 3 ? cubic : quadratic;
  store4(w, a);
  store4(w + 4, a * (FOUR(PLACE) - t));
}

/* Along x, each weight four times: nodes of vector k. */
INLINE void row_weights(int degree, double t, vec w[ROW], vec wd[ROW]) {
  for (int k = 0; k < ROW; k++) {
    const int i = k * NODES;
    if (degree == 3)
      w[k] = BY_NODE(CUBIC_0, i) +
             t * (BY_NODE(CUBIC_1, i) + t * (BY_NODE(CUBIC_2, i) + t * BY_NODE(CUBIC_3, i)));
    else
      w[k] = BY_NODE(QUADRATIC_0, i) + t * (BY_NODE(QUADRATIC_1, i) + t * BY_NODE(QUADRATIC_2, i));
    wd[k] = w[k] * (BY_NODE(PLACE, i) - t);
  }
}

/* First node of the support and t of each axis for particles first, ..., first + n - 1. */
INLINE void locate(const anchor *a, int dim, int degree, int64_t first, int n, int64_t base[BLOCK],
                   double t[3][BLOCK]) {
  const double inverse = 1.0 / a->cell, shift = degree == 3 ? 0.0 : 0.5;
  const int64_t stride[3] = {1, a->nodes[0], a->nodes[0] * a->nodes[1]};
  for (int q = 0; q < n; q++) base[q] = 0;
  for (int c = 0; c < dim; c++) {
    const double *x = a->column[ANCHOR_X + c] + first;
    for (int q = 0; q < n; q++) {
      const double X = x[q] * inverse;
      const int32_t middle = (int32_t)(X + shift); /* the grid lies where x > 0 */
      base[q] += (middle - 1) * stride[c];
      t[c][q] = X - (double)middle;
    }
  }
}

/* ---- particles to grid ----------------------------------------------------------------------- */

/* What a particle brings to the rows of its support. */
typedef struct share {
  vec P[ROW], Y[ROW], Z[ROW];
  double w[16]; /* over y and z */
} share;

INLINE int stress_index(int i, int j) { return i == j ? i : i + j == 1 ? 3 : i + j == 3 ? 4 : 5; }

/* The vectors A and the columns of B: give[q][0] and give[q][1 + axis]. */
INLINE void gather(const anchor *a, int dim, int degree, int64_t first, int n,
                   double give[BLOCK + 1][4][4]) {
  const double h = a->cell, force = a->dt * (degree == 3 ? 3.0 : 4.0) / h;
  const double *m = a->column[ANCHOR_MASS] + first, *V = a->column[ANCHOR_VOLUME] + first;
  for (int q = 0; q < n; q++) {
    give[q][0][0] = m[q];
    for (int c = 0; c < dim; c++) give[q][1 + c][0] = 0.0;
  }
  for (int i = 0; i < dim; i++) {
    const double *v = a->column[ANCHOR_V + i] + first;
    for (int q = 0; q < n; q++) give[q][0][1 + i] = m[q] * v[q];
    for (int j = 0; j < dim; j++) {
      const double *L = a->column[ANCHOR_L + 3 * i + j] + first;
      const double *s = a->column[ANCHOR_S + stress_index(i, j)] + first;
      for (int q = 0; q < n; q++) give[q][1 + j][1 + i] = m[q] * h * L[q] - force * V[q] * s[q];
    }
  }
  if (dim == 2)
    for (int q = 0; q < n; q++)
      for (int c = 0; c < 3; c++) give[q][c][3] = 0.0;
}

/* Shares of the first row of the first slab; a row one farther along y or z adds Y or Z. */
INLINE void prepare(int dim, int degree, double give[4][4], double tx, double ty, double tz,
                    share *s) {
  vec w[ROW], wd[ROW];
  row_weights(degree, tx, w, wd);
  const v4 first = load4(give[0]) - (1.0 + ty) * load4(give[2]) -
                   (dim == 3 ? (1.0 + tz) * load4(give[3]) : (v4){0.0});
  double at[4 * NODES] = {0.0}; /* each_node reads a vector */
  store4(at, first);
  for (int k = 0; k < row_vectors(degree); k++) {
    s->P[k] = w[k] * each_node(at) + wd[k] * each_node(give[1]);
    s->Y[k] = w[k] * each_node(give[2]);
    if (dim == 3) s->Z[k] = w[k] * each_node(give[3]);
  }
  double wy[8], wz[8];
  weights(degree, ty, wy);
  if (dim == 3) weights(degree, tz, wz);
  for (int slab = 0; slab < (dim == 3 ? degree + 1 : 1); slab++)
    store4(s->w + 4 * slab, dim == 3 ? wz[slab] * load4(wy) : load4(wy));
}

/* Adds the n particles of a cell to the rows of one slab of nodes. */
INLINE void add_slab(const anchor *a, int dim, int degree, share *s, int n, int slab,
                     double *node) {
  for (int k = 0; k < row_vectors(degree); k++) {
    vec sum[4] = {{0.0}};
    for (int q = 0; q < n; q++) {
      vec T = s[q].P[k];
      for (int j = 0; j <= degree; j++) {
        sum[j] += s[q].w[4 * slab + j] * T;
        T += s[q].Y[k];
      }
      if (dim == 3) s[q].P[k] += s[q].Z[k]; /* of the next slab */
    }
    for (int j = 0; j <= degree; j++) {
      double *at = node + 4 * (j * a->nodes[0] + NODES * k);
      if (degree == 3 || NODES * (k + 1) <= 3)
        store(at, load(at) + sum[j]);
      else { /* the fourth node has no weight */
        double last[4 * NODES];
        store(last, sum[j]);
        store4(at, load4(at) + load4(last));
      }
    }
  }
}

INLINE void to_grid(anchor *a, int dim, int degree) {
  const int64_t slab_size = 4 * a->nodes[0] * a->nodes[1];
  memset(a->node, 0, (size_t)(slab_size * a->nodes[2]) * sizeof *a->node);
  int64_t base[BLOCK];
  double t[3][BLOCK] = {{0}}, give[BLOCK + 1][4][4];
  share s[SEGMENT];
  for (int64_t first = 0; first < a->count; first += BLOCK) {
    const int n = a->count - first < BLOCK ? (int)(a->count - first) : BLOCK;
    locate(a, dim, degree, first, n, base, t);
    gather(a, dim, degree, first, n, give);
    for (int q = 0, size = 0; q < n; q += size) {
      for (size = 0; size < SEGMENT && q + size < n && base[q + size] == base[q]; size++)
        prepare(dim, degree, give[q + size], t[0][q + size], t[1][q + size], t[2][q + size],
                &s[size]);
      for (int slab = 0; slab < (dim == 3 ? degree + 1 : 1); slab++)
        add_slab(a, dim, degree, s, size, slab, a->node + 4 * base[q] + slab * slab_size);
    }
  }
}

static void move_grid(anchor *a) {
  const int64_t n = a->nodes[0] * a->nodes[1] * a->nodes[2];
  for (int64_t i = 0; i < n; i++) {
    double *node = a->node + 4 * i;
    store4(node, load4(node) * (node[0] > 1e-300 ? 1.0 / node[0] : 0.0));
  }
}

/* ---- grid to particles ----------------------------------------------------------------------- */

/* Sums of w v and w v d over the support: take[0] and take[1 + axis]. */
INLINE void interpolate(const anchor *a, int dim, int degree, const double *node, double tx,
                        double ty, double tz, double take[4][4]) {
  double wy[8], wz[8];
  vec w[ROW], wd[ROW], S[ROW], Sy[ROW], Sz[ROW], sum[4] = {{0.0}};
  row_weights(degree, tx, w, wd);
  weights(degree, ty, wy);
  if (dim == 3) weights(degree, tz, wz);
  for (int k = 0; k < ROW; k++) S[k] = Sy[k] = Sz[k] = (vec){0.0};
  for (int slab = 0; slab < (dim == 3 ? degree + 1 : 1); slab++) {
    const double *at = node + 4 * slab * a->nodes[0] * a->nodes[1];
    for (int k = 0; k < row_vectors(degree); k++) {
      vec T = {0.0}, U = {0.0}; /* sums of w and, in whole cells from the first node, of w d */
      for (int j = degree; j >= 0; j--) {
        /* two nodes a vector: reads a fourth quadratic one */
        T += wy[j] * load(at + 4 * j * a->nodes[0] + 4 * NODES * k);
        if (j > 0) U += T;
      }
      S[k] += dim == 3 ? wz[slab] * T : T;
      Sy[k] += dim == 3 ? wz[slab] * U : U;
      if (dim == 3) Sz[k] += wz[4 + slab] * T;
    }
  }
  for (int k = 0; k < row_vectors(degree); k++) {
    sum[0] += w[k] * S[k];
    sum[1] += wd[k] * S[k];
    sum[2] += w[k] * (Sy[k] - (1.0 + ty) * S[k]);
    if (dim == 3) sum[3] += w[k] * Sz[k];
  }
  for (int r = 0; r <= dim; r++) store4(take[r], over_nodes(sum[r]));
}

INLINE void spread(anchor *a, int dim, int degree, int64_t first, int n, double take[BLOCK][4][4]) {
  const double scale = (degree == 3 ? 3.0 : 4.0) / a->cell;
  for (int i = 0; i < dim; i++) {
    double *x = a->column[ANCHOR_X + i] + first, *v = a->column[ANCHOR_V + i] + first;
    for (int q = 0; q < n; q++) {
      v[q] = take[q][0][1 + i];
      x[q] += a->dt * v[q];
    }
    for (int j = 0; j < dim; j++) {
      double *L = a->column[ANCHOR_L + 3 * i + j] + first;
      for (int q = 0; q < n; q++) L[q] = scale * take[q][1 + j][1 + i];
    }
  }
}

/* Linear elasticity with the Jaumann rate, and the volume. */
INLINE void strain_2d(anchor *a, int64_t first, int n) {
  double *const *L = a->column + ANCHOR_L, *const *s = a->column + ANCHOR_S;
  double *xx = s[0] + first, *yy = s[1] + first, *zz = s[2] + first, *xy = s[3] + first;
  double *V = a->column[ANCHOR_VOLUME] + first;
  const double *Lxx = L[0] + first, *Lxy = L[1] + first, *Lyx = L[3] + first, *Lyy = L[4] + first;
  const double mu = a->dt * a->mu, lambda = a->dt * a->lambda;
  INDEPENDENT
  for (int q = 0; q < n; q++) {
    const double trace = Lxx[q] + Lyy[q], turn = a->dt * (Lxy[q] - Lyx[q]);
    const double shear = xy[q], difference = yy[q] - xx[q];
    xx[q] += turn * shear + 2.0 * mu * Lxx[q] + lambda * trace;
    yy[q] += -turn * shear + 2.0 * mu * Lyy[q] + lambda * trace;
    zz[q] += lambda * trace;
    xy[q] += 0.5 * turn * difference + mu * (Lxy[q] + Lyx[q]);
    V[q] *= 1.0 + a->dt * trace;
  }
}

INLINE void strain_3d(anchor *a, int64_t first, int n) {
  double *const *L = a->column + ANCHOR_L, *const *s = a->column + ANCHOR_S;
  double *xx = s[0] + first, *yy = s[1] + first, *zz = s[2] + first;
  double *xy = s[3] + first, *yz = s[4] + first, *zx = s[5] + first;
  double *V = a->column[ANCHOR_VOLUME] + first;
  const double *Lxx = L[0] + first, *Lxy = L[1] + first, *Lxz = L[2] + first;
  const double *Lyx = L[3] + first, *Lyy = L[4] + first, *Lyz = L[5] + first;
  const double *Lzx = L[6] + first, *Lzy = L[7] + first, *Lzz = L[8] + first;
  const double dt = a->dt, mu = dt * a->mu, lambda = dt * a->lambda;
  INDEPENDENT
  for (int q = 0; q < n; q++) {
    const double trace = Lxx[q] + Lyy[q] + Lzz[q];
    const double wxy = 0.5 * dt * (Lxy[q] - Lyx[q]), wxz = 0.5 * dt * (Lxz[q] - Lzx[q]);
    const double wyz = 0.5 * dt * (Lyz[q] - Lzy[q]);
    const double a1 = xx[q], a2 = yy[q], a3 = zz[q], b1 = xy[q], b2 = yz[q], b3 = zx[q];
    xx[q] = a1 + 2.0 * (wxy * b1 + wxz * b3) + 2.0 * mu * Lxx[q] + lambda * trace;
    yy[q] = a2 + 2.0 * (wyz * b2 - wxy * b1) + 2.0 * mu * Lyy[q] + lambda * trace;
    zz[q] = a3 - 2.0 * (wxz * b3 + wyz * b2) + 2.0 * mu * Lzz[q] + lambda * trace;
    xy[q] = b1 + wxy * (a2 - a1) + wxz * b2 + wyz * b3 + mu * (Lxy[q] + Lyx[q]);
    yz[q] = b2 + wyz * (a3 - a2) - wxy * b3 - wxz * b1 + mu * (Lyz[q] + Lzy[q]);
    zx[q] = b3 + wxz * (a3 - a1) + wxy * b2 - wyz * b1 + mu * (Lxz[q] + Lzx[q]);
    V[q] *= 1.0 + dt * trace;
  }
}

INLINE void to_particles(anchor *a, int dim, int degree) {
  int64_t base[BLOCK];
  double t[3][BLOCK] = {{0}}, take[BLOCK][4][4];
  for (int64_t first = 0; first < a->count; first += BLOCK) {
    const int n = a->count - first < BLOCK ? (int)(a->count - first) : BLOCK;
    locate(a, dim, degree, first, n, base, t);
    for (int q = 0; q < n; q++)
      interpolate(a, dim, degree, a->node + 4 * base[q], t[0][q], t[1][q], t[2][q], take[q]);
    spread(a, dim, degree, first, n, take);
    if (dim == 3)
      strain_3d(a, first, n);
    else
      strain_2d(a, first, n);
  }
}

/* ---- the step, once for each dimension and degree -------------------------------------------- */

#define VARIANT(dim, degree)                                                                       \
  static void step_##dim##_##degree(anchor *a) {                                                   \
    to_grid(a, dim, degree);                                                                       \
    move_grid(a);                                                                                  \
    to_particles(a, dim, degree);                                                                  \
  }
VARIANT(2, 2)
VARIANT(2, 3)
VARIANT(3, 2)
VARIANT(3, 3)

void anchor_step(anchor *a, int64_t steps) {
  void (*step)(anchor *) =
      a->dim == 2 ? (a->degree == 2 ? step_2_2 : step_2_3) : (a->degree == 2 ? step_3_2 : step_3_3);
  for (int64_t k = 0; k < steps; k++) step(a);
}

/* ---- life ------------------------------------------------------------------------------------ */

/* Particles cell by cell. For the quadratic spline a support's middle node is the nearest one, so
 * the block starts half a cell later and its cells are those about the nodes. */
static void fill(anchor *a, int64_t side, double density) {
  const int64_t sides[3] = {side, side, a->dim == 3 ? side : 1};
  const double start = MARGIN + (a->degree == 2 ? 0.5 : 0.0);
  const int corners = 1 << a->dim;
  const double spacing = 0.5 * a->cell;
  const double volume = spacing * spacing * (a->dim == 3 ? spacing : 1.0);
  int64_t p = 0;
  for (int64_t k = 0; k < sides[2]; k++)
    for (int64_t j = 0; j < sides[1]; j++)
      for (int64_t i = 0; i < sides[0]; i++)
        for (int corner = 0; corner < corners; corner++, p++) {
          const int64_t ijk[3] = {i, j, k};
          for (int c = 0; c < a->dim; c++)
            a->column[ANCHOR_X + c][p] =
                a->cell * (start + (double)ijk[c] + 0.25 + 0.5 * (corner >> c & 1));
          a->column[ANCHOR_VOLUME][p] = volume;
          a->column[ANCHOR_MASS][p] = density * volume;
        }
}

anchor anchor_create(int dim, int degree, int64_t side, double cell, double density, double young,
                     double poisson, double dt) {
  anchor a = {.dim = dim, .degree = degree, .cell = cell, .dt = dt};
  a.mu = 0.5 * young / (1.0 + poisson);
  a.lambda = 2.0 * a.mu * poisson / (1.0 - 2.0 * poisson);
  a.count = (dim == 3 ? 8 * side : 4) * side * side;
  for (int c = 0; c < 3; c++) a.nodes[c] = c < dim ? side + 2 * MARGIN + 2 : 1;
  const int64_t nodes = a.nodes[0] * a.nodes[1] * a.nodes[2];
  /* Starts 192 bytes apart modulo a page: columns a page apart would evict one another. */
  const int64_t column = (a.count + 511) / 512 * 512 + 24;
  const size_t size = (size_t)(ANCHOR_COLUMNS * column + 4 * nodes + 16) * sizeof(double);
  a.memory = aligned_alloc(64, (size + 63) / 64 * 64);
  if (!a.memory) {
    fprintf(stderr, "bench: no memory for %lld particles\n", (long long)a.count);
    exit(1);
  }
  memset(a.memory, 0, size);
  for (int c = 0; c < ANCHOR_COLUMNS; c++) a.column[c] = (double *)a.memory + c * column;
  a.node = (double *)a.memory + ANCHOR_COLUMNS * column;
  fill(&a, side, density);
  return a;
}

void anchor_free(anchor *a) {
  free(a->memory);
  a->memory = NULL;
}
