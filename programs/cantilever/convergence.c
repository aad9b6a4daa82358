/* convergence.c - tip error against the number of particles, the paper's Figure 6.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cantilever.h"

#include "common/plot.h"

#include <math.h>
#include <stdio.h>

enum { SIZES = 4, METHODS = 4 };
enum { FINE_X = 193, FINE_Y = 97 }; /* nodes of the reference of a clamped beam */

static const char *const names[METHODS] = {"conservative", "published, re = 3.0",
                                           "published, re = 2.1", "bilinear finite elements"};

static bool particle_error(app *a, const beam *problem, const q4 *reference, int64_t nx, int64_t ny,
                           int method, double *error) {
  elastic_method how = {.def = mps_elastic_defaults(), .published = method != 0};
  model m;
  how.def.state =
      problem->plane_strain ? MPS_ELASTIC_STATE_PLANE_STRAIN : MPS_ELASTIC_STATE_PLANE_STRESS;
  if (method == 2) how.def.radius_ratio = 2.1;
  const bool done = model_solve(a, problem, reference, nx, ny, &how, &m);
  *error = m.tip_error;
  model_free(&m);
  return done;
}

/* Finite elements have nodes on the surfaces: the same number of them makes a beam of its own
 * length with square elements. */
static bool fem_error(app *a, const beam *base, int64_t nx, int64_t ny, double *error) {
  beam problem = *base;
  q4 f, reference = {0};
  double u[2], exact[2];
  problem.length = problem.height * (double)(nx - 1) / (double)(ny - 1);
  if (!q4_solve(&problem, nx, ny, &f)) return app_no_memory(a);
  bool done = true;
  q4_at(&f, 0.0, 0.0, u);
  beam_displacement(&problem, 0.0, 0.0, exact);
  if (problem.clamped && (done = q4_solve(&problem, FINE_X, FINE_Y, &reference)))
    q4_at(&reference, 0.0, 0.0, exact);
  *error = u[1] / exact[1] - 1.0;
  q4_free(&reference);
  q4_free(&f);
  return done || app_no_memory(a);
}

static bool draw(app *a, const char *directory) {
  return plot_draw(a, directory, "convergence", "cantilever/convergence",
                   "array names[4] = ['%s', '%s', '%s', '%s']", names[0], names[1], names[2],
                   names[3]);
}

enum { COLUMNS = 3 + METHODS };

static bool run_size(app *a, const beam *base, int64_t nx, int64_t ny, double row[COLUMNS]) {
  beam problem = *base;
  q4 reference = {0};
  double error[METHODS];
  problem.length = model_length(problem.height, nx, ny);
  bool done =
      !problem.clamped || q4_solve(&problem, FINE_X, FINE_Y, &reference) || app_no_memory(a);
  const q4 *fine = problem.clamped ? &reference : NULL;
  for (int k = 0; k < METHODS && done; k++)
    done = k < 3 ? particle_error(a, &problem, fine, nx, ny, k, &error[k])
                 : fem_error(a, &problem, nx, ny, &error[k]);
  q4_free(&reference);
  if (!done) return false;
  row[0] = (double)(nx * ny), row[1] = (double)nx, row[2] = (double)ny;
  for (int k = 0; k < METHODS; k++) row[3 + k] = 100.0 * error[k];
  return true;
}

static bool write_table(app *a, const char *directory, int count, double row[][COLUMNS]) {
  output table;
  if (!csv_open(&table, a, directory, "convergence.csv",
                "particles,nx,ny,conservative_percent,published_3_percent,"
                "published_2_1_percent,fem_percent"))
    return false;
  for (int k = 0; k < count; k++) csv_row(&table, COLUMNS, row[k]);
  return output_close(&table);
}

static double seconds_of(int64_t nx, int64_t ny, int k) {
  /* the published method has more neighbours: some five times as long as conservative alone */
  return 5.0 * elastic_seconds((double)(((nx - 1) << k) + 1) * (double)(((ny - 1) << k) + 1));
}

double convergence_seconds(int64_t nx, int64_t ny) {
  double sum = 0.0;
  for (int k = 0; k < SIZES; k++) sum += seconds_of(nx, ny, k);
  return sum;
}

/* The table is written after each size: Ctrl-C costs only the one that is being computed. */
bool convergence_run(const model *m, const elastic_method *method, double before,
                     const char *directory) {
  app *a = m->a;
  const int64_t nx = m->nx, ny = m->ny;
  const double whole = convergence_seconds(nx, ny) / (1.0 - before);
  double row[SIZES][COLUMNS];
  printf("Tip error in %%\n%9s %14s %14s %14s %14s\n", "particles", "conservative", "publ. re=3.0",
         "publ. re=2.1", "bilinear FEM");
  bool done = true;
  for (int k = 0; k < SIZES && done; k++) {
    const double seconds = seconds_of(nx, ny, k);
    done = app_agree(a, a->rank > 0 || results_reserve(m, method, directory));
    app_leave_at_once(a, true); /* no hook reaches into the factorisation */
    elastic_bar(a, before, seconds / whole, seconds);
    done = done && run_size(a, m->problem, ((nx - 1) << k) + 1, ((ny - 1) << k) + 1, row[k]);
    elastic_bar(a, before += seconds / whole, 0.0, 0.0);
    app_leave_at_once(a, false);
    const double *r = row[k];
    if (done) printf("%9.0f %14.3f %14.3f %14.3f %14.3f\n", r[0], r[3], r[4], r[5], r[6]);
    done = app_agree(a, done && (a->rank > 0 || write_table(a, directory, k + 1, row)));
  }
  return done && app_agree(a, a->rank > 0 || draw(a, directory));
}
