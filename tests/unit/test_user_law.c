/* test_user_law.c - a law of the caller's own in the WLS-MPM solver: its block, its history, and
 * its failures. SPDX-License-Identifier: BSD-3-Clause */
#include "material/material_internal.h"
#include "mpm_scene.h"
#include "pthread_executor.h"

#define G 2e4
#define K 5e4 /* Pa */

/* ---- a law ----------------------------------------------------------------------------------- */

enum { MOST = 40, PARTICLES = 400 };

/* Its arguments, by id; each particle is written by one thread. */
typedef struct seen {
  double x[PARTICLES][2], temperature[PARTICLES], time[PARTICLES];
  int64_t bad; /* id that it refuses, or -1 */
  double from; /* s, the time from which it does */
} seen;

/* Elastic of small strain; each column c of history counts steps by c + 1. */
static mps_status elastic(void *user, const mps_material_block *b) {
  seen *s = user;
  for (int64_t k = 0; k < b->count; k++) {
    const double xx = b->dt * b->gradient[0][k], yy = b->dt * b->gradient[4][k];
    const double xy = 0.5 * b->dt * (b->gradient[1][k] + b->gradient[3][k]);
    const double trace = (K - 2.0 / 3.0 * G) * (xx + yy);
    b->stress[0][k] += trace + 2.0 * G * xx;
    b->stress[1][k] += trace + 2.0 * G * yy;
    b->stress[2][k] += trace;
    b->stress[3][k] += 2.0 * G * xy;
    for (int32_t c = 0; c < b->history_count; c++) b->history[c][k] += c + 1;
    if (!s) continue;
    const int64_t id = b->ids[k];
    for (int c = 0; c < 2; c++) s->x[id][c] = b->position[c][k];
    s->temperature[id] = b->temperature ? b->temperature[k] : -1.0;
    s->time[id] = b->time;
    if ((id == s->bad || id == s->bad + 150) && b->time > s->from) {
      snprintf(b->message, (size_t)b->message_size, "stretch %g", 1.5);
      *b->refused = k;
      return MPS_ERROR_DIVERGED;
    }
  }
  return MPS_OK;
}

static mps_material *make_law(mps_context *context, const char *name, int32_t columns,
                              const char *const *names, seen *s) {
  DEF(material_user, def, .update = elastic, .user = s, .name = name, .history_count = columns,
      .history = names, .wave_modulus = K + 4.0 / 3.0 * G);
  MAKE_KEPT(material, out, create_user, context, &def);
  return out;
}

/* A block of 20 x 20 particles that falls apart slowly; takes the law over. */
static mpm_scene begin(mps_context *context, mps_material *law, bool warm) {
  mpm_scene s = mpm_scene_begin_in(context, 2, 0.01, 0.0, 0.0, 1e5);
  mps_material_destroy(&s.material);
  s.material = law;
  mpm_scene_box(&s, 0.1, 0.1, 0.3, 0.3);
  const double v0[] = {0.2, -0.1}, L[] = {0.5, -2.0, 2.0, -0.3};
  mpm_scene_affine(&s, v0, L);
  if (warm) {
    OK(mps_particles_add_field(s.particles, "temperature", 0));
    mps_view id = mpm_scene_view(&s, "id");
    EDIT(T, s.particles, "temperature")
      for (int64_t k = 0; k < T.view.shape[0]; k++)
        *mps_edit_f64(&T, k, 0) = 280.0 + (double)*mps_view_i64(&id, k, 0);
  }
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02);
  return s;
}

/* ---- members of a block ---------------------------------------------------------------------- */

TEST_SERIAL(a_block_tells_ids_places_time_and_temperature) {
  for (int warm = 0; warm < 2; warm++) {
    static seen told;
    told = (seen){.bad = -1000};
    scoped_mpm_scene s = begin(context, make_law(context, "spy", 0, NULL, &told), warm);
    OK(mps_mpm_step(s.mpm, 30)); /* sorted by now */
    mps_view x = mpm_scene_view(&s, "position");
    assert_int_equal(x.shape[0], PARTICLES);
    for (int64_t id = 0; id < PARTICLES; id++) {
      const int64_t k = mps_particles_index(s.particles, id);
      for (int c = 0; c < 2; c++) NEAR(told.x[id][c], *mps_view_f64(&x, k, c), 0.0);
      NEAR(told.temperature[id], warm ? 280.0 + (double)id : -1.0, 0.0);
      NEAR(told.time[id], mps_mpm_time(s.mpm), 1e-15);
    }
  }
}

/* ---- history --------------------------------------------------------------------------------- */

static void same_column(mpm_scene *a, mpm_scene *b, const char *name) {
  mps_view va = mpm_scene_view(a, name), vb = mpm_scene_view(b, name);
  for (int64_t k = 0; k < va.shape[0]; k++)
    for (int64_t c = 0; c < va.shape[1]; c++)
      assert_memory_equal(mps_view_f64(&va, k, c), mps_view_f64(&vb, k, c), 8);
}

/* A column called as a field of the library is neither that field nor disturbs it. */
TEST_SERIAL(names_of_the_field_table_do_no_harm) {
  static const char *const table[] = {"group",  "volume",   "density", "mass",
                                      "stress", "velocity", "id",      "position"};
  static const char *const plain[] = {"a", "b", "c", "d", "e", "f", "g", "h"};
  scoped_mpm_scene x = begin(context, make_law(context, "clay", 8, table, NULL), false);
  scoped_mpm_scene y = begin(context, make_law(context, "clay", 8, plain, NULL), false);
  OK(mps_mpm_step(x.mpm, 50));
  OK(mps_mpm_step(y.mpm, 50));
  same_column(&x, &y, "position");
  same_column(&x, &y, "stress");
  same_column(&x, &y, "volume");
  same_column(&x, &y, "mass");
  same_column(&x, &y, "density");
  mps_view group = mpm_scene_view(&x, "clay.group");
  NEAR(*mps_view_f64(&group, 7, 0), 50.0, 0.0);
  assert_string_equal(mpsi_material_history_field(x.material, 3), "clay.mass");
  assert_string_equal(mps_material_history_name(x.material, 3), "mass");
  assert_null(mpsi_material_history_field(x.material, 8));
  assert_null(mpsi_material_history_field(NULL, 0));
  mps_view mass = mpm_scene_view(&x, "mass");
  NEAR(*mps_view_f64(&mass, 0, 0), 1000.0 * 1e-4, 1e-12);
}

/* Two laws with a column of the same name, and a caller's field so called. */
TEST_SERIAL(laws_do_not_share_columns) {
  static const char *const names[] = {"damage"};
  scoped_mpm_scene s = begin(context, make_law(context, "clay", 1, names, NULL), false);
  scoped_material *silt = make_law(context, "silt", 1, names, NULL);
  OK(mps_particles_add_field(s.particles, "user.damage", 3));
  const int64_t ids[] = {5};
  OK(mps_mpm_set_material(s.mpm, silt, ids, 1));
  OK(mps_mpm_step(s.mpm, 10));
  mps_view a = mpm_scene_view(&s, "clay.damage"), b = mpm_scene_view(&s, "silt.damage");
  for (int64_t id = 0; id < PARTICLES; id++) {
    const int64_t k = mps_particles_index(s.particles, id);
    NEAR(*mps_view_f64(&a, k, 0), id == 5 ? 0.0 : 10.0, 0.0);
    NEAR(*mps_view_f64(&b, k, 0), id == 5 ? 10.0 : 0.0, 0.0);
  }
}

TEST_SERIAL(histories_may_be_long) {
  static char text[MOST][8];
  const char *names[MOST];
  for (int c = 0; c < MOST; c++) {
    snprintf(text[c], sizeof text[c], "h%d", c);
    names[c] = text[c];
  }
  mps_material *law = make_law(context, "long", MOST, names, NULL);
  mps_material_point point;
  const double rest[9] = {0.0};
  OK(mps_material_point_init(context, law, &point));
  OK(mps_material_point_drive(context, law, &point, rest, 1.0, 10));
  NEAR(point.history[MOST - 1], 400.0, 0.0); /* as in the solver below */
  scoped_mpm_scene s = begin(context, law, false);
  OK(mps_mpm_step(s.mpm, 10));
  mps_view last = mpm_scene_view(&s, "long.h39");
  for (int64_t k = 0; k < PARTICLES; k++) NEAR(*mps_view_f64(&last, k, 0), 400.0, 0.0);
}

/* ---- refusals -------------------------------------------------------------------------------- */

/* The status, the words and the particle reach the caller, from whichever thread. */
TEST(a_refusal_names_the_particle) {
  int64_t told_first = -1;
  for (int32_t threads = 1; threads <= 4; threads++) {
    mps_context_def own = pthread_executor_def(&threads);
    scoped_context *context = NULL;
    assert_int_equal(mps_context_create(&own, &context, NULL, 0), MPS_OK);
    static seen told;
    told = (seen){.bad = 30, .from = 0.01}; /* and 180, in another block */
    scoped_mpm_scene s = begin(context, make_law(context, "touchy", 0, NULL, &told), false);
    FAILS(mps_mpm_run(s.mpm, 1.0, 1, NULL, NULL), MPS_ERROR_DIVERGED,
          "the law 'touchy' has refused particle ");
    const mps_error *error = mps_context_error(context);
    assert_non_null(strstr(error->message, ": stretch 1.5"));
    assert_true(error->particle == 30 || error->particle == 180);
    assert_true(error->step > 0); /* the step that it refused has not happened */
    const double time = mps_mpm_time(s.mpm);
    assert_true(time <= 0.01 && time + mps_mpm_dt(s.mpm) > 0.01);
    if (told_first < 0) told_first = error->particle;
    assert_int_equal(error->particle, told_first);
    told.bad = -1000;
    OK(mps_mpm_step(s.mpm, 1)); /* it refuses no more */
  }
}

/* Time, steps and shortest remainder of a run whose only step is refused are as before it. */
TEST_SERIAL(a_run_that_is_refused_takes_no_time) {
  static seen told;
  told = (seen){.bad = 30, .from = -1.0};
  scoped_mpm_scene s = begin(context, make_law(context, "touchy", 0, NULL, &told), false);
  const double t_end = 0.5 * mps_mpm_dt(s.mpm);
  FAILS(mps_mpm_run(s.mpm, t_end, 1, NULL, NULL), MPS_ERROR_DIVERGED, "has refused particle ");
  assert_int_equal(mps_mpm_steps(s.mpm), 0);
  NEAR(mps_mpm_time(s.mpm), 0.0, 0.0);
  told.bad = -1000;
  OK(mps_mpm_run(s.mpm, t_end, 1, NULL, NULL));
  assert_int_equal(mps_mpm_steps(s.mpm), 1);
  NEAR(mps_mpm_time(s.mpm), t_end, 0.0);
}

/* A result of no bytes is refused before anything is settled. */
TEST_SERIAL(settling_looks_at_its_result_first) {
  static seen told;
  told = (seen){.bad = -1000};
  scoped_mpm_scene s = begin(context, make_law(context, "mild", 0, NULL, &told), false);
  DEF(mpm_settle, def, .max_steps = 2);
  mps_mpm_settled out;
  const double kinetic = mpm_scene_totals(&s).kinetic;
  REFUSES(mps_mpm_settle_sized(s.mpm, &def, &out, 0), "size is 0");
  assert_int_equal(mps_mpm_steps(s.mpm), 0);
  NEAR(mpm_scene_totals(&s).kinetic, kinetic, 0.0);
}

static int32_t cancel_third(void *user) { return ++*(int *)user >= 3; }

/* Settling that was cut leaves particles that move; a step starts them from rest, if it happens. */
TEST_SERIAL(a_refused_step_leaves_settling_as_it_was_cut) {
  static seen told;
  told = (seen){.bad = -1000};
  scoped_mpm_scene s = begin(context, make_law(context, "touchy", 0, NULL, &told), false);
  int asked = 0;
  OK(mps_particles_set(mps_mpm_particles(s.mpm), "external_force", 1, -0.1));
  DEF(mpm_settle, def, .max_steps = 100);
  mps_context_set_cancel(context, cancel_third, &asked, NULL);
  FAILS(mps_mpm_settle(s.mpm, &def, NULL), MPS_ERROR_CANCELLED, "cancel");
  mps_context_set_cancel(context, NULL, NULL, NULL);
  const mps_totals before = mpm_scene_totals(&s);
  assert_true(before.kinetic > 0.0);
  told.bad = 30, told.from = -1.0;
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_DIVERGED, "has refused particle ");
  const mps_totals after = mpm_scene_totals(&s);
  assert_memory_equal(&after, &before, sizeof after);
}
