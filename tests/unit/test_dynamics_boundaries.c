/* test_dynamics_boundaries.c - held, driven, viscous, periodic and free-field boundaries of the
 * explicit MPS solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dynamics/base/dynamics_solver.h"
#include "soil_column.h"
#include "test_fixture.h"

static const soil_layer soil = {1e9, 1500.0, 100.0, 200.0, 0.0};
static const soil_layer damped = {1e9, 1500.0, 100.0, 200.0, 0.1};

static mps_dynamics *solver(mps_particles *set, int integrator, double dt) {
  DEF(dynamics, def, .integrator = integrator, .dt = dt);
  MAKE_KEPT(dynamics, dynamics, create, context, set, &def);
  return dynamics;
}

static double value(mps_particles *set, const char *field, int64_t id, int component) {
  return soil_value(set, field, id, component);
}

static mps_signal *sine(double phase) {
  MAKE_KEPT(signal, signal, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 3.0, 0.01,
            phase);
  return signal;
}

/* ---- arguments ------------------------------------------------------------------------------- */

TEST(bad_boundaries_are_refused) {
  scoped_particles *set = soil_particles(context, 1.0, 3.0, 3.0, 1, &soil);
  scoped_dynamics *d = solver(set, MPS_DYNAMICS_INTEGRATOR_VERLET, 1e-3);
  scoped_signal *signal = sine(0.0);
  const int64_t ids[2] = {0, 9};
  int32_t number = -7;
  REFUSES(soil_add_held(d, 16, 1, ids), "dofs is 16");
  REFUSES(soil_add_held(d, 4, 1, ids), "dofs is 4");
  REFUSES(soil_add_held(d, 1, 0, ids), "id_count is 0");
  REFUSES(soil_add_held(d, 1, -1, ids), "id_count is -1");
  REFUSES(soil_add_held(d, 1, 1, NULL), "ids is NULL");
  REFUSES(soil_add_held(d, 1, 2, ids), "ids[1] is 9: the set has no such particle");
  REFUSES(soil_add_driven(d, 2, signal, 1.0, 1, ids), "signal[2] is given");
  REFUSES(soil_add_driven(d, 0, NULL, 1.0, 1, ids),
          "must be given where kind is MPS_BOUNDARY_DRIVEN");
  REFUSES(soil_add_driven(d, 0, signal, NAN, 1, ids), "factor[0] is nan");
  REFUSES(soil_add_driven(d, 0, signal, 1.0, 2, ids), "ids[1] is 9");
  const struct {
    int32_t kind, normal;
    uint32_t dofs;
    double density, vs, vp, factor, lower, upper;
    const char *text;
  } cases[] = {{3, 1, 1, NAN, NAN, NAN, 1.0, NAN, NAN,
                "kind is MPS_BOUNDARY_FRICTIONAL, allowed are MPS_BOUNDARY_HELD, "},
               {2, 1, 1, NAN, NAN, NAN, 1.0, NAN, NAN, "kind is MPS_BOUNDARY_ROLLER, allowed"},
               {5, 1, 1, NAN, NAN, NAN, 1.0, NAN, NAN, "kind is MPS_BOUNDARY_FREE_FIELD, allowed"},
               {8, 1, 1, NAN, NAN, NAN, 1.0, NAN, NAN, "kind is 8, allowed"},
               {4, 1, 1, NAN, NAN, NAN, 1.0, NAN, NAN,
                "dofs is 1, must be 0 where kind is MPS_BOUNDARY_ABSORBING"},
               {4, 2, 0, NAN, NAN, NAN, 1.0, NAN, NAN, "axis is 2, allowed are 0 (x) and 1 (y)"},
               {4, 1, 0, -1.0, NAN, NAN, 1.0, NAN, NAN,
                "density is -1 kg/m3, must be in 1e-06 to 1e+09, or NaN"},
               {4, 1, 0, NAN, 0.0, NAN, 1.0, NAN, NAN, "shear_velocity is 0"},
               {4, 1, 0, NAN, NAN, INFINITY, 1.0, NAN, NAN, "pressure_velocity is inf"},
               {4, 1, 0, NAN, NAN, NAN, NAN, NAN, NAN, "factor[0] is nan"},
               {4, 1, 0, NAN, NAN, NAN, 1.0, 0.0, 1.0, "both ids and a box"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    DEF(dynamics_boundary, def, .ids = ids, .id_count = 1, .kind = cases[k].kind,
        .axis = cases[k].normal, .dofs = cases[k].dofs, .density = cases[k].density,
        .shear_velocity = cases[k].vs, .pressure_velocity = cases[k].vp,
        .factor[0] = cases[k].factor, .lower[0] = def.lower[1] = cases[k].lower,
        .upper[0] = def.upper[1] = cases[k].upper);
    REFUSES(mps_dynamics_add_boundary(d, &def, &number), cases[k].text);
  }
  DEF(dynamics_boundary, def, .dofs = MPS_DOF_X);
  REFUSES(mps_dynamics_add_boundary(d, &def, &number),
          "nothing is selected: give ids and id_count, or a box");
  def.lower[0] = def.lower[1] = 50.0;
  def.upper[0] = def.upper[1] = INFINITY;
  REFUSES(mps_dynamics_add_boundary(d, &def, &number),
          "no particle lies in the box from (50, 50) m");
  def.upper[1] = 49.0;
  REFUSES(mps_dynamics_add_boundary(d, &def, &number), "lower[1] is 50 m and upper[1] 49 m");
  REFUSES(mps_dynamics_add_boundary(d, NULL, &number), "def");
  REFUSES(mps_dynamics_add_boundary(d, &def, NULL), "the box is empty");
  REFUSES(mps_dynamics_set_boundary(d, 0, &def), "number is 0: there is no boundary");
  REFUSES(mps_dynamics_remove_boundary(d, -1), "number is -1");
  mps_reaction reaction;
  REFUSES(mps_dynamics_get_reaction(d, 0, &reaction), "number is 0: there is no boundary");
  assert_int_equal(number, -7);
  /* none of it has left a boundary: the block still moves freely as a whole */
  OK(mps_particles_set(set, "velocity", 0, 0.5));
  OK(mps_dynamics_restart(d, 0.0));
  OK(mps_dynamics_step(d, 10));
  for (int64_t id = 0; id < 9; id++) NEAR(value(set, "velocity", id, 0), 0.5, 1e-12);
  /* dofs 0 are all that a particle has */
  OK(soil_add_held(d, 0, 1, ids));
  OK(mps_particles_set(set, "velocity", 1, 0.5));
  OK(mps_particles_set(set, "spin", 0, 0.5));
  OK(mps_dynamics_restart(d, 0.0));
  OK(mps_dynamics_step(d, 10));
  for (int c = 0; c < 2; c++) NEAR(value(set, "velocity", 0, c), 0.0, 1e-12);
  NEAR(value(set, "spin", 0, 0), 0.0, 1e-12);
  assert_true(fabs(value(set, "velocity", 8, 1)) > 0.1);
}

TEST(bad_columns_are_refused) {
  DEF(particles, def, .spacing = 1.0);
  MAKE(particles, set, create, context, &def);
  REFUSES(mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 2), "0 particles");
  mps_particles_destroy(&set);
  def.dim = 3;
  OK(mps_particles_create(context, &def, &set));
  REFUSES(mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 2), "dim 3");
  mps_particles_destroy(&set);
  set = soil_particles(context, 1.0, 3.0, 4.0, 1, &soil);
  REFUSES(mps_dynamics_add_free_field(set, 2, 2),
          "side is MPS_SIDE_Y_LOWER, allowed are MPS_SIDE_X_LOWER and MPS_SIDE_X_UPPER");
  REFUSES(mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 1), "gap is 1 spacings, must be 2 to");
  assert_int_equal(mps_particles_count(set), 12);
  OK(mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 3));
  assert_int_equal(mps_particles_count(set), 16);
  FAILS(mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 3), MPS_ERROR_STATE,
        "already has a left");
  assert_int_equal(mps_particles_count(set), 16);
  for (int64_t id = 12; id < 16; id++) {
    NEAR(value(set, "position", id, 0), 0.5 - 3.0, 1e-15);
    NEAR(value(set, "density", id, 0), 1500.0, 0.0);
  }
}

/* ---- held and driven ------------------------------------------------------------------------- */

/* A strained body, held everywhere: its particles bear forces, but do not accelerate. */
TEST(what_a_support_bears_is_no_divergence) {
  for (int integrator = 0; integrator < 3; integrator++) {
    scoped_particles *set = soil_particles(context, 1.0, 4.0, 4.0, 1, &damped);
    DEF(dynamics, def, .integrator = integrator, .dt = 1e-3, .divergence = 1.0);
    OK(mps_particles_add_field(set, "displacement", 0));
    EDIT(u, set, "displacement") *mps_edit_f64(&u, 5, 0) = 0.05; /* some 1e3 m/s2 */
    MAKE(dynamics, d, create, context, set, &def);
    soil_hold(set, d, MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION, -1.0, -1.0, 9.0, 9.0);
    OK(mps_dynamics_step(d, 10));
    NEAR(value(set, "acceleration", 5, 0), 0.0, 0.0);
  }
}

TEST(a_held_freedom_stays_where_it_is) {
  for (int integrator = 0; integrator < 3; integrator++) {
    scoped_particles *set = soil_particles(context, 1.0, 4.0, 4.0, 1, &damped);
    const int64_t ids[3] = {3, 6, 9};
    OK(mps_particles_set(set, "velocity", 0, 0.2));
    OK(mps_particles_set(set, "velocity", 1, -0.1));
    SET_FIELDS(set, {"spin", 0.3}, {"displacement", 0.05});
    scoped_dynamics *d = solver(set, integrator, 1e-3);
    OK(soil_add_held(d, MPS_DOF_X, 1, &ids[0]));
    OK(soil_add_held(d, MPS_DOF_Y, 1, &ids[1]));
    OK(soil_add_held(d, MPS_DOF_ROTATION, 1, &ids[2]));
    OK(mps_dynamics_step(d, 25));
    const char *const field[3] = {"displacement", "displacement", "rotation"};
    const char *const rate[3] = {"velocity", "velocity", "spin"};
    for (int held = 0; held < 3; held++)
      for (int c = 0; c < 3; c++) {
        const double moved = value(set, field[c], ids[held], c == 1) - (c == 0 ? 0.05 : 0.0);
        if (c == held) {
          NEAR(moved, 0.0, 0.0);
          NEAR(value(set, rate[c], ids[held], c == 1), 0.0, 0.0);
        } else {
          assert_true(fabs(moved) > 1e-6);
        }
      }
  }
}

TEST(a_driven_particle_follows_its_signal) {
  scoped_signal *x = sine(0.4), *y = sine(1.1);
  const double dt = 1e-3, start = 0.25;
  for (int integrator = 0; integrator < 3; integrator++) {
    scoped_particles *set = soil_particles(context, 1.0, 4.0, 4.0, 1, &damped);
    scoped_dynamics *d = solver(set, integrator, dt);
    const int64_t id = 5;
    OK(soil_add_driven(d, 0, y, 7.0, 1, &id));
    OK(soil_add_driven(d, 0, x, 2.0, 1, &id)); /* the last one counts */
    OK(soil_add_driven(d, 1, y, -3.0, 1, &id));
    NEAR(value(set, "displacement", id, 0), 0.0, 0.0); /* from where it is */
    OK(mps_dynamics_restart(d, start));
    for (int k = 0; k <= 30; k++) {
      const double t = mps_dynamics_time(d);
      const mps_signal *signal[2] = {x, y};
      const double factor[2] = {2.0, -3.0};
      for (int c = 0; c < 2; c++) {
        const double u = factor[c] * (mps_signal_displacement(signal[c], t) -
                                      mps_signal_displacement(signal[c], start));
        const double before = factor[c] * (mps_signal_displacement(signal[c], t - dt) -
                                           mps_signal_displacement(signal[c], start));
        const double v = factor[c] * mps_signal_velocity(signal[c], t);
        NEAR(value(set, "displacement", id, c), u, 1e-16);
        NEAR(value(set, "position", id, c), value(set, "reference", id, c) + u, 1e-15);
        NEAR(value(set, "velocity", id, c),
             k == 0 || integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? v : (u - before) / dt, 1e-9);
        if (k > 0) /* that of the instant before, as everybody's */
          NEAR(value(set, "acceleration", id, c),
               factor[c] * mps_signal_acceleration(signal[c], t - dt), 1e-9);
      }
      OK(mps_dynamics_step(d, 1));
    }
  }
}

/* A list that names particles twice bears their weight once, about the right place. */
TEST(a_list_bears_what_it_holds_once) {
  const int64_t ids[7] = {5, 3, 5, 5, 0, 3, 9};
  const double mass = 1500.0, g = 9.81; /* of a particle: 1 m2, 1 m thick */
  for (int integrator = 0; integrator < 3; integrator++) {
    scoped_particles *set = soil_particles(context, 1.0, 4.0, 4.0, 1, &soil);
    scoped_dynamics *d = solver(set, integrator, 1e-3);
    DEF(dynamics_load, load, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1, .acceleration[1] = -g);
    int32_t number, others;
    mps_reaction r, rest;
    OK(mps_dynamics_add_load(d, &load, &number));
    DEF(dynamics_boundary, list, .lower[0] = list.lower[1] = -INFINITY,
        .upper[0] = list.upper[1] = INFINITY);
    OK(mps_dynamics_add_boundary(d, &list, &others));
    list = mps_dynamics_boundary_defaults(), list.ids = ids, list.id_count = 7;
    OK(mps_dynamics_add_boundary(d, &list, &number)); /* prevails */
    OK(mps_dynamics_step(d, 10));
    OK(mps_dynamics_get_reaction(d, number, &r));
    OK(mps_dynamics_get_reaction(d, others, &rest));
    NEAR(r.force[1], 4.0 * mass * g, 1e-9 * mass * g);
    NEAR(rest.force[1], 12.0 * mass * g, 1e-9 * mass * g);
    NEAR(r.force[0], 0.0, 1e-9 * mass * g);
    NEAR(r.work, 0.0, 0.0);
    for (int k = 0; k < 7; k++) NEAR(value(set, "displacement", ids[k], 1), 0.0, 0.0);
  }
}

/* ---- viscous --------------------------------------------------------------------------------- */

/* One free particle: only dashpots act. (1 + c dt/2) v+ = (1 - c dt/2) v- + 2 c dt v_in, and
 * explicitly for Euler; a corner has two faces. */
TEST(dashpots_on_one_particle) {
  const double dt = 2e-3, D = 0.5, area = D * D;
  scoped_signal *wave = sine(0.7);
  for (int integrator = 0; integrator < 3; integrator++)
    for (int corner = 0; corner < 2; corner++) {
      scoped_particles *set = soil_particles(context, D, D, D, 1, &soil);
      const int64_t id = 0;
      assert_int_equal(mps_particles_count(set), 1);
      OK(mps_particles_set(set, "velocity", 0, 0.3));
      OK(mps_particles_set(set, "velocity", 1, -0.2));
      OK(mps_particles_add_field(set, "reaction", 0));
      scoped_dynamics *d = solver(set, integrator, dt);
      DEF(dynamics_boundary, def, .density = 2000.0, .shear_velocity = 80.0, .signal[0] = wave,
          .factor[0] = 1.5);
      OK(soil_add_viscous(d, &def, 1, &id)); /* face across y */
      if (corner) {
        def = mps_dynamics_boundary_defaults();
        def.axis = 0;
        OK(soil_add_viscous(d, &def, 1, &id));
      }
      const double c1[2] = {2000.0 * 80.0 * D / (1500.0 * area),   /* Vs across */
                            2000.0 * 200.0 * D / (1500.0 * area)}; /* Vp, the particle's own */
      const double c2[2] = {corner ? 200.0 / D : 0.0, corner ? 100.0 / D : 0.0};
      double v[2] = {0.3, -0.2};
      for (int k = 0; k < 20; k++) {
        const double before[2] = {v[0], v[1]};
        for (int m = 0; m < 2; m++) {
          const double c = c1[m] + c2[m];
          const double in = m == 0 ? 1.5 * mps_signal_velocity(wave, mps_dynamics_time(d)) : 0.0;
          const double pull = dt * 2.0 * c1[m] * in;
          v[m] = integrator == MPS_DYNAMICS_INTEGRATOR_EULER
                     ? v[m] * (1.0 - c * dt) + pull
                     : (v[m] * (1.0 - 0.5 * c * dt) + pull) / (1.0 + 0.5 * c * dt);
        }
        OK(mps_dynamics_step(d, 1));
        for (int m = 0; m < 2; m++) {
          NEAR(value(set, "velocity", id, m), v[m], 1e-11 * (1.0 + fabs(v[m])));
          const double acceleration = (v[m] - before[m]) / dt;
          NEAR(value(set, "acceleration", id, m), acceleration, 1e-8);
          NEAR(value(set, "reaction", id, m), 1500.0 * area * acceleration, 1e-5);
        }
      }
    }
}

/* Sends a pulse of half width `width` (m) from the middle of an endlessly wide column through its
 * two viscous ends; which part of the energy comes back? */
static double reflected(int wave, int integrator, double width) {
  const double height = 100.0;
  scoped_particles *set = soil_particles(context, 1.0, 3.0, height, 1, &soil);
  mps_totals first, last;
  OK(mps_particles_add_field(set, "velocity", 0));
  mps_view x = view_field(set, "position");
  EDIT(v, set, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&v, k, wave) =
          1e-3 * exp(-pow((*mps_view_f64(&x, k, 1) - 0.5 * height) / width, 2));
  DEF(dynamics, def, .integrator = integrator, .period_x = 3.0);
  MAKE(dynamics, d, create, context, set, &def);
  for (int end = 0; end < 2; end++) {
    int64_t count;
    int64_t *ids =
        soil_select(set, -1.0, end ? height - 1.0 : 0.0, 9.0, end ? height : 1.0, &count);
    assert_int_equal(count, 3);
    OK(soil_add_viscous(d, NULL, count, ids));
    free(ids);
  }
  OK(mps_dynamics_get_totals(d, &first));
  OK(mps_dynamics_run(d, 1.2, 1000, NULL, NULL));
  OK(mps_dynamics_get_totals(d, &last));
  return (last.kinetic + last.strain) / (first.kinetic + first.strain);
}

/* The ends sit half a spacing off, so the reflected amplitude is of the order D over the length of
 * the wave: a quarter of the energy for twice the length. */
TEST(waves_leave_through_viscous_ends) {
  for (int wave = 0; wave < 2; wave++)
    for (int integrator = 0; integrator < 2; integrator++) {
      const double shorter = reflected(wave, integrator, 8.0);
      const double longer = reflected(wave, integrator, 16.0);
      print_message("%s wave, integrator %d: %.2e and %.2e of the energy come back\n",
                    wave ? "P" : "S", integrator, shorter, longer);
      assert_true(shorter < 4e-3 && longer < 0.3 * shorter);
    }
}

/* ---- periodic and free field ----------------------------------------------------------------- */

TEST(a_period_closes_the_body) {
  for (int w = 2; w <= 5; w++) { /* 2: each neighbour from both sides */
    const int h = 7;
    scoped_particles *set = soil_particles(context, 1.0, w, h, 1, &soil);
    DEF(dynamics, def, .period_x = w, .dt = 1e-3);
    scoped_signal *signal = sine(0.0);
    MAKE(dynamics, d, create, context, set, &def);
    assert_int_equal(d->pairs, w * h + 3 * w * (h - 1));
    int64_t count;
    int64_t *ids = soil_select(set, 0.0, 0.0, w, 1.0, &count);
    OK(soil_add_driven(d, 0, signal, 1.0, count, ids));
    free(ids);
    OK(mps_dynamics_step(d, 200));
    for (int64_t id = 0; id < w * h; id++) { /* every column moves as the first */
      NEAR(value(set, "displacement", id, 0), value(set, "displacement", id / w * w, 0), 1e-14);
      NEAR(value(set, "rotation", id, 0), value(set, "rotation", id / w * w, 0), 1e-14);
    }
    assert_true(fabs(value(set, "displacement", w * h - 1, 0)) > 1e-4);
  }
}

/* Level ground of two layers between two columns moves as they do, and as periodic ground does. */
TEST(level_ground_moves_as_its_columns) {
  const soil_layer layers[2] = {{6.0, 1600.0, 90.0, 180.0, 0.02},
                                {1e9, 1900.0, 150.0, 400.0, 0.05}};
  scoped_signal *signal = sine(0.0);
  for (int integrator = 0; integrator < 3; integrator++)
    for (int wide = 0; wide < 2; wide++) {
      double periodic[12][3];
      for (int run = 0; run < 2; run++) { /* 0: periodic, 1: columns */
        scoped_particles *set = soil_particles(context, 1.0, 5.0, 12.0, 2, layers);
        DEF(dynamics, def, .integrator = integrator, .dt = 5e-4, .radius_ratio = wide ? 2.3 : 1.5);
        if (run == 0) def.period_x = 5.0;
        if (run == 1) OK(mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 3));
        if (run == 1) OK(mps_dynamics_add_free_field(set, MPS_SIDE_X_UPPER, 2));
        MAKE(dynamics, d, create, context, set, &def);
        int64_t count;
        int64_t *ids = soil_select(set, -9.0, 0.0, 20.0, 1.0, &count);
        OK(soil_add_driven(d, 0, signal, 1.0, count, ids));
        OK(soil_add_driven(d, 1, signal, 0.3, count, ids));
        free(ids);
        OK(mps_dynamics_step(d, 300));
        for (int64_t id = 0; id < mps_particles_count(set); id++) {
          const int row = (int)floor(value(set, "reference", id, 1));
          const double now[3] = {value(set, "displacement", id, 0),
                                 value(set, "displacement", id, 1), value(set, "rotation", id, 0)};
          if (run == 0 && id % 5 == 0) memcpy(periodic[row], now, sizeof now);
          for (int c = 0; c < 3; c++) NEAR(now[c], periodic[row][c], 1e-12);
        }
        assert_true(fabs(periodic[11][0]) > 1e-4);
      }
    }
}

/* ---- shapes ---------------------------------------------------------------------------------- */

static mps_status l_shape(void *user, const double *x, int32_t *inside) {
  *inside = x[0] < 5.0 || x[1] < 3.0;
  return MPS_OK;
}

/* Shape `which`, its axes exchanged if `turned`; smooth initial velocities. */
static mps_particles *shape(int which, bool turned) {
  const double size[][2] = {{1, 40}, {40, 1}, {300, 3}, {14, 60}, {1, 1}, {2, 1}};
  DEF(particles, def, .spacing = 1.0);
  mps_particles *set = NULL, *upright = NULL;
  OK(mps_particles_create(context, &def, &upright));
  OK(mps_particles_create(context, &def, &set));
  const double lo[2] = {0.0, 0.0}, l[2] = {30.0, 40.0};
  if (which < 6)
    OK(mps_particles_fill_box(upright, lo, size[which], NULL));
  else if (which == 6)
    OK(mps_particles_fill_where(upright, lo, l, l_shape, NULL, NULL));
  else /* a loose heap off any lattice */
    for (int k = 0; k < 400; k++) {
      const double x[2] = {fmod(k * 7.31, 23.0) + 0.31 * sin(k), floor(k / 20.0) + 0.3 * cos(k)};
      OK(mps_particles_append(upright, 1, x));
    }
  mps_view x = view_field(upright, "position");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double at[2] = {*mps_view_f64(&x, k, turned), *mps_view_f64(&x, k, !turned)};
    OK(mps_particles_append(set, 1, at));
  }
  SET_FIELDS(set, {"density", 1500.0}, {"shear_velocity", 100.0}, {"pressure_velocity", 200.0},
             {"spin", 0.0});
  OK(mps_particles_add_field(set, "velocity", 0));
  EDIT(v, set, "velocity")
    EDIT(w, set, "spin")
      for (int64_t k = 0; k < x.shape[0]; k++) {
        *mps_edit_f64(&v, k, turned) = sin(0.3 * *mps_view_f64(&x, k, 1));
        *mps_edit_f64(&v, k, !turned) = cos(0.2 * *mps_view_f64(&x, k, 0));
        *mps_edit_f64(&w, k, 0) = (turned ? -1.0 : 1.0) * sin((double)k);
      }
  mps_particles_destroy(&upright);
  return set;
}

/* Exchanging the axes turns rows into columns and so changes the whole arrangement in memory, but
 * not the motion. */
TEST(odd_shapes_move_the_same_with_axes_exchanged) {
  const int64_t pairs[] = {39, 39, 299 * 3 + 300 * 2 + 2 * 299 * 2, 13 * 60 + 14 * 59 + 2 * 13 * 59,
                           0, 1,
                           /* L: 5 x 40 and 25 x 3 beside it, 3 + 5 across the joint */
                           (4 * 40 + 5 * 39 + 2 * 4 * 39) + (24 * 3 + 25 * 2 + 2 * 24 * 2) + 3 + 5};
  for (int which = 0; which < 8; which++) {
    mps_particles *set[2] = {shape(which, false), shape(which, true)};
    mps_dynamics *d[2] = {solver(set[0], MPS_DYNAMICS_INTEGRATOR_VERLET, 2e-4),
                          solver(set[1], MPS_DYNAMICS_INTEGRATOR_VERLET, 2e-4)};
    if (which < 7) assert_int_equal(d[0]->pairs, pairs[which]);
    assert_int_equal(d[0]->pairs, d[1]->pairs);
    for (int t = 0; t < 2; t++) OK(mps_dynamics_step(d[t], 50));
    for (int64_t id = 0; id < mps_particles_count(set[0]); id++) {
      for (int c = 0; c < 2; c++)
        NEAR(value(set[0], "displacement", id, c), value(set[1], "displacement", id, !c), 1e-13);
      NEAR(value(set[0], "rotation", id, 0), -value(set[1], "rotation", id, 0), 1e-13);
    }
    for (int t = 0; t < 2; t++) {
      mps_dynamics_destroy(&d[t]);
      mps_particles_destroy(&set[t]);
    }
  }
}
