/* test_mpm_budget.c - the energy budget of WLS-MPM: it closes to round-off with every kind of
 * boundary, load, body and law; its terms are what theory says of a falling block, a sliding box, a
 * piston and a vibrating bar. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_twins.h"
#include "test_fixture.h"

static mps_mpm_energy_report losses(mpm_scene *s) {
  mps_mpm_energy_report l;
  OK(mps_mpm_get_energy_report(s->mpm, &l));
  return l;
}

/* The sum of the sizes of all terms, the kinetic energy by its change since `start`. */
static double size_of(mpm_scene *s, double start) {
  const mps_totals t = mpm_scene_totals(s);
  const mps_mpm_energy_report l = losses(s);
  return fabs(t.kinetic - start) + fabs(t.strain) + fabs(t.work_loads) + fabs(t.work_boundaries) +
         fabs(t.work_bodies) + fabs(l.laws) + fabs(l.boundaries) + fabs(l.bodies) +
         fabs(l.damping) + fabs(l.transfer) + fabs(l.stepping) + fabs(l.strain);
}

static double sum_of(const mps_totals *t) {
  return t->kinetic + t->strain + t->dissipated - t->work_loads - t->work_boundaries -
         t->work_bodies;
}

/* The residual, and what the totals leave: they are two sums of the same terms. */
static void assert_closes(mpm_scene *s, double start, const char *what, double tolerance) {
  const mps_totals t = mpm_scene_totals(s);
  const mps_mpm_energy_report l = losses(s);
  const double size = size_of(s, start);
  print_message(
      "%s: K %.4g U %.4g, works %.4g %.4g %.4g, laws %.3g sides %.3g bodies %.3g transfer "
      "%.3g stepping %.3g strain %.3g; residual %.2g of it\n",
      what, t.kinetic, t.strain, t.work_loads, t.work_boundaries, t.work_bodies, l.laws,
      l.boundaries, l.bodies, l.transfer, l.stepping, l.strain, l.residual / size);
  assert_true(size > 0.0 && fabs(l.residual) < tolerance * size);
  assert_true(fabs(sum_of(&t) - start + l.residual) < 1e-12 * (size + start));
}

/* Driven sides, moving nodes, absorbing and frictional sides, loads, body accelerations. */
TEST(closes_with_boundaries) {
  for (int32_t geometry = MPS_MPM_GEOMETRY_PLANE_STRAIN; geometry <= MPS_MPM_GEOMETRY_SPACE;
       geometry++)
    for (int32_t choice = 0; choice < 3; choice++) {
      int32_t box = -1, loads[2];
      DEF(mpm, def, .geometry = geometry, .budget = 1, .spline = choice == 1 ? 2 : 3,
          .volumetric = choice == 2 ? MPS_MPM_VOLUMETRIC_CELL : MPS_MPM_VOLUMETRIC_POINT,
          .flip_time = choice == 2 ? 0.01 : 0.0);
      scoped_mpm_scene s = held_begin_with(context, &def, &box, loads);
      const double start = mpm_scene_totals(&s).kinetic;
      OK(mps_mpm_step(s.mpm, test_steps(60)));
      assert_closes(&s, start, "boundaries", 1e-12);
    }
}

/* A driven and a free rough body, plastic soil; particles held by a list. */
TEST(closes_with_bodies) {
  for (int32_t geometry = MPS_MPM_GEOMETRY_PLANE_STRAIN; geometry <= MPS_MPM_GEOMETRY_SPACE;
       geometry++) {
    change c = none;
    c.budget = 1;
    c.half_plane = true;
    SCOPED(drop) scene x = build(context, geometry, &c);
    int64_t ids[20];
    for (int k = 0; k < 20; k++) ids[k] = 7 * k;
    DEF(mpm_boundary, held, .ids = ids, .id_count = 20, .dofs = MPS_DOF_X);
    int32_t number;
    OK(mps_mpm_add_boundary(x.s.mpm, &held, &number));
    const double start = mpm_scene_totals(&x.s).kinetic;
    OK(mps_mpm_step(x.s.mpm, test_steps(150)));
    const mps_mpm_energy_report l = losses(&x.s);
    assert_closes(&x.s, start, "bodies", 1e-12);
    assert_true(l.bodies > 0.0 && l.laws > 0.0);
  }
}

/* Particles of a list shake in one component and rest in another, some of them in two lists, in an
 * elastic block and in sand that falls, under each volumetric option. Where no other boundary acts
 * the kinetic energy that the budget counts is the particles' own. */
TEST(closes_with_lists_of_particles) {
  for (int32_t law = 0; law < 2; law++)
    for (int32_t volumetric = 0; volumetric <= MPS_MPM_VOLUMETRIC_NODES; volumetric++) {
      scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
      mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.1);
      DEF(mpm, def, .cell = 0.02, .budget = 1, .gravity[1] = -9.81, .volumetric = volumetric);
      if (law == 1) {
        mps_material_destroy(&s.material);
        USING(material_mohr_coulomb, mps_material_create_mohr_coulomb(context, &given, &s.material),
              .young = 1e5, .friction = 0.5, .dilation = 0.2, .cohesion = 10.0);
      }
      mpm_scene_solve(&s, &def);
      scoped_signal *shake = NULL;
      OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 20.0, 0.001, 0.0,
                                &shake));
      int64_t ids[30];
      int32_t numbers[2];
      for (int k = 0; k < 30; k++) ids[k] = 3 * k;
      DEF(mpm_boundary, held, .kind = MPS_BOUNDARY_DRIVEN, .ids = ids, .id_count = 20,
          .signal[0] = shake);
      OK(mps_mpm_add_boundary(s.mpm, &held, &numbers[0]));
      held.ids = ids + 10, held.dofs = MPS_DOF_X, held.factor[0] = -0.5;
      OK(mps_mpm_add_boundary(s.mpm, &held, &numbers[1]));
      OK(mps_mpm_step(s.mpm, test_steps(150)));
      assert_closes(&s, 0.0, law == 0 ? "lists in a block" : "lists in sand", 1e-12);
      double work = 0.0;
      for (int k = 0; k < 2; k++) {
        mps_reaction r;
        OK(mps_mpm_get_reaction(s.mpm, numbers[k], &r));
        work += r.work;
      }
      const double total = mpm_scene_totals(&s).work_boundaries;
      assert_true(fabs(work) > 0.0 && fabs(work - total) < 1e-12 * fabs(total));
    }
}

/* The works are the sums of those of the reactions. */
TEST(works_are_those_of_the_reactions) {
  int32_t box = -1, loads[2];
  DEF(mpm, def, .budget = 1);
  scoped_mpm_scene s = held_begin_with(context, &def, &box, loads);
  OK(mps_mpm_step(s.mpm, 50));
  const int32_t numbers[] = {0, 1, 2, 3, box};
  double work = 0.0;
  for (int k = 0; k < 5; k++) {
    mps_reaction r;
    OK(mps_mpm_get_reaction(s.mpm, numbers[k], &r));
    work += r.work;
  }
  const double total = mpm_scene_totals(&s).work_boundaries;
  assert_true(fabs(work - total) < 1e-12 * fabs(total));
}

/* Without the budget there are no energies but the kinetic one, and the run is the same but for
 * round-off. */
TEST(is_asked_for) {
  mpm_scene s[2];
  for (int k = 0; k < 2; k++) {
    int32_t box = -1, loads[2];
    DEF(mpm, def, .budget = k);
    s[k] = held_begin_with(context, &def, &box, loads);
    OK(mps_mpm_step(s[k].mpm, 60));
  }
  const mps_totals a = mpm_scene_totals(&s[0]), b = mpm_scene_totals(&s[1]);
  assert_true(isnan(a.strain) && isnan(a.dissipated) && isnan(a.scheme) && isnan(a.work_loads));
  assert_true(fabs(a.kinetic - b.kinetic) < 1e-12 * a.kinetic);
  assert_true(fabs(a.work_boundaries - b.work_boundaries) < 1e-11 * fabs(a.work_boundaries));
  mps_mpm_energy_report l;
  FAILS(mps_mpm_get_energy_report(s[0].mpm, &l), MPS_ERROR_STATE, "budget is 0");
  for (int k = 0; k < 2; k++) mpm_scene_end(&s[k]);
  DEF(mpm, def, .cell = 0.02, .budget = 2);
  scoped_mpm_scene other = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&other, 0.0, 0.0, 0.1, 0.1);
  OK(mps_particles_set(other.particles, "density", 0, 1000.0));
  REFUSES(mps_mpm_create(context, other.particles, other.material, &def, &other.mpm),
          "budget is 2");
}

/* A block falls freely: gravity does m g times the fall, all of which is kinetic but for half of
 * m (g dt)^2 a step, which an explicit step with the velocity at its end gives away. */
TEST(falling_block) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.1);
  DEF(mpm, def, .cell = 0.02, .gravity[1] = -10.0, .dt = 1e-4, .budget = 1);
  mpm_scene_solve(&s, &def);
  OK(mps_mpm_step(s.mpm, 500));
  const mps_totals t = mpm_scene_totals(&s);
  const mps_mpm_energy_report l = losses(&s);
  const double v = 0.5, fall = 0.5 * 10.0 * 1e-8 * 500.0 * 501.0, m = 20.0;
  NEAR(t.work_loads, m * 10.0 * fall, 1e-10);
  NEAR(t.kinetic, 0.5 * m * v * v, 1e-10);
  NEAR(l.stepping, 500.0 * 0.5 * m * 1e-6, 1e-10);
  NEAR(l.transfer, 0.0, 1e-10);
  NEAR(t.linear[1], -m * 10.0 * 0.05, 1e-10);
}

/* A box slides to rest on a rough floor: friction takes mu N s, and gravity pushes N. */
static void sliding_box(bool body) {
  const double mu = 0.4, g = 10.0, v0 = 0.6, m = 20.0;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.2, 0.2, 1e8); /* stiff: it hardly shakes */
  mpm_scene_box(&s, 0.2, 0.2, 0.4, 0.3);
  DEF(mpm, def, .cell = 0.02, .gravity[1] = -g, .budget = 1);
  if (!body) def.lower[1] = 0.2;
  OK(mps_particles_set(s.particles, "velocity", 0, v0));
  mpm_scene_solve(&s, &def);
  scoped_body *floor = NULL;
  if (body) {
    const double up[] = {0.0, 1.0};
    USING(body, mps_body_create_half_plane(context, &given, up, &floor), .position[1] = 0.2);
    mpm_scene_contact(&s, floor, mu);
  } else {
    mpm_scene_side(&s, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_FRICTIONAL, mu);
  }
  double before = 0.0, after = 0.0;
  mps_view x = mpm_scene_view(&s, "position");
  for (int64_t k = 0; k < x.shape[0]; k++) before += *mps_view_f64(&x, k, 0);
  OK(mps_mpm_run(s.mpm, 0.25, 1, NULL, NULL));
  x = mpm_scene_view(&s, "position");
  for (int64_t k = 0; k < x.shape[0]; k++) after += *mps_view_f64(&x, k, 0);
  const double slid = (after - before) / (double)x.shape[0];
  const mps_totals t = mpm_scene_totals(&s);
  const mps_mpm_energy_report l = losses(&s);
  const double friction = body ? l.bodies : l.boundaries;
  print_message("slid %.4f m, theory %.4f; friction %.4f J, mu N s %.4f\n", slid,
                v0 * v0 / (2.0 * mu * g), friction, mu * m * g * slid);
  NEAR(slid, v0 * v0 / (2.0 * mu * g), 0.02 * slid);
  NEAR(friction, mu * m * g * slid, 0.01 * friction);
  assert_closes(&s, 0.5 * m * v0 * v0, body ? "box on body" : "box on side", 1e-12);
  assert_true(t.kinetic < 1e-4 * friction);
}

TEST(box_slides_on_a_side) { sliding_box(false); }
TEST(box_slides_on_a_body) { sliding_box(true); }

/* A wall pushes slowly against a bar between rollers: its work is the energy of the strain, half
 * of M (u/L)^2 V, and the momentum is the impulse of the sides. */
TEST(piston) {
  const double young = 1e5, M = young * 0.7 / (1.3 * 0.4), t[] = {0.0, 1.0}, v[] = {0.004, 0.004};
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, young);
  mpm_scene_box(&s, 0.0, 0.0, 0.4, 0.1);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .budget = 1,
        .lower[0] = given.lower[1] = 0.0, .upper[0] = 0.6, .upper[1] = 0.1);
  MAKE(signal, push, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, t, v);
  const double low[] = {0.36, -1.0}, high[] = {0.5, 1.0};
  mps_mpm_boundary_def wall = mpm_scene_box_def(s.mpm, low, high, 0, push, -1.0);
  int32_t number;
  OK(mps_mpm_add_boundary(s.mpm, &wall, &number));
  OK(mps_mpm_run(s.mpm, 0.5, 1, NULL, NULL));
  const mps_totals all = mpm_scene_totals(&s);
  const double u = 0.002, theory = 0.5 * M * (u / 0.36) * (u / 0.36) * 0.036;
  print_message("piston: work %.5g J, strain %.5g, theory %.5g\n", all.work_boundaries, all.strain,
                theory);
  NEAR(all.work_boundaries, theory, 0.05 * theory);
  NEAR(all.strain, all.work_boundaries, 0.03 * theory);
  assert_closes(&s, 0.0, "piston", 1e-12);
  double impulse = 0.0;
  for (int k = 0; k < 5; k++) {
    mps_reaction r;
    OK(mps_mpm_get_reaction(s.mpm, k < 4 ? k : number, &r));
    impulse += r.impulse[0];
  }
  NEAR(all.linear[0], impulse, 1e-12 * M * 0.5);
}

/* A free bar in its first axial mode: energy goes to and fro between motion and strain; what is
 * lost, the transfers have taken. */
TEST(vibrating_bar) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 1.0, 0.04);
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  OK(mps_particles_add_field(s.particles, "velocity_gradient", 0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    EDIT(L, s.particles, "velocity_gradient")
      for (int64_t k = 0; k < x.shape[0]; k++) {
        *mps_edit_f64(&v, k, 0) = -0.01 * cos(PI * *mps_view_f64(&x, k, 0));
        *mps_edit_f64(&L, k, 0) = 0.01 * PI * sin(PI * *mps_view_f64(&x, k, 0));
      }
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .budget = 1);
  const double start = mpm_scene_totals(&s).kinetic;
  double most = 0.0;
  for (int step = 0; step < 1500; step++) {
    OK(mps_mpm_step(s.mpm, 1));
    const mps_totals t = mpm_scene_totals(&s);
    most = fmax(most, t.strain);
    assert_true(fabs(sum_of(&t) - start) < 1e-12 * start);
  }
  const mps_mpm_energy_report l = losses(&s);
  print_message("bar: start %.6g J, most strain %.6g, transfer %.3g, stepping %.3g\n", start, most,
                l.transfer, l.stepping);
  assert_true(most > 0.97 * start && most < 1.001 * start);
  assert_true(l.laws == 0.0 && l.bodies == 0.0 && l.boundaries == 0.0 && l.damping == 0.0);
  assert_true(l.transfer > 0.0 && l.transfer < 0.2 * start && fabs(l.stepping) < 0.05 * start);
}

/* The sums go through a snapshot, and do not depend on the threads. */
TEST(sums_go_back_and_are_the_same) {
  change c = none;
  c.budget = 1;
  SCOPED(drop) scene x = build(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, &c);
  scoped_snapshot *snapshot = NULL;
  OK(mps_mpm_step(x.s.mpm, 30));
  OK(mps_mpm_snapshot(x.s.mpm, &snapshot));
  OK(mps_mpm_step(x.s.mpm, 30));
  const mps_totals a = mpm_scene_totals(&x.s);
  OK(mps_mpm_rollback(x.s.mpm, snapshot));
  OK(mps_mpm_step(x.s.mpm, 30));
  const mps_totals b = mpm_scene_totals(&x.s);
  assert_memory_equal(&a, &b, sizeof a);
  int32_t threads = 3;
  scoped_context *other = on_threads(&threads);
  SCOPED(drop) scene y = build(other, MPS_MPM_GEOMETRY_PLANE_STRAIN, &c);
  OK(mps_mpm_step(y.s.mpm, 60));
  const mps_totals d = mpm_scene_totals(&y.s);
  assert_memory_equal(&a, &d, sizeof a);
}
