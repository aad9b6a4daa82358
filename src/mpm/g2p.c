/* g2p.c - nodes to particles, Nakamura (41)-(43), (48), one block of cells at a time, and then,
 * while its particles are in the cache, their law and the speeds that bound the time step, (49),
 * (50). Particles with a cut support: fitted.c. Compiled once for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wall.h"

/* Copies the nodes under a tile. */
MPSI_INLINE void gather_tile(const mps_mpm *mpm, const mpsi_cell_block *cells, mpsi_node *tile) {
  const int low = cells->low[0], high = cells->high[0];
  const int middle = high < MPSI_SIDE ? high : low > MPSI_SIDE ? low : MPSI_SIDE;
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++) {
      mpsi_node *own = mpm->grid.node + mpsi_node_under(mpm, cells, 0, j, k);
      mpsi_node *next = mpm->grid.node + mpsi_node_under(mpm, cells, MPSI_SIDE, j, k);
      mpsi_node *to = tile + mpsi_tile_index(0, j, k);
      for (int i = low; i < middle; i++) mpsi_put(to[i], mpsi_get(own[i]));
      for (int i = middle; i < high; i++) mpsi_put(to[i], mpsi_get(next[i - MPSI_SIDE]));
    }
}

/* Differences along y of a stencil, node by node along x, in each of its planes across z. */
typedef struct differences {
  int32_t first; /* lowest node of the stencil */
  mpsi_vec along_y[4][MPSI_ROW];
} differences;

MPSI_INLINE void find_differences(int dim, int spline, int32_t first, const mpsi_node *tile,
                                  differences *out) {
  out->first = first;
  for (int plane = 0; plane <= (dim == 3 ? spline : 0); plane++)
    MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
      const double *node = tile[first + mpsi_tile_index(0, 0, plane)] + 4 * MPSI_WIDE * v;
      mpsi_vec sum = {0.0};
      MPSI_UNROLL for (int j = 0; j <= spline; j++) sum +=
          mpsi_difference(spline, j) * mpsi_get_row(node + 4 * mpsi_tile_index(0, j, 0));
      out->along_y[plane][v] = sum;
    }
}

/* A particle's velocity (lanes 1 to 3), its slopes by x, y, z, which the transfer takes, and its
 * derivatives, which the laws see. */
typedef struct gathered {
  mpsi_two v;    /* velocity, 0 */
  mpsi_two L[3]; /* slope and derivative by each axis */
} gathered;

/* By factors: sums of the rows by their weights across, w and w s, node by node, and at last along
 * x. `excess` (1/m) of each axis: see mpsi_excess. */
MPSI_INLINE void gather_full(int dim, int spline, double scale, const mpsi_places *places,
                             const mpsi_rows *rows, int k, const mpsi_node *tile,
                             const differences *difference, const double *excess, gathered *out) {
  /* by w of y and z, by w s of y, by w s of z, by differences of y, of z */
  mpsi_vec sum[5][MPSI_ROW] = {{{0.0}}};
  tile += places->first[k];
  for (int plane = 0; plane <= (dim == 3 ? spline : 0); plane++) {
    MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
      mpsi_vec value = {0.0}, slope = {0.0};
      MPSI_UNROLL for (int j = 0; j <= spline; j++) {
        const mpsi_vec node = mpsi_get_row(tile[mpsi_tile_index(0, j, plane)] + 4 * MPSI_WIDE * v);
        value += places->w[0][j][k] * node;
        slope += places->ws[0][j][k] * node;
      }
      if (dim == 2) {
        sum[0][v] = value, sum[1][v] = slope, sum[3][v] = difference->along_y[0][v];
        continue;
      }
      const double wz = places->w[1][plane][k], wzs = places->ws[1][plane][k];
      sum[0][v] += wz * value;
      sum[1][v] += wz * slope;
      sum[2][v] += wzs * value;
      sum[3][v] += wz * difference->along_y[plane][v];
      sum[4][v] += mpsi_difference(spline, plane) * value;
    }
  }
  mpsi_vec w[MPSI_ROW], ws[MPSI_ROW], all[4] = {{0.0}}, rise[3] = {{0.0}};
  mpsi_weights_along(spline, places, rows, k, w, ws);
  MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
    double by_x[4];
    for (int i = 0; i < 4; i++) by_x[i] = mpsi_difference(spline, i);
    all[0] += w[v] * sum[0][v];
    all[1] += ws[v] * sum[0][v];
    rise[0] += mpsi_by_node(by_x, v * MPSI_WIDE) * sum[0][v];
    for (int d = 2; d <= dim; d++) {
      all[d] += w[v] * sum[d - 1][v];
      rise[d - 1] += w[v] * sum[d + 1][v];
    }
  }
  mpsi_put(out->v, mpsi_fold(all[0]));
  for (int d = 0; d < dim; d++) {
    const mpsi_vec slope = scale * all[1 + d];
    mpsi_fold_two(slope, slope + excess[d] * rise[d], out->L[d]);
  }
}

/* The same at the wall across `axis`, where the laws see the slope across it. */
MPSI_INLINE void gather_at_wall(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim,
                                int spline, double scale, const mpsi_places *places, int axis,
                                int k, const mpsi_node *tile, const differences *difference,
                                const double *excess, gathered *out) {
  mpsi_wall wall;
  double along[3] = {excess[0], excess[1], excess[2]};
  gathered slopes;
  along[axis] = 0.0;
  mpsi_wall_places(mpm, cells, dim, spline, places, k, k + 1, axis, MPSI_WALL_ALONG, &wall);
  gather_full(dim, spline, scale, &wall.places, &wall.rows, 0, tile, difference, along, &slopes);
  mpsi_wall_places(mpm, cells, dim, spline, places, k, k + 1, axis, MPSI_WALL_SLOPE, &wall);
  gather_full(dim, spline, scale, &wall.places, &wall.rows, 0, tile, difference, along, out);
  for (int d = 0; d < dim; d++)
    if (d != axis) memcpy(out->L[d], slopes.L[d], sizeof(mpsi_node));
}

/* The first `n` (at most 4) values of a vector. */
MPSI_INLINE void store_some(double *to, mpsi_quad v, int n) {
  if (n >= 4) {
    mpsi_put(to, v);
    return;
  }
  for (int i = 0; i < n; i++) to[i] = v[i];
}

/* Velocities and gradients to the particles' columns; the particles move. Tells whether one is then
 * `outside` the domain (or nowhere), or has `left` the block and its slack: their stencils would
 * leave the tile. */
typedef struct moved {
  bool outside, left;
} moved;

/* Slopes, or (second 4) derivatives, of four particles to columns from `at`; `n` of them are there.
 */
MPSI_INLINE void store_gradients(int dim, int n, const gathered *from, int second,
                                 double *const *to, int64_t at) {
  MPSI_UNROLL for (int d = 0; d < dim; d++) {
    mpsi_quad a[4];
    MPSI_UNROLL for (int i = 0; i < 4; i++) a[i] = mpsi_get(from[i].L[d] + second);
    mpsi_transpose(a);
    MPSI_UNROLL for (int c = 0; c < dim; c++) store_some(to[dim * c + d] + at, a[1 + c], n);
  }
}

/* Four particles from `at`, of which `n` are there. */
MPSI_INLINE void move_four(mps_mpm *mpm, const mpsi_cell_block *cells, int geometry, int spline,
                           int64_t at, int n, const gathered *from, mpsi_mask *outside,
                           mpsi_mask *left) {
  const int dim = mpsi_dim_of(geometry);
  const double first = spline == 3 ? 1.0 : 0.5; /* of the block: see mpsi_find_places */
  const mpsi_columns *p = &mpm->p;
  const mpsi_mask there = (mpsi_mask){0, 1, 2, 3} < n;
  mpsi_quad v[4];
  MPSI_UNROLL for (int i = 0; i < 4; i++) v[i] = mpsi_get(from[i].v);
  mpsi_transpose(v);
  MPSI_UNROLL for (int c = 0; c < dim; c++) {
    const int reach = c == 0 ? 3 : spline; /* see widen_use in layout.c */
    const mpsi_quad x = mpsi_get_some(p->x[c] + at, n), to = x + mpm->run.dt * v[1 + c];
    const mpsi_quad X = mpsi_from_block(mpm, cells, c, to);
    const double corner = (double)cells->at[c] * MPSI_SIDE;
    const mpsi_mask good =
        (X >= (double)mpm->grid.low[c] - corner) & (X <= (double)mpm->grid.high[c] - corner);
    const mpsi_mask here = (X >= first + cells->low[c]) & (X < first + (cells->high[c] - reach));
    *outside |= there & ~good;
    *left |= there & ~here;
    store_some(p->v[c] + at, v[1 + c], n);
    if (geometry == MPS_MPM_AXISYMMETRIC && c == 0) store_some(p->L[4] + at, v[1] / x, n);
    store_some(p->x[c] + at, to, n);
  }
}

MPSI_INLINE moved move(mps_mpm *mpm, const mpsi_cell_block *cells, int geometry, int spline,
                       int64_t begin, int n, const gathered *from, double *const *D) {
  const int dim = mpsi_dim_of(geometry);
  double *const *L = mpm->p.L;
  mpsi_mask outside = {0}, left = {0};
  for (int k = 0; k < n; k += 4) {
    const int64_t at = begin + k;
    if (n - k >= 4) { /* apart: without questions */
      move_four(mpm, cells, geometry, spline, at, 4, from + k, &outside, &left);
      store_gradients(dim, 4, from + k, 0, L, at);
      store_gradients(dim, 4, from + k, 4, D, k);
    } else {
      move_four(mpm, cells, geometry, spline, at, n - k, from + k, &outside, &left);
      store_gradients(dim, n - k, from + k, 0, L, at);
      store_gradients(dim, n - k, from + k, 4, D, k);
    }
  }
  return (moved){(outside[0] | outside[1] | outside[2] | outside[3]) != 0,
                 (left[0] | left[1] | left[2] | left[3]) != 0};
}

/* FLIP: what the particles keep of their own velocities, where fitted.c has put it. */
static void add_own(mps_mpm *mpm, int64_t begin, int n, const gathered *from) {
  for (int c = 0; c < mpm->dim; c++)
    for (int k = 0; k < n; k++) mpm->p.v[c][begin + k] += from[k].L[c][MPSI_MASS];
}

/* The nodes of a wall stand still, but a velocity fitted over them need not at the wall itself: a
 * particle that is pressed on it passes it by a little in time. At a mirror it does not. */
#define BEYOND 0.1 /* cells: a particle so far behind a wall is put back on it */

/* Looks after particles [begin, end), one of which is outside the domain: the first that is too far
 * beyond a wall, or not a number; -1 where there is none. Those beyond an open side leave after the
 * step. Nothing is put back on the axis: there
 * the hoop strain has no end. */
static int64_t keep_inside(mps_mpm *mpm, mpsi_cell_block *cells, int64_t begin, int64_t end) {
  int64_t bad = -1;
  for (int64_t k = begin; k < end; k++)
    for (int c = 0; c < mpm->dim; c++) {
      double *x = &mpm->p.x[c][k];
      const double X = mpsi_grid_coordinate(mpm, c, *x);
      const double low = (double)mpm->grid.low[c], high = (double)mpm->grid.high[c];
      if (X >= low && X <= high) continue;
      if (mpsi_mpm_passes(mpm, c, X)) {
        cells->gone = true;
        continue;
      }
      const bool axis = mpm->def.geometry == MPS_MPM_AXISYMMETRIC && c == 0 && !(*x > 0.0);
      if (axis || !(X >= low - BEYOND && X <= high + BEYOND)) {
        if (bad < 0) bad = k;
        break;
      }
      const double wall = X < low ? low : high, inwards = X < low ? INFINITY : -INFINITY;
      *x = mpm->def.origin[c] + mpm->def.cell * wall;
      while ((mpsi_grid_coordinate(mpm, c, *x) - wall) * inwards < 0.0) *x = nextafter(*x, inwards);
    }
  return bad;
}

/* c + |v| of particles [begin, begin + n), at most a chunk. A NaN or infinity is a bad particle. */
MPSI_INLINE void find_speed(const mps_mpm *mpm, mpsi_cell_block *cells, int dim, int64_t begin,
                            int n, const double *moduli) {
  const mpsi_columns *p = &mpm->p;
  const double *v0 = p->v[0] + begin, *v1 = p->v[1] + begin, *v2 = dim == 3 ? p->v[2] + begin : v1;
  const double *V = p->V + begin, *m = p->m + begin;
  const double moving = mpm->def.step_from == MPS_MPM_STEP_FROM_SPEED ? 1.0 : 0.0;
  double speed[MPSI_CHUNK];
  MPSI_SIMD for (int k = 0; k < n; k++) {
    double square = v0[k] * v0[k] + v1[k] * v1[k];
    if (dim == 3) square += v2[k] * v2[k];
    speed[k] =
        sqrt((moduli ? moduli[k] : mpm->laws.law[0].modulus) * V[k] / m[k]) + moving * sqrt(square);
  }
  double largest[4] = {0.0};
  int64_t good = 1;
  for (int k = 0; k < n; k++) {
    largest[k % 4] = speed[k] > largest[k % 4] ? speed[k] : largest[k % 4];
    good &= speed[k] <= 1.7e308; /* not of a NaN */
  }
  for (int k = 0; k < 4; k++)
    if (largest[k] > cells->speed) cells->speed = largest[k];
  for (int k = 0; k < n && !good && (cells->bad < 0 || cells->lost); k++)
    if (!isfinite(speed[k])) cells->bad = begin + k, cells->lost = false;
}

MPSI_INLINE void speed_chunk(const mps_mpm *mpm, mpsi_cell_block *cells, int dim, int64_t begin,
                             int n) {
  if (mpm->laws.one_modulus) {
    find_speed(mpm, cells, dim, begin, n, NULL);
    return;
  }
  double moduli[MPSI_CHUNK];
  mpsi_mpm_find_moduli(mpm, begin, begin + n, moduli);
  find_speed(mpm, cells, dim, begin, n, moduli);
}

/* What the nodes give to particles [begin, begin + n). */
MPSI_INLINE void gather_chunk(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                              int dim, int spline, int64_t begin, int n, gathered *out) {
  const double scale = mpsi_inverse_moment(spline) * mpm->grid.inverse;
  const mpsi_node *tile = (const mpsi_node *)worker->tile;
  mpsi_places places;
  differences difference = {.first = -1};
  double excess[3][MPSI_CHUNK];
  mpsi_find_places(mpm, cells, dim, spline, begin, n, &places);
  for (int c = 0; c < dim; c++)
    for (int k = 0; k < n; k += 4)
      mpsi_put(excess[c] + k, mpm->grid.inverse * mpsi_excess(spline, mpsi_get(places.t[c] + k)));
  if (mpm->p.stencil)
    memcpy(mpm->p.stencil + begin, places.first, (size_t)n * sizeof *mpm->p.stencil);
  uint32_t state = 0;
  for (int k = 0; k < n; k++) {
    const int32_t first = places.first[k];
    const double e[3] = {excess[0][k], excess[1][k], dim == 3 ? excess[2][k] : 0.0};
    if (first != difference.first) {
      find_differences(dim, spline, first, tile, &difference);
      if (cells->cut) state = mpsi_support_state(worker, dim, spline, first);
    }
    const int axis = state ? mpsi_wall_axis(mpm, cells, dim, spline, state, first) : -1;
    if (!state)
      gather_full(dim, spline, scale, &places, NULL, k, tile, &difference, e, &out[k]);
    else if (axis >= 0)
      gather_at_wall(mpm, cells, dim, spline, scale, &places, axis, k, tile, &difference, e,
                     &out[k]);
    else
      MPSI_LEVELLED(mpsi_gather_fitted)(mpm, cells, worker, begin + k, out[k].v, out[k].L);
    for (int d = 0; d < dim && mpm->strain_by_fit; d++)
      memcpy(out[k].L[d] + 4, out[k].L[d], sizeof(mpsi_node));
  }
}

/* `D`: columns of the derivatives of these particles, as those of L, for the laws. */
MPSI_INLINE void g2p_chunk(mps_mpm *mpm, mpsi_cell_block *cells, const mpsi_worker *worker,
                           int geometry, int spline, int64_t begin, int n, double *const *D) {
  const int dim = mpsi_dim_of(geometry);
  gathered from[MPSI_CHUNK] __attribute__((aligned(64)));
  gather_chunk(mpm, cells, worker, dim, spline, begin, n, from);
  if (mpm->energy.counts) mpsi_energy_before(mpm, cells, begin, begin + n);
  const moved m = move(mpm, cells, geometry, spline, begin, n, from, D);
  if (mpm->energy.counts) mpsi_energy_moved(mpm, cells, begin, begin + n);
  if (mpm->flip > 0.0) add_own(mpm, begin, n, from);
  if (m.left) cells->left = true;
  if (!m.outside) return;
  const int64_t bad = keep_inside(mpm, cells, begin, begin + n);
  if (cells->bad < 0 && bad >= 0) cells->bad = bad, cells->lost = true;
}

MPSI_INLINE void g2p_body(mps_mpm *mpm, int64_t b, int32_t number, int geometry, int spline) {
  mpsi_cell_block *cells = &mpm->grid.cells[b];
  mpsi_worker *worker = &mpm->grid.workers[number];
  const int dim = mpsi_dim_of(geometry);
  cells->left = cells->gone = cells->lost = false;
  cells->bad = -1;
  cells->speed = 0.0;
  gather_tile(mpm, cells, worker->tile);
  if (cells->mirrors) mpsi_mpm_unfold(mpm, cells, worker->tile);
  if (cells->cut) mpsi_mpm_find_states(mpm, cells, worker);
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int n = cells->end - k < MPSI_CHUNK ? (int)(cells->end - k) : MPSI_CHUNK;
    double own[9][MPSI_CHUNK], *D[9];
    for (int c = 0; c < dim * dim; c++) D[c] = mpm->p.D[c] ? mpm->p.D[c] + k : own[c];
    g2p_chunk(mpm, cells, worker, geometry, spline, k, n, D);
    if (mpm->p.stencil) continue; /* the laws wait for the cells' means */
    mpsi_mpm_apply_law(mpm, cells, k, k + n, D);
    speed_chunk(mpm, cells, dim, k, n);
  }
}

/* ---- variants -------------------------------------------------------------------------------- */

#define DEFINE(g, s, geometry, spline)                                                             \
  static void g2p_##g##_##s(mps_mpm *mpm, int64_t b, int32_t worker) {                             \
    g2p_body(mpm, b, worker, geometry, spline);                                                    \
  }
MPSI_VARIANTS(DEFINE)

#define ENTRY(g, s, geometry, spline) [geometry][spline - 2] = g2p_##g##_##s,
const mpsi_mpm_task MPSI_LEVELLED(mpsi_g2p)[3][2] = {MPSI_VARIANTS(ENTRY)};

void MPSI_LEVELLED(mpsi_speed)(mps_mpm *mpm, int64_t b, int32_t worker) {
  (void)worker;
  mpsi_cell_block *cells = &mpm->grid.cells[b];
  if (!cells->lost) cells->bad = -1;
  cells->speed = 0.0;
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int n = cells->end - k < MPSI_CHUNK ? (int)(cells->end - k) : MPSI_CHUNK;
    speed_chunk(mpm, cells, mpm->dim, k, n);
  }
}
