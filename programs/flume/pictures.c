/* pictures.c - pictures of mps-flume: levels with their target, spectra, force, pressures at the
 * largest force, discharge. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/plot.h"

#include <math.h>

enum { SHOWN = 3 };   /* gauges */
#define IN_METRES 0.5 /* m: waves from this height on have levels in m, of prototypes */

/* First, middle and last gauge, the last 12 periods. */
static bool draw_levels(app *a, const flume *m) {
  const double last = m->samples ? m->sample[m->samples - 1].t : 1.0;
  const int shown = m->gauges < SHOWN ? m->gauges : SHOWN;
  const bool metres = m->s.height >= IN_METRES;
  const double unit = metres ? 1.0 : 1e3;
  output f;
  if (shown == 0) return true;
  if (!plot_open(&f, a, m->s.out, "levels", 1000, 120 + 230 * shown)) return false;
  output_text(
      &f,
      "set multiplot layout %d,1\nset xrange [%.6g:%.6g]\nset ylabel 'level (%s)'\nset lmargin "
      "10\nset ytics %.6g\nset key outside top center horizontal\n",
      shown, fmax(last - 12.0 * m->s.period, 0.0), last, metres ? "m" : "mm",
      plot_tics(2.0 * unit * m->s.height, 6.0));
  for (int k = 0; k < shown; k++) {
    const int g = shown == 1 ? 0 : k * (m->gauges - 1) / (shown - 1);
    output_text(
        &f,
        "%splot 'gauges.csv' every ::1 using 1:(%g*$%d) with lines linewidth 3 linecolor rgb "
        "'#f0b27a' title 'target without reflection, x = %g m', '' every ::1 "
        "using 1:(%g*$%d) with lines linewidth 1.4 linecolor rgb '#1f4e8c' title 'MPS'\n",
        k == shown - 1 ? "set xlabel 't (s)'\n" : "", unit, 2 * g + 3, m->s.gauge[g], unit,
        2 * g + 2);
  }
  output_text(&f, "unset multiplot\n");
  return plot_close(&f, m->s.out, "levels");
}

static bool draw_spectrum(app *a, const flume *m, const flume_figures *g) {
  output f;
  if (!g->separated || m->s.waves == FLUME_REGULAR) return true;
  if (!plot_open(&f, a, m->s.out, "spectrum", 900, 520)) return false;
  output_text(
      &f,
      "set title '%.1f to %.1f s: H_{m0} incident %.3g m, target %.3g m, reflection "
      "%.2f'\nset xlabel 'frequency (Hz)'\nset ylabel 'density (mm^2 s)'\nset yrange [0:*]\n",
      g->from, g->to, g->split.incident_height, g->target_height, g->split.reflection);
  plot_key_below(&f);
  output_text(
      &f, "plot 'spectrum.csv' every ::1 using 1:(1e6*$4) with lines linewidth 3 linecolor rgb "
          "'#f0b27a' title 'linear target', '' every ::1 using 1:(1e6*$2) with lines linewidth 1.4 "
          "linecolor rgb '#1f4e8c' title 'incident', '' every ::1 using 1:(1e6*$3) with lines "
          "linecolor rgb '#c0392b' title 'reflected'\n");
  return plot_close(&f, m->s.out, "spectrum");
}

static bool draw_force(app *a, const flume *m, const flume_figures *g) {
  output f;
  if (!flume_is_loaded(m)) return true;
  if (!plot_open(&f, a, m->s.out, "force", 1000, 460)) return false;
  output_text(&f,
              "set title 'Horizontal force of the water on the structure'\nset xlabel 't (s)'\nset "
              "ylabel 'force (N per m)'\nset xrange [0:%.6g]\n",
              m->s.duration);
  plot_key_below(&f);
  output_text(&f,
              "plot %.9g with lines dashtype '--' linecolor rgb '#888888' title 'water at rest', ",
              g->force_still);
  if (g->has_goda)
    output_text(&f, "%.9g with lines dashtype '--' linecolor rgb '#c0392b' title 'Goda', ",
                g->force_still + g->goda.force);
  output_text(
      &f, "'force.csv' every ::1 using 1:4 with lines linewidth 1.4 linecolor rgb '#1f4e8c' title "
          "'MPS'\n");
  return plot_close(&f, m->s.out, "force");
}

static bool draw_discharge(app *a, const flume *m, const flume_figures *g) {
  output f;
  if (!flume_is_open(m)) return true;
  if (!plot_open(&f, a, m->s.out, "discharge", 1000, 420)) return false;
  output_text(
      &f,
      "set title 'Water that has passed the crest'\nset xlabel 't (s)'\nset ylabel 'volume (l "
      "per m)'\nset xrange [0:%.6g]\nset yrange [0:*]\n",
      m->s.duration);
  plot_key_below(&f);
  output_text(&f, "plot ");
  if (g->has_eurotop)
    output_text(
        &f,
        "(x < %.6g ? NaN : 1e3*%.9g*(x - %.6g)) with lines linewidth 3 linecolor rgb '#f0b27a' "
        "title 'EurOtop, mean', ",
        g->from, g->eurotop.discharge, g->from);
  output_text(&f,
              "'discharge.csv' every ::1 using 1:(1e3*$2) with lines linewidth 1.4 linecolor rgb "
              "'#1f4e8c' title 'MPS'");
  if (g->thin)
    output_text(&f, ", '' every ::1 using 1:(1e3*($2+$6)) with lines linewidth 1.4 dashtype '-' "
                    "linecolor rgb '#1f4e8c' title 'with events too low for particles'");
  output_text(&f, "\n");
  return plot_close(&f, m->s.out, "discharge");
}

/* ---- pressures at the largest force ---------------------------------------------------------- */

/* Goda's trapezoids: from the base over the still level to eta*, or the crest. */
static void plot_goda(output *f, const flume *m, const flume_figures *g) {
  const double bed = m->s.wall == FLUME_VERTICAL ? m->ground[m->grounds - 1][1] : 0.0;
  const double d = m->s.depth, base = flume_has_body(m) ? m->heel[1] : bed;
  const double reach = g->goda.reach, crest = m->s.wall == FLUME_VERTICAL ? INFINITY : g->crest;
  const double top = fmin(reach, crest), p4 = top < reach ? g->goda.p4 : 0.0;
  output_text(f, "$goda << EOD\n%.6g,%.6g\n%.6g,%.6g\n%.6g,%.6g\nEOD\n", 1e-3 * g->goda.p3, base,
              1e-3 * g->goda.p1, d, 1e-3 * p4, d + top);
}

/* Left the faces that are no underside, over the height; right the base of a caisson on rock. */
static bool draw_pressures(app *a, const flume *m, const flume_figures *g) {
  const bool body = flume_has_body(m);
  const double base = m->heel[1], half = 0.5 * m->s.spacing;
  output f;
  if (!flume_is_loaded(m) || m->look.faces == 0) return true;
  if (!plot_open(&f, a, m->s.out, "pressures", body ? 1200 : 700, 620)) return false;
  if (g->has_goda) plot_goda(&f, m, g);
  output_text(&f, "set multiplot layout 1,%d\n", body ? 2 : 1);
  plot_key_below(&f);
  output_text(&f,
              "set title 'Pressure above that of water at rest, t = %.2f s'\nset xlabel "
              "'pressure (kPa)'\nset ylabel 'y (m)'\nset xrange [*<0:*]\nplot ",
              m->look.t);
  if (g->has_goda)
    output_text(&f, "$goda using 1:2 with linespoints linewidth 2 linecolor rgb '#c0392b' title "
                    "'Goda', ");
  if (body)
    output_text(
        &f,
        "'faces.csv' every ::1 using ($1 < %.9g && $2 > %.9g ? 1e-3*$4 : NaN):2 with points "
        "pointtype 7 pointsize 0.7 linecolor rgb '#1f4e8c' title 'MPS, front', '' every ::1 "
        "using ($1 > %.9g && $2 > %.9g ? 1e-3*$4 : NaN):2 with points pointtype 6 pointsize "
        "0.7 linecolor rgb '#1f4e8c' title 'MPS, rear'\n",
        m->heel[0] - half, base + 1e-6, m->heel[0] - half, base + 1e-6);
  else
    output_text(&f, "'faces.csv' every ::1 using (1e-3*$4):2 with points pointtype 7 pointsize 0.7 "
                    "linecolor rgb '#1f4e8c' title 'MPS'\n");
  if (!body) return output_text(&f, "unset multiplot\n"), plot_close(&f, m->s.out, "pressures");
  output_text(&f, "set title 'Uplift below the caisson'\nset xlabel 'x (m)'\nset ylabel 'pressure "
                  "(kPa)'\nset xrange [*:*]\nset yrange [*<0:*]\n");
  output_text(&f, "$stated << EOD\n%.9g,%.9g\n%.9g,0\nEOD\n", g->front, 1e-3 * g->foot_peak,
              m->heel[0]);
  if (g->has_goda)
    output_text(&f, "$pu << EOD\n%.9g,%.9g\n%.9g,0\nEOD\n", g->front, 1e-3 * g->goda.pu,
                m->heel[0]);
  output_text(&f, "plot ");
  if (g->has_goda)
    output_text(&f, "$pu using 1:2 with lines linewidth 2 linecolor rgb '#c0392b' title 'Goda', ");
  output_text(
      &f,
      "$stated using 1:2 with lines dashtype '--' linecolor rgb '#888888' title 'triangle "
      "from the foot', 'faces.csv' every ::1 using (abs($2 - %.9g) < 1e-6 && $1 > %.9g ? $1 "
      ": NaN):(1e-3*$4) with points pointtype 7 pointsize 0.7 linecolor rgb '#1f4e8c' title "
      "'MPS, %s'\nunset multiplot\n",
      base, g->front - half, m->bedded ? "in the rock" : "below it");
  return plot_close(&f, m->s.out, "pressures");
}

bool flume_draw(app *a, const flume *m, const flume_figures *g) {
  return draw_levels(a, m) && draw_spectrum(a, m, g) && draw_force(a, m, g) &&
         draw_pressures(a, m, g) && draw_discharge(a, m, g) && flume_draw_water(a, m);
}
