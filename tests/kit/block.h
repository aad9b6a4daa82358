/* block.h - a block of rubber that every solver takes, and the four solvers on blocks of it.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_KIT_BLOCK_H
#define MPS_TEST_KIT_BLOCK_H

#include "test_fixture.h"

/* 0.8 m by 0.4 m: 32 particles, whose lowest row is particles 0 to 7. */
static inline mps_particles *block(void) {
  mps_particles *set = box_of(context, 0.1, AT(0.0, 0.0), AT(0.8, 0.4));
  OK(mps_particles_set(set, "density", 0, 1000.0));
  return set;
}

static inline mps_material *rubber(void) {
  MAKE_KEPT(material, material, create_linear_elastic, context, 1e6, 0.25);
  return material;
}

#ifdef FOUR_SOLVERS
static mps_mpm *mpm;
static mps_dynamics *dynamics;
static mps_elastic *elastic;
static mps_fluid *fluid;

static void begin(void) {
  mps_particles *set[4] = {block(), block(), block(), block()};
  scoped_material *material = rubber();
  DEF(mpm, mpm_def, .cell = 0.2, .lower[1] = 0.0);
  DEF(dynamics, dynamics_def, .material = material);
  DEF(elastic, elastic_def, .material = material);
  OK(mps_mpm_create(context, set[0], material, &mpm_def, &mpm));
  OK(mps_dynamics_create(context, set[1], &dynamics_def, &dynamics));
  OK(mps_elastic_create(context, set[2], &elastic_def, &elastic));
  OK(mps_fluid_create(context, set[3], NULL, &fluid));
  for (int k = 0; k < 4; k++) mps_particles_destroy(&set[k]);
}

static void end(void) {
  mps_mpm_destroy(&mpm);
  mps_dynamics_destroy(&dynamics);
  mps_elastic_destroy(&elastic);
  mps_fluid_destroy(&fluid);
}
#endif

#endif
