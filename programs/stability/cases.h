/* cases.h - the critical time step of one soil column, by linear theory and by time stepping.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/app.h"

#include <mps/dynamics.h>

enum { METHOD_LINEAR = 0, METHOD_STEPPING = 1, METHOD_BOTH = 2 };

/* Common settings of all cases of a study. */
typedef struct method {
  int kind; /* METHOD_... */
  int rotation, torque;
  double f1, f2;              /* Hz */
  double criterion, accuracy; /* of the bisection: m/s2, ratio of the bounds */
  double duration;            /* s of each run; NaN: method_duration decides */
} method;

typedef struct stability_case {
  char wave; /* 'S' or 'P' */
  int integrator;
  double radius, velocity, damping; /* R m, V m/s (of the wave), h */
  double other; /* m/s: the other wave's velocity; 0: Vp = 2 Vs as in the paper */
  /* found; NaN: not requested or not defined */
  double linear;            /* s */
  double stepping;          /* s: the largest step that ran stably */
  double unstable;          /* s: the smallest that did not, at most accuracy times above */
  double table2;            /* s: the paper's printed regression, h up to 0.22 */
  int64_t particles, steps; /* of the column, of all its runs */
  mps_status status;
  char why[320]; /* of a failure */
} stability_case;

/* Long enough for the pulse to leave the base, to rise and to be reflected at the surface: an
 * unstable mode, which grows e-fold in few steps, has then been excited everywhere. The limit of
 * the Euler method, which fails by slow growth, depends on it. */
double method_duration(const method *m, double velocity);
/* The paper's particles: 10 m x 100 m, rounded to whole particles (R = 1.6 m: 3 x 31). */
int64_t case_particles(double radius);
double case_vs(const stability_case *x);
double case_vp(const stability_case *x);
/* Finds the quantities of `m`, on a serial context of its own: may run in parallel with others. */
void case_find(const method *m, stability_case *out);
/* The same with the threads and ranks of the program, which compute the case together. `hook` is
 * called for each run of the bisection. */
void case_find_together(app *a, const method *m, stability_case *out, mps_context_progress_fn hook,
                        void *user);
