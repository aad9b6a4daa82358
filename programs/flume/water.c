/* water.c - pictures of the water of mps-flume with its structure and rock: at the largest force,
 * and as an animation of the last periods. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

enum {
  MOVING_SIDE = 800,           /* pixels of a frame of the animation, at most */
  FIRST_END = 3 + FLUME_ROCKS, /* number of an object of gnuplot */
  ROOM_OF_TIC = 26             /* pixels */
};

typedef struct section {
  double lower[2], upper[2]; /* m */
} section;

static bool in_solid(const void *user, double x, double y) {
  const flume *m = user;
  if (m->s.wall == FLUME_VERTICAL && x > m->outlet) return true;
  if (x > m->outlet && y < m->ground[m->grounds - 1][1]) return true; /* the bed continues */
  return flume_is_solid(m, x, y);
}

/* Two depths and a wave length before the structure, or all of the flume. */
static section choose_section(const flume *m) {
  const flume_settings *s = &m->s;
  double top = 1.6 * s->depth, low = 0.0;
  for (int k = 0; k < m->grounds; k++)
    top = fmax(top, 1.15 * m->ground[k][1]), low = fmin(low, m->ground[k][1]);
  for (int k = 0; k < m->shape.body; k++) top = fmax(top, 1.15 * m->shape.body_point[k][1]);
  const double left = flume_is_loaded(m) ? m->toe - m->wave_length - 2.0 * s->depth : 0.0;
  const double reach =
      flume_is_open(m) || !flume_has_body(m) ? m->outlet : m->heel[0] + 4.0 * s->depth;
  return (section){.lower = {fmax(left, -0.2 * s->depth), low - 2.0 * s->spacing},
                   .upper = {fmin(reach, m->outlet) + 2.0 * s->spacing, top}};
}

static bool image(app *a, output *f, const flume *m, const flume_look *look, const section *v,
                  int side, area *out) {
  double *row = malloc(3 * (size_t)(look->count + 1) * sizeof *row);
  if (!row) return app_no_memory(a);
  for (int64_t i = 0; i < 3 * look->count; i++) row[i] = (double)look->value[i];
  const area_def def = {.spacing = m->s.spacing,
                        .slit = AREA_SLIT,
                        .lower = {v->lower[0], v->lower[1]},
                        .upper = {v->upper[0], v->upper[1]},
                        .side = side,
                        .factor = 1e-3,
                        .solid = in_solid,
                        .user = m};
  area_write(f, &def, look->count, row, out);
  free(row);
  return true;
}

static void polygon(output *f, int number, int count, const double *point, const char *style) {
  output_text(f, "set object %d polygon from %.6g,%.6g", number, point[2 * count - 2],
              point[2 * count - 1]);
  for (int k = 0; k < count; k++) output_text(f, " to %.6g,%.6g", point[2 * k], point[2 * k + 1]);
  output_text(f, " %s\n", style);
}

/* Ground and body cover the image, rock is seen through. */
static void draw_solids(output *f, const flume *m, const section *v) {
  static const char solid[] = "fillstyle solid 1.0 border linecolor rgb '#444444' fillcolor rgb "
                              "'#8a8f98' behind";
  double ground[2 * FLUME_POINTS + 8][2] = {{v->lower[0], m->ground[0][1]}};
  int n = 1; /* left of x = 0 the bed continues */
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
            "fillstyle transparent solid 0.35 border linecolor rgb '#5d4a33' fillcolor rgb "
            "'#8b6f47' front");
}

/* Maker and far end where they are at a time. */
static void draw_ends(output *f, const flume *m, const section *v, double t) {
  static const char style[] = "fillstyle solid 1.0 border linecolor rgb '#444444' fillcolor rgb "
                              "'#c9cdd3' behind";
  int64_t k = 0;
  while (k + 1 < m->samples && m->sample[k].t < t - 1e-9) k++;
  if (m->samples == 0) return;
  const double maker = m->sample[k].maker, end = m->outlet - m->sample[k].end;
  if (maker > v->lower[0])
    output_text(f, "set object %d rectangle from %.6g,%.6g to %.6g,%.6g %s\n", FIRST_END,
                v->lower[0], m->ground[0][1], maker, v->upper[1], style);
  if (!flume_is_open(m) && end < v->upper[0])
    output_text(f, "set object %d rectangle from %.6g,%.6g to %.6g,%.6g %s\n", FIRST_END + 1, end,
                m->ground[m->grounds - 1][1], v->upper[0], v->upper[1], style);
}

/* Tics that a picture of `high` pixels has room for: a long flume is a narrow band. */
static void begin(output *f, const flume *m, const section *v, int high, double least,
                  double most) {
  output_text(f,
              "set size ratio -1\nunset grid\nset xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\nset "
              "xlabel 'x (m)'\nset ylabel 'y (m)'\nset ytics %.6g\nset cblabel 'pressure (kPa)' "
              "offset 1.2\nset palette defined (0 '#2c3e8f', 0.35 '#4aa3c7', 0.7 '#b7e0a5', 1 "
              "'#f4d03f')\n",
              v->lower[0], v->upper[0], v->lower[1], v->upper[1],
              plot_tics(v->upper[1] - v->lower[1], fmin(high / (double)ROOM_OF_TIC, 4.0)));
  draw_solids(f, m, v);
  plot_colours(f, least, most, least, most);
  if (high < 6 * ROOM_OF_TIC)
    output_text(f, "set cbtics %.6g\n", plot_tics(most - least, high / (double)ROOM_OF_TIC));
}

static bool draw_still(app *a, const flume *m, const section *v) {
  const double shape = (v->upper[1] - v->lower[1]) / (v->upper[0] - v->lower[0]);
  area picture;
  output f;
  double least, most;
  if (m->look.count == 0) return true;
  if (!output_open(&f, a, m->s.out, "water.bin")) return false;
  const bool good = image(a, &f, m, &m->look, v, AREA_SIDE, &picture);
  if (!output_close(&f) || !good) return false;
  area_range(1, &picture, &least, &most);
  const int high = (int)fmin(fmax(1080.0 * shape, 90.0), 1400.0);
  if (!plot_open(&f, a, m->s.out, "water", 1300, high + 170)) return false;
  output_text(&f, "set title 't = %.2f s%s'\n", m->look.t,
              flume_is_loaded(m) ? ", at the largest force" : "");
  begin(&f, m, v, (int)(990.0 * shape), least, most);
  draw_ends(&f, m, v, m->look.t);
  output_text(&f, "plot ");
  area_plot(&f, "water.bin", &picture, 1.0);
  output_text(&f, "\n");
  return plot_close(&f, m->s.out, "water");
}

static bool draw_frames(app *a, const flume *m, const section *v, const area *picture) {
  const double shape = (v->upper[1] - v->lower[1]) / (v->upper[0] - v->lower[0]);
  const double span = m->frame[m->frames - 1].t - m->frame[0].t;
  const int high = (int)fmin(fmax(760.0 * shape, 70.0), 900.0);
  double least, most;
  output f;
  area_range(m->frames, picture, &least, &most);
  if (!plot_open_animation(&f, a, m->s.out, "animation", 960, high + 150,
                           span / (double)(m->frames - 1)))
    return false;
  begin(&f, m, v, (int)(730.0 * shape), least, most);
  for (int64_t k = 0; k < m->frames; k++) {
    draw_ends(&f, m, v, m->frame[k].t);
    output_text(&f, "set title 't = %.2f s'\nplot ", m->frame[k].t);
    area_plot(&f, "frames.bin", &picture[k], 1.0);
    output_text(&f, "\n");
  }
  return plot_close_animation(&f, m->s.out, "animation");
}

static bool animate(app *a, const flume *m, const section *v) {
  output f;
  if (m->frames < 3) return true;
  area *picture = calloc((size_t)m->frames, sizeof *picture);
  if (!picture) return app_no_memory(a);
  bool good = output_open(&f, a, m->s.out, "frames.bin");
  for (int64_t k = 0; good && k < m->frames; k++)
    good = image(a, &f, m, &m->frame[k], v, MOVING_SIDE, &picture[k]);
  good = output_close(&f) && good && draw_frames(a, m, v, picture);
  free(picture);
  return good;
}

bool flume_draw_water(app *a, const flume *m) {
  const section v = choose_section(m);
  return draw_still(a, m, &v) && animate(a, m, &v);
}
