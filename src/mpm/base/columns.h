/* columns.h - the particles as structure of arrays, in sorted order, over the memory of the fields
 * of the particle set. Tensors by rows. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_COLUMNS_H
#define MPSI_MPM_COLUMNS_H

#include "mpm/particles/laws.h"

#include <mps/particles.h>

typedef struct mpsi_columns {
  int64_t count;
  double *x[3], *v[3]; /* m, m/s */
  double *L[9];        /* 1/s, velocity gradient; 2D: xx, xy, yx, yy, hoop */
  double *D[9];  /* 1/s, derivatives of the velocity for the laws, as L without the hoop; NULL where
                    no law needs a mean: G2P then passes them on directly */
  double *rough; /* scratch of the filter of mean stresses (filter.c): the plastic strain before the
                    law, then the part of the mean stress (Pa) that the nodes do not represent; NULL
                    without filter */
  double *s[6];  /* Pa: xx, yy, zz, xy, zx, yz; 2D: the first four */
  double *u, *g[3]; /* Pa, Pa/m: pressure of pore water, which adds to the forces of s, and its
                       gradient; NULL without water */
  double *n, *k;    /* porosity; permeability, m/s: NULL without water that flows */
  double K_w;       /* Pa, bulk modulus of the water; 0 without water */
  double *V, *m;    /* m3, kg */
  double *J;        /* V/V0 where some law reads it, else NULL */
  double *F[9];     /* deformation gradient, as L; NULL where no law needs it */
  double
      *f[3]; /* N, forces by body accelerations and loads in the step; NULL where there are none */
  int64_t *law; /* number of each particle's law; NULL: one law */
  mpsi_laws laws;
  mps_particles *set; /* the caller's set, in whose fields these columns lie */
  int32_t *stencil;   /* lowest node of the particle's stencil, in its block's tile, in the present
                         step; NULL where volumetric.c and filter.c do not need it */
} mpsi_columns;

#endif
