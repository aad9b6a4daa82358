/* search.c - searches over the particles of a block, four at once: particles that may be near a
 * body, by bounds from the last foot found (constraints.c); particles in cells with corners in
 * bodies (inside.c). Compiled once for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/loops.h"

double MPSI_LEVELLED(mpsi_mpm_fastest)(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin,
                                       int64_t end) {
  mpsi_quad largest = {0.0};
  for (int64_t k = begin; k < end; k += 4) {
    mpsi_quad square = {0.0};
    for (int c = 0; c < grid->dim; c++) {
      const mpsi_quad v = mpsi_get_some(p->v[c] + k, end - k < 4 ? (int)(end - k) : 4);
      square += v * v;
    }
    const mpsi_mask larger = square > largest;
    largest = (mpsi_quad)(((mpsi_mask)square & larger) | ((mpsi_mask)largest & ~larger));
  }
  return sqrt(fmax(fmax(largest[0], largest[1]), fmax(largest[2], largest[3])));
}

/* Lanes of particles that the bounds do not exclude. */
MPSI_INLINE mpsi_mask may_be_near(const mpsi_columns *p, int dim, const mpsi_far *far, int64_t k,
                                  int n) {
  mpsi_quad square = {0.0}, before = {0.0};
  for (int c = 0; c < dim; c++) {
    const mpsi_quad x = mpsi_get_some(p->x[c] + k, n), from = x - far->x[c];
    square += from * from;
    before += (x - far->at[c]) * far->normal[c];
  }
  return ~((square < far->square) | (before > far->before)) & ((mpsi_mask){0, 1, 2, 3} < n);
}

MPSI_INLINE int64_t next_near(const mpsi_columns *p, int dim, const mpsi_far *far, int64_t begin,
                              int64_t end) {
  for (int64_t k = begin; k < end; k += 4) {
    const int n = end - k < 4 ? (int)(end - k) : 4;
    const mpsi_mask near = may_be_near(p, dim, far, k, n);
    if (!(near[0] | near[1] | near[2] | near[3])) continue;
    for (int l = 0; l < 4; l++)
      if (near[l]) return k + l;
  }
  return end;
}

int64_t MPSI_LEVELLED(mpsi_mpm_next_near)(const mpsi_grid *grid, const mpsi_columns *p,
                                          const mpsi_far *far, int64_t begin, int64_t end) {
  return grid->dim == 3 ? next_near(p, 3, far, begin, end) : next_near(p, 2, far, begin, end);
}

/* Lanes of particles that may be in cells low to high - 1 of each axis; the axis `slim`, whose
 * range is shortest, is tested first. A particle on the upper side of the domain or beyond counts
 * to the last cell. */
MPSI_INLINE mpsi_mask may_be_in(const mpsi_grid *grid, const mpsi_columns *p,
                                const mpsi_cell_block *cells, int dim, int slim, const int *low,
                                const int *high, int64_t k, int n) {
  const double slack = 1e-6; /* margin for round-off: the caller checks again */
  mpsi_mask in = (mpsi_mask){0, 1, 2, 3} < n;
  for (int a = 0; a < dim && (in[0] | in[1] | in[2] | in[3]); a++) {
    const int c = slim + a < dim ? slim + a : slim + a - dim;
    const int64_t last = grid->high[c] - 1 - (int64_t)cells->at[c] * MPSI_SIDE;
    const mpsi_quad X = mpsi_from_block(grid, cells, c, mpsi_get_some(p->x[c] + k, n));
    in &= (X > (low[c] > last ? (double)last : (double)low[c]) - slack) &
          (X < (high[c] > last ? INFINITY : high[c] + slack));
  }
  return in;
}

MPSI_INLINE int64_t next_in(const mpsi_grid *grid, const mpsi_columns *p,
                            const mpsi_cell_block *cells, int dim, const int *low, const int *high,
                            int64_t begin) {
  int slim = 0;
  for (int c = 1; c < dim; c++)
    if (high[c] - low[c] < high[slim] - low[slim]) slim = c;
  for (int64_t k = begin; k < cells->end; k += 4) {
    const int n = cells->end - k < 4 ? (int)(cells->end - k) : 4;
    const mpsi_mask in = may_be_in(grid, p, cells, dim, slim, low, high, k, n);
    if (!(in[0] | in[1] | in[2] | in[3])) continue;
    for (int l = 0; l < 4; l++)
      if (in[l]) return k + l;
  }
  return cells->end;
}

int64_t MPSI_LEVELLED(mpsi_mpm_next_in)(const mpsi_grid *grid, const mpsi_columns *p,
                                        const mpsi_cell_block *cells, const int *low,
                                        const int *high, int64_t begin) {
  return grid->dim == 3 ? next_in(grid, p, cells, 3, low, high, begin)
                        : next_in(grid, p, cells, 2, low, high, begin);
}
