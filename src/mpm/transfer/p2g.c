/* p2g.c - particles to nodes (P2G): mass, momentum and forces of a block of cells, Nakamura
 * (23)-(25), (39), for particles with a full support or at one wall; those with other cut supports
 * are in cut_scatter.c. Compiled once for each instruction set.
 *
 * Consecutive particles with the same stencil, a segment, are summed in registers before they are
 * added to the tile. Particles are sorted by stencil; an order that is only nearly sorted gives
 * shorter segments. SPDX-License-Identifier: BSD-3-Clause */
#include "wall_support.h"

#include "mpm/water/water.h"

/* Contributions of particles to their nodes, w (part 0 + part 1 s_x + part 2 s_y + part 3 s_z), for
 * each of the four values of a node. */
typedef double columns[4][4][MPSI_CHUNK] MPSI_LINE; /* [part][value][particle] */
typedef struct parts {
  columns sum;   /* mass, momentum */
  columns force; /* 0, force; only in split blocks */
} parts;

/* Contributions of four particles. */
typedef struct quad_parts {
  mpsi_quad sum[4][4], force[4][4];
} quad_parts;

/* Where the contributions come from: the particles' columns, and factors of these. Local, as stores
 * of vectors may alias what is behind a pointer. */
typedef struct sources {
  const mpsi_columns *p;
  double viscosity;             /* Pa s, of the water */
  double h, stiff, dt, fall[3]; /* m; 1/m, of stresses; s, or 1 if momentum and force are apart; dt
                                   times gravity */
} sources;

MPSI_INLINE sources find_sources(const mpsi_transfer *work, int dim, int spline, bool split) {
  sources out = {.p = work->p,
                 .viscosity = work->water ? work->water->viscosity : 0.0,
                 .h = work->grid->cell,
                 .stiff = -mpsi_inverse_moment(spline) * work->grid->inverse,
                 .dt = split ? 1.0 : work->run->dt};
  MPSI_UNROLL for (int c = 0; c < dim; c++) out.fall[c] = out.dt * work->def->gravity[c];
  return out;
}

/* Pa, of the four particles from index `at` on: with what the water's viscosity adds. */
MPSI_INLINE mpsi_quad water_pressure(const sources *s, int geometry, int64_t at) {
  const mpsi_columns *p = s->p;
  const int dim = mpsi_dim_of(geometry);
  mpsi_quad rate = mpsi_get(p->L[0] + at);
  MPSI_UNROLL for (int c = 1; c < dim; c++) rate += mpsi_get(p->L[(dim + 1) * c] + at);
  if (geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) rate += mpsi_get(p->L[4] + at);
  return mpsi_get(p->slow + at) - s->viscosity * rate;
}

/* Contributions of the four particles from index `at` on. `split`: momentum in `sum`, force in
 * `force`; else `sum` has momentum + dt force. */
MPSI_INLINE void find_quad_parts(const sources *s, int geometry, bool split, int64_t at,
                                 quad_parts *out) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const int dim = mpsi_dim_of(geometry);
  const mpsi_columns *p = s->p;
  const double dt = s->dt;
  const mpsi_quad zero = {0.0}, m = mpsi_get(p->m + at), V = dt * mpsi_get(p->V + at);
  const mpsi_quad mh = m * s->h, Vs = V * s->stiff;
  const mpsi_quad u = p->slow ? water_pressure(s, geometry, at) : zero;
  out->sum[0][MPSI_MASS] = m + zero; /* gcc compiles a plain copy to a slow `rep movs` */
  out->force[0][MPSI_EXCESS] = zero;
  MPSI_UNROLL for (int c = 0; c < dim; c++) {
    const int to = MPSI_VECTOR + c;
    mpsi_quad momentum = m * mpsi_get(p->v[c] + at), force = m * s->fall[c];
    if (p->f[0]) force += dt * mpsi_get(p->f[c] + at);
    if (geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && c == 0)
      force -= V * (mpsi_get(p->s[2] + at) - u) / mpsi_get(p->x[0] + at);
    out->sum[0][to] = split ? momentum : momentum + force;
    out->force[0][to] = force;
    MPSI_UNROLL for (int d = 0; d < dim; d++) {
      momentum = mh * mpsi_get(p->L[dim * c + d] + at);
      force = mpsi_get(p->s[symmetric[c][d]] + at);
      force = Vs * (c == d ? force - u : force);
      out->sum[1 + d][to] = split ? momentum : momentum + force;
      out->force[1 + d][to] = force;
    }
  }
}

MPSI_INLINE void put_columns(int dim, mpsi_quad from[4][4], int k, columns to) {
  mpsi_put(to[0][MPSI_MASS] + k, from[0][MPSI_MASS]);
  MPSI_UNROLL for (int d = 0; d <= dim; d++) MPSI_UNROLL for (int c = MPSI_VECTOR; c <= dim; c++)
      mpsi_put(to[d][c] + k, from[d][c]);
}

MPSI_INLINE void find_parts(const mpsi_transfer *work, int geometry, int spline, bool split,
                            int64_t begin, int n, parts *out) {
  const sources s = find_sources(work, mpsi_dim_of(geometry), spline, split);
  for (int k = 0; k < n; k += 4) {
    quad_parts part;
    find_quad_parts(&s, geometry, split, begin + k, &part);
    put_columns(mpsi_dim_of(geometry), part.sum, k, out->sum);
    if (split) put_columns(mpsi_dim_of(geometry), part.force, k, out->force);
  }
}

/* Transposes the weights along x of four particles: for each the four nodes of a row side by
 * side. */
MPSI_INLINE void find_row(int spline, double (*from)[MPSI_COLUMN], int k, double (*to)[4]) {
  mpsi_quad w[4] = {{0.0}};
  MPSI_UNROLL for (int i = 0; i <= spline; i++) w[i] = mpsi_get(from[i] + k);
  mpsi_transpose(w);
  MPSI_UNROLL for (int i = 0; i < 4; i++) mpsi_put(to[k + i], w[i]);
}

MPSI_INLINE void find_rows(int spline, bool slopes, mpsi_places *places, int n, mpsi_rows *out) {
  for (int k = 0; k < n; k += 4) {
    find_row(spline, places->w[0], k, out->w);
    if (slopes) find_row(spline, places->ws[0], k, out->ws);
  }
}

/* Contributions in 2D: of each particle to each of its rows along x, w (value + slope s_x). */
typedef struct row_parts {
  double mass[4][MPSI_CHUNK] MPSI_LINE; /* [row]; constant along a row */
  double value[4][2][MPSI_CHUNK], slope[4][2][MPSI_CHUNK];
} row_parts;

MPSI_INLINE void find_row_parts(int spline, const mpsi_places *places, int n, columns part,
                                row_parts *out) {
  for (int k = 0; k < n; k += 4) MPSI_UNROLL for (int j = 0; j <= spline; j++) {
      const mpsi_quad w = mpsi_get(places->w[1][j] + k), ws = mpsi_get(places->ws[1][j] + k);
      mpsi_put(out->mass[j] + k, w * mpsi_get(part[0][MPSI_MASS] + k));
      MPSI_UNROLL for (int c = 0; c < 2; c++) {
        const int from = MPSI_VECTOR + c;
        mpsi_put(out->value[j][c] + k,
                 w * mpsi_get(part[0][from] + k) + ws * mpsi_get(part[2][from] + k));
        mpsi_put(out->slope[j][c] + k, w * mpsi_get(part[1][from] + k));
      }
    }
}

/* Adds particles [begin, end) of a chunk, which share a stencil, to the tile in 2D. */
MPSI_INLINE void add_in_plane(int spline, const mpsi_places *places, const mpsi_rows *rows,
                              int begin, int end, const row_parts *part, mpsi_node *tile) {
  mpsi_quad sum[4][4] = {{{0.0}}}; /* [row][value]; lanes: the four nodes of the row */
  for (int k = begin; k < end; k++) {
    const mpsi_quad w = mpsi_get(rows->w[k]), ws = mpsi_get(rows->ws[k]);
    MPSI_UNROLL for (int j = 0; j <= spline; j++) {
      sum[j][MPSI_MASS] += part->mass[j][k] * w;
      MPSI_UNROLL for (int c = 0; c < 2; c++) {
        sum[j][MPSI_VECTOR + c] += part->value[j][c][k] * w;
        sum[j][MPSI_VECTOR + c] += part->slope[j][c][k] * ws;
      }
    }
  }
  MPSI_UNROLL for (int j = 0; j <= spline; j++) {
    mpsi_node *to = tile + places->first[begin] + mpsi_tile_index(0, j, 0);
    mpsi_transpose(sum[j]);
    MPSI_UNROLL for (int i = 0; i <= spline; i++) mpsi_put(to[i], mpsi_get(to[i]) + sum[j][i]);
  }
}

/* Contributions in 3D: [particle][part], the four values of a node side by side. */
typedef struct node_parts {
  double of[MPSI_CHUNK][4][4] MPSI_LINE;
} node_parts;

/* Stores the contributions of the four particles from `k` on. */
MPSI_INLINE void put_nodes(mpsi_quad from[4][4], int k, node_parts *to) {
  MPSI_UNROLL for (int d = 0; d < 4; d++) {
    mpsi_quad a[4];
    MPSI_UNROLL for (int c = 0; c < 4; c++) a[c] =
        d > 0 && c == MPSI_MASS ? (mpsi_quad){0.0} : from[d][c];
    mpsi_transpose(a);
    MPSI_UNROLL for (int i = 0; i < 4; i++) mpsi_put(to->of[k + i][d], a[i]);
  }
}

MPSI_INLINE void find_node_parts(int n, columns part, node_parts *out) {
  for (int k = 0; k < n; k += 4) {
    mpsi_quad a[4][4];
    MPSI_UNROLL for (int d = 0; d < 4; d++) MPSI_UNROLL for (int c = 0; c < 4; c++) a[d][c] =
        mpsi_get(part[d][c] + k);
    put_nodes(a, k, out);
  }
}

/* Adds particles [begin, end) of a chunk, which share a stencil, to the tile in 3D, by any weights:
 * multiplied by the weights along x once, and then by those of each row. */
MPSI_INLINE void add_in_space(int spline, const mpsi_places *places, const mpsi_rows *rows,
                              int begin, int end, const node_parts *part, mpsi_node *tile) {
  mpsi_vec along[MPSI_SEGMENT][3][MPSI_ROW]; /* factors of w_y w_z, (w s)_y w_z, w_y (w s)_z */
  for (int k = begin; k < end; k++) {
    mpsi_vec w[MPSI_ROW], ws[MPSI_ROW], a[4];
    for (int v = 0; v < MPSI_ROW; v++) {
      w[v] = mpsi_by_node(rows->w[k], v * MPSI_WIDE);
      ws[v] = mpsi_by_node(rows->ws[k], v * MPSI_WIDE);
    }
    for (int d = 0; d < 4; d++) a[d] = mpsi_spread(mpsi_get(part->of[k][d]));
    MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
      along[k - begin][0][v] = w[v] * a[0] + ws[v] * a[1];
      for (int d = 2; d < 4; d++) along[k - begin][d - 1][v] = w[v] * a[d];
    }
  }
  tile += places->first[begin];
  for (int plane = 0; plane <= spline; plane++) {
    mpsi_vec sum[4][MPSI_ROW] = {{{0.0}}};
    for (int k = begin; k < end; k++) {
      const double wz = places->w[2][plane][k], wzs = places->ws[2][plane][k];
      MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
        const mpsi_vec value = wz * along[k - begin][0][v] + wzs * along[k - begin][2][v];
        const mpsi_vec slope = wz * along[k - begin][1][v];
        MPSI_UNROLL for (int j = 0; j <= spline; j++) {
          sum[j][v] += places->w[1][j][k] * value; /* apart: each is one fused multiply-add */
          sum[j][v] += places->ws[1][j][k] * slope;
        }
      }
    }
    MPSI_UNROLL for (int j = 0; j <= spline; j++) {
      double *to = tile[mpsi_tile_index(0, j, plane)];
      MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
        double *at = to + 4 * MPSI_WIDE * v;
        mpsi_put_row(at, mpsi_get_row(at) + sum[j][v]);
      }
    }
  }
}

/* ---- full supports in space ------------------------------------------------------------------ */

/* Weights w_j w_k of the rows 4 k + j of a stencil. */
typedef struct row_weights {
  double w[MPSI_STENCIL / 4][MPSI_COLUMN] MPSI_LINE;
} row_weights;

MPSI_INLINE void find_row_weights(int spline, const mpsi_places *places, int n, row_weights *out) {
  for (int k = 0; k < n; k += 4) MPSI_UNROLL for (int plane = 0; plane <= spline; plane++) {
      const mpsi_quad across = mpsi_get(places->w[2][plane] + k);
      MPSI_UNROLL for (int j = 0; j <= spline; j++)
          mpsi_put(out->w[4 * plane + j] + k, across * mpsi_get(places->w[1][j] + k));
    }
}

/* Moves the origin of the linear functions from the particle to the second node of the stencil. The
 * distances of the nodes are then integers, the same for all particles of the stencil. */
MPSI_INLINE void shift_parts(const mpsi_places *places, int k, mpsi_quad part[4][4]) {
  MPSI_UNROLL for (int d = 0; d < 3; d++) {
    const mpsi_quad f = mpsi_get(places->t[d] + k) - 1.0;
    MPSI_UNROLL for (int c = MPSI_VECTOR; c < 4; c++) part[0][c] -= f * part[1 + d][c];
  }
}

MPSI_INLINE void find_full_parts(const mpsi_transfer *work, int spline, bool split,
                                 const mpsi_places *places, node_parts *sum, node_parts *force) {
  const sources s = find_sources(work, 3, spline, split);
  const int64_t chunk = places->chunk;
  const int n = places->count;
  for (int k = 0; k < n; k += 4) {
    quad_parts part;
    find_quad_parts(&s, MPS_MPM_GEOMETRY_SPACE, split, chunk + k, &part);
    shift_parts(places, k, part.sum);
    put_nodes(part.sum, k, sum);
    if (!split) continue;
    shift_parts(places, k, part.force);
    put_nodes(part.force, k, force);
  }
}

/* Distances (cells) of the nodes from number i of a row on to the second node. */
MPSI_INLINE mpsi_vec find_distances(int i) {
#if MPSI_WIDE == 2
  const double a = i - 1.0, b = i;
  return (mpsi_vec){a, a, a, a, b, b, b, b};
#else
  return mpsi_spread((mpsi_quad){0.0} + (i - 1.0));
#endif
}

/* Planes of a stencil that are summed at once: as many as fit in the registers. */
#if MPSI_LEVEL == 4
#define PLANES(spline) ((spline) + 1)
#elif MPSI_LEVEL == 3
#define PLANES(spline) ((spline) == 2 ? 3 : 2)
#else
#define PLANES(spline) 1
#endif

/* Adds one particle's contribution to the rows of `planes` planes from number `first` on: `value`
 * at the second row of the first plane, with the increments by_y from row to row and by_z from
 * plane to plane. */
MPSI_INLINE void add_rows(int spline, int first, int planes, const row_weights *weights, int k,
                          mpsi_vec value, mpsi_vec by_y, mpsi_vec by_z, mpsi_vec (*sum)[4]) {
  const mpsi_vec twice = by_y + by_y;
  MPSI_UNROLL for (int plane = 0; plane < planes; plane++) {
    const double *w = weights->w[4 * (first + plane)] + k;
    sum[plane][0] += w[0] * (value - by_y);
    sum[plane][1] += w[MPSI_COLUMN] * value;
    sum[plane][2] += w[2 * MPSI_COLUMN] * (value + by_y);
    if (spline == 3) sum[plane][3] += w[3 * MPSI_COLUMN] * (value + twice);
    value += by_z;
  }
}

/* Adds particles [begin, end) of a chunk, which share a full stencil, to the tile in 3D. */
MPSI_INLINE void add_full(int spline, const mpsi_places *places, const mpsi_rows *rows,
                          const row_weights *weights, int begin, int end, const node_parts *part,
                          mpsi_node *tile) {
  const int planes = PLANES(spline);
  tile += places->first[begin];
  for (int first = 0; first <= spline; first += planes)
    MPSI_UNROLL for (int i = 0; i <= spline; i += MPSI_WIDE) {
      const mpsi_vec distance = find_distances(i);
      mpsi_vec sum[4][4] = {{{0.0}}};
      for (int k = begin; k < end; k++) {
        const mpsi_vec w = mpsi_by_node(rows->w[k], i);
        mpsi_vec a[4];
        MPSI_UNROLL for (int d = 0; d < 4; d++) a[d] = mpsi_spread(mpsi_get(part->of[k][d]));
        const mpsi_vec by_z = w * a[3], value = w * (a[0] + distance * a[1]);
        add_rows(spline, first, planes, weights, k, value + (first - 1.0) * by_z, w * a[2], by_z,
                 sum);
      }
      MPSI_UNROLL for (int plane = 0; plane < planes; plane++)
          MPSI_UNROLL for (int j = 0; j <= spline; j++) {
        double *at = tile[mpsi_tile_index(i, j, first + plane)];
        mpsi_put_row(at, mpsi_get_row(at) + sum[plane][j]);
      }
    }
}

/* ---- full supports in the plane, two rows in a vector ---------------------------------------- */

#if MPSI_WIDE == 2
/* Contributions by component: value at the stencil's second nodes, slope along x, slope along y. */
typedef struct pair_parts {
  double mass[MPSI_CHUNK] MPSI_LINE, of[2][3][MPSI_CHUNK];
} pair_parts;

MPSI_INLINE void put_pairs(const mpsi_places *places, mpsi_quad from[4][4], int k, pair_parts *to) {
  mpsi_put(to->mass + k, from[0][MPSI_MASS]);
  MPSI_UNROLL for (int c = 0; c < 2; c++) {
    mpsi_quad value = from[0][MPSI_VECTOR + c];
    MPSI_UNROLL for (int d = 0; d < 2; d++) {
      const mpsi_quad slope = from[1 + d][MPSI_VECTOR + c];
      value -= (mpsi_get(places->t[d] + k) - 1.0) * slope;
      mpsi_put(to->of[c][1 + d] + k, slope);
    }
    mpsi_put(to->of[c][0] + k, value);
  }
}

MPSI_INLINE void find_pair_parts(const mpsi_transfer *work, int geometry, int spline, bool split,
                                 const mpsi_places *places, pair_parts *sum, pair_parts *force) {
  const sources s = find_sources(work, mpsi_dim_of(geometry), spline, split);
  const int64_t chunk = places->chunk;
  const int n = places->count;
  for (int k = 0; k < n; k += 4) {
    quad_parts part;
    find_quad_parts(&s, geometry, split, chunk + k, &part);
    put_pairs(places, part.sum, k, sum);
    if (split) put_pairs(places, part.force, k, force);
  }
}

MPSI_INLINE mpsi_vec make_pair(double a, double b) { return (mpsi_vec){a, a, a, a, b, b, b, b}; }

/* Adds the sums of two rows ([value], lanes: nodes) to the tile nodes from `to` on; not `both`: the
 * second row does not exist. */
MPSI_INLINE void add_pair(int spline, bool both, const mpsi_vec *sum, mpsi_node *to) {
  const mpsi_vec p = MPSI_SHUFFLE_WIDE(sum[0], sum[1], 0, 8, 2, 10, 4, 12, 6, 14);
  const mpsi_vec q = MPSI_SHUFFLE_WIDE(sum[0], sum[1], 1, 9, 3, 11, 5, 13, 7, 15);
  const mpsi_vec r = MPSI_SHUFFLE_WIDE(sum[2], sum[3], 0, 8, 2, 10, 4, 12, 6, 14);
  const mpsi_vec s = MPSI_SHUFFLE_WIDE(sum[2], sum[3], 1, 9, 3, 11, 5, 13, 7, 15);
  const mpsi_vec node[4] = {MPSI_SHUFFLE_WIDE(p, r, 0, 1, 8, 9, 4, 5, 12, 13),
                            MPSI_SHUFFLE_WIDE(q, s, 0, 1, 8, 9, 4, 5, 12, 13),
                            MPSI_SHUFFLE_WIDE(p, r, 2, 3, 10, 11, 6, 7, 14, 15),
                            MPSI_SHUFFLE_WIDE(q, s, 2, 3, 10, 11, 6, 7, 14, 15)};
  mpsi_node *next = to + mpsi_tile_index(0, 1, 0);
  MPSI_UNROLL for (int i = 0; i <= spline; i++) {
    const mpsi_vec a = node[i];
    mpsi_put(to[i], mpsi_get(to[i]) + (mpsi_quad){a[0], a[1], a[2], a[3]});
    if (both) mpsi_put(next[i], mpsi_get(next[i]) + (mpsi_quad){a[4], a[5], a[6], a[7]});
  }
}

MPSI_INLINE void add_pairs(int spline, const mpsi_places *places, const mpsi_rows *rows, int begin,
                           int end, const pair_parts *part, mpsi_node *tile) {
  const mpsi_vec along = {-1.0, 0.0, 1.0, 2.0, -1.0, 0.0, 1.0, 2.0};
  const mpsi_vec across[2] = {make_pair(-1.0, 0.0), make_pair(1.0, 2.0)};
  mpsi_vec sum[2][4] = {{{0.0}}};
  for (int k = begin; k < end; k++) {
    mpsi_vec w[2];
    MPSI_UNROLL for (int v = 0; v < 2; v++) {
      const double second = 2 * v < spline ? places->w[1][2 * v + 1][k] : 0.0;
      w[v] = mpsi_spread(mpsi_get(rows->w[k])) * make_pair(places->w[1][2 * v][k], second);
      sum[v][MPSI_MASS] += part->mass[k] * w[v];
    }
    MPSI_UNROLL for (int c = 0; c < 2; c++) {
      const mpsi_vec value = part->of[c][0][k] + part->of[c][1][k] * along;
      MPSI_UNROLL for (int v = 0; v < 2; v++) sum[v][MPSI_VECTOR + c] +=
          w[v] * (value + part->of[c][2][k] * across[v]);
    }
  }
  tile += places->first[begin];
  add_pair(spline, true, sum[0], tile);
  add_pair(spline, spline == 3, sum[1], tile + mpsi_tile_index(0, 2, 0));
}
#endif

/* ---- at walls, and in the plane -------------------------------------------------------------- */

/* Contributions in the layout of the loop that adds them. */
typedef union arranged_parts {
  row_parts row;
  node_parts node;
#if MPSI_WIDE == 2
  pair_parts pair;
#endif
} arranged_parts;

MPSI_INLINE void arrange_parts(int dim, int spline, const mpsi_places *places, int n, columns part,
                               arranged_parts *out) {
  if (dim == 2)
    find_row_parts(spline, places, n, part, &out->row);
  else
    find_node_parts(n, part, &out->node);
}

MPSI_INLINE void add_segment(int dim, int spline, const mpsi_places *places, const mpsi_rows *rows,
                             int begin, int end, const arranged_parts *part, mpsi_node *tile) {
  if (dim == 2)
    add_in_plane(spline, places, rows, begin, end, &part->row, tile);
  else
    add_in_space(spline, places, rows, begin, end, &part->node, tile);
}

/* Contributions and weights of a chunk of particles with full supports. */
typedef struct chunk {
  mpsi_rows rows;
  row_weights weights; /* in 3D */
  arranged_parts sum, force;
} chunk;

/* Arrays of a chunk, in the worker's scratch memory; `part` also for a segment at a wall, behind it
 * those of such a segment alone. */
typedef struct p2g_scratch {
  mpsi_places places;
  chunk all;
  parts part;
  columns along; /* forces that act along the wall */
  mpsi_wall wall;
  arranged_parts added;
} p2g_scratch;
_Static_assert(sizeof(p2g_scratch) <= MPSI_WORKER_SCRATCH, "scratch of a worker");

/* Adds a segment at the wall across `axis`: mass and momentum to the tile, force and
 * excess mass (see mpsi_node) to the tile of forces. Derivatives across the wall and along it have
 * different weights: hence three passes. */
MPSI_INLINE void add_at_wall(const mpsi_transfer *work, int geometry, int spline,
                             const mpsi_segment *segment, int axis) {
  const int dim = mpsi_dim_of(geometry), n = segment->end - segment->begin;
  const size_t bytes = sizeof(double[4][MPSI_CHUNK]);
  p2g_scratch *scratch = work->worker->scratch;
  mpsi_wall *wall = &scratch->wall;
  parts *part = &scratch->part;
  arranged_parts *added = &scratch->added;
  memset(scratch->along, 0, sizeof scratch->along);
  find_parts(work, geometry, spline, true, segment->places->chunk + segment->begin, n, part);
  mpsi_wall_places(work, dim, spline, segment, axis, MPSI_WALL_VALUE, wall);
  arrange_parts(dim, spline, &wall->places, n, part->sum, added);
  add_segment(dim, spline, &wall->places, &wall->rows, 0, n, added, work->worker->tile);
  for (int k = 0; k < n; k++) {
    scratch->along[0][MPSI_EXCESS][k] = part->sum[0][MPSI_MASS][k] * wall->mass[k];
    part->force[0][MPSI_EXCESS][k] = -part->sum[0][MPSI_MASS][k];
  }
  for (int d = 0; d < dim; d++) {
    if (d == axis) continue;
    memcpy(scratch->along[1 + d], part->force[1 + d], bytes);
    memset(part->force[1 + d], 0, bytes);
  }
  mpsi_wall_places(work, dim, spline, segment, axis, MPSI_WALL_SLOPE, wall);
  arrange_parts(dim, spline, &wall->places, n, part->force, added);
  add_segment(dim, spline, &wall->places, &wall->rows, 0, n, added, work->worker->force);
  mpsi_wall_places(work, dim, spline, segment, axis, MPSI_WALL_ALONG, wall);
  arrange_parts(dim, spline, &wall->places, n, scratch->along, added);
  add_segment(dim, spline, &wall->places, &wall->rows, 0, n, added, work->worker->force);
}

/* Functions of their own, as for MPSI_INSTANCES. */
#define DEFINE_AT_WALL(g, s, geometry, spline)                                                     \
  MPSI_APART void at_wall_##g##_##s(const mpsi_transfer *work, const mpsi_segment *segment,        \
                                    int axis) {                                                    \
    add_at_wall(work, geometry, spline, segment, axis);                                            \
  }
MPSI_VARIANTS(DEFINE_AT_WALL)
#define AT_WALL_ENTRY(g, s, geometry, spline) [geometry][spline - 2] = at_wall_##g##_##s,
static void (*const at_wall[3][2])(const mpsi_transfer *, const mpsi_segment *,
                                   int) = {MPSI_VARIANTS(AT_WALL_ENTRY)};

MPSI_INLINE void clear(const mpsi_cell_block *cells, mpsi_node *tile) {
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++)
      for (int i = cells->low[0]; i < cells->high[0]; i++)
        mpsi_put(tile[mpsi_tile_index(i, j, k)], (mpsi_quad){0.0});
}

/* Adds the tile, and the tile of forces, to the block of nodes g under corner q of the tile. */
MPSI_INLINE void flush(const mpsi_grid *grid, double dt, const mpsi_cell_block *cells, int q,
                       int32_t g, const mpsi_node *tile, const mpsi_node *forces) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  mpsi_node *node = grid->node + mpsi_first_node(grid, g);
  mpsi_node *side = nodes->side >= 0 ? grid->side + mpsi_first_node(grid, nodes->side) : NULL;
  int low[3], high[3];
  for (int c = 0; c < 3; c++) { /* range of the tile's nodes over that block */
    const int first = q >> c & 1 ? MPSI_SIDE : 0;
    low[c] = cells->low[c] > first ? cells->low[c] : first;
    high[c] = first || cells->high[c] < MPSI_SIDE ? cells->high[c] : MPSI_SIDE;
  }
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1]; j++) {
      const int t = mpsi_tile_index(0, j, k);
      const int to =
          ((k % MPSI_SIDE) * MPSI_SIDE + j % MPSI_SIDE) * MPSI_SIDE - (q & 1) * MPSI_SIDE;
      for (int i = low[0]; i < high[0]; i++) {
        mpsi_quad sum = mpsi_get(tile[t + i]);
        if (cells->apart) {
          mpsi_quad force = mpsi_get(forces[t + i]);
          if (nodes->split) {
            mpsi_put(side[to + i], mpsi_get(side[to + i]) + force);
          } else {
            if (side) side[to + i][MPSI_EXCESS] += force[MPSI_EXCESS];
            force[MPSI_EXCESS] = 0.0;
            sum += dt * force;
          }
        }
        mpsi_put(node[to + i], mpsi_get(node[to + i]) + sum);
      }
    }
}

MPSI_INLINE void find_chunk(const mpsi_transfer *work, int geometry, int spline, bool split,
                            p2g_scratch *scratch) {
  mpsi_places *places = &scratch->places;
  chunk *out = &scratch->all;
  const int dim = mpsi_dim_of(geometry), n = places->count;
  find_rows(spline, dim == 2 && MPSI_WIDE == 1, places, n, &out->rows);
  if (dim == 3) {
    find_row_weights(spline, places, n, &out->weights);
    find_full_parts(work, spline, split, places, &out->sum.node, &out->force.node);
    return;
  }
#if MPSI_WIDE == 2
  find_pair_parts(work, geometry, spline, split, places, &out->sum.pair, &out->force.pair);
#else
  find_parts(work, geometry, spline, split, places->chunk, n, &scratch->part);
  arrange_parts(dim, spline, places, n, scratch->part.sum, &out->sum);
  if (split) arrange_parts(dim, spline, places, n, scratch->part.force, &out->force);
#endif
}

MPSI_INLINE void add_chunk(int dim, int spline, const mpsi_places *places, const chunk *from,
                           const arranged_parts *part, int begin, int end, mpsi_node *tile) {
  if (dim == 2)
#if MPSI_WIDE == 2
    add_pairs(spline, places, &from->rows, begin, end, &part->pair, tile);
#else
    add_in_plane(spline, places, &from->rows, begin, end, &part->row, tile);
#endif
  else
    add_full(spline, places, &from->rows, &from->weights, begin, end, &part->node, tile);
}

MPSI_INLINE void p2g_chunk(const mpsi_transfer *work, int geometry, int spline, int64_t begin,
                           int n) {
  const int dim = mpsi_dim_of(geometry);
  const mpsi_cell_block *cells = work->cells;
  const mpsi_worker *worker = work->worker;
  p2g_scratch *scratch = worker->scratch;
  const mpsi_places *places = &scratch->places;
  const chunk *all = &scratch->all;
  mpsi_find_places(work, dim, spline, dim == 2 ? 3 : 7, dim == 2 && MPSI_WIDE == 1 ? 3 : 0, begin,
                   n, &scratch->places);
  if (cells->split)
    find_chunk(work, geometry, spline, true, scratch);
  else
    find_chunk(work, geometry, spline, false, scratch);
  for (int k = 0, end; k < n; k = end) {
    for (end = k + 1; end < n && end < k + MPSI_SEGMENT && places->first[end] == places->first[k];)
      end++;
    const uint32_t state =
        cells->cut ? mpsi_support_state(worker, dim, spline, places->first[k]) : 0;
    if (state != 0) {
      const mpsi_segment segment = {places, k, end};
      const int axis = mpsi_wall_axis(work->grid, cells, dim, spline, state, places->first[k]);
      if (axis >= 0) at_wall[geometry][spline - 2](work, &segment, axis);
      if (axis >= 0 || MPSI_LEVELLED(mpsi_mpm_scatter_cut)(work, &segment)) continue;
    }
    add_chunk(dim, spline, places, all, &all->sum, k, end, worker->tile);
    if (cells->split) add_chunk(dim, spline, places, all, &all->force, k, end, worker->force);
  }
}

/* Prefetches the columns of a chunk. In 2D a block has too few particles for the processor to
 * detect the sequential access, and the next block of the colour is elsewhere in memory. */
MPSI_INLINE void prefetch_chunk(const mpsi_columns *p, int64_t begin, int64_t end) {
  for (int64_t k = begin; k < end && k < begin + MPSI_CHUNK; k += 8) {
    for (int c = 0; c < 2; c++) __builtin_prefetch(p->x[c] + k), __builtin_prefetch(p->v[c] + k);
    for (int c = 0; c < 4; c++) __builtin_prefetch(p->L[c] + k), __builtin_prefetch(p->s[c] + k);
    __builtin_prefetch(p->V + k);
    __builtin_prefetch(p->m + k);
  }
}

/* Clears the second tiles, for values across thin bodies, and the sets of nodes that these separate
 * from particles. Particles with a full support write no set, but the gather reads it where nodes
 * retain momentum (return_momentum of cut_gather.c). */
static void begin_across(const mpsi_contacts *contacts, const mpsi_cell_block *cells,
                         mpsi_worker *worker) {
  const size_t count = (size_t)(cells->end - cells->begin);
  clear(cells, worker->across_tile);
  clear(cells, worker->across_force);
  memset(contacts->across + cells->begin, 0, count * sizeof *contacts->across);
}

/* First half of P2G: sums the contributions of the particles of block b in the worker's tiles. Sets
 * the loads of penalty contact, stored fits and impulses of mirrors of the block to zero before. */
MPSI_INLINE void tile_body(const mpsi_transfer *work, int geometry, int spline) {
  const mpsi_cell_block *cells = work->cells;
  mpsi_worker *worker = work->worker;
  const int dim = mpsi_dim_of(geometry);
  for (int32_t q = 0; q < cells->pairs; q++) {
    mpsi_cell_pair *pair = &work->contact->cell_pair[cells->first_pair + q];
    pair->in_contact = false;
    pair->deepest = 0.0;
    memset(work->contact->load + pair->first_load, 0,
           (size_t)work->contact->handle[pair->body]->parts * sizeof *work->contact->load);
  }
  if (cells->cut) mpsi_mpm_find_states(work);
  if (cells->first_fit >= 0)
    memset(work->grid->fitted + cells->first_fit, 0, (size_t)(cells->end - cells->begin));
  if (cells->mirrors) mpsi_mpm_begin_mirrors(work->mirrors, cells);
  clear(cells, worker->tile);
  if (cells->apart) clear(cells, worker->force);
  if (cells->thin) begin_across(work->contact, cells, worker);
  const mpsi_cell_block *next =
      dim == 2 && cells + 2 < work->grid->cells + work->grid->cell_count ? cells + 2 : NULL;
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int64_t rest = cells->end - k;
    if (next) prefetch_chunk(work->p, next->begin + (k - cells->begin), next->end);
    p2g_chunk(work, geometry, spline, k, rest < MPSI_CHUNK ? (int)rest : MPSI_CHUNK);
  }
  if (cells->mirrors) mpsi_mpm_fold(work);
}

/* Second half of P2G: adds the worker's tiles to the blocks of nodes. */
MPSI_INLINE void flush_body(const mpsi_transfer *work, int dim) {
  const mpsi_cell_block *cells = work->cells;
  const mpsi_worker *from = work->worker;
  for (int q = 0; q < 1 << dim; q++)
    flush(work->grid, work->run->dt, cells, q, cells->to[q], (const mpsi_node *)from->tile,
          (const mpsi_node *)from->force);
  for (int q = 0; q < 1 << dim && cells->thin; q++)
    flush(work->grid, work->run->dt, cells, q, work->grid->nodes[cells->to[q]].across,
          (const mpsi_node *)from->across_tile, (const mpsi_node *)from->across_force);
}

void MPSI_LEVELLED(mpsi_mpm_flush)(const mpsi_transfer *work) { flush_body(work, work->grid->dim); }

#define DEFINE(g, s, geometry, spline)                                                             \
  static void tile_##g##_##s(const mpsi_transfer *work) { tile_body(work, geometry, spline); }     \
  static void p2g_##g##_##s(const mpsi_transfer *work) {                                           \
    tile_##g##_##s(work);                                                                          \
    flush_body(work, mpsi_dim_of(geometry));                                                       \
  }
MPSI_VARIANTS(DEFINE)

#define TILE_ENTRY(g, s, geometry, spline) [geometry][spline - 2] = tile_##g##_##s,
const mpsi_transfer_fn MPSI_LEVELLED(mpsi_mpm_tile)[3][2] = {MPSI_VARIANTS(TILE_ENTRY)};

#define ENTRY(g, s, geometry, spline) [geometry][spline - 2] = p2g_##g##_##s,
const mpsi_transfer_fn MPSI_LEVELLED(mpsi_mpm_p2g)[3][2] = {MPSI_VARIANTS(ENTRY)};
