/* pores.h - what rock is to particles and pairs: see pores.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/loops.h"
#include "fluid/particles/rock.h"

/* Of a particle in the step being made. */
typedef struct mpsi_fluid_pore {
  double porosity, ease, lambda; /* e; e/(lambda (1 + Cm)); lambda - 1: resistance in a step */
  double fill; /* sum w of the neighbours, as if all had its own spacing and radius */
  const mpsi_fluid_weight *weight;
  double spacing; /* m */
  bool mixed;     /* some neighbours are in another region, after the neighbour search */
} mpsi_fluid_pore;

/* Pores of particle i; NULL: there is no rock in the fluid. */
static inline mpsi_fluid_pore *mpsi_fluid_pore_of(const mps_fluid *f, int64_t i) {
  return f->rocks ? (mpsi_fluid_pore *)f->rocks->part_room.item + i : NULL;
}
/* Weight of particle i and particles in its region. */
static inline const mpsi_fluid_weight *mpsi_fluid_weight_of(const mps_fluid *f, int64_t i) {
  return f->rocks ? mpsi_fluid_pore_of(f, i)->weight : &f->weight;
}
static inline bool mpsi_fluid_is_mixed(const mps_fluid *f, int64_t i) {
  return f->rocks && mpsi_fluid_pore_of(f, i)->mixed;
}
/* Sums n0 of particle i's spacing, and n of its neighbours at that spacing. */
static inline double mpsi_fluid_full(const mps_fluid *f, int64_t i) {
  return mpsi_fluid_weight_of(f, i)->n0;
}
static inline double mpsi_fluid_fill(const mps_fluid *f, int64_t i) {
  return f->rocks ? mpsi_fluid_pore_of(f, i)->fill : f->local[i].n;
}
/* Whether particles of a chunk, or neighbours of theirs, are in rock. */
static inline bool mpsi_fluid_near_rock(const mps_fluid *f, int64_t chunk) {
  return f->rocks && !((const bool *)f->rocks->free_room.item)[chunk];
}
/* Radius (m) of weights of two particles: the mean of theirs. */
static inline double mpsi_fluid_pair_radius(const mps_fluid *f, int64_t i, int64_t j) {
  return 0.5 * (mpsi_fluid_weight_of(f, i)->re + mpsi_fluid_weight_of(f, j)->re);
}
/* Weight of particles i and j at the distance r, m; 0 beyond their radius. */
double mpsi_fluid_pair_w(const mps_fluid *fluid, int64_t i, int64_t j, double r);

/* Finds the pores of all particles, and resists their velocities over the step. */
mps_status mpsi_fluid_find_pores(mps_fluid *fluid, const char *function, double dt);
/* Before the neighbour search: regions of the cloud. */
mps_status mpsi_fluid_mark_regions(mps_fluid *fluid, const char *function);
/* Radius (m) that has all neighbours of particle i of a chunk, and may have more. */
double mpsi_fluid_search_radius(const mps_fluid *fluid, int64_t chunk, int64_t i);
/* Of a list of neighbours those within the pairs' radii; sets `mixed`. Returns their number. */
int64_t mpsi_fluid_keep_in_pores(mps_fluid *fluid, int64_t i, int64_t count, int32_t *index,
                                 double *r2);
/* Weights of the pairs of different regions. */
void mpsi_fluid_weigh_mixed(const mps_fluid *fluid, int64_t i, int64_t count, const int32_t *index,
                            const double *r2, float *w);
/* Sums of particle i's neighbours as if these had its own spacing and radius. */
void mpsi_fluid_sum_pores(const mps_fluid *fluid, int64_t i, mpsi_fluid_sums *sums);
/* Finds the weights of the flow between the pores of pairs, for the pressure equation. The pairs'
 * weights are then those (true), or w. */
mps_status mpsi_fluid_weigh_flow(mps_fluid *fluid, const char *function);
void mpsi_fluid_use_flow(mps_fluid *fluid, bool flow);
