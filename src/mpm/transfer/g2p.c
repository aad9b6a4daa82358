/* g2p.c - nodes to particles (G2P): velocity, velocity gradient and position of the particles of a
 * block of cells, Nakamura (41)-(43), (48); then, while the particles are in the cache, their
 * constitutive law and the speed c + |v| that bounds the time step, (49), (50). Particles with a
 * cut support: cut_gather.c. Compiled once for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wall_support.h"

#include "mpm/water/water.h"

MPSI_INLINE mpsi_node *find_node(const mpsi_grid *grid, const mpsi_cell_block *cells, bool across,
                                 bool before, int i, int j, int k) {
  if (before) return grid->side + mpsi_side_under(grid, cells, across, i, j, k);
  return grid->node +
         (across ? mpsi_node_across(grid, cells, i, j, k) : mpsi_node_under(grid, cells, i, j, k));
}

/* Copies the nodes under a tile; `across`: their values across thin bodies, for the second tile;
 * `before`: their velocities before the forces. */
MPSI_INLINE void gather_tile(const mpsi_grid *grid, const mpsi_cell_block *cells, bool across,
                             bool before, mpsi_node *tile) {
  const int low = cells->low[0], high = cells->high[0];
  const int middle = high < MPSI_SIDE ? high : low > MPSI_SIDE ? low : MPSI_SIDE;
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++) {
      mpsi_node *own = find_node(grid, cells, across, before, 0, j, k);
      mpsi_node *next = find_node(grid, cells, across, before, MPSI_SIDE, j, k);
      mpsi_node *to = tile + mpsi_tile_index(0, j, k);
      for (int i = low; i < middle; i++) mpsi_put(to[i], mpsi_get(own[i]));
      for (int i = middle; i < high; i++) mpsi_put(to[i], mpsi_get(next[i - MPSI_SIDE]));
    }
}

/* Values of the nodes of a stencil as polynomials along y, one for each place along x and plane
 * across z, which serve all particles of the stencil. With f the distance along y from the second
 * node (cells), the sum of the nodes' values times B-splines is term[0] + term[1] f + term[2] f^2 +
 * term[3] f^3; its derivative by f is that of the B-splines. The highest coefficient is the
 * difference of mpsi_difference over spline! (the factor of mpsi_excess). */
typedef struct polynomials {
  mpsi_node term[4][4][4] MPSI_LINE; /* [plane][place along x][power] */
  const mpsi_node *lowest;           /* node of the stencil, in the tile */
} polynomials;

MPSI_INLINE void find_polynomials(int dim, int spline, const mpsi_node *lowest, polynomials *out) {
  out->lowest = lowest;
  for (int plane = 0; plane <= (dim == 3 ? spline : 0); plane++)
    MPSI_UNROLL for (int i = 0; i <= spline; i++) {
      const mpsi_node *node = lowest + mpsi_tile_index(i, 0, plane);
      mpsi_node *to = out->term[plane][i];
      const mpsi_quad a = mpsi_get(node[0]), b = mpsi_get(node[mpsi_tile_index(0, 1, 0)]);
      const mpsi_quad c = mpsi_get(node[mpsi_tile_index(0, 2, 0)]);
      if (spline == 3) {
        const mpsi_quad d = mpsi_get(node[mpsi_tile_index(0, 3, 0)]), outer = a + c;
        mpsi_put(to[0], (outer + 4.0 * b) * (1.0 / 6.0));
        mpsi_put(to[1], 0.5 * (c - a));
        mpsi_put(to[2], 0.5 * outer - b);
        mpsi_put(to[3], (d - a) * (1.0 / 6.0) + 0.5 * (b - c));
      } else {
        const mpsi_quad outer = a + c;
        mpsi_put(to[0], 0.125 * outer + 0.75 * b);
        mpsi_put(to[1], 0.5 * (c - a));
        mpsi_put(to[2], 0.5 * outer - b);
      }
    }
}

/* Sums over the nodes of a row along y, for one component of the velocity. */
typedef struct row_sums {
  mpsi_lanes value, growth; /* weighted by w; by dw/df, or at a wall by w s */
} row_sums;

/* Sums of a row by the polynomials of the stencil; f: distance along y from the second node,
 * cells. */
MPSI_INLINE row_sums sum_splines(int spline, const mpsi_node *term, int lane, mpsi_lanes f) {
  const double top = term[spline][lane];
  mpsi_lanes value = top * f + term[spline - 1][lane], growth = top * f + value;
  if (spline == 3) {
    value = value * f + term[1][lane];
    growth = growth * f + value;
  }
  return (row_sums){value * f + term[0][lane], growth};
}

/* Sums of a row by any weights, at a wall. */
MPSI_INLINE row_sums sum_weights(int spline, const mpsi_places *places, int k,
                                 const mpsi_node *node, int lane) {
  row_sums out = {{0.0}, {0.0}};
  MPSI_UNROLL for (int j = 0; j <= spline; j++) {
    const double v = node[mpsi_tile_index(0, j, 0)][lane];
    out.value += mpsi_get_lanes(places->w[1][j] + k) * v;
    out.growth += mpsi_get_lanes(places->ws[1][j] + k) * v;
  }
  return out;
}

/* Sums over the plane of nodes at one place along x, for one component of the velocity: weighted by
 * w_y w_z; `slope` by the derivatives along y (as row_sums.growth) and z (w s); `rise` by
 * mpsi_difference along y and z. */
typedef struct plane_sums {
  mpsi_lanes value, slope[2], rise[2];
} plane_sums;

/* MPSI_LANES particles of one stencil: of `places`, from number k on, with the polynomials of the
 * stencil. */
typedef struct lanes {
  const mpsi_places *places;
  int k;
  const polynomials *rows;
} lanes;

/* At place i along x, for the component in `lane` of a node; `lowest`: node of the stencil. */
MPSI_INLINE plane_sums sum_plane(int dim, int spline, bool at_wall, const lanes *of,
                                 const mpsi_node *lowest, int lane, int i) {
  const mpsi_places *places = of->places;
  const int k = of->k;
  const mpsi_lanes f = mpsi_get_lanes(places->t[1] + k) - 1.0;
  plane_sums out = {{0.0}, {{0.0}}, {{0.0}}};
  for (int plane = 0; plane <= (dim == 3 ? spline : 0); plane++) {
    const mpsi_node *term = of->rows->term[plane][i];
    const mpsi_node *node = lowest + mpsi_tile_index(i, 0, plane);
    const row_sums row =
        at_wall ? sum_weights(spline, places, k, node, lane) : sum_splines(spline, term, lane, f);
    const double rise = term[spline][lane];
    if (dim == 2) {
      out = (plane_sums){row.value, {row.growth}, {rise + out.rise[0]}};
      continue;
    }
    const mpsi_lanes w = mpsi_get_lanes(places->w[2][plane] + k);
    out.value += w * row.value;
    out.slope[0] += w * row.growth;
    out.slope[1] += mpsi_get_lanes(places->ws[2][plane] + k) * row.value;
    out.rise[0] += w * rise;
    out.rise[1] += mpsi_difference(spline, plane) * row.value;
  }
  return out;
}

#define EVERY_AXIS 3

/* Velocities, slopes and derivatives of MPSI_LANES particles, to `out` from `to` on: sums over
 * planes, then along x. Lanes beyond the last particle get zeros. The derivative along the axis
 * `plain` (-1: none) is the slope of the fit. */
MPSI_INLINE void gather_body(const mpsi_transfer *work, int dim, int spline, bool at_wall,
                             const lanes *of, int plain, mpsi_gathered *out, int to) {
  /* copies: stores of vectors may alias what is behind a pointer */
  const lanes own = *of;
  const double inverse = work->grid->inverse, scale = mpsi_inverse_moment(spline) * inverse;
  const double factorial = spline == 3 ? 6.0 : 2.0;
  const mpsi_places *places = own.places;
  const mpsi_node *lowest = own.rows->lowest;
  const int k = own.k;
  mpsi_lanes excess[3] = {{0.0}}; /* see mpsi_excess */
  MPSI_UNROLL for (int d = 0; d < dim; d++) excess[d] =
      inverse * mpsi_excess(spline, mpsi_get_lanes(places->t[d] + k));
  excess[1] *= factorial;
#pragma GCC unroll 1 /* all components would fill the instruction cache */
  for (int c = 0; c < dim; c++) {
    mpsi_lanes v = {0.0}, slope[3] = {{0.0}}, rise[3] = {{0.0}};
    MPSI_UNROLL for (int i = 0; i <= spline; i++) {
      const plane_sums sum = sum_plane(dim, spline, at_wall, &own, lowest, MPSI_VECTOR + c, i);
      const mpsi_lanes w = mpsi_get_lanes(places->w[0][i] + k);
      v += w * sum.value;
      slope[0] += mpsi_get_lanes(places->ws[0][i] + k) * sum.value;
      rise[0] += mpsi_difference(spline, i) * sum.value;
      MPSI_UNROLL for (int d = 1; d < dim; d++) {
        slope[d] += w * sum.slope[d - 1];
        rise[d] += w * sum.rise[d - 1];
      }
    }
    mpsi_put_lanes(out->v[c] + to, v);
    MPSI_UNROLL for (int d = 0; d < dim; d++) {
      const mpsi_lanes more = excess[d] * rise[d];
      slope[d] = d == 1 && !at_wall ? inverse * slope[d] - more : scale * slope[d];
      mpsi_put_lanes(out->slope[dim * c + d] + to, slope[d]);
      mpsi_put_lanes(out->derivative[dim * c + d] + to,
                     d == plain || plain == EVERY_AXIS ? slope[d] : slope[d] + more);
    }
  }
}

/* Arrays of a chunk, in the worker's scratch memory; the last two of a segment at a wall. */
typedef struct g2p_scratch {
  mpsi_places places;
  mpsi_gathered from, old; /* after and before the forces */
  mpsi_wall wall;
  mpsi_gathered along;
} g2p_scratch;
_Static_assert(sizeof(g2p_scratch) <= MPSI_WORKER_SCRATCH, "scratch of a worker");

/* Velocities, slopes and derivatives of a segment of at most MPSI_LANES particles at the wall
 * across `axis`, where the derivative across the wall is the slope of the fit. */
MPSI_INLINE void gather_wall_body(const mpsi_transfer *work, int dim, int spline,
                                  const mpsi_segment *segment, int axis, const polynomials *rows,
                                  mpsi_gathered *out) {
  const int k = segment->begin;
  const size_t bytes = (size_t)(segment->end - k) * sizeof(double);
  g2p_scratch *scratch = work->worker->scratch;
  mpsi_wall *wall = &scratch->wall;
  mpsi_gathered *along = &scratch->along;
  const lanes of = {&wall->places, 0, rows};
  for (int part = 0; part < 2; part++) {
    mpsi_wall_places(work, dim, spline, segment, axis,
                     part == 0 ? MPSI_WALL_ALONG : MPSI_WALL_SLOPE, wall);
    gather_body(work, dim, spline, true, &of, axis, part == 0 ? along : out, part == 0 ? 0 : k);
  }
  for (int c = 0; c < dim; c++)
    for (int d = 0; d < dim; d++) {
      if (d == axis) continue;
      memcpy(out->slope[dim * c + d] + k, along->slope[dim * c + d], bytes);
      memcpy(out->derivative[dim * c + d] + k, along->derivative[dim * c + d], bytes);
    }
}

/* Not inlined: each variant exists once in the code of a block. */
#define DEFINE_GATHER(dim, spline)                                                                 \
  MPSI_APART void gather_lanes_##dim##_##spline(const mpsi_transfer *work, const lanes *of,        \
                                                int plain, mpsi_gathered *out) {                   \
    gather_body(work, dim, spline, false, of, plain, out, of->k);                                  \
  }                                                                                                \
  MPSI_APART void gather_at_wall_##dim##_##spline(const mpsi_transfer *work,                       \
                                                  const mpsi_segment *segment, int axis,           \
                                                  const polynomials *rows, mpsi_gathered *out) {   \
    gather_wall_body(work, dim, spline, segment, axis, rows, out);                                 \
  }
DEFINE_GATHER(2, 2)
DEFINE_GATHER(2, 3)
DEFINE_GATHER(3, 2)
DEFINE_GATHER(3, 3)
/* The variant for a dimension and a degree of the spline, which are literal. */
#define OF_KIND(name, dim, spline)                                                                 \
  ((dim) == 2 ? (spline) == 2 ? name##_2_2 : name##_2_3 : (spline) == 2 ? name##_3_2 : name##_3_3)

/* The first `n` (at most 4) values of a vector. */
MPSI_INLINE void store_some(double *to, mpsi_quad v, int n) {
  if (n >= 4) {
    mpsi_put(to, v);
    return;
  }
  for (int i = 0; i < n; i++) to[i] = v[i];
}

/* Whether a particle that has moved is `outside` the domain or not finite; or has `left` its block
 * by more than a cell, so that its stencil would leave the tile. */
typedef struct moved {
  bool outside, left;
} moved;

/* The same of four particles, in the lanes. */
typedef struct moved_lanes {
  mpsi_mask outside, left;
} moved_lanes;

/* Limits, by axis, of the positions from the block's first node (cells): of the domain and of
 * particles whose stencil stays in the tile. */
typedef struct limits {
  double low[3], high[3], least[3], below[3];
} limits;

MPSI_INLINE void find_limits(const mpsi_grid *grid, const mpsi_cell_block *cells, int dim,
                             int spline, limits *out) {
  const double first = spline == 3 ? 1.0 : 0.5; /* least distance from the lowest node, cells */
  MPSI_UNROLL for (int c = 0; c < dim; c++) {
    const int reach = c == 0 ? 3 : spline; /* see widen_use in layout.c */
    const double corner = (double)cells->at[c] * MPSI_SIDE;
    out->low[c] = (double)grid->low[c] - corner;
    out->high[c] = (double)grid->high[c] - corner;
    out->least[c] = first + cells->low[c];
    out->below[c] = first + (cells->high[c] - reach);
  }
}

/* What moves the particles of a chunk, and how far. */
typedef struct motion {
  const mpsi_columns *p;
  const mpsi_gathered *from;
  int64_t chunk; /* its first particle */
  double dt;     /* s */
  mpsi_frame frame;
  limits within;
} motion;

/* Writes velocities and gradients of the `n` (at most 4) particles from number k on of a chunk, and
 * advances their positions, x += dt v. Sets the lanes that are outside the domain or have left the
 * block. */
MPSI_INLINE void move_four(const motion *m, int geometry, int k, int n, moved_lanes *out) {
  const int64_t at = m->chunk + k;
  const int dim = mpsi_dim_of(geometry);
  const mpsi_columns *p = m->p;
  const mpsi_gathered *from = m->from;
  const mpsi_mask there = (mpsi_mask){0, 1, 2, 3} < n;
  MPSI_UNROLL for (int c = 0; c < dim; c++) {
    const mpsi_quad v = mpsi_get(from->v[c] + k), x = mpsi_get_some(p->x[c] + at, n);
    const mpsi_quad to = x + m->dt * v, X = mpsi_in_frame(&m->frame, c, to);
    const mpsi_mask good = (X >= m->within.low[c]) & (X <= m->within.high[c]);
    const mpsi_mask here = (X >= m->within.least[c]) & (X < m->within.below[c]);
    out->outside |= there & ~good;
    out->left |= there & ~here;
    store_some(p->v[c] + at, v, n);
    if (geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && c == 0) store_some(p->L[4] + at, v / x, n);
    store_some(p->x[c] + at, to, n);
  }
  MPSI_UNROLL for (int a = 0; a < dim * dim; a++)
      store_some(p->L[a] + at, mpsi_get(from->slope[a] + k), n);
}

MPSI_INLINE moved move(const mpsi_transfer *work, int geometry, int spline, int64_t chunk, int n,
                       const mpsi_gathered *from) {
  const int dim = mpsi_dim_of(geometry);
  moved_lanes m = {{0}, {0}};
  motion by = {work->p,
               from,
               chunk,
               work->run->dt,
               mpsi_frame_of(work->grid, work->cells, dim),
               {{0.0}, {0.0}, {0.0}, {0.0}}};
  find_limits(work->grid, work->cells, dim, spline, &by.within);
  for (int k = 0; k < n; k += 4) {
    if (n - k >= 4) /* four lanes: no test in the loop */
      move_four(&by, geometry, k, 4, &m);
    else
      move_four(&by, geometry, k, n - k, &m);
  }
  return (moved){(m.outside[0] | m.outside[1] | m.outside[2] | m.outside[3]) != 0,
                 (m.left[0] | m.left[1] | m.left[2] | m.left[3]) != 0};
}

/* Adds the FLIP part of the velocities; positions follow the nodes alone. */
static void add_flip_part(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin, int n,
                          const mpsi_gathered *from) {
  for (int c = 0; c < grid->dim; c++)
    for (int k = 0; k < n; k++) p->v[c][begin + k] += from->own[c][k];
}

/* Nodes on a wall have its velocity, but the velocity fitted over them need not be zero at the wall
 * itself: a particle pressed against it slowly passes it. At a mirror it does not. */
#define BEYOND 0.1 /* cells: particles up to this far behind a wall are moved back to it */

/* For particles [begin, end), some of which are outside the domain: moves those slightly beyond a
 * wall back to it and marks the block (`gone`) for those beyond an open side, which are removed
 * after the step. Returns the first that is too far beyond a wall or not finite, or -1. No particle
 * is moved back to the axis of symmetry, where its hoop strain would be infinite. */
static int64_t keep_inside(const mpsi_grid *grid, const mpsi_columns *p,
                           const mpsi_boundaries *boundaries, mpsi_cell_block *cells, int64_t begin,
                           int64_t end) {
  int64_t bad = -1;
  for (int64_t k = begin; k < end; k++)
    for (int c = 0; c < grid->dim; c++) {
      double *x = &p->x[c][k];
      const double X = mpsi_grid_at(grid, c, *x);
      const double low = (double)grid->low[c], high = (double)grid->high[c];
      if (X >= low && X <= high) continue;
      if (mpsi_mpm_passes(grid, boundaries, c, X)) {
        cells->gone = true;
        continue;
      }
      const bool axis = grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && c == 0 && !(*x > 0.0);
      if (axis || !(X >= low - BEYOND && X <= high + BEYOND)) {
        if (bad < 0) bad = k;
        break;
      }
      const double wall = X < low ? low : high, inwards = X < low ? INFINITY : -INFINITY;
      *x = grid->origin[c] + grid->cell * wall;
      while ((mpsi_grid_at(grid, c, *x) - wall) * inwards < 0.0) *x = nextafter(*x, inwards);
    }
  return bad;
}

/* Largest of `n` values (c + |v|)^2, at most a chunk, in an array with room for three more; false
 * where one is not finite. */
MPSI_INLINE bool find_largest(int n, double *square, double *out) {
  mpsi_quad largest = {0.0};
  mpsi_mask good = {-1, -1, -1, -1};
  for (int i = 0; i < 3; i++) square[n + i] = 0.0;
  for (int k = 0; k < n; k += 4) {
    const mpsi_quad own = mpsi_get(square + k);
    const mpsi_mask larger = own > largest;
    largest = (mpsi_quad)(((mpsi_mask)own & larger) | ((mpsi_mask)largest & ~larger));
    good &= own <= 1.7e308; /* not of a NaN */
  }
  *out = fmax(fmax(largest[0], largest[1]), fmax(largest[2], largest[3]));
  return (good[0] & good[1] & good[2] & good[3]) != 0;
}

#define FASTEST 1e100 /* m/s: limit that keeps kinetic energies finite */

/* Largest c + |v| of particles [begin, begin + n), at most a chunk, to cells->speed; from the
 * square c^2 + v^2 + 2 c |v|, which takes one root less. Adds sum m v^2 to cells->vis_viva. A
 * particle with a negative volume, or a speed that is not finite or beyond FASTEST, becomes
 * cells->bad. */
MPSI_INLINE void find_speed(const mpsi_columns *p, const mps_mpm_def *def, mpsi_cell_block *cells,
                            int dim, int64_t begin, int n, const double *moduli) {
  const double *v0 = p->v[0] + begin, *v1 = p->v[1] + begin, *v2 = dim == 3 ? p->v[2] + begin : v1;
  const double *V = p->V + begin, *m = p->m + begin;
  const double moving = def->step_from == MPS_MPM_STEP_FROM_SPEED ? 1.0 : 0.0;
  double square[MPSI_COLUMN] MPSI_LINE, largest, sum = 0.0;
  MPSI_SIMD_SUM(sum) for (int k = 0; k < n; k++) {
    double v = v0[k] * v0[k] + v1[k] * v1[k];
    if (dim == 3) v += v2[k] * v2[k];
    sum += m[k] * v;
    const double c = (moduli ? moduli[k] : p->laws.law[0].modulus) * V[k] / m[k];
    square[k] =
        ((c < 0.0) | !(v <= FASTEST * FASTEST)) ? NAN : c + moving * (v + 2.0 * sqrt(c * v));
  }
  cells->vis_viva += sum;
  const bool good = find_largest(n, square, &largest);
  if (largest > cells->speed * cells->speed) cells->speed = sqrt(largest);
  for (int k = 0; k < n && !good && (cells->bad < 0 || cells->lost); k++)
    if (!isfinite(square[k])) cells->bad = begin + k, cells->lost = false;
}

MPSI_INLINE void speed_chunk(const mpsi_transfer *work, int dim, int64_t begin, int n) {
  if (work->p->laws.one_modulus) {
    find_speed(work->p, work->def, work->cells, dim, begin, n, NULL);
    return;
  }
  double moduli[MPSI_CHUNK];
  mpsi_pore_speeds pores;
  mpsi_mpm_find_moduli(work->grid, work->p, work->water, work->run, work->def, begin, begin + n,
                       moduli, &pores);
  work->cells->flow = fmax(work->cells->flow, pores.flow);
  work->cells->wave = fmax(work->cells->wave, pores.wave);
  find_speed(work->p, work->def, work->cells, dim, begin, n, moduli);
}

/* Velocities and gradients of a segment. The last arguments are literal: each has its own code. */
MPSI_INLINE void gather_segment(const mpsi_transfer *work, int dim, int spline,
                                const mpsi_segment *segment, mpsi_gathered *out) {
  const mpsi_cell_block *cells = work->cells;
  const int32_t first = segment->places->first[segment->begin];
  polynomials rows;
  find_polynomials(dim, spline, (const mpsi_node *)work->worker->tile + first, &rows);
  const uint32_t state = cells->cut ? mpsi_support_state(work->worker, dim, spline, first) : 0;
  const int axis = state ? mpsi_wall_axis(work->grid, cells, dim, spline, state, first) : -1;
  lanes of = {segment->places, segment->begin, &rows};
  if (!cells->light && axis >= 0) {
    for (mpsi_segment part = *segment; part.begin < segment->end; part.begin = part.end) {
      const int left = segment->end - part.begin;
      part.end = part.begin + (left < MPSI_LANES ? left : MPSI_LANES);
      OF_KIND(gather_at_wall, dim, spline)(work, &part, axis, &rows, out);
    }
  } else if (!cells->light && !state) {
    for (; of.k < segment->end; of.k += MPSI_LANES)
      OF_KIND(gather_lanes, dim, spline)(work, &of, -1, out);
  } else if (!MPSI_LEVELLED(mpsi_mpm_gather_cut)(work, segment, out)) {
    for (; of.k < segment->end; of.k += MPSI_LANES)
      OF_KIND(gather_lanes, dim, spline)(work, &of, EVERY_AXIS, out);
  }
}

/* Borders of cells on which particle k of a chunk lies, two bits an axis: 0 that below, 1 none, 2
 * that above. */
MPSI_INLINE int32_t borders_of(const mpsi_places *places, int dim, int spline, int k) {
  const double least = spline == 3 ? 1.0 : 0.5;
  int32_t border = 0;
  for (int c = 0; c < dim; c++) {
    const double t = places->t[c][k] - least;
    border |= (int32_t)(1 - (t < MPSI_ON_BORDER) + (t > 1.0 - MPSI_ON_BORDER)) << 2 * c;
  }
  return border;
}

/* Place of a particle in an undrained step of pore water (water.h). */
MPSI_INLINE uint16_t pore_place(const mpsi_places *places, int dim, int spline, int k) {
  int32_t border = borders_of(places, dim, spline, k), code = 0;
  for (int c = 0, by = 1; c < dim; c++, border >>= 2, by *= 3)
    code += by * ((border & 3) == 0 ? 2 : (border & 3) - 1);
  return (uint16_t)(places->first[k] + MPSI_PORE_PLACES * code);
}

/* Stencils of the particles of a chunk, with the borders of cells on which they lie. */
MPSI_INLINE void keep_stencils(const mpsi_places *places, int dim, int spline,
                               const mpsi_columns *p) {
  int32_t *stencil = p->stencil + places->chunk;
  for (int k = 0; k < places->count; k++)
    stencil[k] = places->first[k] | borders_of(places, dim, spline, k) << MPSI_STENCIL_BITS;
  for (int c = 0; c < dim; c++)
    memcpy(p->t[c] + places->chunk, places->t[c], (size_t)places->count * sizeof *p->t[c]);
}

/* Velocities and gradients of particles [begin, begin + n), one segment after the other. */
MPSI_INLINE void gather_chunk(const mpsi_transfer *work, int dim, int spline, int64_t begin, int n,
                              mpsi_gathered *out) {
  g2p_scratch *scratch = work->worker->scratch;
  mpsi_places *places = &scratch->places;
  /* weights of x and z; the sums along y are polynomials */
  mpsi_find_places(work, dim, spline, 5, 5, begin, n, places);
  mpsi_pad_places(dim, spline, 5, n, places);
  for (int k = 0; work->water && k < n; k++)
    work->water->place[begin + k] = pore_place(places, dim, spline, k);
  if (work->p->stencil) keep_stencils(places, dim, spline, work->p);
  for (int k = 0, end; k < n; k = end) {
    for (end = k + 1; end < n && places->first[end] == places->first[k];) end++;
    const mpsi_segment segment = {places, k, end};
    gather_segment(work, dim, spline, &segment, out);
  }
  if (work->grid->strain_by_fit) memcpy(out->derivative, out->slope, sizeof out->slope);
}

/* The work with the tiles of forces, of which the scatter has made use, in place of those of
 * velocities, to gather the velocities before the forces. */
static mpsi_transfer before_forces(const mpsi_transfer *work, mpsi_worker *worker) {
  mpsi_transfer before = *work;
  *worker = *work->worker;
  worker->tile = work->worker->force;
  worker->across_tile = work->worker->across_force;
  before.worker = worker;
  before.before = true;
  return before;
}

/* FLIP part of the velocities of particles [begin, begin + n): what the nodes before the forces do
 * not give back of them, of which a step keeps the same fraction for all, so that momentum is
 * conserved. */
MPSI_INLINE void find_flip_part(const mpsi_transfer *work, int dim, int spline, int64_t begin,
                                int n, mpsi_gathered *out) {
  mpsi_worker worker;
  mpsi_gathered *old = &((g2p_scratch *)work->worker->scratch)->old;
  const mpsi_transfer before = before_forces(work, &worker);
  gather_chunk(&before, dim, spline, begin, n, old);
  for (int c = 0; c < dim; c++)
    for (int k = 0; k < n; k++)
      out->own[c][k] = work->keep * (work->p->v[c][begin + k] - old->v[c][k]);
}

MPSI_INLINE void g2p_chunk(const mpsi_transfer *work, int geometry, int spline, int64_t begin,
                           int n, const mpsi_law_block *laws) {
  const int dim = mpsi_dim_of(geometry);
  mpsi_gathered *from = &((g2p_scratch *)work->worker->scratch)->from;
  double *D[9];
  gather_chunk(work, dim, spline, begin, n, from);
  if (work->keep > 0.0) find_flip_part(work, dim, spline, begin, n, from);
  for (int a = 0; a < dim * dim; a++) {
    D[a] = from->derivative[a];
    if (work->p->D[a]) memcpy(work->p->D[a] + begin, D[a], (size_t)n * sizeof *D[a]);
  }
  if (work->energy->counts)
    mpsi_mpm_energy_before(work->grid, work->p, work->energy, work->cells, begin, begin + n);
  const moved m = move(work, geometry, spline, begin, n, from);
  if (work->energy->counts)
    mpsi_mpm_energy_moved(work->grid, work->p, work->energy, work->def, work->run->dt, work->cells,
                          begin, begin + n);
  if (work->grid->flip > 0.0 || work->keep > 0.0)
    add_flip_part(work->grid, work->p, begin, n, from);
  if (m.left) work->cells->left = true;
  if (m.outside) {
    const int64_t bad =
        keep_inside(work->grid, work->p, work->boundaries, work->cells, begin, begin + n);
    if (work->cells->bad < 0 && bad >= 0) work->cells->bad = bad, work->cells->lost = true;
  }
  if (work->energy->counts)
    mpsi_mpm_energy_after(work->grid, work->p, work->energy, work->cells, begin, begin + n);
  if (!work->p->laws.at_once) return; /* the laws need means of volumetric.c or filter.c first */
  double former[MPSI_CHUNK];
  const bool responds = mpsi_pore_responds(work->water);
  if (responds) memcpy(former, work->p->V + begin, (size_t)n * sizeof *former);
  mpsi_mpm_apply_law(laws, begin, begin + n, D, NULL);
  if (responds) {
    const bool hoop = geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC;
    const double *const rate[3] = {D[0], D[dim + 1],
                                   dim == 3 ? D[8]
                                   : hoop   ? work->p->L[4] + begin
                                            : NULL};
    mpsi_mpm_follow_motion(work->p, work->run->dt, rate, begin, n, former);
    MPSI_LEVELLED(mpsi_pore_strain)(work, former, begin, n);
  }
  speed_chunk(work, dim, begin, n);
}

/* Whether some node under the block retains momentum that is returned to its particles:
 * MPSI_LEAST_MASS in blocks.h. */
static bool is_light(const mpsi_grid *grid, const mpsi_cell_block *cells) {
  bool any = false;
  for (int q = 0; q < 1 << grid->dim; q++) {
    const mpsi_node_block *nodes = &grid->nodes[cells->to[q]];
    any = any || nodes->light || (nodes->across >= 0 && grid->nodes[nodes->across].light);
  }
  return any;
}

/* Tiles of the velocities before the forces, where those of the forces were. */
static void gather_before(const mpsi_transfer *work) {
  mpsi_worker worker;
  const mpsi_transfer before = before_forces(work, &worker);
  const mpsi_cell_block *cells = work->cells;
  gather_tile(work->grid, cells, false, true, worker.tile);
  if (cells->thin) gather_tile(work->grid, cells, true, true, worker.across_tile);
  if (cells->mirrors) mpsi_mpm_unfold(&before);
}

MPSI_INLINE void g2p_body(const mpsi_transfer *work, int geometry, int spline) {
  mpsi_cell_block *cells = work->cells;
  const mpsi_worker *worker = work->worker;
  mps_material_block seen;
  const mpsi_law_block laws = {work->grid, work->p, work->run, work->energy, cells, &seen};
  mpsi_mpm_begin_block(&seen);
  cells->left = cells->gone = cells->lost = false;
  cells->light = is_light(work->grid, cells);
  cells->bad = -1;
  cells->speed = cells->flow = cells->wave = cells->vis_viva = 0.0;
  gather_tile(work->grid, cells, false, false, worker->tile);
  if (cells->thin) gather_tile(work->grid, cells, true, false, worker->across_tile);
  if (cells->mirrors) mpsi_mpm_unfold(work);
  if (work->keep > 0.0) gather_before(work);
  if (cells->cut || cells->light) mpsi_mpm_find_states(work);
  const bool responds = mpsi_pore_responds(work->water) && work->p->laws.at_once;
  if (responds) MPSI_LEVELLED(mpsi_pore_begin_block)(work);
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int n = cells->end - k < MPSI_CHUNK ? (int)(cells->end - k) : MPSI_CHUNK;
    g2p_chunk(work, geometry, spline, k, n, &laws);
  }
  if (responds) MPSI_LEVELLED(mpsi_pore_respond)(work);
}

/* ---- variants -------------------------------------------------------------------------------- */

#define DEFINE(g, s, geometry, spline)                                                             \
  static void g2p_##g##_##s(const mpsi_transfer *work) { g2p_body(work, geometry, spline); }
MPSI_VARIANTS(DEFINE)

#define ENTRY(g, s, geometry, spline) [geometry][spline - 2] = g2p_##g##_##s,
const mpsi_transfer_fn MPSI_LEVELLED(mpsi_mpm_g2p)[3][2] = {MPSI_VARIANTS(ENTRY)};

void MPSI_LEVELLED(mpsi_mpm_speed)(const mpsi_transfer *work) {
  mpsi_cell_block *cells = work->cells;
  if (!cells->lost) cells->bad = -1;
  cells->speed = cells->flow = cells->wave = cells->vis_viva = 0.0;
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int n = cells->end - k < MPSI_CHUNK ? (int)(cells->end - k) : MPSI_CHUNK;
    speed_chunk(work, work->grid->dim, k, n);
  }
}
