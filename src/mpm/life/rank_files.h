/* rank_files.h - checkpoints of a solver on several ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "io/checkpoint.h"
#include "mpm/base/mpm_solver.h"

/* Writes the file that one rank would write, from all ranks; keeps, of the values of a whole file,
 * those of this rank (mpsi_state_of). Collective. */
mps_status mpsi_mpm_save_on_ranks(mps_mpm *mpm, const mpsi_state_of *of, const char *function,
                                  const char *path, const mps_checkpoint *info);
mps_status mpsi_mpm_restore_on_ranks(void *solver, const char *function, mps_status status,
                                     mps_snapshot *values);
