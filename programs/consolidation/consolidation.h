/* consolidation.h - the parts of mps-consolidation: model and run (model.c), loads and layers of a
 * column with its exact solution (column.c, strata.c), a restart (restart.c), exact solutions
 * (exact.c), results (results.c). SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/mpm_course.h"
#include "common/mpm_model.h"
#include "strata.h"

#include <mps/experimental/pore_water.h>

enum { TERZAGHI, LARGE, MCC, MANDEL, CRYER, STRIP, BARRON };
enum { EXPLICIT, IMPLICIT };
enum { DRAINED_TOP, DRAINED_BOTTOM, DRAINED_BOTH };
enum { MOST_TIMES = 64, MOST_STEPS = 12, MOST_POINTS = 1024, MOST_CELLS = 256 };

typedef struct settings {
  int kase, scheme, solver, drained;
  int64_t threads;
  double courant;
  double cell, cells;       /* m, NaN: by the case; along H, of the strip along B */
  double nu, young, load;   /* Pa; load: u0 */
  double ratio;             /* of the radius a of Barron's cylinder to that of its drain */
  double M, lambda, kappa;  /* of Cam-Clay */
  double e0, initial;       /* void ratio and, Pa, vertical effective stress before the load */
  double duration, damping; /* s that T = 1 lasts; 1/s */
  double stiffness;         /* (K_w/n)/M' */
  double ramp;              /* T within which a load grows */
  const char *times, *layers, *loads, *out;
  mpm_course_options course;
} settings;

/* What is measured at one time. */
typedef struct instant {
  int step;             /* of the loads, from 0 */
  double T, U, U_exact; /* since that load; degree of consolidation of a column */
  double settlement, settlement_exact, force; /* m, m; over the exact one */
  double degree, degree_equal; /* of consolidation, mean of 1 - u/u0: Barron; for equal strain */
  mps_pore_budget water;       /* kg */
  double u[MOST_POINTS];       /* u/u0; of a column u0 is what its load is more than the last */
} instant;

typedef struct simulation {
  settings s;
  mpm_model m;
  double time[MOST_TIMES];     /* T after each load */
  int times, rows;             /* of a load, measured so far of all */
  int steps;                   /* loads of a column, else 1 */
  double load[MOST_STEPS + 1]; /* Pa: 0, the first, ... */
  strata ground;
  double k, height; /* m/s and m, with --layers: mean and sum; else 0 */
  instant row[MOST_TIMES];
  int64_t id[MOST_POINTS]; /* particles of the profile */
  double at[MOST_POINTS];  /* their depth over H before anything moves */
  int points;
  double modulus, volume; /* Pa, M'; m3 at the start */
  int32_t drain;          /* faces that the load is given at */
  mpm_course course;
} simulation;

/* Completes the settings. Why they are not consistent; NULL: good. */
const char *consolidation_settle(simulation *sim, const option *table);
/* The default duration of T = 1, s, at which inertia does not count. */
double consolidation_duration(const simulation *sim);
mps_status consolidation_build(mps_context *context, void *user);
mps_status consolidation_march(void *user);
bool consolidation_finish(app *a, void *user);
void consolidation_pass(void *user, resume_bytes *b);

static inline bool is_column(const settings *s) { return s->kase <= MCC; }
/* u0 of a row, Pa. */
static inline double reference_load(const simulation *sim, int step) {
  return is_column(&sim->s) ? sim->load[step + 1] - sim->load[step] : sim->s.load;
}

/* column.c: before and after the other settings are completed; why they are not consistent. */
const char *column_settle(simulation *sim, const option *table);
/* Chooses cells: the nearest number to --cell, or from the usual one on, that fits. */
const char *column_choose_cells(simulation *sim);
const char *column_finish_settings(simulation *sim);
/* The layer at `depth` over H. */
const stratum *column_layer(const simulation *sim, double depth);
/* Pa, T after load number `step` began; and the T at which a load that grows is set anew next. */
double column_load(const simulation *sim, int step, double T);
double column_next(const simulation *sim, double T);
/* Exact, T after load `step` began: u (Pa) and the settlement over H; and what part `settlement` is
 * of that at the end under this load. */
double column_pressure(const simulation *sim, int step, double T, double depth);
double column_settlement(const simulation *sim, int step, double T);
double column_degree(const simulation *sim, int step, double settlement);

/* exact.c: u/u0 at the depth/H (Mandel and Cryer: 1 is the centre; strip: z/B; Barron: 1 - r/a),
 * and Cryer's settlement over a at T, m = u0/M'. */
double exact_pressure(const settings *s, double depth, double T);
double exact_sphere(double nu, double m, double T);
/* Of Mandel's plate since the load was applied, over b u0/M'; downwards. */
double exact_plate(double nu, double T);
/* Barron's vertical drain, radius 1/n of that of its cylinder: mean of 1 - u/u0 at T = c_v t/a^2,
 * and that for equal strain. */
double exact_drain(double n, double T);
double exact_drain_equal(double n, double T);
