/* element.h - the parts of mps-element: options (options.c), the law (law.c), the path of stress
 * and strain (path.c), results (results.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_ELEMENT_H
#define EXAMPLES_ELEMENT_H

#include "common/options.h"
#include "common/output.h"

#include <mps/soil.h>

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
  LAWS
};
#define ELEMENT_LAWS                                                                               \
  "elastic|neohookean|vonmises|tresca|druckerprager|mohrcoulomb|newtonian|mcc|smallstrain"
enum { ISO, OEDOMETER, CU, CD, PS_UNDRAINED, EXTENSION, SHEAR, CYCLIC, FROM_FILE };
#define ELEMENT_PATHS "iso|oedometer|cu|cd|ps-undrained|extension|shear|cyclic"

typedef struct settings {
  int law, path;
  const char *path_file; /* NULL: `path` */
  double strain, rate;   /* 1, 1/s */
  int64_t steps, cycles, threads;
  double p0, k0;                      /* Pa, 1: the first stress */
  double young, poisson, nu;          /* nu: another name of poisson; NaN: not given */
  double cohesion, phi, psi, tension; /* Pa, degrees, degrees, Pa */
  int cone;
  double yield, hardening;                          /* Pa; NaN: sqrt(3) cohesion */
  double residual, residual_phi, residual_cohesion; /* 1, degrees, Pa */
  double slip, band, rate_factor, rate_reference;   /* m, m, 1, 1/s */
  bool linear;                                      /* softening */
  double bulk, viscosity;                           /* Pa, Pa s */
  double M, lambda, kappa, e0, ocr, shear_modulus;  /* e0: NaN, there is none */
  bool lode;
  double reference_strain, curvature, strength; /* small strain: 1, 1, Pa */
  const char *out;
} settings;

/* A part of the path: strains (logarithmic, tensor components of a velocity gradient that stays the
 * same) or, of the controlled components, changes of stress, in equal steps. */
typedef struct stage {
  double strain[9];
  uint32_t controlled; /* MPS_MATERIAL_POINT_... */
  double stress[6];    /* Pa, change */
  int64_t steps;
} stage;

enum { STAGES = 1000 };

/* A row of path.csv. */
typedef struct row {
  double strain, stress[6], p, q, u, void_ratio, pc, e[4], volume_ratio, plastic;
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
  int pc_at, void_at, plastic_at; /* columns of history; -1: the law has none */
} element;

enum { ELEMENT_OPTIONS = 64 }; /* rows of the table at most, with the empty one */
settings element_defaults(void);
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
/* Shear modulus and damping ratio of the last loop of a cyclic path; false: there is none. */
bool element_loop(const element *x, double *modulus, double *damping);
/* q at which the path ends under shear, by theory; NaN: none. */
double element_limit(const element *x);

#endif
