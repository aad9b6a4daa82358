/* results.h - tables, summary and pictures of mps-cantilever.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_CANTILEVER_RESULTS_H
#define EXAMPLES_CANTILEVER_RESULTS_H

#include "model.h"

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

#endif
