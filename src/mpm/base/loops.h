/* loops.h - common code of the inner loops: vectors of nodes, tiles, and chunks of particles. For
 * the files that are compiled once for each instruction set, with MPSI_LEVEL set.
 *
 * A node is four doubles {m, x, y, z}. A row of a stencil, its four nodes along x, is one array of
 * vectors of MPSI_WIDE nodes each. A particle contributes to its nodes a linear function of s,
 * which along a row is w_j w_k w_i (B + s_i D) with B and D constant on the row: two multiply-adds
 * a node for all four quantities at once (fused where the processor can: these files, unlike the
 * others, allow it). SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "kernels.h"

#include <string.h>

#define MPSI_JOIN_(a, b) a##b
#define MPSI_JOIN(a, b) MPSI_JOIN_(a, b)
#define MPSI_LEVELLED(name) MPSI_JOIN(name##_v, MPSI_LEVEL)
#define MPSI_SIMD _Pragma("omp simd")
#define MPSI_PRAGMA(text) _Pragma(#text)
#define MPSI_SIMD_SUM(sum) MPSI_PRAGMA(omp simd reduction(+ : sum))
#define MPSI_UNROLL _Pragma("GCC unroll 4")
#if defined(__GNUC__) || defined(__clang__)
/* not inlined: large, and called from several places */
#define MPSI_APART static __attribute__((noinline))
#else
#define MPSI_APART static
#endif

#define MPSI_VARIANTS(X)                                                                           \
  X(plane_strain, cubic, MPS_MPM_GEOMETRY_PLANE_STRAIN, 3)                                         \
  X(plane_strain, quadratic, MPS_MPM_GEOMETRY_PLANE_STRAIN, 2)                                     \
  X(axisymmetric, cubic, MPS_MPM_GEOMETRY_AXISYMMETRIC, 3)                                         \
  X(axisymmetric, quadratic, MPS_MPM_GEOMETRY_AXISYMMETRIC, 2)                                     \
  X(space, cubic, MPS_MPM_GEOMETRY_SPACE, 3)                                                       \
  X(space, quadratic, MPS_MPM_GEOMETRY_SPACE, 2)

MPSI_INLINE int mpsi_dim_of(int geometry) { return geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2; }

/* ---- vectors --------------------------------------------------------------------------------- */

typedef double mpsi_quad __attribute__((vector_size(32)));
typedef double mpsi_quad_any __attribute__((vector_size(32), aligned(8), may_alias));
typedef int32_t mpsi_index __attribute__((vector_size(16)));
#if MPSI_LEVEL == 4
#define MPSI_WIDE 2
typedef double mpsi_vec __attribute__((vector_size(64)));
typedef double mpsi_vec_any __attribute__((vector_size(64), aligned(8), may_alias));
#else
#define MPSI_WIDE 1
typedef mpsi_quad mpsi_vec;
typedef mpsi_quad_any mpsi_vec_any;
#endif
#define MPSI_ROW (4 / MPSI_WIDE) /* number of vectors in a row of nodes */

MPSI_INLINE mpsi_quad mpsi_get(const double *from) { return *(const mpsi_quad_any *)from; }
MPSI_INLINE void mpsi_put(double *to, mpsi_quad v) { *(mpsi_quad_any *)to = v; }
MPSI_INLINE mpsi_vec mpsi_get_row(const double *from) { return *(const mpsi_vec_any *)from; }
MPSI_INLINE void mpsi_put_row(double *to, mpsi_vec v) { *(mpsi_vec_any *)to = v; }

typedef int64_t mpsi_mask __attribute__((vector_size(32))); /* result of comparisons: 0 or -1 */
#ifdef __clang__
#define MPSI_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#define MPSI_SHUFFLE_WIDE MPSI_SHUFFLE
#else
typedef int64_t mpsi_mask_wide __attribute__((vector_size(64)));
#define MPSI_SHUFFLE_WIDE(a, b, ...) __builtin_shuffle(a, b, (mpsi_mask_wide){__VA_ARGS__})
#define MPSI_SHUFFLE(a, b, ...) __builtin_shuffle(a, b, (mpsi_mask){__VA_ARGS__})
#endif

/* Transposes a 4 x 4 matrix. */
MPSI_INLINE void mpsi_transpose(mpsi_quad *a) {
  const mpsi_quad p = MPSI_SHUFFLE(a[0], a[1], 0, 4, 2, 6),
                  q = MPSI_SHUFFLE(a[0], a[1], 1, 5, 3, 7);
  const mpsi_quad r = MPSI_SHUFFLE(a[2], a[3], 0, 4, 2, 6),
                  s = MPSI_SHUFFLE(a[2], a[3], 1, 5, 3, 7);
  a[0] = MPSI_SHUFFLE(p, r, 0, 1, 4, 5);
  a[1] = MPSI_SHUFFLE(q, s, 0, 1, 4, 5);
  a[2] = MPSI_SHUFFLE(p, r, 2, 3, 6, 7);
  a[3] = MPSI_SHUFFLE(q, s, 2, 3, 6, 7);
}

/* Copies the values of a node to every node of a vector. */
MPSI_INLINE mpsi_vec mpsi_spread(mpsi_quad a) {
#if MPSI_WIDE == 2
  return (mpsi_vec){a[0], a[1], a[2], a[3], a[0], a[1], a[2], a[3]};
#else
  return a;
#endif
}

/* Coefficients c[i], c[i + 1] of the nodes in a vector, from node i on, each for all values of its
 * node. */
MPSI_INLINE mpsi_vec mpsi_by_node(const double *c, int i) {
#if MPSI_WIDE == 2
  return (mpsi_vec){c[i], c[i], c[i], c[i], c[i + 1], c[i + 1], c[i + 1], c[i + 1]};
#else
  return (mpsi_vec){c[i], c[i], c[i], c[i]};
#endif
}

/* Particles of a stencil that G2P processes at once. */
#if MPSI_LEVEL == 4
#define MPSI_LANES 8
#else
#define MPSI_LANES 4
#endif
typedef double mpsi_lanes __attribute__((vector_size(8 * MPSI_LANES)));
typedef double mpsi_lanes_any __attribute__((vector_size(8 * MPSI_LANES), aligned(8), may_alias));
MPSI_INLINE mpsi_lanes mpsi_get_lanes(const double *from) { return *(const mpsi_lanes_any *)from; }
MPSI_INLINE void mpsi_put_lanes(double *to, mpsi_lanes v) { *(mpsi_lanes_any *)to = v; }

/* The derivative of a B-spline is the slope of the fit, w s/m2, plus `excess` times the difference
 * of second (quadratic) or third order (cubic) of the nodes of its stencil: so the sums of
 * differences are common to all particles of a stencil. t as in mpsi_weights. */
MPSI_INLINE mpsi_lanes mpsi_excess(int spline, mpsi_lanes t) {
  const mpsi_lanes f = t - 1.0, g = 2.0 - t;
  return spline == 3 ? 0.5 * (f * f) * (g * g) : 2.0 * f * (f * f - 0.25);
}

/* Weights of these differences. */
MPSI_INLINE double mpsi_difference(int spline, int i) {
  static const double second[4] = {1.0, -2.0, 1.0, 0.0}, third[4] = {-1.0, 3.0, -3.0, 1.0};
  return spline == 3 ? third[i] : second[i];
}

/* ---- chunks of particles --------------------------------------------------------------------- */

#define MPSI_SEGMENT 16 /* most particles of one stencil that are summed at once */

/* a vector may be read or written from any particle of a chunk on */
#define MPSI_COLUMN (MPSI_CHUNK + 8)
/* For arrays on the stack: without it their alignment depends on the callers, and a vector that
 * crosses the end of a cache line takes twice as long. */
#define MPSI_LINE __attribute__((aligned(64)))

/* Positions in the tile, in cells, and weights of the particles of a chunk. */
typedef struct mpsi_places {
  int64_t chunk;                      /* index of its first particle */
  int count;                          /* of its particles */
  double t[3][MPSI_COLUMN] MPSI_LINE; /* distance from the lowest node of the stencil */
  double w[3][4][MPSI_COLUMN], ws[3][4][MPSI_COLUMN]; /* w and w s, by axis and node */
  int32_t first[MPSI_CHUNK]; /* lowest node of the stencil, index in the tile */
} mpsi_places;

/* A segment: consecutive particles, numbers `begin` to `end` - 1 of a chunk, with one stencil. */
typedef struct mpsi_segment {
  const mpsi_places *places;
  int begin, end;
} mpsi_segment;

/* Weights along x of each particle, the four nodes of a row side by side. */
typedef struct mpsi_rows {
  double w[MPSI_CHUNK][4] MPSI_LINE, ws[MPSI_CHUNK][4];
} mpsi_rows;

/* The first `n` values (at least 1); the first one again in further lanes: memory behind them may
 * be written by another thread, and zeros could be a position far from the block. */
MPSI_INLINE mpsi_quad mpsi_get_some(const double *from, int n) {
  if (n >= 4) return mpsi_get(from);
  mpsi_quad out = {from[0], from[0], from[0], from[0]};
  for (int i = 1; i < n; i++) out[i] = from[i];
  return out;
}

/* Origin of a block's tile: that of the grid (m), and the block's first node from there (cells). A
 * local copy, as stores of vectors may alias what is behind a pointer. */
typedef struct mpsi_frame {
  double origin[3], corner[3], inverse; /* 1/m, cells in a metre */
} mpsi_frame;

MPSI_INLINE mpsi_frame mpsi_frame_of(const mpsi_grid *grid, const mpsi_cell_block *cells, int dim) {
  mpsi_frame out = {{0.0}, {0.0}, grid->inverse};
  MPSI_UNROLL for (int c = 0; c < dim; c++) {
    out.origin[c] = grid->origin[c];
    out.corner[c] = (double)cells->at[c] * MPSI_SIDE;
  }
  return out;
}

/* Distance (cells) from the block's first node, along axis c, of four particles at x. */
MPSI_INLINE mpsi_quad mpsi_in_frame(const mpsi_frame *frame, int c, mpsi_quad x) {
  return (x - frame->origin[c]) * frame->inverse - frame->corner[c];
}

/* The same, where few particles are asked for. */
MPSI_INLINE mpsi_quad mpsi_from_block(const mpsi_grid *grid, const mpsi_cell_block *cells, int c,
                                      mpsi_quad x) {
  return (x - grid->origin[c]) * grid->inverse - (double)cells->at[c] * MPSI_SIDE;
}

/* B-spline weights of four particles along one axis. */
MPSI_INLINE void mpsi_lane_weights(int spline, mpsi_quad t, mpsi_quad *w) {
  const mpsi_quad f = t - 1.0, g = 2.0 - t;
  if (spline == 3) {
    w[0] = g * g * g * (1.0 / 6.0);
    w[1] = 2.0 / 3.0 + f * f * (0.5 * f - 1.0);
    w[2] = 2.0 / 3.0 + g * g * (0.5 * g - 1.0);
    w[3] = f * f * f * (1.0 / 6.0);
  } else {
    w[0] = 0.5 * (0.5 - f) * (0.5 - f);
    w[1] = 0.75 - f * f;
    w[2] = 0.5 * (0.5 + f) * (0.5 + f);
  }
}

/* Positions of particles [begin, begin + n) in the tile, their weights along the axes of `weights`
 * (a bit each), and weights times s along those of `slopes`, a subset of these; both literal. */
MPSI_INLINE void mpsi_find_places(const mpsi_transfer *work, int dim, int spline, int weights,
                                  int slopes, int64_t begin, int n, mpsi_places *out) {
  const mpsi_frame frame = mpsi_frame_of(work->grid, work->cells, dim);
  const double *x[3] = {NULL};
  for (int c = 0; c < dim; c++) x[c] = work->p->x[c] + begin;
  out->chunk = begin, out->count = n;
  for (int k = 0; k < n; k += 4) {
    mpsi_index first = {0};
    for (int c = 0, stride = 1; c < dim; c++, stride *= MPSI_TILE_SIDE) {
      /* from the block's first node: not negative, so that truncation is floor */
      const mpsi_quad X = mpsi_in_frame(&frame, c, mpsi_get_some(x[c] + k, n - k));
      const mpsi_index base = spline == 3 ? __builtin_convertvector(X, mpsi_index) - 1
                                          : __builtin_convertvector(X - 0.5, mpsi_index);
      const mpsi_quad t = X - __builtin_convertvector(base, mpsi_quad);
      mpsi_quad w[4];
      first += base * stride;
      mpsi_put(out->t[c] + k, t);
      if (!(weights >> c & 1)) continue;
      mpsi_lane_weights(spline, t, w);
      for (int i = 0; i <= spline; i++) {
        mpsi_put(out->w[c][i] + k, w[i]);
        if (slopes >> c & 1) mpsi_put(out->ws[c][i] + k, w[i] * ((double)i - t));
      }
    }
    memcpy(out->first + k, &first, sizeof first);
  }
}

/* Zeros behind the `n` particles, for loops over MPSI_LANES of them: other contents can be denormal
 * numbers, whose products take a hundred times as long. */
MPSI_INLINE void mpsi_pad_places(int dim, int spline, int weights, int n, mpsi_places *out) {
  const mpsi_lanes zero = {0.0};
  for (int c = 0; c < dim; c++) {
    mpsi_put_lanes(out->t[c] + n, zero);
    for (int i = 0; i <= spline && (weights >> c & 1); i++) {
      mpsi_put_lanes(out->w[c][i] + n, zero);
      mpsi_put_lanes(out->ws[c][i] + n, zero);
    }
  }
}

/* States of the nodes of the stencil from tile node `first`, all bits together: 0 where none is
 * outside the domain or in a body. */
MPSI_INLINE uint32_t mpsi_support_state(const mpsi_worker *worker, int dim, int spline,
                                        int32_t first) {
  uint32_t any = 0;
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      uint32_t row;
      memcpy(&row, worker->state + first + mpsi_tile_index(0, j, k), sizeof row);
      any |= row;
    }
  return (any | any >> 8 | any >> 16 | (spline == 3 ? any >> 24 : 0)) & 0xff;
}

/* Velocities of a chunk of particles from the nodes, as columns. The derivative of component c
 * along axis d is number dim c + d, as in the columns L of the set. */
typedef struct mpsi_gathered {
  double v[3][MPSI_COLUMN] MPSI_LINE,
      own[3][MPSI_COLUMN];           /* m/s; FLIP part of the particle's velocity */
  double slope[9][MPSI_COLUMN];      /* 1/s, slope of the fit, for the next P2G */
  double derivative[9][MPSI_COLUMN]; /* 1/s, derivative for the laws */
} mpsi_gathered;

/* ---- cut_scatter.c, cut_gather.c: particles whose support is cut ----------------------------- */

/* P2G and G2P of a segment with a cut support. P2G also sums penalty contact and stores fits. They
 * do nothing and return false if all supports are full: such particles are treated as others with
 * full supports, except that the laws take the slopes of the fit. */
bool MPSI_LEVELLED(mpsi_mpm_scatter_cut)(const mpsi_transfer *work, const mpsi_segment *segment);
bool MPSI_LEVELLED(mpsi_mpm_gather_cut)(const mpsi_transfer *work, const mpsi_segment *segment,
                                        mpsi_gathered *out);

/* The functions of mpsi_kernels. */
void MPSI_LEVELLED(mpsi_mpm_fit)(const mpsi_transfer *work, int64_t particle, mpsi_stencil *stencil,
                                 mpsi_shape_values *out);
void MPSI_LEVELLED(mpsi_mpm_foot)(const mpsi_transfer *work, int64_t particle, const double *d,
                                  mpsi_foot_weights *out);
double MPSI_LEVELLED(mpsi_mpm_fastest)(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin,
                                       int64_t end);
int64_t MPSI_LEVELLED(mpsi_mpm_next_near)(const mpsi_grid *grid, const mpsi_columns *p,
                                          const mpsi_far *far, int64_t begin, int64_t end);
int64_t MPSI_LEVELLED(mpsi_mpm_next_in)(const mpsi_grid *grid, const mpsi_columns *p,
                                        const mpsi_cell_block *cells, const int *low,
                                        const int *high, int64_t begin);
void MPSI_LEVELLED(mpsi_mpm_release)(mpsi_impulses *all, const mpsi_constraint_block *block);
void MPSI_LEVELLED(mpsi_mpm_warm)(mpsi_impulses *all, double dt,
                                  const mpsi_constraint_block *block);
void MPSI_LEVELLED(mpsi_mpm_sweep)(mpsi_impulses *all, int32_t dim, mpsi_constraint_block *block,
                                   bool back);
void MPSI_LEVELLED(mpsi_mpm_foot_velocity)(const mpsi_impulses *all, int64_t constraint, double *v);
void MPSI_LEVELLED(mpsi_mpm_speed)(const mpsi_transfer *work);
void MPSI_LEVELLED(mpsi_mpm_flush)(const mpsi_transfer *work);
void MPSI_LEVELLED(mpsi_pore_sum)(const mpsi_transfer *work);
void MPSI_LEVELLED(mpsi_pore_give)(const mpsi_transfer *work);
void MPSI_LEVELLED(mpsi_pore_begin_block)(const mpsi_transfer *work);
void MPSI_LEVELLED(mpsi_pore_respond)(const mpsi_transfer *work);
void MPSI_LEVELLED(mpsi_pore_strain)(const mpsi_transfer *work, const double *former, int64_t begin,
                                     int n);
void MPSI_LEVELLED(mpsi_pore_advance)(const mpsi_transfer *work, int64_t g, const uint64_t *whole);
void MPSI_LEVELLED(mpsi_pore_slopes)(const mpsi_transfer *work, int64_t g, const uint64_t *whole);
