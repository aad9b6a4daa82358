/* solver_scenes.h - one small scene of each solver, in motion, as an mps_solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_SOLVER_SCENES_H
#define MPS_TEST_SOLVER_SCENES_H

#include "elastic_common.h"
#include "fluid_tank.h"
#include "mpm_scene.h"

/* A solver of some kind on a set in motion; `young` of the solids, Pa. */
typedef struct scene {
  mps_particles *set;
  mps_material *material;
  mps_solver *solver;
} scene;

static void move(mps_particles *set, double speed) {
  OK(mps_particles_add_field(set, "velocity", 0));
  EDIT(edit, set, "velocity")
    for (int64_t i = 0; i < mps_particles_count(set); i++)
      for (int32_t k = 0; k < 2; k++)
        *mps_edit_f64(&edit, i, k) = speed * sin(1.0 + (double)(3 * i + k));
}

static scene make_mpm(mps_context *c) {
  mpm_scene s = mpm_scene_begin(c, 0.01, 0.0, 0.0, 1e6);
  DEF(mpm, def, .cell = 0.02, .lower[0] = def.lower[1] = 0.0);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.06);
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  move(s.particles, 0.1);
  OK(mps_mpm_create(c, s.particles, s.material, &def, &s.mpm));
  return (scene){s.particles, s.material, mps_mpm_solver(s.mpm)};
}

static scene make_dynamics(mps_context *c) {
  mpm_scene s = mpm_scene_begin(c, 1.0, 0.0, 0.0, 1e6);
  mps_dynamics *dynamics = NULL;
  mpm_scene_box(&s, 0.0, 0.0, 8.0, 5.0);
  OK(mps_particles_set(s.particles, "density", 0, 1800.0));
  move(s.particles, 0.01);
  USING(dynamics, mps_dynamics_create(c, s.particles, &given, &dynamics), .material = s.material);
  return (scene){s.particles, s.material, mps_dynamics_solver(dynamics)};
}

static scene make_elastic(mps_context *c) {
  test_body b = test_body_begin(c, 2, 0.1);
  test_body_box(&b, 0.0, 0.0, 0.0, 0.8, 0.4, 0.0);
  OK(mps_particles_set(b.particles, "density", 0, 1000.0));
  move(b.particles, 0.01);
  test_body_finish(&b, 1e7, 0.3, NULL);
  int64_t count = 0;
  int64_t *foot = test_select(&b, 0, 0.0, 0.1, &count);
  for (int k = 0; k < 2; k++) OK(test_prescribe(b.elastic, k, count, foot, NULL));
  free(foot);
  USING(elastic_motion, mps_elastic_start(b.elastic, &given), .dt = 1e-3);
  return (scene){b.particles, NULL, mps_elastic_solver(b.elastic)};
}

static void tilt(void *user, double *x, double *u) { x[1] *= 1.0 + 0.1 * cos(TANK_PI * x[0]); }

static scene make_fluid(mps_context *c) {
  tank t = tank_of(c, 1.0, 0.5, 0.1, NAN, NULL, tilt, NULL);
  return (scene){t.water, NULL, mps_fluid_solver(t.fluid)};
}

static const struct {
  const char *name;
  scene (*make)(mps_context *);
} kinds[] = {{"mpm", make_mpm},
             {"dynamics", make_dynamics},
#ifdef TEST_IMPLICIT
             {"elastic", make_elastic},
#endif
             {"fluid", make_fluid}};
#define KINDS ((int)(sizeof kinds / sizeof *kinds))

static void drop(scene *s) {
  mps_solver_destroy(&s->solver);
  assert_null(s->solver);
  mps_particles_destroy(&s->set);
  mps_material_destroy(&s->material);
}

#endif
