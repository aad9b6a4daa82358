/* strip.h - a rectangular elastic structure with water on one of its faces, in plane strain: the
 * wall of mps-seawall, the plate of mps-tank.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

#include <stdbool.h>

/* Edges, or-ed. */
enum { STRIP_LEFT = 1, STRIP_RIGHT = 2, STRIP_BOTTOM = 4, STRIP_TOP = 8 };

typedef struct strip_def {
  double lower[2], upper[2];      /* m: the rectangle, whole spacings along both axes */
  double spacing;                 /* m */
  double young, poisson, density; /* Pa, -, kg/m3 */
  bool published;                 /* as Chikazawa (10): whole cells, one process */
  int clamped; /* STRIP_...: particles lie on these edges, half of their cells cut off, and are held
                */
  int level;   /* STRIP_...: particles lie on these edges and are cut, but free */
  int wet;     /* STRIP_...: one */
  mps_domain *domain; /* ranks that all make it, borrowed; NULL: one process */
} strip_def;

typedef struct strip {
  strip_def def;
  mps_particles *set;
  mps_elastic *solver;
  int64_t count;         /* of facets on the wet face, from the left or from below */
  int64_t *facet;        /* their numbers */
  double *centre;        /* 3 a facet, m */
  double *area;          /* m2, of 1 m thickness */
  double *given;         /* Pa, 3 a facet: the tractions of the last strip_load */
  int32_t load, support; /* numbers of the solver */
} strip;

mps_status strip_make(mps_context *context, const strip_def *def, strip *out);
void strip_free(strip *s);
/* Pressure (Pa, on the structure) on each wet facet from now on. */
mps_status strip_load(strip *s, const double *pressure);
/* Mean of component c of the displacement (m) of the particles in a box. */
mps_status strip_displacement(strip *s, const double *lower, const double *upper, int c,
                              double *mean);
