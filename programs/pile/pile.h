/* pile.h - an open-ended pile pushed into sand (Nakamura 8): settings, the run, and its parts.
 *
 * Axisymmetric: x is the radius r, y the height above the bottom of the soil. Forces are those of
 * the whole pile. Depths are measured from the initial surface, downwards.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/mpm_method.h"
#include "common/mpm_model.h"
#include "common/resume.h"
#include "common/sand.h"

#define PILE_GRAVITY 9.81 /* m/s2 */
#define PILE_PI 3.14159265358979323846

typedef struct pile_settings {
  double inner_diameter, wall;        /* m */
  double friction, rate, depth, rest; /* mu; m/s; m; s of waiting before the pile moves */
  double corner, inset;           /* radius of its edges; how far before them faces end; cells */
  int contact;                    /* mps_contact_method */
  double xi, k;                   /* contact stiffness by Nakamura (58), or in N/m; NaN: not so */
  const char *soil;               /* "WxH" */
  double width, height;           /* m, what `soil` says */
  double density, young, poisson; /* kg/m3, Pa, 1 */
  sand_voids voids;
  double phi, psi, cohesion, k0; /* degrees, degrees, Pa; k0 NaN: nu/(1 - nu) */
  int cone;                      /* see pile_cone */
  double h, courant, flip_time;  /* m, 1, s */
  int64_t ppc, frames, threads;
  int spline, volumetric; /* degree of the weights less 2; mps_mpm_volumetric */
  mpm_method method;
  bool paper;
  const char *checkpoint, *restart; /* files, NULL: none */
  double every_checkpoint;          /* s; NaN: a tenth of the run */
  const char *out;
} pile_settings;

enum { PILE_TIP, PILE_INSIDE, PILE_OUTSIDE, PILE_PARTS, PILE_TOTAL = PILE_PARTS, PILE_FORCES };

/* One row of load.csv. */
typedef struct pile_row {
  double depth;               /* m, of the tip */
  double force[PILE_FORCES];  /* N, upwards on the pile: mean over the path since the row before */
  double smooth[PILE_FORCES]; /* N, mean over a window of the path about the row */
  double jitter;              /* N, rms of the single steps' total about their mean */
  double plug;                /* m, top of the soil inside above the tip; NaN: none yet */
} pile_row;

/* The soil at one depth of the pile: r, height, mean stress, deviatoric stress, plastic strain. */
enum { FIELD_R, FIELD_Z, FIELD_MEAN, FIELD_DEVIATOR, FIELD_STRAIN, FIELDS };
typedef struct pile_frame {
  double depth;
  float *value; /* FIELDS a particle */
} pile_frame;
enum { PILE_PICTURES = 4 }; /* frames shown in a picture */

/* History of the run after every step. */
typedef struct pile_seen {
  double ratio_max, ratio_min; /* of V/V0 */
  int64_t inside;              /* most particles inside the wall at once */
  double deepest;              /* m, the furthest that one was below its surface */
  double rest_speed; /* m/s, fastest particle in the second half of the time before contact */
} pile_seen;

typedef struct pile {
  pile_settings s;
  const option *table; /* of the options */
  mpm_model m;
  double k0, inner, outer;   /* 1; m: radii of the wall */
  double penalty;            /* N/m per unit thickness */
  int64_t particles;         /* of all ranks */
  double dt, t_start, t_end; /* s: first step, start and end of the pile's motion */
  pile_row *row;
  int64_t rows, capacity;
  double stride;                                                   /* m of path between rows */
  double last_time, last_impulse[PILE_FORCES], last_step, squares; /* since the last row */
  pile_seen seen; /* of all ranks, after an exchange */
  mpm_counts inside;
  pile_frame frame[PILE_PICTURES];
  int64_t frames, frames_kept;
  mps_recorder *recorder; /* NULL in a libmps without HDF5, and on all ranks but the first */
  char vtk[40];           /* its file, "": there has been none */
  bool opened;            /* with the first frame: a series without one is none */
  double restarted;       /* s: time of the checkpoint that the run continues from */
  resume_schedule saves;
} pile;

/* ---- model.c --------------------------------------------------------------------------------- */

mps_material_cone pile_cone(const pile_settings *s);
const char *pile_cone_name(const pile_settings *s);
/* Reads `soil`, and returns why the settings cannot be run; NULL where they can. */
const char *pile_check(pile_settings *s);
mps_status pile_build(mps_context *context, void *user);
void pile_free(pile *p); /* objects that the model does not own */

/* ---- drive.c --------------------------------------------------------------------------------- */

/* Allocates the empty history of a run from the beginning. */
mps_status pile_begin(pile *p);
mps_status pile_drive(void *user);
/* Depth of the tip (m). */
double pile_depth(const pile *p);

/* ---- fields.c -------------------------------------------------------------------------------- */

mps_status pile_take_frame(pile *p);
bool pile_write_frames(app *a, pile *p);
void pile_free_frames(pile *p);

/* How many of the first `frames` frames are kept for the pictures. */
int64_t pile_pictures(const pile *p, int64_t frames);

/* ---- restart.c ------------------------------------------------------------------------------- */

/* An error for a file `restart` that was made with other options, which it names. */
mps_status pile_peek(mps_context *context, pile *p);
/* Writes `checkpoint`: the solver, and the history of the run of the pile `user`. */
mps_status pile_save(void *user);
/* Restores the state of the file `restart`. */
mps_status pile_restore(mps_context *context, pile *p);

/* ---- results.c, pictures.c ------------------------------------------------------------------- */

bool pile_finish(app *a, void *user);
/* Engineering estimates (N; 1): friction of the outer shaft at K0 stress at `depth`, and the
 * bearing capacity factor of the tip after Prandtl and Reissner. */
double pile_beta_shaft(const pile *p, double depth);
double pile_nq(const pile *p);
bool pile_draw(app *a, const pile *p);
