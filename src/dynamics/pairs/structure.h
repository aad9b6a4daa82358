/* structure.h - order, pairs, mesh and arrays of the set's particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "domain/halo.h"
#include "dynamics/boundary/boundary.h"
#include "dynamics/pairs/layout.h"
#include "dynamics/pairs/mesh.h"

#include <mps/dynamics.h>

#include <stdbool.h>

/* Structure of the set's particles: the solver's present one lies in its own members. */
#define MPSI_DYN_SLAB_COLUMNS 15

typedef struct mpsi_dynamics_structure {
  int64_t count, body, pairs;
  bool lattice;
  mpsi_dynamics_mesh mesh;
  double *slab, *scratch, *part;
  int64_t stride, slots; /* of the slab: from column to column, pair slots */
  int32_t *bad;
  mpsi_dynamics_dashpot *column_dashpot;
  int64_t column_dashpots;
  int64_t ghosts;  /* particles of other ranks, behind the own ones */
  mpsi_halo *halo; /* exchange of their values; NULL: one rank */
} mpsi_dynamics_structure;

/* Adds the fields that the solver writes. */
mps_status mpsi_dynamics_add_fields(mps_dynamics *dynamics, const char *function);
/* Sorts the set. */
mps_status mpsi_dynamics_sort(mps_dynamics *dynamics, const char *function);
/* Makes the structure of sorted particles, of the set or of `geometry`. On an error nothing else
 * has changed. */
mps_status mpsi_dynamics_make_structure(mps_dynamics *dynamics, const char *function,
                                        const mpsi_dynamics_geometry *geometry,
                                        mpsi_dynamics_structure *out);
/* Sorted particles of the solver's body at these reference positions. */
mpsi_dynamics_geometry mpsi_dynamics_geometry_of(const mps_dynamics *dynamics, int64_t count,
                                                 const double *x, const double *y,
                                                 const int64_t *side);
/* Identifies the pairs of a body: a hash of the reference positions, 32 bits. */
int64_t mpsi_dynamics_hash_positions(int64_t count, const double *x, const double *y);
void mpsi_dynamics_free_structure(mps_dynamics *dynamics, mpsi_dynamics_structure *structure);
/* Puts it in place of the solver's own, which is released; finds columns and coefficients. */
void mpsi_dynamics_use_structure(mps_dynamics *dynamics, mpsi_dynamics_structure *structure);
/* Finds the columns of the fields in the set. */
void mpsi_dynamics_bind(mps_dynamics *dynamics);
mps_status mpsi_dynamics_add_reference(mps_dynamics *dynamics, const char *function);
mpsi_dynamics_geometry mpsi_dynamics_present_geometry(const mps_dynamics *dynamics);
mps_status mpsi_dynamics_allocate(mps_dynamics *dynamics, const char *function,
                                  mpsi_dynamics_structure *out);
