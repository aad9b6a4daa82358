/* pictures.c - Chikazawa's Figures 9 to 13 anew: the tank and the waves in it, the force on the
 * wall in time, its pressures and its bending at the crest; and the waves as an animation.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "seawall.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

enum { PANELS = 6 };

/* The section that is shown, m: with the piston, the wall and the splash, up to three depths. */
typedef struct view {
  area_def def;
  area *image; /* of each frame, in frames.bin */
} view;

static void choose_section(const seawall *w, view *v) {
  const seawall_settings *s = &w->s;
  const double least = fmax(s->wall_height, 1.5 * s->depth);
  float water = 0.0f; /* not a double: gcc 12 for ARM fails on that loop */
  for (int64_t k = 0; k < w->frames; k++)
    for (int64_t i = 0; i < w->frame[k].count; i++)
      water = fmaxf(water, w->frame[k].value[3 * i + 1]);
  const double top = fmax(least, (double)water);
  v->def = (area_def){
      .spacing = s->spacing,
      .slit = AREA_SLIT,
      .lower = {-1.2 * fabs(s->amplitude) - 4.0 * s->spacing, -2.0 * s->spacing},
      .upper = {s->length + s->wall_thickness + 0.02, fmin(top, 3.0 * s->depth) + 2.0 * s->spacing},
      .side = 860,
      .factor = 1e-3};
}

/* Bed, wall and piston as set_water draws them. */
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
    v->def.solid = in_solids, v->def.user = &walls;
    area_write(&f, &v->def, w->frame[k].count, row, &v->image[k]);
  }
  free(row);
  return good && output_close(&f);
}

/* Axes, colours, the wall's outline, and the piston as a bar behind its face. */
static void set_water(output *f, const seawall *w, const view *v) {
  const seawall_settings *s = &w->s;
  const double left = v->def.lower[0], end = s->length + s->wall_thickness;
  area_set(f, "frames.bin", &v->def, w->frames, v->image, 1.0);
  output_text(f,
              "x_name = 'x (m)'; y_name = 'y (m)'; cb_name = 'pressure (kPa)'\npalette = 'water'; "
              "cb_least = 0; cb_most = %.9g\narray piston[%lld]\n",
              1.35e-3 * WAVES_DENSITY * WAVES_G * s->depth, (long long)w->frames);
  for (int64_t k = 0; k < w->frames; k++)
    output_text(f, "piston[%lld] = %.9g\n", (long long)k + 1, w->frame[k].piston);
  output_text(
      f,
      "wall(n, a, b, c, d, colour) = sprintf('set object %%d rectangle from %%g,%%g to "
      "%%g,%%g fillcolor rgb \"%%s\" fillstyle solid 1.0 noborder behind; ', n, a, b, c, d, "
      "colour)\ncover(k) = wall(1, %.9g, 0, %.9g, %.9g, '#8a8f98').wall(2, %.9g, %.9g, %.9g, "
      "0, '#8a8f98').wall(3, piston[frame_of(k) + 1] - %.9g, 0, piston[frame_of(k) + 1], "
      "%.9g, '#c0392b')\n",
      s->length, end, s->wall_height, left, -2.0 * s->spacing, end, 2.0 * s->spacing,
      s->wall_height);
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
  const int64_t shown = w->frames < PANELS ? w->frames : PANELS, crest = crest_frame(w);
  const double step = shown > 1 ? (double)(w->frames - 1) / (double)(shown - 1) : 1.0;
  output f;
  if (w->frames == 0) return true;
  if (!plot_begin(&f, a, w->s.out, "waves")) return false;
  set_water(&f, w, v);
  output_text(&f, "maps = %d\narray chosen[maps]\nframe_of(k) = chosen[k + 1]\n", (int)shown);
  for (int64_t p = 0; p < shown; p++) {
    const bool peak = p > 0 && crest >= 0 && llround((double)crest / step) == p;
    const int64_t k = peak ? crest : llround((double)p * step);
    output_text(&f, "chosen[%d] = %lld; titles[%d] = 't = %.2f s%s'\n", (int)p + 1, (long long)k,
                (int)p + 1, w->frame[k].t, peak ? ", nearest to the largest force" : "");
  }
  return plot_end(&f, w->s.out, "waves", "maps");
}

static bool draw_animation(app *a, const seawall *w, const view *v) {
  output f;
  if (w->frames < 3) return true;
  const double step = (w->frame[w->frames - 1].t - w->frame[0].t) / (double)(w->frames - 1);
  if (!plot_begin(&f, a, w->s.out, "animation.gif")) return false;
  set_water(&f, w, v);
  output_text(&f, "wide = 860; delay = %d\n", (int)fmax(100.0 * step + 0.5, 2.0));
  for (int64_t k = 0; k < w->frames; k++)
    output_text(&f, "titles[%lld] = 't = %.2f s'\n", (long long)k + 1, w->frame[k].t);
  return plot_end(&f, w->s.out, "animation.gif", "animation");
}

/* Figures 11 to 13. */
static bool draw_wall(app *a, const seawall *w, double H) {
  const seawall_settings *s = &w->s;
  const double k = waves_number(s->period, s->depth), t = w->look.at.t;
  return plot_draw(
             a, s->out, "force", "seawall/force",
             "end = %.9g; impulse = %.9g; H = %.9g\nstill = %.9g; crest = %.9g; trough = %.9g",
             s->duration, SEAWALL_IMPULSE, H, 0.5 * WAVES_DENSITY * WAVES_G * s->depth * s->depth,
             isnan(H) ? NAN : waves_sainflou(k, s->depth, H, 1),
             isnan(H) ? NAN : waves_sainflou(k, s->depth, H, -1)) &&
         plot_draw(a, s->out, "pressure", "seawall/pressure", "t = %.9g; depth = %.9g; H = %.9g", t,
                   s->depth, H) &&
         plot_draw(a, s->out, "deflection", "seawall/deflection",
                   "t = %.9g; crest = %.9g; front = %.9g; thickness = %.9g; high = %.9g; spacing = "
                   "%.9g",
                   t, w->look.at.deflection, s->length, s->wall_thickness, s->wall_height,
                   s->spacing);
}

bool seawall_draw(app *a, const seawall *w, double H) {
  view v = {.image = NULL};
  choose_section(w, &v);
  const bool good = image_frames(a, w, &v) && draw_waves(a, w, &v) && draw_wall(a, w, H) &&
                    draw_animation(a, w, &v);
  free(v.image);
  return good;
}
