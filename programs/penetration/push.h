/* push.h - a rigid body pushed into soil, of mps-pile and mps-penetrometer: its forces by part
 * along the path, after every step a check for particles inside it, and what both know of soil and
 * contact.
 *
 * The vertical axis is y in axisymmetry and z in space. Depths are measured from the initial
 * surface, downwards. Forces are those of the whole body. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/mpm_course.h"
#include "common/mpm_model.h"
#include "common/sand.h"

#define PUSH_PI 3.14159265358979323846
enum { PUSH_PARTS = 3, PUSH_TOTAL = PUSH_PARTS, PUSH_FORCES };

typedef struct push_row {
  double depth;               /* m */
  double force[PUSH_FORCES];  /* N, upwards: mean over the path since the row before */
  double smooth[PUSH_FORCES]; /* N, mean over a window of the path about the row */
  double jitter;              /* N, rms of the single steps' total about their mean */
  double plug; /* m, of a pile: top of the soil inside above the tip; NaN: none yet */
} push_row;

/* After every step, of all ranks after an exchange. */
typedef struct push_seen {
  double ratio_max, ratio_min; /* of V/V0 */
  int64_t inside;              /* most particles inside the body at once */
  double deepest;              /* m, the furthest that one was below its surface */
  double speed;                /* m/s, fastest particle, where push_look_at_speeds is called */
} push_seen;

typedef struct push {
  mpm_model *m; /* with the body, its first, and the particles */
  const char *part[PUSH_PARTS];
  double ground, above; /* m: height of the surface; of the reference point over the lowest point */
  double lower, upper;  /* m, of the distance from the axis: particles that may be inside */
  double density, cell; /* kg/m3, m */
  double factor;        /* of forces: 4 of a quarter */
  push_row *row;
  int64_t rows, capacity;
  double last_time, last_step, squares, last_impulse[PUSH_FORCES]; /* since the last row */
  push_seen seen;
  mpm_counts counts; /* of particles inside */
  double *near;      /* positions of the particles that may be inside, room for all, */
  double *distance;  /* and their distances */
} push;

/* Room for rows, and for `particles` of all ranks: one may have any number of them. */
mps_status push_begin(push *p, int64_t capacity, int64_t particles);
void push_free(push *p);
int push_up(const push *p); /* the vertical axis */
double push_depth(const push *p);

/* After a step. */
mps_status push_look(push *p, bool at_volumes);
mps_status push_look_at_speeds(push *p);
mps_status push_note_jitter(push *p, double t);
/* Maximum over all ranks of the checks of their own particles. Collective. */
mps_status push_join(push *p, mps_status status);
/* Upward impulses on the body so far (N s); of one without parts all is the tip. */
mps_status push_impulses(const push *p, double *up);
/* Ends the row at time t; *row is NULL where there is none to end. */
mps_status push_end_row(push *p, double t, push_row **row);
/* Means over `half` rows to both sides, of a row as far to either side, but `least` at the ends. */
void push_smooth(push *p, int64_t half, int64_t least);
/* Part of a program's data in a checkpoint. */
void push_pass(push *p, resume_bytes *b);

/* The weight above and a surcharge (Pa), sideways k0 as much. */
mps_status push_set_stress(push *p, double gravity, double k0, double surface, double surcharge);
/* Degrees; `voids` may end the dilation. */
typedef struct push_sand {
  double young, poisson, phi, psi, cohesion;
  sand_voids voids;
  mps_material_cone cone;
} push_sand;
mps_status push_make_sand(mps_context *context, const push_sand *s, mps_material **out);
/* Stiffness of penalty contact, N/m, in axisymmetry per unit thickness: the pressure below a tip
 * must not use up the offset. */
double push_penalty(const push *p);
/* Lengths in cells; `penalty` is for that method. */
mps_status push_add_contact(push *p, int method, double corner, double inset, double penalty,
                            mps_contact_def *contact);

/* A value that `share` of the `count` values do not exceed; NaN without memory. */
double push_most(int64_t count, const double *value, double share);
