/* site.h - the parts of mps-site-response: options (options.c), the file of layers (ground.c), laws
 * of the layers (laws.c), the motion (motion.c), model and run (model.c), what is recorded
 * and passed to a restart (record.c), spectra (spectra.c), waves in elastic layers (exact.c),
 * results (results.c, pictures.c). SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_SITE_H
#define EXAMPLES_SITE_H

#include "common/compare.h"
#include "common/mpm_course.h"
#include "common/mpm_model.h"
#include "common/sand.h"

#include <mps/signal.h>

#define SITE_FREQUENCY 10.0          /* Hz: default of the highest one */
#define SITE_FREQUENCY_YIELDING 20.0 /* of layers that yield */
enum { SITE_ELASTIC, SITE_SMALL_STRAIN, SITE_MOHR_COULOMB, SITE_CYCLIC_SAND, SITE_LAWS };
enum { SITE_COMPLIANT, SITE_RIGID };
enum { SITE_LAYERS = 100, SITE_ROWS = 4000, SITE_SAMPLES = 400000, SITE_CELLS = 4 };
enum { SITE_PERIODS = 100, SITE_FREQUENCIES = 1000, SITE_PER_WAVE = 20 };
#define SITE_GRAVITY 9.81 /* m/s2 */
#define SITE_WATER 1000.0 /* kg/m3 */

/* A layer, in the order of the table of ground.c; NaN: not given. */
typedef struct site_layer {
  double thickness, density; /* m, kg/m3 */
  double vs, poisson;        /* m/s, 1 */
  double k0;
  double permeability, porosity; /* m/s, 1 */
  double reference_strain, curvature, strength;
  double phi, psi, cohesion; /* degrees, degrees, Pa */
  double e0, e_max;
  double relative_density, blow_count;
  int64_t law;
} site_layer;
enum { SITE_COLUMNS = 18 }; /* these */

typedef struct site_ground {
  int64_t count; /* with the half space, the last one where there is one */
  int64_t has_half_space;
  site_layer layer[SITE_LAYERS + 1];
} site_ground;

typedef struct settings {
  const char *layers, *record, *out;
  const char *column;                           /* of a record; NULL: the only one */
  int unit, baseline, base, volumetric, spline; /* spline: degree - 2 */
  double scale, step, frequency, amplitude;
  int64_t cycles;
  double courant;
  double h, highest, flip_time; /* m, Hz, s; NaN: not given */
  double sample, duration;      /* s */
  double damping;               /* 1/s, viscous */
  double permeability, porosity, bulk;
  double loop; /* m, depth of loop.csv; NaN: none */
  bool undrained;
  int64_t threads;
  mpm_course_options course;
} settings;

/* What is recorded of the surface and of the loop's depth, relative to the input's motion. */
typedef struct site_sample {
  double t;              /* s */
  double v, u;           /* m/s, m: highest row of particles */
  double strain, stress; /* 1, Pa: at the depth of the loop */
  double ru;             /* there */
  double settlement;     /* m, of the surface */
} site_sample;

/* A row of particles, from below. */
typedef struct site_row {
  double depth;              /* m, before the run */
  double x, y;               /* m, means before the run */
  double vertical, pressure; /* Pa: effective stress, compression positive, and water, at rest */
  double volume;             /* m3, at rest */
  double u[5];               /* r_u of the last samples; the largest is of their mean */
  double v[5];               /* m/s, of the last samples, relative */
  double acceleration, velocity, displacement; /* largest so far, absolute or relative to input */
  double strain, stress, ru, last_ru, settlement, last_displacement;
  double sunk; /* m, by the places of its particles */
} site_row;

typedef struct simulation {
  settings s;
  mpm_model m;
  mpm_course course;
  site_ground ground;
  mps_signal *motion, *load; /* acceleration of the input; that of the frame on the particles */
  mps_material *law[SITE_LAYERS + 1], *elastic[SITE_LAYERS + 1];
  double height, below, width; /* m: of the soil, of the half space's ground below, of the model */
  double cell, flip_time;      /* m, s: of the solver */
  int32_t volumetric;
  double spacing, duration; /* m, s */
  double start; /* s, of the solver where the motion begins, after the ground has come to rest */
  double record_end, record_peak; /* s, m/s2 */
  double highest;                 /* Hz: --max-frequency or its default */
  bool wet, flows, liquefies;     /* liquefies: some saturated cyclic sand */
  bool opens;                     /* some sand, with gaps between its grains */
  int64_t rows, across, loop_row; /* of particles; in a row; -1: none */
  int64_t samples, count;         /* in all, recorded so far */
  site_row *row;
  site_sample *sample;
} simulation;

/* options.c: completes the settings; why they are not consistent, NULL: good. */
const char *site_settle(settings *s, const option *table);
bool site_is_pulse(const settings *s); /* no record of a file */

/* Writes the reason why the model is not made; returns false. */
bool site_refuse(mpm_model *m, const char *format, ...) APP_PRINTF(2, 3);

/* ground.c: reads the file of layers; false after site_refuse. */
bool site_read_ground(mpm_model *m, const settings *s, site_ground *out);
/* The layer at a depth; below the last one that. */
const site_layer *site_layer_at(const site_ground *g, double depth);
double site_thickness(const site_ground *g); /* m, without the half space */
const char *site_law_name(int64_t law);
/* Time (s) that a shear wave takes through the layers. */
double site_travel_time(const site_ground *g);

/* laws.c */
mps_status site_make_law(mps_context *context, const site_layer *layer, mps_material **out);

/* motion.c: the record or pulse, and the load of the frame that moves with it. */
mps_status site_make_motion(mps_context *context, simulation *sim);
double site_input(const simulation *sim, double t); /* m/s2 */

mps_status site_build(mps_context *context, void *user);
mps_status site_march(void *user);
void site_free(simulation *sim);

/* record.c */
mps_status site_begin_record(simulation *sim);
mps_status site_take_sample(simulation *sim);
void site_pass(void *user, resume_bytes *b);
/* Derivative by five samples `step` apart. */
double site_slope(const double v[5], double step);

/* spectra.c: accelerations at equal steps. */
typedef struct site_series {
  int64_t count;
  double step;             /* s */
  double *surface, *input; /* m/s2, absolute */
} site_series;
/* Largest pseudo-acceleration of an oscillator. */
double site_response(const double *a, int64_t count, double step, double period, double damping);
/* |surface| over |input| of the Fourier transforms at `frequency`, and the same of `exact`, as
 * means over a window. */
typedef struct site_fourier {
  int64_t count;
  double step; /* Hz */
  double surface[SITE_FREQUENCIES], input[SITE_FREQUENCIES], exact[SITE_FREQUENCIES];
} site_fourier;
void site_transform(const site_series *s, double highest, site_fourier *out);
void site_smooth(site_fourier *f);

/* exact.c: the surface over the input of elastic layers, at a frequency. */
double site_exact(const simulation *sim, double frequency);

bool site_finish(app *a, void *user);
/* pictures.c */
bool site_draw(app *a, const simulation *sim, bool exact);

#endif
