/* test_mpm_outflow.c - particles that leave a WLS-MPM solver in a step: a jet through an open side,
 * removal by a body; mass and momentum are kept to the last digit.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

/* Numbers with few digits: sums of masses are exact. */
#define SPACING 0.015625        /* m, 1/64 */
#define MASS (1024.0 / 64 / 64) /* kg, of a particle */

/* A channel 1 m long; it is open to the right, and above there is nothing. */
static mpm_scene channel(mps_context *context, double gravity) {
  mpm_scene s = mpm_scene_begin(context, SPACING, 0.0, 0.0, 1e5);
  DEF(mpm, def, .cell = 2.0 * SPACING, .lower[0] = def.lower[1] = 0.0, .upper[0] = 1.0,
      .gravity[1] = gravity, .budget = 1);
  mpm_scene_box(&s, 0.5, 0.25, 1.0, 0.375);
  SET_FIELDS(s.particles, {"density", 1024.0}, {"velocity", 2.0});
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  mpm_scene_side(&s, MPS_SIDE_X_UPPER, MPS_BOUNDARY_OPEN, 0.0);
  return s;
}

static mps_reaction side_of(mpm_scene *s, int32_t side) {
  mps_reaction r;
  OK(mps_mpm_get_reaction(s->mpm, side, &r));
  return r;
}

/* What has left and what is there are what has come; the momentum too. */
static void check_balance(mpm_scene *s, int64_t came, double momentum, double angular) {
  const mps_reaction out = side_of(s, MPS_SIDE_X_UPPER);
  const mps_totals t = mpm_scene_totals(s);
  assert_int_equal(out.removed + mps_particles_count(s->particles), came);
  assert_true(out.removed_mass == MASS * (double)out.removed);
  assert_true(t.mass == MASS * (double)mps_particles_count(s->particles));
  assert_true(out.removed_mass + t.mass == MASS * (double)came); /* exactly */
  /* Nodes at an edge keep at least 2 % of their mass by weights: momentum is not quite kept there.
   */
  NEAR(t.linear[0] - out.impulse[0], momentum, 1e-3 * momentum);
  NEAR(t.linear[1] - out.impulse[1], 0.0, 1e-3 * momentum);
  NEAR(t.angular[2] - out.moment_impulse[2], angular, 1e-3 * momentum);
}

TEST_SERIAL(a_jet_leaves_the_channel) {
  scoped_mpm_scene s = channel(context, 0.0);
  int64_t came = mps_particles_count(s.particles);
  assert_int_equal(came, 32 * 8);
  double momentum = 2.0 * MASS * (double)came, angular = mpm_scene_totals(&s).angular[2];
  /* The jet is fed: each time a piece as long as the way since. */
  double place[2 * 8];
  for (int k = 0; k < 16; k++) {
    OK(mps_mpm_run(s.mpm, (k + 1) * SPACING / 2.0, 1, NULL, NULL));
    for (int i = 0; i < 8; i++)
      place[2 * i] = 0.5 - 0.5 * SPACING, place[2 * i + 1] = 0.25 + (i + 0.5) * SPACING;
    const int64_t first = mps_particles_count(s.particles);
    OK(mps_particles_append(s.particles, 8, place));
    OK(mps_particles_set(s.particles, "density", 0, 1024.0));
    EDIT(v, s.particles, "velocity")
      for (int64_t p = first; p < first + 8; p++) *mps_edit_f64(&v, p, 0) = 2.0;
    came += 8, momentum += 2.0 * MASS * 8;
    for (int i = 0; i < 8; i++) angular -= MASS * 2.0 * place[2 * i + 1];
    check_balance(&s, came, momentum, angular);
  }
  assert_in_range(side_of(&s, 1).removed, 14 * 8, 18 * 8);
  assert_true(side_of(&s, 1).work < 0.0);
  /* In the end all are removed, and time continues. */
  OK(mps_mpm_run(s.mpm, 1.0, 1, NULL, NULL));
  assert_int_equal(mps_particles_count(s.particles), 0);
  check_balance(&s, came, momentum, angular);
  const mps_reaction all = side_of(&s, 1);
  NEAR(all.work, -0.5 * 2.0 * momentum, 1e-3 * momentum);
  NEAR(mps_mpm_time(s.mpm), 1.0, 0.0);
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "no particles");
}

/* Before, the side failed the step. A rollback restores removed particles. */
TEST_SERIAL(goes_back_and_leaves_again) {
  scoped_mpm_scene s = channel(context, -9.81), other = channel(context, -9.81);
  scoped_snapshot *snapshot = NULL;
  OK(mps_mpm_run(s.mpm, 0.02, 1, NULL, NULL));
  OK(mps_mpm_snapshot(s.mpm, &snapshot));
  const int64_t before = mps_particles_count(s.particles);
  mps_reaction first;
  mps_totals t[2];
  for (int k = 0; k < 2; k++) {
    OK(mps_mpm_step(s.mpm, 100));
    assert_true(mps_particles_count(s.particles) < before - 16);
    t[k] = mpm_scene_totals(&s);
    if (k == 0) first = side_of(&s, 1);
    if (k == 0) OK(mps_mpm_rollback(s.mpm, snapshot));
    if (k == 0) assert_int_equal(mps_particles_count(s.particles), before);
  }
  const mps_reaction again = side_of(&s, 1);
  assert_memory_equal(&first, &again, sizeof first);
  assert_true(t[0].linear[0] == t[1].linear[0] && t[0].kinetic == t[1].kinetic);
  assert_true(again.impulse[0] < 0.0 && again.impulse[1] > 0.0); /* they also fall */
  mps_mpm_energy_report losses; /* the energy budget knows what left */
  OK(mps_mpm_get_energy_report(s.mpm, &losses));
  NEAR(losses.residual, 0.0, 1e-12 * fabs(again.work));
  NEAR(t[1].kinetic + t[1].strain + t[1].dissipated - t[1].work_loads - t[1].work_boundaries,
       2.0 * MASS * 256, 1e-9);
  /* What a roller holds, and an open side that is not passed, change nothing. */
  mpm_scene_side(&other, MPS_SIDE_X_UPPER, MPS_BOUNDARY_ROLLER, 0.0);
  OK(mps_mpm_step(other.mpm, 20));
  assert_int_equal(side_of(&other, 1).removed, 0);
}

TEST_SERIAL(an_open_side_takes_no_motion) {
  scoped_mpm_scene s = channel(context, 0.0);
  DEF(mpm_boundary, def, .kind = MPS_BOUNDARY_OPEN);
  REFUSES(mps_mpm_set_boundary(s.mpm, MPS_SIDE_Y_UPPER, &def), "no boundary of this number");
  def.friction = 0.5;
  REFUSES(mps_mpm_set_boundary(s.mpm, 1, &def), "friction is 0.5");
  def.friction = 0.0;
  int32_t number;
  REFUSES(mps_mpm_add_boundary(s.mpm, &def, &number), "kind is MPS_BOUNDARY_OPEN");
  def.kind = 8;
  REFUSES(mps_mpm_set_boundary(s.mpm, 1, &def), "and MPS_BOUNDARY_OPEN");
}

/* ---- bodies ---------------------------------------------------------------------------------- */

TEST_SERIAL(a_body_takes_away_what_it_finds) {
  scoped_mpm_scene s = channel(context, 0.0);
  const int64_t all = mps_particles_count(s.particles);
  OK(mps_particles_set(s.particles, "velocity", 0, 0.0));
  DEF(body, def, .position[0] = 0.75, .position[1] = 0.375);
  mps_contact_def contact = mps_contact_defaults();
  scoped_contact *handle = NULL;
  mps_reaction r;
  MAKE(body, body, create_box, context, &def, 0.125, 0.125);
  OK(mps_mpm_add_contact(s.mpm, body, &contact, &handle));
  REFUSES(mps_mpm_step(s.mpm, 1), "32 particles");
  mps_contact_destroy(&handle);
  contact.inside = MPS_CONTACT_INSIDE_REMOVE;
  contact.depth = 2.0 * SPACING;
  OK(mps_mpm_add_contact(s.mpm, body, &contact, &handle));
  assert_int_equal(mps_particles_count(s.particles), all - 8 * 4); /* its lower half */
  OK(mps_contact_get_reaction(handle, -1, &r));
  assert_int_equal(r.removed, 32);
  assert_true(r.removed_mass == 32 * MASS);
  OK(mps_mpm_step(s.mpm, 3));
  assert_int_equal(mps_particles_count(s.particles), all - 32);
  /* It is put elsewhere: what is deeper than `depth` there goes before the next step. */
  scoped_snapshot *snapshot = NULL;
  OK(mps_mpm_snapshot(s.mpm, &snapshot));
  WITH_DEFAULTS(mps_body_motion, motion, .position[0] = 0.625);
  OK(mps_body_set_motion(body, &motion));
  OK(mps_mpm_step(s.mpm, 1));
  OK(mps_contact_get_reaction(handle, -1, &r));
  assert_int_equal(r.removed, 32 + 4 * 2); /* of 8 x 4, two rows from the faces beside and below */
  assert_int_equal(mps_particles_count(s.particles) + r.removed, all);
  assert_true(mpm_scene_totals(&s).mass + r.removed_mass == MASS * (double)all);
  OK(mps_mpm_rollback(s.mpm, snapshot));
  OK(mps_contact_get_reaction(handle, -1, &r));
  assert_int_equal(r.removed, 32);
  assert_int_equal(mps_particles_count(s.particles), all - 32);
}
