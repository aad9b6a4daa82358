/* checkpoint.h - the state of a solver (core/state.h) in a checkpoint file, for the solvers'
 * mps_S_save and mps_S_restore. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/state/row_source.h"
#include "core/state/state.h"

#include <mps/io.h>

/* Of a set alone: mps_checkpoint_read is its inverse. */
mps_status mpsi_checkpoint_write(mps_particles *particles, const char *path,
                                 const mps_checkpoint *info);
/* Writes the fields of the solver's set and its state. Of `info` (NULL: the defaults) only user_key
 * and the user_data are read: time, step and dt are those of `of`. */
mps_status mpsi_checkpoint_save(const mpsi_state_of *of, const char *function, const char *path,
                                const mps_checkpoint *info);
/* The same with the particles and values of all ranks: the rows of `source` in the place of the
 * solver's set. `request` is an mpsi_checkpoint_request. */
typedef struct mpsi_checkpoint_request {
  const mpsi_state_of *of;
  const char *function, *path;
  const mps_checkpoint *info;
  const mpsi_values *state;
} mpsi_checkpoint_request;
mps_status mpsi_checkpoint_save_rows(void *request, mpsi_row_source *source);
/* Restores a solver that was built in the same way, and its set, to that state and order. `info`
 * (may be NULL) is as for mps_checkpoint_info. On an error nothing has changed. */
mps_status mpsi_checkpoint_restore(const mpsi_state_of *of, const char *function, const char *path,
                                   mps_checkpoint *info);
