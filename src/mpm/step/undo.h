/* undo.h - restores the state before a step that fails half way, when some particles have moved:
 * a law of the caller refuses, a particle gets values that are not finite or not possible
 * (water/bounds.c), or all get more energy than there is (bound.c). Steps that continue a calm
 * motion without such laws, with water far inside its bounds or none, save nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/boundary/boundaries.h"

#include <stddef.h>

#define MPSI_UNDO_COLUMNS 64 /* besides histories */

typedef struct mpsi_undo {
  bool on; /* the state before this step is saved */
  double *
      *column; /* columns that the step writes; memory for MPSI_UNDO_COLUMNS and all histories */
  int32_t columns;
  mpsi_room list_room, room, dashpot_room;
  mpsi_room boundary_room; /* mpsi_boundary, of each number */
  mpsi_room sums_room;     /* mpsi_boundary_sums, of each boundary that has some */
  struct {
    void *kept; /* impulses in the step before: of contacts, of lists of particles */
    int64_t warm_count;
    double warm_dt;
  } impulses[2];
} mpsi_undo;

/* Before a step: memory, and copies of what belongs to no particle. MPS_ERROR_MEMORY. */
mps_status mpsi_mpm_prepare_undo(mps_mpm *mpm, const char *function);
/* Copies the particles of a block of cells, before G2P writes them. */
void mpsi_mpm_save_block(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_undo *u,
                         int64_t b);
/* Restores the state before the step. */
void mpsi_mpm_undo(const mpsi_grid *grid, const mpsi_columns *p, mpsi_boundaries *b,
                   mpsi_contacts *contacts, mpsi_prescribed *prescribed, const mpsi_undo *u);

/* ---- bound.c: what energy allows, and whether a step can end beyond all bounds ----------------
 */

typedef struct mpsi_bound {
  double allowed; /* J: energy counted when it was last renewed, and the works done since */
  double kinetic; /* J, after the last step */
  double
      fastest; /* m/s: no particle was faster after the last step; infinite where water is tight */
  double mass; /* kg, of all particles */
  double lightest; /* kg */
  double most;     /* J, bound of the step being made */
  bool lapsed;     /* the bound did not apply in the last step: its energies are of before */
  int64_t beyond;  /* the fastest particle of a step beyond that bound, or -1 */
} mpsi_bound;

/* Before a step, whose signals have been evaluated: whether it continues a smooth motion, so
 * that nothing is saved to undo it. The same on all ranks. */
bool mpsi_bound_is_calm(const mps_mpm *mpm);
/* Before a step: counts the energy anew where the caller has changed it. */
void mpsi_bound_begin(mps_mpm *mpm);
/* After a step's laws: whether its kinetic energy is beyond the bound. */
void mpsi_bound_check(mps_mpm *mpm);
/* Completes a step that is kept. */
void mpsi_bound_keep(mps_mpm *mpm);
/* After a step that is kept: a speed (m/s) that no particle of this rank exceeds; infinite where
 * its water is within a step of its bounds. */
double mpsi_bound_fastest(const mps_mpm *mpm);
/* Writes what is wrong with the particle `beyond`. */
void mpsi_bound_describe(const mps_mpm *mpm, char *out, size_t size);
/* Whether a law of the caller may refuse. */
bool mpsi_bound_by_law(const mpsi_columns *p);
