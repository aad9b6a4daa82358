/* seawall.h - common declarations of mps-seawall: settings, model, records of the run.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_SEAWALL_H
#define EXAMPLES_SEAWALL_H

#include "common/options.h"
#include "common/output.h"
#include "common/resume.h"
#include "common/rows.h"
#include "common/strip.h"
#include "common/waves.h"

#include <mps/experimental/coupling.h>
#include <mps/io.h>
#include <mps/fluid.h>

#define SEAWALL_LOOK 5.16    /* s: the crest of Chikazawa's Figures 12 and 13 */
#define SEAWALL_IMPULSE 0.05 /* s: the piston starts with a jerk, whose forces are no waves' */
#define SEAWALL_WINDOW 0.072 /* s, of a Hann window: half the power passes at 10 Hz */
#define SEAWALL_COLUMNS 4    /* of particles at the wall, of whose number the level is that */
#define SEAWALL_LAYERS 3     /* of particles that a wall of the paper's fluid has */

enum { SEAWALL_BED = 0, SEAWALL_PISTON, SEAWALL_WALL };

typedef struct seawall_settings {
  double length, depth, spacing, amplitude, period, ramp, dt, duration, sample;
  double wall_thickness, wall_height, young, poisson, wall_density;
  double disturb; /* spacings */
  double every_checkpoint;
  int64_t frames, threads, seed;
  int solver;       /* of the pressure: waves_choose_solver */
  double tolerance; /* of its residual */
  bool coupled, paper;
  int method, wall_method; /* 0 or 1: classical; published */
  double share;            /* of the density error, classical */
  const char *out, *checkpoint, *restart;
} seawall_settings;

typedef struct seawall_sample { /* s, N, N m, m above the water at rest, m, m */
  double t, force, moment, level, deflection, piston;
} seawall_sample;

/* The water at a moment: x, y (m) and pressure (Pa) of each particle. */
typedef struct seawall_frame {
  double t, piston;
  int64_t count;
  float *value;
} seawall_frame;

/* The wall at the crest, or at the end of a shorter run. */
typedef struct seawall_look {
  seawall_sample at;
  int64_t points;       /* wetted, of the fluid's wall */
  double *y, *pressure; /* m, Pa */
  double *displacement; /* m, 2 a particle of the structure */
} seawall_look;

/* Of a wall that moves the water; arrays over its facets, along the normal into the water. */
typedef struct seawall_both {
  mps_coupling *coupling;
  mps_snapshot *start; /* of the structure, at the beginning of the step */
  double *block;
  double *rest, *displacement, *velocity; /* m, m, m/s: under still water; at the beginning */
  double *mean, *answer;                  /* m/s2: accelerations over the step */
  double *moved, *speed;                  /* m, m/s: at its end */
  double *before, *given, *vector;        /* Pa: loads at its beginning and end; room */
  double *middle;                         /* Pa, of the water in the middle of the step before */
  double *memory;                         /* of the coupling, before the step */
  int64_t room, learnt;
} seawall_both;

typedef struct seawall {
  seawall_settings s;
  const option *table;
  waves_piston motion;
  mps_particles *water;
  mps_signal *piston;
  mps_fluid *fluid;
  strip wall;
  seawall_both both;
  double *pressure; /* Pa, a facet of the wall */
  mps_recorder *series, *wall_series;
  result_rows rows;
  const seawall_sample *sample; /* of `rows` */
  seawall_frame *frame;
  int64_t samples, capacity, frames, room; /* room: points of the look */
  resume_schedule saves;
  double *force;         /* N, after each step */
  double *linear;        /* N/m, at each sample, by linear potential flow on a rigid wall */
  int64_t forces, steps; /* how many there are, and will be at the end */
  seawall_look look;
  double restarted; /* s, NaN: from the start */
  app *a;           /* borrowed */
  char why[400];    /* reason against a restart; "": recorded by the library */
} seawall;

/* The particles that the method of the paper has for this tank: the water, three layers under it
 * and behind the piston, and the wall, down to the lowest layer. */
int64_t seawall_paper_particles(const seawall_settings *s);

/* model.c; seawall_rows sets `sample` from `rows`. */
void seawall_rows(seawall *w);
mps_status seawall_build(app *a, seawall *w);
void seawall_free(seawall *w);
/* coupled.c */
mps_status seawall_couple(mps_context *context, seawall *w);
void seawall_free_coupled(seawall_both *b);
mps_status seawall_coupled_step(seawall *w);
/* run.c: steps to the end, or until Ctrl-C, which leaves a checkpoint. */
mps_status seawall_run(app *a, seawall *w);
/* restart.c. seawall_peek compares the options of the file with these before the model is built. */
mps_status seawall_save(void *user);
mps_status seawall_peek(mps_context *context, seawall *w);
mps_status seawall_restore(mps_context *context, seawall *w);
/* run.c: the force around step k less all that is faster than 10 Hz. */
double seawall_smooth(const seawall *w, int64_t k);
/* results.c: tables and summary; pictures.c. */
bool seawall_write(app *a, seawall *w);
bool seawall_draw(app *a, const seawall *w, double height); /* Sainflou's H, NaN where none */

#endif
