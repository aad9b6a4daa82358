/* pictures.c - pictures of mps-flume: levels with their target, spectra, force, discharge, the
 * water at the largest force. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

enum { SHOWN = 3 }; /* gauges */

/* First, middle and last gauge, the last 12 periods. */
static bool draw_levels(app *a, const flume *m) {
  const double last = m->samples ? m->sample[m->samples - 1].t : 1.0;
  const int shown = m->gauges < SHOWN ? m->gauges : SHOWN;
  output f;
  if (shown == 0) return true;
  if (!plot_open(&f, a, m->s.out, "levels", 1000, 120 + 230 * shown)) return false;
  output_text(
      &f,
      "set multiplot layout %d,1\nset xrange [%.6g:%.6g]\nset ylabel 'level (mm)'\nset lmargin "
      "10\nset ytics %.6g\nset key outside top center horizontal\n",
      shown, fmax(last - 12.0 * m->s.period, 0.0), last, plot_tics(2e3 * m->s.height, 6.0));
  for (int k = 0; k < shown; k++) {
    const int g = shown == 1 ? 0 : k * (m->gauges - 1) / (shown - 1);
    output_text(
        &f,
        "%splot 'gauges.csv' every ::1 using 1:(1e3*$%d) with lines linewidth 3 linecolor rgb "
        "'#f0b27a' title 'target without reflection, x = %g m', '' every ::1 "
        "using 1:(1e3*$%d) with lines linewidth 1.4 linecolor rgb '#1f4e8c' title 'MPS'\n",
        k == shown - 1 ? "set xlabel 't (s)'\n" : "", 2 * g + 3, m->s.gauge[g], 2 * g + 2);
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
      "set title 'Spectra, %.1f to %.1f s: incident H_{m0} %.4f m, target %.4f m, reflection "
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
  if (m->s.wall == FLUME_OPEN_END) return true;
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
  if (!flume_has_body(&m->s)) return true;
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
              "'#1f4e8c' title 'MPS'\n");
  return plot_close(&f, m->s.out, "discharge");
}

/* ---- the water ------------------------------------------------------------------------------- */

static bool in_body(const void *user, double x, double y) {
  const flume *m = user;
  if (m->s.wall == FLUME_VERTICAL && x > m->s.length) return true;
  return y < 0.0 || (m->corners > 0 && y < flume_ground(m, x));
}

static bool image(app *a, const flume *m, const double *lower, const double *upper, area *out) {
  const int64_t n = m->look.count;
  double *row = malloc(3 * (size_t)(n + 1) * sizeof *row);
  output f;
  if (!row) return app_no_memory(a);
  for (int64_t i = 0; i < 3 * n; i++) row[i] = (double)m->look.value[i];
  const area_def def = {.spacing = m->s.spacing,
                        .slit = AREA_SLIT,
                        .lower = {lower[0], lower[1]},
                        .upper = {upper[0], upper[1]},
                        .side = AREA_SIDE,
                        .solid = in_body,
                        .user = m};
  const bool good = output_open(&f, a, m->s.out, "water.bin");
  if (good) area_write(&f, &def, n, row, out);
  free(row);
  return good && output_close(&f);
}

/* Two depths and a wave length before the structure, or all of a short flume. */
static bool draw_water(app *a, const flume *m) {
  const flume_settings *s = &m->s;
  const bool body = flume_has_body(s);
  const double right = (body ? m->outlet : s->length) + 2.0 * s->spacing;
  const double left = fmax(-0.2 * s->depth, s->length - m->wave_length - 2.0 * s->depth);
  const double lower[2] = {s->wall == FLUME_OPEN_END ? -0.2 * s->depth : left, -2.0 * s->spacing};
  const double upper[2] = {right,
                           fmax(1.6 * s->depth, body ? 1.3 * m->corner[m->corners - 1][1] : 0.0)};
  const double shape = (upper[1] - lower[1]) / (upper[0] - lower[0]);
  area picture;
  output f;
  double least, most;
  if (m->look.count == 0) return true;
  if (!image(a, m, lower, upper, &picture)) return false;
  area_range(1, &picture, 1e-3, &least, &most);
  if (!plot_open(&f, a, s->out, "water", 1300, (int)fmax(1080.0 * shape, 90.0) + 170)) return false;
  output_text(
      &f,
      "set size ratio -1\nunset grid\nset xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\nset xlabel "
      "'x (m)'\nset ylabel 'y (m)'\nset ytics %.6g\nset cblabel 'pressure (kPa)' offset 1.2\nset "
      "title 't = "
      "%.2f s%s'\nset palette defined (0 '#2c3e8f', 0.35 '#4aa3c7', 0.7 '#b7e0a5', 1 "
      "'#f4d03f')\n",
      lower[0], upper[0], lower[1], upper[1], plot_tics(upper[1] - lower[1], 4.0), m->look.t,
      s->wall == FLUME_OPEN_END ? "" : ", at the largest force");
  if (body) {
    output_text(&f, "set object 1 polygon from %.6g,0", m->heel);
    for (int k = 0; k < m->corners; k++)
      output_text(&f, " to %.6g,%.6g", m->corner[k][0], m->corner[k][1]);
    output_text(
        &f,
        " to %.6g,0 fillstyle solid 1.0 border linecolor rgb '#444444' fillcolor rgb '#8a8f98'\n",
        m->heel);
  }
  plot_colours(&f, least, most, least, most);
  output_text(&f, "plot ");
  area_plot(&f, "water.bin", &picture, 1.0, 1e-3);
  output_text(&f, "\n");
  return plot_close(&f, s->out, "water");
}

bool flume_draw(app *a, const flume *m, const flume_figures *g) {
  return draw_levels(a, m) && draw_spectrum(a, m, g) && draw_force(a, m, g) &&
         draw_discharge(a, m, g) && draw_water(a, m);
}
