/* model.h - the cantilever of particles: building, solving, comparing with theory.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_MODEL_H
#define EXAMPLES_MODEL_H

#include "q4.h"

#include "elastic/elastic.h"

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

#endif
