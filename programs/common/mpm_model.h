/* mpm_model.h - common parts of the programs on the WLS-MPM solver: their objects, and the course
 * of a run from the options to the exit code.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "options.h"
#include "output.h"

#include <mps/experimental/domain.h>
#include <mps/fluid.h>
#include <mps/history.h>
#include <mps/io.h>
#include <mps/mpm.h>

enum { MPM_MODEL_BODIES = 8, MPM_MODEL_SAMPLES = 3 };

typedef struct mpm_model {
  mps_particles *particles;
  mps_material *material;
  mps_mpm *mpm;
  mps_fluid *fluid;                 /* in its place where a program has the choice */
  mps_history *history;             /* of the solver, NULL: none */
  mps_body *body[MPM_MODEL_BODIES]; /* NULL where there is none */
  int64_t samples;                  /* rows of results so far, which `march` counts */
  bool failed;   /* `march` sets it where something is missing that was requested: exit code 1 */
  char why[400]; /* reason of an error of `build` or `march` that the library does not know; "" */
  app *a;        /* of the run */
  int64_t count; /* particles of all ranks, when `march` begins and when `finish` does */
  mps_particles *whole; /* of several ranks, on rank 0: the last set of mpm_model_whole */
} mpm_model;

/* The parts of a run; `user` is that of mpm_model_run. */
typedef struct mpm_model_parts {
  mps_status (*build)(mps_context *context, void *user);
  mps_status (*march)(void *user);
  bool (*finish)(app *a, void *user); /* results; false after an error line; rank 0 only */
} mpm_model_parts;

/* Options of where a run's files are; resume_places may change the two names. */
typedef struct mpm_model_places {
  const char **out, **checkpoint, *restart;
} mpm_model_places;

/* Starts the library, makes the directory `out`, builds, marches, finishes, and destroys the model.
 * `finish` is also called for a run that ended early, by Ctrl-C or an error, with at least
 * MPM_MODEL_SAMPLES samples. Returns the exit code. */
int mpm_model_run(const options_program *program, int64_t threads, const mpm_model_places *places,
                  mpm_model *model, const mpm_model_parts *parts, void *user);

/* ---- several ranks ---------------------------------------------------------------------------
 * Each builds its part of the particles, and all else of the model. `build` and `march` are called
 * on all of them; their results must be the same on all. */

/* Makes the set m->particles, which lies in parts on the ranks. Collective, as its fills are. */
mps_status mpm_model_particles(mpm_model *m, mps_context *context, const mps_particles_def *def);

/* mps_mpm_create with m->particles and m->material, after `status`, which is that of the rank's own
 * objects, such as particles and bodies: a failure on one rank is one on all, and the solver is not
 * made. Sets `domain` of the definition. */
mps_status mpm_model_create(mpm_model *m, mps_context *context, mps_status status,
                            mps_mpm_def *def);
/* The particles of all ranks, for reading: *whole is NULL on all but rank 0. Collective. */
mps_status mpm_model_whole(mpm_model *m, mps_particles **whole);
/* *value becomes the sum of those of all ranks, which are below 2^53. Collective. */
mps_status mpm_model_sum(mpm_model *m, int64_t *value);
/* Of a number that each rank counts among its own particles after every step, the greatest sum of
 * all ranks. They exchange the numbers of many steps at once, and only where there are any. */
typedef struct mpm_counts {
  int64_t *untold, steps, room;
} mpm_counts;
mps_status mpm_counts_note(mpm_model *m, mpm_counts *c, int64_t count, int64_t *most);
mps_status mpm_counts_join(mpm_model *m, mpm_counts *c, int64_t *most); /* collective */
/* The rows of a set in ascending order of their ids, to be freed: sums and files in this order do
 * not depend on the order of the particles. NULL: no memory. */
int64_t *mpm_rows_by_id(mps_particles *particles);
/* After work on rank 0: a failure of one rank becomes that of all, and else `values` of rank 0 are
 * sent to all. Collective. */
mps_status mpm_model_tell(mpm_model *m, mps_status status, int count, double *values);

/* Ids of the particles of all ranks at places x (m, as many values as the set has dimensions) that
 * are chosen, the same list on all: that of a load. To be freed, NULL after an error. Collective.
 */
mps_status mpm_model_list(mpm_model *m, bool (*chosen)(const void *user, const double *x),
                          const void *user, int64_t *count, int64_t **ids);

/* A series for ParaView, as frame_series, and a frame of it at the present time. Collective: rank 0
 * has the series, the others NULL. */
mps_status mpm_model_series(mpm_model *m, const char *directory, const char *what, double from,
                            mps_recorder **out);
mps_status mpm_model_frame(mpm_model *m, mps_recorder *series);

/* mps_mpm_run, with the progress bar continued. */
mps_status mpm_model_advance(mpm_model *m, double t_end, int64_t every, mps_mpm_fn callback,
                             void *user);

/* Rows of the grid with their defaults: side of a cell, particles in it, time step, degree of the
 * weights. */
#define MPM_MODEL_GRID(s, cell_, ppc_, courant_, note)                                             \
  OPTION_NUMBER("cell", &(s)->h, note, cell_), OPTION_INTEGER("ppc", &(s)->ppc, NULL, ppc_),       \
      OPTION_NUMBER("courant", &(s)->courant, NULL, courant_),                                     \
      OPTION_CHOICE("spline", &(s)->spline, NULL, 1)
/* The row of a program's table that chooses the contact's method, an mps_contact_method. */
#define MPM_MODEL_CONTACT(value) OPTION_CHOICE("contact", value, NULL)
/* Why an option of penalty contact alone, --k or --xi, cannot be given; NULL where it can. */
const char *mpm_model_refuse_stiffness(const option *table, int contact);
/* Settles --corner and --inset (cells), of which one is 0; `usual`: --inset where neither is given.
 * Returns what they exclude, or NULL. */
const char *mpm_model_settle_edges(const option *table, int contact, double usual, double *corner,
                                   double *inset);

/* Why a model of so many particles is not begun; NULL where it is. */
const char *mpm_model_too_large(double particles);

/* Destroys all objects and nulls them: before `march` builds the next of several models. */
void mpm_model_destroy(mpm_model *model);

/* Opens DIR/summary.json and writes the common part of all summaries. */
bool mpm_model_summary(app *a, const mpm_model *model, const char *directory, output *file);
