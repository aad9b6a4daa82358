/* bending.h - bending within a cell.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

#include <stdbool.h>

/* ---- bending.c ------------------------------------------------------------------------------- */
#define MPSI_BENDING_MAX 48 /* terms of a row: 12 squares of 4 corners */

typedef struct mpsi_bending_term {
  int64_t site;
  double value[3]; /* couples equal components */
} mpsi_bending_term;

/* Is bending stiffness in use, in a body with joints or without? Its array, of this size, is made
 * with them (joints.c). */
bool mpsi_elastic_has_bending(const mps_elastic *e, bool joints);
int64_t mpsi_elastic_bending_size(const mps_elastic *e);
/* Stiffnesses of squares, from volumes and material. */
void mpsi_elastic_measure_bending(mps_elastic *e);
/* f += the forces of squares on particle p under the displacements u. */
void mpsi_elastic_bending_force(const mps_elastic *e, const double *u, int64_t p, double *f);
/* The row of particle p; the number of terms, of which several may have the same site. */
int32_t mpsi_elastic_bending_row(const mps_elastic *e, int64_t p, mpsi_bending_term *terms);
