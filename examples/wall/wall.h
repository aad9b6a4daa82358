/* wall.h - the parts of mps-wall: ground, wall and the run (model.c), results (results.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_WALL_H
#define EXAMPLES_WALL_H

#include "common/mpm_course.h"
#include "common/mpm_heap.h"
#include "common/mpm_model.h"

enum { WALL_SAMPLES = 80 };
enum { ACTIVE = 0, PASSIVE = 1 };
enum { TRANSLATES = 0, TURNS_ABOUT_TOE = 1, TURNS_ABOUT_TOP = 2 };

typedef struct settings {
  int pressure, motion;                    /* ACTIVE or PASSIVE; TRANSLATES ... */
  double height, base, length, front;      /* m */
  double phi, psi, cohesion, k0;           /* degrees, degrees, Pa, - */
  double young, poisson, density, gravity; /* Pa, -, kg/m3, m/s2 */
  double friction, corner, path, rate, h;  /* -, cells, m, m/s, m */
  double surcharge, sheet; /* Pa on the ground behind; m of the wall below the ground in front */
  double flip_time;        /* s */
  int64_t ppc, threads;
  int spline; /* degree of the weights less 2 */
  mpm_course_options course;
  const char *out;
} settings;

typedef struct simulation {
  settings s;
  mpm_model m;
  int32_t face;       /* part of the wall's surface in contact with the ground behind it */
  double ramp, t_end; /* s */
  double path[WALL_SAMPLES + 1]; /* m */
  double across[WALL_SAMPLES + 1], along[WALL_SAMPLES + 1], moment[WALL_SAMPLES + 1];
  /* N/m, of the ground on the wall, across it and upwards along it; N, about its reference point */
  int rows;
  double last_time, last[3]; /* s; N s and N m s: impulses at the last sample */
  mpm_snapshot shot;         /* plastic strain at the last sample */
  mpm_course course;
} simulation;

double wall_thickness(const settings *s); /* m */
mps_status wall_build(mps_context *context, void *user);
mps_status wall_march(void *user);
bool wall_finish(app *a, void *user);

#endif
