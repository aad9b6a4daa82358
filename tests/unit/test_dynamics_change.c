/* test_dynamics_change.c - loads and boundaries of explicit dynamics that are changed or taken away
 * between steps, against the momentum that they give. Verlet keeps it to rounding.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"
#include "test_fixture.h"

#define DT 1e-3 /* s, about a quarter of the limit */
#define STEPS 50

static const soil_layer soil = {1e9, 1500.0, 100.0, 200.0, 0.0};

/* 6 x 6 particles of 1 m, at rest: 54 t a metre. */
static mps_dynamics *block(mps_particles **set) {
  DEF(dynamics, def, .dt = DT);
  *set = soil_particles(context, 1.0, 6.0, 6.0, 1, &soil);
  MAKE_KEPT(dynamics, dynamics, create, context, *set, &def);
  return dynamics;
}

static void drop(mps_dynamics *dynamics, mps_particles *set) {
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
}

static mps_totals totals_of(mps_dynamics *dynamics) {
  mps_totals t;
  OK(mps_dynamics_get_totals(dynamics, &t));
  return t;
}

TEST(a_changed_load_pushes_anew) {
  mps_particles *set;
  mps_dynamics *dynamics = block(&set);
  DEF(dynamics_load, def, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1, .acceleration[1] = -9.81);
  int32_t number = -1;
  const double mass = totals_of(dynamics).mass;
  OK(mps_dynamics_add_load(dynamics, &def, &number));
  OK(mps_dynamics_step(dynamics, STEPS));
  const double fallen = mass * -9.81 * STEPS * DT;
  NEAR(totals_of(dynamics).linear[1], fallen, 1e-11 * mass);

  /* Another acceleration, then a traction on the six particles of the top. */
  def.acceleration[0] = 2.0, def.acceleration[1] = 0.0;
  OK(mps_dynamics_set_load(dynamics, number, &def));
  OK(mps_dynamics_step(dynamics, STEPS));
  NEAR(totals_of(dynamics).linear[0], mass * 2.0 * STEPS * DT, 1e-11 * mass);
  NEAR(totals_of(dynamics).linear[1], fallen, 1e-11 * mass);
  def = mps_dynamics_load_defaults();
  def.lower[0] = -INFINITY, def.lower[1] = 5.0, def.upper[0] = INFINITY, def.upper[1] = INFINITY;
  def.lower[2] = def.upper[2] = 0.0;
  def.traction[1] = 3000.0; /* Pa on 6 m2 */
  OK(mps_dynamics_set_load(dynamics, number, &def));
  OK(mps_dynamics_step(dynamics, STEPS));
  const double lifted = fallen + 3000.0 * 6.0 * STEPS * DT;
  NEAR(totals_of(dynamics).linear[1], lifted, 1e-11 * mass);

  /* A refused definition changes nothing; without the load the momentum stays. */
  def.traction[0] = NAN;
  REFUSES(mps_dynamics_set_load(dynamics, number, &def), "traction[0] is nan");
  REFUSES(mps_dynamics_set_load(dynamics, number + 1, &def), "number is 1: there is no load");
  REFUSES(mps_dynamics_set_load(dynamics, number, NULL), "NULL");
  OK(mps_dynamics_step(dynamics, STEPS));
  const double twice = lifted + 3000.0 * 6.0 * STEPS * DT;
  NEAR(totals_of(dynamics).linear[1], twice, 1e-11 * mass);
  OK(mps_dynamics_remove_load(dynamics, number));
  REFUSES(mps_dynamics_remove_load(dynamics, number), "number is 0: there is no load");
  OK(mps_dynamics_step(dynamics, STEPS));
  NEAR(totals_of(dynamics).linear[1], twice, 1e-11 * mass);
  drop(dynamics, set);
}

/* The budget of momentum: what the body gains is what load and boundary gave. */
TEST(a_changed_boundary_keeps_its_account) {
  mps_particles *set;
  mps_dynamics *dynamics = block(&set);
  DEF(dynamics_load, gravity, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1, .acceleration[1] = -9.81);
  int32_t load, number;
  mps_reaction r;
  const double mass = totals_of(dynamics).mass;
  OK(mps_dynamics_add_load(dynamics, &gravity, &load));
  DEF(dynamics_boundary, base, .dofs = MPS_DOF_X | MPS_DOF_Y, .lower[0] = base.lower[1] = -INFINITY,
      .upper[0] = INFINITY, .upper[1] = 1.0, .lower[2] = base.upper[2] = 0.0);
  OK(mps_dynamics_add_boundary(dynamics, &base, &number));
  OK(mps_dynamics_step(dynamics, STEPS));
  OK(mps_dynamics_get_reaction(dynamics, number, &r));
  assert_int_equal(r.count, 6);
  assert_true(r.impulse[1] > 0.0);
  NEAR(totals_of(dynamics).linear[1], r.impulse[1] - mass * 9.81 * STEPS * DT, 1e-10 * mass);

  /* Half the base now; what it has exerted so far stays counted. */
  base.upper[0] = 3.0;
  OK(mps_dynamics_set_boundary(dynamics, number, &base));
  OK(mps_dynamics_step(dynamics, STEPS));
  OK(mps_dynamics_get_reaction(dynamics, number, &r));
  assert_int_equal(r.count, 3);
  NEAR(totals_of(dynamics).linear[1], r.impulse[1] - 2.0 * mass * 9.81 * STEPS * DT, 1e-10 * mass);
  REFUSES(mps_dynamics_set_boundary(dynamics, number, NULL), "NULL");

  /* Released, the block falls freely. */
  const double before = totals_of(dynamics).linear[1];
  OK(mps_dynamics_remove_boundary(dynamics, number));
  REFUSES(mps_dynamics_get_reaction(dynamics, number, &r), "boundary");
  OK(mps_dynamics_step(dynamics, STEPS));
  NEAR(totals_of(dynamics).linear[1], before - mass * 9.81 * STEPS * DT, 1e-10 * mass);
  drop(dynamics, set);
}
