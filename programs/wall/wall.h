/* wall.h - the parts of mps-wall: wall and the run (model.c), layers and water (ground.c), results
 * (results.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/mpm_course.h"
#include "common/mpm_heap.h"
#include "common/mpm_model.h"
#include "common/sand.h"

enum { WALL_SAMPLES = 80, WALL_LAYERS = 16 };
enum { ACTIVE = 0, PASSIVE = 1 };
enum { TRANSLATES = 0, TURNS_ABOUT_TOE = 1, TURNS_ABOUT_TOP = 2 };

typedef struct wall_layer {
  double thickness;          /* m; the last one continues downwards */
  double phi, psi, cohesion; /* degrees, degrees, Pa */
  double density;            /* kg/m3, saturated below the water table */
} wall_layer;

typedef struct settings {
  int pressure, motion;               /* ACTIVE or PASSIVE; TRANSLATES ... */
  double height, base, length, front; /* m */
  sand_voids voids;
  double phi, psi, cohesion, k0;           /* degrees, degrees, Pa, - */
  double young, poisson, density, gravity; /* Pa, -, kg/m3, m/s2 */
  double courant;
  double friction, corner, inset, path, rate, h; /* -, cells, cells, m, m/s, m */
  double surcharge, sheet; /* Pa on the ground behind; m of the wall below the ground in front */
  double water;            /* m, depth of the water table below the surface; NaN: none */
  double heaviest;         /* kg/m3 of the layers */
  bool k0_given;
  int layers; /* 1: of the options */
  wall_layer layer[WALL_LAYERS];
  const char *layers_file;
  double flip_time; /* s */
  int64_t ppc, threads;
  int spline; /* degree of the weights less 2 */
  mpm_course_options course;
  const char *out;
} settings;

typedef struct wall_row {
  double t, path, across, along, moment; /* s, m; N/m, of the ground on the wall, across it and
                                            upwards along it; N, about its reference point */
  double sums[3];                        /* N s/m, N s/m, N s: on the wall so far */
} wall_row;

typedef struct simulation {
  settings s;
  mpm_model m;
  int32_t face;       /* part of the wall's surface in contact with the ground behind it */
  double ramp, t_end; /* s */
  mpm_snapshot shot;  /* plastic strain at the last sample */
  mpm_course course;
} simulation;

static inline int wall_rows(const simulation *sim) { return (int)sim->course.rows.count; }
static inline const wall_row *wall_row_of(const simulation *sim, int k) {
  return (const wall_row *)sim->course.rows.row + k;
}

/* ground.c */
const char *wall_settle_ground(settings *s, const option *table);
bool wall_is_plain(const settings *s); /* one layer, dry */
const wall_layer *wall_layer_at(const settings *s, double depth);
mps_status wall_set_ground(settings *s, mps_particles *set); /* densities, buoyancy, stresses */
mps_status wall_make_law(mps_context *context, const settings *s, int k, mps_material **out);
mps_status wall_set_laws(mps_context *context, const settings *s, mpm_model *m);
/* The force of the ground (N/m) by coefficients K of its layers; `bound`: without tension. */
typedef double (*wall_coefficient_fn)(const settings *s, const wall_layer *l);
double wall_theory(const settings *s, wall_coefficient_fn k_of, bool bound);
double wall_unit(const settings *s);  /* N/m of K = 1: the weight of the ground above, summed */
double wall_water(const settings *s); /* N/m, of the water behind */

double wall_thickness(const settings *s); /* m */
mps_status wall_build(mps_context *context, void *user);
mps_status wall_march(void *user);
bool wall_finish(app *a, void *user);
