/* facets.h - faces of cells on the surface of the body.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

typedef struct mpsi_facet {
  int64_t particle;
  int8_t axis, side;
} mpsi_facet;

/* ---- facets.c -------------------------------------------------------------------------------- */
mps_status mpsi_elastic_find_facets(mps_elastic *e, const char *function);
/* The cell of particle i reaches from low to high (relative to the particle) along `axis`. */
void mpsi_elastic_reach(const mps_elastic *e, int64_t i, int axis, double *low, double *high);
/* The middle of the facet (m, 3 components). */
void mpsi_elastic_facet_centre(const mps_elastic *e, const mpsi_facet *f, double *centre);
/* The facet as a box relative to its particle. */
void mpsi_elastic_facet_box(const mps_elastic *e, const mpsi_facet *f, double *low, double *high);
