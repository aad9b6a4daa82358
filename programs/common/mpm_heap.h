/* mpm_heap.h - measures of collapsing heaps on a bed y = 0 beside a wall x = 0: the front, the
 * height at the wall, the velocity, and pictures of their particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm_model.h"
#include "area.h"
#include "output.h"

typedef struct mpm_heap {
  double front;        /* m: farthest x of the heap, half a spacing beyond the last particle */
  double reach;        /* m: 98 % of the particles are nearer to the wall; axisymmetry: NaN */
  double top;          /* m: highest y of the heap beside the wall, likewise */
  double height;       /* m: volume beside the wall over the area of the band */
  double mass;         /* kg, of all particles; plane: of 1 m, as the following */
  double potential;    /* J above the bed, gravity g given */
  double kinetic;      /* J */
  double volume;       /* m3 */
  double volume_ratio; /* largest V/V0 of a particle */
  double detached;     /* share of the mass ahead of the front */
  double edge;         /* m: farthest x at which the heap is `thickness` thick; 0: nowhere */
} mpm_heap;

typedef struct mpm_heap_def {
  double g;          /* m/s2 */
  double band;       /* m: beside the wall is x < band */
  bool axisymmetric; /* x = 0 is the axis of a cylinder */
  double density;    /* kg/m3, of particles at the start; axisymmetry */
  double thickness;  /* m: that of the heap at its `edge`, a mean over the width `window` (m) */
  double window;
} mpm_heap_def;

/* Drops are left out: particles ahead of a gap of 2 spacings (for `top`: above it) that are less
 * than 1 % of all. Collective: all ranks receive it. */
mps_status mpm_heap_measure(mpm_model *m, const mpm_heap_def *def, mpm_heap *out);

/* Positions and one value of all particles at one time, in ascending order of ids. */
typedef struct mpm_snapshot {
  double time; /* s */
  int64_t count;
  double *row; /* x, y (m), value of each particle */
} mpm_snapshot;

/* The value is the pressure (Pa) for `field` "stress", else the first component of the field.
 * Replaces the former contents of `shot`; free with mpm_snapshot_free. Collective: of several ranks
 * rank 0 receives it. */
mps_status mpm_snapshot_take(mpm_model *m, double time, const char *field, mpm_snapshot *shot);
/* The same on rank 0 alone, of the particles that mpm_model_whole has seen last. */
mps_status mpm_snapshot_last(const mpm_model *m, double time, const char *field,
                             mpm_snapshot *shot);
void mpm_snapshot_free(mpm_snapshot *shot);
/* The greatest number >= 0 of a column: 0 x, 1 y, 2 the value. */
double mpm_snapshot_most(const mpm_snapshot *shot, int column);
/* DIR/NAME: a line frame,t_s,x_m,y_m,VALUE for each particle of each shot. */
bool mpm_snapshots_write(app *a, const char *directory, const char *name, const char *value,
                         int count, const mpm_snapshot *shots);

/* DIR/NAME: the area of the particles of each shot. */
bool mpm_snapshots_image(app *a, const char *directory, const char *name, int count,
                         const mpm_snapshot *shots, const area_def *def, area *images);
