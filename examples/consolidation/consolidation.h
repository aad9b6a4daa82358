/* consolidation.h - the parts of mps-consolidation: model and run (model.c), a restart (restart.c),
 * exact solutions (exact.c), results (results.c). SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_CONSOLIDATION_H
#define EXAMPLES_CONSOLIDATION_H

#include "common/mpm_course.h"
#include "common/mpm_model.h"

#include <mps/pore_water.h>

enum { TERZAGHI, LARGE, MCC, MANDEL, CRYER, STRIP, BARRON };
enum { EXPLICIT, IMPLICIT };
enum { MOST_TIMES = 32, MOST_POINTS = 1024, MOST_CELLS = 256 };

typedef struct settings {
  int kase, scheme, solver;
  int64_t threads;
  double cells;             /* along H; of the strip along B */
  double nu, young, load;   /* Pa; load: u0 */
  double ratio;             /* of the radius a of Barron's cylinder to that of its drain */
  double M, lambda, kappa;  /* of Cam-Clay */
  double e0, initial;       /* void ratio and, Pa, vertical effective stress before the load */
  double duration, damping; /* s that T = 1 lasts; 1/s */
  double stiffness;         /* (K_w/n)/M' */
  const char *times, *out;
  mpm_course_options course;
} settings;

/* What is measured at one time. */
typedef struct instant {
  double T, settlement, settlement_exact, force; /* m, m; over the exact one */
  double degree, degree_equal; /* of consolidation, mean of 1 - u/u0: Barron; for equal strain */
  mps_pore_budget water;       /* kg */
  double u[MOST_POINTS];       /* u/u0 */
} instant;

typedef struct simulation {
  settings s;
  mpm_model m;
  double time[MOST_TIMES];
  int times, rows; /* in all, measured so far */
  instant row[MOST_TIMES];
  int64_t id[MOST_POINTS]; /* particles of the profile */
  double at[MOST_POINTS];  /* their depth over H before anything moves */
  int points;
  double modulus, volume; /* Pa, M'; m3 at the start */
  mpm_course course;
} simulation;

/* Completes the settings. Why they are not consistent; NULL: good. */
const char *consolidation_settle(simulation *sim, const option *table);
mps_status consolidation_build(mps_context *context, void *user);
mps_status consolidation_march(void *user);
bool consolidation_finish(app *a, void *user);
void consolidation_pass(void *user, resume_bytes *b);

/* exact.c: u/u0 at the depth/H of material (Mandel and Cryer: 1 is the centre; strip: z/B; Barron:
 * 1
 * - r/a), and the settlement over H at T; NaN where there is none. */
double exact_pressure(const settings *s, double m, double depth, double T);
double exact_settlement(const settings *s, double m, double T);
/* Of Mandel's plate since the load was applied, over b u0/M'; downwards. */
double exact_plate(double nu, double T);
/* Barron's vertical drain, radius 1/n of that of its cylinder: mean of 1 - u/u0 at T = c_v t/a^2,
 * and that for equal strain. */
double exact_drain(double n, double T);
double exact_drain_equal(double n, double T);

#endif
