/* assemble.h - the sparse matrix of the free unknowns.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* Rows of the particles [from, to) of the order of layers: all directions of each. */
typedef struct mpsi_elastic_rows {
  int64_t from, to;
  int64_t *start;
  int32_t *column;
  double *value;
} mpsi_elastic_rows;

/* ---- assemble.c ------------------------------------------------------------------------------ */
mps_status mpsi_elastic_assemble(mps_elastic *e, const char *function);
/* Whole rows of K + shift M with numbered unknowns, whose arrays become the caller's (also on an
 * error); fixed directions have a diagonal alone. */
mps_status mpsi_elastic_assemble_rows(mps_elastic *e, const char *function, double shift,
                                      mpsi_elastic_rows *rows);
/* Without a matrix: numbers the unknowns and allocates their vectors. */
mps_status mpsi_elastic_make_vectors(mps_elastic *e, const char *function);
