/* penetrometer.h - a rigid tip pushed into a box of soil: settings, the runs, and their parts.
 *
 * In space z is upwards and the axis is x = y = 0; in axisymmetry x is the radius and y upwards.
 * The floor is at height 0. Forces are those of the whole tip: 4 times those of a quarter. Depths
 * are measured from the initial surface, downwards, to the lowest point.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "penetration/push.h"

#define PEN_WATER 1000.0 /* kg/m3, in pores */

enum { PEN_CONE, PEN_SPHERE, PEN_STL };                             /* --tip */
enum { PEN_CLAY, PEN_SAND, PEN_ELASTIC, PEN_TRESCA, PEN_CAM_CLAY }; /* --law */
enum { PEN_AXIAL, PEN_QUARTER, PEN_WHOLE };                         /* --symmetry */
enum { PEN_ROLLERS, PEN_FREE };                                     /* --sides */
enum { PEN_TIP, PEN_SHAFT, PEN_TOTAL = PUSH_TOTAL };                /* forces of a row */

typedef struct pen_settings {
  int tip, law, model, sides, volumetric;
  int spline;  /* degree of the weights less 2 */
  int contact; /* mps_contact_method */
  const char *mesh;
  double scale;                 /* m per unit of the mesh */
  double diameter, angle;       /* m, degrees */
  double depth, rate, friction; /* m, m/s, 1 */
  double start;                 /* m, depth at the beginning; 0: above the ground */
  double alpha;                 /* of the cohesion; NaN: no bound */
  double corner, inset; /* radius of the tip's edges; how far before them faces end; cells */
  const char *soil;     /* "WxWxH", m */
  double width, breadth, height;           /* m, what `soil` says */
  double e_max;                            /* of sand */
  double cohesion, phi, psi;               /* Pa, degrees */
  double young, poisson, density, gravity; /* Pa, 1, kg/m3, m/s2; NaN: by the law */
  double surcharge, k0, ir;                /* Pa, horizontal over vertical stress, G/su */
  double M, lambda, kappa, e0, ocr;        /* of Cam-Clay; e0 of sand too */
  double permeability;                     /* m/s; NaN: undrained */
  double h, courant, flip_time;            /* m, 1, s; NaN: by law and speed */
  bool both;                               /* after space the same about an axis */
  int64_t ppc, threads;
  mpm_course_options course;
  const char *out;
} pen_settings;

/* A particle of the vertical section through the axis, at the end. */
typedef struct pen_point {
  double x, z; /* m: distance from the axis (to the left in axisymmetry), height over the ground */
  double moved, strain; /* m, plastic strain (0: the law has none) */
} pen_point;

typedef struct pen_run {
  mps_mpm_geometry geometry;
  mpm_model m;
  double size[3]; /* m: half width, half breadth, height; in axisymmetry radius and height */
  push push;      /* along the path */
  double penalty, dt;
  double rest; /* N, upwards on the tip before it moves */
  int64_t particles, steps;
  pen_point *point;
  int64_t points;
} pen_run;

/* Undrained ground before the penetration, where it has no weight: Pa. */
typedef struct pen_state {
  double sideways, strength, shear; /* horizontal stress, su in triaxial compression, G */
} pen_state;

typedef struct penetrometer {
  pen_settings s;
  pen_state state;
  pen_run run[2]; /* the second one, if there are two, is the axisymmetric one */
  int runs, now;  /* number of runs, and the present one */
  mpm_course course;
  double stride; /* m of path between rows */
  double hold;   /* s, the tip waits in its hole: the ground comes to rest */
  double t_end;  /* s */
  mps_context *context;
} penetrometer;

/* ---- model.c --------------------------------------------------------------------------------- */

/* Reads `soil`, fills in what depends on others, and returns why the settings cannot be run; NULL
 * where they can. */
const char *pen_check(penetrometer *p, const option *table);
mps_status pen_build(mps_context *context, void *user);
/* The run p->now. */
mps_status pen_build_run(penetrometer *p, bool restores);
void pen_free(penetrometer *p);             /* objects that the model does not own */
double pen_radius(const penetrometer *p);   /* m */
double pen_shoulder(const penetrometer *p); /* m: height of the cone */
double pen_gap(const penetrometer *p);      /* m: between tip and ground at the start */
double pen_path(const penetrometer *p);     /* m: of the whole run */
int pen_up(const pen_run *r);               /* the vertical axis */

/* ---- soil.c ---------------------------------------------------------------------------------- */

const char *pen_check_soil(penetrometer *p, const option *table); /* part of pen_check */
/* Particles with their stress at rest and law; `lower`: corner of their box. */
mps_status pen_make_soil(penetrometer *p, pen_run *r, const double *lower);
/* Pore water, and the surcharge, once the solver is made. */
mps_status pen_load_soil(const penetrometer *p, pen_run *r);

double pen_vertical(const penetrometer *p, double depth); /* Pa, total stress of ground at rest */

/* Cone factors at a tip pressure q (Pa) and depth (m); NaN where there are none. */
typedef struct pen_factor {
  double strength, rigidity;  /* su in triaxial compression (Pa), Ir = G/su */
  double vertical, deviation; /* total vertical stress at the tip (Pa), (sv - sh)/(2 su) */
  double n_kt;                /* (q - sv)/su */
  double teh_houlsby, lu;     /* of a smooth cone, by strain paths and by finite elements */
} pen_factor;
pen_factor pen_factor_of(const penetrometer *p, double q, double depth);

/* ---- push.c ---------------------------------------------------------------------------------- */

mps_status pen_push(void *user);
double pen_reached(const pen_run *r); /* m: depth of the last row */

/* ---- results.c, pictures.c ------------------------------------------------------------------- */

bool pen_finish(app *a, void *user);
/* Hertz: force (N) on a smooth rigid sphere in an elastic half space. */
double pen_hertz(const penetrometer *p, double depth);
bool pen_draw(app *a, const penetrometer *p);
