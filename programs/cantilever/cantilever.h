/* cantilever.h - the parts of mps-cantilever: the beam and its theory, finite elements, particles,
 * results. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "elastic/elastic.h"

#include <stdbool.h>
#include <stdint.h>

/* ---- beam.c ---------------------------------------------------------------------------------- */

typedef struct beam {
  double length, height; /* m */
  double young, poisson; /* Pa, - */
  double load;           /* N/m */
  bool plane_strain;
  bool clamped; /* the wall does not move; otherwise it moves as the exact solution */
} beam;

/* Displacements of Chikazawa (11) and of the u that belongs to it: u = v = du/dy = 0 at (length,
 * 0).
 */
void beam_displacement(const beam *b, double x, double y, double *u);
/* Its stresses xx, yy, xy (Pa). */
void beam_stress(const beam *b, double x, double y, double *stress);
/* Traction on the loaded end at height y (Pa). */
void beam_traction(const beam *b, double y, double *traction);
/* Displacement that is prescribed at the wall. */
void beam_wall(const beam *b, double y, double *u);
/* Lame's constants of the plane state. */
void beam_lame(const beam *b, double *lambda, double *mu);

/* ---- q4.c ------------------------------------------------------------------------------------ */

typedef struct q4 {
  const beam *problem;
  int64_t nx, ny; /* nodes along and up */
  double hx, hy;  /* m: element size */
  double *u;      /* [2 * (i * ny + j) + c], displacement of node (i, j) */
} q4;

/* Solves with nx x ny nodes (at least 2 each). False: out of memory, or the solver failed. */
bool q4_solve(const beam *problem, int64_t nx, int64_t ny, q4 *out);
void q4_free(q4 *f);
/* Displacement at (x, y), interpolated. */
void q4_at(const q4 *f, double x, double y, double *u);

/* ---- model.c --------------------------------------------------------------------------------- */

typedef struct model {
  app *a;
  const beam *problem;
  const q4 *reference; /* of a clamped wall, which has no exact solution; else NULL */
  mps_particles *particles;
  mps_elastic *elastic;
  double spacing;
  int64_t nx, ny;
  mps_elastic_report report;
  double tip, tip_exact, tip_error; /* m, m, relative: first particle of the axis */
  double stress_error;              /* relative L2 error over the body, against Chikazawa */
  double energy;                    /* J/m */
  double equilibrium;               /* |load + reactions| / load */
} model;

/* Length from the loaded surface to the wall's layer of nx x ny particles in a beam of `height`. */
double model_length(double height, int64_t nx, int64_t ny);

/* Makes, supports, loads and solves the beam, and finds the errors. False after an error line. */
bool model_solve(app *a, const beam *problem, const q4 *reference, int64_t nx, int64_t ny,
                 const elastic_method *method, model *out);
void model_free(model *m);

/* Results at particle (i, j) from the loaded end and from below. */
bool model_get(const model *m, int64_t i, int64_t j, elastic_point *out);
/* Reference displacement: Chikazawa (11), or the fine finite elements of a clamped wall. */
void model_reference(const model *m, const double *x, double *u);

/* ---- results.c ------------------------------------------------------------------------------- */

/* deflection.csv (the axis, the paper's Figure 5), stress.csv (all particles), stress-axis.csv and
 * stress-section.csv (Figures 7 and 8), summary.json and their pictures in DIR. */
bool results_write(const model *m, const elastic_method *method, const char *directory);

/* The summary that is written where Ctrl-C ends the program at once (app_leave_at_once). */
bool results_reserve(const model *m, const elastic_method *method, const char *directory);

/* Time of the comparison, in seconds of one processor. */
double convergence_seconds(int64_t nx, int64_t ny);
/* The comparison of the paper's Figure 6: tip errors of both methods and of bilinear finite
 * elements at four sizes, each with twice the particles a side of the one before. convergence.csv
 * and .png. `m` has been solved by `method`. The bar is at `done` of the whole before. */
bool convergence_run(const model *m, const elastic_method *method, double done,
                     const char *directory);
