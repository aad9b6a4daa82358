/* partition.h - the ranks of a domain (mps/experimental/domain.h) that compute a fluid together.
 * Each has all of it: the set, walls, bodies, images. Quantities by rows (neighbours, sums over
 * them, rows of the matrix, its factor and iterations, velocities) each rank computes for its own
 * particles, whole blocks of the preconditioner (pcg.c), and sends to the others:
 *
 *   of particles near those of other ranks  x, z (at each iteration), m, velocities
 *   of all particles                        state, q, positions, velocities, pressures
 *
 * and the sums of chunks and blocks, which every rank then adds in the same order: the bits of one.
 * Loops of a step return no status. An error of the transport is kept, and returned by
 * mpsi_fluid_lost.
 *
 * Without a domain of several ranks these functions do nothing, and all particles are own ones.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

#include "domain/domain_internal.h"

/* Of the definition's domain; collective. */
mps_status mpsi_fluid_partition_create(mps_fluid *fluid, const char *function);
void mpsi_fluid_partition_destroy(mps_fluid *fluid);

/* Status of all ranks, as mpsi_domain_agree. Collective, as what follows. */
mps_status mpsi_fluid_agree(mps_fluid *fluid, const char *function, mps_status status);
mps_status mpsi_fluid_agree_max(mps_fluid *fluid, const char *function, mps_status status,
                                int32_t count, double *values);
/* Checks that motions of walls and bodies, loads, and edited particles are the same on all ranks.
 * `status` is this rank's so far. */
mps_status mpsi_fluid_agree_same(mps_fluid *fluid, const char *function, mps_status status);
mps_status mpsi_fluid_lost(mps_fluid *fluid, const char *function);

/* Blocks of the preconditioner (pcg.c), whole chunks of particles (mpsi_fluid_units), by the number
 * of particles alone. Not collective. */
typedef struct mpsi_fluid_blocks {
  int64_t count, size;
} mpsi_fluid_blocks;
mpsi_fluid_blocks mpsi_fluid_cut(const mps_fluid *fluid);
/* Deals the particles to the ranks, in these blocks: fluid->own. Not collective. */
void mpsi_fluid_deal(mps_fluid *fluid);
/* After the neighbour search: lists the particles of other ranks that are neighbours of own ones.
 */
mps_status mpsi_fluid_find_halo(mps_fluid *fluid, const char *function);

/* Halo exchange of per-particle columns: from their owners to the ranks that have them as
 * neighbours. */
#define MPSI_FLUID_SHARED 7 /* columns at most */
void mpsi_fluid_send_halo(mps_fluid *fluid, int32_t columns, double *const *column);
/* The same, to all ranks. */
void mpsi_fluid_send_all(mps_fluid *fluid, int32_t columns, double *const *column);
/* system.sums of units of so many particles, two of each, to all. */
void mpsi_fluid_send_sums(mps_fluid *fluid, int64_t unit);
/* The greatest of each value over the ranks, and 0 where the transport has failed. */
void mpsi_fluid_reduce_max(mps_fluid *fluid, int64_t count, double *values);
/* Sums over all ranks; invalid where the transport has failed. */
void mpsi_fluid_reduce_exact(mps_fluid *fluid, int32_t count, mpsi_exact *sums);
/* States, numbers of neighbours and moments m, and marks of the surface zone (moments.c). */
void mpsi_fluid_send_moments(mps_fluid *fluid);
/* fluid->flux of the neighbours that other ranks own. */
void mpsi_fluid_send_flux(mps_fluid *fluid);
/* fluid->local of all particles, as far as levels and loads use it. */
void mpsi_fluid_send_local(mps_fluid *fluid);
