/* picture.c - wave.png: acceleration against time and depth, as the paper's Figure 2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "results.h"

#include "common/plot.h"

#include <math.h>

/* Largest of all traces, for their common scale. */
static double largest(const receivers *r) {
  double peak = 0.0;
  for (int64_t k = 0; k < r->column; k++) peak = fmax(peak, receivers_peak(r, k));
  return peak > 0.0 && isfinite(peak) ? peak : 1.0;
}

/* 1, 2 or 5 times a power of ten, at most `value`. */
static double round_down(double value) {
  const double power = pow(10.0, floor(log10(value)));
  const double lead = value / power;
  return (lead >= 5.0 ? 5.0 : lead >= 2.0 ? 2.0 : 1.0) * power;
}

static void write_title(output *f, const settings *s, const results *x) {
  static const char *const names[] = {[MPS_DYNAMICS_INTEGRATOR_VERLET] = "Verlet",
                                      [MPS_DYNAMICS_INTEGRATOR_LEAPFROG] = "leapfrog",
                                      [MPS_DYNAMICS_INTEGRATOR_EULER] = "Euler"};
  const layer *l = &s->ground.layer[0];
  const char wave = settings_wave(s);
  output_text(f, "set title \"%s wave through ", wave == 'S' ? "Shear" : "Pressure");
  output_text(f, "%s", s->sloped ? "a slope of " : "");
  if (s->ground.count > 1)
    output_text(f, "%d layers", (int)s->ground.count);
  else
    output_text(f, "uniform ground, V_%c = %g m/s, ", wave, wave == 'S' ? l->vs : l->vp);
  if (s->ground.count == 1 && l->damping == 0.0) output_text(f, "undamped");
  if (s->ground.count == 1 && l->damping > 0.0) output_text(f, "damping ratio %g", l->damping);
  output_text(f,
              "\\n{/*0.85 %lld particles, R = %g m, %s, {/Symbol D}t = %.4g s, %s base}\" "
              "offset 0,0.3\n",
              (long long)x->particles, 0.5 * s->spacing, names[s->integrator], x->dt,
              s->base == BASE_RIGID ? "rigid" : "viscous");
}

/* Left: the depths. Right: the peaks. At most some 20 labels. */
static void write_tics(output *f, const receivers *r) {
  const int64_t every = (r->column + 19) / 20;
  for (int side = 0; side < 2; side++) {
    output_text(f, side == 0 ? "set ytics (" : "set y2tics (");
    for (int64_t k = 0; k < r->column; k += every) {
      const double depth = r->list[k].depth;
      if (side == 0)
        output_text(f, "%s'GL.-%.4g m' %.9g", k ? ", " : "", depth, depth);
      else
        output_text(f, "%s'%#.3g' %.9g", k ? ", " : "", receivers_peak(r, k), depth);
    }
    output_text(f, ")\n");
  }
}

/* Times at which the centre of the pulse passes each receiver, on its way up and down again. */
static void write_theory(output *f, const settings *s, const column *c, const receivers *r) {
  const double top = c->height - column_surface(c, 0.5 * c->width);
  const double base = top + r->list[r->column - 1].depth;
  const char wave = settings_wave(s);
  const double total = layers_travel_time(&s->ground, wave, base, top);
  output_text(f, "$theory << EOD\n");
  for (int way = 0; way < 2; way++)
    for (int64_t i = 0; i < r->column; i++) {
      const int64_t k = way == 0 ? r->column - 1 - i : i;
      const double depth = k == 0 ? 0.0 : r->list[k].depth;
      const double part = layers_travel_time(&s->ground, wave, base, top + depth);
      output_text(f, "%.9g,%.9g\n", s->peak_time + (way == 0 ? part : 2.0 * total - part), depth);
    }
  output_text(f, "EOD\n");
}

bool results_draw(app *a, const settings *s, const column *c, const receivers *r,
                  const results *x) {
  output f;
  if (!plot_open(&f, a, s->out, "wave", 1200, 900)) return false;
  const double deepest = r->list[r->column - 1].depth;
  const double gap = deepest / (double)(r->column - 1);
  const double peak = largest(r);
  /* Few traces may be as high as their distance, many must overlap to be seen. */
  const double scale = fmax(gap, deepest / 20.0) / peak;
  const double bar = round_down(peak), right = receivers_time(r, r->rows - 1);
  const double upper = -1.3 * peak * scale, lower = deepest + 1.3 * peak * scale;
  /* the scale's place: over the trace of the surface, before the pulse is there */
  const double above = -0.65 * peak * scale;
  write_title(&f, s, x);
  output_text(&f, "set xlabel 'time t (s)'\n"
                  "set ylabel 'depth of the receiver' offset 1,0\n"
                  "set y2label 'peak acceleration (m/s^2)' offset 0,0\n"
                  "set key at graph 0.98,0.03 right bottom opaque box linecolor rgb '#bbbbbb'\n"
                  "set lmargin 16\nset rmargin 11\nset tmargin 4.5\n");
  output_text(&f, "set xrange [0:%.9g]\nset yrange [%.9g:%.9g]\nset y2range [%.9g:%.9g]\n", right,
              lower, upper, lower, upper);
  write_tics(&f, r);
  output_text(&f,
              "set arrow from graph 0.03, first %.9g to graph 0.03, first %.9g heads size screen "
              "0.006,90 front linewidth 1.5\nset label '%g m/s^2' at graph 0.047, first %.9g\n",
              above + scale * bar * 0.5, above - scale * bar * 0.5, bar, above);
  if (s->ricker) write_theory(&f, s, c, r);
  output_text(&f, "plot ");
  for (int64_t k = 0; k < r->column; k++)
    output_text(&f,
                "'receivers.csv' every ::1 using 1:(%.9g - %.9g*$%lld) with lines linecolor rgb "
                "'#1f4e8c' linewidth 1.3 %s, \\\n  ",
                r->list[k].depth, scale, (long long)k + 2, k ? "notitle" : "title 'MPS'");
  output_text(&f, s->ricker
                      ? "$theory using 1:2 with lines dashtype '--' linewidth 1.2 linecolor rgb "
                        "'#c0392b' title 'pulse by theory'\n"
                      : "NaN notitle\n");
  return plot_close(&f, s->out, "wave");
}
