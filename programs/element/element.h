/* element.h - the parts of mps-element: options (options.c), the law (law.c), the path of stress
 * and strain (path.c), cyclic paths and their results (cycles.c), results (results.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/options.h"
#include "common/output.h"

#include <mps/soil.h>
#include <mps/experimental/material_point.h>

enum {
  ELASTIC,
  NEO_HOOKEAN,
  VON_MISES,
  TRESCA,
  DRUCKER_PRAGER,
  MOHR_COULOMB,
  NEWTONIAN,
  CAM_CLAY,
  SMALL_STRAIN,
  CYCLIC_SAND,
  LAWS
};
#define ELEMENT_LAWS                                                                               \
  "elastic|neohookean|vonmises|tresca|druckerprager|mohrcoulomb|newtonian|mcc|smallstrain|"        \
  "cyclicsand"
enum { ISO, OEDOMETER, CU, CD, PS_UNDRAINED, EXTENSION, SHEAR, CYCLIC, CYCLIC_TRIAXIAL, FROM_FILE };
#define ELEMENT_PATHS "iso|oedometer|cu|cd|ps-undrained|extension|shear|cyclic|cyclic-triaxial"

typedef struct settings {
  int law, path;
  const char *path_file; /* NULL: `path` */
  double strain, rate;   /* 1, 1/s */
  int64_t steps, cycles, threads;
  double p0, k0; /* Pa, 1: the first stress */
  double young, poisson;
  double cohesion, phi, psi, tension; /* Pa, degrees, degrees, Pa */
  int cone;
  double yield, hardening;                          /* Pa; NaN: sqrt(3) cohesion */
  double residual, residual_phi, residual_cohesion; /* 1, degrees, Pa */
  double slip, band, rate_factor, rate_reference;   /* m, m, 1, 1/s */
  bool linear;                                      /* softening */
  double bulk, viscosity;                           /* Pa, Pa s */
  double M, lambda, kappa, e0, ocr, shear_modulus;  /* e0: NaN, there is none */
  double e_max;                                     /* end of dilation; NaN: none */
  bool lode;
  double reference_strain, curvature, strength; /* small strain: 1, 1, Pa */
  double csr;                                   /* cyclic stress ratio; NaN: by strain */
  bool drained;                                 /* cyclic: stresses across are held */
  double relative_density, blow_count, c[4];    /* cyclic sand; NaN: not given */
  double threshold, strain_limit;               /* amplitudes, 1 */
  const char *out;
} settings;

/* A part of the path: strains (logarithmic, tensor components of a velocity gradient that stays the
 * same) or, of the controlled components, changes of stress, in equal steps. */
typedef struct stage {
  double strain[9];
  uint32_t controlled; /* MPS_MATERIAL_POINT_... */
  double stress[6];    /* Pa, change */
  double deviator;     /* Pa, change of q at constant volume; 0: the above */
  int64_t steps;
} stage;

#define ELEMENT_LIQUEFIED 0.95 /* u over element_reference */
enum { STAGES = 1000 };

/* A row of path.csv. */
typedef struct row {
  double strain, stress[6], p, q, u, void_ratio, pc, e[4], volume_ratio, plastic;
  double contraction, cycles; /* NaN: the law, the path has none */
} row;

typedef struct element {
  app a;
  settings s;
  mps_material *material;
  mps_material_point point;
  stage *stages;
  int stage_count;
  int64_t rows, room;
  row *table;
  double e[4]; /* logarithmic strain xx, yy, zz, and engineering shear xy, so far */
  int pc_at, void_at, plastic_at, contraction_at; /* columns of history; -1: the law has none */
  bool stopped; /* stresses of a cyclic path are beyond the strength: it has ended before its end */
} element;

enum { ELEMENT_OPTIONS = 80 }; /* rows of the table at most, with the empty one */
/* Writes the table, whose values are those of `s`. */
void element_options(settings *s, option *table);

/* Reasons why settings are not consistent; NULL: good. Fills in defaults that depend on the law. */
const char *element_settle(settings *s, const option *table);
bool element_make_law(element *x);
/* The first stress and history. */
bool element_start(element *x);

/* One stage of a path by name, or those of the file. */
bool element_make_path(element *x);
/* Drives the point; false where a step has failed, after the rows up to it. */
bool element_drive(element *x);

/* path.csv, summary.json, pictures. `done`: the path has come to its end. */
bool element_results(element *x, bool done);
/* cycles.c: whether the path is cyclic, and whether its stresses are given. */
bool element_is_cyclic(const settings *s);
bool element_has_ratio(const settings *s);
/* The stages of a cyclic path; returns how many. */
int element_cyclic_path(const settings *s, stage *g);
/* One step of an undrained triaxial test to q = sigma_xx - sigma_zz, at constant volume, in dt;
 * `found`: its velocity gradient. */
mps_status element_drive_deviator(element *x, double q, double dt, double found[9]);
/* The effective stress that pore pressures are compared with: vertical, or p of a triaxial test. */
double element_reference(const element *x);
/* Cycles after which u is 0.95 of that stress or the stresses of the path are beyond the strength;
 * NaN: never. */
double element_liquefied(const element *x);
/* cycles.csv, and the picture of u or volume strain over the cycles. */
bool element_write_cycles(element *x);
bool element_draw_cycles(element *x);
/* Shear modulus and damping ratio of the last loop of a cyclic path; false: there is none. */
bool element_loop(const element *x, double *modulus, double *damping);
/* q at which the path ends under shear, by theory; NaN: none. */
double element_limit(const element *x);
