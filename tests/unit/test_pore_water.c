/* test_pore_water.c - what water in the pores refuses, and what an error leaves as it was; the same
 * bits with threads, and after a snapshot and a checkpoint.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kit/same.h"
#include "pore_column.h"
#include "test_fixture.h"
#include "test_journal.h"

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

TEST(definitions_are_checked) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
  mps_pore_water_def def = mps_pore_water_defaults();
  refused(&c, &def, MPS_ERROR_ARGUMENT, "'porosity' of particle"); /* no field, no value */
  def.porosity = 0.4, def.permeability = 1e-4, def.density = 6000.0;
  refused(&c, &def, MPS_ERROR_ARGUMENT, "'density' of particle");
  def.density = 1000.0;
  double number;
  assert_int_equal(mps_mpm_get_pore_flow(c.s.mpm, -1, &number, NULL), MPS_ERROR_STATE);
  OK(mps_mpm_add_pore_water(c.s.mpm, &def));
  assert_int_equal(mps_mpm_add_pore_water(c.s.mpm, &def), MPS_ERROR_STATE);
  assert_int_equal(mps_mpm_settle(c.s.mpm, NULL, NULL), MPS_ERROR_UNSUPPORTED);
  assert_int_equal(mps_mpm_get_pore_flow(c.s.mpm, 0, &number, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_set_pore_level(c.s.mpm, NULL), MPS_ERROR_ARGUMENT);
  mpm_scene_end(&c.s);
}

TEST(fields_are_checked) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
  OK(mps_particles_set(c.s.particles, "porosity", 0, 0.4));
  OK(mps_particles_add_field(c.s.particles, "permeability", 0));
  EDIT(k, c.s.particles, "permeability")
    for (int64_t i = 0; i < mps_particles_count(c.s.particles); i++)
      *mps_edit_f64(&k, i, 0) = i == 3 ? 0.0 : 1e-4; /* one undrained among drained ones */
  mps_pore_water_def def = mps_pore_water_defaults();
  refused(&c, &def, MPS_ERROR_ARGUMENT, "'permeability' of particle");
  OK(mps_particles_set(c.s.particles, "permeability", 0, 1e-4));
  OK(mps_mpm_add_pore_water(c.s.mpm, &def));
  OK(mps_mpm_step(c.s.mpm, 2));
  OK(mps_particles_set(c.s.particles, "porosity", 0, 1.0));
  assert_int_equal(mps_mpm_step(c.s.mpm, 1), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_steps(c.s.mpm), 2);
  OK(mps_particles_set(c.s.particles, "porosity", 0, 0.4));
  OK(mps_mpm_step(c.s.mpm, 1));
  mpm_scene_end(&c.s);
}

TEST(faces_are_checked) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
  mps_pore_face_def face = mps_pore_face_defaults();
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_STATE);
  USING(pore_water, mps_mpm_add_pore_water(c.s.mpm, &given), .porosity = 0.4);
  for (int32_t k = 0; k < MPS_PORE_MAX_FACES; k++) OK(mps_mpm_add_pore_face(c.s.mpm, &face, NULL));
  assert_int_equal(mps_mpm_add_pore_face(c.s.mpm, &face, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_mpm_set_pore_face(c.s.mpm, MPS_PORE_MAX_FACES, &face), MPS_ERROR_ARGUMENT);
  OK(mps_mpm_set_pore_face(c.s.mpm, 0, &face));
  mpm_scene_end(&c.s);
}

/* ---- the same bits --------------------------------------------------------------------------- */

/* A block of ground that falls on a corner of the domain, so that surfaces cross cells. */
static mpm_scene block(mps_context *where, int32_t scheme) {
  mpm_scene s = mpm_scene_begin(where, 0.01, 0.0, 0.03, 1e5);
  mpm_scene_box(&s, 0.1, 0.03, 0.9, 0.73);
  DEF(mpm, def, .cell = 0.02, .lower[0] = def.lower[1] = 0.0, .gravity[1] = -9.81);
  mpm_scene_solve(&s, &def);
  USING(pore_water, mps_mpm_add_pore_water(s.mpm, &given), .scheme = scheme, .porosity = 0.4,
        .permeability = 1e-4, .exponent = 2.0, .ratio_slope = 0.5);
  return s;
}

static void assert_same(mpm_scene *a, mpm_scene *b) {
  assert_same_rows(a->particles, b->particles, "");
  double p, q;
  OK(mps_mpm_get_pore_flow(a->mpm, -1, NULL, &p));
  OK(mps_mpm_get_pore_flow(b->mpm, -1, NULL, &q));
  assert_true(p == q);
}

static void compare_threads(int32_t scheme, int64_t steps) {
  scoped_context *many = test_context(MPS_CONTEXT_EXECUTOR_OPENMP, 3);
  scoped_mpm_scene one = block(context, scheme), three = block(many, scheme);
  OK(mps_mpm_step(one.mpm, steps));
  OK(mps_mpm_step(three.mpm, steps));
  assert_same(&one, &three);
}

TEST(threads_change_no_bit) {
  compare_threads(MPS_PORE_SCHEME_EXPLICIT, 200);
  compare_threads(MPS_PORE_SCHEME_IMPLICIT, 10);
}

/* Cut at `steps`, with some steps back in time, and on for half as many. */
static void compare_restarts(int32_t scheme, int64_t steps) {
  scoped_mpm_scene whole = block(context, scheme), cut = block(context, scheme);
  scoped_mpm_scene other = block(context, scheme);
  scoped_snapshot *shot = NULL;
  OK(mps_mpm_step(whole.mpm, steps + steps / 2));
  OK(mps_mpm_step(cut.mpm, steps));
  OK(mps_mpm_snapshot(cut.mpm, &shot));
  const mps_status saved = mps_mpm_save(cut.mpm, "pore_water.h5", NULL);
  OK(mps_mpm_step(cut.mpm, 3));
  OK(mps_mpm_rollback(cut.mpm, shot));
  OK(mps_mpm_step(cut.mpm, steps / 2));
  assert_same(&whole, &cut);
  if (saved == MPS_OK) {
    OK(mps_mpm_restore(other.mpm, "pore_water.h5", NULL));
    OK(mps_mpm_step(other.mpm, steps / 2));
    assert_same(&whole, &other);
    (void)remove("pore_water.h5");
  } else {
    assert_int_equal(saved, MPS_ERROR_UNSUPPORTED); /* a build without HDF5 */
  }
}

TEST(restarts_change_no_bit) {
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
  mps_body_def def = mps_body_defaults(); /* stands still */
  DEF(material_user, law, .update = refusing, .user = (void *)refuses, .wave_modulus = 1e5);
  OK(mps_material_create_user(context, &law, &t.law));
  OK(mps_mpm_set_material(t.s.mpm, t.law, ids, 3));
  def.position[0] = 0.5, def.position[1] = 0.03 - 0.05;
  OK(mps_body_create_box(context, &def, 0.4, 0.1, &t.body));
  OK(mps_mpm_add_contact(t.s.mpm, t.body, NULL, &t.contact));
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
TEST(refused_steps_change_no_bit) {
  for (int32_t scheme = MPS_PORE_SCHEME_EXPLICIT; scheme <= MPS_PORE_SCHEME_IMPLICIT; scheme++) {
    bool never = false, now = false;
    SCOPED(touchy_end) touchy a = touchy_begin(scheme, &never), b = touchy_begin(scheme, &now);
    for (int part = 0; part < 3; part++) {
      mps_reaction reaction;
      OK(mps_mpm_step(a.s.mpm, 10));
      OK(mps_mpm_step(b.s.mpm, 10));
      now = true;
      assert_int_equal(mps_mpm_step(b.s.mpm, 1), MPS_ERROR_NUMERIC);
      now = false;
      assert_int_equal(mps_mpm_steps(b.s.mpm), 10 * (part + 1));
      assert_same(&a.s, &b.s);
      OK(mps_contact_get_reaction(a.contact, -1, &reaction));
      assert_true(reaction.force[1] != 0.0); /* the contact bears */
    }
  }
}

/* Implicit pressures leave the step that dry ground has; where water flows there is no settling. */
TEST(implicit_steps_are_long) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
  const double dry = mps_mpm_limit(c.s.mpm);
  DEF(pore_water, def, .porosity = 0.4, .permeability = 1e-4, .scheme = MPS_PORE_SCHEME_IMPLICIT);
  OK(mps_mpm_add_pore_water(c.s.mpm, &def));
  NEAR(mps_mpm_limit(c.s.mpm), dry, 1e-12 * dry);
  assert_int_equal(mps_mpm_settle(c.s.mpm, NULL, NULL), MPS_ERROR_UNSUPPORTED);
  assert_non_null(strstr(mps_context_error(context)->message, "flows"));
  OK(mps_mpm_get_pore_water(c.s.mpm, &def));
  assert_int_equal(def.scheme, MPS_PORE_SCHEME_IMPLICIT);
  mpm_scene_end(&c.s);
}

/* Undrained ground settles under its weight: its water bears the part 1/(1 + n M'/K_w) of it. */
static void settles_undrained(int32_t scheme) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 16.0, 10.0, 0.0);
  DEF(pore_water, def, .porosity = 0.4, .scheme = scheme, .bulk = 0.4 * 9.0 * c.modulus);
  mps_mpm_settled settled;
  double worst = 0.0;
  OK(mps_mpm_add_pore_water(c.s.mpm, &def));
  const double limit = mps_mpm_limit(c.s.mpm);
  OK(mps_mpm_set_dt(c.s.mpm, 0.5 * limit)); /* implicit: of dry ground */
  OK(mps_mpm_settle(c.s.mpm, NULL, &settled));
  OK(mps_mpm_get_pore_water(c.s.mpm, &def));
  assert_int_equal(def.scheme, scheme);
  NEAR(mps_mpm_limit(c.s.mpm), limit, 0.01 * limit);
  OK(mps_mpm_step(c.s.mpm, 50)); /* the equilibrium is that of both schemes */
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
TEST(undrained_ground_settles) {
  settles_undrained(MPS_PORE_SCHEME_EXPLICIT);
  settles_undrained(MPS_PORE_SCHEME_IMPLICIT);
}

/* Water at a pressure of its own leaves through the surface, but not where a body lies on it. */
static void lets_water_out(bool lid, int32_t scheme) {
  pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 8.0, 0.0, 10.0);
  DEF(pore_water, water, .porosity = 0.4, .permeability = 1e-3, .scheme = scheme);
  scoped_body *body = NULL;
  scoped_contact *contact = NULL;
  mps_pore_budget budget;
  OK(mps_mpm_add_pore_water(c.s.mpm, &water));
  OK(mps_particles_set(c.s.particles, "pore_pressure", 0, 1000.0));
  if (lid) {
    mps_body_def def = mps_body_defaults(); /* stands still */
    def.position[1] = 1.25;
    OK(mps_body_create_box(context, &def, 1.0, 0.5, &body));
    OK(mps_mpm_add_contact(c.s.mpm, body, NULL, &contact));
  }
  OK(mps_mpm_step(c.s.mpm, 50));
  OK(mps_mpm_get_pore_budget(c.s.mpm, &budget));
  print_message("lid %d, scheme %d: %.3g kg have left\n", lid, scheme, budget.left);
  if (lid)
    NEAR(budget.left + budget.entered, 0.0, 0.0);
  else
    assert_true(budget.drained > 0.0);
  mpm_scene_end(&c.s);
}

TEST(bodies_are_impervious) {
  for (int32_t scheme = 0; scheme < 2; scheme++) {
    lets_water_out(false, scheme);
    lets_water_out(true, scheme);
  }
}

/* A drained face of undrained ground is warned of, at once; one of ground that drains is not. */
TEST(faces_of_undrained_ground_are_warned_of) {
  for (int flows = 0; flows < 2; flows++) {
    journal log = {0};
    scoped_context *own = journal_context(&log, NULL);
    pore_column c = pore_column_begin(own, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
    DEF(pore_water, def, .porosity = 0.4);
    mps_pore_face_def face = mps_pore_face_defaults();
    if (flows) def.permeability = 1e-4;
    OK(mps_mpm_add_pore_water(c.s.mpm, &def));
    OK(mps_mpm_add_pore_face(c.s.mpm, &face, NULL));
    assert_int_equal(log.count, 0);
    face.kind = MPS_PORE_FACE_DRAINED;
    for (int k = 0; k < 3; k++) {
      face.pressure = 10.0 * k;
      OK(mps_mpm_set_pore_face(c.s.mpm, 0, &face));
      assert_int_equal(log.count, flows ? 0 : 1); /* not again with each pressure */
    }
    OK(mps_mpm_add_pore_face(c.s.mpm, &face, NULL));
    assert_int_equal(log.count, flows ? 0 : 2);
    if (!flows) assert_non_null(strstr(log.last, "drained face of undrained ground"));
    mpm_scene_end(&c.s);
  }
}

/* A seam of clay of one row or two lets water through where it shares cells with sand: such a cell
 * has the mean of both. Faces of the seam that are faces of cells are right. */
TEST(permeabilities_that_differ_within_a_cell_are_warned_of) {
  static const struct {
    double low, high, ratio; /* m, of the seam in a column of cells of 0.25 m; sand over clay */
    int warnings;
  } seams[] = {{0.25, 0.5, 1000.0, 0},
               {0.25, 0.75, 10.0, 0},
               {0.375, 0.625, 1000.0, 1},
               {0.5, 0.625, 10.0, 1},
               {0.5, 0.625, 2.0, 0}};
  for (int geometry = MPS_MPM_GEOMETRY_PLANE_STRAIN; geometry <= MPS_MPM_GEOMETRY_SPACE; geometry++)
    for (int k = 0; k < (int)(sizeof seams / sizeof *seams); k++) {
      journal log = {0};
      char text[64];
      scoped_context *own = journal_context(&log, NULL);
      pore_column c = pore_column_begin(own, geometry, 4.0, 10.0, 0.0);
      OK(mps_particles_add_field(c.s.particles, "permeability", 0));
      const mps_view x = mpm_scene_view(&c.s, "position");
      EDIT(k_of, c.s.particles, "permeability")
        for (int64_t i = 0; i < x.shape[0]; i++) {
          const double y = *mps_view_f64(&x, i, 1);
          const bool clay = y > seams[k].low && y < seams[k].high;
          *mps_edit_f64(&k_of, i, 0) = clay ? 1e-4 / seams[k].ratio : 1e-4;
        }
      DEF(pore_water, def, .porosity = 0.4);
      OK(mps_mpm_add_pore_water(c.s.mpm, &def));
      assert_int_equal(log.count, seams[k].warnings);
      snprintf(text, sizeof text, "differs by %g times within a cell, at (", seams[k].ratio);
      if (log.count > 0) assert_non_null(strstr(log.last, text));
      mpm_scene_end(&c.s);
    }
}

/* Warnings of a column at rest under water to its surface, beside a body or a frictional side. */
static int count_friction(int32_t scheme, int32_t method, bool wall, double friction, char *last,
                          size_t size) {
  journal log = {0};
  scoped_context *own = journal_context(&log, NULL);
  pore_column c = pore_column_begin(own, MPS_MPM_GEOMETRY_PLANE_STRAIN, 8.0, 10.0, 10.0);
  DEF(pore_water, water, .porosity = 0.4, .permeability = 1e-3, .scheme = scheme);
  const double top[] = {0.0, 1.0}, across[] = {1.0, 0.0};
  scoped_body *body = NULL;
  OK(mps_mpm_add_pore_water(c.s.mpm, &water));
  OK(mps_mpm_set_pore_level(c.s.mpm, top));
  mpm_scene_weigh(&c.s, 1e4, 0.25, 1.0);
  if (wall) {
    DEF(contact, contact, .friction = friction, .method = method);
    OK(mps_body_create_half_plane(own, NULL, across, &body));
    OK(mps_mpm_add_contact(c.s.mpm, body, &contact, NULL));
  } else
    mpm_scene_side(&c.s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_FRICTIONAL, friction);
  OK(mps_mpm_step(c.s.mpm, 64));
  snprintf(last, size, "%s", log.last);
  mpm_scene_end(&c.s);
  return log.count;
}

/* Friction is of the effective stress (verify/mpm_pore_ground), but that by penalty. */
TEST(friction_by_penalty_where_water_bears_is_warned_of) {
  char last[512];
  for (int32_t scheme = 0; scheme < 2; scheme++) {
    const int32_t penalty = MPS_CONTACT_METHOD_PENALTY, impulse = MPS_CONTACT_METHOD_IMPULSE;
    assert_int_equal(count_friction(scheme, impulse, true, 0.3, last, sizeof last), 0);
    assert_int_equal(count_friction(scheme, impulse, false, 0.3, last, sizeof last), 0);
    assert_int_equal(count_friction(scheme, penalty, true, 0.0, last, sizeof last), 0);
    assert_int_equal(count_friction(scheme, penalty, true, 0.3, last, sizeof last), 1);
    print_message("%s\n", last);
    assert_non_null(strstr(last, "by penalty acts on the total normal stress"));
  }
}

/* ---- what is refused ------------------------------------------------------------------------- */

/* Implicit pressures beside a body thinner than two cells. */
TEST(scenes_without_a_matrix_are_refused) {
  for (int which = 0; which < 2; which++) { /* thin; thick */
    pore_column c = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4.0, 10.0, 0.0);
    DEF(pore_water, water, .porosity = 0.4, .scheme = MPS_PORE_SCHEME_IMPLICIT);
    DEF(body, def, .position[1] = 1.5);
    scoped_contact *contact = NULL;
    OK(mps_mpm_add_pore_water(c.s.mpm, &water));
    MAKE(body, body, create_box, context, &def, 1.0, which == 0 ? 0.3 : 0.6);
    OK(mps_mpm_add_contact(c.s.mpm, body, NULL, &contact));
    const mps_status status = mps_mpm_step(c.s.mpm, 1);
    assert_int_equal(status, which == 0 ? MPS_ERROR_STATE : MPS_OK);
    if (which == 0)
      assert_non_null(strstr(mps_context_error(context)->message, "thinner than 2 cells"));
    assert_int_equal(mps_mpm_steps(c.s.mpm), which == 0 ? 0 : 1);
    mpm_scene_end(&c.s);
  }
}

/* ---- steps that diverge ---------------------------------------------------------------------- */

/* A step that would move particles by more than a cell, or empty their pores, is undone, and with
 * values that can be the run continues as if there had been none. */
TEST(impossible_steps_change_no_bit) {
  for (int32_t scheme = MPS_PORE_SCHEME_EXPLICIT; scheme <= MPS_PORE_SCHEME_IMPLICIT; scheme++)
    for (int which = 0; which < 2; which++) { /* a fast particle; all of them towards the floor */
      const bool no = false;
      touchy a = touchy_begin(scheme, &no), b = touchy_begin(scheme, &no);
      mps_edit edit;
      OK(mps_mpm_step(a.s.mpm, 8));
      OK(mps_mpm_step(b.s.mpm, 8));
      const double dt = mps_mpm_dt(b.s.mpm), fast = which == 0 ? 1e5 : 1e4;
      OK(mps_mpm_set_dt(a.s.mpm, dt));
      OK(mps_mpm_set_dt(b.s.mpm, dt));
      mps_view v = view_field(a.s.particles, "velocity");
      OK(mps_particles_edit(b.s.particles, "velocity", &edit));
      for (int64_t k = 0; k < v.shape[0]; k++)
        if (which == 1 || k == v.shape[0] / 2) *mps_edit_f64(&edit, k, 1) = -fast;
      OK(mps_particles_commit(b.s.particles, &edit));
      const double time = mps_mpm_time(b.s.mpm);
      const mps_status status = mps_mpm_step(b.s.mpm, 1);
      print_message("%s\n", mps_context_error(context)->message);
      if (which == 0) /* else the law of the caller may be the first that cannot go on */
        assert_int_equal(status, MPS_ERROR_DIVERGED);
      else
        assert_true(status == MPS_ERROR_DIVERGED || status == MPS_ERROR_NUMERIC);
      assert_int_equal(mps_mpm_steps(b.s.mpm), 8);
      assert_true(mps_mpm_time(b.s.mpm) == time);
      OK(mps_particles_edit(b.s.particles, "velocity", &edit));
      for (int64_t k = 0; k < v.shape[0]; k++)
        for (int c = 0; c < 2; c++) *mps_edit_f64(&edit, k, c) = *mps_view_f64(&v, k, c);
      OK(mps_particles_commit(b.s.particles, &edit));
      assert_same(&a.s, &b.s);
      OK(mps_mpm_step(a.s.mpm, 5));
      OK(mps_mpm_step(b.s.mpm, 5));
      assert_same(&a.s, &b.s);
      touchy_end(&a);
      touchy_end(&b);
    }
}
