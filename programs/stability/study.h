/* study.h - the paper's parameter study (Table 1): 320 cases; and its Figure 3: 60
 * cases that compare the integrators (R 0.5 and 1.6 m, V 100 m/s, S wave).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "cases.h"
#include "regression.h"

enum {
  STUDY_RADII = 4,
  STUDY_VELOCITIES = 4,
  STUDY_DAMPINGS = 10,
  STUDY_WAVE = STUDY_RADII * STUDY_VELOCITIES * STUDY_DAMPINGS, /* cases of one wave */
  STUDY_GRID = 2 * STUDY_WAVE,                                  /* S, then P */
  STUDY_THIRD = 2 * STUDY_DAMPINGS,                             /* cases of one integrator */
  STUDY_CASES = STUDY_GRID + 3 * STUDY_THIRD
};
extern const double study_radius[STUDY_RADII];
extern const double study_velocity[STUDY_VELOCITIES];
extern const double study_damping[STUDY_DAMPINGS];

/* Regression of one wave's limits by one method. */
typedef struct regression {
  bool known;
  limit_fit fit;
  double rms_table2; /* of dt / printed - 1, h up to 0.22 */
  double rms_fits;   /* of own regression / printed - 1 */
} regression;

/* The Euler method fails by slow growth: a criterion near the response itself would measure
 * something else than instability, so the integrators are compared at the paper's 1e15. */
#define STUDY_INTEGRATOR_CRITERION 1e15

typedef struct study {
  method m;
  stability_case cases[STUDY_CASES]; /* by wave, R, V, h; then by integrator, R, h */
  regression linear[2], stepping[2]; /* S, P */
  limit_fit printed[2];
  int64_t done; /* cases that have been run; fewer than all after Ctrl-C */
} study;

/* Finds all cases, in parallel, until Ctrl-C. False with an error line at the first failure. */
bool study_run(app *a, const method *m, study *s);
/* Regressions of the results. */
bool study_fit(app *a, study *s);
/* limits.csv and integrators.csv; of an interrupted study the cells of the other cases are empty.
 */
bool study_write_limits(app *a, const study *s, const char *directory);
/* Those two, regression.csv and coefficients.csv. */
bool study_write(app *a, const study *s, const char *directory);
/* Members of summary.json, and the last lines on stdout. */
bool study_summary(app *a, const study *s, const char *directory);
/* fig03.png to fig10.png, as the paper's figures. */
bool study_draw(app *a, const study *s, const char *directory);
