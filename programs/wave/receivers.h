/* receivers.h - records the motion of chosen particles, and the energy, during a run.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_WAVE_RECEIVERS_H
#define EXAMPLES_WAVE_RECEIVERS_H

#include "common/column.h"
#include "common/output.h"

/* One recorded component of the acceleration of one particle. */
typedef struct receiver {
  int64_t id;
  int32_t component; /* 0 x, 1 y */
  double depth;      /* of the particle below the surface at its x, m */
  char label[48];    /* column of the CSV file */
} receiver;

typedef struct receivers {
  mps_particles *particles; /* borrowed */
  int64_t column;           /* the first ones: the middle column from the surface down */
  int64_t count;            /* then the surface at the edge, and of a slope its crest and toe */
  receiver *list;
  bool energy;        /* record the total energy too */
  double energy_from; /* s: after this time */
  double energy_least, energy_most, energy_sum;
  bool watch;          /* stop where the energy grows beyond what has been put in: `grown` */
  double speed;        /* m/s, of the input, the largest */
  double given, grown; /* J: most that was put in so far; energy above it, 0: not so */
  int64_t energies;
  int64_t rows, capacity;
  double *row; /* rows x (1 + count): time (s), accelerations (m/s2) */
  double *now; /* a row under way: each rank has the accelerations of its own particles */
} receivers;

/* Chooses `n` receivers along the middle column and those beside it. */
bool receivers_create(app *a, const column *c, char wave, int64_t n, receivers *out);
void receivers_destroy(receivers *r);
/* In a callback of mps_dynamics_run; `domain` NULL: one process. On all ranks the same rows. */
mps_status receivers_record(receivers *r, mps_dynamics *dynamics, mps_domain *domain);
double receivers_time(const receivers *r, int64_t row);
double receivers_value(const receivers *r, int64_t row, int64_t k);
/* Largest |acceleration| (m/s2) of receiver k. */
double receivers_peak(const receivers *r, int64_t k);
/* (max - min) / mean of the total energy; NaN when it was not recorded. */
double receivers_energy_drift(const receivers *r);

/* receivers.csv: time, the middle column, the edge; slope.csv: time, crest and toe, if any. */
bool receivers_write(app *a, const receivers *r, const char *directory);

#endif
