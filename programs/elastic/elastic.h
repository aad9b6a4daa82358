/* elastic.h - common parts of the programs of implicit elasticity: the options of the method, and
 * the results at a particle.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/app.h"
#include "common/options.h"

#include <mps/elastic.h>
#include <mps/experimental/papers.h>

typedef struct elastic_settings {
  double young, poisson;      /* Pa, - */
  double radius_ratio, alpha; /* radius_ratio NaN: the method's own */
  int method, divisor, state; /* as options */
  bool paper;
} elastic_settings;

/* With --paper the published method, unless another is given. Returns -1, or an exit code. */
int elastic_prefer(const options_program *program, const elastic_settings *s,
                   const option_preset *paper);
/* The method of solution: the library's, or the one that the paper prints. */
typedef struct elastic_method {
  mps_elastic_def def;
  bool published, constant;
} elastic_method;
elastic_method elastic_settings_method(const elastic_settings *s);
/* The functions below are false after an error line. */
bool elastic_make(app *a, mps_particles *particles, const elastic_method *method,
                  mps_elastic **out);
/* Rough time of a solution by CHOLMOD, in seconds of one processor, for the progress bar. */
double elastic_seconds(double particles);
/* Draws the bar by the clock from `done` of the whole on, a part `share`, for a computation of
 * `seconds` of one processor; 0: ended. */
void elastic_bar(app *a, double done, double share, double seconds);
/* Warns of displacements that are not small. Those of --paper, where E is 1 Pa, are numbers and no
 * lengths, unless `of`, the option of the load, or E is given. */
void elastic_warn(app *a, const option *table, const char *of, double displacement, double length);
/* Ends a line with the solver used. */
void elastic_tell(const app *a, const mps_elastic_report *report);
/* Prescribes component `component` of `count` particles: values[i], m, or 0 (values NULL). */
bool elastic_hold(app *a, mps_elastic *elastic, int32_t component, int64_t count,
                  const int64_t *ids, const double *values);
/* Tractions by a function on `count` facets. */
bool elastic_pull(app *a, mps_elastic *elastic, int64_t count, const int64_t *facets,
                  mps_elastic_traction_fn traction, void *user);
const char *elastic_method_name(const elastic_settings *s);

/* Rows of an option table. */
#define ELASTIC_MATERIAL(s, young_, poisson_)                                                      \
  OPTION_NUMBER_IN("young", OPTION_FROM_TO(1e-6, 1e16), &(s)->young, NULL, young_),                \
      OPTION_NUMBER_IN("poisson", OPTION_FROM_TO(0.0, 0.49999), &(s)->poisson, NULL, poisson_),    \
      OPTION_CHOICE("state", &(s)->state, NULL)
#define ELASTIC_METHOD(s)                                                                          \
  OPTION_HEADING("Method"), OPTION_FLAG("paper", &(s)->paper, NULL),                               \
      OPTION_CHOICE_OF("method", "conservative|published", &(s)->method, "discretisation"),        \
      OPTION_NUMBER("influence", &(s)->radius_ratio, NULL, NAN),                                   \
      OPTION_NUMBER("stabilisation", &(s)->alpha, NULL, 1.0),                                      \
      OPTION_CHOICE_OF("n", "local|constant", &(s)->divisor, NULL)

/* Results at a particle: position, displacement, stress xx, yy, xy, von Mises stress. */
typedef struct elastic_point {
  double x[2], u[2], stress[3], mises;
} elastic_point;
/* Of the particle at `index` of the views. False after an error line. */
bool elastic_point_get(app *a, mps_particles *particles, int64_t index, elastic_point *out);
