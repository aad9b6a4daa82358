/* corner.h - where a body bears a particle whose edges and corners are rounded by a radius that
 * the grid can show: docs/theory/contact.md derives it. The rounded body is that which a ball of
 * this radius sweeps out inside the body; faces stay where they are.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body/body_internal.h"

typedef struct mpsi_bearing {
  mpsi_foot foot; /* on the rounded body; beside a corner that would let the particle into the body
                     itself, on that */
  double half; /* m, how far the particle keeps off it: half its size; off the body itself less */
  double outside; /* m, of the body itself */
} mpsi_bearing;

/* Where the body bears a particle of half size `half` (m) at x, whose own foot of x is `own`. A
 * `radius` (m) of 0 leaves the corners as they are. Costs a search for another foot, and beside a
 * corner one for each of its faces. */
mpsi_bearing mpsi_corner_bearing(const mps_body *body, double radius, const double *x, double half,
                                 const mpsi_foot *own);
