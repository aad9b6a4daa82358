/* results.c - tables, summary and pictures of mps-plate.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "plate.h"

#include "common/area.h"
#include "common/frame.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

/* ---- tables ---------------------------------------------------------------------------------- */

static bool write_particles(const plate *p, const char *directory) {
  output f;
  if (!csv_open(&f, p->a, directory, "particles.csv",
                "x_m,y_m,u_m,v_m,xx_Pa,xx_exact_Pa,yy_Pa,yy_exact_Pa,xy_Pa,xy_exact_Pa,"
                "von_mises_Pa"))
    return false;
  for (int64_t k = 0; k < mps_particles_count(p->particles); k++) {
    elastic_point at;
    double e[3];
    if (!plate_get(p, k, &at)) return output_close(&f) && false;
    plate_exact_stress(p->def, at.x, e);
    CSV_LINE(&f, at.x[0], at.x[1], at.u[0], at.u[1], at.stress[0], e[0], at.stress[1], e[1],
             at.stress[2], e[2], at.mises);
  }
  return output_close(&f);
}

/* The line that is drawn: the middle row of the plate in tension (u), or the ligament (xx). */
static bool write_line(const plate *p, const char *directory) {
  output f;
  if (!csv_open(&f, p->a, directory, p->def->hole ? "ligament.csv" : "displacement.csv",
                p->def->hole ? "y_m,xx_Pa,xx_exact_Pa" : "x_m,u_m,u_exact_m"))
    return false;
  const double centre[2] = {p->wall, 0.0};
  elastic_point middle = {{0}, {0}, {0}, 0};
  const int64_t id = mps_particles_nearest(p->particles, centre);
  if (!p->def->hole && !plate_get(p, mps_particles_index(p->particles, id), &middle))
    return output_close(&f) && false;
  for (int64_t k = 0; k < mps_particles_count(p->particles); k++) {
    elastic_point at;
    double e[3], u[2];
    if (!plate_get(p, k, &at)) return output_close(&f) && false;
    plate_exact_stress(p->def, at.x, e);
    plate_exact_displacement(p, at.x, u);
    const double across[3] = {at.x[1], at.stress[0], e[0]}, along[3] = {at.x[0], at.u[0], u[0]};
    if (p->def->hole ? plate_on_ligament(p, &at) : fabs(at.x[1] - middle.x[1]) < 0.25 * p->spacing)
      csv_row(&f, 3, p->def->hole ? across : along);
  }
  return output_close(&f);
}

/* Of a plate that is not solved yet all results are null. */
static bool open_summary(output *out, const plate *p, const elastic_method *method,
                         const char *directory) {
  const bool known = p->elastic != NULL;
  output f;
  if (!summary_open(&f, p->a, directory)) return false;
  json_text(&f, "case", p->def->hole ? "hole" : "tension");
  json_text(&f, "method", method->published ? "published" : "conservative");
  json_integer_if(&f, known, "particles", known ? mps_particles_count(p->particles) : 0);
  json_number_if(&f, known, "spacing", p->spacing);
  if (p->def->hole) {
    JSON_NUMBERS(&f, {"concentration", known ? p->concentration : NAN},
                 {"concentration_exact", 3.0},
                 {"largest_principal_over_tension", known ? p->largest : NAN});
  } else {
    JSON_NUMBERS(&f, {"end_displacement", known ? p->end : NAN},
                 {"end_displacement_exact", known ? p->end_exact : NAN},
                 {"displacement_error", known ? p->displacement_error : NAN});
  }
  json_number_if(&f, known, "stress_l2_error", p->stress_error);
  json_integer_if(&f, known, "unknowns", p->report.unknowns);
  json_integer_if(&f, known, "nnz_factor", p->report.factor_nonzeros);
  JSON_NUMBERS(&f, {"seconds_factor", known ? p->report.seconds_factor : NAN},
               {"residual", known ? p->report.residual : NAN});
  json_end(&f);
  *out = f;
  return true;
}

static bool write_summary(const plate *p, const elastic_method *method, const char *directory) {
  output f;
  return open_summary(&f, p, method, directory) && output_close(&f);
}

bool plate_reserve(const plate *p, const elastic_method *method, const char *directory) {
  const char *outcome = p->a->outcome;
  output f;
  p->a->outcome = "interrupted";
  const bool opened = open_summary(&f, p, method, directory);
  p->a->outcome = outcome;
  return opened && output_reserve(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static bool draw_line(const plate *p, const char *directory) {
  if (!p->def->hole)
    return plot_draw(p->a, directory, "displacement", "plate/displacement",
                     "second = '%lld particles, largest error %.1e'",
                     (long long)mps_particles_count(p->particles), p->displacement_error);
  return plot_draw(p->a, directory, "ligament", "plate/ligament",
                   "second = 'radius %.1f spacings, concentration %.3f from the ligament, theory "
                   "3'\nradius = %.9g; end = %.9g",
                   p->def->across, p->concentration, p->def->radius,
                   fmin(3.0 * p->def->radius, p->def->side));
}

/* The stress xx (Pa) around the hole; the plate in tension has one stress only. */
static bool draw_map(const plate *p, const char *directory) {
  const double edge = fmin(3.0 * p->def->radius, p->def->side);
  const area_def def = {
      .spacing = p->spacing, .slit = AREA_SLIT, .upper = {edge, edge}, .side = AREA_SIDE};
  const int64_t count = mps_particles_count(p->particles);
  area image;
  output f;
  double *row = malloc((size_t)(count + 1) * 3 * sizeof *row);
  if (!row) return app_no_memory(p->a);
  bool good = true;
  for (int64_t k = 0; good && k < count; k++) {
    elastic_point at;
    good = plate_get(p, k, &at);
    if (good) row[3 * k] = at.x[0], row[3 * k + 1] = at.x[1], row[3 * k + 2] = at.stress[0];
  }
  good = good && area_image(p->a, directory, "stress.bin", &def, count, row, &image);
  free(row);
  if (!good || !plot_begin(&f, p->a, directory, "stress")) return false;
  area_set(&f, "stress.bin", &def, 1, &image, 1.0);
  output_text(&f,
              "titles[1] = 'Stress in the direction of the tension'\nx_name = 'x (m)'; y_name = 'y "
              "(m)'; cb_name = '{/Symbol s}_x (Pa)'\npalette = 'signed'; cb_least = 0; cb_most = "
              "%.9g\n",
              3.0 * p->def->tension);
  return plot_end(&f, directory, "stress", "maps");
}

bool plate_write(const plate *p, const elastic_method *method, const char *directory) {
  return write_particles(p, directory) && write_line(p, directory) &&
         write_summary(p, method, directory) &&
         frame_write(p->a, p->particles, directory, "plate.vtkhdf") && draw_line(p, directory) &&
         (!p->def->hole || draw_map(p, directory));
}
