/* test_elastic_change.c - what changes while a motion of implicit elasticity is under way: with
 * Newmark's average acceleration the budget closes over each step after another material or
 * boundary, and the first step of what is set free is that of its forces; densities are those of
 * the start, whatever is queried in between.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/operator/moduli.h"
#include "elastic_common.h"
#include "test_fixture.h"

enum { SIDE = 5 };

typedef struct beam {
  mps_particles *set;
  mps_elastic *e;
  int32_t foot;
} beam;

/* A block that moves; its lowest row is held. */
static beam make(double stiffness_damping) {
  mps_elastic_def solver = mps_elastic_defaults();
  const double lo[2] = {0.0, 0.0}, hi[2] = {0.1 * SIDE, 0.1 * SIDE}, force[2] = {300.0, -500.0};
  beam b = {.set = NULL};
  USING(particles, mps_particles_create(context, &given, &b.set), .spacing = 0.1);
  OK(mps_particles_fill_box(b.set, lo, hi, NULL));
  SET_FIELDS(b.set, {"density", 1000.0}, {"young", 1e6}, {"poisson", 0.3});
  OK(mps_particles_add_field(b.set, "velocity", 0));
  EDIT(v, b.set, "velocity")
    for (int64_t k = 0; k < v.view.shape[0]; k++)
      for (int c = 0; c < 2; c++)
        *mps_edit_f64(&v, k, c) = 0.3 * sin(1.0 + (double)(3 * k + 7 * c));
  OK(mps_elastic_create(context, b.set, &solver, &b.e));
  DEF(elastic_boundary, foot, .lower[0] = foot.lower[1] = -1.0, .upper[0] = 9.0, .upper[1] = 0.1);
  OK(mps_elastic_add_boundary(b.e, &foot, &b.foot));
  OK(test_body_force(b.e, force));
  DEF(elastic_motion, motion, .dt = 2e-3);
  motion.rho_inf = 1.0; /* average acceleration */
  motion.stiffness_damping = stiffness_damping;
  OK(mps_elastic_start(b.e, &motion));
  OK(mps_elastic_step(b.e, 10));
  return b;
}

static void drop(beam *b) {
  mps_elastic_destroy(&b->e);
  mps_particles_destroy(&b->set);
}

static double balance_of(const mps_totals *t) {
  return t->kinetic + t->strain + t->dissipated - t->work_loads - t->work_boundaries;
}

static mps_totals totals_of(const beam *b) {
  mps_totals t;
  OK(mps_elastic_get_totals(b->e, &t));
  return t;
}

static void assert_closes(const beam *b, int64_t steps) {
  const mps_totals before = totals_of(b);
  OK(mps_elastic_step(b->e, steps));
  const mps_totals after = totals_of(b);
  NEAR(balance_of(&after), balance_of(&before), 1e-9 * (after.kinetic + after.strain));
}

static void other_material(const beam *b) {
  int64_t ids[10];
  for (int k = 0; k < 10; k++) ids[k] = 5 + k;
  MAKE(material, soft, create_linear_elastic, context, 3e5, 0.1);
  OK(mps_elastic_set_material(b->e, soft, ids, 10));
}

TEST(the_budget_closes_after_another_material) {
  for (int damped = 0; damped < 2; damped++) {
    SCOPED(drop) beam b = make(damped ? 1e-3 : 0.0);
    const mps_totals before = totals_of(&b);
    other_material(&b);
    const mps_totals changed = totals_of(&b);
    NEAR(changed.dissipated, before.dissipated, 1e-12 * before.strain);
    assert_true(changed.strain < 0.9 * before.strain); /* the same shape of softer ground */
    assert_closes(&b, 1);
    assert_closes(&b, 20);
    const mps_totals after = totals_of(&b);
    assert_true(damped ? after.dissipated > changed.dissipated
                       : fabs(after.dissipated) <= 1e-9 * after.kinetic);
  }
}

TEST(the_budget_closes_after_another_boundary) {
  SCOPED(drop) beam b = make(0.0);
  DEF(elastic_boundary, side, .lower[0] = 0.4, .upper[0] = 9.0, .lower[1] = 0.1, .upper[1] = 9.0);
  int32_t number;
  OK(mps_elastic_add_boundary(b.e, &side, &number)); /* stops what moves there */
  assert_closes(&b, 1);
  assert_closes(&b, 10);
  OK(mps_elastic_remove_boundary(b.e, number));
  assert_closes(&b, 1);
  assert_closes(&b, 10);
  OK(mps_elastic_set_boundary(b.e, b.foot, &side)); /* from the foot to a side, at once */
  assert_closes(&b, 1);
  assert_closes(&b, 10);
}

/* What has been held without a strain begins with F/m: u' = dt^2/4 (F/m + a') after the first step.
 */
TEST(what_is_set_free_falls_at_once) {
  SCOPED(drop) beam b = make(0.0);
  int32_t number;
  const double dt = 2e-3, body[2] = {300.0 / 1000.0, -500.0 / 1000.0};
  DEF(elastic_boundary, all, .lower[0] = all.lower[1] = -1.0, .upper[0] = all.upper[1] = 9.0);
  OK(mps_elastic_add_boundary(b.e, &all, &number)); /* at its place of origin */
  OK(mps_elastic_step(b.e, 3));
  OK(mps_elastic_remove_boundary(b.e, number));
  OK(mps_elastic_step(b.e, 1));
  mps_view u = view_field(b.set, "displacement");
  mps_view a = view_field(b.set, "acceleration");
  mps_view x = view_field(b.set, "position");
  for (int64_t k = 0; k < u.shape[0]; k++)
    for (int c = 0; c < 2 && *mps_view_f64(&x, k, 1) > 0.1; c++)
      NEAR(*mps_view_f64(&u, k, c), 0.25 * dt * dt * (body[c] + *mps_view_f64(&a, k, c)), 1e-15);
}

/* The same step as from a solver that never had other densities. */
TEST(a_second_start_has_the_present_densities) {
  beam x = make(0.0), y = make(0.0);
  DEF(elastic_motion, motion, .dt = 2e-3, .rho_inf = 1.0);
  double omega[2];
  OK(mps_particles_set(x.set, "density", 0, 4000.0));
  OK(mps_elastic_modes(x.e, 2, omega, NULL)); /* of the new ones; the motion continues as it was */
  OK(mps_elastic_step(x.e, 3));
  OK(mps_elastic_step(y.e, 3));
  const mps_totals a = totals_of(&x), b = totals_of(&y);
  NEAR(a.mass, b.mass, 0.0);
  NEAR(a.kinetic, b.kinetic, 1e-12 * b.kinetic);
  OK(mps_elastic_start(x.e, &motion)); /* the same dt: the same shift of the matrix */
  OK(mps_particles_set(y.set, "density", 0, 4000.0));
  OK(mpsi_elastic_renew_material(y.e, __func__)); /* nothing is left of its factor */
  OK(mps_elastic_start(y.e, &motion));
  OK(mps_elastic_step(x.e, 5));
  OK(mps_elastic_step(y.e, 5));
  NEAR(totals_of(&x).mass, 4000.0 * 0.25, 1e-9);
  mps_view u = view_field(x.set, "displacement");
  mps_view w = view_field(y.set, "displacement");
  for (int64_t k = 0; k < u.shape[0]; k++)
    for (int c = 0; c < 2; c++) NEAR(*mps_view_f64(&u, k, c), *mps_view_f64(&w, k, c), 1e-12);
  drop(&x), drop(&y);
}

/* Weight follows from the densities of the moment, at rest. */
TEST(a_solution_weighs_the_present_densities) {
  SCOPED(drop) beam b = make(0.0);
  DEF(elastic_load, weight, .kind = MPS_ELASTIC_LOAD_BODY, .all = 1, .force[1] = -10.0);
  double force[3];
  OK(mps_elastic_set_load(b.e, 0, &weight));
  OK(mps_elastic_solve(b.e));
  OK(mps_particles_set(b.set, "density", 0, 3000.0));
  OK(mps_elastic_get_load_resultant(b.e, NULL, force, NULL));
  NEAR(force[1], -10.0 * 3000.0 * 0.25, 1e-9);
  OK(mps_elastic_solve(b.e));
  mps_reaction r;
  OK(mps_elastic_get_reaction(b.e, b.foot, &r));
  NEAR(r.force[1], 10.0 * 3000.0 * 0.25, 1e-6);
  NEAR(totals_of(&b).mass, 3000.0 * 0.25, 1e-9);
  const double nowhere[3] = {0.0, NAN, 0.0};
  REFUSES(mps_elastic_get_load_resultant(b.e, nowhere, force, NULL), "about[1]");
  const double far[3] = {1e305, 0.0, 0.0};
  FAILS(mps_elastic_get_load_resultant(b.e, far, force, force), MPS_ERROR_NUMERIC, "moment[2]");
}

/* A rollback over a change: as if it had not been, bit for bit, and then as after it again. */
TEST(a_rollback_over_a_change_leads_to_the_same) {
  SCOPED(drop) beam b = make(1e-3);
  scoped_snapshot *snapshot = NULL;
  mps_totals first, second;
  int32_t number;
  DEF(elastic_boundary, foot, .lower[0] = foot.lower[1] = -1.0, .upper[0] = 9.0, .upper[1] = 0.1);
  OK(mps_elastic_add_boundary(b.e, &foot, &number));
  foot.dofs = MPS_DOF_Y, foot.lower[1] = 0.4, foot.upper[1] = 9.0;
  OK(mps_elastic_set_boundary(b.e, b.foot, &foot));
  OK(mps_elastic_snapshot(b.e, &snapshot));
  OK(mps_elastic_step(b.e, 3));
  first = totals_of(&b);
  OK(mps_elastic_rollback(b.e, snapshot));
  OK(mps_elastic_step(b.e, 3));
  second = totals_of(&b);
  assert_memory_equal(&first, &second, sizeof first);
  other_material(&b);
  OK(mps_elastic_rollback(b.e, snapshot));
  assert_closes(&b, 3);
}

/* Masses and forces of a state are those of its cells: over a cut there is no way back. */
TEST(a_rollback_over_a_cut_is_refused) {
  for (int removed = 0; removed < 2; removed++) {
    static const char path[] = "test_elastic_change.h5";
    beam b = make(0.0);
    mps_snapshot *snapshot = NULL;
    int64_t ids[SIDE];
    const int64_t last = SIDE * SIDE - 1;
    for (int k = 0; k < SIDE; k++) ids[k] = k;
    OK(mps_elastic_snapshot(b.e, &snapshot));
    OK(mps_elastic_save(b.e, path, NULL));
    if (removed) OK(mps_particles_remove(b.set, &last, 1));
    OK(mps_elastic_cut(b.e, MPS_SIDE_Y_LOWER, ids, SIDE));
    USING(elastic_motion, mps_elastic_start(b.e, &given), .dt = 1e-3);
    OK(mps_elastic_step(b.e, 2));
    const mps_totals before = totals_of(&b);
    FAILS(mps_elastic_rollback(b.e, snapshot), MPS_ERROR_STATE, "particle 0 is cut on other sides");
    REFUSES(mps_elastic_restore(b.e, path, NULL), "particle 0 is cut on other sides");
    const mps_totals after = totals_of(&b);
    assert_memory_equal(&before, &after, sizeof before);
    assert_closes(&b, 3);
    mps_snapshot_destroy(&snapshot);
    drop(&b);
    (void)remove(path);
  }
}
