/* water.c - pictures of the water of mps-flume with its structure and rock: at the largest force,
 * and as an animation of the last periods. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

enum {
  MOVING_SIDE = 800,          /* pixels of a frame of the animation, at most */
  FIRST_END = 3 + FLUME_ROCKS /* number of an object of gnuplot */
};

static bool in_solid(const void *user, double x, double y) {
  const flume *m = user;
  if (m->s.wall == FLUME_VERTICAL && x > m->outlet) return true;
  if (x > m->outlet && y < m->ground[m->grounds - 1][1]) return true; /* the bed continues */
  return flume_is_solid(m, x, y);
}

/* Two depths and a wave length before the structure, or all of the flume. */
static area_def choose_section(const flume *m) {
  const flume_settings *s = &m->s;
  double top = 1.6 * s->depth, low = 0.0;
  for (int k = 0; k < m->grounds; k++)
    top = fmax(top, 1.15 * m->ground[k][1]), low = fmin(low, m->ground[k][1]);
  for (int k = 0; k < m->shape.body; k++) top = fmax(top, 1.15 * m->shape.body_point[k][1]);
  const double left = flume_is_loaded(m) ? m->toe - m->wave_length - 2.0 * s->depth : 0.0;
  const double reach =
      flume_is_open(m) || !flume_has_body(m) ? m->outlet : m->heel[0] + 4.0 * s->depth;
  return (area_def){.spacing = s->spacing,
                    .slit = AREA_SLIT,
                    .lower = {fmax(left, -0.2 * s->depth), low - 2.0 * s->spacing},
                    .upper = {fmin(reach, m->outlet) + 2.0 * s->spacing, top},
                    .side = AREA_SIDE,
                    .factor = 1e-3,
                    .solid = in_solid,
                    .user = m};
}

static bool image(app *a, output *f, const flume_look *look, const area_def *def, area *out) {
  double *row = malloc(3 * (size_t)(look->count + 1) * sizeof *row);
  if (!row) return app_no_memory(a);
  for (int64_t i = 0; i < 3 * look->count; i++) row[i] = (double)look->value[i];
  area_write(f, def, look->count, row, out);
  free(row);
  return true;
}

static void polygon(output *f, int number, int count, const double *point, const char *style) {
  output_text(f, "set object %d polygon from %.6g,%.6g", number, point[2 * count - 2],
              point[2 * count - 1]);
  for (int k = 0; k < count; k++) output_text(f, " to %.6g,%.6g", point[2 * k], point[2 * k + 1]);
  output_text(f, " %s; ", style);
}

/* Ground and body cover the image, rock is seen through. */
static void draw_solids(output *f, const flume *m, const area_def *v) {
  static const char solid[] = "fillstyle solid 1.0 border linecolor rgb \"#444444\" fillcolor "
                              "rgb \"#8a8f98\" behind";
  double ground[2 * FLUME_POINTS + 8][2] = {{v->lower[0], m->ground[0][1]}};
  int n = 1; /* left of x = 0 the bed continues */
  output_text(f, "fixed = '");
  for (int k = 0; k < m->grounds; k++) {
    const double *p = m->ground[k], *q = m->ground[k + 1 < m->grounds ? k + 1 : k];
    if (p[0] < v->lower[0]) { /* the section begins on this segment, or behind it */
      if (q[0] > v->lower[0])
        ground[0][1] = p[1] + (q[1] - p[1]) * (v->lower[0] - p[0]) / (q[0] - p[0]);
      continue;
    }
    ground[n][0] = fmin(p[0], v->upper[0]), ground[n++][1] = p[1];
  }
  ground[n][0] = v->upper[0], ground[n++][1] = m->ground[m->grounds - 1][1];
  ground[n][0] = v->upper[0], ground[n++][1] = v->lower[1];
  ground[n][0] = v->lower[0], ground[n++][1] = v->lower[1];
  polygon(f, 1, n, ground[0], solid);
  if (flume_has_body(m)) polygon(f, 2, m->shape.body, m->shape.body_point[0], solid);
  for (int k = 0; k < m->shape.rocks; k++)
    polygon(f, 3 + k, m->shape.rock[k].corners, m->shape.rock[k].corner[0],
            "fillstyle transparent solid 0.35 border linecolor rgb \"#5d4a33\" fillcolor rgb "
            "\"#8b6f47\" front");
  output_text(f, "'\n");
}

/* ends[k]: maker and far end where they are at a time. */
static void set_ends(output *f, const flume *m, const area_def *v, int64_t number, double t) {
  static const char style[] = "fillstyle solid 1.0 border linecolor rgb \"#444444\" fillcolor rgb "
                              "\"#c9cdd3\" behind; ";
  int64_t k = 0;
  while (k + 1 < m->samples && m->sample[k].t < t - 1e-9) k++;
  const double maker = m->samples ? m->sample[k].maker : -INFINITY;
  const double end = m->samples ? m->outlet - m->sample[k].end : INFINITY;
  output_text(f, "ends[%lld] = '", (long long)number);
  if (maker > v->lower[0])
    output_text(f, "set object %d rectangle from %.6g,%.6g to %.6g,%.6g %s", FIRST_END, v->lower[0],
                m->ground[0][1], maker, v->upper[1], style);
  if (!flume_is_open(m) && end < v->upper[0])
    output_text(f, "set object %d rectangle from %.6g,%.6g to %.6g,%.6g %s", FIRST_END + 1, end,
                m->ground[m->grounds - 1][1], v->upper[0], v->upper[1], style);
  output_text(f, "'\n");
}

static void set_section(output *f, const flume *m, const area_def *v, const char *file,
                        int64_t count, const area *picture) {
  area_set(f, file, v, count, picture, 1.0);
  draw_solids(f, m, v);
  output_text(f, "array ends[maps]\ncover(k) = fixed.ends[k + 1]\nx_name = 'x (m)'; y_name = 'y "
                 "(m)'; cb_name = 'pressure (kPa)'\npalette = 'water'; cb_least = cb_lowest; "
                 "cb_most = cb_highest\n");
}

static bool draw_still(app *a, const flume *m, const area_def *v) {
  area picture;
  output f;
  if (m->look.count == 0) return true;
  if (!output_open(&f, a, m->s.out, "water.bin")) return false;
  const bool good = image(a, &f, &m->look, v, &picture);
  if (!output_close(&f) || !good || !plot_begin(&f, a, m->s.out, "water")) return false;
  set_section(&f, m, v, "water.bin", 1, &picture);
  output_text(&f, "titles[1] = 't = %.2f s%s'\n", m->look.t,
              flume_is_loaded(m) ? ", at the largest force" : "");
  set_ends(&f, m, v, 1, m->look.t);
  return plot_end(&f, m->s.out, "water", "maps");
}

static bool draw_frames(app *a, const flume *m, const area_def *v, const area *picture) {
  const double span = m->frame[m->frames - 1].t - m->frame[0].t;
  output f;
  if (!plot_begin(&f, a, m->s.out, "animation.gif")) return false;
  set_section(&f, m, v, "frames.bin", m->frames, picture);
  output_text(&f, "wide = 960; delay = %d\n",
              (int)fmax(100.0 * span / (double)(m->frames - 1) + 0.5, 2.0));
  for (int64_t k = 0; k < m->frames; k++) {
    output_text(&f, "titles[%lld] = 't = %.2f s'\n", (long long)k + 1, m->frame[k].t);
    set_ends(&f, m, v, k + 1, m->frame[k].t);
  }
  return plot_end(&f, m->s.out, "animation.gif", "animation");
}

static bool animate(app *a, const flume *m, const area_def *v) {
  area_def moving = *v;
  output f;
  if (m->frames < 3) return true;
  area *picture = calloc((size_t)m->frames, sizeof *picture);
  if (!picture) return app_no_memory(a);
  moving.side = MOVING_SIDE;
  bool good = output_open(&f, a, m->s.out, "frames.bin");
  for (int64_t k = 0; good && k < m->frames; k++)
    good = image(a, &f, &m->frame[k], &moving, &picture[k]);
  good = output_close(&f) && good && draw_frames(a, m, &moving, picture);
  free(picture);
  return good;
}

bool flume_draw_water(app *a, const flume *m) {
  const area_def v = choose_section(m);
  return draw_still(a, m, &v) && animate(a, m, &v);
}
