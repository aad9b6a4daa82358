/* swing.c - whether the values agreed on swing faster than the steps follow. Changes y of a value
 * that oscillates by w radians a step obey y(n+1) + y(n-1) = 2 cos(w) y(n), whatever its mean. The
 * factor by least squares over some 64 steps is w of what dominates; what it leaves over is small
 * only where one frequency does: waves with a little noise, or impacts, say nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "coupling_private.h"

#include <math.h>

#define STEPS 64.0  /* that count: each the less by a 64th with every step */
#define LONGEST 0.3 /* rad a step: beyond, water and structure may drive one another */
#define PURE 0.1    /* of the changes' square: what other frequencies may have */
#define ABOVE 10.0  /* times the floor: changes that are none of the tolerance */

/* Adds the changes up to the values agreed on now. */
static void add_up(mps_coupling *c) {
  mpsi_coupling_swing *s = &c->swing;
  const double kept = 1.0 - 1.0 / STEPS;
  double across = 0.0, middle = 0.0, outer = 0.0;
  for (int64_t i = 0; i < c->def.size; i++) {
    const double y = c->past[0][i] - c->past[1][i];
    const double sum = c->x[i] - c->past[0][i] + c->past[1][i] - c->past[2][i];
    across += sum * y, middle += y * y, outer += sum * sum;
  }
  s->across = kept * s->across + across;
  s->middle = kept * s->middle + middle;
  s->outer = kept * s->outer + outer;
  s->seen++;
}

void mpsi_coupling_watch(mps_coupling *c) {
  mpsi_coupling_swing *s = &c->swing;
  if (c->steps < MPSI_COUPLING_PAST || s->warned) return;
  add_up(c);
  const double n = (double)c->def.size, least = ABOVE * c->def.floor;
  if ((double)s->seen < STEPS || !(s->middle > STEPS * n * least * least)) return;
  const double rest = s->outer - s->across * s->across / s->middle;
  const double w = acos(fmax(fmin(0.5 * s->across / s->middle, 1.0), -1.0));
  if (!(w > LONGEST) || !(rest < PURE * s->middle)) return;
  s->warned = true;
  mpsi_log(
      c->context, MPS_CONTEXT_LOG_WARNING,
      "the coupling's values oscillate by %.2f rad a step, omega dt: the step is too long for the "
      "structure, %.2g of it follows (omega dt up to %g)",
      w, LONGEST / w, LONGEST);
}
