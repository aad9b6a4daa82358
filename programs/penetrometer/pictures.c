/* pictures.c - force.png: force along the path, of both runs and by theory; section.png: the soil
 * in the vertical section through the axis, the axisymmetric run to the left.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

static const char *title_of(const penetrometer *p) {
  static const char *const titles[3][5] = {
      {"Cone in clay", "Cone in sand", "Cone in elastic ground", "Cone in clay (Tresca)",
       "Cone in Cam-Clay"},
      {"Sphere in clay", "Sphere in sand", "Sphere in elastic ground", "Sphere in clay (Tresca)",
       "Sphere in Cam-Clay"},
      {"Mesh in clay", "Mesh in sand", "Mesh in elastic ground", "Mesh in clay (Tresca)",
       "Mesh in Cam-Clay"}};
  return titles[p->s.tip][p->s.law];
}

static void plot_curve(output *f, const char *file, int column, double unit, const char *style,
                       const char *title) {
  output_text(f, "'%s' every ::1 using (1e3*$1):($%d/%.9g) with lines %s title '%s', \\\n  ", file,
              column, unit, style, title);
}

static bool draw_force(app *a, const penetrometer *p) {
  const bool clay = p->s.law == PEN_CLAY || p->s.law == PEN_TRESCA;
  const bool hertz = p->s.law == PEN_ELASTIC && p->s.tip == PEN_SPHERE;
  const bool space = p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE;
  const double unit = clay ? PEN_PI * pen_radius(p) * pen_radius(p) * p->s.cohesion : 1e3;
  output f;
  if (!plot_open(&f, a, p->s.out, "force", 1000, 680)) return false;
  output_text(&f,
              "set title \"%s\\n{/*0.85 diameter %g m, h = %g m, %g m/s, {/Symbol m} = %g}\"\n"
              "set xlabel 'depth of the lowest point (mm)'\nset ylabel '%s'\n"
              "set key left top Left reverse opaque\n",
              title_of(p), p->s.diameter, p->s.h, p->s.rate, p->s.friction,
              clay ? "force over c {/Symbol p}D^2/4" : "force (kN)");
  /* a run that ends above the ground has nothing to scale the axes by */
  output_text(&f, "%s\nplot ",
              pen_reached(&p->run[0]) <= 0.0 ? "set xrange [0:1]\nset yrange [0:1]"
              : p->s.start > 0.0             ? "set yrange [0:*]"
                                             : "set xrange [0:*]\nset yrange [0:*]");
  plot_curve(&f, "force.csv", 2, unit, "linecolor rgb '#bbbbbb' linewidth 0.7", "every row");
  if (p->runs == 2)
    plot_curve(&f, "force-axisymmetric.csv", 5, unit, "linecolor rgb '#c0392b' linewidth 1.6",
               "total, axisymmetric");
  plot_curve(&f, "force.csv", 5, unit, "linecolor rgb '#1f4e8c' linewidth 1.6",
             space ? "total, in space" : "total, axisymmetric");
  if (p->s.tip == PEN_CONE && p->s.friction > 0.0) {
    plot_curve(&f, "force.csv", 6, unit, "dashtype 2 linecolor rgb '#1f4e8c'", "its tip");
    plot_curve(&f, "force.csv", 7, unit, "dashtype 3 linecolor rgb '#2e8b57'", "its shaft");
  }
  if (hertz)
    output_text(&f, "%.9g*(1e-3*x)**1.5 dashtype '--' linecolor black title 'Hertz, half space'\n",
                pen_hertz(p, 1.0) / unit);
  else
    output_text(&f, "1/0 notitle\n");
  return plot_close(&f, p->s.out, "force");
}

/* ---- section --------------------------------------------------------------------------------- */

/* The outline of cone or sphere in front of the soil; of a mesh none. */
static void draw_outline(output *f, const penetrometer *p, double top) {
  const double R = pen_radius(p), tip = -pen_reached(&p->run[0]), shoulder = tip + pen_shoulder(p);
  static const char *const look = "fillcolor rgb '#555555' fillstyle solid noborder front";
  if (p->s.tip == PEN_SPHERE)
    output_text(f, "set object 1 circle at 0,%.9g size first %.9g %s\n", tip + R, R, look);
  if (p->s.tip == PEN_CONE)
    output_text(f,
                "set object 1 polygon from 0,%.9g to %.9g,%.9g to %.9g,%.9g to %.9g,%.9g to "
                "%.9g,%.9g to 0,%.9g %s\n",
                tip, R, shoulder, R, fmax(top, shoulder), -R, fmax(top, shoulder), -R, shoulder,
                tip, look);
}

/* The same area. */
static bool in_tip(const void *user, double x, double z) {
  const penetrometer *p = user;
  const double R = pen_radius(p), over = z + pen_reached(&p->run[0]), cone = pen_shoulder(p);
  if (p->s.tip == PEN_SPHERE) return hypot(x, over - R) < R;
  return p->s.tip == PEN_CONE && over > 0.0 && fabs(x) < fmin(R, R * over / cone);
}

/* A value that all but a few of the points stay below. */
static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double most_of(const pen_run *r, bool strain) {
  double *value = malloc((size_t)(r->points + 1) * sizeof *value), most = 1.0;
  if (!value) return most;
  for (int64_t i = 0; i < r->points; i++)
    value[i] = strain ? r->point[i].strain : r->point[i].moved;
  qsort(value, (size_t)r->points, sizeof *value, ascending);
  if (r->points > 0) most = value[(r->points - 1) * 997 / 1000];
  free(value);
  return most > 0.0 ? most : 1.0;
}

/* A round distance of tics: two or three on `length`. */
static double tics_of(double length) {
  const double ten = pow(10.0, floor(log10(0.5 * length))), lead = 0.5 * length / ten;
  return ten * (lead < 2.0 ? 1.0 : lead < 5.0 ? 2.0 : 5.0);
}

/* displacement.bin (m) and plastic_strain.bin: the section of all runs. */
static bool image_section(app *a, const penetrometer *p, bool strain, const double *lower,
                          const double *upper, area *image) {
  output f;
  int64_t count = 0;
  double spacing = 0.0;
  for (int k = 0; k < p->runs; k++) {
    count += p->run[k].points;
    spacing = fmax(spacing, mps_particles_spacing(p->run[k].m.particles));
  }
  double *row = malloc((size_t)(count + 1) * 3 * sizeof *row), *end = row;
  if (!row) return app_no_memory(a);
  for (int k = 0; k < p->runs; k++)
    for (int64_t i = 0; i < p->run[k].points; i++, end += 3) {
      const pen_point *point = &p->run[k].point[i];
      end[0] = point->x, end[1] = point->z, end[2] = strain ? point->strain : point->moved;
    }
  const bool good =
      output_open(&f, a, p->s.out, strain ? "plastic_strain.bin" : "displacement.bin");
  const area_def def = {.spacing = spacing,
                        .slit = AREA_SLIT_SHEARED,
                        .lower = {lower[0], lower[1]},
                        .upper = {upper[0], upper[1]},
                        .walled = true,
                        .side = AREA_SIDE,
                        .solid = in_tip,
                        .user = p};
  if (good) area_write(&f, &def, count, row, image);
  free(row);
  return good && output_close(&f);
}

static bool draw_section(app *a, const penetrometer *p) {
  const double R = pen_radius(p);
  const double side = fmin(p->run[0].size[0], fmax(3.0 * R, p->s.depth));
  const double top = 0.6 * fmin(R, p->s.depth) + 2.0 * p->s.h;
  const double bottom = -fmin(p->run[0].size[p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE ? 2 : 1],
                              p->s.depth + 3.0 * R);
  const bool both =
      p->runs == 2 || (p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE && p->s.model == PEN_WHOLE);
  const bool axial = p->run[0].geometry != MPS_MPM_GEOMETRY_SPACE;
  const double left = both || axial ? -side : 0.0, right = axial ? 0.0 : side;
  const double pixels = 600.0, scale = pixels / (top - bottom);
  const int panel = (int)(scale * (right - left)), width = 2 * (panel + 240), height = 800;
  const bool plastic = p->s.law != PEN_ELASTIC;
  const double lower[2] = {left, bottom}, upper[2] = {right, top};
  area image[2] = {{.offset = 0}};
  for (int k = 0; k < (plastic ? 2 : 1); k++)
    if (!image_section(a, p, k == 1, lower, upper, &image[k])) return false;
  output f;
  if (!plot_open(&f, a, p->s.out, "section", plastic ? width : width / 2, height)) return false;
  const double wide = plastic ? width : width / 2;
  output_text(
      &f,
      "set multiplot title '%s' font ',18'\n"
      "set palette defined (0 '#e6ebf1', 0.15 '#c6dbef', 0.4 '#6baed6', 0.7 '#2171b5', 1 "
      "'#08306b')\nset xlabel '%s'\nset ylabel 'z (m)' offset 1\nset xrange [%.9g:%.9g]\nset "
      "yrange "
      "[%.9g:%.9g]\nset xtics %.9g\nset tmargin at screen %.4g\nset bmargin at screen %.4g\n",
      title_of(p), p->runs == 2 ? "axisymmetric |  x (m)  | in space" : "x (m)", left, right,
      bottom, top, tics_of(side), 0.87, 0.87 - pixels / height);
  draw_outline(&f, p, top);
  for (int k = 0; k < (plastic ? 2 : 1); k++) {
    const double from = 115.0 + k * (panel + 240.0);
    output_text(&f,
                "set lmargin at screen %.4g\nset rmargin at screen %.4g\nset title '%s'\n"
                "set colorbox user origin screen %.4g, screen 0.3 size screen %.4g, screen 0.4\n",
                from / wide, (from + panel) / wide, k ? "Plastic strain (-)" : "Displacement (m)",
                (from + panel + 18.0) / wide, 16.0 / wide);
    plot_colours(&f, 0.0, most_of(&p->run[0], k), image[k].least, image[k].most);
    output_text(&f, "plot ");
    area_plot(&f, k ? "plastic_strain.bin" : "displacement.bin", &image[k], 1.0);
    output_text(&f, "\nset ylabel ''\n");
  }
  output_text(&f, "unset multiplot\n");
  return plot_close(&f, p->s.out, "section");
}

bool pen_draw(app *a, const penetrometer *p) {
  return p->run[0].rows == 0 || (draw_force(a, p) && draw_section(a, p));
}
