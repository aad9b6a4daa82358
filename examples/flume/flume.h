/* flume.h - common declarations of mps-flume: settings, model, records of a run.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_FLUME_H
#define EXAMPLES_FLUME_H

#include "common/output.h"
#include "common/resume.h"
#include "common/waves.h"

#include <mps/body.h>
#include <mps/io.h>
#include <mps/wave_loads.h>
#include <mps/waves.h>

enum { FLUME_REGULAR = 0, FLUME_JONSWAP, FLUME_PM, FLUME_FOCUSED, FLUME_FILE };
enum { FLUME_OPEN_END = 0, FLUME_VERTICAL, FLUME_CAISSON, FLUME_SLOPE, FLUME_PROFILE };
enum { FLUME_ACTIVE = 0, FLUME_ZONE, FLUME_NONE };
enum { FLUME_POINTS = 64 }; /* of a profile */
enum { FLUME_GAUGES = 16, FLUME_BED = 0, FLUME_MAKER, FLUME_END };

typedef struct flume_settings {
  int waves, wall, absorb, form, order, random; /* FLUME_..., mps_absorber_form, mps_waves_theory */
  int solver;                                   /* of the pressure: waves_choose_solver */
  double tolerance;                             /* of its residual */
  double depth, length, spacing;                /* m; length: to the toe of the wall, or the end */
  double height, period, gamma, repeat, ramp;   /* of the waves */
  double focus[2];                              /* m, s */
  double stroke, speed;                         /* m, m/s: of the maker, NaN: no limit */
  double zone, rate;                            /* wave lengths; 1/period */
  double crest, cotangent, width;               /* m, 1, m: of the wall */
  double density, friction;                     /* kg/m3, 1: of the caisson */
  double duration, sample, disturb;             /* s, s, spacings */
  double gauge[FLUME_GAUGES], window[2];        /* m, s */
  double profile[FLUME_POINTS][2];              /* m, from the toe, on the bed */
  int points;
  int64_t seed, frames, threads;
  double every_checkpoint; /* s */
  const char *file, *out, *checkpoint, *restart;
} flume_settings;

typedef struct flume_sample {
  double t, maker, end;       /* s, m, m: displacements of the pistons */
  double level[FLUME_GAUGES]; /* m above the water at rest */
  double force, moment; /* N, N m about the heel of a body, the foot of a wall: on the structure */
  double foot;          /* Pa, on the bed before it */
  double volume;        /* m2: has passed the crest so far */
} flume_sample;

/* The water at the largest force: x, y (m), pressure (Pa) of each particle. */
typedef struct flume_look {
  double t, force;
  int64_t count, room;
  float *value;
} flume_look;

typedef struct flume {
  flume_settings s;
  const option *table;
  int gauges;
  double wave_length, heel, outlet; /* m; x of the rear foot of the body, of the open side */
  double corner[FLUME_POINTS][2];   /* m: face from the toe to the rear edge of the crest */
  int corners;
  mps_waves *waves;
  mps_absorber *maker, *end;
  mps_particles *water;
  mps_fluid *fluid;
  mps_recorder *series;
  flume_sample *sample;
  int64_t samples, capacity;
  flume_look look;
  mps_fluid_report report;
  resume_schedule saves;
  double restarted; /* s, NaN: from the start */
  app *a;           /* borrowed */
  char why[400];    /* reason against a restart; "": recorded by the library */
} flume;

static inline bool flume_has_body(const flume_settings *s) { return s->wall >= FLUME_CAISSON; }

/* waves.c: the sea, and the pistons that absorb. */
mps_status flume_make_waves(app *a, flume *m);
mps_status flume_make_pistons(app *a, flume *m);
/* model.c: water, walls, structure. */
mps_status flume_build(app *a, flume *m);
void flume_free(flume *m);
double flume_ground(const flume *m, double x);
/* run.c: steps to the end, or until Ctrl-C, which leaves a checkpoint. */
mps_status flume_run(app *a, flume *m);
/* restart.c. flume_peek compares the options of the file with these before the model is built. */
mps_status flume_save(void *user);
mps_status flume_peek(mps_context *context, flume *m);
mps_status flume_restore(mps_context *context, flume *m);

/* What a run is about, from the samples of its window. */
typedef struct flume_figures {
  double from, to; /* s, as used */
  bool separated;  /* there are incident and reflected waves */
  mps_separation split;
  int64_t bands;
  double *frequency, *incident, *reflected, *target; /* Hz, m: amplitudes */
  double target_height; /* m, Hm0 of the linear target at the gauges in the same window */
  double force_still, force_peak, force_least, peak_at, foot_peak; /* N, N, N, s, Pa above rest */
  double sliding, overturning; /* least safeties of the caisson */
  double discharge;            /* m2/s */
  double loss;                 /* of the height, a wave length */
  mps_goda goda;
  mps_eurotop eurotop;
  bool has_goda, has_eurotop;
  char why[600]; /* reason why a formula is not valid here */
} flume_figures;

/* figures.c. False after an error line. */
bool flume_find_figures(app *a, flume *m, flume_figures *f);
void flume_free_figures(flume_figures *f);
/* results.c: tables and summary; pictures.c. */
bool flume_write(app *a, flume *m);
bool flume_draw(app *a, const flume *m, const flume_figures *f);

#endif
