/* results.c - tables, summary and the paper's Figures 5, 7 and 8 of mps-cantilever.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cantilever.h"

#include "common/area.h"
#include "common/frame.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

/* ---- tables ---------------------------------------------------------------------------------- */

static bool write_deflection(const model *m, const char *directory) {
  output f;
  if (!csv_open(&f, m->a, directory, "deflection.csv", "x_m,y_m,v_m,v_reference_m,error_percent?"))
    return false;
  for (int64_t i = 0; i < m->nx; i++) {
    elastic_point p;
    double u[2];
    if (!model_get(m, i, m->ny / 2, &p)) return output_close(&f) && false;
    model_reference(m, p.x, u);
    CSV_LINE(&f, p.x[0], p.x[1], p.u[1], u[1], 100.0 * (p.u[1] / u[1] - 1.0));
  }
  return output_close(&f);
}

/* Stresses of particles i0..i1, j0..j1. */
static bool write_stress(const model *m, const char *directory, const char *name, int64_t i0,
                         int64_t i1, int64_t j0, int64_t j1) {
  output f;
  if (!csv_open(&f, m->a, directory, name,
                "x_m,y_m,xx_Pa,xx_exact_Pa,yy_Pa,yy_exact_Pa,xy_Pa,xy_exact_Pa,von_mises_Pa,u_m,"
                "v_m"))
    return false;
  for (int64_t i = i0; i <= i1; i++)
    for (int64_t j = j0; j <= j1; j++) {
      elastic_point p;
      double e[3];
      if (!model_get(m, i, j, &p)) return output_close(&f) && false;
      beam_stress(m->problem, p.x[0], p.x[1], e);
      CSV_LINE(&f, p.x[0], p.x[1], p.stress[0], e[0], p.stress[1], e[1], p.stress[2], e[2], p.mises,
               p.u[0], p.u[1]);
    }
  return output_close(&f);
}

/* Of a model that is not solved yet all results are null. */
static bool open_summary(output *out, const model *m, const elastic_method *method,
                         const char *directory) {
  const bool known = m->tip_exact != 0.0;
  output f;
  if (!summary_open(&f, m->a, directory)) return false;
  json_text(&f, "method", method->published ? "published" : "conservative");
  json_text(&f, "state", m->problem->plane_strain ? "strain" : "stress");
  json_text(&f, "reference", m->reference ? "fine bilinear finite elements" : "Chikazawa (11)");
  json_integer(&f, "particles", m->nx * m->ny);
  json_integer_if(&f, known, "unknowns", m->report.unknowns);
  JSON_NUMBERS(&f, {"length", m->problem->length}, {"height", m->problem->height});
  JSON_NUMBERS(&f, {"tip", known ? m->tip : NAN}, {"tip_exact", known ? m->tip_exact : NAN},
               {"tip_error", known ? m->tip_error : NAN},
               {"stress_l2_error", known ? m->stress_error : NAN},
               {"strain_energy", known ? m->energy : NAN},
               {"equilibrium_error", known ? m->equilibrium : NAN},
               {"residual", known ? m->report.residual : NAN});
  json_integer_if(&f, known, "nnz_matrix", m->report.matrix_nonzeros);
  json_integer_if(&f, known, "nnz_factor", m->report.factor_nonzeros);
  JSON_NUMBERS(&f, {"flops_factor", known ? m->report.factor_flops : NAN},
               {"seconds_assemble", known ? m->report.seconds_assemble : NAN},
               {"seconds_analyse", known ? m->report.seconds_analyse : NAN},
               {"seconds_factor", known ? m->report.seconds_factor : NAN},
               {"seconds_solve", known ? m->report.seconds_solve : NAN});
  json_end(&f);
  *out = f;
  return true;
}

static bool write_summary(const model *m, const elastic_method *method, const char *directory) {
  output f;
  return open_summary(&f, m, method, directory) && output_close(&f);
}

bool results_reserve(const model *m, const elastic_method *method, const char *directory) {
  const char *outcome = m->a->outcome;
  output f;
  m->a->outcome = "interrupted";
  const bool opened = open_summary(&f, m, method, directory);
  m->a->outcome = outcome;
  return opened && output_reserve(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

/* von Mises' stress (Pa) of the body with its displacements times `scale`. */
static bool draw_shape(const model *m, const char *directory) {
  const double spacing = m->problem->height / (double)m->ny;
  const double scale = 0.25 * m->problem->length / fabs(m->tip);
  const int64_t count = m->nx * m->ny;
  area_def def = {.spacing = spacing,
                  .slit = AREA_SLIT,
                  .lower = {INFINITY, INFINITY},
                  .upper = {-INFINITY, -INFINITY},
                  .side = AREA_SIDE};
  area image;
  output f;
  double *row = malloc((size_t)count * 3 * sizeof *row);
  if (!row) return app_no_memory(m->a);
  bool good = true;
  for (int64_t k = 0; good && k < count; k++) {
    elastic_point p;
    good = model_get(m, k / m->ny, k % m->ny, &p);
    for (int c = 0; good && c < 2; c++) {
      row[3 * k + c] = p.x[c] + scale * p.u[c];
      def.lower[c] = fmin(def.lower[c], row[3 * k + c] - spacing);
      def.upper[c] = fmax(def.upper[c], row[3 * k + c] + spacing);
    }
    if (good) row[3 * k + 2] = p.mises;
  }
  good = good && area_image(m->a, directory, "shape.bin", &def, count, row, &image);
  free(row);
  if (!good || !plot_begin(&f, m->a, directory, "shape")) return false;
  area_set(&f, "shape.bin", &def, 1, &image, 1.0);
  output_text(&f,
              "titles[1] = 'Displacements times %.3g'\nx_name = 'x (m)'; y_name = 'y (m)'; cb_name "
              "= \"von Mises' stress (Pa)\"\npalette = 'heat'; cb_least = 0; cb_most = "
              "cb_highest\n",
              scale);
  return plot_end(&f, directory, "shape", "maps");
}

static bool draw(const model *m, const char *directory, double y, double x) {
  return plot_draw(m->a, directory, "deflection", "cantilever/deflection",
                   "second = '%lld x %lld particles, tip error %+.2f %%'\nreference = '%s'",
                   (long long)m->nx, (long long)m->ny, 100.0 * m->tip_error,
                   m->reference ? "fine finite elements" : "theory, Chikazawa (11)") &&
         plot_draw(m->a, directory, "stress-axis", "cantilever/stress",
                   "file = 'stress-axis.csv'; first = 'Stresses along y = %.3g m'; along = 'x_m'; "
                   "x_name = 'x (m)'",
                   y) &&
         plot_draw(m->a, directory, "stress-section", "cantilever/stress",
                   "file = 'stress-section.csv'; first = 'Stresses across the section x = %.4g m'; "
                   "along = 'y_m'; x_name = 'y (m)'",
                   x) &&
         draw_shape(m, directory);
}

bool results_write(const model *m, const elastic_method *method, const char *directory) {
  /* The paper's section is at x = 2 of 4. */
  const int64_t middle = m->ny / 2, section = m->nx / 2;
  elastic_point p;
  if (!model_get(m, section, middle, &p)) return false;
  return write_deflection(m, directory) &&
         write_stress(m, directory, "stress.csv", 0, m->nx - 1, 0, m->ny - 1) &&
         write_stress(m, directory, "stress-axis.csv", 0, m->nx - 1, middle, middle) &&
         write_stress(m, directory, "stress-section.csv", section, section, 0, m->ny - 1) &&
         write_summary(m, method, directory) &&
         frame_write(m->a, m->particles, directory, "cantilever.vtkhdf") &&
         draw(m, directory, p.x[1], p.x[0]);
}
