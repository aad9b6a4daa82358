/* slope.h - the parts of mps-slope: ground and one trial (model.c), the search for the factor
 * (search.c), water in the ground (water.c), slip circles (circles.c), logarithmic spirals
 * (spirals.c), results (results.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_SLOPE_H
#define EXAMPLES_SLOPE_H

#include "common/mpm_course.h"
#include "common/mpm_heap.h"
#include "common/mpm_model.h"
#include "common/sand.h"
#include "common/units.h"

enum { SLOPE_SAMPLES = 40, SLOPE_TRIALS = 24, SLOPE_POINTS = 64 };
enum { FLOW_NONE, FLOW_ALONG };
#define WATER 1000.0 /* kg/m3 */

typedef struct settings {
  double height, slope, base, crest, toe; /* m; slope: horizontal per vertical */
  sand_voids voids;
  double phi, psi, cohesion;               /* degrees, degrees, Pa */
  double gradient;                         /* Pa/m, growth of the cohesion below the crest */
  double residual_phi, residual_cohesion;  /* NaN: as phi and cohesion */
  double slip;                             /* m */
  double young, poisson, density, gravity; /* Pa, -, kg/m3, m/s2 */
  double courant;
  double factor, tolerance, falls, h; /* NaN: it is sought; -, (H/g)^1/2, m */
  double moist, ru;                   /* kg/m3 above the table; pressure over weight */
  double table, drawdown; /* m above the toe: the water table, and the pool before; NaN: none */
  double line[2 * SLOPE_POINTS]; /* m, the table: x from the crest's edge, level above the toe */
  int64_t points;                /* of that; 0: none */
  int flow;
  const char *table_text;
  int64_t ppc, threads;
  int spline; /* degree of the weights less 2 */
  bool runout;
  mpm_course_options course;
  const char *out;
} settings;

/* One strength, and whether the slope stands. */
typedef struct trial {
  double factor;
  int failed, ended; /* 0 or 1 */
  int rows;
  double t[SLOPE_SAMPLES + 1], moved[SLOPE_SAMPLES + 1]; /* s, m */
} trial;

/* Speed of a slope that has failed, g H/c: a trial's ground comes to rest, or flows faster. */
#define SLOPE_FLOWS 1e-3

typedef struct simulation {
  settings s;
  mpm_model m;
  mps_context *context;
  int now; /* the present trial; those before have ended */
  trial trial[SLOPE_TRIALS];
  double *start; /* m, 2 a particle by its id: where it was; rank 0 */
  int64_t starts;
  double front, lost, kinetic; /* m: beyond the toe, behind the crest; J/m: at the last sample */
  double peak;                 /* J/m, of the kinetic energy */
  mpm_snapshot shot;           /* plastic strain of the weakest strength that failed, or the last */
  mpm_course course;
} simulation;

/* The strengths between which the slope fails: of all trials that have ended. 0 and infinity where
 * none stood or failed. */
void slope_bracket(const simulation *sim, int trials, double *stands, double *fails);
/* Whether they are as close as requested, or the one trial has ended. */
bool slope_found(const simulation *sim, int trials);

/* water.c: x from the crest's edge to the toe, y above the toe, m. */
const char *slope_settle_water(settings *s, const option *table);
bool slope_is_wet(const settings *s);
double slope_surface(const settings *s, double x);
double slope_table(const settings *s, double x); /* level; -infinity: none */
double slope_pool(const settings *s); /* level of water that stands at the toe; -infinity: none */
double slope_density(const settings *s, double x, double y);
double slope_overburden(const settings *s, double x, double y); /* Pa, ground and pool above */
double slope_pressure(const settings *s, double x, double y);   /* Pa, of the water */
/* Densities, effective stresses and the water's force on the particles. */
mps_status slope_wet(settings *s, mps_particles *set);

/* circles.c: the least factor of all slip circles by Bishop's simplified method; infinite: none. */
typedef struct slope_circle {
  double x, y, radius; /* m, as in water.c */
} slope_circle;
double slope_circles(const settings *s, slope_circle *out);

/* A slip line: x of the ends, and the sag of a circle through them over its chord. */
typedef struct slope_arc {
  double from, to, sag;
} slope_arc;
/* Its factor, found from `start`; infinite where there is none. `out`: its pole, and the radius at
 * the entry. */
typedef double (*slope_slip_fn)(const settings *s, const slope_arc *a, double start,
                                slope_circle *out);
/* The least factor of a kind of slip lines. */
double slope_least_slip(const settings *s, slope_slip_fn slip, slope_circle *out);
/* Levels of the ends; false where they are those of no slip. */
bool slope_ends(const settings *s, const slope_arc *a, double *y0, double *y1);
double slope_cohesion(const settings *s, double y); /* Pa */

/* spirals.c: the least factor of all logarithmic spirals, of associated flow or with the strength
 * of Davis for --psi; infinite: none. */
double slope_spirals(const settings *s, bool davis, slope_circle *out);

/* model.c */
double slope_duration(const settings *s);
/* Young's modulus of a run: at least that at which a trial's ground keeps its shape. Pa */
double slope_young(const settings *s);
/* Mean speed over the last `samples` of a trial, as SLOPE_FLOWS. */
double slope_speed(const settings *s, const trial *t, int samples);
mps_status slope_build_trial(simulation *sim);
mps_status slope_march_trial(simulation *sim);

/* search.c */
mps_status slope_build(mps_context *context, void *user);
mps_status slope_march(void *user);

/* results.c */
bool slope_finish(app *a, void *user);

#endif
