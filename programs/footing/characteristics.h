/* characteristics.h - exact bearing capacity of a strip footing on ground that obeys Mohr and
 * Coulomb, with weight, by the method of characteristics.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_CHARACTERISTICS_H
#define EXAMPLES_CHARACTERISTICS_H

#include <stdbool.h>

typedef struct strip_footing {
  double half_width; /* m, > 0 */
  double friction;   /* rad, phi in [0, 60 degrees] */
  double cohesion;   /* Pa, c; either c or the surcharge > 0 */
  double weight;     /* N/m3, rho g, >= 0 */
  double gradient;   /* Pa/m, growth of c with depth, >= 0; where c > 0 and phi = 0; rough up to 5
                        c/half_width */
  double surcharge;  /* Pa, pressure on the surface beside the footing, >= 0 */
  bool rough;        /* its base: smooth, or as rough as the ground */
} strip_footing;

/* Mean pressure under the footing at the limit (Pa), with `lines` >= 2 characteristics of either
 * family through the fan and from the surface; the error falls with their square. NaN where memory
 * runs out or no solution is found. */
double characteristics_capacity(const strip_footing *f, int lines);

#endif
