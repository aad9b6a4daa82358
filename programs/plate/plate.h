/* plate.h - the two plates of mps-plate: a square in tension (Chikazawa, Figures 2 and 3), and a
 * quarter of a plate with a hole under tension in x (Kirsch).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "elastic/elastic.h"

typedef struct plate_def {
  bool hole;
  double spacing, across; /* m; particles along a side, or spacings along the radius of the hole */
  double side;            /* m; with a hole: of the quarter */
  double radius;          /* m, of the hole */
  double young, poisson;
  double tension; /* Pa */
  bool plane_strain;
} plate_def;

typedef struct plate {
  app *a;
  const plate_def *def;
  mps_particles *particles;
  mps_elastic *elastic;
  double spacing;
  double wall; /* m: the tension plate's x at which it is held */
  mps_elastic_report report;
  /* results; errors relative */
  double end, end_exact;     /* m: displacement of the pulled end, at its middle */
  double displacement_error; /* largest, over the largest exact displacement */
  double stress_error;       /* L2 */
  double concentration;      /* of the hole: at its edge, from the ligament */
  double largest;            /* largest principal stress of a particle, over the tension */
} plate;

bool plate_solve(app *a, const plate_def *def, const elastic_method *method, plate *out);
void plate_free(plate *p);

/* Results at the particle of index k in the views. */
bool plate_get(const plate *p, int64_t k, elastic_point *out);
/* Exact stress xx, yy, xy at x; displacement of the plate in tension. */
void plate_exact_stress(const plate_def *def, const double *x, double *stress);
void plate_exact_displacement(const plate *p, const double *x, double *u);
/* Is the particle one of the ligament: of those above the hole on x = 0? */
bool plate_on_ligament(const plate *p, const elastic_point *at);

/* Tables, summary and pictures in DIR. */
bool plate_write(const plate *p, const elastic_method *method, const char *directory);
/* The summary that is written where Ctrl-C ends the program at once (app_leave_at_once). */
bool plate_reserve(const plate *p, const elastic_method *method, const char *directory);
