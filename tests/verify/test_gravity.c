/* test_gravity.c - gravity, a member of every solver's definition: bodies that nothing holds fall
 * by it, a body that stands on a boundary rests on it with its weight, and it is a body load on all
 * particles, bit for bit. SPDX-License-Identifier: BSD-3-Clause */
#include "kit/block.h"

static const double pull[3] = {1.5, -9.81, 0.0};

/* The momentum of a free fall is m g t. */
#define FALLS(S)                                                                                   \
  static void S##_falls(mps_##S *solver, double tolerance) {                                       \
    mps_totals sum;                                                                                \
    OK(mps_##S##_step(solver, 20));                                                                \
    OK(mps_##S##_get_totals(solver, &sum));                                                        \
    const double t = mps_##S##_time(solver);                                                       \
    for (int c = 0; c < 2; c++)                                                                    \
      NEAR(sum.linear[c], sum.mass *pull[c] * t, tolerance * sum.mass * 10.0 * t);                 \
  }
FALLS(mpm)
FALLS(dynamics)
FALLS(fluid)

TEST(free_bodies_fall) {
  scoped_particles *set = block();
  scoped_material *material = rubber();
  mps_mpm_def mpm_def = mps_mpm_defaults();
  mps_dynamics_def dynamics_def = mps_dynamics_defaults();
  mps_fluid_def fluid_def = mps_fluid_defaults();
  mps_dynamics *dynamics = NULL;
  for (int c = 0; c < 3; c++)
    mpm_def.gravity[c] = dynamics_def.gravity[c] = fluid_def.gravity[c] = pull[c];
  mpm_def.cell = 0.2, mpm_def.dt = 1e-4;
  MAKE(mpm, mpm, create, context, set, material, &mpm_def);
  mpm_falls(mpm, 1e-12);
  mps_particles_destroy(&set);
  for (int euler = 0; euler < 2; euler++) {
    set = block();
    dynamics_def.material = material, dynamics_def.dt = 1e-4;
    dynamics_def.integrator =
        euler ? MPS_DYNAMICS_INTEGRATOR_EULER : MPS_DYNAMICS_INTEGRATOR_VERLET;
    OK(mps_dynamics_create(context, set, &dynamics_def, &dynamics));
    dynamics_falls(dynamics, 1e-12);
    mps_dynamics_destroy(&dynamics);
    mps_particles_destroy(&set);
  }
  set = block();
  fluid_def.dt = 1e-4;
  MAKE(fluid, fluid, create, context, set, &fluid_def);
  fluid_falls(fluid, 1e-5); /* the residual of its pressures */
}

/* The elastic block on its lowest row: its weight is the reaction, by the definition and by a
 * load, with the same bits. */
TEST(a_block_rests_with_its_weight) {
  double displacement[2][32];
  scoped_material *material = rubber();
  DEF(elastic, def, .material = material);
  for (int by_load = 0; by_load < 2; by_load++) {
    scoped_particles *set = block();
    mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
    mps_elastic_load_def load = mps_elastic_load_defaults();
    int32_t number;
    mps_reaction r;
    for (int c = 0; c < 2; c++) def.gravity[c] = by_load ? 0.0 : pull[c], load.force[c] = pull[c];
    MAKE(elastic, elastic, create, context, set, &def);
    foot.upper[1] = 0.1, load.all = 1;
    OK(mps_elastic_add_boundary(elastic, &foot, &number));
    if (by_load) OK(mps_elastic_add_load(elastic, &load, NULL));
    OK(mps_elastic_solve(elastic));
    OK(mps_elastic_get_reaction(elastic, number, &r));
    for (int c = 0; c < 2; c++) NEAR(r.force[c], -320.0 * pull[c], 1e-6);
    mps_view u = view_field(set, "displacement");
    for (int64_t k = 0; k < 32; k++) displacement[by_load][k] = *mps_view_f64(&u, k, 1);
  }
  for (int k = 0; k < 32; k++) assert_true(displacement[0][k] == displacement[1][k]);
  scoped_particles *set = block();
  mps_elastic *elastic = NULL;
  DEF(elastic, none, .material = material, .gravity[1] = NAN);
  REFUSES(mps_elastic_create(context, set, &none, &elastic), "gravity[1] is nan m/s2");
  DEF(dynamics, flat, .material = material, .gravity[2] = 1.0);
  mps_dynamics *dynamics = NULL;
  REFUSES(mps_dynamics_create(context, set, &flat, &dynamics), "gravity[2] is 1");
}

/* Explicit dynamics on a held row: the same bits by the definition and by a body load. */
TEST(gravity_is_a_body_load) {
  double velocity[2][64];
  scoped_material *material = rubber();
  for (int by_load = 0; by_load < 2; by_load++) {
    scoped_particles *set = block();
    DEF(dynamics, def, .material = material);
    DEF(dynamics_load, load, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1);
    for (int c = 0; c < 2; c++)
      def.gravity[c] = by_load ? 0.0 : pull[c], load.acceleration[c] = pull[c];
    MAKE(dynamics, dynamics, create, context, set, &def);
    USING(dynamics_boundary, mps_dynamics_add_boundary(dynamics, &given, NULL), .upper[1] = 0.1);
    if (by_load) OK(mps_dynamics_add_load(dynamics, &load, NULL));
    OK(mps_dynamics_step(dynamics, 50));
    mps_view v = view_field(set, "velocity");
    for (int64_t k = 0; k < 64; k++) velocity[by_load][k] = *mps_view_f64(&v, k / 2, (int)(k % 2));
  }
  double largest = 0.0;
  for (int k = 0; k < 64; k++) {
    assert_true(velocity[0][k] == velocity[1][k]);
    largest = fmax(largest, fabs(velocity[0][k]));
  }
  assert_true(largest > 1e-3);
}
