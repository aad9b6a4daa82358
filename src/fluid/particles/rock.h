/* rock.h - permeable regions: see rock.c. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

#include <mps/experimental/fluid_rock.h>

typedef struct mpsi_fluid_rock {
  bool used;
  int64_t count; /* of corners */
  double *xy;
  double low[2], high[2]; /* m, a box that has them all */
  mps_fluid_rock_def def;
  double a, b, mass;        /* 1/s, 1/m, 1 + Cm */
  mpsi_fluid_weight weight; /* in it, with sums over the lattice of its spacing, l0/e^.5 */
} mpsi_fluid_rock;

struct mpsi_fluid_rocks {
  int32_t capacity;
  mpsi_fluid_rock *rock;
  double spacing; /* m, the largest of particles in all regions */
  /* of pores.c */
  mpsi_room part_room;   /* mpsi_fluid_pore of each particle */
  mpsi_room free_room;   /* bool of each chunk: its particles have no rock within f->reach */
  mpsi_room region_room; /* int32_t of the cloud: number of the region + 1, 0: water */
  mpsi_room start_room;  /* int64_t of each chunk: where its weights of flow are */
  mpsi_room flow_room;   /* float: those of pairs of chunks near rock, or their w */
  bool flowing;          /* the pairs' weights are those of flow, and flow_room has their w */
};

void mpsi_fluid_drop_rocks(mps_fluid *fluid);
/* Least porosity of all regions, 1 without any. */
double mpsi_fluid_least_porosity(const mps_fluid *fluid);
void mpsi_fluid_list_rocks(mpsi_state *state, const mps_fluid *fluid);
