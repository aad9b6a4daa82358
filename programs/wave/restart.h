/* restart.h - data of a checkpoint of mps-wave besides the solver: the options of the model, and
 * the results so far.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_WAVE_RESTART_H
#define EXAMPLES_WAVE_RESTART_H

#include "field.h"
#include "receivers.h"

typedef struct results_so_far {
  const settings *s;
  receivers *record;
  field *peaks;
  int64_t every; /* steps between rows */
} results_so_far;

/* Options and results as one block, to be freed by the caller; NULL: out of memory. */
void *restart_pack(const results_so_far *r, int64_t *size);
/* Restores the results. False with an error line that names the first option that differs. */
bool restart_unpack(app *a, results_so_far *r, const void *block, int64_t size);

#endif
