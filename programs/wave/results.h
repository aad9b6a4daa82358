/* results.h - results of a run of mps-wave, against theory: summary.json, the picture, last line.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_WAVE_RESULTS_H
#define EXAMPLES_WAVE_RESULTS_H

#include "common/compare.h"
#include "receivers.h"
#include "settings.h"

typedef enum outcome { OUTCOME_COMPLETE, OUTCOME_INTERRUPTED, OUTCOME_DIVERGED } outcome;

typedef struct results {
  outcome end;
  int64_t particles, steps;
  double dt, dt_limit;                    /* s; a limit of 0: there is no stable step */
  double surface_peak, surface_peak_edge; /* m/s2; NaN: diverged */
  double travel_time, travel_exact;       /* s; NaN: the wave has not arrived */
  comparison peak, travel;                /* of the surface, and of the time */
  double energy_drift;                    /* NaN: not defined */
} results;

/* Fills the peaks and times from the records; `signal` is the input. */
bool results_find(app *a, const settings *s, const column *c, const receivers *r,
                  const mps_signal *signal, results *out);
bool results_write(app *a, const settings *s, const results *x, const mps_signal *signal);
/* wave.png, as the paper's Figure 2. */
bool results_draw(app *a, const settings *s, const column *c, const receivers *r, const results *x);
void results_print(app *a, const settings *s, const results *x);

#endif
