/* supports.h - fixed directions of particles, and the numbers of the free unknowns.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

#include <stdbool.h>

/* The supports of one particle: rows normal . u = value, of unit length. `basis` has the fixed
 * directions first, then free ones, all orthonormal; `fixed` are displacement, velocity and
 * acceleration along the first `count`. */
typedef struct mpsi_support {
  int64_t particle;
  int32_t count;
  int32_t owner[3];  /* boundary of the row */
  int32_t signal[3]; /* component of the owner's motion */
  double normal[3][3], offset[3];
  double basis[3][3]; /* basis[c] is direction c */
  double fixed[3][3]; /* [derivative][direction] */
} mpsi_support;

/* Adds the row normal . u to the support of a particle, or replaces a parallel one. False: the
 * direction is fixed already by the others. */
bool mpsi_elastic_add_row(mpsi_support *s, int dim, const double *normal, double offset,
                          int32_t owner, int32_t signal);
/* Length of row r along direction c of its basis. */
double mpsi_elastic_row(const mpsi_support *s, int32_t r, int32_t c);
/* Numbers the free unknowns. */
void mpsi_elastic_number(mps_elastic *e);
/* Unit vector of local direction c of particle i. */
void mpsi_elastic_direction(const mps_elastic *e, int64_t i, int32_t c, double *out);
/* u += the prescribed displacements (prescribed true), and those of the free unknowns. */
void mpsi_elastic_expand(const mps_elastic *e, const double *free_values, bool prescribed,
                         double *u);
/* Replaces the components along fixed directions by those prescribed: displacements (derivative
 * 0), velocities (1), accelerations (2). */
void mpsi_elastic_impose(const mps_elastic *e, int derivative, double *values);
/* The free components of a vector over all particles. */
void mpsi_elastic_reduce(const mps_elastic *e, const double *f, double *free_values);
/* Keeps only the components of f along fixed directions. */
void mpsi_elastic_keep_fixed(const mps_elastic *e, double *f);
