/* pictures.c - Chikazawa's Figures 9 to 13 anew: the tank and the waves in it, the force on the
 * wall in time, its pressures and its bending at the crest; and the waves as an animation.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

enum { PANELS = 6, ACROSS = 2, STILL_WIDTH = 860 };

/* The section that is shown, m: with the piston, the wall and the splash, up to three depths. */
typedef struct view {
  double lower[2], upper[2];
  area *image;        /* of each frame, in frames.bin */
  double least, most; /* kPa */
} view;

static void choose_section(const seawall *w, view *v) {
  const seawall_settings *s = &w->s;
  double top = fmax(s->wall_height, 1.5 * s->depth);
  for (int64_t k = 0; k < w->frames; k++)
    for (int64_t i = 0; i < w->frame[k].count; i++)
      top = fmax(top, (double)w->frame[k].value[3 * i + 1]);
  v->lower[0] = -1.2 * fabs(s->amplitude) - 4.0 * s->spacing;
  v->lower[1] = -2.0 * s->spacing;
  v->upper[0] = s->length + s->wall_thickness + 0.02;
  v->upper[1] = fmin(top, 3.0 * s->depth) + 2.0 * s->spacing;
}

/* Bed, wall and piston as begin_water and plot_water draw them. */
typedef struct solids {
  const seawall_settings *s;
  double piston; /* m, of its face */
} solids;

static bool in_solids(const void *user, double x, double y) {
  const solids *w = user;
  return y < 0.0 || (y < w->s->wall_height && (x > w->s->length || x < w->piston));
}

/* frames.bin: the pressure (Pa) in the area of the water, frame after frame. */
static bool image_frames(app *a, const seawall *w, view *v) {
  output f;
  int64_t room = 1;
  for (int64_t k = 0; k < w->frames; k++)
    if (w->frame[k].count > room) room = w->frame[k].count;
  double *row = malloc((size_t)room * 3 * sizeof *row);
  v->image = calloc((size_t)w->frames + 1, sizeof *v->image);
  if (!row || !v->image) {
    free(row);
    return app_no_memory(a);
  }
  bool good = output_open(&f, a, w->s.out, "frames.bin");
  for (int64_t k = 0; good && k < w->frames; k++) {
    for (int64_t i = 0; i < 3 * w->frame[k].count; i++) row[i] = (double)w->frame[k].value[i];
    const solids walls = {&w->s, w->frame[k].piston};
    const area_def def = {.spacing = w->s.spacing,
                          .slit = AREA_SLIT,
                          .lower = {v->lower[0], v->lower[1]},
                          .upper = {v->upper[0], v->upper[1]},
                          .side = 700,
                          .factor = 1e-3,
                          .solid = in_solids,
                          .user = &walls};
    area_write(&f, &def, w->frame[k].count, row, &v->image[k]);
  }
  free(row);
  area_range(w->frames, v->image, &v->least, &v->most);
  return good && output_close(&f);
}

/* Common parts of the pictures of the water: axes, colours, the wall's outline. */
static void begin_water(output *f, const seawall_settings *s, const view *v) {
  const double left = v->lower[0];
  output_text(f,
              "set size ratio -1\nunset grid\nset ytics 0.1\nset xrange [%.6g:%.6g]\nset yrange "
              "[%.6g:%.6g]\n"
              "set palette defined (0 '#2c3e8f', 0.35 '#4aa3c7', 0.7 '#b7e0a5', 1 '#f4d03f')\n"
              "set xlabel 'x (m)' offset 0,0.6\nset ylabel 'y (m)' offset 1.8\n"
              "set cblabel 'pressure (kPa)'\n"
              "set object 1 rectangle from %.9g,0 to %.9g,%.9g fillcolor rgb '#8a8f98' fillstyle "
              "solid 1.0 noborder behind\n"
              "set object 2 rectangle from %.9g,%.9g to %.9g,0 fillcolor rgb '#8a8f98' fillstyle "
              "solid 1.0 noborder behind\n",
              left, v->upper[0], v->lower[1], v->upper[1], s->length, s->length + s->wall_thickness,
              s->wall_height, left, -2.0 * s->spacing, s->length + s->wall_thickness);
  plot_colours(f, 0.0, 1.35e-3 * WAVES_DENSITY * WAVES_G * s->depth, v->least, v->most);
}

/* Frame k; the piston is a bar behind its face. */
static void plot_water(output *f, const seawall *w, const view *v, int64_t k, const char *note) {
  const seawall_settings *s = &w->s;
  const seawall_frame *frame = &w->frame[k];
  output_text(f,
              "set object 3 rectangle from %.9g,0 to %.9g,%.9g fillcolor rgb '#c0392b' fillstyle "
              "solid 1.0 noborder behind\nset title 't = %.2f s%s' offset 0,-0.6\nplot ",
              frame->piston - 2.0 * s->spacing, frame->piston, s->wall_height, frame->t, note);
  area_plot(f, "frames.bin", &v->image[k], 1.0);
  output_text(f, "\n");
}

/* The frame that is nearest to the largest force on the wall after the start; -1 without one. */
static int64_t crest_frame(const seawall *w) {
  int64_t best = -1;
  double most = -INFINITY, at = NAN;
  for (int64_t k = 0; k < w->samples; k++)
    if (w->sample[k].t > SEAWALL_IMPULSE && w->sample[k].force > most)
      most = w->sample[k].force, at = w->sample[k].t;
  for (int64_t k = 0; k < w->frames && !isnan(at); k++)
    if (best < 0 || fabs(w->frame[k].t - at) < fabs(w->frame[best].t - at)) best = k;
  return best;
}

/* Figures 9 and 10: the tank at rest, then the last waves; the crest at the wall in the place of
 * the frame that is nearest to it. */
static bool draw_waves(app *a, const seawall *w, const view *v) {
  const double shape = (v->upper[1] - v->lower[1]) / (v->upper[0] - v->lower[0]);
  const int down = PANELS / ACROSS, height = 110 + (int)(600.0 * shape + 95.0) * down;
  const int64_t shown = w->frames < PANELS ? w->frames : PANELS, crest = crest_frame(w);
  const double step = shown > 1 ? (double)(w->frames - 1) / (double)(shown - 1) : 1.0;
  output f;
  if (w->frames == 0) return true;
  if (!plot_open(&f, a, w->s.out, "waves", 1500, height)) return false;
  output_text(&f,
              "set multiplot layout %d,%d columnsfirst margins screen 0.06, screen 0.895, screen "
              "%.4f, screen %.4f spacing screen 0.065, screen %.4f\n",
              down, ACROSS, 85.0 / height, 1.0 - 30.0 / height, 95.0 / height);
  begin_water(&f, &w->s, v);
  output_text(&f, "set colorbox user origin screen 0.925,0.25 size screen 0.012,0.5\n");
  for (int64_t p = 0; p < shown; p++) {
    const bool peak = p > 0 && crest >= 0 && llround((double)crest / step) == p;
    plot_water(&f, w, v, peak ? crest : llround((double)p * step),
               peak ? ", nearest to the largest force" : "");
    if (p == 0) output_text(&f, "unset colorbox\n");
  }
  output_text(&f, "unset multiplot\n");
  return plot_close(&f, w->s.out, "waves");
}

static bool draw_animation(app *a, const seawall *w, const view *v) {
  output f;
  if (w->frames < 3) return true;
  const double step = (w->frame[w->frames - 1].t - w->frame[0].t) / (double)(w->frames - 1);
  const double shape = (v->upper[1] - v->lower[1]) / (v->upper[0] - v->lower[0]);
  const int height = (int)(700.0 * shape) + 110;
  if (!plot_open_animation(&f, a, w->s.out, "animation", STILL_WIDTH, height, step)) return false;
  begin_water(&f, &w->s, v);
  output_text(&f, "set lmargin 8\nset rmargin 14\nset bmargin 3.2\nset tmargin 2\n");
  for (int64_t k = 0; k < w->frames; k++) plot_water(&f, w, v, k, "");
  return plot_close_animation(&f, w->s.out, "animation");
}

/* Figure 11. */
static bool draw_force(app *a, const seawall *w, double H) {
  const seawall_settings *s = &w->s;
  const double k = waves_number(s->period, s->depth);
  output f;
  if (!plot_open(&f, a, s->out, "force", 1100, 560)) return false;
  output_text(&f,
              "set title 'Force of the water on the wall'\nset xlabel 't (s)'\nset ylabel 'force "
              "(N per m of wall)'\n"
              "set xrange [0:%.9g]\nset yrange [0:*]\n",
              s->duration);
  plot_key_below(&f);
  if (!isnan(H))
    output_text(&f, "crest = %.9g\ntrough = %.9g\n", waves_sainflou(k, s->depth, H, 1),
                waves_sainflou(k, s->depth, H, -1));
  output_text(&f, "still = %.9g\nplot ", 0.5 * WAVES_DENSITY * WAVES_G * s->depth * s->depth);
  output_text(&f, "still with lines linecolor rgb '#999999' linewidth 1 title 'water at rest', ");
  if (!isnan(H))
    output_text(
        &f,
        "\\\n  crest with lines dashtype '--' linecolor rgb '#c0392b' title 'Sainflou, crest "
        "(H = %.3f m)', \\\n  trough with lines dashtype '.' linecolor rgb '#c0392b' title "
        "'Sainflou, trough', ",
        H);
  output_text(&f,
              "\\\n  'force.csv' every ::1 using ($1 < %.9g ? NaN : $1):2 with lines linecolor rgb "
              "'#8fb3dd' linewidth 1 title 'MPS', \\\n  '' every ::1 using ($1 < %.9g ? NaN : "
              "$1):3 with lines linecolor rgb '#1f4e8c' "
              "linewidth 1.6 title 'below 10 Hz'\n",
              SEAWALL_IMPULSE, SEAWALL_IMPULSE);
  return plot_close(&f, s->out, "force");
}

/* Figure 12. */
static bool draw_pressure(app *a, const seawall *w, double H) {
  output f;
  if (!plot_open(&f, a, w->s.out, "pressure", 640, 720)) return false;
  output_text(&f,
              "set title 'Pressure on the wall, t = %.2f s'\nset xlabel 'pressure (kPa)'\n"
              "set ylabel 'height above the bed (m)'\nset key top right\nset xrange [0:*]\n"
              "set yrange [0:%.9g]\nset arrow 1 from graph 0, first %.9g to graph 1, first %.9g "
              "nohead linecolor rgb '#4aa3c7'\nset label 1 'water at rest' at graph 0.97, first "
              "%.9g right offset 0,0.6 textcolor rgb '#4aa3c7'\nplot ",
              w->look.at.t, 1.5 * w->s.depth, w->s.depth, w->s.depth, w->s.depth);
  if (!isnan(H))
    output_text(&f,
                "'pressure.csv' every ::1 using ($3*1e-3):1 with lines dashtype '--' linecolor rgb "
                "'#c0392b' title 'Sainflou, H = %.3f m', \\\n  ",
                H);
  output_text(&f,
              "'pressure.csv' every ::1 using ($2*1e-3):1 with points pointtype 7 pointsize 0.9 "
              "linecolor rgb '#1f4e8c' title 'MPS'\n");
  return plot_close(&f, w->s.out, "pressure");
}

/* Figure 13. */
static bool draw_deflection(app *a, const seawall *w) {
  const seawall_settings *s = &w->s;
  const double most = fmax(1e6 * fabs(w->look.at.deflection), 0.02);
  output f;
  if (!plot_open(&f, a, s->out, "deflection", 560, 760)) return false;
  output_text(
      &f,
      "set title 'Wall at t = %.2f s, displacement times 10^6'\nset xlabel 'x (m)'\n"
      "set ylabel 'y (m)'\nset size ratio -1\nset xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n"
      "set xtics 0.1\nset key top left reverse Left\n"
      "set label 1 'crest: %.3g {/Symbol m}m' at %.9g,%.9g center offset 0,1 textcolor rgb "
      "'#1f4e8c'\n"
      "plot 'wall.csv' every ::1 using 1:2 with points pointtype 6 pointsize 0.7 linecolor "
      "rgb '#bbbbbb' title 'unloaded', \\\n"
      "  '' every ::1 using ($1+1e6*$3):($2+1e6*$4) with points pointtype 7 pointsize 0.7 "
      "linecolor rgb '#1f4e8c' title 'bent'\n",
      w->look.at.t, s->length - 0.05, s->length + s->wall_thickness + most + 0.05,
      -2.0 * s->spacing, 1.3 * s->wall_height, 1e6 * w->look.at.deflection,
      s->length + 0.5 * s->wall_thickness + 0.5 * most, 1.06 * s->wall_height);
  return plot_close(&f, s->out, "deflection");
}

bool seawall_draw(app *a, const seawall *w, double H) {
  view v = {.image = NULL};
  choose_section(w, &v);
  const bool good = image_frames(a, w, &v) && draw_waves(a, w, &v) && draw_force(a, w, H) &&
                    draw_pressure(a, w, H) && draw_deflection(a, w) && draw_animation(a, w, &v);
  free(v.image);
  return good;
}
