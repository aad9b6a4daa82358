/* test_dynamics_budget.c - the energy budget of explicit dynamics closes, impulses are changes of
 * momentum, and reactions are those of statics, under every kind of boundary and load.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"
#include "test_fixture.h"

/* A block of 10 x 12 particles, measure 2.5 m, in slow motion: strains and rotations of some 1e-11,
 * so that what is not linear is below round-off. */
static mps_dynamics *block(mps_particles **set, int integrator, double damping, bool watch) {
  const soil_layer soil = {1e9, 1700.0, 120.0, 260.0, damping};
  *set = soil_particles(context, 0.5, 5.0, 6.0, 1, &soil);
  OK(mps_particles_set(*set, "velocity", 0, 0.0));
  mps_view x = view_field(*set, "position");
  EDIT(v, *set, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      *mps_edit_f64(&v, k, 0) = 1e-9 * sin(1.0 + *mps_view_f64(&x, k, 1));
      *mps_edit_f64(&v, k, 1) = 1e-9 * cos(2.0 * *mps_view_f64(&x, k, 0));
    }
  DEF(dynamics, def, .integrator = integrator);
  def.dt = integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? 1e-5 : 1e-3; /* Euler grows */
  def.measure = 2.5;
  def.watch_damping = watch;
  MAKE_KEPT(dynamics, d, create, context, *set, &def);
  return d;
}

static mps_totals totals(mps_dynamics *d) {
  mps_totals t;
  OK(mps_dynamics_get_totals(d, &t));
  return t;
}

/* The largest term of the budget so far. */
static double largest(const mps_totals *t) {
  return fmax(fmax(fabs(t->kinetic), fabs(t->strain)),
              fmax(fmax(fabs(t->dissipated), fabs(t->work_loads)), fabs(t->work_boundaries)));
}

/* A driven base, a viscous top, rollers, a load in time, gravity and forces of the caller. */
static void add_everything(mps_dynamics *d, mps_particles *set, bool external) {
  scoped_signal *wave = NULL, *factor = NULL;
  int32_t number;
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 4.0, 1e-10, 0.3, &wave));
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_VALUE, 4.0, 1e-10, 0.3, &factor));
  mps_dynamics_boundary_def def = mps_dynamics_boundary_defaults();
  def.dofs = MPS_DOF_X | MPS_DOF_ROTATION; /* a side */
  def.lower[0] = def.lower[1] = -INFINITY;
  def.upper[0] = 0.5, def.upper[1] = INFINITY;
  OK(mps_dynamics_add_boundary(d, &def, &number));
  def.kind = MPS_BOUNDARY_DRIVEN; /* the base */
  def.dofs = MPS_DOF_Y;
  def.upper[0] = INFINITY, def.upper[1] = 0.5;
  def.signal[0] = wave;
  OK(mps_dynamics_add_boundary(d, &def, &number));
  def.kind = MPS_BOUNDARY_ABSORBING; /* the top, with a wave from above */
  def.dofs = 0;
  def.lower[1] = 5.5, def.upper[1] = INFINITY;
  def.signal[0] = NULL, def.signal[1] = wave;
  OK(mps_dynamics_add_boundary(d, &def, &number));
  assert_int_equal(number, 2);
  DEF(dynamics_load, load, .lower[0] = 4.5, .lower[1] = -INFINITY,
      .upper[0] = load.upper[1] = INFINITY, .traction[0] = 2.0, .signal[0] = factor,
      .factor[0] = 1e7);
  OK(mps_dynamics_add_load(d, &load, &number));
  load = mps_dynamics_load_defaults();
  load.kind = MPS_DYNAMICS_LOAD_BODY, load.all = 1;
  load.acceleration[1] = -1e-8;
  OK(mps_dynamics_add_load(d, &load, &number));
  assert_int_equal(number, 1);
  if (external) OK(mps_particles_set(set, "external_force", 1, 1e-6));
}

/* Kinetic + strain + dissipated - works keeps its value, and Verlet and leapfrog need no help. */
TEST(the_budget_closes) {
  for (int integrator = 0; integrator < 3; integrator++)
    for (int damped = 0; damped < 2; damped++)
      for (int all = 0; all < 2; all++) {
        scoped_particles *set = NULL;
        scoped_dynamics *d = block(&set, integrator, 0.02 * damped, true);
        if (all) add_everything(d, set, true);
        OK(mps_dynamics_step(d, 1));
        double most = 0.0, scheme = 0.0, gap = 0.0, start = NAN;
        for (int k = 0; k < 300; k++) {
          OK(mps_dynamics_step(d, k % 3));
          const mps_totals t = totals(d);
          const double sum = t.kinetic + t.strain + t.dissipated - t.work_loads -
                             t.work_boundaries - t.work_bodies;
          if (isnan(start)) start = sum;
          most = fmax(most, largest(&t));
          gap = fmax(gap, fabs(sum - start));
          scheme = fmax(scheme, fabs(t.scheme));
        }
        const mps_totals t = totals(d);
        print_message("integrator %d, damped %d, all %d: gap %.2g, scheme %.2g of %.3g J\n",
                      integrator, damped, all, gap / most, scheme / most, most);
        assert_true(gap < 1e-12 * most);
        if (integrator != MPS_DYNAMICS_INTEGRATOR_EULER) assert_true(scheme < 1e-10 * most);
        if (damped) assert_true(t.dissipated > 1e-3 * most);
        if (all) assert_true(t.work_loads != 0.0 && fabs(t.work_boundaries) > 1e-3 * most);
      }
}

/* A change of dt costs energy of second order only, which `scheme` shows. */
TEST(a_change_of_dt_shows_in_the_scheme) {
  scoped_particles *set = NULL;
  scoped_dynamics *d = block(&set, MPS_DYNAMICS_INTEGRATOR_VERLET, 0.0, false);
  OK(mps_dynamics_step(d, 20));
  assert_true(fabs(totals(d).scheme) <
              1e-10 * largest(&(mps_totals){.kinetic = totals(d).kinetic}));
  OK(mps_dynamics_set_dt(d, 0.5e-3));
  OK(mps_dynamics_step(d, 20));
  const mps_totals t = totals(d);
  print_message("scheme %.2g of %.2g J\n", t.scheme, t.kinetic + t.strain);
  assert_true(t.scheme != 0.0 && fabs(t.scheme) < 0.02 * (t.kinetic + t.strain));
}

/* What is not watched is found all the same. */
TEST(damping_that_is_not_watched_is_the_rest) {
  mps_particles *set[2];
  mps_dynamics *d[2];
  mps_totals t[2];
  for (int watch = 0; watch < 2; watch++) {
    d[watch] = block(&set[watch], MPS_DYNAMICS_INTEGRATOR_LEAPFROG, 0.02, watch);
    add_everything(d[watch], set[watch], false);
    OK(mps_dynamics_step(d[watch], 200));
    t[watch] = totals(d[watch]);
  }
  NEAR(t[0].dissipated / t[1].dissipated, 1.0, 1e-9);
  assert_true(isnan(t[0].scheme) && !isnan(t[1].scheme));
  NEAR(t[0].kinetic / t[1].kinetic, 1.0, 1e-12); /* it only watches */
  for (int watch = 0; watch < 2; watch++) {
    mps_dynamics_destroy(&d[watch]);
    mps_particles_destroy(&set[watch]);
  }
}

/* Impulses of boundaries and loads are the change of momentum; moments that of angular momentum. */
TEST(impulses_are_changes_of_momentum) {
  for (int integrator = 0; integrator < 2; integrator++) {
    scoped_particles *set = NULL;
    scoped_dynamics *d = block(&set, integrator, 0.0, false);
    const mps_totals before = totals(d);
    int32_t number[2];
    OK(mps_dynamics_step(d, 10)); /* between steps, not only before the first */
    DEF(dynamics_boundary, def, .dofs = MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION,
        .lower[0] = def.lower[1] = -INFINITY, .upper[0] = INFINITY, .upper[1] = 1.0);
    OK(mps_dynamics_add_boundary(d, &def, &number[0]));
    OK(mps_dynamics_step(d, 57));
    def = mps_dynamics_boundary_defaults();
    def.kind = MPS_BOUNDARY_ABSORBING;
    def.lower[0] = -INFINITY, def.lower[1] = 5.5;
    def.upper[0] = def.upper[1] = INFINITY;
    OK(mps_dynamics_add_boundary(d, &def, &number[1]));
    OK(mps_dynamics_step(d, 100));
    const mps_totals after = totals(d);
    mps_reaction r[2];
    for (int k = 0; k < 2; k++) OK(mps_dynamics_get_reaction(d, number[k], &r[k]));
    assert_int_equal(r[0].count, 20);
    assert_int_equal(r[1].count, 10);
    for (int c = 0; c < 2; c++) {
      const double change = after.linear[c] - before.linear[c];
      NEAR((r[0].impulse[c] + r[1].impulse[c]) / change, 1.0, 1e-8);
    }
    const double turn = after.angular[2] - before.angular[2];
    NEAR((r[0].moment_impulse[2] + r[1].moment_impulse[2]) / turn, 1.0, 1e-6);
    NEAR((r[0].work + r[1].work) / after.work_boundaries, 1.0, 1e-12);
    assert_true(r[1].work < 0.0); /* it absorbs */
    /* removed: free again, and what it did stays counted */
    OK(mps_dynamics_remove_boundary(d, number[0]));
    mps_reaction none;
    REFUSES(mps_dynamics_get_reaction(d, number[0], &none), "number is 0: there is no boundary");
    OK(mps_dynamics_step(d, 30));
    const mps_totals t = totals(d);
    assert_true(fabs(t.scheme) < 1e-9 * largest(&t));
  }
}

/* A block at rest on its base under gravity and a pressure, after strong damping: reactions are the
 * weight and the load of the whole thickness, particle by particle too. */
TEST(reactions_carry_the_weight) {
  scoped_particles *set = NULL;
  scoped_dynamics *d = block(&set, MPS_DYNAMICS_INTEGRATOR_VERLET, 0.2, false);
  int32_t base, gravity, pressure;
  OK(mps_particles_add_field(set, "reaction", 0));
  OK(mps_particles_set(set, "velocity", 0, 0.0));
  OK(mps_particles_set(set, "velocity", 1, 0.0));
  OK(mps_dynamics_restart(d, 0.0));
  OK(mps_dynamics_set_dt(d, 2e-4));
  USING(dynamics_boundary, mps_dynamics_add_boundary(d, &given, &base),
        .dofs = MPS_DOF_X | MPS_DOF_Y, .lower[0] = given.lower[1] = -INFINITY, .upper[0] = INFINITY,
        .upper[1] = 0.5);
  DEF(dynamics_load, load, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1, .acceleration[1] = -9.8);
  OK(mps_dynamics_add_load(d, &load, &gravity));
  load = mps_dynamics_load_defaults();
  load.lower[0] = -INFINITY, load.lower[1] = 5.5;
  load.upper[0] = load.upper[1] = INFINITY;
  load.traction[1] = -1e4;
  OK(mps_dynamics_add_load(d, &load, &pressure));
  OK(mps_dynamics_run(d, 6.0, 100000, NULL, NULL));
  mps_reaction r;
  OK(mps_dynamics_get_reaction(d, base, &r));
  const double weight = 1700.0 * 5.0 * 6.0 * 2.5 * 9.8, top = 1e4 * 5.0 * 2.5;
  print_message("base %.6g N, weight and pressure %.6g N\n", r.force[1], weight + top);
  NEAR(r.force[1] / (weight + top), 1.0, 1e-3);
  NEAR(r.force[0] / weight, 0.0, 1e-6);
  NEAR(r.moment[2] / (2.5 * (weight + top)), 1.0, 1e-3); /* at the middle, x = 2.5 m */
  mps_view each = view_field(set, "reaction");
  double sum = 0.0;
  for (int64_t k = 0; k < each.shape[0]; k++) sum += *mps_view_f64(&each, k, 1);
  NEAR(sum / r.force[1], 1.0, 1e-12);
  OK(mps_dynamics_remove_load(d, pressure));
  OK(mps_dynamics_run(d, 12.0, 100000, NULL, NULL));
  OK(mps_dynamics_get_reaction(d, base, &r));
  NEAR(r.force[1] / weight, 1.0, 1e-3);
  NEAR(totals(d).mass * 9.8 / weight, 1.0, 1e-12);
}

/* A free lump falls as it must under body loads, tractions and forces in the field, alike. */
TEST(loads_accelerate_a_free_body) {
  for (int integrator = 0; integrator < 3; integrator++)
    for (int kind = 0; kind < 3; kind++) {
      scoped_particles *set = NULL;
      scoped_dynamics *d = block(&set, integrator, 0.0, false);
      int32_t number;
      const double g = -3.0, mass = 1700.0 * 0.25 * 2.5;
      const mps_totals before = totals(d);
      DEF(dynamics_load, load, .lower[0] = load.lower[1] = -INFINITY,
          .upper[0] = load.upper[1] = INFINITY,
          .kind = kind == 0 ? MPS_DYNAMICS_LOAD_BODY : MPS_DYNAMICS_LOAD_TRACTION,
          .acceleration[1] = g);
      load.traction[1] = mass * g / 1.25; /* spacing times measure */
      if (kind < 2)
        OK(mps_dynamics_add_load(d, &load, &number));
      else
        OK(mps_particles_set(set, "external_force", 1, mass * g));
      OK(mps_dynamics_step(d, 50));
      const mps_totals after = totals(d);
      NEAR((after.linear[1] - before.linear[1]) / (before.mass * g * 50.0 * mps_dynamics_dt(d)),
           1.0, 1e-9);
      const double fallen = integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? 49.0 * 50.0 : 50.0 * 51.0;
      NEAR(soil_value(set, "displacement", 60, 1) / (0.5 * g * pow(mps_dynamics_dt(d), 2) * fallen),
           1.0, 1e-4);
    }
}
