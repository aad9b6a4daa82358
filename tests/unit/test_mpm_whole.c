/* test_mpm_whole.c - a step of WLS-MPM is whole or has not happened: one that a law refuses leaves
 * all as before it, bit for bit, and one in which a particle leaves the domain is complete, and the
 * solver continues when that particle is put back or removed.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_twins.h"
#include "test_fixture.h"

/* ---- a law that refuses ---------------------------------------------------------------------- */

/* A law that stiffens with the work it has seen; it refuses particle `id` when it has written. */
typedef struct touchy {
  int64_t id; /* -1: never */
} touchy;

static mps_status update(void *user, const mps_material_block *b) {
  const touchy *t = user;
  const double modulus = 1e5;
  mps_status status = MPS_OK;
  for (int64_t k = 0; k < b->count; k++) {
    for (int c = 0; c < 2 * b->dim; c++) { /* of the diagonal alone, and of xy */
      const int diagonal = c < 3 ? 4 * c : 1;
      const double rate = b->gradient[diagonal] ? b->gradient[diagonal][k] : 0.0;
      b->stress[c][k] += modulus * b->dt * rate;
    }
    b->history[0][k] += b->dt * b->stress[0][k];
    b->volume_ratio[k] *= 1.0 + 1e-9;
    if (b->ids[k] != t->id) continue;
    *b->refused = k;
    status = MPS_ERROR_NUMERIC;
  }
  return status;
}

static mps_material *law_of(mps_context *own, touchy *t) {
  static const char *const names[] = {"work"};
  DEF(material_user, law, .update = update, .user = t, .name = "touchy", .wave_modulus = 1.5e5,
      .history_count = 1, .history = names, .needs_deformation = 1);
  MAKE_KEPT(material, out, create_user, own, &law);
  return out;
}

static scene held_scene(mps_context *own, const mps_mpm_def *def, touchy *t) {
  int32_t box, loads[2];
  scene x = {.s = held_begin_with(own, def, &box, loads)};
  scoped_material *law = law_of(own, t);
  OK(mps_mpm_set_material(x.s.mpm, law, NULL, 0));
  return x;
}

static void same_totals(scene *a, scene *b) {
  mps_totals t[2];
  memset(t, 0, sizeof t);
  OK(mps_mpm_get_totals(a->s.mpm, &t[0]));
  OK(mps_mpm_get_totals(b->s.mpm, &t[1]));
  assert_memory_equal(&t[0], &t[1], sizeof t[0]);
}

/* A step that did not happen may have sorted the particles. */
static void same_state(scene *a, scene *b) {
  assert_same_by_id(a->s.particles, b->s.particles, "");
  if (a->body[DRIVEN])
    same_bodies(a, b);
  else
    same_forces(a, b);
  assert_true(mps_mpm_time(a->s.mpm) == mps_mpm_time(b->s.mpm));
  assert_true(mps_mpm_dt(a->s.mpm) == mps_mpm_dt(b->s.mpm));
}

static scene scene_with_bodies(mps_context *own, int32_t geometry, touchy *t) {
  scene x = build(own, geometry, &none);
  scoped_material *law = law_of(own, t);
  OK(mps_mpm_set_material(x.s.mpm, law, NULL, 0));
  return x;
}

/* With boundaries of all kinds, or with bodies. */
static void refuses(const mps_mpm_def *def, int32_t threads, bool bodies) {
  scoped_context *own = on_threads(&threads);
  touchy never = {-1}, now = {-1};
  SCOPED(drop)
  scene x = bodies ? scene_with_bodies(own, def->geometry, &now) : held_scene(own, def, &now);
  scene twin =
      bodies ? scene_with_bodies(own, def->geometry, &never) : held_scene(own, def, &never);
  for (int round = 0; round < (bodies ? 12 : 3); round++) {
    OK(mps_mpm_step(x.s.mpm, 9));
    OK(mps_mpm_step(twin.s.mpm, 9));
    same_totals(&x, &twin);     /* sums in the same order */
    now.id = 100 * (round % 7); /* of another block each time */
    for (int again = 0; again < 2; again++) {
      FAILS_ON(own, mps_mpm_step(x.s.mpm, 1), MPS_ERROR_NUMERIC, "'touchy' has refused");
      assert_int_equal(mps_context_error(own)->particle, now.id);
      same_state(&x, &twin);
    }
    now.id = -1;
  }
  OK(mps_mpm_step(x.s.mpm, 9));
  OK(mps_mpm_step(twin.s.mpm, 9));
  same_state(&x, &twin);
  same_totals(&x, &twin);
  if (bodies) {
    mps_reaction r;
    OK(mps_body_get_reaction(x.body[DRIVEN], -1, &r));
    assert_true(r.impulse[1] != 0.0);
  }
  drop(&twin);
}

TEST(a_refused_step_has_not_happened) {
  DEF(mpm, def, .budget = 1);
  refuses(&def, 1, false);
  refuses(&def, 3, false);
  def.volumetric = MPS_MPM_VOLUMETRIC_CELL;
  refuses(&def, 2, false);
  def = mps_mpm_defaults();
  refuses(&def, 2, true);
  def.geometry = MPS_MPM_GEOMETRY_SPACE;
  refuses(&def, 2, false);
}

/* ---- a particle that leaves ------------------------------------------------------------------ */

/* Soil that flies towards the free end of the domain. */
static mpm_scene flying(int32_t volumetric) {
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.1, 0.1, 0.28, 0.2);
  OK(mps_particles_set(s.particles, "velocity", 0, 3.0));
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .volumetric = volumetric,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = 0.3, .upper[1] = 0.4);
  mpm_scene_side(&s, MPS_SIDE_X_UPPER, MPS_BOUNDARY_FREE, 0.0);
  return s;
}

/* Steps until a particle is lost; its id. Everything has moved in that step. */
static int64_t lose_one(mpm_scene *s) {
  mps_status status = MPS_OK;
  double before[400], time = 0.0;
  int64_t steps = 0;
  while (status == MPS_OK && steps < 1000) {
    mps_view x = mpm_scene_view(s, "position"), id = mpm_scene_view(s, "id");
    for (int64_t k = 0; k < x.shape[0]; k++)
      before[*mps_view_i64(&id, k, 0)] = *mps_view_f64(&x, k, 0);
    time = mps_mpm_time(s->mpm), steps = mps_mpm_steps(s->mpm);
    status = mps_mpm_step(s->mpm, 1);
  }
  assert_int_equal(status, MPS_ERROR_DIVERGED);
  assert_non_null(strstr(mps_context_error(context)->message, "has left the domain"));
  const int64_t lost = mps_context_error(context)->particle;
  assert_int_equal(mps_mpm_steps(s->mpm), steps + 1);
  const double dt = mps_mpm_time(s->mpm) - time;
  mps_view x = mpm_scene_view(s, "position"), id = mpm_scene_view(s, "id");
  mps_view v = mpm_scene_view(s, "velocity");
  for (int64_t k = 0; k < x.shape[0]; k++)
    NEAR(*mps_view_f64(&x, k, 0), before[*mps_view_i64(&id, k, 0)] + dt * *mps_view_f64(&v, k, 0),
         1e-14);
  return lost;
}

static void no_step_until_it_is_mended(mpm_scene *s) {
  mps_snapshot *snapshot = NULL;
  const int64_t steps = mps_mpm_steps(s->mpm);
  const double point[3] = {0.2, 0.15, 0.0};
  double value[2];
  FAILS(mps_mpm_step(s->mpm, 1), MPS_ERROR_STATE, "edit its position");
  FAILS(mps_mpm_run(s->mpm, 9.0, 1, NULL, NULL), MPS_ERROR_STATE, "outside the domain");
  FAILS(mps_mpm_snapshot(s->mpm, &snapshot), MPS_ERROR_STATE, "edit its");
  FAILS(mps_grid_evaluate(mps_mpm_grid(s->mpm), "velocity", -1, 1, point, value, NULL),
        MPS_ERROR_STATE, "outside the domain");
  assert_int_equal(mps_mpm_steps(s->mpm), steps);
}

TEST(a_step_that_loses_a_particle_is_whole) {
  for (int32_t by_cell = 0; by_cell < 2; by_cell++) {
    scoped_mpm_scene s = flying(by_cell ? MPS_MPM_VOLUMETRIC_CELL : MPS_MPM_VOLUMETRIC_POINT);
    scoped_snapshot *snapshot = NULL;
    mps_totals t;
    OK(mps_mpm_snapshot(s.mpm, &snapshot));
    lose_one(&s);
    OK(mps_mpm_get_totals(s.mpm, &t));
    NEAR(t.linear[0], 180 * 0.1 * 3.0, 1e-12 * 54.0); /* free flight: all have it */
    no_step_until_it_is_mended(&s);
    EDIT(x, s.particles, "position")
      for (int64_t k = 0; k < x.view.shape[0]; k++)
        if (*mps_view_f64(&x.view, k, 0) > 0.3) *mps_edit_f64(&x, k, 0) = 0.2999;
    OK(mps_mpm_step(s.mpm, 1));               /* put back by hand */
    for (int round = 0; round < 3; round++) { /* taken away */
      lose_one(&s);
      int64_t outside[400], count;
      const double lo[2] = {0.3, -9.0}, hi[2] = {9.0, 9.0};
      OK(mps_particles_select_box(s.particles, lo, hi, 400, &count, outside));
      assert_true(count > 0);
      OK(mps_particles_remove(s.particles, outside, count));
      OK(mps_mpm_step(s.mpm, 1));
    }
    lose_one(&s);
    OK(mps_mpm_rollback(s.mpm, snapshot)); /* or forgotten */
    assert_int_equal(mps_particles_count(s.particles), 180);
    OK(mps_mpm_step(s.mpm, 1));
  }
}
