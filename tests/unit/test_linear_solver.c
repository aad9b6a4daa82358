/* test_linear_solver.c - a linear solver of the caller, for each equation: the answers of the
 * library's own, what is refused, errors of its callbacks, its place in states, and its end.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"
#include "fluid_tank.h"
#include "linear_plug.h"
#include "pore_column.h"
#include "test_fixture.h"

#include <mps/dynamics.h>
#include <mps/experimental/fluid_parts.h>

enum {
  STIFFNESS = MPS_LINEAR_EQUATION_STIFFNESS,
  PRESSURE = MPS_LINEAR_EQUATION_PRESSURE,
  PORES = MPS_LINEAR_EQUATION_PORE_PRESSURE
};
static int first_equation(void) {
  return mps_library_has(MPS_FEATURE_CHOLMOD) ? STIFFNESS : PRESSURE;
}

/* ---- three models, each of any size: a bar in motion, a wave in a tank, drained ground ---------
 */

typedef struct model {
  int equation;
  mps_solver *solver; /* lent */
  mps_particles *set;
  test_body bar;
  tank wave;
  pore_column ground;
} model;

static model make_bar(int size, double tolerance) {
  model m = {.equation = STIFFNESS, .bar = test_body_begin(context, 2, 0.25)};
  const double force[3] = {0.0, -1e-2, 0.0};
  int64_t count;
  DEF(elastic, def, .tolerance = tolerance);
  test_body_box(&m.bar, 0, 0, 0, size, 1, 0);
  test_body_finish(&m.bar, 1.0, 0.3, &def);
  int64_t *ids = test_select(&m.bar, 0, -1, 0.3, &count);
  for (int c = 0; c < 2; c++) OK(test_prescribe(m.bar.elastic, c, count, ids, NULL));
  free(ids);
  OK(test_body_force(m.bar.elastic, force));
  OK(mps_particles_set(m.bar.particles, "density", 0, 2.0));
  USING(elastic_motion, mps_elastic_start(m.bar.elastic, &given), .dt = 0.2);
  m.solver = mps_elastic_solver(m.bar.elastic), m.set = m.bar.particles;
  return m;
}

static model make_wave(int size, double tolerance) {
  model m = {.equation = PRESSURE};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  set.spacing = 0.025, def.dt = 2e-3, def.level = 0.2, def.tolerance = tolerance;
  OK(mps_particles_create(context, &set, &m.wave.water));
  tank_fill(m.wave.water, 0.2 * size, 0.2, NULL, NULL);
  OK(mps_fluid_create(context, m.wave.water, &def, &m.wave.fluid));
  MAKE(signal, piston, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0);
  tank_wall(m.wave.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(m.wave.fluid, 0.0, 0.0, 1.0, 0.0, piston);
  tank_wall(m.wave.fluid, 0.2 * size, 0.0, -1.0, 0.0, NULL);
  m.solver = mps_fluid_solver(m.wave.fluid), m.set = m.wave.water;
  return m;
}

static model make_ground(int size) {
  model m = {.equation = PORES};
  m.ground = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 6 * size, 0.0, 0.0);
  USING(pore_water, mps_mpm_add_pore_water(m.ground.s.mpm, &given),
        .scheme = MPS_PORE_SCHEME_IMPLICIT, .porosity = 0.4, .permeability = 1e-4,
        .bulk = 80.0 * m.ground.modulus);
  m.solver = mps_mpm_solver(m.ground.s.mpm), m.set = m.ground.s.particles;
  OK(mps_particles_set(m.set, "pore_pressure", 0, 1e3));
  OK(mps_particles_set(m.set, "stress", 1, -1e3));
  return m;
}

static model make(int equation, int size, double tolerance) {
  return equation == STIFFNESS  ? make_bar(size, tolerance)
         : equation == PRESSURE ? make_wave(size, tolerance)
                                : make_ground(size);
}

static void end(model *m) {
  if (m->equation == STIFFNESS) test_body_end(&m->bar);
  if (m->equation == PRESSURE) tank_free(&m->wave);
  if (m->equation == PORES) mpm_scene_end(&m->ground.s);
}

static void put_in(model *m, linear_plug *p) {
  const mps_linear_solver_def def = linear_plug_def(p);
  OK(mps_solver_set_linear_solver(m->solver, m->equation, &def));
}

/* What the equation gives. */
static mps_view solution(const model *m) {
  static const char *const name[] = {
      [STIFFNESS] = "displacement", [PRESSURE] = "pressure", [PORES] = "pore_pressure"};
  mps_view v = view_field(m->set, name[m->equation]);
  return v;
}

/* The largest difference of two models, over the largest value. */
static double difference(const model *a, const model *b) {
  const mps_view u[2] = {solution(a), solution(b)};
  double worst = 0.0, largest = 0.0;
  assert_int_equal(u[0].shape[0], u[1].shape[0]);
  for (int64_t i = 0; i < u[0].shape[0]; i++)
    for (int64_t c = 0; c < u[0].shape[1]; c++) {
      const double x = *mps_view_f64(&u[0], i, c), y = *mps_view_f64(&u[1], i, c);
      worst = fmax(worst, fabs(x - y)), largest = fmax(largest, fabs(x));
    }
  assert_true(largest > 0.0);
  return worst / largest;
}

/* ---- answers --------------------------------------------------------------------------------- */

TEST(answers_are_the_librarys) {
  for (int equation = first_equation(); equation <= PORES; equation++)
    for (int size = 1; size <= 4; size *= 2) {
      linear_plug p = {.fault = LINEAR_FINE};
      model own = make(equation, size, 1e-12), other = make(equation, size, 1e-12);
      put_in(&other, &p);
      OK(mps_solver_step(own.solver, 4));
      OK(mps_solver_step(other.solver, 4));
      const double apart = difference(&own, &other);
      print_message("equation %d, %d rows: %d iterations, differs by %.1e\n", equation, (int)p.rows,
                    (int)p.iterations, apart);
      assert_true(apart < 1e-8);
      assert_true(p.solutions >= 4 && p.iterations > 0);
      assert_int_equal(p.block, equation == STIFFNESS ? 2 : 1);
      assert_int_equal(p.modes, equation == STIFFNESS ? 3 : 0);
      assert_true(linear_asymmetry(&p) < 1e-12);
      end(&own);
      end(&other);
      assert_int_equal(p.released, 1);
      linear_plug_drop(&p);
    }
}

/* The same columns as before are announced, and seen by the plug to be so. */
TEST(says_whether_columns_have_changed) {
  for (int equation = first_equation(); equation <= PORES; equation++) {
    linear_plug p = {.fault = LINEAR_FINE};
    model m = make(equation, 2, 1e-8);
    put_in(&m, &p);
    OK(mps_solver_step(m.solver, 1));
    assert_true(p.matrices >= 1 && p.patterns == 1);
    const int matrices = p.matrices;
    if (equation == STIFFNESS) OK(mps_solver_set_dt(m.solver, 0.1));
    OK(mps_solver_step(m.solver, 1));
    assert_true(p.matrices > matrices);
    if (equation != PRESSURE) assert_int_equal(p.patterns, 1);
    mps_snapshot *then = NULL;
    OK(mps_solver_snapshot(m.solver, &then));
    const int patterns = p.patterns;
    OK(mps_solver_step(m.solver, 1));
    assert_int_equal(p.patterns, patterns + 1); /* all is new after `forget` */
    mps_snapshot_destroy(&then);
    end(&m);
    linear_plug_drop(&p);
  }
}

TEST(small_equations_stay_the_librarys) {
  for (int equation = first_equation(); equation <= PORES; equation++) {
    linear_plug p = {.fault = LINEAR_FINE}, counter = {.fault = LINEAR_FINE};
    model own = make(equation, 2, 1e-8), other = make(equation, 2, 1e-8);
    put_in(&other, &counter);
    OK(mps_solver_step(other.solver, 1));
    end(&other);
    for (int k = 0; k < 2; k++) {
      mps_linear_solver_def def = linear_plug_def(&p);
      other = make(equation, 2, 1e-8);
      def.least = counter.rows + k;
      OK(mps_solver_set_linear_solver(other.solver, equation, &def));
      OK(mps_solver_step(other.solver, 2));
      assert_int_equal(p.solutions > 0, k == 0);
      if (k) OK(mps_solver_step(own.solver, 2));
      if (k) assert_true(difference(&own, &other) == 0.0);
      p.solutions = 0;
      end(&other);
    }
    end(&own);
    linear_plug_drop(&p);
    linear_plug_drop(&counter);
  }
}

/* One solver, another one, and the library's own at last. */
TEST(solvers_change_between_steps) {
  for (int equation = first_equation(); equation <= PORES; equation++) {
    linear_plug p[2] = {{.fault = LINEAR_FINE}, {.fault = LINEAR_FINE}};
    model own = make(equation, 2, 1e-12), other = make(equation, 2, 1e-12);
    for (int k = 0; k < 2; k++) {
      put_in(&other, &p[k]);
      OK(mps_solver_step(other.solver, 2));
      assert_true(p[k].solutions >= 2 && p[k].released == 0);
    }
    assert_int_equal(p[0].released, 1);
    OK(mps_solver_set_linear_solver(other.solver, equation, NULL));
    assert_int_equal(p[1].released, 1);
    const int solutions = p[0].solutions + p[1].solutions;
    OK(mps_solver_step(other.solver, 2));
    assert_int_equal(p[0].solutions + p[1].solutions, solutions);
    OK(mps_solver_step(own.solver, 6));
    assert_true(difference(&own, &other) < 1e-8);
    end(&own);
    end(&other);
    for (int k = 0; k < 2; k++) linear_plug_drop(&p[k]);
  }
}

/* ---- faults and errors ----------------------------------------------------------------------- */

/* A step that fails is not made: the next one has the bits of one without a failure before it. */
static void expect_failure(model *m, linear_plug *p, mps_status status, const char *text) {
  linear_plug fine = {.fault = LINEAR_FINE};
  model twin = make(m->equation, 2, 1e-6);
  put_in(&twin, &fine);
  OK(mps_solver_step(twin.solver, 1));
  FAILS(mps_solver_step(m->solver, 1), status, text);
  assert_int_equal(mps_solver_steps(m->solver), 0);
  p->fault = LINEAR_FINE;
  p->matrix_status = p->solve_status = MPS_OK;
  OK(mps_solver_step(m->solver, 1));
  assert_true(difference(&twin, m) == 0.0);
  end(&twin);
  linear_plug_drop(&fine);
}

TEST(solutions_that_are_none_are_refused) {
  static const struct {
    mps_status status;
    const char *text;
  } expected[LINEAR_FAULTS] = {
      [LINEAR_SCALES] = {MPS_ERROR_NUMERIC,
                         "callback solve of mps_solver_set_linear_solver has the"},
      [LINEAR_SAYS_LESS] = {MPS_ERROR_NUMERIC, "says a residual of "},
      [LINEAR_GIVES_UP] = {MPS_ERROR_NUMERIC, "has not converged: it says a residual of 0.5"},
      [LINEAR_NAN] = {MPS_ERROR_NUMERIC, "has given x["},
      [LINEAR_WRITES_ON] = {MPS_ERROR_NUMERIC, "has written x["},
      [LINEAR_LEAVES_ROWS] = {MPS_ERROR_NUMERIC, "has the residual 1 of the right side"},
      [LINEAR_COUNTS_BELOW_0] = {MPS_ERROR_NUMERIC, "says -1 iterations"},
      [LINEAR_STEPS] = {MPS_ERROR_STATE, "the callback solve of mps_solver_set_linear_solver"},
  };
  for (int equation = first_equation(); equation <= PORES; equation++)
    for (int fault = LINEAR_FINE + 1; fault < LINEAR_FAULTS; fault++) {
      model m = make(equation, 2, 1e-6);
      linear_plug p = {.fault = (linear_fault)fault, .solver = m.solver};
      put_in(&m, &p);
      expect_failure(&m, &p, expected[fault].status, expected[fault].text);
      end(&m);
      linear_plug_drop(&p);
    }
}

TEST(errors_of_callbacks_end_the_step) {
  for (int equation = first_equation(); equation <= PORES; equation++) {
    for (int k = 0; k < 2; k++) {
      model m = make(equation, 2, 1e-6);
      linear_plug p = {.fault = LINEAR_FINE};
      *(k ? &p.solve_status : &p.matrix_status) = MPS_ERROR_IO;
      put_in(&m, &p);
      expect_failure(&m, &p, MPS_ERROR_IO, k ? "the callback solve of" : "the callback matrix of");
      end(&m);
      linear_plug_drop(&p);
    }
    model m = make(equation, 1, 1e-8);
    linear_plug p = {.forget_status = MPS_ERROR_IO};
    mps_snapshot *then = NULL;
    OK(mps_solver_snapshot(m.solver, &then));
    put_in(&m, &p);
    FAILS(mps_solver_snapshot(m.solver, &then), MPS_ERROR_IO, "callback forget");
    FAILS(mps_solver_rollback(m.solver, then), MPS_ERROR_IO, "callback forget");
    assert_int_equal(p.forgotten, 2);
    p.forget_status = MPS_OK;
    OK(mps_solver_rollback(m.solver, then));
    OK(mps_solver_step(m.solver, 1));
    mps_snapshot_destroy(&then);
    end(&m);
    linear_plug_drop(&p);
  }
}

TEST(wrong_definitions_are_refused) {
  assert_int_equal(mps_solver_set_linear_solver(NULL, STIFFNESS, NULL), MPS_ERROR_ARGUMENT);
  for (int equation = first_equation(); equation <= PORES; equation++) {
    model m = make(equation, 1, 1e-8);
    linear_plug p = {.fault = LINEAR_FINE}, kept = {.fault = LINEAR_FINE};
    put_in(&m, &kept);
    for (int other = -1; other <= PORES + 1; other++) {
      const mps_linear_solver_def def = linear_plug_def(&p);
      if (other == equation) continue;
      FAILS(mps_solver_set_linear_solver(m.solver, other, &def), MPS_ERROR_ARGUMENT,
            "that of the solver is");
      FAILS(mps_solver_set_linear_solver(m.solver, other, NULL), MPS_ERROR_ARGUMENT,
            "that of the solver is");
    }
    static const char *const text[] = {"matrix is NULL",        "solve is NULL",
                                       "least is -1",           "rank 1 of 2 processes",
                                       "rank 0 of 2 processes", "reserved"};
    for (int k = 0; k < 6; k++) {
      mps_linear_solver_def def = linear_plug_def(&p);
      if (k == 0) def.matrix = NULL;
      if (k == 1) def.solve = NULL;
      if (k == 2) def.least = -1;
      if (k == 3 || k == 4) def.rank = 4 - k, def.ranks = 2;
      if (k == 5) def.reserved = 1;
      FAILS(mps_solver_set_linear_solver(m.solver, equation, &def), MPS_ERROR_ARGUMENT, text[k]);
    }
    OK(mps_solver_step(m.solver, 1)); /* the former one is still there */
    assert_true(kept.solutions > 0 && kept.released == 0 && p.released == 0);
    end(&m);
    linear_plug_drop(&kept);
  }
}

/* Solvers that have no such equation, or not now. */
TEST(solvers_without_the_equation_refuse_it) {
  linear_plug p = {.fault = LINEAR_FINE};
  const mps_linear_solver_def def = linear_plug_def(&p);
  pore_column dry = pore_column_begin(context, MPS_MPM_GEOMETRY_PLANE_STRAIN, 4, 0.0, 0.0);
  mps_solver *ground = mps_mpm_solver(dry.s.mpm);
  FAILS(mps_solver_set_linear_solver(ground, PORES, &def), MPS_ERROR_STATE, "no pore water");
  mpm_scene_end(&dry.s);
  model wave = make(PRESSURE, 1, 1e-8);
  OK(mps_fluid_begin_step(wave.wave.fluid, 2e-3));
  FAILS(mps_solver_set_linear_solver(wave.solver, PRESSURE, &def), MPS_ERROR_STATE, "open");
  end(&wave);
  mps_particles *particles = NULL;
  USING(particles, mps_particles_create(context, &given, &particles), .spacing = 0.25);
  OK(mps_particles_fill_box(particles, AT(0.0, 0.0), AT(1.0, 1.0), NULL));
  SET_FIELDS(particles, {"density", 2000.0}, {"shear_velocity", 100.0},
             {"pressure_velocity", 200.0});
  MAKE_KEPT(dynamics, dynamics, create, context, particles, NULL);
  for (int equation = 0; equation <= PORES; equation++)
    FAILS(mps_solver_set_linear_solver(mps_dynamics_solver(dynamics), equation, &def),
          MPS_ERROR_ARGUMENT, "and the solver has none");
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&particles);
  assert_int_equal(p.released, 0);
}

/* ---- states ---------------------------------------------------------------------------------- */

TEST(a_run_goes_on_from_a_snapshot) {
  for (int equation = first_equation(); equation <= PORES; equation++) {
    linear_plug p = {.fault = LINEAR_FINE}, q = {.fault = LINEAR_FINE};
    model m = make(equation, 2, 1e-6), whole = make(equation, 2, 1e-6);
    mps_snapshot *then = NULL, *same = NULL;
    put_in(&m, &p);
    put_in(&whole, &q);
    OK(mps_solver_step(m.solver, 3));
    OK(mps_solver_step(whole.solver, 3));
    OK(mps_solver_snapshot(m.solver, &then));
    OK(mps_solver_snapshot(whole.solver, &same));
    OK(mps_solver_step(whole.solver, 3));
    OK(mps_solver_step(m.solver, 2));
    OK(mps_solver_rollback(m.solver, then));
    assert_int_equal(p.forgotten, 2);
    OK(mps_solver_step(m.solver, 3));
    assert_true(difference(&whole, &m) == 0.0);
    mps_snapshot_destroy(&then);
    mps_snapshot_destroy(&same);
    end(&m);
    end(&whole);
    linear_plug_drop(&p);
    linear_plug_drop(&q);
  }
}

TEST(a_run_goes_on_from_a_file) {
  static const char path[] = "test_linear_solver.h5";
  if (!mps_library_has(MPS_FEATURE_HDF5)) skip();
  for (int equation = first_equation(); equation <= PORES; equation++) {
    linear_plug p = {.fault = LINEAR_FINE}, q = {.fault = LINEAR_FINE};
    model whole = make(equation, 2, 1e-6), later = make(equation, 2, 1e-6);
    put_in(&whole, &p);
    put_in(&later, &q);
    OK(mps_solver_step(whole.solver, 3));
    OK(mps_solver_save(whole.solver, path, NULL));
    OK(mps_solver_step(whole.solver, 3));
    OK(mps_solver_step(later.solver, 1)); /* has another past */
    OK(mps_solver_restore(later.solver, path, NULL));
    OK(mps_solver_step(later.solver, 3));
    assert_true(p.forgotten == 1 && q.forgotten == 1);
    assert_true(difference(&whole, &later) == 0.0);
    end(&whole);
    end(&later);
    linear_plug_drop(&p);
    linear_plug_drop(&q);
    remove(path);
  }
}

/* Two snapshots in one call: the callback stays a callback of the run between them. */
static mps_status keep_twice(void *user, mps_solver *solver) {
  mps_snapshot **then = user;
  linear_plug none = {.fault = LINEAR_FINE};
  const mps_linear_solver_def def = linear_plug_def(&none);
  for (int k = 0; k < 2; k++) OK(mps_solver_snapshot(solver, then));
  for (int equation = STIFFNESS; equation <= PORES; equation++)
    FAILS(mps_solver_set_linear_solver(solver, equation, &def), MPS_ERROR_STATE, "callback");
  FAILS(mps_solver_step(solver, 1), MPS_ERROR_STATE, "callback");
  return MPS_OK;
}

TEST(callbacks_of_a_run_take_snapshots) {
  for (int equation = first_equation(); equation <= PORES; equation++) {
    linear_plug p = {.fault = LINEAR_FINE};
    model m = make(equation, 1, 1e-8);
    mps_snapshot *then = NULL;
    put_in(&m, &p);
    OK(mps_solver_run(m.solver, mps_solver_time(m.solver) + 2.0 * mps_solver_dt(m.solver), 1,
                      keep_twice, &then));
    assert_true(p.forgotten >= 6);
    mps_snapshot_destroy(&then);
    end(&m);
    linear_plug_drop(&p);
  }
}
