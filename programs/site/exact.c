/* exact.c - steady shear waves in elastic layers on a rigid base or a half space: the surface over
 * the motion of the base or of the half space's outcrop (Kramer 1996, Geotechnical Earthquake
 * Engineering, 7.2.1.4, equations of layers from the surface down). Of one layer that is
 * 1/|cos kH| and 1/sqrt(cos^2 kH + a^2 sin^2 kH), a the ratio of the impedances.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include <complex.h>
#include <math.h>

#define PI 3.14159265358979323846

double site_exact(const simulation *sim, double frequency) {
  const site_ground *g = &sim->ground;
  double complex up = 1.0, down = 1.0; /* amplitudes at the top of the layer; surface: 2 */
  const int64_t layers = g->count - g->has_half_space;
  for (int64_t i = 0; i < layers; i++) {
    const site_layer *l = &g->layer[i];
    const double complex phase = cexp(I * (2.0 * PI * frequency * l->thickness / l->vs));
    up *= phase, down /= phase;
    if (i + 1 == g->count) break;
    const site_layer *next = &g->layer[i + 1];
    const double ratio = l->density * l->vs / (next->density * next->vs);
    const double complex above = up, back = down;
    up = 0.5 * (above * (1.0 + ratio) + back * (1.0 - ratio));
    down = 0.5 * (above * (1.0 - ratio) + back * (1.0 + ratio));
  }
  return g->has_half_space ? 1.0 / cabs(up) : 2.0 / cabs(up + down);
}
