/* layout.h - order of the particles in memory, and the search for their pairs.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mesh.h"

/* The geometry that pairs are made of. Arrays have one value a particle. */
typedef struct mpsi_dynamics_geometry {
  int64_t count;
  const double *x, *y; /* reference positions, m */
  const int64_t *side; /* 0 the body, 1 or 2 a free-field column (mps_side); NULL: no column */
  double spacing;      /* D, m */
  double radius;       /* re, m */
  double period_x;     /* m, 0: none */
  const double *edge;  /* x of the body's outermost particles, m; NULL: of those given here */
} mpsi_dynamics_geometry;

/* The strips of rows that a body of these bounds is laid out in. */
typedef struct mpsi_dynamics_rows {
  double lo[2], spacing; /* m */
  int32_t fast;          /* 1: rows run along y */
  int64_t strips, width; /* lattice cells in a row of a strip */
  int64_t rows;
} mpsi_dynamics_rows;
mpsi_dynamics_rows mpsi_dynamics_layout_rows(const double *lo, const double *hi, double spacing);
/* Number of a place of the body in that order; particles at the same place come by their ids. */
int64_t mpsi_dynamics_layout_key(const mpsi_dynamics_rows *rows, double x, double y);

/* Writes to order[k] the old index of the particle that comes k-th: the body in strips of rows
 * along its longer direction, then the columns from the bottom up. False: out of memory. */
bool mpsi_dynamics_layout_order(mps_context *context, const mpsi_dynamics_geometry *geometry,
                                int64_t *order);

/* Finds all pairs of sorted particles: of the body, of each column with its periodic copies, and
 * the forces of the column on the edge beside it. `pairs` receives an array for mpsi_free. Errors
 * carry `function`. `distinct` receives the number of ordinary pairs. `keep` NULL: all; else by
 * particle: only pairs of the body with a marked end. */
mps_status mpsi_dynamics_layout_pairs(mps_context *context, const char *function,
                                      const mpsi_dynamics_geometry *geometry, const uint8_t *keep,
                                      int64_t *count, mpsi_dynamics_pair **pairs,
                                      int64_t *distinct);

/* For each particle of a column (index as sorted) the edge particle of the same row, else -1. */
mps_status mpsi_dynamics_layout_edges(mps_context *context, const char *function,
                                      const mpsi_dynamics_geometry *geometry, int64_t *edge);
