/* near.c - which particles of a block may be near a body, four at once: what the last foot that was
 * found tells of the others (touches.c). Compiled once for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "loops.h"

double MPSI_LEVELLED(mpsi_mpm_fastest)(const mps_mpm *mpm, int64_t begin, int64_t end) {
  mpsi_quad largest = {0.0};
  for (int64_t k = begin; k < end; k += 4) {
    mpsi_quad square = {0.0};
    for (int c = 0; c < mpm->dim; c++) {
      const mpsi_quad v = mpsi_get_some(mpm->p.v[c] + k, end - k < 4 ? (int)(end - k) : 4);
      square += v * v;
    }
    const mpsi_mask larger = square > largest;
    largest = (mpsi_quad)(((mpsi_mask)square & larger) | ((mpsi_mask)largest & ~larger));
  }
  return sqrt(fmax(fmax(largest[0], largest[1]), fmax(largest[2], largest[3])));
}

/* Lanes of particles that may be near. */
MPSI_INLINE mpsi_mask may_be_near(const mps_mpm *mpm, int dim, const mpsi_far *far, int64_t k,
                                  int n) {
  mpsi_quad square = {0.0}, before = {0.0};
  for (int c = 0; c < dim; c++) {
    const mpsi_quad x = mpsi_get_some(mpm->p.x[c] + k, n), from = x - far->x[c];
    square += from * from;
    before += (x - far->at[c]) * far->normal[c];
  }
  return ~((square < far->square) | (before > far->before)) & ((mpsi_mask){0, 1, 2, 3} < n);
}

MPSI_INLINE int64_t next_near(const mps_mpm *mpm, int dim, const mpsi_far *far, int64_t begin,
                              int64_t end) {
  for (int64_t k = begin; k < end; k += 4) {
    const int n = end - k < 4 ? (int)(end - k) : 4;
    const mpsi_mask near = may_be_near(mpm, dim, far, k, n);
    if (!(near[0] | near[1] | near[2] | near[3])) continue;
    for (int l = 0; l < 4; l++)
      if (near[l]) return k + l;
  }
  return end;
}

int64_t MPSI_LEVELLED(mpsi_mpm_next_near)(const mps_mpm *mpm, const mpsi_far *far, int64_t begin,
                                          int64_t end) {
  return mpm->dim == 3 ? next_near(mpm, 3, far, begin, end) : next_near(mpm, 2, far, begin, end);
}
