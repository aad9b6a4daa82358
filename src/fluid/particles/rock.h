/* rock.h - permeable regions: see rock.c. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_FLUID_ROCK_H
#define MPSI_FLUID_ROCK_H

#include "fluid/base/loops.h"
#include "fluid/base/flow_solver.h"

#include <mps/fluid_rock.h>

typedef struct mpsi_fluid_rock {
  bool used;
  int64_t count; /* of corners */
  double *xy;
  double low[2], high[2]; /* m, a box that has them all */
  mps_fluid_rock_def def;
  double a, b, mass;        /* 1/s, 1/m, 1 + Cm */
  mpsi_fluid_weight weight; /* sums over the lattice of its spacing, l0/e^.5 */
} mpsi_fluid_rock;

struct mpsi_fluid_rocks {
  int32_t room;
  mpsi_fluid_rock *rock;
  mpsi_room part_room, flow_room; /* mpsi_fluid_pore of each particle; float of each pair */
  mpsi_room free_room;            /* bool of each chunk: its particles have no rock within re */
};

/* Of a particle in the step being made. */
typedef struct mpsi_fluid_pore {
  double porosity, ease; /* e; e/(lambda (1 + Cm)), lambda - 1 the resistance in a step */
  double fill;           /* sum w of the neighbours, as if all had its own spacing */
  const mpsi_fluid_weight *weight;
  double spacing; /* m */
} mpsi_fluid_pore;

/* Pores of particle i; NULL: there is no rock in the fluid. */
static inline mpsi_fluid_pore *mpsi_fluid_pore_of(const mps_fluid *f, int64_t i) {
  return f->rocks ? (mpsi_fluid_pore *)f->rocks->part_room.item + i : NULL;
}
/* Sums n0 of particle i's spacing, and n of its neighbours at that spacing. */
static inline double mpsi_fluid_full(const mps_fluid *f, int64_t i) {
  return f->rocks ? mpsi_fluid_pore_of(f, i)->weight->n0 : f->weight.n0;
}
static inline double mpsi_fluid_fill(const mps_fluid *f, int64_t i) {
  return f->rocks ? mpsi_fluid_pore_of(f, i)->fill : f->local[i].n;
}
/* Whether particles of a chunk have rock within re. */
static inline bool mpsi_fluid_near_rock(const mps_fluid *f, int64_t chunk) {
  return f->rocks && !((const bool *)f->rocks->free_room.item)[chunk];
}
/* Finds the pores of all particles, and resists their velocities over the step. */
mps_status mpsi_fluid_find_pores(mps_fluid *fluid, const char *function, double dt);
/* Sums of particle i's neighbours as if these had its own spacing. */
void mpsi_fluid_sum_pores(const mps_fluid *fluid, int64_t i, mpsi_fluid_sums *sums);
/* The weights of pairs are those of the flow between their pores, for the pressure equation (true),
 * or w. */
mps_status mpsi_fluid_weigh_flow(mps_fluid *fluid, const char *function);
void mpsi_fluid_use_flow(mps_fluid *fluid, bool flow);
void mpsi_fluid_drop_rocks(mps_fluid *fluid);
/* Least porosity of all regions, 1 without any. */
double mpsi_fluid_least_porosity(const mps_fluid *fluid);
void mpsi_fluid_list_rocks(mpsi_state *state, const mps_fluid *fluid);

#endif
