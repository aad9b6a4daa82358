/* pictures.c - pile.png: load and plug along the path (Nakamura, Figure 23) and the soil at the
 * end; and the soil around the pile at some depths, one picture a quantity (Figures 24 and 25).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

/* Upper bound of all but a few of the soil's particles: the colour scale ignores single particles
 * under a corner. */
static int ascending(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

static double most_of(const pile *p, const pile_frame *frame, int field, double share) {
  const int64_t count = p->particles;
  float *value = malloc((size_t)count * sizeof *value);
  if (!value) return NAN;
  for (int64_t k = 0; k < count; k++) value[k] = fabsf(frame->value[k * FIELDS + field]);
  qsort(value, (size_t)count, sizeof *value, ascending);
  const double most = (double)value[(int64_t)(share * (double)(count - 1))];
  free(value);
  return most;
}

/* ---- along the path -------------------------------------------------------------------------- */

/* Places the next plot: fractions of the picture's width. */
static void place(output *f, double left, double right) {
  output_text(f,
              "set lmargin at screen %.4g\nset rmargin at screen %.4g\nset tmargin at screen 0.83\n"
              "set bmargin at screen 0.2\n",
              left, right);
}

/* Columns of load.csv, and the line that each is. */
static const struct line {
  const char *title, *colour, *dash;
  int column;
} lines[] = {{"total", "#222222", "solid", 6},
             {"tip", "#c0392b", "solid", 7},
             {"inside", "#1f4e8c", "solid", 8},
             {"outside", "#2e8b57", "solid", 9},
             {"- - outside, K_0 {/Symbol s}_v {/Symbol m}", "#2e8b57", "'--'", 13}};

static void plot_load(output *f, const pile *p, int width) {
  const size_t count = sizeof lines / sizeof *lines;
  double left = 125.0;
  for (size_t k = 0; k < count; k++, left += 95.0)
    output_text(f, "set label %d '%s' at screen %.4g,0.05 textcolor rgb '%s'\n", (int)k + 1,
                lines[k].title, left / width, lines[k].colour);
  output_text(
      f,
      "set title 'Load'\nset xlabel 'force (kN)'\nset ylabel 'depth of the tip (m)' offset 1\n"
      "set xrange [0:*]\nset yrange [%.9g:0]\nunset key\n"
      "plot 'load.csv' every ::1 using ($2/1e3):1 with lines linecolor rgb '#999999' "
      "linewidth 0.7",
      p->s.depth);
  for (size_t k = 0; k < count; k++)
    output_text(f,
                ", \\\n  '' every ::1 using ($%d/1e3):1 with lines dashtype %s linecolor rgb '%s'",
                lines[k].column, lines[k].dash, lines[k].colour);
  output_text(f, "\nunset label\n");
}

static void plot_plug(output *f) {
  output_text(f,
              "set title 'Soil inside'\nset xlabel 'its top above the tip (m)'\nset ylabel ''\n"
              "set key right top opaque\n"
              "plot 'load.csv' every ::1 using 11:1 with lines linecolor rgb '#1f4e8c' "
              "linewidth 1.6 title 'plug', \\\n"
              "  '' every ::1 using 1:1 with lines dashtype '--' linecolor rgb '#888888' title 'no "
              "plugging'\n");
}

/* ---- soil ------------------------------------------------------------------------------------ */

typedef struct quantity {
  const char *name, *title;
  int field;
  double factor; /* of fields-N.csv over the frame's value: Pa to kPa, pressure positive */
  double share;  /* of the particles that the colours reach */
} quantity;

static const quantity mean_stress = {"mean_stress", "Mean pressure (kPa)", FIELD_MEAN, -1e-3,
                                     0.995};
static const quantity deviatoric_stress = {"deviatoric_stress", "Deviatoric stress (kPa)",
                                           FIELD_DEVIATOR, 1e-3, 0.995};
static const quantity shear_strain = {"shear_strain", "Plastic shear strain (-)", FIELD_STRAIN, 1.0,
                                      0.97};

/* The part of the section that is shown, m. */
static double section_top(const pile *p) { return 0.08 * p->s.depth + 4.0 * p->s.h; }
static double section_bottom(const pile *p) {
  return -fmin(p->s.height, p->s.depth + 3.0 * p->s.inner_diameter);
}

/* Picture of a quantity: NAME.bin has the soil of all frames. */
typedef struct section {
  const quantity *q;
  char file[40];
  area *image;        /* of each frame */
  double least, most; /* of the last one */
} section;

typedef struct wall {
  double inner, outer, tip; /* m */
} wall;

static bool in_wall(const void *user, double r, double z) {
  const wall *w = user;
  return r > w->inner && r < w->outer && z > w->tip;
}

static bool image_sections(app *a, const pile *p, const quantity *q, section *x) {
  output f;
  *x = (section){.q = q, .image = calloc((size_t)p->frames_kept + 1, sizeof *x->image)};
  snprintf(x->file, sizeof x->file, "%s.bin", q->name);
  double *row = malloc((size_t)p->particles * 3 * sizeof *row);
  if (!row || !x->image) {
    free(row);
    return app_no_memory(a);
  }
  const bool good = output_open(&f, a, p->s.out, x->file);
  for (int64_t n = 0; good && n < p->frames_kept; n++) {
    for (int64_t k = 0; k < p->particles; k++) {
      const float *value = p->frame[n].value + k * FIELDS;
      row[3 * k] = (double)value[FIELD_R];
      row[3 * k + 1] = (double)value[FIELD_Z];
      row[3 * k + 2] = (double)value[q->field];
    }
    const wall pipe = {p->inner, p->outer, -p->frame[n].depth};
    const area_def def = {.spacing = mps_particles_spacing(p->m.particles),
                          .slit = AREA_SLIT_SHEARED,
                          .lower = {0.0, section_bottom(p)},
                          .upper = {p->s.width, section_top(p)},
                          .walled = true,
                          .side = AREA_SIDE,
                          .factor = q->factor,
                          .solid = in_wall,
                          .user = &pipe};
    area_write(&f, &def, p->particles, row, &x->image[n]);
  }
  free(row);
  area_range(1, &x->image[p->frames_kept - 1], &x->least, &x->most);
  return good && output_close(&f);
}

/* `panel`: pixels across. */
static void begin_sections(output *f, const pile *p, const section *x, int panel) {
  const quantity *q = x->q;
  const pile_frame *last = &p->frame[p->frames_kept - 1];
  output_text(f,
              "set palette defined (0 '#e6ebf1', 0.15 '#c6dbef', 0.4 '#6baed6', 0.7 '#2171b5', 1 "
              "'#08306b')\nset size ratio -1\nset xtics %.9g\n"
              "set xlabel 'r (m)'\nset ylabel 'z (m)' offset 1.5\nset xrange [0:%.9g]\nset yrange "
              "[%.9g:%.9g]\n",
              plot_tics(p->s.width, panel / 45.0), p->s.width, section_bottom(p), section_top(p));
  plot_colours(f, 0.0, fabs(q->factor) * most_of(p, last, q->field, q->share), x->least, x->most);
}

/* Half a section with the wall, r to the right. */
static void plot_section(output *f, const pile *p, const section *x, int64_t frame) {
  output_text(
      f,
      "set object 1 rectangle from %.9g,%.9g to %.9g,%.9g fillcolor rgb '#555555' fillstyle "
      "solid noborder front\nplot ",
      p->inner, -p->frame[frame].depth, p->outer, section_top(p));
  area_plot(f, x->file, &x->image[frame], 1.0);
  output_text(f, "\n");
}

static bool draw_sections(app *a, const pile *p, const section *x) {
  const quantity *q = x->q;
  output f;
  const double high = section_top(p) - section_bottom(p), pixels = 700.0;
  const int count = (int)p->frames_kept, panel = (int)(pixels * p->s.width / high);
  const int width = count * (panel + 70) + 200;
  if (!plot_open(&f, a, p->s.out, q->name, width, 850)) return false;
  output_text(&f,
              "set multiplot layout 1,%d title '%s' font ',18' margins screen %.4g, screen %.4g, "
              "screen 0.105, screen 0.885 spacing screen %.4g, screen 0\nunset colorbox\n",
              count, q->title, 100.0 / width, 1.0 - 160.0 / width, 70.0 / width);
  begin_sections(&f, p, x, panel);
  for (int k = 0; k < count; k++) {
    if (k == count - 1)
      output_text(
          &f, "set colorbox user origin screen %.4g, screen 0.15 size screen %.4g, screen 0.6\n",
          1.0 - 130.0 / width, 22.0 / width);
    if (k == 1) output_text(&f, "set ylabel ''\n");
    output_text(&f, "set title 'tip at %.3f m'\n", p->frame[k].depth);
    plot_section(&f, p, x, k);
  }
  output_text(&f, "unset multiplot\n");
  return plot_close(&f, p->s.out, q->name);
}

/* ---- all in one ------------------------------------------------------------------------------ */

static bool draw_overview(app *a, const pile *p, const section *stress, const section *strain) {
  output f;
  const double high = section_top(p) - section_bottom(p), pixels = 0.63 * 760.0;
  const int panel = (int)(pixels * p->s.width / high), width = 1080 + 2 * (panel + 210);
  if (!plot_open(&f, a, p->s.out, "pile", width, 760)) return false;
  output_text(
      &f,
      "set multiplot title \"Open-ended pile, inner diameter %g m, wall %g mm, to %g m at %g "
      "m/s\\n{/*0.8 h = %g mm, %lld particles, {/Symbol f} = %g degrees (%s cone), "
      "{/Symbol m} = %g}\" font ',18'\n",
      p->s.inner_diameter, 1e3 * p->s.wall, p->s.depth, p->s.rate, 1e3 * p->s.h,
      (long long)p->particles, p->s.phi, pile_cone_name(&p->s), p->s.friction);
  place(&f, 125.0 / width, 535.0 / width);
  plot_load(&f, p, width);
  place(&f, 615.0 / width, 1005.0 / width);
  plot_plug(&f);
  const section *const shown[2] = {stress, strain};
  for (int k = 0; k < 2; k++) {
    const double left = 1110.0 + k * (panel + 210.0);
    place(&f, left / width, (left + panel) / width);
    output_text(
        &f,
        "set title '%s'\nset colorbox user origin screen %.4g, screen 0.3 size screen %.4g, "
        "screen 0.4\n",
        shown[k]->q->title, (left + panel + 18.0) / width, 16.0 / width);
    begin_sections(&f, p, shown[k], panel);
    plot_section(&f, p, shown[k], p->frames_kept - 1);
  }
  output_text(&f, "unset multiplot\n");
  return plot_close(&f, p->s.out, "pile");
}

bool pile_draw(app *a, const pile *p) {
  if (p->frames_kept == 0 || p->rows == 0) return true;
  static const quantity *const all[3] = {&mean_stress, &deviatoric_stress, &shear_strain};
  section x[3] = {{.q = NULL}};
  bool good = true;
  for (int k = 0; k < 3; k++) good = good && image_sections(a, p, all[k], &x[k]);
  good = good && draw_overview(a, p, &x[0], &x[2]);
  for (int k = 0; k < 3; k++) good = good && draw_sections(a, p, &x[k]);
  for (int k = 0; k < 3; k++) free(x[k].image);
  return good;
}
