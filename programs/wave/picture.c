/* picture.c - wave.png: acceleration against time and depth, as the paper's Figure 2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wave.h"

#include "common/plot.h"

#include <math.h>

static void write_title(output *f, const settings *s, const results *x) {
  static const char *const names[] = {[MPS_DYNAMICS_INTEGRATOR_VERLET] = "Verlet",
                                      [MPS_DYNAMICS_INTEGRATOR_LEAPFROG] = "leapfrog",
                                      [MPS_DYNAMICS_INTEGRATOR_EULER] = "Euler"};
  const layer *l = &s->ground.layer[0];
  const char wave = settings_wave(s);
  output_text(f, "first = '%s wave through %s", wave == 'S' ? "Shear" : "Pressure",
              s->sloped ? "a slope of " : "");
  if (s->ground.count > 1)
    output_text(f, "%d layers", (int)s->ground.count);
  else
    output_text(f, "uniform ground, V_%c = %g m/s, ", wave, wave == 'S' ? l->vs : l->vp);
  if (s->ground.count == 1 && l->damping == 0.0) output_text(f, "undamped");
  if (s->ground.count == 1 && l->damping > 0.0) output_text(f, "damping ratio %g", l->damping);
  output_text(f, "'\nsecond = '%lld particles, R = %g m, %s, {/Symbol D}t = %.4g s, %s base'\n",
              (long long)x->particles, 0.5 * s->spacing, names[s->integrator], x->dt,
              s->base == BASE_RIGID ? "rigid" : "viscous");
}

/* Times at which the centre of the pulse passes each receiver, on its way up and down again. */
static void write_theory(output *f, const settings *s, const column *c, const receivers *r) {
  const double top = c->height - column_surface(c, 0.5 * c->width);
  const double base = top + r->list[r->column - 1].depth;
  const char wave = settings_wave(s);
  const double total = layers_travel_time(&s->ground, wave, base, top);
  output_text(f, "known = %d\n$theory << EOD\nt,depth\n", s->ricker);
  for (int64_t i = 0; i < 2 * r->column; i++) {
    const int64_t k = i < r->column ? r->column - 1 - i : i - r->column;
    const double depth = k == 0 ? 0.0 : r->list[k].depth;
    const double part = layers_travel_time(&s->ground, wave, base, top + depth);
    const double t = s->peak_time + (i < r->column ? part : 2.0 * total - part);
    output_text(f, "%.9g,%.9g\n", s->ricker ? t : NAN, depth);
  }
  output_text(f, "EOD\n");
}

bool results_draw(app *a, const settings *s, const column *c, const receivers *r,
                  const results *x) {
  output f;
  if (!plot_begin(&f, a, s->out, "wave")) return false;
  write_title(&f, s, x);
  output_text(&f, "receivers = %lld; end = %.9g\narray depth[receivers]; array peak[receivers]\n",
              (long long)r->column, receivers_time(r, r->rows - 1));
  for (int64_t k = 0; k < r->column; k++)
    output_text(&f, "depth[%lld] = %.9g; peak[%lld] = %.9g\n", (long long)k + 1, r->list[k].depth,
                (long long)k + 1, receivers_peak(r, k));
  write_theory(&f, s, c, r);
  return plot_end(&f, s->out, "wave", "wave/wave");
}
