/* test_pore_water.c - what water in the pores refuses, and what an error leaves as it was; the same
 * bits with threads, and after a snapshot and a checkpoint.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pore_column.h"
#include "test_fixture.h"
#include "test_journal.h"

#include <mps/contact.h>
#include <mps/mpm_settle.h>

#include <stdio.h>
#include <string.h>

static void refused(pore_column *c, const mps_pore_water_def *def, mps_status expected,
                    const char *word) {
  const int32_t fields = mps_particles_field_count(c->s.particles);
  const double dt = mps_mpm_dt(c->s.mpm);
  assert_int_equal(mps_mpm_add_pore_water(c->s.mpm, def), expected);
  if (!strstr(mps_context_error(context)->message, word))
    fail_msg("'%s' does not name %s", mps_context_error(context)->message, word);
  assert_int_equal(mps_particles_field_count(c->s.particles), fields);
  assert_true(mps_mpm_dt(c->s.mpm) == dt);
}

static void definitions_are_checked(void **state) {
  (void)state;
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
  mps_pore_water_def def = mps_pore_water_defaults();
  refused(&c, &def, MPS_ERROR_ARGUMENT, "'porosity' of particle"); /* no field, no value */
  static const double bad[] = {0.0, 1.0, -0.1, INFINITY};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    def.porosity = bad[k];
    refused(&c, &def, MPS_ERROR_ARGUMENT, "porosity");
  }
  def.porosity = 0.4;
  static const double rates[] = {0.0, -1e-5, 2.0, INFINITY};
  for (size_t k = 0; k < sizeof rates / sizeof *rates; k++) {
    def.permeability = rates[k];
    refused(&c, &def, MPS_ERROR_ARGUMENT, "permeability");
  }
  def.permeability = 1e-4, def.bulk = 0.0;
  refused(&c, &def, MPS_ERROR_ARGUMENT, "bulk");
  def.bulk = NAN, def.density = NAN;
  refused(&c, &def, MPS_ERROR_ARGUMENT, "density");
  def.density = 6000.0;
  refused(&c, &def, MPS_ERROR_ARGUMENT, "'density' of particle");
  def.density = 1000.0, def.exponent = -1.0;
  refused(&c, &def, MPS_ERROR_ARGUMENT, "exponent");
  def.exponent = 0.0, def.scheme = 2;
  refused(&c, &def, MPS_ERROR_ARGUMENT, "scheme");
  def.scheme = MPS_PORE_SCHEME_EXPLICIT, def.ratio_slope = 0.0;
  refused(&c, &def, MPS_ERROR_ARGUMENT, "ratio_slope");
  def.ratio_slope = INFINITY;
  double number;
  assert_int_equal(mps_mpm_get_pore_flow(c.s.mpm, -1, &number, NULL), MPS_ERROR_STATE);
  mps_assert_ok(context, mps_mpm_add_pore_water(c.s.mpm, &def));
  assert_int_equal(mps_mpm_add_pore_water(c.s.mpm, &def), MPS_ERROR_STATE);
  assert_int_equal(mps_mpm_settle(c.s.mpm, NULL, NULL), MPS_ERROR_UNSUPPORTED);
  assert_int_equal(mps_mpm_get_pore_flow(c.s.mpm, 0, &number, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_set_pore_level(c.s.mpm, NULL), MPS_ERROR_ARGUMENT);
  mpm_scene_end(&c.s);
}

static void fields_are_checked(void **state) {
  (void)state;
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
  mps_assert_ok(context, mps_particles_set(c.s.particles, "porosity", 0, 0.4));
  mps_assert_ok(context, mps_particles_add_field(c.s.particles, "permeability", 0));
  mps_edit k = mpm_scene_edit(&c.s, "permeability");
  for (int64_t i = 0; i < mps_particles_count(c.s.particles); i++)
    *mps_edit_f64(&k, i, 0) = i == 3 ? 0.0 : 1e-4; /* one undrained among drained ones */
  mpm_scene_commit(&c.s, &k);
  mps_pore_water_def def = mps_pore_water_defaults();
  refused(&c, &def, MPS_ERROR_ARGUMENT, "'permeability' of particle");
  mps_assert_ok(context, mps_particles_set(c.s.particles, "permeability", 0, 1e-4));
  mps_assert_ok(context, mps_mpm_add_pore_water(c.s.mpm, &def));
  mps_assert_ok(context, mps_mpm_step(c.s.mpm, 2));
  mps_assert_ok(context, mps_particles_set(c.s.particles, "porosity", 0, 1.0));
  assert_int_equal(mps_mpm_step(c.s.mpm, 1), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_steps(c.s.mpm), 2);
  mps_assert_ok(context, mps_particles_set(c.s.particles, "porosity", 0, 0.4));
  mps_assert_ok(context, mps_mpm_step(c.s.mpm, 1));
  mpm_scene_end(&c.s);
}

static void faces_are_checked(void **state) {
  (void)state;
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
  mps_pore_face_def face = mps_pore_face_defaults();
  mps_pore_water_def water = mps_pore_water_defaults();
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_STATE);
  water.porosity = 0.4;
  mps_assert_ok(context, mps_mpm_add_pore_water(c.s.mpm, &water));
  face.kind = 2;
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  face = mps_pore_face_defaults(), face.sides = 1u << 4;
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  face = mps_pore_face_defaults(), face.pressure = NAN;
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  face = mps_pore_face_defaults(), face.lower[0] = 1.0, face.upper[0] = 0.0;
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  face = mps_pore_face_defaults(), face.at_rest = 2;
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  face = mps_pore_face_defaults(), face.pressure = 1000.0; /* without a kind it is impervious */
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(mps_context_error(context)->message, "impervious"));
  face = mps_pore_face_defaults(), face.at_rest = 1;
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  face = mps_pore_face_defaults();
  for (int32_t k = 0; k < MPS_PORE_MAX_FACES; k++)
    mps_assert_ok(context, mps_mpm_add_pore_face(c.s.mpm, &face, NULL));
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_set_pore_face(c.s.mpm, MPS_PORE_MAX_FACES, &face), MPS_ERROR_ARGUMENT);
  mps_assert_ok(context, mps_mpm_set_pore_face(c.s.mpm, 0, &face));
  mpm_scene_end(&c.s);
}

/* ---- the same bits --------------------------------------------------------------------------- */

/* A block of ground that falls on a corner of the domain, so that surfaces cross cells. */
static mpm_scene block(mps_context *where, int32_t scheme) {
  mpm_scene s = mpm_scene_begin(where, 0.01, 0.0, 0.03, 1e5);
  mpm_scene_box(&s, 0.1, 0.03, 0.9, 0.73);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.02;
  def.lower[0] = def.lower[1] = 0.0;
  def.gravity[1] = -9.81;
  mpm_scene_solve(&s, &def);
  mps_pore_water_def water = mps_pore_water_defaults();
  water.scheme = scheme;
  water.porosity = 0.4, water.permeability = 1e-4, water.exponent = 2.0, water.ratio_slope = 0.5;
  mps_assert_ok(where, mps_mpm_add_pore_water(s.mpm, &water));
  return s;
}

static void assert_same(mpm_scene *a, mpm_scene *b) {
  static const char *const names[] = {"position", "stress",       "pore_pressure",
                                      "porosity", "permeability", "mass"};
  for (size_t f = 0; f < sizeof names / sizeof *names; f++) {
    const mps_view x = mpm_scene_view(a, names[f]), y = mpm_scene_view(b, names[f]);
    for (int64_t k = 0; k < x.shape[0]; k++)
      for (int64_t c = 0; c < x.shape[1]; c++)
        assert_true(*mps_view_f64(&x, k, c) == *mps_view_f64(&y, k, c));
  }
  double p, q;
  mps_assert_ok(a->context, mps_mpm_get_pore_flow(a->mpm, -1, NULL, &p));
  mps_assert_ok(b->context, mps_mpm_get_pore_flow(b->mpm, -1, NULL, &q));
  assert_true(p == q);
}

static void compare_threads(int32_t scheme, int64_t steps) {
  mps_context *many = test_context(MPS_CONTEXT_EXECUTOR_OPENMP, 3);
  mpm_scene one = block(context, scheme), three = block(many, scheme);
  mps_assert_ok(context, mps_mpm_step(one.mpm, steps));
  mps_assert_ok(many, mps_mpm_step(three.mpm, steps));
  assert_same(&one, &three);
  mpm_scene_end(&one);
  mpm_scene_end(&three);
  mps_context_destroy(&many);
}

static void threads_change_no_bit(void **state) {
  (void)state;
  compare_threads(MPS_PORE_SCHEME_EXPLICIT, 200);
  compare_threads(MPS_PORE_SCHEME_IMPLICIT, 10);
}

/* Cut at `steps`, with some steps back in time, and on for half as many. */
static void compare_restarts(int32_t scheme, int64_t steps) {
  mpm_scene whole = block(context, scheme), cut = block(context, scheme);
  mpm_scene other = block(context, scheme);
  mps_snapshot *shot = NULL;
  mps_assert_ok(context, mps_mpm_step(whole.mpm, steps + steps / 2));
  mps_assert_ok(context, mps_mpm_step(cut.mpm, steps));
  mps_assert_ok(context, mps_mpm_snapshot(cut.mpm, &shot));
  const mps_status saved = mps_mpm_save(cut.mpm, "pore_water.h5", NULL);
  mps_assert_ok(context, mps_mpm_step(cut.mpm, 3));
  mps_assert_ok(context, mps_mpm_rollback(cut.mpm, shot));
  mps_assert_ok(context, mps_mpm_step(cut.mpm, steps / 2));
  assert_same(&whole, &cut);
  if (saved == MPS_OK) {
    mps_assert_ok(context, mps_mpm_restore(other.mpm, "pore_water.h5", NULL));
    mps_assert_ok(context, mps_mpm_step(other.mpm, steps / 2));
    assert_same(&whole, &other);
    (void)remove("pore_water.h5");
  } else {
    assert_int_equal(saved, MPS_ERROR_UNSUPPORTED); /* a build without HDF5 */
  }
  mps_snapshot_destroy(&shot);
  mpm_scene_end(&whole);
  mpm_scene_end(&cut);
  mpm_scene_end(&other);
}

static void restarts_change_no_bit(void **state) {
  (void)state;
  compare_restarts(MPS_PORE_SCHEME_EXPLICIT, 100);
  compare_restarts(MPS_PORE_SCHEME_IMPLICIT, 10);
}

/* A law of the caller's, without stress, that refuses on request. */
static mps_status refusing(void *user, const mps_material_block *at) {
  if (!*(const bool *)user) return MPS_OK;
  *at->refused = 0;
  return MPS_ERROR_NUMERIC;
}

/* The block, which rests on a body, with some particles of such a law. */
typedef struct touchy {
  mpm_scene s;
  mps_material *law;
  mps_body *body;
  mps_contact *contact;
} touchy;

static touchy touchy_begin(int32_t scheme, const bool *refuses) {
  static const int64_t ids[] = {7, 1000, 2000};
  touchy t = {.s = block(context, scheme)};
  mps_material_user_def law = mps_material_user_defaults();
  mps_body_def def = mps_body_defaults(); /* stands still */
  law.update = refusing, law.user = (void *)refuses, law.wave_modulus = 1e5;
  mps_assert_ok(context, mps_material_create_user(context, &law, &t.law));
  mps_assert_ok(context, mps_mpm_set_material(t.s.mpm, t.law, 3, ids));
  def.position[0] = 0.5, def.position[1] = 0.03 - 0.05;
  mps_assert_ok(context, mps_body_create_box(context, &def, 0.4, 0.1, &t.body));
  mps_assert_ok(context, mps_mpm_add_contact(t.s.mpm, t.body, NULL, &t.contact));
  return t;
}

static void touchy_end(touchy *t) {
  mps_contact_destroy(&t->contact);
  mps_body_destroy(&t->body);
  mpm_scene_end(&t->s);
  mps_material_destroy(&t->law);
}

/* A step that a law refuses, after the pressures have been found and water has flowed, has not
 * happened: the run continues with the bits of one without. */
static void refused_steps_change_no_bit(void **state) {
  (void)state;
  for (int32_t scheme = MPS_PORE_SCHEME_EXPLICIT; scheme <= MPS_PORE_SCHEME_IMPLICIT; scheme++) {
    bool never = false, now = false;
    touchy a = touchy_begin(scheme, &never), b = touchy_begin(scheme, &now);
    for (int part = 0; part < 3; part++) {
      mps_reaction reaction;
      mps_assert_ok(context, mps_mpm_step(a.s.mpm, 10));
      mps_assert_ok(context, mps_mpm_step(b.s.mpm, 10));
      now = true;
      assert_int_equal(mps_mpm_step(b.s.mpm, 1), MPS_ERROR_NUMERIC);
      now = false;
      assert_int_equal(mps_mpm_steps(b.s.mpm), 10 * (part + 1));
      assert_same(&a.s, &b.s);
      mps_assert_ok(context, mps_contact_get_reaction(a.contact, -1, &reaction));
      assert_true(reaction.force[1] != 0.0); /* the contact bears */
    }
    touchy_end(&a);
    touchy_end(&b);
  }
}

/* Implicit pressures leave the step that dry ground has; where water flows there is no settling. */
static void implicit_steps_are_long(void **state) {
  (void)state;
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
  const double dry = mps_mpm_limit(c.s.mpm);
  mps_pore_water_def def = mps_pore_water_defaults();
  def.porosity = 0.4, def.permeability = 1e-4, def.scheme = MPS_PORE_SCHEME_IMPLICIT;
  mps_assert_ok(context, mps_mpm_add_pore_water(c.s.mpm, &def));
  mps_assert_near(mps_mpm_limit(c.s.mpm), dry, 1e-12 * dry);
  assert_int_equal(mps_mpm_settle(c.s.mpm, NULL, NULL), MPS_ERROR_UNSUPPORTED);
  assert_non_null(strstr(mps_context_error(context)->message, "flows"));
  mps_assert_ok(context, mps_mpm_get_pore_water(c.s.mpm, &def));
  assert_int_equal(def.scheme, MPS_PORE_SCHEME_IMPLICIT);
  mpm_scene_end(&c.s);
}

/* Undrained ground settles under its weight: its water bears the part 1/(1 + n M'/K_w) of it. */
static void settles_undrained(int32_t scheme) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 16.0, 10.0, 0.0);
  mps_pore_water_def def = mps_pore_water_defaults();
  mps_mpm_settled settled;
  double worst = 0.0;
  def.porosity = 0.4, def.scheme = scheme;
  def.bulk = 0.4 * 9.0 * c.modulus;
  mps_assert_ok(context, mps_mpm_add_pore_water(c.s.mpm, &def));
  const double limit = mps_mpm_limit(c.s.mpm);
  mps_assert_ok(context, mps_mpm_set_dt(c.s.mpm, 0.5 * limit)); /* implicit: of dry ground */
  mps_assert_ok(context, mps_mpm_settle(c.s.mpm, NULL, &settled));
  mps_assert_ok(context, mps_mpm_get_pore_water(c.s.mpm, &def));
  assert_int_equal(def.scheme, scheme);
  mps_assert_near(mps_mpm_limit(c.s.mpm), limit, 0.01 * limit);
  mps_assert_ok(context, mps_mpm_step(c.s.mpm, 50)); /* the equilibrium is that of both schemes */
  const mps_view x = mpm_scene_view(&c.s, "position"), u = mpm_scene_view(&c.s, "pore_pressure");
  for (int64_t k = 0; k < u.shape[0]; k++) {
    const double depth = 1.0 - *mps_view_f64(&x, k, 1);
    worst = fmax(worst, fabs(*mps_view_f64(&u, k, 0) / (2000.0 * 10.0) - 0.9 * depth));
  }
  print_message("settled, scheme %d: %d steps, pressures within %.2f %% of the greatest weight\n",
                scheme, (int)settled.steps, 100.0 * worst);
  assert_true(worst < 0.02);
  mpm_scene_end(&c.s);
}
static void undrained_ground_settles(void **state) {
  (void)state;
  settles_undrained(MPS_PORE_SCHEME_EXPLICIT);
  settles_undrained(MPS_PORE_SCHEME_IMPLICIT);
}

/* Water at a pressure of its own leaves through the surface, but not where a body lies on it. */
static void lets_water_out(bool lid, int32_t scheme) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 8.0, 0.0, 10.0);
  mps_pore_water_def water = mps_pore_water_defaults();
  mps_body *body = NULL;
  mps_contact *contact = NULL;
  mps_pore_budget budget;
  water.porosity = 0.4, water.permeability = 1e-3, water.scheme = scheme;
  mps_assert_ok(context, mps_mpm_add_pore_water(c.s.mpm, &water));
  mps_assert_ok(context, mps_particles_set(c.s.particles, "pore_pressure", 0, 1000.0));
  if (lid) {
    mps_body_def def = mps_body_defaults(); /* stands still */
    def.position[1] = 1.25;
    mps_assert_ok(context, mps_body_create_box(context, &def, 1.0, 0.5, &body));
    mps_assert_ok(context, mps_mpm_add_contact(c.s.mpm, body, NULL, &contact));
  }
  mps_assert_ok(context, mps_mpm_step(c.s.mpm, 50));
  mps_assert_ok(context, mps_mpm_get_pore_budget(c.s.mpm, &budget));
  print_message("lid %d, scheme %d: %.3g kg have left\n", lid, scheme, budget.left);
  if (lid)
    mps_assert_near(budget.left + budget.entered, 0.0, 0.0);
  else
    assert_true(budget.drained > 0.0);
  mps_contact_destroy(&contact);
  mps_body_destroy(&body);
  mpm_scene_end(&c.s);
}

static void bodies_are_impervious(void **state) {
  (void)state;
  for (int32_t scheme = 0; scheme < 2; scheme++) {
    lets_water_out(false, scheme);
    lets_water_out(true, scheme);
  }
}

/* A drained face of undrained ground is warned of, at once; one of ground that drains is not. */
static void faces_of_undrained_ground_are_warned_of(void **state) {
  (void)state;
  for (int flows = 0; flows < 2; flows++) {
    journal log = {0};
    mps_context *own = journal_context(&log, NULL);
    pore_column c = pore_column_begin(own, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
    mps_pore_water_def def = mps_pore_water_defaults();
    mps_pore_face_def face = mps_pore_face_defaults();
    def.porosity = 0.4;
    if (flows) def.permeability = 1e-4;
    mps_assert_ok(own, mps_mpm_add_pore_water(c.s.mpm, &def));
    mps_assert_ok(own, mps_mpm_add_pore_face(c.s.mpm, &face, NULL));
    assert_int_equal(log.count, 0);
    face.kind = MPS_PORE_FACE_DRAINED;
    for (int k = 0; k < 3; k++) {
      face.pressure = 10.0 * k;
      mps_assert_ok(own, mps_mpm_set_pore_face(c.s.mpm, 0, &face));
      assert_int_equal(log.count, flows ? 0 : 1); /* not again with each pressure */
    }
    mps_assert_ok(own, mps_mpm_add_pore_face(c.s.mpm, &face, NULL));
    assert_int_equal(log.count, flows ? 0 : 2);
    if (!flows) assert_non_null(strstr(log.last, "drained face of undrained ground"));
    mpm_scene_end(&c.s);
    mps_context_destroy(&own);
  }
}

/* Implicit pressures of undrained ground below a body that moves are warned of, once. */
static void bodies_in_undrained_ground_are_warned_of(void **state) {
  (void)state;
  for (int which = 0; which < 3; which++) { /* moves; stands still; the water flows */
    journal log = {0};
    mps_context *own = journal_context(&log, NULL);
    pore_column c = pore_column_begin(own, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
    mps_pore_water_def water = mps_pore_water_defaults();
    mps_body_def def = mps_body_defaults();
    mps_body_motion motion = mps_body_motion_defaults();
    mps_body *body = NULL;
    mps_contact *contact = NULL;
    water.porosity = 0.4, water.scheme = MPS_PORE_SCHEME_IMPLICIT;
    if (which == 2) water.permeability = 1e-4;
    def.position[1] = 1.25;
    motion.velocity[1] = which == 1 ? 0.0 : -1e-3;
    mps_assert_ok(own, mps_mpm_add_pore_water(c.s.mpm, &water));
    mps_assert_ok(own, mps_body_create_box(own, &def, 1.0, 0.5, &body));
    mps_assert_ok(own, mps_body_set_motion(body, &motion));
    mps_assert_ok(own, mps_mpm_add_contact(c.s.mpm, body, NULL, &contact));
    mps_assert_ok(own, mps_mpm_step(c.s.mpm, 3));
    assert_int_equal(log.count, which == 0 ? 1 : 0);
    if (which == 0) assert_non_null(strstr(log.last, "lag beside a body that moves"));
    mps_contact_destroy(&contact);
    mps_body_destroy(&body);
    mpm_scene_end(&c.s);
    mps_context_destroy(&own);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(definitions_are_checked),
                                     cmocka_unit_test(fields_are_checked),
                                     cmocka_unit_test(faces_are_checked),
                                     cmocka_unit_test(threads_change_no_bit),
                                     cmocka_unit_test(restarts_change_no_bit),
                                     cmocka_unit_test(refused_steps_change_no_bit),
                                     cmocka_unit_test(implicit_steps_are_long),
                                     cmocka_unit_test(undrained_ground_settles),
                                     cmocka_unit_test(bodies_are_impervious),
                                     cmocka_unit_test(faces_of_undrained_ground_are_warned_of),
                                     cmocka_unit_test(bodies_in_undrained_ground_are_warned_of)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
