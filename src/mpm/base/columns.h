/* columns.h - the particles as structure of arrays, in sorted order, over the memory of the fields
 * of the particle set. Tensors by rows. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/particles/laws.h"

#include <mps/mpm.h>
#include <mps/particles.h>

#include <math.h>

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
  double *slow;  /* Pa, the pressure of which P2G has the forces: of implicit ones a mean over some
                    steps (water/flow.c), else u */
  double *n, *k; /* porosity; permeability, m/s: NULL without water that flows */
  double K_w;    /* Pa, bulk modulus of the water; 0 without water */
  double *V, *m; /* m3, kg */
  double *J;     /* V/V0 where some law reads it, else NULL */
  double *F[9];  /* deformation gradient, as L; NULL where no law needs it */
  double
      *f[3]; /* N, forces by body accelerations and loads in the step; NULL where there are none */
  int64_t *law; /* number of each particle's law; NULL: one law */
  mpsi_laws laws;
  mps_particles *set; /* the caller's set, in whose fields these columns lie */
  int32_t *stencil;   /* lowest node of the particle's stencil, in its block's tile, in the present
                         step (mpsi_stencil_node), and whether the particle lies on a border of the
                         cell that this stands for (mpsi_stencil_border); NULL where volumetric.c and
                         filter.c do not need it */
  double *t[3];       /* with `stencil`: position from that node, in cells */
} mpsi_columns;

enum { MPSI_STENCIL_BITS = 12 }; /* of the node; then two bits an axis */
static inline int mpsi_stencil_node(int32_t stencil) {
  return (int)(stencil & ((1 << MPSI_STENCIL_BITS) - 1));
}
/* Along axis c: -1 on the border to the cell below, 1 to the one above, 0 on none. */
static inline int mpsi_stencil_border(int32_t stencil, int c) {
  return (int)(stencil >> (MPSI_STENCIL_BITS + 2 * c) & 3) - 1;
}

/* Along any axis. */
static inline bool mpsi_stencil_on_border(int32_t stencil, int dim) {
  const int32_t none = 1 | 1 << 2 | (dim == 3 ? 1 << 4 : 0);
  return stencil >> MPSI_STENCIL_BITS != none;
}

/* flip_time where it is left open, in times in which a wave crosses a cell (mpsi_wave_time), which
 * do not depend on the step. Less damps slow flow (a stress of 0.05 rho c v over this
 * number), more keeps noise of the particles (docs/theory/transfers.md). */
#define MPSI_FLIP_CELLS 20.0

/* Whether particles keep a part of the velocity that the nodes do not represent. */
static inline bool mpsi_keeps_velocity(const mps_mpm_def *def, const mpsi_columns *p) {
  return isnan(def->flip_time) ? p->laws.some_flow : def->flip_time > 0.0;
}

/* The fraction of it that they keep in a step of dt; `cross`: mpsi_wave_time. */
static inline double mpsi_kept_fraction(const mps_mpm_def *def, const mpsi_columns *p, double dt,
                                        double cross) {
  if (!mpsi_keeps_velocity(def, p)) return 0.0;
  return exp(-dt / (isnan(def->flip_time) ? MPSI_FLIP_CELLS * cross : def->flip_time));
}

static inline const mpsi_law_use *mpsi_law_of(const mpsi_columns *p, int64_t particle) {
  return &p->laws.law[p->law ? p->law[particle] : 0];
}

/* Factor of the elastic moduli of a particle's law. */
static inline double mpsi_mpm_stiffness(const mpsi_columns *p, int64_t particle) {
  const double *factor = mpsi_law_of(p, particle)->stiffness;
  return factor && factor[particle] > 0.0 ? factor[particle] : 1.0;
}

/* K + 4G/3 and G (Pa) of a particle's material at zero strain. */
static inline void mpsi_mpm_elastic(const mpsi_columns *p, int64_t particle, double *wave,
                                    double *shear) {
  const mps_material *material = mpsi_law_of(p, particle)->material;
  const double factor = mpsi_mpm_stiffness(p, particle);
  *wave = factor * mpsi_material_rest_modulus(material);
  *shear = factor * mpsi_material_shear(material);
}

/* K + 4G/3 and G (Pa) of dashpots: waves go through the water of saturated ground too. Where it
 * flows as well: it hardly does within a wave of several cells, whose period is far below (a wave
 * length)^2/c_v. */
static inline void mpsi_mpm_saturated(const mpsi_columns *p, int64_t particle, double *wave,
                                      double *shear) {
  mpsi_mpm_elastic(p, particle, wave, shear);
  if (p->n) *wave += p->K_w / p->n[particle];
}

/* What the ground and the water in its pores bear across a surface, Pa; or sums over particles. */
typedef struct mpsi_borne {
  double ground, water;
} mpsi_borne;

/* Of particle k across the unit vector n. Only with water. */
static inline mpsi_borne mpsi_mpm_borne(const mpsi_columns *p, int dim, int64_t k,
                                        const double *n) {
  static const int component[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  mpsi_borne out = {0.0, p->u[k]};
  for (int i = 0; i < dim; i++)
    for (int j = 0; j < dim; j++) out.ground -= n[i] * n[j] * p->s[component[i][j]][k];
  return out;
}

/* The part of a normal force that is on the ground, by which friction is limited. Of what water
 * pulls the ground bears no more than the force. */
static inline double mpsi_ground_share(mpsi_borne by) {
  const double ground = fmax(by.ground, 0.0);
  return by.water > 0.0 ? ground / (ground + by.water) : 1.0;
}
