/* flap.h - an elastic flap in 2D that stands on the ground, held at its foot, with the facets above
 * that a fluid loads. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/app.h"

#include <mps/elastic.h>

typedef struct flap_def {
  double x, y;                    /* m: the middle of its foot */
  double width, height, spacing;  /* m; whole spacings */
  double young, poisson, density; /* Pa, 1, kg/m3 */
  double bending;                 /* mps_elastic_def.bending */
  double dt;                      /* s */
} flap_def;

typedef struct flap {
  mps_particles *particles;
  mps_elastic *solver;
  int64_t *facets; /* sides and top */
  int64_t facet_count;
  int64_t tip; /* id of a particle at the top */
} flap;

/* Makes it, at rest, with its motion started. False, with an error line, on a failure; flap_free it
 * in any case. */
bool flap_make(app *a, const flap_def *def, flap *out);
void flap_free(flap *f);
/* Displacement of the tip (m): x, y. */
bool flap_tip(app *a, const flap *f, double *u);
