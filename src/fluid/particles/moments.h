/* moments.h - sums over the neighbours: density, moments, velocity gradient, free surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

/* The weight (1-z)^4 (1+4z), z = r/re, and its sums over the full lattice. */
typedef struct mpsi_fluid_weight {
  double re, inverse; /* m, 1/m */
  double n0;          /* sum w over the lattice */
  double half;        /* ... over the rows at and below a particle of a level surface */
  double slope;       /* growth of sum w with a surface that rises by l0 */
  double square;      /* sum w r^2/4 over the lattice, m2 */
  double scale;       /* of w: 1, in rock (rock.h) the water's radius over re to the power 4 */
} mpsi_fluid_weight;

/* Moments of a particle's neighbourhood; tensors xx, xy, yx, yy, symmetric ones xx, xy, yy.
 * Inputs of the pressure equation are exact to round-off; single precision is enough for the rest.
 */
typedef struct mpsi_fluid_local {
  double n, m[2];    /* sum w, sum w dx */
  double inverse[3]; /* of M = sum w dx dx^T/r^2, at the surface of M + c e e^T, c = |m|/h */
  double divergence; /* of velocity, 1/s */
  double h, qs;      /* distance of the surface (m), 0 farther inside; reduced pressure there, Pa */
  float S;           /* sum w r^2/4 */
  float shear[3];    /* of the velocity's gradient xx, xy, yx, 1/s */
  float rest[2];     /* sum w (du - G dx)/n: deviation from a linear velocity field, m/s */
  float shift[2];    /* sum w dx/(r n0) */
} mpsi_fluid_local;

enum { MPSI_FLUID_INSIDE = 0, MPSI_FLUID_SURFACE = 1, MPSI_FLUID_APART = 2 };
/* Rise: height of the surface above particle i against gravity, m; 0: none. */
void mpsi_fluid_find_moments(mps_fluid *fluid);
void mpsi_fluid_count(mps_fluid *fluid); /* to the report: neighbours, particles at the surface */
double mpsi_fluid_rise(const mps_fluid *fluid, int64_t i);
/* 1 where particle i, between a body's face and a wall opposite, has no neighbours along the gap
 * but those beside it, 0 where it has, and in between. */
double mpsi_fluid_squeezed(const mps_fluid *fluid, int64_t i);
