/* undo.h - restores the state before a step that a law of the caller refuses half way, when some
 * particles have moved. Where no law can refuse, nothing is saved.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_UNDO_H
#define MPSI_MPM_UNDO_H

#include "mpm/boundary/boundaries.h"

#define MPSI_UNDO_COLUMNS 64 /* besides histories */

typedef struct mpsi_undo {
  bool on; /* some law can refuse */
  double *
      *column; /* columns that the step writes; memory for MPSI_UNDO_COLUMNS and all histories */
  int32_t columns;
  mpsi_room list_room, room, dashpot_room;
  mpsi_room hold_room; /* mpsi_boundary, of each number */
  double holds_dt;
  mpsi_room sums_room; /* mpsi_boundary_sums, of each boundary that has some */
  void *kept_impulses; /* impulses of contacts in the step before */
  int64_t warm_count;
  double warm_dt;
} mpsi_undo;

/* Before a step: memory, and copies of what belongs to no particle. MPS_ERROR_MEMORY. */
mps_status mpsi_mpm_prepare_undo(mps_mpm *mpm, const char *function);
/* Copies the particles of a block of cells, before G2P writes them. */
void mpsi_mpm_save_block(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_undo *u,
                         int64_t b);
/* Restores the state before the step. */
void mpsi_mpm_undo(const mpsi_grid *grid, const mpsi_columns *p, mpsi_boundaries *b,
                   mpsi_contacts *contacts, const mpsi_undo *u);

#endif
