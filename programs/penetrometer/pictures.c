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

static bool draw_force(app *a, const penetrometer *p) {
  const bool clay = p->s.law == PEN_CLAY || p->s.law == PEN_TRESCA;
  const bool hertz = p->s.law == PEN_ELASTIC && p->s.tip == PEN_SPHERE;
  return plot_draw(
      a, p->s.out, "force", "penetrometer/force",
      "first = '%s'; second = 'diameter %g m, h = %g m, %g m/s, {/Symbol m} = %g'\nclay = %d; unit "
      "= %.9g; runs = %d; space = %d; parts = %d; hertz = %.9g; above = %d; fallen = %d",
      title_of(p), p->s.diameter, p->s.h, p->s.rate, p->s.friction, clay,
      clay ? PUSH_PI * pen_radius(p) * pen_radius(p) * p->s.cohesion : 1e3, (int)p->runs,
      p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE, p->s.tip == PEN_CONE && p->s.friction > 0.0,
      hertz ? pen_hertz(p, 1.0) : NAN, pen_reached(&p->run[0]) <= 0.0, p->s.start > 0.0);
}

/* ---- section --------------------------------------------------------------------------------- */

/* The outline of cone or sphere in front of the soil; of a mesh none. */
static void set_outline(output *f, const penetrometer *p, double top) {
  const double R = pen_radius(p), tip = -pen_reached(&p->run[0]), shoulder = tip + pen_shoulder(p);
  static const char *const look = "fillcolor rgb \"#555555\" fillstyle solid noborder front";
  if (p->s.tip == PEN_SPHERE)
    output_text(f, "cover(k) = 'set object 1 circle at 0,%.9g size first %.9g %s'\n", tip + R, R,
                look);
  if (p->s.tip == PEN_CONE)
    output_text(f,
                "cover(k) = 'set object 1 polygon from 0,%.9g to %.9g,%.9g to %.9g,%.9g to "
                "%.9g,%.9g to %.9g,%.9g to 0,%.9g %s'\n",
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
static double most_of(const pen_run *r, bool strain) {
  double *value = malloc((size_t)(r->points + 1) * sizeof *value);
  for (int64_t i = 0; value && i < r->points; i++)
    value[i] = strain ? r->point[i].strain : r->point[i].moved;
  const double most = value ? push_most(r->points, value, 0.997) : NAN;
  free(value);
  return most > 0.0 ? most : 1.0;
}

/* DIR/FILE: displacement (m) or plastic strain in the section of all runs. */
static bool image_section(app *a, const penetrometer *p, const char *file, bool strain,
                          const area_def *def, area *image) {
  int64_t count = 0;
  for (int k = 0; k < p->runs; k++) count += p->run[k].points;
  double *row = malloc((size_t)(count + 1) * 3 * sizeof *row), *end = row;
  if (!row) return app_no_memory(a);
  for (int k = 0; k < p->runs; k++)
    for (int64_t i = 0; i < p->run[k].points; i++, end += 3) {
      const pen_point *point = &p->run[k].point[i];
      end[0] = point->x, end[1] = point->z, end[2] = strain ? point->strain : point->moved;
    }
  const bool good = area_image(a, p->s.out, file, def, count, row, image);
  free(row);
  return good;
}

static bool draw_section(app *a, const penetrometer *p) {
  const bool space = p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE;
  const bool both = p->runs == 2 || (space && p->s.model == PEN_WHOLE);
  const double R = pen_radius(p), top = 0.6 * fmin(R, p->s.depth) + 2.0 * p->s.h;
  const double side = fmin(p->run[0].size[0], fmax(3.0 * R, p->s.depth));
  const int quantities = p->s.law == PEN_ELASTIC ? 1 : 2;
  area_def def = {.slit = AREA_SLIT_SHEARED,
                  .lower = {both || !space ? -side : 0.0,
                            -fmin(p->run[0].size[space ? 2 : 1], p->s.depth + 3.0 * R)},
                  .upper = {space ? side : 0.0, top},
                  .walled = true,
                  .side = AREA_SIDE,
                  .solid = in_tip,
                  .user = p};
  for (int k = 0; k < p->runs; k++)
    def.spacing = fmax(def.spacing, mps_particles_spacing(p->run[k].m.particles));
  static const char *const files[] = {"displacement.bin", "plastic_strain.bin"};
  area image[2];
  output f;
  for (int k = 0; k < quantities; k++)
    if (!image_section(a, p, files[k], k == 1, &def, &image[k])) return false;
  if (!plot_begin(&f, a, p->s.out, "section")) return false;
  output_text(&f,
              "first = '%s'; x_name = '%s'; quantities = %d\narray images[2]; array lowest[2]; "
              "array highest[2]; array most[2]\n",
              title_of(p), p->runs == 2 ? "axisymmetric |  x (m)  | in space" : "x (m)",
              quantities);
  for (int k = 0; k < quantities; k++) {
    area_set(&f, files[k], &def, 1, &image[k], 1.0);
    output_text(&f,
                "images[%d] = image; lowest[%d] = cb_lowest; highest[%d] = cb_highest; most[%d] = "
                "%.9g\n",
                k + 1, k + 1, k + 1, k + 1, most_of(&p->run[0], k));
  }
  set_outline(&f, p, top);
  return plot_end(&f, p->s.out, "section", "penetrometer/section");
}

bool pen_draw(app *a, const penetrometer *p) {
  return p->run[0].push.rows == 0 || (draw_force(a, p) && draw_section(a, p));
}
