/* lattice.h - sites of the lattice and their neighbours, n_i, the plain gradient; parallel loops
 * over particles. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "implicit/ranks/partition.h"

#include <mps/elastic.h>

#include <stdbool.h>

#define MPSI_STENCIL_MAX 64 /* sites of one gradient: a disc of radius < 4 has 45 */

/* Neighbours on the lattice, by offset. */
typedef struct mpsi_links {
  int32_t count;      /* offsets shorter than re; offset k and count - 1 - k are opposite */
  int32_t (*step)[3]; /* lattice units */
  double *weight;     /* w(r) */
  double *r2;         /* r^2, m2 */
  bool *far;          /* more than one cell along some axis */
  int32_t face[3][2]; /* which offset is one step down (0) or up (1) along an axis */
  int64_t *to;        /* to[slot * count + k]: the neighbour of the window's particle, or -1 */
} mpsi_links;

/* Opens the window and fills links, density and density0 from x, with the other arrays of the
 * operator; errors are reported for `function`. */
mps_status mpsi_elastic_connect(mps_elastic *e, const char *function);
void mpsi_elastic_disconnect(mps_elastic *e);
/* Clears the pointers of both windows and of joints, which have been moved to another object. */
void mpsi_elastic_lose_window(mps_elastic *e);
/* Neighbours across faces of all particles, on any rank, by a temporary table of sites. */
typedef struct mpsi_sites mpsi_sites;
mps_status mpsi_elastic_open_sites(mps_elastic *e, const char *function, mpsi_sites **out);
void mpsi_elastic_close_sites(mps_elastic *e, mpsi_sites *sites);
int64_t mpsi_elastic_beside(const mpsi_sites *sites, int64_t i, int axis, int up);
/* n*_i of the published method: n_i, or n0. */
double mpsi_elastic_divisor(const mps_elastic *e, int64_t i);
/* Coefficient (a vector of dim values, 1/m) of neighbour k in the gradient at i. */
void mpsi_elastic_coefficient(const mps_elastic *e, int64_t i, int32_t k, double *g);
/* All sites of the plain gradient at i: G_i u = sum_a u[site a] (x) g[a]; site 0 is i itself. Face
 * values are means: joints come on top. */
int32_t mpsi_elastic_stencil(const mps_elastic *e, int64_t i, int64_t *sites, double (*g)[3]);
/* work(task, k) for all k of [0, count), chunk by chunk in parallel; and for all
 * particles of a span. */
typedef void (*mpsi_elastic_work)(void *task, int64_t k);
void mpsi_elastic_for_each(mps_elastic *e, int64_t count, mpsi_elastic_work work, void *task);
void mpsi_elastic_for_span(mps_elastic *e, mpsi_span span, mpsi_elastic_work work, void *task);
