/* pile.h - an open-ended pile pushed into sand (Nakamura 8): settings, the run, and its parts.
 *
 * Axisymmetric: x is the radius r, y the height above the bottom of the soil. Forces are those of
 * the whole pile. Depths are measured from the initial surface, downwards.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/mpm_method.h"
#include "penetration/push.h"

#define PILE_ROWS 5       /* a cell of path */
#define PILE_GRAVITY 9.81 /* m/s2 */

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
  int64_t ppc, threads;
  int spline, volumetric; /* degree of the weights less 2; mps_mpm_volumetric */
  mpm_method method;
  bool paper;
  mpm_course_options course;
  const char *out;
} pile_settings;

enum { PILE_TIP, PILE_INSIDE, PILE_OUTSIDE, PILE_TOTAL = PUSH_TOTAL }; /* forces of a row */

/* The soil at one depth of the pile: r, height, mean stress, deviatoric stress, plastic strain. */
enum { FIELD_R, FIELD_Z, FIELD_MEAN, FIELD_DEVIATOR, FIELD_STRAIN, FIELDS };
typedef struct pile_frame {
  double depth;
  float *value; /* FIELDS a particle */
} pile_frame;
enum { PILE_PICTURES = 4 }; /* frames shown in a picture */

typedef struct pile {
  pile_settings s;
  mpm_model m;
  double k0, inner, outer;   /* 1; m: radii of the wall */
  double penalty;            /* N/m per unit thickness */
  int64_t particles;         /* of all ranks */
  double dt, t_start, t_end; /* s: first step, start and end of the pile's motion */
  push push;                 /* along the path */
  double stride;             /* m of path between rows */
  pile_frame frame[PILE_PICTURES];
  int64_t frames, frames_kept;
  mpm_course course;
} pile;

/* ---- model.c --------------------------------------------------------------------------------- */

mps_material_cone pile_cone(const pile_settings *s);
const char *pile_cone_name(const pile_settings *s);
/* Reads `soil`, and returns why the settings cannot be run; NULL where they can. */
const char *pile_check(pile_settings *s);
mps_status pile_build(mps_context *context, void *user);
void pile_free(pile *p); /* objects that the model does not own */

/* ---- drive.c --------------------------------------------------------------------------------- */

mps_status pile_drive(void *user);

/* ---- fields.c -------------------------------------------------------------------------------- */

mps_status pile_take_frame(pile *p);
bool pile_write_frames(app *a, pile *p);
void pile_pass_frames(pile *p, resume_bytes *b);
void pile_free_frames(pile *p);

/* How many of the first `frames` frames are kept for the pictures. */
int64_t pile_pictures(const pile *p, int64_t frames);

/* ---- results.c, pictures.c ------------------------------------------------------------------- */

bool pile_finish(app *a, void *user);
/* Engineering estimates (N; 1): friction of the outer shaft at K0 stress at `depth`, and the
 * bearing capacity factor of the tip after Prandtl and Reissner. */
double pile_beta_shaft(const pile *p, double depth);
double pile_nq(const pile *p);
bool pile_draw(app *a, const pile *p);
