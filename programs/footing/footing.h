/* footing.h - the parts of mps-footing: settings and the course of the runs (run.c), ground and
 * footing (model.c), results (results.c), a section (section.c), the exact capacity (limits.c,
 * characteristics.c). SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_FOOTING_H
#define EXAMPLES_FOOTING_H

#include "characteristics.h"
#include "common/mpm_course.h"
#include "common/mpm_heap.h"
#include "common/mpm_method.h"
#include "common/mpm_model.h"
#include "common/sand.h"

enum { FOOTING_SAMPLES = 120, VON_MISES = 0, DRUCKER_PRAGER = 1 };
enum { STRIP = 0, CIRCLE = 1 };

/* The run of stiff ground, which keeps its shape; then that of the ground as it is, where it is
 * soft.
 */
enum { FOOTING_UNDEFORMED, FOOTING_DEFORMED };
typedef struct footing_pace {
  double young, rate, settlement; /* Pa, m/s, m */
} footing_pace;

typedef struct settings {
  int model, cone, shape; /* VON_MISES or DRUCKER_PRAGER; mps_material_cone; STRIP or CIRCLE */
  double width, depth;    /* m, of the half model */
  double phi, psi;        /* degrees */
  sand_voids voids;
  double cohesion, young;   /* Pa */
  double gradient;          /* Pa/m, growth of the cohesion with depth */
  double surcharge;         /* Pa, on the ground beside the footing */
  double eccentricity;      /* m, of the load's line from the middle of a strip */
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
  bool twice;                /* both runs */
  footing_pace pace[2], run; /* of both, and of the present one */
  mpm_course_options course;
  const char *domain, *out;
} settings;

typedef struct footing_row {
  double t, path, q, impulse; /* s, m, Pa, N s: on the footing so far */
} footing_row;

typedef struct simulation {
  settings s;
  mpm_model m;
  double ramp, t_end;                      /* s, of the present run */
  int now;                                 /* the present run, FOOTING_... */
  footing_row undeformed[FOOTING_SAMPLES]; /* of the first run, once it has ended */
  int undeformed_rows;
  mps_context *context;
  double *profile; /* of --section: points, stresses, plastic strains; NULL: none */
  int64_t points;
  mpm_course course;
} simulation;

/* limits.c: of frictional ground in plane strain, by the cone that it has: rad and Pa. phi is pi/2
 * where no pressure is too high for the ground. */
typedef struct footing_strength {
  double phi, psi, cohesion;
} footing_strength;
footing_strength footing_find_strength(const settings *s);

/* limits.c: Pa; NaN where they are not known, `exact` of a base that is neither smooth nor rough,
 * `davis` of associated flow. */
typedef struct footing_limits {
  double smooth, rough, exact, davis;
  const char *source;
} footing_limits;
footing_limits footing_find_limits(const settings *s);

/* What no such ground bears, Pa: that of associated flow, of a rough base where this one is neither
 * smooth nor rough; NaN where no bound is known or the ground's shape changes. */
double footing_find_bound(const settings *s);

/* A layer on rigid rough ground that is thinner than a mechanism is deep. */
bool footing_is_thin(const settings *s);
/* The load is eccentric: both halves are computed. */
bool footing_is_whole(const settings *s);

static inline int footing_rows(const simulation *sim) { return (int)sim->course.rows.count; }
static inline const footing_row *footing_row_of(const simulation *sim, int k) {
  return (const footing_row *)sim->course.rows.row + k;
}

/* run.c: fills in what depends on the model. Returns why settings are not consistent; NULL: good.
 */
const char *footing_settle(settings *s, const option *table);
/* About the capacity of the ground, Pa, from which stiffness, path and speed of a run follow. */
double footing_scale(const settings *s);
/* More than half of the capacity is of the weight of the ground. */
bool footing_weight_bears(const settings *s);
mps_status footing_build(mps_context *context, void *user);
mps_status footing_march(void *user);
bool footing_finish(app *a, void *user);

/* model.c: the present run's. */
mps_status footing_build_model(mps_context *context, simulation *sim);
double footing_area(const settings *s); /* m2, of the base that the force of the model acts on */

/* section.c: at the end of the run, collective on ranks; its table and picture, nothing without
 * one. */
mps_status footing_take_section(simulation *sim);
bool footing_write_section(app *a, const simulation *sim);

#endif
