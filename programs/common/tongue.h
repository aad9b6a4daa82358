/* tongue.h - the end of a tongue of particles on a slope, which is thinner than a spacing there.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/particles.h>

#include <stdbool.h>

/* A plane slope: from `foot` (m) at `angle` (rad) above x; water on its upper side. */
typedef struct tongue_slope {
  double foot[2], angle;
  double length; /* m, of the slope: water beyond is not on it */
} tongue_slope;

typedef struct tongue {
  double resolved; /* m along the slope: as far as the tongue is a spacing thick without a gap */
  double end;   /* m along the slope: where its thickness is continued to 0; -INFINITY, both: there
                   is none, as it is too short or not thinner upwards */
  double layer; /* m along the slope: end of the particles on it, without a gap */
} tongue;

/* The tongue of the particles of `spacing` (m). Its thickness is that of the particles in bins of
 * two spacings along the slope; the line of least squares through it, from six spacings to one, is
 * continued to zero, at most by its own length: before a bore it would be no tongue's. False
 * without memory. */
bool tongue_find(mps_particles *water, const tongue_slope *slope, double spacing, tongue *out);
