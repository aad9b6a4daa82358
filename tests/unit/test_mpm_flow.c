/* test_mpm_flow.c - particles come and go while a WLS-MPM solver lives: balances, threads, the same
 * results as from a solver made afresh, the way back, and what is refused.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_twins.h"
#include "test_allocator.h"

enum { MOST = 10000 };

/* Ids of the particles from y on. */
static int64_t above(mps_particles *set, double y, int64_t *ids) {
  const double lo[3] = {-INFINITY, y, -INFINITY}, hi[3] = {INFINITY, INFINITY, INFINITY};
  int64_t count = 0;
  assert_int_equal(mps_particles_select_box(set, lo, hi, MOST, &count, ids), MPS_OK);
  assert_true(count <= MOST);
  return count;
}

static const double *column(mps_particles *set, const char *name, int32_t component, mps_view *v) {
  assert_int_equal(mps_particles_view(set, name, v), MPS_OK);
  return mps_view_f64(v, 0, component);
}

/* ---- balances -------------------------------------------------------------------------------- */

/* Without particles nothing bounds the step that follows the limit, and its impulses. */
TEST_SERIAL(nothing_settles_where_no_particle_is) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  DEF(mpm, def, .cell = 0.02, .gravity[1] = -9.81);
  int64_t ids[MOST];
  mps_reaction side;
  def.lower[0] = def.lower[1] = 0.0;
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  mpm_scene_solve(&s, &def);
  OK(mps_mpm_step(s.mpm, 3));
  OK(mps_particles_remove(s.particles, ids, above(s.particles, -1.0, ids)));
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "no particles, and nothing bounds dt");
  FAILS(mps_mpm_settle(s.mpm, NULL, NULL), MPS_ERROR_STATE, "no particles, and nothing bounds dt");
  assert_int_equal(mps_mpm_steps(s.mpm), 3);
  OK(mps_mpm_get_reaction(s.mpm, MPS_SIDE_Y_LOWER, &side));
  assert_true(isfinite(side.impulse[1]) && isfinite(side.work));
}

TEST_SERIAL(erosion_of_half_a_column_takes_its_mass_and_momentum) {
  SCOPED(drop) scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  int64_t ids[MOST];
  OK(mps_mpm_step(x.s.mpm, 100));
  const int64_t count = above(x.s.particles, 0.18, ids);
  const mps_totals before = mpm_scene_totals(&x.s);
  double mass = 0.0, momentum[2] = {0.0, 0.0}, former[2 * MOST];
  mps_view v, w;
  const double *m = column(x.s.particles, "mass", 0, &v);
  mps_view velocity = mpm_scene_view(&x.s, "velocity");
  for (int64_t k = 0; k < count; k++) {
    const int64_t at = mps_particles_index(x.s.particles, ids[k]);
    mass += m[at];
    for (int c = 0; c < 2; c++) momentum[c] += m[at] * *mps_view_f64(&velocity, at, c);
  }
  const double *stress = column(x.s.particles, "stress", 1, &w);
  for (int64_t id = 0; id < 800; id++) {
    const int64_t at = mps_particles_index(x.s.particles, id);
    former[2 * id] = stress[at], former[2 * id + 1] = m[at];
  }
  OK(mps_particles_remove(x.s.particles, ids, count));
  const mps_totals after = mpm_scene_totals(&x.s);
  assert_in_range(count, 300, 500);
  NEAR(after.mass, before.mass - mass, 1e-13 * before.mass);
  for (int c = 0; c < 2; c++)
    NEAR(after.linear[c], before.linear[c] - momentum[c], 1e-12 * before.mass);
  stress = column(x.s.particles, "stress", 1, &w), m = column(x.s.particles, "mass", 0, &v);
  for (int64_t id = 0; id < 800; id++) { /* remaining particles are unchanged */
    const int64_t at = mps_particles_index(x.s.particles, id);
    if (at >= 0) assert_true(stress[at] == former[2 * id] && m[at] == former[2 * id + 1]);
  }
  OK(mps_mpm_step(x.s.mpm, 100));
  NEAR(mpm_scene_totals(&x.s).mass, after.mass, 1e-13 * after.mass);
}

/* A column of 1 m x 0.2 m between rollers. */
static mpm_scene soil(mps_context *context, double height) {
  mpm_scene s = mpm_scene_begin(context, 0.025, 0.0, 0.0, 1e6);
  DEF(mpm, def, .cell = 0.05, .lower[0] = def.lower[1] = 0.0, .upper[0] = 0.2, .gravity[1] = -10.0);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, height);
  mpm_scene_solve(&s, &def);
  return s;
}

/* Steps, and now and then takes a part of the velocities away. */
static void settle(mpm_scene *s, int times) {
  for (int k = 0; k < times; k++) {
    OK(mps_mpm_step(s->mpm, 10));
    EDIT(v, s->particles, "velocity")
      for (int64_t i = 0; i < v.view.shape[0]; i++)
        for (int c = 0; c < 2; c++) *mps_edit_f64(&v, i, c) *= 0.7;
  }
}

TEST_SERIAL(a_fed_column_bears_its_weight) {
  scoped_mpm_scene fed = soil(context, 0.25), whole = soil(context, 1.0);
  for (int layer = 0; layer < 6; layer++) {
    int64_t added = 0;
    OK(mps_particles_fill_box(fed.particles, AT(0.0, 0.25 + 0.125 * layer),
                              AT(0.2, 0.25 + 0.125 * layer + 0.125), &added));
    assert_int_equal(added, 40);
    OK(mps_particles_set(fed.particles, "density", 0, 1000.0));
    settle(&fed, 10);
  }
  settle(&fed, 60);
  settle(&whole, 60);
  mps_view x = mpm_scene_view(&fed, "position"), stress = mpm_scene_view(&fed, "stress");
  mps_view other = mpm_scene_view(&whole, "stress");
  assert_int_equal(x.shape[0], 320);
  NEAR(mpm_scene_totals(&fed).mass, 200.0, 1e-11);
  double worst = 0.0, apart = 0.0;
  for (int64_t id = 0; id < 320; id++) {
    const int64_t k = mps_particles_index(fed.particles, id);
    const int64_t q = mps_particles_index(whole.particles, id);
    const double y = 0.025 * ((double)(id / 8) + 0.5); /* small strains: where it has been put */
    const double error = *mps_view_f64(&stress, k, 1) + 1e4 * (1.0 - y);
    worst = fmax(worst, fabs(error));
    apart = fmax(apart, fabs(*mps_view_f64(&stress, k, 1) - *mps_view_f64(&other, q, 1)));
  }
  if (!(worst < 200.0) || !(apart < 200.0))
    fail_msg("stress is %g Pa from rho g (H - y), %g Pa from that of a column made whole", worst,
             apart);
}

/* ---- bits ------------------------------------------------------------------------------------ */

/* Some go and some come, at rest below what is there or with a velocity of their own. */
static void change_some(scene *x) {
  mps_particles *set = x->s.particles;
  int64_t ids[MOST], some = 0;
  const int64_t count = above(set, 0.12, ids), first = mps_particles_count(set);
  for (int64_t k = 0; k < count; k += 7) ids[some++] = ids[k];
  OK(mps_particles_remove(set, ids, some));
  int64_t added = 0;
  OK(mps_particles_fill_box(set, AT(0.5, 0.1, 0.02), AT(0.6, 0.2, 0.12), &added));
  OK(mps_particles_set(set, "density", 0, 1500.0));
  assert_true(added >= 100 && some > 20);
  EDIT(v, set, "velocity")
    for (int64_t k = first - some; k < v.view.shape[0]; k++) *mps_edit_f64(&v, k, 0) = -1.0;
}

TEST(same_bits_on_any_threads) {
  int32_t threads[3] = {1, 2, 3};
  scene x[3];
  mps_context *context[3];
  for (int t = 0; t < 3; t++) {
    context[t] = on_threads(&threads[t]);
    change c = none;
    c.spacing = 0.005, c.cell = 0.01; /* many enough to share */
    x[t] = build(context[t], MPS_MPM_GEOMETRY_PLANE_STRAIN, &c);
    OK(mps_mpm_step(x[t].s.mpm, 20));
    change_some(&x[t]);
    OK(mps_mpm_step(x[t].s.mpm, 20));
    assert_true(mps_particles_count(x[t].s.particles) > 2500);
    if (t > 0) same(&x[t], &x[0]);
  }
  for (int t = 0; t < 3; t++) {
    drop(&x[t]);
    mps_context_destroy(&context[t]);
  }
}

/* A column, some of it removed before the first step; and one that never had it. */
TEST_SERIAL(what_remains_moves_as_if_made_so) {
  scoped_mpm_scene eroded = soil(context, 1.0), fresh = soil(context, 0.5);
  int64_t ids[MOST];
  const int64_t count = above(eroded.particles, 0.5, ids);
  OK(mps_particles_remove(eroded.particles, ids, count));
  for (int k = 0; k < 3; k++) {
    OK(mps_mpm_step(eroded.mpm, 50));
    OK(mps_mpm_step(fresh.mpm, 50));
    scene a = {.s = eroded}, b = {.s = fresh};
    same_fields(&a, &b);
  }
  /* And one that got it after it was made, once all is in its place. */
  scoped_mpm_scene grown = soil(context, 0.5), whole = soil(context, 1.0);
  OK(mps_particles_fill_box(grown.particles, AT(0.0, 0.5), AT(0.2, 1.0), NULL));
  OK(mps_particles_set(grown.particles, "density", 0, 1000.0));
  for (int k = 0; k < 3; k++) {
    OK(mps_mpm_step(grown.mpm, 50));
    OK(mps_mpm_step(whole.mpm, 50));
    scene a = {.s = grown}, b = {.s = whole};
    same_fields(&a, &b);
  }
}

/* The way back crosses insertions and removals; a step repeated gives the particles that come again
 * the ids that they had. */
static void goes_back_across(int32_t geometry, int32_t threads) {
  scoped_context *context = on_threads(&threads);
  SCOPED(drop) scene x = build(context, geometry, &none), twin = build(context, geometry, &none);
  scoped_snapshot *start = NULL, *later = NULL;
  OK(mps_mpm_step(x.s.mpm, 10));
  OK(mps_mpm_step(twin.s.mpm, 10));
  OK(mps_mpm_snapshot(x.s.mpm, &start));
  for (int k = 0; k < 2; k++) {
    change_some(&x);
    OK(mps_mpm_step(x.s.mpm, 10));
    if (k == 0) OK(mps_mpm_rollback(x.s.mpm, start));
    if (k == 0) same(&x, &twin);
  }
  change_some(&twin);
  OK(mps_mpm_step(twin.s.mpm, 10));
  same(&x, &twin);
  OK(mps_mpm_snapshot(x.s.mpm, &later));
  OK(mps_mpm_rollback(x.s.mpm, start)); /* to and fro */
  OK(mps_mpm_step(x.s.mpm, 5));
  OK(mps_mpm_rollback(x.s.mpm, later));
  same(&x, &twin);
  int64_t ids[MOST];
  const int64_t count = above(x.s.particles, 0.0, ids);
  OK(mps_particles_remove(x.s.particles, ids, count)); /* all */
  OK(mps_mpm_rollback(x.s.mpm, later));
  OK(mps_mpm_step(x.s.mpm, 5));
  OK(mps_mpm_step(twin.s.mpm, 5));
  same(&x, &twin);
}

TEST(goes_back_across_what_came_and_went) {
  goes_back_across(MPS_MPM_GEOMETRY_PLANE_STRAIN, 1);
  goes_back_across(MPS_MPM_GEOMETRY_AXISYMMETRIC, 2);
  goes_back_across(MPS_MPM_GEOMETRY_SPACE, 3);
}

/* ---- what new particles are ------------------------------------------------------------------ */

TEST_SERIAL(new_particles_take_material_volume_and_mass) {
  scoped_mpm_scene s = soil(context, 0.5);
  DEF(material_von_mises, def, .young = 1e6, .poisson = 0.3, .yield_stress = 1e3);
  MAKE(material, clay, create_von_mises, context, &def);
  OK(mps_mpm_step(s.mpm, 30));
  const double places[4] = {0.05, 0.7, 0.15, 0.7};
  OK(mps_particles_append(s.particles, 2, places));
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "particle 160 has come since");
  assert_int_equal(mps_context_error(context)->particle, 160);
  mps_snapshot *snapshot = NULL;
  FAILS(mps_mpm_snapshot(s.mpm, &snapshot), MPS_ERROR_STATE, "has density 0");
  const int64_t last[1] = {161};
  OK(mps_mpm_set_material(s.mpm, clay, last, 1));
  mps_view mass;
  mps_edit rho, volume;
  const double heavy = column(s.particles, "mass", 0, &mass)[3];
  OK(mps_particles_edit(s.particles, "density", &rho));
  const int64_t a = mps_particles_index(s.particles, 160),
                b = mps_particles_index(s.particles, 161);
  *mps_edit_f64(&rho, a, 0) = 2000.0;
  *mps_edit_f64(&rho, b, 0) = 1e13;
  REFUSES(mps_particles_commit(s.particles, &rho), "of particle 161");
  *mps_edit_f64(&rho, b, 0) = 3000.0;
  OK(mps_particles_commit(s.particles, &rho));
  NEAR(*mps_view_f64(&mass, a, 0), 2000.0 * 0.025 * 0.025, 1e-15);
  OK(mps_particles_edit(s.particles, "volume", &volume));
  *mps_edit_f64(&volume, b, 0) = 1e-3;
  OK(mps_particles_commit(s.particles, &volume));
  NEAR(*mps_view_f64(&mass, b, 0), 3.0, 1e-15);
  assert_true(*mps_view_f64(&mass, 3, 0) == heavy); /* deformed, and not written to */
  OK(mps_particles_edit(s.particles, "volume", &volume));
  *mps_edit_f64(&volume, b, 0) = -1.0;
  REFUSES(mps_particles_commit(s.particles, &volume), "of particle 161 is -1 m3");
  *mps_edit_f64(&volume, b, 0) = 0.0; /* the lattice's */
  OK(mps_particles_commit(s.particles, &volume));
  NEAR(*mps_view_f64(&mass, b, 0), 3000.0 * 0.025 * 0.025, 1e-15);
  OK(mps_mpm_step(s.mpm, 5));
  mps_view law = mpm_scene_view(&s, "material");
  const int64_t *number = law.data;
  assert_int_equal(number[mps_particles_index(s.particles, 161)], 1);
  assert_int_equal(number[mps_particles_index(s.particles, 160)], 0);
  NEAR(mpm_scene_totals(&s).mass, 160 * 0.625 + 5 * 0.625, 1e-11);
  /* They fall freely, but for what the others' nodes take. */
  mps_view v = mpm_scene_view(&s, "velocity");
  assert_true(*mps_view_f64(&v, mps_particles_index(s.particles, 160), 1) < 0.0);
}

/* A boundary holds those of its list that there are. */
TEST_SERIAL(held_particles_leave_the_list_and_come_back) {
  scoped_mpm_scene s = soil(context, 0.5);
  const int64_t ids[3] = {150, 151, 152}, gone[2] = {151, 3};
  scoped_snapshot *snapshot = NULL;
  mps_reaction r;
  int32_t number = -1;
  USING(mpm_boundary, mps_mpm_add_boundary(s.mpm, &given, &number), .ids = ids, .id_count = 3);
  OK(mps_mpm_step(s.mpm, 5));
  OK(mps_mpm_snapshot(s.mpm, &snapshot));
  OK(mps_particles_remove(s.particles, gone, 2));
  OK(mps_mpm_step(s.mpm, 1));
  OK(mps_mpm_get_reaction(s.mpm, number, &r));
  assert_int_equal(r.count, 2);
  OK(mps_mpm_rollback(s.mpm, snapshot));
  OK(mps_mpm_step(s.mpm, 1));
  OK(mps_mpm_get_reaction(s.mpm, number, &r));
  assert_int_equal(r.count, 3);
}

/* ---- what is refused ------------------------------------------------------------------------- */

static mps_status meddle(void *user, mps_mpm *mpm) {
  mps_context *context = mps_mpm_context(mpm);
  mps_particles *set = mps_mpm_particles(mpm);
  const double there[2] = {0.5, 0.5};
  const int64_t ids[1] = {5};
  ++*(int *)user;
  FAILS(mps_particles_append(set, 1, there), MPS_ERROR_STATE, "in the callback of mps_mpm_run");
  FAILS(mps_particles_remove(set, ids, 1), MPS_ERROR_STATE, "in the callback of mps_mpm_run");
  return MPS_OK;
}

TEST_SERIAL(refusals_change_nothing) {
  SCOPED(drop)
  scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none),
        twin = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none);
  OK(mps_mpm_step(x.s.mpm, 20));
  OK(mps_mpm_step(twin.s.mpm, 20));
  const double out[4] = {0.7, 0.7, 1.2, 0.7}, within[4] = {0.7, 0.7, 0.1, 0.03};
  const int64_t bad[2] = {7, 4711};
  int calls = 0;
  REFUSES(mps_particles_append(x.s.particles, 2, out), "outside the domain");
  REFUSES(mps_particles_append(x.s.particles, 2, within), "1 particles lie inside");
  REFUSES(mps_particles_fill_box(x.s.particles, AT(0.9, 0.5), AT(1.1, 0.6), NULL), "outside the");
  REFUSES(mps_particles_remove(x.s.particles, bad, 2), "no such particle");
  same(&x, &twin);
  OK(mps_mpm_run(x.s.mpm, mps_mpm_time(x.s.mpm) + 1e-3, 1000, meddle, &calls));
  OK(mps_mpm_run(twin.s.mpm, mps_mpm_time(twin.s.mpm) + 1e-3, 1000, NULL, NULL));
  assert_int_equal(calls, 2);
  same(&x, &twin);
}

/* All may be removed; time continues, and others may be added. */
TEST_SERIAL(an_empty_solver_waits) {
  scoped_mpm_scene s = soil(context, 0.5);
  int64_t ids[MOST];
  OK(mps_mpm_step(s.mpm, 5));
  const int64_t count = above(s.particles, 0.0, ids);
  assert_int_equal(count, 160);
  OK(mps_particles_remove(s.particles, ids, count));
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "no particles");
  OK(mps_mpm_run(s.mpm, 1.0, 1, NULL, NULL));
  NEAR(mps_mpm_time(s.mpm), 1.0, 0.0);
  NEAR(mpm_scene_totals(&s).mass, 0.0, 0.0);
  scoped_snapshot *snapshot = NULL;
  OK(mps_mpm_snapshot(s.mpm, &snapshot));
  const double place[2] = {0.1, 0.9};
  for (int k = 0; k < 2; k++) {
    OK(mps_particles_append(s.particles, 1, place));
    assert_int_equal(mps_particles_nearest(s.particles, place), 160);
    OK(mps_particles_set(s.particles, "density", 0, 500.0));
    OK(mps_mpm_run(s.mpm, 1.1, 1, NULL, NULL));
    mps_view v = mpm_scene_view(&s, "velocity");
    NEAR(*mps_view_f64(&v, 0, 1), -1.0, 1e-12); /* g t */
    if (k == 0) OK(mps_mpm_rollback(s.mpm, snapshot));
  }
}

/* A box is driven into the column: the step that finds a particle too deep has not begun. */
TEST(a_step_that_would_go_too_deep_does_not_begin) {
  int32_t threads = 2;
  scoped_context *context = on_threads(&threads);
  scene x[2];
  mps_contact *contact[2] = {NULL, NULL};
  memset(x, 0, sizeof x);
  for (int k = 0; k < 2; k++) {
    x[k].s = soil(context, 1.0);
    DEF(body, def, .position[0] = 0.1, .position[1] = 1.1);
    DEF(contact, touch, .depth = 0.002, .penalty = 1e4, .method = MPS_CONTACT_METHOD_PENALTY);
    WITH_DEFAULTS(mps_body_motion, down, .velocity[1] = -5.0);
    OK(mps_body_create_box(context, &def, 0.15, 0.15, &x[k].body[0]));
    OK(mps_body_set_motion(x[k].body[0], &down));
    OK(mps_mpm_add_contact(x[k].s.mpm, x[k].body[0], &touch, &contact[k]));
  }
  mps_status status = MPS_OK;
  while ((status = mps_mpm_step(x[0].s.mpm, 1)) == MPS_OK)
    assert_in_range(mps_mpm_steps(x[0].s.mpm), 0, 500);
  assert_int_equal(status, MPS_ERROR_DIVERGED);
  assert_non_null(strstr(mps_context_error(context)->message, "below the surface of body 0"));
  OK(mps_mpm_step(x[1].s.mpm, mps_mpm_steps(x[0].s.mpm)));
  same_fields(&x[0], &x[1]);
  FAILS(mps_mpm_step(x[0].s.mpm, 1), MPS_ERROR_DIVERGED, "below the surface"); /* again */
  mps_reaction r[2];
  mps_snapshot *snapshot = NULL;
  for (int k = 0; k < 2; k++) { /* without the body it continues, as one that never failed */
    OK(mps_contact_get_reaction(contact[k], -1, &r[k]));
    OK(mps_mpm_snapshot(x[k].s.mpm, &snapshot));
    mps_snapshot_destroy(&snapshot);
    mps_contact_destroy(&contact[k]);
    OK(mps_mpm_step(x[k].s.mpm, 50));
  }
  assert_memory_equal(&r[0], &r[1], sizeof r[0]);
  same_fields(&x[0], &x[1]);
  assert_true(mps_mpm_time(x[0].s.mpm) == mps_mpm_time(x[1].s.mpm));
  drop(&x[0]);
  drop(&x[1]);
}

/* Each allocation is refused in turn: all or nothing. */
static mps_status come_and_go(mps_context *own, int what) {
  scene x;
  scoped_snapshot *snapshot = NULL;
  const int64_t ids[2] = {3, 400};
  mps_status status = try_build(own, MPS_MPM_GEOMETRY_PLANE_STRAIN, &none, &x);
  if (status == MPS_OK) status = mps_mpm_snapshot(x.s.mpm, &snapshot);
  if (status == MPS_OK) status = mps_particles_remove(x.s.particles, ids, 2);
  if (status == MPS_OK) {
    status = mps_particles_fill_box(x.s.particles, AT(0.5, 0.1), AT(0.9, 0.3), NULL);
    assert_int_equal(mps_particles_count(x.s.particles), status == MPS_OK ? 1598 : 798);
  }
  if (status == MPS_OK) status = mps_particles_set(x.s.particles, "density", 0, 1500.0);
  if (status == MPS_OK) status = mps_mpm_step(x.s.mpm, 1);
  if (status == MPS_OK) {
    status = mps_mpm_rollback(x.s.mpm, snapshot);
    assert_int_equal(mps_particles_count(x.s.particles), status == MPS_OK ? 800 : 1598);
  }
  drop(&x);
  return status;
}

TEST(refused_allocations_leave_nothing_behind) { test_allocator_sweep(come_and_go, 0); }
