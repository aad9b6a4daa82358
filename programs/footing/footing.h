/* footing.h - the parts of mps-footing: model and run (model.c), results (results.c), a section
 * (section.c), the exact capacity (characteristics.c). SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_FOOTING_H
#define EXAMPLES_FOOTING_H

#include "characteristics.h"
#include "common/mpm_course.h"
#include "common/mpm_method.h"
#include "common/mpm_model.h"
#include "common/sand.h"

enum { FOOTING_SAMPLES = 120, FOOTING_SETTLED = 30, VON_MISES = 0, DRUCKER_PRAGER = 1 };
enum { STRIP = 0, CIRCLE = 1 };

typedef struct settings {
  int model, cone, shape; /* VON_MISES or DRUCKER_PRAGER; mps_material_cone; STRIP or CIRCLE */
  double width, depth;    /* m, of the half model */
  double phi, psi;        /* degrees */
  sand_voids voids;
  double cohesion, young;   /* Pa */
  double gradient;          /* Pa/m, growth of the cohesion with depth */
  double surcharge;         /* Pa, on the ground beside the footing */
  double eccentricity;      /* m, of the load's line from the middle of a strip */
  double tolerance;         /* of the ground at rest, in the second half of the path */
  double top, top_cohesion; /* m, Pa: of an upper layer; 0: none */
  double poisson, density, gravity;
  int contact;            /* mps_contact_method */
  int spline, volumetric; /* degree of the weights less 2; mps_mpm_volumetric */
  double courant;
  double inset;                                          /* of its base, cells */
  double h, mu, corner, rate, half_width, k, settlement; /* m, 1, cells, m/s, m, N/m, m */
  double flip_time;                                      /* s */
  double section;                                        /* m: x of a vertical line; NaN: none */
  int64_t ppc, threads;
  mpm_method method;
  bool paper;
  bool settled; /* --quasi-static */
  mpm_course_options course;
  const char *domain, *out;
} settings;

typedef struct footing_row {
  double t, path, q, impulse; /* s, m, Pa, N s: on the footing so far */
} footing_row;

typedef struct simulation {
  settings s;
  mpm_model m;
  double ramp, t_end; /* s */
  int samples;        /* in all */
  double strain;      /* largest plastic strain */
  double *profile;    /* of --section: points, stresses, plastic strains; NULL: none */
  int64_t points;
  mpm_course course;
} simulation;

/* What pressures are shown over: the surcharge, rho g B/2 or the cohesion of the upper ground. Pa.
 */
typedef struct footing_unit {
  double value;
  const char *name;
} footing_unit;
footing_unit footing_unit_of(const settings *s);
/* A layer on rigid rough ground that is thinner than a mechanism is deep. */
bool footing_is_thin(const settings *s);
/* The load is eccentric: both halves are computed. */
bool footing_is_whole(const settings *s);

static inline int footing_rows(const simulation *sim) { return (int)sim->course.rows.count; }
static inline const footing_row *footing_row_of(const simulation *sim, int k) {
  return (const footing_row *)sim->course.rows.row + k;
}

/* Fills in what depends on the model. Returns why settings are not consistent; NULL: good. */
const char *footing_settle(settings *s, const option *table);
mps_status footing_build(mps_context *context, void *user);
mps_status footing_march(void *user);
bool footing_finish(app *a, void *user);

/* section.c: at the end of the run, collective on ranks; its table and picture, nothing without
 * one. */
mps_status footing_take_section(simulation *sim);
bool footing_write_section(app *a, const simulation *sim);

#endif
