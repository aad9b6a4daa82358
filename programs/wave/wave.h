/* wave.h - the parts of mps-wave: options, records, the map of peaks, results, checkpoints, files.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/column.h"
#include "common/output.h"
#include "common/compare.h"
#include "common/resume.h"

#include <mps/io.h>
#include <mps/dynamics.h>

/* ---- settings.c ------------------------------------------------------------------------------ */

enum { WAVE_S = 0, WAVE_P = 1 };
enum { BASE_RIGID = 0, BASE_VISCOUS = 1 };
enum { SIDES_ROLLER = 0, SIDES_PERIODIC = 1, SIDES_FREEFIELD = 2 };

typedef struct settings {
  /* ground */
  double spacing, width, height, vs, vp, unit_weight, damping, f1, f2;
  const char *layers_file;
  double slope[3];
  /* input */
  int wave; /* WAVE_... */
  const char *input;
  double frequency, peak_time, amplitude, scale;
  int unit, baseline;
  double step;        /* s, of a record without times; NaN: by the file */
  const char *column; /* of a record; NULL: the only one */
  /* boundaries */
  int base, sides;
  layer half_space; /* members NaN: those of the lowest layer */
  /* method */
  int integrator, rotation, torque, damping_form;
  double dt, courant, duration;
  int64_t receivers, threads;
  int64_t frames;
  double every_checkpoint; /* s; NaN: a tenth of the run */
  const char *checkpoint, *restart, *out;
  /* made from the above */
  bool ricker, sloped, paper;
  layers ground;
} settings;

/* Fills `s` from the command line. Returns -1 to continue, or the exit code. */
int settings_parse(settings *s, int argc, char **argv);
/* Reads the layers file, or makes the one layer that the options describe, and checks it against
 * the height of the model. */
bool settings_ground(app *a, settings *s);
/* Makes the input motion. */
bool settings_signal(app *a, const settings *s, mps_signal **out);
/* Definition of the solver; `width` (m) of the lattice is the period of periodic sides. */
mps_dynamics_def settings_dynamics(const settings *s, double width);
char settings_wave(const settings *s); /* 'S' or 'P' */

/* ---- receivers.c ----------------------------------------------------------------------------- */

/* One recorded component of the acceleration of one particle. */
typedef struct receiver {
  int64_t id;
  int32_t component; /* 0 x, 1 y */
  double depth;      /* of the particle below the surface at its x, m */
  char label[48];    /* column of the CSV file */
} receiver;

typedef struct receivers {
  mps_particles *particles; /* borrowed */
  int64_t column;           /* the first ones: the middle column from the surface down */
  int64_t count;            /* then the surface at the edge, and of a slope its crest and toe */
  receiver *list;
  bool energy;        /* record the total energy too */
  double energy_from; /* s: after this time */
  double energy_least, energy_most, energy_sum;
  bool watch;          /* stop where the energy grows beyond what has been put in: `grown` */
  double speed;        /* m/s, of the input, the largest */
  double given, grown; /* J: most that was put in so far; energy above it, 0: not so */
  int64_t energies;
  int64_t rows, capacity;
  double *row; /* rows x (1 + count): time (s), accelerations (m/s2) */
  double *now; /* a row under way: each rank has the accelerations of its own particles */
} receivers;

/* Chooses `n` receivers along the middle column and those beside it. */
bool receivers_create(app *a, const column *c, char wave, int64_t n, receivers *out);
void receivers_destroy(receivers *r);
/* In a callback of mps_dynamics_run; `domain` NULL: one process. On all ranks the same rows. */
mps_status receivers_record(receivers *r, mps_dynamics *dynamics, mps_domain *domain);
double receivers_time(const receivers *r, int64_t row);
double receivers_value(const receivers *r, int64_t row, int64_t k);
/* Largest |acceleration| (m/s2) of receiver k. */
double receivers_peak(const receivers *r, int64_t k);
/* (max - min) / mean of the total energy; NaN when it was not recorded. */
double receivers_energy_drift(const receivers *r);

/* receivers.csv: time, the middle column, the edge; slope.csv: time, crest and toe, if any. */
bool receivers_write(app *a, const receivers *r, const char *directory);

/* ---- field.c --------------------------------------------------------------------------------- */

typedef struct field {
  mps_particles *particles; /* borrowed; of several ranks this one's share */
  int64_t count;            /* of all ranks; 0: no map */
  double *peak;             /* |acceleration|, m/s2, by particle id; of others' particles 0 */
} field;

/* Of `count` particles of all ranks. */
bool field_create(app *a, const settings *s, mps_particles *particles, int64_t count, field *out);
void field_destroy(field *f);
/* Raises the peaks to the present accelerations. */
mps_status field_record(field *f);
/* Brings the peaks of all ranks together. Collective. */
mps_status field_join(field *f, mps_domain *domain);
/* peaks.csv: x, y, peak of each particle of the slope, which `whole` has all; peaks.png. */
bool field_write(app *a, const settings *s, const field *f, mps_particles *whole);

/* ---- results.c ------------------------------------------------------------------------------- */

typedef enum outcome { OUTCOME_COMPLETE, OUTCOME_INTERRUPTED, OUTCOME_DIVERGED } outcome;

typedef struct results {
  outcome end;
  int64_t particles, steps;
  double dt, dt_limit;                    /* s; a limit of 0: there is no stable step */
  double surface_peak, surface_peak_edge; /* m/s2; NaN: diverged */
  double travel_time, travel_exact;       /* s; NaN: the wave has not arrived */
  comparison peak, travel;                /* of the surface, and of the time */
  double energy_drift;                    /* NaN: not defined */
} results;

/* Fills the peaks and times from the records; `signal` is the input. */
bool results_find(app *a, const settings *s, const column *c, const receivers *r,
                  const mps_signal *signal, results *out);
bool results_write(app *a, const settings *s, const results *x, const mps_signal *signal);
/* wave.png, as the paper's Figure 2. */
bool results_draw(app *a, const settings *s, const column *c, const receivers *r, const results *x);
void results_print(app *a, const settings *s, const results *x);

/* ---- restart.c ------------------------------------------------------------------------------- */

typedef struct results_so_far {
  const settings *s;
  receivers *record;
  field *peaks;
  int64_t every; /* steps between rows */
  bool same;     /* the checkpoint is of the same layers, receivers and map */
} results_so_far;

#define RESTART_KEY "mps-wave 3"
resume restart_parts(app *a, results_so_far *r, mps_dynamics *dynamics);

/* ---- files.c --------------------------------------------------------------------------------- */

typedef struct files {
  mps_particles *particles; /* borrowed; of several ranks this one's share */
  mps_domain *domain;       /* borrowed; NULL: one process */
  mps_particles *whole;     /* rank 0 of several: all ranks' particles, to write */
  mps_recorder *recorder;   /* NULL: no frames */
  char *series;             /* its file */
  double frame_every;       /* s, between frames; 0: no frames */
  int64_t next_frame;       /* due at next_frame * frame_every; the first at once */
  resume_schedule saves;    /* checkpoints */
  mps_dynamics *dynamics;   /* borrowed */
  app *a;                   /* borrowed */
  bool failed;              /* files_record, which ended the run */
  results_so_far *so_far;   /* borrowed: results in a checkpoint */
} files;

/* Reads the time step of the checkpoint that the options name, before the solver is made. */
bool files_peek(app *a, settings *s);
/* Restores the checkpoint, if any, and opens the files of the options. */
bool files_open(app *a, const settings *s, double duration, results_so_far *so_far,
                mps_dynamics *dynamics, files *out);
/* Writes the files that are due; call it with fields up to date. `status` is that of this rank so
 * far. As the others with a solver: on all ranks, of which rank 0 writes. */
mps_status files_record(files *f, mps_status status);
/* The particles of all ranks, brought up to date on rank 0; NULL on the others, or on an error. */
mps_status files_gather(files *f, mps_particles **whole);
/* The last checkpoint, wherever the run ended; false after an error line. */
bool files_close(app *a, files *f, bool diverged, bool interrupted);
void files_destroy(files *f);
