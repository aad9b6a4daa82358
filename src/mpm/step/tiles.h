/* tiles.h - scatter of a step, and its tiles between ranks (tiles.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/parts.h"
#include <mps/mpm.h>

#include <stdbool.h>

/* Whether the step needs the same memory and messages as the last one, so that no preparation can
 * fail: then the ranks need no reduction. Not collective: all ranks find the same. */
bool mpsi_mpm_partition_unchanged(const mpsi_boundaries *boundaries, const mpsi_contacts *contacts,
                                  mpsi_partition *partition, const mpsi_settling *settling,
                                  const mpsi_run *run);
/* Worst status of all ranks, after all preparations of a step that can fail. Collective. */
mps_status mpsi_mpm_agree_before_step(mps_mpm *mpm, const char *function, mps_status status);
/* Sums the border blocks into tiles and sends these. Collective. */
mps_status mpsi_mpm_send_tiles(mps_mpm *mpm, const char *function);
/* Scatter task of a pass: P2G of a block of cells, with penalty contact; on several ranks by the
 * tile that has been sent, whichever rank has summed it. */
void mpsi_step_scatter(void *solver, int64_t b, int32_t worker);
