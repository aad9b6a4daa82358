/* goring.h - a piston that makes a solitary wave of height H in the depth d, after Goring (1979):
 *
 *   X = S tanh(theta),  theta = k (c (t - t0) - X),  c^2 = g (d + H),  k^2 = 3 H/(4 d^3),
 *   S = H/(k d),
 *
 * from theta = -3.8 at t = 0. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_GORING_H
#define MPS_GORING_H

#include "fluid_tank.h"

enum { GORING_SAMPLES = 1200 };
#define GORING_START (-3.8) /* theta */

typedef struct solitary {
  double depth, height, speed, number, stroke; /* d, H, c, k, S */
} solitary;

static inline solitary solitary_of(double depth, double height) {
  solitary w = {.depth = depth, .height = height};
  w.speed = sqrt(TANK_G * (depth + height));
  w.number = sqrt(3.0 * height / (4.0 * depth * depth * depth));
  w.stroke = height / (w.number * depth);
  return w;
}

static inline double goring_time(const solitary *w, double theta) {
  return (theta / w->number + w->stroke * tanh(theta)) / w->speed;
}

/* Displacement of the piston over 6 s. */
static inline mps_signal *goring_piston(mps_context *c, const solitary *w) {
  double times[GORING_SAMPLES], x[GORING_SAMPLES];
  mps_signal *signal = NULL;
  const double start = goring_time(w, GORING_START);
  for (int k = 0; k < GORING_SAMPLES; k++) {
    double low = -4.0, high = 40.0;
    times[k] = 0.005 * k;
    for (int n = 0; n < 60; n++) {
      const double middle = 0.5 * (low + high);
      if (goring_time(w, middle) - start < times[k])
        low = middle;
      else
        high = middle;
    }
    x[k] = w->stroke * (tanh(low) - tanh(GORING_START));
  }
  x[0] = 0.0;
  OK(mps_signal_create_table(c, MPS_SIGNAL_QUANTITY_DISPLACEMENT, GORING_SAMPLES, times, x,
                             &signal));
  return signal;
}

#endif
