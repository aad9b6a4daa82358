/* coarse.h - the coarse space of the pressure's conjugate gradients (pcg.c): functions that are
 * constant over aggregates, tiles of about 8 by 8 particles, columns of Z. Without it the number
 * of iterations grows as the number of particles along the fluid's side; with it iterations reduce
 * the error within aggregates only.
 *
 * Deflation (Nicolaides 1987): with E = Z^T A Z, the residual r stays at right angles to Z, and the
 * preconditioned one, v, becomes v - Z E^-1 (A Z)^T v. pcg.c has no product with A; it needs U^-T A
 * (v - Z e) = U^-T (A v - A Z e), so that A Z e joins what its solution with U^T begins from. A Z
 * has entries only near edges of aggregates and at the free surface, some 2 a row.
 *
 * An aggregate lies in one block of the preconditioner. A block sums the contributions of its rows
 * to its own aggregates and to others near by, its slots; the sums over blocks are then taken in
 * the order of the slots, on every rank, which all solve the coarse equation. So the bits are those
 * of any
 * number of threads and ranks. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/envelope.h"
#include "fluid/base/flow_solver.h"

/* Where an entry of A Z is in its block: the row from the block's first on, the column's slot. */
typedef struct mpsi_fluid_coarse_at {
  uint16_t row, slot;
} mpsi_fluid_coarse_at;

struct mpsi_fluid_coarse {
  bool used;             /* for the present matrix */
  int64_t block, blocks; /* particles in a block; number of blocks */
  double side;           /* m, of an aggregate, about */
  int64_t aggregates;    /* numbers from 1 on */
  int64_t *own;          /* first aggregate of each block, less 1; and of all */
  int64_t *slots;        /* first slot of each block, and of all */
  int64_t *count;        /* entries of each block */
  int64_t most, capacity; /* room for entries: by 16 rows, and by block */
  mpsi_room block_room, of_room, map_room, list_room, at_room, entry_room, slot_room, part_room,
      value_room;
  int32_t *of;              /* aggregate of each particle, 0: apart */
  int32_t *map, *list;      /* by block: slot + 1 of each aggregate; aggregate of each slot */
  mpsi_fluid_coarse_at *at; /* of the entries of A Z: stretches of the blocks */
  double *entry;
  int32_t *slot;        /* aggregates of all slots */
  double *part;         /* sums by slot */
  double *value;        /* by aggregate: coarse right side, then e; [0] is 0 */
  mpsi_envelope matrix; /* E */
};

/* Whether the present matrix is to have a coarse space. */
bool mpsi_fluid_has_coarse(const mps_fluid *fluid);
/* Builds aggregates, A Z and the factors of E for the present matrix; `block`: particles in a block
 * of the preconditioner, of `blocks`. Collective. */
mps_status mpsi_fluid_coarsen(mps_fluid *fluid, const char *function, int64_t block,
                              int64_t blocks);
/* (A Z)^T v of the rows of block b to its slots. */
void mpsi_fluid_coarse_restrict(mps_fluid *fluid, int64_t b, const double *v);
/* e = E^-1 of the sums of the slots. Collective. */
void mpsi_fluid_coarse_solve(mps_fluid *fluid);
/* r -= A Z e of the rows of block b. */
static inline void mpsi_fluid_coarse_subtract(const mpsi_fluid_coarse *c, int64_t b, double *r) {
  const mpsi_fluid_coarse_at *at = c->at + b * c->capacity;
  const double *entry = c->entry + b * c->capacity;
  const int32_t *slot = c->slot + c->slots[b];
  double *own = r + b * c->block;
  for (int64_t k = 0; k < c->count[b]; k++) own[at[k].row] -= entry[k] * c->value[slot[at[k].slot]];
}
/* v -= Z e of rows [first, end). */
static inline void mpsi_fluid_coarse_deflate(const mpsi_fluid_coarse *c, int64_t first, int64_t end,
                                             double *v) {
  for (int64_t i = first; i < end; i++) v[i] -= c->value[c->of[i]];
}
/* Changes x and the residual system.r = b - A x such that it is orthogonal to Z; returns its
 * square. Collective. */
double mpsi_fluid_coarse_start(mps_fluid *fluid);
bool mpsi_fluid_coarse_create(mps_fluid *fluid); /* false: no memory */
void mpsi_fluid_coarse_drop(mps_fluid *fluid);
int64_t mpsi_fluid_coarse_bytes(const mps_fluid *fluid);
