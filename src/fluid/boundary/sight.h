/* sight.h - visibility of neighbours past walls that end.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

#include <stdbool.h>

void mpsi_fluid_find_limits(mps_fluid *fluid);
int64_t mpsi_fluid_keep_visible(const mps_fluid *fluid, int64_t i, int64_t count, int32_t *index,
                                double *r2);
/* Whether a corner of a body, in the water, is within 1.5 l0 of particle i. */
bool mpsi_fluid_near_corner(const mps_fluid *fluid, int64_t i);
/* Whether a corner of a body is within `reach` (m) of particle i. */
bool mpsi_fluid_within(const mps_fluid *fluid, int64_t i, double reach);
/* Whether the water rushes past a body within `reach` (m) of particle i: 1 where its speed
 * relative to the body limits the step, 0 below half of that. */
double mpsi_fluid_rush(const mps_fluid *fluid, int64_t i, double reach);
/* The same past a body under water, away from walls and others, from a lower speed on. */
double mpsi_fluid_rush_below(const mps_fluid *fluid, int64_t i, double reach);
/* Where the sight of particle i passes a face towards an image in it: distance (m) along the face
 * from its nearer end; infinite where no end is a corner. The same from the parent to i's image. */
double mpsi_fluid_past_corner(const mps_fluid *fluid, int64_t i, int64_t ghost);
/* Whether an acute corner of the water is within 3.1 l0 of particle i, and within 60 degrees of the
 * direction e, unless that is NULL. */
bool mpsi_fluid_near_wedge(const mps_fluid *fluid, int64_t i, const double *e);
/* Whether an acute corner of the water is within 3.1 l0 of a point. */
bool mpsi_fluid_point_near_wedge(const mps_fluid *fluid, const double *x);
/* Whether a face other than `wall` (-1: none) is between two points. */
bool mpsi_fluid_hidden(const mps_fluid *fluid, int wall, const double *a, const double *b);
