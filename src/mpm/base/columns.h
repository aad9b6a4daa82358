/* columns.h - the particles as the solver works on them: structure of arrays, in sorted order, over
 * the memory of the fields of the particle set. Tensors by rows.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_COLUMNS_H
#define MPSI_MPM_COLUMNS_H

#include "mpm/particles/laws.h"

#include <mps/particles.h>

typedef struct mpsi_columns {
  int64_t count;
  double *x[3], *v[3]; /* m, m/s */
  double *L[9];        /* 1/s, velocity gradient; 2D: xx, xy, yx, yy, hoop */
  double *D[9];        /* 1/s, derivatives of the velocity that the laws see, as L without the hoop;
                          NULL where no law waits for a mean: G2P passes them on */
  double *rough;       /* of the step being made, where a mean stress is filtered (filter.c): the
                          plastic strain before the law, then, Pa, what the nodes do not see of the
                          mean stress; NULL where none is */
  double *s[6];        /* Pa: xx, yy, zz, xy, zx, yz; 2D: the first four */
  double *u, *g[3]; /* Pa, Pa/m: pressure of pore water, which forces come from besides s, and its
                       gradient; NULL without water */
  double *n, *k;    /* porosity; permeability, m/s: NULL where water does not flow */
  double *V, *m;    /* m3, kg */
  double *J;        /* V/V0 where some law reads it, else NULL */
  double *F[9];     /* as L; NULL where all laws do without */
  double *f[3];     /* N, body accelerations and loads of the step; NULL where there are none */
  int64_t *law;     /* number of each particle's law; NULL: one law */
  mpsi_laws laws;
  mps_particles *set; /* the caller's, whose fields these are */
  int32_t *stencil;   /* lowest node of the particle's stencil, in its block's tile, of the step
                         being made; NULL where volumetric.c and filter.c have no work */
} mpsi_columns;

#endif
