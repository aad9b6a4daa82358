/* linear.c - force on the wall by linear potential flow in the closed tank, from rest: a particular
 * potential with the piston's velocity V at x = 0,
 *   V ((y + d)^2 - (L - x)^2)/(2 L)          (y from the water at rest up),
 * and the tank's modes cos(k x) cosh k(y + d)/cosh k d, k = n pi/L, whose amplitudes keep the
 * pressure of the surface zero. With b the integral of the pressure of a mode at the surface,
 *   b'' = -omega^2 (b + c V),  c = 2 L/(n pi)^2,  omega^2 = g k tanh k d.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include <math.h>

#define MODES 80  /* what they leave of the force falls with the fourth power of their number */
#define TURN 0.05 /* of the last mode's phase in a step */

typedef struct modes {
  double k[MODES], omega2[MODES], c[MODES];
  double b[MODES], rate[MODES]; /* m2/s, m2/s2 */
} modes;

static void begin(modes *m, const seawall_settings *s) {
  for (int i = 0; i < MODES; i++) {
    m->k[i] = (i + 1) * WAVES_PI / s->length;
    m->omega2[i] = WAVES_G * m->k[i] * tanh(m->k[i] * s->depth);
    m->c[i] = 2.0 / (s->length * m->k[i] * m->k[i]);
    m->b[i] = m->rate[i] = 0.0;
  }
}

static void advance(modes *m, waves_piston *piston, double from, double to) {
  double motion[3];
  const double whole = to - from;
  const int steps = 1 + (int)(whole * sqrt(m->omega2[MODES - 1]) / TURN);
  const double h = whole / steps;
  for (int j = 0; j < steps; j++) {
    waves_move_piston(piston, from + (j + 0.5) * h, motion);
    for (int i = 0; i < MODES; i++) {
      m->b[i] += 0.5 * h * m->rate[i];
      m->rate[i] -= h * m->omega2[i] * (m->b[i] + m->c[i] * motion[1]);
      m->b[i] += 0.5 * h * m->rate[i];
    }
  }
}

/* N/m: of the water at rest, of all the tank's rise and of the modes. */
static double force(const modes *m, const seawall_settings *s, waves_piston *piston, double t) {
  const double L = s->length, d = s->depth;
  double motion[3];
  waves_move_piston(piston, t, motion);
  const double X = motion[0], A = motion[2];
  double sum = A * d * d * d / (6.0 * L);
  sum += d * (A * (L * L / 3.0 - d * d) / (2.0 * L) - WAVES_G * X * d / L);
  for (int i = 0; i < MODES; i++) {
    const double sign = i % 2 == 0 ? -1.0 : 1.0; /* cos n pi */
    sum += sign * (m->rate[i] + m->c[i] * A) * tanh(m->k[i] * d) / m->k[i];
  }
  return WAVES_DENSITY * (0.5 * WAVES_G * d * d - sum);
}

void seawall_linear(const seawall *w, double *out) {
  modes m;
  waves_piston motion = w->motion;
  double t = 0.0;
  begin(&m, &w->s);
  for (int64_t k = 0; k < w->samples; k++) {
    advance(&m, &motion, t, w->sample[k].t);
    t = w->sample[k].t;
    out[k] = force(&m, &w->s, &motion, t);
  }
}
